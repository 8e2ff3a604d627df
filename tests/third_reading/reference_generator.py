"""docs/reference/coprocessor.md, "Reference generator": T2, and the rotation that LOAD uses, too."""

import math

from notation import TURN_32, TURN_48, clamp, rounded, signed

NUMERIC, TRACKING, ANGLE = 0, 1, 2

# "precise": 30 stages, 5 guard bits
START = 41730103921
ARCTANGENTS = (
    17179869184,
    10141868980,
    5358685036,
    2720152196,
    1365354594,
    683342891,
    341754828,
    170887842,
    85445225,
    42722775,
    21361408,
    10680707,
    5340354,
    2670177,
    1335088,
    667544,
    333772,
    166886,
    83443,
    41722,
    20861,
    10430,
    5215,
    2608,
    1304,
    652,
    326,
    163,
    81,
    41,
)
STAGES = tuple((i, (1 << i) >> 1, a) for i, a in enumerate(ARCTANGENTS))

# "paper": 28 stages, no guard bits
PAPER_START = 1304065748
PAPER_STAGES = tuple((i, round(math.atan(2.0**-i) / (2 * math.pi) * TURN_32)) for i in range(28))


def folded(z, bits, start):
    """Rotation CORDIC, step 1: z within a quarter of a turn, and x."""
    top, next_to_top = z >> (bits - 1) & 1, z >> (bits - 2) & 1
    if top != next_to_top:
        return signed(z ^ (1 << (bits - 1)), bits), -start
    return signed(z, bits), start


def rotate_precise(p):
    z, x = folded(rounded(p, 11) & ((1 << 37) - 1), 37, START)
    y = 0
    for i, half, a in STAGES:
        along_y, along_x = (y + half) >> i, (x + half) >> i
        if z >= 0:
            x, y, z = x - along_y, y + along_x, z - a
        else:
            x, y, z = x + along_y, y - along_x, z + a
    return clamp(rounded(y, 5)), clamp(rounded(x, 5))


def rotate_paper(p):
    z, x = folded(p >> 16, 32, PAPER_START)
    y = 0
    for i, a in PAPER_STAGES:
        along_y, along_x = y >> i, x >> i
        if z >= 0:
            x, y, z = x - along_y, y + along_x, z - a
        else:
            x, y, z = x + along_y, y - along_x, z + a
    return clamp(y), clamp(x)


def rotate(arithmetic, p):
    """Sine and cosine, Q1.31, of a phase of 48 bits."""
    return rotate_paper(p) if arithmetic.paper else rotate_precise(p)


def refer(arithmetic, sample, registers):
    """T2. The sample gets its reference and what PHASE and FREQ become at the tick's end."""
    source = sample.source = registers.source
    phase, freq = registers.phase, registers.freq
    p = sample.relative << 16 if source == ANGLE else phase
    sample.ref_phase = rounded(p, 16) % TURN_32
    sample.residue = 0 if sample.zero else signed(sample.relative - sample.ref_phase)
    lead = arithmetic.reference_lead * freq if arithmetic.paper and source != ANGLE else 0
    sample.sine, sample.cosine = rotate(arithmetic, (p + lead) % TURN_48)

    step = phase + freq
    sample.turn = source != TRACKING and not 0 <= step < TURN_48
    sample.next_freq = None
    if source == TRACKING:
        e = sample.residue << 16
        step += rounded(e, registers.kp)
        sample.next_freq = sample.saturated(freq + rounded(e, registers.ki), 48)
    sample.next_phase = step % TURN_48
