"""What the Python tests share: places, a clean environment, and a case that has a folder and ends what it started.

CMake gives the places. By hand, in the top folder: PYTHONPATH=tests:scripts python3 tests/system/gdb_test.py Session
"""

import functools
import json
import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

# Taken away: what a test starts has no settings of the test's.
SOURCE = Path(os.environ.pop("CAPSOC_TEST_SOURCE", Path(__file__).resolve().parents[1])).resolve()
BUILD = Path(os.environ.pop("CAPSOC_TEST_BUILD", SOURCE / "build")).resolve()
CAPSOC = BUILD / "capsoc"
FIRMWARE = BUILD / "firmware"
TRACES = SOURCE / "traces"
#: Without settings of capsoc and of builds, which would come before a test's own.
CLEAN = {
    name: value
    for name, value in os.environ.items()
    if not name.startswith("CAPSOC_") and name not in ("CFLAGS", "MAKEFLAGS", "DESTDIR")
}


def output_of(*command, code=0, environment=None, timeout=400, **keywords):
    """What a command prints on standard output. It ends with the exit code, or the test fails with all that it said.

    `environment`: beside CLEAN. Further keywords as subprocess.run has them.
    """
    done = subprocess.run(
        [*map(str, command)],
        capture_output=True,
        text=True,
        timeout=timeout,
        check=False,
        env=CLEAN | (environment or {}),
        **({"stdin": subprocess.DEVNULL} if "input" not in keywords else {}),
        **keywords,
    )
    if done.returncode != code:
        raise AssertionError(f"{command}: {done.returncode}\n{done.stdout[-20000:]}{done.stderr[-20000:]}")
    return done.stdout


@functools.cache
def is_firmware_of_the_pages():
    """Whether the firmware is compiled as for the figures of the pages, by GCC 12 of Debian 12. The code of another one
    takes other times."""
    command = ["arm-none-eabi-gcc", "-dumpversion"]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.startswith("12.")


def agree(told, written, share=0.01):
    """Whether a line that was printed is that of a page. Of another firmware numbers may differ by a share."""
    if told == written or is_firmware_of_the_pages():
        return told == written
    number = re.compile(r"\d+(?:\.\d+)?(?:e-?\d+)?")
    if number.sub("", told) != number.sub("", written):
        return False
    pairs = zip(map(float, number.findall(told)), map(float, number.findall(written)))
    return all(abs(a - b) <= share * abs(b) for a, b in pairs)


def without_host_times(result):
    """A copy of a result file without what the host's clock and the translator's mood say: the same from every run."""
    result = json.loads(json.dumps(result))
    result["time"].pop("wall_s")
    result["cpu"].pop("mips")
    result.pop("translator", None)
    return result


def signal_is_caught(process, number):
    """Whether a process has its own handler for a signal (Linux)."""
    status = Path(f"/proc/{process.pid}/status").read_text(encoding="ascii", errors="replace")
    return bool(int(status.split("SigCgt:")[1].split()[0], 16) >> (number - 1) & 1)


class Case(unittest.TestCase):
    """A test with its own folder, which is removed."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="capsoc-test-")
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name).resolve()

    def start(self, *arguments, **keywords):
        """capsoc in the background, in the test's folder; it does not outlive the test."""
        keywords = {
            "stdin": subprocess.DEVNULL,
            "stdout": subprocess.PIPE,
            "stderr": subprocess.PIPE,
            "env": CLEAN,
            "cwd": self.folder,
            **keywords,
        }
        process = subprocess.Popen([CAPSOC, *map(str, arguments)], **keywords)
        self.addCleanup(self.end, process)
        return process

    @staticmethod
    def end(process):
        """Of one that may still run."""
        if process.poll() is None:
            process.kill()
        process.communicate()

    def result(self, name="r.json"):
        """A result file in the test's folder, read."""
        return json.loads((self.folder / name).read_text(encoding="utf-8"))

    def check_refused(self, code, out, said, *words):
        """Exit code 2, nothing on standard output, and one sentence with the words."""
        self.assertEqual((code, out), (2, b""), said)
        self.assertEqual(len(said.strip().splitlines()), 1, said)
        for word in words:
            self.assertIn(str(word), said)
