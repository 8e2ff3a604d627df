"""A UART of the simulation, seen from outside: what the program sends and what it receives."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Optional, Union

from .arrays import Outgoing
from .errors import ExpectationError

if TYPE_CHECKING:
    from .simulation import Simulation
    from .state import Stop

#: Lines of text in the message of an expectation that failed.
SHOWN_LINES = 20


class Match:
    """What an expectation found: `match[0]` is the text, `match[1]` the first group, `before` the text before it."""

    def __init__(self, groups: Sequence[Optional[str]], before: str) -> None:
        self.text, self.before = groups[0] or "", before
        self._groups = tuple(groups)

    def groups(self) -> tuple[Optional[str], ...]:
        """All groups, None for those that took no part."""
        return self._groups[1:]

    def group(self, number: int = 0) -> Optional[str]:
        """The text (0) or a group, as re.Match.group()."""
        return self._groups[number]

    __getitem__ = group

    def __repr__(self) -> str:
        return f"<Match {self.text!r} {self.groups()}>"


class Uart:
    """UART 0 to 4. Text is UTF-8; bytes that are not are replaced by U+FFFD."""

    def __init__(self, simulation: Simulation, number: int) -> None:
        self._simulation, self.number = simulation, number
        self._text = ""  # all that was read
        self._seen = 0  # characters of it up to the end of the last match

    @property
    def text(self) -> str:
        """All text that the program has sent."""
        self._text += self._simulation.call("uart.read", uart=self.number)["text"]
        return self._text

    def send(self, data: Union[str, bytes]) -> None:
        """Bytes for the program, which it receives from this simulated instant on at the line's baud rate."""
        outgoing = Outgoing()
        raw = data.encode() if isinstance(data, str) else data
        self._simulation.call("uart.send", outgoing, uart=self.number, bytes=outgoing.add_bytes(raw))

    def expect(self, pattern: Union[str, re.Pattern[str]], within: float = 60.0) -> Match:
        """Advances the simulation until the text after the last match has a match of a regular expression.

        The text is searched whenever a line ends or the transmitter becomes idle. within: limit in simulated seconds.
        `^` and `$` are also the ends of lines. Use what Python's expressions and RE2 have in common. Raises
        ExpectationError, with the text that was seen, if the limit or the program's end comes first.
        """
        __tracebackhide__ = True  # pytest shows the test's line
        expression, text = _compiled(pattern)
        if found := self._search(expression):  # in what was read but not matched
            return found
        stop = self._simulation.until(uart=(self.number, text), within=within)
        if stop.match is not None:
            return self._found(stop.match)
        self.text  # reads the rest
        if found := self._search(expression):
            return found
        raise self._unmet(expression.pattern, within, stop)

    def _search(self, expression: re.Pattern[str]) -> Optional[Match]:
        found = expression.search(self._text, self._seen)
        if found is None:
            return None
        before = self._text[self._seen : found.start()]
        self._seen = found.end()
        return Match((found.group(), *found.groups()), before)

    def _found(self, match: dict[str, Any]) -> Match:
        """A match that the session found: it counts the text up to its end as read."""
        self._text += match["text"]
        groups = match["groups"]
        before = self._text[self._seen : len(self._text) - len(groups[0])]
        self._seen = len(self._text)
        return Match(groups, before)

    def _unmet(self, pattern: str, within: float, stop: Stop) -> ExpectationError:
        lines = self._text.splitlines()[-SHOWN_LINES:]
        state = self._simulation.state
        why = {
            "over": "before the program ended",
            "interrupted": "before it was interrupted",
        }.get(stop.reason, f"within {within:g} simulated s")
        message = (
            f"UART {self.number} did not send {pattern!r} {why}: it is {state.time_s:.6f} s and the program is at "
            f"{state.place or hex(state.pc)}. "
        )
        shown = "".join(f"\n  | {line}" for line in lines)
        message += f"The last {len(lines)} lines:{shown}" if lines else "It sent nothing."
        return ExpectationError(message, self._text[self._seen :], state.time_s, state.place)

    def _copy(self) -> tuple[str, int]:
        """What belongs to the simulation's state on this side: text and position."""
        return self._text, self._seen

    def _set(self, copy: tuple[str, int]) -> None:
        self._text, self._seen = copy

    def __repr__(self) -> str:
        return f"<UART {self.number}: {len(self._text)} characters>"


def _compiled(pattern: Union[str, re.Pattern[str]]) -> tuple[re.Pattern[str], str]:
    """An expression for the text here, and the same for the session, whose flags are written in front."""
    given = pattern if isinstance(pattern, str) else pattern.pattern
    flags = re.MULTILINE | (0 if isinstance(pattern, str) else pattern.flags)
    letters = "m" + "".join(letter for letter, flag in (("i", re.IGNORECASE), ("s", re.DOTALL)) if flags & flag)
    return re.compile(given, flags), f"(?{letters}){given}"
