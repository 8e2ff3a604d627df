"""Synthesises the coprocessor for a Cyclone V and checks the netlist against the RTL.

usage: synth [--arithmetic precise|safety|paper|two-clocks|both] [--json FILE] [--no-units] [--no-gate]
             [--unit NAME] [--channels N] [--samples N] [--seed N] [--work FOLDER]

Prints, for each arithmetic (default: both): area next to Table 7 of the SoC paper, area of every unit,
the longest path, and the result of the netlist simulation. Both are without the safety mechanisms;
`safety` is `precise` with them, `two-clocks` is `paper` with two clocks an iteration, and both are part of both.
The limits (a third of the ALMs, a tenth of the DSP blocks, half of the registers) are for `precise`, 1.15 times
4,024 ALMs for `safety`; `paper` is shown without. `two-clocks` has to keep 25 MHz.

--no-units   leaves out the second synthesis, which keeps the hierarchy
--no-gate    leaves out the netlist simulation
--channels   of the coprocessor; default 1, and with more there are no limits
--unit       one module of rtl/ (parameters as they stand there) instead of the whole: area, path, and its
             netlist against its RTL with random inputs in Icarus
--samples    of the netlist simulation; default 3000 for precise, 300 for paper, 20000 inputs for a unit
--work       where netlists, logs and the simulation go; default build/synth

Status 0: limits kept, netlist and RTL identical; 1: not so; 2: a tool is missing or failed.
"""

import argparse
import re
import sys
from pathlib import Path

from capsoc_tools.rtl.synth_flow import (
    ROOT,
    RTL,
    STA_SECONDS,
    TOP,
    ToolError,
    design_sources,
    figures,
    find,
    longest_path,
    synthesise,
    total,
    variant,
    write_figures,
)
from capsoc_tools.rtl.synth_gate import gate, unit_gate

SAMPLES = {"precise": 3000, "safety": 3000, "paper": 300, "two-clocks": 300}
PARAMETERS = {
    "precise": {"Paper": 0, "Safety": 0},
    "safety": {"Paper": 0, "Safety": 1},
    "paper": {"Paper": 1, "Safety": 0},
    "two-clocks": {"Paper": 1, "Safety": 0, "IterationClocks": 2},
}

# Table 7 of the SoC paper (Quartus), and the limits that the pages set for `precise`.
TABLE_7 = {"alm": 12192, "dsp": 125, "registers": 7106}
LIMITS = {
    "precise": {"alm": 12192 // 3, "dsp": 125 // 10, "registers": 7106 // 2},
    "safety": {"alm": 4024 * 115 // 100, "dsp": 125 // 10},
    "paper": {},
    "two-clocks": {},
}
HAS_TO_KEEP_CLOCK = {"two-clocks"}
CLOCK_MHZ = 25  # of the paper's system, and of ours at reset
ROUTED = (1.6, 2.0)  # times the logic's time, logic and routing together: an assumption, nothing is placed here
FIGURES = [
    ("alm", "ALM (estimate)"),
    ("alm_upper", "ALM (upper estimate)"),
    ("dsp", "DSP blocks"),
    ("registers", "registers"),
    ("memory_bits", "memory bits"),
]
FORMULA = """\
ALM = ALUT6 + (ALUT2..5 + NOT + ALUT_ARITH + MLAB) / 2: all but 6-input functions share an ALM; 20 MLAB cells
of 32 bits fill ten. Upper estimate: every ALUT5 has an ALM to itself. Flip-flops (4 an ALM) ride along.
DSP blocks = 27x27 + (18x18) / 2 + (9x9) / 3, each rounded up. No placement: Quartus may differ by a fifth.
Method: yosys synth_intel_alm -family cyclonev -nodsp, flattened; multipliers and rtl/add_subtract.sv are put
on their cells by this script, because yosys 0.23 loses signs of the former and the inverter in the latter."""


def print_area(limits, area):
    """The table; returns whether the limits are kept."""
    kept = True
    print(f"{'':24}{'here':>10}{'Table 7':>10}{'share':>9}{'limit':>9}")
    for key, title in FIGURES:
        line = f"{title:24}{area[key]:10,}"
        if key in TABLE_7:
            line += f"{TABLE_7[key]:10,}{area[key] / TABLE_7[key]:9.1%}"
            if limit := limits.get(key):
                passed = area[key] <= limit
                kept = kept and passed
                line += f"{limit:9,}  {'pass' if passed else 'FAIL'}"
        print(line)
    print(FORMULA)
    return kept


def plain(module):
    """`$paramod...\\name\\Parameter=...` as the name alone."""
    found = re.search(r"\\(\w+)", module) if module.startswith("$paramod") else None
    return found.group(1) if found else module


def print_units(cells):
    print("\nunits (hierarchy kept, so the sum is more than the whole; a unit includes those below it)")
    print(f"  {'':34}{'count':>6}{'ALM':>8}{'DSP':>6}{'registers':>11}{'bits':>8}")
    rows = []

    def walk(module, depth, count):
        area = figures(total(cells, module))
        rows.append({"unit": plain(module), "depth": depth, "count": count, **area})
        print(
            f"  {'  ' * depth + plain(module):34}{count:6}{area['alm']:8,}{area['dsp']:6}"
            f"{area['registers']:11,}{area['memory_bits']:8,}"
        )
        below = [(kind.lstrip("\\"), number) for kind, number in cells[module].items()]
        for kind, number in sorted(below, key=lambda item: plain(item[0])):
            if kind in cells and depth < 3:
                walk(kind, depth + 1, number)

    walk(next(name for name in cells if plain(name) == TOP), 0, 1)
    return rows


def report_unit(unit, arguments):
    if not (RTL / f"{unit}.sv").exists():
        raise ToolError(f"there is no {unit}.sv in rtl/")
    folder = Path(arguments.work).resolve() / unit
    folder.mkdir(parents=True, exist_ok=True)
    sources = design_sources(folder / "generated")
    cells = synthesise(sources, {}, folder, True, unit)
    area = figures(total(cells, next(iter(cells))))
    print(f"{unit}: " + ", ".join(f"{area[key]:,} {title}" for key, title in FIGURES))
    same, text = (True, "") if arguments.no_gate else unit_gate(unit, sources, folder, arguments.samples or 20000)
    print(f"netlist against RTL: {text}" if text else "netlist not simulated")
    return same, {"area": area, "identical": same}


def report(name, arguments):
    parameters, folder = variant(PARAMETERS[name], arguments.channels, arguments.work, name)
    limits = LIMITS[name] if arguments.channels == 1 else {}
    sources = design_sources(folder / "generated")
    print(f"== {folder.name}", flush=True)
    cells = synthesise(sources, parameters, folder, True)
    area = figures(total(cells, next(iter(cells))))
    passed = print_area(limits, area)
    result = {"area": area, "limits": limits or None, "limits_kept": passed}
    path = longest_path(folder)
    if path is None:
        print(f"\nlongest path: yosys sta was stopped after {STA_SECONDS} s", flush=True)
        result["longest_path_ns"] = None
    else:
        delay, levels = path
        result["longest_path_ns"] = delay
        slowest, fastest = (1000 / delay / factor for factor in reversed(ROUTED))
        result["f_max_mhz"] = [slowest, fastest]
        if name in HAS_TO_KEEP_CLOCK:
            passed = passed and slowest >= CLOCK_MHZ
        kept = "kept" if slowest >= CLOCK_MHZ else "not kept" if fastest < CLOCK_MHZ else "not sure"
        print(
            f"\nlongest path {delay:.1f} ns, {levels} cells: yosys sta with the cell delays of Cyclone V, logic only\n"
            f"f_max {slowest:.1f} to {fastest:.1f} MHz with routing ({ROUTED[0]} to {ROUTED[1]} times the logic's "
            "time); "
            f"the paper's {CLOCK_MHZ} MHz: {kept}",
            flush=True,
        )
    if not arguments.no_units:
        result["units"] = print_units(synthesise(sources, parameters, folder, False))
    if not arguments.no_gate:
        samples = arguments.samples or SAMPLES[name]
        same, text = gate(sources, parameters, folder, samples, arguments.seed)
        print(f"\nnetlist against RTL, seed {arguments.seed}: {text}", flush=True)
        result["netlist"] = {"identical": same, "samples": samples, "seed": arguments.seed}
        passed = passed and same
    return passed, result


def main():
    parser = argparse.ArgumentParser(usage=__doc__.split("usage: ")[1], add_help=True)
    parser.add_argument("--arithmetic", choices=[*PARAMETERS, "both"], default="both")
    parser.add_argument("--json")
    parser.add_argument("--no-units", action="store_true")
    parser.add_argument("--no-gate", action="store_true")
    parser.add_argument("--unit")
    parser.add_argument("--channels", type=int, choices=range(1, 17), default=1, metavar="N")
    parser.add_argument("--samples", type=int)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--work", default=ROOT / "build" / "synth")
    arguments = parser.parse_args()
    names = list(PARAMETERS) if arguments.arithmetic == "both" else [arguments.arithmetic]
    passed, results = True, {}
    try:
        needed = [("yosys", "yosys")]
        if arguments.unit:
            passed, results[arguments.unit] = report_unit(arguments.unit, arguments)
            names = []
        elif not arguments.no_gate:
            needed += [("verilator", "verilator"), ("make", "make"), ("g++", "g++")]
        for tool, package in needed:
            find(tool, package)
        for name in names:
            kept, results[name] = report(name, arguments)
            passed = passed and kept
        write_figures(arguments.json, {"table_7": TABLE_7, "channels": arguments.channels, **results})
    except ToolError as error:
        print(f"synth: {error}", file=sys.stderr)
        return 2
    return 0 if passed else 1


if __name__ == "__main__":
    sys.exit(main())
