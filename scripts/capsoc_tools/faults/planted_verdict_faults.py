"""Plants faults in the judgement of the self-calibration programs, one at a time; a test has to notice each.

usage: planted_verdict_faults [--match TEXT | --number N] [--work FOLDER]

The faults of tests/faults/verdicts.toml, in a copy of the tracked files; build/ is the built program. Noticed
means that tests/system/verdicts_test.py (without its random sensors), traces_test.py or papers_test.py (Table 9)
fails; without a fault both pass. Status 0: all noticed; 1: not all; 2: usage, a place that is not there exactly once,
or something does not build.
"""

import argparse
import json
import os
import re
import subprocess
import sys

from capsoc_tools.faults.planting import (
    ROOT,
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

# All but the random sensors, which take minutes.
VERDICTS = re.findall(
    r"^class (\w+)\(VerdictCase\)", (ROOT / "tests/system/verdicts_test.py").read_text(), re.MULTILINE
)
TESTS = (["verdicts_test.py", *VERDICTS], ["papers_test.py", "Table9"], ["traces_test.py"])


def passes(tree):
    environment = {
        **os.environ,
        "CAPSOC_TEST_BUILD": str(tree / "build"),
        "CAPSOC_TEST_SOURCE": str(tree),
        "PYTHONPATH": f"{tree / 'tests'}:{tree / 'scripts'}",
    }
    return all(
        subprocess.run(
            [sys.executable, str(tree / "tests" / "system" / name), "-f", *suites],
            env=environment,
            check=False,
            capture_output=True,
        ).returncode
        == 0
        for name, *suites in TESTS
    )


def try_fault(tree, fault, log):
    """Plants, builds, tests and restores; true if a test fails."""
    with planted(tree, fault):
        build(tree, ["firmware"], log)
        return not passes(tree)


def prepare(tree, log):
    """The tracked files with their firmware built, next to the program that is there; without a fault all passes."""
    copy_tree(tree)
    configure(tree, log)
    build(tree, ["firmware"], log)
    program = tree / "build" / "capsoc"
    program.unlink(missing_ok=True)
    program.symlink_to(ROOT / "build" / "capsoc")
    if not passes(tree):
        raise PlantError("without a fault the tests fail")


def try_one(faults, arguments):
    """For a campaign: a JSON object on stdout, all else on stderr."""
    fault = numbered(faults, arguments.number)
    with free_folder(arguments.work.resolve()) as work:
        prepare(work / "tree", work / "log")
        red = try_fault(work / "tree", fault, work / "log")
    print(json.dumps({"fault": fault["name"], "noticed": red}))
    return 0


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", 1)[0], prog="planted_verdict_faults")
    add_options(parser, "verdict_faults", jobs=False, numbered=True)
    arguments = parser.parse_args()
    noticed = 0
    try:
        faults = chosen("verdicts", arguments)
        if arguments.number is not None:
            return try_one(faults, arguments)
        with free_folder(arguments.work.resolve()) as work:
            tree, log = work / "tree", work / "log"
            prepare(tree, log)
            for fault in faults:
                red = try_fault(tree, fault, log)
                noticed += red
                print(f"{'noticed' if red else 'MISSED ':7}  {fault['name']}", flush=True)
    except PlantError as error:
        print(f"planted_verdict_faults: {error}", file=sys.stderr)
        return 2
    print(f"noticed: {noticed} of {len(faults)}")
    return 0 if noticed == len(faults) else 1


if __name__ == "__main__":
    sys.exit(main())
