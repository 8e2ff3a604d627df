"""docs/reference/coprocessor.md, "LMS demodulator": T3."""

from block_learning import NOTHING, SUMS, WEIGHTS
from notation import ONE_31, rounded
from reference_generator import ANGLE


def limited(error, slew):
    """Limited slew: the error that an update sees."""
    if slew == 0:
        return error
    limit = ONE_31 >> (2 * slew)
    return max(-limit, min(limit - 1, error))


def error_precise(sample, data, weights):
    w = [rounded(weight, 15) for weight in weights]
    estimate = rounded(w[0] * sample.sine + w[1] * sample.cosine, 31) + w[2]
    return sample.saturated(data - estimate)


def error_paper(sample, data, weights):
    estimate = (weights[0] * sample.sine >> 31) + (weights[1] * sample.cosine >> 31) + weights[2]
    return sample.saturated(data - estimate)


def changes_precise(sample, error, steps):
    g = [rounded(error * step, 16) for step in steps]
    return rounded(g[0] * sample.sine, 31), rounded(g[1] * sample.cosine, 31), g[2]


def changes_paper(arithmetic, sample, error, steps):
    g = [error * (step >> arithmetic.step_shift) >> 31 for step in steps]
    return g[0] * sample.sine >> 31, g[1] * sample.cosine >> 31, g[2]


def demodulate(arithmetic, sample, registers):
    """T3. Weights are those of `registers` in the arithmetic's own words: s48 Q2.46, `paper` s32 Q1.31."""
    learns = registers.demod and not registers.frozen and not (sample.source == ANGLE and sample.zero)
    base, written = registers.blocks.decide(registers, learns)
    errors, following = [], []
    for channel, data in enumerate((sample.u, sample.v)):
        weights = registers.weights[3 * channel : 3 * channel + 3]
        steps = registers.steps[3 * channel : 3 * channel + 3]
        error = (error_paper if arithmetic.paper else error_precise)(sample, data, weights)
        errors.append(error)
        if written == NOTHING:
            continue
        seen = limited(error, registers.slew)
        changes = (
            changes_paper(arithmetic, sample, seen, steps) if arithmetic.paper else changes_precise(sample, seen, steps)
        )
        bits = 32 if arithmetic.paper else 48
        following += [
            sample.saturated(w + change, bits) for w, change in zip(base[3 * channel : 3 * channel + 3], changes)
        ]
    sample.errors = errors
    sample.next_weights = following if written == WEIGHTS else None
    sample.next_sums_of_block = following if written == SUMS else None
    # Error average, whether or not DEMOD: 64 times it.
    sample.next_sums = [s + abs(e) - rounded(s, 6) for s, e in zip(registers.error_sums, errors)]
