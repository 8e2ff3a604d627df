"""docs/reference/coprocessor.md, "Turn judge": the end of T4."""

from notation import TURN_32, signed
from reference_generator import NUMERIC

ONE_TURN = 1 << 30  # of travel

TIMEOUT, RADIUS, WINDING, MIRROR, NOANGLE, SAT, GOOD, RESIDUE = (1 << bit for bit in range(16, 24))


class TurnJudge:
    """The present window, and the record of the last one."""

    def __init__(self):
        self.angle_before = None
        self.glitches = 0
        self.alarm = False
        self.good_turns = 0
        self.turn_count = 0
        self.spoilt = False  # the window of the last sample, up to it
        # Registers
        self.radius_max = self.residue_max = self.winding = self.turn_samples = self.turn_det = self.turn_flags = 0
        self.open_window()

    def open_window(self):
        self.largest_deviation = self.largest_residue = self.travel = self.samples = 0
        self.octants = self.clipped = 0
        self.reasons = 0  # RADIUS, WINDING (wild), MIRROR, NOANGLE, SAT, RESIDUE of a sample

    def take(self, sample, settings):
        """One sample, with the settings that its T4 read. Returns whether a window ended."""
        det = abs(sample.det)
        deviation = abs(sample.amplitude - det)

        def reaches(limit):
            return limit != 0 and deviation >= det * limit >> 8

        self.follow_alarm(reaches(settings.alarm_limit) or sample.clip)
        self.add(sample, deviation, reaches(settings.radius_limit))
        self.spoilt = self.clipped != 0 or bool(self.reasons & (RADIUS | MIRROR | NOANGLE | SAT | RESIDUE))
        ends_anyway, ends = self.window_ends(sample, settings)
        if ends:
            self.conclude(sample, settings, time_out=not settings.count and not ends_anyway)
        if self.alarm:
            self.good_turns = 0
        return ends

    def permits_lock(self, turns):
        """After take: of the sample that it took."""
        return not self.alarm and self.good_turns >= turns and not (turns and self.spoilt)

    def follow_alarm(self, glitch):
        self.glitches = min(16, self.glitches + 1) if glitch else max(0, self.glitches - 1)
        if self.glitches == 16:
            self.alarm = True
        elif self.glitches == 0:
            self.alarm = False

    def add(self, sample, deviation, beyond):
        angle = sample.angle >> 2
        step = self.step = 0 if self.angle_before is None else signed(angle - self.angle_before, 30)
        self.angle_before = angle
        self.travel = signed(self.travel + step)
        self.samples = (self.samples + 1) % TURN_32
        self.largest_deviation = max(self.largest_deviation, deviation)
        self.largest_residue = max(self.largest_residue, abs(sample.residue))
        self.octants |= 1 << (sample.angle >> 29)
        self.clipped = min(255, self.clipped + sample.clip)
        wild = not -3 * ONE_TURN <= 2 * self.travel < 3 * ONE_TURN
        for reason, holds in (
            (RADIUS, beyond),
            (WINDING, wild),
            (MIRROR, sample.mirror),
            (NOANGLE, sample.zero or sample.unsettled),
            (SAT, sample.sat),
            (RESIDUE, abs(sample.residue) >= TURN_32 // 16),
        ):
            if holds:
                self.reasons |= reason

    def window_ends(self, sample, settings):
        """By its source (never with COUNT); by that or by its length."""
        if settings.count:
            by_source = False
        elif settings.source == NUMERIC:
            by_source = sample.turn
        else:
            by_source = self.travel >= ONE_TURN or self.travel < -ONE_TURN
        return by_source, by_source or settings.turn_limit != 0 and self.samples >= settings.turn_limit

    def conclude(self, sample, settings, time_out):
        flags = self.octants | self.clipped << 8 | self.reasons
        if time_out:
            flags |= TIMEOUT
        sixty_fourths = self.travel >> 24
        if not (61 <= sixty_fourths <= 66 or -67 <= sixty_fourths <= -62):
            flags |= WINDING
        good = (
            self.octants == 0xFF
            and self.clipped == 0
            and not flags & (TIMEOUT | RADIUS | MIRROR | NOANGLE | SAT | RESIDUE)
            and (not flags & WINDING or settings.count)
        )
        if good:
            flags |= GOOD
        self.good_turns = min(3, self.good_turns + 1) if good else 0
        self.turn_count = (self.turn_count + 1) % 256
        self.turn_flags = flags | self.turn_count << 24
        self.radius_max, self.residue_max = self.largest_deviation, self.largest_residue
        self.winding, self.turn_samples, self.turn_det = self.travel, self.samples, sample.det
        self.open_window()
