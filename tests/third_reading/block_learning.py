"""docs/reference/coprocessor.md, "Block learning": what becomes of an update of T3."""

from turn_judge import GOOD, TIMEOUT

NOTHING, WEIGHTS, SUMS = range(3)


class BlockLearning:
    """The block under way."""

    def __init__(self):
        self.sums = None
        self.unfit = False  # the sums do not fit their parity bits
        self.open = self.begun = False
        self.ended = True

    def decide(self, registers, learns):
        """As T3's tick begins: what the update is added to, and what is written with it."""
        ended, self.ended = self.ended, False
        if not registers.block:
            self.open = self.begun = False
            return registers.weights, WEIGHTS if learns else NOTHING
        base = self.sums if self.begun else registers.weights
        if not ended:
            if not (learns and self.open):
                return base, NOTHING
            self.begun = True
            return base, SUMS
        flags = registers.judge.turn_flags
        counts = bool(flags & GOOD) if registers.guard else not flags & TIMEOUT
        taken_over = learns and self.begun and counts
        self.open, self.begun = True, False
        return base, WEIGHTS if taken_over else NOTHING
