#!/usr/bin/env python3
"""capsoc regress as a user runs it, on the real Verilated coprocessor."""

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path
from xml.etree import ElementTree

from harness import BUILD, CAPSOC, CLEAN, Case

CTEST = {"name": "regress", "timeout": 600}

FAULTY = BUILD / "tests" / "regress" / "regress_faulty_rtl.so"
# A thousandth of the long run that docs/explanation/verification.md names.
SHORT = ["--samples", "10000", "--accesses", "1000", "--seeds", "1"]


def regress(*arguments):
    return subprocess.run([CAPSOC, "regress", *arguments], capture_output=True, text=True, check=False)


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

    def test_model_and_rtl_agree_with_two_clocks_an_iteration(self):
        with tempfile.TemporaryDirectory() as folder:
            results = Path(folder) / "results.json"
            two = ["--arithmetic", "paper", "--iteration-clocks", "2"]
            done = regress(*SHORT, *two, "--json", str(results))
            self.assertEqual(done.returncode, 0, done.stdout[-4000:] + done.stderr)
            self.assertIn("no difference", done.stdout)
            written = json.loads(results.read_text(encoding="utf-8"))
            self.assertIn(" ".join(two[2:]), written["command"])
            self.assertEqual(written["arithmetics"]["paper"]["missing"], [])
        done = regress("--scenario", "ties", *two)
        for spacing in ("1", "2..62", "63", "64", "65", "66..127", "128", "129..320", "321", "322", "above 400"):
            self.assertIn(f"missing: spacing: {spacing}\n", done.stdout)

    def test_two_clocks_are_a_parameter_of_paper_with_one_library(self):
        for arguments, saying in (
            ([], "give --arithmetic paper, too"),
            (["--arithmetic", "paper", "--rebuild"], "leave --rebuild and --coverage out"),
            (["--arithmetic", "paper", "--coverage", "c"], "leave --rebuild and --coverage out"),
        ):
            done = regress("--iteration-clocks", "2", *arguments)
            self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
            self.assertIn(saying, done.stderr)

    def test_output_does_not_depend_on_jobs(self):
        texts = {
            regress(
                "--scenario", "traffic", "--samples", "300", "--accesses", "900", "--seeds", "3", "--jobs", jobs
            ).stdout
            for jobs in ("1", "2", "3")
        }
        self.assertEqual(len(texts), 1)


class Failures(unittest.TestCase):
    """Of RTL that is wrong, hangs or crashes."""

    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)

    def faulty(self, fault, *arguments):
        return subprocess.run(
            [
                CAPSOC,
                "regress",
                "--arithmetic",
                "precise",
                "--rtl-library",
                FAULTY,
                "--samples",
                "500",
                "--accesses",
                "500",
                "--seeds",
                "1",
                *arguments,
            ],
            capture_output=True,
            text=True,
            check=False,
            cwd=self.folder,
            env={**os.environ, "CAPSOC_TEST_FAULT": fault},
        )

    def signals_of(self, waves):
        """Full names and ranges as GTKWave's own converter reads them."""
        text = subprocess.run(["fst2vcd", waves], capture_output=True, text=True, check=True).stdout
        scopes, names = [], set()
        for line in text.splitlines():
            words = line.split()
            if line.startswith("$scope"):
                scopes.append(words[2])
            elif line.startswith("$upscope"):
                scopes.pop()
            elif line.startswith("$var"):
                names.add(".".join([*scopes, "".join(words[4:-1])]))
        return names, text

    def test_no_fault_no_failure(self):
        done = self.faulty("", "--scenario", "ties")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_waves_of_a_difference_and_what_to_show(self):
        for fault, shown in (("node", "rtl.node_sine_o[63:0]"), ("value", "rtl.prdata_o[31:0]")):
            done = self.faulty(fault, "--scenario", "traffic", "--waves", "w", "--junit", "junit.xml")
            self.assertEqual(done.returncode, 4, done.stdout + done.stderr)
            self.assertIn("waves: gtkwave w/precise-traffic-1.fst w/precise-traffic-1.gtkw", done.stdout)
            cycle = int(done.stdout.split(" cycle ")[1].split(":")[0])
            signals, text = self.signals_of(self.folder / "w" / "precise-traffic-1.fst")
            times = [int(line[1:]) for line in text.splitlines() if line.startswith("#")]
            save = (self.folder / "w" / "precise-traffic-1.gtkw").read_text().splitlines()
            names = {line for line in save if line.startswith("rtl.")}
            self.assertIn(shown, names)
            self.assertEqual(names - signals, set())
            marker = int(next(line for line in save if line.startswith("*")).split()[1])
            self.assertEqual(marker, 40 * cycle)
            self.assertTrue(times[0] <= marker <= times[-1], (times[0], marker, times[-1]))
            case = ElementTree.parse(self.folder / "junit.xml").getroot().find("testsuite/testcase")
            self.assertEqual(
                [line for line in case.find("system-out").text.split("\n") if line],
                [f"[[ATTACHMENT|{self.folder.resolve()}/w/precise-traffic-1.{kind}]]" for kind in ("fst", "gtkw")],
            )

    def test_the_printed_command_makes_the_waves(self):
        done = self.faulty("value", "--scenario", "ties")
        self.assertEqual(done.returncode, 4, done.stdout + done.stderr)
        command = next(line for line in done.stdout.splitlines() if line.startswith("waves: "))[len("waves: ") :]
        make, show = command.split("; ")
        self.assertEqual(show, "gtkwave waves/precise-ties-1.fst waves/precise-ties-1.gtkw")
        subprocess.run(
            make.replace("capsoc", str(CAPSOC), 1),
            shell=True,
            check=False,
            cwd=self.folder,
            env={**os.environ, "CAPSOC_TEST_FAULT": "value"},
            capture_output=True,
        )
        self.assertEqual(
            {file.name for file in (self.folder / "waves").iterdir()}, {"precise-ties-1.fst", "precise-ties-1.gtkw"}
        )

    def test_rtl_that_hangs_fails_its_runs(self):
        done = self.faulty(
            "hang", "--scenario", "ties", "--scenario", "registers", "--time-limit", "1.5", "--junit", "j"
        )
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertIn("out of time: it did not end within 1.5 s (--time-limit)", done.stdout)
        self.assertIn("<error message=", (self.folder / "j").read_text())

    def test_rtl_that_crashes_fails_its_runs(self):
        done = self.faulty("crash", "--scenario", "ties", "--json", "r.json", "--html", "r.html")
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertIn("crashed: signal 6: the RTL did not converge\n", done.stdout)
        run = json.loads((self.folder / "r.json").read_text())["arithmetics"]["precise"]["runs"][0]
        self.assertEqual(run["difference"]["kind"], "no result")
        self.assertIn("crashed: signal 6", (self.folder / "r.html").read_text())

    def test_what_verilator_says_of_a_loop_is_in_every_report(self):
        done = self.faulty("loop", "--scenario", "ties", "--json", "r.json", "--junit", "r.xml")
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        said = "crashed: signal 6: %Error: polar_unit.sv:12: Active region did not converge."
        self.assertIn(said + "\n", done.stdout)
        self.assertEqual(done.stdout.count("Aborting..."), 1, "in the log of the one that is shown, and nowhere else")
        difference = json.loads((self.folder / "r.json").read_text())["arithmetics"]["precise"]["runs"][0]["difference"]
        self.assertEqual(difference["what"], said)
        self.assertIn("Aborting...", difference["report"])
        self.assertIn(said, (self.folder / "r.xml").read_text())

    def test_a_library_that_cannot_be_loaded_says_why(self):
        (self.folder / "none.so").write_text("no library\n")
        done = regress("--rtl-library", self.folder / "none.so", "--arithmetic", "precise", "--scenario", "ties")
        self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
        self.assertRegex(done.stderr, r"can be loaded \(.*none\.so: .*\)")


class Rebuild(Case):
    """--rebuild in a folder that looks like a build tree, with a cmake that is a script."""

    def regress(self, cmake, *arguments):
        program = self.folder / "build" / "capsoc"
        program.parent.mkdir()
        shutil.copy(CAPSOC, program)
        (program.parent / "CMakeCache.txt").write_text("")
        (self.folder / "bin").mkdir()
        (self.folder / "bin" / "cmake").write_text(f"#!/bin/sh\n{cmake}\n")
        (self.folder / "bin" / "cmake").chmod(0o755)
        return subprocess.run(
            [program, "regress", "--rebuild", "--arithmetic", "precise", "--scenario", "ties", *arguments],
            capture_output=True,
            text=True,
            check=False,
            cwd=self.folder,
            env={**CLEAN, "PATH": f"{self.folder / 'bin'}:{CLEAN['PATH']}"},
        )

    def test_it_compares_what_it_has_built(self):
        library = self.folder / "build" / "libcapsoc_rtl_precise_fast.so"
        done = self.regress(f"echo \"$@\" >asked; cp {BUILD / 'libcapsoc_rtl_precise.so'} {library}")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("no difference", done.stdout)
        asked = (self.folder / "asked").read_text().split()
        self.assertEqual(asked[0], "--build")
        self.assertEqual(asked[2:], ["--target", "capsoc_rtl_precise_fast"])

    def test_what_the_tools_say_is_shown(self):
        done = self.regress(
            "echo '[1/5] Verilating'; echo 'FAILED: all.cpp'; echo 'cd build && verilator'; "
            "echo '%Error: rtl/polar_unit.sv:12:3: syntax error'; "
            "echo 'Traceback (most recent call last):'; echo 'KeyError: 7'; echo 'ninja: build stopped'; exit 1"
        )
        self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
        lines = done.stderr.splitlines()
        self.assertEqual(
            lines[:3],
            ["%Error: rtl/polar_unit.sv:12:3: syntax error", "Traceback (most recent call last):", "KeyError: 7"],
        )
        self.assertIn("does not build", lines[3])

    def test_it_goes_with_no_library_of_another(self):
        done = self.regress("exit 1", "--rtl-library", "x.so")
        self.assertEqual(done.returncode, 2)
        self.assertIn("leave --rtl-library", done.stderr)


class Signals(unittest.TestCase):
    """A long regression that is asked, or ended."""

    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.json = Path(temporary.name) / "r.json"
        # Files, since the test does not read while it runs: a full pipe would block it.
        self.printed = open(Path(temporary.name) / "printed", "w+", encoding="utf-8")
        self.addCleanup(self.printed.close)
        self.junit = Path(temporary.name) / "r.xml"
        self.process = subprocess.Popen(
            [
                CAPSOC,
                "regress",
                "--samples",
                "3000000",
                "--accesses",
                "0",
                "--jobs",
                "2",
                "--arithmetic",
                "precise",
                "--seeds",
                "60",
                "--json",
                self.json,
                "--junit",
                self.junit,
            ],
            stdout=self.printed,
            stderr=subprocess.STDOUT,
            text=True,
        )
        self.addCleanup(self.process.wait)
        self.addCleanup(self.process.kill)

    def listens(self):
        """Whether the process has come so far that SIGUSR1 does not end it."""
        status = Path(f"/proc/{self.process.pid}/status").read_text()
        caught = int(re.search(r"SigCgt:\s*(\w+)", status)[1], 16)
        return caught >> (signal.SIGUSR1 - 1) & 1

    def ask_until_something_is_done(self):
        """Directed scenarios are short and the long ones go first, so this asks again and again."""
        for _ in range(600):
            time.sleep(0.1)
            self.assertIsNone(self.process.poll())
            if not self.listens():
                continue
            self.process.send_signal(signal.SIGUSR1)
            result = json.loads(self.json.read_text()) if self.json.exists() else {"partial": {"done": 0}}
            if result["partial"]["done"] > 0:
                return result
        self.fail("no report within a minute")

    def wait_for_skipped(self, count):
        """In the JUnit file of the newest JSON: one file is put in its place after the other."""
        until = time.monotonic() + 10
        while True:
            skipped = int(ElementTree.parse(self.junit).getroot().find("testsuite").get("skipped"))
            if skipped == count or time.monotonic() > until:
                return self.assertEqual(skipped, count)
            time.sleep(0.01)

    def test_asked_for_a_report_it_writes_one_and_goes_on(self):
        result = self.ask_until_something_is_done()
        self.assertLess(result["partial"]["done"], result["partial"]["of"])
        self.assertEqual(len(result["arithmetics"]["precise"]["runs"]), result["partial"]["done"])
        self.wait_for_skipped(result["partial"]["of"] - result["partial"]["done"])
        time.sleep(0.3)
        self.assertIsNone(self.process.poll())

    def test_ended_it_writes_what_is_done(self):
        self.ask_until_something_is_done()
        self.json.unlink()
        self.process.send_signal(signal.SIGTERM)
        self.assertEqual(self.process.wait(timeout=60), 128 + signal.SIGTERM)
        self.printed.seek(0)
        output = self.printed.read()
        self.assertIn("PARTIAL: ", output)
        self.assertIn("no difference until here", output)
        partial = json.loads(self.json.read_text())["partial"]
        self.assertTrue(0 < partial["done"] < partial["of"], partial)


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
