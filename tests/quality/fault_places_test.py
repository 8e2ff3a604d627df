"""Every place that a list of faults names is still there as its script demands. Nothing is built."""

import contextlib
import importlib.util
import sys
import tempfile
import tomllib
import unittest
from importlib.machinery import SourceFileLoader
from pathlib import Path

from harness import SOURCE

CTEST = {"name": "quality: places of the faults", "whole": True}

MUTATION = SOURCE / "scripts" / "mutation"


def load(path):
    """A program as a module."""
    sys.dont_write_bytecode = True
    with contextlib.ExitStack() as stack:
        sys.path.insert(0, str(path.parent))
        stack.callback(sys.path.remove, str(path.parent))
        loader = SourceFileLoader(path.stem, str(path))
        module = importlib.util.module_from_spec(importlib.util.spec_from_loader(path.stem, loader))
        loader.exec_module(module)
    return module


def listed(path, table):
    return tomllib.loads((SOURCE / path).read_text(encoding="utf-8"))[table]


class FaultPlaces(unittest.TestCase):
    def planted_texts(self, path, old, new, folder=""):
        planted = load(SOURCE / "scripts" / "planted_tree.py")
        faults = listed(path, "fault")
        self.assertGreater(len(faults), 10)
        for fault in faults:
            with self.subTest(fault["name"]):
                file = SOURCE / folder / fault["file"]
                self.assertNotEqual(planted.exchanged(file, fault[old], fault[new]), file.read_text(encoding="utf-8"))

    def test_mutation(self):
        faults = load(MUTATION / "faults")
        every = faults.read_faults(MUTATION / "faults.txt")
        self.assertGreater(len(every), 100)
        with tempfile.TemporaryDirectory() as folder:
            files = faults.mutation.sources(Path(folder), SOURCE / "rtl")
            for fault in every:
                with self.subTest(fault["name"]):
                    faults.planted(files, [fault])
            for arithmetic in ("precise", "paper"):
                faults.planted(files, [fault for fault in every if fault["arithmetic"] in (arithmetic, "both")])

    def test_a_file_that_is_not_there(self):
        faults = load(MUTATION / "faults")
        fault = {"name": "n", "arithmetic": "both", "file": "nowhere.sv", "place": "@(a)@", "new": "b"}
        with self.assertRaisesRegex(faults.mutation.MutationError, "nowhere.sv"):
            faults.planted([SOURCE / "rtl" / "sequencer.sv"], [fault])

    def test_lockstep(self):
        self.planted_texts("tests/rtl/planted_faults.toml", "old", "new")

    def test_common(self):
        self.planted_texts("tests/third_reading/common_faults.toml", "old", "new", "models/coprocessor")

    def test_translator(self):
        self.planted_texts(
            "tests/cortex_m3/translator_faults.toml", "old", "new", "models/cortex_m3/executors/translator"
        )

    def test_verdicts(self):
        self.planted_texts("tests/system/verdict_faults.toml", "text", "fault")

    def test_proofs(self):
        formal = load(SOURCE / "scripts" / "formal")
        for proof in listed("rtl/formal/proofs.toml", "proof"):
            with self.subTest(proof["name"]), tempfile.TemporaryDirectory() as folder:
                fault = proof["fault"]
                text = (SOURCE / "rtl" / fault["file"]).read_text(encoding="utf-8")
                (Path(folder) / fault["file"]).write_text(text, encoding="utf-8")
                formal.plant(fault, Path(folder))


if __name__ == "__main__":
    unittest.main()
