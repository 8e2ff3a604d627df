#!/usr/bin/python3
"""Recorded sessions: capsoc replay gives the same bytes, names the first difference, and refuses what is no session."""

import contextlib
import hashlib
import json
import os
import random
import re
import signal
import subprocess
import threading
import unittest
from pathlib import Path

from history_test import SHORT, Past
from harness import CAPSOC, CLEAN, FIRMWARE, TRACES
from protocol_test import Refused

CTEST = {"name": "service: replay", "timeout": 600, "interpreter": "/usr/bin/python3"}

SEED = 20261126


class Replayed(Past):
    """Sessions in the test's folder, and capsoc replay."""

    def run_replay(self, name, *words):
        return subprocess.run(
            [CAPSOC, "replay", name, *words], cwd=self.folder, env=CLEAN, capture_output=True, check=False, timeout=300
        )

    def replay(self, *words, code=0, name="a.session"):
        done = self.run_replay(name, *words)
        self.assertEqual(done.returncode, code, done.stderr)
        return done.stdout.decode(), done.stderr.decode()


class Replays(Replayed):
    """A session of the main job and of a program that answers, recorded and simulated again."""

    def record(self, simulation, name="a.session"):
        return self.session("simulation.record", simulation=simulation, file=str(self.folder / name))

    def test_what_came_from_outside(self):
        simulation = self.construct("echo")
        self.advance(simulation, seconds=0.001)
        self.session("uart.send", simulation=simulation, uart=0, bytes=[99, 0, 0, 0, 65, 66, 67])
        self.advance(simulation, seconds=0.0003)
        self.session("memory.write", simulation=simulation, address=0x20300000, bytes="abc")
        self.session("history.keep", simulation=simulation)
        self.advance(simulation, seconds=0.005)
        self.session("pin.drive", simulation=simulation, gpio=2, pin=1, level=True)
        text = self.text(simulation)
        told = self.record(simulation)
        self.assertEqual(told["inputs"], 3)
        said, about = self.replay()
        self.assertEqual(said, text)
        self.assertRegex(about, "the same until 0.006.* s: 3 inputs, [12] states compared")
        self.assertRegex(self.replay("--until", "0.002")[1], "the same until 0.002.* s: 2 inputs")

    def test_the_sensor_that_is_built_in(self):
        simulation = self.construct("echo", **{"sensor.file": "built-in:soc_eq21.toml"})
        self.advance(simulation, seconds=0.001)
        self.session("sensor.set", simulation=simulation, parameters={"b1": 0.1})
        self.advance(simulation, seconds=0.001)
        self.assertEqual(self.record(simulation)["inputs"], 1)
        self.assertRegex(self.replay()[1], "the same until 0.002 s: 1 inputs")
        # Without the program that has it: by its content.
        self.assertIn((TRACES / "soc_eq21.toml").read_bytes(), (self.folder / "a.session").read_bytes())

    def run_recorded(self, program, *options, code=0, given=b"", name="a.session"):
        """What `capsoc run --record-session` says, and the same run without it."""
        both = []
        for more in (("--record-session", name), ()):
            done = subprocess.run(
                [CAPSOC, "run", FIRMWARE / f"{program}.elf", *options, *more],
                cwd=self.folder,
                env=CLEAN,
                input=given,
                capture_output=True,
                check=False,
                timeout=300,
            )
            self.assertEqual(done.returncode, code, done.stderr)
            both.append(done)
        return both

    def test_a_run_of_the_command_line(self):
        recorded, plain = self.run_recorded("hello")
        self.assertEqual(recorded.stdout, plain.stdout)
        for done in (recorded, plain):
            self.assertIn(b"exit 0: the firmware ended with status 0", done.stderr)
        self.assertEqual(self.replay()[0].encode(), plain.stdout)
        recorded, plain = self.run_recorded("divzero", code=5)
        self.assertEqual(recorded.stdout, plain.stdout)
        self.assertIn(b"fault report: HardFault", recorded.stderr)
        self.replay()

    def test_what_was_typed(self):
        recorded, plain = self.run_recorded("echo", "--uart0", "stdio", given=b"\x03\0\0\0\xff\x80\n")
        self.assertEqual((recorded.stdout, plain.stdout), (b"\x03\0\0\0\xff\x80\n",) * 2)
        recorded, plain = self.run_recorded("echo", "--uart0", "stdio", given=b"\x03\0\0\0abc")
        self.assertEqual((recorded.stdout, plain.stdout), (b"\x03\0\0\0abc",) * 2)
        said, about = self.replay()
        self.assertEqual(said, "\x03\0\0\0abc")
        self.assertIn("1 inputs", about)

    def test_what_the_console_was_asked(self):
        """The guest sees no difference between an answer that was there and one that came late."""
        options = ("--uart0", "null", "--semihosting-console", "stdio")
        for given in (
            b"",
            b"first\nx\nsecond, of more than the 23 bytes of a read\nquit\n",
            b"abc",
            b"a\nb\nc\n" * 200,
        ):
            with self.subTest(given=given[:20]):
                recorded, plain = self.run_recorded("questions", *options, given=given)
                self.assertEqual(recorded.stdout, plain.stdout)
                self.assertRegex(self.replay()[1], rf"the same until .*: {given.count(10) + 1} inputs")
        traces = []
        for words in (("run", FIRMWARE / "questions.elf", *options), ("replay", "a.session")):
            trace = self.folder / f"{words[0]}.txt"
            subprocess.run(
                [CAPSOC, *words, "--trace-instructions", trace],
                cwd=self.folder,
                env=CLEAN,
                input=given,
                capture_output=True,
                check=True,
                timeout=300,
            )
            traces.append([line for line in trace.read_text().splitlines() if "--- reset" not in line])
        self.assertGreater(len(traces[0]), 100_000)
        self.assertTrue(traces[0] == traces[1])

    def test_answers_that_take_their_time(self):
        words = [CAPSOC, "run", FIRMWARE / "questions.elf", "--uart0", "null", "--semihosting-console", "stdio"]
        plain = subprocess.run(words, input=b"one\ntwo\n", env=CLEAN, capture_output=True, check=True, timeout=60)
        slow = subprocess.Popen(
            [*words, "--record-session", "a.session"],
            cwd=self.folder,
            env=CLEAN,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
        )
        self.addCleanup(slow.kill)
        for_ever = threading.Timer(60, slow.kill)
        self.addCleanup(for_ever.cancel)
        for_ever.start()
        said = b""
        for answer, wanted in ((b"one\n", b"line? "), (b"two\n", b"character? ")):
            while not said.endswith(wanted):
                byte = slow.stdout.read(1)
                self.assertTrue(byte, said)
                said += byte
            slow.stdin.write(answer)
            slow.stdin.flush()
        rest, _ = slow.communicate(timeout=60)
        self.assertEqual((slow.returncode, said + rest), (0, plain.stdout))
        self.assertIn("the same until", self.replay()[1])

    def test_its_results_and_what_is_refused(self):
        recorded = self.run_recorded("hello", "--json", "r.json", "--html", "r.html")[0]
        results = json.loads((self.folder / "r.json").read_text())
        self.assertEqual((recorded.returncode, results["exit"]["code"]), (0, 0))
        self.assertIn("hello from capsoc", (self.folder / "r.html").read_text())
        for options, sentence in (
            (["--trace-bus", "t"], "no history: trace.bus names a place"),
            (["--uart1", "pty:p"], "no history: uart1.backend connects the simulation to pty:p"),
            (["--halt"], "--halt waits for a debugger"),
            (["--gdb-history"], "--gdb-history is for a debugger: add --gdb"),
        ):
            with self.subTest(options=options):
                done = subprocess.run(
                    [CAPSOC, "run", FIRMWARE / "hello.elf", "--record-session", "x.session", *options],
                    cwd=self.folder,
                    env=CLEAN,
                    capture_output=True,
                    check=False,
                    timeout=60,
                )
                self.assertEqual((done.returncode, done.stdout), (2, b""))
                self.assertIn(sentence, done.stderr.decode())
                self.assertFalse((self.folder / "x.session").exists())

    def test_a_simulation_that_is_killed_did_not_end_well(self):
        run = subprocess.Popen(
            [CAPSOC, "run", FIRMWARE / "forever.elf", "--uart0", "null", "--record-session", "a.session"],
            cwd=self.folder,
            env=CLEAN,
            stderr=subprocess.PIPE,
        )
        worker = run.pid
        for _ in range(2):  # the session, and the simulation in it
            children = []
            while not children and run.poll() is None:
                children = Path(f"/proc/{worker}/task/{worker}/children").read_text().split()
            worker = int(children[0])
        os.kill(worker, signal.SIGKILL)
        said = run.communicate(timeout=60)[1].decode()
        self.assertEqual(run.returncode, 70, said)
        self.assertIn("simulation 1 was ended by signal 9", said)
        self.assertFalse((self.folder / "a.session").exists())

    def test_the_main_job_from_another_folder(self):
        (self.folder / "own.elf").write_bytes((FIRMWARE / "selfcal.elf").read_bytes())
        (self.folder / "own.toml").write_bytes((TRACES / "soc_eq21.toml").read_bytes())
        simulation = self.construct(
            "x", **{"firmware.elf": str(self.folder / "own.elf"), "sensor.file": str(self.folder / "own.toml")}, **SHORT
        )
        for _ in range(4):
            self.advance(simulation, seconds=0.3)
            self.session("history.keep", simulation=simulation)
            self.session("sensor.set", simulation=simulation, parameters={"b1": 0.1})
            self.advance(simulation, instructions=1000)
            self.session("history.keep", simulation=simulation)
        self.record(simulation)
        # The files by content: where they were does not matter any more.
        (self.folder / "own.elf").unlink()
        (self.folder / "own.toml").write_text("nothing")
        self.assertRegex(self.replay()[1], "4 inputs, [4-9] states compared")

    def forge(self, change, name="b.session"):
        """A session with another header, and the hash that belongs to it."""
        data = (self.folder / "a.session").read_bytes()
        line, rest = data.split(b"\n", 1)
        size = int(line.split()[3])
        header = json.loads(rest[:size])
        change(header)
        text = json.dumps(header).encode()
        first = f"capsoc session 1 {len(text)} {hashlib.sha256(text).hexdigest()}\n".encode()
        (self.folder / name).write_bytes(first + text + rest[size:])
        return name

    def test_the_first_difference_is_named(self):
        simulation = self.construct("selfcal", **SHORT)
        for _ in range(3):
            self.advance(simulation, seconds=0.25)
            self.session("history.keep", simulation=simulation)
        self.advance(simulation, seconds=0.25)
        self.record(simulation)

        def other_state(header):
            mark = next(each for each in header["marks"] if each["at"]["time_s"] >= 0.5)
            mark["parts"]["timer1"] = "0" * 64

        about = self.replay(name=self.forge(other_state), code=1)[1]
        self.assertRegex(about, r"differs between 0\.25\S* s and 0\.5\S* s: in timer1")
        wanted = self.forge(lambda header: header["uarts"][0].update(sha256="0" * 64))
        self.assertRegex(self.replay(name=wanted, code=1)[1], "differs at its end: uart0")

        def other_program(header):
            header["settings"]["program.demodulation_samples"] = "501"

        self.assertRegex(self.replay(name=self.forge(other_program), code=1)[1], "differs between 0 s and")

    def test_what_is_refused(self):
        simulation = self.construct("echo")
        self.advance(simulation, seconds=0.001)
        self.session("uart.send", simulation=simulation, uart=0, bytes=[1, 0, 0, 0, 65])
        self.record(simulation)
        data = (self.folder / "a.session").read_bytes()
        draw = random.Random(SEED)
        kinds = [
            lambda: data[: draw.randrange(len(data))],
            lambda: data + b"x",
            lambda: data[:15] + b"7" + data[16:],
            lambda: b"capsoc checkpoint 1" + data,
        ]
        for number, kind in enumerate(kinds):
            (self.folder / "b.session").write_bytes(kind())
            about = self.replay(name="b.session", code=2)[1]
            self.assertEqual(about.count("\n"), 1, (number, about))
        self.assertRegex(self.replay(name="none", code=2)[1], "none: .*")
        for name in ("trace.instructions", "uart0.backend", "checkpoint.save", "coprocessor.rtl_library"):
            writes = self.forge(lambda header, name=name: header["settings"].update({name: "x@1"}))
            self.assertRegex(self.replay(name=writes, code=2)[1], f"the session sets {name}")
        self.assertFalse((self.folder / "x").exists())
        library = self.forge(lambda header: header["files"][0].update(setting="coprocessor.rtl_library"))
        self.assertRegex(self.replay(name=library, code=2)[1], "the session sets coprocessor.rtl_library")
        unknown = self.forge(lambda header: header["settings"].update({"no.such": "1"}))
        self.assertRegex(self.replay(name=unknown, code=2)[1], "no.such")
        with self.assertRaisesRegex(Refused, "there is no history"):
            self.record(self.construct("echo", history_mb=0))
        with self.assertRaisesRegex(Refused, "cannot be written|No such"):
            self.session("simulation.record", simulation=simulation, file=str(self.folder / "no" / "x"))


class Repeated(Replayed):
    """A recorded session as a simulation: one goes into it, forward and back, and leaves it for another future."""

    def original(self, **sensor):
        """Positions and states of a session with inputs of several kinds, recorded at its end."""
        (self.folder / "own.toml").write_text((TRACES / "soc_eq21.toml").read_text())
        simulation = self.construct("selfcal", **SHORT, **sensor)
        states = {}
        for time_s, method, params in (
            (0.5, "sensor.set", {"parameters": {"b1": 0.1}}),
            (0.9, "fault.inject", {"fault": "freeze sin for 0.2"}),
            (1.3, "processor.write", {"register": "r11", "value": 77}),
            (1.7, None, {}),
        ):
            self.advance(simulation, until_s=time_s)
            if method is not None:
                self.session(method, simulation=simulation, **params)
            states[time_s] = self.where(simulation)["now"], self.session("simulation.state", simulation=simulation)
        last = self.parts(simulation, "a.session")
        self.session("simulation.close", simulation=simulation)
        (self.folder / "own.toml").write_text("nothing")
        return states, last

    def parts(self, simulation, name="b.session"):
        """Where a simulation is, and the hash of each part of its state; not of the names of its files."""
        self.session("simulation.record", simulation=simulation, file=str(self.folder / name))
        head, rest = (self.folder / name).read_bytes().split(b"\n", 1)
        return json.loads(rest[: int(head.split()[3])])["marks"][-1]

    def repeat(self, **settings):
        params = {"session": str(self.folder / "a.session"), "settings": settings}
        return self.session("simulation.construct", **params)["simulation"]

    def check(self, simulation, time_s, states):
        self.session("simulation.goto", simulation=simulation, time_s=time_s)
        now = self.where(simulation)["now"], self.session("simulation.state", simulation=simulation)
        self.assertEqual(now, states[time_s], time_s)

    def test_forward_and_back(self):
        states, last = self.original()
        simulation = self.repeat()
        told = self.where(simulation)
        self.assertEqual((told["now"]["time_ps"], told["end"]), (0, last["at"]))
        for time_s in (1.3, 0.5, 1.7, 0.9, 0.5, 1.7):
            self.check(simulation, time_s, states)
            if time_s != 0.9:  # the fault lasts
                self.session("history.keep", simulation=simulation)
        self.assertEqual(self.parts(simulation), last)
        self.assertEqual(self.where(simulation)["inputs"], 3)
        (clone,) = self.session("simulation.clone", simulation=simulation)["simulations"]
        self.session("simulation.close", simulation=simulation)
        self.session("sensor.set", simulation=clone, parameters={"a1": 0.5})  # reads the recorded file again
        self.assertGreater(self.advance(clone, seconds=0.1)["state"]["samples"], last["at"]["samples"])

    def test_by_advances(self):
        _, last = self.original()
        simulation = self.repeat()
        for goal in ({"seconds": 0.7}, {"instructions": 1000}, {"samples": 60}, {"until_s": 1.7}):
            self.advance(simulation, **goal)
        self.assertEqual(self.parts(simulation), last)
        self.advance(simulation, until_s=1.8)  # beyond the recording
        self.assertEqual(self.where(simulation)["now"], self.where(simulation)["end"])

    def test_asked_who_wrote(self):
        states, _ = self.original()
        simulation = self.repeat()
        self.session("simulation.goto", simulation=simulation, time_s=1.7)
        write = self.session("history.last_write", simulation=simulation, register="r11")
        self.assertEqual((write["found"], write["by"]), (True, "processor.write"))
        self.assertEqual(write["position"], states[1.3][0])

    def test_another_future(self):
        states, last = self.original()
        simulation = self.repeat()
        self.check(simulation, 0.9, states)
        self.session("simulation.goto", simulation=simulation, time_s=0.6)
        answer = self.session("sensor.set", simulation=simulation, parameters={"b1": 0.2})
        self.assertEqual(answer["ended_history"], last["at"] | {"history": 1})
        self.advance(simulation, until_s=1.7)
        self.assertEqual(self.where(simulation)["inputs"], 2)
        self.assertNotEqual(self.parts(simulation)["parts"], last["parts"])

    def test_settings_over_it(self):
        _, last = self.original()
        simulation = self.repeat(**{"cpu.executor": "stepping"})
        self.session("simulation.goto", simulation=simulation, time_s=1.7)
        self.assertEqual(self.parts(simulation), last)

    def test_from_a_state(self):
        """A session that begins in a kept state ends in the same state as one from the start."""
        states, last = self.original()
        simulation = self.repeat()
        for time_s in (0.5, 1.3, 1.5, 1.7):
            self.session("simulation.goto", simulation=simulation, time_s=time_s)
            self.session("history.keep", simulation=simulation)
        for last_s, from_s, inputs in ((0.1, 1.5, 0), (0.3, 1.3, 0), (1.2, 0.5, 2), (5, 0, 3)):
            told = self.session(
                "simulation.record", simulation=simulation, file=str(self.folder / "b.session"), last_s=last_s
            )
            self.assertEqual((told["from_s"], told["inputs"]), (from_s, inputs), last_s)
            self.assertIn(f"the same until 1.7 s: {inputs} inputs", self.replay(name="b.session")[1])
            again = self.session("simulation.construct", session=str(self.folder / "b.session"))["simulation"]
            self.assertEqual(self.where(again)["now"]["time_s"], from_s)
            self.session("simulation.goto", simulation=again, time_s=1.7)
            self.assertEqual(self.parts(again, "c.session"), last)
            self.session("simulation.close", simulation=again)

    def test_a_beginning_that_was_not_kept(self):
        simulation = self.construct("selfcal", history_mb=1, **SHORT)
        for time_s in range(1, 40):
            self.advance(simulation, until_s=0.04 * time_s)
            self.session("adc.inject", simulation=simulation, u=[0.1] * 2000, v=[0.2] * 2000)
            self.session("history.keep", simulation=simulation)
        self.assertGreater(self.where(simulation)["beginning"]["time_s"], 0)
        self.parts(simulation, "a.session")
        self.replay()

    def test_the_last_seconds_of_a_run(self):
        words = [word for name, value in SHORT.items() for word in ("-C", f"{name}={value}")]
        run = [CAPSOC, "run", FIRMWARE / "selfcal.elf", *words, "--uart0", "null", "--keep-last", "0.5"]
        done = subprocess.run(run, cwd=self.folder, env=CLEAN, capture_output=True, check=False, timeout=60)
        self.assertEqual(done.returncode, 2)
        self.assertIn(b"--keep-last is the end of a recorded session; add --record-session FILE", done.stderr)
        run += ["--record-session", "a.session"]
        subprocess.run(run, cwd=self.folder, env=CLEAN, capture_output=True, check=False, timeout=60)
        self.replay()

    def test_a_state_that_is_none(self):
        self.original()
        simulation = self.repeat()
        self.session("simulation.goto", simulation=simulation, time_s=0.5)
        self.session("history.keep", simulation=simulation)
        self.session("simulation.goto", simulation=simulation, time_s=0.7)
        self.session("simulation.record", simulation=simulation, file=str(self.folder / "a.session"), last_s=0.1)
        head, rest = (self.folder / "a.session").read_bytes().split(b"\n", 1)
        size = int(head.split()[3])
        header, blobs = json.loads(rest[:size]), rest[size:]
        begin = sum(each["size"] for each in header["files"])
        state, log = blobs[begin : begin + header["state"]], blobs[begin + header["state"] :]
        draw = random.Random(SEED)
        kinds = [lambda: b"", lambda: b"{}", lambda: state[: draw.randrange(len(state))]]
        kinds += [
            lambda: state.replace(b'"waiting"', b'"wasting"'),
            lambda: state.replace(b'"course":[', b'"course":["",'),
            lambda: re.sub(rb'"course":\[[^]]*\]', lambda found: b'"course":[1'.ljust(len(found[0]) - 1) + b"]", state),
        ]
        refused_ones = len(kinds)
        kinds += [lambda: bytes(byte ^ (draw.random() < 1e-4) << draw.randrange(8) for byte in state)] * 20
        for number, kind in enumerate(kinds):
            other = kind()
            header.update(state=len(other), state_sha256=hashlib.sha256(other).hexdigest())
            text = json.dumps(header).encode()
            first = f"capsoc session 1 {len(text)} {hashlib.sha256(text).hexdigest()}\n".encode()
            (self.folder / "b.session").write_bytes(first + text + blobs[:begin] + other + log)
            done = self.run_replay("b.session")
            with self.subTest(number=number):
                self.assertIn(done.returncode, (2,) if number < refused_ones else (0, 1, 2), done.stderr)
                self.assertEqual(done.stderr.count(b"\n"), 1, done.stderr)
                with self.assertRaises(Refused) if done.returncode == 2 else contextlib.nullcontext() as refused:
                    again = self.session("simulation.construct", session=str(self.folder / "b.session"))["simulation"]
                    self.session("simulation.close", simulation=again)
                if done.returncode == 2:
                    self.assertNotIn("ended", str(refused.exception))

    def test_what_is_refused(self):
        for file, settings, words in (
            (self.folder / "none", {}, "none: "),
            (FIRMWARE / "echo.elf", {}, "echo.elf: "),
            (self.folder / "a.session", {"history_mb": 0}, "there is no history"),
            (self.folder / "a.session", {"no.such": 1}, "no.such"),
        ):
            if file.name == "a.session" and not file.exists():
                self.original()
            with self.subTest(file=file, settings=settings), self.assertRaises(Refused) as refused:
                self.session("simulation.construct", session=str(file), settings=settings)
            self.assertIn(words, str(refused.exception))

    def test_its_files_are_gone_with_the_session(self):
        self.original()
        (self.folder / "tmp").mkdir()
        kept = os.environ.get("TMPDIR")
        os.environ["TMPDIR"] = str(self.folder / "tmp")
        CLEAN["TMPDIR"] = os.environ["TMPDIR"]
        try:
            session = type(self.session)(self.folder)
        finally:
            del CLEAN["TMPDIR"]
            if kept is None:
                del os.environ["TMPDIR"]
            else:
                os.environ["TMPDIR"] = kept
        simulation = session("simulation.construct", session=str(self.folder / "a.session"))["simulation"]
        self.assertEqual(len(list((self.folder / "tmp").iterdir())), 1)
        session("simulation.close", simulation=simulation)
        session.close()
        self.assertEqual(list((self.folder / "tmp").iterdir()), [])

    def test_under_gdb(self):
        """To the end of what was recorded, where what was typed has arrived; a step back, and back to the beginning."""
        simulation = self.construct("echo")
        self.advance(simulation, seconds=0.001)
        self.session("uart.send", simulation=simulation, uart=0, bytes=[3, 0, 0, 0, 65, 66, 67])
        self.advance(simulation, seconds=0.00008)  # before its own end
        self.session("simulation.record", simulation=simulation, file=str(self.folder / "a.session"))
        end = self.where(simulation)["now"]["instructions"]
        run = subprocess.Popen(
            [CAPSOC, "replay", "a.session", "--gdb", "0"],
            cwd=self.folder,
            env=CLEAN,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        self.addCleanup(run.kill)
        port = re.search(r"127\.0\.0\.1:(\d+), waiting", run.stderr.readline())[1]
        script = ["set pagination off", f"target remote :{port}", "monitor when", "continue", "monitor when"]
        script += ["reverse-stepi", "monitor when", "reverse-continue", "monitor when", "kill"]
        words = [word for line in script for word in ("-ex", line)]
        said = subprocess.run(
            ["gdb-multiarch", "-nx", "-q", "-batch", *words, FIRMWARE / "echo.elf"],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            check=False,
            timeout=20,
        ).stdout
        out, _ = run.communicate(timeout=20)
        self.assertEqual(out, "\x03\x00\x00\x00ABC")
        counts = [int(count) for count in re.findall(r"now: .*instruction (\d+)", said)]
        self.assertEqual(counts, [0, end, end - 1, 0], said)


if __name__ == "__main__":
    unittest.main()
