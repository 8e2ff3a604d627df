#include "trace/coverage.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <tuple>
#include <utility>

#include "cortex_m3/isa/decoder.h"
#include "host/files.h"
#include "host/sha256.h"
#include "support/input_file.h"

namespace capsoc::trace {
namespace {

constexpr uint64_t largest_file = 256U << 20U;
/// How often each byte of a program is looked at, far more than a sound one needs: a damaged one
/// may claim code without end.
constexpr uint64_t most_visits = 8;

using cortex_m3::DecodedOp;
using cortex_m3::ExecutionCounts;
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

/// True for the sources of a library that was compiled on another machine (newlib): genhtml stops
/// where it finds no source. So it is with lines whose file has lost its name.
bool is_elsewhere(const std::string& file) {
  std::error_code ignored;
  return file.empty() || file.rfind("../", 0) == 0 ||
         (file.rfind('/', 0) == 0 && !std::filesystem::exists(file, ignored));
}

/// Adds what one image's code came to.
class Collector {
 public:
  Collector(const soc::Soc& soc, const Counts& counts, const loader::ElfImage& image,
            const DebugInformation& information, ProgramCoverage& coverage)
      : soc_(soc), counts_(counts), image_(image), information_(information), coverage_(coverage) {
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
  FileCoverage& file(const std::string& name) { return coverage_.files[name]; }

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
      file(information_.files()[std::get<0>(key)]).lines[std::get<1>(key)] += count;
  }

  void add_function(const loader::Symbol& symbol) {
    const auto at = information_.line_at(symbol.address);
    if (!at) return;
    FileCoverage::Function& function = file(at->file).functions[symbol.name];
    if (function.line == 0) function.line = at->line;
    function.calls += counts_.begun(symbol.address);
  }

  std::optional<DecodedOp> decode(uint32_t address, uint8_t it) const {
    uint16_t first = 0, second = 0;
    const cortex_m3::Core& core = soc_.cpu.core();
    if (!core.debug_read(address, &first, 2)) return std::nullopt;
    if (cortex_m3::is_wide(first) && !core.debug_read(address + 2, &second, 2)) return std::nullopt;
    return cortex_m3::decode(address, first, second, it);
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
    using cortex_m3::Operation;
    const uint64_t begun = counts_.begun(op.address), skipped = counts_.skipped(op.address);
    if (op.operation == Operation::bcond || op.operation == Operation::cbz ||
        op.operation == Operation::cbnz) {
      const uint64_t taken = counts_.taken(op.address);
      add_outcomes(op.address, {taken, begun - skipped - taken});
    } else if (op.condition != cortex_m3::condition_always) {
      // THEN and ELSE have one condition, unless one of them sets the flags.
      if (!decided) add_outcomes(op.address, {begun - skipped, skipped});
      decided = !op.set_flags && !is(op, cortex_m3::kind::compare);
    }
  }

  void add_outcomes(uint32_t address, const FileCoverage::Outcomes& outcomes) {
    const auto at = information_.line_at(address);
    if (!at) return;
    unsigned& block = blocks_[{at->file, at->line}];
    file(at->file).decisions[{at->line, block++}] = outcomes;
  }

  const soc::Soc& soc_;
  const Counts& counts_;
  const loader::ElfImage& image_;
  const DebugInformation& information_;
  ProgramCoverage& coverage_;
  std::map<std::pair<std::string, unsigned>, unsigned> blocks_;
  uint64_t budget_ = 0;  ///< instructions that may still be looked at
};

}  // namespace

Result<std::unique_ptr<Coverage>> Coverage::attach(soc::Soc& soc, const source::Program& program,
                                                   const std::string& path) {
  bool has_lines = false;
  for (const auto& information : program.debug_information())
    has_lines = has_lines || information->has_lines();
  if (!has_lines)
    return Error{fmt::format("--coverage: {} has no lines of source; compile it with -g",
                             program.images().front()->path)};
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
  for (auto file = coverage.files.begin(); file != coverage.files.end();)
    file = is_elsewhere(file->first) ? coverage.files.erase(file) : std::next(file);
  return coverage;
}

std::optional<Error> Coverage::finish() {
  ProgramCoverage coverage = collect();
  coverage.add(earlier_);
  return host::write_whole(path_, to_lcov(coverage));
}

}  // namespace capsoc::trace
