"""A sequential circuit as an and-inverter graph (AIGER's text form), and what a mutant changes in it.

Literals are AIGER's: twice the node's number, plus 1 if inverted; 0 and 1 are the constants.
"""

import re


class Circuit:
    """Inputs, registers, outputs and and-gates of one file; gates come in an order in which they can be computed."""

    def __init__(self, file):
        with open(file, encoding="ascii") as text:
            _, _, inputs, registers, outputs, gates = text.readline().split()
            counts = [int(inputs), int(registers), int(outputs), int(gates)]
            self.inputs = [int(text.readline()) for _ in range(counts[0])]
            rows = [text.readline().split() for _ in range(counts[1])]
            self.registers = [int(row[0]) for row in rows]
            next_states = [int(row[1]) for row in rows]
            outputs = [int(text.readline()) for _ in range(counts[2])]
            self.gates = sorted(tuple(map(int, text.readline().split())) for _ in range(counts[3]))
            self.names = {"i": {}, "o": {}}
            for line in text:
                if line.startswith("c"):
                    break
                kind, _, name = line.strip().partition(" ")
                if kind[0] in self.names:
                    self.names[kind[0]][name] = (self.inputs if kind[0] == "i" else outputs)[int(kind[1:])]
            # Outputs that are probes have a dot in their name: yosys makes them of a module's inside.
            self.results = next_states + [literal for name, literal in self.names["o"].items() if "." not in name]

    def input_word(self, name):
        """Literals of an input, lowest bit first."""
        return self.word("i", re.compile(rf"{re.escape(name)}\[(\d+)\]"))

    def probe(self, name):
        return self.word("o", re.compile(rf"\S+\.{re.escape(name)}\[(\d+)\]"))

    def word(self, kind, pattern):
        found = {
            int(match[1]): literal for text, literal in self.names[kind].items() if (match := pattern.fullmatch(text))
        }
        return [found[bit] for bit in range(len(found))]


class Graph:
    """And-gates without duplicates, made one by one."""

    def __init__(self):
        self.pairs = [(0, 0)]  # by number; a variable has none
        self.known = {}

    def variable(self):
        self.pairs.append(None)
        return 2 * len(self.pairs) - 2

    def both(self, a, b):
        if a > b:
            a, b = b, a
        if a == 0 or a ^ b == 1:
            return 0
        if a in (1, b):
            return b
        pair = (a, b)
        literal = self.known.get(pair)
        if literal is None:
            literal = self.known[pair] = 2 * len(self.pairs)
            self.pairs.append(pair)
        return literal

    def either(self, a, b):
        return self.both(a ^ 1, b ^ 1) ^ 1

    def differ(self, a, b):
        return self.either(self.both(a, b ^ 1), self.both(a ^ 1, b))

    def any(self, literals):
        result = 0
        for literal in literals:
            result = self.either(result, literal)
        return result

    def below(self, literals):
        """Numbers of all nodes that these depend on, operands first."""
        order, seen, stack = [], set(), [literal >> 1 for literal in literals]
        while stack:
            node = stack.pop()
            if node < 0:
                order.append(~node)
            elif node not in seen:
                seen.add(node)
                stack.append(~node)
                stack.extend(operand >> 1 for operand in self.pairs[node] or ())
        return [node for node in order if node]

    def evaluate(self, literals, variables):
        """Values of literals, given those of variables by number (0 where none is given)."""
        value = {0: 0}
        for node in self.below(literals):
            pair = self.pairs[node]
            value[node] = (
                variables.get(node, 0)
                if pair is None
                else (value[pair[0] >> 1] ^ pair[0] & 1) & (value[pair[1] >> 1] ^ pair[1] & 1)
            )
        return [value[literal >> 1] ^ literal & 1 for literal in literals]

    def write(self, literal, file):
        """The gates below `literal` as an AIGER file with that one output."""
        order = self.below([literal])
        variables = [node for node in order if self.pairs[node] is None]
        gates = [node for node in order if self.pairs[node]]
        place = {node: index for index, node in enumerate([0] + variables + gates)}

        def renamed(of):
            return 2 * place[of >> 1] + (of & 1)

        with open(file, "wb") as out:
            count = len(variables) + len(gates)
            out.write(f"aig {count} {len(variables)} 0 1 {len(gates)}\n{renamed(literal)}\n".encode())
            for node in gates:
                low, high = sorted(map(renamed, self.pairs[node]))
                out.write(packed(2 * place[node] - high) + packed(high - low))


def packed(number):
    """AIGER's binary numbers: seven bits a byte, lowest first."""
    result = bytearray()
    while number >= 128:
        result.append(number & 127 | 128)
        number >>= 7
    return bytes(result + bytearray([number]))


class Mutants:
    """The circuit without a mutant and with each of them, in one graph."""

    def __init__(self, circuit, graph):
        self.circuit = circuit
        self.graph = graph
        self.selectors = circuit.input_word("mutant")
        self.start = [None] * (2 + 2 * (len(circuit.inputs) + len(circuit.registers) + len(circuit.gates)))
        self.start[0] = 0
        for literal in circuit.inputs + circuit.registers:
            self.start[literal >> 1] = graph.variable()
        self.original = self.computed(self.choose(0))

    def choose(self, mutant):
        return {literal >> 1: mutant >> bit & 1 for bit, literal in enumerate(self.selectors)}

    def computed(self, inputs, before=None):
        """Literals in the graph of all nodes, with `inputs` given; `before`: of the original, where nothing changes."""
        value = list(self.start if before is None else before)
        for node, literal in inputs.items():
            value[node] = literal
        both = self.graph.both
        if before is None:
            for output, a, b in self.circuit.gates:
                value[output >> 1] = both(value[a >> 1] ^ a & 1, value[b >> 1] ^ b & 1)
            return value
        changed = bytearray(len(value))
        for node in inputs:
            changed[node] = value[node] != before[node]
        for output, a, b in self.circuit.gates:
            if changed[a >> 1] or changed[b >> 1]:
                node = output >> 1
                value[node] = both(value[a >> 1] ^ a & 1, value[b >> 1] ^ b & 1)
                changed[node] = value[node] != before[node]
        return value

    def differences(self, mutant):
        """Pairs of literals of the results (registers' next values, then outputs) that may differ."""
        value = self.computed(self.choose(mutant), self.original)
        pairs = (
            (self.original[literal >> 1] ^ literal & 1, value[literal >> 1] ^ literal & 1)
            for literal in self.circuit.results
        )
        return [(a, b) for a, b in pairs if a != b]
