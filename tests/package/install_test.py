#!/usr/bin/env python3
"""cmake --install into a folder, the tree moved elsewhere, and the program used from there."""

import json
import os
import re
import sys
import tempfile
import unittest
from pathlib import Path

from harness import BUILD, output_of

CTEST = {"name": "package: install", "whole": True}


class Installed(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        top = Path(folder.name).resolve()
        output_of("cmake", "--install", BUILD, "--prefix", top / "first")
        cls.tree = top / "moved" / "to a place with blanks"
        cls.tree.parent.mkdir()
        (top / "first").rename(cls.tree)
        cls.share = cls.tree / "share"

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.work = Path(folder.name)

    def do(self, *command, **keywords):
        return output_of(*command, cwd=self.work, timeout=250, **keywords)

    def capsoc(self, *arguments, code=0):
        return self.do(self.tree / "bin" / "capsoc", *arguments, code=code)

    def result(self, *arguments, code):
        self.capsoc("run", *arguments, "--json", "r.json", code=code)
        return json.loads((self.work / "r.json").read_text())

    def test_the_main_job_takes_its_files_from_the_tree(self):
        result = self.result("--simlimit", "2", code=124)
        self.assertGreater(result["samples"], 100)
        self.assertEqual(
            [i["path"] for i in result["inputs"]],
            [str(self.share / "capsoc/firmware/selfcal.elf"), str(self.share / "capsoc/traces/soc_eq21.toml")],
        )

    def test_the_rtl_comes_from_the_tree(self):
        self.assertTrue((BUILD / "libcapsoc_rtl_precise.so").exists(), "build the target capsoc_rtl first")
        for arithmetic in ("precise", "paper"):
            result = self.result("--coprocessor", "rtl", "--arithmetic", arithmetic, "--simlimit", "1", code=124)
            self.assertGreater(result["samples"], 10)
        libraries = self.tree / "lib/capsoc"
        hidden = self.tree / "hidden"
        libraries.rename(hidden)
        self.addCleanup(hidden.rename, libraries)
        self.capsoc("run", "--coprocessor", "rtl", code=2)

    def test_info_and_fit(self):
        self.assertIn("coprocessor", self.capsoc("info"))
        self.capsoc("fit", self.share / "capsoc/traces/soc_eq21.toml")
        self.assertTrue((self.work / "calibration.json").exists())

    def test_every_default_is_in_the_tree(self):
        listed = self.capsoc("run", "--list-params")
        self.assertNotIn(str(BUILD), listed)
        self.assertIn(str(self.share / "capsoc/firmware/selfcal.elf"), listed)
        names = [f"bench_{k}.elf" for k in ("list_search", "matrix", "state_machine", "crc", "sort", "strings")]
        self.assertLessEqual(
            {*names, "calibrate.elf", "track.elf", "unordered.elf", "hello.elf"},
            {p.name for p in (self.share / "capsoc/firmware").iterdir()},
        )

    def test_the_python_package_finds_the_program(self):
        environment = {"PYTHONPATH": str(self.share / "capsoc/python"), "PYTHONDONTWRITEBYTECODE": "1"}
        found = self.do(sys.executable, "-c", "import capsoc; print(capsoc.find_program())", environment=environment)
        self.assertEqual(found.strip(), str(self.tree / "bin/capsoc"))

    def test_nothing_needs_the_build_tree(self):
        for file in (self.tree / "bin/capsoc", *(self.tree / "lib/capsoc").iterdir()):
            self.assertNotRegex(self.do("readelf", "-d", file), r"R(UN)?PATH")
        for file in self.tree.glob("**/*"):
            self.assertFalse(file.is_symlink(), file)
            if file.suffix in (".txt", ".md", ".toml", ".py", ".h", ".c", ".svd") and file.is_file():
                self.assertNotIn(str(BUILD), file.read_text(), file)

    def test_the_template_builds_with_what_is_installed(self):
        expected = "hello\nangle: 30.0000 degrees\n"
        # The tree's own path has blanks, the link's none; a link to the program alone may stand in the path, too.
        link = self.work / "capsoc"
        link.symlink_to(self.tree)
        (self.work / "bin").mkdir()
        (self.work / "bin" / "capsoc").symlink_to(link / "bin" / "capsoc")
        for name, options, environment in (
            ("named", [f"CAPSOC={self.tree}"], {}),
            ("found", [], {"PATH": f"{link}/bin:{os.environ['PATH']}"}),
            ("linked", [], {"PATH": f"{self.work}/bin:{os.environ['PATH']}"}),
        ):
            app = self.work / name
            self.do(self.tree / "bin/capsoc", "new", app)
            self.assertEqual(self.do("make", "-s", "-C", app, *options, "run", environment=environment), expected)
        for name, options, environment in (
            ("cnamed", [f"-DCAPSOC={self.tree}"], {}),
            ("cfound", [], {"PATH": f"{link}/bin:{os.environ['PATH']}"}),
            ("clinked", [], {"PATH": f"{self.work}/bin:{os.environ['PATH']}"}),
        ):
            app = self.work / name
            self.do(self.tree / "bin/capsoc", "new", app)
            self.do(
                "cmake",
                "-S",
                app,
                "-B",
                app / "build",
                "--toolchain",
                app / "toolchain.cmake",
                *options,
                environment=environment,
            )
            self.assertIn(
                expected, self.do("cmake", "--build", app / "build", "--target", "run", environment=environment)
            )

    def test_gdb_knows_the_registers(self):
        listed = self.do(
            "gdb-multiarch", "-nx", "-batch", "-ex", f"source {self.share}/capsoc/gdb/svd.py", "-ex", "svd list"
        )
        self.assertIn("COPROCESSOR", listed)

    def test_pages_and_completions(self):
        page = self.do("man", "-M", self.share / "man", "capsoc-run")
        self.assertIn("coprocessor.arithmetic", re.sub(r".\x08", "", page))
        completion = self.share / "bash-completion/completions/capsoc"
        self.assertEqual(
            self.do("bash", "-c", 'source "$0"; complete -p capsoc', completion), "complete -F _capsoc capsoc\n"
        )
        self.do(
            "zsh",
            "-fc",
            "fpath=($0 $fpath); autoload -Uz compinit; compinit -u -d $PWD/dump; "
            "[[ $_comps[capsoc] == _capsoc ]] && autoload +X _capsoc",
            self.share / "zsh/site-functions",
        )
        self.assertIn(
            "lockstep",
            self.do(
                "fish",
                "--no-config",
                "-c",
                "source $argv[1]; complete -C 'capsoc run --coprocessor '",
                self.share / "fish/vendor_completions.d/capsoc.fish",
            ),
        )

    def test_licence_and_documents(self):
        documents = self.share / "doc/capsoc"
        for name in (
            "LICENSE",
            "README.md",
            "CHANGELOG.md",
            "docs/README.md",
            "docs/guide/installing.md",
            "docs/reference/registers.md",
        ):
            self.assertTrue((documents / name).is_file(), name)
        self.assertIn("Apache License", (documents / "LICENSE").read_text())


if __name__ == "__main__":
    unittest.main()
