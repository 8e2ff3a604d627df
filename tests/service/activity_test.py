#!/usr/bin/python3
"""What processor.activity says of sleep, threads and handlers is what `capsoc run --timeline` writes of a program.

The timeline is another process, whose observer follows stacks and tail chains by itself.
"""

import random
import struct
import subprocess
import unittest

from harness import CAPSOC, CLEAN, FIRMWARE
from processor_times import processor_times
from protocol_test import Driven, Refused

CTEST = {"name": "service: activity", "timeout": 300, "interpreter": "/usr/bin/python3"}

SEED = 20261128
WINDOWS = (0.001, 0.01, 0.1, 1, 10, 100)


class Activity(Driven):
    """A simulation and a run of the same program."""

    def timeline(self, program, limit_s):
        file = self.folder / "timeline.json"
        command = [CAPSOC, "run", FIRMWARE / f"{program}.elf", "--uart0", "null", "--simlimit", str(limit_s)]
        subprocess.run(
            [*command, "--timeline", file], env=CLEAN, capture_output=True, check=False, stdin=subprocess.DEVNULL
        )
        return processor_times(file)

    def read(self, simulation, window_s):
        """The answer with lists: pairs (begin, end) of slices, numbers of shares."""
        told = self.session("processor.activity", simulation=simulation, window_s=window_s)
        for row in told["rows"]:
            if "slices" in row:
                data = self.session.data[row["slices"]["frame"]]
                numbers = [int(each) for each in struct.unpack(f"<{len(data) // 8}d", data)]
                row["slices"] = [(at, at + long) for at, long in zip(numbers[::2], numbers[1::2])]
            else:
                row["shares"] = list(self.session.data[row["shares"]["frame"]])
        return told

    def compare(self, told, times):
        """True: the answer has each time by itself."""
        begin, end, known = told["begin_ps"], told["end_ps"], told["known_ps"]
        seen, sliced = set(), True
        for row in told["rows"]:
            name = row["name"]
            there = [(at, min(to, end)) for at, to in times.get(name, []) if to > begin and at < end]
            inside = sum(to - max(at, known) for at, to in there if to > known)
            self.assertAlmostEqual(row["share"], inside / max(1, end - known), 9, name)
            if there:
                seen.add(name)
            if "slices" in row:
                first = [(max(at, known), to) for at, to in there if to > known]
                self.assertEqual([(max(at, known), to) for at, to in row["slices"] if to > known], first, name)
                continue
            sliced = False
            self.assertEqual(len(row["shares"]), 250)
            for number, share in enumerate(row["shares"]):
                left = max(known, begin + number * told["bin_ps"])
                right = min(end, begin + (number + 1) * told["bin_ps"])
                busy = sum(max(0, min(to, right) - max(at, left)) for at, to in there)
                self.assertEqual(share, -(-255 * busy // max(1, right - left)) if busy else 0, (name, number))
        outside = {name for name, all_ in times.items() if any(to > known and at < end for at, to in all_)}
        self.assertEqual(outside - seen, set())
        return sliced

    def test_programs(self):
        """At random instants, on the way and after going back to some of them."""
        kinds = set()
        for program, limit, least in (
            ("selfcal", 4, {"asleep", "thread", "coprocessor", "uart0 tx"}),
            ("threads", 0.0157, {"thread", "SVCall", "PendSV", "MemManage"}),
            ("exceptions", 0.0253, {"thread", "SysTick", "SVCall", "PendSV", "interrupt 25", "interrupt 26"}),
            ("board", 0.05, {"asleep", "thread", "dual_timer", "NMI"}),
            ("bench_interrupts", 0.02, {"thread", "SysTick", "uart0 rx", "ethernet", "MemManage"}),
        ):
            draw = random.Random(f"{SEED} {program}")
            times = self.timeline(program, limit)
            self.assertEqual(least - times.keys(), set())
            simulation = self.construct(program)
            self.read(simulation, 1)
            stops = sorted(draw.uniform(limit / 50, limit * 0.99) for _ in range(8))
            for stop in [*stops, *draw.sample(stops, 4), *draw.sample(stops, 4)]:
                self.session("simulation.goto", simulation=simulation, time_s=stop)
                self.session("history.keep", simulation=simulation)
                for window in WINDOWS:
                    with self.subTest(program=program, stop=stop, window=window, seed=SEED):
                        told = self.read(simulation, window)
                        self.assertEqual(told["known_ps"], told["begin_ps"])
                        kinds.add((program, self.compare(told, times)))
            self.session("simulation.close", simulation=simulation)
        self.assertIn(("selfcal", True), kinds)
        self.assertIn(("selfcal", False), kinds)
        self.assertIn(("bench_interrupts", False), kinds)

    def test_another_clock(self):
        """Handlers begin where the events say, at 25 MHz, at 50, and at 33.3, whose period is no number of ps."""
        simulation = self.construct("selfcal")
        self.session("events.subscribe", simulation=simulation, kinds=["exception"])
        self.read(simulation, 0.1)
        for multiplier, divider in ((1, 1), (2, 1), (4, 3), (1, 1)):
            for name, value in (("CTRL", 0), ("PLL", multiplier | divider << 8), ("CTRL", 1)):
                self.session("register.write", simulation=simulation, name=f"CLOCKCTRL.{name}", value=value)
            self.advance(simulation, seconds=0.01)
            self.session("register.write", simulation=simulation, name="CLOCKCTRL.CTRL", value=3)
            hertz = self.session("register.read", simulation=simulation, name="CLOCKCTRL.FREQ")["value"]
            self.assertEqual(hertz, 25_000_000 * multiplier // divider)
            self.advance(simulation, seconds=0.3)
            events = self.advance(simulation, seconds=0.1)["events"]
            told = self.read(simulation, 0.1)
            row = next(row for row in told["rows"] if row["name"] == "coprocessor")
            entered = [event["time_s"] for event in events if event["name"].startswith("coprocessor")]
            entered = [at for at in entered if at * 1e12 > told["begin_ps"]]
            self.assertGreater(len(entered), 20)
            self.assertEqual(len(row["slices"]), len(entered))
            for at, (begin, _) in zip(entered, row["slices"]):
                self.assertAlmostEqual(at, begin * 1e-12, delta=1e-6)

    def test_it_begins_with_the_question_and_ends(self):
        simulation = self.construct("selfcal")
        self.advance(simulation, seconds=0.5)
        told = self.read(simulation, 0.1)
        self.assertEqual((told["known_ps"], told["end_ps"]), (500_000_000_000, 500_000_000_000))
        self.assertEqual([row["name"] for row in told["rows"]], ["asleep"])
        self.advance(simulation, seconds=0.02)
        told = self.read(simulation, 0.1)
        times = self.timeline("selfcal", 1)
        self.compare(told, times)
        self.assertEqual(told["known_ps"], 500_000_000_000)
        # Going where it stands records what was missing, although a snapshot is there.
        self.session("history.keep", simulation=simulation)
        self.session("simulation.goto", simulation=simulation, time_ps=told["end_ps"])
        again = self.read(simulation, 0.1)
        self.assertEqual((again["known_ps"], again["end_ps"]), (told["begin_ps"], told["end_ps"]))
        self.compare(again, times)
        self.assertEqual(self.session("processor.activity", simulation=simulation, window_s=0), {})
        self.session("simulation.goto", simulation=simulation, time_s=0.3)
        self.assertEqual(self.read(simulation, 0.1)["known_ps"], 300_000_000_000)

    def test_the_newest_part_of_a_long_run(self):
        """Of many changes bins are left, which do not grow."""
        simulation = self.construct("bench_interrupts")
        self.read(simulation, 0.01)
        times = self.timeline("bench_interrupts", 0.25)
        for _ in range(5):
            self.advance(simulation, seconds=0.049)
            for window in WINDOWS:
                told = self.read(simulation, window)
                self.compare(told, times)
                self.assertLess(sum(map(len, self.session.data)), 64 * 250 + 16 * 600)

    def test_what_is_refused(self):
        simulation = self.construct("selfcal")
        for window in (-1, 0.5, 1e9):
            with self.assertRaisesRegex(Refused, "window_s is 0.001, 0.01, 0.1, 1, 10 or 100"):
                self.session("processor.activity", simulation=simulation, window_s=window)

    def test_it_changes_nothing(self):
        """The state after a walk with a record is that of one without."""
        states = []
        for is_recorded in (False, True):
            simulation = self.construct("bench_interrupts")
            for time_s in (0.02, 0.005, 0.012, 0.03):
                if is_recorded:
                    self.read(simulation, 0.01)
                self.session("simulation.goto", simulation=simulation, time_s=time_s)
                told = self.session("history.when", simulation=simulation, hash=True)
                states.append((told["now"], told["sha256"], told["inputs"]))
        self.assertEqual(states[:4], states[4:])


if __name__ == "__main__":
    unittest.main()
