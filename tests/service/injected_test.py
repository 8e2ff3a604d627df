#!/usr/bin/python3
"""Faults that a session injects on the way: what `capsoc run --inject` does, in every past and every replay."""

import json
import subprocess
import unittest

from harness import CAPSOC, CLEAN, FIRMWARE, without_host_times
from history_test import SHORT as PROGRAM, Past
from protocol_test import Driven, Refused

CTEST = {"name": "service: injected", "timeout": 300, "interpreter": "/usr/bin/python3"}

#: A lost interrupt is the end of the program's progress.
SHORT = {**PROGRAM, "run.simlimit_s": "2.3"}
LASTING = "freeze sin at 1.2s for 0.3s"
ONES = (
    "flip coprocessor.cv[39] at 1.1s",
    "lose write COPROCESSOR.FLAGS at 1.15s",
    LASTING,
    "lose irq coprocessor at sample 400",
    "flip cpu.r11[3] at 1.7s",
)


#: ARM DDI 0403, B3: register and bit of what a place of the processor's system blocks is the state of.
REGISTERS = {
    "nvic.enabled": (0xE000E100, 0),
    "nvic.pending": (0xE000E200, 0),
    "nvic.active": (0xE000E300, 0),
    "systick.enable": (0xE000E010, 0),
    "systick.tickint": (0xE000E010, 1),
    "systick.clksource": (0xE000E010, 2),
    "systick.reload": (0xE000E014, 0),
    "scb.actlr": (0xE000E008, 0),
    "scb.pending.nmi": (0xE000ED04, 31),
    "scb.pending.pendsv": (0xE000ED04, 28),
    "scb.pending.systick": (0xE000ED04, 26),
    "scb.vtor": (0xE000ED08, 7),
    "scb.prigroup": (0xE000ED0C, 8),
    "scb.sleeponexit": (0xE000ED10, 1),
    "scb.sleepdeep": (0xE000ED10, 2),
    "scb.sevonpend": (0xE000ED10, 4),
    "scb.nonbasethrdena": (0xE000ED14, 0),
    "scb.usersetmpend": (0xE000ED14, 1),
    "scb.unalign_trp": (0xE000ED14, 3),
    "scb.div_0_trp": (0xE000ED14, 4),
    "scb.bfhfnmign": (0xE000ED14, 8),
    "scb.stkalign": (0xE000ED14, 9),
    "scb.active.memmanage": (0xE000ED24, 0),
    "scb.active.busfault": (0xE000ED24, 1),
    "scb.active.usagefault": (0xE000ED24, 3),
    "scb.active.svcall": (0xE000ED24, 7),
    "scb.active.debugmonitor": (0xE000ED24, 8),
    "scb.active.pendsv": (0xE000ED24, 10),
    "scb.active.systick": (0xE000ED24, 11),
    "scb.pending.usagefault": (0xE000ED24, 12),
    "scb.pending.memmanage": (0xE000ED24, 13),
    "scb.pending.busfault": (0xE000ED24, 14),
    "scb.pending.svcall": (0xE000ED24, 15),
    "scb.memfaultena": (0xE000ED24, 16),
    "scb.busfaultena": (0xE000ED24, 17),
    "scb.usgfaultena": (0xE000ED24, 18),
    "scb.pending.debugmonitor": (0xE000EDFC, 17),
    "mpu.ctrl": (0xE000ED94, 0),
    "mpu.rnr": (0xE000ED98, 0),
    "mpu.rbar": (0xE000ED9C, 5),
    "mpu.enable": (0xE000EDA0, 0),
    "mpu.size": (0xE000EDA0, 1),
    "mpu.srd": (0xE000EDA0, 8),
    "mpu.tex_s_c_b": (0xE000EDA0, 16),
    "mpu.ap": (0xE000EDA0, 24),
    "mpu.xn": (0xE000EDA0, 28),
}
#: Bytes of SHPR, by the exception's number.
SYSTEM_PRIORITIES = {"memmanage": 4, "busfault": 5, "usagefault": 6, "svcall": 11, "debugmonitor": 12, "pendsv": 14}
SYSTEM_PRIORITIES["systick"] = 15
#: No register shows them.
HIDDEN = {"scb.pending.hardfault", "scb.active.hardfault", "scb.active.nmi"}
#: Nor does a program of Armv6-M see these: it has no NVIC_IABR and no SHCSR.
HIDDEN_ARMV6M = {"nvic.active", "scb.pending.svcall", "scb.active.svcall", "scb.active.pendsv", "scb.active.systick"}


class SystemBlocks(Driven):
    """Places of the processor's NVIC, SysTick, SCB and MPU: a program reads the changed bit, and no other."""

    def register_of(self, place, priority_bits):
        """Address and lowest bit, and the region that has to be selected."""
        block, *words = place.split(".")
        if block == "mpu" and len(words) == 2:
            return (*REGISTERS[f"mpu.{words[1]}"], int(words[0]))
        if words[0] == "priority":
            first = 0xE000E400 + int(words[1]) if block == "nvic" else 0xE000ED14 + SYSTEM_PRIORITIES[words[1]]
            return first & ~3, 8 * (first & 3) + 8 - priority_bits, None
        if place == "scb.vtor" and priority_bits == 2:
            return 0xE000ED08, 8, None  # of the Cortex-M0+
        return (*REGISTERS[place], None)

    def places(self, *options):
        listed = subprocess.run(
            [CAPSOC, "run", *options, "--list-fault-places"], env=CLEAN, check=True, capture_output=True, timeout=60
        )
        all_places = json.loads(listed.stdout)["places"]
        return [
            (each["place"][4:], each["bits"])
            for each in all_places
            if each["unit"] in ("nvic", "systick", "scb", "mpu")
        ]

    def check_each(self, places, hidden, priority_bits, **settings):
        simulation = self.construct("selfcal", **settings)
        self.advance(simulation, seconds=0.5)
        for place, bits in places:
            if place in hidden:
                continue
            address, low, region = self.register_of(place, priority_bits)
            for bit in range(bits):
                with self.subTest(place=place, bit=bit):
                    if region is not None:
                        self.write(simulation, 0xE000ED98, region)
                    before = self.word(simulation, address)
                    for changed in (1 << (low + bit), 0):
                        self.session("fault.inject", simulation=simulation, fault=f"flip cpu.{place}[{bit}]")
                        self.assertEqual(self.word(simulation, address) ^ before, changed)

    def word(self, simulation, address):
        self.session("memory.read", simulation=simulation, address=address, size=4)
        word = int.from_bytes(self.session.data[0], "little")
        return word & 0xFE000000 if address == 0xE000ED04 else word  # ICSR: without what follows from its bits

    def write(self, simulation, address, word):
        self.session("memory.write", simulation=simulation, address=address, bytes=list(word.to_bytes(4, "little")))

    def test_of_the_cortex_m3(self):
        places = self.places()
        self.assertEqual({name.split(".")[0] for name, _ in places}, {"nvic", "systick", "scb", "mpu"})
        self.assertGreater(sum(bits for _, bits in places), 700)
        self.check_each(places, HIDDEN, 3)

    def test_of_the_cortex_m0plus(self):
        places = self.places("-C", "cpu.profile=m0plus")
        names = {name for name, _ in places}
        self.assertEqual({name.split(".")[0] for name in names}, {"nvic", "systick", "scb"})
        self.assertFalse(names & {"scb.prigroup", "scb.active.memmanage", "scb.stkalign", "scb.priority.usagefault"})
        self.check_each(places, HIDDEN | HIDDEN_ARMV6M, 2, **{"cpu.profile": "m0plus"})


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
        self.assertEqual([fault["applied"] for fault in run["faults"]], [True] * len(ONES))
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
        self.assertIn(f"{len(ONES)} inputs".encode(), done.stderr)

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
