"""Writes the coprocessor's RTL as a kit for other projects: sources, FuseSoC core file, IP-XACT, SDC.

usage: rtl_kit [--verilog] FOLDER

FOLDER gets the SystemVerilog, with what scripts generate. Modules, packages, types, macros and files have names that
begin with capsoc_, so that a project's own do not meet them. Next to it:
- capsoc_coprocessor.core, CAPI 2: the files in reading order, the parameters, a target for each top:
  default (APB), ahb_lite, axi4_lite
- capsoc_coprocessor.f, the same files for simulators: -f in FOLDER
- IP-XACT (IEEE 1685-2014) of each top, as capsoc_coprocessor.xml: bus interface, ports, registers as
  models/registers/capsoc.svd describes them
- constraints of each top, as capsoc_coprocessor.sdc
- reference/: the bench that compares a design with the reference model, and the header of that
- with --verilog verilog/: the APB top in Verilog-2005 without parameters, by yosys: capsoc_coprocessor_precise.v and
  capsoc_coprocessor_paper.v, each a module of that name
A file whose content would not change is left alone.

Status 0: written; 2: something is missing, and one sentence says what.
"""

import re
import subprocess
import sys
import tempfile
from collections import Counter
from pathlib import Path

from capsoc_tools import ROOT
from capsoc_tools.generate.output import SourceError, write_if_changed
from capsoc_tools.generate.registers import read_device
from capsoc_tools.rtl.ip_xact import LICENCE, PERIPHERAL, Bus, Top, ip_xact_text
from capsoc_tools.rtl.prefix import file_name, prefixed, shared_names, with_prefix
from capsoc_tools.rtl.sources import REGISTERS, RTL, WRAPPERS, RtlError, read_list, sources
from capsoc_tools.rtl.yosys_types import read_design

CORE, LIST = "capsoc_coprocessor.core", "capsoc_coprocessor.f"
REFERENCE = ROOT / "platform" / "reference"
APB = {
    "PCLK": "pclk_i",
    "PRESETn": "presetn_i",
    "PSELx": "psel_i",
    "PENABLE": "penable_i",
    "PWRITE": "pwrite_i",
    "PADDR": "paddr_i",
    "PWDATA": "pwdata_i",
    "PSTRB": "pstrb_i",
    "PREADY": "pready_o",
    "PRDATA": "prdata_o",
    "PSLVERR": "pslverr_o",
}
AHB_LITE = {
    "HCLK": "hclk_i",
    "HRESETn": "hresetn_i",
    "HSELx": "hsel_i",
    "HADDR": "haddr_i",
    "HWRITE": "hwrite_i",
    "HTRANS": "htrans_i",
    "HSIZE": "hsize_i",
    "HREADY": "hready_i",
    "HWDATA": "hwdata_i",
    "HREADYOUT": "hreadyout_o",
    "HRDATA": "hrdata_o",
    "HRESP": "hresp_o",
}
AXI4_LITE = {
    "ACLK": "aclk_i",
    "ARESETn": "aresetn_i",
    "AWVALID": "awvalid_i",
    "AWREADY": "awready_o",
    "AWADDR": "awaddr_i",
    "AWPROT": "awprot_i",
    "WVALID": "wvalid_i",
    "WREADY": "wready_o",
    "WDATA": "wdata_i",
    "WSTRB": "wstrb_i",
    "BVALID": "bvalid_o",
    "BREADY": "bready_i",
    "BRESP": "bresp_o",
    "ARVALID": "arvalid_i",
    "ARREADY": "arready_o",
    "ARADDR": "araddr_i",
    "ARPROT": "arprot_i",
    "RVALID": "rvalid_o",
    "RREADY": "rready_i",
    "RDATA": "rdata_o",
    "RRESP": "rresp_o",
}
# By target of the core file: the top's module, the folder of rtl/ that has it, its bus.
TOPS = {
    "default": ("coprocessor", "", Bus("apb", "AMBA4", "APB4", "r0p0_0", APB)),
    "ahb_lite": ("capsoc_coprocessor_ahb_lite", "wrappers", Bus("ahb_lite", "AMBA3", "AHBLite", "r2p0_0", AHB_LITE)),
    "axi4_lite": (
        "capsoc_coprocessor_axi4_lite",
        "wrappers",
        Bus("axi4_lite", "AMBA4", "AXI4-Lite", "r0p0_0", AXI4_LITE),
    ),
}
PORT = re.compile(r"^  (input|output)\s+logic\s+(?:\[(\d+):(\d+)\])?\s*(\w+),?\s*(?://.*)?$", re.M)
PARAMETER = re.compile(r"^  parameter int (\w+)\s*= (\d+),?\s*//\s*(.*)$", re.M)


def read_top(module, folder, bus):
    """The top `module` as its file in `folder` of rtl/ declares it."""
    text = (RTL / folder / f"{module}.sv").read_text(encoding="utf-8")
    head = text[: text.index(");", text.index(f"module {module}"))]
    ports = [(direction, int(left or 0), int(right or 0), name) for direction, left, right, name in PORT.findall(head)]
    return Top(file_name(Path(module)), bus, ports, PARAMETER.findall(head))


def version_of(peripheral):
    word = next(register.reset for register in peripheral.registers if register.name == "VERSION")
    return f"{word >> 16}.{word & 0xFFFF}"


def core_text(names, wrappers, tops, version):
    """`names`, `wrappers`: files in reading order; `tops`: by target. All have the parameters of the first."""
    parameters = tops["default"].parameters
    lines = [
        "CAPI=2:",
        f"# {LICENCE}",
        f"name: capsoc:ip:coprocessor:{version}.0",
        "description: Self-calibration coprocessor for quadrature angle sensors (APB, AHB-Lite, AXI4-Lite)",
        "filesets:",
    ]
    sets = {"rtl": (names, "systemVerilogSource"), "wrappers": (wrappers, "systemVerilogSource")}
    sets |= {f"constraints_{target}": ([f"{top.name}.sdc"], "SDC") for target, top in tops.items()}
    for fileset, (files, kind) in sets.items():
        lines += [f"  {fileset}:", "    files:", *(f"      - {name}" for name in files), f"    file_type: {kind}"]
    lines.append("parameters:")
    for name, value, meaning in parameters:
        lines += [f"  {name}:", f"    datatype: int\n    default: {value}\n    paramtype: vlogparam"]
        lines.append(f'    description: "{meaning}"')
    lines.append("targets:")
    for target, top in tops.items():
        filesets = ["rtl", *([] if target == "default" else ["wrappers"]), f"constraints_{target}"]
        lines += [f"  {target}:", f"    filesets: [{', '.join(filesets)}]", f"    toplevel: {top.name}"]
        lines.append(f"    parameters: [{', '.join(name for name, _, _ in parameters)}]")
    return "\n".join(lines) + "\n"


def write_sources(folder, files, names):
    """The files with their shared `names` prefixed; the names of what was written."""
    for file in files:
        write_if_changed(folder / file_name(file), with_prefix(file.read_text(encoding="utf-8"), names))
    return [file_name(file) for file in files]


def write(folder):
    folder.mkdir(parents=True, exist_ok=True)
    wrappers = read_list(RTL / WRAPPERS)
    bench = sorted((REFERENCE / "bench").glob("*.sv"))
    with tempfile.TemporaryDirectory() as made:
        files = sources(Path(made))
        shared = shared_names(file.read_text(encoding="utf-8") for file in (*files, *wrappers))
        names = write_sources(folder, files, shared)
        wrapper_names = write_sources(folder, wrappers, shared)
    (folder / "reference").mkdir(exist_ok=True)
    write_sources(folder / "reference", bench, shared)
    for file in (REFERENCE / "capsoc_reference.h", REFERENCE / "bench" / "capsoc_reference_vpi.c"):
        write_if_changed(folder / "reference" / file.name, file.read_text(encoding="utf-8"))
    peripheral = next(each for each in read_device(REGISTERS).peripherals if each.name == PERIPHERAL)
    version = version_of(peripheral)
    tops = {target: read_top(*about) for target, about in TOPS.items()}
    write_if_changed(folder / CORE, core_text(names, wrapper_names, tops, version))
    write_if_changed(folder / LIST, "\n".join([f"// {LICENCE}", *names, *wrapper_names]) + "\n")
    for target, top in tops.items():
        needed = names if target == "default" else names + wrapper_names
        write_if_changed(folder / f"{top.name}.xml", ip_xact_text(peripheral, version, needed, top))
        constraints = RTL / "constraints" / f"{TOPS[target][0]}.sdc"
        write_if_changed(folder / f"{top.name}.sdc", constraints.read_text(encoding="utf-8"))
    return names


def write_verilog(folder, names):
    """The APB top of each arithmetic in Verilog-2005; `names`: the files of the design in `folder`."""
    (folder / "verilog").mkdir(exist_ok=True)
    for paper, arithmetic in enumerate(("precise", "paper")):
        top = f"{prefixed('coprocessor')}_{arithmetic}"
        with tempfile.TemporaryDirectory() as made:
            netlist = Path(made) / "top.v"
            try:
                read = read_design([folder / name for name in names], made)
                script = f"{read}; chparam -set Paper {paper} {prefixed('coprocessor')}; "
                script += f"hierarchy -check -top {prefixed('coprocessor')}; proc; opt_clean; rename -top {top}; "
                command = ["yosys", "-q", "-p", f"{script} write_verilog -noattr {netlist}"]
                done = subprocess.run(command, capture_output=True, text=True, check=False)
            except FileNotFoundError as error:
                raise RtlError("--verilog: yosys is missing; install the package yosys") from error
            if done.returncode:
                raise RtlError(f"yosys failed: {(done.stderr or done.stdout).strip()}")
            write_if_changed(
                folder / "verilog" / f"{top}.v", f"// {LICENCE}\n" + plain_names(netlist.read_text("utf-8"))
            )


def plain_names(text):
    """A netlist of yosys with plain names for the modules that it made of those with parameters."""
    names, numbers = {}, Counter()
    for made in re.findall(r"^module (\\\$paramod\S*)", text, re.MULTILINE):
        base = re.search(r"\\\$paramod(?:\$[0-9a-f]+)?\\(\w+)", made)[1]
        numbers[base] += 1
        names[made] = f"{base}_{numbers[base]}"
    return re.sub(r"\\\$paramod\S*", lambda token: names[token[0]], text)


def main(arguments):
    as_verilog = "--verilog" in arguments
    arguments = [word for word in arguments if word != "--verilog"]
    if len(arguments) != 1 or arguments[0].startswith("-"):
        print(__doc__, file=sys.stdout if arguments[:1] in (["-h"], ["--help"]) else sys.stderr)
        return 0 if arguments[:1] in (["-h"], ["--help"]) else 2
    try:
        names = write(Path(arguments[0]))
        if as_verilog:
            write_verilog(Path(arguments[0]), names)
    except (RtlError, SourceError, OSError) as error:
        print(f"rtl_kit: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
