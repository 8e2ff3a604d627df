"""Random sensors and the recordings that `verdicts` gives to the self-calibration programs.

A case is "SEED KIND NUMBER PROGRAM"; the same case gives the same samples. Angles are in turns, signals in full scale
of the converter, times in samples.
"""

import dataclasses
import hashlib
import math
import random

import numpy as np

RATE, SPEED = 250, 0.05
# Programs that depend on a steady speed, and the degrees within which a good shaft stays of a steady turn. A numeric
# reference cannot distinguish the shaft's unevenness from the sensor's error. The limit is lower where the unevenness
# becomes a part of what is learnt.
STEADY_DEG = {"selfcal": 3, "track": 3, "quick_known": 3, "paper": 3, "recursive": 3, "harmonics": 1}
# Degrees of angle error, by noise and harmonics, up to which a sensor counts as good. With an error of 6 degrees a
# bound of 30 says nothing.
CLEAN_DEG = 5
TURN = 2 * np.pi


def log_uniform(draw, least, most):
    return math.exp(draw.uniform(math.log(least), math.log(most)))


def sign(draw):
    return draw.choice((-1, 1))


def arrays_from(text):
    """Random arrays of a text. RandomState and not Generator: NumPy keeps its numbers from version to version."""
    return np.random.RandomState(np.frombuffer(hashlib.sha256(text.encode()).digest(), dtype="<u4"))


class Sensor:
    """A random sensor; `signals(angle, arrays)` are its channels at these angles."""

    def __init__(self, draw, speed=SPEED):
        self.a1 = log_uniform(draw, 0.02, 0.95)
        self.a2 = min(0.95, max(0.02, self.a1 * log_uniform(draw, 0.5, 2)))
        self.b1 = draw.uniform(-1, 1) * min(0.5, 0.97 - self.a1)
        self.b2 = draw.uniform(-1, 1) * min(0.5, 0.97 - self.a2)
        self.beta, self.phi = draw.uniform(-1.2, 1.2), draw.uniform(0, 1)
        self.noise = draw.choice((0, log_uniform(draw, 1e-6, 1e-2))) * min(self.a1, self.a2)
        self.bits = draw.randint(12, 24)
        self.harmonics = []
        if draw.random() < 0.7:
            shares = [draw.random() for _ in range(8)]
            total = draw.uniform(0, 0.02)
            self.harmonics = [
                (i % 2, 2 + i // 2, total * s / sum(shares), draw.uniform(0, 2 * math.pi)) for i, s in enumerate(shares)
            ]
        self.ripple = (log_uniform(draw, 1e-4, 0.02), draw.uniform(0.005, 0.2))
        if draw.random() < 0.5:
            self.ripple = (0, 0.01)
        self.speed = draw.choice((1, -1)) * speed
        room = 1 - 1e-4 - 5 * self.noise
        for amplitude, offset in ((self.a1, "b1"), (self.a2, "b2")):
            reach = amplitude * 1.02
            setattr(self, offset, max(-(room - reach), min(room - reach, getattr(self, offset))))

    @property
    def least(self):
        return min(self.a1, self.a2)

    def parameters(self):
        return {name: getattr(self, name) for name in ("a1", "a2", "b1", "b2", "beta")}

    def ripple_deg(self):
        """The largest error of the angle that the unevenness of the motion makes."""
        depth, frequency = self.ripple
        return 360 * abs(self.speed) * depth / (2 * math.pi * frequency)

    def steady_within(self, most):
        """Limits the unevenness of the motion to `most` degrees."""
        depth, frequency = self.ripple
        if self.ripple_deg() > most:
            self.ripple = (depth * most / self.ripple_deg(), frequency)

    def residual_deg(self):
        """What no calibration takes off the angle, about: four times the noise, half a step of the converter and the
        harmonics, of both channels, times what beta makes of them.
        """
        shares = [(4 * self.noise + 2**-self.bits) / a for a in (self.a1, self.a2)]
        for channel, _, amplitude, _ in self.harmonics:
            shares[channel] += amplitude
        return math.degrees(math.hypot(*shares) / math.cos(self.beta))

    def clean_within(self, most):
        """Limits noise and harmonics to an angle error of `most` degrees; the converter's steps may exceed that."""
        share = min(1.0, most / self.residual_deg())
        self.noise *= share
        self.harmonics = [(channel, order, share * size, phase) for channel, order, size, phase in self.harmonics]

    def angle(self, seconds):
        """At a steady speed with its ripple."""
        depth, frequency = self.ripple
        wave = depth / (2 * math.pi * frequency) * (1 - np.cos(TURN * frequency * seconds)) if depth else 0
        return self.phi + self.speed * (seconds + wave)

    def signals(self, angle, arrays):
        theta = TURN * angle
        u, v = np.sin(theta), np.cos(theta + self.beta)
        for channel, order, amplitude, phase in self.harmonics:
            (u, v)[channel][:] += amplitude * np.sin(order * theta + phase)
        u, v = self.a1 * u + self.b1, self.a2 * v + self.b2
        if self.noise:
            u, v = u + arrays.normal(0, self.noise, len(u)), v + arrays.normal(0, self.noise, len(v))
        return u, v


@dataclasses.dataclass
class Plan:
    """How a program runs: its settings, the recording that it needs, and the samples that a pass is about (nearly)."""

    elf: str
    settings: list
    length: int
    judged: tuple
    speed: float = SPEED
    rate: int = RATE
    claimed: str = "calibration"  # whose angles the bound is of: calibration, the last two turns, or all since the lock
    phases: dict = dataclasses.field(default_factory=dict)

    @property
    def turn(self):
        return self.rate / self.speed


def options(**values):
    return [text for name, value in values.items() for text in ("-P", f"{name}={value!r}")]


def in_mode(elf, settings, demodulation, calibration, speed, margin):
    """A plan of a program that demodulates and then calibrates."""
    end = demodulation + calibration
    return Plan(
        elf,
        settings,
        end + margin,
        (demodulation, end),
        speed,
        phases={"demodulation": (0, demodulation), "calibration": (demodulation, end)},
    )


# How a program is used, and the speeds in turns a second of each but "usual", which is the program's own.
STYLES = {"usual": None, "other": (0.04, 0.6), "long": (0.1, 1), "slow": (0.008, 0.03), "fast": (1, 9)}
STYLES["back and forth"] = STYLES["changing"] = STYLES["resting"] = STYLES["other"]
# A shaft of changing speed turns at least at this share of the plan's speed (verdict_motions.changing_speed).
SLOWEST = 0.4


def speed_for(draw, style, least=0.0, most=math.inf):
    """Written as the programs read it, so both know the same number."""
    if style == "usual":
        return SPEED
    slowest, fastest = STYLES[style]
    return round(log_uniform(draw, max(least, slowest), min(most, fastest)), 4)


def odd_turns(draw, turn, least, most, longest=10**6):
    """A number of samples that is no whole number of turns."""
    return int(min(longest, turn * draw.uniform(least, most))) | 1


def calibration_of(draw, style, turn):
    """Samples of calibration: the usual, or one to twelve turns, or some hundred."""
    if style == "usual":
        return 5_000
    return odd_turns(draw, turn, 50, 300, 300_000) if style == "long" else odd_turns(draw, turn, 1.05, 12, 60_000)


def plan_numeric(elf, **extra):
    def plan(draw, style):
        speed = speed_for(draw, style)
        turn, usual = RATE / speed, style == "usual"
        # The steps of paper are meant for 0.05 Hz.
        least = 30_001 if elf == "paper" else 0
        demodulation = 100_000 if usual else max(least, odd_turns(draw, turn, 20, 26))
        calibration = calibration_of(draw, style, turn)
        settings = (
            []
            if usual
            else options(
                frequency_hz=speed, demodulation_samples=demodulation, calibration_samples=calibration, **extra
            )
        )
        return in_mode(elf, settings, demodulation, calibration, speed, 100)

    return plan


def plan_recursive(draw, style):
    """Its least squares take long on the processor: it turns faster and stops sooner than the other programs."""
    speed = 0.25 if style == "usual" else speed_for(draw, style, 0.25 if style == "other" else 0)
    turn = RATE / speed
    demodulation = 20_000 if style == "usual" else odd_turns(draw, turn, 18, 24)
    calibration = 1_000 if style == "usual" else odd_turns(draw, turn, 1.05, 8)
    settings = options(
        frequency_hz=speed,
        forgetting=round(0.5 / turn, 6),
        demodulation_samples=demodulation,
        calibration_samples=calibration,
    )
    return in_mode("recursive", settings, demodulation, calibration, speed, 100)


def plan_blocks(elf, turns, known):
    """quick and harmonics: they calibrate after `turns` turns."""

    def plan(draw, style):
        speed = speed_for(draw, style)
        turn = RATE / speed
        calibration = calibration_of(draw, style, turn)
        settings = options(frequency_hz=speed) if known else []
        settings += [] if style == "usual" else options(calibration_samples=calibration)
        settings += options(measuring_seconds=400) if style == "slow" and not known else []
        begin = int(turn * turns)
        return Plan(
            elf, settings, begin + calibration + int(2.6 * turn), (begin - int(turn), begin + calibration), speed
        )

    return plan


def plan_track(draw, style):
    speed = speed_for(draw, style, most=0.4 if style == "other" else math.inf)
    until = 400 if style == "usual" else draw.randint(260, 400)
    shown = until + (20 if style == "usual" else draw.randint(200, 1000) if style == "long" else draw.randint(5, 80))
    settings = [] if style == "usual" else options(tracking_until=until, angle_until=shown)
    end = shown * RATE
    return Plan(
        "track",
        settings,
        end + int(1.7 * RATE / speed),
        (until * RATE - int(2 * RATE / speed), end),
        speed,
        claimed="two turns",
        phases={"numeric": (25_000, 37_500), "tracking": (37_500, until * RATE), "angle": (until * RATE, end)},
    )


def plan_unordered(draw, style):
    usual = style == "usual"
    demodulation = 100_000 if usual else draw.randint(20_000, 100_000)
    calibration = 5_000 if usual else draw.randint(100_000, 300_000) if style == "long" else draw.randint(2_000, 40_000)
    window = 4_750 if usual else draw.randint(1_000, 10_000)
    settings = (
        []
        if usual
        else options(demodulation_samples=demodulation, calibration_samples=calibration, window_samples=window)
    )
    return in_mode("unordered", settings, 500 + demodulation, calibration, SPEED, window + 10)


def plan_calibrate(draw, style):
    if style == "usual":
        return Plan("calibrate", [], 5_100, (0, 5_000))
    speed = speed_for(draw, style)
    samples = calibration_of(draw, style, RATE / speed)
    if style == "changing":  # a pass needs a whole turn, at the slowest speed too
        samples = max(samples, int(1.05 / SLOWEST * RATE / speed))
    window = draw.choice((0, 0, odd_turns(draw, RATE / speed, 1.05, 3)))
    samples = max(samples, int(1.05 * window))  # a pass needs a whole one
    return Plan("calibrate", options(samples=samples, window_samples=window), samples + 100, (0, samples), speed)


def plan_follow(draw, style):
    rate = 250 if style in ("usual", "slow") else draw.choice((250, 500, 1000))
    any_speed = round(log_uniform(draw, 0.3, rate / 80), 4)
    any_of = ("other", "back and forth", "changing", "resting")
    speed = 1.0 if style == "usual" else any_speed if style in any_of else speed_for(draw, style)
    turns = {
        "usual": 120,
        "long": draw.randint(200, 500),
        "slow": draw.randint(12, 20),
        "back and forth": draw.randint(30, 120),  # in a third of them it turns back, and it needs six good ones
    }.get(style) or draw.randint(15, 120)
    # A lock needs about nine turns: the measured one, one that it begins in, and six good ones.
    seconds = min(math.ceil(turns / speed), (400_000 if style == "slow" else 300_000) // rate)
    settings = options(rate_hz=rate, seconds=seconds)
    settings += options(measuring_seconds=400, longest_turn_seconds=100) if style == "slow" else []
    if style == "other" and draw.random() < 0.3:
        settings += options(drift_per_s=draw.choice((0, 0.01)))
    # The bound has six times the drift since the last good turn: 10 degrees of ten turns' rest or of three slow turns.
    if style == "resting" and draw.random() < 0.3:
        settings += options(drift_per_s=draw.choice((0, round(0.003 * speed, 6))))
    if style == "slow":
        settings += options(drift_per_s=draw.choice((0, round(0.01 * speed, 6))))
    begin = int(2.2 * rate / speed)
    return Plan(
        "follow",
        settings,
        begin + seconds * rate,
        (begin + int(7 * rate / speed), begin + seconds * rate),
        speed,
        rate,
        claimed="since the lock",
    )


PLANS = {
    "selfcal": plan_numeric("selfcal", step=0),
    "track": plan_track,
    "unordered": plan_unordered,
    "calibrate": plan_calibrate,
    "quick": plan_blocks("quick", 8.4, False),
    "quick_known": plan_blocks("quick", 7.4, True),
    "harmonics": plan_blocks("harmonics", 27, False),
    "paper": plan_numeric("paper"),
    "recursive": plan_recursive,
    "follow": plan_follow,
}


class Case:
    """One case: the sensor, the plan of the program, and random numbers: `draw` for single ones, `arrays` for many."""

    def __init__(self, seed, kind, number, program, style=None):
        self.kind, self.number, self.program = kind, number, program
        self.broken_by = [kind]
        self.draw = random.Random(f"{seed} {kind} {number}")
        self.arrays = arrays_from(f"{seed} {kind} {number} {program}")
        planner = random.Random(f"{seed} {kind} {number} {program}")
        self.plan = PLANS[program](planner, style or planner.choice(("usual", "other")))
        self.sensor = Sensor(self.draw, self.plan.speed)
        if kind.startswith("good"):
            self.sensor.steady_within(STEADY_DEG.get(program, 360))
            self.sensor.clean_within(CLEAN_DEG)
        self.n, self.k = self.plan.length, np.arange(self.plan.length)
        self.seconds = self.k / self.plan.rate
        # Some broken sensors of unordered turn: their samples come in order.
        self.shuffled = program == "unordered" and (kind.startswith("good") or self.draw.random() < 0.8)

    def steady(self):
        """The angle without anything wrong with the motion."""
        return self.arrays.uniform(0, 1, self.n) if self.shuffled else self.sensor.angle(self.seconds)

    def stretch(self, shortest=0.02, longest=3.0):
        """First sample and end of a stretch, whose length is in turns, at places where a program may have ceased to
        judge.

        Anywhere; early in the judged time; its end, beyond the last whole turn; one of the program's phases; or all
        from one sample on.
        """
        draw, turn, (begin, end) = self.draw, self.plan.turn, self.plan.judged
        size = turn * log_uniform(draw, shortest, longest)
        how = draw.choice(("anywhere", "early", "unfinished turn", "phase", "from here on"))
        if how == "unfinished turn":
            first = end - turn * draw.uniform(0.02, 1.3)
            return self._clip(first, self.n if draw.random() < 0.7 else first + size)
        if how == "early":
            first = begin + draw.uniform(0, max(0.0, end - begin - 1.2 * turn))
        elif how == "phase" and self.plan.phases:
            low, high = draw.choice(list(self.plan.phases.values()))
            first = draw.uniform(low, high)
        elif how == "from here on":
            first = draw.uniform(0.1 * self.n, 0.97 * self.n)
            return self._clip(first, self.n)
        else:
            first = draw.uniform(0.2 * self.n, 0.98 * self.n)
        return self._clip(first, first + size)

    def _clip(self, first, end):
        first = min(self.n - 2, max(0, int(first)))
        return first, max(first + 1, min(self.n, int(end)))

    def inside(self, stretch):
        return (self.k >= stretch[0]) & (self.k < stretch[1])


# The digits of 0 .. 999 as ASCII.
DIGITS = np.array([[ord(c) for c in f"{i:03d}"] for i in range(1000)], dtype=np.uint8)


def fixed(values, decimals):
    """A table of ASCII: sign or 0, three digits, point and `decimals` (a multiple of 3) decimals."""
    scaled = np.rint(np.abs(values) * 10**decimals).astype(np.int64)
    text = np.empty((len(values), 5 + decimals), dtype=np.uint8)
    text[:, 0] = np.where(values < 0, ord("-"), ord("0"))
    text[:, 4] = ord(".")
    for at in range(5 + decimals - 3, 4, -3):
        scaled, part = np.divmod(scaled, 1000)
        text[:, at : at + 3] = DIGITS[part]
    text[:, 1:4] = DIGITS[scaled]
    return text


def write(path, u, v, angle):
    """A recording with the true angle. Values beyond +-1 are left for the converter to clip, up to +-1.05: far beyond
    is another unit.
    """
    columns = [fixed(np.clip(u, -1.05, 1.05), 9), fixed(np.clip(v, -1.05, 1.05), 9), fixed(angle % 1 * 360, 6)]
    comma = np.full((len(u), 1), ord(","), dtype=np.uint8)
    rows = np.hstack(
        [columns[0], comma, columns[1], comma, columns[2], np.full((len(u), 1), ord("\n"), dtype=np.uint8)]
    )
    with open(path, "wb") as file:
        file.write(b"u,v,angle_deg\n")
        file.write(rows.tobytes())
