"""What yosys leaves without behaviour among the cells of an ECP5: the multiplier and the block memory.

Both are as the coprocessor's netlist has them, from Lattice's description of the cells (FPGA-TN-02205, sysDSP, and
FPGA-TN-02204, memory). The multiplier has 18 bits and no registers. The block memory has 512 words of 36 bits or 2,048
of 9, a port to write (A) and a port to read (B). In any other use the simulation stops.
"""

MULTIPLIER = """\
module MULT18X18D(input {a}, {b}, {c}, SIGNEDA, SIGNEDB, SOURCEA, SOURCEB, output {p});
  wire signed [18:0] a = {{SIGNEDA & A17, {a}}};
  wire signed [18:0] b = {{SIGNEDB & B17, {b}}};
  wire signed [37:0] product = a * b;
  assign {{{p}}} = product[35:0];
  always @* if (SOURCEA | SOURCEB) $fatal(1, "MULT18X18D: an operand of the cell before it");
endmodule
"""
MEMORY = """\
module DP16KD(input {dia}, {dib}, {ada}, {adb}, CEA, OCEA, CLKA, WEA, RSTA, CSA2, CSA1, CSA0,
              CEB, OCEB, CLKB, WEB, RSTB, CSB2, CSB1, CSB0, output {doa}, {dob});
  parameter DATA_WIDTH_A = 18, DATA_WIDTH_B = 18, REGMODE_A = "NOREG", REGMODE_B = "NOREG", RESETMODE = "SYNC",
            ASYNC_RESET_RELEASE = "SYNC", CSDECODE_A = "0b000", CSDECODE_B = "0b000", GSR = "ENABLED",
            CLKAMUX = "CLKA", CLKBMUX = "CLKB", WRITEMODE_A = "NORMAL", WRITEMODE_B = "NORMAL",
            INITVAL_FILE = "", INIT_DATA = "STATIC";
  parameter [319:0] {zeros};
  localparam [64*320-1:0] Begin = {{{names}}};  // 18 of each 20 bits
  reg [35:0] words [0:511];
  reg [35:0] q;
  wire [35:0] d = {{{dib}, {dia}}};
  wire [8:0] write = {{{ada_word}}}, read = {{{adb_word}}};
  wire narrow = DATA_WIDTH_A == 9;  // word 4n of 9 bits is the lowest part of word n of 36
  wire [1:0] write_part = {{ADA4, ADA3}}, read_part = {{ADB4, ADB3}};
  integer i;
  initial begin
    if (DATA_WIDTH_A != DATA_WIDTH_B || DATA_WIDTH_A != 36 && DATA_WIDTH_A != 9)
      $fatal(1, "DP16KD: neither 512 words of 36 bits nor 2,048 of 9");
    q = 0;
    for (i = 0; i < 512; i = i + 1) words[i] = {{Begin[40*i+20 +: 18], Begin[40*i +: 18]}};
  end
  always @(posedge CLKA) if (CEA & WEA & narrow) words[write][9*write_part +: 9] <= d[8:0];
  always @(posedge CLKA) if (CEA & WEA & !narrow) begin
    if (ADA0) words[write][8:0] <= d[8:0];
    if (ADA1) words[write][17:9] <= d[17:9];
    if (ADA2) words[write][26:18] <= d[26:18];
    if (ADA3) words[write][35:27] <= d[35:27];
  end
  always @(posedge CLKB) if (CEB) q <= narrow ? {{9'd0, words[read][9*read_part +: 9], 18'd0}} : words[read];
  always @* if (RSTA | RSTB | WEB) $fatal(1, "DP16KD: a reset, or a second port to write");
  assign {{{dob}, {doa}}} = q;
endmodule
"""


def pins(name, high, low=0):
    """`A17, A16, ... A0`."""
    return ", ".join(f"{name}{bit}" for bit in range(high, low - 1, -1))


def models():
    """The modules as Verilog."""
    initial = [f"INITVAL_{number:02X}" for number in range(64)]
    operands = {name.lower(): pins(name, 17) for name in "ABC"}
    ports = {name.lower(): pins(name, 17) for name in ("DIA", "DIB", "DOA", "DOB")}
    ports |= {name.lower(): pins(name, 13) for name in ("ADA", "ADB")}
    return MULTIPLIER.format(**operands, p=pins("P", 35)) + MEMORY.format(
        **ports,
        ada_word=pins("ADA", 13, 5),
        adb_word=pins("ADB", 13, 5),
        zeros=", ".join(f"{name} = 320'd0" for name in initial),
        names=", ".join(reversed(initial)),
    )
