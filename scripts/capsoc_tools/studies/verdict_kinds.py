"""The kinds of random sensors that `verdicts` knows, good and broken. Each draws its sizes, times and places from its
case.
"""

import math

from capsoc_tools.studies.verdict_motions import MOTIONS, ORDERS, changing_speed, reversing, steady, with_rests
from capsoc_tools.studies.verdict_sensors import TURN, Case, sign
from capsoc_tools.studies.verdict_signals import SIGNALS


# --- sensors that count their angle otherwise: (u, v, angle) of a case


def swapped(case):
    """U is the cosine and V the sine: it turns the other way round."""
    angle = case.steady()
    u, v = case.sensor.signals(angle, case.arrays)
    return v, u, 0.25 - angle - case.sensor.beta / TURN


def inverted(case):
    """V has the other sign: it turns the other way round."""
    angle = case.steady()
    u, v = case.sensor.signals(angle, case.arrays)
    return u, 2 * case.sensor.b2 - v, 0.5 - angle


def beyond_quarter(case):
    """beta lies beyond a quarter turn: the same samples as of a sensor that turns the other way round."""
    case.sensor.beta = sign(case.draw) * case.draw.uniform(math.pi - 1.2, math.pi)
    angle = case.steady()
    return (*case.sensor.signals(angle, case.arrays), angle if case.program == "calibrate" else 0.5 - angle)


LEGAL = {
    "swapped": swapped,
    "V inverted": inverted,
    "beta beyond": beyond_quarter,
}


# Motion, style of use and programs of the kinds of good sensors, as docs/explanation/verdicts.md and the programs
# require.
GOOD = {
    "good": (steady, None, None),
    "good: long": (steady, "long", None),
    "good: slow": (steady, "slow", ("selfcal", "calibrate", "quick", "quick_known", "recursive", "follow")),
    "good: fast": (steady, "fast", ("selfcal", "track", "calibrate", "quick", "recursive", "follow")),
    "good: speed changes": (changing_speed, "changing", ("calibrate", "quick", "follow")),
    "good: rests": (with_rests, "resting", ("follow",)),
    "good: turns back": (reversing, "back and forth", ("follow",)),
}
# What a pass may take for granted, by how its condition begins: a kind of these is then outside what the pass is about.
CONDITIONS = {
    "no sample is stale": {*ORDERS},
    "every sample is the sensor's": {"garbage"},
    "no second signal turns at almost its speed": {"slow beat"},
    "harmonics along the circle": {"harmonic", "bent", "dead zone", "modulated 1 a turn", "modulated 2 a turn"},
}
BROKEN = [*MOTIONS, *ORDERS, *SIGNALS, *LEGAL, "two at once"]


def two_at_once(case):
    """Two of the kinds above together, each of another group."""

    def one_of(group, kinds):
        if group not in groups:
            return None
        case.broken_by.append(case.draw.choice(sorted(kinds)))
        return kinds[case.broken_by[-1]]

    groups = case.draw.sample(("motion", "order", "signal"), 2)
    return put_together(case, one_of("motion", MOTIONS) or steady, one_of("signal", SIGNALS), one_of("order", ORDERS))


def put_together(case, motion, signal, order):
    """Channels and angle of a motion, a change of the signals and an order of the samples; none: nothing wrong with
    it.
    """
    angle = motion(case)
    u, v = case.sensor.signals(angle, case.arrays)
    if signal is not None:
        u, v = signal(case, u, v, angle)
    if order is not None:
        source = order(case)
        which = case.draw.choice(("both", "both", "both", "U", "V"))
        u = u[source] if which != "V" else u
        v = v[source] if which != "U" else v
    return u, v, angle


def make_case(seed, kind, number, program):
    """A case with its channels and the true angle in turns: (case, u, v, angle)."""
    motion, style, _ = GOOD.get(kind) or (MOTIONS.get(kind, steady), None, None)
    case = Case(seed, kind, number, program, style)
    if kind in LEGAL:
        return (case, *LEGAL[kind](case))
    if kind == "two at once":
        return (case, *two_at_once(case))
    return (case, *put_together(case, motion, SIGNALS.get(kind), ORDERS.get(kind)))
