#include "regress/scenario.h"

namespace capsoc::regress {

const std::vector<Scenario>& scenarios() {
  static const std::vector<Scenario> all = {
      {"registers", "access, reset value and reserved bits of every register, as described", 0, 0,
       run_registers},
      {"pairs", "write stages and read latches of the 48-bit registers", 0, 0, run_pairs},
      {"flags", "every flag raised, masked, cleared, and cleared at the edge that raises it", 0, 0,
       run_flags},
      {"spacing", "samples 1 to 200 cycles apart", 0, 0, run_spacing},
      {"load_moments", "LOAD at every edge of a sample's way, and among samples", 0, 0,
       run_load_moments},
      {"reset_moments", "soft and pin reset at every edge of a sample's way", 0, 0,
       run_reset_moments},
      {"collisions", "writes at, before and after the edges at which the pipeline writes", 0, 0,
       run_collisions},
      {"overruns", "samples that find the holding register full", 0, 0, run_overruns},
      {"modes", "every change of source, DEMOD and CALIB, idle and at every stage", 0, 0,
       run_modes},
      {"ties", "rounded shifts of exactly one half", 0, 0, run_ties},
      {"saturation", "words at the ends of their range", 0, 0, run_saturation},
      {"quadrants", "all quadrants, their borders and the seam at half a turn", 0, 0,
       run_quadrants},
      {"amplitudes", "the smallest and the largest amplitudes", 0, 0, run_amplitudes},
      {"full_scale", "phases at which sine or cosine is largest", 0, 0, run_full_scale},
      {"beta", "beta near a quarter and half a turn, both directions", 0, 0, run_beta},
      {"zero", "input that has no angle", 0, 0, run_zero},
      {"step_ends", "step factors at both ends", 0, 0, run_step_ends},
      {"weight_clamp", "coefficients at their clamps", 0, 0, run_weight_clamp},
      {"loop_gains", "every KP and KI, the frequency at its clamps", 0, 0, run_loop_gains},
      {"thresholds", "lock and divergence at, below and above the error average", 0, 0,
       run_thresholds},
      {"stream", "sensors and other signals through the ADC stream, in all modes", 500, 80,
       run_stream},
      {"noise", "white noise back to back", 350, 20, run_noise},
      {"traffic", "accesses to every offset between samples", 50, 650, run_traffic},
      {"interrupted", "resets, LOADs and changes of mode in the course of samples", 50, 150,
       run_interrupted},
      {"software", "samples that software submits", 50, 100, run_software},
      {"threshold_bits", "thresholds, and averages of u and v, that differ in one bit", 0, 0,
       run_threshold_bits},
      {"largest_error", "the error average at its end, and the thresholds beside it", 0, 0,
       run_largest_error},
      {"stages", "each write stage and read latch alone, and each among all", 0, 0, run_stages},
      {"flag_bits", "many flags at once, cleared one by one", 0, 0, run_flag_bits},
      {"turns", "windows of the turn judge: ends, records, limits, good and bad ones", 0, 0,
       run_turns},
      {"alarm", "glitches, alarm and freeze, and their settings at every edge", 0, 0, run_alarm},
      {"magnitudes", "magnitudes beside one half, offsets beside 1", 0, 0, run_magnitudes},
      {"golden", "a drawn sensor: ANGLE against what the CSFN makes of the same samples", 0, 0,
       run_golden},
  };
  return all;
}

}  // namespace capsoc::regress
