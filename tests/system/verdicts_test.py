#!/usr/bin/env python3
"""What the self-calibration programs say of broken sensors, and whether a pass keeps the bound that it states."""

import json
import math
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

BUILD = Path(os.environ.get("CAPSOC_TEST_BUILD", "build")).resolve()
SOURCE = Path(os.environ.get("CAPSOC_TEST_SOURCE", ".")).resolve()
CLEAN = {k: v for k, v in os.environ.items() if not k.startswith("CAPSOC_")}
RATE = 250


def turning(k):
    """Turns of the shaft at sample k: 0.05 Hz."""
    return 0.05 * k / RATE


def stopping(k):
    return turning(min(k, 40 * RATE))


class Noise:
    """Deterministic and near enough to normal: the sum of four uniform numbers of a 32-bit generator."""

    def __init__(self, size):
        self.state, self.size = 1, size

    def __call__(self):
        total = 0.0
        for _ in range(4):
            self.state = (self.state * 1664525 + 1013904223) % 2**32
            total += self.state / 2**32 - 0.5
        return total * math.sqrt(3) * self.size


class Case(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def run_program(self, program, *options):
        """Exit code and verdict of the result file."""
        process = subprocess.run([BUILD / "capsoc", "run", BUILD / "firmware" / f"{program}.elf", "--json", "r.json",
                                  *map(str, options)], capture_output=True, text=True, timeout=300, check=False, env=CLEAN,
                                 cwd=self.folder)
        self.assertTrue((self.folder / "r.json").exists(), process.stderr)
        self.result, self.process = json.loads((self.folder / "r.json").read_text()), process
        return process.returncode, self.result["verdict"]

    def record(self, samples):
        path = self.folder / "s.csv"
        with path.open("w", encoding="ascii") as file:
            file.write("u,v,angle_deg\n")
            file.writelines(f"{u:.9f},{v:.9f},{angle % 1 * 360:.7f}\n" for u, v, angle in samples)
        return path

    def sensor(self, u, v, angle=turning, noise=0.0, length=105_100):
        """A recording whose channels are functions of the angle in radians."""
        disturbance = Noise(noise)
        return self.record((u(2 * math.pi * angle(k)) + disturbance(), v(2 * math.pi * angle(k)) + disturbance(), angle(k))
                           for k in range(length))


def good_u(x):
    return 0.6 * math.sin(x) + 0.1


def good_v(x):
    return 0.5 * math.cos(x + 0.1) - 0.05


class Broken(Case):
    """The broken sensors that once locked and passed: each is refused, with a sentence."""

    def check(self, sensor, words, program="selfcal", *options):
        code, verdict = self.run_program(program, "--sensor", sensor, *options)
        self.assertEqual(code, 1, self.process.stderr)
        self.assertFalse(verdict["pass"])
        self.assertIn(words, verdict["reason"])
        self.assertIsNone(verdict["bound_deg"])
        self.assertEqual(self.process.stdout.splitlines()[-1], f"{program}: fail: {verdict['reason']}")

    CIRCLE, NO_ANGLE, REST = "do not stay on a circle", "give no angle", "no whole turn was seen in time"

    def test_both_channels_are_dead(self):
        self.check(self.sensor(lambda x: 0.0, lambda x: 0.0), self.NO_ANGLE)

    def test_noise_only(self):
        self.check(self.sensor(lambda x: 0.0, lambda x: 0.0, noise=1e-4), self.CIRCLE)

    def test_the_shaft_rests(self):
        self.check(self.sensor(good_u, good_v, angle=lambda k: 0.3), "")

    def test_a_channel_is_constant(self):
        self.check(self.sensor(lambda x: 0.2, good_v), "")
        self.check(self.sensor(good_u, lambda x: 0.2), "")

    def test_the_channels_are_equal(self):
        self.check(self.sensor(good_u, good_u), "")

    def test_the_shaft_stops(self):
        self.check(self.sensor(good_u, good_v, angle=stopping), self.CIRCLE)
        self.check(self.sensor(good_u, good_v, angle=stopping, length=121_000), self.REST, "track")

    def test_small_signals_in_noise(self):
        self.check(self.sensor(lambda x: 5e-4 * math.sin(x), lambda x: 5e-4 * math.cos(x), noise=1e-4), self.CIRCLE)

    def test_clipping(self):
        self.check(self.sensor(lambda x: 1.01 * math.sin(x), good_v), "clipped")

    def test_wrong_parameters(self):
        (self.folder / "p.json").write_text(json.dumps({"parameters": {
            name: {"word": round(value * 2**31), "value": value} for name, value in
            (("a1", 0.6), ("a2", 0.2), ("b1", 0.1), ("b2", -0.05), ("beta", 0), ("phi", 0))}}))
        self.check(self.sensor(good_u, good_v, length=5100), self.CIRCLE, "calibrate", "--parameters", "p.json")

    def test_an_offset_that_drifts(self):
        # A tenth of the amplitude a turn: the demodulation follows, so nothing but the drift shows it.
        self.check(self.record((0.2 * math.sin(2 * math.pi * turning(k)) + 0.02 * (turning(k) - 10),
                                good_v(2 * math.pi * turning(k)), turning(k)) for k in range(105_100)), "still drift")

    def test_a_channel_that_fails_after_the_last_whole_turn(self):
        (self.folder / "p.json").write_text(json.dumps({"parameters": {
            name: {"word": round(value * (2**32 / (2 * math.pi) if name == "beta" else 2**31)), "value": value} for name, value in
            (("a1", 0.6), ("a2", 0.5), ("b1", 0.1), ("b2", -0.05), ("beta", 0.1), ("phi", 0))}}))
        sensor = self.record((good_u(2 * math.pi * turning(k)) if k < 6150 else 0.0, good_v(2 * math.pi * turning(k)), turning(k))
                             for k in range(6400))
        self.check(sensor, "have left their circle", "calibrate", "--parameters", "p.json", "-P", "samples=6250")

    def test_dropouts_that_lie_on_the_circle(self):
        # The offsets are as long as the amplitude: 0 in both channels is a place on the circle, and only 0 itself shows it.
        words = {name: {"word": round(value * 2**31), "value": value} for name, value in
                 (("a1", 0.5), ("a2", 0.5), ("b1", 0.3), ("b2", 0.4), ("beta", 0), ("phi", 0))}
        (self.folder / "p.json").write_text(json.dumps({"parameters": words}))

        def samples(every):
            for k in range(7000):
                x = 2 * math.pi * turning(k)
                lost = k % every == every - 1
                yield (0.0, 0.0, turning(k)) if lost else (0.5 * math.sin(x) + 0.3, 0.5 * math.cos(x) + 0.4, turning(k))

        self.check(self.record(samples(200)), "the converter drops out", "calibrate", "--parameters", "p.json")
        code, verdict = self.run_program("calibrate", "--parameters", "p.json", "--sensor", self.record(samples(10_000)))
        self.assertEqual((code, verdict["pass"]), (0, True))

    def test_a_bound_that_is_too_wide(self):
        sensor = self.sensor(good_u, good_v, noise=0.02)
        code, verdict = self.run_program("selfcal", "--sensor", sensor)
        self.assertEqual(code, 0)
        self.check(sensor, "above limit_deg", "selfcal", "-P", f"limit_deg={verdict['bound_deg'] / 2:.3f}")


class Bounds(Case):
    """A pass says how far an angle can be off, and `capsoc run` looks."""

    def check(self, most, program, *options):
        code, verdict = self.run_program(program, *options)
        self.assertEqual(code, 0, self.process.stderr)
        self.assertTrue(verdict["pass"] and verdict["bound_holds"], verdict)
        self.assertIsNone(verdict["reason"])
        self.assertLess(verdict["bound_deg"], most)
        self.assertIn(f"{program}: pass: every angle within ", self.process.stdout.splitlines()[-1])
        self.assertIn("the program's own bound", self.process.stderr)

    def test_small_amplitudes_in_both_arithmetics(self):
        for arithmetic in ("precise", "paper"):
            # The truncated products of `paper` settle slowly where they are small: the bound says so.
            for amplitude, most in ((0.3, 0.1), (0.05, 0.1 if arithmetic == "precise" else 12)):
                options = [f"-Csensor.{name}={value}" for name, value in
                           (("a1", amplitude), ("a2", amplitude), ("b1", 0), ("b2", 0))]
                self.check(most, "selfcal", "--arithmetic", arithmetic, *options)

    def test_the_other_way_round(self):
        self.check(0.1, "selfcal", "-C", "sensor.motion.frequency_hz=-0.05")

    def test_unknown_truth(self):
        sensor = self.folder / "u.csv"
        sensor.write_text("u,v\n" + "".join(f"{good_u(2 * math.pi * turning(k)):.9f},{good_v(2 * math.pi * turning(k)):.9f}\n"
                                              for k in range(105_100)))
        code, verdict = self.run_program("selfcal", "--sensor", sensor)
        self.assertEqual(code, 0)
        self.assertTrue(verdict["pass"])
        self.assertIsNone(verdict["bound_holds"])
        self.assertIsNone(verdict["largest_error_deg"])
        self.assertIn("not known whether it holds", self.process.stderr)

    def test_a_bound_that_does_not_hold_is_no_pass(self):
        # A truth that is off by one degree stands for a wrong angle.
        sensor = self.sensor(good_u, good_v, angle=turning)
        lines = sensor.read_text().splitlines()
        shifted = [lines[0]] + [f"{u},{v},{(float(angle) + 1) % 360:.7f}" for u, v, angle in
                                (line.split(",") for line in lines[1:])]
        sensor.write_text("\n".join(shifted) + "\n")
        code, verdict = self.run_program("selfcal", "--sensor", sensor)
        self.assertEqual(code, 1)
        self.assertTrue(verdict["pass"])
        self.assertIs(verdict["bound_holds"], False)
        self.assertEqual(self.result["exit"]["reason"], "the program vouches for 0.072 deg, but an angle is 1 deg wrong")
        self.assertIn("DOES NOT HOLD", self.process.stderr)

    def test_a_program_without_a_verdict(self):
        self.assertIsNone(self.run_program("hello")[1])


class Drawn(unittest.TestCase):
    """scripts/verdicts on a few drawn sensors of every kind."""

    def test_no_wrong_pass(self):
        process = subprocess.run([SOURCE / "scripts" / "verdicts", "--good", "3", "--broken", "1", "--programs", "selfcal,track",
                                  "--seed", "2", "--build", BUILD], capture_output=True, text=True, timeout=900, check=False)
        self.assertEqual(process.returncode, 0, process.stdout + process.stderr)
        self.assertIn("wrong passes: 0 of 128", process.stdout)


if __name__ == "__main__":
    unittest.main()
