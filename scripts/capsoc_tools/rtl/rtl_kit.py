"""Writes the coprocessor's RTL as a kit for other projects: sources, FuseSoC core file, IP-XACT, SDC.

usage: rtl_kit FOLDER

FOLDER gets the SystemVerilog, with what scripts generate, and next to it:
- capsoc_coprocessor.core, CAPI 2: the files in reading order, the parameters, a target for each top:
  default (APB), ahb_lite, axi4_lite
- capsoc_coprocessor.f, the same files for simulators: -f in FOLDER
- IP-XACT (IEEE 1685-2014) of each top, as capsoc_coprocessor.xml: bus interface, ports, registers as
  models/registers/capsoc.svd describes them
- constraints of each top, as coprocessor.sdc
A file whose content would not change is left alone.

Status 0: written; 2: something is missing, and one sentence says what.
"""

import re
import shutil
import sys
import tempfile
from pathlib import Path

from capsoc_tools.generate.output import SourceError, write_if_changed
from capsoc_tools.generate.registers import read_device
from capsoc_tools.rtl.ip_xact import LICENCE, PERIPHERAL, Bus, Top, ip_xact_text
from capsoc_tools.rtl.sources import REGISTERS, RTL, WRAPPERS, RtlError, read_list, sources

CORE, LIST = "capsoc_coprocessor.core", "capsoc_coprocessor.f"
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
    return Top(module, bus, ports, PARAMETER.findall(head))


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


def write(folder):
    folder.mkdir(parents=True, exist_ok=True)
    wrappers = read_list(RTL / WRAPPERS)
    with tempfile.TemporaryDirectory() as made:
        files = sources(Path(made))
        for file in (*files, *wrappers):
            write_if_changed(folder / file.name, file.read_text(encoding="utf-8"))
    names, wrapper_names = [file.name for file in files], [file.name for file in wrappers]
    peripheral = next(each for each in read_device(REGISTERS).peripherals if each.name == PERIPHERAL)
    version = version_of(peripheral)
    tops = {target: read_top(*about) for target, about in TOPS.items()}
    write_if_changed(folder / CORE, core_text(names, wrapper_names, tops, version))
    write_if_changed(folder / LIST, "\n".join([f"// {LICENCE}", *names, *wrapper_names]) + "\n")
    for target, top in tops.items():
        needed = names if target == "default" else names + wrapper_names
        text = ip_xact_text(peripheral, version, needed, top)
        write_if_changed(folder / f"capsoc_{top.name.removeprefix('capsoc_')}.xml", text)
        shutil.copy(RTL / "constraints" / f"{top.name}.sdc", folder)


def main(arguments):
    if len(arguments) != 1 or arguments[0] in ("-h", "--help"):
        print(__doc__, file=sys.stdout if arguments[:1] in (["-h"], ["--help"]) else sys.stderr)
        return 0 if arguments[:1] in (["-h"], ["--help"]) else 2
    try:
        write(Path(arguments[0]))
    except (RtlError, SourceError, OSError) as error:
        print(f"rtl_kit: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
