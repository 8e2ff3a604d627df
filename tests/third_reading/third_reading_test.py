#!/usr/bin/env python3
"""The model's answers to the regression's scenarios against the third reading, and the checker against wrong
answers.
"""

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from harness import BUILD
from registers import NAMES

CTEST = {"name": "third reading", "timeout": 3600, "long": ["PreciseLong", "PaperLong"]}

RECORDER = BUILD / "platform" / "experiments" / "regress" / "record_answers"
CHECKER = Path(__file__).resolve().with_name("check_answers.py")
# Random samples and accesses of a recording, in addition to the directed scenarios.
SHORT = ("--samples", "2000", "--accesses", "2000")
LONG = ("--samples", "100000", "--accesses", "50000", "--seeds", "4")


def check(text):
    return subprocess.run([sys.executable, CHECKER, "-"], input=text, capture_output=True, text=True, check=False)


class Agreement(unittest.TestCase):
    def agrees(self, *arguments):
        with subprocess.Popen([RECORDER, "-", *arguments], stdout=subprocess.PIPE) as recorder:
            done = subprocess.run(
                [sys.executable, CHECKER, "-"], stdin=recorder.stdout, capture_output=True, text=True, check=False
            )
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertEqual(recorder.returncode, 0)
        print(" ".join(arguments), done.stdout.strip(), flush=True)


class Precise(Agreement):
    def test_every_scenario(self):
        self.agrees("--arithmetic", "precise", *SHORT)


class Paper(Agreement):
    def test_every_scenario(self):
        self.agrees("--arithmetic", "paper", *SHORT)


class Options(Agreement):
    """Options of `paper`, each away from its default."""

    def some(self, *arguments):
        self.agrees(
            "--arithmetic",
            "paper",
            "--samples",
            "1000",
            "--scenario",
            "quadrants",
            "beta",
            "load_moments",
            "stream",
            *arguments,
        )

    def test_as_in_table_8(self):
        self.some("--operand-bits", "16", "--reference-lead", "2", "--step-shift", "7", "--plain-arctangent")

    def test_narrow_operands(self):
        self.some("--operand-bits", "2")

    def test_a_reference_that_lags(self):
        self.some("--reference-lead", "-3")

    def test_plain_arctangent(self):
        self.some("--plain-arctangent")


class TwoClocks(Agreement):
    """Two clocks an iteration of the arctangent: every scenario has another latency."""

    def test_every_scenario(self):
        self.agrees("--arithmetic", "paper", "--iteration-clocks", "2", *SHORT)


class PreciseLong(Agreement):
    def test_every_scenario(self):
        self.agrees("--arithmetic", "precise", *LONG)


class PaperLong(Agreement):
    def test_every_scenario(self):
        self.agrees("--arithmetic", "paper", *LONG)


class Checker(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.lines = subprocess.run(
            [RECORDER, "-", "--scenario", "flags"], capture_output=True, text=True, check=True
        ).stdout.splitlines()

    def changed(self, kind, change, which=30):
        """The recording with one line of `kind` as `change` makes it of its words; none: left out."""
        lines = list(self.lines)
        at = [i for i, line in enumerate(lines) if line.startswith(kind + " ")][which]
        words = change(lines[at].split())
        lines[at : at + 1] = [" ".join(words)] if words else []
        return at + 1, check("\n".join(lines) + "\n")

    def differs(self, kind, change, *saying):
        at, done = self.changed(kind, change)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        for text in (f"line {at}", "edge", *saying):
            self.assertIn(text, done.stdout)

    def test_as_recorded(self):
        self.assertEqual(check("\n".join(self.lines)).returncode, 0)

    def test_a_word_that_was_read(self):
        self.differs("r", lambda w: [*w[:3], f"{int(w[3], 16) ^ 4:x}", w[4]], "read of 0x010 (FLAGS)")

    def test_an_answer_that_should_be_an_error(self):
        self.differs("r", lambda w: [*w[:4], "0"], "PSLVERR")

    def test_a_write_that_was_refused(self):
        self.differs("w", lambda w: [*w[:4], "0"], "write")

    def test_a_sample_that_was_dropped(self):
        self.differs("s", lambda w: [*w[:5], str(1 - int(w[5]))], "latched")

    def test_a_register_at_a_commit(self):
        at = 2 + sorted(NAMES).index(0x0B8)
        self.differs("k", lambda w: [*w[:at], f"{int(w[at], 16) ^ 1:x}", *w[at + 1 :]], "(CAL_S) at a commit")

    def test_a_level_one_edge_late(self):
        at, done = self.changed("l", lambda w: [w[0], str(int(w[1]) + 1), *w[2:]], which=0)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertIn("BUSY", done.stdout)

    def test_a_commit_that_is_missing(self):
        _, done = self.changed("k", lambda _: None)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertIn("the record has none", done.stdout)

    def refused(self, text, saying):
        done = check(text)
        self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
        self.assertIn(saying, done.stderr)
        self.assertEqual(done.stderr.count("\n"), 1)

    def test_files_that_are_none(self):
        head = "\n".join(self.lines[:2]) + "\n"
        self.refused("", "first line")
        self.refused("edge,u,v\n", "first line")
        self.refused(head, "no end")
        self.refused(head + "q 12\n", "line 3")
        self.refused(head + "r 12 10\n", "line 3")
        self.refused(head + "s 12 1 1 0 0\ns 11 1 1 0 0\n", "line 4")
        self.refused(self.lines[0] + "\ne 12\n", "no run")
        self.refused(self.lines[0] + "\nrun exact 32 0 0 0 1 flags 1\n", "exact")

    def test_a_file_that_is_not_there(self):
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run(
                [sys.executable, CHECKER, Path(folder) / "none"], capture_output=True, text=True, check=False
            )
        self.assertEqual(done.returncode, 2)
        self.assertIn("none", done.stderr)


if __name__ == "__main__":
    unittest.main()
