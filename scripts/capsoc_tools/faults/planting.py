"""Faults that scripts plant in a copy of the tree: their lists, the planter, and what the runners share.

Run as a program, it checks all lists and prints how many faults each has.

A list is a file tests/faults/NAME.toml. Its keys:

    runner     the command that plants the faults and demands that each is noticed
    requires   keys that each fault must have in addition to those below
    allows     keys that a fault may have in addition
    [[fault]]
    name       what is broken; unique in the list
    file       path in the tree; generated/... is a file that scripts/capsoc_tools/rtl/sources.py generates
    old, new   the text that is exchanged, and what takes its place
    before, after   optional: the text around `old`. before + old + after must be in the file exactly once
"""

import argparse
import contextlib
import fcntl
import itertools
import shutil
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

from capsoc_tools.rtl import sources as rtl_sources

from capsoc_tools import ROOT

LISTS = ROOT / "tests" / "faults"
GENERATED = "generated"
LIST_KEYS = {"runner", "requires", "allows", "fault"}
REQUIRED = {"name", "file", "old", "new"}
OPTIONAL = {"before", "after"}


class PlantError(Exception):
    """One sentence for the user."""


# Lists


def list_names():
    return sorted(path.stem for path in LISTS.glob("*.toml"))


def read_list(name, folder=LISTS):
    """The list `name` as its file has it: runner and faults. PlantError if it has another form."""
    path = folder / f"{name}.toml"
    try:
        whole = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, tomllib.TOMLDecodeError) as error:
        raise PlantError(f"{path}: {error}") from error
    check_keys(f"{path}", whole, {"runner", "fault"}, LIST_KEYS)
    required = REQUIRED | set(whole.get("requires", []))
    seen = set()
    for fault in whole["fault"]:
        where = f"{path}: fault {fault.get('name', '?')!r}"
        check_keys(where, fault, required, required | OPTIONAL | set(whole.get("allows", [])))
        if fault["name"] in seen:
            raise PlantError(f"{where} is there twice; give it another name")
        if fault["old"] == fault["new"]:
            raise PlantError(f"{where} changes nothing: old and new are the same")
        seen.add(fault["name"])
    return whole


def check_keys(where, table, required, allowed):
    for key in sorted(required - table.keys()):
        raise PlantError(f"{where} has no key {key!r}")
    for key in sorted(table.keys() - allowed):
        raise PlantError(f"{where} has the unknown key {key!r}; scripts/tool planting --help describes the keys")


def place_of(fault):
    """(offset of `old` in its context, the context), the context being what must be in the file exactly once."""
    before = fault.get("before", "")
    return len(before), before + fault["old"] + fault.get("after", "")


def find(text, fault):
    """Where `old` begins in the file's text. PlantError unless its place is there exactly once."""
    offset, place = place_of(fault)
    if text.count(place) != 1:
        raise PlantError(f"{fault['file']} holds the place of '{fault['name']}' {text.count(place)} times: {place!r}")
    return text.index(place) + offset


def read_source(path, fault):
    if not path.is_file():
        raise PlantError(f"there is no {fault['file']}, the file of '{fault['name']}'")
    return path.read_text(encoding="utf-8")


def exchanged(text, fault):
    """The file's text with the fault in it."""
    at = find(text, fault)
    return text[:at] + fault["new"] + text[at + len(fault["old"]) :]


def plant(path, fault):
    """Writes the fault into a file."""
    path.write_text(exchanged(read_source(path, fault), fault), encoding="utf-8")


def all_planted(text, faults, choice):
    """A SystemVerilog text with all of the faults in it, of which a variable chooses one at run time. `choice`: of a
    fault, the condition under which it is chosen. Faults at the same place nest; places must not overlap otherwise."""
    parts = {}
    for fault in faults:
        parts.setdefault((find(text, fault), fault["old"]), []).append(fault)
    end = len(text)
    for (at, old), at_place in sorted(parts.items(), reverse=True):
        if at + len(old) > end:
            raise PlantError(f"the place of '{at_place[0]['name']}' overlaps another; exchange the same part")
        end = at
        new = f"({old})"
        for fault in at_place:
            new = f"({choice(fault)} ? ({fault['new']}) : {new})"
        text = text[:at] + new + text[at + len(old) :]
    return text


def check_place(fault, generated, root=ROOT):
    """PlantError unless the fault's place is in its file exactly once. `generated`: the folder of generated files."""
    folder, _, name = fault["file"].partition("/")
    find(read_source(generated / name if folder == GENERATED else root / fault["file"], fault), fault)


# What the runners share


def add_options(parser, work=None, jobs=True, numbered=False):
    """--match; with `numbered` --number; with `jobs` --jobs; with `work`, a folder of build/, --work."""
    which = parser.add_mutually_exclusive_group()
    which.add_argument("--match", default="", metavar="TEXT", help="only faults whose name or file holds this text")
    if numbered:
        which.add_argument("--number", type=int, help="only this one, counted from 1; prints JSON")
    if jobs:
        parser.add_argument("--jobs", type=int, default=2)
    if work:
        parser.add_argument("--work", type=Path, default=ROOT / "build" / work)


def chosen(name, arguments, keep=lambda fault: True, located=True):
    """The faults of a list that the options choose. With `located`, each is at its place in the tree."""
    faults = [f for f in read_list(name)["fault"] if arguments.match in f["name"] + f["file"] and keep(f)]
    if not faults:
        raise PlantError(f"no fault's name or file holds {arguments.match!r}; see tests/faults/{name}.toml")
    for fault in faults if located else []:
        find(read_source(ROOT / fault["file"], fault), fault)
    return faults


def numbered(faults, number):
    if not 1 <= number <= len(faults):
        raise PlantError(f"there are the faults 1 to {len(faults)}")
    return faults[number - 1]


@contextlib.contextmanager
def planted(tree, fault):
    """The tree with the fault in it; afterwards it is whole again."""
    file = tree / fault["file"]
    whole = read_source(file, fault)
    try:
        plant(file, fault)
        yield
    finally:
        file.write_text(whole, encoding="utf-8")


@contextlib.contextmanager
def free_folder(work):
    """The first of WORK/worker-1, WORK/worker-2, ... that no other process uses.

    Processes plant in parallel, each in its own tree. The next one builds on it.
    """
    for number in itertools.count(1):
        folder = work / f"worker-{number}"
        folder.mkdir(parents=True, exist_ok=True)
        with open(folder / "lock", "w", encoding="utf-8") as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                continue
            yield folder
            return


def copy_tree(tree):
    """The tracked files of the working tree and no others; unchanged ones keep their times, so that little is built
    again.
    """
    listed = subprocess.run(["git", "-C", ROOT, "ls-files", "-z"], capture_output=True, text=True, check=True)
    names = [name for name in listed.stdout.split("\0") if name and (ROOT / name).is_file()]
    for name in names:
        source, copy = ROOT / name, tree / name
        if not (copy.exists() and copy.read_bytes() == source.read_bytes()):
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(source, copy)
    kept = {tree / name for name in names}
    for folder in [entry for entry in tree.iterdir() if entry.name != "build"]:
        for copy in [folder] if folder.is_file() else folder.rglob("*"):
            if copy.is_file() and copy not in kept:
                copy.unlink()


def run(command, log):
    """Exit code, and what the command printed."""
    with open(log, "w", encoding="utf-8") as out:
        done = subprocess.run(command, stdout=out, stderr=subprocess.STDOUT, check=False)
    return done.returncode, Path(log).read_text(encoding="utf-8", errors="replace")


def configure(tree, log, *options):
    code, _ = run(
        [
            "cmake",
            "-S",
            tree,
            "-B",
            tree / "build",
            "-G",
            "Ninja",
            "-DCMAKE_BUILD_TYPE=Release",
            "-DCAPSOC_TESTS=OFF",
            *options,
        ],
        log,
    )
    if code:
        raise PlantError(f"CMake failed; see {log}")


def build(tree, targets, log, jobs=2):
    code, _ = run(["cmake", "--build", tree / "build", "-j", str(jobs), "--target", *targets], log)
    if code:
        raise PlantError(f"the build failed; see {log}")


def main():
    """Status 0: every fault is at its place; 2: one is not, or a list has another form."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.parse_args()
    try:
        with tempfile.TemporaryDirectory() as folder:
            rtl_sources.generate(Path(folder))
            for name in list_names():
                whole = read_list(name)
                for fault in whole["fault"]:
                    check_place(fault, Path(folder))
                print(f"{name:<14} {len(whole['fault']):>4}  {whole['runner']}")
    except (PlantError, rtl_sources.RtlError) as error:
        print(f"planting: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
