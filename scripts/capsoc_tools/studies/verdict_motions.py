"""How the shaft of a random sensor moves, and which sample comes when, a kind at a time, for `verdicts`.

MOTIONS are angles in turns: angle(case). ORDERS give samples of another time: the number of the sample that comes,
for each sample.
"""

import math

import numpy as np

from capsoc_tools.studies.verdict_sensors import SLOWEST, TURN, log_uniform, sign


def steady(case):
    """Nothing wrong with the motion."""
    return case.steady()


def at_rest(case):
    """The shaft never moves."""
    return np.full(case.n, case.sensor.phi)


def stops(case):
    """The shaft stops for good."""
    at = case.draw.uniform(0.1, 0.75) * case.n
    return case.sensor.angle(np.minimum(case.k, at) / case.plan.rate)


def starts(case):
    """The shaft starts late."""
    at = case.draw.uniform(0.15, 0.75) * case.n
    return case.sensor.angle(np.maximum(0, case.k - at) / case.plan.rate)


def walk(case):
    """The shaft walks at random."""
    return case.sensor.phi + np.cumsum(case.arrays.normal(0, log_uniform(case.draw, 3e-4, 0.03), case.n))


def other_speed(case):
    """The speed differs from the program's setting."""
    share = 1 + sign(case.draw) * log_uniform(case.draw, 1e-4, 0.3)
    return case.sensor.angle(case.seconds * share)


def other_rate(case):
    """The recording was sampled at another rate."""
    return case.sensor.angle(case.seconds * case.draw.choice((0.1, 0.5, 2, 5, 25)))


def swing(case):
    """The shaft swings and never turns."""
    size, hertz = case.draw.uniform(0.05, 0.6), case.plan.speed * log_uniform(case.draw, 0.2, 3)
    return case.sensor.phi + size * np.sin(TURN * hertz * case.seconds)


def back_and_forth(case):
    """The shaft turns round once."""
    at = case.draw.uniform(0.1, 0.95) * case.n
    return case.sensor.angle(np.where(case.k < at, case.k, 2 * at - case.k) / case.plan.rate)


def speed_points(case, points, least, most):
    """An angle whose speed is linear between `points` random points, as a share of the plan's speed."""
    times = np.sort(case.arrays.uniform(0, case.n, points))
    shares = case.arrays.uniform(least, most, points)
    return case.sensor.phi + np.cumsum(np.interp(case.k, times, shares)) * case.sensor.speed / case.plan.rate


def rests_and_swings(case):
    """The shaft rests, turns and swings by turns."""
    draw = case.draw
    pieces, speed, at = np.zeros(case.n), case.sensor.speed / case.plan.rate, 0
    while at < case.n:
        size = max(1, int(case.plan.turn * log_uniform(draw, 0.1, 5)))
        how = draw.choice(("rest", "turn", "turn", "back", "swing"))
        wave = np.sin(TURN * np.arange(size) / (case.plan.turn * draw.uniform(0.3, 2)))
        piece = {"rest": 0, "turn": speed, "back": -speed, "swing": speed * draw.uniform(0.3, 3) * wave}[how]
        pieces[at : at + size] = (piece * np.ones(size))[: case.n - at]
        at += size
    return case.sensor.phi + np.cumsum(pieces)


def speed_changes(case):
    """The speed jumps once, somewhere."""
    first, _ = case.stretch()
    share = log_uniform(case.draw, 0.3, 3)
    return case.sensor.angle(np.where(case.k < first, case.k, first + (case.k - first) * share) / case.plan.rate)


def speed_wanders(case):
    """The speed wanders slowly by up to a few ten percent."""
    spread = log_uniform(case.draw, 0.003, 0.5)
    return speed_points(case, case.draw.randint(5, 60), 1 - spread, 1 + spread)


def turn_ripple(case):
    """An unevenness of the motion that repeats with each turn, and may grow."""
    angle, draw = case.steady(), case.draw
    order, size, phase = draw.choice((1, 1, 2, 3, 4)), log_uniform(draw, 1e-4, 0.03), draw.uniform(0, 1)
    return angle + size * np.sin(TURN * (order * angle + phase))


def indexed(case):
    """The shaft moves in steps: it rests at a random number of positions of a turn."""
    positions = int(log_uniform(case.draw, 3, 2000))
    return (np.floor(case.steady() * positions) + case.draw.random()) / positions


def indexed_randomly(case):
    """A table of a few positions in random order, each held for a while."""
    positions, hold = int(log_uniform(case.draw, 3, 500)), max(1, int(log_uniform(case.draw, 1, 200)))
    visits = case.arrays.randint(0, positions, case.n // hold + 1)
    return np.repeat(visits, hold)[: case.n] / positions + case.sensor.phi


def rest_in_stretch(case):
    """The shaft rests for a while and then turns again, so it lags its reference."""
    first, end = case.stretch(0.02, 2)
    moved = np.where(case.k < first, case.k, np.where(case.k < end, first, case.k - (end - first)))
    return case.sensor.angle(moved / case.plan.rate)


# --- motions of good sensors


def changing_speed(case):
    """A shaft whose speed changes slowly: between SLOWEST of the speed and all of it, or by some percent."""
    spread = case.draw.choice((0.05, 0.2, 1 - SLOWEST))
    return speed_points(case, max(3, int(case.n / case.plan.turn / 4)), 1 - spread, 1)


def with_rests(case):
    """A shaft that rests now and then, for up to two turns, and turns in between."""
    moving = case.arrays.random_sample(int(case.n / case.plan.turn * 2) + 2) < 0.7
    moving[:8] = True
    return (
        case.sensor.phi
        + np.cumsum(moving[(case.k * 2 / case.plan.turn).astype(int)]) * case.sensor.speed / case.plan.rate
    )


def reversing(case):
    """A shaft that turns two and a half turns forth and one and a half back."""
    cycle = case.k / case.plan.turn % 4
    whole = np.floor(case.k / case.plan.turn / 4)
    return case.sensor.phi + math.copysign(1, case.sensor.speed) * (whole + np.where(cycle < 2.5, cycle, 5 - cycle))


# --- orders: sample k is that of another time


def stale(case):
    """Some samples, random ones or every N-th, are old ones; the age is fixed or random."""
    draw, turn = case.draw, case.plan.turn
    age = max(1, int(turn * log_uniform(draw, 2e-3, 0.7)))
    chosen = case.inside(case.stretch(0.1, 5))
    if draw.random() < 0.5:
        chosen &= case.k % draw.randint(2, 12) == 0
    else:
        chosen &= case.arrays.random_sample(case.n) < log_uniform(draw, 0.002, 0.9)
    ages = age if draw.random() < 0.6 else case.arrays.randint(1, age + 1, case.n)
    return np.maximum(0, np.where(chosen, case.k - ages, case.k))


def hold(k, first, size):
    """Samples of [first, first + size) are that of `first`."""
    return np.where((k >= first) & (k < first + size), first, k)


def held_once(case):
    """One hold: the samples stand still for a while, and then are right again."""
    first, end = case.stretch(0.002, 0.5)
    return hold(case.k, first, min(end - first, int(case.plan.turn * 0.7)))


def held_often(case):
    """Holds come again and again, a part of each period."""
    draw, stretch = case.draw, case.stretch(0.3, 8)
    period = max(4, int(case.plan.turn * log_uniform(draw, 0.01, 2)))
    size = max(2, int(period * log_uniform(draw, 0.02, 0.8)))
    phase = (case.k - stretch[0]) % period
    return np.where(case.inside(stretch) & (phase < size), case.k - phase, case.k)


def repeated(case):
    """Single samples are exactly the one before."""
    draw = case.draw
    chosen = case.inside(case.stretch(0.5, 8)) & (case.arrays.random_sample(case.n) < log_uniform(draw, 1e-3, 0.8))
    return np.maximum(0, case.k - chosen)


def lag(case):
    """All samples of a stretch are late by the same time."""
    delay = max(1, int(case.plan.turn * log_uniform(case.draw, 2e-3, 0.5)))
    return np.maximum(0, np.where(case.inside(case.stretch(0.02, 4)), case.k - delay, case.k))


def lag_grows(case):
    """Rows are doubled again and again, so the samples are later and later; or lost, so that they are earlier."""
    first, end = case.stretch(0.05, 6)
    rate = log_uniform(case.draw, 1e-4, 0.5)
    late = np.floor(np.clip(case.k - first, 0, end - first) * rate).astype(int)
    return np.clip(case.k - late * case.draw.choice((1, 1, -1)), 0, case.n - 1)


def swapped_pairs(case):
    """Neighbours, or neighbouring blocks, in the wrong order."""
    draw = case.draw
    size = max(1, int(case.plan.turn * log_uniform(draw, 1e-5, 0.3)))
    inside = (
        case.inside(case.stretch(0.1, 5))
        & (case.arrays.random_sample(case.n // (2 * size) + 1) < draw.uniform(0.05, 1))[case.k // (2 * size)]
    )
    other = np.where(case.k // size % 2 == 0, case.k + size, case.k - size)
    return np.where(inside & (other < case.n), other, case.k)


def reversed_blocks(case):
    """Blocks of samples run backwards."""
    size = max(2, int(case.plan.turn * log_uniform(case.draw, 1e-3, 0.7)))
    other = case.k // size * size + size - 1 - case.k % size
    return np.where(case.inside(case.stretch(0.1, 5)) & (other < case.n), other, case.k)


def old_turn_again(case):
    """A stretch repeats the samples before it exactly: a buffer that is sent twice."""
    first, end = case.stretch(0.02, 2)
    size = min(end - first, first)
    inside = (case.k >= first) & (case.k < first + size)
    return np.where(inside, case.k - size, case.k)


def shuffled_stretch(case):
    """The samples of short blocks come in random order."""
    size = max(2, int(case.plan.turn * log_uniform(case.draw, 1e-3, 0.5)))
    keys = case.k // size + case.arrays.random_sample(case.n) * 0.999
    return np.where(case.inside(case.stretch(0.1, 5)), np.argsort(keys, kind="stable"), case.k)


MOTIONS = {
    "at rest": at_rest,
    "stops": stops,
    "starts late": starts,
    "other speed": other_speed,
    "other rate": other_rate,
    "swings": swing,
    "random walk": walk,
    "turns back": back_and_forth,
    "rests and swings": rests_and_swings,
    "speed changes": speed_changes,
    "speed wanders": speed_wanders,
    "ripple of the turn": turn_ripple,
    "indexed": indexed,
    "indexed at random": indexed_randomly,
    "rests for a while": rest_in_stretch,
}
ORDERS = {
    "stale": stale,
    "held once": held_once,
    "held often": held_often,
    "repeated": repeated,
    "late": lag,
    "later and later": lag_grows,
    "swapped order": swapped_pairs,
    "reversed blocks": reversed_blocks,
    "sent twice": old_turn_again,
    "shuffled": shuffled_stretch,
}
