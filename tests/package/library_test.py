#!/usr/bin/env python3
"""The models as libraries (docs/guide/library.md): what is installed, and four projects built against it alone."""

import os
import re
import shutil
import tempfile
import unittest
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from harness import BUILD, SOURCE, output_of

CTEST = {"name": "package: library", "whole": True, "timeout": 1200}

PROJECTS = SOURCE / "tests/package/projects"
# Headers that a component's user has asked for.
ASKED_FOR = {"identification": "/eigen3/"}
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]', re.M)
THIRD_PARTY = re.compile(r"/(fmt|spdlog|nlohmann|asmjit|eigen3|toml\+\+|CLI|yaml\.h|zlib\.h)")


class Library(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        top = Path(folder.name).resolve()
        for component in ("development", "rtl"):
            output_of("cmake", "--install", BUILD, "--prefix", top / "first", "--component", component)
        # It may be moved.
        cls.tree = top / "a place with blanks"
        (top / "first").rename(cls.tree)
        cls.include = cls.tree / "include/capsoc"
        cls.work = top / "work"
        cls.work.mkdir()

    def project(self, name):
        source = self.work / name
        shutil.copytree(PROJECTS / name, source)
        build = source / "build"
        output_of(
            "cmake", "-S", source, "-B", build, f"-DCMAKE_PREFIX_PATH={self.tree}", "-DCMAKE_CXX_FLAGS=-Wall -Wextra"
        )
        output_of("cmake", "--build", build)
        for line in output_of("cmake", "--build", build, "--", "-v", "-n").splitlines():
            self.assertNotIn(str(SOURCE), line)
        output = output_of(build / name, environment={"SYSTEMC_DISABLE_COPYRIGHT_MESSAGE": "1"})
        return output.strip()

    def test_a_system_of_capsocs_parts(self):
        self.assertEqual(self.project("own_soc"), "ok\nasleep: 1")

    def test_the_processor_with_a_uart_of_somebody_else(self):
        self.assertEqual(self.project("foreign_uart"), "0123456789\ninstructions: 46, microseconds: 11")

    def test_the_coprocessor_under_an_initiator_of_somebody_else(self):
        self.assertEqual(self.project("foreign_initiator"), "ID: 43415053\nangle: 30.0000 degrees")

    def test_the_identification_without_a_simulation(self):
        self.assertEqual(self.project("fit"), "a1 0.6000, a2 0.7000, b1 0.1000, b2 -0.0500, beta 0.2000")
        linked = output_of("ldd", self.work / "fit/build/fit")
        self.assertNotIn("systemc", linked)

    def test_pkg_config_knows_the_parts(self):
        environment = {"PKG_CONFIG_PATH": str(self.tree / "lib/pkgconfig")}
        self.assertEqual(
            output_of("pkg-config", "--modversion", "capsoc-armv7m", environment=environment).count("."), 2
        )
        flags = output_of("pkg-config", "--cflags", "--libs", "capsoc-identification", environment=environment)
        program = self.work / "by_pkg_config"
        flags = flags.replace("\\ ", "\0").split()
        flags = [flag.replace("\0", " ") for flag in flags]
        output_of("g++", "-std=c++17", PROJECTS / "fit/main.cpp", *flags, "-o", program)
        self.assertIn("a1 0.6000", output_of(program))

    def test_a_component_that_is_none_is_named(self):
        (self.work / "wrong").mkdir()
        (self.work / "wrong/CMakeLists.txt").write_text(
            "cmake_minimum_required(VERSION 3.16)\nproject(wrong LANGUAGES CXX)\n"
            "find_package(capsoc REQUIRED COMPONENTS armv7m armv8)\n"
        )
        with self.assertRaisesRegex(AssertionError, r"capsoc has no component\s+'armv8'"):
            output_of(
                "cmake", "-S", self.work / "wrong", "-B", self.work / "wrong/build", f"-DCMAKE_PREFIX_PATH={self.tree}"
            )

    def headers(self):
        return sorted(self.include.rglob("*.h"))

    def closures(self):
        """Of each header by name: what it includes, directly or not, our headers by name and others as `<name`."""
        texts = {str(header.relative_to(self.include)): header.read_text() for header in self.headers()}
        found = {}

        def closure(name):
            if name not in found:
                found[name] = set()
                for kind, used in INCLUDE.findall(texts[name]):
                    found[name] |= {used} | closure(used) if used in texts else {"<" + used}
            return found[name]

        for name in texts:
            closure(name)
        return found

    def chains(self):
        """The headers in lists, each of which may be read as one source: when a header comes, nothing was read that
        it does not include itself, so it stands as if it were alone. Half as many sources as headers."""
        closures = self.closures()
        left = sorted(closures, key=lambda name: (-len(closures[name]), name))
        while left:
            chain = [left.pop(0)]
            while below := [name for name in left if closures[name] | {name} <= closures[chain[-1]]]:
                chain.append(below[0])
                left.remove(below[0])
            yield chain[::-1]

    def what_is_wrong_with(self, chain):
        """Of headers in one source: a line, or nothing."""
        unit = self.work / ("alone_" + chain[-1].replace("/", "_") + ".cpp")
        unit.write_text("".join(f'#include "{name}"\n' for name in chain))
        made = unit.with_suffix(".d")
        own = ["-fsyntax-only", "-MD", "-MF", made, "-I", self.include, "-DSC_INCLUDE_DYNAMIC_PROCESSES"]
        try:
            output_of(
                "g++", "-std=c++17", *own, *output_of("pkg-config", "--cflags", "systemc", "eigen3").split(), unit
            )
        except AssertionError as error:
            return f"{chain}: {error}"
        asked_for = ASKED_FOR.get(chain[-1].split("/")[0], "-")
        others = [used for used in made.read_text().split() if THIRD_PARTY.search(used) and asked_for not in used]
        return f"{chain}: {others[0]}" if others else None

    def test_each_header_compiles_alone_and_asks_for_no_other_library(self):
        chains = list(self.chains())
        self.assertEqual(sum(map(len, chains)), len(self.headers()))
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            self.assertEqual([said for said in pool.map(self.what_is_wrong_with, chains) if said], [])

    def test_only_the_identification_includes_eigen(self):
        for name, used in self.closures().items():
            if not name.startswith("identification/"):
                self.assertFalse([other for other in used if "Eigen" in other], name)

    def test_macros_have_a_prefix(self):
        # A header that fills a table from a .def file takes its macro back, or the file does.
        tables = "".join(table.read_text() for table in self.include.rglob("*.def"))
        for header in self.headers():
            text = header.read_text()
            for name in re.findall(r"^\s*#\s*define\s+(\w+)", text, re.M):
                if not re.search(rf"^\s*#\s*undef\s+{name}\b", text + tables, re.M):
                    self.assertRegex(name, "^CAPSOC_", header)

    def test_symbols_are_in_the_namespace(self):
        allowed = re.compile(
            r"^(vtable|typeinfo|typeinfo name|guard variable|non-virtual thunk|virtual thunk|VTT)?( for | to )?capsoc::"
        )
        for archive in sorted((self.tree / "lib").glob("libcapsoc_*.a")):
            for line in output_of("nm", "-C", "--defined-only", "--extern-only", archive).splitlines():
                found = re.match(r"[0-9a-f]+ ([TDBR]) (.*)", line)
                if found:
                    self.assertRegex(found[2], allowed, archive)


if __name__ == "__main__":
    unittest.main()
