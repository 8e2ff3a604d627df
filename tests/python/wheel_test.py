#!/usr/bin/python3
"""The wheel: built without a network, installed into a virtual environment, and used from there."""

import shutil
import sys
import unittest
import zipfile
from pathlib import Path

from harness import BUILD, SOURCE, Case, output_of

CTEST = {"name": "python wheel", "interpreter": "/usr/bin/python3", "timeout": 900, "whole": True}

EXAMPLE = """
def test_calibrates(capsoc):
    with capsoc.run("selfcal.elf", sensor=capsoc.Sensor(a1=0.6, b1=0.1, noise=1e-4)) as sim:
        sim.uart0.expect(r"(\\d+) s: lock", within=120)
        sim.sensor.b1 += 0.05
        sim.advance(seconds=120)
        assert sim.coprocessor.STATUS.LOCK
        assert sim.samples(last=500).error_deg.abs().max() < 0.01
        assert sim.variable("results") > 25000
"""


class Wheel(Case):
    def do(self, *command, environment=None):
        environment = {"PIP_DISABLE_PIP_VERSION_CHECK": "1", **(environment or {})}
        return output_of(*command, environment=environment, cwd=self.folder)

    def wheel(self):
        shutil.copytree(SOURCE / "platform" / "python", self.folder / "source", ignore=shutil.ignore_patterns("build"))
        options = ("--no-index", "--no-deps", "--no-build-isolation", "--wheel-dir", self.folder)
        self.do(sys.executable, "-m", "pip", "wheel", *options, self.folder / "source")
        (wheel,) = self.folder.glob("capsoc-*-py3-none-any.whl")
        return wheel

    def test_it(self):
        wheel = self.wheel()
        names = set(zipfile.ZipFile(wheel).namelist())
        modules = {f"capsoc/{path.name}" for path in (SOURCE / "platform/python/capsoc").glob("*.py")}
        self.assertLessEqual(modules | {"capsoc/py.typed"}, names)
        # pytest is Debian's; the package and its entry point are the environment's.
        self.do(sys.executable, "-m", "venv", "--system-site-packages", "--without-pip", self.folder / "venv")
        python = self.folder / "venv" / "bin" / "python"
        options = ("--no-index", "--no-deps", "--python", python)
        self.do(sys.executable, "-m", "pip", *options[2:], "install", *options[:2], wheel)
        where = self.do(python, "-c", "import capsoc; print(capsoc.__file__)").strip()
        self.assertTrue(Path(where).is_relative_to(self.folder / "venv"), where)
        (self.folder / "test_example.py").write_text(EXAMPLE)
        program = {"CAPSOC": str(BUILD / "capsoc")}
        said = self.do(python, "-m", "pytest", "--strict-markers", "test_example.py", environment=program)
        self.assertIn("1 passed", said)


if __name__ == "__main__":
    unittest.main()
