"""Compares one build of capsoc with another: the same bytes for every program, or the first difference.

usage: compare_builds OLD NEW [--simlimit S] [--programs A,B] [--jobs N]

OLD and NEW are programs (build/capsoc of two trees). Every ELF of NEW's folder firmware/ runs on both, with both
arithmetics and with the model, the RTL and lockstep, the programs of the coprocessor in all, the others with the
model only. Compared are the bytes of UART 0, the result file without times, the traces of instructions and bus and
the profile (model, 0.02 s), the waves' values, and one regression report. For refactorings: a table in the end.
Status 0: all the same; 1: a difference; 2: usage.
"""

import argparse
import concurrent.futures
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

CLEAN = {k: v for k, v in os.environ.items() if not k.startswith("CAPSOC_")}
COPROCESSOR = ("selfcal", "track", "unordered", "drivers")
# What says which build or run it was, and when.
OWN = ("versions", "command")
PLACES = ("firmware.elf", "sensor.file", "coprocessor.rtl_library")


def result_of(path):
    j = json.loads(path.read_text())
    for name in OWN:
        j.pop(name, None)
    j["time"].pop("wall_s"), j["cpu"].pop("mips"), j.pop("translator", None)
    j["configuration"] = {
        k: v for k, v in j["configuration"].items() if k.split(".")[0] != "checkpoint" and k not in PLACES
    }
    for entry in j["inputs"]:
        entry.pop("path")
    return json.dumps(j)


def outputs(capsoc, arguments, folder, files):
    """Exit code, stderr's last line, and the named files."""
    folder.mkdir()
    done = subprocess.run(
        [str(part) for part in (capsoc, *arguments)],
        cwd=folder,
        env=CLEAN,
        capture_output=True,
        check=False,
        timeout=900,
    )
    found = {"exit": done.returncode, "stdout": done.stdout}
    for name in files:
        path = folder / name
        if name.endswith(".json"):
            found[name] = result_of(path) if path.exists() else None
        elif name.endswith(".fst"):
            text = subprocess.run(["fst2vcd", path], capture_output=True, check=False).stdout if path.exists() else None
            found[name] = text and text[text.find(b"$enddefinitions") :]
        else:
            found[name] = path.read_bytes() if path.exists() else None
    return found


def one(case):
    what, old, new, arguments, files = case
    with tempfile.TemporaryDirectory(prefix="capsoc-compare-") as folder:
        before, after = (
            outputs(capsoc, arguments, Path(folder) / name, files) for name, capsoc in (("old", old), ("new", new))
        )
    return what, [name for name in before if before[name] != after[name]], len(before)


def cases(old, new, simlimit, wanted):
    firmware = new.parent / "firmware"
    for elf in sorted(firmware.glob("*.elf")):
        if wanted and elf.stem not in wanted:
            continue
        base = [
            "run",
            elf,
            "--simlimit",
            simlimit,
            "--json",
            "r.json",
            "--uart0",
            "file:u",
            "--semihosting-dir",
            ".",
            "--timelimit",
            "300",
        ]
        for arithmetic in ("precise", "paper") if elf.stem in COPROCESSOR else ("precise",):
            for coprocessor in ("tlm", "rtl", "lockstep") if elf.stem in COPROCESSOR else ("tlm",):
                yield (
                    f"{elf.stem}, {arithmetic}, {coprocessor}",
                    old,
                    new,
                    [*base, "--arithmetic", arithmetic, "--coprocessor", coprocessor],
                    ["u", "r.json"],
                )
        yield (
            f"{elf.stem}, traces",
            old,
            new,
            [
                "run",
                elf,
                "--simlimit",
                "0.02",
                "--uart0",
                "file:u",
                "--semihosting-dir",
                ".",
                "--trace-instructions",
                "i",
                "--trace-bus",
                "b",
                "--profile",
                "p",
                "--trace-waves",
                "w.fst",
                "--timelimit",
                "300",
            ],
            ["u", "i", "b", "p", "w.fst"],
        )
    for arithmetic in ("precise", "paper"):
        yield (
            f"regress, {arithmetic}",
            old,
            new,
            [
                "regress",
                "--arithmetic",
                arithmetic,
                "--samples",
                "300",
                "--accesses",
                "300",
                "--seeds",
                "1",
                "--jobs",
                "1",
            ],
            [],
        )


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", 1)[0], prog="compare_builds")
    parser.add_argument("old", type=Path)
    parser.add_argument("new", type=Path)
    parser.add_argument("--simlimit", default="3", metavar="S")
    parser.add_argument("--programs", default="")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    options = parser.parse_args()
    for capsoc in (options.old, options.new):
        if not os.access(capsoc, os.X_OK) or capsoc.is_dir():
            parser.error(f"{capsoc}: is no program; build it, or name build/capsoc of a tree")
    wanted = set(filter(None, options.programs.split(",")))
    different = total = 0
    with concurrent.futures.ProcessPoolExecutor(options.jobs) as pool:
        for what, names, count in pool.map(
            one, cases(options.old.resolve(), options.new.resolve(), options.simlimit, wanted)
        ):
            print(
                f"{what:40} {count - len(names)} of {count} the same{': not ' + ', '.join(names) if names else ''}",
                flush=True,
            )
            different += bool(names)
            total += 1
    print(f"different: {different} of {total} runs")
    return 1 if different or not total else 0


if __name__ == "__main__":
    sys.exit(main())
