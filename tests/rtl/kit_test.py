#!/usr/bin/env python3
"""scripts/tool rtl_kit: what it writes, as tools read it that are not ours: yosys, xmllint, a reader of YAML."""

import re
import subprocess
import unittest
from xml.etree import ElementTree

import yaml

from capsoc_tools.generate.registers import read_device
from capsoc_tools.rtl.sources import REGISTERS
from harness import CLEAN, SOURCE, Case

CTEST = {"name": "rtl: kit", "whole": True, "timeout": 200}
SPACE = {"x": "http://www.accellera.org/XMLSchema/IPXACT/1685-2014"}
# The commands of the constraints, as a tool for timing has them, in the Tcl of yosys: what they name must be a port.
READER = """
set ports {%s}
proc get_ports names {
  global ports
  set found {}
  foreach name $names {
    set matching [lsearch -all -inline -glob $ports $name]
    if {$matching eq {}} {error "no port $name"}
    lappend found {*}$matching
  }
  return $found
}
proc create_clock args {puts "clock [lindex $args end]"}
proc set_false_path args {puts "false [lindex $args end]"}
proc set_input_delay args {puts "input [lindex $args end]"}
proc set_output_delay args {puts "output [lindex $args end]"}
source coprocessor.sdc
"""


class Kit(Case):
    def setUp(self):
        super().setUp()
        done = self.run_tool(SOURCE / "scripts" / "tool", "rtl_kit", ".")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.core = yaml.safe_load((self.folder / "capsoc_coprocessor.core").read_text().split("\n", 1)[1])
        self.component = ElementTree.parse(self.folder / "capsoc_coprocessor.xml").getroot()

    def run_tool(self, *command):
        return subprocess.run(command, capture_output=True, text=True, check=False, cwd=self.folder, env=CLEAN)

    def words(self, path):
        return [each.text for each in self.component.iterfind(path, SPACE)]

    def test_yosys_reads_the_core_files_list(self):
        first = (self.folder / "capsoc_coprocessor.core").read_text().split("\n", 1)[0]
        self.assertEqual(first, "CAPI=2:")
        target = self.core["targets"]["default"]
        files = [name for part in target["filesets"] for name in self.core["filesets"][part]["files"]]
        self.assertTrue(all((self.folder / name).is_file() for name in files), files)
        sources = " ".join(name for name in files if name.endswith(".sv"))
        parameters = " ".join(
            f"-set {name} {self.core['parameters'][name]['default']}" for name in target["parameters"]
        )
        top = target["toplevel"]
        done = self.run_tool(
            "yosys", "-q", "-p", f"read_verilog -sv {sources}; chparam {parameters} {top}; hierarchy -check -top {top}"
        )
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_every_file_names_its_licence(self):
        for file in self.folder.iterdir():
            if not file.name.startswith(("capsoc_coprocessor_", "paper_sine")):  # generated from these
                self.assertIn("SPDX-License-Identifier: Apache-2.0", file.read_text()[:300], file.name)

    def test_ip_xact_is_of_the_one_description(self):
        done = self.run_tool("xmllint", "--noout", "--nonet", "capsoc_coprocessor.xml")
        self.assertEqual(done.returncode, 0, done.stderr)
        peripheral = next(each for each in read_device(REGISTERS).peripherals if each.name == "COPROCESSOR")
        registers = self.component.findall(".//x:register", SPACE)
        self.assertEqual(
            [each.find("x:name", SPACE).text for each in registers], [r.name for r in peripheral.registers]
        )
        for register, described in zip(registers, peripheral.registers):
            number = register.find("x:addressOffset", SPACE).text
            self.assertEqual(int(number.removeprefix("'h"), 16), described.offset)
            reset = 0
            for part in register.iterfind("x:field", SPACE):
                value = part.find("x:resets/x:reset/x:value", SPACE).text
                reset |= int(value.removeprefix("'h"), 16) << int(part.find("x:bitOffset", SPACE).text)
            self.assertEqual(reset, described.reset, described.name)

    def test_bus_and_ports_are_the_top_modules(self):
        names = self.words(".//x:model/x:ports/x:port/x:name")
        text = (self.folder / "coprocessor.sv").read_text()
        head = text[: text.index("\n);")]
        self.assertEqual(names, re.findall(r"^  (?:input|output) +logic .*?(\w+_[io]),?(?: |$)", head, re.M))
        self.assertTrue(set(self.words(".//x:physicalPort/x:name")) <= set(names))
        self.assertEqual(self.words(".//x:parameters/x:parameter/x:name"), list(self.core["parameters"]))

    def test_constraints_name_ports_of_the_design_and_leave_none_out(self):
        ports = self.words(".//x:model/x:ports/x:port/x:name")
        (self.folder / "check.tcl").write_text(READER % " ".join(ports))
        done = self.run_tool("yosys", "-q", "-c", "check.tcl")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        constrained = {name for line in done.stdout.splitlines() for name in line.split()[1:]}
        self.assertEqual(constrained, set(ports))


if __name__ == "__main__":
    unittest.main()
