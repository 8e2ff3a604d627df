// Registers that software and the pipeline share: phase, frequency, the six coefficients and the
// six parameters (docs/coprocessor.md, "Registers").
//
// Latency: a write counts from its edge on. Formats: phase, freq 2^-48 turn; au .. cv s48, Q2.46;
// a1, a2, b1, b2 Q1.31; beta, phi 2^-32 turn.
module state_registers #(
  parameter int Paper = 0
) (
  input  logic        clk_i,
  input  logic        rst_ni,
  input  logic        clear_i,
  // Bus
  input  logic        write_i,        // of any register, but no reserved value
  input  logic        zero_phase_i,   // CMD.PHASE0
  input  logic [5:0]  word_i,         // address of the access
  input  logic [31:0] pwdata_i,
  input  logic [31:0] staged_low_i,   // what a write of HI takes as LO
  output logic [31:0] pair_high_o,    // of the 48-bit register at word_i, now
  output logic [31:0] pair_low_o,
  // Pipeline; writes at the boundary
  input  logic        boundary_i,
  input  logic        phase_we_i, freq_we_i, weights_u_we_i, weights_v_we_i, parameters_we_i,
  input  logic [47:0] phase_i, freq_i, au_i, bu_i, cu_i, av_i, bv_i, cv_i,
  input  logic [31:0] a1_i, a2_i, b1_i, b2_i, beta_i, phi_i,
  output logic [47:0] phase_o, freq_o, au_o, bu_o, cu_o, av_o, bv_o, cv_o,
  output logic [31:0] a1_o, a2_o, b1_o, b2_o, beta_o, phi_o
);

  localparam logic [47:0] Half = 48'd1 << 45;  // 0.5, the reset value of a_u and b_v
  localparam logic [31:0] A1Reset = capsoc_coprocessor_pkg::A1_RESET;
  localparam logic [31:0] A2Reset = capsoc_coprocessor_pkg::A2_RESET;

  // Words 06 .. 09 and 14 .. 1F are pairs, LO even and HI odd; 20 .. 25 the parameters.
  logic [47:0] pair, coefficient, phase_word;
  always_comb begin
    case (word_i[4] ? word_i[3:1] : {2'b00, word_i[3]})
      3'd0:    pair = freq_o;
      3'd1:    pair = phase_o;
      3'd2:    pair = au_o;
      3'd3:    pair = bu_o;
      3'd4:    pair = cu_o;
      3'd5:    pair = av_o;
      3'd6:    pair = bv_o;
      default: pair = cv_o;
    endcase
  end

  pair_words #(
    .Paper (Paper)
  ) u_pair_words (
    .coefficient_i (word_i[4]),
    .value_i       (pair),
    .high_o        (pair_high_o),
    .low_o         (pair_low_o),
    .high_i        (pwdata_i),
    .low_i         (staged_low_i),
    .coefficient_o (coefficient),
    .phase_o       (phase_word)
  );

  logic weights_u_we, weights_v_we, parameters_we;
  assign weights_u_we  = weights_u_we_i & boundary_i;
  assign weights_v_we  = weights_v_we_i & boundary_i;
  assign parameters_we = parameters_we_i & boundary_i;

  shared_register #(.Width(48), .ResetValue('0)) u_freq (
    .clk_i, .rst_ni, .clear_i, .bus_we_i (write_i & word_i == 6'h07), .bus_i (phase_word),
    .pipeline_we_i (freq_we_i & boundary_i), .pipeline_i (freq_i), .q_o (freq_o)
  );
  shared_register #(.Width(48), .ResetValue('0)) u_phase (
    .clk_i, .rst_ni, .clear_i, .bus_we_i (zero_phase_i | (write_i & word_i == 6'h09)),
    .bus_i (phase_word & {48{~zero_phase_i}}),
    .pipeline_we_i (phase_we_i & boundary_i), .pipeline_i (phase_i), .q_o (phase_o)
  );
  shared_register #(.Width(48), .ResetValue(Half)) u_au (
    .clk_i, .rst_ni, .clear_i, .bus_we_i (write_i & word_i == 6'h15), .bus_i (coefficient),
    .pipeline_we_i (weights_u_we), .pipeline_i (au_i), .q_o (au_o)
  );
  shared_register #(.Width(48), .ResetValue('0)) u_bu (
    .clk_i, .rst_ni, .clear_i, .bus_we_i (write_i & word_i == 6'h17), .bus_i (coefficient),
    .pipeline_we_i (weights_u_we), .pipeline_i (bu_i), .q_o (bu_o)
  );
  shared_register #(.Width(48), .ResetValue('0)) u_cu (
    .clk_i, .rst_ni, .clear_i, .bus_we_i (write_i & word_i == 6'h19), .bus_i (coefficient),
    .pipeline_we_i (weights_u_we), .pipeline_i (cu_i), .q_o (cu_o)
  );
  shared_register #(.Width(48), .ResetValue('0)) u_av (
    .clk_i, .rst_ni, .clear_i, .bus_we_i (write_i & word_i == 6'h1B), .bus_i (coefficient),
    .pipeline_we_i (weights_v_we), .pipeline_i (av_i), .q_o (av_o)
  );
  shared_register #(.Width(48), .ResetValue(Half)) u_bv (
    .clk_i, .rst_ni, .clear_i, .bus_we_i (write_i & word_i == 6'h1D), .bus_i (coefficient),
    .pipeline_we_i (weights_v_we), .pipeline_i (bv_i), .q_o (bv_o)
  );
  shared_register #(.Width(48), .ResetValue('0)) u_cv (
    .clk_i, .rst_ni, .clear_i, .bus_we_i (write_i & word_i == 6'h1F), .bus_i (coefficient),
    .pipeline_we_i (weights_v_we), .pipeline_i (cv_i), .q_o (cv_o)
  );
  shared_register #(.Width(32), .ResetValue(A1Reset)) u_a1 (
    .clk_i, .rst_ni, .clear_i, .bus_we_i (write_i & word_i == 6'h20), .bus_i (pwdata_i),
    .pipeline_we_i (parameters_we), .pipeline_i (a1_i), .q_o (a1_o)
  );
  shared_register #(.Width(32), .ResetValue(A2Reset)) u_a2 (
    .clk_i, .rst_ni, .clear_i, .bus_we_i (write_i & word_i == 6'h21), .bus_i (pwdata_i),
    .pipeline_we_i (parameters_we), .pipeline_i (a2_i), .q_o (a2_o)
  );
  shared_register #(.Width(32), .ResetValue('0)) u_b1 (
    .clk_i, .rst_ni, .clear_i, .bus_we_i (write_i & word_i == 6'h22), .bus_i (pwdata_i),
    .pipeline_we_i (parameters_we), .pipeline_i (b1_i), .q_o (b1_o)
  );
  shared_register #(.Width(32), .ResetValue('0)) u_b2 (
    .clk_i, .rst_ni, .clear_i, .bus_we_i (write_i & word_i == 6'h23), .bus_i (pwdata_i),
    .pipeline_we_i (parameters_we), .pipeline_i (b2_i), .q_o (b2_o)
  );
  shared_register #(.Width(32), .ResetValue('0)) u_beta (
    .clk_i, .rst_ni, .clear_i, .bus_we_i (write_i & word_i == 6'h24), .bus_i (pwdata_i),
    .pipeline_we_i (parameters_we), .pipeline_i (beta_i), .q_o (beta_o)
  );
  shared_register #(.Width(32), .ResetValue('0)) u_phi (
    .clk_i, .rst_ni, .clear_i, .bus_we_i (write_i & word_i == 6'h25), .bus_i (pwdata_i),
    .pipeline_we_i (parameters_we), .pipeline_i (phi_i), .q_o (phi_o)
  );

endmodule
