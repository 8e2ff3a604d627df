#!/usr/bin/env python3
"""The Cortex-M0+ in place of the Cortex-M3 (`-C cpu.profile=m0plus`): whole programs, on QEMU's Cortex-M0 too, and what
else shows that it is another processor.
"""

import re
import unittest

import profile_case
from gdb_test import Packets, Run, gdb
from harness import CAPSOC, FIRMWARE, Case, output_of
from profile_case import ask, capsoc

CTEST = {"name": "m0plus", "timeout": 600}

CHOSEN = ("-C", "cpu.profile=m0plus")
HELLO = FIRMWARE / "hello_m0plus.elf"


class Programs(profile_case.Programs):
    CHOSEN = CHOSEN

    def test_qemus_cortex_m0_prints_the_same(self):
        theirs = output_of(
            *("qemu-system-arm", "-M", "microbit", "-display", "none", "-monitor", "none", "-serial", "none"),
            *("-chardev", "stdio,id=console"),
            *("-semihosting-config", "enable=on,target=native,chardev=console"),
            *("-kernel", FIRMWARE / "armv6m.elf"),
        )
        self.assertIn("udiv 00000001\n", theirs)
        self.assertIn("levels 02s,.1p3\n", theirs)
        self.assertEqual(self.everywhere("armv6m", "--semihosting-console", "stdout")[0], theirs)

    def test_hello(self):
        self.assertEqual(self.everywhere("hello_m0plus")[0], "hello from capsoc\n")

    def test_the_main_job_learns_what_it_learns_on_the_cortex_m3(self):
        out, result = self.everywhere("selfcal_m0plus")
        self.assertTrue(result["verdict"]["pass"], out)
        output_of(CAPSOC, "run", FIRMWARE / "selfcal.elf", "--json", self.folder / "m3.json")
        of_m3 = self.result("m3.json")
        self.assertEqual(result["parameters"], of_m3["parameters"])
        self.assertGreater(result["cpu"]["instructions"], of_m3["cpu"]["instructions"], "no IT, no division")

    def test_the_cortex_m3_has_every_instruction_of_it(self):
        self.assertEqual(output_of(CAPSOC, "run", HELLO), "hello from capsoc\n")


class Differences(Case):
    """What a user notices."""

    def test_a_program_of_the_cortex_m3_is_told_what_is_missing(self):
        done = capsoc("run", FIRMWARE / "divzero.elf", *CHOSEN)
        said = done.stderr.decode()
        self.assertEqual(done.returncode, 5, said)
        self.assertIn("fault report: HardFault (exception 3", said)
        self.assertRegex(
            said, r"UNDEFINSTR: undefined instruction \('[a-z.]+ .*' is of Armv7-M; build with -mcpu=cortex-m0plus\)"
        )
        for word in ("CFSR", "HFSR", "MMFAR", "BFAR", "SHCSR", "FORCED"):
            self.assertNotIn(word, said)

    def test_settings_that_it_has_no_use_for(self):
        for options, words in (
            (("-C", "cpu.priority_bits=3"), ("cpu.priority_bits", "Cortex-M0+", "2 bits")),
            (("--itm", "stdout"), ("--itm", "Cortex-M0+", "no ITM")),
            (("--inject", "flip cpu.basepri[5] at 0.001s"), ("basepri",)),
        ):
            done = capsoc("run", HELLO, *CHOSEN, *options)
            self.check_refused(done.returncode, done.stdout, done.stderr.decode(), *words)
        done = capsoc("run", HELLO, "-C", "cpu.profile=m7")
        self.check_refused(
            done.returncode, done.stdout, done.stderr.decode(), "cpu.profile", "m3", "m0plus", "m4", "m4f"
        )

    def test_a_checkpoint_belongs_to_its_processor(self):
        whole = output_of(CAPSOC, "run", HELLO, *CHOSEN, "--json", self.folder / "whole.json")
        saved = self.folder / "saved"
        done = capsoc("run", HELLO, *CHOSEN, "--save", f"{saved}@0.0005")
        self.assertEqual((done.returncode, done.stdout.decode()), (0, whole), done.stderr)
        refused = capsoc("run", HELLO, "--restore", saved)
        self.check_refused(
            refused.returncode,
            refused.stdout,
            refused.stderr.decode(),
            "was saved with another cpu.profile (m0plus, here m3); give the same as then",
        )
        done = capsoc("run", HELLO, *CHOSEN, "--restore", saved, "--json", self.folder / "rest.json")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.result("rest.json")["cpu"]["cycles"], self.result("whole.json")["cpu"]["cycles"])

    def test_dropped_priority_bits_are_not_the_boards_three(self):
        done = capsoc("run", FIRMWARE / "armv6m.elf", *CHOSEN)
        said = [line for line in done.stderr.decode().splitlines() if "priority bits" in line]
        self.assertEqual(len(said), 1, said)
        self.assertIn("the Cortex-M0+ has 2 priority bits, the rest is dropped (pc", said[0])


class Session(Case):
    """capsoc serve."""

    def test_registers_are_those_that_it_has(self):
        settings = {"firmware.elf": str(HELLO), "cpu.profile": "m0plus"}
        _, read, refused, listed, value, about = ask(
            ("simulation.construct", {"settings": settings}),
            ("processor.read", {"simulation": 1}),
            ("processor.write", {"simulation": 1, "register": "basepri", "value": 32}),
            ("register.list", {"simulation": 1}),
            ("register.read", {"simulation": 1, "name": "SCB.CCR"}),
            ("debugger.about", {"simulation": 1}),
        )
        self.assertIn("primask", read["registers"])
        self.assertNotIn("faultmask", read["registers"])
        self.assertIn("no register 'basepri'", refused)
        peripherals = {each["name"]: [reg["name"] for reg in each["registers"]] for each in listed["peripherals"]}
        for absent in ("MPU", "ITM", "DWT", "DCB"):
            self.assertNotIn(absent, peripherals)
        self.assertIn("SHPR3", peripherals["SCB"])
        self.assertNotIn("CFSR", peripherals["SCB"])
        self.assertEqual(value["value"], 0x208)
        self.assertEqual(about["processor"], "cortex-m0plus")


class Debugger(Case):
    """GDB, with and without a history."""

    OPTIONS = (CHOSEN, (*CHOSEN, "--gdb-history"))

    def test_the_description_has_what_there_is(self):
        for options in self.OPTIONS:
            with Run(HELLO, "--halt", *options) as run, Packets(run) as packets:
                xml = packets.ask("qXfer:features:read:target.xml:0,4000")
                names = re.findall(r'reg name="(\w+)"', xml)
                self.assertEqual(names[-5:], ["xpsr", "msp", "psp", "primask", "control"], options)
                self.assertIn('name="cortex-m0plus"', packets.ask("qXfer:threads:read::0,4000"))
                self.assertNotIn('start="0x22000000"', packets.ask("qXfer:memory-map:read::0,4000"))
                self.assertEqual(packets.word(0xE000ED00), 0x410CC601)

    def test_gdb_reads_and_writes_its_registers(self):
        for options in self.OPTIONS:
            with Run(HELLO, "--halt", *options) as run:
                out = gdb(
                    run,
                    "break main\ncontinue\ninfo registers primask control xpsr\nset $primask = 1\nprint $primask\n"
                    "set $r0 = 0x12345678\nprint /x $r0\nprint $basepri\nset $xpsr = 0xffffffff\nprint /x $xpsr\n"
                    "detach\n",
                    HELLO,
                )
                self.assertIn("Breakpoint 1, main", out)
                self.assertRegex(out, r"\$1 = 1\n")
                self.assertIn("$2 = 0x12345678", out)
                self.assertIn("$3 = void", out, "no such register")
                self.assertIn("$4 = 0xf1000000", out, "bits of xPSR that there are")


if __name__ == "__main__":
    unittest.main()
