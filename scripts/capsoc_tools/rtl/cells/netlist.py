"""The netlist that yosys mapped to the cells of a Liberty file: nets, loads, units, and its Verilog.

A net is a number. Names in all files: n<number>, and c<number> of a cell, m<number> of a memory. Memories stay
behavioural, with one writing and one reading port, because a library of cells has none.
"""

import functools
import json
from collections import Counter
from dataclasses import dataclass

from capsoc_tools.rtl.cells.liberty import expression_of
from capsoc_tools.rtl.synth_flow import ToolError

#: Number of the first net in the simulator's table.
FIRST = 2


@dataclass
class Instance:
    kind: str  # cell of the library
    unit: str  # path of the RTL's instances, "" for the top
    pins: dict  # net, or "0" or "1", by pin


@dataclass
class Memory:
    unit: str
    width: int
    size: int
    clocked: bool  # its reading port has a register
    pins: dict  # nets, least significant first, by port of yosys' $mem_v2


def unit_of(name):
    """`$flatten\\u_datapath.g_precise.\\u_core.$abc$1` as datapath.core; names of generate blocks are left out."""
    parts = []
    for part in name.removeprefix("$flatten").split("."):
        part = part.lstrip("\\")
        if part.startswith("$"):
            break
        if not part.startswith(("g_", "gen_")):
            parts.append(part.removeprefix("u_"))
    return ".".join(parts)


class Netlist:
    """ports: (direction, nets) by name. clock: its net. driven: nets with a driver, without the clock."""

    def __init__(self, text, library, clock="pclk_i", reset="presetn_i"):
        modules = json.loads(text)["modules"]
        if len(modules) != 1:
            raise ToolError(f"the netlist has {len(modules)} modules, not one")
        (self.name, module), self.library, self.numbers = *modules.items(), library, {}
        self.reset = reset
        self.ports = {
            name: (port["direction"], [self.net(bit) for bit in port["bits"]]) for name, port in module["ports"].items()
        }
        self.clock = self.ports[clock][1][0] if clock in self.ports else None
        self.cells, self.memories = [], []
        for name, cell in module["cells"].items():
            pins = {pin: [self.net(bit) for bit in bits] for pin, bits in cell["connections"].items()}
            if cell["type"] == "$mem_v2":
                self.memories.append(self.memory(unit_of(name).rpartition(".")[0], cell["parameters"], pins))
            elif cell["type"] in library.cells and not library.cells[cell["type"]].other_state:
                single = {pin: nets[0] for pin, nets in pins.items()}
                self.cells.append(Instance(cell["type"], unit_of(name), single))
            else:
                raise ToolError(f"the netlist has a cell {cell['type']}, which this tool does not simulate")
        self.find_drivers()

    def net(self, bit):
        """Of a bit of yosys. An unknown value is 0, as it is in the simulation."""
        if isinstance(bit, str):
            return "1" if bit == "1" else "0"
        return self.numbers.setdefault(bit, len(self.numbers))

    @staticmethod
    def memory(unit, parameters, pins):
        def value(name):
            return int(parameters[name], 2)

        if (value("RD_PORTS"), value("WR_PORTS"), value("OFFSET")) != (1, 1, 0) or not value("WR_CLK_POLARITY"):
            raise ToolError(f"the memory of {unit} has other ports than one for writing and one for reading")
        return Memory(unit, value("WIDTH"), value("SIZE"), bool(value("RD_CLK_ENABLE")), pins)

    def find_drivers(self):
        """Per net its unit as `drivers` has it ("pins" of an input), and its load in farad, without wires."""
        self.drivers, self.loads, self.fanout = {}, Counter(), Counter()
        for direction, nets in self.ports.values():
            if direction == "input":
                self.drivers.update((net, "pins") for net in nets)
        for cell in self.cells:
            for pin, net in cell.pins.items():
                kind = self.library.cells[cell.kind].pins[pin]
                if kind.direction == "output":
                    self.drivers[net] = cell.unit
                else:
                    self.loads[net] += kind.capacitance
                    self.fanout[net] += 1
        for memory in self.memories:
            self.drivers.update((net, memory.unit) for net in memory.pins["RD_DATA"])
        if floating := sorted(self.fanout.keys() - self.drivers.keys() - {"0", "1"}):
            raise ToolError(f"net {self.name_of(floating[0])} of the netlist has no driver")
        self.driven = sorted(net for net in self.drivers if net != self.clock)

    def name_of(self, net):
        return f"1'b{net}" if isinstance(net, str) else f"n{net}"

    def _module(self, body):
        """The module around `body`, with the ports of the RTL."""
        lines = [f"module {self.name}_cells ({', '.join(self.ports)});"]
        for name, (direction, nets) in self.ports.items():
            lines.append(f"  {direction} {f'[{len(nets) - 1}:0] ' if len(nets) > 1 else ''}{name};")
        lines += [f"  wire n{net};" for net in range(len(self.numbers))]
        for name, (direction, nets) in self.ports.items():
            for i, net in enumerate(nets):
                port = f"{name}[{i}]" if len(nets) > 1 else name
                pair = (self.name_of(net), port) if direction == "input" else (port, self.name_of(net))
                lines.append(f"  assign {pair[0]} = {pair[1]};")
        return "\n".join([*lines, *body, "endmodule", ""])

    def _vector(self, nets):
        return "{" + ", ".join(self.name_of(net) for net in reversed(nets)) + "}"

    def structure(self):
        """Verilog of instances alone, for tools that have the Liberty file. The memories are modules without a body."""
        body = []
        for i, cell in enumerate(self.cells):
            pins = ", ".join(f".{pin}({self.name_of(net)})" for pin, net in cell.pins.items())
            body.append(f"  {cell.kind} c{i} ({pins});")
        for i, memory in enumerate(self.memories):
            pins = ", ".join(f".{pin}({self._vector(nets)})" for pin, nets in memory.pins.items() if nets)
            body.append(f"  memory_{i} m{i} ({pins});")
        return self._module(body)

    def table(self):
        """What cell_simulator.h reads: cells with truth tables, flip-flops, memories. Its nets 0 and 1 are constants,
        and net n of this class is n + FIRST."""

        def numbers(nets):
            return [len(nets), *(int(net) if isinstance(net, str) else net + FIRST for net in nets)]

        lines = [[len(self.numbers) + FIRST]]
        lines += [["port", name, *numbers(nets)] for name, (_, nets) in self.ports.items()]
        for cell in self.cells:
            kind = self.library.cells[cell.kind]
            inputs = [pin for pin in cell.pins if kind.pins[pin].direction == "input"]
            outputs = [pin for pin in cell.pins if kind.pins[pin].direction == "output"]
            if kind.flip_flop:
                lines.append(["flop", *numbers([cell.pins[outputs[0]], *self.flip_flop_inputs(cell, kind)])[1:]])
                continue
            for pin in outputs:
                nets = numbers([cell.pins[name] for name in inputs])
                lines.append(
                    ["cell", truth_table(kind.pins[pin].function, tuple(inputs)), *numbers([cell.pins[pin]])[1:], *nets]
                )
        for memory in self.memories:
            words = ["memory", memory.width, memory.size, int(memory.clocked), *numbers(memory.pins["RD_EN"])[1:]]
            for port in ("RD_ADDR", "RD_DATA", "WR_ADDR", "WR_DATA", "WR_EN"):
                words += numbers(memory.pins[port])
            lines.append(words)
        return "".join(" ".join(map(str, words)) + "\n" for words in lines)

    def flip_flop_inputs(self, cell, kind):
        """Nets of data, clear and preset; the latter act at 0. ToolError: other ones than the simulator knows."""
        nets = [cell.pins[kind.flip_flop["next_state"]]]
        resets = {"1", *(self.ports[self.reset][1] if self.reset in self.ports else [])}
        for what in ("clear", "preset"):
            pin = kind.flip_flop.get(what)
            nets.append(cell.pins[pin.strip("(!)")] if pin else "1")
            if nets[-1] not in resets or pin and "!" not in pin:
                raise ToolError(f"a flip-flop of '{cell.unit}' has a {what} that is not the reset pin")
        return nets


@functools.cache
def truth_table(function, inputs):
    """Bit i is the value where bit k of i is the value of input k."""
    expression, table = expression_of(function), 0
    for place in range(1 << len(inputs)):
        values = {name: place >> k & 1 for k, name in enumerate(inputs)}
        table |= (eval(expression, {"__builtins__": {}}, values) & 1) << place
    return table
