#include "reproduce/synthesis.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>

#include "base/input_file.h"

namespace capsoc::reproduce {
namespace {

using nlohmann::json;

constexpr uint64_t largest_file = 1U << 24U;
constexpr double paper_alms = 12192, paper_registers = 7106, paper_dsp_blocks = 125;

Error not_a_synthesis(const std::string& path, const std::string& what) {
  return Error{fmt::format("{}: {}; write the file with scripts/tool synth --json", path, what)};
}

/// A member that is a number of 0 or more.
std::optional<double> number_in(const json& object, const char* name) {
  const auto found = object.find(name);
  if (found == object.end() || !found->is_number()) return std::nullopt;
  const double value = found->get<double>();
  return value >= 0 ? std::optional(value) : std::nullopt;
}

std::optional<Area> area_of(const json& result) {
  if (!result.is_object()) return std::nullopt;
  const auto cells = result.find("area");
  if (cells == result.end() || !cells->is_object()) return std::nullopt;
  const auto alms = number_in(*cells, "alm"), registers = number_in(*cells, "registers"),
             dsp_blocks = number_in(*cells, "dsp");
  if (!alms || !registers || !dsp_blocks) return std::nullopt;
  Area area{*alms, *registers, *dsp_blocks, {}, {}};
  const auto range = result.find("f_max_mhz");
  const bool two = range != result.end() && range->is_array() && range->size() == 2 &&
                   (*range)[0].is_number() && (*range)[1].is_number();
  if (two) {
    area.slowest_mhz = (*range)[0].get<double>();
    area.fastest_mhz = (*range)[1].get<double>();
  }
  return area;
}

/// The limits that scripts/tool synth holds `precise` to: a third, a half and a tenth of the
/// paper's.
void precise_rows(Report& report, const Area& area) {
  const auto row = [&](const char* name, double paper, double here, double part,
                       const char* reason) {
    report.known(fmt::format("{}, precise", name), fixed(paper, 0), fixed(here, 0),
                 Bound::at_most(std::floor(paper * part)), reason);
  };
  row("ALMs", paper_alms, area.alms, 1.0 / 3,
      "one multiplier in turns and CORDICs instead of loops of multipliers; an estimate of yosys.");
  row("registers", paper_registers, area.registers, 0.5, "the same, five ticks deep.");
  row("DSP blocks", paper_dsp_blocks, area.dsp_blocks, 0.1, "the same.");
}

void paper_rows(Report& report, const char* arithmetic, const Area& area) {
  const auto row = [&](const char* name, double paper, double here) {
    report.row(fmt::format("{}, {}", name, arithmetic), fixed(paper, 0), fixed(here, 0),
               lies_in(fixed(here, 0), Bound::at_most(paper)));
  };
  row("ALMs", paper_alms, area.alms);
  row("registers", paper_registers, area.registers);
  row("DSP blocks", paper_dsp_blocks, area.dsp_blocks);
}

void frequency_row(Report& report, const char* arithmetic, const Area& area, const Bound& bound,
                   const char* reason) {
  if (!area.slowest_mhz || !area.fastest_mhz) return;
  report.known(fmt::format("largest frequency, {}, MHz", arithmetic), "70",
               {fmt::format("{:.1f} .. {:.1f}", *area.slowest_mhz, *area.fastest_mhz),
                *area.slowest_mhz, *area.fastest_mhz},
               bound, reason);
}

}  // namespace

Result<Synthesis> read_synthesis(const std::string& path) {
  const auto read =
      read_input(path, {"name a file that scripts/tool synth --json wrote", largest_file});
  if (!read) return Error{read.error()};
  const json parsed = json::parse(read.value(), nullptr, false);
  if (!parsed.is_object()) return not_a_synthesis(path, "is not a JSON object");
  if (const auto channels = parsed.find("channels"); channels != parsed.end() && *channels != 1)
    return not_a_synthesis(path, "is of several channels, where the paper has one sensor");
  Synthesis synthesis;
  for (const char* arithmetic : {"precise", "paper", "two-clocks"}) {
    const auto found = parsed.find(arithmetic);
    if (found == parsed.end()) continue;
    const auto area = area_of(*found);
    if (!area)
      return not_a_synthesis(
          path, fmt::format("{}.area has no numbers alm, registers and dsp", arithmetic));
    synthesis[arithmetic] = *area;
  }
  if (synthesis.empty())
    return not_a_synthesis(path, "has neither precise nor paper nor two-clocks");
  return synthesis;
}

void table_7(Report& report, const Synthesis& synthesis) {
  if (!report.wants({"7"})) return;
  report.heading("7");
  if (synthesis.empty()) {
    report.stated("ALMs", fixed(paper_alms, 0), "-");
    report.stated("registers", fixed(paper_registers, 0), "-");
    report.stated("DSP blocks", fixed(paper_dsp_blocks, 0), "-");
    report.sentence("Ours: scripts/tool synth --json FILE (minutes), then --synthesis FILE.");
  }
  if (const auto precise = synthesis.find("precise"); precise != synthesis.end()) {
    precise_rows(report, precise->second);
    frequency_row(report, "precise", precise->second, {25, 70},
                  "the paper's is a timing tool's estimate of the system; ours must hold its 25.");
  }
  if (const auto paper = synthesis.find("paper"); paper != synthesis.end()) {
    paper_rows(report, "paper", paper->second);
    frequency_row(report, "paper", paper->second, {10, 25},
                  "Eq (11) goes through table, product and gain in one clock, and its next turn "
                  "needs the result.");
  }
  if (const auto two = synthesis.find("two-clocks"); two != synthesis.end()) {
    paper_rows(report, "paper in two clocks", two->second);
    frequency_row(report, "paper in two clocks", two->second, {25, 70},
                  "the table has one of the two clocks, product and gain the other; the paper's 25 "
                  "must hold.");
  }
  report.stated("pins", "233", "-");
  report.stated("thermal power, mW", "361.875", "-");
  report.sentence("Pins are the board's, and the power is a tool's estimate that we do not have.");
}

}  // namespace capsoc::reproduce
