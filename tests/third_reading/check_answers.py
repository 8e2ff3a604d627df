#!/usr/bin/env python3
"""Checks a coprocessor's recorded answers against docs/reference/coprocessor.md, as this folder implements it.

usage: check_answers.py FILE...        (-: standard input)

FILE is what record_answers has written (its source has the format). Every answer, the interrupt line and BUSY from
edge to edge, and every register at each commit have to be those of the page. The first difference ends it, with its
edge, the access, the register, and both values.

Status 0: everything agrees; 1: it does not; 2: a file that cannot be read or is none.
"""

import sys
from collections import Counter

from coprocessor import Coprocessor
from notation import Arithmetic
from registers import NAMES

HEADER = "capsoc-answers 2"
OFFSETS = tuple(sorted(NAMES))


class BadFile(Exception):
    """One sentence for the user."""


class Difference(Exception):
    """What differs first."""


def named(offset):
    return f"{offset:#05x} ({NAMES.get(offset, 'no register')})"


def shown(value):
    return "PSLVERR" if value is None else f"{value:#x}"


class Replay:
    """One run of the record through the reading."""

    def __init__(self, arithmetic, counts):
        self.device = Coprocessor(arithmetic)
        self.counts = counts
        self.edge = 0
        self.levels = False, False  # as recorded
        self.commits = 0  # without their registers
        self.actions = {
            "s": self.sample,
            "w": self.write,
            "r": self.read,
            "d": self.peek,
            "x": self.reset,
            "l": self.level,
            "k": self.commit,
            "e": self.end,
        }

    def line(self, kind, words):
        edge = int(words[0])
        if edge < self.edge:
            raise BadFile(f"edge {edge} comes behind edge {self.edge}")
        self.go_to(edge)
        self.actions[kind](words[1:])

    def go_to(self, edge):
        """To the first line of `edge`: what lies between has to be as the record has it, without a line."""
        if edge == self.edge:
            return
        self.close()
        before = self.device.registers.since_reset
        for at in self.device.advance(edge):
            self.edge = at
            self.commits = self.device.registers.since_reset - before
            if at < edge:
                self.close()
        self.edge = edge

    def close(self):
        """The present edge is complete."""
        self.check_levels()
        if self.commits:
            raise Difference(f"edge {self.edge}: the page has a commit, the record has none")

    def check_levels(self):
        for name, ours, theirs in zip(("interrupt", "BUSY"), (self.device.interrupt(), self.device.busy), self.levels):
            if ours != theirs:
                raise Difference(f"edge {self.edge}: {name}: the page has {ours:d}, answered was {theirs:d}")

    def check(self, what, ours, theirs):
        if ours != theirs:
            raise Difference(f"edge {self.edge}: {what}: the page has {shown(ours)}, answered was {shown(theirs)}")

    def sample(self, words):
        u, v, clip, latched = (int(word, 16) for word in words)
        self.counts["samples"] += 1
        self.check(
            f"sample ({u:#010x}, {v:#010x}): latched", int(self.device.submit(self.edge, u, v, bool(clip))), latched
        )

    def write(self, words):
        offset, value, ok = (int(word, 16) for word in words)
        self.counts["writes"] += 1
        self.check(
            f"write of {value:#x} to {named(offset)}: accepted", int(self.device.write(self.edge, offset, value)), ok
        )
        if self.device.registers.since_reset == 0:
            self.commits = 0  # a soft reset at the edge of the commit

    def read(self, words):
        offset, value, ok = (int(word, 16) for word in words)
        self.counts["reads"] += 1
        self.check(f"read of {named(offset)}", self.device.read(offset), value if ok else None)
        self.check(f"data of the read of {named(offset)}", value if ok else 0, value)

    def peek(self, words):
        offset, value, ok = (int(word, 16) for word in words)
        self.counts["reads"] += 1
        self.check(f"debugger's read of {named(offset)}", self.device.peek(offset), value if ok else None)
        self.check(f"data of the debugger's read of {named(offset)}", value if ok else 0, value)

    def reset(self, words):
        self.device.reset()
        self.commits = 0

    def level(self, words):
        interrupt, busy = words
        self.counts["changes of a level"] += 1
        self.levels = interrupt == "1", busy == "1"
        self.check_levels()

    def commit(self, words):
        if len(words) != len(OFFSETS):
            raise BadFile(f"a commit has {len(words)} registers, not {len(OFFSETS)}")
        self.counts["commits"] += 1
        self.commits = 0
        for offset, word in zip(OFFSETS, words):
            ours = self.device.peek(offset)
            if ours != int(word, 16):
                self.check(f"{named(offset)} at a commit", ours, int(word, 16))

    def end(self, words):
        self.close()


def arithmetic_of(words):
    name, bits, lead, shift, plain, clocks = words
    if name not in ("precise", "paper"):
        raise BadFile(f"there is no arithmetic {name!r}")
    return Arithmetic(name == "paper", int(bits), int(lead), int(shift), plain == "1", int(clocks))


def check_lines(lines, counts):
    """All runs of a file."""
    if next(lines, "").rstrip("\n") != HEADER:
        raise BadFile(f"its first line is not {HEADER!r}")
    replay, run = None, None
    for number, line in enumerate(lines, 2):
        kind, *words = line.split()
        try:
            if kind == "run":
                if replay is not None:
                    raise BadFile(f"the run {run} has no end")
                replay, run = Replay(arithmetic_of(words[:6]), counts), " ".join([words[0], *words[6:]])
                counts["runs"] += 1
            else:
                if replay is None:
                    raise BadFile("no run has begun")
                replay.line(kind, words)
                replay = None if kind == "e" else replay
        except Difference as difference:
            raise Difference(f"{run}, line {number}, {difference}") from None
        except BadFile as bad:
            raise BadFile(f"line {number}: {bad}") from None
        except (KeyError, ValueError, IndexError):
            raise BadFile(f"line {number} is none of its format: {line.strip()[:60]!r}") from None
    if replay is not None:
        raise BadFile(f"the run {run} has no end")


def main(names):
    if not names or names[0].startswith("--"):
        print(__doc__.strip(), file=sys.stderr if names[:1] != ["--help"] else sys.stdout)
        return 0 if names[:1] == ["--help"] else 2
    counts = Counter()
    for name in names:
        try:
            with open(0 if name == "-" else name, encoding="ascii") as file:
                check_lines(iter(file), counts)
        except Difference as difference:
            print(f"{name}: {difference}")
            return 1
        except (BadFile, OSError, UnicodeDecodeError) as bad:
            print(f"check_answers: {name}: {bad}", file=sys.stderr)
            return 2
    print(
        "agreed: "
        + ", ".join(
            f"{counts[kind]} {kind}" for kind in ("runs", "samples", "writes", "reads", "changes of a level", "commits")
        )
    )
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
