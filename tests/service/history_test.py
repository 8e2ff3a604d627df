#!/usr/bin/python3
"""Going back in time: a position in the past has the state that a run in one piece has there, bit for bit.

The oracle of every test is another simulation that only goes forward. CAPSOC_HISTORY_WALKS asks for longer walks.
"""

import json
import os
import random
import unittest

from harness import is_firmware_of_the_pages, without_host_times
from protocol_test import Driven, Refused

CTEST = {"name": "service: history", "timeout": 900, "interpreter": "/usr/bin/python3"}

SEED = int(os.environ.get("CAPSOC_HISTORY_SEED", "20261126"))
MOVES = int(os.environ.get("CAPSOC_HISTORY_WALKS", "24"))
SHORT = {"program.demodulation_samples": "500", "program.calibration_samples": "50"}


class Past(Driven):
    """Simulations, and what is asked of them."""

    def call(self, method, **params):
        return self.session(method, simulation=self.simulation, **params)

    def where(self, simulation, **params):
        return self.session("history.when", simulation=simulation, **params)

    def look(self, simulation):
        """What has to be equal at equal positions."""
        told = self.where(simulation, hash=True)
        state = self.session("simulation.state", simulation=simulation)["state"]
        return told["now"], told["sha256"], state

    def text(self, simulation):
        """Of whichever output the program uses."""
        text = self.session("uart.read", simulation=simulation, uart=0)["text"]
        text += self.session("semihosting.read", simulation=simulation)["text"]
        try:
            return text + self.session("itm.read", simulation=simulation)["text"]
        except Refused:
            return text


class Walks(Past):
    """Random moves, compared at each stop."""

    def forward(self, program, settings, inputs, stops):
        """The states at the counts of instructions, and the text, of a simulation that keeps no history."""
        simulation = self.construct(program, history_mb=0, **settings)
        seen, text = {}, ""
        for count in sorted(set(stops) | {each[0] for each in inputs}):
            now = self.where(simulation)["now"]["instructions"]
            self.advance(simulation, instructions=count - now)
            for _, method, params in (each for each in inputs if each[0] == count):
                self.session(method, simulation=simulation, **params)
            seen[count] = self.look(simulation)
            text += self.text(simulation)
        self.session("simulation.close", simulation=simulation)
        return seen, text

    def walk(self, program, stops, inputs=(), moves=MOVES, **settings):
        draw = random.Random(f"{SEED} {program} {settings}")
        last = max(stops)
        seen, wanted = self.forward(program, settings, inputs, stops)
        simulation = self.construct(program, **settings)
        for count, method, params in inputs:
            now = self.where(simulation)["now"]["instructions"]
            self.advance(simulation, instructions=count - now)
            self.session(method, simulation=simulation, **params)
        self.session("simulation.goto", simulation=simulation, instructions=last)
        if program == "selfcal" and last > 1_000_000:
            self.assertGreater(self.where(simulation)["snapshots"], 1)  # by itself
        text = ""
        for _ in range(moves):
            count = draw.choice(stops)
            now = self.where(simulation)["now"]
            kind = draw.choice(["goto", "time", "relative", "relative"])
            if kind == "time":
                self.session("simulation.goto", simulation=simulation, time_ps=seen[count][0]["time_ps"])
            elif kind == "goto":
                self.session("simulation.goto", simulation=simulation, instructions=count)
            elif count > now["instructions"]:
                self.advance(simulation, instructions=count - now["instructions"])
            elif count < now["instructions"]:
                self.session("history.back", simulation=simulation, instructions=now["instructions"] - count)
            else:
                continue
            with self.subTest(program=program, seed=SEED, move=kind, count=count, **settings):
                self.assertEqual(self.look(simulation), seen[count])
            if draw.random() < 0.3:
                text += self.text(simulation)
            if draw.random() < 0.3:
                self.session("history.keep", simulation=simulation)
        self.session("simulation.goto", simulation=simulation, instructions=last)
        self.assertEqual(self.look(simulation), seen[last])
        self.assertEqual(text + self.text(simulation), wanted, f"seed {SEED}")
        self.assertEqual(self.where(simulation)["inputs"], len(inputs))
        self.session("simulation.close", simulation=simulation)

    def stops(self, name, most, count=12):
        draw = random.Random(f"{SEED} {name}")
        return sorted(draw.randrange(1, most) for _ in range(count))

    def test_the_main_job(self):
        self.walk("selfcal", self.stops("selfcal", 5_000_000))

    def test_a_sample_that_is_on_its_way(self):
        """A snapshot at any cycle between a sample's conversion and its result."""
        scout = self.construct("selfcal", history_mb=0)
        self.session("simulation.advance", simulation=scout, samples=1000)
        result = self.where(scout)["now"]["cycles"]
        forward, past = self.construct("selfcal", history_mb=0), self.construct("selfcal")
        counts, positions = set(), []
        for goal in [*range(result - 60, result + 3), result + 100_000]:
            now = self.where(forward)["now"]["cycles"]
            if goal > now:  # an instruction may take several
                self.advance(forward, cycles=goal - now)
            positions.append(self.where(forward)["now"]["cycles"])
            counts.add(self.where(forward)["now"]["samples"])
        self.assertEqual(counts, {999, 1000, 1001})
        there = self.look(forward), self.newest(forward)
        for cycles in positions:
            self.session("simulation.goto", simulation=past, cycles=cycles)
            self.session("history.keep", simulation=past)
        for cycles in reversed(positions):
            self.session("simulation.goto", simulation=past, cycles=cycles)
            self.session("simulation.goto", simulation=past, cycles=positions[-1])
            with self.subTest(cycles=result - cycles):
                self.assertEqual((self.look(past), self.newest(past)), there)

    def newest(self, simulation):
        return self.session("samples.read", simulation=simulation, last=1)

    def test_tasks(self):
        self.walk("threads", self.stops("threads", 20_000), **{"run.simlimit_s": "100"})

    def test_what_came_from_outside(self):
        sent = [
            (500, "uart.send", {"uart": 0, "bytes": [9, 0, 0, 0]}),
            (900, "uart.send", {"uart": 0, "bytes": "one two"}),
            (901, "pin.drive", {"gpio": 0, "pin": 3, "level": True}),
            (1000, "processor.write", {"register": "r11", "value": 77}),
            (1100, "memory.write", {"address": 0x20300000, "bytes": [1, 2, 3]}),
            (1200, "uart.send", {"uart": 0, "bytes": "three"}),
        ]
        self.walk("echo", [400, 500, 700, 900, 901, 950, 1000, 1150, 1200, 1300], sent)

    def test_text_beside_the_uarts(self):
        self.walk("itm", [100, 250, 300, 350, 400, 450, 500], **{"itm.backend": "stdout"})
        self.walk("long_text", self.stops("long_text", 200_000, 6), moves=MOVES // 2)

    def test_what_is_read_from_the_console(self):
        sent = [(300_000, "semihosting.send", {"bytes": "abc\ndef"}), (300_020, "semihosting.send", {"bytes": "g\n"})]
        stops = [250_000, 300_000, 300_010, 300_020, 300_030, 300_050, 300_100]
        self.walk("endless", stops, sent, **{"program.way": "22"})

    def test_a_console_that_waits(self):
        settings = {"semihosting.console": "stdio"}
        scout = self.construct("questions", history_mb=0, **settings)
        sent, stops = [], [100]
        for answer in ({"bytes": "one\n"}, {"bytes": "x"}, {"bytes": ""}, {"bytes": "two", "end": True}):
            told = self.advance(scout)
            self.assertEqual(told["reason"], "console")
            self.assertEqual(self.advance(scout, seconds=1)["reason"], "console")
            count = told["state"]["instructions"]
            stops += [count - 7, count - 1, count]
            self.session("semihosting.send", simulation=scout, **answer)
            if answer["bytes"]:
                sent.append((count, "semihosting.send", answer))
        self.assertEqual(self.advance(scout)["reason"], "over")
        self.assertEqual(len({count for count, *_ in sent}), 3)
        self.walk("questions", stops, sent, **settings)

    def test_the_sensor(self):
        changes = [
            (40_000, "sensor.set", {"parameters": {"b1": 0.125}}),
            (70_000, "sensor.speed", {"factor": 1.75}),
            (90_000, "adc.inject", {"u": [0.5, 0.25, 0.125], "v": [0.1, 0.2, 0.3]}),
        ]
        self.walk("selfcal", self.stops("sensor", 200_000, 8) + [40_000, 70_000, 90_000], changes, moves=MOVES // 2)

    def test_the_rtl(self):
        stops = self.stops("rtl", 60_000, 6)
        self.walk("selfcal", stops, moves=MOVES // 3, **{"coprocessor.backend": "rtl"}, **SHORT)


class Results(Past):
    """What observers gathered of the whole run is in its result, however often a client goes back."""

    GATHERED = {"results.curves": "true", "results.latencies": "true", "cpu.stack_marks": "true"}

    def result(self, program, stops, **settings):
        simulation = self.construct(program, **self.GATHERED, **settings)
        for kind, time_ps in stops:
            if kind == "keep":
                self.session("history.keep", simulation=simulation)
            else:
                self.session("simulation.goto", simulation=simulation, time_ps=time_ps)
        self.advance(simulation)
        finished = self.session("simulation.finish", simulation=simulation)
        self.session("simulation.close", simulation=simulation)
        return without_host_times(finished["result"])

    def test_looking_back_changes_no_result(self):
        for program, end, settings in (
            ("selfcal", 2_200_000_000_000, SHORT),
            ("profiled", 200_000_000, {"tasks.current": "0x20000000"}),
        ):
            forward = self.result(program, [], **settings)
            for name in ("curves", "interrupts", "stacks"):
                self.assertIn(name, forward)
            draw = random.Random(f"{SEED} {program}")
            stops = [("goto", draw.randrange(end // 2, end)), ("keep", 0)]
            for _ in range(6):
                stops += [("goto", draw.randrange(end // 10, end)), ("keep", 0)]
            self.assertEqual(self.result(program, stops, **settings), forward, f"seed {SEED}")

    def test_snapshots_have_it_too(self):
        simulation = self.construct("selfcal", **self.GATHERED, **SHORT)
        self.advance(simulation, seconds=1)
        snapshot = self.session("simulation.snapshot", simulation=simulation)["snapshot"]
        self.advance(simulation, seconds=0.5)
        self.session("simulation.restore", simulation=simulation, snapshot=snapshot)
        self.advance(simulation)
        finished = self.session("simulation.finish", simulation=simulation)
        self.assertEqual(without_host_times(finished["result"]), self.result("selfcal", [], **SHORT))
        self.session("simulation.close", simulation=simulation)

    def test_what_needs_all_samples_has_no_past(self):
        simulation = self.construct("selfcal", **{"run.golden": "true"})
        self.assertIn("run.golden needs all samples", self.where(simulation)["why"])
        with self.assertRaises(Refused) as refused:
            self.advance(simulation, seconds=0.1)
            snapshot = self.session("simulation.snapshot", simulation=simulation)["snapshot"]
            self.session("simulation.restore", simulation=simulation, snapshot=snapshot)
        self.assertIn("run.golden needs all samples", str(refused.exception))
        self.session("simulation.close", simulation=simulation)


class Outcomes(Past):
    """How a run ends, asked before it does."""

    def outcome(self, simulation):
        answer = self.session("simulation.outcome", simulation=simulation)
        return self.without_the_host(answer)

    def look_at(self, simulation, is_over):
        return self.where(simulation)["now"] if is_over else self.look(simulation)

    def without_the_host(self, answer):
        return {**answer, "table": None, "result": without_host_times(answer["result"])}

    def test_it_is_what_finish_answers_and_changes_nothing(self):
        for program, goal, code in (("selfcal", {"seconds": 1}, 0), ("divzero", {}, 5), ("hello", {}, 0)):
            simulation = self.construct(program)
            self.advance(simulation, **goal)
            is_over = program != "selfcal"  # then it has no state to resume from
            before, now = self.look_at(simulation, is_over), self.where(simulation)["now"]
            told = self.outcome(simulation)
            self.assertEqual(told["code"], code)
            self.assertEqual(self.look_at(simulation, is_over), before)
            self.session("history.back", simulation=simulation, instructions=100)
            self.session("simulation.goto", simulation=simulation, time_ps=now["time_ps"])
            self.assertEqual(self.look_at(simulation, is_over), before)
            finished = self.session("simulation.finish", simulation=simulation)
            self.assertEqual(told, self.without_the_host(finished))
            self.session("simulation.close", simulation=simulation)

    def test_it_needs_a_history(self):
        simulation = self.construct("hello", history_mb=0)
        with self.assertRaises(Refused) as refused:
            self.session("simulation.outcome", simulation=simulation)
        self.assertIn("history_mb is 0", str(refused.exception))
        self.session("simulation.close", simulation=simulation)


class Logged(Past):
    """What changes the simulation is logged, and nothing else. Every method of a simulation is in one of the lists."""

    INPUTS = {
        "memory.write": {"address": 0x20300000, "bytes": [1]},
        "variable.write": {"name": "results", "value": 7},
        "processor.write": {"register": "r11", "value": 77},
        "register.write": {"name": "COPROCESSOR.LOCK_THRESHOLD", "value": 77},
        "uart.send": {"uart": 0, "bytes": "x"},
        "semihosting.send": {"bytes": "x"},
        "pin.drive": {"gpio": 0, "pin": 3, "level": True},
        "button.press": {"button": 0, "pressed": True},
        "adc.inject": {"u": [0.5], "v": [0.25]},
        "sensor.set": {"parameters": {"b1": 0.125}},
        "sensor.speed": {"factor": 1.5},
        "fault.inject": {"fault": "flip cpu.r10[3]"},
        "debugger.attach": {"attached": True},
        "processor.reset": {},
    }
    LOOKS = {
        "simulation.state": {},
        "simulation.save": {"file": "saved"},
        "simulation.outcome": {},
        "simulation.record": {"file": "recorded"},
        "history.when": {},
        "history.keep": {},
        "history.list": {},
        "memory.read": {"address": 0x20000000, "size": 64},
        "variable.read": {"name": "results"},
        "variable.list": {},
        "expression.read": {"text": "results + 1"},
        "processor.read": {},
        "processor.activity": {"window_s": 0.1},
        "register.read": {"name": "UART0.STATE"},
        "register.list": {},
        "coprocessor.read": {},
        "uart.read": {"uart": 0},
        "itm.read": {},
        "semihosting.read": {},
        "pin.read": {"gpio": 0},
        "events.subscribe": {"kinds": ["exception", "sample"]},
        "sensor.read": {},
        "samples.read": {},
        "fault.list": {},
        "fault.places": {},
        "debugger.about": {},
    }
    MOVES = {
        *("simulation.advance", "simulation.goto", "simulation.restore", "simulation.finish", "simulation.close"),
        *("simulation.interrupt", "simulation.snapshot", "simulation.clone"),
        *("debugger.resume", "debugger.reverse", "debugger.kill"),
        *("history.back", "history.last_write", "history.last_change", "history.diff", "history.timeline"),
        *("history.trace", "history.why", "history.select"),
    }

    def test_every_method(self):
        methods = {each["name"] for each in self.session("session.schema")["methods"] if each["simulation"]}
        self.assertEqual(methods, {*self.INPUTS, *self.LOOKS, *self.MOVES})
        simulation = self.construct(**{"itm.backend": "stdout"})
        self.advance(simulation, instructions=300_000)
        before = self.look(simulation)
        for method, params in self.LOOKS.items():
            with self.subTest(method=method):
                self.session(method, simulation=simulation, **params)
                self.assertEqual(self.where(simulation)["inputs"], 0)
                self.assertEqual(self.look(simulation), before)
        for number, (method, params) in enumerate(self.INPUTS.items(), 1):
            with self.subTest(method=method):
                self.session(method, simulation=simulation, **params)
                self.assertEqual(self.where(simulation)["inputs"], number)


class Branches(Past):
    """An input after going back makes another future."""

    def test_another_future(self):
        simulation = self.construct("echo")
        self.advance(simulation, seconds=0.001)
        self.session("uart.send", simulation=simulation, uart=0, bytes=[3, 0, 0, 0, 65, 66, 67])
        self.advance(simulation, seconds=0.004)
        end = self.where(simulation)["now"]
        self.session("simulation.goto", simulation=simulation, time_s=0.0005)
        self.assertEqual(self.text(simulation), "\x03\x00\x00\x00ABC")
        answer = self.session("uart.send", simulation=simulation, uart=0, bytes=[9, 0, 0, 0, 88, 89])
        self.assertEqual(answer["ended_history"], end | {"history": 1})
        told = self.where(simulation)
        self.assertEqual((told["inputs"], told["end"]), (1, told["now"]))
        self.advance(simulation, seconds=0.004)
        self.assertEqual(self.text(simulation), "\t\x00\x00\x00XY")
        other = self.construct("echo")
        self.advance(other, seconds=0.0005)
        self.session("uart.send", simulation=other, uart=0, bytes=[9, 0, 0, 0, 88, 89])
        self.advance(other, seconds=0.004)
        self.assertEqual(self.look(simulation), self.look(other))

    def test_histories_that_were_left(self):
        """Drawn walks: what is at the end of each history is what was there when it was left."""
        draw = random.Random(SEED)
        simulation = self.construct("echo")
        ends, inputs, number, selected = {}, {1: []}, 1, 0
        for _ in range(100):
            kind = draw.choice(["forward", "forward", "back", "send", "send", "select", "keep"])
            now = self.where(simulation)["now"]
            if kind == "forward":
                self.advance(simulation, cycles=draw.randint(1, 20_000))
            elif kind == "back":
                self.session("simulation.goto", simulation=simulation, cycles=draw.randint(0, now["cycles"]))
            elif kind == "keep":
                self.session("history.keep", simulation=simulation)
            elif kind == "select" and set(ends) - {number}:
                # The one that is left now ends where it was simulated to.
                end = self.where(simulation)["end"]
                self.session("simulation.goto", simulation=simulation, time_ps=end["time_ps"])
                ends[number] = self.look(simulation)
                number = draw.choice(sorted(set(ends) - {number}))
                self.session("history.select", simulation=simulation, number=number)
                self.assertEqual(self.look(simulation), ends[number], f"seed {SEED}, history {number}")
                selected += 1
            elif kind == "send":
                ahead = [each for each in inputs[number] if each[0] > now["cycles"]]
                end = self.where(simulation)["end"]
                if ahead or end != now:
                    self.session("simulation.goto", simulation=simulation, time_ps=end["time_ps"])
                    ends[number] = self.look(simulation)
                    self.session("simulation.goto", simulation=simulation, cycles=now["cycles"])
                    now = self.where(simulation)["now"]
                byte = draw.randint(1, 255)
                answer = self.session("uart.send", simulation=simulation, uart=0, bytes=[byte])
                before = [each for each in inputs[number] if each[0] <= now["cycles"]]
                self.assertEqual("ended_history" in answer, end != now)
                if end != now:
                    self.assertEqual(answer["ended_history"], end | {"history": number})
                    number = max(inputs) + 1
                inputs[number] = [*before, (now["cycles"], byte)]
            about = self.where(simulation)
            self.assertEqual((about["history"], about["inputs"]), (number, len(inputs[number])))
            listed = self.session("history.list", simulation=simulation)["histories"]
            self.assertEqual([each["history"] for each in listed if each["present"]], [number])
            self.assertEqual({each["history"]: each["inputs"] for each in listed}, {n: len(inputs[n]) for n in inputs})
        self.assertGreater(selected, 3)
        self.assertGreater(len(inputs), 5)
        with self.assertRaisesRegex(Refused, "there is no history 99; history.list has those"):
            self.session("history.select", simulation=simulation, number=99)

    def test_a_history_that_was_left_says_its_text_once(self):
        simulation = self.construct("echo")
        self.advance(simulation, cycles=1000)
        self.session("uart.send", simulation=simulation, uart=0, bytes=[3, 0, 0, 0, 65, 65, 65])
        self.advance(simulation, seconds=0.004)
        self.assertEqual(self.text(simulation), "\x03\x00\x00\x00AAA")
        self.session("simulation.goto", simulation=simulation, cycles=0)
        self.session("uart.send", simulation=simulation, uart=0, bytes=[3, 0, 0, 0, 66, 66, 66])
        while "B" not in self.text(simulation):
            self.advance(simulation, cycles=50)
        for number in (1, 2):
            self.session("history.select", simulation=simulation, number=number)
            self.assertEqual(self.text(simulation), "")
        self.advance(simulation, seconds=0.004)
        self.assertEqual(self.text(simulation), "BB")
        self.session("simulation.goto", simulation=simulation, cycles=0)
        wanted = {"uart": 0, "pattern": "B+"}
        self.assertEqual(self.advance(simulation, uart=wanted, within_s=0.01)["reason"], "uart")

    def test_a_pattern_is_found_again(self):
        simulation = self.construct("selfcal")
        wanted = {"uart": 0, "pattern": "s: (lock.*)"}
        first = self.advance(simulation, uart=wanted)
        self.advance(simulation, seconds=1)
        self.session("simulation.goto", simulation=simulation, cycles=1000)
        again = self.advance(simulation, uart=wanted)
        self.assertEqual((again["match"]["groups"], again["state"]), (first["match"]["groups"], first["state"]))

    def test_streams_are_told_once(self):
        simulation = self.construct("itm", **{"itm.backend": "stdout"})
        text = ""
        for until_s in (0.0001, 0.00005, 0.0002, 0.00001, 0.01):
            self.session("simulation.goto", simulation=simulation, time_s=until_s)
            text += self.session("itm.read", simulation=simulation)["text"]
        other = self.construct("itm", **{"itm.backend": "stdout"})
        self.advance(other, until_s=0.01)
        wanted = self.session("itm.read", simulation=other)["text"]
        self.assertEqual((text, len(wanted) > 0), (wanted, True))

    def test_a_search_is_answered_though_its_simulation_is_closed(self):
        for ending in ("simulation.close", "simulation.interrupt"):
            simulation = self.construct("selfcal")
            self.advance(simulation, until_s=300)
            params = {"simulation": simulation}
            requests = (
                (1, "history.last_write", {**params, "register": "r9"}),
                (2, "simulation.state", params),
                (3, ending, params),
            )
            process = self.session.process
            for number, method, given in requests:
                request = {"jsonrpc": "2.0", "id": number, "method": method, "params": given}
                process.stdin.write(json.dumps(request).encode() + b"\n")
            process.stdin.flush()
            answers = [json.loads(process.stdout.readline()) for _ in requests]
            self.assertEqual(sorted(answer["id"] for answer in answers), [1, 2, 3])
            if ending == "simulation.interrupt":
                self.assertEqual(self.advance(simulation, seconds=1)["state"]["time_s"], 301)

    def test_what_is_refused(self):
        simulation = self.construct("echo", history_mb=0)
        with self.assertRaisesRegex(Refused, "history_mb is 0"):
            self.session("simulation.goto", simulation=simulation, time_s=0)
        simulation = self.construct("echo")
        for method, params in (
            ("simulation.goto", {}),
            ("simulation.goto", {"time_s": -1}),
            ("simulation.goto", {"time_s": 1, "cycles": 1}),
            ("history.back", {"cycles": 1, "address": "main"}),
            ("history.back", {"address": "no_such_symbol"}),
            ("history.back", {"expression": {"text": "nothing_there > 1"}}),
            ("history.last_write", {}),
            ("history.last_write", {"register": "pc"}),
            ("history.last_write", {"variable": "no_such_variable"}),
            ("history.last_write", {"address": 0x90000000}),
            ("history.last_change", {"name": "UART0.NOTHING"}),
            ("history.last_change", {"signal": "nothing"}),
            ("history.last_change", {"name": "UART0.STATE", "every_s": 0}),
            ("history.diff", {"one": {"nothing": 1}}),
            ("history.timeline", {}),
            ("history.timeline", {"one": {"time_s": -1}}),
            ("history.timeline", {"one": {"time_s": 0}, "kinds": ["nothing"]}),
            ("history.timeline", {"one": {"cycles": 2}, "other": {"cycles": 1}}),
            ("history.trace", {"one": {"time_s": 0}}),
            ("history.why", {}),
            ("history.why", {"signal": "nothing"}),
        ):
            with self.subTest(method=method, params=params), self.assertRaises(Refused):
                self.session(method, simulation=simulation, **params)
        self.assertEqual(self.session("history.back", simulation=simulation, seconds=1)["reason"], "beginning")
        never = self.session("history.back", simulation=simulation, expression={"text": "1 == 2"})
        self.assertEqual(never["reason"], "never")


class Questions(Past):
    """What happened last, compared with what a simulation going forward shows."""

    def setUp(self):
        super().setUp()
        self.simulation = self.construct("selfcal", **SHORT)

    def test_the_last_time_at_an_address(self):
        pcs = []
        for _ in range(3):
            self.advance(self.simulation, address="uart_write")
            pcs.append(self.where(self.simulation)["now"])
        self.advance(self.simulation, instructions=1)
        for wanted in reversed(pcs):
            answer = self.call("history.back", address="uart_write")
            self.assertEqual((answer["reason"], self.where(self.simulation)["now"]), ("address", wanted))
        self.assertEqual(self.call("history.back", address="uart_write")["reason"], "never")
        self.assertEqual(self.where(self.simulation)["now"], pcs[0])

    def test_the_last_time_that_something_held(self):
        held = []
        for _ in range(300):
            self.advance(self.simulation, until_s=0.001 * (len(held) + 1))
            held.append(self.call("expression.read", text="$r3 % 3 == 1")["value"])
            if len(held) % 50 == 0:
                self.call("history.keep")
        for _ in range(3):
            now = round(self.where(self.simulation)["now"]["time_s"] * 1000)
            wanted = [i + 1 for i, value in enumerate(held) if value and i + 1 < now][-1:]
            answer = self.call("history.back", expression={"text": "$r3 % 3 == 1"})
            self.assertEqual(answer["reason"], "expression" if wanted else "never")
            if wanted:
                self.assertEqual(round(answer["state"]["time_s"] * 1000), wanted[0])

    def test_the_last_instruction_that_wrote(self):
        draw = random.Random(SEED)
        for _ in range(4):
            self.call("simulation.goto", instructions=draw.randrange(20_000, 100_000))
            begin = self.where(self.simulation)["now"]["instructions"]
            stack = self.call("processor.read")["registers"]["sp"] - 64
            seen = []
            for _ in range(120):
                registers = self.call("processor.read")["registers"]
                self.call("memory.read", address=stack, size=128)
                seen.append((registers, self.session.data[0]))
                self.advance(self.simulation, instructions=1)
            registers = self.call("processor.read")["registers"]
            self.call("memory.read", address=stack, size=128)
            seen.append((registers, self.session.data[0]))
            here = self.look(self.simulation)
            for name in ("r0", "r3", "sp", "lr"):
                changes = [i for i in range(120) if seen[i][0][name] != seen[i + 1][0][name]]
                with self.subTest(seed=SEED, register=name, begin=begin):
                    answer = self.call("history.last_write", register=name)
                    if not changes:
                        self.assertTrue(not answer["found"] or answer["position"]["instructions"] < begin)
                        continue
                    self.assertEqual(answer["position"]["instructions"], begin + changes[-1])
                    self.assertEqual(answer["old"], seen[changes[-1]][0][name])
                    self.assertEqual(answer["new"], seen[changes[-1] + 1][0][name])
                    self.assertEqual(answer["pc"], seen[changes[-1]][0]["pc"])
            changes = [i for i in range(120) if seen[i][1] != seen[i + 1][1]]
            with self.subTest(seed=SEED, begin=begin):
                answer = self.call("history.last_write", address=stack, size=128)
                self.assertTrue(answer["found"])
                wrote = answer["position"]["instructions"] - begin
                if changes:
                    self.assertGreaterEqual(wrote, changes[-1])
                if answer["old"] != answer["new"] and wrote >= 0:
                    self.assertEqual(wrote, changes[-1])
                    self.assertEqual(bytes(answer["new"]), seen[wrote + 1][1])
            self.assertEqual(self.look(self.simulation), here)

    REGISTERS = ("sp", *(f"r{number}" for number in range(13)))

    def test_a_register_that_was_written_long_ago(self):
        """Its change is where a simulation that has not gone further finds it."""
        self.simulation = self.construct("bench_matrix")
        self.advance(self.simulation, instructions=50_000)
        begun = {name: self.call("history.last_write", register=name) for name in self.REGISTERS}
        before = self.call("processor.read")["registers"]
        for count in (4_000_000, 10_000_000, 12_000_000):
            self.call("simulation.goto", instructions=count)
            if count == 10_000_000:
                self.call("history.keep")
        answers = {name: self.call("history.last_write", register=name) for name in self.REGISTERS}
        # Which registers the loops leave alone is the compiler's choice.
        kept = [name for name in self.REGISTERS if answers[name]["position"]["instructions"] < 50_000]
        self.assertLessEqual({"sp", "r11"} if is_firmware_of_the_pages() else {"sp"}, set(kept))
        self.assertGreater(len(kept), 1)
        now = self.call("processor.read")["registers"]
        for name in kept:
            self.assertEqual((answers[name], now[name]), (begun[name], before[name]), name)
        unused = "r12" if is_firmware_of_the_pages() else kept[-1]
        self.call("processor.write", register=unused, value=77)
        self.call("simulation.goto", instructions=16_000_000)
        answer = self.call("history.last_write", register=unused)
        self.assertEqual((answer["by"], answer["new"]), ("processor.write", 77))
        self.assertEqual(answer["position"]["instructions"], 12_000_000)

    def test_a_request_that_wrote(self):
        self.advance(self.simulation, seconds=0.01)
        self.call("memory.write", address=0x20300000, bytes=[7])
        wrote = self.where(self.simulation)["now"]
        self.advance(self.simulation, seconds=0.01)
        answer = self.call("history.last_write", address=0x20300000)
        self.assertEqual((answer["by"], answer["position"]), ("memory.write", wrote))
        self.assertEqual((answer["old"], answer["new"]), ([0, 0, 0, 0], [7, 0, 0, 0]))

    def test_the_last_change(self):
        self.advance(self.simulation, seconds=0.0123)
        self.call("pin.drive", gpio=1, pin=2, level=True)
        driven = self.where(self.simulation)["now"]
        self.advance(self.simulation, seconds=0.1)
        answer = self.call("history.last_change", name="GPIO1.DATA")
        self.assertEqual((answer["found"], answer["old"], answer["new"]), (True, 0, 4))
        self.assertLessEqual(abs(answer["position"]["time_ps"] - driven["time_ps"]), 1_000_000)
        self.advance(self.simulation, seconds=1)
        self.call("samples.read", columns=["a1"])
        answer = self.call("history.last_change", signal="a1")
        self.assertTrue(answer["found"])
        self.assertNotEqual(answer["old"], answer["new"])
        self.call("simulation.goto", sample=answer["position"]["samples"])
        self.assertEqual(self.call("coprocessor.read")["signals"]["a1"], answer["new"])

    def test_who_changed_a_register(self):
        """Whom it names is in front of the change: one instruction there has the old value, and after it the new."""
        self.advance(self.simulation, seconds=1.00003)
        here = self.look(self.simulation)
        kinds = set()
        for name in ("ADC.CTRL", "COPROCESSOR.CTRL", "UART0.BAUDDIV", "COPROCESSOR.FLAGS", "COPROCESSOR.SAMPLES"):
            with self.subTest(name=name):
                answer = self.call("history.last_change", name=name)
                self.assertTrue(answer["found"])
                self.assertEqual(self.look(self.simulation), here)
                kinds.add(answer["by"])
                self.call("simulation.goto", time_ps=answer["since"]["time_ps"])
                self.assertEqual(self.call("register.read", name=name)["value"], answer["old"])
                processor = self.call("processor.read")["registers"]
                if answer["by"] == "instruction":
                    self.assertEqual(processor["pc"], answer["pc"])
                    self.assertEqual(answer["accessed"].split(".")[0], name.split(".")[0])
                    self.advance(self.simulation, instructions=1)
                else:
                    self.assertEqual(answer["by"], "device")
                    self.call("simulation.goto", time_ps=answer["position"]["time_ps"])
                if name == "COPROCESSOR.SAMPLES":
                    self.assertEqual(answer["sample"], answer["position"]["samples"])
                self.assertEqual(self.call("register.read", name=name)["value"], answer["new"])
                self.call("simulation.goto", time_ps=here[0]["time_ps"])
        self.assertEqual(kinds, {"instruction", "device"})
        self.call("register.write", name="COPROCESSOR.LOCK_THRESHOLD", value=4711)
        self.advance(self.simulation, seconds=0.01)
        answer = self.call("history.last_change", name="COPROCESSOR.LOCK_THRESHOLD")
        self.assertEqual((answer["by"], answer["new"]), ("register.write", 4711))

    def test_a_register_that_a_read_changes(self):
        self.simulation = self.construct("echo")
        self.advance(self.simulation, seconds=0.001)
        self.call("uart.send", uart=0, bytes=[1, 0, 0, 0, 65])
        self.advance(self.simulation, seconds=0.004)
        answer = self.call("history.last_change", name="UART0.STATE.RXFULL", every_s=1e-6)
        self.assertEqual((answer["by"], answer["access"], answer["new"]), ("instruction", "read", 0))
        self.assertEqual(answer["accessed"], "UART0.DATA")

    def test_what_happened_between(self):
        """As reported by a simulation that goes forward."""
        kinds = ["exception", "sample", "uart", "pins"]
        self.call("events.subscribe", kinds=kinds)
        told = []
        for _ in range(5):
            told += self.advance(self.simulation, seconds=0.1)["events"]
        here = self.look(self.simulation)
        self.assertEqual({each["kind"] for each in told}, {"exception", "sample", "uart"})
        for one, other in ((0.0, None), (0.123, 0.234), (0.2, 0.2), (0.05, 0.4)):
            with self.subTest(one=one, other=other):
                between = {} if other is None else {"other": {"time_s": other}}
                answer = self.call("history.timeline", one={"time_s": one}, kinds=kinds, **between)
                begin, end = answer["one"]["time_s"], answer["other"]["time_s"]
                self.assertEqual(answer["events"], [each for each in told if begin < each["time_s"] <= end])
                self.assertEqual(self.look(self.simulation), here)
        every = self.call("history.timeline", one={"sample": 3}, other={"sample": 6})["events"]
        self.assertEqual([each["sample"] for each in every if each["kind"] == "sample"], [3, 4, 5])

    def test_the_difference(self):
        self.advance(self.simulation, seconds=0.5)
        one = self.look(self.simulation)[0]
        registers = self.call("processor.read")["registers"]
        self.advance(self.simulation, seconds=1)
        self.call("variable.write", name="results", value=5)
        now = self.call("processor.read")["registers"]
        answer = self.call("history.diff", one={"time_ps": one["time_ps"]})
        wanted = {name: [registers[name], now[name]] for name in now if registers[name] != now[name]}
        self.assertEqual(answer["processor"], wanted)
        self.assertEqual(answer["one"], one)
        names = [each["name"] or "" for each in answer["memory"]]
        self.assertTrue(any(name.startswith("results") for name in names), names)
        same = self.call("history.diff", one={"time_ps": one["time_ps"]}, other={"time_ps": one["time_ps"]})
        self.assertEqual((same["processor"], same["devices"], same["memory"]), ({}, {}, []))


if __name__ == "__main__":
    unittest.main()
