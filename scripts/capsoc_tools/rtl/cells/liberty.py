"""Reads what an energy needs of a Liberty file: pins, functions, internal power, leakage; all values in SI units.

Energies of internal_power tables are in capacitive_load_unit times voltage_unit squared, as the Liberty user guide
has it; with pF and V that is pJ.
"""

import re
from dataclasses import dataclass, field

from capsoc_tools.rtl.synth_flow import ToolError

TOKEN = re.compile(r'"(?:[^"\\]|\\.)*"|[{}():;,]|[^\s{}():;,"]+', re.S)
PREFIXES = {"f": 1e-15, "p": 1e-12, "n": 1e-9, "u": 1e-6, "m": 1e-3, "": 1.0}


@dataclass
class Group:
    """`kind (name) { ... }`: simple attributes as text, complex ones as lists of text, groups below in their order."""

    kind: str
    name: str = ""
    attributes: dict = field(default_factory=dict)
    groups: list = field(default_factory=list)

    def all(self, kind):
        return [group for group in self.groups if group.kind == kind]


@dataclass
class Table:
    """A value over load (farad) and slew (second), linear between its points and beyond its ends."""

    axes: list  # "load" or "slew", as the template orders them
    points: list  # a list of numbers for each axis
    values: list  # row by row

    def at(self, load, slew):
        position = [{"load": load, "slew": slew}[axis] for axis in self.axes]
        return self._at(self.values, position)

    def _at(self, values, position):
        depth = len(self.axes) - len(position)
        if not position:
            return values[0]
        points = self.points[depth]
        row = len(values) // len(points)
        if len(points) == 1:
            return self._at(values, position[1:])
        low = max(0, min(len(points) - 2, sum(point <= position[0] for point in points) - 1))
        below, above = (self._at(values[i * row : (i + 1) * row], position[1:]) for i in (low, low + 1))
        return below + (above - below) * (position[0] - points[low]) / (points[low + 1] - points[low])


@dataclass
class Power:
    """internal_power of a pin: joules of a rising and of a falling edge. related: the pin that causes it, or None."""

    related: str | None
    rise: Table | None
    fall: Table | None


@dataclass
class Pin:
    direction: str
    capacitance: float = 0.0  # farad
    function: str | None = None
    clock: bool = False
    powers: list = field(default_factory=list)


@dataclass
class Cell:
    name: str
    area: float
    leakage: float  # watt
    pins: dict
    flip_flop: dict | None  # attributes of the group ff, and `state`: its first name
    other_state: bool  # a latch or a three-state output, which no netlist here has


@dataclass
class Library:
    name: str
    voltage: float
    cells: dict


def tokens_of(text):
    text = re.sub(r"/\*.*?\*/|\\\r?\n", " ", text, flags=re.S)
    return [token.group() for token in TOKEN.finditer(text)]


def parse(text):
    """The file's outermost group."""
    tokens = tokens_of(text)
    top = Group("")
    stack = [top]
    place = 0
    while place < len(tokens):
        word = tokens[place]
        if word == "}":
            stack.pop()
            place += 1
        elif word in ";,":
            place += 1
        elif tokens[place + 1 : place + 2] == [":"]:
            end = tokens.index(";", place)
            stack[-1].attributes[word] = " ".join(tokens[place + 2 : end]).strip('"')
            place = end + 1
        elif tokens[place + 1 : place + 2] == ["("]:
            end = tokens.index(")", place)
            values = [value.strip('"') for value in tokens[place + 2 : end] if value != ","]
            place = end + 1
            if tokens[place : place + 1] == ["{"]:
                group = Group(word, " ".join(values))
                stack[-1].groups.append(group)
                stack.append(group)
                place += 1
            else:
                stack[-1].attributes[word] = values
        else:
            raise ValueError(f"'{word}' is no attribute and no group")
        if not stack:
            raise ValueError("a '}' too many")
    if len(stack) != 1 or len(top.groups) != 1:
        raise ValueError("a '}' is missing")
    return top.groups[0]


def numbers(texts):
    return [float(word) for text in texts for word in re.split(r"[,\s]+", text.strip()) if word]


def unit(text, what):
    """The factor of a unit such as "1ns"."""
    found = re.fullmatch(r"\s*([\d.]+)\s*([fpnum]?)" + what, text, re.IGNORECASE)
    if not found:
        raise ValueError(f"'{text}' is no unit of {what}")
    return float(found[1]) * PREFIXES[found[2].lower()]


class Reader:
    def __init__(self, top):
        self.top = top
        number, farad = top.attributes["capacitive_load_unit"]
        self.farad = float(number) * unit(f"1{farad}", "f")
        self.second = unit(top.attributes["time_unit"], "s")
        self.joule = self.farad * unit(top.attributes["voltage_unit"], "v") ** 2
        self.watt = unit(top.attributes.get("leakage_power_unit", "1nW"), "w")
        self.templates = {group.name: group for group in top.all("power_lut_template")}

    def table(self, group):
        values = [value * self.joule for value in numbers(group.attributes["values"])]
        if group.name == "scalar":
            return Table([], [], values)
        template = self.templates[group.name].attributes
        axes, points = [], []
        while variable := template.get(f"variable_{len(axes) + 1}"):
            load = variable in ("total_output_net_capacitance", "equal_or_opposite_output_net_capacitance")
            index = f"index_{len(axes) + 1}"
            axes.append("load" if load else "slew")
            scale = self.farad if load else self.second
            points.append([scale * value for value in numbers(group.attributes.get(index) or template[index])])
        return Table(axes, points, values)

    def power(self, group):
        tables = {
            kind: self.table(found[0]) for kind in ("rise_power", "fall_power", "power") if (found := group.all(kind))
        }
        both = tables.get("power")
        return Power(
            group.attributes.get("related_pin"), tables.get("rise_power", both), tables.get("fall_power", both)
        )

    def pin(self, group):
        return Pin(
            group.attributes["direction"],
            self.farad * float(group.attributes.get("capacitance", 0)),
            group.attributes.get("function"),
            group.attributes.get("clock") == "true",
            [self.power(each) for each in group.all("internal_power")],
        )

    def cell(self, group):
        pins = {each.name: self.pin(each) for each in group.all("pin")}
        held = [{"state": each.name.split()[0], **each.attributes} for each in group.all("ff")]
        three_state = any("three_state" in each.attributes for each in group.all("pin"))
        return Cell(
            group.name,
            float(group.attributes.get("area", 0)),
            self.watt * float(group.attributes.get("cell_leakage_power", 0)),
            pins,
            held[0] if held else None,
            bool(group.all("latch")) or three_state,
        )


def read_liberty(path):
    """The library of a file. ToolError: it cannot be read, or is not Liberty."""
    try:
        reader = Reader(parse(path.read_text(encoding="latin-1")))
        cells = {group.name: reader.cell(group) for group in reader.top.all("cell")}
        return Library(reader.top.name, float(reader.top.attributes["nom_voltage"]), cells)
    except OSError as error:
        raise ToolError(f"{path}: {error.strerror}; name a Liberty file") from error
    except (ValueError, KeyError, IndexError) as error:
        raise ToolError(f"{path}: not a Liberty file that this tool reads: {error}") from error


def expression_of(function):
    """A Liberty function with the operators of Python and Verilog."""
    words = re.findall(r"\w+|[!'^*&+|()]", function)
    out = []
    for i, word in enumerate(words):
        if word == "'":
            raise ToolError(f"function '{function}': the operator ' is not supported")
        if i and (word in "!(" or word.isidentifier()) and (words[i - 1] == ")" or words[i - 1].isidentifier()):
            out.append("&")  # side by side is AND
        out.append({"!": "~", "+": "|", "*": "&"}.get(word, word))
    return " ".join(out)
