#include "trace/coverage.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "armv7m/isa/decoder.h"
#include "base/input_file.h"
#include "base/printable.h"
#include "host/files.h"
#include "host/sha256.h"
#include "loader/demangle.h"
#include "trace/source_paths.h"

namespace capsoc::trace {
namespace {

constexpr uint64_t largest_file = 256U << 20U;
/// How often each byte of a program is looked at, far more than a sound one needs: a damaged one
/// may claim code without end.
constexpr uint64_t most_visits = 8;

using armv7m::DecodedOp;
using armv7m::ExecutionCounts;
using source::DebugInformation;

/// What ExecutionCounts came to, by address.
class Counts {
 public:
  explicit Counts(const ExecutionCounts& counts) : pages_(counts.totals()) {}

  uint64_t begun(uint32_t address) const { return of(address, &ExecutionCounts::Totals::executed); }
  uint64_t skipped(uint32_t address) const {
    return of(address, &ExecutionCounts::Totals::skipped);
  }
  uint64_t taken(uint32_t address) const { return of(address, &ExecutionCounts::Totals::taken); }
  uint64_t executed(uint32_t address) const { return begun(address) - skipped(address); }

 private:
  using Array = std::array<uint64_t, ExecutionCounts::halfwords>;
  uint64_t of(uint32_t address, Array ExecutionCounts::Totals::*counts) const {
    const auto page = pages_.find(address >> ExecutionCounts::page_bits);
    if (page == pages_.end()) return 0;
    return (page->second.*counts)[address % (2 * ExecutionCounts::halfwords) / 2];
  }

  std::map<uint32_t, ExecutionCounts::Totals> pages_;
};

/// Where each file of an image's debug information is, "" for what is not here: genhtml stops where
/// it finds no source.
std::vector<std::string> paths_of(const loader::ElfImage& image,
                                  const DebugInformation& information) {
  const SourcePaths sources(image.path);
  std::vector<std::string> paths;
  for (const source::SourceFile& file : information.files())
    paths.push_back(sources.find(file).value_or(""));
  return paths;
}

/// Adds what one image's code came to.
class Collector {
 public:
  Collector(const soc::Soc& soc, const Counts& counts, const loader::ElfImage& image,
            const DebugInformation& information, ProgramCoverage& coverage)
      : soc_(soc),
        counts_(counts),
        image_(image),
        information_(information),
        paths_(paths_of(image, information)),
        coverage_(coverage) {
    for (const loader::Segment& segment : image.segments)
      budget_ += most_visits * segment.bytes.size();
  }

  void collect() {
    add_lines();
    for (const loader::Symbol& symbol : image_.symbols) {
      if (!symbol.is_code || symbol.size == 0) continue;
      add_function(symbol);
      add_decisions(symbol);
    }
  }

 private:
  /// Null: the file is not here.
  FileCoverage* file(unsigned index) {
    return paths_[index].empty() ? nullptr : &coverage_.files[paths_[index]];
  }

  /// Addresses that belong to a row of the line table.
  template <typename Visit>
  void each_row(Visit visit) const {
    const auto& rows = information_.rows();
    for (std::size_t i = 0; i + 1 < rows.size(); ++i)
      if (!rows[i].end && rows[i].line != 0) visit(rows[i], rows[i + 1].address);
  }

  void add_lines() {
    // Of each line in each function.
    std::map<std::tuple<unsigned, unsigned, const loader::Symbol*>, uint64_t> most;
    each_row([&](const DebugInformation::Row& row, uint32_t behind) {
      if (behind <= row.address) return;
      uint64_t& count = most[{row.file, row.line, image_.symbol_at(row.address)}];
      for (uint32_t at = row.address; at < behind && budget_ != 0; at += 2, --budget_)
        count = std::max(count, counts_.executed(at));
    });
    for (const auto& [key, count] : most)
      if (FileCoverage* const of = file(std::get<0>(key))) of->lines[std::get<1>(key)] += count;
  }

  void add_function(const loader::Symbol& symbol) {
    const auto* const at = information_.row_at(symbol.address);
    FileCoverage* const of = at == nullptr ? nullptr : file(at->file);
    if (of == nullptr) return;
    const std::string name = loader::demangled(symbol.name);
    // The symbols of one constructor have one name.
    if (!functions_.emplace(symbol.address, name).second) return;
    FileCoverage::Function& function = of->functions[name];
    if (function.line == 0) function.line = at->line;
    function.calls += counts_.begun(symbol.address);
  }

  std::optional<DecodedOp> decode(uint32_t address, uint8_t it) const {
    uint16_t first = 0, second = 0;
    const armv7m::Core& core = soc_.cpu.core();
    if (!core.debug_read(address, &first, 2)) return std::nullopt;
    if (armv7m::is_wide(first) && !core.debug_read(address + 2, &second, 2)) return std::nullopt;
    return armv7m::decode(address, first, second, it);
  }

  void add_decisions(const loader::Symbol& symbol) {
    uint8_t it = 0;
    bool decided = false;  // the present condition of an IT block
    uint32_t at = symbol.address;
    for (; at - symbol.address < symbol.size && budget_ != 0; --budget_) {
      if (!image_.is_code(at)) {
        at += 2;
        it = 0;
        continue;
      }
      const auto op = decode(at, it);
      if (!op) return;
      if (op->it_before == 0) decided = false;
      add_decision(*op, decided);
      it = op->it_after;
      at = next_address(*op);
    }
  }

  void add_decision(const DecodedOp& op, bool& decided) {
    using armv7m::Operation;
    const uint64_t begun = counts_.begun(op.address), skipped = counts_.skipped(op.address);
    if (op.operation == Operation::bcond || op.operation == Operation::cbz ||
        op.operation == Operation::cbnz) {
      const uint64_t taken = counts_.taken(op.address);
      add_outcomes(op.address, {taken, begun - skipped - taken});
    } else if (op.condition != armv7m::condition_always) {
      // THEN and ELSE have one condition, unless one of them sets the flags.
      if (!decided) add_outcomes(op.address, {begun - skipped, skipped});
      decided = !op.set_flags && !is(op, armv7m::kind::compare);
    }
  }

  void add_outcomes(uint32_t address, const FileCoverage::Outcomes& outcomes) {
    const auto* const at = information_.row_at(address);
    FileCoverage* const of = at == nullptr ? nullptr : file(at->file);
    if (of == nullptr) return;
    unsigned& block = blocks_[{paths_[at->file], at->line}];
    of->decisions[{at->line, block++}] = outcomes;
  }

  const soc::Soc& soc_;
  const Counts& counts_;
  const loader::ElfImage& image_;
  const DebugInformation& information_;
  const std::vector<std::string> paths_;  ///< by the file's index
  ProgramCoverage& coverage_;
  std::set<std::pair<uint32_t, std::string>> functions_;  ///< those added, by address and name
  std::map<std::pair<std::string, unsigned>, unsigned> blocks_;
  uint64_t budget_ = 0;  ///< instructions that may still be looked at
};

/// An Error: there is no source of the program on this machine.
std::optional<Error> refuse_missing_sources(const source::Program& program) {
  std::size_t count = 0;
  std::string first;
  for (std::size_t i = 0; i < program.images().size(); ++i) {
    const DebugInformation& information = *program.debug_information()[i];
    for (const std::string& path : paths_of(*program.images()[i], information))
      if (!path.empty()) return std::nullopt;
    count += information.files().size();
    for (const source::SourceFile& file : information.files())
      if (first.empty()) first = file.name;
  }
  return Error{fmt::format(
      "--coverage: {}: none of its {} source files is on this machine (the first: {}); run it "
      "where they are, or compile it without a prefix map",
      program.images().front()->path, count, printable(first, 200))};
}

}  // namespace

Result<std::unique_ptr<Coverage>> Coverage::attach(soc::Soc& soc, const source::Program& program,
                                                   const std::string& path) {
  bool has_lines = false;
  for (const auto& information : program.debug_information())
    has_lines = has_lines || information->has_lines();
  if (!has_lines)
    return Error{fmt::format("--coverage: {} has no lines of source; compile it with -g",
                             program.images().front()->path)};
  if (auto error = refuse_missing_sources(program)) return *error;
  std::unique_ptr<Coverage> coverage(new Coverage(soc, program, path));
  if (auto error = host::check_writable(path)) return *error;
  if (auto error = coverage->read_earlier()) return *error;
  soc.cpu.core().count_executions(&coverage->counts_);
  return coverage;
}

Coverage::~Coverage() {
  soc_.cpu.core().count_executions(nullptr);
}

std::optional<Error> Coverage::read_earlier() {
  std::string digests;
  for (const loader::ElfImage* image : program_.images())
    if (image->file != nullptr) digests += host::sha256_of(*image->file);
  const std::string program = "capsoc_" + host::sha256_of(digests).substr(0, 32);
  earlier_.program = program;
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path_, ignored)) return std::nullopt;
  const auto text =
      read_input(path_, {"name another file, or remove this one", largest_file, true});
  if (!text) return Error{text.error()};
  if (text.value().empty()) return std::nullopt;
  auto earlier = parse_lcov(path_, text.value());
  if (!earlier) return Error{earlier.error()};
  if (earlier.value().program != program)
    return Error{fmt::format(
        "{}: is the coverage of another program than {}, or of another build of it; name another "
        "file, or remove this one (lcov -a adds files of several programs)",
        path_, program_.images().front()->path)};
  earlier_ = std::move(earlier.value());
  return std::nullopt;
}

ProgramCoverage Coverage::collect() const {
  ProgramCoverage coverage;
  coverage.program = earlier_.program;
  const Counts counts(counts_);
  for (std::size_t i = 0; i < program_.images().size(); ++i)
    Collector(soc_, counts, *program_.images()[i], *program_.debug_information()[i], coverage)
        .collect();
  return coverage;
}

std::optional<Error> Coverage::finish() {
  ProgramCoverage coverage = collect();
  coverage.add(earlier_);
  return host::write_whole(path_, to_lcov(coverage));
}

}  // namespace capsoc::trace
