"""The design's files in a form that the installed yosys reads.

The types of coprocessor_types.sv and of the generated files belong to no package, because Icarus Verilog 11 aborts at
a package's. Some later versions of yosys (0.52 of Debian 13) do not know the width of such a struct in a port, and stop
with an assertion in genrtlil.cc. They do know it for an alias of a package's type, whose members yosys 0.23 in turn
does not find. So the form is chosen by what the installed yosys does with an example.
"""

import functools
import re
import subprocess
import tempfile
from pathlib import Path

PACKAGE = "capsoc_types"
# A type between modules: it begins in the first column and ends with its name.
TYPE = re.compile(r"^typedef (?:struct packed \{.*?^\}|[^;{]*?) (\w+);[^\n]*\n", re.M | re.S)
EXAMPLE = """\
typedef struct packed {
  logic [3:0] word;
} example_t;
module example(input example_t from_i, output logic [3:0] word_o);
  assign word_o = from_i.word;
endmodule
"""


@functools.cache
def reads_types_between_modules():
    """Whether the yosys on the path reads a port of a type that belongs to no package. OSError: there is no yosys."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "example.sv").write_text(EXAMPLE, encoding="utf-8")
        command = ["yosys", "-q", "-p", "read_verilog -sv example.sv; hierarchy -check -top example"]
        return subprocess.run(command, cwd=folder, capture_output=True, check=False).returncode == 0


def in_a_package(files, folder):
    """Copies of the files in `folder` without their types, after a file that has them in a package, with an alias of
    each. The line of a statement stays the same."""
    folder.mkdir(parents=True, exist_ok=True)
    types, names, copies = [], [], []
    for file in map(Path, files):
        text = file.read_text(encoding="utf-8")
        for found in TYPE.finditer(text):
            types.append(found[0])
            names.append(found[1])
        copies.append(folder / file.name)
        copies[-1].write_text(TYPE.sub(lambda found: "\n" * found[0].count("\n"), text), encoding="utf-8")
    package = folder / f"{PACKAGE}.sv"
    aliases = [f"typedef {PACKAGE}::{name} {name};\n" for name in names]
    package.write_text("".join([f"package {PACKAGE};\n", *types, "endpackage\n", *aliases]), encoding="utf-8")
    return [package, *copies]


def read_design(files, folder, options=""):
    """The command of yosys that reads the files; copies that it may need go to `folder`."""
    return f"read_verilog -sv {options}{' '.join(map(str, readable(files, folder)))}"


def readable(files, folder):
    """The files as the installed yosys reads them: themselves, or copies in the new folder `folder`/types."""
    return [*files] if reads_types_between_modules() else in_a_package(files, Path(folder) / "types")
