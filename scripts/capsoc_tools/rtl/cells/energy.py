"""Joules of a netlist's toggles, by unit, from the tables of its Liberty file.

An edge of a net costs half of load times voltage squared, the internal power of the output that drives it, and that
of the input pins that it reaches. An output's internal power is the mean over the pins that can cause the edge; a
flip-flop's is that of its clock. The load is the input pins, no wire. All slews are the same nominal one.
"""

from collections import defaultdict
from dataclasses import dataclass, field

from capsoc_tools.rtl.synth_flow import ToolError

NOMINAL_SLEW = 0.18e-9  # second, of 20 to 80 %: the second point of most tables


@dataclass
class Unit:
    """Sums of one unit. Energies in joule, of the whole run; `clock`: of a clock cycle; `leakage` in watt."""

    cells: int = 0
    flip_flops: int = 0
    toggles: int = 0
    gates: float = 0.0
    registers: float = 0.0
    clock: float = 0.0
    leakage: float = 0.0

    @property
    def switched(self):
        return self.gates + self.registers


@dataclass
class Costs:
    """Per net the joules of a rising and of a falling edge as (unit, is a flip-flop, rise, fall)."""

    edges: dict = field(default_factory=lambda: defaultdict(list))
    units: dict = field(default_factory=lambda: defaultdict(Unit))

    def spent(self, counts):
        """Units by name. counts: (half clocks at 1, rises, falls) by net."""
        units = {
            name: Unit(unit.cells, unit.flip_flops, clock=unit.clock, leakage=unit.leakage)
            for name, unit in self.units.items()
        }
        for net, parts in self.edges.items():
            _, rises, falls = counts[net]
            for i, (name, register, rise, fall) in enumerate(parts):
                unit = units[name]
                joules = rises * rise + falls * fall
                if register:
                    unit.registers += joules
                else:
                    unit.gates += joules
                if i == 0:
                    unit.toggles += rises + falls
        return units


def mean(tables, load, slew):
    values = [table.at(load, slew) for table in tables if table]
    return sum(values) / len(values) if values else 0.0


def internal(pin, load, slew, cause=None):
    """Joules of a rise and of a fall. cause: the only pin that counts, or None for all."""
    powers = [power for power in pin.powers if cause is None or power.related == cause]
    return mean([power.rise for power in powers], load, slew), mean([power.fall for power in powers], load, slew)


def costs_of(netlist, slew=NOMINAL_SLEW):
    """What each edge costs. ToolError: a flip-flop whose clock is not the netlist's."""
    library, costs = netlist.library, Costs()
    half = library.voltage**2 / 2
    for net in netlist.driven:  # first, so that the driver's part is the first one of each net
        name = netlist.drivers[net]
        costs.edges[net].append([name, False, half * netlist.loads[net], half * netlist.loads[net]])
        costs.units[name]
    for cell in netlist.cells:
        kind, unit = library.cells[cell.kind], costs.units[cell.unit]
        unit.cells += 1
        unit.leakage += kind.leakage
        clock = kind.flip_flop["clocked_on"] if kind.flip_flop else None
        if clock:
            unit.flip_flops += 1
            if cell.pins[clock] != netlist.clock:
                raise ToolError(f"a flip-flop of '{cell.unit}' has another clock than the design")
            unit.clock += 2 * half * kind.pins[clock].capacitance + sum(internal(kind.pins[clock], 0.0, slew))
        for name, net in cell.pins.items():
            pin = kind.pins[name]
            if isinstance(net, str) or name == clock:
                continue
            if pin.direction == "output":
                part = costs.edges[net][0]
                rise, fall = internal(pin, netlist.loads[net], slew, clock)
                part[1:] = [clock is not None, part[2] + rise, part[3] + fall]
            elif pin.powers:
                costs.edges[net].append([cell.unit, clock is not None, *internal(pin, 0.0, slew)])
    return costs


def total(units):
    sums = Unit()
    for unit in units.values():
        for name in vars(sums):
            setattr(sums, name, getattr(sums, name) + getattr(unit, name))
    return sums
