#!/usr/bin/env python3
"""firmware/template copied out of the tree, built both ways and run."""

import os
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

BUILD = Path(os.environ.get("CAPSOC_TEST_BUILD", "build")).resolve()
SOURCE = Path(os.environ.get("CAPSOC_TEST_SOURCE", ".")).resolve()
CLEAN = {k: v for k, v in os.environ.items() if not k.startswith("CAPSOC_") and k not in ("CFLAGS", "MAKEFLAGS")}


class Template(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.app = Path(folder.name) / "app"
        shutil.copytree(SOURCE / "firmware" / "template", self.app)

    def do(self, *command):
        done = subprocess.run(command, cwd=self.app, capture_output=True, text=True, timeout=120, check=False, env=CLEAN)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done.stdout

    def test_make(self):
        self.do("make", f"CAPSOC={BUILD}")
        self.assertEqual(self.do("make", "-s", f"CAPSOC={BUILD}", "run"), "angle: 300 tenths of a degree\n")
        self.do("make", f"CAPSOC={BUILD}", "clean")
        self.assertEqual({p.name for p in self.app.iterdir()}, {p.name for p in (SOURCE / "firmware/template").iterdir()})

    def test_cmake(self):
        self.do("cmake", "-B", "build", "--toolchain", "toolchain.cmake", f"-DCAPSOC={BUILD}")
        self.do("cmake", "--build", "build")
        self.assertEqual(self.do(BUILD / "capsoc", "run", "build/app.elf"), "angle: 300 tenths of a degree\n")
        self.assertIn("angle: 300 tenths of a degree\n", self.do("cmake", "--build", "build", "--target", "run"))

    def test_settings_of_its_own(self):
        main = self.app / "main.c"
        text = main.read_text().replace('#include "capsoc_device.h"', """#include "capsoc_device.h"
#include "program_settings.h"

#define SETTINGS(NUMBER, TEXT)                                                   \\
  NUMBER(int16_t, offset, -3, -300, 300, 1, "tenths", "added to the angle")      \\
  NUMBER(uint8_t, share, 0.5, 0, 0.75, 256, "", "of nothing")                    \\
  TEXT(label, 8, "angle", "what is printed before it")
PROGRAM_SETTINGS(SETTINGS)
#define settings (*program_settings_values())""")
        text = text.replace('print("angle: ");', 'print(settings.label);\n  print(": ");')
        main.write_text(text.replace(">> 32));", ">> 32) + (uint32_t)settings.offset);"))
        self.do("make", f"CAPSOC={BUILD}")
        run = [BUILD / "capsoc", "run", "app.elf"]
        self.assertEqual(self.do(*run), "angle: 297 tenths of a degree\n")
        self.assertEqual(self.do(*run, "-P", "offset=-100", "-P", "label=phi"), "phi: 200 tenths of a degree\n")
        listing = self.do(*run, "--list-program-settings", "-P", "share=0.25")
        self.assertRegex(listing, r"offset +-3 +tenths +-300 \.\. 300 +built-in +added to the angle\n")
        self.assertRegex(listing, r"share +0.25 +0 \.\. 0.75 +command line")
        self.assertRegex(listing, r"label +angle +at most 7 bytes")
        for arguments, expected in ((["-P", "label=longer than it"], "too long; give at most 7 bytes"),
                                    (["-P", "offset=301"], "give -300 .. 300 tenths")):
            done = subprocess.run([*run, *arguments], cwd=self.app, capture_output=True, text=True, check=False, env=CLEAN)
            self.assertEqual(done.returncode, 2)
            self.assertIn(expected, done.stderr)

    def test_the_board_without_the_coprocessor(self):
        self.do("make", f"CAPSOC={BUILD}")
        done = subprocess.run(["qemu-system-arm", "-M", "mps2-an385", "-nographic", "-semihosting", "-kernel", "app.elf"],
                              cwd=self.app, capture_output=True, timeout=60, check=False, stdin=subprocess.DEVNULL)
        self.assertEqual((done.returncode, done.stdout), (1, b"no coprocessor\n"))

    def test_in_a_wrong_place_it_says_what_to_do(self):
        for command in (["make", "CAPSOC=/nowhere"],
                        ["cmake", "-B", "build", "--toolchain", "toolchain.cmake", "-DCAPSOC=/nowhere"]):
            done = subprocess.run(command, cwd=self.app, capture_output=True, text=True, check=False, env=CLEAN)
            self.assertNotEqual(done.returncode, 0)
            self.assertIn("/path/to/capsoc/build", done.stderr)


if __name__ == "__main__":
    unittest.main()
