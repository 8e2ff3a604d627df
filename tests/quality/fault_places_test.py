"""Every place that a list of faults names is still there as its runner demands. Nothing is built.

The lists are those of the folder tests/faults: a new one is checked without being named here.
"""

import re
import subprocess
import tempfile
import tomllib
import unittest
from pathlib import Path

from capsoc_tools.faults import planted_common_faults, planting
from capsoc_tools.faults.mutation import regression_faults
from capsoc_tools.rtl import formal, sources as rtl_sources
from harness import SOURCE

CTEST = {"name": "quality: places of the faults", "whole": True}


def fault(**keys):
    return {"name": "n", "file": "a.sv", "old": "b", "new": "c", **keys}


class FaultPlaces(unittest.TestCase):
    def test_every_list(self):
        names, count = planting.list_names(), 0
        self.assertGreater(len(names), 5)
        with tempfile.TemporaryDirectory() as folder:
            rtl_sources.generate(Path(folder))
            for name in names:
                faults = planting.read_list(name)["fault"]
                self.assertGreater(len(faults), 0, name)
                count += len(faults)
                for fault in faults:
                    with self.subTest(list=name, fault=fault["name"]):
                        planting.check_place(fault, Path(folder))
        self.assertGreater(count, 400)

    def test_what_a_runner_changes_itself(self):
        planting.check_place(planted_common_faults.NO_ERRORS, SOURCE)

    def test_every_list_has_a_runner_that_reads_it(self):
        for name in planting.list_names():
            with self.subTest(name):
                program, tool, *_ = planting.read_list(name)["runner"].split()
                self.assertEqual(program, "scripts/tool")
                (module,) = (SOURCE / "scripts" / "capsoc_tools").rglob(f"{tool}.py")
                self.assertIn(f'"{name}"', module.read_text(encoding="utf-8"))

    def test_the_page_has_the_numbers(self):
        page = (SOURCE / "docs/explanation/verification.md").read_text(encoding="utf-8")
        table = dict(re.findall(r"^\| `(\w+)\.toml` \| (\d+) \| `scripts/tool", page, re.MULTILINE))
        counts = {name: str(len(planting.read_list(name)["fault"])) for name in planting.list_names()}
        self.assertEqual(table, counts)

    def test_no_list_is_elsewhere(self):
        for folder in ("scripts", "tests", "rtl", "models", "campaigns"):
            for path in (SOURCE / folder).rglob("*.toml"):
                if path.parent == planting.LISTS or "build" in path.parts:
                    continue
                with self.subTest(path):
                    self.assertNotRegex(path.read_text(encoding="utf-8"), r"(?m)^old *=", "move it to tests/faults")

    def test_faults_of_the_regression_fit_into_one_copy(self):
        every = planting.read_list("regression")["fault"]
        with tempfile.TemporaryDirectory() as folder:
            files = regression_faults.mutation.sources(Path(folder), SOURCE / "rtl")
            for arithmetic in ("precise", "paper"):
                chosen = regression_faults.of_arithmetic(every, arithmetic)
                texts = regression_faults.planted(files, chosen)
                for number in range(1, len(chosen) + 1):
                    self.assertEqual(sum(text.count(f"faults::selected == {number} ?") for text in texts.values()), 1)
                # What is exchanged has to be an expression.
                copy = regression_faults.write_copy(chosen, Path(folder) / arithmetic, SOURCE / "rtl")
                paper = f"-GPaper={int(arithmetic == 'paper')}"
                command = ("verilator", "--lint-only", "-Wno-lint", "-Wno-fatal", "--top-module", "coprocessor", paper)
                done = subprocess.run((*command, *copy), capture_output=True, text=True, check=False)
                self.assertEqual(done.returncode, 0, done.stderr[:2000])

    def test_a_file_that_is_not_there(self):
        with self.assertRaisesRegex(planting.PlantError, "nowhere.sv"):
            regression_faults.planted([SOURCE / "rtl" / "sequencer.sv"], [fault(file="rtl/nowhere.sv")])

    def test_every_proof_has_a_fault(self):
        proofs = formal.read_proofs()
        listed = tomllib.loads((SOURCE / "rtl/formal/proofs.toml").read_text(encoding="utf-8"))["proof"]
        self.assertEqual(list(proofs), [proof["name"] for proof in listed])
        self.assertEqual(
            sum(len(proof["faults"]) for proof in proofs.values()), len(planting.read_list("proofs")["fault"])
        )

    def test_campaigns_have_as_many_faults_as_their_lists(self):
        for campaign, name in (
            ("planted_faults", "lockstep"),
            ("translator_faults", "translator"),
            ("verdict_faults", "verdicts"),
        ):
            with self.subTest(campaign):
                text = (SOURCE / "campaigns" / f"{campaign}.toml").read_text(encoding="utf-8")
                axis = tomllib.loads(text)["axes"][0]["value"]["fault"]
                count = len(planting.read_list(name)["fault"])
                self.assertEqual(axis, {"range": [1, count], "points": count})
                self.assertIn(f"tests/faults/{name}.toml", tomllib.loads(text)["settings"]["command"]["inputs"])


class Lists(unittest.TestCase):
    """What is no list is refused with a sentence that names the file."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def refused(self, text, said):
        (self.folder / "l.toml").write_text(text, encoding="utf-8")
        with self.assertRaisesRegex(planting.PlantError, rf"l\.toml.*{said}"):
            planting.read_list("l", self.folder)

    FAULT = '[[fault]]\nname = "n"\nfile = "f"\nold = "a"\n'

    def test_good(self):
        text = 'runner = "r"\nrequires = ["x"]\nallows = ["y"]\n' + self.FAULT + 'new = "b"\nx = 1\nafter = "z"\n'
        (self.folder / "l.toml").write_text(text, encoding="utf-8")
        self.assertEqual(planting.read_list("l", self.folder)["fault"][0]["after"], "z")

    def test_refused(self):
        new = self.FAULT + 'new = "b"\n'
        self.refused("runner =", "Invalid value")
        self.refused(new, "no key 'runner'")
        self.refused('runner = "r"\n' + self.FAULT, "no key 'new'")
        self.refused('runner = "r"\n' + new + "other = 1", "unknown key 'other'")
        self.refused('runner = "r"\nrequires = ["names"]\n' + new, "no key 'names'")
        self.refused('runner = "r"\n' + new + new, "is there twice")
        self.refused('runner = "r"\n' + self.FAULT + 'new = "a"', "changes nothing")
        with self.assertRaisesRegex(planting.PlantError, "No such file"):
            planting.read_list("nowhere", self.folder)


class Planter(unittest.TestCase):
    def test_exchange(self):
        self.assertEqual(planting.exchanged("x b y b", fault(before="x ")), "x c y b")
        self.assertEqual(planting.exchanged("x b y b", fault(before="y ", after="")), "x b y c")

    def test_place_that_is_not_there_once(self):
        for text in ("", "x b y b"):
            with self.assertRaisesRegex(planting.PlantError, r"a\.sv holds the place of 'n' [02] times: 'b'"):
                planting.exchanged(text, fault())

    def test_tree_is_whole_again(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "a.sv"
            file.write_text("a b", encoding="utf-8")
            with self.assertRaises(KeyError), planting.planted(Path(folder), fault()):
                self.assertEqual(file.read_text(encoding="utf-8"), "a c")
                raise KeyError
            self.assertEqual(file.read_text(encoding="utf-8"), "a b")

    def test_several_in_one_text(self):
        faults = [fault(name="1"), fault(name="2", new="d"), fault(name="3", before="y ", old="e")]
        self.assertEqual(
            planting.all_planted("x b y e", faults, lambda f: f"s == {f['name']}"),
            "x (s == 2 ? (d) : (s == 1 ? (c) : (b))) y (s == 3 ? (c) : (e))",
        )
        with self.assertRaisesRegex(planting.PlantError, "overlaps"):
            planting.all_planted("x b y", [fault(), fault(name="m", old="x b")], lambda f: f["name"])


if __name__ == "__main__":
    unittest.main()
