"""IP-XACT (IEEE 1685-2014) of a top of the coprocessor: bus interface, ports, registers, files, parameters."""

from dataclasses import dataclass
from xml.sax.saxutils import escape

LICENCE = "SPDX-License-Identifier: Apache-2.0"
PERIPHERAL = "COPROCESSOR"


@dataclass
class Bus:
    """A bus as its owner's IP-XACT definitions call it, and which port of the top has which of its signals."""

    name: str
    library: str
    definition: str
    version: str
    ports: dict


@dataclass
class Top:
    """A module: ports are (direction, left, right, name), parameters (name, value, meaning)."""

    name: str
    bus: Bus
    ports: list
    parameters: list


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


def bus_text(bus):
    maps = [
        element(
            "portMap",
            element("logicalPort", element("name", logical)),
            element("physicalPort", element("name", physical)),
        )
        for logical, physical in bus.ports.items()
    ]
    kind = f'{{}} vendor="amba.com" library="{bus.library}" name="{{}}" version="{bus.version}"/>'
    return element(
        "busInterface",
        element("name", bus.name),
        kind.format("<ipxact:busType", bus.definition),
        element(
            "abstractionTypes",
            element(
                "abstractionType",
                kind.format("<ipxact:abstractionRef", f"{bus.definition}_rtl"),
                element("portMaps", *maps),
            ),
        ),
        element("slave", '<ipxact:memoryMapRef memoryMapRef="registers"/>'),
    )


def ip_xact_text(peripheral, version, names, top):
    block = [element("name", PERIPHERAL), element("baseAddress", "0"), element("range", f"'h{peripheral.size:X}")]
    block += [element("width", "32"), element("usage", "register")]
    block += [register_text(register) for register in peripheral.registers]
    files = [element("file", element("name", name), element("fileType", "systemVerilogSource")) for name in names]
    view = element("view", element("name", "rtl"), element("componentInstantiationRef", "rtl"))
    instance = [element("name", "rtl"), element("language", "SystemVerilog"), element("moduleName", top.name)]
    instance.append(element("fileSetRef", element("localName", "rtl")))
    body = [
        element("vendor", "capsoc"),
        element("library", "ip"),
        element("name", top.name),
        element("version", version),
        element("busInterfaces", bus_text(top.bus)),
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
            element("ports", *(port_text(port) for port in top.ports)),
        ),
        element("fileSets", element("fileSet", element("name", "rtl"), *files)),
        element("description", peripheral.description),
        element(
            "parameters",
            *(
                f'<ipxact:parameter parameterId="{name}" type="int">\n'
                + "\n".join([element("name", name), element("description", meaning), element("value", value)])
                + "\n</ipxact:parameter>"
                for name, value, meaning in top.parameters
            ),
        ),
    ]
    return (
        f'<?xml version="1.0" encoding="UTF-8"?>\n<!-- {LICENCE} -->\n'
        '<ipxact:component xmlns:ipxact="http://www.accellera.org/XMLSchema/IPXACT/1685-2014">\n'
        + "\n".join(body)
        + "\n</ipxact:component>\n"
    )
