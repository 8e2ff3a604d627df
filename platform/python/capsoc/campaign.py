"""Many runs side by side: each simulation is its own process, so that all processors of the host work."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from typing import Any, Callable, Optional, Union

from .program import Place
from .session import Session
from .simulation import Simulation
from .state import Result

#: A run: a function of a Session that returns a row or a value, or the arguments of Session.run() by name.
Run = Union[Callable[[Session], Any], Mapping[str, Any]]
Measure = Callable[[Simulation, Result], Mapping[str, Any]]


class Campaign:
    """Runs from a list of functions or settings.

    runs: functions, which get the session, run what they want and return a dict (or a value); or mappings with the
    arguments of Session.run(), which run to their end. measure: for the latter, makes the row of a finished run; unless
    given, the exit code, its reason and the largest angle error. jobs: simulations at a time, the host's processors
    unless said. program: as of Session.

        rows = capsoc.Campaign([{"sensor": capsoc.Sensor(noise=10**-n)} for n in range(2, 7)]).results()
    """

    def __init__(
        self,
        runs: Iterable[Run],
        *,
        measure: Optional[Measure] = None,
        jobs: Optional[int] = None,
        program: Optional[Place] = None,
    ) -> None:
        self.runs = list(runs)
        self.jobs = jobs or os.cpu_count() or 1
        self._measure = measure or _outcome
        self._program = program
        self._rows: Optional[list[dict[str, Any]]] = None

    def results(self) -> list[dict[str, Any]]:
        """One row for each run, in the order of the list, whatever finished first. Runs them at the first call.

        A run that raises an exception has a row with "error": the exception's type and message. The others continue.
        """
        if self._rows is None:
            with Session(self._program) as session, ThreadPoolExecutor(self.jobs) as pool:
                pending = [pool.submit(self._row, session, number, run) for number, run in enumerate(self.runs)]
                try:
                    self._rows = [one.result() for one in pending]
                except BaseException:  # Ctrl-C: the session's end ends the simulations, too
                    for one in pending:
                        one.cancel()
                    session.close()
                    raise
        return self._rows

    def frame(self) -> Any:
        """The results as a pandas frame if pandas can be imported, else as results()."""
        try:
            import pandas
        except ImportError:
            return self.results()
        return pandas.DataFrame(self.results()).set_index("run")

    def _row(self, session: Session, number: int, run: Run) -> dict[str, Any]:
        row: dict[str, Any] = {"run": number}
        try:
            row.update(self._of_function(session, run) if callable(run) else self._of_settings(session, run))
        except Exception as error:  # of one run, whatever it is: the row says so
            row["error"] = f"{type(error).__name__}: {error}"
        return row

    @staticmethod
    def _of_function(session: Session, run: Callable[[Session], Any]) -> Mapping[str, Any]:
        value = run(session)
        named = {"name": getattr(run, "__name__", "")}
        return {**named, **value} if isinstance(value, Mapping) else {**named, "value": value}

    def _of_settings(self, session: Session, run: Mapping[str, Any]) -> Mapping[str, Any]:
        with session.run(**run) as simulation:
            simulation.advance()
            return self._measure(simulation, simulation.finish())


def _outcome(simulation: Simulation, result: Result) -> dict[str, Any]:
    errors = result.data.get("angle_error_deg") or {}
    return {
        "code": result.code,
        "reason": result.reason,
        "time_s": (result.data.get("time") or {}).get("simulated_s"),
        "error_deg": errors.get("calibration_mode_max"),
    }
