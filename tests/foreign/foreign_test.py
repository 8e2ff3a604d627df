#!/usr/bin/env python3
"""scripts/tool foreign_firmware without the network: same and different programs, and what a user may do wrong."""

import contextlib
import io
import re
import subprocess
import tempfile
import tomllib
import unittest
from pathlib import Path

from capsoc_tools.compare import foreign_firmware as foreign
from harness import BUILD, CAPSOC, SOURCE

CTEST = {"name": "foreign firmware", "whole": True, "timeout": 120}

ARGUMENTS = """
#include <stdio.h>
int main(int argc, char** argv) {
  FILE* file = fopen("note", "w");
  fputs(argv[2], file);
  fclose(file);
  file = fopen("note", "r");
  int first = fgetc(file);
  printf("%s %d %c %g\\n", argv[1], argc, first, 1.5);
  return 7;
}
"""
# DWT_CTRL: four comparators here, none of QEMU's.
DWT = """
#include <stdio.h>
int main(void) {
  printf("%u comparators\\n", *(volatile unsigned*)0xE0001000u >> 28);
  return 0;
}
"""
# Turns of four cycles, timed in the 10 ms of clock().
CLOCK = """
#include <stdio.h>
#include <time.h>
int main(void) {
  const clock_t begin = clock();
  unsigned left = 10000000;
  __asm volatile(".balign 4\\n0: nop\\n subs %0, #1\\n bne 0b" : "+l"(left) : : "cc");
  printf("a second: %.1f\\n", 1e7 / ((clock() - begin) / (double)CLOCKS_PER_SEC));
  return 0;
}
"""
ENDLESS = 'int main(void) { for (;;) __asm volatile(""); }'
# Answers each byte of UART 0 with the next one, plus a number with DWT; ends at ! and says nothing to ?.
ANSWER = """
#define UART0 ((volatile unsigned*)0x40004000u)
int main(void) {
  UART0[4] = 16;
  UART0[2] = 3;
  for (;;) {
    while (!(UART0[1] & 2)) {
    }
    const unsigned byte = UART0[0];
    if (byte == '!') return 7;
    if (byte == '?') continue;
    while (UART0[1] & 1) {
    }
    UART0[0] = byte + 1 + (DWT ? DWT - 1 + (*(volatile unsigned*)0xE0001000u >> 28) : 0);
  }
}
"""
# Sends what it is given, a byte a test, and wants the next one back.
RUNNER = """
import os, sys, tty

terminal, folder, *sent = sys.argv[2].removeprefix("port:"), sys.argv[4], *sys.argv[5:]
os.makedirs(folder)
line = os.open(terminal, os.O_RDWR | os.O_NOCTTY)
tty.setraw(line)
for byte in sent:
    os.write(line, byte.encode())
    answer = os.read(line, 1)
    right = answer == bytes([ord(byte) + 1])
    print("pass " if right else "FAIL ", f"tests/{byte}")
    if not right:
        open(f"{folder}/tests_{byte}.out", "wb").write(answer)
print("skip  tests/none")
print(len(sent), "tests performed")
"""
FAULT = "int main(void) { return *(volatile int*)0x60000000; }"


class ForeignFirmware(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.work = Path(self.folder.name)
        self.bench = foreign.Bench(CAPSOC, self.work, 60)

    def run_text(self, text, arguments=(), **keys):
        source, elf = self.work / "program.c", self.work / "program.elf"
        source.write_text(text, encoding="utf-8")
        entry = {"name": "program", "arguments": list(arguments), **keys}
        self.assertIsNone(self.bench.compile(elf, [source], entry, self.work, "-O2"))
        return self.bench.compare("program -O2", elf, entry)

    def test_the_same_output_and_status_are_no_complaint(self):
        verdict = self.run_text(ARGUMENTS, ["one", "two words"], expect="1.5")
        self.assertEqual((verdict.complaint, verdict.status), ("", 7))
        self.assertEqual(verdict.output.strip(), b"one 3 t 1.5")
        self.assertGreater(verdict.instructions, 1000)

    def test_other_output_is_told(self):
        self.assertEqual(self.run_text(DWT).complaint, "other output than on QEMU")

    def test_an_output_without_what_is_expected_is_told(self):
        self.assertEqual(self.run_text(ARGUMENTS, ["one", "two"], expect="passed").complaint, "does not say 'passed'")

    def test_lines_that_are_hidden_may_differ_and_no_others(self):
        self.assertEqual(self.run_text(DWT, hide="^4 |^0 ").complaint, "")
        self.assertEqual(self.run_text(DWT, hide="^4 ").complaint, "other output than on QEMU")

    def test_a_score_is_for_a_megahertz_of_the_simulated_clock(self):
        score = {"unit": "turns", "line": "a second: (.*)", "one": 10}
        verdict = self.run_text(CLOCK, expect="a second", hide="a second", score=score)
        self.assertEqual(verdict.complaint, "")
        self.assertEqual(verdict.score.unit, "turns")
        # 4 cycles a turn: NOP, SUBS and a taken branch of 2.
        self.assertAlmostEqual(verdict.score.per_mhz * 10, 1e6 / 4, delta=1e6 / 4 * 0.01)
        for text in (FAULT, ENDLESS):
            self.bench.limit = 2
            self.assertIsNone(self.run_text(text, score=score).score)

    def test_options_are_the_simulators(self):
        plain, fast = (
            self.run_text(ARGUMENTS, ["one", "two"], options=options)
            for options in ([], ["-C", "memory.psram.wait_states=0"])
        )
        self.assertEqual((plain.instructions, plain.output), (fast.instructions, fast.output))
        self.assertGreater(plain.cycles, fast.cycles)

    def test_a_fault_ends_both_alike(self):
        verdict = self.run_text(FAULT)
        self.assertEqual((verdict.complaint, verdict.output.strip(), verdict.status), ("", b"FAULT", 1))

    def test_a_program_without_an_end_is_told(self):
        self.bench.limit = 2
        self.assertEqual(self.run_text(ENDLESS).complaint, "no end in 2 s on either")

    def run_board(self, *sent, dwt=0, limit=20):
        """The row and what was printed of a board's suite."""
        source, elf, runner = self.work / "program.c", self.work / "program.elf", self.work / "runner.py"
        source.write_text(ANSWER, encoding="utf-8")
        runner.write_text(RUNNER, encoding="utf-8")
        entry = {
            "name": "board",
            "title": "A board",
            "runner": runner.name,
            "expect": "tests performed",
            "limit": limit,
            "passes": {"plain": sent},
        }
        self.assertIsNone(self.bench.compile(elf, [source], entry, self.work, "-O2", [f"-DDWT={dwt}"]))
        with contextlib.redirect_stdout(io.StringIO()) as printed:
            row = foreign.run_passes(self.bench, entry, self.work, elf, "board -O2")
            foreign.print_table([row])
        return row, printed.getvalue()

    def test_a_board_that_answers_alike_has_no_difference(self):
        row, printed = self.run_board("a", "b")
        self.assertEqual((row.count, row.same), (2, 2), printed)
        self.assertIn(
            "board -O2 plain: 3 tests, 2 pass on both, 0 fail on both alike, 1 not for this target, 0 differ\n", printed
        )
        self.assertRegex(printed, r"\| A board \| 2 \| 2 \| [0-9.]+ \|\n")

    def test_a_board_that_answers_otherwise_is_told(self):
        row, printed = self.run_board("a", "b", dwt=1)
        self.assertEqual((row.count, row.same), (2, 0), printed)
        self.assertIn("  tests/a: FAIL, on QEMU pass\n", printed)
        row, printed = self.run_board("a", "b", dwt=2)  # wrong on both
        self.assertEqual((row.count, row.same), (2, 0), printed)
        self.assertIn("  tests/b: fails with other output than on QEMU\n", printed)

    def test_a_board_that_ends_is_told(self):
        row, printed = self.run_board("a", "!")
        self.assertLess(row.same, row.count, printed)  # what it said before its end may still arrive
        self.assertIn("on capsoc: the simulator ended with 1: exit 1: the firmware ended with status 7\n", printed)
        self.assertIn("on QEMU: the simulator ended with 7: ", printed)

    def test_a_board_that_says_nothing_is_told(self):
        row, printed = self.run_board("?", limit=2)
        self.assertEqual((row.count, row.same), (1, 0), printed)
        self.assertEqual(printed.count(": no end in time\n"), 2)

    def test_a_board_that_does_not_start_is_one_sentence(self):
        with self.assertRaisesRegex(foreign.ForeignError, "opens no terminal: .*nothing.elf"):
            with foreign.Board([CAPSOC, "run", "nothing.elf", "--uart0", "pty"], self.work):
                pass

    def test_what_does_not_compile_is_one_sentence(self):
        entry = {"name": "board", "make": [["-f", "nothing.mk", "{build}"]]}
        with self.assertRaisesRegex(
            foreign.ForeignError, r"^board -O2 does not compile: make: \*\*\* .*nothing.mk.*Stop\.$"
        ):
            foreign.run_board_suite(self.bench, entry, self.work, "-O2")

    def test_the_page_has_a_row_for_each(self):
        listed = tomllib.loads((SOURCE / "tests/foreign/programs.toml").read_text(encoding="utf-8"))
        titles = list(dict.fromkeys(entry["title"] for kind in ("program", "suite", "board") for entry in listed[kind]))
        page = (SOURCE / "docs" / "reference" / "processor.md").read_text(encoding="utf-8")
        table = page.split(f"{foreign.TABLE}\n")[1].split("\n\n")[0]
        rows = [re.fullmatch(r"\| (.*) \| ([\d,]+) \| \2 \| \d+\.\d \|", line) for line in table.splitlines()]
        self.assertEqual([row and row[1] for row in rows], titles)

    def refused(self, *arguments):
        done = subprocess.run(
            [SOURCE / "scripts" / "tool", "foreign_firmware", *arguments], capture_output=True, text=True, check=False
        )
        self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (2, "", 1))
        return done.stderr

    def test_wrong_options_are_one_sentence(self):
        self.assertIn("is missing; build it first", self.refused("--build", self.work))
        self.assertIn("Not a directory", self.refused("--build", BUILD, "--work", SOURCE / "README.md" / "work"))
        self.assertIn(
            "no program with 'cobol'", self.refused("--build", BUILD, "--work", self.work, "--match", "cobol")
        )
        self.assertIn("no level -O9", self.refused("--build", BUILD, "--work", self.work, "--level=-O9"))


if __name__ == "__main__":
    unittest.main()
