"""Writes the coprocessor's RTL as a kit for other projects: sources, FuseSoC core file, IP-XACT, SDC.

usage: rtl_kit FOLDER

Writes into FOLDER:
- the SystemVerilog, with the generated files
- capsoc_coprocessor.core (CAPI 2: the files in reading order, the parameters)
- capsoc_coprocessor.xml (IP-XACT, IEEE 1685-2014: bus interface, ports, registers as models/registers/capsoc.svd
  describes them)
- coprocessor.sdc

A file whose content would not change is left alone.

Status 0: written; 2: something is missing, and one sentence says what.
"""

import re
import shutil
import sys
import tempfile
from pathlib import Path
from xml.sax.saxutils import escape

from capsoc_tools.generate.output import SourceError, write_if_changed
from capsoc_tools.generate.registers import read_device
from capsoc_tools.rtl.sources import REGISTERS, RTL, RtlError, sources

LICENCE = "SPDX-License-Identifier: Apache-2.0"
CORE, IP_XACT, CONSTRAINTS = "capsoc_coprocessor.core", "capsoc_coprocessor.xml", "coprocessor.sdc"
PERIPHERAL, TOP = "COPROCESSOR", "coprocessor"
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
PORT = re.compile(r"^  (input|output)\s+logic\s+(?:\[(\d+):(\d+)\])?\s*(\w+),?\s*(?://.*)?$", re.M)
PARAMETER = re.compile(r"^  parameter int (\w+)\s*= (\d+),?\s*//\s*(.*)$", re.M)


def interface(text):
    """(ports, parameters) of the top module: (direction, left, right, name) and (name, value, meaning)."""
    head = text[: text.index(");", text.index(f"module {TOP}"))]
    ports = [(direction, int(left or 0), int(right or 0), name) for direction, left, right, name in PORT.findall(head)]
    return ports, PARAMETER.findall(head)


def version_of(peripheral):
    word = next(register.reset for register in peripheral.registers if register.name == "VERSION")
    return f"{word >> 16}.{word & 0xFFFF}"


def core_text(names, parameters, version):
    lines = [
        "CAPI=2:",
        f"# {LICENCE}",
        f"name: capsoc:ip:coprocessor:{version}.0",
        "description: Self-calibration coprocessor for quadrature angle sensors (APB)",
        "filesets:",
        "  rtl:",
        "    files:",
        *(f"      - {name}" for name in names),
        "    file_type: systemVerilogSource",
        "  constraints:",
        "    files:",
        f"      - {CONSTRAINTS}",
        "    file_type: SDC",
        "parameters:",
    ]
    for name, value, meaning in parameters:
        lines += [f"  {name}:", f"    datatype: int\n    default: {value}\n    paramtype: vlogparam"]
        lines.append(f'    description: "{meaning}"')
    lines += ["targets:", "  default:", "    filesets: [rtl, constraints]", f"    toplevel: {TOP}"]
    lines.append(f"    parameters: [{', '.join(name for name, _, _ in parameters)}]")
    return "\n".join(lines) + "\n"


def element(tag, *inside):
    """A text of IP-XACT: what is inside is elements, or a word."""
    tag = f"ipxact:{tag}"
    if len(inside) == 1 and not inside[0].startswith("<"):
        return f"<{tag}>{escape(inside[0])}</{tag}>"
    return f"<{tag}>\n" + "\n".join(inside) + f"\n</{tag}>"


def access_of(part):
    return element("access", part.access)


def field_text(part):
    inside = [element("name", part.name), element("description", part.description)]
    inside += [element("bitOffset", str(part.low)), element("bitWidth", str(part.high - part.low + 1)), access_of(part)]
    if part.one_to_clear:
        inside.append(element("modifiedWriteValue", "oneToClear"))
    return element("field", *inside)


def register_text(register):
    inside = [element("name", register.name), element("description", register.description)]
    inside += [element("addressOffset", f"'h{register.offset:X}"), element("size", "32"), access_of(register)]
    if not register.fields:  # the standard wants one: the whole word
        word = [element("name", "VALUE"), element("bitOffset", "0")]
        word.append(element("resets", element("reset", element("value", f"'h{register.reset:X}"))))
        inside.append(element("field", *word, element("bitWidth", "32"), access_of(register)))
    for part in register.fields:
        text = field_text(part)
        reset = (register.reset >> part.low) & ((1 << (part.high - part.low + 1)) - 1)
        resets = element("resets", element("reset", element("value", f"'h{reset:X}")))
        inside.append(text.replace("<ipxact:bitWidth>", resets + "\n<ipxact:bitWidth>", 1))
    return element("register", *inside)


def port_text(port):
    direction, left, right, name = port
    wire = [element("direction", direction.removesuffix("put"))]
    if left != right:
        wire.append(element("vectors", element("vector", element("left", str(left)), element("right", str(right)))))
    return element("port", element("name", name), element("wire", *wire))


def bus_text():
    maps = [
        element(
            "portMap",
            element("logicalPort", element("name", logical)),
            element("physicalPort", element("name", physical)),
        )
        for logical, physical in APB.items()
    ]
    kind = '{} vendor="amba.com" library="AMBA4" name="{}" version="r0p0_0"/>'
    return element(
        "busInterface",
        element("name", "apb"),
        kind.format("<ipxact:busType", "APB4"),
        element(
            "abstractionTypes",
            element("abstractionType", kind.format("<ipxact:abstractionRef", "APB4_rtl"), element("portMaps", *maps)),
        ),
        element("slave", '<ipxact:memoryMapRef memoryMapRef="registers"/>'),
    )


def ip_xact_text(peripheral, names, ports, parameters):
    block = [element("name", PERIPHERAL), element("baseAddress", "0"), element("range", f"'h{peripheral.size:X}")]
    block += [element("width", "32"), element("usage", "register")]
    block += [register_text(register) for register in peripheral.registers]
    files = [element("file", element("name", name), element("fileType", "systemVerilogSource")) for name in names]
    view = element("view", element("name", "rtl"), element("componentInstantiationRef", "rtl"))
    instance = [element("name", "rtl"), element("language", "SystemVerilog"), element("moduleName", TOP)]
    instance.append(element("fileSetRef", element("localName", "rtl")))
    body = [
        element("vendor", "capsoc"),
        element("library", "ip"),
        element("name", TOP),
        element("version", version_of(peripheral)),
        element("busInterfaces", bus_text()),
        element(
            "memoryMaps",
            element(
                "memoryMap",
                element("name", "registers"),
                element("addressBlock", *block),
                element("addressUnitBits", "8"),
            ),
        ),
        element(
            "model",
            element("views", view),
            element("instantiations", element("componentInstantiation", *instance)),
            element("ports", *(port_text(port) for port in ports)),
        ),
        element("fileSets", element("fileSet", element("name", "rtl"), *files)),
        element("description", peripheral.description),
        element(
            "parameters",
            *(
                f'<ipxact:parameter parameterId="{name}" type="int">\n'
                + "\n".join([element("name", name), element("description", meaning), element("value", value)])
                + "\n</ipxact:parameter>"
                for name, value, meaning in parameters
            ),
        ),
    ]
    return (
        f'<?xml version="1.0" encoding="UTF-8"?>\n<!-- {LICENCE} -->\n'
        '<ipxact:component xmlns:ipxact="http://www.accellera.org/XMLSchema/IPXACT/1685-2014">\n'
        + "\n".join(body)
        + "\n</ipxact:component>\n"
    )


def write(folder):
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as made:
        files = sources(Path(made))
        for file in files:
            write_if_changed(folder / file.name, file.read_text(encoding="utf-8"))
    names = [file.name for file in files]
    peripheral = next(each for each in read_device(REGISTERS).peripherals if each.name == PERIPHERAL)
    ports, parameters = interface((RTL / f"{TOP}.sv").read_text(encoding="utf-8"))
    write_if_changed(folder / CORE, core_text(names, parameters, version_of(peripheral)))
    write_if_changed(folder / IP_XACT, ip_xact_text(peripheral, names, ports, parameters))
    shutil.copy(RTL / "constraints" / CONSTRAINTS, folder)


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
