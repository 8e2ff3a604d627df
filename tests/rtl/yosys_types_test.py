#!/usr/bin/env python3
"""The design with its types in a package, as yosys 0.52 needs it, read by a tool that takes both forms: Verilator."""

import subprocess
import unittest
from pathlib import Path

from capsoc_tools.rtl.sources import RTL, sources
from capsoc_tools.rtl.yosys_types import PACKAGE, in_a_package
from harness import CLEAN, Case

CTEST = {"name": "rtl: types for yosys", "timeout": 100}


class Types(Case):
    def setUp(self):
        super().setUp()
        self.plain = sources(self.folder / "generated")
        self.package, *self.copies = in_a_package(self.plain, self.folder / "types")

    def lint(self, files):
        """What Verilator says of the design; its report of itself left out."""
        waiver = RTL / "lint" / "verilator.vlt"
        command = [
            "verilator",
            "--lint-only",
            "-Wall",
            "-Wno-DECLFILENAME",
            "--top-module",
            "coprocessor",
            waiver,
            *files,
        ]
        done = subprocess.run(command, capture_output=True, text=True, check=False, env=CLEAN)
        return done.returncode, [line for line in done.stderr.splitlines() if not line.startswith("- ")]

    def test_both_forms_are_read(self):
        self.assertEqual(self.lint(self.plain), (0, []))
        self.assertEqual(self.lint([self.package, *self.copies]), (0, []))

    def test_each_type_is_in_the_package_once(self):
        package = self.package.read_text()
        self.assertEqual(package.count("\ntypedef struct packed {"), package.count("\n} "))
        self.assertIn(f"\ntypedef {PACKAGE}::state_t state_t;\n", package)
        for copy in self.copies:
            self.assertNotRegex(copy.read_text(), r"(?m)^typedef ")

    def test_a_message_names_the_same_line(self):
        for plain, copy in zip(self.plain, self.copies, strict=True):
            before, after = Path(plain).read_text().splitlines(), copy.read_text().splitlines()
            self.assertEqual(len(before), len(after), plain)
            module = [line for line in enumerate(before) if line[1].startswith(("module ", "endmodule"))]
            self.assertEqual(
                module, [line for line in enumerate(after) if line[1].startswith(("module ", "endmodule"))]
            )

    def test_a_type_that_is_lost_is_seen(self):
        text = self.package.read_text()
        self.package.write_text(text.replace(f"typedef {PACKAGE}::change_t change_t;\n", ""))
        self.assertNotEqual(self.lint([self.package, *self.copies])[0], 0)


if __name__ == "__main__":
    unittest.main()
