"""The netlist gate of scripts/tool synth: what was synthesised, simulated and what was written."""

import os
import re
import subprocess
from pathlib import Path

from capsoc_tools.rtl.synth_flow import ROOT, TOP, find, run

GATE = ROOT / "tests" / "rtl" / "netlist" / "netlist_gate.cpp"


def techlib_cells(folder):
    """Simulation cells; of the memories the two that this flow uses, for Icarus refuses the others. It refuses
    variable bounds of a slice, too, so those of the block memory are written with a width."""
    share = Path(find("yosys", "yosys")).resolve().parents[1] / "share" / "yosys" / "intel_alm" / "common"
    text = (share / "mem_sim.v").read_text()
    memories = [
        re.search(rf"module {name}\b.*?endmodule", text, re.S).group(0) for name in ("MISTRAL_MLAB", "MISTRAL_M10K")
    ]
    slices = re.sub(r"\((\w+) \+ 1\) \* (\w+) - 1 : \1 \* \2\]", r"\1 * \2 +: \2]", "\n".join(memories))
    (folder / "memories.v").write_text(slices + "\n")
    return [str(share / name) for name in ("alm_sim.v", "dff_sim.v", "dsp_sim.v")] + [str(folder / "memories.v")]


def verilate(name, sources, folder, options):
    verilator = find("verilator", "verilator")
    run(
        [
            verilator,
            "--cc",
            "-O3",
            "-Wno-fatal",
            "-Wno-lint",
            "--top-module",
            name,
            "--prefix",
            f"V{name}",
            "--Mdir",
            str(folder / name),
            *options,
            *sources,
        ],
        folder / f"{name}.log",
    )
    run(
        [
            find("make", "make"),
            "-s",
            "-j",
            str(os.cpu_count() or 1),
            "-C",
            str(folder / name),
            "-f",
            f"V{name}.mk",
            "OPT_FAST=-O1",
            "OPT_SLOW=-O0",
            f"V{name}__ALL.a",
            "verilated.o",
            "verilated_threads.o",
        ],
        folder / f"{name}.make.log",
    )


def build_program(source, parts, includes, folder):
    """A program around Verilated modules, in folder/ under the name of its source."""
    root = subprocess.run(
        [find("verilator", "verilator"), "--getenv", "VERILATOR_ROOT"], capture_output=True, text=True, check=True
    ).stdout.strip()
    program = folder / source.stem
    run(
        [
            find("g++", "g++"),
            "-std=c++17",
            "-O1",
            *[f"-I{place}" for place in [*parts, f"{root}/include", *includes]],
            str(source),
            *[str(part / f"V{part.name}__ALL.a") for part in parts],
            str(parts[0] / "verilated.o"),
            str(parts[0] / "verilated_threads.o"),
            "-lpthread",
            "-o",
            str(program),
        ],
        folder / f"{source.stem}.log",
    )
    return program


def gate(sources, parameters, folder, samples, seed, cells=None):
    """folder/netlist.v against RTL with these parameters; the program's last lines and its verdict. cells: files with
    the simulation models of the netlist's cells, in place of those of Cyclone V."""
    verilate(f"{TOP}_netlist", [str(folder / "netlist.v"), *(cells or techlib_cells(folder))], folder, [])
    verilate(TOP, sources, folder, [f"-G{name}={value}" for name, value in parameters.items()])
    program = build_program(GATE, [folder / TOP, folder / f"{TOP}_netlist"], [], folder)
    channels = parameters.get("Channels", 1)
    done = subprocess.run([program, str(samples), str(seed), str(channels)], capture_output=True, text=True)
    return done.returncode == 0, done.stdout.strip()


UNIT_BENCH = """\
module bench;
  reg clock = 0;
  integer i, k, seen = 0, wrong = 0;
  function [127:0] word(input integer unused);
    case ($urandom % 8)
      0: word = 128'd0;
      1: word = ~128'd0;
      2: word = 128'd1 << ($urandom % 128);
      3: word = {{$urandom, $urandom, $urandom, $urandom}} & {{$urandom, $urandom, $urandom, $urandom}};
      default: word = {{$urandom, $urandom, $urandom, $urandom}};
    endcase
  endfunction
{declarations}
  {unit} rtl({rtl});
  {unit}_netlist netlist({netlist});
  initial begin
    for (i = 0; i < {samples}; i = i + 1) begin
{inputs}
      #1;
{compares}
      clock = 1; #1; clock = 0; #1;
    end
    $display("%0d inputs, %0d bits compared: %0s", {samples}, seen, wrong == 0 ? "identical" : "DIFFERENT");
    $finish(0);
  end
endmodule
"""


def unit_gate(unit, sources, folder, samples, cells=None):
    """folder/netlist.v of one unit against its RTL in Icarus. Bits that the RTL does not know yet do not count. cells:
    as in gate()."""
    text = (folder / "netlist.v").read_text()
    ports = re.findall(r"^  (input|output) (?:\[(\d+):0\] )?(\w+);", text, re.M)
    declarations, inputs, compares, sides = [], [], [], {"rtl": [], "netlist": []}
    for direction, high, name in ports:
        width = int(high or 0) + 1
        for side, connections in sides.items():
            signal = name if direction == "input" else f"{side}_{name}"
            connections.append(f".{name}({'clock' if name == 'clk_i' else signal})")
            if direction == "output":
                declarations.append(f"  wire [{width - 1}:0] {signal};")
        if direction == "input" and name != "clk_i":
            declarations.append(f"  reg [{width - 1}:0] {name};")
            inputs.append(f"      {name} = {'i > 1' if name == 'rst_ni' else 'word(0)'};")
        elif direction == "output":
            compares.append(
                f"      for (k = 0; k < {width}; k = k + 1) if (rtl_{name}[k] !== 1'bx) begin\n"
                f"        seen = seen + 1;\n"
                f"        if (rtl_{name}[k] !== netlist_{name}[k]) wrong = wrong + 1;\n      end"
            )
    (folder / "bench.v").write_text(
        UNIT_BENCH.format(
            unit=unit,
            samples=samples,
            declarations="\n".join(declarations),
            inputs="\n".join(inputs),
            compares="\n".join(compares),
            **{side: ", ".join(all_) for side, all_ in sides.items()},
        )
    )
    program = folder / "bench.vvp"
    run(
        [
            find("iverilog", "iverilog"),
            "-g2012",
            "-s",
            "bench",
            "-o",
            str(program),
            str(folder / "bench.v"),
            str(folder / "netlist.v"),
            *(cells or techlib_cells(folder)),
            *sources,
        ],
        folder / "bench.log",
    )
    done = subprocess.run([find("vvp", "iverilog"), str(program)], capture_output=True, text=True)
    text = done.stdout.strip()
    return text.endswith("bits compared: identical") and " 0 bits" not in text, text
