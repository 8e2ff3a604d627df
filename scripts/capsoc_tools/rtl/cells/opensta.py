"""Compares the reading of the Liberty file with OpenSTA's (Debian's package opensta, of 2019), cell kind by cell kind.

A circuit has one cell of each kind, its inputs at ports with the nominal slew, its outputs with one load, and every
input and output toggles at one rate. OpenSTA's rule of 2019, found by varying slews, differs from energy.py's. It adds
the tables of all pins that can cause an edge, each times the probability that the pin's neighbour in the function
lets it through, where energy.py takes the mean. It takes the sum of rise and fall for each edge, where energy.py takes
the one that happens. It leaves out tables that are the same for both. So the tables are compared under OpenSTA's rule,
and how far the rules are apart is reported next to it.
"""

import ast
import subprocess

from capsoc_tools.rtl.cells.energy import internal
from capsoc_tools.rtl.cells.liberty import expression_of
from capsoc_tools.rtl.synth_flow import ToolError, find

LOAD = 0.0125e-12  # farad
ACTIVITY, DUTY = 0.2, 0.5  # edges a clock, share of the time at 1
PERIOD_NS = 40
TCL = """\
read_liberty {liberty}
read_verilog {folder}/each_cell.v
link_design each_cell
create_clock -name clk -period {period} clk
set_propagated_clock clk
set inputs [list {inputs}]
foreach name $inputs {{ set_input_delay 0 -clock clk $name }}
foreach name [concat clk $inputs] {{ set_input_transition {slew} $name }}
foreach name [list {outputs}] {{ set_load {load} $name }}
set_power_activity -global -activity {activity} -duty {duty}
set_power_activity -input -activity {activity} -duty {duty}
foreach name [list {cells}] {{ report_power -instance $name -digits 9 }}
exit
"""


def tree(function):
    return ast.parse(expression_of(function), mode="eval").body


def probability(node):
    """That an expression is 1, its pins independent."""
    if isinstance(node, ast.Name):
        return DUTY
    if isinstance(node, ast.UnaryOp):
        return 1 - probability(node.operand)
    left, right = probability(node.left), probability(node.right)
    both = left * right
    return {ast.BitAnd: both, ast.BitOr: left + right - both, ast.BitXor: left + right - 2 * both}[type(node.op)]


def passing(node, pin):
    """The probability that the expression next to `pin` lets its edge through; 1 without one, None without the pin."""
    if isinstance(node, ast.Name):
        return 1.0 if node.id == pin else None
    if isinstance(node, ast.UnaryOp):
        return passing(node.operand, pin)
    for side, other in ((node.left, node.right), (node.right, node.left)):
        inside = side.operand if isinstance(side, ast.UnaryOp) else side
        if isinstance(inside, ast.Name) and inside.id == pin:
            one = probability(other)
            return {ast.BitAnd: one, ast.BitOr: 1 - one, ast.BitXor: DUTY}[type(node.op)]
    found = passing(node.left, pin)
    return passing(node.right, pin) if found is None else found


def powers_of(cell, voltage, slew):
    """(internal by OpenSTA's rule, internal by energy.py, switching, leakage) of one cell, in watt."""
    clock = cell.flip_flop["clocked_on"] if cell.flip_flop else None
    theirs = ours = switching = 0.0
    edges = ACTIVITY / (PERIOD_NS * 1e-9)
    for name, pin in cell.pins.items():
        output = pin.direction == "output"
        load = LOAD if output else 0.0
        rate = 2 / (PERIOD_NS * 1e-9) if name == clock else edges
        for power in pin.powers:
            if power.rise is power.fall:
                continue
            if clock and clock in (name, power.related):
                share = 1.0
            else:
                combinational = output and not clock
                share = passing(tree(pin.function), power.related) if combinational else DUTY
            theirs += sum(table.at(load, slew) for table in (power.rise, power.fall) if table) * rate * share
        if pin.powers:
            ours += sum(internal(pin, load, slew, clock if output else None)) / 2 * rate
        if output:
            switching += LOAD * voltage**2 / 2 * edges
    return theirs, ours, switching, cell.leakage


def circuit(kinds):
    """Verilog of one cell of each kind, and its ports other than the clock."""
    ports, body = {"input": [], "output": []}, []
    for i, kind in enumerate(kinds):
        clock = kind.flip_flop["clocked_on"] if kind.flip_flop else None
        nets = {pin: "clk" if pin == clock else f"p{i}_{pin}" for pin in kind.pins}
        for pin, net in nets.items():
            if pin != clock:
                ports[kind.pins[pin].direction].append(net)
        body.append(f"  {kind.name} c{i} ({', '.join(f'.{pin}({net})' for pin, net in nets.items())});")
    head = [f"module each_cell (clk, {', '.join(ports['input'] + ports['output'])});", "  input clk;"]
    head += [f"  {direction} {name};" for direction, names in ports.items() for name in names]
    return "\n".join([*head, *body, "endmodule", ""]), ports


def compare(netlist_kinds, library, liberty, slew, folder):
    """Prints and returns the largest relative difference of one cell's powers, and our internal power by theirs."""
    kinds = [library.cells[name] for name in sorted(netlist_kinds)]
    text, ports = circuit(kinds)
    (folder / "each_cell.v").write_text(text)
    (folder / "each_cell.tcl").write_text(
        TCL.format(
            liberty=liberty, folder=folder, period=PERIOD_NS, slew=slew * 1e9, load=LOAD * 1e12, activity=ACTIVITY,
            duty=DUTY, inputs=" ".join(ports["input"]), outputs=" ".join(ports["output"]),
            cells=" ".join(f"c{i}" for i in range(len(kinds))),
        )
    )  # fmt: skip
    command = [find("sta", "opensta"), "-no_splash", str(folder / "each_cell.tcl")]
    done = subprocess.run(command, capture_output=True, text=True, check=False, stdin=subprocess.DEVNULL, cwd=folder)
    rows = [line.split() for line in done.stdout.splitlines()]
    rows = {
        row[4]: [float(word) for word in row[:3]]
        for row in rows
        if len(row) == 5 and row[4][:1] == "c" and row[4][1:].isdigit()
    }
    if len(rows) != len(kinds):
        raise ToolError(f"sta reported {len(rows)} of {len(kinds)} cells: {(done.stdout + done.stderr).strip()[-300:]}")
    largest, sums = 0.0, [0.0, 0.0]
    for i, kind in enumerate(kinds):
        theirs, ours, switching, leakage = powers_of(kind, library.voltage, slew)
        sums = [sums[0] + theirs, sums[1] + ours]
        for expected, said in zip((theirs, switching, leakage), rows[f"c{i}"]):
            largest = max(largest, abs(said - expected) / expected)
    print(
        f"  OpenSTA, {len(kinds)} kinds of cells, activity {ACTIVITY}: internal, switching and leakage power differ by "
        f"{largest:.1e} at the most\n  internal power by our rule: {sums[1] / sums[0]:.3f} of that by OpenSTA's of 2019"
    )
    return {"kinds": len(kinds), "largest_difference": largest, "our_rule_by_theirs": sums[1] / sums[0]}
