"""docs/reference/coprocessor.md, "Registers": what software sees and writes."""

from operator import attrgetter

from block_learning import BlockLearning
from notation import ONE_31, TURN_32, TURN_48, Arithmetic, clamp, rounded, signed
from turn_judge import TurnJudge

NAMES = {
    0x000: "ID",
    0x004: "VERSION",
    0x008: "CTRL",
    0x00C: "STATUS",
    0x010: "FLAGS",
    0x014: "CMD",
    0x018: "FREQ_LO",
    0x01C: "FREQ_HI",
    0x020: "PHASE_LO",
    0x024: "PHASE_HI",
    0x028: "STEP_AU",
    0x02C: "STEP_BU",
    0x030: "STEP_CU",
    0x034: "STEP_AV",
    0x038: "STEP_BV",
    0x03C: "STEP_CV",
    0x040: "LOOP",
    0x044: "LOCK_THRESHOLD",
    0x048: "DIVERGE_THRESHOLD",
    0x04C: "ERROR_AVERAGE",
    0x050: "AU_LO",
    0x054: "AU_HI",
    0x058: "BU_LO",
    0x05C: "BU_HI",
    0x060: "CU_LO",
    0x064: "CU_HI",
    0x068: "AV_LO",
    0x06C: "AV_HI",
    0x070: "BV_LO",
    0x074: "BV_HI",
    0x078: "CV_LO",
    0x07C: "CV_HI",
    0x080: "A1",
    0x084: "A2",
    0x088: "B1",
    0x08C: "B2",
    0x090: "BETA",
    0x094: "PHI",
    0x098: "JUDGE",
    0x09C: "TURN_LIMIT",
    0x0A0: "SOFT_U",
    0x0A4: "SOFT_V",
    0x0A8: "CORRECTION",
    0x0AC: "SAFETY",
    0x0B0: "RAW_U",
    0x0B4: "RAW_V",
    0x0B8: "CAL_S",
    0x0BC: "CAL_C",
    0x0C0: "ANGLE",
    0x0C4: "ERR_U",
    0x0C8: "ERR_V",
    0x0CC: "RESIDUE",
    0x0D0: "SAMPLES",
    0x0D4: "EARLY_COUNT",
    0x0D8: "REF_PHASE",
    0x0DC: "AMPLITUDE",
    0x0E0: "LATENCY",
    0x0E4: "TURN_FLAGS",
    0x0EC: "RADIUS_MAX",
    0x0F0: "RESIDUE_MAX",
    0x0F4: "WINDING",
    0x0F8: "TURN_SAMPLES",
    0x0FC: "TURN_DET",
}
OFFSETS = {name: offset for offset, name in NAMES.items()}
STATUS, FREQ_LO, PHASE_LO, STEP_AU, AU_LO, CV_HI = (
    OFFSETS[name] for name in ("STATUS", "FREQ_LO", "PHASE_LO", "STEP_AU", "AU_LO", "CV_HI")
)
PAIRS = (FREQ_LO, PHASE_LO, *range(AU_LO, CV_HI, 8))

# FLAGS
(RESULT, CLIP, SAT, ZERO, EARLY, LOCKCHG, DIVERGED, MIRRORCHG, CONFIG, TURN, ALARM, UNSETTLED) = (
    1 << bit for bit in range(12)
)
PARITY, MISFIT, JUMP, MISSED = SAFETY_FLAGS = tuple(1 << bit for bit in range(12, 16))
FLAGS_ALL = (1 << 16) - 1
# CTRL
IE_RESULT, IE_LOCK, IE_ERROR, IE_TURN, IE_ALARM = (1 << bit for bit in range(8, 13))
SRST = 1 << 31
CTRL_BITS = 0x7FFF
BLOCK, GUARD, CORRECT, IE_SAFETY = 1 << 6, 1 << 7, 1 << 13, 1 << 14
INTERRUPTS = (
    (IE_RESULT, RESULT),
    (IE_LOCK, LOCKCHG),
    (IE_TURN, TURN),
    (IE_ALARM, ALARM),
    (IE_SAFETY, sum(SAFETY_FLAGS)),
    (IE_ERROR, CLIP | SAT | ZERO | EARLY | DIVERGED | CONFIG | UNSETTLED),
)
# CMD
LOAD, CLEAR, PHASE0 = 1, 2, 4


class Registers:
    """Everything that a reset sets, but the pipeline."""

    def __init__(self, arithmetic: Arithmetic):
        self.arithmetic = arithmetic
        self.ctrl = self.flags = 0
        self.freq = 0  # s48
        self.phase = 0  # u48
        self.steps = [1349307] * 6
        self.loop = 10 << 8 | 4
        self.lock_threshold, self.diverge_threshold = 1 << 21, 1 << 29
        # The arithmetic's own words: Q2.46, `paper` Q1.31. a_u, b_u, c_u, a_v, b_v, c_v.
        half = 1 << (30 if arithmetic.paper else 45)
        self.weights = [half, 0, 0, 0, half, 0]
        self.a1 = self.a2 = ONE_31 // 2
        self.b1 = self.b2 = self.beta = self.phi = 0
        self.judge_word = 51 | 51 << 8 | 1 << 16
        self.turn_limit = 0
        self.soft_u = 0
        self.safety = 0
        self.unfit = set()  # registers whose parity bit is wrong
        self.stages = dict.fromkeys(PAIRS, 0)
        self.latches = dict.fromkeys(PAIRS, 0)
        # Results
        self.raw_u = self.raw_v = self.cal_s = self.cal_c = self.angle = self.err_u = self.err_v = 0
        self.residue = self.samples = self.early_count = self.ref_phase = self.amplitude = self.error_average = 0
        self.lock = self.diverged = self.mirror = self.valid = False
        self.error_sums = [0, 0]
        self.since_reset = 0
        self.judge = TurnJudge()
        self.blocks = BlockLearning()

    # Fields

    demod = property(lambda self: bool(self.ctrl & 1))
    calib = property(lambda self: bool(self.ctrl & 2))
    source = property(lambda self: self.ctrl >> 2 & 3)
    adc = property(lambda self: bool(self.ctrl & 16))
    frozen = property(lambda self: bool(self.ctrl & 32 and self.flags & ALARM))
    block = property(lambda self: bool(self.ctrl & BLOCK))
    guard = property(lambda self: bool(self.ctrl & GUARD))
    correct = property(lambda self: bool(self.ctrl & CORRECT))
    latency = property(lambda self: 1 + 5 * self.arithmetic.tick)
    kp = property(lambda self: self.loop & 31)
    ki = property(lambda self: self.loop >> 8 & 31)
    radius_limit = property(lambda self: self.judge_word & 0xFF)
    alarm_limit = property(lambda self: self.judge_word >> 8 & 0xFF)
    turns = property(lambda self: self.judge_word >> 16 & 3)
    count = property(lambda self: bool(self.judge_word >> 18 & 1))
    slew = property(lambda self: self.judge_word >> 19 & 7)

    def finds(self, flag):
        """Whether the mechanism of a flag is on."""
        return bool(self.safety & flag >> 12)

    error_limit = property(lambda self: self.safety >> 16 & 31)
    step_limit = property(lambda self: min(29, self.safety >> 24 & 31))

    def interrupt(self):
        return any(self.ctrl & enable and self.flags & flags for enable, flags in INTERRUPTS)

    def status(self):
        """Without BUSY, which is the sequencer's."""
        return (
            self.lock << 1
            | self.diverged << 2
            | self.mirror << 3
            | self.valid << 4
            | self.judge.alarm << 5
            | self.frozen << 6
            | self.arithmetic.paper << 8
            | self.judge.good_turns << 12
        )

    # Pairs

    def wide(self, low):
        """The 48-bit register at `low` as its HI and LO words."""
        if low == FREQ_LO:
            return self.freq >> 16, self.freq & 0xFFFF
        if low == PHASE_LO:
            return self.phase >> 16, self.phase & 0xFFFF
        weight = self.weights[(low - AU_LO) // 8]
        if self.arithmetic.paper:
            weight <<= 15
        high = clamp(rounded(weight, 15))
        return high, clamp(weight - (high << 15))

    def write_pair(self, low, high, low_word):
        if low == FREQ_LO:
            self.freq = signed(high << 16 | low_word & 0xFFFF, 48)
        elif low == PHASE_LO:
            self.phase = (high << 16 | low_word & 0xFFFF) % TURN_48
        else:
            weight = (signed(high) << 15) + signed(low_word)
            self.weights[(low - AU_LO) // 8] = clamp(rounded(weight, 15)) if self.arithmetic.paper else weight

    # Accesses

    def value(self, offset, busy):
        """What a debugger reads: no side effect, the present LO."""
        return (self.status() | busy if offset == STATUS else VALUES[offset](self)) % TURN_32

    def read(self, offset, busy):
        """A bus read, with its side effect."""
        if offset in self.latches:
            return self.latches[offset]
        if offset - 4 in self.latches:
            self.latches[offset - 4] = self.value(offset - 4, busy)
        return self.value(offset, busy)

    def write(self, offset, value):
        """All but what CMD.LOAD, CTRL.SRST and SOFT_V do to the pipeline."""
        name = NAMES[offset]
        bad_parity = self.safety & 1 << 8
        word = self.word_written(name, value)
        if word is not None:
            (self.unfit.add if bad_parity else self.unfit.discard)(word)
        if offset in self.stages:
            self.stages[offset] = value
        elif offset - 4 in self.stages:
            self.write_pair(offset - 4, value, self.stages[offset - 4])
            self.stages[offset - 4] = 0
        elif name == "CTRL":
            self.write_control(value)
        elif name == "FLAGS":
            self.flags &= ~value
        elif name == "CMD":
            if value & CLEAR:
                self.samples = self.early_count = 0
            if value & PHASE0:
                self.phase = 0
        elif name.startswith("STEP_") or name in ("A1", "A2"):
            self.write_fraction(name, value)
        elif name in MASKS:
            setattr(self, "judge_word" if name == "JUDGE" else name.lower(), value & MASKS[name])
        elif name in ("B1", "B2"):
            setattr(self, name.lower(), signed(value))

    @staticmethod
    def word_written(name, value):
        """The register with a parity bit that a write changes; none: there is none."""
        if name == "CMD" and value & PHASE0:
            return "PHASE"
        if name.endswith("_HI"):
            return name[:-3]
        reserved = (name.startswith("STEP_") or name in ("A1", "A2")) and value >= ONE_31
        return name if name in SINGLE_WORDS and not reserved else None

    def write_control(self, value):
        if value >> 2 & 3 == 3:
            self.flags |= CONFIG
            value = value & ~0xC | self.ctrl & 0xC
        if self.arithmetic.paper:
            if value & (BLOCK | CORRECT):
                self.flags |= CONFIG
            value &= ~(BLOCK | GUARD | CORRECT)
        self.ctrl = value & CTRL_BITS

    def write_fraction(self, name, value):
        """Unsigned Q1.31: 1.0 and more is a reserved value."""
        if value >= ONE_31:
            self.flags |= CONFIG
        elif name.startswith("STEP_"):
            self.steps[(OFFSETS[name] - STEP_AU) // 4] = value
        else:
            setattr(self, name.lower(), value)


CONSTANTS = {"ID": 0x43415053, "VERSION": 0x00010005, "CMD": 0, "SOFT_V": 0, "CORRECTION": 0}
JUDGE_RECORD = ("TURN_FLAGS", "RADIUS_MAX", "RESIDUE_MAX", "WINDING", "TURN_SAMPLES", "TURN_DET")
MASKS = {
    "LOOP": 0x1F1F,
    "LOCK_THRESHOLD": TURN_32 - 1,
    "DIVERGE_THRESHOLD": TURN_32 - 1,
    "BETA": TURN_32 - 1,
    "PHI": TURN_32 - 1,
    "JUDGE": 0x3FFFFF,
    "TURN_LIMIT": TURN_32 - 1,
    "SOFT_U": TURN_32 - 1,
    "SAFETY": 0x1F1F010F,
}
# Words with a parity bit, but the 48-bit registers.
SINGLE_WORDS = {name for name in NAMES.values() if name.startswith("STEP_")} | {
    *("CTRL", "LOOP", "LOCK_THRESHOLD", "DIVERGE_THRESHOLD", "JUDGE", "TURN_LIMIT", "SAFETY"),
    *("A1", "A2", "B1", "B2", "BETA", "PHI"),
}
WEIGHTS = ("AU", "BU", "CU", "AV", "BV", "CV")
PARAMETERS = ("A1", "A2", "B1", "B2", "BETA", "PHI")


def value_of(offset, name):
    """How the register is read off the state."""
    low = offset & ~4
    if low in PAIRS:
        part = 1 if offset == low else 0
        return lambda r: r.wide(low)[part]
    if name in CONSTANTS:
        return lambda r: CONSTANTS[name]
    if name.startswith("STEP_"):
        return lambda r: r.steps[(offset - STEP_AU) // 4]
    if name in JUDGE_RECORD:
        return attrgetter("judge." + name.lower())
    return attrgetter("judge_word" if name == "JUDGE" else name.lower())


VALUES = {offset: value_of(offset, name) for offset, name in NAMES.items() if name != "STATUS"}
