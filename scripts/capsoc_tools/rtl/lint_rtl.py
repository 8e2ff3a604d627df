"""Reads the RTL with three tools and fails if one of them has anything to say.

usage: lint_rtl [-h]

verilator --lint-only -Wall and yosys for the top in both arithmetics, with two clocks an iteration and with several
channels, iverilog -g2012 -Wall (compile only); verilator for the probe with its nodes, too. The same three for the
tops of rtl/wrappers; of them, yosys also says whether a path leads from an input to an output of the bus. And the same
three for the tops of rtl/board. Status 0: silence; 1: the messages are printed; 2: a tool is missing.
"""

import functools
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from capsoc_tools.rtl.sources import BOARD, DESIGN, PROBE, ROOT, RTL, WRAPPERS, RtlError, generate, read_list
from capsoc_tools.rtl.yosys_types import read_design

WAIVERS = RTL / "lint" / "verilator.vlt"
TOP = "coprocessor"
DESIGNS = {
    "precise": (("Paper", 0),),
    "paper": (("Paper", 1),),
    "two clocks": (("Paper", 1), ("IterationClocks", 2)),
    "four channels": (("Paper", 0), ("Channels", 4)),
    "sixteen channels": (("Paper", 1), ("Channels", 16)),
}
PROBE_TOP = "coprocessor_probe"
# The tops of rtl/wrappers, and their outputs that registers alone must determine: IHI 0022E, A3.1.1, allows no other
# path in AXI; in AHB-Lite one to HREADYOUT would lead through HREADY of the bus.
WRAPPER_TOPS = {
    "capsoc_coprocessor_ahb_lite": (3, "o:hreadyout_o o:hresp_o o:hrdata_o"),
    "capsoc_coprocessor_axi4_lite": (8, "o:awready_o o:wready_o o:b*_o o:arready_o o:r*_o"),
}
# The tops of rtl/board: no output may depend on a pin without a register between.
BOARD_TOPS = ("capsoc_board_ulx3s",)

# What the tools say that is no finding:
# - Icarus 11, of every constant bit select in always_comb: the process is then sensitive to the whole vector. That
#   costs time and changes nothing.
# - Icarus 12, of a member of a struct in a port connection: it names the width of the struct, and connects the member.
#   Verilator knows the width.
# - Verilator 5.032: what it took and how long.
NOTES = re.compile(
    r"sorry: constant selects in always_\* processes are not currently supported"
    r"|^- V e r i l a t i o n|^- Verilator: (Built|Walltime)"
)
ICARUS_12_NOTES = re.compile(
    r"warning: Port \d+ \(\w+\) of \w+ expects \d+ bits, got \d+\.|: Pruning \d+ high bits of the expression"
)


@functools.cache
def takes_members_for_structs():
    """Whether Icarus is a version that ICARUS_12_NOTES is about."""
    version = subprocess.run(["iverilog", "-V"], capture_output=True, text=True, check=False).stdout
    return re.match(r"Icarus Verilog version 1[2-9]", version) is not None


def said(command):
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=ROOT)
    lines = [line for line in (done.stdout + done.stderr).splitlines() if line.strip() and not NOTES.search(line)]
    if command[0] == "iverilog" and takes_members_for_structs():
        lines = [line for line in lines if not ICARUS_12_NOTES.search(line)]
    if done.returncode and not lines:
        lines = [f"status {done.returncode} without a message"]
    return lines


def checks(files, probe, folder):
    names = [str(path) for path in files]
    read = read_design(files, folder)
    for label, parameters in DESIGNS.items():
        settings = [f"-P{TOP}.{name}={value}" for name, value in parameters]
        generics = [f"-G{name}={value}" for name, value in parameters]
        yield (
            f"verilator, {label}",
            ["verilator", "--lint-only", "-Wall", *generics, "--top-module", TOP, str(WAIVERS), *names],
        )
        # What the probe takes out is as wide as the list of nodes says.
        yield (
            f"verilator, probe, {label}",
            [
                "verilator",
                "--lint-only",
                "-Wall",
                *generics,
                "--top-module",
                PROBE_TOP,
                f"-I{folder}",
                str(WAIVERS),
                *names,
                *map(str, probe),
            ],
        )
        yield (
            f"yosys, {label}",
            [
                "yosys",
                "-q",
                "-p",
                f"{read}; "
                + "".join(f"chparam -set {name} {value} {TOP}; " for name, value in parameters)
                + f"hierarchy -check -top {TOP}; proc; check -assert",
            ],
        )
        yield (
            f"iverilog, {label}",
            ["iverilog", "-g2012", "-Wall", *settings, "-s", TOP, "-t", "null", *names],
        )


def around_checks(top, files, folder, outputs):
    """A top around the design. The arithmetic is inside and read above: one of them is enough. Registers alone must
    determine what the selection `outputs` of yosys names."""
    names = [str(path) for path in files]
    verilator = ["verilator", "--lint-only", "-Wall", "--top-module", top, str(WAIVERS), *names]
    yield f"verilator, {top}", verilator
    script = f"{read_design(files, folder)}; hierarchy -check -top {top}; proc; check -assert; flatten; "
    script += f"opt_clean; {outputs}; select -assert-none @outputs %ci*:-$dff:-$adff i:* %i"
    yield f"yosys, {top}", ["yosys", "-q", "-p", script]
    yield f"iverilog, {top}", ["iverilog", "-g2012", "-Wall", "-s", top, "-t", "null", *names]


def wrapper_checks(files, folder):
    for top, (count, outputs) in WRAPPER_TOPS.items():
        selection = f"select -set outputs {outputs}; select -assert-count {count} @outputs"
        yield from around_checks(top, files, folder, selection)


def board_checks(files, folder):
    for top in BOARD_TOPS:
        yield from around_checks(top, files, folder, "select -set outputs o:*")


def main(arguments):
    if arguments:
        print(__doc__.strip(), file=sys.stderr if arguments != ["-h"] else sys.stdout)
        return 0 if arguments == ["-h"] else 2
    missing = [tool for tool in ("verilator", "yosys", "iverilog") if not shutil.which(tool)]
    if missing:
        print(f"lint_rtl: {', '.join(missing)} not found; install scripts/packages.txt", file=sys.stderr)
        return 2
    failed = False
    with tempfile.TemporaryDirectory() as folder:
        try:
            files = [*generate(Path(folder), nodes=True), *read_list(RTL / DESIGN)]
            probe = read_list(RTL / PROBE)
        except RtlError as error:
            print(f"lint_rtl: {error}", file=sys.stderr)
            return 2
        wrapped = wrapper_checks([*files, *read_list(RTL / WRAPPERS)], folder)
        board = board_checks([*files, *read_list(RTL / BOARD)], folder)
        for name, command in (*checks(files, probe, folder), *wrapped, *board):
            lines = said(command)
            print(f"{name}: {len(lines)} lines" if lines else f"{name}: clean")
            print("".join(f"  {line}\n" for line in lines), end="")
            failed = failed or bool(lines)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
