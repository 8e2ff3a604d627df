#!/usr/bin/python3
"""The pytest plugin, by running pytest on test files in a folder, without a simulator and with the program."""

import re
import subprocess
import sys
import unittest
from pathlib import Path

from harness import CAPSOC, CLEAN, SOURCE, Case

sys.path[:0] = [str(Path(__file__).parent)]

import fake_session  # noqa: E402

CTEST = {"name": "python plugin", "interpreter": "/usr/bin/python3", "timeout": 900}


class Pytest(Case):
    def pytest_with(self, program, text, *arguments):
        """(status, output) of pytest on a file; the folder of its temporary files is `tmp`."""
        (self.folder / "test_it.py").write_text(text)
        command = [sys.executable, "-m", "pytest", "-p", "capsoc.pytest_plugin", "-p", "no:cacheprovider"]
        command += ["--capsoc-program", program, "--basetemp", self.folder / "tmp", *arguments, "test_it.py"]
        environment = {**CLEAN, "PYTHONPATH": str(SOURCE / "platform/python"), "COLUMNS": "100"}
        environment["PYTHONDONTWRITEBYTECODE"] = "1"
        done = subprocess.run(
            [*map(str, command)],
            cwd=self.folder,
            env=environment,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
        )
        return done.returncode, done.stdout + done.stderr


class Plugin(Pytest):
    """With a session without a simulator."""

    def pytest(self, text, *arguments, **faults):
        (self.folder / "bin").mkdir(exist_ok=True)
        return self.pytest_with(fake_session.program(self.folder / "bin", **faults), text, *arguments)

    def test_pass(self):
        status, said = self.pytest(
            """
import pytest

def test_text(capsoc):
    with capsoc.run("x.elf", sensor=capsoc.Sensor(a1=0.5), settings={"fake.uart0": [[1, "ok 7"]]}) as sim:
        assert sim.uart0.expect(r"ok (\\d)", within=2)[1] == "7"

def test_refused(capsoc):
    with pytest.raises(capsoc.SimulationError, match="sensor.a1"):
        capsoc.run("x.elf", sensor=capsoc.Sensor(a1=-1))

def test_expected_failure(capsoc):
    with pytest.raises(capsoc.ExpectationError):
        with capsoc.run("x.elf") as sim:
            sim.uart0.expect("x", within=1)

def test_one_session(capsoc):
    capsoc.run("x.elf")  # left open: closed after the test
    assert capsoc.session.call("session.about")["pid"] == capsoc.session.process.pid

def test_without_the_fixture():
    pass
"""
        )
        self.assertEqual(status, 0, said)
        self.assertIn("5 passed", said)
        self.assertEqual(list(self.folder.rglob("*.checkpoint")), [])

    def test_fail(self):
        status, said = self.pytest(
            """
def test_in_with(capsoc):
    with capsoc.run("x.elf", settings={"fake.uart0": [[0.5, "hello\\n"]], "fake.uart2": [[0, "two"]]}) as sim:
        sim.uart0.expect("pass", within=1)

def test_left_open(capsoc):
    sim = capsoc.run("y.elf", settings={"fake.end_s": 2})
    sim.advance()
    assert sim.state.cycles == 0
"""
        )
        self.assertEqual(status, 1, said)
        for words in (
            "2 failed",
            "UART 0 did not send 'pass' within 1 simulated s: it is 1.000000 s and the program is at main (main.c:55)",
            "capsoc x.elf (1)",
            "time 1.000000000 s, cycle 25000000",
            "-- UART 0, the last 1 lines:\nhello",
            "-- UART 2, the last 1 lines:\ntwo",
            "HardFault at main.c:55",
            "the program has ended",
            "-- exit 5: the firmware crashed\nHardFault at main.c:55",
            "capsoc y.elf (1)",
            "at main (main.c:55)",
        ):
            self.assertIn(words, said)
        files = re.findall(r"^checkpoint: (.+)$", said, re.MULTILINE)
        self.assertEqual([Path(file).read_text() for file in files], ["a checkpoint"])
        self.assertEqual({Path(file).parent for file in files}, {self.folder / "tmp"})

    def test_a_session_that_dies_fails_one_test(self):
        status, said = self.pytest(
            """
def test_dies(capsoc):
    with capsoc.run("x.elf") as sim:
        sim.call("echo")

def test_goes_on(capsoc):
    with capsoc.run("x.elf") as sim:
        sim.advance(1)
""",
            die="echo",
        )
        self.assertEqual(status, 1, said)
        self.assertIn("1 failed, 1 passed", said)
        self.assertIn("capsoc: it dies as told", said)

    def test_the_marker_sets_the_backend(self):
        text = """
import pytest

@pytest.mark.capsoc(backend="lockstep")
def test_marked(capsoc):
    assert capsoc.backend == "lockstep"
    with pytest.raises(capsoc.SimulationError, match="'lockstep'"):
        capsoc.run("x.elf", settings={"fake.refuse": "coprocessor.backend"})

def test_not_marked(capsoc):
    assert capsoc.backend is None
"""
        status, said = self.pytest(text, "--strict-markers")
        self.assertEqual(status, 0, said)
        status, said = self.pytest(text.replace('"lockstep")', '"verilog")', 1))
        self.assertIn("the marker is capsoc(backend=...) with one of tlm, rtl, lockstep", said)

    def test_a_page(self):
        text = """
def test_one(capsoc):
    with capsoc.run("one.elf") as sim:
        sim.advance(1)

def test_two(capsoc):
    capsoc.run("two.elf").advance(1)
    with capsoc.run("three.elf") as sim:
        assert sim.advance(1).state.cycles == 0
"""
        status, said = self.pytest(text, "--capsoc-html", "page.html")
        self.assertEqual(status, 1, said)
        page = (self.folder / "page.html").read_text()
        self.assertEqual(page, "001-one.json 002-three.json 003-two.json")

    def test_a_wrong_program(self):
        status, said = self.pytest("def test_it(capsoc): pass\n", "--capsoc-program", "/nowhere")
        self.assertEqual(status, 1, said)
        self.assertIn("/nowhere: is no program (named by program)", said)


class RealProgram(Pytest):
    def test_backends(self):
        status, said = self.pytest_with(
            CAPSOC,
            """
import pytest

@pytest.mark.parametrize("backend", [pytest.param(b, marks=pytest.mark.capsoc(backend=b)) for b in ("tlm", "rtl")])
def test_backend(capsoc, backend):
    with capsoc.run("selfcal.elf") as sim:
        sim.advance(seconds=0.5)
        assert sim.finish()["configuration"]["coprocessor.backend"] == backend
""",
        )
        self.assertEqual(status, 0, said)

    def test_a_failed_test_leaves_a_checkpoint_that_resumes_and_a_page(self):
        status, said = self.pytest_with(
            CAPSOC,
            """
def test_it(capsoc):
    with capsoc.run("selfcal.elf") as sim:
        sim.uart0.expect("absent", within=2)
""",
            "--capsoc-html",
            "page.html",
        )
        self.assertEqual(status, 1, said)
        self.assertIn("UART 0 did not send 'absent' within 2 simulated s: it is 2.0", said)
        self.assertIn("| selfcal: self-calibration at a known speed", said)
        self.assertIn("sampling_wait", said)
        file = re.search(r"^checkpoint: (.+)$", said, re.MULTILINE)[1]
        process = self.start("run", "--restore", file, "--simlimit", "3", "--json", "r.json")
        process.communicate(timeout=60)
        self.assertGreaterEqual(self.result()["samples"], 740)
        self.assertIn("<html", (self.folder / "page.html").read_text()[:1000])


if __name__ == "__main__":
    unittest.main()
