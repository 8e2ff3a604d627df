#!/usr/bin/env python3
"""A user's RTL: find_package(capsoc) from an install tree, capsoc_add_rtl_library(), capsoc regress."""

import json
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from harness import BUILD, CAPSOC, CLEAN

CTEST = {"name": "rtl: a design of one's own", "whole": True, "timeout": 600}

PROJECT = Path(__file__).resolve().parent / "project"
CORE = (BUILD / "generated" / "rtl_sources.txt").read_text(encoding="utf-8").splitlines()


def run(*command, cwd=None):
    return subprocess.run(
        [str(word) for word in command], capture_output=True, text=True, check=False, cwd=cwd, env=CLEAN
    )


class OwnDesign(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.temporary.cleanup)
        cls.folder = Path(cls.temporary.name)
        done = run("cmake", "--install", BUILD, "--prefix", cls.folder / "capsoc", "--component", "rtl")
        assert done.returncode == 0, done.stderr
        shutil.copytree(PROJECT, cls.folder / "project")
        cls.build = cls.folder / "build"
        done = cls.configure(cls.folder / "project", cls.build)
        assert done.returncode == 0, done.stderr
        cls.make()

    @classmethod
    def configure(cls, project, build):
        return run(
            "cmake",
            "-S",
            project,
            "-B",
            build,
            f"-DCMAKE_PREFIX_PATH={cls.folder / 'capsoc'}",
            "-DCMAKE_BUILD_TYPE=Release",
            "-DCORE_SOURCES=" + ";".join(CORE),
        )

    @classmethod
    def make(cls):
        done = run("cmake", "--build", cls.build, "-j2")
        assert done.returncode == 0, done.stdout[-4000:] + done.stderr

    def regress(self, library, *arguments):
        return run(
            CAPSOC,
            "regress",
            "--arithmetic",
            "precise",
            "--rtl-library",
            self.build / library,
            "--seeds",
            "1",
            "--samples",
            "500",
            "--accesses",
            "500",
            *arguments,
            cwd=self.folder,
        )

    def test_it_agrees_at_its_pins(self):
        done = self.regress("libangle_unit.so", "--json", "same.json")
        self.assertEqual(done.returncode, 0, done.stdout[-3000:] + done.stderr)
        self.assertIn("compared at its pins without pstrb, pready, pslverr, sample_ready, idle\n", done.stdout)
        part = json.loads((self.folder / "same.json").read_text())["arithmetics"]["precise"]
        self.assertEqual(part["missing"], [])
        self.assertTrue(part["rtl"]["compared"].startswith("pins without"))

    def test_a_wrong_bit_is_found_and_shown(self):
        done = self.regress("libangle_unit_wrong.so", "--scenario", "traffic", "--waves", "waves")
        self.assertEqual(done.returncode, 4, done.stdout + done.stderr)
        self.assertIn("read of 0x0c0 (ANGLE): model ", done.stdout)
        found = done.stdout.split("(ANGLE): model ")[1].split()
        self.assertEqual(int(found[0].strip(","), 16) ^ int(found[2], 16), 1 << 3)
        self.assertIn("waves: gtkwave waves/precise-traffic-1.fst waves/precise-traffic-1.gtkw", done.stdout)
        waves = subprocess.run(
            ["fst2vcd", self.folder / "waves" / "precise-traffic-1.fst"], capture_output=True, text=True, check=True
        ).stdout
        self.assertIn("$scope module core $end", waves)
        marker = next(
            line
            for line in (self.folder / "waves" / "precise-traffic-1.gtkw").read_text().splitlines()
            if line.startswith("*")
        ).split()[1]
        times = [int(line[1:]) for line in waves.splitlines() if line.startswith("#")]
        self.assertTrue(times[0] <= int(marker) <= times[-1] + 40, (times[0], marker, times[-1]))

    def test_an_edit_needs_the_library_alone(self):
        program = CAPSOC.stat().st_mtime_ns
        sources = [
            json.loads((self.folder / "edit.json").read_text())["arithmetics"]["precise"]["rtl"]["sources"]
            for number in range(2)
            if self.edit_and_regress(number)
        ]
        self.assertEqual(len(set(sources)), 2)
        self.assertEqual(CAPSOC.stat().st_mtime_ns, program)

    def edit_and_regress(self, number):
        with open(self.folder / "project" / "angle_unit.sv", "a", encoding="utf-8") as file:
            file.write(f"// edit {number}\n")
        self.make()
        done = self.regress("libangle_unit.so", "--scenario", "ties", "--json", "edit.json")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return True

    def test_the_soc_needs_to_see_its_inside(self):
        library = self.build / "libangle_unit.so"
        for backend in ("rtl", "lockstep"):
            done = run(
                CAPSOC, "run", "--coprocessor", backend, "--rtl-library", library, "--simlimit", "0.01", cwd=self.folder
            )
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertIn(f"{library}: shows its pins and nothing of its inside", done.stderr)
        (self.folder / "exceptions.txt").write_text("# none\n")
        done = self.regress("libangle_unit.so", "--coverage", "c", "--coverage-exceptions", "exceptions.txt")
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn("leave that out", done.stderr)
        done = run(CAPSOC, "regress", "--arithmetic", "paper", "--rtl-library", library)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn("its arithmetic is precise", done.stderr)

    def test_wrong_pins_are_refused_when_cmake_runs(self):
        text = (PROJECT / "CMakeLists.txt").read_text()
        for wrong, saying in (
            ("psel=sel", "'apb_select=sel' is no PIN=PORT"),
            ("prdata=rdata", "the design must have prdata"),
            ("TOP angle_unit", "wants TOP and SOURCES"),
        ):
            right = {"psel=sel": "apb_select=sel", "prdata=rdata": "prdata=", "TOP angle_unit": ""}[wrong]
            project = self.folder / f"wrong_{len(right)}"
            project.mkdir()
            (project / "CMakeLists.txt").write_text(text.replace(wrong, right))
            done = self.configure(project, project / "build")
            self.assertNotEqual(done.returncode, 0)
            self.assertIn(saying, " ".join(done.stderr.split()))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[1:]])
