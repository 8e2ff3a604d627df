#include "trace/coverage_file.h"

#include <fmt/format.h>

#include <charconv>
#include <string_view>
#include <vector>

namespace capsoc::trace {
namespace {

uint64_t sum(uint64_t a, uint64_t b) {
  uint64_t result = 0;
  return __builtin_add_overflow(a, b, &result) ? UINT64_MAX : result;
}

/// How many entries of a map were hit, and how many there are.
template <typename Entries, typename IsHit>
std::string found_and_hit(const char* kind, const Entries& entries, IsHit is_hit) {
  std::size_t hit = 0;
  for (const auto& entry : entries) hit += is_hit(entry.second) ? 1 : 0;
  return fmt::format("{0}F:{1}\n{0}H:{2}\n", kind, entries.size(), hit);
}

std::string text_of(const FileCoverage& file) {
  std::string text;
  for (const auto& [name, function] : file.functions)
    text += fmt::format("FN:{},{}\n", function.line, name);
  for (const auto& [name, function] : file.functions)
    text += fmt::format("FNDA:{},{}\n", function.calls, name);
  text += found_and_hit("FN", file.functions, [](const auto& f) { return f.calls != 0; });
  std::size_t ways = 0, gone = 0;
  for (const auto& [decision, outcomes] : file.decisions) {
    const bool reached = outcomes.yes != 0 || outcomes.no != 0;
    unsigned way = 0;
    for (const uint64_t count : {outcomes.yes, outcomes.no}) {
      text += fmt::format("BRDA:{},{},{},{}\n", decision.line, decision.block, way++,
                          reached ? std::to_string(count) : "-");
      ++ways;
      gone += count != 0 ? 1 : 0;
    }
  }
  text += fmt::format("BRF:{}\nBRH:{}\n", ways, gone);
  for (const auto& [line, count] : file.lines) text += fmt::format("DA:{},{}\n", line, count);
  return text + found_and_hit("L", file.lines, [](uint64_t count) { return count != 0; });
}

/// The records of a file, one after the other.
class Reader {
 public:
  Reader(const std::string& path, std::string_view text) : path_(path), text_(text) {}

  Result<ProgramCoverage> read() {
    while (next_line()) {
      if (!take()) return wrong();
    }
    if (file_ != nullptr || coverage_.program.empty()) {
      ++number_;
      return wrong();
    }
    return std::move(coverage_);
  }

 private:
  bool next_line() {
    if (text_.empty()) return false;
    const std::size_t end = std::min(text_.find('\n'), text_.size());
    line_ = text_.substr(0, end);
    text_.remove_prefix(std::min(end + 1, text_.size()));
    ++number_;
    return true;
  }

  Error wrong() const {
    return Error{fmt::format(
        "{}:{}: is no line of a coverage file that capsoc wrote; name another file, or remove this "
        "one",
        path_, number_)};
  }

  bool starts(std::string_view record) {
    if (line_.substr(0, record.size()) != record) return false;
    line_.remove_prefix(record.size());
    return true;
  }

  /// The number in front of the next comma, or at the end.
  template <typename Number>
  bool number(Number& value) {
    const auto [end, error] = std::from_chars(line_.data(), line_.data() + line_.size(), value);
    if (error != std::errc()) return false;
    line_.remove_prefix(static_cast<std::size_t>(end - line_.data()));
    if (line_.empty()) return true;
    if (line_.front() != ',') return false;
    line_.remove_prefix(1);
    return true;
  }

  bool take() {
    if (starts("TN:")) {
      const std::string program(line_);
      if (program.empty()) return false;
      if (coverage_.program.empty()) coverage_.program = program;
      return file_ == nullptr && coverage_.program == program;
    }
    if (starts("SF:")) {
      if (file_ != nullptr || line_.empty() || coverage_.program.empty()) return false;
      const auto [place, added] = coverage_.files.try_emplace(std::string(line_));
      file_ = &place->second;
      return added;
    }
    if (file_ == nullptr) return false;
    if (line_ == "end_of_record") {
      file_ = nullptr;
      return true;
    }
    for (const char* sum_of : {"FNF:", "FNH:", "BRF:", "BRH:", "LF:", "LH:"})
      if (starts(sum_of)) return true;
    if (starts("FNDA:")) return take_calls();
    if (starts("FN:")) return take_function();
    if (starts("BRDA:")) return take_outcome();
    return starts("DA:") && take_count();
  }

  bool take_function() {
    FileCoverage::Function function;
    return number(function.line) && !line_.empty() &&
           file_->functions.try_emplace(std::string(line_), function).second;
  }
  bool take_calls() {
    uint64_t calls = 0;
    if (!number(calls)) return false;
    const auto function = file_->functions.find(std::string(line_));
    if (function == file_->functions.end()) return false;
    function->second.calls = calls;
    return true;
  }
  bool take_outcome() {
    FileCoverage::Decision decision;
    unsigned way = 0;
    if (!number(decision.line) || !number(decision.block) || !number(way) || way > 1) return false;
    FileCoverage::Outcomes& outcomes = file_->decisions[decision];
    if (line_ == "-") return true;
    return number(way == 0 ? outcomes.yes : outcomes.no) && line_.empty();
  }
  bool take_count() {
    unsigned line = 0;
    uint64_t count = 0;
    return number(line) && number(count) && line_.empty() &&
           file_->lines.try_emplace(line, count).second;
  }

  const std::string& path_;
  std::string_view text_, line_;
  std::size_t number_ = 0;
  ProgramCoverage coverage_;
  FileCoverage* file_ = nullptr;
};

}  // namespace

void ProgramCoverage::add(const ProgramCoverage& other) {
  for (const auto& [name, theirs] : other.files) {
    FileCoverage& file = files[name];
    for (const auto& [function, about] : theirs.functions) {
      FileCoverage::Function& mine = file.functions[function];
      mine = {about.line, sum(mine.calls, about.calls)};
    }
    for (const auto& [decision, outcomes] : theirs.decisions) {
      FileCoverage::Outcomes& mine = file.decisions[decision];
      mine = {sum(mine.yes, outcomes.yes), sum(mine.no, outcomes.no)};
    }
    for (const auto& [line, count] : theirs.lines) file.lines[line] = sum(file.lines[line], count);
  }
}

std::string to_lcov(const ProgramCoverage& coverage) {
  std::string text;
  for (const auto& [name, file] : coverage.files)
    text += fmt::format("TN:{}\nSF:{}\n{}end_of_record\n", coverage.program, name, text_of(file));
  return text;
}

Result<ProgramCoverage> parse_lcov(const std::string& path, const std::string& text) {
  return Reader(path, text).read();
}

}  // namespace capsoc::trace
