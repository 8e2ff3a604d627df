#!/usr/bin/env python3
"""Verdicts on drawn faults: each kind from what a run did, intervals, and the same rows for any number of jobs."""

import subprocess
import types
import unittest

from capsoc_tools.faults import fault_verdicts as tool
from harness import BUILD, CLEAN, Case, SOURCE

CTEST = {"name": "system: FaultVerdicts", "timeout": 300}

GOOD = tool.VALID | tool.LOCK


def run(samples, code=0, state="s", is_applied=True):
    return types.SimpleNamespace(samples=samples, code=code, state=state, is_applied=is_applied)


def samples(*angles, status=GOOD, flags=1):
    return [(angle, status, flags) for angle in angles]


class Judged(unittest.TestCase):
    GOLDEN = run(samples(*[10.0] * 20))

    def verdict(self, angles, code=0, state="s", changes=()):
        rows = samples(*angles)
        for number, status, flags in changes:
            rows[number] = (rows[number][0], status, flags)
        return tool.judged(run(rows, code, state), self.GOLDEN, 0.1, 3)[:3]

    def test_kinds(self):
        same, off = [10.0] * 20, [10.0] * 5 + [10.2] * 15
        self.assertEqual(self.verdict(same), ("masked", "", ""))
        self.assertEqual(self.verdict(same, state="t"), ("latent", "", ""))
        self.assertEqual(self.verdict([10.05] * 20), ("latent", "", ""))
        self.assertEqual(self.verdict(off), ("silent", "", ""))
        self.assertEqual(self.verdict([10.0] * 17 + [10.2] * 3), ("wrong", "", ""))
        self.assertEqual(self.verdict(same, code=1), ("detected", "exit 1", ""))
        self.assertEqual(self.verdict(off, code=5)[0], "crashed")
        self.assertEqual(self.verdict(off, code=124)[0], "hung")
        self.assertEqual(self.verdict([], code=2)[0], "refused")

    def test_angles_that_do_not_come(self):
        def judged(rows, **more):
            return tool.judged(run(rows, **more), self.GOLDEN, 0.1, 3)[0]

        good = samples(*[10.0] * 20)
        self.assertEqual(judged(good[:5] + [None] * 4 + good[9:]), "silent")
        self.assertEqual(judged(good[:5] + [None] * 3 + good[8:]), "wrong")
        self.assertEqual(judged(good[:16]), "silent")
        self.assertEqual(judged(good[:17]), "wrong")
        self.assertEqual(judged(good[:5] + samples(10.0, status=0) + [None] * 14), "detected")
        self.assertEqual(judged(good[:5], code=1), "detected")

    def test_a_fault_that_did_not_happen_is_not_masked(self):
        good = samples(*[10.0] * 20)
        self.assertEqual(tool.judged(run(good, is_applied=False), self.GOLDEN, 0.1, 3)[0], "unapplied")

    def test_detection_counts_from_the_first_wrong_angle(self):
        off = [10.0] * 5 + [10.2] * 15
        self.assertEqual(self.verdict(off, changes=[(7, tool.VALID, 1)]), ("detected", "no LOCK", 2))
        self.assertEqual(self.verdict(off, changes=[(3, GOOD | tool.ALARM, 1)]), ("detected", "ALARM", 0))
        self.assertEqual(self.verdict(off, changes=[(6, GOOD, 1 | 1 << 2)]), ("detected", "SAT", 1))
        # Too late: more than three samples were wrong before.
        self.assertEqual(self.verdict(off, changes=[(15, tool.VALID, 1)])[0], "silent")

    def test_angles_wrap(self):
        self.assertAlmostEqual(tool.off_by((359.9, 0, 0), (0.1, 0, 0)), 0.2)

    def test_intervals(self):
        """Brown, Cai, DasGupta 2001: of 10 in 100."""
        low, high = tool.wilson(10, 100)
        self.assertAlmostEqual(low, 0.0552, places=4)
        self.assertAlmostEqual(high, 0.1744, places=4)
        self.assertEqual(tool.wilson(0, 10)[0], 0)


class Campaign(Case):
    def rows(self, jobs, *options):
        done = subprocess.run(
            [SOURCE / "scripts" / "tool", "fault_verdicts", "--build", BUILD, "--jobs", str(jobs), "--rows", "r.csv"]
            + ["--count", "8", "--seed", "3", "--to", "404", *options],
            capture_output=True,
            text=True,
            check=False,
            env=CLEAN,
            cwd=self.folder,
            timeout=200,
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        return (self.folder / "r.csv").read_text(), done.stdout

    def test_rows_do_not_depend_on_jobs(self):
        one, table = self.rows(1)
        two, _ = self.rows(3)
        self.assertEqual(one, two)
        self.assertEqual(len(one.splitlines()), 9)
        self.assertIn("8 faults, seed 3", table)

    def test_the_pipeline_of_the_rtl(self):
        rows, _ = self.rows(2, "--coprocessor", "rtl", "--units", "rtl.", "--pipeline")
        for row in rows.splitlines()[1:]:
            self.assertRegex(
                row, r"^\d,rtl\.u_\w+,flip rtl\.[\w.]+\[\d+\] at sample \d+ cycle \d+,(masked|latent|detected),"
            )

    def test_program_and_memory_are_drawn_too(self):
        rows, _ = self.rows(2, "--units", "processor,code_sram")
        self.assertEqual({row.split(",")[1] for row in rows.splitlines()[1:]}, {"code_sram"})


if __name__ == "__main__":
    unittest.main()
