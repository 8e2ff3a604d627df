"""docs/reference/coprocessor.md, "Harmonic correction": the table over the sensor's angle."""

from notation import TURN_32, signed

NODES = 128
SPACING = 1 << 16  # positions from a node to the next


class HarmonicCorrection:
    """Nodes s20, 2^-24 turn; a reset leaves them as they are."""

    def __init__(self):
        self.nodes = [0] * NODES
        self.unfit = set()  # numbers of nodes that do not fit their parity bit

    def write(self, word, bad_parity):
        node = word >> 24 & 0x7F
        self.nodes[node] = signed(word & 0xFFFFF, 20)
        (self.unfit.add if bad_parity else self.unfit.discard)(node)

    def correct(self, relative, phi):
        """The relative angle without the correction, u32, and whether a node of it did not fit."""
        position = (relative >> 9) + (phi >> 9)
        j, f = position // SPACING % NODES, position % SPACING
        right = (j + 1) % NODES
        correction = (self.nodes[j] * (SPACING - f) + self.nodes[right] * f) // SPACING
        unfit = j in self.unfit or f > 0 and right in self.unfit
        return (relative - correction * 256) % TURN_32, unfit
