// SPDX-License-Identifier: Apache-2.0
// Registers that software and the pipeline share: phase, frequency, the six coefficients and the
// six parameters (docs/reference/coprocessor.md, "Registers").
//
// Latency: a write counts from its edge on. Formats: phase, freq 2^-48 turn; au .. cv s48, Q2.46;
// a1, a2, b1, b2 Q1.31; beta, phi 2^-32 turn.
module state_registers #(
  parameter int Paper = 0,
  parameter int Safety = 1,           // the registers have parity bits
  parameter int Channels = 1
) (
  input  logic        clk_i,
  input  logic        rst_ni,
  input  logic        clear_i,
  // Bus
  input  logic        write_i,        // of any register, but no reserved value
  input  logic        zero_phase_i,   // CMD.PHASE0
  input  capsoc_coprocessor_selects_t select_i,  // of the access
  input  logic [31:0] pwdata_i,
  input  logic        bad_parity_i,   // a write of the bus stores the wrong parity bit
  input  logic [31:0] staged_low_i,   // what a write of HI takes as LO
  output logic [31:0] pair_high_o,    // of the 48-bit register of the access, now
  output logic [31:0] pair_low_o,
  // Pipeline; writes at the boundary
  input  logic        boundary_i,
  input  state_we_t   state_we_i,
  input  state_t      state_i,
  output state_t      state_o,
  output logic        fault_o,        // with boundary_i: a register does not fit its parity bit
  input  logic        shift_i,
  input  chain_t      chain_i,
  output chain_t      chain_o
);

  localparam logic [47:0] Half = 48'd1 << 45;  // 0.5, the reset value of a_u and b_v
  localparam logic [31:0] A1Reset = capsoc_coprocessor_pkg::A1_RESET;
  localparam logic [31:0] A2Reset = capsoc_coprocessor_pkg::A2_RESET;

  logic [47:0] freq, phase, au, bu, cu, av, bv, cv;
  logic [31:0] a1, a2, b1, b2, beta, phi;
  assign state_o.freq       = freq;
  assign state_o.phase      = phase;
  assign state_o.weights    = {au, bu, cu, av, bv, cv};
  assign state_o.parameters = {a1, a2, b1, b2, beta, phi};

  // The 48-bit register of the access; the bits of its number are the registers that have them.
  logic is_phase, is_au, is_bu, is_cu, is_av, is_bv, is_cv;
  logic [1:0]  column, row;  // register_bank.sv, "Reading"
  logic [47:0] pair, coefficient, phase_word;
  assign is_phase = select_i.PHASE_LO | select_i.PHASE_HI;
  assign is_au    = select_i.AU_LO | select_i.AU_HI;
  assign is_bu    = select_i.BU_LO | select_i.BU_HI;
  assign is_cu    = select_i.CU_LO | select_i.CU_HI;
  assign is_av    = select_i.AV_LO | select_i.AV_HI;
  assign is_bv    = select_i.BV_LO | select_i.BV_HI;
  assign is_cv    = select_i.CV_LO | select_i.CV_HI;
  assign column   = {is_au | is_av, is_phase | is_cu | is_cv};
  assign row      = {is_bv | is_cv, is_bu | is_cu | is_av};
  always_comb begin
    case (row)
      2'd0:
        case (column)
          2'd0:    pair = freq;
          2'd1:    pair = phase;
          default: pair = au;
        endcase
      2'd1:
        case (column)
          2'd0:    pair = bu;
          2'd1:    pair = cu;
          default: pair = av;
        endcase
      default: pair = column[0] ? cv : bv;
    endcase
  end

  pair_words #(
    .Paper (Paper)
  ) u_pair_words (
    .coefficient_i (is_au | is_bu | is_cu | is_av | is_bv | is_cv),
    .value_i       (pair),
    .high_o        (pair_high_o),
    .low_o         (pair_low_o),
    .high_i        (pwdata_i),
    .low_i         (staged_low_i),
    .coefficient_o (coefficient),
    .phase_o       (phase_word)
  );

  state_we_t pipeline_we;
  assign pipeline_we = state_we_i & {5{boundary_i}};

  // What the bus writes, as parity. PHASE0 writes 0.
  logic word_parity, coefficient_parity, phase_parity;
  logic [13:0] fault;
  assign word_parity        = bad_parity_i ^ (^pwdata_i);
  assign coefficient_parity = bad_parity_i ^ (^coefficient);
  assign phase_parity       = bad_parity_i ^ (^phase_word);
  assign fault_o            = |fault;

  chain_t chain_freq, chain_phase, chain_au, chain_bu, chain_cu, chain_av, chain_bv, chain_cv, chain_a1, chain_a2, chain_b1, chain_b2, chain_beta;

  shared_register #(.Width(48), .ResetValue('0), .Safety(Safety), .Channels(Channels)) u_freq (
    .clk_i, .rst_ni, .clear_i, .bus_we_i (write_i & select_i.FREQ_HI), .bus_i (phase_word),
    .bus_parity_i (phase_parity),
    .pipeline_we_i (pipeline_we.freq), .pipeline_i (state_i.freq), .q_o (freq),
    .boundary_i, .fault_o (fault[0]),
    .shift_i, .chain_i (chain_i), .chain_o (chain_freq)
  );
  shared_register #(.Width(48), .ResetValue('0), .Safety(Safety), .Channels(Channels)) u_phase (
    .clk_i, .rst_ni, .clear_i, .bus_we_i (zero_phase_i | (write_i & select_i.PHASE_HI)),
    .bus_i (phase_word & {48{~zero_phase_i}}),
    .bus_parity_i (phase_parity & ~zero_phase_i ^ zero_phase_i & bad_parity_i),
    .pipeline_we_i (pipeline_we.phase), .pipeline_i (state_i.phase), .q_o (phase),
    .boundary_i, .fault_o (fault[1]),
    .shift_i, .chain_i (chain_freq), .chain_o (chain_phase)
  );
  shared_register #(.Width(48), .ResetValue(Half), .Safety(Safety), .Channels(Channels)) u_au (
    .clk_i, .rst_ni, .clear_i, .bus_we_i (write_i & select_i.AU_HI), .bus_i (coefficient),
    .bus_parity_i (coefficient_parity),
    .pipeline_we_i (pipeline_we.weights_u), .pipeline_i (state_i.weights.au), .q_o (au),
    .boundary_i, .fault_o (fault[2]),
    .shift_i, .chain_i (chain_phase), .chain_o (chain_au)
  );
  shared_register #(.Width(48), .ResetValue('0), .Safety(Safety), .Channels(Channels)) u_bu (
    .clk_i, .rst_ni, .clear_i, .bus_we_i (write_i & select_i.BU_HI), .bus_i (coefficient),
    .bus_parity_i (coefficient_parity),
    .pipeline_we_i (pipeline_we.weights_u), .pipeline_i (state_i.weights.bu), .q_o (bu),
    .boundary_i, .fault_o (fault[3]),
    .shift_i, .chain_i (chain_au), .chain_o (chain_bu)
  );
  shared_register #(.Width(48), .ResetValue('0), .Safety(Safety), .Channels(Channels)) u_cu (
    .clk_i, .rst_ni, .clear_i, .bus_we_i (write_i & select_i.CU_HI), .bus_i (coefficient),
    .bus_parity_i (coefficient_parity),
    .pipeline_we_i (pipeline_we.weights_u), .pipeline_i (state_i.weights.cu), .q_o (cu),
    .boundary_i, .fault_o (fault[4]),
    .shift_i, .chain_i (chain_bu), .chain_o (chain_cu)
  );
  shared_register #(.Width(48), .ResetValue('0), .Safety(Safety), .Channels(Channels)) u_av (
    .clk_i, .rst_ni, .clear_i, .bus_we_i (write_i & select_i.AV_HI), .bus_i (coefficient),
    .bus_parity_i (coefficient_parity),
    .pipeline_we_i (pipeline_we.weights_v), .pipeline_i (state_i.weights.av), .q_o (av),
    .boundary_i, .fault_o (fault[5]),
    .shift_i, .chain_i (chain_cu), .chain_o (chain_av)
  );
  shared_register #(.Width(48), .ResetValue(Half), .Safety(Safety), .Channels(Channels)) u_bv (
    .clk_i, .rst_ni, .clear_i, .bus_we_i (write_i & select_i.BV_HI), .bus_i (coefficient),
    .bus_parity_i (coefficient_parity),
    .pipeline_we_i (pipeline_we.weights_v), .pipeline_i (state_i.weights.bv), .q_o (bv),
    .boundary_i, .fault_o (fault[6]),
    .shift_i, .chain_i (chain_av), .chain_o (chain_bv)
  );
  shared_register #(.Width(48), .ResetValue('0), .Safety(Safety), .Channels(Channels)) u_cv (
    .clk_i, .rst_ni, .clear_i, .bus_we_i (write_i & select_i.CV_HI), .bus_i (coefficient),
    .bus_parity_i (coefficient_parity),
    .pipeline_we_i (pipeline_we.weights_v), .pipeline_i (state_i.weights.cv), .q_o (cv),
    .boundary_i, .fault_o (fault[7]),
    .shift_i, .chain_i (chain_bv), .chain_o (chain_cv)
  );
  shared_register #(.Width(32), .ResetValue(A1Reset), .Safety(Safety), .Channels(Channels)) u_a1 (
    .clk_i, .rst_ni, .clear_i, .bus_we_i (write_i & select_i.A1), .bus_i (pwdata_i),
    .bus_parity_i (word_parity),
    .pipeline_we_i (pipeline_we.parameters), .pipeline_i (state_i.parameters.a1), .q_o (a1),
    .boundary_i, .fault_o (fault[8]),
    .shift_i, .chain_i (chain_cv), .chain_o (chain_a1)
  );
  shared_register #(.Width(32), .ResetValue(A2Reset), .Safety(Safety), .Channels(Channels)) u_a2 (
    .clk_i, .rst_ni, .clear_i, .bus_we_i (write_i & select_i.A2), .bus_i (pwdata_i),
    .bus_parity_i (word_parity),
    .pipeline_we_i (pipeline_we.parameters), .pipeline_i (state_i.parameters.a2), .q_o (a2),
    .boundary_i, .fault_o (fault[9]),
    .shift_i, .chain_i (chain_a1), .chain_o (chain_a2)
  );
  shared_register #(.Width(32), .ResetValue('0), .Safety(Safety), .Channels(Channels)) u_b1 (
    .clk_i, .rst_ni, .clear_i, .bus_we_i (write_i & select_i.B1), .bus_i (pwdata_i),
    .bus_parity_i (word_parity),
    .pipeline_we_i (pipeline_we.parameters), .pipeline_i (state_i.parameters.b1), .q_o (b1),
    .boundary_i, .fault_o (fault[10]),
    .shift_i, .chain_i (chain_a2), .chain_o (chain_b1)
  );
  shared_register #(.Width(32), .ResetValue('0), .Safety(Safety), .Channels(Channels)) u_b2 (
    .clk_i, .rst_ni, .clear_i, .bus_we_i (write_i & select_i.B2), .bus_i (pwdata_i),
    .bus_parity_i (word_parity),
    .pipeline_we_i (pipeline_we.parameters), .pipeline_i (state_i.parameters.b2), .q_o (b2),
    .boundary_i, .fault_o (fault[11]),
    .shift_i, .chain_i (chain_b1), .chain_o (chain_b2)
  );
  shared_register #(.Width(32), .ResetValue('0), .Safety(Safety), .Channels(Channels)) u_beta (
    .clk_i, .rst_ni, .clear_i, .bus_we_i (write_i & select_i.BETA), .bus_i (pwdata_i),
    .bus_parity_i (word_parity),
    .pipeline_we_i (pipeline_we.parameters), .pipeline_i (state_i.parameters.beta), .q_o (beta),
    .boundary_i, .fault_o (fault[12]),
    .shift_i, .chain_i (chain_b2), .chain_o (chain_beta)
  );
  shared_register #(.Width(32), .ResetValue('0), .Safety(Safety), .Channels(Channels)) u_phi (
    .clk_i, .rst_ni, .clear_i, .bus_we_i (write_i & select_i.PHI), .bus_i (pwdata_i),
    .bus_parity_i (word_parity),
    .pipeline_we_i (pipeline_we.parameters), .pipeline_i (state_i.parameters.phi), .q_o (phi),
    .boundary_i, .fault_o (fault[13]),
    .shift_i, .chain_i (chain_beta), .chain_o
  );
  logic unused_selects;  // of the other registers
  assign unused_selects = ^select_i;

endmodule
