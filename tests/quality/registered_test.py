#!/usr/bin/env python3
"""No test can be forgotten: what is written down as one is registered with CTest.

The oracles are unittest's own loader, the sources of the GoogleTest programs, and Git's list of executable files.
"""

import json
import re
import subprocess
import sys
import unittest
from collections import Counter, defaultdict
from pathlib import Path

from harness import BUILD, CLEAN, SOURCE

CTEST = {"name": "quality: registered", "whole": True, "timeout": 120}

TESTS = SOURCE / "tests"
OF_NO_FOLDER = {"benchmarks", "examples", "faults", "foreign", "fuzz", "package", "quality", "system", "third_reading"}
LOADER = """
import importlib.util, pathlib, sys, unittest
path = pathlib.Path(sys.argv[1])
sys.path[:0] = [str(path.parent)]
spec = importlib.util.spec_from_file_location(path.stem, path)
module = importlib.util.module_from_spec(spec)
sys.modules[path.stem] = module
spec.loader.exec_module(module)
def cases(suite):
    for part in suite:
        if isinstance(part, unittest.TestSuite):
            yield from cases(part)
        else:
            yield type(part)
own = {c.__name__ for c in cases(unittest.defaultTestLoader.loadTestsFromModule(module)) if c.__module__ == path.stem}
print(*sorted(own))
"""


def registered():
    """Name -> words of the command, of every CTest entry."""
    done = subprocess.run(
        ["ctest", "--test-dir", BUILD, "--show-only=json-v1"], capture_output=True, check=True, env=CLEAN
    )
    return {
        test["name"]: test.get("command", []) for test in json.loads(done.stdout[done.stdout.index(b"{") :])["tests"]
    }


def classes_of(path):
    """The classes whose tests unittest would run out of a file, by the interpreter in its first line."""
    first = path.read_text(encoding="utf-8").split("\n", 1)[0]
    interpreter = first.removeprefix("#!") if first.startswith("#!/usr/bin/python") else sys.executable
    environment = {
        **CLEAN,
        "CAPSOC_TEST_BUILD": str(BUILD),
        "CAPSOC_TEST_SOURCE": str(SOURCE),
        "PYTHONPATH": f"{TESTS}:{SOURCE / 'scripts'}",
    }
    done = subprocess.run(
        [interpreter, "-c", LOADER, path], capture_output=True, text=True, check=False, env=environment
    )
    if done.returncode != 0:
        raise AssertionError(f"{path}: {done.stderr}")
    return done.stdout.split()


def without_comments(text):
    return re.sub(r"//[^\n]*|/\*.*?\*/", "", text, flags=re.DOTALL)


def googletests(path):
    """Suite.Name of each TEST, TEST_F and TEST_P of a source."""
    found = re.findall(
        r"^\s*TEST(?:_F|_P)?\(\s*(\w+)\s*,\s*(\w+)\s*\)",
        without_comments(path.read_text(encoding="utf-8")),
        re.MULTILINE,
    )
    return [f"{suite}.{name}" for suite, name in found]


class Registered(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.entries = registered()

    def test_python(self):
        files = [
            path
            for path in sorted(TESTS.rglob("*.py"))
            if re.search(r"^(import|from) (unittest|harness)\b", path.read_text(), re.MULTILINE)
        ]
        self.assertGreater(len(files), 40)
        commands = [[word for word in command if not word.startswith("-")] for command in self.entries.values()]
        for path in files:
            if path == TESTS / "harness.py":
                continue
            for name in classes_of(path):
                with self.subTest(path=path, name=name):
                    whole = any(command[1:] == [str(path)] for command in commands)
                    self.assertTrue(
                        whole or any(command[1:] == [str(path), name] for command in commands), "is in no run"
                    )

    def test_googletest(self):
        """A name that several sources have is in as many programs."""
        programs = defaultdict(set)
        for entry in self.entries:
            program, _, name = entry.partition(": ")
            programs[re.sub(r"/.*", "", re.sub(r"^\w+/(?=\w+\.)", "", name))].add(program)
        sources = [path for path in sorted(TESTS.rglob("*.cpp")) if googletests(path)]
        self.assertGreater(len(sources), 100)
        written = Counter(name for path in sources for name in googletests(path))
        for path in sources:
            for name in googletests(path):
                with self.subTest(path=path, name=name):
                    self.assertNotIn("DISABLED", name)
                    self.assertTrue(len(programs[name]) >= written[name], "is in no run")

    def test_folders(self):
        """A folder of tests has the name of its sources' folder (CONTRIBUTING.md), unless it tests no single one."""
        sources = {
            folder.name for top in ("models", "platform", "firmware", "rtl") for folder in (SOURCE / top).rglob("*/")
        }
        sources |= {"rtl", "firmware"}
        folders = {path.name for path in TESTS.iterdir() if path.is_dir() and path.name != "__pycache__"}
        self.assertEqual(sorted(folders - sources - OF_NO_FOLDER), [])

    def test_programs(self):
        """Executable files of tests/ and the checks among the scripts are an entry's command, or named by a test."""
        done = subprocess.run(
            ["git", "-c", "safe.directory=*", "-C", SOURCE, "ls-files", "-s", "tests", "scripts"],
            capture_output=True,
            text=True,
            check=True,
            env=CLEAN,
        )
        files = [Path(line.split("\t")[1]) for line in done.stdout.splitlines() if line.startswith("100755")]
        checked = [path for path in files if path.parts[0] == "tests" or path.name.startswith("check_")]
        self.assertGreater(len(checked), 2)
        commands = {word for command in self.entries.values() for word in command}
        self.assertLessEqual({"lint_rtl", "formal", "synth"}, commands)
        sources = "\n".join(path.read_text(encoding="utf-8") for path in TESTS.rglob("*_test.py"))
        for path in checked:
            with self.subTest(path):
                self.assertTrue(str(SOURCE / path) in commands or f'"{path.name}"' in sources, "is in no run")


if __name__ == "__main__":
    unittest.main()
