#!/usr/bin/env python3
"""scripts/tool rtl_kit: what it writes, as tools read it that are not ours: yosys, xmllint, a reader of YAML."""

import re
import subprocess
import unittest
from xml.etree import ElementTree

import yaml

from capsoc_tools.generate.registers import read_device
from capsoc_tools.rtl.sources import REGISTERS
from capsoc_tools.rtl.yosys_types import read_design
from harness import CLEAN, SOURCE, Case

CTEST = {"name": "rtl: kit", "whole": True, "timeout": 200}
BENCH = "capsoc_reference_bench"
COMPONENTS = {"default": "capsoc_coprocessor", "ahb_lite": "capsoc_coprocessor_ahb_lite"}
COMPONENTS["axi4_lite"] = "capsoc_coprocessor_axi4_lite"
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
source %s.sdc
"""


class Kit(Case):
    def setUp(self):
        super().setUp()
        done = self.run_tool(SOURCE / "scripts" / "tool", "rtl_kit", ".")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.core = yaml.safe_load((self.folder / "capsoc_coprocessor.core").read_text().split("\n", 1)[1])
        self.components = {
            target: ElementTree.parse(self.folder / f"{name}.xml").getroot() for target, name in COMPONENTS.items()
        }
        self.assertEqual(set(self.core["targets"]), set(COMPONENTS))

    def each_target(self):
        """(its part of the core file, its component of IP-XACT) of each target."""
        return [(self.core["targets"][target], component) for target, component in self.components.items()]

    def files_of(self, target):
        return [name for part in target["filesets"] for name in self.core["filesets"][part]["files"]]

    def run_tool(self, *command):
        return subprocess.run(command, capture_output=True, text=True, check=False, cwd=self.folder, env=CLEAN)

    @staticmethod
    def words(component, path):
        return [each.text for each in component.iterfind(path, SPACE)]

    def test_yosys_reads_the_core_files_list(self):
        first = (self.folder / "capsoc_coprocessor.core").read_text().split("\n", 1)[0]
        self.assertEqual(first, "CAPI=2:")
        for target, _ in self.each_target():
            files = self.files_of(target)
            self.assertTrue(all((self.folder / name).is_file() for name in files), files)
            named = [self.folder / name for name in files if name.endswith(".sv")]
            read = read_design(named, self.folder / target["toplevel"])
            parameters = " ".join(
                f"-set {name} {self.core['parameters'][name]['default']}" for name in target["parameters"]
            )
            top = target["toplevel"]
            script = f"{read}; chparam {parameters} {top}; hierarchy -check -top {top}"
            done = self.run_tool("yosys", "-q", "-p", script)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_simulators_read_the_list(self):
        for target, _ in self.each_target():
            for command in (("iverilog", "-g2012", "-t", "null", "-s"), ("verilator", "--lint-only", "--top-module")):
                done = self.run_tool(*command, target["toplevel"], "-f", "capsoc_coprocessor.f")
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_every_shared_name_has_the_prefix(self):
        """As Verilator sees the modules, packages and types outside of modules, of all files and of the bench."""
        for top, files in ((t["toplevel"], self.files_of(t)) for t, _ in self.each_target()):
            command = ("verilator", "--xml-only", "--xml-output", "design.xml", "-Wno-fatal", "--top-module", top)
            done = self.run_tool(*command, *(name for name in files if name.endswith(".sv")))
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            design = ElementTree.parse(self.folder / "design.xml").getroot()
            names = [each.get("origName") or each.get("name") for each in design.iterfind(".//module")]
            names += [each.get("name") for each in design.iterfind(".//package") if each.get("name") != "$unit"]
            names += [each.get("name") for each in design.iterfind(".//package[@name='$unit']/typedef")]
            self.assertGreater(len(names), 50)
            self.assertEqual([name for name in names if not name.startswith("capsoc_")], [])
        macros = re.findall(r"`define +(\w+)", "".join(file.read_text() for file in self.folder.rglob("*.sv")))
        self.assertIn("CAPSOC_CORE_PORTS", macros)
        self.assertEqual([name for name in macros if not name.startswith("CAPSOC_")], [])
        self.assertEqual([file.name for file in self.folder.glob("*.sv") if not file.name.startswith("capsoc_")], [])

    def test_a_word_in_a_comment_stays(self):
        text = (self.folder / "capsoc_sequencer.sv").read_text()
        original = (SOURCE / "rtl" / "sequencer.sv").read_text()
        self.assertIn("\nmodule capsoc_sequencer #(", text)
        self.assertEqual(text.splitlines()[1], original.splitlines()[1])

    def test_every_file_names_its_licence(self):
        for file in self.folder.iterdir():
            generated = (
                "capsoc_coprocessor_pkg",
                "capsoc_coprocessor_selects",
                "capsoc_coprocessor_settings",
                "capsoc_paper_sine",
            )
            if file.is_file() and not file.name.startswith(generated):
                self.assertIn("SPDX-License-Identifier: Apache-2.0", file.read_text()[:300], file.name)

    def test_ip_xact_is_of_the_one_description(self):
        peripheral = next(each for each in read_device(REGISTERS).peripherals if each.name == "COPROCESSOR")
        for target, component in self.each_target():
            done = self.run_tool("xmllint", "--noout", "--nonet", f"{target['toplevel']}.xml")
            self.assertEqual(done.returncode, 0, done.stderr)
            registers = component.findall(".//x:register", SPACE)
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
        for target, component in self.each_target():
            names = self.words(component, ".//x:model/x:ports/x:port/x:name")
            text = (self.folder / f"{target['toplevel']}.sv").read_text()
            head = text[: text.index("\n);")]
            self.assertEqual(names, re.findall(r"^  (?:input|output) +logic .*?(\w+_[io]),?(?: |$)", head, re.M))
            # All ports but those of samples and interrupt are the bus's.
            others = [name for name in names if name.startswith(("sample_", "irq_", "idle_"))]
            mapped = self.words(component, ".//x:physicalPort/x:name")
            self.assertEqual(sorted(mapped + others), sorted(names))
            self.assertEqual(
                [name.lower().removesuffix("x") for name in self.words(component, ".//x:logicalPort/x:name")],
                [name[:-2] for name in mapped],
            )
            self.assertEqual(self.words(component, ".//x:parameters/x:parameter/x:name"), list(self.core["parameters"]))
            listed = self.words(component, ".//x:fileSet/x:file/x:name")
            self.assertEqual(listed, [name for name in self.files_of(target) if name.endswith(".sv")])

    def test_constraints_name_ports_of_the_design_and_leave_none_out(self):
        for target, component in self.each_target():
            ports = self.words(component, ".//x:model/x:ports/x:port/x:name")
            (self.folder / "check.tcl").write_text(READER % (" ".join(ports), target["toplevel"]))
            done = self.run_tool("yosys", "-q", "-c", "check.tcl")
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            constrained = {name for line in done.stdout.splitlines() for name in line.split()[1:]}
            self.assertEqual(constrained, set(ports))


if __name__ == "__main__":
    unittest.main()
