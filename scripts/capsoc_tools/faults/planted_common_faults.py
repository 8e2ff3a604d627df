"""Breaks one thing at a time in the coprocessor's model, and demands that the third reading of its page notices.

usage: planted_common_faults [--match TEXT] [--drawn N [--seed N]] [--jobs N] [--work FOLDER]

A fault in the model stands for the same fault in model and RTL, which lockstep cannot see. tests/third_reading shares
no code with either. Copies the tree's sources to FOLDER (default build/common_faults). For each fault of
tests/faults/third_reading.toml it replaces the text and builds record_answers. check_answers.py then judges the first
scenario whose record differs from that of the model without the fault, with which the checker agrees. Scenarios are
those of both arithmetics, and of `paper` with the options of Table 8. With --drawn, N random faults from all places of
the model are used instead (mutation/model_faults.py). Not counted are faults that do not build, faults that compile to
the same program, and faults that tests/third_reading/equivalent_faults.toml lists with a reason. Each fault that is not
noticed is listed with its place. Without a fault everything has to agree.

Status 0: every fault of the list (97 % of the drawn ones that count) was noticed; 1: not so; 2: a fault's place is
not there exactly once, or something does not build.
"""

import argparse
import random
import shutil
import subprocess
import sys
import threading
import tomllib
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from itertools import zip_longest
from pathlib import Path

from capsoc_tools.faults.planting import (
    ROOT,
    PlantError,
    add_options,
    build,
    chosen,
    configure,
    copy_tree,
    plant,
    planted,
)

from capsoc_tools.faults.mutation import model_faults

# Not one to be noticed: a fault may leave a name unused, which must not end its build.
NO_ERRORS = {"name": "warnings are errors", "file": "CMakeLists.txt", "old": ":-Werror>)", "new": ":-Wno-error>)"}
EQUIVALENT = ROOT / "tests/third_reading/equivalent_faults.toml"
CHECKER = ROOT / "tests/third_reading/check_answers.py"
RECORDER = Path("build/platform/experiments/regress/record_answers")
RUNS = (
    ["--arithmetic", "precise"],
    ["--arithmetic", "paper"],
    [
        "--arithmetic",
        "paper",
        "--operand-bits",
        "16",
        "--reference-lead",
        "2",
        "--step-shift",
        "7",
        "--plain-arctangent",
    ],
)
DRAWN_PERCENT = 97
MOST_SECONDS = 30  # of a recording, which takes one
MOST_LINES = 200_000  # of one scenario that is given to the checker


def said_by_checker(lines):
    """What the checker says of a recording; empty if it agrees."""
    done = subprocess.run(
        [sys.executable, CHECKER, "-"], input="".join(lines), capture_output=True, text=True, check=False
    )
    if done.returncode:
        return (done.stdout + done.stderr).strip().removeprefix("-: ") or f"exit {done.returncode}"
    return ""


def wholes_of(recorder):
    """The recordings of the whole model, line by line, with every one of which the checker agrees."""
    wholes = []
    for run in RUNS:
        done = subprocess.run([recorder, "-", *run], capture_output=True, text=True, check=True)
        wholes.append(done.stdout.splitlines(keepends=True))
        if said := said_by_checker(wholes[-1]):
            raise PlantError(f"without a fault the third reading differs: {said}")
    return wholes


def first_difference(answers, whole):
    """The scenario in which a recording leaves the whole model's, as far as it goes; none if it does not."""
    lines = iter(answers)
    scenario = []
    for due, line in zip_longest(whole, lines):
        if line is None:  # it crashed, or left something out; the checker takes no such file
            return [*scenario, "the recording ends here\n"]
        if line.startswith("run "):
            scenario = []
        scenario.append(line)
        if line != due:
            for further in lines:
                if scenario[-1].startswith("e ") or len(scenario) > MOST_LINES:
                    break
                scenario.append(further)
            return scenario
    return None


def judged(recorder, wholes):
    """What the checker says of the first scenario that differs from the whole model's; empty if none does, or if it
    says nothing against any."""
    for run, whole in zip(RUNS, wholes):
        with subprocess.Popen(
            [recorder, "-", *run], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
        ) as answers:
            alarm = threading.Timer(MOST_SECONDS, answers.kill)
            alarm.start()
            try:
                scenario = first_difference(answers.stdout, whole)
            finally:
                ended = alarm.is_alive()
                alarm.cancel()
                answers.kill()
        if not ended:
            return "no end"
        if scenario is not None and (said := said_by_checker([whole[0], *scenario])):
            return said
    return ""


def judged_once(recorder, wholes):
    try:
        return judged(recorder, wholes)
    finally:
        recorder.unlink()


def make_recorder(tree, fault, recorder, log):
    """Leaves the recorder of the broken model; the tree is whole again."""
    with planted(tree, fault):
        build(tree, ["record_answers"], log)
        shutil.copy(tree / RECORDER, recorder)


def faults_of(arguments):
    if arguments.drawn:
        every = model_faults.every(ROOT)
        return random.Random(arguments.seed).sample(every, min(arguments.drawn, len(every)))
    return chosen("third_reading", arguments)


def listed_equivalents():
    """(file, line, operator) of the drawn faults that nothing outside can see."""
    listed = set()
    for entry in tomllib.loads(EQUIVALENT.read_text(encoding="utf-8"))["fault"]:
        file = f"{model_faults.FOLDER}/{entry['file']}"
        lines = [line.strip() for line in (ROOT / file).read_text(encoding="utf-8").splitlines()]
        if entry["line"] not in lines:
            raise PlantError(f"{EQUIVALENT.relative_to(ROOT)}: {entry['file']} has no line {entry['line']!r}")
        listed |= {(file, entry["line"], operator) for operator in entry["operators"]}
    return listed


def try_all(faults, arguments, tree, work, wholes):
    """Builds one after the other, and judges in the meantime. Returns how many faults had which end."""
    counts = Counter()
    equivalents = listed_equivalents()
    whole_program = (tree / RECORDER).read_bytes()
    with ThreadPoolExecutor(arguments.jobs) as pool:
        pending = []
        for number, fault in enumerate(faults):
            if (fault["file"], fault.get("line"), fault.get("operator")) in equivalents:
                counts["listed as equivalent"] += 1
                continue
            recorder = work / f"record_answers.{number}"
            try:
                make_recorder(tree, fault, recorder, work / "build.log")
            except PlantError:
                if not arguments.drawn:
                    raise
                counts["do not build"] += 1
                continue
            if arguments.drawn and recorder.read_bytes() == whole_program:
                counts["the same program"] += 1
                recorder.unlink()
                continue
            pending.append((fault, pool.submit(judged_once, recorder, wholes)))
            while pending and (pending[0][1].done() or len(pending) > 2 * arguments.jobs):
                counts[report(*pending.pop(0))] += 1
        for fault, said in pending:
            counts[report(fault, said)] += 1
    return counts


def report(fault, said):
    text = said.result()
    file = Path(fault["file"]).name
    print(f"{'noticed' if text else 'MISSED '}  {fault['name']:<52} {file:<24} {text}".rstrip(), flush=True)
    return "noticed" if text else "missed"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    add_options(parser, "common_faults")
    parser.add_argument("--drawn", type=int, default=0, metavar="N", help="draw N faults in place of the list")
    parser.add_argument("--seed", type=int, default=1, help="of --drawn")
    arguments = parser.parse_args()
    work = arguments.work.resolve()
    tree = work / "tree"
    try:
        faults = faults_of(arguments)
        copy_tree(tree)
        plant(tree / "CMakeLists.txt", NO_ERRORS)
        configure(tree, work / "configure.log", "-DCMAKE_CXX_FLAGS_RELEASE=-O1")
        build(tree, ["record_answers"], work / "build.log")
        counts = try_all(faults, arguments, tree, work, wholes_of(tree / RECORDER))
    except PlantError as error:
        print(f"planted_common_faults: {error}", file=sys.stderr)
        return 2
    noticed = counts.pop("noticed", 0)
    counted = noticed + counts.pop("missed", 0)
    print(f"noticed: {noticed} of {counted}" + "".join(f", {count} {what}" for what, count in sorted(counts.items())))
    return 0 if 100 * noticed >= counted * (DRAWN_PERCENT if arguments.drawn else 100) else 1


if __name__ == "__main__":
    sys.exit(main())
