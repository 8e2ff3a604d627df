"""Plants faults in the judgement of the self-calibration programs, one at a time; a test has to notice each.

usage: planted_verdict_faults [--match TEXT]

The faults of tests/faults/verdicts.toml, in a copy of the tracked files; build/ is the built program. Noticed
means that tests/system/verdicts_test.py (without its drawn sensors), traces_test.py or papers_test.py (Table 9)
fails; without a fault both pass. Status 0: all noticed; 1: not all; 2: usage, a place that is not there exactly once,
or something does not build.
"""

import argparse
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from capsoc_tools.faults.planting import ROOT, PlantError, add_options, build, chosen, configure, copy_tree, planted

# All but the drawn sensors, which take minutes.
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
    """Plants, builds, tests and mends; true if a test fails."""
    with planted(tree, fault):
        build(tree, ["firmware"], log)
        return not passes(tree)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", 1)[0], prog="planted_verdict_faults")
    add_options(parser, jobs=False)
    arguments = parser.parse_args()
    noticed = 0
    try:
        faults = chosen("verdicts", arguments)
        with tempfile.TemporaryDirectory(prefix="capsoc-faults-") as folder:
            tree, log = Path(folder) / "tree", Path(folder) / "log"
            copy_tree(tree)
            configure(tree, log)
            build(tree, ["firmware"], log)
            (tree / "build" / "capsoc").symlink_to(ROOT / "build" / "capsoc")
            if not passes(tree):
                raise PlantError("without a fault the tests fail")
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
