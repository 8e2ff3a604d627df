// Register semantics: docs/reference/coprocessor.md, "Registers".
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <utility>

#include "bench.h"

namespace capsoc::coprocessor::test {
namespace {

class Registers : public testing::Test {
 protected:
  uint32_t read(uint32_t offset) { return dut.read(cycle, offset, false).value; }
  bool write(uint32_t offset, uint32_t value) { return dut.write(cycle, offset, value); }
  void soft_sample(int32_t u, int32_t v) {
    cycle += 1000;
    write(reg_soft_u, static_cast<uint32_t>(u));
    write(reg_soft_v, static_cast<uint32_t>(v));
    cycle += latency_cycles;
    dut.advance(cycle);
  }

  Coprocessor dut{Options{}};
  uint64_t cycle = 0;
};

TEST_F(Registers, HaveTheirResetValues) {
  EXPECT_EQ(read(reg_id), 0x43415053u);
  EXPECT_EQ(read(reg_version), 0x00010005u);
  for (uint32_t r = reg_step_au; r <= reg_step_cv; r += 4) EXPECT_EQ(read(r), 1349307u);
  EXPECT_EQ(read(reg_loop), 0xA04u);
  EXPECT_EQ(read(reg_lock_threshold), 1u << 21);
  EXPECT_EQ(read(reg_diverge_threshold), 1u << 29);
  EXPECT_EQ(read(reg_au_lo + 4), 1u << 30);
  EXPECT_EQ(read(reg_au_lo + 0x24), 1u << 30);
  EXPECT_EQ(read(reg_a1), 1u << 30);
  EXPECT_EQ(read(reg_latency), 161u);
  for (uint32_t r :
       {reg_ctrl, reg_status, reg_flags, reg_cmd, reg_safety, reg_freq_hi, reg_phase_hi,
        reg_error_average, reg_b1, reg_beta, reg_phi, reg_angle, reg_samples})
    EXPECT_EQ(read(r), 0u) << r;
}

TEST_F(Registers, AreMappedAsListedAndNowhereElse) {
  std::set<uint32_t> mapped;
  for (uint32_t r = 0x000; r <= 0x09C; r += 4) mapped.insert(r);
  for (uint32_t r = 0x0AC; r <= 0x0E4; r += 4) mapped.insert(r);
  for (uint32_t r = 0x0EC; r <= 0x0FC; r += 4) mapped.insert(r);
  mapped.insert({0x0A0u, 0x0A4u, 0x0A8u});
  for (uint32_t r = 0; r < 0x1000; ++r) {
    EXPECT_EQ(dut.read(0, r, false).ok, mapped.count(r) != 0) << r;
    EXPECT_EQ(dut.read(0, r, true).ok, mapped.count(r) != 0) << r;
    EXPECT_EQ(dut.write(0, r, 0), mapped.count(r) != 0) << r;
  }
}

TEST_F(Registers, ReadOnlyOnesIgnoreWritesAndSaySo) {
  for (uint32_t r : {reg_id, reg_version, reg_status, reg_error_average, reg_raw_u, reg_angle,
                     reg_samples, reg_latency}) {
    const uint32_t before = read(r);
    EXPECT_TRUE(write(r, ~before));
    EXPECT_FALSE(write_complaint(r, ~before).empty());
    EXPECT_EQ(read(r), before);
  }
  EXPECT_TRUE(write(reg_loop, 0));
  EXPECT_TRUE(write_complaint(reg_loop, 0).empty());
}

TEST_F(Registers, EveryComplaintAboutAWriteNamesWhatIsIgnored) {
  const auto complaint = [](uint32_t offset, uint32_t value) {
    return std::string(write_complaint(offset, value));
  };
  EXPECT_EQ(complaint(reg_angle, 0), "write to a read-only register is ignored");
  EXPECT_EQ(complaint(reg_step_bv, 1u << 31),
            "a step of 1.0 or more is ignored: write less than 2^31");
  EXPECT_EQ(complaint(reg_a2, 1u << 31), "a negative amplitude is ignored: write less than 2^31");
  EXPECT_EQ(complaint(reg_ctrl, 3u << ctrl_ref_shift),
            "CTRL.REF 3 is reserved: the reference source stays as it was");
  for (const auto& [offset, name] : {std::pair{reg_ctrl, "CTRL"}, std::pair{reg_cmd, "CMD"},
                                     std::pair{reg_correction, "CORRECTION"},
                                     std::pair{reg_loop, "LOOP"}, std::pair{reg_judge, "JUDGE"}})
    EXPECT_EQ(complaint(offset, offset == reg_correction ? 1u << 31 : 1u << 30),
              std::string("reserved bits of ") + name + " are ignored");
  EXPECT_EQ(complaint(reg_ctrl, ctrl_srst | 1u << 30), "") << "a reset looks at no other bit";
  for (const uint32_t offset : {reg_flags, reg_freq_lo, reg_phase_lo, reg_au_lo, reg_soft_v})
    EXPECT_EQ(complaint(offset, ~0u), "") << offset;
}

TEST_F(Registers, FrequencyIsCommittedByItsHighWordOnly) {
  write(reg_freq_lo, 0x1234);
  EXPECT_EQ(read(reg_freq_hi), 0u);
  EXPECT_EQ(read(reg_freq_lo), 0u);
  write(reg_freq_hi, 0x89ABCDEF);
  EXPECT_EQ(read(reg_freq_lo), 0u) << "not latched yet";
  EXPECT_EQ(dut.read(cycle, reg_freq_lo, true).value, 0x1234u) << "a debugger sees the present";
  EXPECT_EQ(dut.read(cycle, reg_freq_hi, true).value, 0x89ABCDEFu);
  EXPECT_EQ(read(reg_freq_lo), 0u) << "a debugger's read latches nothing";
  EXPECT_EQ(read(reg_freq_hi), 0x89ABCDEFu);
  EXPECT_EQ(read(reg_freq_lo), 0x1234u);
  write(reg_freq_hi, 1);
  EXPECT_EQ(read(reg_freq_hi), 1u);
  EXPECT_EQ(read(reg_freq_lo), 0u) << "the stage is empty after a commit";
}

TEST_F(Registers, CoefficientsKeepAll48Bits) {
  for (uint32_t high : {0u, 1u, 0x7FFFFFFFu, 0x80000000u, 0xFFFFFFFFu}) {
    for (int32_t low : {0, 1, -1, 16383, -16384}) {
      write(reg_au_lo, static_cast<uint32_t>(low));
      write(reg_au_lo + 4, high);
      EXPECT_EQ(read(reg_au_lo + 4), high);
      EXPECT_EQ(static_cast<int32_t>(read(reg_au_lo)), low);
    }
  }
  // A low word beyond half a unit of the high one moves into it.
  write(reg_au_lo, 40000);
  write(reg_au_lo + 4, 5);
  EXPECT_EQ(read(reg_au_lo + 4), 6u);
  EXPECT_EQ(read(reg_au_lo), 40000u - 32768u);
}

TEST_F(Registers, IllegalValuesKeepTheOldOnesAndSetConfig) {
  write(reg_step_au, 0x80000000);
  EXPECT_EQ(read(reg_step_au), 1349307u);
  EXPECT_EQ(read(reg_flags), flag_config);
  write(reg_flags, flag_config);
  EXPECT_EQ(read(reg_flags), 0u);
  write(reg_step_cv, 0x7FFFFFFF);
  EXPECT_EQ(read(reg_step_cv), 0x7FFFFFFFu);
  EXPECT_EQ(read(reg_flags), 0u);
  write(reg_ctrl, 1u << ctrl_ref_shift);
  write(reg_ctrl, ctrl_ref_mask | ctrl_demod);
  EXPECT_EQ(read(reg_ctrl), (1u << ctrl_ref_shift) | ctrl_demod);
  EXPECT_EQ(read(reg_flags), flag_config);
  write(reg_a1, 0xFFFFFFFF);
  EXPECT_EQ(read(reg_a1), 1u << 30);
}

TEST_F(Registers, SoftwareSamplesNeedNoAdcGate) {
  write(reg_ctrl, ctrl_calib);
  soft_sample(0, 1 << 29);
  EXPECT_EQ(read(reg_samples), 1u);
  EXPECT_EQ(read(reg_raw_v), 1u << 29);
  EXPECT_NEAR(static_cast<int32_t>(read(reg_angle)), 0, 2);
  EXPECT_EQ(read(reg_status), status_valid);
  soft_sample(1 << 29, 0);
  EXPECT_NEAR(read(reg_angle), 1u << 30, 2);
  // M = 0.5 I: S = 0.5 * 0.25.
  EXPECT_EQ(read(reg_cal_s), 1u << 28);
  EXPECT_NEAR(read(reg_amplitude), 1u << 28, 1);
  write(reg_cmd, cmd_clear);
  EXPECT_EQ(read(reg_samples), 0u);
}

TEST_F(Registers, GatesKeepWhatTheyGuard) {
  write(reg_freq_hi, 1 << 20);
  soft_sample(1 << 29, 1 << 28);
  EXPECT_EQ(read(reg_au_lo + 4), 1u << 30);
  EXPECT_EQ(read(reg_angle), 0u) << "CALIB is 0";
  EXPECT_EQ(read(reg_status) & status_valid, 0u);
  EXPECT_EQ(read(reg_phase_hi), 1u << 20) << "the accumulator steps all the same";
  write(reg_ctrl, ctrl_demod);
  soft_sample(1 << 29, 1 << 28);
  EXPECT_NE(read(reg_au_lo + 4), 1u << 30);
  write(reg_cmd, cmd_phase0);
  EXPECT_EQ(read(reg_phase_hi), 0u);
}

TEST_F(Registers, ZeroInputIsFlaggedAndHasNoAngle) {
  write(reg_ctrl, ctrl_calib);
  soft_sample(1 << 29, 0);
  const uint32_t before = read(reg_angle);
  soft_sample(0, 0);
  EXPECT_EQ(read(reg_flags) & flag_zero, flag_zero);
  EXPECT_EQ(read(reg_status) & status_valid, 0u);
  EXPECT_EQ(read(reg_angle), before);
}

TEST_F(Registers, InterruptFollowsFlagsAndEnables) {
  write(reg_ctrl, ctrl_ie_result);
  soft_sample(1 << 29, 0);
  EXPECT_TRUE(dut.interrupt());
  write(reg_flags, flag_result);
  EXPECT_FALSE(dut.interrupt());
  write(reg_step_au, 0xFFFFFFFF);
  EXPECT_FALSE(dut.interrupt());
  write(reg_ctrl, ctrl_ie_error);
  EXPECT_TRUE(dut.interrupt()) << "a level: enabling is enough";
  write(reg_flags, flags_all);
  write(reg_ctrl, ctrl_adc | ctrl_ie_error);
  dut.submit(cycle, 5, 5, true);
  dut.advance(cycle + 160);
  EXPECT_FALSE(dut.interrupt());
  dut.advance(cycle + 161);
  EXPECT_TRUE(dut.interrupt()) << "a clipped sample";
}

TEST_F(Registers, LoadIsEquation8) {
  const Sensor s;
  const auto q32 = [](double angle) {
    return static_cast<uint32_t>(static_cast<int64_t>(std::llround(angle / tau * 4294967296.0)));
  };
  for (double beta : {s.beta, -1.4, 3.0796}) {
    for (double phi : {0.0, s.phi, 2.5}) {
      write(reg_a1, static_cast<uint32_t>(fixed::to_q31(s.a1)));
      write(reg_a2, static_cast<uint32_t>(fixed::to_q31(s.a2)));
      write(reg_b1, static_cast<uint32_t>(fixed::to_q31(s.b1)));
      write(reg_b2, static_cast<uint32_t>(fixed::to_q31(s.b2)));
      write(reg_beta, q32(beta));
      write(reg_phi, q32(phi));
      write(reg_cmd, cmd_load);
      cycle += 97;
      const double expected[6] = {s.a1 * std::cos(phi),         s.a1 * std::sin(phi),        s.b1,
                                  -s.a2 * std::sin(phi + beta), s.a2 * std::cos(phi + beta), s.b2};
      for (uint32_t i = 0; i < 6; ++i)
        EXPECT_NEAR(static_cast<int32_t>(read(reg_au_lo + 8 * i + 4)), expected[i] * 2147483648.0,
                    5)
            << i << " " << beta << " " << phi;
    }
  }
}

TEST_F(Registers, DivergenceShowsInTheErrorAverageAfterSettling) {
  write(reg_ctrl, ctrl_demod);
  // 2mu = 0.9999 on all three: twice the stability limit of sin^2 + cos^2 + 1 = 2.
  for (uint32_t r = reg_step_au; r <= reg_step_cv; r += 4) write(r, 0x7FFFFFFF);
  write(reg_diverge_threshold, 1 << 20);
  write(reg_freq_hi, 1 << 28);
  for (int i = 0; i < 63; ++i) soft_sample((i % 2) ? INT32_MAX : INT32_MIN, 1 << 30);
  EXPECT_EQ(read(reg_status) & (status_diverged | status_lock), 0u);
  soft_sample(INT32_MIN, 1 << 30);
  EXPECT_EQ(read(reg_status) & status_diverged, status_diverged);
  EXPECT_EQ(read(reg_flags) & flag_diverged, flag_diverged);
  EXPECT_GT(read(reg_error_average), 1u << 20);
}

TEST_F(Registers, LockRisesAfter64QuietSamplesWithoutTurns) {
  write(reg_judge, 0x3333);
  for (int i = 0; i < 63; ++i) soft_sample(0, 1 << 30);  // phase 0: the start weights fit exactly
  EXPECT_EQ(read(reg_status) & status_lock, 0u);
  soft_sample(0, 1 << 30);
  EXPECT_EQ(read(reg_status) & status_lock, status_lock);
  EXPECT_EQ(read(reg_flags) & flag_lockchg, flag_lockchg);
}

TEST_F(Registers, SlewIsAFieldOfThreeBitsBesideTheJudges) {
  EXPECT_EQ(read(reg_judge), 0x13333u) << "no limit at reset";
  for (uint32_t n = 0; n < 8; ++n) {
    EXPECT_TRUE(write(reg_judge, n << judge_slew_shift | 0x70201));
    EXPECT_TRUE(write_complaint(reg_judge, n << judge_slew_shift | 0x70201).empty());
    EXPECT_EQ(read(reg_judge), n << judge_slew_shift | 0x70201);
  }
  write(reg_judge, ~0u);
  EXPECT_FALSE(write_complaint(reg_judge, ~0u).empty());
  EXPECT_EQ(read(reg_judge), judge_writable);
}

TEST_F(Registers, SoftResetRestoresEverything) {
  write(reg_judge, judge_writable);
  write(reg_freq_hi, 77);
  write(reg_a1, 5);
  soft_sample(1, 2);
  write(reg_ctrl, ctrl_srst | ctrl_demod);
  EXPECT_EQ(read(reg_ctrl), 0u);
  EXPECT_EQ(read(reg_freq_hi), 0u);
  EXPECT_EQ(read(reg_a1), 1u << 30);
  EXPECT_EQ(read(reg_judge), 0x13333u);
  EXPECT_EQ(read(reg_samples), 0u);
  EXPECT_EQ(read(reg_flags), 0u);
}

TEST(PaperRegisters, ShowTheArithmeticAndKeep32BitWeights) {
  Options options;
  options.arithmetic = Arithmetic::paper;
  Coprocessor dut(options);
  EXPECT_EQ(dut.read(0, reg_status, false).value, status_arith);
  dut.write(0, reg_au_lo, 20000);
  dut.write(0, reg_au_lo + 4, 10);
  EXPECT_EQ(dut.read(0, reg_au_lo + 4, false).value, 11u);
  EXPECT_EQ(dut.read(0, reg_au_lo, false).value, 0u);
}

}  // namespace
}  // namespace capsoc::coprocessor::test
