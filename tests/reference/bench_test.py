#!/usr/bin/env python3
"""The C interface to the reference from outside: a C program, and the example bench under Icarus and under Verilator.

Everything is taken from an installed tree, as a user has it. The oracle of the bench is the RTL, as it is and with a
planted fault.
"""

import re
import shutil
import tempfile
import unittest
from pathlib import Path

from capsoc_tools.faults import planting
from harness import BUILD, SOURCE, output_of

CTEST = {"name": "reference", "timeout": 300}

DESIGN = (BUILD / "generated" / "rtl_sources.txt").read_text(encoding="utf-8").split()
TOP = "capsoc_reference_bench"
STRICT = ("-Wall", "-Wextra", "-Wpedantic", "-Wshadow", "-Werror")
PROGRAM = r"""
#include <capsoc_reference.h>
#include <stdio.h>

int main(void) {
  uint32_t id = 0, error = 1;
  capsoc_reference* reference = capsoc_reference_create(0, 32, 0, 0, 0, 1, 1, 1, 1);
  if (reference == NULL || capsoc_reference_read(reference, 0, &id, &error) != CAPSOC_REFERENCE_OK) return 1;
  printf("%08x %u\n", (unsigned)id, (unsigned)error);
  capsoc_reference_destroy(reference);
  return 0;
}
"""
# The upper word of a coefficient is truncated: the bench reads registers at random, these among them.
FAULT = next(fault for fault in planting.read_list("proofs")["fault"] if fault["proof"] == "pair_words")


class Installed(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = Path(folder.name).resolve()
        output_of("cmake", "--install", BUILD, "--prefix", cls.folder / "capsoc", "--component", "rtl")
        cls.library = next((cls.folder / "capsoc").glob("lib*/**/libcapsoc_reference.so"))
        cls.files = cls.folder / "capsoc/share/capsoc/rtl/reference"
        cls.bench = [cls.files / f"{name}.sv" for name in ("capsoc_reference_monitor", TOP)]
        cls.link = (cls.library, f"-Wl,-rpath,{cls.library.parent}")


class Interface(Installed):
    def test_a_program_in_c_uses_it(self):
        source = self.folder / "main.c"
        source.write_text(PROGRAM, encoding="utf-8")
        program = self.folder / "main"
        output_of("gcc", "-std=c99", *STRICT, f"-I{self.files}", source, "-o", program, *self.link)
        self.assertEqual(output_of(program), "43415053 0\n")

    def test_only_its_functions_are_exported(self):
        exported = {line.split()[-1] for line in output_of("nm", "-D", "--defined-only", self.library).splitlines()}
        header = (self.files / "capsoc_reference.h").read_text(encoding="utf-8")
        self.assertEqual(exported, set(re.findall(r"^\w[\w *]*\b(capsoc_reference_\w+)\(", header, re.MULTILINE)))


class Icarus(Installed):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        module = cls.folder / "capsoc_reference.vpi"
        source = cls.files / "capsoc_reference_vpi.c"
        flags = ("-O1", *STRICT, "-fPIC", "-shared", "-I/usr/include/iverilog")
        output_of("gcc", *flags, source, "-o", module, *cls.link)

    def run_bench(self, design, code, *parameters):
        command = ("iverilog", "-g2012", "-DCAPSOC_REFERENCE_VPI", *parameters, "-s", TOP, "-o", self.folder / "bench")
        output_of(*command, *design, *self.bench)
        return output_of("vvp", f"-M{self.folder}", "-mcapsoc_reference", self.folder / "bench", code=code)

    def test_design_and_reference_agree(self):
        for paper, safety in ((0, 1), (1, 1), (0, 0)):
            said = self.run_bench(DESIGN, 0, f"-P{TOP}.Paper={paper}", f"-P{TOP}.Safety={safety}")
            self.assertRegex(said, r"^8 samples, 1\d\d accesses, \d{4} intervals: 0 differences\n")

    def test_the_kits_verilog_and_reference_agree(self):
        kit = self.folder / "kit"
        output_of(SOURCE / "scripts" / "tool", "rtl_kit", "--verilog", kit)
        for paper, arithmetic in enumerate(("precise", "paper")):
            top = f"capsoc_coprocessor_{arithmetic}"
            file = kit / "verilog" / f"{top}.v"
            output_of("iverilog", "-g2005", "-Wall", "-t", "null", "-s", top, file)
            said = self.run_bench([file], 0, f"-DCAPSOC_DESIGN={top}", f"-P{TOP}.Paper={paper}")
            self.assertRegex(said, r"^8 samples, 1\d\d accesses, \d{4} intervals: 0 differences\n")
            names = re.findall(r"^module +(\S+?)[ (]", file.read_text(), re.MULTILINE)
            self.assertGreater(len(names), 30)
            self.assertEqual([name for name in names if not name.startswith("capsoc_")], [])

    def test_a_fault_is_found(self):
        folder = self.folder / "broken"
        folder.mkdir()
        design = [Path(shutil.copy(file, folder)) for file in DESIGN]
        planting.plant(folder / Path(FAULT["file"]).name, FAULT)
        said = self.run_bench(design, 1)
        self.assertRegex(said, r"interval \d+, prdata: design [0-9a-f]{8}, reference [0-9a-f]{8} \(address 0\w\w\)\n")
        self.assertRegex(said, r": [1-9]\d* differences\n")


class Verilator(Installed):
    def test_design_and_reference_agree(self):
        # Compiled for the compiler's time, all of it at once: the run is short.
        output_of(
            "verilator", "--binary", "--timing", "-O3", "-Wno-lint", "-Wno-style", "-Wno-fatal", "-CFLAGS", "-O0",
            "-MAKEFLAGS", "VM_PARALLEL_BUILDS=0",
            "--top-module", TOP, "--Mdir", self.folder / "objects", "-o", "bench", *DESIGN, *self.bench, self.library,
            "-LDFLAGS", f"-Wl,-rpath,{self.library.parent}",
        )  # fmt: skip
        said = output_of(self.folder / "objects/bench", "+samples=500")
        self.assertRegex(said, r"^500 samples, \d{4,} accesses, \d{5,} intervals: 0 differences\n")


if __name__ == "__main__":
    unittest.main()
