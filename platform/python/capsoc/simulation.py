"""One simulation of a session: its time, its parts, its state and its end."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from html import escape
from types import TracebackType
from typing import TYPE_CHECKING, Any, Callable, Optional, Union

from . import memory, proxies
from .errors import CapsocError, SessionError, SimulationEnded
from .figure import line_plot
from .past import Past
from .samples import Table, table
from .state import Event, Fault, Result, Snapshot, State, Stop, given
from .uart import Uart

if TYPE_CHECKING:
    from .arrays import Outgoing
    from .session import Session

UARTS, GPIOS = 5, 4


class Simulation(Past):
    """A simulation in its own process. Made by Session.run(), capsoc.run() or the fixture `capsoc`.

    Close it or use it in a `with` statement, which closes it on every way out. Simulated time stands between calls, so
    the same calls give the same bytes. All methods raise SimulationError (SimulationEnded, SimulationOver) for what
    the simulation refuses, and SessionError if the session is lost.
    """

    def __init__(self, session: Session, number: int, state: dict[str, Any], name: str) -> None:
        self.session, self.number, self.name = session, number, name
        self.closed = False
        #: Called with this simulation when its `with` statement ends, before it closes; and whether by an exception.
        self.on_exit: Optional[Callable[[Simulation, bool], None]] = None
        self.result: Optional[Result] = None
        self.events: list[Event] = []
        self.uart = [Uart(self, number) for number in range(UARTS)]
        self.uart0, self.uart1, self.uart2, self.uart3, self.uart4 = self.uart
        self.gpio = [proxies.Gpio(self, number) for number in range(GPIOS)]
        self.coprocessor = proxies.Coprocessor(self, "COPROCESSOR")
        self.registers = proxies.Registers(self)
        self.processor = proxies.Processor(self)
        self.sensor = proxies.SensorParameters(self)
        self.adc = proxies.Adc(self)
        self.variables = memory.Variables(self)
        self.mem8, self.mem16, self.mem32 = (memory.Memory(self, size) for size in (1, 2, 4))
        self._last = State.of(state)

    def call(self, method: str, outgoing: Optional[Outgoing] = None, /, **params: Any) -> Any:
        """A request of the protocol about this simulation, for what has no method here."""
        __tracebackhide__ = True
        if self.closed:
            raise SimulationEnded(f"The simulation of {self.name} was closed.", 2)
        return self.session.call(method, outgoing, simulation=self.number, **params)

    @property
    def state(self) -> State:
        """Where the simulation is now."""
        if self.result is None:
            self._last = State.of(self.call("simulation.state"))
        return self._last

    @property
    def time_s(self) -> float:
        """Simulated seconds since the start."""
        return self.state.time_s

    @property
    def itm(self) -> str:
        """What the program wrote to its ITM since the last look; the setting itm.backend has to be "stdout"."""
        return str(self.call("itm.read")["text"])

    @property
    def console(self) -> str:
        """What the program wrote to the console of semihosting since the last look."""
        return str(self.call("semihosting.read")["text"])

    def type(self, text: str, end: bool = False) -> None:
        """Text for the program's next reads of the console of semihosting.

        With the setting semihosting.console="stdio" an advance stops with the reason "console" at a read that has
        no text left, unless end was given with the last one. Otherwise such a read is at the end of the input.
        """
        self.call("semihosting.send", bytes=text, **given({"end": end or None}))

    def advance(
        self,
        seconds: Optional[float] = None,
        *,
        until_s: Optional[float] = None,
        cycles: Optional[int] = None,
        instructions: Optional[int] = None,
        samples: Optional[int] = None,
        within: Optional[float] = None,
    ) -> Stop:
        """Simulates for one of: seconds, to the time until_s, cycles, instructions, samples; without one to the end.

        within: limit in simulated seconds for the others. Ctrl-C stops the simulation between two instructions.
        """
        __tracebackhide__ = True
        return self._advance(
            {
                "seconds": seconds,
                "until_s": until_s,
                "cycles": cycles,
                "instructions": instructions,
                "samples": samples,
            },
            within,
        )

    def until(
        self,
        *,
        address: Optional[int] = None,
        symbol: Optional[str] = None,
        exception: Union[None, int, str] = None,
        expression: Optional[str] = None,
        every_s: float = 0.001,
        uart: Optional[tuple[int, str]] = None,
        within: Optional[float] = None,
    ) -> Stop:
        """Simulates up to an address, a symbol, the entry of an exception (number or name), or a UART's pattern.

        expression: of variables and registers ("turns > 3 and COPROCESSOR.STATUS.LOCK == 1"), which is evaluated every
        every_s simulated seconds. within: limit in simulated seconds; `if not sim.until(..., within=1)` tells that it
        was not reached.
        """
        __tracebackhide__ = True
        return self._advance(
            {
                "address": symbol if address is None else address,
                "exception": exception,
                "expression": None if expression is None else {"text": expression, "every_s": every_s},
                "uart": None if uart is None else {"uart": uart[0], "pattern": uart[1]},
            },
            within,
        )

    def _advance(self, goals: dict[str, Any], within: Optional[float]) -> Stop:
        __tracebackhide__ = True
        goal = given(goals)
        if len(goal) > 1:
            raise ValueError(f"{' and '.join(goal)} exclude each other; name one of them.")
        if within is not None:
            goal["within_s"] = within
        connection = self.session.connection
        if self.closed:
            raise SimulationEnded(f"The simulation of {self.name} was closed.", 2)
        request = connection.send("simulation.advance", {"simulation": self.number, **goal})
        try:
            answer = connection.wait(request)
        except KeyboardInterrupt:
            self.call("simulation.interrupt")
            connection.wait(request)
            raise
        self._last = State.of(answer["state"])
        events = [Event.of(event) for event in answer.get("events", ())]
        self.events += events
        asked = next(iter(goal), "over")
        return Stop(answer["reason"], self._last, "over" if asked == "within_s" else asked, answer.get("match"), events)

    def subscribe(self, *kinds: str) -> None:
        """Events of these kinds are added to `events`: "exception", "uart" (a line was sent), "verdict" (the
        program's own: pass with bound_deg, or reason), and others that the session names when it refuses one.

        Without a kind there are none from now on."""
        self.call("events.subscribe", kinds=list(kinds))

    def variable(self, name: str) -> Any:
        """A variable by its C name: "state.turns", "table[3]", "list->next"; structs are objects, arrays lists."""
        return self.variables[name]

    def samples(
        self, first: Optional[int] = None, last: Optional[int] = None, columns: Optional[Sequence[str]] = None
    ) -> Table:
        """Samples of the coprocessor, as a pandas frame if pandas can be imported, else as samples.Samples.

        first: number of the first one; last: how many of the newest. columns: names, all unless said; angles end in
        _deg, `t` is seconds, signals are fractions of full scale. NaN stands for what is not known.
        """
        chosen = {"first": first, "last": last, "columns": None if columns is None else list(columns)}
        answer = self.call("samples.read", **given(chosen))
        return table(answer["first"], answer["columns"])

    def inject(self, fault: str) -> str:
        """A fault of the hardware: "flip coprocessor.cv[39]", "freeze sin for 0.1", "lose irq coprocessor at sample 9"
        (docs/guide/safety.md); without "at" it begins now. Returns the fault with its time, as `--inject` takes it."""
        __tracebackhide__ = True
        return str(self.call("fault.inject", fault=fault)["fault"])

    @property
    def faults(self) -> list[Fault]:
        """The outcomes of the injected faults."""
        return [Fault(**each) for each in self.call("fault.list")["faults"]]

    def fault_places(self) -> list[tuple[str, int, str]]:
        """What a fault can change: place, bits, unit."""
        return [(each["place"], each["bits"], each["unit"]) for each in self.call("fault.places")["places"]]

    def save(self, file: Union[str, os.PathLike[str]]) -> None:
        """Writes a checkpoint, which `capsoc run --restore FILE` resumes."""
        self.call("simulation.save", file=os.path.abspath(os.fspath(file)))

    def record(self, file: Union[str, os.PathLike[str]], last: Optional[float] = None) -> None:
        """Writes the session of this simulation until now, which `capsoc replay FILE` simulates again and compares.

        last: simulated seconds; the session begins in a kept state that is at least so long ago.
        """
        file = os.path.abspath(os.fspath(file))
        self.call("simulation.record", **given({"file": file, "last_s": last}))

    def snapshot(self) -> Snapshot:
        """Keeps the state in memory, for restore()."""
        uarts = self._uart_copies()
        answer = self.call("simulation.snapshot")
        return Snapshot(answer["snapshot"], answer["bytes"], uarts)

    def restore(self, snapshot: Snapshot) -> State:
        """Returns to a snapshot of this simulation, as often as wanted."""
        answer = self.call("simulation.restore", snapshot=snapshot.number)
        self._last = State.of(answer["state"])
        for uart, copy in zip(self.uart, snapshot.uarts):
            uart._set(copy)
        return self._last

    def drop(self, snapshot: Snapshot) -> None:
        """Releases the memory of a snapshot."""
        self.session.call("snapshot.drop", snapshot=snapshot.number)

    def clone(self, count: int = 1) -> list[Simulation]:
        """Further simulations that continue from the state of now, each on its own."""
        uarts = self._uart_copies()
        numbers: Iterable[int] = self.call("simulation.clone", count=count)["simulations"]
        clones = [Simulation(self.session, number, self._last.__dict__, self.name) for number in numbers]
        for clone in clones:
            clone.on_exit = self.on_exit
            for uart, copy in zip(clone.uart, uarts):
                uart._set(copy)
        return clones

    def _uart_copies(self) -> tuple[tuple[str, int], ...]:
        return tuple(uart._copy() for uart in self.uart)

    def finish(self) -> Result:
        """Ends the run where it is and writes its files. Only the results and close() remain."""
        if self.result is None:
            self._last = self.state
            answer = self.call("simulation.finish")
            self.result = Result(answer["code"], answer["reason"], answer["result"], answer.get("reports", []))
        return self.result

    def close(self) -> None:
        """Ends the simulation's process. May be called twice."""
        if not self.closed:
            try:
                self.call("simulation.close")
            except (SimulationEnded, SessionError):
                pass  # it is gone already
            finally:
                self.closed = True

    def __enter__(self) -> Simulation:
        return self

    def __exit__(
        self, kind: Optional[type[BaseException]], error: Optional[BaseException], trace: Optional[TracebackType]
    ) -> None:
        try:
            if self.on_exit is not None and not self.closed:
                self.on_exit(self, error is not None)
        finally:
            self.close()

    def __repr__(self) -> str:
        if self.closed:
            return f"<capsoc.Simulation {self.name}, closed>"
        return f"<capsoc.Simulation {self.name} at {self._last.time_s:.6f} s>"

    def _repr_html_(self) -> str:
        try:
            state = self.state
            columns = self.samples(last=2000)
            figures = "".join(
                line_plot(list(columns[name]), name) for name in ("u", "v", "error_deg") if name in columns.columns
            )
        except CapsocError as error:
            return f"<p>{escape(self.name)}: {escape(str(error))}</p>"
        rows = (("time", f"{state.time_s:.6f} s"), ("place", state.place), ("cycles", f"{state.cycles:,}"))
        cells = "".join(f"<tr><th>{name}</th><td>{escape(value)}</td></tr>" for name, value in rows)
        return f"<table><caption>{escape(self.name)}</caption>{cells}</table>{figures}"
