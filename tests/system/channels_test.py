#!/usr/bin/env python3
"""Several sensors at once on a coprocessor of several channels: the program `channels`."""

import json
import re
import unittest

from harness import CAPSOC, FIRMWARE, Case, output_of

CTEST = {"name": "channels", "timeout": 300}

# Samples a second of each, and turns a second: a turn is 100 samples.
RATE = 100
SENSORS = (
    {"a1": 0.61, "a2": 0.62, "b1": 0.13, "b2": 0.18, "beta_rad": 0.06, "phi_rad": 0.09},
    {"a1": 0.35, "a2": 0.25, "b1": -0.05, "b2": 0.02, "beta_rad": -0.4, "phi_rad": 1.5},
    {"a1": 0.50, "a2": 0.45, "b1": 0.01, "b2": -0.20, "beta_rad": 0.2, "phi_rad": -2.0},
    {"a1": 0.80, "a2": 0.81, "b1": 0.10, "b2": 0.00, "beta_rad": 0.0, "phi_rad": 3.0},
)
BROKEN = 2
HARMONIC = '[[harmonics]]\nchannel = "v"\norder = 3\namplitude = 0.3\n'


def description(number, sensor):
    signal = "\n".join(f"{name} = {value}" for name, value in sensor.items())
    return (
        f'name = "sensor {number}"\norigin = "test"\n[sampling]\nrate_hz = {RATE}\nadc_bits = 24\n'
        f'[signal]\n{signal}\n[motion]\nkind = "constant"\nfrequency_hz = 1\n' + (HARMONIC if number == BROKEN else "")
    )


class Channels(Case):
    def setUp(self):
        super().setUp()
        self.files = []
        for number, sensor in enumerate(SENSORS):
            path = self.folder / f"{number}.toml"
            path.write_text(description(number, sensor), encoding="utf-8")
            self.files.append(str(path))

    def command(self, *arguments, channels=4):
        return (
            *(CAPSOC, "run", FIRMWARE / "channels.elf", "--sensor", self.files[0]),
            *("-C", f"sensor.further={','.join(self.files[1:])}", "-C", f"coprocessor.channels={channels}"),
            *("-P", f"rate_hz={RATE}", "--simlimit", "30", *arguments),
        )

    def check(self, text):
        parts = re.split(r"channel (\d+): ", text)
        self.assertEqual(parts[1::2], ["0", "1", "2", "3"], text)
        for number, part in enumerate(parts[2::2]):
            if number == BROKEN:
                self.assertTrue(part.startswith("refused, the signals are no ellipse\n"), part)
                continue
            self.assertTrue(
                part.startswith("pass: the last 2 turns were good by the turn judge; no bound of the angle\n"), text
            )
            found = {name: float(value) for name, value in re.findall(r"^(\w+) +-?\d+ +(-?[\d.]+)", part, re.MULTILINE)}
            for name, due in SENSORS[number].items():
                if name != "phi_rad":  # the converter takes the sensors one after another
                    self.assertAlmostEqual(found[name.removesuffix("_rad")], due, delta=1e-4, msg=(number, name))

    def test_one_that_is_broken_is_refused_alone(self):
        text = output_of(*self.command(), code=1)
        self.check(text)
        # The same in the RTL, sample by sample.
        self.assertEqual(output_of(*self.command("--coprocessor", "lockstep"), code=1), text)

    def test_the_result_has_each_sensor(self):
        output_of(*self.command("--json", "r.json", "--html", "r.html"), code=1, cwd=self.folder)
        page = (self.folder / "r.html").read_text()
        for path in self.files:
            self.assertIn(f"<td>{path}</td>", re.sub(r"<td[^>]*>", "<td>", page))
        sensors = json.loads((self.folder / "r.json").read_text())["sensors"]
        self.assertEqual([each["channel"] for each in sensors], [0, 1, 2, 3])
        self.assertEqual([each["path"] for each in sensors], self.files)
        for number, each in enumerate(sensors):
            self.assertGreater(each["samples"], 5 * RATE, each)
            self.assertLess(each["valid"], each["samples"], each)
            self.assertIsNone(each["parameters"]["phi"]["true"])
            error = each["angle_error_deg"]
            self.assertGreater(error["uncalibrated_max"], 5, each)
            if number == BROKEN:
                self.assertGreater(error["last_revolution"], 5, each)
                continue
            self.assertLess(error["last_revolution"], 1e-4, each)
            for name in ("a1", "a2", "b1"):
                self.assertLess(abs(each["parameters"][name]["relative_error"]), 1e-6, (number, name))
        # The same from the middle on, and in the RTL.
        output_of(*self.command("--save", "half.capsoc@2.5"), code=1, cwd=self.folder)
        for rest in (("--restore", "half.capsoc"), ("--coprocessor", "lockstep")):
            output_of(*self.command(*rest, "--json", "s.json"), code=1, cwd=self.folder)
            self.assertEqual(json.loads((self.folder / "s.json").read_text())["sensors"], sensors, rest)

    def test_a_checkpoint_has_all_of_them(self):
        text = output_of(*self.command(), code=1)
        output_of(*self.command("--save", "half.capsoc@2.5"), code=1, cwd=self.folder)
        rest = output_of(*self.command("--restore", "half.capsoc"), code=1, cwd=self.folder)
        self.assertTrue(text.endswith(rest), rest)
        self.check(rest)

    def test_what_does_not_fit_is_said(self):
        process = self.start(*self.command(channels=3)[1:])
        out, said = process.communicate(timeout=60)
        self.check_refused(process.returncode, out, said.decode(), "4 sensors", "3 channels")
        for line, other in (("adc_bits = 24", "adc_bits = 12"), (f"rate_hz = {RATE}", "rate_hz = 250")):
            text = description(1, SENSORS[1])
            self.assertIn(line, text)
            (self.folder / "1.toml").write_text(text.replace(line, other), encoding="utf-8")
            process = self.start(*self.command()[1:])
            out, said = process.communicate(timeout=60)
            self.check_refused(process.returncode, out, said.decode(), "1.toml", "one converter takes both")
        text = output_of(CAPSOC, "run", FIRMWARE / "channels.elf", code=1)
        self.assertIn("no coprocessor with a channel for each sensor here", text)


if __name__ == "__main__":
    unittest.main()
