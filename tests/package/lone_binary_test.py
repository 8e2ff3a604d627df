#!/usr/bin/env python3
"""The program copied somewhere by itself: it works, or says in one sentence what is missing."""

import hashlib
import json
import shutil
import subprocess
import unittest

from harness import CAPSOC, CLEAN, Case, FIRMWARE, SOURCE

CTEST = {"name": "package: lone_binary", "whole": True}

DEFAULT = SOURCE / "traces" / "soc_eq21.toml"


class LoneBinary(Case):
    def setUp(self):
        super().setUp()
        (self.folder / "bin").mkdir()
        (self.folder / "work").mkdir()
        shutil.copy2(CAPSOC, self.folder / "bin" / "capsoc")

    def capsoc(self, *arguments, code=0):
        done = subprocess.run(
            [self.folder / "bin" / "capsoc", *map(str, arguments)],
            cwd=self.folder / "work",
            capture_output=True,
            text=True,
            timeout=250,
            check=False,
            env=CLEAN,
        )
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done

    def refusal(self, *arguments):
        """The one sentence of exit code 2."""
        done = self.capsoc(*arguments, code=2)
        self.assertEqual(done.stdout, "")
        self.assertRegex(done.stderr, r"\Acapsoc: [^\n]+\n\Z")
        return done.stderr

    def result(self, *arguments, code=0):
        self.capsoc("run", *arguments, "--json", "r.json", code=code)
        return json.loads((self.folder / "work" / "r.json").read_text())

    def sensor_of(self, result):
        return next(i for i in result["inputs"] if i["role"] == "sensor")

    def test_any_firmware_runs_with_the_sensor_that_is_built_in(self):
        result = self.result(FIRMWARE / "hello.elf")
        self.assertEqual(
            self.sensor_of(result),
            {
                "role": "sensor",
                "path": "built-in:soc_eq21.toml",
                "sha256": hashlib.sha256(DEFAULT.read_bytes()).hexdigest(),
            },
        )

    def test_the_sensor_that_is_built_in_is_the_trace(self):
        selfcal = [FIRMWARE / "selfcal.elf", "--simlimit", "30"]
        runs = [self.result(*selfcal, *options, code=124) for options in ([], ["--sensor", DEFAULT])]
        self.assertGreater(runs[0]["samples"], 1000)
        for key in ("samples", "parameters", "angle_error_deg", "uart0", "cpu"):
            for run in runs:
                run["cpu"].pop("mips", None)
            self.assertEqual(runs[0][key], runs[1][key], key)

    def test_traces_beside_the_program_come_first(self):
        (self.folder / "bin" / "traces").mkdir()
        text = DEFAULT.read_text().replace("0.6079", "0.5000")
        (self.folder / "bin" / "traces" / "soc_eq21.toml").write_text(text)
        result = self.result(FIRMWARE / "hello.elf")
        self.assertEqual(self.sensor_of(result)["path"], str(self.folder / "bin" / "traces" / "soc_eq21.toml"))
        self.assertEqual(self.sensor_of(result)["sha256"], hashlib.sha256(text.encode()).hexdigest())

    def test_a_missing_default_program_is_one_sentence(self):
        for options in ([], ["--golden"], ["--parameters", "calibration.json"]):
            text = self.refusal("run", *options)
            program = "calibrate" if "--parameters" in options else "selfcal"
            self.assertIn(f"{self.folder}/bin/firmware/{program}.elf", text)
            self.assertIn("capsoc run FILE.elf", text)

    def test_a_program_that_was_named_is_missing_by_its_own_name(self):
        self.assertIn("nowhere.elf", self.refusal("run", "nowhere.elf"))

    def test_fit(self):
        answers = []
        for trace in (DEFAULT, "built-in:soc_eq21.toml"):
            self.capsoc("fit", trace)
            answers.append(json.loads((self.folder / "work" / "calibration.json").read_text()))
        self.assertEqual(answers[0]["parameters"], answers[1]["parameters"])
        self.assertEqual(answers[1]["inputs"][0]["path"], "built-in:soc_eq21.toml")
        self.assertEqual(answers[0]["inputs"][0]["sha256"], answers[1]["inputs"][0]["sha256"])

    def test_only_what_is_built_in_has_that_name(self):
        self.assertIn("built-in:other.toml", self.refusal("fit", "built-in:other.toml"))

    def test_info_and_accuracy_need_nothing(self):
        self.assertIn("coprocessor", self.capsoc("info").stdout)
        self.assertIn("deg", self.capsoc("accuracy").stdout)

    def test_commands_that_need_files_say_which(self):
        self.assertIn("bin/traces/soc_experiment.toml", self.refusal("reproduce"))
        self.assertIn("bin/firmware/bench_list_search.elf", self.refusal("bench", "cpu"))
        self.assertIn("bin/libcapsoc_rtl_precise.so", self.refusal("regress"))
        self.assertIn(
            "bin/libcapsoc_rtl_precise.so", self.refusal("run", FIRMWARE / "hello.elf", "--coprocessor", "rtl")
        )


if __name__ == "__main__":
    unittest.main()
