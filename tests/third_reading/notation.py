"""docs/reference/coprocessor.md, "Notation and common rules"."""

from dataclasses import dataclass

TURN_32 = 1 << 32
TURN_48 = 1 << 48
ONE_31 = 1 << 31  # 1.0 in Q1.31, the first value that does not fit


@dataclass(frozen=True)
class Arithmetic:
    """`precise` or `paper`, with the latter's options."""

    paper: bool = False
    operand_bits: int = 32
    reference_lead: int = 0
    step_shift: int = 0
    plain_arctangent: bool = False
    iteration_clocks: int = 1

    @property
    def tick(self):
        """Cycles."""
        return 32 * self.iteration_clocks if self.paper else 32


def rounded(x, n):
    """x >>r n: to nearest, ties towards plus infinity."""
    return (x + (1 << (n - 1))) >> n if n else x


def clamp(x, bits=32):
    """To a signed word of `bits`, without a flag."""
    top = (1 << (bits - 1)) - 1
    return top if x > top else -top - 1 if x < -top - 1 else x


def signed(x, bits=32):
    """x modulo 2^bits, read as two's complement."""
    x &= (1 << bits) - 1
    return x - (1 << bits) if x >> (bits - 1) else x


def bit_length(x):
    """Without the sign; of the one's complement for negative numbers."""
    return (x if x >= 0 else ~x).bit_length()
