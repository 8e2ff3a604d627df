"""Places and routes the coprocessor on an ECP5 of Lattice, and says its area and clock.

usage: route [--arithmetic precise|safety|paper|two-clocks] [--channels N] [--board] [--device 25k|45k|85k]
             [--seed N] [--seeds N] [--no-gate] [--xilinx] [--json FILE] [--work FOLDER]

yosys synthesises, nextpnr-ecp5 places and routes for the slowest speed grade (6) and a clock of 25 MHz. The
coprocessor alone has no input and output buffers. Debian 12 has no nextpnr-ecp5, Debian 13 has it:
    scripts/tool bare_debian --keep build/route trixie sh -c \
        'apt-get install -qq python3 yosys nextpnr-ecp5 fpga-trellis verilator make g++ && scripts/tool route'

--arithmetic  as in scripts/tool synth; default: all four, one after the other
--channels    of the coprocessor; default 1
--board       the board of rtl/board in place of the coprocessor alone, with its pins; writes the bitstream of the
              fastest placement
--device      default 25k, the LFE5U-25F in the package CABGA381, and 85k for `paper`, which needs more multipliers
--seed        of the first placement; default 1
--seeds       placements, each with the next seed; default 1. The table has the median, the lowest and the highest clock
--no-gate     leaves out the simulation of the netlist
--xilinx      cells of synth_xilinx for the 7 series, too; they are not placed
--json        the figures as JSON
--work        where netlists, logs, reports and the bitstream go; default build/route

Status 0: netlist and RTL are identical, and every placement of a design that has to keeps 25 MHz (all but `paper`);
1: not so; 2: a tool is missing or failed.
"""

import argparse
import json
import re
import statistics
import sys
from pathlib import Path

from capsoc_tools.rtl import sources as rtl_sources
from capsoc_tools.rtl.ecp5_cells import models
from capsoc_tools.rtl.synth import CLOCK_MHZ, PARAMETERS, SAMPLES
from capsoc_tools.rtl.synth_flow import (
    ROOT,
    RTL,
    TOP,
    ToolError,
    design_sources,
    find,
    for_verilator,
    run,
    variant,
    write_figures,
)
from capsoc_tools.rtl.synth_gate import gate
from capsoc_tools.rtl.yosys_types import read_design

BOARD_TOP = "capsoc_board_ulx3s"
BOARD_LIST = RTL / rtl_sources.BOARD
BOARD_PINS = RTL / "board" / "ulx3s.lpf"
PACKAGE = "CABGA381"
DEVICES = {"precise": "25k", "safety": "25k", "paper": "85k", "two-clocks": "85k"}
MISSES_THE_CLOCK = {"paper"}  # Eq (11) in every clock: docs/explanation/papers.md
CELLS = {"TRELLIS_COMB": "LUT4", "TRELLIS_FF": "registers", "MULT18X18D": "MULT18", "DP16KD": "block memories"}
NEXTPNR = ("nextpnr-ecp5", "nextpnr-ecp5 of Debian 13 (route --help has the command)")
XILINX = {"DSP48E1": "DSP48", "RAMB18E1": "RAMB18", "RAMB36E1": "RAMB36"}


def synthesise(files, parameters, top, folder, flow):
    """Runs a synthesis of yosys for `top` with these parameters in the new `folder`, which gets the log."""
    settings = "".join(f"chparam -set {name} {value} {top}; " for name, value in parameters.items())
    script = f"{read_design(files, folder)}; {settings}{flow}"
    run([find("yosys", "yosys"), "-q", "-p", script], folder / f"{flow.split()[0]}.log")


def xilinx_cells(files, parameters, top, folder):
    """{title: count} of what synth_xilinx makes, by kind."""
    statistics_file = folder / "xilinx.json"
    flow = f"synth_xilinx -family xc7 -flatten -noiopad -noclkbuf -top {top}; tee -o {statistics_file} stat -json"
    synthesise(files, parameters, top, folder, flow)
    text = statistics_file.read_text(encoding="utf-8")
    counts = json.loads(text[text.index("{") :])["design"]["num_cells_by_type"]
    counts = {kind.lstrip("\\"): count for kind, count in counts.items()}
    return {
        "LUT": sum(count for kind, count in counts.items() if kind.startswith("LUT")),
        "registers": sum(count for kind, count in counts.items() if kind.startswith("FD")),
        **{title: counts.get(kind, 0) for kind, title in XILINX.items()},
    }


def cell_models(folder):
    """Simulation models of an ECP5's cells: yosys's own, and what it has none for."""
    share = Path(find("yosys", "yosys")).resolve().parents[1] / "share" / "yosys" / "ecp5" / "cells_sim.v"
    text = re.sub(r"\(\* blackbox \*\)\s*module DP16KD\b.*?endmodule\n", "", share.read_text("utf-8"), flags=re.S)
    (folder / "cells.v").write_text(text + models(), encoding="utf-8")
    return [f"-I{share.parent}", str(folder / "cells.v")]


def place(netlist, options, device, seed, folder):
    """The report of one placement: cells by kind, and the routed clock in MHz."""
    report = folder / f"seed_{seed}.json"
    command = [find(*NEXTPNR), f"--{device}"]
    command += ["--package", PACKAGE, "--speed", "6", "--json", str(netlist), "--freq", str(CLOCK_MHZ)]
    command += ["--seed", str(seed), "--timing-allow-fail", "--report", str(report)]
    command += [option.format(seed=seed) for option in options]
    run(command, folder / f"seed_{seed}.log")
    figures = json.loads(report.read_text(encoding="utf-8"))
    (clock,) = figures["fmax"].values()
    path = max(figures["critical_paths"], key=lambda path: sum(step["delay"] for step in path["path"]))
    routing = sum(step["delay"] for step in path["path"] if step["type"] == "routing")
    cells = {title: figures["utilization"][kind]["used"] for kind, title in CELLS.items()}
    return {"seed": seed, "mhz": clock["achieved"], "routing_share": routing * clock["achieved"] / 1000, **cells}


def describe(runs, xilinx):
    """Prints one design's lines; returns its figures."""
    clocks = sorted(run["mhz"] for run in runs)
    cells = {title: runs[0][title] for title in CELLS.values()}
    print("  " + ", ".join(f"{count:,} {title}" for title, count in cells.items()))
    print(
        f"  routed: {statistics.median(clocks):.1f} MHz"
        + (f" (median of {len(clocks)} placements, {clocks[0]:.1f} to {clocks[-1]:.1f})" if len(clocks) > 1 else "")
        + f", {CLOCK_MHZ} MHz {'kept' if clocks[0] >= CLOCK_MHZ else 'not kept'}"
        + f"; wires are {runs[0]['routing_share']:.0%} of the longest path"
    )
    if xilinx:
        print("  7 series, not placed: " + ", ".join(f"{count:,} {title}" for title, count in xilinx.items()))
    return {"cells": cells, "placements": runs, "median_mhz": statistics.median(clocks), "xilinx": xilinx}


def report(name, arguments):
    """Prints what becomes of one design; returns whether it keeps the clock as it has to, and its figures."""
    parameters, folder = variant(
        PARAMETERS[name], arguments.channels, arguments.work, "board_" * arguments.board + name
    )
    device = arguments.device or DEVICES[name]
    print(f"== {folder.name}, LFE5U-{device[:-1]}F", flush=True)
    top, options = TOP, ["--out-of-context"]
    files = sources = design_sources(folder / "generated")
    if arguments.board:
        top = BOARD_TOP
        files = [*sources, *rtl_sources.read_list(BOARD_LIST)]
        options = ["--lpf", str(BOARD_PINS), "--textcfg", str(folder / "board_{seed}.config")]
    netlist = folder / "ecp5.json"
    check = not (arguments.no_gate or arguments.board)
    flow = [f"synth_ecp5 -top {top} -json {netlist}", *(for_verilator(top, folder) if check else [])]
    synthesise(files, parameters, top, folder, "; ".join(flow))
    checked = {}
    if check:
        checked["identical"], text = gate(sources, parameters, folder, SAMPLES[name], 1, cell_models(folder))
        print(f"  netlist against RTL, seed 1: {text}", flush=True)
    seeds = range(arguments.seed, arguments.seed + arguments.seeds)
    runs = [place(netlist, options, device, seed, folder) for seed in seeds]
    xilinx = xilinx_cells(files, parameters, top, folder) if arguments.xilinx else None
    result = {"device": device, **checked, **describe(runs, xilinx)}
    if arguments.board:
        bitstream = folder / f"{BOARD_TOP}.bit"
        packer = find("ecppack", "fpga-trellis of Debian 13")
        fastest = max(runs, key=lambda run: run["mhz"])["seed"]
        run([packer, "--compress", str(folder / f"board_{fastest}.config"), str(bitstream)], folder / "ecppack.log")
        print(f"  bitstream of seed {fastest}: {bitstream}")
    kept = name in MISSES_THE_CLOCK or min(run["mhz"] for run in runs) >= CLOCK_MHZ
    return kept and checked.get("identical", True), result


def main():
    parser = argparse.ArgumentParser(usage=__doc__.split("usage: ")[1], add_help=True)
    parser.add_argument("--arithmetic", choices=PARAMETERS)
    parser.add_argument("--channels", type=int, choices=range(1, 17), default=1, metavar="N")
    parser.add_argument("--board", action="store_true")
    parser.add_argument("--device", choices=["25k", "45k", "85k"])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--seeds", type=int, choices=range(1, 101), default=1, metavar="N")
    parser.add_argument("--no-gate", action="store_true")
    parser.add_argument("--xilinx", action="store_true")
    parser.add_argument("--json")
    parser.add_argument("--work", default=ROOT / "build" / "route")
    arguments = parser.parse_args()
    passed, results = True, {}
    try:
        find("yosys", "yosys")
        find(*NEXTPNR)
        if arguments.board and arguments.channels > 1:
            raise ToolError("the board has one channel; leave out --channels or --board")
        for name in [arguments.arithmetic] if arguments.arithmetic else PARAMETERS:
            kept, results["board_" * arguments.board + name] = report(name, arguments)
            passed = passed and kept
        write_figures(arguments.json, {"channels": arguments.channels, "designs": results})
    except (ToolError, rtl_sources.RtlError) as error:
        print(f"route: {error}", file=sys.stderr)
        return 2
    return 0 if passed else 1


if __name__ == "__main__":
    sys.exit(main())
