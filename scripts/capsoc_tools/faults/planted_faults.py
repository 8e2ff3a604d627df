"""Breaks one thing at a time in the RTL or in the model, and demands that lockstep names it.

usage: planted_faults [--match TEXT | --number N] [--jobs N] [--work FOLDER] [--at-pins]

Copies the tree's sources to FOLDER (default build/planted), and for each fault of tests/faults/lockstep.toml
exchanges the text, builds, and runs the main job with `--coprocessor lockstep` (or the regression's scenario that the
fault names). Of the RTL it builds the library that is not specialised, which takes seconds. The run has to end with
exit code 4 and its report has to name what the fault says. The table's last columns: samples that the coprocessor had
taken when it was seen, and cycles from the newest of them to the report (a sample's way through the pipeline is 161
cycles). At the end the unbroken tree has to agree.

--at-pins: only the RTL's faults, in a design of which only the pins are known (tests/rtl/own_design). The regression
has to end with exit code 4, whatever it names, since there is no node to name.

--number N: the N-th fault of the list alone, and its outcome as a JSON object, for a campaign that shares them out
(campaigns/planted_faults.toml).

Status 0: every fault was named; 1: one was not, or the unbroken tree differs; 2: a fault's place is not there exactly
once, or something does not build.
"""

import argparse
import json
import re
import sys
from pathlib import Path

from capsoc_tools.rtl import sources as rtl_sources
from capsoc_tools.faults.planting import (
    PlantError,
    add_options,
    build,
    chosen,
    configure,
    copy_tree,
    free_folder,
    numbered,
    planted,
    run,
)

SIMULATED_SECONDS = "3"
REPORT = re.compile(r"^ +(what|first node) .*$", re.M)


def library_of(arithmetic):
    return f"capsoc_rtl_{arithmetic}_fast"


def arithmetic_of(fault):
    return fault.get("arithmetic", "precise")


def make(tree, fault, log, jobs):
    """What compare() needs for the fault."""
    build(tree, ("capsoc", "firmware", library_of(arithmetic_of(fault))), log, jobs)


def compare(tree, fault, log):
    capsoc = tree / "build" / "capsoc"
    arithmetic = arithmetic_of(fault)
    library = tree / "build" / f"lib{library_of(arithmetic)}.so"
    if "scenario" in fault:
        command = [
            capsoc,
            "regress",
            "--arithmetic",
            arithmetic,
            "--rtl-library",
            library,
            "--scenario",
            *fault["scenario"].split(),
            "--seeds",
            "1",
        ]
    else:
        command = [
            capsoc,
            "run",
            "--arithmetic",
            arithmetic,
            "--coprocessor",
            "lockstep",
            "-C",
            f"coprocessor.rtl_library={library}",
            "--simlimit",
            SIMULATED_SECONDS,
            "--uart0",
            "null",
            "-C",
            f"results.waves={log.with_suffix('.fst')}",
        ]
    return run(command, log)


def design_sources(tree):
    """The coprocessor's, the generated ones as the tree's build made them."""
    generated = [tree / "build" / "generated" / f"capsoc_coprocessor_{part}.sv" for part in ("pkg", "selects")]
    table = tree / "build" / "platform" / "simulation" / "rtl" / "generated" / "paper_sine_table.sv"
    return [*generated, table, *rtl_sources.read_list(tree / "rtl" / rtl_sources.DESIGN)]


def compare_at_pins(tree, fault, jobs, logs):
    """The same design with other names, built by capsoc's CMake function as a user would build it."""
    arithmetic = arithmetic_of(fault)
    folder = logs.parent / f"pins-{arithmetic}"
    options = [
        f"-Dcapsoc_DIR={tree / 'cmake'}",
        f"-DARITHMETIC={arithmetic}",
        "-DCMAKE_BUILD_TYPE=Release",
        "-DCORE_SOURCES=" + ";".join(map(str, design_sources(tree))),
    ]
    log = logs.with_suffix(".build.log")
    code, _ = run(["cmake", "-S", tree / "tests/rtl/own_design/project", "-B", folder, "-G", "Ninja", *options], log)
    code = code or run(["cmake", "--build", folder, "-j", str(jobs), "--target", "angle_unit"], log)[0]
    if code:
        raise PlantError(f"the build failed; see {log}")
    scenarios = [
        word for name in fault.get("scenario", "").replace("--scenario", " ").split() for word in ("--scenario", name)
    ]
    return run(
        [
            tree / "build" / "capsoc",
            "regress",
            "--arithmetic",
            arithmetic,
            "--rtl-library",
            folder / "libangle_unit.so",
            "--seeds",
            "1",
            "--samples",
            "20000",
            "--accesses",
            "5000",
            "--jobs",
            str(jobs),
            *scenarios,
        ],
        logs.with_suffix(".log"),
    )


def samples_until(text):
    """Samples in the report's list, and the cycles from the newest one to the difference."""
    cycle = re.search(r"differ at cycle (\d+)", text)
    listed = re.search(r"^last samples.*\n((?: .*\n)*)", text, re.M)
    edges = [int(edge) for edge in re.findall(r"^ +(\d+)", listed[1], re.M)] if listed else []
    if not cycle or not edges:
        return "", ""
    return str(len(edges)) if len(edges) < 16 else "16 or more", str(int(cycle[1]) - edges[-1])


def prepare(tree, work, arguments):
    copy_tree(tree)
    configure(tree, work / "configure.log")
    if arguments.at_pins:
        build(tree, ("capsoc", "capsoc_rtl_hash"), work / "build.log", arguments.jobs)


def is_named(fault, code, text, arguments):
    return code == 4 and (arguments.at_pins or re.search(fault["names"], text) is not None)


def said_by(text):
    return "; ".join([re.sub(r"\s+", " ", m[0].strip()) for m in REPORT.finditer(text)][:2])


def try_one(faults, arguments):
    """For a campaign; 0 if the fault was named."""
    fault = numbered(faults, arguments.number)
    with free_folder(arguments.work.resolve()) as work:
        tree = work / "tree"
        prepare(tree, work, arguments)
        code, text = try_fault(tree, fault, arguments, work / str(arguments.number))
    named = is_named(fault, code, text, arguments)
    samples, cycles = samples_until(text)
    print(
        json.dumps(
            {
                "fault": fault["name"],
                "file": fault["file"],
                "named": named,
                "exit": code,
                "samples": samples,
                "cycles": cycles,
                "report": said_by(text),
            }
        )
    )
    return 0 if named else 1


def try_fault(tree, fault, arguments, logs):
    """Plants, builds, compares and restores; returns exit code and report."""
    with planted(tree, fault):
        if arguments.at_pins:
            return compare_at_pins(tree, fault, arguments.jobs, logs)
        make(tree, fault, logs.with_suffix(".build.log"), arguments.jobs)
    return compare(tree, fault, logs.with_suffix(".log"))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    add_options(parser, "planted", numbered=True)
    parser.add_argument("--at-pins", action="store_true")
    arguments = parser.parse_args()
    tree = arguments.work.resolve() / "tree"
    named, agree = 0, True
    try:
        faults = chosen("lockstep", arguments, lambda f: f["file"].startswith("rtl/") or not arguments.at_pins)
        if arguments.number is not None:
            return try_one(faults, arguments)
        prepare(tree, arguments.work, arguments)
        print(f"{'fault':<48} {'file':<24} {'samples':>10} {'cycles':>6}  report")
        for number, fault in enumerate(faults, 1):
            code, text = try_fault(tree, fault, arguments, arguments.work.resolve() / str(number))
            was_named = is_named(fault, code, text, arguments)
            named += was_named
            samples, cycles = samples_until(text)
            print(
                f"{fault['name']:<48} {Path(fault['file']).name:<24} {samples:>10} {cycles:>6}  "
                f"{'' if was_named else 'NOT NAMED, exit ' + str(code) + ': '}{said_by(text)}",
                flush=True,
            )
        for arithmetic in ("precise", "paper"):
            whole, logs = {"arithmetic": arithmetic}, arguments.work.resolve() / f"unbroken-{arithmetic}"
            if arguments.at_pins:
                is_same = compare_at_pins(tree, whole, arguments.jobs, logs)[0] == 0
            else:
                make(tree, whole, logs.with_suffix(".build.log"), arguments.jobs)
                is_same = compare(tree, whole, logs.with_suffix(".log"))[0] == 124
            agree = agree and is_same
            print(f"unbroken, {arithmetic}: {'model and RTL agree' if is_same else 'they DIFFER'}")
    except (PlantError, rtl_sources.RtlError) as error:
        print(f"planted_faults: {error}", file=sys.stderr)
        return 2
    print(f"named: {named} of {len(faults)}")
    return 0 if named == len(faults) and agree else 1


if __name__ == "__main__":
    sys.exit(main())
