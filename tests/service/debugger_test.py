#!/usr/bin/python3
"""A debugger's steps, points and their way back, compared with a run that is stepped forward from the start.

The oracle knows the program counter in front of each instruction and which instruction a watchpoint stops after, and
from these alone where each move has to end. CAPSOC_REVERSE_MOVES asks for longer walks.
"""

import os
import random
import unittest

from history_test import SHORT, Past
from protocol_test import Refused

CTEST = {"name": "service: debugger", "timeout": 900, "interpreter": "/usr/bin/python3"}

SEED = int(os.environ.get("CAPSOC_REVERSE_SEED", "20261127"))
MOVES = int(os.environ.get("CAPSOC_REVERSE_MOVES", "30"))


class Debugged(Past):
    def resume(self, kind="run", points=(), **more):
        answer = self.call("debugger.resume", kind=kind, points=list(points), **more)
        self.stopped = answer["reason"]
        return answer

    def reverse(self, kind="run", points=()):
        return self.call("debugger.reverse", kind=kind, points=list(points))

    def count(self):
        return self.where(self.simulation)["now"]["instructions"]


class Reverse(Debugged):
    def hits(self, program, first, last, points, limit, **settings):
        """By the number of an instruction up to the last: the watchpoints that stop after it, each found by itself."""
        found = {}
        for number, point in enumerate(points):
            self.simulation = self.construct(program, history_mb=0, **settings)
            self.advance(self.simulation, instructions=first)
            while self.resume(points=[point, limit])["reason"] != "over" and self.count() <= last:
                if self.stopped == "watchpoint":
                    found.setdefault(self.count(), set()).add(number)
            self.session("simulation.close", simulation=self.simulation)
        return found

    def stepped(self, first, length):
        """By number of instruction, program counter and state; and data that the stack and other pointers lead to."""
        pcs, states, places = {}, {}, set()
        while (now := self.count()) <= first + length:
            registers = self.call("processor.read")["registers"]
            pcs[now], states[now] = registers["pc"], self.look(self.simulation)
            places |= {at & ~3 for at in registers.values() if 0x20000000 <= at < 0x20400000}
            self.resume("step")
        return pcs, states, places

    def walk(self, program, first, length, moves=MOVES, **settings):
        """Between the instructions `first` and `first + length`, with points in data and in the code."""
        draw = random.Random(f"{SEED} {program} {settings}")
        # What happens: stepped, and each watchpoint by itself.
        self.simulation = self.construct(program, history_mb=0, **settings)
        self.advance(self.simulation, instructions=first)
        pcs, states, places = self.stepped(first, length)
        while len(set(pcs.values())) < 20:  # a loop that waits; where it is depends on the compiler
            first = self.count()
            pcs, states, places = self.stepped(first, length)
        limit = {"kind": "breakpoint", "address": pcs[first + length]}
        # Which of them are written or read depends on the compiler.
        for _ in range(8):
            watched = draw.sample(sorted(places), min(4, len(places)))
            points = [{"kind": draw.choice(["write", "access", "read"]), "address": at, "size": 4} for at in watched]
            if hits := self.hits(program, first, first + length, points, limit, **settings):
                break

        self.simulation = self.construct(program, **settings)
        self.advance(self.simulation, instructions=first)
        self.call("history.keep")
        self.session("simulation.goto", simulation=self.simulation, instructions=first + length)
        here = first + length
        ways = {"back": 0, "on": 0}
        for move in range(moves):
            chosen = draw.sample(range(len(points)), draw.randrange(len(points) + 1))
            stops = set(draw.sample(sorted(set(pcs.values())), draw.randrange(3)))
            asked = [{"kind": "breakpoint", "address": pc} for pc in stops] + [points[i] for i in chosen]
            kind = draw.choice(["back", "back", "on", "step", "step back"])
            with self.subTest(program=program, seed=SEED, move=move, kind=kind, here=here, **settings):
                if kind in ("back", "step back"):
                    found = [n for n, of in hits.items() if of & set(chosen) and first < n < here]
                    found += [n for n, pc in pcs.items() if pc in stops and n < here]
                    wanted = here - 1 if kind == "step back" else max(found, default=None)
                    if wanted is None or wanted < first:
                        continue
                    answer = self.reverse("step" if kind == "step back" else "run", asked)
                elif here == first + length:
                    continue
                elif kind == "step":
                    wanted, answer = here + 1, self.resume("step", asked)
                else:
                    found = [n for n, of in hits.items() if of & set(chosen) and here < n]
                    found += [n for n, pc in pcs.items() if pc in stops and n > here]
                    wanted, answer = min(found, default=first + length), self.resume("run", asked)
                    if not found:
                        self.assertEqual(answer["reason"], "end")
                ways["back" if "back" in kind else "on"] += 1
                self.assertEqual(self.count(), wanted, answer["reason"])
                self.assertEqual(self.look(self.simulation), states[wanted])
                here = wanted
        self.assertGreater(min(ways.values()), moves // 8)
        self.assertGreater(len(hits), 0)
        self.session("simulation.close", simulation=self.simulation)

    def test_the_main_job(self):
        self.walk("selfcal", 99_500, 400, **SHORT)

    def test_interrupts(self):
        self.walk("drivers", 12_000, 400)

    def test_the_rtl(self):
        settings = {"coprocessor.backend": "rtl", **SHORT}
        self.walk("selfcal", 99_500, 200, moves=MOVES // 2, **settings)

    def test_executors(self):
        for executor in ("blocks", "stepping"):
            self.walk("hello", 2_560, 150, moves=MOVES // 2, **{"cpu.executor": executor})


class Ends(Debugged):
    def test_the_beginning_and_the_end(self):
        self.simulation = self.construct("hello")
        self.advance(self.simulation, address="main")
        for _ in range(5):
            self.resume("step")
        end = self.look(self.simulation)
        self.assertEqual(self.reverse()["reason"], "beginning")
        self.assertEqual(self.count(), 0)
        self.assertEqual(self.reverse("step")["reason"], "beginning")
        self.assertEqual(self.resume("run")["reason"], "end")
        self.assertEqual(self.look(self.simulation), end)
        self.assertEqual(self.resume("run")["reason"], "over")

    def test_a_bkpt_stops_in_front_of_itself_while_one_is_attached(self):
        self.simulation = self.construct("presence")
        self.call("debugger.attach", attached=True)
        answer = self.resume("run")
        at = answer["state"]["pc"]
        self.assertEqual(answer["reason"], "bkpt")
        self.call("memory.read", address=at, size=2)
        self.assertEqual(self.session.data, [b"\x01\xbe"])
        stands = self.look(self.simulation)
        for again in (self.resume("run"), self.advance(self.simulation, seconds=1)):
            self.assertEqual((again["reason"], self.look(self.simulation)), ("bkpt", stands))
        self.call("processor.write", register="pc", value=at + 2)
        self.resume("step")
        after = self.look(self.simulation)
        self.assertEqual(self.reverse()["reason"], "bkpt")
        self.session("simulation.goto", simulation=self.simulation, instructions=after[0]["instructions"])
        self.assertEqual(self.look(self.simulation), after)

    def test_a_reset_is_an_input(self):
        self.simulation = self.construct("hello")
        self.advance(self.simulation, instructions=100)
        first = self.where(self.simulation, hash=True)["sha256"]
        self.call("processor.reset")
        self.advance(self.simulation, instructions=50)
        end = self.look(self.simulation)
        self.assertEqual(self.reverse("step")["reason"], "step")
        self.resume("step")
        self.assertEqual(self.look(self.simulation), end)
        self.assertNotEqual(first, end[1])

    def test_what_is_refused(self):
        self.simulation = self.construct("hello")
        for method, params in (
            ("debugger.resume", {"kind": "walk"}),
            ("debugger.resume", {"kind": "range"}),
            ("debugger.resume", {"kind": "run", "points": [{"kind": "write"}]}),
            ("debugger.resume", {"kind": "run", "points": [{"kind": "write", "address": 0, "size": 0}]}),
            ("debugger.resume", {"kind": "run", "points": [5]}),
            ("debugger.resume", {"kind": "run", "points": {"kind": "write"}}),
            ("debugger.resume", {"kind": "run", "points": 5}),
            ("debugger.reverse", {"kind": "run", "points": 5}),
            ("debugger.reverse", {"kind": "range"}),
            ("debugger.reverse", {"kind": "run", "points": [{"kind": "jump", "address": 0}]}),
        ):
            with self.subTest(method=method, params=params), self.assertRaises(Refused) as refused:
                self.call(method, **params)
            self.assertNotIn("internal", str(refused.exception))
        self.assertEqual(self.count(), 0)


if __name__ == "__main__":
    unittest.main()
