"""Lists the flip-flops of the Verilated coprocessor, for verilated_coprocessor.cpp to reach them by name.

usage: flip_flops.py VERILATED_DIRECTORY OUTPUT

Verilator keeps every variable under its own name, since all of them are traced. Registers end with _q (the RTL's
style), and arrays are memories. The output has a line for each:

FLIP_FLOP("u_sequencer.held_u_q", 32, coprocessor_probe__DOT__dut__DOT__u_sequencer__DOT__held_u_q)
FLIP_FLOPS("u_register_bank.u_words.words", 32, 32, ...)      name, words, bits of each, variable
"""

import re
import sys
from pathlib import Path

DESIGN = "coprocessor_probe__DOT__dut__DOT__"
REGISTER = re.compile(rf"^\s*(?:CData|SData|IData|QData|VlWide<\d+>)/\*(\d+):0\*/ ({DESIGN}\w+_q);", re.M)
MEMORY = re.compile(rf"^\s*VlUnpacked<[CSIQ]Data/\*(\d+):0\*/, (\d+)> ({DESIGN}\w+);", re.M)


def name_of(variable):
    return variable[len(DESIGN) :].replace("__DOT__", ".")


def lines(header):
    for high, variable in REGISTER.findall(header):
        yield f'FLIP_FLOP("{name_of(variable)}", {int(high) + 1}, {variable})'
    for high, words, variable in MEMORY.findall(header):
        yield f'FLIP_FLOPS("{name_of(variable)}", {words}, {int(high) + 1}, {variable})'


def main():
    folder, output = map(Path, sys.argv[1:])
    (header,) = folder.glob("V*___024root.h")
    output.write_text("".join(line + "\n" for line in sorted(lines(header.read_text()))))


if __name__ == "__main__":
    main()
