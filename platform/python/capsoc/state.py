"""What a simulation answers: where it is, why an advance ended, events, snapshots, results."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import Any, Optional


def given(values: dict[str, Any]) -> dict[str, Any]:
    """Those that are not None."""
    return {name: value for name, value in values.items() if value is not None}


@dataclass(frozen=True)
class State:
    """Where a simulation is.

    place: function, file and line of the program counter, and who called; only in Simulation.state. over: the program
    has ended.
    """

    time_s: float = 0.0
    time_ps: int = 0
    cycles: int = 0
    instructions: int = 0
    pc: int = 0
    place: str = ""
    over: bool = False
    asleep: bool = False

    @classmethod
    def of(cls, answer: dict[str, Any]) -> State:
        """The state in an answer, which names its place only where that was asked for."""
        known = {part.name for part in fields(cls)}
        told = {**answer.get("state", {}), **answer}
        return cls(**{name: value for name, value in told.items() if name in known})


@dataclass(frozen=True)
class Position:
    """An instant of a simulation's history, between two instructions. samples: results of the coprocessor so far."""

    time_s: float
    time_ps: int
    cycles: int
    instructions: int
    samples: int

    @classmethod
    def of(cls, answer: dict[str, Any]) -> Position:
        """The position in an answer, which may have more members."""
        return cls(**{part.name: answer[part.name] for part in fields(cls)})


@dataclass(frozen=True)
class History:
    """One history of a simulation: the present one, or one that was left when a call changed its past.

    number: for Simulation.select_history(). start: the last position that it has in common with the present one, None
    of that one itself. inputs: calls that changed the simulation in it.
    """

    number: int
    present: bool
    end: Position
    inputs: int
    start: Optional[Position] = None


@dataclass(frozen=True)
class Write:
    """The last write to something. by: "instruction", or the method of the request that wrote.

    position: in front of the instruction; after a request. old, new: a register's value, or bytes of memory. pc,
    place (function, file and line): of the instruction.
    """

    by: str
    position: Position
    old: Any
    new: Any
    pc: Optional[int] = None
    place: str = ""


@dataclass(frozen=True)
class Step:
    """A signal of the coprocessor in one result. value: of full scale, degrees for angles, None for flags and counters;
    word: as its format has it. made_from: other steps and inputs. stage: T0 to T4, or registers."""

    name: str
    stage: str
    unit: str
    word: int
    made_from: list[str]
    value: Optional[float] = None


@dataclass(frozen=True)
class Why:
    """The values that made a signal. steps: the signal first, each before those that it is made from. inputs: the
    sample's words, and registers as they were when it was taken; None for state without a register."""

    signal: str
    sample: int
    position: Position
    steps: list[Step]
    inputs: dict[str, Optional[int]]

    def __getitem__(self, name: str) -> Any:
        """The value of a step, or of an input."""
        for step in self.steps:
            if step.name == name:
                return step.word if step.value is None else step.value
        return self.inputs[name]

    def __str__(self) -> str:
        lines = [f"{self.signal} of result {self.sample} at {self.position.time_s:.9g} s"]
        for step in self.steps:
            value = f"{step.word:#x}" if step.value is None else f"{step.value:.9g}"
            lines.append(f"{step.stage:<9} {step.name} = {value}, from {' '.join(step.made_from) or 'nothing'}")
        lines += [name if value is None else f"{name} = {value:.0f}" for name, value in self.inputs.items()]
        return "\n".join(lines)


@dataclass(frozen=True)
class FunctionCost:
    """What a function took itself, without what it called."""

    function: str
    cycles: int
    instructions: int


@dataclass(frozen=True)
class Change:
    """The last change of a register or field of a device, or of a signal of the coprocessor.

    by, of a register: "instruction" (one that accessed the device: pc, place, access "write" or "read", accessed: the
    register that it accessed), "device" (no instruction did; sample: the result that came), or the method of a request.
    position: the first instant with the new value. since, of a register: the last instant with the old one.
    """

    position: Position
    old: Any
    new: Any
    by: str = ""
    since: Optional[Position] = None
    pc: Optional[int] = None
    place: str = ""
    access: str = ""
    accessed: str = ""
    sample: Optional[int] = None


@dataclass(frozen=True)
class Fault:
    """The outcome of an injected fault: where it was applied first, what the place held before and after.

    fault: the line that repeats it. changes: how often it changed something. note: why it changed nothing.
    """

    fault: str
    applied: bool
    time_s: float = 0
    cycle: int = 0
    instruction: int = 0
    before: int = 0
    after: int = 0
    changes: int = 0
    note: str = ""


@dataclass(frozen=True)
class Event:
    """Something that happened: kind ("exception", "uart" and so on), simulated seconds, details."""

    kind: str
    time_s: float
    details: dict[str, Any]

    @classmethod
    def of(cls, answer: dict[str, Any]) -> Event:
        """The event in an answer."""
        return cls(answer["kind"], answer["time_s"], {k: v for k, v in answer.items() if k not in ("kind", "time_s")})


@dataclass(frozen=True)
class Stop:
    """Why an advance ended. True if what was asked for was reached; False at a limit, an end, an interruption.

    reason: "time", "cycles", "instructions", "samples", "address", "exception", "uart", "expression", or "limit",
    "interrupted", "over", "console" (the program reads its console, see type()).
    match: of a UART's pattern, text and groups.
    """

    reason: str
    state: State
    asked: str
    match: Optional[dict[str, Any]] = None
    events: list[Event] = field(default_factory=list)

    def __bool__(self) -> bool:
        return self.reason not in ("limit", "interrupted", "over", "console") or self.asked == self.reason == "over"


@dataclass(frozen=True)
class Result:
    """The outcome of a run: the exit code of `capsoc run` (0: pass), its reason, and the result file as `data`.

    reports: of a crash or of a difference between model and RTL.
    """

    code: int
    reason: str
    data: dict[str, Any]
    reports: list[str] = field(default_factory=list)

    @property
    def passed(self) -> bool:
        """Whether the exit code is 0."""
        return self.code == 0

    def __getitem__(self, path: str) -> Any:
        """A value of the result file (docs/reference/results.md) by its path, such as "verdict.bound_deg"."""
        value: Any = self.data
        for name in path.split("."):
            value = value[name]
        return value


@dataclass(frozen=True)
class Snapshot:
    """A state that the session keeps in memory. size: bytes."""

    number: int
    size: int
    uarts: tuple[tuple[str, int], ...] = field(repr=False)
