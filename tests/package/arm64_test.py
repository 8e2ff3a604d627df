#!/usr/bin/env python3
"""The cores on arm64: cross-compiled, and run by QEMU's user emulation."""

import shutil
import tempfile
import unittest
from pathlib import Path

from harness import FIRMWARE, SOURCE, output_of

CTEST = {"name": "package: arm64", "whole": True, "long": True, "timeout": 900}

# Slow below an emulator, and about the translator, for which blocks stand in there.
TOO_LONG = "-*HotCode*:*Translator*"


class Arm64(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        for tool in ("aarch64-linux-gnu-g++", "qemu-aarch64"):
            if shutil.which(tool) is None:
                raise AssertionError(f"there is no {tool}: ./scripts/setup all")
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.build = Path(folder.name).resolve()
        cls.compile(cls.build / "arm64", "aarch64-linux-gnu-g++")
        cls.compile(cls.build / "host", "g++", "--target", "digits")

    @staticmethod
    def compile(build, compiler, *target):
        output_of(
            "cmake", "-G", "Ninja", "-S", SOURCE / "tests/package/arm64", "-B", build,
            f"-DCMAKE_CXX_COMPILER={compiler}", f"-DCAPSOC_PROGRAMS={FIRMWARE}",
        )  # fmt: skip
        output_of("cmake", "--build", build, *target, timeout=800)

    def emulate(self, program, *arguments):
        return output_of(
            "qemu-aarch64", "-L", "/usr/aarch64-linux-gnu", self.build / "arm64" / program, *arguments, timeout=600
        )

    def test_the_processor(self):
        said = self.emulate("armv7m_test", f"--gtest_filter={TOO_LONG}", "--gtest_brief=1")
        self.assertRegex(said, r"PASSED  \] [4-9]\d\d tests")

    def test_the_sums_of_the_identification_have_the_same_digits(self):
        here = output_of(self.build / "host/digits")
        self.assertEqual(len(here.splitlines()), 24)
        self.assertEqual(self.emulate("digits"), here)


if __name__ == "__main__":
    unittest.main()
