"""The pytest plugin: the fixture `capsoc`, the marker `capsoc(backend=...)`, and what a failed test attaches.

One session serves all tests of a process, so each worker of pytest-xdist has its own. When a test fails, the report
has a section for each of its simulations: where the program was, the UARTs' last lines, the crash report, and a
checkpoint of the last state, which `capsoc run --restore FILE --gdb` resumes.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable, Optional, Union

import pytest

from .pages import Pages

if TYPE_CHECKING:
    from .session import Session
    from .simulation import Simulation
    from .uart import Uart

BACKENDS = ("tlm", "rtl", "lockstep")
SHOWN_LINES = 40


class Capsoc:
    """What the fixture gives: the names of the package, with run() in the tests' session."""

    def __init__(self, session: Session, backend: Optional[str], checkpoints: Path, pages: Pages) -> None:
        self.session = session
        self.backend = backend
        self._pages = pages
        self.reports: list[tuple[str, str]] = []
        self.failed = False
        self._checkpoints = checkpoints
        self._simulations: list[Simulation] = []

    def __getattr__(self, name: str) -> Any:
        import capsoc

        return getattr(capsoc, name)

    def run(self, *arguments: Any, **options: Any) -> Simulation:
        """As Session.run(), with the marker's backend unless another one is named."""
        if self.backend is not None:
            options.setdefault("backend", self.backend)
        if self._pages.wanted:
            options["settings"] = {"results.curves": True, **options.get("settings", {})}
        return self._added(self.session.run(*arguments, **options))

    def replay(self, file: Union[str, os.PathLike[str]], **options: Any) -> Simulation:
        """As Session.replay()."""
        return self._added(self.session.replay(file, **options))

    def _added(self, simulation: Simulation) -> Simulation:
        simulation.on_exit = self._leave
        self._simulations.append(simulation)
        return simulation

    def _leave(self, simulation: Simulation, failed: bool) -> None:
        if failed:
            self.report(simulation)
        self._pages.add(simulation)

    def report(self, simulation: Simulation) -> None:
        """Keeps what a failed test's report says about a simulation that is still open."""
        number = len(self.reports) + 1
        self.reports.append((f"capsoc {simulation.name} ({number})", describe(simulation, self._file(number))))

    def report_open(self) -> None:
        """As report(), for each simulation that the test did not close."""
        for simulation in self._simulations:
            if not simulation.closed:
                self._leave(simulation, True)
                simulation.close()

    def close(self) -> None:
        """Closes what the test left open. Of a test that passed no checkpoint remains."""
        for simulation in self._simulations:
            if not simulation.closed:
                self._pages.add(simulation)
                simulation.close()
        for number in range(1, len(self.reports) + 1) if not self.failed else ():
            self._file(number).unlink(missing_ok=True)

    def _file(self, number: int) -> Path:
        return self._checkpoints.with_name(f"{self._checkpoints.name}-{number}.checkpoint")


def describe(simulation: Simulation, checkpoint: Path) -> str:
    """State, UART text and crash report of a simulation, which is over afterwards; writes the checkpoint."""
    from .errors import CapsocError

    lines: list[str] = []

    def attempt(part: Callable[[], list[str]]) -> None:
        try:
            lines.extend(part())
        except CapsocError as error:
            lines.append(str(error))

    attempt(lambda: _state_lines(simulation))
    for uart in simulation.uart:
        attempt(partial(_uart_lines, uart))
    attempt(lambda: _checkpoint_lines(simulation, checkpoint))
    attempt(lambda: _crash_lines(simulation))
    attempt(lambda: _text_lines("standard error of the session", simulation.session.log()))
    return "\n".join(lines)


def _state_lines(simulation: Simulation) -> list[str]:
    state = simulation.state
    over = ", the program has ended" if state.over else ""
    return [
        f"time {state.time_s:.9f} s, cycle {state.cycles}, instruction {state.instructions}{over}",
        f"at {state.place or hex(state.pc)}",
    ]


def _text_lines(title: str, text: str) -> list[str]:
    shown = text.splitlines()[-SHOWN_LINES:]
    return [f"-- {title}, the last {len(shown)} lines:", *shown] if shown else []


def _uart_lines(uart: Uart) -> list[str]:
    return _text_lines(f"UART {uart.number}", uart.text)


def _checkpoint_lines(simulation: Simulation, file: Path) -> list[str]:
    if simulation.result is not None or simulation.state.over:
        return []
    simulation.save(file)
    return [f"checkpoint: {file}"]


def _crash_lines(simulation: Simulation) -> list[str]:
    over = simulation.state.over
    result = simulation.finish()
    # The outcome of a run that only its test ended means nothing.
    outcome = [f"-- exit {result.code}: {result.reason}"] if over else []
    return [*outcome, *"\n".join(result.reports).splitlines()]


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("capsoc")
    group.addoption("--capsoc-program", metavar="PATH", help="the program capsoc, or the folder of its build")
    group.addoption("--capsoc-html", metavar="FILE", help="writes one page with the results of all simulations")


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line(
        "markers", "capsoc(backend): the coprocessor is the model (tlm), the Verilated RTL (rtl), or both (lockstep)"
    )


class Sessions:
    """The session of this process's tests; another one is started when it is lost."""

    def __init__(self, program: Optional[str], pages: Pages) -> None:
        self._program = program
        self._session: Optional[Session] = None
        self.pages = pages

    def get(self) -> Session:
        """The session, alive. Raises ProgramNotFound or SessionError."""
        from .session import Session

        if self._session is not None and not self._session.alive:
            self.close()
        if self._session is None:
            self._session = Session(self._program)
        return self._session

    def close(self) -> None:
        """Ends the session, if there is one."""
        if self._session is not None:
            self._session.close()
            self._session = None


@pytest.fixture(scope="session")
def capsoc_sessions(request: pytest.FixtureRequest) -> Iterator[Sessions]:
    """Starts the session that the tests of this process share."""
    program, file = request.config.getoption("--capsoc-program"), request.config.getoption("--capsoc-html")
    # Each worker of pytest-xdist writes its own page.
    sessions = Sessions(program, Pages(program, file, os.environ.get("PYTEST_XDIST_WORKER")))
    yield sessions
    sessions.close()
    sessions.pages.write()


@pytest.fixture
def capsoc(request: pytest.FixtureRequest, capsoc_sessions: Sessions, tmp_path: Path) -> Iterator[Capsoc]:
    """The package `capsoc`, with run() in a session that is running. Simulations are closed after the test."""
    fixture = Capsoc(capsoc_sessions.get(), _backend(request.node), tmp_path, capsoc_sessions.pages)
    request.node.stash[_fixture] = fixture
    yield fixture
    fixture.close()


_fixture = pytest.StashKey[Capsoc]()


def _backend(node: pytest.Item) -> Optional[str]:
    marker = node.get_closest_marker("capsoc")
    if marker is None:
        return None
    backend = marker.kwargs.get("backend")
    if marker.args or set(marker.kwargs) != {"backend"} or backend not in BACKENDS:
        raise pytest.UsageError(f"{node.nodeid}: the marker is capsoc(backend=...) with one of {', '.join(BACKENDS)}.")
    return str(backend)


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Iterator[None]:
    outcome = yield
    report = outcome.get_result()  # type: ignore[attr-defined]
    fixture = item.stash.get(_fixture, None)
    if fixture is None or report.when != "call" or not report.failed:
        return
    fixture.failed = True
    fixture.report_open()
    report.sections += fixture.reports
