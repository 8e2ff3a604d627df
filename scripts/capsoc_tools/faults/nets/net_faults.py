"""Sticks nets of the synthesised coprocessor at 0 and 1, one at a time, and says what software would see of it.

usage: net_faults [--nets N] [--seed S] [--samples N] [--reference numeric|angle] [--error-limit N] [--step-limit N]
                  [--jobs N] [--rows FILE.csv] [--work FOLDER]

Synthesises the coprocessor with its safety mechanisms as scripts/tool synth does, and draws nets of the netlist, each
as likely as another one. The netlist is Verilated. It runs in calibration mode with lock and all mechanisms on, a
turn in 256 samples; each fault begins there and lasts. Software reads FLAGS, SAMPLES, STATUS and ANGLE of each sample.
The limits are the fields of SAFETY: errors of 2^-N of full scale, steps of 2^-(N+1) turn.

silent    an angle was more than 0.1 deg off for more than 3 samples, and nothing showed it
detected  a mechanism, a flag, VALID, LOCK, SAMPLES, a lost interrupt or an error of the bus showed it
wrong     an angle was off for 3 samples at the most
latent    no angle was off; some bit that software reads differs
unseen    software reads the same as without the fault

Status 0: the table was printed; 2: usage, or a tool is missing or failed.
"""

import argparse
import collections
import csv
import random
import re
import subprocess
import sys
from pathlib import Path

from capsoc_tools import ROOT
from capsoc_tools.faults.fault_verdicts import wilson
from capsoc_tools.rtl.synth import PARAMETERS
from capsoc_tools.rtl.synth_flow import TOP, ToolError, design_sources, synthesise
from capsoc_tools.rtl.synth_gate import build_program, techlib_cells, verilate

HERE = Path(__file__).resolve().parent
REFERENCES = {"numeric": 0, "angle": 2}  # CTRL.REF
VERDICTS = ("silent", "wrong", "detected", "latent", "unseen")
#: Ports of the cells that drive nets.
OUTPUTS = {"Q", "SO", "CO", "Y", "B1DATA"}
CELL = re.compile(r"^  (MISTRAL_\w+) (?:#\(.*?\n  \) )?(\S+) +\(\n(.*?)\n  \);", re.M | re.S)
PORT = re.compile(r"\.(\w+)\(([^()]*)\)")


def short_names(text):
    """The netlist with short names of its nets, and what they were: Verilator makes ten times as much of long ones."""
    names = {}

    def short(match):
        return names.setdefault(match[1], f"w{len(names)}") + " "

    return re.sub(r"\\(\S+) ", short, text), {new: old for old, new in names.items()}


def drivers(text):
    """Net by net the kind of its cell, and where the name stands in the output's connection."""
    found = {}
    for cell in CELL.finditer(text):
        for port in PORT.finditer(cell[3]):
            if port[1] not in OUTPUTS:
                continue
            for net in re.finditer(r"\b[nw]\d+\b(?! *\[)", port[2]):
                start = cell.start(3) + port.start(2)
                found[net[0]] = (cell[1].removeprefix("MISTRAL_"), start + net.start(), start + net.end())
    return found


def with_stuck_nets(text, nets, places):
    """The netlist, each net with a value of its driver and one that may be stuck."""
    count = len(nets)
    for start, end in sorted(((places[net][1], places[net][2]) for net in nets), reverse=True):
        text = f"{text[:end]}_driven{text[end:]}" if text[start:end] else text
    header, body = text.split(");\n", 1)
    lines = [
        "  input [15:0] stuck_net_i;",
        "  input stuck_value_i;",
        f"  reg [{count - 1}:0] stuck_0, stuck_1;",
        "  always @* begin",
        "    stuck_0 = 0; stuck_1 = 0;",
        f"    if (stuck_net_i < {count}) begin",
        "      if (stuck_value_i) stuck_1[stuck_net_i] = 1'b1; else stuck_0[stuck_net_i] = 1'b1;",
        "    end",
        "  end",
    ]
    for i, net in enumerate(nets):
        lines += [f"  wire {net}_driven;", f"  assign {net} = stuck_1[{i}] | ({net}_driven & ~stuck_0[{i}]);"]
    return f"{header}, stuck_net_i, stuck_value_i);\n" + "\n".join(lines) + "\n" + body


def build(nets_wanted, seed, folder):
    """The program, and name and cell of each net that can be stuck in it."""
    sources = design_sources(folder / "generated")
    synthesise(sources, PARAMETERS["safety"], folder, True, hide=False)
    text, names = short_names((folder / "netlist.v").read_text())
    places = drivers(text)
    nets = random.Random(seed).sample(sorted(places), min(nets_wanted, len(places)))
    (folder / "stuck.v").write_text(with_stuck_nets(text, nets, places))
    name = f"{TOP}_netlist"
    verilate(name, [str(folder / "stuck.v"), *techlib_cells(folder)], folder, [])
    build_program(HERE / "stuck_nets.cpp", [folder / name], [ROOT / "build" / "generated", ROOT / "models"], folder)
    return [(names.get(net, net), places[net][0]) for net in nets], len(places)


def simulate(folder, nets, options):
    """The program's lines, one a fault."""
    words = [nets, options.samples, REFERENCES[options.reference], options.error_limit, options.step_limit]
    running = [
        subprocess.Popen(
            [str(folder / "stuck_nets"), *map(str, words), str(part), str(options.jobs)],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        for part in range(options.jobs)
    ]
    rows = []
    for process in running:
        out, said = process.communicate()
        if process.returncode:
            raise ToolError(f"stuck_nets failed: {said.strip()}")
        rows += [line.split(None, 6) for line in out.splitlines()]
    if len(rows) != 2 * nets:
        raise ToolError(f"stuck_nets said nothing of {2 * nets - len(rows)} faults")
    return sorted(rows, key=lambda row: (int(row[0]), int(row[1])))


def print_table(rows, kinds):
    count = len(rows)
    verdicts = collections.Counter(row[2] for row in rows)
    for verdict in VERDICTS:
        low, high = wilson(verdicts[verdict], count)
        print(f"{verdict:10}{verdicts[verdict]:7}  {verdicts[verdict] / count:6.2%} ({low:.2%} to {high:.2%})")
    by = collections.Counter(row[6] for row in rows if row[2] == "detected")
    print("detected by: " + ", ".join(f"{name} {number}" for name, number in by.most_common()))
    wrong = [row for row in rows if row[2] in ("silent", "wrong") or int(row[4]) > 0 or int(row[3]) > 0]
    print(f"an angle off by more than 0.1 deg that software would have used: {len(wrong)}")
    for row in wrong:
        name, kind = kinds[int(row[0])]
        print(f"  {name} ({kind}) stuck at {row[1]}: {row[2]}, {row[4]} samples, {row[5]} deg, {row[6]}")


def main(words=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--nets", type=int, default=500)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--samples", type=int, default=256)
    parser.add_argument("--reference", choices=REFERENCES, default="numeric")
    parser.add_argument("--error-limit", type=int, default=6)
    parser.add_argument("--step-limit", type=int, default=6)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--rows", type=Path)
    parser.add_argument("--work", type=Path, default=ROOT / "build" / "nets")
    options = parser.parse_args(words)
    folder = options.work.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    try:
        kinds, of_all = build(options.nets, options.seed, folder)
        print(
            f"{len(kinds)} of {of_all} nets, seed {options.seed}, stuck at 0 and at 1, {options.samples} samples each"
        )
        rows = simulate(folder, len(kinds), options)
    except ToolError as error:
        print(f"net_faults: {error}", file=sys.stderr)
        return 2
    print_table(rows, kinds)
    if options.rows:
        with options.rows.open("w", newline="", encoding="utf-8") as file:
            out = csv.writer(file)
            out.writerow(["net", "cell", "stuck at", "verdict", "after samples", "trusted", "largest deg", "by"])
            out.writerows([*kinds[int(row[0])], *row[1:]] for row in rows)
    return 0


if __name__ == "__main__":
    sys.exit(main())
