"""docs/reference/coprocessor.md, "Sequencer: time", "LOAD" and "Commit": the whole coprocessor, edge by edge.

A third reading of that page, next to the C++ model and the SystemVerilog, with which it shares nothing. It is written
to be compared with the page, in exact integers, and not to be fast.
"""

from types import SimpleNamespace

import registers as names
from calibrator import calibrate
from harmonic_correction import HarmonicCorrection
from lms_demodulator import demodulate
from notation import TURN_32, Arithmetic, clamp, rounded, signed
from polar_unit import find_parameters, find_relative, found_angle
from reference_generator import refer, rotate
from registers import NAMES, Registers

SETTINGS = (
    "demod",
    "calib",
    "source",
    "lock_threshold",
    "diverge_threshold",
    "radius_limit",
    "alarm_limit",
    "turns",
    "count",
    "turn_limit",
    "safety",
    "step_limit",
)


class Sample:
    """What travels through the pipeline; the stages add to it."""

    def __init__(self, u, v, clip):
        self.u, self.v, self.clip = u, v, clip
        self.sat = False
        # A register did not fit its parity bit as one of its ticks began; SAFETY did not.
        self.bad_parity = self.bad_safety = False

    def saturated(self, value, bits=32):
        """sat(value)"""
        result = clamp(value, bits)
        if result != value:
            self.sat = True
        return result


class Coprocessor:
    """Time is an edge number that never decreases; what happens at one edge comes in the page's order."""

    def __init__(self, arithmetic: Arithmetic):
        self.arithmetic = arithmetic
        self.correction = HarmonicCorrection()
        self.reset()

    def reset(self):
        """The pin, or SRST: at the present edge."""
        self.registers = Registers(self.arithmetic)
        self.stages = [None] * 5  # samples in T0 to T4
        self.held = None
        self.load_waits = False
        self.load_stage = None  # 0, 1, 2
        self.load_words = None
        self.boundary = None  # the edge at which the next tick begins; none while idle

    @property
    def busy(self):
        return self.boundary is not None

    def interrupt(self):
        return self.registers.interrupt()

    # Time

    def advance(self, edge):
        """Ends and starts of ticks up to and with `edge`. Yields each edge at which there were any."""
        while self.boundary is not None and self.boundary <= edge:
            at = self.boundary
            unfit = set(self.registers.unfit)
            self.end_tick()
            self.start_tick()
            for sample in self.stages:
                if sample is not None:
                    sample.bad_parity |= bool(unfit)
                    sample.bad_safety |= "SAFETY" in unfit
                    sample.bad_parity |= self.marks_weights()
            yield at

    def marks_weights(self):
        """Whether T3's update has wrong parity bits, which is a finding of all samples of its tick."""
        learner = self.stages[3]
        updates = learner is not None and learner.next_weights is not None
        return updates and bool(self.registers.safety & 1 << 8)

    def end_tick(self):
        if self.load_stage is not None:
            self.end_load_stage()
        # T4 first: nothing that a stage writes is another's in the same tick.
        for stage in (4, 3, 2):
            if self.stages[stage] is not None:
                (self.end_t2, self.end_t3, self.commit)[stage - 2](self.stages[stage])

    def start_tick(self):
        self.stages = [None, *self.stages[:4]]
        if self.load_stage is not None:
            self.load_stage = self.load_stage + 1 if self.load_stage < 2 else None
        empty = all(sample is None for sample in self.stages)
        if self.load_stage is None and self.load_waits and empty:
            self.load_stage, self.load_waits = 0, False
        if self.load_stage is not None:
            self.start_load_stage()
        elif self.held is not None and not self.load_waits:
            self.stages[0], self.held = self.held, None
        running = self.load_stage is not None or any(sample is not None for sample in self.stages)
        self.boundary = self.boundary + self.arithmetic.tick if running else None
        starts = (self.start_t0, self.start_t1, self.start_t2, self.start_t3, self.start_t4)
        for start, sample in zip(starts, self.stages):
            if sample is not None:
                start(sample)

    # The stages: what they read is that of their tick's first edge.

    def start_t0(self, sample):
        calibrate(self.arithmetic, sample, self.registers)

    def start_t1(self, sample):
        find_relative(self.arithmetic, sample)
        if self.registers.correct:
            sample.relative, unfit = self.correction.correct(sample.relative, self.registers.phi)
            sample.bad_parity |= unfit

    def start_t2(self, sample):
        refer(self.arithmetic, sample, self.registers)

    def end_t2(self, sample):
        self.registers.phase = sample.next_phase
        self.registers.unfit.discard("PHASE")
        if sample.next_freq is not None:
            self.registers.freq = sample.next_freq
            self.registers.unfit.discard("FREQ")

    def start_t3(self, sample):
        blocks = self.registers.blocks
        sample.bad_parity |= self.registers.block and blocks.begun and blocks.unfit
        sample.wrong_parity = bool(self.registers.safety & 1 << 8)
        demodulate(self.arithmetic, sample, self.registers)
        largest = 1 << 31 - self.registers.error_limit
        sample.misfit = any(not -largest <= error < largest for error in sample.errors)

    def end_t3(self, sample):
        self.registers.error_sums = sample.next_sums
        if sample.next_weights is not None:
            self.registers.weights = sample.next_weights
            self.registers.unfit.difference_update(names.WEIGHTS)
        if sample.next_sums_of_block is not None:
            self.registers.blocks.sums = sample.next_sums_of_block
            self.registers.blocks.unfit = sample.wrong_parity

    def start_t4(self, sample):
        r = self.registers
        sample.settings = SimpleNamespace(**{name: getattr(r, name) for name in SETTINGS})
        sample.parameters = find_parameters(self.arithmetic, sample, r)
        sample.angle = found_angle(self.arithmetic, sample, sample.parameters)
        sample.average = max(rounded(s, 6) for s in r.error_sums)

    def commit(self, sample):
        """The end of T4."""
        r, settings = self.registers, sample.settings
        pending = bool(r.flags & names.RESULT)
        turn_ended = r.judge.take(sample, settings)
        r.blocks.ended = turn_ended
        r.since_reset += 1
        settled_in = r.since_reset >= 64
        lock = settled_in and sample.average < settings.lock_threshold and r.judge.permits_lock(settings.turns)
        r.diverged = settled_in and sample.average > settings.diverge_threshold
        largest = 1 << 29 - settings.step_limit
        jump = not -largest <= r.judge.step < largest
        for holds, flag in (
            (settings.safety & 1 and sample.bad_parity or sample.bad_safety, names.PARITY),
            (settings.safety & 2 and sample.misfit, names.MISFIT),
            (settings.safety & 4 and jump, names.JUMP),
            (settings.safety & 8 and pending, names.MISSED),
            (True, names.RESULT),
            (sample.clip, names.CLIP),
            (sample.sat, names.SAT),
            (sample.zero, names.ZERO),
            (sample.unsettled, names.UNSETTLED),
            (r.diverged, names.DIVERGED),
            (r.judge.alarm, names.ALARM),
            (lock != r.lock, names.LOCKCHG),
            (sample.mirror != r.mirror, names.MIRRORCHG),
            (turn_ended, names.TURN),
        ):
            if holds:
                r.flags |= flag
        r.lock, r.mirror = lock, sample.mirror
        if settings.demod:
            p = sample.parameters
            r.a1, r.a2, r.b1, r.b2, r.beta, r.phi = p.a1, p.a2, p.b1, p.b2, p.beta, p.phi
            r.unfit.difference_update(names.PARAMETERS)
        distrusted = any(r.flags & flag for flag in names.SAFETY_FLAGS)
        r.valid = settings.calib and not sample.zero and not sample.unsettled and not distrusted
        if r.valid:
            r.angle = sample.angle
        r.raw_u, r.raw_v, r.cal_s, r.cal_c = sample.u, sample.v, sample.cal_s, sample.cal_c
        r.err_u, r.err_v = sample.errors
        r.residue, r.ref_phase, r.amplitude = sample.residue, sample.ref_phase, sample.amplitude
        r.error_average = sample.average
        r.samples = (r.samples + 1) % TURN_32

    # LOAD, Eq (8)

    def start_load_stage(self):
        r = self.registers
        if self.load_stage == 0:
            self.rotation = self.rotate(r.phi)
            return
        sine, cosine = self.rotation
        if self.load_stage == 1:
            self.load_words = (r.a1 * cosine, r.a1 * sine, r.b1)
            self.rotation = self.rotate((r.phi + r.beta) % TURN_32)
        else:
            self.load_words = (r.a2 * -sine, r.a2 * cosine, r.b2)

    def rotate(self, angle):
        return rotate(self.arithmetic, angle << 16)

    def end_load_stage(self):
        if self.load_stage == 0:
            return
        a, b, c = self.load_words
        weights = [rounded(a, 16), rounded(b, 16), c << 15]
        if self.arithmetic.paper:
            weights = [rounded(w, 15) for w in weights]
        first = 3 * (self.load_stage - 1)
        self.registers.weights[first : first + 3] = weights
        self.registers.unfit.difference_update(names.WEIGHTS[first : first + 3])

    # Samples and accesses, after the ticks of their edge

    def wake(self, edge):
        if self.boundary is None:
            self.boundary = edge + 1

    def latch(self, edge, u, v, clip):
        if self.held is not None:
            self.registers.early_count = min(TURN_32 - 1, self.registers.early_count + 1)
            self.registers.flags |= names.EARLY
            return False
        self.held = Sample(signed(u), signed(v), clip)
        self.wake(edge)
        return True

    def submit(self, edge, u, v, clip):
        """A sample of the ADC stream. Returns whether it was latched."""
        return self.registers.adc and self.latch(edge, u, v, clip)

    def read(self, offset):
        """What a bus read shows; none: PSLVERR."""
        return self.registers.read(offset, self.busy) if offset in NAMES else None

    def peek(self, offset):
        """What a debugger's read shows."""
        return self.registers.value(offset, self.busy) if offset in NAMES else None

    def write(self, edge, offset, value):
        """Returns whether there is such a register."""
        if offset not in NAMES:
            return False
        name = NAMES[offset]
        if name == "CTRL" and value & names.SRST:
            self.reset()
            return True
        if name == "CORRECTION":
            self.write_correction(value)
            return True
        self.registers.write(offset, value)
        if name == "CMD" and value & names.LOAD:
            self.load_waits = True
            self.wake(edge)
        if name == "SOFT_V":
            self.latch(edge, self.registers.soft_u, value, False)
        return True

    def write_correction(self, value):
        """With BUSY as the write's edge leaves it."""
        if self.busy or self.arithmetic.paper:
            self.registers.flags |= names.CONFIG
        else:
            self.correction.write(value, self.registers.safety & 1 << 8)
