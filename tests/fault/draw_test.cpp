// Faults drawn: each bit and each time as likely as another one, the same for the same seed.
#include "fault/draw.h"

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "inject/fault.h"

namespace capsoc::fault {
namespace {

/// Samples 1000, 1250, ... at 402 s, 403 s, ...
Golden golden() {
  Golden golden;
  for (uint64_t i = 0; i <= 8; ++i)
    golden.starts.push_back({(402 + i) * 1'000'000'000'000, 1000 + 250 * i});
  golden.places = {{"coprocessor.au", 48, "coprocessor"},
                   {"coprocessor.lock", 1, "coprocessor"},
                   {"cpu.r0", 32, "processor"},
                   {"rtl.u_a.b", 15, "rtl.u_a"}};
  return golden;
}

void set(TrialSettings& settings, const std::string& path, const std::string& value) {
  const auto error = settings.set(path, value, SettingSource::command_line, "the test");
  ASSERT_FALSE(error) << error->text;
}

TEST(Draw, EachBitIsAsLikelyAsAnotherOne) {
  const Golden without = golden();
  std::map<std::string, unsigned> places;
  std::map<unsigned, unsigned> bits;
  constexpr unsigned draws = 4900;
  for (unsigned seed = 0; seed < draws; ++seed) {
    TrialSettings settings;
    set(settings, "fault.seed", std::to_string(seed));
    const auto drawn = draw(settings, without);
    ASSERT_TRUE(drawn) << drawn.error();
    ++places[drawn.value().place];
    if (drawn.value().place == "coprocessor.au") ++bits[drawn.value().bit];
  }
  EXPECT_EQ(places.size(), 2u);  // no other unit
  EXPECT_NEAR(places["coprocessor.lock"], draws / 49, 40);
  EXPECT_EQ(bits.size(), 48u);
  for (const auto& [bit, hits] : bits) EXPECT_NEAR(hits, 100, 45) << bit;
}

TEST(Draw, ATimeHasTheStateBeforeIt) {
  const Golden without = golden();
  std::map<std::size_t, unsigned> starts;
  for (unsigned seed = 0; seed < 400; ++seed) {
    TrialSettings settings;
    set(settings, "fault.seed", std::to_string(seed));
    const auto drawn = draw(settings, without);
    ASSERT_TRUE(drawn) << drawn.error();
    const auto fault = inject::parse_fault(drawn.value().line);
    ASSERT_TRUE(fault) << fault.error();
    const uint64_t ps = fault.value().when.value;
    EXPECT_GE(ps, 402'000'000'000'000u);
    EXPECT_LT(ps, 410'000'000'000'000u);
    const std::size_t start = drawn.value().start;
    EXPECT_LT(without.starts[start].time_ps, ps);
    EXPECT_GE(without.starts[start + 1].time_ps, ps);
    ++starts[start];
  }
  EXPECT_EQ(starts.size(), 8u);
}

TEST(Draw, ASampleAndACycleOfThePipeline) {
  const Golden without = golden();
  std::map<uint64_t, unsigned> cycles;
  for (unsigned seed = 0; seed < 2000; ++seed) {
    TrialSettings settings;
    set(settings, "fault.seed", std::to_string(seed));
    set(settings, "fault.pipeline", "true");
    set(settings, "fault.units", "rtl.,processor");
    set(settings, "fault.kind", "stuck1");
    const auto drawn = draw(settings, without);
    ASSERT_TRUE(drawn) << drawn.error();
    const auto fault = inject::parse_fault(drawn.value().line);
    ASSERT_TRUE(fault) << fault.error();
    EXPECT_EQ(fault.value().kind, inject::Fault::Kind::stuck1);
    EXPECT_EQ(fault.value().when.unit, inject::When::Unit::sample);
    EXPECT_GT(fault.value().when.value, 1000u);
    EXPECT_LE(fault.value().when.value, 3001u);
    EXPECT_LT(without.starts[drawn.value().start].sample, fault.value().when.value);
    ++cycles[fault.value().when.cycles];
  }
  EXPECT_EQ(cycles.size(), 162u);
}

TEST(Draw, TheSameForTheSameSeed) {
  TrialSettings settings;
  set(settings, "fault.seed", "7");
  EXPECT_EQ(draw(settings, golden()).value().line, draw(settings, golden()).value().line);
  TrialSettings other;
  set(other, "fault.seed", "8");
  EXPECT_NE(draw(settings, golden()).value().line, draw(other, golden()).value().line);
}

TEST(Draw, OneThatIsGiven) {
  TrialSettings settings;
  set(settings, "fault.line", "flip  cpu.r0[5] at sample 1600 cycle 3");
  const auto drawn = draw(settings, golden());
  ASSERT_TRUE(drawn) << drawn.error();
  EXPECT_EQ(drawn.value().line, "flip cpu.r0[5] at sample 1600 cycle 3");
  EXPECT_EQ(drawn.value().unit, "processor");
  EXPECT_EQ(drawn.value().start, 2u);
}

TEST(Draw, Refusals) {
  TrialSettings settings;
  set(settings, "fault.units", "coprozessor");
  EXPECT_EQ(draw(settings, golden()).error(),
            "fault.units: no unit begins with 'coprozessor'; capsoc run --list-fault-places names "
            "them");
  set(settings, "fault.line", "flop cpu.r0[5] at 1s");
  EXPECT_NE(draw(settings, golden()).error().find("fault.line 'flop cpu.r0[5] at 1s': "),
            std::string::npos);
}

}  // namespace
}  // namespace capsoc::fault
