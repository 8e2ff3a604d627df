"""The lists of rtl/ (design, probe, tops for buses and boards): no file is forgotten, none is listed and not there."""

import subprocess
import tempfile
import tomllib
import unittest
from pathlib import Path

from capsoc_tools.rtl import sources as rtl_sources
from harness import CLEAN, SOURCE

CTEST = {"name": "quality: RTL lists", "whole": True}

RTL = SOURCE / "rtl"
TABLE = "paper_sine_table.sv"
LISTS = (rtl_sources.DESIGN, rtl_sources.PROBE, rtl_sources.WRAPPERS, rtl_sources.BOARD)


def listed(name):
    return rtl_sources.read_list(RTL / name)


def of_proofs():
    """What scripts/tool formal reads in addition to the design: the properties, and what stands in for a unit."""
    proofs = tomllib.loads((RTL / "formal" / "proofs.toml").read_text(encoding="utf-8"))["proof"]
    names = {f"formal/{proof['harness']}" for proof in proofs if "harness" in proof}
    names |= {name for proof in proofs for name in proof["sources"] if name.startswith("formal/")}
    return {(RTL / name).resolve() for name in names}


class Lists(unittest.TestCase):
    def test_every_file_is_listed(self):
        files = {path.resolve() for path in RTL.rglob("*.sv")}
        self.assertGreater(len(files), 60)
        known = {*(file for name in LISTS for file in listed(name)), *of_proofs()}
        message = "in no list: add it to rtl/coprocessor.f, rtl/wrappers.f or rtl/board.f, or to its probe or proof"
        self.assertEqual(sorted(files - known), [], message)
        self.assertEqual(sorted(known - files), [], "in a list and not in rtl/")

    def test_no_file_is_listed_twice(self):
        for name in LISTS:
            self.assertEqual(len(listed(name)), len(set(listed(name))), name)

    def test_the_design_is_the_top_folder(self):
        self.assertEqual({path.parent for path in listed(rtl_sources.DESIGN)}, {RTL.resolve()})

    def test_packages_and_types_come_first(self):
        is_module = [not path.stem.endswith(("_pkg", "_types")) for path in listed(rtl_sources.DESIGN)]
        self.assertEqual(is_module, sorted(is_module))

    def test_the_reader_for_cmake_reads_the_same(self):
        """Its oracle is the reader for the scripts."""
        with tempfile.TemporaryDirectory() as folder:
            script = Path(folder) / "read.cmake"
            script.write_text(
                "cmake_minimum_required(VERSION 3.25)\n"
                "function(set_property)\nendfunction()\n"  # there is none to configure again in a script
                f"include({SOURCE / 'cmake' / 'rtl_list.cmake'})\n"
                f"capsoc_read_rtl_list(files {RTL / rtl_sources.DESIGN})\n"
                "foreach(file ${files})\n  message(${file})\nendforeach()\n",
                encoding="utf-8",
            )
            done = subprocess.run(["cmake", "-P", script], capture_output=True, text=True, check=True, env=CLEAN)
        self.assertEqual([Path(line) for line in done.stderr.split()], listed(rtl_sources.DESIGN))

    def test_generated_files_come_before(self):
        with tempfile.TemporaryDirectory() as folder:
            files = rtl_sources.sources(Path(folder))
        design = listed(rtl_sources.DESIGN)
        self.assertEqual(files[-len(design) :], design)
        self.assertIn(TABLE, [path.name for path in files[: -len(design)]])


class Licence(unittest.TestCase):
    """Who takes a file alone takes its licence with it."""

    def test_every_file_names_the_repositorys(self):
        heading = (SOURCE / "LICENSE").read_text(encoding="utf-8").split()[:4]
        self.assertEqual(heading, ["Apache", "License", "Version", "2.0,"])
        without = [
            str(path.relative_to(SOURCE))
            for path in sorted(RTL.rglob("*"))
            if path.is_file() and "SPDX-License-Identifier: Apache-2.0" not in path.read_text("utf-8").split("\n", 1)[0]
        ]
        self.assertEqual(without, [], "in the first line of each: SPDX-License-Identifier: Apache-2.0")


class Errors(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.list = Path(folder.name).resolve() / "some.f"

    def test_a_file_that_is_not_there(self):
        self.list.write_text("// a comment\n\nnowhere.sv\n", encoding="utf-8")
        with self.assertRaisesRegex(rtl_sources.RtlError, r"some\.f:3: .*nowhere\.sv"):
            rtl_sources.read_list(self.list)

    def test_no_list(self):
        with self.assertRaisesRegex(rtl_sources.RtlError, r"some\.f: No such file"):
            rtl_sources.read_list(self.list)

    def test_comments_and_blank_lines_are_no_files(self):
        (self.list.parent / "a.sv").write_text("", encoding="utf-8")
        self.list.write_text("// first\n\n  a.sv  // why\n", encoding="utf-8")
        self.assertEqual(rtl_sources.read_list(self.list), [self.list.parent / "a.sv"])


if __name__ == "__main__":
    unittest.main()
