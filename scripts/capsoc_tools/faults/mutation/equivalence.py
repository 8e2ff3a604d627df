"""Proofs that a mutant never differs from the RTL at the coprocessor's pins.

All mutants stand in one and-inverter graph, so what a mutant leaves as it was is shared and needs no proof:

  structure    nothing is left that differs: the mutant changes no gate that a register or an output depends on
  next state   yosys-abc shows that from equal registers, whatever they hold, both circuits come to equal registers and
               outputs, whatever the inputs are. It may use the facts below, which are proved first by induction.
"""

import subprocess

from capsoc_tools.faults.mutation.and_graph import Circuit, Graph, Mutants

# What the facts are about; yosys makes outputs of them, which do not count as outputs here.
WEIGHTS = ["au", "bu", "cu", "av", "bv", "cv"]
TICK = ["stage", "load", "cycle"]
PASSES = [
    "expose "
    + " ".join(
        [
            *(f"w:u_datapath.{name} w:u_datapath.g_*.u_core.{name}" for name in TICK),
            *(f"w:u_register_bank.u_state.{name}" for name in WEIGHTS),
        ]
    ),
    "memory_map",
    "opt_clean",
    "async2sync",
    "dffunmap",
    "simplemap",
    "techmap",
    "opt_clean",
    "dffunmap",
    "setundef -zero",
    "aigmap",
    "opt_clean",
]
SOLVER_SECONDS = 60  # of the processor: a proof takes a second or two; multipliers can take for ever


class Unproved(Exception):
    """A fact that every proof needs."""


def commands(file):
    """What yosys does with the netlist of all mutants to write `file`."""
    return PASSES + [f"write_aiger -ascii -symbols {file}"]


class Prover:
    """All mutants of one arithmetic; `file` as commands() writes it, `folder` for the solver's files."""

    def __init__(self, file, folder, paper):
        self.circuit = Circuit(file)
        self.graph = Graph()
        self.mutants = Mutants(self.circuit, self.graph)
        self.folder = folder
        self.paper = paper
        self.count = len(self.circuit.registers)
        self.facts = self.prove_facts()

    def probed(self, name):
        """Indices of the registers of a probe's bits, lowest bit first; no index where there is no register."""
        place = {self.mutants.start[literal >> 1] >> 1: index for index, literal in enumerate(self.circuit.registers)}
        found = []
        for literal in self.circuit.probe(name):
            literal = self.mutants.original[literal >> 1] ^ literal & 1
            operands = self.graph.pairs[literal >> 1] or (literal,)  # the register itself, or that and no reset
            found.append(next((place[operand >> 1] for operand in operands if operand >> 1 in place), None))
        return found

    def statements(self, originals):
        """The facts on registers that yosys-abc needs, as one literal; `originals`: of all registers."""
        graph = self.graph

        def bits(name):
            return [originals[index] for index in self.probed(name) if index is not None]

        stage, load, cycle = bits("stage"), bits("load"), bits("cycle")
        any_stage, any_load = graph.any(stage), graph.any(load)
        running = graph.either(any_stage, any_load)
        # A LOAD is in one step and alone; no cycles are counted when nothing runs.
        wrong = [
            graph.both(load[0], load[1]),
            graph.both(load[0], load[2]),
            graph.both(load[1], load[2]),
            graph.both(any_load, any_stage),
            graph.both(graph.any(cycle), running ^ 1),
        ]
        if self.paper:  # a weight is a word of Q1.31; yosys has removed the bits below it
            wrong += [graph.differ(*bits(name)[-2:]) for name in WEIGHTS]
        return graph.any(wrong) ^ 1

    def prove_facts(self):
        """The facts hold in the state of all zeros, which a reset leaves, and continue to hold."""
        value = self.mutants.original
        now = [value[literal >> 1] for literal in self.circuit.registers]
        after = [value[literal >> 1] ^ literal & 1 for literal in self.circuit.results[: self.count]]
        facts, facts_after = self.statements(now), self.statements(after)
        if self.graph.evaluate([facts], {}) != [1] or not self.never(self.graph.both(facts, facts_after ^ 1)):
            raise Unproved("what equivalence.py states of the registers does not hold")
        return facts

    def never(self, literal):
        """Is `literal` 0 for all values of the variables?"""
        if literal < 2:
            return literal == 0
        file = self.folder / "question.aig"
        self.graph.write(literal, file)
        limit = ["prlimit", f"--cpu={SOLVER_SECONDS}"]
        # One that was stopped says nothing: not known.
        done = subprocess.run(
            [*limit, "yosys-abc", "-q", f"read_aiger {file}; iprove"], check=False, capture_output=True, text=True
        )
        return "UNSATISFIABLE" in done.stdout

    def prove(self, mutant):
        """The kind of proof; None if there is none."""
        differences = self.mutants.differences(mutant)
        if not differences:
            return "structure"
        graph = self.graph
        differ = graph.any(graph.differ(a, b) for a, b in differences)
        return "next state" if self.never(graph.both(differ, self.facts)) else None
