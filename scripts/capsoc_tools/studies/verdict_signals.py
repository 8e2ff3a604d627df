"""What breaks the channels of a random sensor, a kind at a time, for `verdicts`.

Each of SIGNALS changes the channels: (u, v) = change(case, u, v, angle), with u and v in full scale of the converter
and the angle in turns.
"""

import numpy as np

from capsoc_tools.studies.verdict_sensors import TURN, log_uniform, sign


def constant(channel, value):
    """A channel that has one value."""

    def change(case, u, v, angle):
        shifted = np.full(case.n, (case.sensor.b1, case.sensor.b2)[channel] + value)
        return (shifted, v) if channel == 0 else (u, shifted)

    return change


def noise_only(size):
    """Noise and nothing else."""

    def change(case, u, v, angle):
        return case.arrays.normal(0, size, case.n), case.arrays.normal(0, size, case.n)

    return change


def spikes(case, u, v, angle):
    """Samples of any value, at random."""
    lost = case.arrays.random_sample(case.n) < log_uniform(case.draw, 1 / 2000, 0.05)
    garbage = case.arrays.uniform(-0.99, 0.99, (2, case.n))
    return np.where(lost, garbage[0], u), np.where(lost, garbage[1], v)


def dropouts(case, u, v, angle):
    """Both channels are 0 now and then."""
    lost = case.arrays.random_sample(case.n) < log_uniform(case.draw, 0.0005, 0.1)
    return np.where(lost, 0, u), np.where(lost, 0, v)


def garbage(case, u, v, angle):
    """Samples of a stretch, all or some, have nothing to do with the shaft, but lie where its signals do."""
    draw, s = case.draw, case.sensor
    lost = case.inside(case.stretch(0.02, 2)) & (case.arrays.random_sample(case.n) < log_uniform(draw, 0.003, 2))
    if draw.random() < 0.5:
        other = s.b1 + s.a1 * case.arrays.uniform(-1, 1, case.n), s.b2 + s.a2 * case.arrays.uniform(-1, 1, case.n)
    else:
        other = s.signals(case.arrays.uniform(0, 1, case.n), case.arrays)  # on the ellipse
    return np.where(lost, other[0], u), np.where(lost, other[1], v)


def mains(case, u, v, angle):
    """Hum of 50.3 Hz on both channels."""
    hum = log_uniform(case.draw, 0.003, 0.3) * case.sensor.least * np.sin(TURN * 50.3 * case.seconds)
    return u + hum, v + hum


def gain_step(case, u, v, angle):
    """The gain of one channel changes."""
    draw, s = case.draw, case.sensor
    gain = draw.choice((log_uniform(draw, 0.3, 3), 1 + sign(draw) * log_uniform(draw, 0.003, 0.3)))
    changed = case.inside(case.stretch())
    if draw.random() < 0.5:
        return np.where(changed, (u - s.b1) * gain + s.b1, u), v
    return u, np.where(changed, (v - s.b2) * gain + s.b2, v)


def air_gap(case, u, v, angle):
    """Both amplitudes change, the offsets do not."""
    draw, s = case.draw, case.sensor
    first, end = case.stretch()
    gain = log_uniform(draw, 0.3, 1.5)
    course = np.interp(case.k, [first, first + max(1, draw.choice((1, end - first)))], [1, gain])
    return (u - s.b1) * course + s.b1, (v - s.b2) * course + s.b2


def offset_step(case, u, v, angle):
    """The offset of one channel jumps."""
    jump = sign(case.draw) * log_uniform(case.draw, 0.003, 0.5) * case.inside(case.stretch())
    return (u + jump * case.sensor.a1, v) if case.draw.random() < 0.5 else (u, v + jump * case.sensor.a2)


def offset_drift(case, u, v, angle):
    """An offset drifts from the beginning."""
    turns = case.k / case.plan.turn
    return u + sign(case.draw) * log_uniform(case.draw, 1e-3, 0.5) * case.sensor.a1 * turns, v


def late_drift(case, u, v, angle):
    """Offsets, gains or the phase between the channels begin to drift somewhere."""
    draw, s = case.draw, case.sensor
    first, _ = case.stretch()
    grown = np.maximum(0, case.k - first) / case.plan.turn * sign(draw) * log_uniform(draw, 1e-3, 0.5)
    what = draw.choice(("offset", "gain", "phase"))
    if what == "offset":
        return u + s.a1 * grown, v
    if what == "gain":
        return u, (v - s.b2) * np.exp(np.clip(grown, -3, 1)) + s.b2
    return u, v + s.a2 * (np.cos(TURN * angle + s.beta + np.clip(grown, -1, 1)) - np.cos(TURN * angle + s.beta))


def modulated(case, u, v, angle):
    """The amplitude of channel U swings at any frequency."""
    depth, hertz = log_uniform(case.draw, 0.02, 0.5), log_uniform(case.draw, 0.1, 10) * case.plan.speed
    return (u - case.sensor.b1) * (1 + depth * np.sin(TURN * hertz * case.seconds)) + case.sensor.b1, v


def modulated_by_turn(order):
    """An eccentric magnet: both amplitudes change `order` times a turn, together or each with its own phase."""

    def change(case, u, v, angle):
        draw, s = case.draw, case.sensor
        depth, phase = log_uniform(draw, 0.02, 0.3), draw.uniform(0, 1)
        other = phase if draw.random() < 0.7 else draw.uniform(0, 1)
        return (
            (u - s.b1) * (1 + depth * np.sin(TURN * (order * angle + phase))) + s.b1,
            (v - s.b2) * (1 + depth * np.sin(TURN * (order * angle + other))) + s.b2,
        )

    return change


def neighbour(ratios, largest):
    """A neighbouring track that turns at another speed couples into both channels."""

    def change(case, u, v, angle):
        draw, s = case.draw, case.sensor
        size = log_uniform(draw, 0.01, largest)
        ratio = ratios(draw)
        phase, skew = draw.uniform(0, 1), 0 if draw.random() < 0.7 else draw.uniform(-0.25, 0.25)
        # From the angle and not from time: it is a track of the same shaft.
        other = TURN * (ratio * angle + phase)
        if case.shuffled:
            other = TURN * (ratio * s.angle(case.seconds) + phase)
        return u + size * s.a1 * np.sin(other), v + size * s.a2 * np.cos(other + TURN * skew)

    return change


def slow_ratio(draw):
    return 1 + sign(draw) * log_uniform(draw, 0.001, 0.1)


def pole_ratio(draw):
    return draw.choice((0.5, 0.5, 1 / 3, 1.5, 2, 15 / 16, 17 / 16))


def dead_zone(case, u, v, angle):
    """A channel is constant around its middle."""
    draw, s = case.draw, case.sensor
    width, which = log_uniform(draw, 0.005, 0.25), draw.choice(("U", "V", "both"))
    if which != "V":
        u = np.where(np.abs(u - s.b1) < width * s.a1, s.b1, u)
    if which != "U":
        v = np.where(np.abs(v - s.b2) < width * s.a2, s.b2, v)
    return u, v


def bent(case, u, v, angle):
    """Channels with a cubic or saturating characteristic, one or both."""
    draw, s = case.draw, case.sensor
    size, shape, which = (
        log_uniform(draw, 0.01, 0.33),
        draw.choice(("cubic", "tanh", "rail")),
        draw.choice(("U", "V", "both", "both")),
    )

    def curve(x):
        if shape == "cubic":
            return x - size * x**3
        if shape == "tanh":
            return np.tanh(3 * size * x) / (3 * size)
        return np.clip(x, -1, 1.05 - size)

    if which != "V":
        u = s.b1 + s.a1 * curve((u - s.b1) / s.a1)
    if which != "U":
        v = s.b2 + s.a2 * curve((v - s.b2) / s.a2)
    return u, v


def harmonic(case, u, v, angle):
    """One harmonic of order 2 to 8 of 1 to 8 %, of any phase, in one channel or both, or along the circle."""
    draw, s = case.draw, case.sensor
    order, size, phase = draw.choice((2, 3, 3, 3, 4, 5, 7, 8)), log_uniform(draw, 0.01, 0.08), draw.uniform(0, 1)
    wave = TURN * (order * angle + phase)
    how = draw.choice(("U", "both", "along", "radius"))
    theta = TURN * angle
    if how == "U":
        return u + size * s.a1 * np.sin(wave), v
    if how == "both":
        return u + size * s.a1 * np.sin(wave), v + size * s.a2 * np.cos(wave + TURN * draw.uniform(0, 1))
    if how == "along":
        return u + size * s.a1 * np.cos(theta) * np.sin(wave), v - size * s.a2 * np.sin(theta + s.beta) * np.sin(wave)
    return u + size * s.a1 * np.sin(theta) * np.sin(wave), v + size * s.a2 * np.cos(theta + s.beta) * np.sin(wave)


def telegraph(case, u, v, angle):
    """Offsets jump between two values at random times."""
    draw = case.draw
    flips = case.arrays.random_sample(case.n) < 1 / (case.plan.turn * log_uniform(draw, 0.003, 3))
    state = np.cumsum(flips) % 2 * log_uniform(draw, 0.003, 0.3)
    return (
        (u + state * case.sensor.a1, v)
        if draw.random() < 0.6
        else (u + state * case.sensor.a1, v - state * case.sensor.a2)
    )


def shaped_noise(case, gain):
    """Normal noise of deviation 1 with this gain over frequency (cycles a sample)."""
    spectrum = np.fft.rfft(case.arrays.normal(0, 1, case.n)) * gain(np.fft.rfftfreq(case.n))
    noise = np.fft.irfft(spectrum, case.n)
    return noise / np.std(noise)


def coloured(gain_of):
    """Noise that is not white."""

    def change(case, u, v, angle):
        draw, s = case.draw, case.sensor
        gain, size = gain_of(draw), log_uniform(draw, 3e-4, 0.1)
        return u + size * s.a1 * shaped_noise(case, gain), v + size * s.a2 * shaped_noise(case, gain)

    return change


def autoregressive(draw):
    keeps = draw.choice((0.5, 0.9, 0.9, 0.99, 0.999))
    return lambda f: 1 / np.abs(1 - keeps * np.exp(-2j * np.pi * f))


def flicker(draw):
    power = draw.choice((0.5, 0.5, 1))
    return lambda f: np.where(f > 0, np.maximum(f, 1e-9) ** -power, 0)


def stuck_bit(case, u, v, angle):
    """A bit of channel U is always 1."""
    bit = case.draw.randint(1, 8)
    return (((u + 1) * 2**22).astype(int) | 2 ** (22 - bit)) / 2**22 - 1, v


def bit_errors(case, u, v, angle):
    """Single bits of single samples are wrong."""
    draw = case.draw
    hit = case.arrays.random_sample(case.n) < log_uniform(draw, 2e-4, 0.2)
    words = np.clip(((np.stack([u, v]) + 1) * 2**15).astype(int), 0, 2**16 - 1)
    flipped = (words ^ 2 ** case.arrays.randint(3, 16, (2, case.n))) / 2**15 - 1
    return np.where(hit, flipped[0], u), np.where(hit & (draw.random() < 0.5), flipped[1], v)


def missing_codes(case, u, v, angle):
    """A converter of 8 to 12 bits, some of whose codes never come."""
    draw = case.draw
    codes = 2 ** draw.randint(8, 12)
    missing = case.arrays.random_sample(codes + 1) < log_uniform(draw, 0.01, 0.6)

    def converted(x):
        code = np.clip(np.floor((x + 1) * codes / 2), 0, codes - 1).astype(int)
        return (np.maximum(code - missing[code], 0) + 0.5) * 2 / codes - 1

    return converted(u), converted(v)


def tiny(case, u, v, angle):
    """Signals that are hardly larger than the noise."""
    gain = log_uniform(case.draw, 2e-4, 5e-3) / case.sensor.a1
    return u * gain + case.arrays.normal(0, 1e-4, case.n), v * gain + case.arrays.normal(0, 1e-4, case.n)


def clipped(case, u, v, angle):
    """Channel U is larger than the converter."""
    return u * case.draw.uniform(1.02, 3) / (case.sensor.a1 + abs(case.sensor.b1)), v


def wrapped(case, u, v, angle):
    """A converter that wraps around instead of clipping."""
    gain = log_uniform(case.draw, 1.003, 1.5) / (case.sensor.a1 + abs(case.sensor.b1))
    return (u * gain + 1) % 2 - 1, v


def huge_offset(case, u, v, angle):
    """The offset of channel U moves the signal out of the converter."""
    shift = sign(case.draw) * case.draw.uniform(1.0, 1.5) - case.sensor.b1
    return u + shift * (1 - 0.2 * case.sensor.a1), v


def channel_gone(holds):
    """A channel that keeps its value from some sample on (holds), or is lost."""

    def change(case, u, v, angle):
        first, end = case.stretch()
        gone = case.inside((first, end if case.draw.random() < 0.3 else case.n))
        return np.where(gone, u[first] if holds else case.arrays.normal(0, 1e-4, case.n), u), v

    return change


SIGNALS = {
    "both channels 0": lambda case, u, v, angle: (0 * u, 0 * v),
    "noise only 1e-4": noise_only(1e-4),
    "noise only 0.05": noise_only(0.05),
    "U constant": constant(0, 0.1),
    "V constant": constant(1, 0.1),
    "V = U": lambda case, u, v, angle: (u, u),
    "V = -U": lambda case, u, v, angle: (u, -u),
    "tiny in noise": tiny,
    "clipped": clipped,
    "wrapped": wrapped,
    "spikes": spikes,
    "garbage": garbage,
    "dropouts": dropouts,
    "channel lost": channel_gone(False),
    "channel held": channel_gone(True),
    "interference": mains,
    "huge offset": huge_offset,
    "gain step": gain_step,
    "air gap": air_gap,
    "offset step": offset_step,
    "offset drift": offset_drift,
    "late drift": late_drift,
    "modulated": modulated,
    "modulated 1 a turn": modulated_by_turn(1),
    "modulated 2 a turn": modulated_by_turn(2),
    "slow beat": neighbour(slow_ratio, 0.2),
    "neighbour track": neighbour(pole_ratio, 0.2),
    "dead zone": dead_zone,
    "bent": bent,
    "harmonic": harmonic,
    "telegraph": telegraph,
    "noise AR(1)": coloured(autoregressive),
    "noise 1/f": coloured(flicker),
    "stuck bit": stuck_bit,
    "bit errors": bit_errors,
    "missing codes": missing_codes,
}
