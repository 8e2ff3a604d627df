"""docs/reference/coprocessor.md, "Calibrator", and the node DET of "Turn judge": T0."""

from notation import clamp, rounded
from polar_unit import sine_cosine


def calibrate_precise(sample, registers):
    a_u, b_u, c_u, a_v, b_v, c_v = (rounded(w, 15) for w in registers.weights)
    du, dv = sample.u - c_u, sample.v - c_v
    sample.s = b_v * du - b_u * dv
    sample.c = a_u * dv - a_v * du
    det = a_u * b_v - a_v * b_u
    sample.mirror = det < 0
    if sample.mirror:
        sample.s, sample.c = -sample.s, -sample.c
    sample.cal_s = sample.saturated(rounded(sample.s, 31))
    sample.cal_c = sample.saturated(rounded(sample.c, 31))
    sample.det = clamp(rounded(det, 31))


def calibrate_paper(sample, registers):
    """Eq (12), on the parameter registers."""
    sine, cosine = sine_cosine(registers.beta)
    du = sample.saturated(sample.u - registers.b1)
    dv = sample.saturated(sample.v - registers.b2)
    u1 = sample.saturated(registers.a2 * du >> 31)
    v1 = sample.saturated(registers.a1 * dv >> 31)
    sample.cal_s = sample.saturated(u1 * cosine >> 31)
    sample.cal_c = sample.saturated(v1 + (u1 * sine >> 31))
    sample.mirror = cosine < 0
    sample.phi = registers.phi
    sample.det = clamp(clamp(registers.a1 * registers.a2 >> 31) * cosine >> 31)


def calibrate(arithmetic, sample, registers):
    """T0. The calibrated pair of the present coefficients (paper: parameters), and its determinant."""
    (calibrate_paper if arithmetic.paper else calibrate_precise)(sample, registers)
