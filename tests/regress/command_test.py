#!/usr/bin/env python3
"""capsoc regress as a user runs it, on the real Verilated coprocessor."""

import json
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from xml.etree import ElementTree

PROGRAM = Path(os.environ["CAPSOC_TEST_BUILD"]) / "capsoc"
# A thousandth of the long run that docs/verification.md names.
SHORT = ["--samples", "10000", "--accesses", "1000", "--seeds", "1"]


def regress(*arguments):
    return subprocess.run([PROGRAM, "regress", *arguments], capture_output=True, text=True, check=False)


class Regression(unittest.TestCase):
    def test_model_and_rtl_agree(self):
        with tempfile.TemporaryDirectory() as folder:
            junit, results = Path(folder) / "junit.xml", Path(folder) / "results.json"
            done = regress(*SHORT, "--junit", str(junit), "--json", str(results))
            self.assertEqual(done.returncode, 0, done.stdout[-4000:] + done.stderr)
            self.assertIn("no difference", done.stdout)
            suites = ElementTree.parse(junit).getroot().findall("testsuite")
            self.assertEqual([suite.get("failures") for suite in suites], ["0", "0"])
            for suite in suites:
                self.assertEqual(len(suite.findall("testcase")), int(suite.get("tests")))
            for arithmetic in json.loads(results.read_text(encoding="utf-8"))["arithmetics"].values():
                self.assertGreaterEqual(sum(run["samples"] for run in arithmetic["runs"]), 10000)
                self.assertEqual(arithmetic["missing"], [])

    def test_output_does_not_depend_on_jobs(self):
        texts = {regress("--scenario", "traffic", "--samples", "300", "--accesses", "900", "--seeds", "3", "--jobs",
                         jobs).stdout for jobs in ("1", "2", "3")}
        self.assertEqual(len(texts), 1)


class Refusals(unittest.TestCase):
    def refused(self, *arguments, saying):
        done = regress(*arguments)
        self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
        self.assertIn(saying, done.stderr)
        self.assertEqual(done.stderr.strip().count("\n"), 0, done.stderr)

    def test_unknown_scenario(self):
        self.refused("--scenario", "trafic", saying="traffic")

    def test_unknown_option(self):
        self.refused("--sample", "1", saying="--samples")

    def test_no_seeds(self):
        self.refused("--seeds", "0", saying="--seeds")

    def test_library_that_is_not_there(self):
        self.refused("--arithmetic", "paper", "--rtl-library", "/nowhere/library.so", saying="/nowhere/library.so")

    def test_one_library_for_both_arithmetics(self):
        self.refused("--rtl-library", "/nowhere/library.so", saying="--arithmetic")

    def test_result_that_cannot_be_written(self):
        self.refused("--json", "/nowhere/results.json", saying="/nowhere")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[1:]])
