// Writes down what the regression's scenarios do to the coprocessor and what it answers, as text
// for check_answers.py. Of the model, or with --rtl-library of the RTL.
//
// One line each, numbers in hexadecimal except edges; a run is one scenario on its own device:
// capsoc-answers 2
//   run ARITHMETIC OPERAND_BITS REFERENCE_LEAD STEP_SHIFT PLAIN_ARCTANGENT ITERATION_CLOCKS
//   SCENARIO SEED  (decimal) s EDGE U V CLIP LATCHED      a sample of the ADC stream w EDGE OFFSET
//   VALUE OK       a bus write; OK 0: PSLVERR r EDGE OFFSET VALUE OK       a bus read d EDGE OFFSET
//   VALUE OK       a debugger's read x EDGE                       the reset pin l EDGE INTERRUPT
//   BUSY        levels from this edge on, where they differ from those before k EDGE WORD... a
//   commit: every register in the order of its offset, as a debugger sees it e EDGE the end of the
//   run
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "capsoc_registers.h"
#include "coprocessor/coprocessor.h"
#include "regress/bench.h"
#include "regress/scenario.h"
#include "rtl/coprocessor_rtl.h"

namespace {

using namespace capsoc;
using coprocessor::Device;
using coprocessor::RegisterAccess;

struct Arguments {
  std::string arithmetic = "precise", library, output;
  std::vector<std::string> scenarios, without;
  coprocessor::Options options;
  uint64_t first_seed = 1, seeds = 1;
  regress::Budget budget{2000, 2000};
};

/// A device, with everything it is asked and answers written down.
class Recorder final : public Device {
 public:
  Recorder(std::unique_ptr<Device> device, std::FILE* file)
      : device_(std::move(device)), file_(file) {}

  void reset() override {
    device_->reset();
    line("x {}\n", edge_);
  }
  // Edge by edge while anything can change, so that every change of a level has its edge.
  void advance(uint64_t cycle) override {
    while (edge_ < cycle) {
      close();
      edge_ = busy_ ? edge_ + 1 : cycle;
      device_->advance(edge_);
    }
  }
  bool submit(uint64_t cycle, int32_t u, int32_t v, bool clip) override {
    advance(cycle);
    const bool latched = device_->submit(cycle, u, v, clip);
    line("s {} {:x} {:x} {:d} {:d}\n", cycle, static_cast<uint32_t>(u), static_cast<uint32_t>(v),
         clip, latched);
    return latched;
  }
  RegisterAccess read(uint64_t cycle, uint32_t offset, bool debug) override {
    advance(cycle);
    const RegisterAccess access = device_->read(cycle, offset, debug);
    line("{} {} {:x} {:x} {:d}\n", debug ? 'd' : 'r', cycle, offset, access.value, access.ok);
    return access;
  }
  bool write(uint64_t cycle, uint32_t offset, uint32_t value) override {
    advance(cycle);
    const bool ok = device_->write(cycle, offset, value);
    line("w {} {:x} {:x} {:d}\n", cycle, offset, value, ok);
    return ok;
  }
  std::optional<uint64_t> next_event() const override { return device_->next_event(); }
  bool interrupt() const override { return device_->interrupt(); }
  bool idle() const override { return device_->idle(); }
  const coprocessor::Nodes& nodes() const override { return device_->nodes(); }
  unsigned tick() const override { return device_->tick(); }

  void end() {
    close();
    line("e {}\n", edge_);
  }

 private:
  template <typename... Args>
  void line(const char* format, Args... args) {
    fmt::print(file_, fmt::runtime(format), args...);
  }
  // What the present edge has left is complete.
  void close() {
    const bool interrupt = device_->interrupt(), busy = !device_->idle();
    if (interrupt != interrupt_ || busy != busy_) line("l {} {:d} {:d}\n", edge_, interrupt, busy);
    interrupt_ = interrupt;
    busy_ = busy;
    if (device_->nodes().commits == commits_) return;
    commits_ = device_->nodes().commits;
    line("k {}", edge_);
    for (const auto& entry : registers::coprocessor::table)
      line(" {:x}", device_->read(edge_, entry.offset, true).value);
    line("\n");
  }

  std::unique_ptr<Device> device_;
  std::FILE* file_;
  uint64_t edge_ = 0, commits_ = 0;
  bool interrupt_ = false, busy_ = false;
};

bool contains(const std::vector<std::string>& names, const char* name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

void record(const Arguments& a, const regress::Scenario& scenario, uint64_t seed,
            std::unique_ptr<Device> device, std::FILE* file) {
  const auto& o = a.options;
  fmt::print(file, "run {} {} {} {} {:d} {} {} {}\n", a.arithmetic, o.paper_operand_bits,
             o.paper_reference_lead, o.paper_step_shift, o.paper_plain_arctangent,
             o.paper_iteration_clocks, scenario.name, seed);
  Recorder recorder(std::move(device), file);
  regress::Coverage coverage(o.arithmetic);
  regress::Bench bench(recorder, o.arithmetic, coverage, [] { return false; });
  Random random(seed, static_cast<uint64_t>(&scenario - regress::scenarios().data()));
  scenario.run(bench, random,
               {a.budget.samples * scenario.sample_share / 1000,
                a.budget.accesses * scenario.access_share / 1000});
  bench.drain();
  bench.wait(2);
  recorder.end();
}

int record_all(const Arguments& a, std::FILE* file) {
  rtl::RtlLibrary::Handle library;
  if (!a.library.empty()) {
    auto opened = rtl::RtlLibrary::open(a.library, a.options);
    if (!opened) {
      fmt::print(stderr, "record_answers: {}\n", opened.error());
      return 2;
    }
    library = opened.value();
  }
  fmt::print(file, "capsoc-answers 2\n");
  for (const regress::Scenario& scenario : regress::scenarios()) {
    if (!a.scenarios.empty() && !contains(a.scenarios, scenario.name)) continue;
    if (contains(a.without, scenario.name)) continue;
    for (uint64_t i = 0; i < a.seeds; ++i) {
      std::unique_ptr<Device> device;
      if (library != nullptr)
        device = std::make_unique<rtl::CoprocessorRtl>(library);
      else
        device = std::make_unique<coprocessor::Coprocessor>(a.options);
      record(a, scenario, a.first_seed + i, std::move(device), file);
    }
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments a;
  std::vector<std::string> names;
  for (const regress::Scenario& scenario : regress::scenarios()) names.emplace_back(scenario.name);
  CLI::App app("Writes down what the regression asks of the coprocessor and what it answers");
  app.add_option("output", a.output, "File; -: standard output")->required();
  app.add_option("--arithmetic", a.arithmetic)->check(CLI::IsMember({"precise", "paper"}));
  app.add_option("--scenario", a.scenarios, "Only these")->check(CLI::IsMember(names));
  app.add_option("--without", a.without, "All but these")->check(CLI::IsMember(names));
  app.add_option("--first-seed", a.first_seed)->capture_default_str();
  app.add_option("--seeds", a.seeds)->capture_default_str();
  app.add_option("--samples", a.budget.samples, "Of all random scenarios, for each seed")
      ->capture_default_str();
  app.add_option("--accesses", a.budget.accesses, "Of all random scenarios, for each seed")
      ->capture_default_str();
  app.add_option("--rtl-library", a.library, "The Verilated coprocessor in place of the model");
  app.add_option("--operand-bits", a.options.paper_operand_bits)->check(CLI::Range(2, 32));
  app.add_option("--reference-lead", a.options.paper_reference_lead);
  app.add_option("--step-shift", a.options.paper_step_shift)->check(CLI::Range(0, 31));
  app.add_flag("--plain-arctangent", a.options.paper_plain_arctangent);
  app.add_option("--iteration-clocks", a.options.paper_iteration_clocks)->check(CLI::Range(1, 2));
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  if (a.arithmetic == "paper") a.options.arithmetic = coprocessor::Arithmetic::paper;
  std::FILE* file = a.output == "-" ? stdout : std::fopen(a.output.c_str(), "w");
  if (file == nullptr) {
    fmt::print(stderr, "record_answers: {} cannot be written\n", a.output);
    return 2;
  }
  const int code = record_all(a, file);
  const bool written = std::fflush(file) == 0 && std::ferror(file) == 0;
  if (!written) fmt::print(stderr, "record_answers: {} could not be written\n", a.output);
  return code != 0 ? code : written ? 0 : 2;
}
