#!/usr/bin/env python3
"""Intel HEX, S-records, raw binaries and several images, as objcopy writes them."""

import subprocess
import unittest

from harness import CAPSOC, CLEAN, Case, FIRMWARE

CTEST = {"name": "system: Loading", "whole": True, "timeout": 120}

HELLO = FIRMWARE / "hello.elf"


class Loading(Case):
    def objcopy(self, form, *options, elf=HELLO):
        path = self.folder / f"{elf.stem}.{form}"
        subprocess.run(["arm-none-eabi-objcopy", "-O", form, *options, elf, path], check=True)
        return path

    def run_it(self, *arguments):
        done = subprocess.run(
            [CAPSOC, "run", *map(str, arguments)], capture_output=True, timeout=60, check=False, env=CLEAN
        )
        return done.returncode, done.stdout, done.stderr.decode()

    def test_every_format_is_the_same_program(self):
        expected = self.run_it(HELLO)[:2]
        self.assertEqual(expected, (0, b"hello from capsoc\n"))
        self.assertEqual(self.run_it(self.objcopy("ihex"))[:2], expected)
        # Over another program, which never ends: the last image wins.
        forever = FIRMWARE / "forever.elf"
        self.assertEqual(self.run_it(forever, "--load", f"{self.objcopy('binary')}@0")[:2], expected)
        self.assertEqual(
            self.run_it(forever, "--load", f"{self.objcopy('binary')}@0x21000000", "--load", self.objcopy("ihex"))[:2],
            expected,
        )

    def test_s_records_are_the_same_program(self):
        """Of 16, 24 and 32 bits of address, and with lines of any length."""
        forever = FIRMWARE / "forever.elf"
        for name, options in (
            ("hello", ()),
            ("hello", ("--srec-forceS3",)),
            ("hello", ("--srec-len=200",)),
            ("hello_psram", ()),
            ("hello_sram", ()),
        ):
            elf = FIRMWARE / f"{name}.elf"
            expected = self.run_it(elf)[:2]
            self.assertEqual(expected, (0, b"hello from capsoc\n"))
            srec = self.objcopy("srec", *options, elf=elf)
            self.assertEqual(self.run_it(srec)[:2], expected)
            if name == "hello":
                self.assertEqual(self.run_it(forever, "--load", srec)[:2], expected)

    def test_a_byte_order_mark_is_no_part_of_a_text(self):
        for form in ("ihex", "srec"):
            path = self.objcopy(form)
            path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes().replace(b"\r\n", b"\n"))
            self.assertEqual(self.run_it(path)[:2], (0, b"hello from capsoc\n"))

    def test_what_cannot_be_loaded_is_refused_with_a_sentence(self):
        raw = self.objcopy("binary")
        for place, words in (
            (f"{raw}@0x60000000", "outside memory"),
            (f"{raw}@here", "no address"),
            ("nowhere@0", "cannot be read"),
            (raw, "--load FILE@ADDRESS"),
        ):
            code, _, said = self.run_it(HELLO, "--load", place)
            self.assertEqual(code, 2)
            self.assertIn(words, said)
        code, _, said = self.run_it(raw)
        self.assertEqual((code, said.count("\n")), (2, 1))
        self.assertIn("is no ELF file, no Intel HEX and no S-records;", said)


if __name__ == "__main__":
    unittest.main()
