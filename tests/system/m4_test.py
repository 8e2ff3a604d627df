#!/usr/bin/env python3
"""The Cortex-M4 without FPU in place of the Cortex-M3 (`-C cpu.profile=m4`): whole programs, on QEMU's Cortex-M4, too,
and what else shows that it is another processor.
"""

import re
import unittest

import profile_case
from gdb_test import Packets, Run, gdb
from harness import CAPSOC, FIRMWARE, Case, output_of
from profile_case import ask, capsoc

CTEST = {"name": "m4", "timeout": 600}

CHOSEN = ("-C", "cpu.profile=m4")
HELLO = FIRMWARE / "hello_m4.elf"
DSP = FIRMWARE / "dsp_m4.elf"


class Programs(profile_case.Programs):
    CHOSEN = CHOSEN

    def test_qemus_cortex_m4_prints_the_same(self):
        theirs = output_of(
            *("qemu-system-arm", "-M", "mps2-an386", "-icount", "shift=5,sleep=off", "-display", "none"),
            *("-monitor", "none", "-serial", "stdio", "-semihosting-config", "enable=on,target=native"),
            *("-kernel", DSP),
        )
        instructions = set(re.findall(r"(?m)^([a-z].*[0-9a-z]) +[0-9a-f]{8}$", theirs))
        self.assertEqual(len(instructions), 97, "with their halves, exchanges and rounding")
        self.assertIn("handler 680f0000, stacked 290a0000, after 280a0000\n", theirs)
        self.assertEqual(self.everywhere("dsp_m4")[0], theirs)

    def test_hello(self):
        self.assertEqual(self.everywhere("hello_m4")[0], "hello from capsoc\n")

    def test_the_main_job_learns_what_it_learns_on_the_cortex_m3(self):
        out, result = self.everywhere("selfcal_m4")
        self.assertTrue(result["verdict"]["pass"], out)
        output_of(CAPSOC, "run", FIRMWARE / "selfcal.elf", "--json", self.folder / "m3.json")
        self.assertEqual(result["parameters"], self.result("m3.json")["parameters"])

    def test_it_has_every_instruction_of_the_cortex_m3_and_multiplies_in_less_time(self):
        results = []
        for options in ((), CHOSEN):
            out = output_of(CAPSOC, "run", FIRMWARE / "bench_matrix.elf", *options, "--json", self.folder / "r.json")
            results.append((out, self.result()["cpu"]))
        (out, m3), (same_out, m4) = results
        self.assertEqual(same_out, out)
        self.assertEqual(m4["instructions"], m3["instructions"])
        self.assertLess(m4["cycles"], m3["cycles"])

    def test_a_checkpoint_has_ge_and_belongs_to_its_processor(self):
        self.check_checkpoints(DSP, (0.25, 0.5, 0.75), other="m3")


class Differences(Case):
    """What a user notices."""

    def test_a_program_of_it_is_told_what_the_others_lack(self):
        for profile, said in (
            ("m3", r"\('sxtab r0, r1, r2' is of the DSP extension of Armv7-M; build with -mcpu=cortex-m3\)"),
            ("m0plus", r"\('[a-z.]+ .*' is of Armv7-M; build with -mcpu=cortex-m0plus\)"),
        ):
            done = capsoc("run", DSP, "-C", f"cpu.profile={profile}")
            self.assertEqual(done.returncode, 5, done.stderr)
            self.assertRegex(done.stderr.decode(), "UNDEFINSTR: undefined instruction " + said)

    def test_floating_point_ends_in_a_missing_coprocessor(self):
        done = capsoc("run", FIRMWARE / "no_fpu_m4.elf", *CHOSEN)
        self.assertEqual(done.returncode, 5, done.stderr)
        self.assertEqual(done.stdout, b"CPACR 00000000\n", "it cannot be enabled")
        self.assertIn(
            "NOCP: coprocessor instruction without a coprocessor (of an FPU, which the Cortex-M4 does not have; "
            "build with -mfloat-abi=soft, or run it with -C cpu.profile=m4f)",
            done.stderr.decode(),
        )

    def test_a_processor_that_there_is_not_is_refused(self):
        done = capsoc("run", HELLO, "-C", "cpu.profile=m7")
        self.check_refused(
            done.returncode,
            done.stdout,
            done.stderr.decode(),
            "cpu.profile cannot be 'm7'; choose one of m3, m0plus, m4, m4f",
        )

    def test_the_instruction_trace_shows_ge(self):
        trace = self.folder / "trace"
        done = capsoc("run", DSP, *CHOSEN, "--simlimit", 0.003, "--trace-instructions", trace)
        self.assertEqual(done.returncode, 124, done.stderr)
        self.assertRegex(trace.read_text(), r"msr apsr_nzcvqg, r\d+ .* xpsr=f80f0000")

    def test_translated_code_is_the_same_in_every_run(self):
        traces = []
        for name in ("1", "2"):
            trace = self.folder / name
            output_of(CAPSOC, "run", DSP, *CHOSEN, "-C", "cpu.translate_after=2", "--trace-translation", trace)
            traces.append(trace.read_text())
        self.assertIn("smladx", traces[0])
        self.assertEqual(traces[0], traces[1])


class Session(Case):
    """capsoc serve."""

    def test_registers_are_those_that_it_has(self):
        settings = {"firmware.elf": str(HELLO), "cpu.profile": "m4"}
        _, listed, value, about, _, read = ask(
            ("simulation.construct", {"settings": settings}),
            ("register.list", {"simulation": 1}),
            ("register.read", {"simulation": 1, "name": "SCB.CPUID"}),
            ("debugger.about", {"simulation": 1}),
            ("processor.write", {"simulation": 1, "register": "xpsr", "value": 0xFFFFFFFF}),
            ("processor.read", {"simulation": 1}),
        )
        peripherals = {each["name"]: [reg["name"] for reg in each["registers"]] for each in listed["peripherals"]}
        self.assertIn("ID_ISAR2", peripherals["SCB"])
        for present in ("MPU", "ITM", "DWT", "DCB"):
            self.assertIn(present, peripherals)
        self.assertEqual(value["value"], 0x410FC241)
        self.assertEqual(about["processor"], "cortex-m4")
        self.assertEqual(read["registers"]["xpsr"] & 0xFF0F0000, 0xFF0F0000)


class Debugger(Case):
    """GDB, with and without a history."""

    def test_gdb_sees_ge_and_the_registers_of_the_cortex_m3(self):
        for options in (CHOSEN, (*CHOSEN, "--gdb-history")):
            with Run(HELLO, "--halt", *options) as run, Packets(run) as packets:
                names = re.findall(r'reg name="(\w+)"', packets.ask("qXfer:features:read:target.xml:0,4000"))
                self.assertEqual(names[-6:], ["msp", "psp", "primask", "basepri", "faultmask", "control"], options)
                self.assertIn('name="cortex-m4"', packets.ask("qXfer:threads:read::0,4000"))
                self.assertEqual(packets.word(0xE000ED00), 0x410FC241)
            with Run(HELLO, "--halt", *options) as run:
                out = gdb(run, "set $xpsr = 0xffffffff\nprint /x $xpsr & 0xff0f0000\ndetach\n", HELLO)
                self.assertIn("$1 = 0xff0f0000", out, "bits of xPSR that there are")


if __name__ == "__main__":
    unittest.main()
