"""The synthesis of scripts/tool synth: yosys for a Cyclone V, counted cells, longest path."""

import json
import re
import shutil
import subprocess
from pathlib import Path

from capsoc_tools.rtl import sources as rtl_sources
from capsoc_tools.rtl.yosys_types import readable

ROOT = rtl_sources.ROOT
RTL = rtl_sources.RTL
TOP = "coprocessor"
STA_SECONDS = 60

# `sta` of yosys 0.23 does not see conditional arcs, so the flip-flop gets an unconditional one with the
# delay of its data input.
FLIP_FLOP = """\
(* abc9_box, lib_whitebox *)
module MISTRAL_FF(input DATAIN, CLK, ACLR, ENA, SCLR, SLOAD, SDATA, output reg Q);
specify
  (posedge CLK => (Q : DATAIN)) = 731;
  $setup(DATAIN, posedge CLK, 0);
  $setup(ENA, posedge CLK, 0);
  $setup(SCLR, posedge CLK, 0);
  $setup(SLOAD, posedge CLK, 0);
  $setup(SDATA, posedge CLK, 0);
endspecify
always @(posedge CLK) Q <= DATAIN;
endmodule
"""


# dsp_map.v of yosys 0.23 (and of 0.55) drops the signs of a multiplier's operands: the cells then take
# unsigned digits of 18 or 9 bits for signed ones. So multipliers are mapped here, signs included, with the
# rules of synth_intel_alm, which gets -nodsp for the rest.
DSP_RULES = [(27, 19), (18, 10), (9, 4)]  # widest and narrowest operand
DSP_CELL = """\
module __MUL{width}X{width}(A, B, Y);
parameter A_SIGNED = 1;
parameter B_SIGNED = 1;
parameter A_WIDTH = {width};
parameter B_WIDTH = {width};
parameter Y_WIDTH = 2 * {width};
input [A_WIDTH-1:0] A;
input [B_WIDTH-1:0] B;
output [Y_WIDTH-1:0] Y;
MISTRAL_MUL{width}X{width} #(.A_SIGNED(A_SIGNED), .B_SIGNED(B_SIGNED)) _TECHMAP_REPLACE_ (.A(A), .B(B), .Y(Y));
endmodule
"""


# The same for an adder that inverts one operand. The LUTs of the adder can do that, but yosys maps only a subtraction
# so. Synthesis reads this in place of rtl/add_subtract.sv; the gate-level netlist check compares the result with the
# unchanged RTL.
ADD_SUBTRACT = """\
module add_subtract #(parameter int Width = 32) (
  input logic [Width-1:0] a_i, b_i, input logic minus_i, carry_i, output logic [Width-1:0] sum_o);
wire [Width-1:0] half_sum, carry;
\\$alu #(.A_SIGNED(0), .B_SIGNED(0), .A_WIDTH(Width), .B_WIDTH(Width), .Y_WIDTH(Width)) adder (
  .A(a_i), .B(b_i), .BI(minus_i), .CI(carry_i),
  .Y(sum_o), .X(half_sum), .CO(carry));
endmodule
"""


class ToolError(Exception):
    """One sentence for the user."""


def find(tool, package):
    path = shutil.which(tool)
    if path is None:
        raise ToolError(f"{tool} is missing; install the package {package}")
    return path


def variant(parameters, channels, work, name):
    """(parameters, new folder below `work`) of an arithmetic with this number of channels."""
    if channels > 1:
        parameters = {**parameters, "Channels": channels}
        name += f"_{channels}_channels"
    folder = Path(work).resolve() / name
    folder.mkdir(parents=True, exist_ok=True)
    return dict(parameters), folder


def write_figures(path, figures):
    """The figures of a tool as JSON, if `path` names a file."""
    if path is None:
        return
    try:
        Path(path).write_text(json.dumps(figures, indent=2) + "\n", encoding="utf-8")
    except OSError as error:
        raise ToolError(f"--json: cannot write '{path}': {error.strerror}; choose another path") from error


def for_verilator(top, folder, hide=True):
    """Commands of yosys that write folder/netlist.v of the mapped `top`. hide: no names of the RTL.

    One wire a bit and short names: Verilator 5.006 gets vectors whose bits depend on one another wrong, and long names
    make its output ten times as long."""
    return [
        f"rename -top {top}_netlist",
        "check -assert",
        "setundef -zero",
        "splitnets",
        "opt_clean -purge",
        *(["rename -hide w:* c:*"] if hide else []),
        "rename -enumerate -pattern n%",
        f"write_verilog -noattr {folder}/netlist.v",
    ]


def run(command, log, **options):
    with open(log, "w") as out:
        status = subprocess.run(command, stdout=out, stderr=subprocess.STDOUT, **options).returncode
    if status != 0:
        last = Path(log).read_text(errors="replace").strip().splitlines()[-3:]
        raise ToolError(f"{Path(command[0]).name} failed ({log}): " + " | ".join(last))


def design_sources(folder):
    """Generated files, made in `folder`, then the RTL's in the order of its list."""
    try:
        return [str(path) for path in rtl_sources.sources(folder)]
    except rtl_sources.RtlError as error:
        raise ToolError(str(error)) from error


def synthesise(sources, parameters, folder, flatten, top=TOP, hide=True):
    """Runs yosys with these parameters of the top; gives the cell counts of each module. hide: no names of the RTL."""
    (folder / "flip_flop.v").write_text(FLIP_FLOP)
    (folder / "dsp_map.v").write_text("".join(DSP_CELL.format(width=width) for width, _ in DSP_RULES))
    (folder / "add_subtract.sv").write_text(ADD_SUBTRACT)
    mapped = [str(path) for path in readable(sources, folder) if Path(path).name != "add_subtract.sv"]
    name = "flat" if flatten else "units"
    flow = f"synth_intel_alm -family cyclonev -noiopad -noclkbuf -nodsp -top {top}"
    script = [
        f"read_verilog -sv {' '.join(mapped)}",
        f"read_verilog -sv -icells {folder}/add_subtract.sv",
        *(f"chparam -set {parameter} {value} {top}" for parameter, value in parameters.items()),
        f"{flow} -run begin:coarse",
        "proc",
        *(["flatten"] if flatten else []),
        "opt -nodffe -nosdff",
        "wreduce",
        "peepopt",
        "opt_clean",
    ]
    for widest, narrowest in DSP_RULES:
        script += [
            f"techmap -map +/mul2dsp.v -D DSP_A_MAXWIDTH={widest} -D DSP_B_MAXWIDTH={widest} "
            f"-D DSP_A_MINWIDTH={narrowest} -D DSP_B_MINWIDTH={narrowest} "
            f"-D DSP_NAME=__MUL{widest}X{widest}",
            "chtype -set $mul t:$__soft_mul",
        ]
    script += [
        f"techmap -map {folder}/dsp_map.v",
        f"{flow} -run coarse:check" + ("" if flatten else " -noflatten"),
        f"tee -o {folder}/{name}.json stat -json",
    ]
    if flatten:
        script += for_verilator(top, folder, hide)
    (folder / f"{name}.ys").write_text("\n".join(script) + "\n")
    run([find("yosys", "yosys"), "-q", "-s", str(folder / f"{name}.ys")], folder / f"{name}.log")
    # With more than one module, yosys 0.23 puts a table in plain text after this member.
    text = (folder / f"{name}.json").read_text().split('"modules":', 1)[1].lstrip()
    modules = json.JSONDecoder().raw_decode(text)[0]
    return {key.lstrip("\\"): value["num_cells_by_type"] for key, value in modules.items()}


def total(cells, module):
    """Cells of a module and all below it."""
    sums = {}
    for kind, count in cells[module].items():
        kind = kind.lstrip("\\")
        below = total(cells, kind) if kind in cells else {kind: 1}
        for leaf, number in below.items():
            sums[leaf] = sums.get(leaf, 0) + count * number
    return sums


def figures(counts):
    def cell(name):
        return counts.get("MISTRAL_" + name, 0)

    halves = sum(cell(f"ALUT{n}") for n in (2, 3, 4, 5)) + cell("NOT") + cell("ALUT_ARITH") + cell("MLAB")
    alm = cell("ALUT6") + -(-halves // 2)
    return {
        "alm": alm,
        "alm_upper": alm + cell("ALUT5") // 2,
        "dsp": cell("MUL27X27") + -(-cell("MUL18X18") // 2) + -(-cell("MUL9X9") // 3),
        "registers": cell("FF"),
        "memory_bits": 32 * cell("MLAB") + 10240 * cell("M10K"),
    }


def longest_path(folder):
    """Nanoseconds and cells, or None: `sta` follows every path, and a netlist can have too many of them."""
    cells = [
        f"read_verilog -specify -lib -D cyclonev +/intel_alm/common/{kind}_sim.v"
        for kind in ("alm", "dff", "dsp", "mem", "misc")
    ]
    script = [
        *cells,
        "delete =MISTRAL_FF",
        f"read_verilog -specify -lib {folder}/flip_flop.v",
        f"read_verilog {folder}/netlist.v",
        "hierarchy -auto-top",
        f"tee -o {folder}/sta.txt sta",
    ]
    (folder / "sta.ys").write_text("\n".join(script) + "\n")
    try:
        run([find("yosys", "yosys"), "-q", "-s", str(folder / "sta.ys")], folder / "sta.log", timeout=STA_SECONDS)
    except subprocess.TimeoutExpired:
        return None
    text = (folder / "sta.txt").read_text()
    found = re.search(r"Latest arrival time in '\S+' is (\d+)", text)
    if not found:
        raise ToolError(f"yosys sta printed no arrival time ({folder}/sta.txt)")
    cells = len(re.findall(r"^ +\d+ \S+ \(MISTRAL_ALUT|^ +\d+ \S+ \(MISTRAL_MUL", text, re.M))
    return int(found.group(1)) / 1000, cells
