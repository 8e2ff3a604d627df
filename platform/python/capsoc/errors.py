"""Exceptions of the package. Each message is a sentence that says what happened and what to do."""

from __future__ import annotations

from typing import Any, Optional

#: Error codes of the session protocol (docs/reference/protocol.md).
REFUSED, NO_SIMULATION, OVER = 1, 2, 3


class CapsocError(Exception):
    """Base class of all exceptions of this package."""


class ProgramNotFound(CapsocError):
    """The program `capsoc` was not found or cannot be started."""


class SessionError(CapsocError):
    """The session ended, cannot be reached, or sent an answer that is not of the protocol.

    The connection cannot be used afterwards; start another session.
    """


class AnswerTimeout(SessionError):
    """The session did not answer within the connection's limit of host time."""


class RequestError(CapsocError):
    """The session does not know the method or a parameter. `code` is JSON-RPC's (-32700 to -32600)."""

    def __init__(self, message: str, code: int = -32600, data: Any = None) -> None:
        super().__init__(message)
        self.code = code
        self.data = data


class SimulationError(CapsocError):
    """A simulation refuses a request: a wrong setting, a file, an address. `code` is the protocol's."""

    def __init__(self, message: str, code: int = REFUSED, data: Any = None) -> None:
        super().__init__(message)
        self.code = code
        self.data = data


class SimulationEnded(SimulationError):
    """There is no such simulation: it was closed, or its process ended, for instance by a signal."""


class SimulationOver(SimulationError):
    """The program has ended; simulated time cannot advance any further."""


class ExpectationError(SimulationError, AssertionError):
    """A UART did not send the expected text in time.

    An AssertionError as well, so that test runners report a failure.

    text: everything that arrived since the last match. time_s: simulated seconds. place: where the program was.
    """

    def __init__(self, message: str, text: str = "", time_s: float = 0.0, place: str = "") -> None:
        super().__init__(message)
        self.text = text
        self.time_s = time_s
        self.place = place


def from_answer(error: Any) -> CapsocError:
    """The exception for the member `error` of an answer."""
    if not isinstance(error, dict) or not isinstance(error.get("code"), int):
        return SessionError(f"The session sent an error without a code: {str(error)[:200]}")
    code, message, data = error["code"], str(error.get("message", "")), error.get("data")
    kinds: dict[int, type[SimulationError]] = {NO_SIMULATION: SimulationEnded, OVER: SimulationOver}
    if code < 0:
        return RequestError(message, code, data)
    return kinds.get(code, SimulationError)(message, code, data)


def with_tail(message: str, log: Optional[str], lines: int = 5) -> str:
    """A message followed by the last lines of a log, if it has any."""
    tail = (log or "").strip().splitlines()[-lines:]
    return "\n  ".join([message, *tail])
