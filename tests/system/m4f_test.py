#!/usr/bin/env python3
"""The Cortex-M4 with FPU in place of the Cortex-M3 (`-C cpu.profile=m4f`): whole programs, on QEMU's Cortex-M4, too,
and what else shows that it is another processor.
"""

import json
import re
import unittest

import profile_case
from gdb_test import Packets, Run, gdb
from harness import CAPSOC, FIRMWARE, Case, output_of
from profile_case import ask, capsoc
from trace_test import read_callgrind

CTEST = {"name": "m4f", "timeout": 600}

CHOSEN = ("-C", "cpu.profile=m4f")
HELLO = FIRMWARE / "hello_m4f.elf"
FPU = FIRMWARE / "fpu_m4f.elf"
CONTEXT = FIRMWARE / "fpu_context_m4f.elf"


def on_qemu(program):
    return output_of(
        *("qemu-system-arm", "-M", "mps2-an386", "-icount", "shift=5,sleep=off", "-display", "none"),
        *("-monitor", "none", "-serial", "stdio", "-semihosting-config", "enable=on,target=native"),
        *("-kernel", program),
    )


class Programs(profile_case.Programs):
    CHOSEN = CHOSEN

    def test_qemus_cortex_m4_computes_the_same(self):
        theirs = on_qemu(FPU)
        hashes = re.findall(r"(?m)[0-9a-f]{8}$", theirs)
        self.assertEqual(len(hashes), 54, "instructions and short sequences")
        self.assertGreater(len(set(hashes)), 48, "few of them do the same")
        self.assertEqual(self.everywhere("fpu_m4f")[0], theirs)

    def test_qemus_cortex_m4_saves_the_same(self):
        theirs = on_qemu(CONTEXT)
        self.assertEqual(theirs.count(" differ 0,"), 6, theirs)
        self.assertIn("MemManage 1, CFSR 00000020, LSPACT 1\ninterrupted checksums that differ: 0\n", theirs)
        self.assertEqual(self.everywhere("fpu_context_m4f")[0], theirs)

    def test_hello(self):
        self.assertEqual(self.everywhere("hello_m4f")[0], "hello from capsoc\n")

    def test_the_main_job_learns_what_it_learns_on_the_cortex_m3(self):
        out, result = self.everywhere("selfcal_m4f")
        self.assertTrue(result["verdict"]["pass"], out)
        output_of(CAPSOC, "run", FIRMWARE / "selfcal.elf", "--json", self.folder / "m3.json")
        self.assertEqual(result["parameters"], self.result("m3.json")["parameters"])

    def test_qemus_cortex_m4_computes_the_same_as_translated_code(self):
        for kernel in ("float_matrix", "float_filter", "float_control"):
            with self.subTest(kernel):
                program = FIRMWARE / f"bench_{kernel}_m4f.elf"
                path = self.folder / "r.json"
                out = output_of(CAPSOC, "run", program, *CHOSEN, "--json", path)
                self.assertEqual(out, on_qemu(program))
                self.assertGreater(self.result("r.json")["translator"]["share"]["translator"], 0.99)

    def test_its_speed_is_measured_beside_qemus(self):
        path = self.folder / "b.json"
        kernel = FIRMWARE / "bench_float_control_m4f.elf"
        command = ("bench", "cpu", kernel, "--repeat", "1", "--json", path)
        output_of(CAPSOC, *command, "--profile", "m4f")
        rows = json.loads(path.read_text())["tables"][0]["rows"]
        self.assertEqual([row["verdict"] for row in rows if row["program"] == kernel.stem], ["good"])
        # The Cortex-M3 has no FPU, neither here nor in QEMU.
        self.assertEqual(capsoc(*command).returncode, 1)

    def test_an_integer_program_takes_the_time_of_the_cortex_m4(self):
        cpus = []
        for profile in ("m4", "m4f"):
            output_of(
                *(CAPSOC, "run", FIRMWARE / "dsp_m4.elf", "-C", f"cpu.profile={profile}"),
                *("--json", self.folder / "r.json"),
            )
            cpu = self.result()["cpu"]
            cpus.append((cpu["instructions"], cpu["cycles"]))
        self.assertEqual(cpus[0], cpus[1])

    def test_a_checkpoint_has_the_registers_and_belongs_to_its_processor(self):
        self.check_checkpoints(CONTEXT, (0.3, 0.6, 0.9), other="m4")


class Differences(Case):
    """What a user notices."""

    def test_a_program_of_it_is_told_what_the_others_lack(self):
        for profile, product in (("m3", "Cortex-M3"), ("m4", "Cortex-M4")):
            done = capsoc("run", FPU, "-C", f"cpu.profile={profile}")
            self.assertEqual(done.returncode, 5, done.stderr)
            self.assertIn(
                f"(of an FPU, which the {product} does not have; build with -mfloat-abi=soft, "
                "or run it with -C cpu.profile=m4f)",
                done.stderr.decode(),
            )

    def test_the_instruction_trace_shows_its_registers(self):
        trace = self.folder / "trace"
        done = capsoc("run", FPU, *CHOSEN, "--simlimit", 0.003, "--trace-instructions", trace)
        self.assertEqual(done.returncode, 124, done.stderr)
        text = trace.read_text()
        self.assertRegex(text, r"vmov s1, r1 .* s1=80000000")
        self.assertRegex(text, r"vmsr fpscr, r\d+ .* control=00000004")

    def test_traces_follow_frames_with_its_registers(self):
        """Threads continue where a return from such a frame leaves them: in their callers, and as the same threads."""
        profile, line = self.folder / "p.out", self.folder / "t.json"
        output_of(CAPSOC, "run", CONTEXT, *CHOSEN, "--profile", profile, "--timeline", line)
        own, calls = read_callgrind(profile.read_text())
        for pair, count in {
            ("show", "differences_after_call"): 6,
            ("show", "printf"): 6,
            ("[SysTick]", "tick"): 200,
            ("tick", "compute"): 200,
            ("[PendSV]", "switch_handler"): 100,
            ("Reset_Handler", "exit"): 1,
        }.items():
            self.assertEqual(calls[pair][0], count, pair)
        # All but the end of the run, and the handlers, is in main.
        handlers = sum(cycles for (caller, _), (_, cycles) in calls.items() if caller.startswith("["))
        whole = sum(own.values()) - own["instructions"]
        self.assertGreater(calls["Reset_Handler", "main"][1], 0.97 * (whole - handlers))
        events = json.loads(line.read_text())["traceEvents"]
        runs = [event["tid"] for event in events if event["name"] == "runs"]
        self.assertGreater(len(runs), 200)
        self.assertEqual(len(set(runs)), 1, "one thread, whatever interrupts it")

    def test_a_register_of_it_can_be_injected_into(self):
        for place in ("cpu.s3[30]", "cpu.fpscr[22]", "cpu.fpu.lspact[0]"):
            done = capsoc("run", HELLO, *CHOSEN, "--inject", f"flip {place} at 0.0001s")
            self.assertNotEqual(done.returncode, 2, done.stderr)
        refused = capsoc("run", HELLO, "-C", "cpu.profile=m4", "--inject", "flip cpu.s3[30] at 0.0001s")
        self.check_refused(refused.returncode, refused.stdout, refused.stderr.decode(), "s3")


class Session(Case):
    """capsoc serve."""

    def test_registers_are_those_that_it_has(self):
        settings = {"firmware.elf": str(HELLO), "cpu.profile": "m4f"}
        _, listed, value, about, _, _, read = ask(
            ("simulation.construct", {"settings": settings}),
            ("register.list", {"simulation": 1}),
            ("register.read", {"simulation": 1, "name": "FPU.MVFR0"}),
            ("debugger.about", {"simulation": 1}),
            ("processor.write", {"simulation": 1, "register": "s31", "value": 0x3F800000}),
            ("processor.write", {"simulation": 1, "register": "fpscr", "value": 0xFFFFFFFF}),
            ("processor.read", {"simulation": 1}),
        )
        peripherals = {each["name"]: [reg["name"] for reg in each["registers"]] for each in listed["peripherals"]}
        self.assertIn("CPACR", peripherals["SCB"])
        self.assertEqual(peripherals["FPU"], ["FPCCR", "FPCAR", "FPDSCR", "MVFR0", "MVFR1"])
        self.assertEqual(value["value"], 0x10110021)
        self.assertEqual(about["processor"], "cortex-m4f")
        self.assertEqual(read["registers"]["s31"], 0x3F800000)
        self.assertEqual(read["registers"]["fpscr"], 0xF7C0009F, "the bits that there are")


class Debugger(Case):
    """GDB, with and without a history."""

    def test_gdb_reads_and_writes_its_registers(self):
        for options in (CHOSEN, (*CHOSEN, "--gdb-history")):
            with Run(HELLO, "--halt", *options) as run, Packets(run) as packets:
                names = re.findall(r'reg name="(\w+)"', packets.ask("qXfer:features:read:target.xml:0,4000"))
                self.assertEqual(names[-17:], [*(f"d{n}" for n in range(16)), "fpscr"], options)
                self.assertIn('name="cortex-m4f"', packets.ask("qXfer:threads:read::0,4000"))
            with Run(HELLO, "--halt", *options) as run:
                commands = (
                    "set $s0 = 1.5\nset $s1 = -2\nset $fpscr = 0x400000\n"
                    "print $s0\nprint $s1\nprint /x $fpscr\nprint /x (long long)$d0\ninfo float\ndetach\n"
                )
                out = gdb(run, commands, HELLO)
                self.assertIn("$1 = 1.5\n", out)
                self.assertIn("$2 = -2\n", out)
                self.assertIn("$3 = 0x400000\n", out)

    def test_lldb_does_too(self):
        commands = (
            "register write d1 0x3f8000003fc00000\nregister write fpscr 0x400000\n"
            "breakpoint set -n main\ncontinue\nregister read d1 fpscr\ncontinue\n"
        )
        with Run(HELLO, "--halt", *CHOSEN) as run:
            script = self.folder / "commands.lldb"
            script.write_text(f"gdb-remote 127.0.0.1:{run.port}\n{commands}")
            said = output_of("lldb", "--no-lldbinit", "-l", "none", "-b", "-s", script, HELLO)
        self.assertRegex(said, r"stop reason = breakpoint 1\.1")
        self.assertRegex(said, r"d1 = 0x3f8000003fc00000\n +fpscr = 0x00400000\n")
        self.assertIn("exited with status = 0", said)


if __name__ == "__main__":
    unittest.main()
