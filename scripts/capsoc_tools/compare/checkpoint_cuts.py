"""Cuts runs at random times and lets them continue from the checkpoint; what comes must be what the unbroken run did.

usage: checkpoint_cuts [--count N] [--seed S] [--programs A,B] [--pairs tlm-tlm,tlm-rtl] [--arithmetic precise|paper]
[--jobs N]
       [--build FOLDER] [--keep FOLDER]

Every cut has a program, the coprocessor before and after it, its arithmetic, a time, and for the second part another
quantum and executor, all random from the seed. Saving must not change the output of the saved run. Of the run that
continued, these are compared: every UART's remaining bytes, exit code, cycles, instructions, samples, parameters, angle
errors, verdict and the checksum of all that UART 0 sent. Status 0: all the same; 1: a difference, with its commands; 2:
usage.
"""

import argparse
import collections
import concurrent.futures
import json
import os
import random
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

from capsoc_tools import ROOT as TOP

CLEAN = {k: v for k, v in os.environ.items() if not k.startswith("CAPSOC_")}
UARTS = range(5)
# Options that a program needs; the self-calibration is cut short where RTL takes part, since it computes every clock
# of it.
PROGRAMS = {
    "selfcal": [],
    "track": [],
    "quick": [
        "-P",
        "frequency_hz=0.5",
        "-P",
        "turns=4",
        "-P",
        "calibration_samples=400",
        "-C",
        "sensor.motion.frequency_hz=0.5",
    ],
    "unordered": [],
    "drivers": [],
    "exceptions": [],
    "board": [],
    "threads": [],
    "mpu": [],
    "newlib": ["--semihosting-dir", "."],
    "rdimon": ["--semihosting-dir", "."],
    "itm": [],
    "overrun": [],
}
BACKENDS = ("tlm", "rtl", "lockstep")
PAIRS = tuple(f"{before}-{after}" for before in BACKENDS for after in BACKENDS)
ARITHMETICS = ("precise", "paper")
SHORT = ["-P", "demodulation_samples=2600", "-P", "calibration_samples=400"]


class Difference(Exception):
    """What was not the same."""


def run(build, folder, program, name, *options):
    """Runs a program; result file and the bytes of every UART."""
    command = [
        build / "capsoc",
        "run",
        build / "firmware" / f"{program}.elf",
        *PROGRAMS[program],
        "--json",
        f"{name}.json",
        "--semihosting-console",
        "null",
    ]
    for number in UARTS:
        command += [f"--uart{number}", f"file:{name}.uart{number}"]
    command = [str(part) for part in (*command, *options)]
    done = subprocess.run(command, cwd=folder, env=CLEAN, capture_output=True, text=True, check=False, timeout=600)
    try:
        result = json.loads((folder / f"{name}.json").read_text())
    except OSError:
        raise Difference(f"no result, exit {done.returncode}: {done.stderr[-300:]}\n  {shlex.join(command)}") from None
    return command, result, [(folder / f"{name}.uart{number}").read_bytes() for number in UARTS]


def figures(result):
    """What two runs have in common however they came there."""
    own = ("command", "configuration", "versions", "inputs", "translator")
    kept = {key: value for key, value in result.items() if key not in own}
    return kept | {
        "time": result["time"]["simulated_s"],
        "cpu": (result["cpu"]["instructions"], result["cpu"]["cycles"]),
    }


def demand(what, expected, found, commands):
    if expected != found:
        raise Difference(
            f"{what}: {expected!r:.300} is {found!r:.300}\n" + "\n".join("  " + shlex.join(c) for c in commands)
        )


def one_cut(case):
    """Returns what differed, or None."""
    number, program, before, after, arithmetic, place, seed, build, keep = case
    draw = random.Random(f"{seed} {number}")
    folder = Path(keep) / f"cut-{number}" if keep else None
    with tempfile.TemporaryDirectory(prefix="capsoc-cut-") as scratch:
        folder = folder or Path(scratch)
        folder.mkdir(parents=True, exist_ok=True)
        options = SHORT if program == "selfcal" and (before, after) != ("tlm", "tlm") else []
        if program in ("track", "unordered") and (before, after) != ("tlm", "tlm"):
            options = ["--simlimit", "12"]
        options = [*options, "--arithmetic", arithmetic]
        try:
            (folder / "a").mkdir(exist_ok=True)
            _, whole, bytes_whole = run(build, folder / "a", program, "whole", *options)
            time = place * whole["time"]["simulated_s"]
            (folder / "b").mkdir(exist_ok=True)
            save, first, bytes_first = run(
                build,
                folder / "b",
                program,
                "first",
                *options,
                "--coprocessor",
                before,
                "--save",
                f"state.capsoc@{time:.12f}",
            )
            demand("the saved run", figures(whole), figures(first), [save])
            demand("its bytes", bytes_whole, bytes_first, [save])
            speed = [
                "--quantum",
                str(draw.choice((100, 10000, 1000000))),
                "-C",
                f"cpu.executor={draw.choice(('blocks', 'stepping'))}",
            ]
            if PROGRAMS[program]:
                # What the guest does to its files after the cut must not have happened yet.
                (folder / "c").mkdir(exist_ok=True)
                run(
                    build,
                    folder / "c",
                    program,
                    "ended",
                    *options,
                    "--save",
                    f"state.capsoc@{time:.12f}",
                    "--simlimit",
                    f"{time + 2e-6:.12f}",
                )
            restore, rest, bytes_rest = run(
                build,
                folder / ("c" if PROGRAMS[program] else "b"),
                program,
                "rest",
                *options,
                "--coprocessor",
                after,
                *speed,
                "--restore",
                "state.capsoc",
            )
            demand("the restored run", figures(whole), figures(rest), [save, restore])
            for uart, (everything, later) in enumerate(zip(bytes_whole, bytes_rest)):
                demand(f"the rest of uart{uart}", everything[len(everything) - len(later) :], later, [save, restore])
        except Difference as difference:
            return f"cut {number}: {program}, {before} to {after}, {arithmetic}: {difference}"
    return None


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", 1)[0], prog="checkpoint_cuts")
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--programs", default=",".join(PROGRAMS))
    parser.add_argument("--pairs", default=",".join(PAIRS), help="coprocessor before and after the cut")
    parser.add_argument("--arithmetic", choices=ARITHMETICS, help="of the coprocessor (both in turn)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--build", type=Path, default=TOP / "build", metavar="FOLDER", help="of the program (build)")
    parser.add_argument("--keep", type=Path, metavar="FOLDER", help="keep every run's files there")
    options = parser.parse_args()
    programs, pairs = options.programs.split(","), options.pairs.split(",")
    if options.count < 1 or set(programs) - set(PROGRAMS) or any(pair.count("-") != 1 for pair in pairs):
        parser.error("no such program or pair, or no cut at all")
    draw = random.Random(options.seed)
    cases = []
    for number in range(options.count):
        before, after = pairs[number % len(pairs)].split("-")
        program = programs[(number // len(pairs)) % len(programs)]
        turn = number % len(pairs) + number // len(pairs) % len(programs) + number // (len(pairs) * len(programs))
        arithmetic = options.arithmetic or ARITHMETICS[turn % len(ARITHMETICS)]
        cases.append(
            (
                number,
                program,
                before,
                after,
                arithmetic,
                draw.uniform(0.001, 0.999),
                options.seed,
                options.build.resolve(),
                options.keep and options.keep.resolve(),
            )
        )
    with concurrent.futures.ProcessPoolExecutor(options.jobs) as pool:
        answers = list(pool.map(one_cut, cases))
    counts = collections.Counter((case[1], f"{case[2]} to {case[3]}", case[4]) for case in cases)
    wrong = collections.Counter(
        (case[1], f"{case[2]} to {case[3]}", case[4]) for case, answer in zip(cases, answers) if answer
    )
    print(f"seed {options.seed}\n{'program':12} {'coprocessor':24} {'arithmetic':10} {'cuts':>5} {'different':>9}")
    for (program, pair, arithmetic), count in sorted(counts.items()):
        print(f"{program:12} {pair:24} {arithmetic:10} {count:5} {wrong[program, pair, arithmetic]:9}")
    different = [answer for answer in answers if answer]
    print(f"different: {len(different)} of {len(cases)}")
    for answer in different[:10]:
        print(answer)
    return 1 if different else 0


if __name__ == "__main__":
    sys.exit(main())
