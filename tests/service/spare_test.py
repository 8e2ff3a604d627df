#!/usr/bin/python3
"""Spares: processes that fork the workers which go back. No client sees them, and they outlive nothing.

The oracle is a simulation that only goes forward, as in history_test.py, and /proc.
"""

import json
import os
import random
import signal
import socket
import subprocess
import threading
import time
import unittest
from pathlib import Path

from harness import CAPSOC, CLEAN, FIRMWARE
from history_test import SEED, Past
from protocol_test import Refused

CTEST = {"name": "service: spares", "timeout": 600, "interpreter": "/usr/bin/python3"}

KILLS = int(os.environ.get("CAPSOC_SPARE_KILLS", "40"))
MOST = 8


def stat_of(process):
    """The fields of /proc/PID/stat from the state on; None: there is no such process."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()
    except (FileNotFoundError, ProcessLookupError):
        return None


def children(process):
    listed = Path(f"/proc/{process}/task/{process}/children")
    return {int(each) for each in listed.read_text().split()} if listed.exists() else set()


def is_gone(process):
    """An orphan that no process has waited for yet counts as gone, too."""
    stat = stat_of(process)
    return stat is None or stat[0] == "Z"


def kill_later(seconds, process):
    def kill():
        time.sleep(seconds)
        try:
            os.kill(process, signal.SIGKILL)
        except ProcessLookupError:
            pass

    killer = threading.Thread(target=kill)
    killer.start()
    return killer


class Spares(Past):
    """Simulations with what their session has in addition."""

    def wait_for(self, condition, what):
        deadline = time.monotonic() + 20
        while not condition():
            self.assertLess(time.monotonic(), deadline, what)
            time.sleep(0.01)

    def workers(self):
        return {each["process"] for each in self.session("session.simulations")["simulations"]}

    def spares(self):
        """Once no process has come or gone for a while; one on its way out may be among them."""
        session = self.session.process.pid
        listed = self.workers()

        def others():
            return {each for each in children(session) if each not in listed}

        before, since = others(), time.monotonic()
        while time.monotonic() - since < 0.15:
            time.sleep(0.01)
            if others() != before:
                before, since = others(), time.monotonic()
        return before

    def check_spares(self, count):
        """Waits until there are `count`, which it returns: on a busy machine others take long to go."""
        found = set()

        def are_there():
            found.clear()
            found.update(self.spares())
            return len(found) == count

        self.wait_for(are_there, f"{count} spares")
        return found

    def spare(self):
        (spare,) = self.check_spares(1)
        return spare

    def back(self, simulation, count=1):
        return self.session("history.back", simulation=simulation, instructions=count)

    def forward(self, simulation, first, last, inputs=()):
        """What a simulation that keeps no history shows after each count of instructions."""
        other = self.construct("selfcal", history_mb=0)
        seen = {}
        for count in sorted({each[0] for each in inputs} | set(range(first, last + 1))):
            self.advance(other, instructions=count - self.where(other)["now"]["instructions"])
            for _, method, params in (each for each in inputs if each[0] == count):
                self.session(method, simulation=other, **params)
            seen[count] = self.look(other)
        self.session("simulation.close", simulation=other)
        return seen

    def begun(self, instructions, inputs=()):
        simulation = self.construct("selfcal")
        for count, method, params in inputs:
            self.advance(simulation, instructions=count - self.where(simulation)["now"]["instructions"])
            self.session(method, simulation=simulation, **params)
        self.session("simulation.goto", simulation=simulation, instructions=instructions)
        return simulation


class Unseen(Spares):
    """The same answers, whichever process constructs the board."""

    LAST = 300_000

    def test_one_from_the_first_way_back_on(self):
        simulation = self.begun(self.LAST)
        self.assertEqual(self.spares(), set())
        self.back(simulation)
        spare = self.spare()
        self.back(simulation)
        self.session("history.last_write", simulation=simulation, register="r3")
        self.assertEqual(self.spare(), spare)
        self.assertNotIn(spare, self.workers())
        # Each worker of the simulation took a number, as ever; the spare has none.
        other = self.construct("hello")
        self.assertLess(other, 12)
        with self.assertRaisesRegex(Refused, "there is no simulation"):
            self.session("simulation.state", simulation=1 << 62)

    def test_many_steps_back_are_the_run_forward(self):
        steps = 60
        seen = self.forward("selfcal", self.LAST - steps, self.LAST)
        simulation = self.begun(self.LAST)
        for count in range(self.LAST - 1, self.LAST - steps - 1, -1):
            if count % 2:
                self.back(simulation)
            else:
                self.session("debugger.reverse", simulation=simulation, kind="step")
            self.assertEqual(self.look(simulation), seen[count])
        for count in (self.LAST, self.LAST - steps, self.LAST - 1):
            self.session("simulation.goto", simulation=simulation, instructions=count)
            self.assertEqual(self.look(simulation), seen[count])

    def test_back_right_after_a_change(self):
        """The spare was made before what the change changes."""
        changes = (
            ("sensor.set", {"parameters": {"b1": 0.125}}),
            ("sensor.speed", {"factor": 1.75}),
            ("adc.inject", {"u": [0.5, 0.25], "v": [0.1, 0.2]}),
            ("memory.write", {"address": 0x20300000, "bytes": [7] * 8}),
            ("processor.write", {"register": "r11", "value": 77}),
        )
        begin, apart = 250_000, 1000
        inputs = [(begin + i * apart, method, params) for i, (method, params) in enumerate(changes)]
        wanted = {}
        for end in range(1, len(inputs) + 1):
            last = inputs[end - 1][0]
            wanted[last] = self.forward("selfcal", last - 2, last, inputs[:end])
        simulation = self.begun(begin - 10)
        self.back(simulation)
        spare = self.spare()
        for count, method, params in inputs:
            self.session("simulation.goto", simulation=simulation, instructions=count)
            self.session(method, simulation=simulation, **params)
            for at in (count - 1, count - 2, count):
                self.session("simulation.goto", simulation=simulation, instructions=at)
                self.assertEqual(self.look(simulation), wanted[count][at], method)
        self.assertEqual(self.spare(), spare)

    def test_a_restored_simulation_has_another_past(self):
        seen = self.forward("selfcal", self.LAST - 3, self.LAST)
        simulation = self.begun(self.LAST - 100_000)
        snapshot = self.session("simulation.snapshot", simulation=simulation)["snapshot"]
        self.session("simulation.goto", simulation=simulation, instructions=self.LAST)
        for _ in range(2):
            self.back(simulation)
            self.assertEqual(self.look(simulation), seen[self.LAST - 1])
            spare = self.spare()
            self.session("simulation.restore", simulation=simulation, snapshot=snapshot)
            self.wait_for(lambda of=spare: is_gone(of), "the spare of the history that was left")
            self.assertEqual(self.where(simulation)["beginning"]["instructions"], self.LAST - 100_000)
            self.session("simulation.goto", simulation=simulation, instructions=self.LAST)
        self.back(simulation, 3)
        self.assertEqual(self.look(simulation), seen[self.LAST - 3])

    def test_a_client_is_answered_though_another_one_ends_the_simulation(self):
        process = subprocess.Popen([CAPSOC, "serve", "--socket", "here"], env=CLEAN, cwd=self.folder)
        self.addCleanup(self.end, process)
        self.wait_for((self.folder / "here").exists, "the socket")
        for way in ("goto", "last_write"):
            one, other = (socket.socket(socket.AF_UNIX) for _ in range(2))
            for client in (one, other):
                client.settimeout(30)
                self.wait_for(lambda of=client: of.connect_ex(str(self.folder / "here")) == 0, "the session to listen")

            def ask(client, method, **params):
                request = {"jsonrpc": "2.0", "id": 1, "method": method, "params": params}
                client.sendall(json.dumps(request).encode() + b"\n")
                return client.makefile("rb")

            settings = {"firmware.elf": str(FIRMWARE / "selfcal.elf")}
            simulation = json.loads(ask(one, "simulation.construct", settings=settings).readline())["result"][
                "simulation"
            ]
            ask(one, "simulation.advance", simulation=simulation, until_s=300).readline()
            params = {"time_s": 100} if way == "goto" else {"register": "r9"}
            file = ask(other, f"{'simulation' if way == 'goto' else 'history'}.{way}", simulation=simulation, **params)
            time.sleep(0.02)
            one.close()
            answer = json.loads(file.readline())
            self.assertIn("error", answer)
            other.close()


class Ends(Spares):
    """Whatever is killed or closed, nothing is left, and nothing else is lost."""

    LAST = 200_000

    def test_the_spare_is_killed(self):
        seen = self.forward("selfcal", self.LAST - 5, self.LAST)
        simulation = self.begun(self.LAST)
        for count in range(self.LAST - 1, self.LAST - 6, -1):
            self.back(simulation)
            self.assertEqual(self.look(simulation), seen[count])
            spare = self.spare()
            os.kill(spare, signal.SIGKILL)
            self.wait_for(lambda of=spare: stat_of(of) is None, "the session waits for the spare that was killed")

    def test_the_spare_is_killed_at_any_time(self):
        draw = random.Random(SEED)
        simulation = self.begun(self.LAST)
        seen = self.forward("selfcal", self.LAST - 9, self.LAST)
        for _ in range(KILLS):
            self.session("simulation.goto", simulation=simulation, instructions=self.LAST)
            self.back(simulation)
            spare = self.spare()
            killer = kill_later(draw.uniform(0, 0.006), spare)
            for count in range(self.LAST - 2, self.LAST - 10, -1):
                self.back(simulation)
                self.assertEqual(self.look(simulation), seen[count], f"seed {SEED}")
            killer.join()
        self.wait_for(lambda: len(self.spares()) <= 1, "one spare at most")

    def test_the_worker_is_killed(self):
        simulation, other = self.begun(self.LAST), self.begun(self.LAST)
        for each in (simulation, other):
            self.back(each)
        self.check_spares(2)
        listed = self.session("session.simulations")["simulations"]
        os.kill(next(each["process"] for each in listed if each["simulation"] == simulation), signal.SIGKILL)
        self.wait_for(lambda: len(self.workers()) == 1, "the worker that was killed")
        self.check_spares(1)
        with self.assertRaisesRegex(Refused, "was ended by signal 9"):
            self.back(simulation)
        self.assertEqual(self.back(other)["state"]["instructions"], self.LAST - 2)

    def test_the_worker_is_killed_at_any_time(self):
        draw = random.Random(SEED)
        for _ in range(KILLS // 4):
            simulation = self.begun(self.LAST)
            self.back(simulation)
            killer = kill_later(draw.uniform(0, 0.01), next(iter(self.workers())))
            try:
                for _ in range(20):
                    self.back(simulation)
            except Refused as refused:
                self.assertRegex(str(refused), "ended")
            killer.join()
            try:
                self.session("simulation.close", simulation=simulation)
            except Refused:
                pass
            self.assertEqual(self.workers(), set())
        self.check_spares(0)

    def test_both_are_killed(self):
        """Most often the session sees both at once."""
        for _ in range(5):
            simulation = self.begun(self.LAST)
            self.back(simulation)
            for each in self.check_spares(1) | self.workers():
                os.kill(each, signal.SIGKILL)
            self.wait_for(lambda: not self.workers(), "the worker that was killed")
            with self.assertRaisesRegex(Refused, "was ended by signal 9"):
                self.back(simulation)
            self.check_spares(0)

    def test_the_session_is_killed(self):
        for waits in (True, False):
            simulation = self.begun(self.LAST)
            self.back(simulation)
            session = self.session.process
            family = self.check_spares(1) | self.workers()
            self.assertEqual(len(family), 2)
            if not waits:
                request = {"jsonrpc": "2.0", "id": 1, "method": "history.last_write"}
                request["params"] = {"simulation": simulation, "register": "r9"}
                session.stdin.write(json.dumps(request).encode() + b"\n")
                session.stdin.flush()
                self.wait_for(lambda of=session.pid: len(children(of)) > 2, "a worker in the past")
                family = children(session.pid)
            session.kill()
            session.wait()
            for each in family:
                self.wait_for(lambda of=each: is_gone(of), "a process that its session left behind")
            self.setUp()

    def test_nothing_is_left_of_what_was_closed(self):
        for way in ("simulation.close", "session.end", "end of input"):
            simulation = self.begun(self.LAST)
            self.back(simulation)
            spare = self.spare()
            family = children(self.session.process.pid)
            if way == "end of input":
                self.assertEqual(self.session.close(), 0)
                self.setUp()
            else:
                self.session(way, **({"simulation": simulation} if way == "simulation.close" else {}))
            for each in family:
                self.wait_for(lambda of=each: is_gone(of), f"{way}: {'the spare' if each == spare else 'the worker'}")
            if way == "session.end":
                self.assertEqual(self.session.close(), 0)
                self.setUp()

    def test_a_simulation_that_is_closed_while_it_is_constructed(self):
        process = self.session.process
        settings = {"settings": {"firmware.elf": str(FIRMWARE / "selfcal.elf")}}
        for number, method, params in (
            (1, "simulation.construct", settings),
            (2, "simulation.close", {"simulation": 1}),
            (3, "session.simulations", {}),
        ):
            request = {"jsonrpc": "2.0", "id": number, "method": method, "params": params}
            process.stdin.write(json.dumps(request).encode() + b"\n")
        process.stdin.flush()
        answers = {answer["id"]: answer for answer in (json.loads(process.stdout.readline()) for _ in range(3))}
        self.assertEqual(answers[1]["error"]["message"], "simulation 1 was closed")
        self.assertEqual(answers[3]["result"]["simulations"], [])


class Costs(Spares):
    """A spare takes no time and a bounded memory."""

    def test_no_time_while_idle(self):
        simulation = self.begun(200_000)
        self.back(simulation)
        spare = self.spare()
        processes = (self.session.process.pid, spare, *self.workers())

        def times():
            return [stat_of(each)[11:13] for each in processes]  # user and system

        def took_none():
            before = times()
            time.sleep(1)
            return times() == before

        self.wait_for(took_none, "a second in which none of them took any time")

    def test_no_more_than_some(self):
        simulations = [self.begun(100_000) for _ in range(MOST + 3)]
        for _ in range(2):
            for simulation in simulations:
                self.back(simulation)
            self.check_spares(MOST)
        for simulation in simulations:
            self.assertEqual(self.where(simulation)["now"]["instructions"], 100_000 - 2)
            self.session("simulation.close", simulation=simulation)
        self.check_spares(0)

    def test_memory(self):
        simulation = self.construct("selfcal", history_mb=1)
        self.advance(simulation, instructions=100_000)
        self.back(simulation)
        sizes = []
        for _ in range(60):
            self.advance(simulation, instructions=20_000)
            self.session("history.keep", simulation=simulation)
            self.back(simulation)
            self.assertLessEqual(self.where(simulation)["bytes"], 1 << 20)
            sizes.append(int(stat_of(self.spare())[21]) * os.sysconf("SC_PAGESIZE"))
        self.assertLess(max(sizes) - sizes[9], 4 << 20, sizes)

    def test_settings_that_a_fork_would_share(self):
        """/tmp/perf-PID.map is named by the process."""
        simulation = self.construct("selfcal", **{"trace.perf_map": "true"})
        self.advance(simulation, instructions=100_000)
        for left in (99_999, 99_998):
            self.assertEqual(self.back(simulation)["state"]["instructions"], left)
        self.check_spares(0)


if __name__ == "__main__":
    unittest.main()
