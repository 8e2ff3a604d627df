#!/usr/bin/env python3
"""The models and the library's projects, read by clang: no error and no warning with our options."""

import json
import os
import shlex
import unittest
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from harness import BUILD, SOURCE, output_of

CTEST = {"name": "quality: clang", "whole": True, "long": True, "timeout": 1200}

WARNINGS = ["-Wall", "-Wextra", "-Wpedantic", "-Wshadow", "-Werror"]
# Options of gcc alone, and what carries its precompiled header.
OF_GCC = ("-Winvalid-pch", "-fno-gcse", "-fno-crossjumping")


def commands():
    """(folder, arguments) of each compilation of the models, as clang takes them without making an object."""
    for entry in json.loads((BUILD / "compile_commands.json").read_text(encoding="utf-8")):
        file = Path(entry["file"])
        if not (file.is_relative_to(SOURCE / "models") or file.is_relative_to(BUILD / "models")):
            continue
        words = iter(shlex.split(entry["command"])[1:])
        kept = []
        for word in words:
            if word in ("-o", "-include", "-MF", "-MT"):
                next(words)
            elif word not in OF_GCC and word not in ("-c", "-MD"):
                kept.append(word)
        yield entry["directory"], [*kept, *WARNINGS, "-fsyntax-only"]


class Clang(unittest.TestCase):
    def what_is_wrong_with(self, command):
        folder, arguments = command
        try:
            output_of("clang++", *arguments, cwd=folder)
        except AssertionError as error:
            return str(error)[-4000:]
        return None

    def read_all(self, all_commands):
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            self.assertEqual([said for said in pool.map(self.what_is_wrong_with, all_commands) if said], [])

    def test_the_models(self):
        found = list(commands())
        self.assertGreater(len(found), 50)
        self.read_all(found)

    def test_the_projects_of_the_library(self):
        includes = ["-I", SOURCE / "models", "-I", SOURCE / "platform", "-I", BUILD / "generated"]
        flags = output_of("pkg-config", "--cflags", "systemc", "eigen3").replace("-I", "-isystem").split()
        self.read_all(
            (
                SOURCE,
                ["-std=c++17", "-DSC_INCLUDE_DYNAMIC_PROCESSES", *WARNINGS, *includes, *flags, "-fsyntax-only", main],
            )
            for main in sorted((SOURCE / "tests/package/projects").glob("*/main.cpp"))
        )


if __name__ == "__main__":
    unittest.main()
