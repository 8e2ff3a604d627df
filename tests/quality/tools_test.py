"""scripts/ shows what a user types; the tools lie in scripts/capsoc_tools, and the command `tool` finds each."""

import ast
import re
import subprocess
import unittest

from harness import CLEAN, SOURCE

CTEST = {"name": "quality: tools"}

SCRIPTS = SOURCE / "scripts"
PACKAGE = SCRIPTS / "capsoc_tools"
#: A user types `tool`, sources debugger/svd.py in GDB, and reads the rest in README.md and CONTRIBUTING.md.
TOP = set("setup demo test times tool check_format check_python check_tidy packages.txt capsoc_tools debugger".split())
#: Ways around Python's import, none of which a module with a name needs. This file names them.
AROUND = re.compile(r"SourceFileLoader|sys\.path\.(insert|append)")


def tool(*arguments):
    return subprocess.run([SCRIPTS / "tool", *arguments], capture_output=True, text=True, check=False, env=CLEAN)


def programs():
    """Names of the modules that end with a call of main(), and of the shell scripts."""
    for path in sorted(PACKAGE.rglob("*.py")):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        if any(isinstance(node, ast.If) and "__main__" in ast.dump(node.test) for node in tree.body):
            yield path.stem
    yield from (path.stem for path in sorted(PACKAGE.rglob("*.sh")))


class Places(unittest.TestCase):
    def test_top(self):
        self.assertEqual({path.name for path in SCRIPTS.iterdir() if path.name != "__pycache__"}, TOP)

    def test_names_are_unique(self):
        names = list(programs())
        self.assertGreater(len(names), 20)
        self.assertEqual(len(names), len(set(names)))

    def test_nothing_imports_around_python(self):
        for folder in ("scripts", "tests"):
            for path in (SOURCE / folder).rglob("*.py"):
                if path.name != "tools_test.py":
                    with self.subTest(path):
                        self.assertNotRegex(path.read_text(encoding="utf-8"), AROUND)

    def test_pages_and_lists_name_tools_that_exist(self):
        names = set(programs())
        done = subprocess.run(
            ["git", "-c", "safe.directory=*", "-C", SOURCE, "grep", "-hoE", r"scripts/tool [a-z_]+"],
            capture_output=True,
            text=True,
            check=True,
            env=CLEAN,
        )
        named = {line.split()[1] for line in done.stdout.splitlines()} - {"lists"}
        self.assertGreater(len(named), 15)
        self.assertEqual(named - names, set())


class Command(unittest.TestCase):
    def test_list(self):
        done = tool()
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(set(re.findall(r"(?m)^  (\w+) +\S", done.stdout)), set(programs()))

    def test_help_of_each(self):
        for path in sorted(PACKAGE.rglob("*.py")):
            if path.stem in programs() and "argparse" in path.read_text(encoding="utf-8"):
                with self.subTest(path.stem):
                    done = tool(path.stem, "--help")
                    self.assertEqual((done.returncode, done.stderr), (0, ""))
                    self.assertIn(f"usage: {path.stem} ", done.stdout)

    def test_no_such_tool(self):
        done = tool("nowhere")
        said = "tool: there is no tool 'nowhere'; scripts/tool lists them\n"
        self.assertEqual((done.returncode, done.stdout, done.stderr), (2, "", said))


if __name__ == "__main__":
    unittest.main()
