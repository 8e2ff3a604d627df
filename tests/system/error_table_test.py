#!/usr/bin/env python3
"""capsoc fit --use-angle: a table from a recorded angle, and the SoC that starts with it, on other samples."""

import json
import math
import random
import re
import subprocess
import unittest

from harness import BUILD, CAPSOC, CLEAN, SOURCE, TRACES, Case

CTEST = {"name": "system: ErrorTable", "whole": True, "timeout": 600}


class ErrorTable(Case):
    def record(self, name, seed, *, factor=1.0, zero=0.0, harmonics=1.0, columns="t,u,v,angle_deg"):
        """12,000 samples of a shaft that swings once a turn by 0.6 rad: speed tells nothing of the harmonics."""
        source, lines = random.Random(seed), [columns]
        for k in range(12_000):
            t = k / 250
            x = 2 * math.pi * 0.25 * t
            theta = 0.7 + x + 0.6 * math.sin(x + 0.3) + 0.2 * math.sin(0.2 * t + seed)
            u = math.sin(theta) + harmonics * (
                0.012 * math.sin(2 * theta + 1) + 0.008 * math.sin(3 * theta) + 0.003 * math.cos(5 * theta)
            )
            v = math.cos(theta + 0.2) + harmonics * (0.007 * math.cos(2 * theta - 0.4) + 0.01 * math.cos(3 * theta + 2))
            row = {
                "t": t,
                "u": 0.45 * u + 0.06 + source.gauss(0, 2e-5),
                "v": 0.40 * v - 0.09 + source.gauss(0, 2e-5),
                "angle_deg": (factor * math.degrees(theta) + zero) % 360,
            }
            lines.append(",".join(repr(row[name]) for name in columns.split(",")))
        (self.folder / name).write_text("\n".join(lines) + "\n", encoding="ascii")
        return name

    def capsoc(self, *arguments):
        return subprocess.run(
            [CAPSOC, *map(str, arguments)], cwd=self.folder, capture_output=True, timeout=300, check=False, env=CLEAN
        )

    def fit(self, name, *options):
        process = self.capsoc("fit", name, *options)
        self.assertEqual(process.returncode, 0, process.stderr.decode())
        return json.loads((self.folder / "calibration.json").read_text(encoding="utf-8")), process.stdout.decode()

    def run_error(self, sensor, *options):
        """Largest error in calibration mode, degrees, and what the program printed."""
        process = self.capsoc(
            "run",
            "--parameters",
            "calibration.json",
            "--sensor",
            sensor,
            "-P",
            "samples=10000",
            "--json",
            "r.json",
            *options,
        )
        self.assertIn(process.returncode, (0, 1), process.stderr.decode())
        return (
            json.loads((self.folder / "r.json").read_text(encoding="utf-8"))["angle_error_deg"]["calibration_mode_max"],
            process.stdout,
        )

    def test_the_socs_angle_gets_better_on_other_samples(self):
        for factor, zero in ((1, 0), (-1, 40)):
            learnt = self.record("learnt.csv", 1, factor=factor, zero=zero)
            other = self.record("other.csv", 2, factor=factor, zero=zero)
            self.fit(learnt)
            before, printed = self.run_error(other)
            self.assertNotIn(b"error table", printed)
            calibration, text = self.fit(learnt, "--use-angle")
            self.assertIn("--use-angle", calibration["command"])
            held_out = calibration["error_table"]["held_out_deg"]
            self.assertEqual((held_out["folds"], held_out["by"]), (5, "turns"))
            self.assertLess(held_out["rms_after"], held_out["rms_before"] / 100)
            self.assertIn("held-out samples", text)
            after, printed = self.run_error(other)
            self.assertIn(b"the error table of the parameters is on", printed)
            self.assertGreater(before, 1.5)
            self.assertLess(after, 0.03)
            self.assertLess(after, 2 * held_out["largest_after"])

    def test_the_header_has_the_same_nodes(self):
        calibration, _ = self.fit(self.record("learnt.csv", 1), "--use-angle")
        header = (self.folder / "calibration.h").read_text(encoding="utf-8")
        nodes = re.search(r"#define CALIBRATION_NODES \\\n\s*\{([^}]*)\}", header)[1].replace("\\\n", "")
        self.assertEqual([int(node) for node in nodes.split(",")], calibration["error_table"]["nodes"])
        (self.folder / "check.c").write_text(
            f'#include <stdint.h>\n#define CALIBRATION_HEADER "{self.folder / "calibration.h"}"\n'
            f'#include "{SOURCE / "firmware/apps/calibrate/parameter_block.c"}"\n',
            encoding="utf-8",
        )
        device = next(BUILD.glob("**/capsoc_device.h")).parent
        compiled = subprocess.run(
            [
                "cc",
                "-fsyntax-only",
                "-Wall",
                "-Werror",
                f"-I{SOURCE}/firmware/apps/common",
                f"-I{SOURCE}/firmware/drivers",
                f"-I{SOURCE}/firmware/common",
                f"-I{device}",
                "check.c",
            ],
            cwd=self.folder,
            capture_output=True,
            text=True,
            check=False,
        )
        self.assertEqual(compiled.returncode, 0, compiled.stderr)

    def test_the_arithmetic_paper_leaves_it_out(self):
        learnt = self.record("learnt.csv", 1)
        self.fit(learnt)
        before, _ = self.run_error(learnt, "--arithmetic", "paper")
        self.fit(learnt, "--use-angle")
        after, printed = self.run_error(learnt, "--arithmetic", "paper")
        self.assertIn(b"the error table is left out", printed)
        self.assertEqual(after, before)

    def test_a_clean_sensor_has_no_table(self):
        calibration, text = self.fit(self.record("clean.csv", 1, harmonics=0), "--use-angle")
        self.assertFalse(calibration["error_table"]["identified"])
        self.assertNotIn("nodes", calibration["error_table"])
        self.assertIn("error table  none: an error table does not make the angle of held-out samples better", text)

    def test_harmonics_are_recommended_only_where_they_are_identified(self):
        name = self.record("uneven.csv", 1)
        _, text = self.fit(name)
        self.assertNotIn("use --harmonics", text)
        self.assertIn("--use-angle", text)
        self.assertNotIn("1/f", text)
        self.assertNotIn("nan", text)
        _, text = self.fit(name, "--harmonics", 3)
        self.assertNotIn("use --harmonics", text)
        _, text = self.fit(TRACES / "csfn_h3.toml")
        self.assertIn("; use --harmonics 3\n", text)
        calibration, _ = self.fit(TRACES / "csfn_h3.toml", "--harmonics", 3)
        self.assertTrue(calibration["harmonics"]["identified"])

    def test_the_bound_is_below_five_times_the_error_in_the_median(self):
        process = self.capsoc("fit", "--table", "bound", "--table-records", 100, "--table-seed", 5)
        text = process.stdout.decode()
        self.assertEqual((process.returncode, process.stderr), (0, b""), text)
        rows = [re.split(r"\s{2,}", line.strip()) for line in text.splitlines()[3:6]]
        self.assertEqual([row[0] for row in rows], ["good", "amplitude 5e-4 .. 5e-3", "10 .. 16 bits"], text)
        for row in rows:
            self.assertGreater(int(row[1]), 95, text)
            self.assertLess(float(row[4]), 5, text)
            self.assertGreater(float(row[6]), 1, text)

    def test_what_is_no_angle_is_refused(self):
        for code, expected, options in (
            (2, "--use-angle needs a true angle", {"columns": "t,u,v"}),
            (3, "it seems to be radians", {"factor": math.pi / 180}),
        ):
            process = self.capsoc("fit", self.record("bad.csv", 1, **options), "--use-angle")
            text = process.stderr.decode()
            self.assertEqual((process.returncode, len(text.splitlines())), (code, 1), text)
            self.assertIn(expected, text)
        process = self.capsoc("fit", self.record("good.csv", 1), "--use-angle", "--harmonics", 3)
        self.assertEqual(process.returncode, 2)
        self.assertIn("--use-angle", process.stderr.decode())


if __name__ == "__main__":
    unittest.main()
