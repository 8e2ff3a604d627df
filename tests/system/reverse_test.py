#!/usr/bin/env python3
"""`capsoc run --gdb --gdb-history` with gdb-multiarch: who did that?"""

import re
import unittest

import gdb_test
from gdb_test import Run, gdb
from harness import FIRMWARE, SOURCE, is_firmware_of_the_pages

CTEST = {"name": "reverse", "timeout": 600}

#: 0.0005 s; with the code of another compiler the end of the instruction that is under way then.
INSTANT = r"0\.0005" if is_firmware_of_the_pages() else r"0\.0005\d*"

OVERWRITTEN = FIRMWARE / "overwritten.elf"


def line_of(mark):
    """The number of the line of the program that ends with a comment."""
    lines = (SOURCE / "firmware/tests/overwritten.c").read_text().splitlines()
    return next(number for number, line in enumerate(lines, 1) if line.endswith(f"// {mark}"))


class Questions(unittest.TestCase):
    def ask(self, script, *options):
        with Run(OVERWRITTEN, "--halt", "--gdb-history", *options) as debugged:
            out = gdb(debugged, script + "\nkill\n", OVERWRITTEN)
            self.assertEqual(debugged.end()[::2][0], 0)
        return out

    def at(self, mark):
        return f"overwritten.c:{line_of(mark)}"

    def test_who_has_overwritten_the_return_address(self):
        """In four commands after the crash."""
        out = self.ask(
            """
continue
watch -location *(unsigned*)($sp + 28)
reverse-continue
backtrace
print/x *(unsigned*)0x2000ffe4
"""
        )
        self.assertIn("SIGSEGV", out)
        trace = out[out.index("#0") :]
        self.assertRegex(trace.splitlines()[0], rf"in copy \(.*{self.at('too far')}$")
        self.assertRegex(trace.splitlines()[1], r"in parse \(length=20\)")
        # Three of the four bytes are there already.
        self.assertIn("$1 = 0xefeeed", out)

    def test_the_interrupt_that_changed_a_variable(self):
        out = self.ask(
            """
break parse
continue
delete
monitor last-write shared
watch shared if $lr == 0xfffffff9
reverse-continue
info line
backtrace
"""
        )
        self.assertRegex(out, rf"97080000 -> 98080000: .*main.*{self.at('by the loop')}")
        trace = out[out.index("#0") :]
        self.assertRegex(trace.splitlines()[0], rf"SysTick_Handler \(\).*{self.at('by the interrupt')}")
        self.assertIn("main ()", trace)
        change = re.search(r"Old value = (\d+)\nNew value = (\d+)", out)
        self.assertEqual(int(change[1]) - int(change[2]), 100)

    def test_to_the_beginning_and_back_to_the_end(self):
        out = self.ask(
            """
break parse
continue
delete
print $end = $pc
reverse-continue
print $pc
continue
print $pc == $end
reverse-finish
reverse-stepi
stepi
print $pc
"""
        )
        said = r"No more reverse-execution history\.|Reached end of recorded history; stopping\."  # GDB 13 and 16
        self.assertEqual(len(re.findall(said, out)), 2)
        self.assertRegex(out, r"\$2 = .* <Reset_Handler>")
        self.assertIn("$3 = 1", out)
        self.assertIn(self.at("the call"), out)

    def test_another_future(self):
        """What is written in the past begins it; what was said is said once."""
        with Run(OVERWRITTEN, "--halt", "--gdb-history") as debugged:
            out = gdb(
                debugged,
                """
break parse
continue
monitor goto 0.0005s
maintenance flush register-cache
monitor when
set var shared = 7
monitor when
continue
print shared
reverse-continue
delete
detach
""",
                OVERWRITTEN,
            )
            _, text, _ = debugged.end()
        until = re.search(r"a new history begins here; history 1 is kept, until ([0-9.]+) s", out)[1]
        self.assertGreater(float(until), 0.0005)
        if is_firmware_of_the_pages():
            self.assertEqual(until, "0.00113184")
        ends = re.findall(r"^end: +([0-9.]+) s", out, re.MULTILINE)
        self.assertRegex(" ".join(ends), f"^{re.escape(until)} {INSTANT}$")
        value = int(re.search(r"\$1 = (\d+)", out)[1])
        self.assertLess(value, 2200)
        self.assertGreater(value, 7)
        # What other futures said, too: the text from 0.0005 s on, and that of the run from its beginning.
        again = b"re" if is_firmware_of_the_pages() else rb"\w*e"
        self.assertRegex(text, rb"^before\n" + again + rb"\nbefore\n\Z")

    def test_histories(self):
        """What was left is simulated again, and GDB sees at once where the processor is."""
        out = self.ask(
            """
source scripts/debugger/history.gdb
break parse
continue
delete
printf "at %#x, %d\\n", $pc, shared
monitor goto 0.0005s
printf "at %#x, %d\\n", $pc, shared
backtrace
set var shared = 7
stepi
printf "at %#x, %d\\n", $pc, shared
monitor history
monitor history 1
printf "at %#x, %d\\n", $pc, shared
backtrace
monitor history
monitor history 2
printf "at %#x, %d\\n", $pc, shared
monitor history 3
monitor history x
"""
        )
        first, then, changed, again, second = re.findall(r"^at (0x\w+, \d+)", out, re.MULTILINE)
        self.assertEqual(first, again)
        self.assertNotEqual(first.split(",")[0], then.split(",")[0])
        self.assertEqual(changed, second)
        self.assertEqual(changed.split(", ")[1], "7")
        self.assertRegex(out, r"#0 +parse .*\n#1 .*main")
        position = r"[0-9.]+ s, instruction \d+, cycle \d+, sample \d+"
        self.assertRegex(
            out,
            rf"  1: 1 inputs, until {position}; the present one until {INSTANT} s,.*\n"
            rf"\* 2: 2 inputs, until {position}\n",
        )
        self.assertRegex(out, rf"\* 1: 1 inputs, .*\n  2: 2 inputs, .*; the present one until {INSTANT} s,")
        self.assertIn("there is no history 3; history.list has those that are kept", out)
        self.assertIn("history: write the number of one, or nothing", out)

    def test_the_monitor(self):
        out = self.ask(
            """
break parse
continue
monitor diff 0.0005 #17290
monitor last-change UART0.STATE
monitor who-set UART0.CTRL.TXEN
monitor timeline #0
monitor timeline
monitor who-set
monitor last-write 0x2000ffe4 4
monitor last-write $r3
monitor goto nowhere
monitor goto #nothing
monitor goto sample
monitor last-write
monitor last-write nothing_there
monitor last-change NOTHING.AT
monitor diff
monitor record
monitor itm port 0 on
monitor help
"""
        )
        last = "2200" if is_firmware_of_the_pages() else r"\d+"
        self.assertRegex(out, rf"shared: \d+ -> {last}\n")
        self.assertIn("at 0.00", out)
        for said in (
            "goto: write a time as 0.25s, #INSTRUCTION, cycle N or sample N",
            "last-write: write an address with a size, a variable or $register",
            "'nothing_there'",
            "'NOTHING'",
            "0 -> 1: a write of UART0.CTRL by ",
            "s  uart0: before\n",
            "s  exception 15, SysTick\n",
            "timeline: write one or two positions",
            "who-set: write PERIPHERAL.REGISTER[.FIELD]",
            "diff: write one or two positions",
            "record: give one file",
            "capsoc run --itm stdout",
            "goto POSITION ",
            "reset            reset the SoC",
        ):
            self.assertIn(said, out)
        self.assertEqual(out.count("goto: write a time"), 3)


class Same(unittest.TestCase):
    """All that a debugger without a history is tested with, to the results of the run."""

    def test_as_without_a_history(self):
        Run.options = ("--gdb-history",)
        self.addCleanup(setattr, Run, "options", ())
        suite = unittest.defaultTestLoader.loadTestsFromModule(gdb_test)
        self.assertGreater(suite.countTestCases(), 20)
        result = unittest.TestResult()
        suite.run(result)
        self.assertEqual([text for _, text in result.failures + result.errors], [])


if __name__ == "__main__":
    unittest.main()
