#!/usr/bin/env python3
"""What scripts change and read: settings of programs, keys of a sensor, columns of a record, tables as data."""

import json
import os
import shlex
import subprocess
import tempfile
import unittest
from pathlib import Path

BUILD = Path(os.environ.get("CAPSOC_TEST_BUILD", "build")).resolve()
SOURCE = Path(os.environ.get("CAPSOC_TEST_SOURCE", ".")).resolve()
CAPSOC = BUILD / "capsoc"
FIRMWARE = BUILD / "firmware"
TRACES = SOURCE / "traces"


def capsoc(*arguments, environment=None, stdin=b""):
    """Runs the program; stdout and stderr as bytes."""
    clean = {k: v for k, v in os.environ.items() if not k.startswith("CAPSOC_")}
    return subprocess.run([CAPSOC, *map(str, arguments)], capture_output=True, timeout=570, check=False, input=stdin,
                          env={**clean, **(environment or {})})


class Case(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def run_soc(self, *arguments, code=0, **keywords):
        """`capsoc run` with its results read back."""
        path = self.folder / "r.json"
        process = capsoc("run", "--json", path, *arguments, **keywords)
        self.assertEqual(process.returncode, code, process.stdout.decode() + process.stderr.decode())
        return process, json.loads(path.read_text())

    def refuse(self, expected, *arguments, **keywords):
        process = capsoc(*arguments, **keywords)
        text = process.stderr.decode()
        self.assertEqual(process.returncode, 2, text)
        self.assertEqual(process.stdout, b"")
        self.assertEqual(len(text.strip().splitlines()), 1, text)
        self.assertIn(expected, text)


class ProgramSettings(Case):
    """`-P name=value` and what else sets them."""

    def listed(self, *arguments, **keywords):
        process = capsoc("run", "--list-program-settings", *arguments, **keywords)
        self.assertEqual(process.returncode, 0, process.stderr.decode())
        return {line.split()[0]: line for line in process.stdout.decode().splitlines()}

    def test_every_application_lists_its_own(self):
        for program, name in (("selfcal", "frequency_hz"), ("track", "drift_divider"), ("unordered", "step"),
                              ("calibrate", "angle_stride")):
            lines = self.listed(FIRMWARE / f"{program}.elf")
            self.assertIn(name, lines)
            self.assertIn("rate_hz", lines)
            self.assertRegex(lines["rate_hz"], r"250 +Hz +1 \.\. 100000 +built-in +samples a second")

    def test_precedence(self):
        config = self.folder / "c.toml"
        config.write_text("[program]\nrate_hz = 111\n")
        chosen = {"CAPSOC_PROGRAM_RATE_HZ": "222"}
        for expected, source, arguments, keywords in (
                ("250", "built-in", [], {}), ("111", "file", ["--config", config], {}),
                ("222", "environment", ["--config", config], {"environment": chosen}),
                ("333", "command line", ["--config", config, "-P", "rate_hz=333"], {"environment": chosen}),
                ("444", "command line", ["-C", "program.rate_hz=444"], {})):
            line = self.listed(*arguments, **keywords)["rate_hz"]
            self.assertEqual(line.split()[1], expected)
            self.assertIn(source, line)

    def test_wrong_ones_are_a_sentence(self):
        self.refuse("-P stap=1: ", "run", "-P", "stap=1")
        self.refuse("it has baud, rate_hz, frequency_hz, step,", "run", "-P", "stap=1")
        self.refuse("-P step=fast: step cannot be 'fast'; give a number", "run", "-P", "step=fast")
        self.refuse("give 1 .. 100000 Hz", "run", "-P", "rate_hz=0")
        self.refuse("write name=value", "run", "-P", "step")
        self.refuse("lower-case", "run", "-P", "Step=1")
        self.refuse("hello.elf has no settings", "run", FIRMWARE / "hello.elf", "-P", "step=1")
        self.refuse("environment CAPSOC_PROGRAM_STAP", "run", environment={"CAPSOC_PROGRAM_STAP": "1"})
        config = self.folder / "c.toml"
        config.write_text("[program]\n\nrate_hz = 0\n")
        self.refuse(f"{config}:3: rate_hz = 0 is out of range", "run", "--config", config)

    def test_another_rate_keeps_the_speed_of_the_shaft(self):
        # 300 does not divide the clock: the reference has to follow the converter's own period.
        for rate in (500, 300):
            _, r = self.run_soc("-P", f"rate_hz={rate}", "-P", "demodulation_samples=150000")
            self.assertEqual(r["samples"], 155_000)
            self.assertAlmostEqual(r["time"]["simulated_s"], 155_000 / rate, delta=0.1)
            self.assertLessEqual(r["angle_error_deg"]["calibrated_max_last_revolution"], 1e-6)
            self.assertLessEqual(r["convergence_s"], 125 * 250 / rate)
            self.assertEqual(r["configuration"]["program.rate_hz"], str(rate))
            self.assertEqual(r["configuration"]["program.frequency_hz"], "0.05")

    def test_the_step_follows_the_speed_when_it_is_0(self):
        trace = self.folder / "fast.toml"
        trace.write_text((TRACES / "soc_eq21.toml").read_text().replace("frequency_hz = 0.05", "frequency_hz = -1"))
        _, r = self.run_soc("--sensor", trace, "-P", "frequency_hz=-1", "-P", "step=0", "-P", "demodulation_samples=10000")
        self.assertLessEqual(r["angle_error_deg"]["calibrated_max_last_revolution"], 1e-5)
        self.assertLessEqual(r["convergence_s"], 10)

    def test_a_length_that_is_no_whole_second_is_kept(self):
        process, r = self.run_soc("-P", "demodulation_samples=30001", "-P", "calibration_samples=7")
        self.assertEqual(r["samples"], 30_008)
        self.assertIn(b"selfcal: pass", process.stdout)

    def test_a_shaft_that_is_too_fast_is_told(self):
        process, _ = self.run_soc("-P", "frequency_hz=125", code=1)
        self.assertIn(b"too high for rate_hz", process.stdout)
        self.run_soc("-P", "frequency_hz=-124", "-P", "demodulation_samples=250", code=1)

    def test_the_command_reproduces_the_run(self):
        first, r = self.run_soc("-P", "rate_hz=500", "-P", "demodulation_samples=20000", "-P", "calibration_samples=500")
        self.assertIn("-C program.rate_hz=500", r["command"])
        words = shlex.split(r["command"])
        again = capsoc(*words[1:])
        self.assertEqual(again.returncode, 0)
        self.assertEqual(again.stdout, first.stdout)


if __name__ == "__main__":
    unittest.main()
