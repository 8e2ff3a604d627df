#!/usr/bin/env python3
"""What a debugger changes for the program (ITM, DHCSR), and LLDB as a client."""

import re
import subprocess
import tempfile
import unittest
from pathlib import Path

from gdb_test import DEBUGGEE, Run, gdb

from harness import CAPSOC, CLEAN, FIRMWARE

CTEST = {"name": "debuggers"}

VIEWER, PRESENCE = FIRMWARE / "viewer.elf", FIRMWARE / "presence.elf"
TEXT = "by itm\nABCCD\n"


def run(elf, *options):
    done = subprocess.run(
        [CAPSOC, "run", elf, *map(str, options)], capture_output=True, timeout=60, check=False, env=CLEAN
    )
    if done.returncode != 0:
        raise AssertionError(done.stderr.decode())
    return done.stdout.decode(), done.stderr.decode()


class Viewer(unittest.TestCase):
    """The ITM is enabled by who asks for its text, and stays so over a reset (C1.7, DEMCR.TRCENA)."""

    def said(self, trcena, tcr, ter):
        return 2 * f"trcena {trcena} tcr {tcr} ter {ter}\n"

    def test_nobody_asks(self):
        for options in ((), ("--itm", "null")):
            self.assertEqual(run(VIEWER, *options)[0], self.said(0, 0, 0))

    def test_the_option_asks(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "itm.txt"
            self.assertEqual(run(VIEWER, "--itm", f"file:{file}")[0], self.said(1, 1, 1))
            self.assertEqual(file.read_text(), 2 * TEXT)
            self.assertEqual(run(VIEWER, "--itm", f"file:{file}", "-C", "itm.port=3")[0], self.said(1, 1, 8))
            self.assertEqual(file.read_text(), 2 * "port three\n")
        _, log = run(VIEWER, "--itm", "log", "--log-level", "info")
        self.assertIn("itm: by itm", log)
        # Text and UART come by the same stream, in the order of time.
        both, _ = run(VIEWER, "--itm", "stdout")
        self.assertEqual(sorted(both.splitlines()), sorted((self.said(1, 1, 1) + 2 * TEXT).splitlines()))

    def test_every_executor(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "itm.txt"
            for options in (
                ["-C", "cpu.executor=stepping"],
                ["-C", "cpu.executor=blocks"],
                ["-C", "cpu.translate_after=1"],
                ["--quantum", 100],
            ):
                run(VIEWER, "--itm", f"file:{file}", *options)
                self.assertEqual(file.read_text(), 2 * TEXT, options)

    def test_gdb_asks(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "itm.txt"
            for options, script, expected, answer in (
                (["--itm", f"file:{file}"], "monitor itm port 0 off\ncontinue", (1, 1, 0), ""),
                (["--itm", f"file:{file}"], "monitor itm ports off\nmonitor itm port 0 on\ncontinue", (1, 1, 1), ""),
                (
                    ["--itm", f"file:{file}"],
                    "monitor itm port 3 on\ncontinue",
                    (1, 1, 9),
                    "only the text of port 0 is shown",
                ),
                (
                    [],
                    "monitor itm port 0 on\ncontinue",
                    (1, 1, 1),
                    "the text goes nowhere; start capsoc run with --itm stdout",
                ),
                ([], "monitor itm ports 1\ncontinue", (1, 1, 4294967295), "the text goes nowhere"),
                ([], "monitor itm port\ncontinue", (0, 0, 0), "itm: write itm port N on|off"),
            ):
                file.write_text("")
                with Run(VIEWER, "--halt", *options) as process:
                    said = gdb(process, script, elf=VIEWER)
                    code, out, _ = process.end()
                self.assertEqual((code, out.decode()), (0, self.said(*expected)), script)
                self.assertIn(answer, said)
                self.assertEqual("itm:" in said, answer != "", said)
                self.assertEqual(file.read_text(), 2 * TEXT if options and expected[2] & 1 else "", script)

    def test_a_restored_run_shows_the_text_that_is_asked_for_now(self):
        with tempfile.TemporaryDirectory() as folder:
            checkpoint, file = Path(folder) / "c.capsoc", Path(folder) / "itm.txt"
            for saved, restored in (([], [f"file:{file}"]), ([f"file:{file}"], [f"file:{file}"])):
                file.write_text("")
                # In the first of the two passes, after its text.
                run(VIEWER, *(["--itm", *saved] if saved else []), "--save", f"{checkpoint}@0.003")
                out, _ = run(VIEWER, "--restore", checkpoint, "--itm", *restored)
                self.assertIn("trcena 1 tcr 1 ter 1\n", out)
                self.assertIn(TEXT, file.read_text())


class Presence(unittest.TestCase):
    """DHCSR (C1.6.2)."""

    def test_without_a_debugger(self):
        for options in ((), ("--gdb", "0")):
            self.assertEqual(run(PRESENCE, *options)[0], "no debugger\n")

    def test_with_gdb_its_breakpoint_is_reached(self):
        with Run(PRESENCE, "--halt") as process:
            said = gdb(
                process, "x/wx 0xe000edf0\ncontinue\nx/i $pc\nset $pc += 2\nx/wx 0xe000edf0\ncontinue", elf=PRESENCE
            )
            code, out, _ = process.end()
        self.assertEqual((code, out), (0, b"a debugger is there\n"))
        self.assertRegex(said, r"bkpt\s+0x0001")
        # C_DEBUGEN, C_HALT, S_REGRDY and S_HALT, as a debugger reads it.
        self.assertEqual(len(re.findall(r"0xe000edf0:\s+0x00030003", said)), 2, said)

    def test_when_it_has_left_it_is_gone(self):
        with Run(PRESENCE, "--halt") as process:
            gdb(process, "stepi\ndetach", elf=PRESENCE)
            code, out, _ = process.end()
        self.assertEqual((code, out), (0, b"no debugger\n"))

    def test_the_results_without_one_are_those_without_the_option(self):
        def essence(*options):
            with tempfile.TemporaryDirectory() as folder:
                path = Path(folder) / "r.json"
                run(FIRMWARE / "hello.elf", *options, "--json", path)
                return re.findall(r'"(?:cycles|instructions)": \d+', path.read_text())

        self.assertEqual(essence(), essence("--gdb", "0"))


class Lldb(unittest.TestCase):
    """The commands of a session; LLDB prints no assertion, and what it prints is right."""

    SESSION = """register read
breakpoint set -n work
continue
bt
register read pc sp lr xpsr
frame variable
expr written
memory region 0x20000000
memory region 0x10000000
memory region 0xffffffff
memory read --size 4 --format x --count 4 0x40004000
memory write 0x20200000 1 2 3 4
memory read 0x20200000
thread step-inst
thread step-over
thread step-out
breakpoint delete -f
watchpoint set variable written
continue
expr written
watchpoint delete -f
breakpoint set -n SysTick_Handler
continue
expr ticks + 1
breakpoint delete -f
register write r0 99
register read r0
process plugin packet monitor help
process plugin packet send qC
settings set target.disable-aslr false
continue
"""

    def test_a_session(self):
        with Run(DEBUGGEE, "--halt") as process, tempfile.NamedTemporaryFile("w", suffix=".lldb") as file:
            file.write(f"gdb-remote 127.0.0.1:{process.port}\n{self.SESSION}")
            file.flush()
            done = subprocess.run(
                ["lldb", "--no-lldbinit", "-l", "none", "-b", "-s", file.name, DEBUGGEE],
                capture_output=True,
                timeout=120,
                check=False,
                stdin=subprocess.DEVNULL,
                env=CLEAN,
            )
            said = (done.stdout + done.stderr).decode()
            code, out, _ = process.end()
        self.assertEqual(done.returncode, 0, said)
        self.assertEqual((code, out.decode()), (0, "debuggee: right\n"))
        for word in ("Assertion", "error:", "LLVM", "backtrace leading"):
            self.assertNotIn(word, said)
        for pattern in (
            r"stop reason = breakpoint 1\.1",
            r"frame #1: 0x\w+ debuggee\.elf`main at debuggee\.c",
            r"\(volatile uint32_t\) \$0 = 0\n",
            r"\[0x0*20000000-0x0*20400000\) rwx",
            r"\[0x0*1010000-0x0*20000000\) ---",
            r"\[0x0*e0100000-0x0*100000000\) ---",
            r"0x20200000: 01 02 03 04 00",
            r"stop reason = step out",
            r"Watchpoint 1 hit:\nold value: 1\nnew value: 2\n",
            r"stop reason = watchpoint 1",
            r"\$1 = 2\n",
            r"stop reason = breakpoint 2\.1",
            r"r0 = 0x00000063",
            r"response: QC1",
            r"itm port N on",
            r"exited with status = 0",
        ):
            self.assertRegex(said, pattern)


if __name__ == "__main__":
    unittest.main()
