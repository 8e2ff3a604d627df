#!/usr/bin/python3
"""docs/guide/python.md: pytest runs its blocks "python test", the interpreter its blocks "python run"."""

import re
import sys
import unittest

from harness import BUILD, SOURCE, Case, output_of

CTEST = {"name": "python guide", "interpreter": "/usr/bin/python3", "timeout": 900}

PAGE = SOURCE / "docs" / "guide" / "python.md"


class Guide(Case):
    def blocks(self, kind):
        return re.findall(rf"^```python {kind}\n(.*?)^```$", PAGE.read_text(), re.MULTILINE | re.DOTALL)

    def run_python(self, *arguments):
        environment = {"CAPSOC": str(BUILD), "PYTHONPATH": str(SOURCE / "platform" / "python")}
        return output_of(sys.executable, *arguments, environment=environment, cwd=self.folder)

    def test_every_block_is_run(self):
        kinds = set(re.findall(r"^```(python[^\n]*)$", PAGE.read_text(), re.MULTILINE))
        self.assertEqual(kinds, {"python test", "python run"})

    def test_the_tests(self):
        blocks = self.blocks("test")
        for number, text in enumerate(blocks):
            (self.folder / f"test_block_{number}.py").write_text(text)
        said = self.run_python("-m", "pytest", "-p", "capsoc.pytest_plugin", "--strict-markers", "-q")
        functions = sum(len(re.findall(r"^def test_", text, re.MULTILINE)) for text in blocks)
        self.assertIn(f"{functions} passed", said)

    def test_the_programs(self):
        blocks = self.blocks("run")
        self.assertGreater(len(blocks), 0)
        for text in blocks:
            self.run_python("-c", text)


if __name__ == "__main__":
    unittest.main()
