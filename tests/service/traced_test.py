#!/usr/bin/python3
"""Traces of a part of a run, asked for afterwards: of a history, of a recorded session, after a restored state."""

import hashlib
import json
import re
import subprocess
import unittest

from history_test import SHORT
from harness import CAPSOC, CLEAN, FIRMWARE
from protocol_test import Refused
from replay_test import Replayed

CTEST = {"name": "service: traced", "timeout": 300, "interpreter": "/usr/bin/python3"}

FILES = {
    "instructions": "i.txt",
    "bus": "b.txt",
    "profile": "p.callgrind",
    "coverage": "c.info",
    "waves": "w.fst",
    "timeline": "t.json",
}
OPTIONS = {name: f"--trace-{name}" for name in ("instructions", "bus", "waves")} | {
    name: f"--{name}" for name in ("profile", "coverage", "timeline")
}
CLOCK_HZ = 25_000_000


class Traced(Replayed):
    def files(self, prefix="", names=tuple(FILES)):
        return {name: str(self.folder / (prefix + FILES[name])) for name in names}

    def words(self, prefix=""):
        return [word for name, file in FILES.items() for word in (OPTIONS[name], prefix + file)]

    def run_program(self, *words, seconds=2):
        settings = [
            word
            for name, value in {**SHORT, "run.simlimit_s": str(seconds)}.items()
            for word in ("-C", f"{name}={value}")
        ]
        done = subprocess.run(
            [CAPSOC, "run", FIRMWARE / "selfcal.elf", *settings, "--uart0", "null", *words],
            cwd=self.folder,
            env=CLEAN,
            capture_output=True,
            check=False,
            timeout=100,
        )
        self.assertIn(done.returncode, (0, 124), done.stderr)

    def lines(self, name, prefix=""):
        return (self.folder / (prefix + FILES[name])).read_text().splitlines()

    def bytes(self, name, prefix=""):
        return (self.folder / (prefix + FILES[name])).read_bytes()

    def cycles_of(self, line):
        return int(line.split()[0])

    def profiled(self, prefix=""):
        """All cycles of the profile, by the sum of its lines of costs: self costs alone."""
        total, is_call = 0, False
        for line in self.lines("profile", prefix):
            if line.startswith("calls="):
                is_call = True
            elif re.match(r"(0x[0-9a-f]+|[+*-]\d*|\d+) ", line):
                total, is_call = total + (0 if is_call else int(line.split()[-2])), False
        return total


class Parts(Traced):
    """history.trace: of a simulation whose settings ask for no trace."""

    def trace(self, simulation, one, other=None, **files):
        between = {"one": one} if other is None else {"one": one, "other": other}
        return self.session("history.trace", simulation=simulation, files=files, **between)

    def test_a_part_has_the_lines_of_the_whole(self):
        self.run_program(*self.words("whole-"))
        simulation = self.construct(**SHORT)
        self.advance(simulation, until_s=1.6)
        before = self.session("history.when", simulation=simulation, hash=True)
        told = self.trace(simulation, {"time_s": 1.1}, {"time_s": 1.3}, **self.files())
        self.assertEqual(self.session("history.when", simulation=simulation, hash=True), before)
        self.assertEqual(told["lost"], [])
        first, last = told["one"]["cycles"], told["other"]["cycles"]
        self.assertGreaterEqual(told["one"]["time_s"], 1.1)
        for name in ("instructions", "bus"):
            heading, *lines = self.lines(name)
            whole = self.lines(name, "whole-")
            self.assertEqual(heading, whole[0])
            self.assertEqual(lines, [line for line in whole[1:] if first <= self.cycles_of(line) < last], name)
            self.assertGreater(len(lines), 1000)
        self.assertEqual(self.profiled(), last - first)
        self.assertLessEqual(sum(each["cycles"] for each in told["functions"]), last - first)
        slices = [each for each in json.loads(self.bytes("timeline"))["traceEvents"] if each["ph"] == "X"]
        for each in slices:
            self.assertGreaterEqual(each["ts"], told["one"]["time_s"] * 1e6 - 1e-3)
        # One thread, handlers and sleep have all of the time.
        processor = [each for each in slices if each["pid"] == 2]
        used = sum(each["dur"] for each in processor)
        self.assertAlmostEqual(used, (told["other"]["time_ps"] - told["one"]["time_ps"]) / 1e6, delta=0.1)

    def test_parts_of_coverage_are_the_whole(self):
        simulation = self.construct(**SHORT)
        self.advance(simulation, until_s=1.5)
        everything = self.files("all-", ["coverage"])
        self.trace(simulation, {"time_s": 0}, **everything)
        for one, other in ((0, 0.4), (0.4, 1.2), (1.2, 1.5)):
            self.trace(simulation, {"time_s": one}, {"time_s": other}, **self.files("", ["coverage"]))
        self.assertEqual(self.lines("coverage"), self.lines("coverage", "all-"))

    def test_in_a_handler_and_asleep(self):
        simulation = self.construct(**SHORT)
        self.session("simulation.advance", simulation=simulation, exception=16 + 30)
        self.session("simulation.advance", simulation=simulation, instructions=3)
        inside = self.session("history.when", simulation=simulation)["now"]
        self.advance(simulation, until_s=0.9)
        self.assertTrue(self.session("simulation.state", simulation=simulation)["state"]["asleep"])
        asleep = self.session("history.when", simulation=simulation)["now"]
        self.advance(simulation, until_s=1.2)
        for begin in (inside, asleep):
            told = self.trace(simulation, {"time_ps": begin["time_ps"]}, **self.files())
            self.assertEqual(told["one"], begin)
            self.assertEqual(self.profiled(), told["other"]["cycles"] - begin["cycles"])
            processor = [
                each
                for each in json.loads(self.bytes("timeline"))["traceEvents"]
                if each["ph"] == "X" and each["pid"] == 2
            ]
            first = min(processor, key=lambda each: each["ts"])
            self.assertAlmostEqual(first["ts"], begin["time_ps"] / 1e6, delta=1e-3)
            self.assertEqual(first["name"] == "sleeps", begin is asleep, first)
            (self.folder / FILES["coverage"]).unlink()

    def test_refusals(self):
        simulation = self.construct(**SHORT)
        self.advance(simulation, seconds=0.5)
        program = self.folder / "selfcal.elf"
        program.write_bytes((FIRMWARE / "selfcal.elf").read_bytes())
        own = self.construct(str(self.folder / "selfcal"))
        for number, between, files, sentence in (
            (simulation, {"time_s": 0.1}, {}, "files names no trace, for instance profile"),
            (simulation, {"time_s": 0.1}, {"depth": 3}, "files names no trace"),
            (simulation, {"time_s": 0.1}, {"prifile": "x"}, "there is no setting 'trace.prifile'"),
            (simulation, {"time_s": 0.1}, {"profile": [1]}, "trace.profile has to be a text, a number, true or false"),
            (simulation, {"time_s": 0.1}, {"profile": "x", "start": "nowhere"}, "nowhere"),
            (simulation, {"time_s": 0.1}, {"profile": "/no/folder/x"}, "/no/folder/x"),
            (simulation, {"time_s": 0.1}, {"profile": "x.a", "bus": "x.a"}, "x.a"),
            (simulation, {"nothing": 1}, {"profile": "x"}, "a position is a time_s"),
            (own, {"time_s": 0}, {"profile": str(program)}, "selfcal.elf"),
        ):
            with self.subTest(sentence), self.assertRaisesRegex(Refused, re.escape(sentence)):
                self.trace(number, between, **files)
        with self.assertRaisesRegex(Refused, "other lies before one"):
            self.trace(simulation, {"time_s": 0.2}, {"time_s": 0.1}, profile=str(self.folder / "p"))
        self.assertEqual(program.read_bytes(), (FIRMWARE / "selfcal.elf").read_bytes())
        without = self.construct(**SHORT, history_mb=0)
        with self.assertRaisesRegex(Refused, "there is no history"):
            self.trace(without, {"time_s": 0}, profile="x")


class Sessions(Traced):
    """capsoc replay with the options of a run."""

    def test_a_replay_has_the_traces_of_the_run(self):
        simulation = self.construct(**SHORT)
        self.advance(simulation, until_s=0.6)
        self.session("simulation.record", simulation=simulation, file=str(self.folder / "a.session"))
        self.run_program(*self.words("run-"), seconds=0.6)
        plain = self.replay()
        self.assertEqual(self.replay(*self.words()), plain)
        # The reset is before the session's first instant, at which a client could send something.
        for name, of_reset in (("instructions", 1), ("bus", 2)):
            whole = self.lines(name, "run-")
            self.assertEqual(self.lines(name), whole[:1] + whole[1 + of_reset :])
        self.assertEqual(self.bytes("profile"), self.bytes("profile", "run-"))

        def counts(prefix):
            return [line for line in self.lines("coverage", prefix) if not line.startswith("SF:")]

        self.assertEqual(counts(""), counts("run-"))

    def test_refusals(self):
        simulation = self.construct(**SHORT)
        self.advance(simulation, seconds=0.1)
        session = self.folder / "a.session"
        self.session("simulation.record", simulation=simulation, file=str(session))
        recorded = hashlib.sha256(session.read_bytes()).hexdigest()
        for words, sentence in (
            (["--profile", "/no/folder/x"], "/no/folder/x"),
            (["--profile", "x", "--trace-bus", "x"], "x"),
            (["--profile", "a.session"], "a.session"),
            (["--profile", "p", "--gdb", "0"], "--profile: a debugger goes back and forth"),
            (["--timeline", "p", "--view", "0"], "--timeline: a page goes back and forth"),
        ):
            with self.subTest(words):
                self.assertIn(sentence, self.replay(*words, code=2)[1])
        self.assertEqual(hashlib.sha256(session.read_bytes()).hexdigest(), recorded)


class Restored(Traced):
    """capsoc run --restore: what was before the saved state is no part of a trace."""

    def test_a_profile_begins_with_the_state(self):
        self.run_program("--save", "s.capsoc@1.0")
        self.run_program("--restore", "s.capsoc", *self.words("rest-"))
        self.run_program(*self.words("whole-"))
        first = self.cycles_of(self.lines("instructions", "rest-")[1])
        self.assertGreaterEqual(first, CLOCK_HZ)
        self.assertLessEqual(self.profiled("rest-"), CLOCK_HZ + 1000)
        slices = [each for each in json.loads(self.bytes("timeline", "rest-"))["traceEvents"] if each["ph"] == "X"]
        self.assertGreaterEqual(min(each["ts"] for each in slices), 1e6)
        used = sum(each["dur"] for each in slices if each["pid"] == 2)
        self.assertAlmostEqual(used, 1e6, delta=1)


if __name__ == "__main__":
    unittest.main()
