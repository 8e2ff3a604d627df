#!/usr/bin/python3
"""Faults that a session injects on the way: what `capsoc run --inject` does, in every past and every replay."""

import json
import subprocess
import unittest

from harness import CAPSOC, CLEAN, FIRMWARE, without_host_times
from history_test import SHORT as PROGRAM, Past
from protocol_test import Refused

CTEST = {"name": "service: injected", "timeout": 300, "interpreter": "/usr/bin/python3"}

#: A lost interrupt is the end of the program's progress.
SHORT = {**PROGRAM, "run.simlimit_s": "2.3"}
LASTING = "freeze sin at 1.2s for 0.3s"
ONES = ("flip coprocessor.cv[39] at 1.1s", LASTING, "lose irq coprocessor at sample 400", "flip cpu.r11[3] at 1.7s")


class Injected(Past):
    def inject(self, simulation, fault):
        return self.session("fault.inject", simulation=simulation, fault=fault)["fault"]

    def faults(self, simulation):
        return self.session("fault.list", simulation=simulation)["faults"]

    def finished(self, simulation):
        self.advance(simulation)
        result = self.session("simulation.finish", simulation=simulation)["result"]
        self.session("simulation.close", simulation=simulation)
        return without_host_times(result)

    def of_run(self, *faults):
        words = [word for name, value in SHORT.items() for word in ("-C", f"{name}={value}")]
        words += [word for fault in faults for word in ("--inject", fault)]
        subprocess.run(
            [CAPSOC, "run", FIRMWARE / "selfcal.elf", *words, "--uart0", "null", "--json", "r.json"],
            cwd=self.folder,
            env=CLEAN,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            check=False,
            timeout=100,
        )
        return without_host_times(json.loads((self.folder / "r.json").read_text()))

    def check_same(self, one, other):
        """Without the way in which the faults were requested."""
        for result in (one, other):
            result["configuration"] = {
                name: value
                for name, value in result["configuration"].items()
                if not name.startswith(("inject", "uart"))
            }
        for name in {*one, *other} - {"command"}:
            self.assertEqual(one.get(name), other.get(name), name)

    def test_it_is_that_of_a_run(self):
        run = self.of_run(*ONES)
        self.assertEqual([fault["applied"] for fault in run["faults"]], [True] * 4)
        self.assertNotEqual(run["instructions"] if "instructions" in run else run["cpu"], self.of_run()["cpu"])
        simulation = self.construct(**SHORT)
        self.advance(simulation, seconds=1)
        self.assertEqual([self.inject(simulation, fault) for fault in ONES], list(ONES))
        self.check_same(self.finished(simulation), run)

    def test_now(self):
        simulation = self.construct(**SHORT)
        self.advance(simulation, seconds=1)
        now = self.where(simulation)["now"]["time_ps"]
        before = self.session("processor.read", simulation=simulation)["registers"]["r11"]
        fault = self.inject(simulation, "flip cpu.r11[3]")
        after = self.session("processor.read", simulation=simulation)["registers"]["r11"]
        self.assertEqual(before ^ after, 8)
        self.assertEqual(fault, f"flip cpu.r11[3] at {now / 1e12:.14g}s")
        (told,) = self.faults(simulation)
        self.assertEqual((told["before"], told["after"], told["applied"]), (before, after, True))
        run = self.of_run(fault)
        self.check_same(self.finished(simulation), run)

    def test_the_past_and_the_future_of_one(self):
        """Snapshots lie before, between and after; in each place the state is that of a run in one piece."""
        forward = self.construct(**SHORT)
        simulation = self.construct(**SHORT)
        for each in (forward, simulation):
            self.advance(each, seconds=1)
            for fault in ONES:
                self.inject(each, fault)
        places, kept = {}, set()
        for time_s in (1.05, 1.15, 1.3, 1.45, 1.6, 1.75, 1.9):
            self.advance(forward, until_s=time_s)
            told = self.where(forward)["now"]
            places[time_s] = (told, self.session("simulation.state", simulation=forward)["state"])
        self.advance(simulation, until_s=1.9)
        for time_s in (1.9, 1.15, 1.75, 1.3, 1.05, 1.6, 1.45, 0.5, 1.9):
            self.session("simulation.goto", simulation=simulation, time_s=time_s)
            try:
                self.session("history.keep", simulation=simulation)
                kept.add(time_s)
            except Refused as refused:
                self.assertIn("while a fault lasts", str(refused))
            if time_s not in places:
                self.assertEqual(self.faults(simulation), [])
                continue
            state = self.session("simulation.state", simulation=simulation)["state"]
            self.assertEqual((self.where(simulation)["now"], state), places[time_s])
        self.assertEqual(kept, {0.5, 1.75, 1.9})
        self.assertEqual(self.look(simulation), self.look(forward))
        self.assertEqual(self.faults(simulation), self.faults(forward))
        self.check_same(self.finished(simulation), self.finished(forward))

    def test_nothing_is_saved_until_it_is_over(self):
        simulation = self.construct(**SHORT)
        self.advance(simulation, seconds=1)
        self.inject(simulation, LASTING)
        for method, params in (
            ("simulation.save", {"file": "x"}),
            ("simulation.snapshot", {}),
            ("simulation.clone", {}),
        ):
            for until_s in (1.1, 1.3):
                self.session("simulation.goto", simulation=simulation, time_s=until_s)
                with self.subTest(method=method, until_s=until_s), self.assertRaises(Refused) as refused:
                    self.session(method, simulation=simulation, **params)
                self.assertIn(f"cannot be saved while a fault lasts ({LASTING})", str(refused.exception))
        self.advance(simulation, until_s=1.6)
        clone = self.session("simulation.clone", simulation=simulation)["simulations"][0]
        self.assertEqual(self.look(clone)[1], self.look(simulation)[1])
        self.assertEqual(self.faults(clone), self.faults(simulation))
        self.check_same(self.finished(clone), self.finished(simulation))

    def test_a_recorded_session_has_it(self):
        simulation = self.construct(**SHORT)
        self.advance(simulation, seconds=1)
        for fault in ONES:
            self.inject(simulation, fault)
        self.advance(simulation, until_s=1.9)
        self.session("simulation.record", simulation=simulation, file=str(self.folder / "a.session"))
        done = subprocess.run(
            [CAPSOC, "replay", "a.session"], cwd=self.folder, env=CLEAN, capture_output=True, check=False, timeout=100
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn(b"the same until 1.9", done.stderr)
        self.assertIn(b"4 inputs", done.stderr)

    def test_what_is_wrong_is_said(self):
        simulation = self.construct(**SHORT)
        self.advance(simulation, seconds=1)
        for fault, words in (
            ("flip cpu.r99[0]", "the processor has no register 'r99'"),
            ("flip cpu.r1[3] at 0.5s", "its time is past"),
            ("flip cpu.r1[3] at sample 3", "its time is past"),
            ("flip cpu.r1[3] at instruction 3", "its time is past"),
            ("flop cpu.r1[3]", "'flop' is no fault"),
            ("", "is empty"),
            ("flip cpu.r1[3] soon", "has 'soon' after its end"),
            ("flip rtl.u_sequencer.cycle_q[0]", "rtl"),
        ):
            with self.subTest(fault=fault), self.assertRaises(Refused) as refused:
                self.inject(simulation, fault)
            self.assertIn(words, str(refused.exception))
        self.assertEqual(self.faults(simulation), [])

    def test_every_place_can_be_hit(self):
        simulation = self.construct(**SHORT)
        self.advance(simulation, seconds=1)
        places = self.session("fault.places", simulation=simulation)["places"]
        units = {place["unit"]: place for place in places}
        self.assertLessEqual({"processor", "coprocessor"}, set(units))
        for place in units.values():
            self.inject(simulation, f"flip {place['place']}[{place['bits'] - 1}] at 1.5s")
        self.advance(simulation, until_s=1.50001)
        self.assertEqual([fault["applied"] for fault in self.faults(simulation)], [True] * len(units))


if __name__ == "__main__":
    unittest.main()
