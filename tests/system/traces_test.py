#!/usr/bin/env python3
"""traces/README.md's table of what each trace gives: every row is run as it stands there."""

import json
import re
import subprocess
import tempfile
import unittest
from collections import namedtuple
from pathlib import Path

from harness import CAPSOC, CLEAN, FIRMWARE, TRACES, agree

CTEST = {"name": "system: Traces", "whole": True, "timeout": 600}


Row = namedtuple("Row", "trace program code verdict angle warning")


def rows():
    """The rows of the table under "What each gives", as text without the back ticks."""
    section = (TRACES / "README.md").read_text().split("## What each gives")[1].split("\n## ")[0]
    table = [line for line in section.splitlines() if line.startswith("|")]
    cells = [[cell.strip().strip("`") for cell in line.strip("|").split("|")] for line in table]
    assert cells[0] == ["trace", "program", "exit", "verdict", "angle error, deg", "warning"], cells[0]
    return [Row(*line) for line in cells[2:]]


def capsoc(folder, *arguments):
    return subprocess.run(
        [CAPSOC, *map(str, arguments)], capture_output=True, text=True, timeout=300, check=False, env=CLEAN, cwd=folder
    )


class Table(unittest.TestCase):
    """Exit code, verdict, angle error and warning of each row."""

    def run_row(self, folder, row):
        """The process, and the angle error of its result file as the table prints it."""
        program, *options = row.program.split()
        trace = TRACES / row.trace
        if program == "fit":
            return capsoc(folder, "fit", trace, *options), ""
        if program == "calibrate":
            fit = capsoc(folder, "fit", trace)
            self.assertEqual(fit.returncode, 0, fit.stderr)
            options = ["--parameters", "calibration.json", *options]
        elf = FIRMWARE / f"{program}.elf"
        process = capsoc(folder, "run", elf, "--sensor", trace, "--json", "r.json", *options)
        errors = json.loads((Path(folder) / "r.json").read_text())["angle_error_deg"]
        of_mode = "calibration_mode_max" if program == "calibrate" else "calibrated_max_last_revolution"
        return process, f"{errors[of_mode]:.3g}"

    def check(self, row):
        with tempfile.TemporaryDirectory() as folder:
            process, angle = self.run_row(folder, row)
        everything = process.stdout + process.stderr
        self.assertEqual(str(process.returncode), row.code, everything)
        self.assertTrue(agree(angle, row.angle), (angle, row.angle))
        if row.program == "fit":
            self.assertIn(row.verdict, everything)
        else:
            last = process.stdout.splitlines()[-1]
            self.assertTrue(agree(last, row.verdict), (last, row.verdict))
        warnings = re.findall("^warning: .*$", process.stderr, re.MULTILINE)
        self.assertEqual(len(warnings), 1 if row.warning else 0, warnings)
        if row.warning:
            self.assertIn(row.warning, warnings[0])
            self.assertIn(f"{row.trace}: ", warnings[0])

    def test_every_row_is_what_comes_out(self):
        table = rows()
        self.assertGreater(len(table), 20)
        for row in table:
            with self.subTest(trace=row.trace, program=row.program):
                self.check(row)

    def test_every_trace_has_a_row(self):
        files = {path.name for path in TRACES.iterdir() if path.suffix in (".toml", ".csv")}
        self.assertEqual({row.trace for row in rows()}, files)


if __name__ == "__main__":
    unittest.main()
