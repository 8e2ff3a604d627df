#!/usr/bin/env python3
"""The timeline of a run, compared with what the other traces, the recording and the results say of the same run."""

import csv
import json
import os
import subprocess
import unittest
from collections import Counter
from decimal import Decimal
from itertools import groupby

from harness import CAPSOC
from trace_test import Traced

CTEST = {"name": "timeline"}


class Timed(Traced):
    def timeline(self, program, *options):
        """Slices by process and thread, each (begin, end, name, arguments) in ps; other events; exit code, UART bytes,
        results."""
        place = self.folder / "timeline.json"
        code, text, result = self.run_with(program, "--timeline", place, *options)
        events = json.loads(place.read_text(), parse_float=Decimal)["traceEvents"]
        names, slices, others = {}, {}, []
        for event in events:
            if event["ph"] == "M" and event["name"].endswith("_name"):
                names[event["pid"], event.get("tid")] = event["args"]["name"]
        for event in events:
            if event["ph"] == "X":
                begin = int(event["ts"] * 1_000_000)
                track = names[event["pid"], None], names[event["pid"], event["tid"]]
                end = begin + int(event["dur"] * 1_000_000)
                slices.setdefault(track, []).append((begin, end, event["name"], event["args"]))
            elif event["ph"] != "M":
                others.append(event)
        for each in slices.values():
            each.sort(key=lambda entry: (entry[0], -entry[1]))
        return slices, others, (code, text, result)

    def assertNested(self, slices):
        open_ends = []
        for begin, end, *_ in slices:
            while open_ends and open_ends[-1] <= begin:
                open_ends.pop()
            self.assertTrue(not open_ends or end <= open_ends[-1], (begin, end, open_ends))
            open_ends.append(end)


def threads_of(slices):
    return {track: each for track, each in slices.items() if track[1].startswith("thread ")}


def entries(lines):
    """Of an instruction trace: the name of each exception that was entered."""
    return [line.split(" --> exception ")[1].split(" ", 1)[1].split(",")[0] for line in lines if " --> " in line]


class Processor(Timed):
    def test_somebody_has_it_at_any_time(self):
        """A thread that runs or sleeps, or the outermost handler: no gap, no overlap, to the picosecond."""
        for program, options in (
            ("selfcal", ["--simlimit", "0.5"]),
            ("threads", []),
            ("exceptions", []),
            ("task_start", []),
            ("debuggee", []),
        ):
            slices, _, (_, _, result) = self.timeline(program, *options)
            busy = [each[:2] for track in threads_of(slices).values() for each in track]
            end = 0
            for begin, until, *_ in slices.get(("processor", "handlers"), []):
                if begin >= end:
                    busy.append((begin, until))
                    end = until
            busy.sort()
            with self.subTest(program=program):
                self.assertEqual(busy[0][0], 0)
                for one, other in zip(busy, busy[1:]):
                    self.assertEqual(one[1], other[0])
                self.assertEqual(busy[-1][1], round(result["time"]["simulated_s"] * 1e12))

    def test_handlers_are_those_of_the_instruction_trace(self):
        for program in ("exceptions", "threads", "divzero"):
            trace = self.folder / "i.txt"
            slices, _, _ = self.timeline(program, "--trace-instructions", trace, "--simlimit", "1")
            handlers = slices.get(("processor", "handlers"), [])
            with self.subTest(program=program):
                self.assertNested(handlers)
                wanted = Counter(entries(trace.read_text().splitlines()))
                self.assertGreater(sum(wanted.values()), 0)
                self.assertEqual(Counter(each[2] for each in handlers if each[2] != "sleeps"), wanted)

    def test_latencies_are_those_of_the_results(self):
        slices, _, (_, _, result) = self.timeline("selfcal", "--latencies", "--simlimit", "2")
        known = {each["name"]: each for each in result["interrupts"]}
        handlers = sorted(slices["processor", "handlers"], key=lambda each: each[2])
        compared = 0
        for name, group in groupby(handlers, key=lambda each: each[2]):
            waits = [each[3]["latency_cycles"] for each in group if "latency_cycles" in each[3]]
            if not waits:
                continue
            self.assertEqual(len(waits), known[name]["count"], name)
            self.assertEqual(min(waits), known[name]["latency_cycles"]["least"], name)
            self.assertEqual(max(waits), known[name]["latency_cycles"]["most"], name)
            compared += len(waits)
        self.assertGreater(compared, 400)

    def test_threads_are_told_apart(self):
        for program, thread in (("profiled", "thread_b"), ("bench_tasks", "second_task"), ("task_start", "task")):
            slices, _, _ = self.timeline(program, "--simlimit", "0.1")
            names = sorted(track[1] for track in threads_of(slices))
            self.assertEqual(names, ["thread 0: Reset_Handler", f"thread 1: {thread}"])

    def test_sleep(self):
        slices, _, _ = self.timeline("selfcal", "--simlimit", "1")
        asleep = sum(
            end - begin for track in threads_of(slices).values() for begin, end, name, _ in track if name == "sleeps"
        )
        self.assertGreater(asleep / 1e12, 0.9)


class Coprocessor(Timed):
    def test_every_sample_passes_its_stages(self):
        record = self.folder / "record.csv"
        for coprocessor in ("tlm", "rtl"):
            slices, others, (_, _, result) = self.timeline(
                *("selfcal", "--simlimit", "1", "--coprocessor", coprocessor),
                *("--record", record, "--record-columns", "t,found_deg,status"),
            )
            stages = [slices["coprocessor", f"T{stage}"] for stage in range(5)]
            rows = list(csv.DictReader(line for line in record.open() if not line.startswith("#")))
            self.assertEqual([len(stage) for stage in stages], [result["samples"]] * 5)
            self.assertEqual(len(rows), result["samples"])
            for samples in zip(*stages, strict=True):
                self.assertEqual(len({name for _, _, name, _ in samples}), 1)
                for (begin, end, *_), (following, *_) in zip(samples, samples[1:]):
                    self.assertEqual(end, following)
                    self.assertEqual(end - begin, 32 * 40_000)  # cycles of 25 MHz
            for row, (_, _, _, result_of) in zip(rows, stages[4], strict=True):
                self.assertAlmostEqual(float(result_of["angle_deg"]), float(row["found_deg"]), delta=1e-8)
                self.assertEqual(result_of["lock"], bool(int(row["status"]) & 2))
            first = stages[0][0][0]
            for row, (begin, *_) in zip(rows, stages[0]):
                self.assertAlmostEqual((begin - first) * 1e-12, float(row["t"]), delta=1e-9)
            self.assertEqual(sum(event["name"] == "error average" for event in others), result["samples"])

    def test_interrupt_lines_are_high_while_their_handler_begins(self):
        slices, _, _ = self.timeline("selfcal", "--simlimit", "0.2")
        line = slices["interrupts", "coprocessor interrupt"]
        handlers = [each for each in slices["processor", "handlers"] if each[2] == "coprocessor"]
        self.assertEqual(len(line), len(handlers))
        for (rises, falls, *_), (begin, end, *_) in zip(line, handlers):
            self.assertTrue(rises <= begin < falls < end)


class Text(Timed):
    def test_lines_of_a_uart(self):
        slices, _, (_, text, _) = self.timeline("hello")
        lines = [each[2] for each in slices["UARTs", "uart0"]]
        self.assertEqual(lines, [line for line in text.decode().splitlines() if line])

    def test_bytes_that_are_no_text(self):
        place = self.folder / "input"
        place.write_bytes(bytes(range(1, 256)))
        slices, _, _ = self.timeline("echo", "-C", f"uart0.input={place}", "--simlimit", "1")
        self.assertGreater(len(slices["UARTs", "uart0"]), 0)

    def test_how_it_ended(self):
        for program, options in (("hello", []), ("divzero", []), ("selfcal", ["--simlimit", "0.1"])):
            _, others, (code, _, _) = self.timeline(program, *options)
            self.assertEqual([event["name"].split(":")[0] for event in others if event["ph"] == "i"], [f"exit {code}"])


class Bus(Timed):
    def test_transfers_are_those_of_the_bus_trace(self):
        trace = self.folder / "b.txt"
        slices, _, _ = self.timeline("selfcal", "--trace-bus", trace, "--simlimit", "0.1")
        wanted = Counter()
        for line in trace.read_text().splitlines()[1:]:
            cycle, _, initiator, what, _, address, *_ = line.split()
            if "COPROCESSOR." in line or "UART0." in line:
                wanted[int(cycle), initiator, what, line.split()[-1]] += 1
        seen = Counter()
        for (process, port), each in slices.items():
            for begin, _, name, _ in each if process == "bus" else []:
                if "." in name:
                    seen[begin // 40_000, port, *name.split()] += 1
        self.assertGreater(len(wanted), 100)
        self.assertEqual({key: n for key, n in seen.items() if key[3].startswith(("COPROCESSOR", "UART0"))}, wanted)


class Windows(Timed):
    def test_nothing_lies_outside(self):
        window = ("-C", "trace.start=0.25", "-C", "trace.stop=0.5", "--simlimit", "1")
        slices, others, _ = self.timeline("selfcal", *window)
        for track, each in slices.items():
            for begin, end, *_ in each:
                self.assertTrue(250_000_000_000 <= begin <= end <= 504_000_000_000, (track, begin, end))
        self.assertGreater(len(slices["coprocessor", "T4"]), 50)
        self.assertEqual({event["ph"] for event in others}, {"C", "i"})

    def test_a_long_run_takes_no_more_memory(self):
        def peak_kib(*options):
            with subprocess.Popen([CAPSOC, "run", "--simlimit", "60", *options], stderr=subprocess.DEVNULL) as process:
                return os.wait4(process.pid, 0)[2].ru_maxrss

        place = self.folder / "t.json"
        plain, traced = peak_kib("--uart0", "null"), peak_kib("--uart0", "null", "--timeline", place)
        self.assertGreater(place.stat().st_size, 20_000_000)
        self.assertLess(traced - plain, 8_000)


if __name__ == "__main__":
    unittest.main()
