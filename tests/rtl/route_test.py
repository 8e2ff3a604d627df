#!/usr/bin/env python3
"""scripts/tool route as far as Debian 12 has its tools: the netlist of an ECP5 against the RTL. And the table."""

import json
import shutil
import subprocess
import unittest
from pathlib import Path

from capsoc_tools.rtl import route
from capsoc_tools.rtl.hardware_table import BadFile, table
from capsoc_tools.rtl.synth_flow import ToolError, for_verilator, write_figures
from capsoc_tools.rtl.synth_gate import unit_gate
from harness import CLEAN, SOURCE, Case

CTEST = {"name": "rtl: route", "timeout": 300}


class Netlist(Case):
    def compare(self, unit, damage=lambda text: text):
        """What the simulation of a unit's netlist says; `damage` of the models of its cells."""
        files = route.design_sources(self.folder / "generated")
        flow = "; ".join([f"synth_ecp5 -top {unit}", *for_verilator(unit, self.folder)])
        route.synthesise(files, {}, unit, self.folder, flow)
        cells = route.cell_models(self.folder)
        (self.folder / "cells.v").write_text(damage((self.folder / "cells.v").read_text()))
        return unit_gate(unit, files, self.folder, 1000, cells)

    def test_multipliers(self):
        same, text = self.compare("multiplier_34x34")
        self.assertTrue(same, text)
        self.assertIn("MULT18X18D", (self.folder / "netlist.v").read_text())

    def test_a_multiplier_without_signs_is_found(self):
        same, text = self.compare("multiplier_34x34", lambda text: text.replace("SIGNEDA & A17", "1'b0"))
        self.assertFalse(same)
        self.assertIn("DIFFERENT", text)

    def test_block_memory(self):
        same, text = self.compare("results_memory")
        self.assertTrue(same, text)
        self.assertIn("DP16KD", (self.folder / "netlist.v").read_text())

    def test_a_memory_in_another_use_stops_the_simulation(self):
        other = "DATA_WIDTH_A != 36"
        same, text = self.compare("results_memory", lambda text: text.replace(other, "DATA_WIDTH_A != 18"))
        self.assertFalse(same)
        self.assertIn("DP16KD: neither 512 words of 36 bits nor 2,048 of 9", text)


class Tools(Case):
    def test_a_machine_without_nextpnr_is_told_where_it_is(self):
        for name in ("yosys", "python3"):
            (self.folder / name).symlink_to(shutil.which(name))
        environment = {**CLEAN, "PATH": str(self.folder)}
        command = [shutil.which("python3"), SOURCE / "scripts" / "tool", "route"]
        done = subprocess.run(command, capture_output=True, text=True, check=False, env=environment)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn("nextpnr-ecp5 is missing; install the package nextpnr-ecp5 of Debian 13", done.stderr)

    def test_figures_that_cannot_be_written_are_said(self):
        with self.assertRaisesRegex(ToolError, "--json: cannot write '.*none/x.json': No such file"):
            write_figures(self.folder / "none" / "x.json", {})


class Table(Case):
    def write(self, name, **found):
        (self.folder / name).write_text(json.dumps(found))
        return str(self.folder / name)

    def setUp(self):
        super().setUp()
        area = {"alm": 4059, "registers": 3553, "dsp": 12, "memory_bits": 76800}
        design = {"area": area, "longest_path_ns": 13.46}
        self.area = self.write("area.json", table_7={}, channels=1, precise=design)
        self.four = self.write("four.json", table_7={}, channels=4, precise={**design, "longest_path_ns": None})
        cells = {"LUT4": 11371, "registers": 3773, "MULT18": 23}
        designs = {"precise": {"cells": cells, "median_mhz": 39.42, "xilinx": None}}
        self.routed = self.write("route.json", channels=1, designs=designs)

    def test_rows_are_variants(self):
        head, rule, one, four = table([self.four, self.area, self.routed])
        titles = "arithmetic | channels | ALM | registers | DSP | memory bits | path, ns | LUT4 | MULT18 | routed, MHz"
        self.assertEqual(head, f"| {titles} |")
        self.assertEqual(rule.count("---"), 10)
        self.assertEqual(one, "| `precise` | 1 | 4,059 | 3,553 | 12 | 76,800 | 13.5 | 11,371 | 23 | 39.4 |")
        self.assertEqual(four, "| `precise` | 4 | 4,059 | 3,553 | 12 | 76,800 | - | - | - | - |")

    def test_what_is_no_figure_is_refused(self):
        wrong = self.write("wrong.json", designs={})
        for files, sentence in (
            ([self.area, self.area], "gives 'ALM' of precise, 1 channels, again"),
            ([str(self.folder / "none.json")], "cannot read"),
            ([self.write("other.json", some=1)], "is nothing that synth, route or power of this version wrote"),
        ):
            command = [SOURCE / "scripts" / "tool", "hardware_table", *files]
            done = subprocess.run(command, capture_output=True, text=True, check=False, env=CLEAN)
            self.assertEqual((done.returncode, done.stdout), (2, ""))
            self.assertIn(sentence, done.stderr)
        self.assertEqual(len(table([wrong])), 2)

    def test_a_netlist_that_differs_from_the_rtl_has_no_row(self):
        for name, change in ((self.area, {"netlist": {"identical": False}}), (self.routed, {"identical": False})):
            found = json.loads(Path(name).read_text())
            designs = found.get("designs", found)
            designs["precise"] |= change
            Path(name).write_text(json.dumps(found))
            with self.assertRaisesRegex(BadFile, "the netlist of precise differed from the RTL"):
                table([name])


if __name__ == "__main__":
    unittest.main()
