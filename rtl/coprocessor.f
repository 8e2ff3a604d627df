// SPDX-License-Identifier: Apache-2.0
// The coprocessor's own SystemVerilog, in the order in which tools read it: packages and types, then the modules that use
// them. Paths begin at this file. What scripts generate (scripts/capsoc_tools/rtl/sources.py) is read before these.
coprocessor_types.sv
cordic_pkg.sv

add_subtract.sv
block_learning.sv
calibrator.sv
coprocessor.sv
datapath.sv
error_average.sv
flag_register.sv
harmonic_correction.sv
lms_demodulator.sv
multiplier_34x34.sv
multiplier_48x32.sv
normalise_step.sv
pair_words.sv
paper_arctangent.sv
paper_calibrator.sv
paper_core.sv
paper_lms.sv
paper_load.sv
paper_lookup.sv
paper_multiplier.sv
paper_parameters.sv
paper_square_root.sv
polar_normaliser.sv
polar_unit.sv
precise_core.sv
reference_generator.sv
register_bank.sv
results_memory.sv
rotation_cordic.sv
sample_counters.sv
sample_tags.sv
sequencer.sv
setting_registers.sv
shared_register.sv
shift_multiplier.sv
slew_limit.sv
state_registers.sv
turn_judge.sv
vector_gain.sv
vectoring_step.sv
weight_ring.sv
word_memory.sv
