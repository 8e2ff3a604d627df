"""Breaks one thing at a time in the translator, and demands that a test of the processor notices it.

usage: planted_translator_faults [--match TEXT | --number N] [--jobs N] [--work FOLDER]

Copies the tree's sources to FOLDER (default build/translator_faults), and for each fault of
tests/faults/translator.toml exchanges the text, builds armv7m_test, and runs its tests of the translator
until the first one fails. A test that crashes or does not end has noticed it, too. Without a fault all have to pass.

--number N: the N-th fault of the list alone, and its outcome as a JSON object, for a campaign that shares them out
(campaigns/translator_faults.toml).

Status 0: every fault was noticed; 1: one was not, or the tests fail without; 2: a fault's place is not there exactly
once, or something does not build.
"""

import argparse
import json
import re
import subprocess
import sys
import time
from pathlib import Path

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
)

TARGET = "armv7m_test"
FILTER = (
    "*Translator*:Borders.*:Literals.*:StackPointer.*:OverTheEnd*:Flags.*:Limits.*:Branches.*:Unaligned.*:"
    "Operands.*:Windows.*:Rooms.*:Instructions.*:*VectorWrites*:VectorTable.*:"
    "BesideCode.*:JumpCache.*:ProcessStack.*:*SinglePrecision*/0:*SinglePrecisionModes*"
)
MOST_SECONDS = 120  # of the tests, which take ten


def failing(tree, log):
    """The first test that does not pass, or how the program ended; empty if all pass."""
    command = [
        tree / "build/tests/armv7m" / TARGET,
        f"--gtest_filter={FILTER}",
        "--gtest_fail_fast",
        "--gtest_brief=0",
    ]
    try:
        done = subprocess.run(command, cwd=tree, capture_output=True, timeout=MOST_SECONDS, check=False)
        code, said = done.returncode, done.stdout.decode(errors="replace")
    except subprocess.TimeoutExpired as expired:
        code, said = "no end", (expired.stdout or b"").decode(errors="replace")
    log.write_text(said, encoding="utf-8")
    if code == 0:
        return ""
    failed = re.search(r"^\[  FAILED  \] ([^, ]+)", said, re.M)
    begun = re.findall(r"^\[ RUN      \] (.*)$", said, re.M)
    return failed[1] if failed else f"{begun[-1] if begun else '?'} ({code})"


def try_fault(tree, fault, jobs, logs):
    """Plants, builds, restores; what failing() says then."""
    with planted(tree, fault):
        build(tree, [TARGET], logs.with_suffix(".build.log"), jobs)
    return failing(tree, logs.with_suffix(".log"))


def prepare(tree, work):
    copy_tree(tree)
    configure(tree, work / "configure.log", "-DCAPSOC_TESTS=ON")


def try_one(faults, arguments):
    """For a campaign; 0 if the fault was noticed."""
    fault = numbered(faults, arguments.number)
    with free_folder(arguments.work.resolve()) as work:
        prepare(work / "tree", work)
        said = try_fault(work / "tree", fault, arguments.jobs, work / str(arguments.number))
    print(json.dumps({"fault": fault["name"], "file": Path(fault["file"]).name, "noticed": said != "", "by": said}))
    return 0 if said else 1


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    add_options(parser, "translator_faults", numbered=True)
    arguments = parser.parse_args()
    work = arguments.work.resolve()
    tree = work / "tree"
    noticed = 0
    try:
        faults = chosen("translator", arguments)
        if arguments.number is not None:
            return try_one(faults, arguments)
        prepare(tree, work)
        build(tree, [TARGET], work / "unbroken-build.log", arguments.jobs)
        if said := failing(tree, work / "unbroken.log"):
            print(f"without a fault: {said}")
            return 1
        print(f"{'fault':<70} {'file':<20} {'s':>4}  noticed by")
        for number, fault in enumerate(faults, 1):
            begin = time.monotonic()
            said = try_fault(tree, fault, arguments.jobs, work / str(number))
            noticed += said != ""
            file, seconds = Path(fault["file"]).name, time.monotonic() - begin
            print(f"{fault['name']:<70} {file:<20} {seconds:>4.0f}  {said or 'NOT NOTICED'}", flush=True)
    except PlantError as error:
        print(f"planted_translator_faults: {error}", file=sys.stderr)
        return 2
    print(f"noticed: {noticed} of {len(faults)}")
    return 0 if noticed == len(faults) else 1


if __name__ == "__main__":
    sys.exit(main())
