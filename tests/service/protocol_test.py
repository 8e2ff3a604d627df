#!/usr/bin/python3
"""The session protocol: the run is that of capsoc run, stops and values are those that others find, nothing ends it.

The oracles are capsoc run itself, Python's eval() for expressions, GDB for variables, the instruction trace for stops.
"""

import ast
import json
import os
import random
import re
import shutil
import struct
import subprocess
import tempfile
import unittest

from harness import CAPSOC, CLEAN, FIRMWARE, SOURCE, Case, without_host_times

CTEST = {"name": "service: protocol", "timeout": 900, "interpreter": "/usr/bin/python3"}

SEED = 20261126


class Refused(Exception):
    """An error of the protocol."""

    def __init__(self, error):
        super().__init__(error["message"])
        self.code = error["code"]


class Session:
    """capsoc serve on its standard input and output."""

    def __init__(self, folder):
        self.process = subprocess.Popen(
            [CAPSOC, "serve"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=CLEAN, cwd=folder
        )
        self.requests = 0
        self.data = []  # frames of the last answer

    def close(self):
        self.process.stdin.close()
        self.process.stdout.close()
        return self.process.wait(60)

    def send(self, line):
        self.process.stdin.write(line)
        self.process.stdin.flush()
        answer = json.loads(self.process.stdout.readline())
        answer["data"] = [self.process.stdout.read(size) for size in answer.get("frames", [])]
        return answer

    def __call__(self, method, **params):
        self.requests += 1
        request = {"jsonrpc": "2.0", "id": self.requests, "method": method, "params": params}
        answer = self.send(json.dumps(request).encode() + b"\n")
        assert answer["id"] == self.requests
        if "error" in answer:
            raise Refused(answer["error"])
        self.data = answer["data"]
        return answer["result"]


class Driven(Case):
    """A session, and simulations in it."""

    def setUp(self):
        super().setUp()
        self.session = Session(self.folder)
        self.addCleanup(self.session.close)

    def construct(self, program="selfcal", **settings):
        given = {"firmware.elf": str(FIRMWARE / f"{program}.elf"), **settings}
        return self.session("simulation.construct", settings=given)["simulation"]

    def advance(self, simulation, **goal):
        return self.session("simulation.advance", simulation=simulation, **goal)


class Same(Driven):
    """What a session drives is what capsoc run simulates."""

    SETTINGS = {"run.simlimit_s": "30", "program.demodulation_samples": "5000", "program.calibration_samples": "1000"}

    def of_run(self, **settings):
        words = [word for name, value in {**self.SETTINGS, **settings}.items() for word in ("-C", f"{name}={value}")]
        subprocess.run(
            [CAPSOC, "run", FIRMWARE / "selfcal.elf", *words, "--json", "run.json"],
            cwd=self.folder,
            env=CLEAN,
            capture_output=True,
            check=False,
        )
        return without_host_times(json.loads((self.folder / "run.json").read_text()))

    @staticmethod
    def figures(result):
        """What does not say how the run was asked for."""
        return {name: value for name, value in result.items() if name not in ("settings", "command")}

    def test_in_one_piece_and_in_many(self):
        wanted = self.figures(self.of_run())
        draw = random.Random(SEED)
        for pieces in (1, 300):
            with self.subTest(pieces=pieces, seed=SEED):
                simulation = self.construct(**self.SETTINGS)
                for _ in range(pieces - 1):
                    goal = draw.choice(["seconds", "cycles", "instructions", "samples"])
                    most = {"seconds": 0.1, "cycles": 10**6, "instructions": 3000, "samples": 5}[goal]
                    asked = draw.uniform(0, most) if goal == "seconds" else draw.randint(0, most)
                    state = self.advance(simulation, **{goal: asked})["state"]
                    self.session("register.read", simulation=simulation, name="COPROCESSOR.STATUS")
                    self.assertFalse(state["over"], "more pieces than the run has")
                self.assertEqual(self.advance(simulation)["reason"], "over")
                finished = self.session("simulation.finish", simulation=simulation)
                self.assertEqual(self.figures(without_host_times(finished["result"])), wanted)

    def test_on_the_rtl(self):
        library = list((CAPSOC.parent).rglob("*capsoc_rtl_precise*.so"))
        if not library:
            self.fail("the Verilated coprocessor was not built")
        ends = []
        for backend in ("tlm", "rtl", "lockstep"):
            simulation = self.construct(**{"coprocessor.backend": backend})
            ends.append(self.advance(simulation, seconds=2)["state"])
            ends.append(self.advance(simulation, samples=7)["state"])
        self.assertEqual(ends[:2], ends[2:4])
        self.assertEqual(ends[:2], ends[4:])

    def test_snapshots_clones_and_restored_ones_go_on_alike(self):
        simulation = self.construct()
        self.advance(simulation, seconds=1.2345)
        snapshot = self.session("simulation.snapshot", simulation=simulation)["snapshot"]
        clone = self.session("simulation.clone", simulation=simulation)["simulations"][0]
        ends = [self.advance(each, instructions=54321)["state"] for each in (simulation, clone)]
        self.session("simulation.restore", simulation=simulation, snapshot=snapshot)
        ends.append(self.advance(simulation, instructions=54321)["state"])
        self.assertEqual(ends[0], ends[1])
        self.assertEqual(ends[0], ends[2])

    def test_what_was_sent_and_what_was_said_are_in_a_snapshot(self):
        simulation = self.construct("echo")
        self.session("uart.send", simulation=simulation, uart=0, bytes="one\ntwo\n")
        self.session("sensor.set", simulation=simulation, parameters={"b1": 0.25})
        clone = self.session("simulation.clone", simulation=simulation)["simulations"][0]
        texts = []
        for each in (simulation, clone):
            self.advance(each, seconds=0.5)
            texts.append(self.session("uart.read", simulation=each, uart=0)["text"])
            sensor = self.session("sensor.read", simulation=each)["parameters"]
            self.assertEqual(sensor["b1"], 0.25)
        self.assertIn("two", texts[0])
        self.assertEqual(texts[0], texts[1])

    def test_however_much_was_sent(self):
        """More than a line of the protocol holds as text: to the snapshot and back."""
        text = "".join(random.Random(SEED).choices("klmnopqrst", k=5_000_000)) + "\n"
        simulation = self.construct("echo")
        self.session("uart.send", simulation=simulation, uart=0, bytes=text)
        self.advance(simulation, seconds=0.2)
        clone = self.session("simulation.clone", simulation=simulation)["simulations"][0]
        ends = [self.advance(each, seconds=0.1) for each in (simulation, clone)]
        self.assertEqual(ends[0]["state"], ends[1]["state"])
        heard = [self.session("uart.read", simulation=each, uart=0)["text"] for each in (simulation, clone)]
        self.assertGreater(len(heard[0]), 1000)
        self.assertEqual(heard[0], heard[1])


class Streams(Driven):
    """Text of other ports than the UARTs, and events."""

    def test_the_itm(self):
        simulation = self.construct("itm", **{"itm.backend": "stdout"})
        self.advance(simulation)
        self.assertEqual(self.session("itm.read", simulation=simulation), {"text": "itm: 42\n", "lost": 0})
        hidden = self.construct("itm")
        self.advance(hidden, seconds=0.001)
        with self.assertRaisesRegex(Refused, "the text goes to null; construct with itm.backend=stdout"):
            self.session("itm.read", simulation=hidden)

    def test_the_console_of_semihosting(self):
        simulation = self.construct("semihosting_calls", **{"semihosting.directory": str(self.folder)})
        self.advance(simulation)
        said = self.session("semihosting.read", simulation=simulation)["text"]
        self.assertIn("[out]\n[err]\n", said)
        reader = self.construct("endless", **{"program.way": "22"})  # semihosting_read
        self.advance(reader, seconds=0.1)  # it prints first
        self.session("semihosting.send", simulation=reader, bytes="ab\nc")
        self.advance(reader, instructions=12)
        clone = self.session("simulation.clone", simulation=reader)["simulations"][0]
        for each in (reader, clone):
            read = []
            for _ in range(60):
                self.advance(each, instructions=1)
                read.append(self.session("processor.read", simulation=each)["registers"]["r0"])
            read = [byte for i, byte in enumerate(read) if byte in (97, 98, 99, 10) and byte != read[i - 1]]
            self.assertTrue("ab\nc".endswith(bytes(read).decode()), read)
            self.assertIn(ord("c"), read)
        named = self.construct("endless", **{"semihosting.console": "null"})
        for method, params in (("read", {}), ("send", {"bytes": "x"})):
            with self.assertRaisesRegex(Refused, "the console is null; leave semihosting.console out"):
                self.session(f"semihosting.{method}", simulation=named, **params)

    def test_events(self):
        simulation = self.construct("faults")
        kinds = ["exception", "fault", "guest_error", "sample", "uart"]
        self.session("events.subscribe", simulation=simulation, kinds=kinds)
        events = self.advance(simulation)["events"]
        by_kind = {kind: [event for event in events if event["kind"] == kind] for kind in kinds}
        names = {event["name"] for event in by_kind["fault"]}
        self.assertIn("HardFault", names)
        self.assertLessEqual(names, {"HardFault", "MemManage", "BusFault", "UsageFault"})
        self.assertLess(len(by_kind["fault"]), len(by_kind["exception"]) + 1)
        times = [event["time_s"] for event in events]
        self.assertEqual(times, sorted(times))
        simulation = self.construct()
        self.session("events.subscribe", simulation=simulation, kinds=["sample"])
        stop = self.advance(simulation, samples=5)
        self.assertEqual([event["sample"] for event in stop["events"]], list(range(5)))
        self.assertEqual(stop["events"][-1]["time_s"], stop["state"]["time_s"])

    def test_some_of_the_samples(self):
        """At most N, as far apart as they have to be for that, and no farther."""
        simulation = self.construct()
        self.advance(simulation, samples=100)

        def read(**which):
            answer = self.session("samples.read", simulation=simulation, columns=["t"], **which)
            return [struct.unpack(f"<{answer['count']}d", data) for data in self.session.data][0]

        every = read()
        for first, most, step in ((0, 1000, 1), (0, 100, 1), (0, 99, 2), (0, 50, 2), (60, 3, 14), (60, 1, 40)):
            self.assertEqual(read(first=first, most=most), every[first::step])
        self.assertEqual(read(first=100, most=1), ())
        for wrong in ({"most": 0}, {"most": 5, "every": 1}):
            with self.assertRaisesRegex(Refused, "most is 1 or more, and every is left out"):
                read(**wrong)

    def test_the_verdict(self):
        """Once, with what the result has at the end, however the run is cut; after going back it comes again."""
        for settings, program in (
            ({}, "selfcal"),
            ({"program.demodulation_samples": 100, "program.calibration_samples": 20}, "selfcal"),
            ({}, "hello"),
        ):
            simulation = self.construct(program, **settings)
            self.session("events.subscribe", simulation=simulation, kinds=["verdict"])
            told, over = [], False
            while not over:
                stop = self.advance(simulation, seconds=50)
                told += stop["events"]
                over = stop["reason"] == "over"
            stated = self.session("simulation.outcome", simulation=simulation)["result"]["verdict"]
            names = ("pass", "bound_deg", "reason")
            wanted = [] if stated is None else [{name: stated[name] for name in names if stated.get(name) is not None}]
            self.assertEqual([{name: each[name] for name in names if name in each} for each in told], wanted)
            other = self.construct(program, **settings)
            self.session("events.subscribe", simulation=other, kinds=["verdict", "uart"])
            whole = [each for each in self.advance(other)["events"] if each["kind"] == "verdict"]
            self.assertEqual(whole, told)
            past = self.session("history.timeline", simulation=other, one={"time_s": 0}, kinds=["verdict"])["events"]
            self.assertEqual(past, told)
            for each in (simulation, other):
                self.session("simulation.close", simulation=each)


class Stops(Driven):
    """An advance ends where others say that it is."""

    def test_after_instructions(self):
        subprocess.run(
            [CAPSOC, "run", FIRMWARE / "selfcal.elf", "--simlimit", "0.003", "-C", "trace.instructions=trace.txt"],
            cwd=self.folder,
            env=CLEAN,
            capture_output=True,
            check=False,
        )
        lines = (self.folder / "trace.txt").read_text().splitlines()
        pcs = [int(m[1], 16) for line in lines if (m := re.match(r"\s*\d+\s+[\d.]+\s+([0-9a-f]{8})\s", line))]
        self.assertGreater(len(pcs), 2000, lines[:5])
        for count in (0, 1, 2, 63, 64, 65, 100, 1999):
            with self.subTest(instructions=count):
                simulation = self.construct()
                stop = self.advance(simulation, instructions=count)
                self.assertEqual(stop["state"]["instructions"], count)
                self.assertEqual(stop["state"]["pc"], pcs[count])
                self.session("simulation.close", simulation=simulation)

    def test_at_an_address_each_time(self):
        simulation = self.construct()
        counts = []
        for _ in range(5):
            stop = self.advance(simulation, address="COPROCESSOR_Handler", within_s=1)
            self.assertEqual(stop["reason"], "address")
            place = self.session("simulation.state", simulation=simulation)["place"]
            self.assertIn("COPROCESSOR_Handler", place)
            counts.append(stop["state"]["instructions"])
        self.assertEqual(sorted(set(counts)), counts)

    def test_within_a_limit(self):
        simulation = self.construct()
        stop = self.advance(simulation, exception="HardFault", within_s=0.25)
        self.assertEqual((stop["reason"], stop["state"]["time_s"]), ("limit", 0.25))

    def test_when_it_sleeps_with_nothing_to_come(self):
        """The session may still send something, so that time continues."""
        simulation = self.construct("echo")
        self.advance(simulation, seconds=5)
        self.session("uart.send", simulation=simulation, uart=0, bytes="late\n")
        stop = self.advance(simulation, uart={"uart": 0, "pattern": "late"}, within_s=1)
        self.assertEqual(stop["reason"], "uart")
        self.assertGreater(stop["state"]["time_s"], 5)

    def test_time_goes_forward_only(self):
        simulation = self.construct()
        self.advance(simulation, seconds=1)
        with self.assertRaisesRegex(Refused, "time goes forward only"):
            self.advance(simulation, until_s=0.5)


class Expressions(Driven):
    """As Python has them."""

    def value(self, simulation, text):
        return self.session("expression.read", simulation=simulation, text=text)["value"]

    def draw(self, random_source, depth):
        """An expression of small whole numbers whose value fits Python's and ours."""
        if depth == 0 or random_source.random() < 0.2:
            return str(random_source.randint(0, 9))
        one, two = self.draw(random_source, depth - 1), self.draw(random_source, depth - 1)
        kind = random_source.randrange(8)
        if kind == 0:
            return f"(not {one})"
        if kind == 1:
            return f"-{two}" if not two.startswith("-") else f"({two})"
        if kind == 2:
            return f"({one})"
        sign = random_source.choice(["+", "-", "*", "==", "!=", "<", "<=", ">", ">=", "and", "or"])
        return f"{one} {sign} {two}" if random_source.random() < 0.5 else f"({one} {sign} {two})"

    def test_drawn_ones(self):
        simulation = self.construct()
        draw = random.Random(SEED)
        compared = 0
        for _ in range(2000):
            text = self.draw(draw, 4)
            # Python compares in chains.
            if re.search(r"[<>=]", text) and any(
                isinstance(node, ast.Compare) and len(node.ops) > 1 for node in ast.walk(ast.parse(text))
            ):
                continue
            wanted = float(eval(text))  # pylint: disable=eval-used
            self.assertEqual(self.value(simulation, text), wanted, f"{text} (seed {SEED})")
            compared += 1
        self.assertGreater(compared, 1000)

    def test_bits(self):
        simulation = self.construct()
        for text in ("0xF0 & 0x3C | 1", "1 << 4 + 1", "0xFF >> 4 ^ 3", "~5 & 0xFF", "7 & 3 == 3", "100 % 7"):
            self.assertEqual(self.value(simulation, text), float(eval(text)), text)  # pylint: disable=eval-used

    def test_names(self):
        simulation = self.construct()
        self.advance(simulation, seconds=1)
        state = self.session("simulation.state", simulation=simulation)["state"]
        self.assertEqual(self.value(simulation, "$pc"), state["pc"])
        status = self.session("register.read", simulation=simulation, name="COPROCESSOR.STATUS")
        self.assertEqual(self.value(simulation, "COPROCESSOR.STATUS"), status["value"])
        self.assertEqual(self.value(simulation, "COPROCESSOR.STATUS.LOCK == 0 and samples + 1"), 1)

    def test_what_is_none(self):
        simulation = self.construct()
        for text, said in {
            "": "missing",
            "1 +": "missing",
            "(1": r"a \) is missing",
            "1 2": "an operator is missing",
            "1 / 0": "divides by 0",
            "sampels": "did you mean samples",
            "COPROCESSOR.STATSU": "did you mean STATUS",
            "$r99": "no register",
            "(" * 1000: "too many parts",
            "12abc": "no number",
        }.items():
            with self.subTest(text=text[:20]):
                with self.assertRaisesRegex(Refused, said):
                    self.value(simulation, text)


PROGRAM = r"""
#include <stdbool.h>
#include <stdint.h>
enum colour { RED, GREEN = 5, BLUE = -3 };
typedef struct point { int16_t x; uint8_t y; } point_t;
struct everything {
  char text[8]; int8_t i8; uint8_t u8; int16_t i16; uint32_t u32; int64_t i64; uint64_t u64;
  float f; double d; bool b;
  unsigned low : 3; int high : 5; unsigned long wide : 17; enum colour colour; point_t points[2][3];
  struct everything *next;
  union { uint32_t word; uint8_t bytes[4]; } either; const volatile point_t *where;
};
struct everything second = {"two", 1, 2, 3, 4, 5, 6, 7.5f, 8.25, false, 1, 2, 3, GREEN, {{{1, 2}}}, 0, {0x01020304}, 0};
point_t origin = {-7, 9};
struct everything first = {"first", -8, 200, -1600, 0xDEADBEEFu, -640000000000, 0xFFFFFFFFFFFFFFFFu, -1.5f, 1e300,
  true,
  5, -11, 99999, BLUE, {{{-1, 1}, {2, 2}, {3, 3}}, {{4, 4}, {5, 5}, {-6, 6}}}, &second, {0xA1B2C3D4u}, &origin};
static int hidden = 77;
int *pointer = &hidden;
int reset(void) {
  static volatile uint16_t inside = 4321; for (;;) { ++hidden; ++inside; first.u8 += (uint8_t)inside; } }
__attribute__((section(".vectors"), used)) const void *const vectors[2] = {(void *)0x20001000, (void *)reset};
"""
OPTIONS = "-mcpu=cortex-m3 -mthumb -g -O1 -nostdlib -T link.ld"
OTHER = "static int hidden = 5; int other(void) { return ++hidden; }"
LINK = """ENTRY(reset) SECTIONS { . = 0; .text : { KEEP(*(.vectors)) *(.text*) *(.rodata*) }
. = 0x20000000; .data : { *(.data*) *(.bss*) } }"""


class Variables(Driven):
    """By their names in C: as GDB has them."""

    def setUp(self):
        super().setUp()
        for name, text in (("main.c", PROGRAM), ("other.c", OTHER), ("link.ld", LINK)):
            (self.folder / name).write_text(text)
        self.elf = self.folder / "program.elf"
        done = subprocess.run(
            ["arm-none-eabi-gcc", *OPTIONS.split(), "main.c", "other.c", "-o", "program.elf"],
            cwd=self.folder,
            capture_output=True,
            text=True,
            check=False,
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        self.simulation = self.session("simulation.construct", settings={"firmware.elf": str(self.elf)})["simulation"]

    def gdb(self, *expressions):
        """What GDB prints for each expression."""
        words = [word for expression in expressions for word in ("-ex", f"output {expression}", "-ex", "echo \\n")]
        done = subprocess.run(
            ["gdb-multiarch", "-nx", "-batch", *words, self.elf], capture_output=True, text=True, check=True
        )
        return done.stdout.splitlines()

    def read(self, name):
        return self.session("variable.read", simulation=self.simulation, name=name)

    def test_numbers_as_gdb_prints_them(self):
        names = ["i8", "u8", "i16", "u32", "i64", "u64", "f", "d", "low", "high", "wide", "either.word"]
        names += ["either.bytes[3]", "points[1][2].x", "points[0][1].y", "next->i16", "next->next", "where->x"]
        paths = [f"first.{name}" for name in names] + ["*pointer", "first.next->points[0][0].y", "origin.x"]
        wanted = self.gdb(*paths)
        for path, text in zip(paths, wanted):
            with self.subTest(path=path):
                # A pointer is printed with its type, a character with its sign.
                word = re.sub(r"\(.*\) ", "", text).split(" ")[0]
                number = int(word, 16) if word.startswith("0x") else float(word)
                self.assertEqual(float(self.read(path)["value"]), number, text)

    def test_addresses_and_sizes(self):
        listed = {
            each["name"]: each
            for each in self.session("variable.list", simulation=self.simulation)["variables"]
            if each["name"] not in ("hidden",)
        }
        self.assertIn("reset::inside", listed)
        names = ["first", "second", "origin", "pointer"]
        wanted = self.gdb(*(f"/d (long)&{name}" for name in names), *(f"sizeof({name})" for name in names))
        self.assertEqual([listed[name]["address"] for name in names], [int(text) for text in wanted[:4]])
        self.assertEqual([listed[name]["size"] for name in names], [int(text) for text in wanted[4:]])

    def test_words_structures_and_arrays(self):
        first = self.read("first")["value"]
        self.assertEqual(first["text"], "first")
        self.assertEqual(first["colour"], "BLUE")
        self.assertIs(first["b"], True)
        self.assertEqual(first["points"][1], [{"x": 4, "y": 4}, {"x": 5, "y": 5}, {"x": -6, "y": 6}])
        self.assertEqual(first["either"], {"word": 0xA1B2C3D4, "bytes": [0xD4, 0xC3, 0xB2, 0xA1]})
        self.assertEqual(self.read("first.next->colour")["value"], "GREEN")
        self.assertEqual(self.read("main.c::hidden")["value"], 77)
        self.assertEqual(self.read("other.c::hidden")["value"], 5)

    def test_what_was_written_is_read(self):
        for path, value in {
            "first.i8": -128,
            "first.u64": 2**63 + 5,
            "first.high": -16,
            "first.low": 7,
            "first.wide": 2**17 - 1,
            "first.f": 0.25,
            "first.d": -1e-300,
            "first.b": False,
            "first.colour": "GREEN",
            "first.text": "seven77",
            "first.points[0][2]": {"x": 12, "y": 34},
            "first.next->points[1]": [{"x": 1, "y": 2}, {"x": 3, "y": 4}, {"x": 5, "y": 6}],
        }.items():
            with self.subTest(path=path):
                around = (
                    self.read("first.high")["value"],
                    self.read("first.wide")["value"],
                    self.read("first.b")["value"],
                )
                self.session("variable.write", simulation=self.simulation, name=path, value=value)
                self.assertEqual(self.read(path)["value"], value)
                now = self.read("first.high")["value"], self.read("first.wide")["value"], self.read("first.b")["value"]
                changed = sum(one != other for one, other in zip(around, now))
                self.assertLessEqual(changed, 1, "a bit-field leaves its neighbours alone")

    def test_what_does_not_fit(self):
        for path, value, said in (
            ("first.i8", 128, "whole number of 8 bits"),
            ("first.low", 8, "whole number of 3 bits"),
            ("first.u8", -1, "whole number of 8 bits"),
            ("first.f", "x", "a number"),
            ("first.colour", "PINK", "did you mean"),
            ("first.text", "too long a text", "fits"),
            ("first.points", [[], [], []], "fits"),
            ("origin", {"z": 1}, "no member 'z'"),
            ("origin", 3, "an object"),
        ):
            with self.subTest(path=path):
                with self.assertRaisesRegex(Refused, said):
                    self.session("variable.write", simulation=self.simulation, name=path, value=value)

    def test_what_is_not_there(self):
        for path, said in {
            "frist": "did you mean first",
            "hidden": "main.c::hidden or other.c::hidden|other.c::hidden or main.c::hidden",
            "first.x": "no member 'x'",
            "first.u8.x": "no members",
            "first.points[2]": "2 elements",
            "first.points[": "write an index",
            "first->u8": "is no pointer",
            "*first": "is no pointer",
            "first.next->next->u8": None,  # the null pointer leads to code at 0
            "first!": "cannot follow",
        }.items():
            with self.subTest(path=path):
                if said is None:
                    self.read(path)
                    continue
                with self.assertRaisesRegex(Refused, said):
                    self.read(path)


class Hostile(Driven):
    """Whatever a client asks, the session answers, and continues."""

    def any_value(self, draw, depth=0):
        kinds = [
            lambda: draw.randint(-5, 300),
            lambda: draw.choice([0, 1, 2**32, 2**53, 2**63, -(2**40), 1e308, -0.5]),
            lambda: draw.choice(
                ["", "main", "samples", "COPROCESSOR.CTRL", "x" * 5000, "../../etc", "\u0000", "$pc", "first["]
            ),
            lambda: draw.choice([True, False, None]),
            lambda: {"uart": self.any_value(draw, depth + 1), "pattern": draw.choice(["(", "a+", "", "(a*)*b"])},
            lambda: {"text": draw.choice(["samples > 3", "1/", "$pc"]), "every_s": draw.choice([0.001, -1, "x"])},
            lambda: {"frame": draw.randint(0, 3), "type": draw.choice(["<f8", "|u1", "O8"]), "shape": [1]},
            lambda: [self.any_value(draw, depth + 1) for _ in range(draw.randint(0, 4))] if depth < 3 else [],
        ]
        return draw.choice(kinds)()

    def test_any_method_with_any_parameters(self):
        schema = self.session("session.schema")["methods"]
        draw = random.Random(SEED)
        # These end what the others need, write files, or may take as long as they like.
        left_out = {"session.end", "simulation.close", "simulation.finish", "simulation.save", "simulation.advance"}
        left_out |= {"debugger.kill", "debugger.resume"}
        left_out.add("simulation.goto")  # history_test.py has its own refusals
        methods = [each for each in schema if each["name"] not in left_out]
        self.assertGreater(len(methods), 25)
        simulation = self.construct()
        answers = {"result": 0, "error": 0}
        for number in range(4000):
            method = draw.choice(methods)
            params = {
                each["name"]: self.any_value(draw)
                for each in method["params"]
                if each["required"] or draw.random() < 0.5
            }
            if method["simulation"] and draw.random() < 0.9:
                params["simulation"] = simulation
            if method["name"] in ("simulation.construct", "simulation.clone"):
                params = {"settings": {"firmware.elf": self.any_value(draw)}, "count": self.any_value(draw)}
            answer = self.session.send(
                json.dumps({"jsonrpc": "2.0", "id": number, "method": method["name"], "params": params}).encode()
                + b"\n"
            )
            self.assertEqual(answer["id"], number, f"seed {SEED}: {method['name']} {params}")
            answers["result" if "result" in answer else "error"] += 1
            if "error" in answer and answer["error"]["code"] == 2 and "signal" in answer["error"]["message"]:
                self.fail(f"seed {SEED}: {method['name']} {params}: {answer['error']}")
        self.assertGreater(answers["result"], 400)
        self.assertGreater(answers["error"], 400)
        # Its registers and memory hold what was drawn, so it may have crashed; the session is well.
        self.assertIn(self.advance(simulation, seconds=0.01)["reason"], ("time", "over", "bkpt"))
        self.assertEqual(self.advance(self.construct(), seconds=0.01)["reason"], "time")

    def test_damaged_lines(self):
        for line, code in (
            (b"\x00\xff\n", -32700),
            (b"[]\n", -32600),
            (b'{"jsonrpc": "1.0", "id": 1, "method": "session.about"}\n', -32600),
            (b'{"id": {}, "method": "session.about"}\n', -32600),
            (b'{"id": 1, "method": "session.abuot"}\n', -32601),
            (b'{"id": 1, "method": "session.about", "params": [1]}\n', -32602),
            (b'{"id": 1, "method": "session.about", "params": {"x": 1}}\n', -32602),
            (b"[" * 100000 + b"\n", -32700),
        ):
            with self.subTest(line=line[:40]):
                self.assertEqual(self.session.send(line)["error"]["code"], code)
        self.assertEqual(self.session("session.about")["protocol"], 1)

    def test_requests_need_not_wait_for_answers(self):
        """What follows a construction is done after it, or refused with it."""
        for program, ends in ((str(FIRMWARE / "selfcal.elf"), "result"), ("no such program", "error")):
            with self.subTest(program=program):
                number = len(self.session("session.simulations")["simulations"]) + 1
                requests = [("simulation.construct", {"settings": {"firmware.elf": program}})]
                requests += [("simulation.advance", {"simulation": number, "cycles": 1000})] * 3
                lines = [
                    json.dumps({"jsonrpc": "2.0", "id": i, "method": method, "params": params}) + "\n"
                    for i, (method, params) in enumerate(requests)
                ]
                self.session.process.stdin.write("".join(lines).encode())
                self.session.process.stdin.flush()
                answers = {}
                for _ in requests:
                    answer = json.loads(self.session.process.stdout.readline())
                    answers[answer["id"]] = answer
                self.assertEqual([ends in answers[i] for i in range(len(requests))], [True] * len(requests), answers)

    def test_a_client_that_sends_no_more_is_answered(self):
        """In the order of its requests to one simulation, also what that refuses."""
        self.construct("hello")
        bad = {"jsonrpc": "2.0", "id": "bad", "method": "memory.read", "params": {"simulation": 1, "size": "x"}}
        late = {"jsonrpc": "2.0", "id": None, "method": "simulation.state", "params": {"simulation": 1}}
        silent = {"jsonrpc": "2.0", "method": "simulation.state", "params": {"simulation": 1}}
        large = {"jsonrpc": "2.0", "id": 1.5, "method": "memory.read", "params": {"simulation": 1, "address": 0}}
        large["params"]["size"] = 200000
        self.session.process.stdin.write(
            "".join(json.dumps(each) + "\n" for each in (bad, silent, large, late)).encode()
        )
        self.session.process.stdin.close()
        answers = []
        while line := self.session.process.stdout.readline():
            answers.append(json.loads(line))
            answers[-1]["data"] = [self.session.process.stdout.read(size) for size in answers[-1].get("frames", [])]
        self.assertEqual([each["id"] for each in answers], ["bad", 1.5, None])
        self.assertEqual([each["jsonrpc"] for each in answers], ["2.0"] * 3)
        self.assertEqual(answers[0]["error"]["code"], -32602)
        self.assertEqual(len(answers[1]["data"][0]), 200000)
        self.assertIn("place", answers[2]["result"])

    def test_outputs_belong_to_one(self):
        simulation = self.construct(**{"trace.waves": "waves.fst"})
        with self.assertRaisesRegex(Refused, "names a file"):
            self.session("simulation.clone", simulation=simulation)

    def refuse_output(self, simulation, **settings):
        given = {"firmware.elf": str(FIRMWARE / "hello.elf"), **settings}
        with self.assertRaisesRegex(Refused, f"is a file that simulation {simulation} writes; name another") as refused:
            self.session("simulation.construct", settings=given)
        return str(refused.exception)

    def test_an_output_of_another_simulation(self):
        (self.folder / "inside").mkdir()
        (self.folder / "link").symlink_to("inside")
        first = self.construct("hello", **{"trace.waves": "inside/a.fst", "uart0.backend": "file:said"})
        self.assertIn("trace.waves: link/a.fst is", self.refuse_output(first, **{"trace.waves": "link/a.fst"}))
        # Its own save file, and a backend's.
        self.refuse_output(first, **{"trace.profile": "inside/a.gtkw"})
        self.refuse_output(first, **{"uart3.backend": f"file:{self.folder}/said"})
        self.refuse_output(first, **{"checkpoint.save": "said@0.001"})
        second = self.construct("hello", **{"trace.waves": "b.fst", "uart0.backend": "file:/dev/null"})
        third = self.construct("hello", **{"trace.waves": "c.fst", "uart0.backend": "file:/dev/null"})
        for simulation in (first, second, third):
            self.advance(simulation, seconds=0.01)
        # Its result is there, and still it is the simulation's.
        self.session("simulation.finish", simulation=first)
        self.refuse_output(first, **{"trace.waves": "inside/a.fst"})
        self.session("simulation.close", simulation=first)
        fourth = self.construct("hello", **{"trace.waves": "inside/a.fst"})
        self.refuse_output(fourth, **{"trace.waves": "inside/a.fst"})

    def test_an_output_of_one_that_was_not_constructed(self):
        with self.assertRaisesRegex(Refused, "nothing.elf"):
            self.session("simulation.construct", settings={"firmware.elf": "nothing.elf", "trace.waves": "a.fst"})
        self.construct("hello", **{"trace.waves": "a.fst"})

    def test_an_output_of_a_clone(self):
        first = self.construct("hello", **{"uart0.backend": "file:said"})
        snapshot = self.session("simulation.snapshot", simulation=first)["snapshot"]
        with self.assertRaisesRegex(Refused, f"uart0.backend: said is a file that simulation {first} writes"):
            self.session("simulation.clone", simulation=first, count=2)
        other = self.construct("hello")
        with self.assertRaisesRegex(Refused, f"uart0.backend: said is a file that simulation {first} writes"):
            self.session("simulation.restore", simulation=other, snapshot=snapshot)
        # The one that is restored has its own.
        self.session("simulation.restore", simulation=first, snapshot=snapshot)
        self.refuse_output(first, **{"uart0.backend": "file:said"})
        self.advance(first, seconds=0.01)
        self.session("simulation.close", simulation=first)
        self.session("simulation.restore", simulation=other, snapshot=snapshot)
        self.refuse_output(other, **{"uart0.backend": "file:said"})

    def test_going_back_keeps_outputs(self):
        first = self.construct(**{"checkpoint.save": "saved@0.02"})
        self.advance(first, seconds=0.01)
        for _ in range(3):
            self.session("simulation.goto", simulation=first, time_s=0.005)
            self.refuse_output(first, **{"trace.profile": "saved"})
        self.session("history.last_write", simulation=first, register="r3")
        self.session("simulation.close", simulation=first)
        self.construct("hello", **{"trace.profile": "saved"})

    def test_no_input_is_overwritten(self):
        program = self.folder / "program.elf"
        shutil.copy(FIRMWARE / "hello.elf", program)
        given = {"firmware.elf": "program.elf"}
        with self.assertRaisesRegex(Refused, "trace.waves ./program.elf and .* are the same file; name another"):
            self.session("simulation.construct", settings={**given, "trace.waves": "./program.elf"})
        simulation = self.session("simulation.construct", settings=given)["simulation"]
        self.advance(simulation, seconds=0.001)
        for method, params in (
            ("simulation.save", {"file": "program.elf"}),
            ("simulation.record", {"file": "program.elf"}),
            ("history.trace", {"one": {"time_s": 0}, "files": {"instructions": "program.elf"}}),
        ):
            with self.assertRaisesRegex(Refused, "program.elf and .* are the same file; name another"):
                self.session(method, simulation=simulation, **params)
        self.assertEqual(program.read_bytes(), (FIRMWARE / "hello.elf").read_bytes())

    def test_its_parent_may_write_anywhere(self):
        done = subprocess.run([CAPSOC, "serve", "--write", "."], env=CLEAN, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 2)
        self.assertIn("--write is for clients of --socket or --port", done.stderr)
        with tempfile.TemporaryDirectory() as elsewhere:
            self.session("simulation.save", simulation=self.construct(), file=f"{elsewhere}/state")
            self.assertEqual(os.listdir(elsewhere), ["state"])

    def test_no_result_files(self):
        for name in ("results.json", "results.html"):
            with self.assertRaisesRegex(Refused, f"{name}: a session writes no result files"):
                self.construct(**{name: "r"})
            self.assertFalse((self.folder / "r").exists())

    def test_one_that_is_closed_while_it_advances_writes_its_outputs(self):
        simulation = self.construct(**{"trace.waves": "waves.fst"})
        requests = [
            {"jsonrpc": "2.0", "id": i, "method": method, "params": {"simulation": simulation}}
            for i, method in enumerate(("simulation.advance", "simulation.close"))
        ]
        self.session.process.stdin.write("".join(json.dumps(each) + "\n" for each in requests).encode())
        self.session.process.stdin.flush()
        self.assertEqual(self.session.close(), 0)
        self.assertGreater((self.folder / "waves.fst").stat().st_size, 1000)

    def test_standard_output_is_the_sessions(self):
        with self.assertRaisesRegex(Refused, "standard output belongs to the session"):
            self.construct(**{"uart1.backend": "stdout"})


class Page(unittest.TestCase):
    """docs/reference/protocol.md."""

    def test_it_is_what_the_program_says(self):
        done = subprocess.run(
            [SOURCE / "scripts" / "tool", "protocol_page", "--check", CAPSOC],
            capture_output=True,
            text=True,
            check=False,
        )
        self.assertEqual(done.returncode, 0, done.stderr)


if __name__ == "__main__":
    unittest.main()
