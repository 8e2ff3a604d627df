// SPDX-License-Identifier: Apache-2.0
// The tags that travel with a sample: slot, clip, saturation, zero, mirror, turn and unsettled bits. Also the bits of
// STATUS, which change when a sample is committed at the end of T4.
//
// Each input belongs to the stage that makes it and is valid at that stage's last cycle, except saturated_i[s]: stage s
// lost high bits in this cycle, which may be any.
module sample_tags #(
  parameter int Channels = 1
) (
  input  logic       clk_i,
  input  logic       rst_ni,
  input  logic       clear_i,
  input  logic       boundary_i,
  input  logic       enter_i,
  input  logic [4:0] stage_i,
  input  logic       clip_i,         // of the sample that enters T0
  input  logic [4:0] saturated_i,
  input  logic       mirror_i,       // of T0
  input  logic       zero_i,         // of T1
  input  logic       unsettled1_i,   // of T1
  input  logic       turn_i,         // of T2
  input  logic       unsettled4_i,   // of T4
  input  logic       lock_i,         // of the sample that enters T4
  input  logic       diverged_i,
  input  logic       permits_i,      // LOCK of the sample in T4, as far as the turn judge is concerned
  input  logic       calib_i,        // register
  input  logic       distrust_i,     // a safety mechanism has found something, now or before
  output logic [2:0] slot0_o,        // slot numbers of the samples in the stages
  output logic [2:0] slot1_o,
  output logic [2:0] slot2_o,
  output logic [2:0] slot3_o,
  output logic [2:0] slot4_o,
  output logic       mirror4_o,      // of the sample in T4
  output logic       turn4_o,
  output logic       commit_o,
  output logic       valid_o,        // with commit_o: ANGLE is written
  output logic [2:0] result_slot_o,  // of the sample that was committed last
  output logic       result_any_o,   // there was one
  output logic       angle_any_o,    // and one with an angle
  output logic       flag_clip_o,
  output logic       flag_sat_o,
  output logic       flag_zero_o,
  output logic       flag_unsettled_o,
  output logic       flag_diverged_o,
  output logic       flag_lockchg_o,
  output logic       flag_mirrorchg_o,
  output logic       status_lock_o,
  output logic       status_diverged_o,
  output logic       status_mirror_o,
  output logic       status_valid_o,
  input  logic               shift_i,
  input  chain_t     chain_i,
  output chain_t     chain_o
);

  logic [2:0] slot0_q, slot1_q, slot2_q, slot3_q, slot4_q, result_slot_q;
  logic [4:0] clip_q, saturated_q;
  logic [3:0] mirror_q;  // of T1 to T4
  logic [2:0] zero_q;    // of T2 to T4
  logic [2:0] unsettled_q;  // of T2 to T4
  logic [1:0] turn_q;    // of T3 and T4
  logic lock4_q, diverged4_q, calib4_q;

  logic result_any_q, angle_any_q, lock_q, diverged_q, mirror_status_q, valid_q;
  logic shift;
  logic [11:0] moved;
  assign shift = Channels > 1 && shift_i;
  context_chain #(.Channels(Channels), .Width(12)) u_chain (
    .kept_i({slot0_q, result_slot_q, result_any_q, angle_any_q, lock_q, diverged_q, mirror_status_q, valid_q}), .chain_i, .moved_o(moved), .chain_o
  );

  // No reset: a tag means nothing unless the sequencer says that its stage holds a sample.
  always_ff @(posedge clk_i) begin
    if (boundary_i) begin
      slot1_q <= slot0_q;
      slot2_q <= slot1_q;
      slot3_q <= slot2_q;
      slot4_q <= slot3_q;
      clip_q <= {clip_q[3:0], clip_i};
      saturated_q <= {saturated_q[3:0] | saturated_i[3:0], 1'b0};
      mirror_q <= {mirror_q[2:0], mirror_i};
      zero_q <= {zero_q[1:0], zero_i};
      unsettled_q <= {unsettled_q[1:0], unsettled1_i};
      turn_q <= {turn_q[0], turn_i};
      lock4_q <= lock_i;
      diverged4_q <= diverged_i;
      calib4_q <= calib_i;
    end else begin
      saturated_q <= saturated_q | saturated_i;
    end
    if (commit_o) result_slot_q <= slot4_q;
    else if (shift) result_slot_q <= moved[8:6];
  end

  // Slots are handed out in turn; the first one does not matter.
  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) slot0_q <= '0;
    else if (boundary_i && enter_i) slot0_q <= slot0_q + 3'd1;
    else if (shift) slot0_q <= moved[11:9];
  end

  logic lock, unsettled;
  assign lock = lock4_q && permits_i;
  assign unsettled = unsettled_q[2] || unsettled4_i;
  always_ff @(posedge clk_i or negedge rst_ni) begin
    if (!rst_ni) begin
      {result_any_q, angle_any_q, lock_q, diverged_q, mirror_status_q, valid_q} <= '0;
    end else if (clear_i) begin
      {result_any_q, angle_any_q, lock_q, diverged_q, mirror_status_q, valid_q} <= '0;
    end else if (commit_o) begin
      result_any_q <= 1'b1;
      angle_any_q <= angle_any_q || valid_o;
      lock_q <= lock;
      diverged_q <= diverged4_q;
      mirror_status_q <= mirror_q[3];
      valid_q <= valid_o;
    end else if (shift) begin
      {result_any_q, angle_any_q, lock_q, diverged_q, mirror_status_q, valid_q} <= moved[5:0];
    end
  end

  assign slot0_o = slot0_q;
  assign slot1_o = slot1_q;
  assign slot2_o = slot2_q;
  assign slot3_o = slot3_q;
  assign slot4_o = slot4_q;
  assign mirror4_o = mirror_q[3];
  assign turn4_o = turn_q[1];
  assign commit_o = boundary_i && stage_i[4];
  assign valid_o = calib4_q && !zero_q[2] && !unsettled && !distrust_i;
  assign result_slot_o = result_slot_q;
  assign result_any_o = result_any_q;
  assign angle_any_o = angle_any_q;
  assign flag_clip_o = clip_q[4];
  assign flag_sat_o = saturated_q[4] || saturated_i[4];
  assign flag_zero_o = zero_q[2];
  assign flag_unsettled_o = unsettled;
  assign flag_diverged_o = diverged4_q;
  assign flag_lockchg_o = lock != lock_q;
  assign flag_mirrorchg_o = mirror_q[3] != mirror_status_q;
  assign status_lock_o = lock_q;
  assign status_diverged_o = diverged_q;
  assign status_mirror_o = mirror_status_q;
  assign status_valid_o = valid_q;

  logic [3:0] unused_stages;
  assign unused_stages = stage_i[3:0];

endmodule
