// Directed vectors for the datapath: the borders of formats, quadrants and roundings.
#include <algorithm>
#include <array>
#include <cmath>

#include "base/constants.h"
#include "base/fixed.h"
#include "coprocessor/register_map.h"
#include "regress/scenario.h"

namespace capsoc::regress {

using namespace coprocessor;

namespace {

constexpr int64_t one = int64_t{1} << 46;  // Q2.46
constexpr uint32_t top = INT32_MAX, bottom = 0x80000000u;
constexpr uint32_t both = ctrl_adc | ctrl_demod | ctrl_calib;

uint32_t q31(double value) {
  return static_cast<uint32_t>(fixed::to_q31(value));
}

uint32_t ctrl_source(unsigned source) {
  return source << ctrl_ref_shift;
}

void start(Bench& bench, uint32_t ctrl) {
  bench.drain();
  bench.wait(2);
  bench.write(reg_ctrl, ctrl_srst);
  bench.write(reg_ctrl, ctrl | ctrl_adc);
}

void set_steps(Bench& bench, uint32_t step) {
  for (uint32_t offset = reg_step_au; offset <= reg_step_cv; offset += 4) bench.write(offset, step);
}

void set_weights(Bench& bench, const std::array<int64_t, 6>& weights) {
  for (uint32_t i = 0; i < 6; ++i) bench.write_pair(reg_au_lo + 8 * i, weights[i]);
}

void read_results(Bench& bench) {
  for (uint32_t offset = reg_raw_u; offset <= reg_amplitude; offset += 4) bench.read(offset);
  for (uint32_t offset = reg_error_average; offset <= reg_phi; offset += 4) {
    const bool low = offset >= reg_au_lo && offset <= reg_cv_hi && (offset & 4) == 0;
    if (!low) bench.read(offset);
    if (offset >= reg_au_lo && offset <= reg_cv_hi && !low) bench.read(offset - 4);
  }
  for (uint32_t offset :
       {reg_phase_hi, reg_phase_lo, reg_freq_hi, reg_freq_lo, reg_status, reg_flags, reg_ctrl})
    bench.read(offset);
}

// One sample, on its own, and everything it left.
void settle(Bench& bench, uint32_t u, uint32_t v, bool clip = false) {
  bench.sample(u, v, clip);
  bench.drain();
  read_results(bench);
  bench.write(reg_flags, flags_all);
}

void rotating(Bench& bench, unsigned count, double a, double speed, double beta, uint64_t space) {
  for (unsigned i = 0; i < count && !bench.failed(); ++i) {
    const double angle = speed * two_pi * i;
    bench.sample(q31(a * std::sin(angle)), q31(a * std::cos(angle + beta)));
    bench.wait(space);
  }
  bench.drain();
  read_results(bench);
}

}  // namespace

void run_ties(Bench& bench, Random& random, const Budget&) {
  for (unsigned source = 0; source < 3; ++source) {
    start(bench, both | ctrl_source(source));
    bench.write(reg_ctrl, ctrl_adc | ctrl_calib | ctrl_source(source));
    // Coefficients half way between two words of Q31, of both signs, and one unit off.
    for (int64_t low : {0x4000, 0x3FFF, 0x4001, -0x4000, -0x4001, -0x3FFF, 0xC000}) {
      std::array<int64_t, 6> weights{};
      for (int64_t& weight : weights)
        weight = static_cast<int64_t>(static_cast<int32_t>(corner32(random))) * (1 << 14) + low;
      for (int64_t& weight : weights) weight = (weight & ~int64_t{0x7FFF}) + (low & 0x7FFF);
      bench.drain();
      set_weights(bench, weights);
      settle(bench, corner32(random), corner32(random));
      for (int64_t& weight : weights) weight = -weight;
      set_weights(bench, weights);
      settle(bench, corner32(random), corner32(random));
    }
    // Phases half way between two words of REF_PHASE and between two steps of the CORDIC.
    for (uint64_t low : {0x8000u, 0x7FFFu, 0x8001u, 0x400u, 0x3FFu, 0x401u, 0xFFFFu, 0x10000u}) {
      bench.drain();
      bench.write_pair(reg_phase_lo,
                       static_cast<int64_t>((random.word32() & ~0u) * 65536ull + low));
      settle(bench, random.word32(), random.word32());
    }
    // Products half way: the error is data less 0, since the coefficients are 0.
    bench.write(reg_ctrl, both | ctrl_source(source));
    for (uint32_t shift = 0; shift <= 16; ++shift)
      for (bool negative : {false, true}) {
        bench.drain();
        set_weights(bench, {});
        set_steps(bench, 1u << (15 - std::min(shift, 15u)));
        const uint32_t data = (random.word32() & 0xFFFFu) * 2 + 1;
        const uint32_t u = (data << std::min(shift, 15u)) & top;
        settle(bench, negative ? 0u - u : u, negative ? u : 0u - u);
      }
    // The loop's shifts: residues of every alignment.
    if (source != 1) continue;
    for (unsigned k = 16; k < 32; ++k) {
      bench.drain();
      bench.write(reg_ctrl, ctrl_adc | ctrl_calib | ctrl_source(1));
      set_weights(bench, {one / 2, 0, 0, 0, one / 2, 0});
      bench.write(reg_loop, k | k << 8);
      // One sample tells the angle of the vector; the phase is then set half a step off it.
      const uint32_t u = random.word32(), v = random.word32();
      settle(bench, u, v);
      for (bool negative : {false, true}) {
        const auto relative = static_cast<uint64_t>(bench.nodes().relative);
        const uint64_t half = k > 16 ? uint64_t{1} << (k - 17) : 0;
        bench.write_pair(
            reg_phase_lo,
            static_cast<int64_t>(((relative + (negative ? half : 0 - half)) & 0xFFFFFFFF) << 16));
        settle(bench, u, v);
      }
    }
  }
}

void run_saturation(Bench& bench, Random& random, const Budget&) {
  const std::array<uint32_t, 5> ends = {top, bottom, 0, top - 1, bottom + 1};
  const std::array<int64_t, 4> weights = {one - (1 << 15), -one, 0, one / 2};
  for (unsigned source = 0; source < 3; ++source) {
    start(bench, ctrl_calib | ctrl_source(source));
    for (uint32_t u : ends)
      for (uint32_t v : ends) {
        if (bench.failed()) return;
        bench.drain();
        std::array<int64_t, 6> drawn{};
        for (int64_t& weight : drawn) weight = weights[random.below(weights.size())];
        set_weights(bench, drawn);
        bench.write_pair(reg_phase_lo, static_cast<int64_t>(random.below(8) << 45));
        settle(bench, u, v, random.chance(0.5));
      }
    // CAL_S and CAL_C beyond both ends, upright and mirrored.
    for (int64_t sign : {1, -1})
      for (uint32_t u : {top, bottom})
        for (uint32_t v : {top, bottom}) {
          set_weights(bench, {one - 32768, sign * (one - 32768), -sign * one / 2, -(one - 32768),
                              sign * (one - 32768), one / 2});
          settle(bench, u, v);
          set_weights(bench, {-one, one - 32768, one - 32768, one - 32768, one - 32768, -one});
          settle(bench, u, v);
        }
    // paper: parameters take the coefficients' place.
    for (uint32_t b : {top, bottom})
      for (uint32_t beta : {0u, 1u << 29, 0u - (1u << 29), 1u << 31}) {
        bench.write(reg_a1, top);
        bench.write(reg_a2, top);
        bench.write(reg_b1, b);
        bench.write(reg_b2, ~b);
        bench.write(reg_beta, beta);
        settle(bench, ~b, b);
        settle(bench, b, b);
      }
  }
}

void run_quadrants(Bench& bench, Random& random, const Budget&) {
  // Sixteen points and their neighbours, at several sizes, for both orientations.
  for (int64_t orientation : {1, -1})
    for (unsigned source = 0; source < 3; ++source) {
      start(bench, ctrl_calib | ctrl_source(source));
      set_weights(bench, {one / 2, 0, 0, 0, orientation * one / 2, 0});
      if (orientation < 0) bench.write(reg_beta, 1u << 31);
      for (unsigned i = 0; i < 16; ++i)
        for (int offset : {-1, 0, 1}) {
          if (bench.failed()) return;
          const double angle = i * two_pi / 16;
          const double size =
              std::ldexp(0.99, -static_cast<int>(random.below(i % 2 == 0 ? 4 : 24)));
          const uint32_t u = q31(size * std::sin(angle)) + static_cast<uint32_t>(offset);
          const uint32_t v = q31(size * std::cos(angle));
          bench.write_pair(reg_phase_lo, (int64_t{i} << 44) + offset);
          settle(bench, u, v);
        }
      // Next to half a turn, from both sides, and exactly on it; next to zero.
      for (uint32_t v : {bottom, 0u - 1000000000u, 0u - 1u, 1000000000u, top})
        for (uint32_t u : {0u, 1u, 0u - 1u, 2u, 0u - 2u, 1000u, 0u - 1000u}) settle(bench, u, v);
      // phi and psi all round: T4 sees every quadrant whatever the sample is.
      for (unsigned i = 0; i < 16; ++i) {
        bench.write(reg_ctrl, both | ctrl_source(source));
        set_steps(bench, 0);
        const double phi = i * two_pi / 16, psi = phi + orientation * 0.3 * (1 + i % 5);
        const auto weight = [](double value) { return std::llround(std::ldexp(value, 46)); };
        set_weights(bench,
                    {weight(0.6 * std::cos(phi)), weight(0.6 * std::sin(phi)), weight(0.1),
                     weight(-0.7 * std::sin(psi)), weight(0.7 * std::cos(psi)), weight(-0.2)});
        settle(bench, random.word32(), random.word32());
      }
    }
  // Vectors whose angle in the paper's loop depends on the last bit of its gain: 1 in some 20,000.
  start(bench, both);
  set_steps(bench, 0);
  constexpr std::array<std::array<int64_t, 2>, 4> vectors = {{{760358338, 784704886},
                                                              {-258731101, 1007257417},
                                                              {594343079, -975269566},
                                                              {-683631922, 911651596}}};
  for (const auto& [y, x] : vectors) {
    set_weights(bench, {x * 32768, y * 32768, 0, -y * 32768, x * 32768, 0});
    settle(bench, random.word32(), random.word32());
  }
}

void run_amplitudes(Bench& bench, Random& random, const Budget&) {
  for (unsigned source = 0; source < 3; ++source) {
    start(bench, both | ctrl_source(source));
    set_steps(bench, 0);
    // Coefficients of every bit length: normalisation at all shifts.
    for (unsigned shift = 0; shift <= 46; ++shift) {
      if (bench.failed()) return;
      bench.drain();
      const int64_t size = (one - 32768) >> shift;
      const auto draw = [&] {
        const auto value = static_cast<int64_t>(random.word() & 0x3FFFFFFFFFFF) >> shift;
        return random.chance(0.5) ? value : -value;
      };
      set_weights(bench, {size, draw(), 0, draw(), shift % 3 == 0 ? -size : size, draw() >> 2});
      settle(bench, q31(0.5), q31(-0.25));
      set_weights(bench, {draw(), draw(), draw(), draw(), draw(), draw()});
      settle(bench, random.word32() >> (shift / 2), random.word32() >> (shift / 2));
    }
    // Samples of every bit length at ordinary coefficients.
    set_weights(bench, {one / 2, one / 8, 0, -one / 8, one / 2, 0});
    for (unsigned shift = 0; shift < 32; ++shift) {
      settle(bench, top >> shift, (0u - (top >> shift)) + 1);
      settle(bench, static_cast<uint32_t>(static_cast<int32_t>(random.word32()) >> shift),
             static_cast<uint32_t>(static_cast<int32_t>(random.word32()) >> shift));
    }
    // One word next to nothing next to the other: what remains of it after normalisation is its
    // rounding bit, or its sign.
    for (unsigned shift = 0; shift < 16; ++shift)
      for (int64_t sign : {1, -1}) {
        if (bench.failed()) return;
        const int64_t faint =
            sign * ((int64_t{1} << shift) - static_cast<int64_t>(random.below(2)));
        const int64_t large = random.chance(0.5) ? one / 2 + 12345 : -(one - 32768);
        set_weights(bench, {faint, large, 0, large, -faint, 0});
        settle(bench, random.word32(), static_cast<uint32_t>(random.below(4)));
        set_weights(bench, {large, faint, 0, faint, large, 0});
        settle(bench, static_cast<uint32_t>(random.below(4)), random.word32());
      }
    // Learned ones.
    for (double a : {1e-9, 1e-7, 1e-4, 0.01, 0.2, 0.6, 0.99, 1.4}) {
      start(bench, both | ctrl_source(source));
      set_steps(bench, 1u << 29);
      bench.write_pair(reg_freq_lo, int64_t{1} << 44);
      rotating(bench, 80, a, 1.0 / 16, 0.1, bench.tick());
    }
    // The end of the range: a1 = 2 sin 45 degrees.
    set_weights(bench, {one - 32768, one - 32768, 0, -one, -one, one - 32768});
    set_steps(bench, 0);
    settle(bench, top, bottom);
  }
}

void run_full_scale(Bench& bench, Random& random, const Budget&) {
  // Phases about the four points at which sine or cosine is largest: the rotation overshoots there.
  for (uint32_t quarter = 0; quarter < 4; ++quarter) {
    start(bench, ctrl_calib);
    for (unsigned shift = 2; shift < 40 && !bench.failed(); ++shift)
      for (unsigned i = 0; i < 4; ++i) {
        const auto beside = static_cast<int64_t>(random.word() >> 16) >> shift;
        bench.drain();
        bench.write_pair(reg_phase_lo,
                         (int64_t{quarter} << 46) + (random.chance(0.5) ? beside : -beside));
        bench.sample(random.word32(), random.word32());
        bench.drain();
        for (uint32_t offset : {reg_err_u, reg_err_v, reg_ref_phase}) bench.read(offset);
      }
    // LOAD rotates by PHI; what it makes of a full scale shows every bit.
    for (unsigned i = 0; i < 40 && !bench.failed(); ++i) {
      bench.write(reg_a1, top);
      bench.write(reg_a2, top);
      bench.write(reg_phi, (quarter << 30) + (random.word32() >> (8 + i % 20)));
      bench.write(reg_beta, random.chance(0.5) ? 0 : 0u - (random.word32() >> 20));
      bench.write(reg_cmd, cmd_load);
      bench.drain();
      for (uint32_t offset = reg_au_lo; offset <= reg_cv_hi; offset += 8) {
        bench.read(offset + 4);
        bench.read(offset);
      }
    }
  }
  // The largest and the smallest frequency, with each source: what is not steered does not
  // saturate.
  for (const uint32_t source : {0U, 1U, 2U})
    for (const int64_t frequency : {(int64_t{1} << 47) - 1, -(int64_t{1} << 47)}) {
      start(bench, ctrl_calib | source << ctrl_ref_shift);
      bench.write_pair(reg_freq_lo, frequency);
      for (unsigned i = 0; i < 3; ++i) bench.sample(random.word32(), random.word32());
      bench.drain();
      for (uint32_t offset : {reg_flags, reg_freq_hi, reg_freq_lo, reg_ref_phase})
        bench.read(offset);
    }
}

void run_beta(Bench& bench, Random& random, const Budget&) {
  const double quarter = two_pi / 4, half = two_pi / 2;
  for (unsigned source = 0; source < 3; ++source)
    for (double centre : {quarter, -quarter, half, 0.0})
      for (double beside : {-0.2, -1e-3, -1e-9, 0.0, 1e-9, 1e-3, 0.2}) {
        if (bench.failed()) return;
        const double beta = centre + beside;
        start(bench, both | ctrl_source(source));
        set_steps(bench, 1u << (26 + random.below(4)));
        bench.write_pair(reg_freq_lo, random.chance(0.5) ? int64_t{1} << 44 : -(int64_t{1} << 44));
        // The parameters are loaded, then learned further.
        bench.write(reg_a1, q31(0.6));
        bench.write(reg_a2, q31(0.7));
        bench.write(reg_beta, static_cast<uint32_t>(std::llround(beta / two_pi * 4294967296.0)));
        bench.write(reg_phi, random.word32());
        bench.write(reg_cmd, cmd_load);
        rotating(bench, 24, 0.6, 1.0 / 16, beta, bench.tick());
        settle(bench, random.word32(), random.word32());
      }
}

void run_zero(Bench& bench, Random& random, const Budget&) {
  for (unsigned source = 0; source < 3; ++source)
    for (uint32_t learn : {0u, ctrl_demod}) {
      start(bench, ctrl_calib | learn | ctrl_source(source));
      set_steps(bench, 1u << 28);
      bench.write_pair(reg_freq_lo, static_cast<int64_t>(random.word32()) << 13);
      settle(bench, 0, 0);  // offsets are 0 after reset
      settle(bench, random.word32(), random.word32());
      // The sample is the offset.
      const uint32_t c = random.word32() >> 2;
      set_weights(bench, {one / 2, 0, int64_t{c} << 15, 0, one / 2, -(int64_t{c} << 15)});
      bench.write(reg_b1, c);
      bench.write(reg_b2, 0u - c);
      settle(bench, c, 0u - c);
      settle(bench, c + 1, 0u - c);
      // No coefficients at all; then two that cancel (det = 0).
      set_weights(bench, {});
      bench.write(reg_a1, 0);
      bench.write(reg_a2, 0);
      settle(bench, random.word32(), random.word32());
      set_weights(bench, {one / 4, one / 4, 0, one / 4, one / 4, 0});
      settle(bench, q31(0.3), q31(0.3));
      set_weights(bench, {1, 0, 0, 0, 1, 0});
      settle(bench, 1, 1);
      bench.write(reg_ctrl, ctrl_adc | learn | ctrl_source(source));  // CALIB off: VALID falls
      settle(bench, random.word32(), random.word32());
    }
}

void run_step_ends(Bench& bench, Random& random, const Budget&) {
  for (unsigned source = 0; source < 3; ++source)
    for (uint32_t step : {0u, 1u, 2u, 0x7FFFu, 0x8000u, 0xFFFFu, 0x10000u, top - 1, top}) {
      start(bench, both | ctrl_source(source));
      set_steps(bench, step);
      bench.write_pair(reg_freq_lo, int64_t{1} << 44);
      for (unsigned i = 0; i < 12 && !bench.failed(); ++i) {
        bench.sample(corner32(random), corner32(random));
        bench.wait(bench.tick());
      }
      rotating(bench, 24, 0.7, 1.0 / 16, 0.2, bench.tick());
      // One weight alone.
      const auto chosen = static_cast<uint32_t>(random.below(6));
      set_steps(bench, 0);
      bench.write(reg_step_au + 4 * chosen, step);
      rotating(bench, 12, 0.7, 1.0 / 16, 0.2, 40);
    }
}

void run_weight_clamp(Bench& bench, Random& random, const Budget&) {
  // Two coefficients hold the estimate far from the data, and a step on the third alone drives it
  // to its clamp.
  for (unsigned driven = 0; driven < 3; ++driven)
    for (int64_t sign : {1, -1})
      for (unsigned octant = 1; octant < 8; octant += 2) {
        if (bench.failed()) return;
        start(bench, both);
        const double phase = octant * two_pi / 8;
        const std::array<double, 3> r = {std::sin(phase), std::cos(phase), 1};
        std::array<int64_t, 6> weights{};
        for (unsigned i = 0; i < 3; ++i) {
          const bool up = (r[i] > 0) == (sign < 0);
          weights[i] = weights[i + 3] = i == driven ? 0 : up ? one - 32768 : -one;
        }
        set_weights(bench, weights);
        set_steps(bench, 0);
        const uint32_t step = random.chance(0.5) ? top : 0x60000000u + (random.word32() >> 4);
        bench.write(reg_step_au + 4 * driven, step);
        bench.write(reg_step_au + 12 + 4 * driven, step);
        bench.write_pair(reg_freq_lo, 0);
        bench.write_pair(reg_phase_lo, int64_t{octant} << 45);
        for (unsigned i = 0; i < 12; ++i) {
          bench.sample(sign > 0 ? top : bottom, sign > 0 ? top : bottom);
          bench.wait(bench.scaled(40 + 32 * 4));
        }
        bench.drain();
        read_results(bench);
        // Weights that are not written do not count as clamped. Others are in their place when T4
        // reads them, for it would clamp what it makes of these.
        for (unsigned i = 0; i < 4; ++i) {
          bench.drain();
          bench.write(reg_flags, flags_all);
          bench.write(reg_ctrl, ctrl_adc | ctrl_calib | (i % 2 == 0 ? 0 : ctrl_demod));
          const auto data = static_cast<uint32_t>(static_cast<int32_t>(random.word32()) >> 1);
          bench.sample(data, data);
          const uint64_t latched = bench.edge();
          bench.wait_until(latched + 1 + 3 * bench.tick() + 3);
          set_weights(bench, {one / 4, one / 8, 0, -one / 8, one / 4, 0});
          bench.drain();
          read_results(bench);
          set_weights(bench, weights);
          bench.write_pair(reg_au_lo + 8 * driven, sign * (one - 32768));
          bench.write_pair(reg_au_lo + 24 + 8 * driven, sign * (one - 32768));
        }
        bench.write(reg_ctrl, both);
        // Back from there, all steps on.
        set_steps(bench, top);
        for (unsigned i = 0; i < 6; ++i) settle(bench, corner32(random), corner32(random));
      }
}

void run_loop_gains(Bench& bench, Random& random, const Budget&) {
  for (uint32_t k = 0; k < 32; ++k) {
    if (bench.failed()) return;
    start(bench, ctrl_calib | ctrl_source(1) | (k % 2 == 0 ? ctrl_demod : 0));
    bench.write(reg_loop, k | (31 - k) << 8);
    for (unsigned i = 0; i < 8; ++i) {
      bench.sample(random.word32(), random.word32());
      bench.wait(bench.tick());
    }
    bench.write(reg_loop, random.below(32) | k << 8);
    rotating(bench, 16, 0.8, 1.0 / 64, 0, bench.tick() + 1);
  }
  // Past the clamps by every shift: the frequency at its end, the residue a quarter of a turn.
  for (uint32_t ki = 0; ki < 32; ++ki)
    for (int64_t sign : {1, -1}) {
      if (bench.failed()) return;
      start(bench, ctrl_calib | ctrl_source(1));
      bench.write(reg_loop, ki << 8 | ki);
      bench.write_pair(reg_freq_lo, sign > 0 ? (int64_t{1} << 47) - 1 : -(int64_t{1} << 47));
      bench.sample(sign > 0 ? q31(0.7) : q31(-0.7), 0);
      bench.wait(bench.tick());
      bench.sample(random.word32(), random.word32());
      bench.drain();
      read_results(bench);
    }
  // The frequency to both clamps: steps of nearly half a turn with KI 0.
  for (int64_t sign : {1, -1}) {
    start(bench, ctrl_calib | ctrl_source(1));
    bench.write(reg_loop, 31);
    bench.write_pair(reg_freq_lo, sign * ((int64_t{1} << 47) - (sign > 0 ? 1 : 0)));
    for (unsigned i = 0; i < 40 && !bench.failed(); ++i) {
      const uint64_t ahead = static_cast<uint64_t>(bench.nodes().phase) +
                             static_cast<uint64_t>(sign * (int64_t{3} << 45));
      const double angle = std::ldexp(static_cast<double>(ahead & ((uint64_t{1} << 48) - 1)), -48);
      settle(bench, q31(0.7 * std::sin(angle * two_pi)), q31(0.7 * std::cos(angle * two_pi)));
    }
  }
}

void run_thresholds(Bench& bench, Random& random, const Budget&) {
  start(bench, both | ctrl_ie_lock);
  bench.write(reg_judge, 0);  // LOCK by the average alone
  set_steps(bench, 0);
  set_weights(bench, {});
  const uint32_t u = 123456789;  // a constant error: the average creeps up to it
  for (unsigned i = 0; i < 70; ++i) {
    bench.sample(u, 0u - u / 2);
    bench.wait(bench.tick());
    if (i > 60) bench.interrupt();
  }
  bench.drain();
  for (uint32_t offset : {reg_lock_threshold, reg_diverge_threshold})
    for (int beside : {-1, 0, 1, 2}) {
      // Steady: with the error at the average the next average is the same.
      const auto average = static_cast<uint32_t>(bench.nodes().error_average);
      bench.write(offset, average + static_cast<uint32_t>(beside));
      settle(bench, average, 0);
      bench.interrupt();
    }
  for (uint32_t threshold : {0u, 1u, 1u << 31, (1u << 31) + 1, ~0u})
    for (uint32_t data : {0u, bottom, top, random.word32()}) {
      bench.write(reg_lock_threshold, threshold);
      bench.write(reg_diverge_threshold, ~threshold);
      settle(bench, data, data);
      bench.write(reg_diverge_threshold, threshold);
      settle(bench, data, 0u - data);
    }
  // The largest average there is.
  for (unsigned i = 0; i < 700 && !bench.failed(); ++i) {
    bench.sample(bottom, i % 2 == 0 ? bottom : top);
    bench.wait(bench.tick());
  }
  bench.write(reg_diverge_threshold, 0x7FFF0000u);
  settle(bench, bottom, top);
  settle(bench, 0, 0);
}

}  // namespace capsoc::regress
