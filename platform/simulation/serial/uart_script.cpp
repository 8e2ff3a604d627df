#include "serial/uart_script.h"

#include <fmt/format.h>
#include <re2/re2.h>

#include <sstream>
#include <utility>

#include "base/input_file.h"
#include "base/printable.h"
#include "serial/script_time.h"

namespace capsoc::serial {
namespace {

constexpr uint64_t largest_uart_script = 16U << 20U;
constexpr const char* forms =
    "write at SECONDS, wait SECONDS, send \"TEXT\" or expect /REGEX/ [within SECONDS]";

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

/// The text up to the next unescaped `mark`; `rest` is what follows it. Escapes stay as they are.
std::optional<std::string> quoted(const std::string& text, char mark, std::string& rest) {
  if (text.empty() || text.front() != mark) return std::nullopt;
  for (std::size_t i = 1; i < text.size(); ++i) {
    if (text[i] == '\\') {
      ++i;
    } else if (text[i] == mark) {
      rest = trimmed(text.substr(i + 1));
      return text.substr(1, i - 1);
    }
  }
  return std::nullopt;
}

std::optional<char> byte_of(const std::string& digits) {
  if (digits.size() != 2 || digits.find_first_not_of("0123456789abcdefABCDEF") != std::string::npos)
    return std::nullopt;
  return static_cast<char>(std::stoul(digits, nullptr, 16));
}

std::optional<std::string> unescaped(const std::string& text) {
  static constexpr char names[] = "nrte\\\"0";
  static constexpr char bytes[] = "\n\r\t\x1b\\\"";
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '\\') {
      out += text[i];
      continue;
    }
    const char name = ++i < text.size() ? text[i] : '?';
    if (name == 'x') {
      const auto byte = byte_of(text.substr(i + 1, 2));
      if (!byte) return std::nullopt;
      out += *byte;
      i += 2;
      continue;
    }
    const std::size_t known = std::string_view(names, 7).find(name);
    if (known == std::string_view::npos) return std::nullopt;
    out += bytes[known];
  }
  return out;
}

/// `rest`: what stands after the step's word.
Result<UartStep> sending(const std::string& rest) {
  std::string behind;
  const auto text = quoted(rest, '"', behind);
  if (!text || !behind.empty()) return Error{"write send \"TEXT\""};
  auto bytes = unescaped(*text);
  if (!bytes) return Error{R"(knows \n \r \t \e \0 \\ \" and \x41 behind a backslash)"};
  UartStep step;
  step.kind = UartStep::Kind::send;
  step.text = std::move(*bytes);
  return step;
}

Result<UartStep> expecting(const std::string& rest) {
  std::string behind;
  const auto text = quoted(rest, '/', behind);
  UartStep step;
  step.kind = UartStep::Kind::expect;
  if (text && behind.rfind("within ", 0) == 0) {
    const auto limit = script_time(trimmed(behind.substr(7)));
    if (limit && *limit > 0) {
      step.picoseconds = *limit;
      behind.clear();
    }
  }
  if (!text || text->empty() || !behind.empty())
    return Error{"write expect /REGEX/, or expect /REGEX/ within SECONDS"};
  auto pattern = compile_pattern(*text);
  if (!pattern)
    return Error{
        fmt::format("/{}/ is no regular expression: {}", printable(*text, 80), pattern.error())};
  step.text = *text;
  step.expectation = std::move(pattern.value());
  return step;
}

Result<UartStep> step_of(const std::string& line) {
  const std::size_t blank = line.find_first_of(" \t");
  const std::string word = line.substr(0, blank);
  const std::string rest = blank == std::string::npos ? "" : trimmed(line.substr(blank));
  if (word == "send") return sending(rest);
  if (word == "expect") return expecting(rest);
  if (word != "at" && word != "wait") return Error{fmt::format("is no step; {}", forms)};
  const auto time = script_time(rest);
  if (!time) return Error{fmt::format("needs a time in seconds, 0 to 1e6: {} 0.5", word)};
  UartStep step;
  step.kind = word == "at" ? UartStep::Kind::at : UartStep::Kind::wait;
  step.picoseconds = *time;
  return step;
}

}  // namespace

Result<std::vector<UartStep>> parse_uart_script(const std::string& file, const std::string& text) {
  std::vector<UartStep> steps;
  std::istringstream lines{std::string(without_byte_order_mark(text))};
  unsigned number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    line = trimmed(line);
    if (line.empty() || line.front() == '#') continue;
    auto step = step_of(line);
    if (!step) return Error{fmt::format("{}:{}: {}", file, number, step.error())};
    step.value().line = number;
    steps.push_back(std::move(step.value()));
  }
  return steps;
}

Result<UartScript> UartScript::open(const std::string& file, const std::string& option) {
  const auto text = read_input(file, {"name a script for " + option, largest_uart_script, true});
  if (!text) return Error{text.error()};
  auto steps = parse_uart_script(file, text.value());
  if (!steps) return Error{steps.error()};
  return UartScript(file, std::move(steps.value()));
}

UartScript::UartScript(std::string file, std::vector<UartStep> steps)
    : file_(std::move(file)), steps_(std::move(steps)) {}

bool UartScript::sent(uint8_t byte, bool dry) {
  if (!waits()) return false;
  unheard_ += static_cast<char>(byte);
  if (unheard_.size() > most_unheard) unheard_.erase(0, most_unheard / 2);
  dry_ = dry;
  looks_ = looks_ || dry || byte == '\n';
  return looks_ && step().kind == UartStep::Kind::expect;
}

/// Looks at the lines of what was sent, and takes those up to the match.
bool UartScript::is_heard() {
  if (!std::exchange(looks_, false)) return false;
  LineWatch watch(Patterns{step().expectation, nullptr});
  for (std::size_t i = 0; i < unheard_.size(); ++i) {
    const bool last = i + 1 == unheard_.size();
    if (!watch.feed(static_cast<uint8_t>(unheard_[i]), last && dry_)) continue;
    unheard_.erase(0, i + 1);
    looks_ = !unheard_.empty();
    return true;
  }
  // Of lines that did not match, none is needed again.
  const std::size_t end = unheard_.rfind('\n');
  if (end != std::string::npos) unheard_.erase(0, end + 1);
  return false;
}

void UartScript::begin(uint64_t now) {
  begun_ = true;
  begun_at_ = now;
}

bool UartScript::is_due(uint64_t now) {
  switch (step().kind) {
    case UartStep::Kind::at:
      return now >= step().picoseconds;
    case UartStep::Kind::wait:
      return now - begun_at_ >= step().picoseconds;
    case UartStep::Kind::expect:
      if (is_heard()) return true;
      if (step().picoseconds != 0 && now - begun_at_ >= step().picoseconds)
        failure_ =
            fmt::format("{}:{}: no line matched /{}/ within {:g} s", file_, step().line,
                        printable(step().text, 80), static_cast<double>(step().picoseconds) / 1e12);
      return false;
    case UartStep::Kind::send:
      input_.erase(0, std::exchange(taken_, 0));
      input_ += step().text;
      return true;
  }
  return false;
}

void UartScript::play(uint64_t now) {
  while (waits() && failure_.empty()) {
    if (!begun_) begin(now);
    if (!is_due(now)) return;
    ++current_;
    begun_ = false;
    if (waits() && step().kind == UartStep::Kind::expect) looks_ = !unheard_.empty();
  }
}

std::optional<uint64_t> UartScript::next_time() const {
  if (!waits() || !begun_ || !failure_.empty()) return std::nullopt;
  if (step().kind == UartStep::Kind::at) return step().picoseconds;
  if (step().picoseconds == 0) return std::nullopt;
  return begun_at_ + step().picoseconds;
}

std::optional<uint8_t> UartScript::next_input() {
  if (!has_input()) return std::nullopt;
  return static_cast<uint8_t>(input_[taken_++]);
}

std::string UartScript::unfinished() const {
  if (!failure_.empty()) return failure_;
  if (!waits())
    return has_input() ? fmt::format("{}: the program did not take the last {} bytes", file_,
                                     input_.size() - taken_)
                       : "";
  std::string place = fmt::format("{}:{}: the run ended before ", file_, step().line);
  switch (step().kind) {
    case UartStep::Kind::expect:
      return place + fmt::format("a line matched /{}/", printable(step().text, 80));
    case UartStep::Kind::send:
      return place + "this was sent";
    case UartStep::Kind::at:
    case UartStep::Kind::wait:
      return place + "this time was over";
  }
  return place;
}

void UartScript::visit(Archive& archive) {
  std::size_t step = current_;
  archive("step", step);
  archive("begun", begun_);
  archive("begun_at", begun_at_);
  archive("unheard", unheard_);
  archive("dry", dry_);
  archive("looks", looks_);
  input_.erase(0, std::exchange(taken_, 0));
  archive("input", input_);
  archive("failure", failure_);
  if (!archive.loading()) return;
  if (steps_.empty()) {  // another run's script, which this one does not continue with
    unheard_.clear();
    input_.clear();
    failure_.clear();
  } else if (step > steps_.size()) {
    archive.refuse("is of a longer script");
  } else {
    current_ = step;
  }
}

}  // namespace capsoc::serial
