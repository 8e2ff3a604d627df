// Two systems in one SystemC kernel are to each other as if each were alone.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "../elsewhere.h"
#include "loader/elf_image.h"
#include "loader/program_file.h"
#include "soc/soc.h"

namespace capsoc::soc {
namespace {

using armv7m::EndReason;

struct Part {
  std::string program;
  uint64_t quantum_ns = 1'000'000;
  uint64_t hz = 25'000'000;
};

const sc_core::sc_time limit(2.5, sc_core::SC_SEC);

/// One SoC with a program; what of it can be compared, when it has ended or at the limit.
class Board {
 public:
  Board(const std::string& name, const Part& part, const std::function<void()>& ended)
      : soc_(name.c_str(), config(part)) {
    soc_.clock.set_frequency(part.hz);
    const auto image = loader::load_program(CAPSOC_PROGRAMS "/" + part.program + ".elf");
    if (image) load(part.program, image.value());
    if (!image) text_ = image.error();
    soc_.cpu.core().listeners().semihosting = [](armv7m::Core&) { return false; };
    printing_ =
        soc_.uart0.transmitted.listen([this](uint8_t byte) { text_ += static_cast<char>(byte); });
    soc_.cpu.on_end([this, ended](EndReason) {
      take_figures();
      ended();
    });
    soc_.cpu.set_pause(limit, [this, ended](const sc_core::sc_time&) {
      take_figures();
      ended();
      return sc_core::sc_max_time();
    });
  }

  const std::string& figures() const { return figures_; }

 private:
  void take_figures() {
    const armv7m::Core& core = soc_.cpu.core();
    figures_ =
        fmt::format("end {} at {}, {} cycles, {} instructions, UART: {}\n",
                    static_cast<int>(soc_.cpu.end_reason()), sc_core::sc_time_stamp().to_string(),
                    core.cycles(), core.instructions(), text_);
  }
  void load(const std::string& program, const loader::ElfImage& image) {
    for (const loader::Segment& segment : image.segments) {
      if (const auto error = soc_.load(program, segment.address, segment.bytes))
        text_ = error->text;
    }
  }
  static Config config(const Part& part) {
    Config config;
    config.quantum = sc_core::sc_time(static_cast<double>(part.quantum_ns), sc_core::SC_NS);
    return config;
  }

  Soc soc_;
  std::string text_, figures_;
  kit::Listening printing_;
};

/// The figures of all parts, simulated together.
std::string simulate(const std::vector<Part>& parts) {
  return test::elsewhere([&] {
    sc_core::sc_report_handler::set_actions(sc_core::SC_INFO, sc_core::SC_DO_NOTHING);
    std::vector<std::unique_ptr<Board>> boards;
    std::size_t running = parts.size();
    for (const Part& part : parts)
      boards.push_back(std::make_unique<Board>(fmt::format("soc_{}", boards.size()), part, [&] {
        if (--running == 0) sc_core::sc_stop();
      }));
    sc_core::sc_start();
    std::string said;
    for (const auto& board : boards) said += board->figures();
    return said;
  });
}

void expect_as_alone(const std::vector<Part>& parts) {
  std::string alone;
  for (const Part& part : parts) alone += simulate({part});
  EXPECT_EQ(simulate(parts), alone);
}

TEST(TwoSocs, AProgramAloneEnds) {
  const std::string said = simulate({{"hello"}});
  EXPECT_NE(said.find(fmt::format("end {} ", static_cast<int>(EndReason::exit))), std::string::npos)
      << said;
}

TEST(TwoSocs, RunTheSameProgramAsEachAlone) {
  expect_as_alone({{"hello"}, {"hello"}});
}

TEST(TwoSocs, RunOtherProgramsAsEachAlone) {
  expect_as_alone({{"bench_interrupts"}, {"hello"}, {"bench_tasks"}});
}

TEST(TwoSocs, KeepTheirOwnClocks) {
  expect_as_alone({{"bench_interrupts", 1'000'000, 25'000'000},
                   {"bench_interrupts", 1'000'000, 48'000'000},
                   {"bench_polling", 1'000'000, 33'333'333}});
}

TEST(TwoSocs, KeepTheirOwnQuanta) {
  const std::string quick =
      simulate({{"bench_polling", 1'000}, {"bench_interrupts", 1'000'000'000}});
  EXPECT_EQ(quick, simulate({{"bench_polling", 1'000'000}, {"bench_interrupts", 4'000}}));
  EXPECT_EQ(quick, simulate({{"bench_polling"}}) + simulate({{"bench_interrupts"}}));
}

TEST(TwoSocs, MayWaitAndSleepAtTheSameInstants) {
  for (const char* program : {"drivers", "selfcal", "exceptions", "idle"})
    expect_as_alone({{program}, {program}});
}

}  // namespace
}  // namespace capsoc::soc
