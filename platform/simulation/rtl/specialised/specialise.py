"""Generates edges of the Verilated coprocessor for the states of its sequencer in which a run spends its time.

usage: specialise.py VERILATED_DIRECTORY OUTPUT.cpp

Verilator evaluates the whole design at every edge. But one sample in flight keeps only one stage of five busy, and in
that stage only the logic of the present cycle. A few registers of the sequencer determine which logic that is. So this
script writes Verilator's code again, with these registers as constants, once for each of their values. The compiler
removes the logic that they rule out. docs/explanation/architecture.md, "RTL that skips idle logic", says why the result
is the same.

A specialised edge is what Verilator evaluates at it, rising and falling, after all combinational logic computed from
the registers (Verilator's settling, `stl`). What settling assigns is a function of registers and inputs, so it is a
local variable here, and what no register needs of it is not computed.

The output defines what edges.h declares. If the code has not the form of Verilator 5.006 or of 5.032, for which this
script was written, the tables are empty, with a warning: RTL then runs without specialised edges, only slower.
"""

import re
import sys
from pathlib import Path

TOP = "Vcoprocessor_probe___024root"
PROBE = "coprocessor_probe__DOT__"
SEQUENCER = PROBE + "dut__DOT__u_sequencer__DOT__"
# The compiler compares them with the numbers of models/coprocessor/sequencer.h.
CYCLES = 32
STAGES = 5

# Registers of which a specialised edge knows the value, and that it writes back.
REGISTERS = ("cycle_q", "stage_q", "held_q", "load_q", "load_pending_q")
# What the probe has on the design's pins.
PINS = ("psel", "penable", "pwrite", "sample_valid", "presetn")
PORT_TYPES = {"8": "CData", "16": "SData", "": "IData", "64": "QData"}

FUNCTION = re.compile(r"void " + TOP + r"__(_\w+)\(" + TOP + r"\* vlSelf\) \{\n(.*?)\n\}\n", re.S)
FIELD = re.compile(r"^\s*((?:CData|SData|IData|QData|VlWide<\d+>|VlUnpacked<[^;]*>)(?:/\*[\d:]+\*/)?) (\w+);", re.M)
PORT = re.compile(r"^\s*VL_(IN|OUT)(8|16|64|)\((\w+),", re.M)
ASSIGNED = re.compile(r"vlSelf->(\w+)\s*(?:\[[^]=]*\]\s*)*=(?!=)")
# A function that writes a wide word is a statement, its result the first argument after the numbers.
ASSIGNED_WIDE = re.compile(r"(?:^|[;{}])\s*VL_\w+\((?:\s*\d+,)*\s*vlSelf->(\w+)", re.M)
NOISE = ("VL_DEBUG_IF", "Prevent unused", "vlSymsp VL_ATTR_UNUSED", "vlSelfRef = std::ref")
# `if (triggers) {` calls of functions, and notes for the writer of waves `}`
EVALUATED = re.compile(r"^    if \(([^{}]*?)\) \{\n(.*?)\n    \}$", re.M | re.S)
CALL = re.compile(r"\w+__(_nba_\w+)\(vlSelf\);")
WAVES = re.compile(r"vlSelf->__Vm_traceActivity\[\w+\] = 1U;")


class UnknownForm(Exception):
    """What is missing in Verilator's code."""


def in_old_form(text):
    """Code of Verilator 5.032 as 5.006 writes it; what 5.006 wrote as it is."""

    def triggers(masked):
        bits = int(masked[1], 0)
        names = [f"{masked[2]}.at({bit}U)" for bit in range(bits.bit_length()) if bits >> bit & 1]
        return f"({' | '.join(names)})"

    text = text.replace("vlSelfRef.", "vlSelf->")
    text = re.sub(r"(vlSelf->__VactTriggered)\.set\((\d+)U, (.*?)\);\n", r"\1.at(\2U) = \3;\n", text, flags=re.S)
    text = re.sub(r"\((\w+?)ULL\s*&\s*(vlSelf->__V\w+Triggered)\s*\.word\(0U\)\)", triggers, text)
    return re.sub(r"__Vtrigprevexpr___TOP__(\w+?)__0\b", r"__Vtrigrprev__TOP__\1", text)


class Verilated:
    """What the generated files say: fields, functions, triggers and the order of evaluation."""

    def __init__(self, folder):
        self.folder = folder
        header = (folder / f"{TOP}.h").read_text()
        text = in_old_form("\n".join(path.read_text() for path in sorted(folder.glob(f"{TOP}__DepSet_*.cpp"))))
        self.functions = dict(FUNCTION.findall(text))
        self.types = {name: kind for kind, name in FIELD.findall(header)}
        self.outputs = []
        for direction, width, name in PORT.findall(header):
            self.types[name] = PORT_TYPES[width]
            if direction == "OUT":
                self.outputs.append(name)
        self.settling = [
            self.function(name) for name in re.findall(r"__(_stl_\w+)\(vlSelf\);", self.function("_eval_stl"))
        ]
        self.triggers = re.findall(
            r"vlSelf->__VactTriggered\.at\((\d+)U\) = (.*?);", self.function("_eval_triggers__act"), re.S
        )
        self.order = []  # (triggers, function)
        for condition, block in EVALUATED.findall(self.function("_eval_nba")):
            self.order += [(condition, name) for name in CALL.findall(block)]
            if WAVES.sub("", CALL.sub("", block)).strip():
                raise UnknownForm("a block of evaluation that does more than call functions")
        if not self.settling or not self.triggers or not self.order:
            raise UnknownForm("no functions that settle, trigger or evaluate")
        if CALL.findall(self.function("_eval_nba")) != [name for _, name in self.order]:
            raise UnknownForm("an order of evaluation that is no list of functions after triggers")

    def function(self, name):
        if name not in self.functions:
            raise UnknownForm(f"no function {name}")
        return self.functions[name]

    def combinational(self):
        """Fields that settling assigns."""
        names = set()
        for body in self.settling:
            names.update(ASSIGNED.findall(body))
            names.update(ASSIGNED_WIDE.findall(body))
        return {name for name in names if name in self.types}


class Writer:
    def __init__(self, verilated):
        self.verilated = verilated
        # By the names of advance()'s arguments.
        self.known = {SEQUENCER + name: name for name in REGISTERS}
        self.known.update({PROBE + name: name for name in PINS})
        self.known["drive_i"] = "0"
        for name in self.known:
            if name not in verilated.types:
                raise UnknownForm(f"no variable {name}")
        self.combinational = verilated.combinational()
        self.local = self.combinational | set(self.known)
        if self.combinational & set(self.known):
            raise UnknownForm("a register of the sequencer that is assigned without a clock")

    def own(self, text):
        """`text` with local variables for what is local."""
        return re.sub(r"vlSelf->(\w+)", lambda match: match[1] if match[1] in self.local else match[0], text)

    def block(self, body):
        lines = [line for line in body.split("\n") if not any(noise in line for noise in NOISE)]
        return "{\n" + self.own("\n".join(lines)) + "\n}\n"

    def edge(self, rises):
        """What Verilator evaluates at an edge of the clock and no other."""
        clock = {"vlSelf->pclk_i": str(rises), "vlSelf->__Vtrigrprev__TOP__pclk_i": str(1 - rises)}
        text = "{\n"
        for number, expression in self.verilated.triggers:
            for name, value in clock.items():
                expression = expression.replace(name, value)
            # Whatever else might trigger is as it was.
            expression = re.sub(r"vlSelf->__Vtrigrprev__TOP__(\w+)", r"vlSelf->\1", expression)
            if "__Vtrig" in expression:
                raise UnknownForm(f"a trigger with another name of what was before: {expression}")
            text += f"const bool triggered_{number} = {self.own(expression)};\n"
        for condition, name in self.verilated.order:
            condition = re.sub(r"vlSelf->__VnbaTriggered\.at\((\d+)U\)", r"triggered_\1", condition)
            if "Triggered" in condition:
                raise UnknownForm(f"a condition that is none of the triggers: {condition}")
            text += f"if ({condition}) " + self.block(self.verilated.function(name))
        return text + "}\n"

    def declarations(self):
        lines = []
        for name in sorted(self.local):
            kind = self.verilated.types[name]
            value = self.known.get(name, "" if kind.startswith("Vl") else "0")
            lines.append(f"{kind} {name}" + (f" = {value};" if value else ";"))
        return "\n".join(lines) + "\n"

    def source(self):
        outputs = [name for name in self.verilated.outputs if name in self.local]
        pool = sorted(self.verilated.folder.glob("*__ConstPool_0.cpp"))
        arguments = ", ".join(f"const CData {name}" for name in REGISTERS + PINS)
        as_they_are = ", ".join(
            [f"vlSelf->{SEQUENCER}{name}" for name in REGISTERS] + [f"vlSelf->{PROBE}{name}" for name in PINS]
        )
        parts = [
            "// Generated by platform/simulation/rtl/specialised/specialise.py; do not edit.",
            '#include "rtl/specialised/edges.h"',
            '#include "Vcoprocessor_probe__Syms.h"',
            '#include "verilated.h"',
            "namespace {",
            "// The tables' words are constants here, too.",
            *(f'#include "{path.name}"' for path in pool),
            f"using Root = {TOP};",
            "template <bool rises>",
            f"[[gnu::always_inline, gnu::flatten]] inline void advance(Root* __restrict vlSelf, {arguments}) {{",
            self.declarations(),
            *(self.block(body) for body in self.verilated.settling),
            "if constexpr (rises) {",
            self.edge(1),
            self.edge(0),
            *(f"vlSelf->{SEQUENCER}{name} = {SEQUENCER}{name};" for name in REGISTERS),
            "} else {",
            *(f"vlSelf->{name} = {name};" for name in outputs),
            "}",
            "}",
            "template <bool rises, CData cycle, CData stage, CData held = 0, CData sample_valid = 0>",
            "[[gnu::flatten]] void edge(Root* root) {"
            " advance<rises>(root, cycle, stage, held, 0, 0, 0, 0, 0, sample_valid, 1); }",
            "}  // namespace",
            "namespace capsoc::rtl {",
            f"static_assert(coprocessor::stage_count == {STAGES} && coprocessor::tick_cycles == {CYCLES});",
            "const SpecialisedEdge specialised_edges[specialised_states][coprocessor::tick_cycles] = {",
            *self.table("true", range(CYCLES)),
            "};",
            "const SpecialisedEdge specialised_outputs[specialised_states][coprocessor::tick_cycles] = {",
            *self.table("false", (0, CYCLES - 1)),
            "};",
            f"[[gnu::flatten]] void outputs(Root* vlSelf) {{ advance<false>(vlSelf, {as_they_are}); }}",
            "const bool has_outputs = true;",
            "}  // namespace capsoc::rtl",
            "",
        ]
        return "\n".join(parts)

    @staticmethod
    def table(rises, cycles):
        """Rows of the tables, as edges.h names them."""
        for stage in range(STAGES):
            row = (f"edge<{rises}, {cycle}, {1 << stage}>" if cycle in cycles else "nullptr" for cycle in range(CYCLES))
            yield "{" + ", ".join(row) + "},"
        for held, sample in ((1, 0), (0, 1), (0, 0)):
            yield f"{{edge<{rises}, 0, 0, {held}, {sample}>}},"


def main():
    if len(sys.argv) != 3:
        print(__doc__.split("\n\n")[1], file=sys.stderr)
        return 2
    folder, output = Path(sys.argv[1]), Path(sys.argv[2])
    try:
        text = Writer(Verilated(folder)).source()
    except (UnknownForm, OSError) as problem:
        print(f"specialise: warning: {folder}: {problem}; RTL runs without specialised edges", file=sys.stderr)
        text = '#include "rtl/specialised/no_edges.cpp"\n'
    output.write_text(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
