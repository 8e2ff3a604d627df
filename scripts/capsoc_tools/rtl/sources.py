"""The coprocessor's SystemVerilog in the order in which tools read it.

rtl/coprocessor.f lists the design, rtl/wrappers.f its tops for other buses, rtl/board.f its tops for FPGA boards,
rtl/probe.f the probe around it.
cmake/rtl_list.cmake is the reader for CMake.
"""

import subprocess
import sys

from capsoc_tools import ROOT

RTL = ROOT / "rtl"
TOOL = ROOT / "scripts" / "tool"
DESIGN = "coprocessor.f"
PROBE = "probe.f"
WRAPPERS = "wrappers.f"
BOARD = "board.f"
REGISTERS = ROOT / "models" / "registers" / "capsoc.svd"
NODES = ROOT / "models" / "coprocessor" / "nodes.def"


class RtlError(Exception):
    """One sentence for the user."""


def read_list(path):
    """The files of a list, as absolute paths. Its lines are paths that begin at the list's folder; // is a comment."""
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except OSError as error:
        raise RtlError(f"{path}: {error.strerror}; it lists the SystemVerilog files, one a line") from error
    files = []
    for number, line in enumerate(lines, 1):
        name = line.split("//", 1)[0].strip()
        if not name:
            continue
        files.append((path.parent / name).resolve())
        if not files[-1].is_file():
            raise RtlError(f"{path}:{number}: there is no file {name}; remove the line or add the file")
    return files


def generate(folder, nodes=False):
    """Writes the generated SystemVerilog into `folder`, which is made: register package, decoder and tables, and with
    `nodes` what the probe includes. Returns the .sv files in reading order."""
    folder.mkdir(parents=True, exist_ok=True)
    commands = [("registers", REGISTERS, folder), ("tables", folder)]
    commands += [("nodes", NODES, folder)] if nodes else []
    for generator, *arguments in commands:
        done = subprocess.run(
            [sys.executable, TOOL, generator, *arguments], capture_output=True, text=True, check=False
        )
        if done.returncode:
            raise RtlError(f"scripts/tool {generator} failed: {(done.stderr or done.stdout).strip()}")
    return sorted(folder.glob("*.sv"))


def sources(folder, rtl=RTL):
    """The whole design: what is generated into `folder`, then the files of coprocessor.f in the folder `rtl`."""
    return [*generate(folder), *read_list(rtl / DESIGN)]
