#!/usr/bin/python3
"""The random sensors of scripts/tool verdicts: their recordings, and that a wrong verdict is noticed."""

import json
import os
import shlex
import subprocess
import tempfile
import tomllib
import unittest
from pathlib import Path

import numpy as np

from capsoc_tools.studies import verdict_kinds, verdict_sensors
from harness import BUILD, Case, FIRMWARE, SOURCE

CTEST = {"name": "verdict kinds", "interpreter": "/usr/bin/python3"}

KINDS = [*verdict_kinds.GOOD, *verdict_kinds.BROKEN]


def verdicts(*options, build=BUILD):
    return subprocess.run(
        [SOURCE / "scripts" / "tool", "verdicts", "--build", build, *map(str, options)],
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )


class Recordings(Case):
    def write(self, name, kind, case, program, *options):
        path = self.folder / name
        process = verdicts("--write", path, "--kinds", kind, "--case", case, "--programs", program, *options)
        self.assertEqual(process.returncode, 0, process.stderr)
        return path.read_bytes()

    def test_a_case_has_the_same_bytes_each_time(self):
        for kind in ("good", "stale", "noise 1/f", "two at once", "modulated 1 a turn"):
            first = self.write("a.csv", kind, 3, "calibrate")
            self.assertEqual(first, self.write("b.csv", kind, 3, "calibrate"))
            self.assertNotEqual(first, self.write("b.csv", kind, 4, "calibrate"))
            self.assertNotEqual(first, self.write("b.csv", kind, 3, "calibrate", "--seed", 2))

    def test_numbers_are_written_as_they_are(self):
        u, v, angle = (
            np.array([0.0, -0.25, 1.03, -1.049999999]),
            np.array([1e-9, -1e-9, 0.999999999, 0]),
            np.array([0, 0.25, -0.25, 3.5]),
        )
        verdict_sensors.write(self.folder / "n.csv", u, v, angle)
        rows = (self.folder / "n.csv").read_text().splitlines()
        self.assertEqual(rows[0], "u,v,angle_deg")
        read = np.array([[float(cell) for cell in row.split(",")] for row in rows[1:]])
        np.testing.assert_array_equal(read, np.stack([u, v, [0, 90, 270, 180]], axis=1))

    def test_every_kind_differs_from_the_good_sensor_and_is_finite(self):
        for program in ("selfcal", "unordered"):
            for kind in verdict_kinds.BROKEN:
                case, u, v, angle = verdict_kinds.make_case(1, kind, 0, program)
                with self.subTest(kind=kind, program=program):
                    self.assertEqual({len(u), len(v), len(angle)}, {case.plan.length})
                    self.assertTrue(np.isfinite(u).all() and np.isfinite(v).all() and np.isfinite(angle).all())
                    again = verdict_sensors.Case(1, kind, 0, program)
                    good = verdict_kinds.put_together(again, verdict_kinds.steady, None, None)
                    self.assertGreater(sum(np.abs(x - y).max() for x, y in zip((u, v, angle), good)), 1e-7)

    def test_the_truth_is_the_argument_of_the_sine_of_channel_u(self):
        """Also where a convention changes, and whatever the motion is: U, without harmonics and noise, is a1
        sin(angle) + b1.
        """
        for kind in (*verdict_kinds.LEGAL, *verdict_kinds.MOTIONS, *verdict_kinds.GOOD):
            for number in range(4):
                case, u, _, angle = verdict_kinds.make_case(1, kind, number, "selfcal")
                sensor = case.sensor
                a, b = (sensor.a2, sensor.b2) if kind == "swapped" else (sensor.a1, sensor.b1)
                with self.subTest(kind=kind, number=number):
                    self.assertLess(
                        np.abs(u - b - a * np.sin(2 * np.pi * angle)).max(), (0.021 + 6 * sensor.noise / a) * a
                    )

    def test_beta_beyond_a_quarter_turn_is_another_sensor_with_the_same_samples(self):
        """V = a2 cos(theta + beta) = a2 cos(theta' + beta') with theta' = 1/2 - theta, beta' = pi - beta: |beta'|
        below a quarter turn.
        """
        case, _, v, angle = verdict_kinds.make_case(1, "beta beyond", 0, "selfcal")
        sensor = case.sensor
        beta = np.remainder(np.pi - sensor.beta + np.pi, 2 * np.pi) - np.pi
        self.assertLess(abs(beta), np.pi / 2)
        self.assertLess(
            np.abs(v - sensor.b2 - sensor.a2 * np.cos(2 * np.pi * angle + beta)).max(),
            0.021 * sensor.a2 + 6 * sensor.noise,
        )

    def test_stretches_reach_the_unfinished_last_turn_and_the_early_ones(self):
        late = early = 0
        for number in range(60):
            case = verdict_sensors.Case(1, "held once", number, "paper")
            first, end = case.stretch()
            begin, judged_end = case.plan.judged
            late += judged_end - case.plan.turn < first < judged_end
            early += begin < first and end < judged_end - case.plan.turn
            self.assertTrue(0 <= first < end <= case.n)
        self.assertGreater(late, 5)
        self.assertGreater(early, 5)


class Answers(Case):
    """What scripts/tool verdicts makes of the answers of capsoc."""

    def planted(self, change):
        """A build folder whose capsoc lies: `change` is Python that alters the dictionary `verdict`, and may set
        `code`.
        """
        fake = self.folder / "build"
        fake.mkdir(exist_ok=True)
        if not (fake / "firmware").exists():
            (fake / "firmware").symlink_to(FIRMWARE)
        (fake / "capsoc").write_text(
            f"""#!/usr/bin/python3
import json, subprocess, sys
process = subprocess.run([{str(BUILD / 'capsoc')!r}, *sys.argv[1:]], stdout=subprocess.PIPE)
code = process.returncode
sys.stdout.buffer.write(process.stdout)
if "--json" in sys.argv:
    path = sys.argv[sys.argv.index("--json") + 1]
    result = json.load(open(path))
    verdict = result["verdict"]
    {change}
    json.dump(result, open(path, "w"))
sys.exit(code)
"""
        )
        (fake / "capsoc").chmod(0o755)
        return fake

    def run_one(self, build, *options):
        path = self.folder / "answers.json"
        process = verdicts(
            "--good", 1, "--broken", 1, "--jobs", 1, "--arithmetic", "precise", "--json", path, *options, build=build
        )
        return process, json.loads(path.read_text())["answers"]

    def test_a_planted_wrong_pass_is_noticed(self):
        build = self.planted('verdict.update({"pass": True, "bound_deg": 1e-9, "reason": None}); code = 0')
        for program in ("calibrate", "track", "follow"):
            process, answers = self.run_one(build, "--kinds", "good", "--programs", program)
            self.assertEqual((process.returncode, answers[0]["outcome"]), (1, "WRONG"), program)
            self.assertIn("wrong passes: 1 of 1", process.stdout)
            self.assertIn(f"--kinds good --case 0 --programs {program} ", process.stdout)

    def test_it_looks_at_the_truth_itself(self):
        lie = (
            'verdict.update({"pass": True, "bound_deg": 1e-9, "reason": None, '
            '"largest_error_deg": 0, "bound_holds": True}); code = 0'
        )
        for program in ("calibrate", "track", "follow"):
            process, answers = self.run_one(self.planted(lie), "--kinds", "good", "--programs", program)
            self.assertEqual((process.returncode, answers[0]["outcome"]), (1, "WRONG"), program)

    def test_a_pass_with_another_exit_code_is_an_error(self):
        process, answers = self.run_one(self.planted("code = 1"), "--kinds", "good", "--programs", "calibrate")
        self.assertEqual((process.returncode, answers[0]["outcome"]), (1, "error"))

    def test_a_case_that_it_prints_gives_the_answer_again(self):
        process, answers = self.run_one(BUILD, "--kinds", "stale", "--programs", "calibrate")
        path = self.folder / "case.csv"
        written = verdicts(
            "--write", path, "--kinds", "stale", "--case", 0, "--programs", "calibrate", "--arithmetic", "precise"
        )
        again = subprocess.run(
            [*written.stdout.split(), "--json", self.folder / "r.json"],
            capture_output=True,
            text=True,
            check=False,
            env={k: v for k, v in os.environ.items() if not k.startswith("CAPSOC_")},
        )
        verdict = json.loads((self.folder / "r.json").read_text())["verdict"]
        self.assertEqual(again.returncode, answers[0]["exit"], process.stdout)
        self.assertEqual(verdict["bound_deg"], answers[0].get("bound"))

    def test_records_are_continued(self):
        records = self.folder / "records"
        self.run_one(BUILD, "--kinds", "good", "--programs", "calibrate", "--records", records)
        before = records.read_text()
        _, answers = self.run_one(BUILD, "--kinds", "good,held often", "--programs", "calibrate", "--records", records)
        self.assertEqual([a["kind"] for a in answers], ["good", "held often"])
        self.assertEqual(records.read_text().splitlines()[:2], before.splitlines())
        self.assertEqual(len(records.read_text().splitlines()), 3)

    def test_usage(self):
        for wrong in (
            ("--kinds", "no such"),
            ("--programs", "hello"),
            ("--arithmetic", "fast"),
            ("--write", self.folder / "x.csv"),
        ):
            process = verdicts(*wrong)
            self.assertEqual(process.returncode, 2, wrong)
        self.assertFalse((self.folder / "x.csv").exists())


class Kinds(unittest.TestCase):
    """One case of every kind for a short program: no crash, no missing answer."""

    def test_every_kind_gets_an_answer(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "answers.json"
            process = verdicts(
                "--good", 5, "--broken", 1, "--programs", "calibrate,follow", "--arithmetic", "precise", "--json", path
            )
            self.assertIn(process.returncode, (0, 1), process.stderr)
            answers = json.loads(path.read_text())["answers"]
        self.assertEqual({a["kind"] for a in answers}, set(KINDS))
        self.assertEqual([a for a in answers if a["outcome"] in ("error", "no verdict")], [])


class Campaign(unittest.TestCase):
    def test_it_has_every_case(self):
        description = tomllib.loads((SOURCE / "campaigns/verdicts.toml").read_text(encoding="utf-8"))
        (axis,) = description["axes"]
        points = axis["value"]["case"]["points"]
        self.assertEqual(axis["value"]["case"]["range"], [1, points])
        words = shlex.split(description["settings"]["command"]["line"])
        self.assertEqual((words[:2], words[-2:]), (["scripts/tool", "verdicts"], ["--number", "$case"]))
        process = verdicts(*words[2:-1], points + 1)
        self.assertEqual(process.returncode, 2)
        self.assertIn(f": there are 1 .. {points}\n", process.stderr)


if __name__ == "__main__":
    unittest.main()
