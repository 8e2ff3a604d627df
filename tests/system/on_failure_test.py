#!/usr/bin/env python3
"""`capsoc run --gdb-on-failure`: a run that fails waits for a debugger where it stands, with its past."""

import re
import signal
import subprocess
import time
import unittest

from harness import CAPSOC, CLEAN, Case, FIRMWARE

CTEST = {"name": "on failure", "timeout": 300}


class OnFailure(Case):
    def start(self, *arguments):
        process = subprocess.Popen(
            [CAPSOC, "run", *map(str, arguments), "--gdb-on-failure", "0"],
            cwd=self.folder,
            env=CLEAN,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        self.addCleanup(process.stdout.close)
        self.addCleanup(process.stderr.close)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        return process

    def until_it_waits(self, process):
        """What it says until then, and its port."""
        said = ""
        for line in process.stderr:
            said += line
            if found := re.match(r"gdb: listening on 127.0.0.1:(\d+), waiting for a debugger at the failure", line):
                return said, int(found[1])
        self.fail(said)

    def gdb(self, port, program, *commands):
        script = ["set pagination off", f"target remote :{port}", *commands]
        arguments = [part for command in script for part in ("-ex", command)]
        return subprocess.run(
            ["gdb-multiarch", "-q", "-nx", "-batch", *arguments, FIRMWARE / f"{program}.elf"],
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
        ).stdout

    def run_and_ask(self, program, *commands, options=()):
        process = self.start(FIRMWARE / f"{program}.elf", *options)
        said, port = self.until_it_waits(process)
        answered = self.gdb(port, program, *commands)
        rest = process.stderr.read()
        return said, answered, rest, process.wait(60)

    def test_a_crash(self):
        said, answered, rest, code = self.run_and_ask(
            "divzero", "reverse-stepi", "reverse-stepi", "backtrace", "print $r3", "kill"
        )
        self.assertIn("DIVBYZERO: division by zero", said)
        self.assertIn("exit 5: the firmware crashed: lockup", said)
        self.assertRegex(answered, r"#0 .* in main \(\) at .*divzero.c:10")
        self.assertIn("$1 = 0", answered)
        self.assertNotIn("DIVBYZERO", rest)  # the report was shown once
        self.assertEqual(code, 5)  # the debugger ended what had failed

    def test_a_program_that_says_it_failed(self):
        said, answered, _, code = self.run_and_ask(
            "failures",
            *("monitor when", "reverse-continue", "print $pc", "continue", "continue"),
            options=["-P", "failure=1"],
        )
        self.assertRegex(said, r"(?m)^exit \d+: ")
        self.assertIn("Reset_Handler", answered)
        self.assertEqual(code, int(re.search(r"(?m)^exit (\d+): ", said)[1]))

    def test_a_limit(self):
        said, answered, _, code = self.run_and_ask(
            "forever", "reverse-stepi", "stepi", "detach", options=["--simlimit", "0.001"]
        )
        self.assertIn("exit 124: the limit of 0.001 simulated s was hit", said)
        self.assertEqual(code, 124, answered)

    def test_what_passes_does_not_wait(self):
        process = self.start(FIRMWARE / "hello.elf")
        text, said = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 0, said)
        self.assertIn("hello from capsoc", text)
        self.assertNotIn("gdb:", said)

    def test_a_signal_ends_the_wait(self):
        process = self.start(FIRMWARE / "divzero.elf")
        self.until_it_waits(process)
        begin = time.monotonic()
        process.send_signal(signal.SIGTERM)
        self.assertEqual(process.wait(30), 128 + signal.SIGTERM)
        self.assertLess(time.monotonic() - begin, 10)

    def test_refusals(self):
        for options, sentence in (
            (["--gdb"], "--gdb-on-failure waits where the run fails: leave --gdb out"),
            (["--view"], "--gdb-on-failure waits where the run fails: leave --view out"),
            (["--trace-bus", "b"], "no history: trace.bus names a place"),
            (["--halt"], "--halt waits for a debugger; give --gdb PORT, too"),
        ):
            process = self.start(FIRMWARE / "hello.elf", *options)
            _, said = process.communicate(timeout=60)
            self.assertEqual(process.returncode, 2, said)
            self.assertIn(sentence, said)


if __name__ == "__main__":
    unittest.main()
