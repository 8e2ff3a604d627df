// The self-calibration coprocessor as another company might have it. It has different names, and a reset that is active
// high and synchronous. Its bus port takes address and direction in the setup phase and has no wait states, errors or
// byte strobes.
module angle_unit #(
  parameter int Paper    = 0,
  parameter int WrongBit = -1  // of the ANGLE that is read; -1: none
) (
  input  logic        clk,
  input  logic        rst,
  input  logic        sel,
  input  logic        strobe,
  input  logic        we,
  input  logic [15:0] addr,
  input  logic [31:0] wdata,
  output logic [31:0] rdata,
  input  logic        adc_stb,
  input  logic [31:0] adc_sin,
  input  logic [31:0] adc_cos,
  input  logic        adc_over,
  output logic        request
);
  localparam logic [11:0] AngleAddress = 12'h0C0;

  logic        reset_n, write;
  logic [11:0] address;
  logic [31:0] data;

  always_ff @(posedge clk) begin
    reset_n <= ~rst;
    if (sel && !strobe) begin
      address <= addr[11:0];
      write   <= we;
    end
  end

  coprocessor #(.Paper(Paper)) core (
    .pclk_i         (clk),
    .presetn_i      (reset_n & ~rst),
    .psel_i         (sel),
    .penable_i      (strobe),
    .pwrite_i       (write),
    .paddr_i        (address),
    .pwdata_i       (wdata),
    .pstrb_i        (4'hF),
    .pready_o       (),
    .prdata_o       (data),
    .pslverr_o      (),
    .sample_valid_i (adc_stb),
    .sample_u_i     (adc_sin),
    .sample_v_i     (adc_cos),
    .sample_clip_i  (adc_over),
    .sample_channel_i (4'd0),
    .sample_ready_o (),
    .irq_o          (request),
    .idle_o         ()
  );

  always_comb begin
    rdata = data;
    if (WrongBit >= 0 && address == AngleAddress) rdata[WrongBit] = ~data[WrongBit];
  end
endmodule
