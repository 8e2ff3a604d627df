"""scripts/tool power: Liberty reader, simulator, energies and SAIF file, each with figures that are known without it;
and the Liberty tables as OpenSTA reads them."""

import contextlib
import io
import subprocess
import unittest
from pathlib import Path
from unittest import mock

from capsoc_tools.rtl import power
from capsoc_tools.rtl.cells import mapping, opensta
from capsoc_tools.rtl.cells.energy import costs_of, total
from capsoc_tools.rtl.cells.liberty import read_liberty
from capsoc_tools.rtl.cells.netlist import FIRST, Netlist
from capsoc_tools.rtl.cells.saif import read_saif, write_saif
from harness import CLEAN, SOURCE, Case, output_of

CTEST = {"name": "rtl: power", "whole": True, "timeout": 300}

ONLY_DEBIAN_12 = unittest.skipUnless(
    "bookworm" in Path("/etc/os-release").read_text(encoding="utf-8"), f"{mapping.PACKAGE} is only in Debian 12"
)
LIBERTY = """
library (hand) {
  time_unit : "1ns";  voltage_unit : "1V";  leakage_power_unit : "1nW";
  capacitive_load_unit (1, pf);  nom_voltage : 2.0;
  power_lut_template (grid) {
    variable_1 : total_output_net_capacitance;  variable_2 : input_transition_time;
    index_1 ("0.01, 0.03");  index_2 ("0.1, 0.3");
  }
  cell (INV) {
    cell_leakage_power : 3;
    pin (A) { direction : input; capacitance : 0.02; }
    pin (Y) { direction : output; function : "(!A)"; /* two lines of values */
      internal_power () { related_pin : "A";
        rise_power (grid) { values ("1, 2", \\
                                    "3, 4"); }
        fall_power (grid) { values ("10, 20", "30, 40"); }
      }
    }
  }
  cell (DFF) {
    cell_leakage_power : 5;
    ff (IQ, IQN) { next_state : "D"; clocked_on : "CLK"; }
    pin (CLK) { direction : input; capacitance : 0.005; clock : true;
      internal_power () { rise_power (scalar) { values ("7"); } fall_power (scalar) { values ("8"); } } }
    pin (D) { direction : input; capacitance : 0.01; }
    pin (Q) { direction : output; function : "IQ"; }
  }
}
"""
#: pclk_i clocks a flip-flop with q; its data is y, q inverted.
NETLIST = """{"modules": {"toggle": {
  "ports": {"pclk_i": {"direction": "input", "bits": [2]}, "q": {"direction": "output", "bits": [3]}},
  "cells": {
    "u_a.$1": {"type": "INV", "connections": {"A": [3], "Y": [4]}},
    "$flatten\\\\u_b.$2": {"type": "DFF", "connections": {"CLK": [2], "D": [4], "Q": [3]}}}}}}"""
COUNTER = """module counter #(parameter Bits = 8) (input pclk_i, presetn_i, output reg [Bits-1:0] q);
  always @(posedge pclk_i or negedge presetn_i) if (!presetn_i) q <= 0; else q <= q + 1;
endmodule
"""
#: Arguments: table, delay, port to set or clock, changes. Prints the edges of every net.
DRIVER = """#include "cell_simulator.h"
#include <cstdio>
#include <cstdlib>
int main(int, char** argv) {
  CellSimulator cells(argv[1], argv[2][0] == '1');
  const std::string port = argv[3];
  if (port == "pclk_i") {
    cells.clock();
    cells.set(cells.port("presetn_i"), 1);
  }
  cells.settle();
  cells.start();
  for (int i = 0; i < std::atoi(argv[4]); ++i) {
    if (port == "pclk_i") cells.clock(); else cells.set(cells.port(port), i % 2 == 0);
    cells.settle();
    cells.half_clock();
  }
  for (std::size_t i = 0; i < cells.nets(); ++i) {
    const Edges net = cells.edges(i);
    std::printf("%d %d %d\\n", static_cast<int>(net.high), static_cast<int>(net.rises), static_cast<int>(net.falls));
  }
}
"""


def hand_library(folder):
    (folder / "hand.lib").write_text(LIBERTY)
    return read_liberty(folder / "hand.lib")


class Energy(Case):
    def test_table(self):
        rise = hand_library(self.folder).cells["INV"].pins["Y"].powers[0].rise
        self.assertAlmostEqual(rise.at(0.02e-12, 0.15e-9) / 1e-12, 1 + 1 + 0.25)  # half of 2, a quarter of 1
        self.assertAlmostEqual(rise.at(0.05e-12, 0.1e-9) / 1e-12, 5)  # beyond the end

    def test_by_hand(self):
        netlist = Netlist(NETLIST, hand_library(self.folder))
        self.assertEqual({cell.unit for cell in netlist.cells}, {"a", "b"})
        q, y = netlist.cells[0].pins["A"], netlist.cells[0].pins["Y"]
        units = costs_of(netlist, 0.1e-9).spent({q: (0, 3, 2), y: (0, 2, 3)})
        # y has 0.01 pF: 0.02 pJ an edge, and tables with 1 and 10 pJ. q has 0.02 pF: 0.04 pJ.
        self.assertAlmostEqual(units["a"].gates / 1e-12, 5 * 0.02 + 2 * 1 + 3 * 10)
        self.assertAlmostEqual(units["b"].registers / 1e-12, 5 * 0.04)
        self.assertAlmostEqual(units["b"].clock / 1e-12, 7 + 8 + 0.005 * 2**2)
        self.assertAlmostEqual(total(units).leakage / 1e-9, 8)
        self.assertEqual((units["a"].toggles, units["b"].toggles), (5, 5))

    @ONLY_DEBIAN_12
    def test_opensta(self):
        library = read_liberty(mapping.LIBERTY)
        kinds = [name for name, cell in library.cells.items() if not cell.other_state]
        with contextlib.redirect_stdout(io.StringIO()):
            found = opensta.compare(kinds, library, mapping.LIBERTY, 0.3e-9, self.folder)
        self.assertEqual(found["kinds"], len(kinds))
        self.assertLess(found["largest_difference"], 1e-6)


class Toggles(Case):
    def simulate(self, table, delay, port, changes):
        """(half clocks at 1, rises, falls) by net of the netlist."""
        folder = self.folder
        (folder / "table.txt").write_text(table)
        (folder / "driver.cpp").write_text(DRIVER)
        include = SOURCE / "scripts/capsoc_tools/rtl/cells"
        output_of("g++", "-std=c++17", "-O1", f"-I{include}", folder / "driver.cpp", "-o", folder / "driver")
        said = output_of(folder / "driver", folder / "table.txt", int(delay), port, changes)
        return [tuple(map(int, line.split())) for line in said.splitlines()][FIRST:]

    @ONLY_DEBIAN_12
    def test_counter(self):
        (self.folder / "counter.v").write_text(COUNTER)
        source, library = str(self.folder / "counter.v"), read_liberty(mapping.LIBERTY)
        for bits in (3, 8):
            text = mapping.map_cells({"Bits": bits}, mapping.LIBERTY, self.folder / "work", "counter", [source])
            netlist = Netlist(text, library)
            for delay in (False, True):
                counts = self.simulate(netlist.table(), delay, "pclk_i", 2**bits)
                nets = [counts[net] for net in netlist.ports["q"][1]]
                self.assertEqual(sum(rises + falls for _, rises, falls in nets), 2 ** (bits + 1) - 2)
                self.assertEqual([high for high, _, _ in nets], [2 ** (bits - 1)] * bits)

    def test_glitch(self):
        """y = a & ~a: a pulse after each rise of a if cells take time, else nothing."""
        table = "5\nport a 1 2\ncell 1 3 1 2\ncell 8 4 2 2 3\n"
        self.assertEqual(self.simulate(table, False, "a", 10), [(5, 5, 5), (5, 5, 5), (0, 0, 0)])
        self.assertEqual(self.simulate(table, True, "a", 10), [(5, 5, 5), (5, 5, 5), (0, 5, 5)])

    def test_saif(self):
        file, nets = self.folder / "x.saif", {"n0": (60, 40, 3), "n12": (0, 100, 0)}
        write_saif(file, "top", 100, nets)
        self.assertEqual(read_saif(file), (100, nets))
        file.write_text(file.read_text().replace("(DURATION 100)", ""))
        self.assertRaises(ValueError, read_saif, file)


class Command(Case):
    def test_missing_package(self):
        command = [SOURCE / "scripts/tool", "power", "--liberty", "nowhere.lib", "--work", self.folder]
        done = subprocess.run(command, capture_output=True, text=True, check=False, env=CLEAN)
        said = "power: nowhere.lib is missing; install the package qflow-tech-osu018\n"
        self.assertEqual((done.returncode, done.stdout, done.stderr), (2, "", said))

    def test_different(self):
        """A program that says that outputs differ: status 1 and what it said."""
        program = self.folder / "count_toggles"
        program.write_text("#!/bin/sh\necho clock 7: the netlist differs from the RTL\nexit 1\n")
        program.chmod(0o755)
        said = io.StringIO()
        with (
            mock.patch.object(power.mapping, "map_cells", return_value=NETLIST),
            mock.patch.object(power.mapping, "build", return_value=program),
            contextlib.redirect_stdout(io.StringIO()),
            contextlib.redirect_stderr(said),
        ):
            (self.folder / "hand.lib").write_text(LIBERTY)
            (self.folder / "paper").mkdir()
            words = ["--arithmetic", "paper", "--liberty", self.folder / "hand.lib", "--work", self.folder]
            status = power.main([str(word) for word in words])
        self.assertEqual((status, said.getvalue()), (1, "power: clock 7: the netlist differs from the RTL\n"))


if __name__ == "__main__":
    unittest.main()
