// A run in pieces is the run in one piece. Each simulation has its own process: SystemC's
// kernel cannot be started twice.
#include "session/simulation.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/time.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include "../elsewhere.h"
#include "capsoc_registers.h"
#include "session/run_settings.h"

namespace capsoc::run {
namespace {

using sc_core::sc_time;
using test::elsewhere;

const std::vector<std::string> short_selfcal = {
    std::string("firmware.elf=") + SELFCAL_ELF, "program.demodulation_samples=900",
    "program.calibration_samples=100", "uart0.backend=null", "log.level=off"};

std::string figures(const RunResult& r) {
  return fmt::format("{} {} {} {} {} {} {} {}", r.code, r.reason, r.cycles, r.instructions,
                     r.samples, r.simulated_s, r.uart0_sha256,
                     r.errors.calibration_mode_max.value_or(-1));
}

/// `drive` moves the simulation on; what it returns comes before the figures of the whole run.
std::string simulate(const std::vector<std::string>& assignments,
                     const std::function<std::string(Simulation&)>& drive) {
  return elsewhere([&] {
    RunSettings settings;
    for (const std::string& assignment : assignments)
      if (const auto error = settings.set_assignment(assignment)) return error->text;
    auto made = Simulation::construct(settings);
    if (!made) return made.error();
    Simulation& simulation = *made.value();
    const std::string said = drive(simulation);
    if (const auto error = simulation.advance_to_end()) return error->text;
    return said + figures(simulation.finish());
  });
}

std::string whole(const std::vector<std::string>& assignments) {
  return simulate(assignments, [](Simulation&) { return std::string(); });
}

TEST(Simulation, PiecesMakeTheWhole) {
  const std::string expected = whole(short_selfcal);
  ASSERT_NE(expected.find("the firmware ended with status"), std::string::npos) << expected;
  EXPECT_EQ(simulate(short_selfcal,
                     [](Simulation& simulation) -> std::string {
                       sc_time next(0.7, sc_core::SC_MS);
                       while (simulation.advance_to(next).value()) {
                         const sc_time late = sc_core::sc_time_stamp() - next;
                         if (late > sc_time(1, sc_core::SC_US)) return "late ";
                         next += sc_time(31.7, sc_core::SC_MS);
                       }
                       return next > sc_time(3, sc_core::SC_SEC) ? "" : "short ";
                     }),
            expected);
}

Simulation* interrupted = nullptr;

/// Interrupts a simulation by the host's clock, a thousand times and more.
class HostClock {
 public:
  explicit HostClock(Simulation& simulation) {
    interrupted = &simulation;
    std::signal(SIGALRM, [](int) { interrupted->interrupt(); });
    set(50);
  }
  ~HostClock() { set(0); }
  HostClock(const HostClock&) = delete;
  HostClock& operator=(const HostClock&) = delete;

 private:
  static void set(int microseconds) {
    const itimerval every{{0, microseconds}, {0, microseconds}};
    setitimer(ITIMER_REAL, &every, nullptr);
  }
};

/// Whatever the two are at.
TEST(Simulation, AnInterruptionFindsTheCoreAndTheKernelAtOneInstant) {
  std::vector<std::string> settings = short_selfcal;
  settings[1] = "program.demodulation_samples=40000";
  const auto drive = [](Simulation& simulation) -> std::string {
    const HostClock clock(simulation);
    unsigned stops = 0;
    while (simulation.advance_to(sc_core::sc_max_time()).value()) {
      soc::Soc& soc = simulation.soc();
      const sc_time core = soc.clock.time_of(soc.cpu.core().cycles());
      if (core > sc_core::sc_time_stamp())
        return fmt::format("core at {} s, kernel at {} s\n", core.to_seconds(),
                           sc_core::sc_time_stamp().to_seconds());
      ++stops;
    }
    return stops > 100 ? "" : fmt::format("{} stops\n", stops);
  };
  EXPECT_EQ(simulate(settings, drive), whole(settings));
}

TEST(Simulation, WhatIsSavedBetweenPiecesGoesOn) {
  const std::string file =
      (std::filesystem::temp_directory_path() / fmt::format("capsoc-pieces-{}", getpid())).string();
  const std::string expected = whole(short_selfcal);
  EXPECT_EQ(simulate(short_selfcal,
                     [&](Simulation& simulation) -> std::string {
                       if (!simulation.save(file)) return "saved before the start ";
                       if (!simulation.advance_to(sc_time(1.2345, sc_core::SC_SEC)).value())
                         return "over ";
                       if (!simulation.advance_to(sc_core::SC_ZERO_TIME).value()) return "over ";
                       const auto error = simulation.save(file);
                       return error ? error->text : "";
                     }),
            expected);
  std::vector<std::string> restored = short_selfcal;
  restored.push_back("checkpoint.restore=" + file);
  EXPECT_EQ(whole(restored), expected);
  std::filesystem::remove(file);
}

TEST(Simulation, NothingGoesOnBehindTheEnd) {
  const std::string said = simulate(short_selfcal, [](Simulation& simulation) -> std::string {
    if (simulation.advance_to(sc_time(100, sc_core::SC_SEC)).value()) return "more ";
    if (simulation.advance_to(sc_time(200, sc_core::SC_SEC)).value()) return "more ";
    return simulation.save("never-written.capsoc") ? "" : "saved ";
  });
  EXPECT_EQ(said, whole(short_selfcal));
  EXPECT_FALSE(std::filesystem::exists("never-written.capsoc"));
}

TEST(Simulation, ALimitEndsAPiece) {
  std::vector<std::string> limited = short_selfcal;
  limited.emplace_back("run.simlimit_s=0.5");
  const std::string expected = whole(limited);
  EXPECT_EQ(expected.rfind("124 ", 0), 0U) << expected;
  EXPECT_EQ(simulate(limited,
                     [](Simulation& simulation) -> std::string {
                       if (!simulation.advance_to(sc_time(0.4, sc_core::SC_SEC)).value())
                         return "early ";
                       return simulation.advance_to(sc_time(1, sc_core::SC_SEC)).value() ? "more "
                                                                                         : "";
                     }),
            expected);
}

/// A soft reset while a sample is on its way, then the control register as it was; returns the
/// sample's index. "": there was none.
std::string lose_a_sample(Simulation& simulation) {
  namespace registers = capsoc::registers::coprocessor;
  soc::Soc& soc = simulation.soc();
  sc_time next(1, sc_core::SC_SEC);
  for (int steps = 0; steps < 10000 && simulation.advance_to(next).value(); ++steps) {
    coprocessor::Device& device = soc.coprocessor.device();
    if (!device.idle()) {
      const uint64_t edge = soc.clock.cycles_at(sc_core::sc_time_stamp()) + 4;
      const uint32_t control = device.read(edge, registers::CTRL_offset, true).value;
      device.write(edge + 1, registers::CTRL_offset, registers::CTRL_SRST_mask);
      device.write(edge + 2, registers::CTRL_offset, control);
      return std::to_string(soc.adc.count.get() - 1);
    }
    next = sc_core::sc_time_stamp() + sc_time(2, sc_core::SC_US);
  }
  return "";
}

/// The index of each row of a CSV that ends in an empty cell, with a blank.
std::string rows_without_result(const std::string& file) {
  std::ifstream lines(file);
  std::string line, found;
  int row = -2;  // a comment and the heading
  while (std::getline(lines, line)) {
    if (row >= 0 && !line.empty() && line.back() == ',') found += std::to_string(row) + " ";
    ++row;
  }
  return found;
}

TEST(Simulation, EqualSamplesHaveTheirOwnResults) {
  const std::string stem =
      (std::filesystem::temp_directory_path() / fmt::format("capsoc-equal-{}", getpid())).string();
  {
    std::ofstream sensor(stem + "-sensor.csv");
    sensor << "u,v\n";
    for (int row = 0; row < 2000; ++row) sensor << "0.5,0.25\n";
  }
  std::vector<std::string> recorded = short_selfcal;
  recorded.push_back("sensor.file=" + stem + "-sensor.csv");
  recorded.push_back("results.record=" + stem + ".csv");
  recorded.emplace_back("results.record_columns=u,status");
  recorded.emplace_back("run.simlimit_s=3");
  const std::string said =
      simulate(recorded, [](Simulation& simulation) { return lose_a_sample(simulation) + " "; });
  const std::string lost = said.substr(0, said.find(' ') + 1);
  EXPECT_GT(lost.size(), 1U);
  EXPECT_EQ(rows_without_result(stem + ".csv"), lost) << said;
  std::filesystem::remove(stem + "-sensor.csv");
  std::filesystem::remove(stem + ".csv");
}

TEST(Simulation, AWrongInputIsSaidBeforeAnythingRuns) {
  std::vector<std::string> wrong = short_selfcal;
  wrong.emplace_back("results.record_columns=nothing");
  EXPECT_NE(whole(wrong).find("--record-columns"), std::string::npos);
  wrong.back() = "checkpoint.restore=no-such-file";
  EXPECT_NE(whole(wrong).find("no-such-file"), std::string::npos);
}

}  // namespace
}  // namespace capsoc::run
