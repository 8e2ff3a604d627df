#!/usr/bin/env python3
"""scripts/foreign_firmware without the network: same and different programs, and what a user may do wrong."""

import importlib.machinery
import importlib.util
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ.pop("CAPSOC_TEST_BUILD"))  # not a setting of capsoc
SCRIPT = ROOT / "scripts" / "foreign_firmware"

sys.dont_write_bytecode = True
loader = importlib.machinery.SourceFileLoader("foreign_firmware", str(SCRIPT))
foreign = importlib.util.module_from_spec(importlib.util.spec_from_loader("foreign_firmware", loader))
loader.exec_module(foreign)

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
ENDLESS = "int main(void) { for (;;) __asm volatile(\"\"); }"
FAULT = "int main(void) { return *(volatile int*)0x60000000; }"


class ForeignFirmware(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.work = Path(self.folder.name)
        self.bench = foreign.Bench(BUILD / "capsoc", self.work, 60)

    def run_text(self, text, expect="", arguments=()):
        source, elf = self.work / "program.c", self.work / "program.elf"
        source.write_text(text, encoding="utf-8")
        entry = {"name": "program", "arguments": list(arguments)}
        self.assertIsNone(self.bench.compile(elf, [source], entry, self.work, "-O2"))
        return self.bench.compare("program -O2", elf, expect)

    def test_the_same_output_and_status_are_no_complaint(self):
        verdict = self.run_text(ARGUMENTS, "1.5", ["one", "two words"])
        self.assertEqual((verdict.complaint, verdict.status), ("", 7))
        self.assertEqual(verdict.output.strip(), b"one 3 t 1.5")
        self.assertGreater(verdict.instructions, 1000)

    def test_other_output_is_told(self):
        self.assertEqual(self.run_text(DWT).complaint, "other output than on QEMU")

    def test_an_output_without_what_is_expected_is_told(self):
        self.assertEqual(self.run_text(ARGUMENTS, "passed", ["one", "two"]).complaint, "does not say 'passed'")

    def test_a_fault_ends_both_alike(self):
        verdict = self.run_text(FAULT)
        self.assertEqual((verdict.complaint, verdict.output.strip(), verdict.status), ("", b"FAULT", 1))

    def test_a_program_without_an_end_is_told(self):
        self.bench.limit = 2
        self.assertEqual(self.run_text(ENDLESS).complaint, "no end in 2 s on either")

    def refused(self, *arguments):
        done = subprocess.run([SCRIPT, *arguments], capture_output=True, text=True, check=False)
        self.assertEqual((done.returncode, done.stdout, done.stderr.count("\n")), (2, "", 1))
        return done.stderr

    def test_wrong_options_are_one_sentence(self):
        self.assertIn("is missing; build it first", self.refused("--build", self.work))
        self.assertIn("Not a directory", self.refused("--build", BUILD, "--work", SCRIPT / "work"))
        self.assertIn("no program with 'cobol'", self.refused("--build", BUILD, "--work", self.work, "--match", "cobol"))
        self.assertIn("no level -O9", self.refused("--build", BUILD, "--work", self.work, "--level=-O9"))


if __name__ == "__main__":
    unittest.main()
