"""Going back in time in one simulation: positions, and questions about what was before now."""

from __future__ import annotations

import os
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, Callable, Iterator, Optional, Sequence, Union, cast

from .errors import SimulationError
from .state import Change, Event, FunctionCost, History, Position, State, Step, Why, Write, given

if TYPE_CHECKING:
    from .arrays import Outgoing
    from .simulation import Simulation

#: Traces that are files.
TRACES = ("instructions", "bus", "profile", "coverage", "waves", "timeline", "translation")


class Past:
    """The part of a Simulation that knows its history (docs/reference/protocol.md, "Going back")."""

    _last: State

    def call(self, method: str, outgoing: Optional[Outgoing] = None, /, **params: Any) -> Any:
        """A request of the protocol about this simulation."""
        raise NotImplementedError

    def when(self) -> Position:
        """Where the simulation is in its history."""
        return Position.of(self.call("history.when")["now"])

    @property
    def histories(self) -> list[History]:
        """The present history, and those that were left when a call changed their past, by number."""
        return [
            History(
                each["history"],
                each["present"],
                Position.of(each["end"]),
                each["inputs"],
                None if each["present"] else Position.of(each["from"]),
            )
            for each in self.call("history.list")["histories"]
        ]

    def select_history(self, number: int) -> State:
        """To the end of another history, which is the present one then; the one before is kept instead.

        What the UARTs sent in it is not told again.
        """
        answer = self.call("history.select", number=number)
        self._last = State.of(answer["state"])
        return self._last

    def goto(
        self,
        time_s: Optional[float] = None,
        *,
        cycles: Optional[int] = None,
        instructions: Optional[int] = None,
        sample: Optional[int] = None,
        position: Optional[Position] = None,
    ) -> State:
        """To the first instant at which a time or a count since the start is reached, back or forward.

        What was sent to the simulation takes place again; what it sent is not told again. position: its time.
        """
        __tracebackhide__ = True
        time_ps = None if position is None else position.time_ps
        goal = {
            "time_s": time_s,
            "time_ps": time_ps,
            "cycles": cycles,
            "instructions": instructions,
            "sample": sample,
        }
        answer = self.call("simulation.goto", **given(goal))
        self._last = State.of(answer["state"])
        return self._last

    def at(self, time_s: float) -> Simulation:
        """This simulation at a time, as goto(): `sim.at(1.5).variables["turns"]`."""
        __tracebackhide__ = True
        self.goto(time_s)
        return cast("Simulation", self)

    def back(
        self,
        seconds: Optional[float] = None,
        *,
        cycles: Optional[int] = None,
        instructions: Optional[int] = None,
        samples: Optional[int] = None,
        symbol: Optional[str] = None,
        address: Optional[int] = None,
        expression: Optional[str] = None,
        every_s: float = 0.001,
    ) -> bool:
        """Back by one of these, or to the last instant before now at which the processor was in front of an instruction
        or an expression was not 0. False: it never was, and the simulation stays; or the history begins later."""
        __tracebackhide__ = True
        goals = {
            "seconds": seconds,
            "cycles": cycles,
            "instructions": instructions,
            "samples": samples,
            "address": symbol if address is None else address,
            "expression": None if expression is None else {"text": expression, "every_s": every_s},
        }
        answer = self.call("history.back", **given(goals))
        self._last = State.of(answer["state"])
        return answer["reason"] not in ("never", "beginning")

    def back_to(self, condition: Union[str, Callable[[Simulation], Any]], every_s: float = 0.001) -> bool:
        """Back to the last instant before now at which a condition held, seen every every_s simulated seconds.

        condition: an expression as in until(), or a function of this simulation, which is slower: each look goes back.
        False: it never held, and the simulation is where it was.
        """
        __tracebackhide__ = True
        if isinstance(condition, str):
            return self.back(expression=condition, every_s=every_s)
        about = self.call("history.when")
        began, beginning = about["now"], about["beginning"]["time_ps"]
        step = round(every_s * 1e12)
        if step <= 0:
            raise ValueError("every_s: give more than 0.")
        for time_ps in range((began["time_ps"] - 1) // step * step, beginning - 1, -step):
            self._last = State.of(self.call("simulation.goto", time_ps=time_ps)["state"])
            if condition(cast("Simulation", self)):
                return True
        self.goto(position=Position.of(began))
        return False

    def last_write(
        self,
        variable: Optional[str] = None,
        *,
        address: Union[None, int, str] = None,
        size: int = 4,
        register: Optional[str] = None,
    ) -> Optional[Write]:
        """The last instruction or request before now that wrote to a variable, to memory (an address or a symbol, and
        bytes), or to a register of the processor; None: there is none. The simulation stays where it is."""
        __tracebackhide__ = True
        asked: dict[str, Any] = {"variable": variable, "address": address, "register": register}
        asked["size"] = None if address is None else size
        answer = self.call("history.last_write", **given(asked))
        if not answer["found"]:
            return None
        known = {name: answer[name] for name in ("by", "old", "new", "pc", "place") if name in answer}
        return Write(position=Position.of(answer["position"]), **known)

    def last_change(
        self, register: Optional[str] = None, *, signal: Optional[str] = None, every_s: float = 0.001
    ) -> Optional[Change]:
        """The last change before now of a register or field of a device ("UART0.STATE.TXFULL") and who made it, or of a
        signal of the coprocessor; None: there is none. What comes and goes within every_s is not seen."""
        __tracebackhide__ = True
        asked = {"name": register, "signal": signal, "every_s": every_s}
        answer = self.call("history.last_change", **given(asked))
        if not answer.pop("found"):
            return None
        answer["position"] = Position.of(answer["position"])
        if "since" in answer:
            answer["since"] = Position.of(answer["since"])
        return Change(**answer)

    def timeline(self, one: float, other: Optional[float] = None, kinds: Optional[Sequence[str]] = None) -> list[Event]:
        """What happened between two times (other: now), of some kinds of events or of all. The simulation stays."""
        __tracebackhide__ = True
        asked: dict[str, Any] = {"one": {"time_s": one}, "other": None if other is None else {"time_s": other}}
        asked["kinds"] = None if kinds is None else list(kinds)
        return [Event.of(each) for each in self.call("history.timeline", **given(asked))["events"]]

    def why(self, signal: str, sample: Optional[int] = None) -> Why:
        """Which values made a signal of the coprocessor in a result, back to the sample and the registers; print it.

        sample: the number of the result; the newest. The simulation stays where it is.
        """
        __tracebackhide__ = True
        answer = self.call("history.why", **given({"signal": signal, "sample": sample}))
        steps = [
            Step(**{name: value for name, value in each.items() if name != "is_angle"}) for each in answer["steps"]
        ]
        return Why(answer["signal"], answer["sample"], Position.of(answer["position"]), steps, answer["inputs"])

    def trace(self, one: float, other: Optional[float] = None, **files: Any) -> list[FunctionCost]:
        """Traces what happened between two times (other: now), whether it was traced then or not. The simulation stays.

        files: instructions, bus, profile, coverage, waves, timeline, each with its path, and what else a run has as
        trace.NAME (depth=100). Returns the functions that took the most cycles, with a profile.
        """
        __tracebackhide__ = True
        between: dict[str, Any] = {"one": {"time_s": one}, "other": None if other is None else {"time_s": other}}
        return self._trace(between, files)

    @contextmanager
    def tracing(self, **files: Any) -> Iterator[list[FunctionCost]]:
        """Traces what happens in a `with` block, as trace() does once the block is left; its list is filled then.

        Simulates the block a second time, from the history. An exception in the block is traced up to there.
        """
        functions: list[FunctionCost] = []
        began = self.when().time_ps
        try:
            yield functions
        finally:
            functions += self._trace({"one": {"time_ps": began}}, files)

    def _trace(self, between: dict[str, Any], files: dict[str, Any]) -> list[FunctionCost]:
        __tracebackhide__ = True
        paths = {
            name: os.path.abspath(path) if isinstance(path, (str, os.PathLike)) and name in TRACES else path
            for name, path in files.items()
        }
        answer = self.call("history.trace", **given(between), files=paths)
        if answer["lost"]:
            raise SimulationError(" ".join(answer["lost"]), 1)
        return [FunctionCost(**each) for each in answer["functions"]]

    def history_diff(self, one: float, other: Optional[float] = None) -> dict[str, Any]:
        """How two times differ (other: now): "processor", "devices" and "memory", with both values by name."""
        __tracebackhide__ = True
        times = {"one": {"time_s": one}} if other is None else {"one": {"time_s": one}, "other": {"time_s": other}}
        answer: dict[str, Any] = self.call("history.diff", **times)
        return answer
