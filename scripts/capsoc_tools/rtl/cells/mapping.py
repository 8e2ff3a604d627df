"""Maps the coprocessor to standard cells with yosys, and counts the toggles of the netlist."""

import hashlib
import subprocess
from pathlib import Path

from capsoc_tools.rtl.cells.netlist import FIRST
from capsoc_tools.rtl.synth_flow import TOP, ToolError, design_sources, find, run
from capsoc_tools.rtl.synth_gate import build_program, verilate
from capsoc_tools.rtl.yosys_types import read_design

HERE = Path(__file__).resolve().parent
PACKAGE = "qflow-tech-osu018"
LIBERTY = Path("/usr/share/qflow/tech/osu018/osu018_stdcells.lib")
#: The memories stay as they are. Each module is mapped by itself, so that every cell belongs to a unit.
SCRIPT = """\
{read}
{parameters}
hierarchy -check -top {top}
proc
opt
peepopt
opt_clean
alumacc
share
opt
memory -nomap
opt_clean
memory_map -rom-only
opt -fast -full
techmap
opt -fast
dfflegalize -cell $_DFF_P_ x -cell $_DFFSR_PNN_ x
simplemap
dfflibmap -liberty {liberty}
opt
abc -liberty {liberty} -script +strash;balance;map,-B,0.9;topo
opt_clean -purge
flatten
opt_clean -purge
write_json {folder}/netlist.json
"""


def liberty_file(path=LIBERTY):
    if not path.is_file():
        raise ToolError(f"{path} is missing; install the package {PACKAGE}")
    return path


def is_made(folder, name, *parts):
    """Whether folder/name.key says that this was made of `parts` before; else the key to write when it is made."""
    digest = hashlib.sha256()
    for part in parts:
        digest.update(Path(part).read_bytes() if isinstance(part, Path) else str(part).encode())
    file = folder / f"{name}.key"
    if file.is_file() and file.read_text() == digest.hexdigest():
        return True, digest.hexdigest()
    return False, digest.hexdigest()


def map_cells(parameters, liberty, folder, top=TOP, sources=None):
    """The text of yosys' netlist, kept in `folder` for the next time."""
    folder.mkdir(parents=True, exist_ok=True)
    sources = sources or design_sources(folder / "generated")
    script = SCRIPT.format(
        read=read_design(sources, folder),
        parameters="\n".join(f"chparam -set {name} {value} {top}" for name, value in parameters.items()),
        top=top, liberty=liberty, folder=folder,
    )  # fmt: skip
    made, key = is_made(folder, "netlist", script, liberty, *map(Path, sources))
    if not made:
        (folder / "netlist.ys").write_text(script)
        run([find("yosys", "yosys"), "-q", "-s", str(folder / "netlist.ys")], folder / "yosys.log")
        (folder / "netlist.key").write_text(key)
    return (folder / "netlist.json").read_text()


def build(netlist, parameters, folder):
    """The program count_toggles for the RTL with these parameters; the netlist's table is in folder/table.txt."""
    sources = design_sources(folder / "generated")
    (folder / "table.txt").write_text(netlist.table())
    source = HERE / "count_toggles.cpp"
    made, key = is_made(folder, "program", parameters, source, HERE / "cell_simulator.h", *map(Path, sources))
    if not made:
        for tool, package in (("verilator", "verilator"), ("make", "make"), ("g++", "g++")):
            find(tool, package)
        verilate(TOP, sources, folder, [f"-G{name}={value}" for name, value in parameters.items()])
        build_program(source, [folder / TOP], [HERE], folder)
        (folder / "program.key").write_text(key)
    return folder / source.stem


class Run:
    """Numbers of one run: clocks, those with an open gate, quiet ones, toggles in these, results read; counts by net:
    (half clocks at 1, rises, falls)."""

    def __init__(self, netlist, text):
        head, *lines = text.splitlines()
        memories, nets = len(netlist.memories), len(netlist.numbers) + FIRST
        if len(lines) != memories + nets:
            raise ToolError(f"count_toggles wrote {len(lines)} lines, not {memories + nets}")
        numbers = head.split()
        self.clocks, self.open, self.quiet, self.quiet_toggles, self.results = map(int, numbers[:5])
        self.samples_a_turn = float(numbers[5])
        self.accesses = [tuple(map(int, line.split())) for line in lines[:memories]]
        self.counts = {net: tuple(map(int, lines[memories + FIRST + net].split())) for net in netlist.driven}


class Different(Exception):
    """The netlist and the RTL differ; what the program said."""


def simulate(program, netlist, samples, seed, period, safety, unit_delay=False):
    """A run with a sample every `period` clocks. Different: the netlist is not the RTL."""
    folder = program.parent
    file = folder / f"counts_{period}{'_delay' if unit_delay else ''}.txt"
    words = [folder / "table.txt", samples, seed, period, int(safety), int(unit_delay), file]
    done = subprocess.run([str(program), *map(str, words)], capture_output=True, text=True, check=False)
    if done.returncode == 1:
        raise Different(done.stdout.strip())
    if done.returncode:
        raise ToolError(f"count_toggles failed: {done.stderr.strip()}")
    return Run(netlist, file.read_text())
