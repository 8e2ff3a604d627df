"""A copy of the tracked files in which scripts plant faults."""

import contextlib
import fcntl
import itertools
import shutil
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


class PlantError(Exception):
    """One sentence for the user."""


@contextlib.contextmanager
def free_folder(work):
    """The first of WORK/worker-1, WORK/worker-2, ... that nobody else is in: those who plant side by side, each in a
    tree of its own, which the next one builds on."""
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


def exchanged(file, old, new):
    """The file's text with `new` in the place of `old`, which must be there exactly once."""
    text = file.read_text(encoding="utf-8") if file.is_file() else ""
    if text.count(old) != 1:
        raise PlantError(f"{file} holds {old!r} {text.count(old)} times, not once")
    return text.replace(old, new)


def exchange(file, old, new):
    file.write_text(exchanged(file, old, new), encoding="utf-8")


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
