"""docs/reference/coprocessor.md, "Polar unit": T1, and twice in T4."""

import math
from dataclasses import dataclass

from notation import ONE_31, TURN_32, bit_length, clamp, rounded
from reference_generator import STAGES

SCALE = 2608131496  # round(K30 2^32)
GAIN = 1298774024  # round(1.9 / 2pi * 2^32): I of Eq (11)
TABLE = tuple(round(math.sin(2 * math.pi * j / 512) * (ONE_31 - 1)) for j in range(513))


@dataclass
class Polar:
    angle: int  # u32
    magnitude: int
    saturated: bool = False
    zero: bool = False
    settled: bool = True


def vectoring(y, x, fraction):
    """`precise`: the vectoring CORDIC of (y, x) with `fraction` fraction bits."""
    if x == 0 and y == 0:
        return Polar(0, 0, zero=True)
    k = 35 - max(bit_length(x), bit_length(y))
    x, y = (x << k, y << k) if k >= 0 else (rounded(x, -k), rounded(y, -k))
    z = 0
    if x < 0:
        x, y, z = -x, -y, 1 << 36
    for i, half, a in STAGES:
        along_y, along_x = (y + half) >> i, (x + half) >> i
        if y >= 0:
            x, y, z = x + along_y, y - along_x, z + a
        else:
            x, y, z = x - along_y, y + along_x, z - a
    magnitude = rounded(x * SCALE, 32 + k + fraction - 31)
    # z wraps in 37 bits, of which rounding uses the lower ones.
    return Polar(rounded(z, 5) % TURN_32, clamp(magnitude), saturated=magnitude != clamp(magnitude))


def look_up(angle):
    """`paper`: the sine of an angle of 32 bits."""
    index, f = angle >> 23, angle & 0x7FFFFF
    return TABLE[index] + ((TABLE[index + 1] - TABLE[index]) * f >> 23)


def sine_cosine(angle):
    return look_up(angle), look_up((angle + (1 << 30)) % TURN_32)


def square_root(a, b):
    """`paper`, Eq (10): the root of a^2 + b^2, and whether its square was saturated."""
    square = (a * a + b * b) >> 31
    x = min(square, ONE_31 - 1)
    y = 0
    for _ in range(30):
        y = clamp((y * y >> 31) - x + y)
    return min(-y, ONE_31 - 1), square != x


def arctangent(arithmetic, y, x):
    """`paper`, Eq (11), with what it says of itself: angle, the amplitude g, zero, settled."""
    zero = x == 0 and y == 0
    s, turned = 0, False
    if not arithmetic.plain_arctangent:
        s = 30 - max(bit_length(x), bit_length(y))
        y, x = (y << s, x << s) if s >= 0 else (y >> -s, x >> -s)
        turned = x < 0
        if turned:
            y, x = -y, -x
    k = 32 - arithmetic.operand_bits
    y, x = y >> k, x >> k
    angle = 0

    def error_of(sine, cosine):
        return ((y * (cosine >> k) - x * (sine >> k)) << (2 * k)) >> 31

    for _ in range(30):
        angle = (angle + (error_of(*sine_cosine(angle)) * GAIN >> 31)) % TURN_32
    sine, cosine = sine_cosine(angle)
    g = ((y * (sine >> k) + x * (cosine >> k)) << (2 * k)) >> 31
    settled = zero or abs(error_of(sine, cosine)) < g >> 10
    amplitude = g >> s if s >= 0 else g << -s
    amplitude = max(0, min(ONE_31 - 1, amplitude))
    return Polar((angle + (TURN_32 // 2 if turned else 0)) % TURN_32, amplitude, zero=zero, settled=settled)


def find_relative(arithmetic, sample):
    """T1. The angle relative to the reference, and the amplitude."""
    if arithmetic.paper:
        found = arctangent(arithmetic, sample.cal_s, sample.cal_c)
        sample.arctangent = found.angle
        sample.relative = (found.angle - sample.phi) % TURN_32
    else:
        found = vectoring(sample.s, sample.c, 62)
        sample.relative = found.angle
    sample.zero, sample.amplitude = found.zero, found.magnitude
    sample.sat |= found.saturated
    sample.unsettled = not found.settled


@dataclass
class Parameters:
    """What T4 finds; b1 and b2 with the sample's flag already set."""

    a1: int
    a2: int
    b1: int
    b2: int
    beta: int
    phi: int


def find_parameters(arithmetic, sample, registers):
    """T4: phi and a1 of (b_u, a_u), psi and a2 of (-a_v, b_v)."""
    a_u, b_u, c_u, a_v, b_v, c_v = registers.weights
    if arithmetic.paper:
        minus_a_v = sample.saturated(-a_v)
        first, second = arctangent(arithmetic, b_u, a_u), arctangent(arithmetic, minus_a_v, b_v)
        (a1, sat1), (a2, sat2) = square_root(b_u, a_u), square_root(minus_a_v, b_v)
        sample.unsettled |= registers.demod and not (first.settled and second.settled)
        b1, b2 = c_u, c_v
        sample.sat |= sat1 or sat2
    else:
        first, second = vectoring(b_u, a_u, 46), vectoring(-a_v, b_v, 46)
        a1, a2 = first.magnitude, second.magnitude
        sample.sat |= first.saturated or second.saturated
        b1, b2 = sample.saturated(rounded(c_u, 15)), sample.saturated(rounded(c_v, 15))
    return Parameters(a1, a2, b1, b2, (second.angle - first.angle) % TURN_32, first.angle)


def found_angle(arithmetic, sample, parameters):
    """T4: the sensor's own angle, in all cases."""
    return sample.arctangent if arithmetic.paper else (sample.relative + parameters.phi) % TURN_32
