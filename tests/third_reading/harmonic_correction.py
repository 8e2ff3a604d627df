"""docs/reference/coprocessor.md, "Harmonic correction": the table over the sensor's angle."""

from notation import TURN_32, signed

NODES = 128
SPACING = 1 << 16  # positions from a node to the next


class HarmonicCorrection:
    """Nodes s20, 2^-24 turn; a reset leaves them as they are."""

    def __init__(self):
        self.nodes = [0] * NODES

    def write(self, word):
        self.nodes[word >> 24 & 0x7F] = signed(word & 0xFFFFF, 20)

    def correct(self, relative, phi):
        """The relative angle without the correction, u32."""
        position = (relative >> 9) + (phi >> 9)
        j, f = position // SPACING % NODES, position % SPACING
        left, right = self.nodes[j], self.nodes[(j + 1) % NODES]
        correction = (left * (SPACING - f) + right * f) // SPACING
        return (relative - correction * 256) % TURN_32
