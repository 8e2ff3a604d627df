"""A UART of the simulation, seen from outside: what the program sends and what it receives."""

from __future__ import annotations

import re
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

    def __init__(self, text: str, groups: tuple[Optional[str], ...], before: str) -> None:
        self.text, self.before = text, before
        self._groups = groups

    def groups(self) -> tuple[Optional[str], ...]:
        """All groups, None for those that took no part."""
        return self._groups

    def group(self, number: int = 0) -> Optional[str]:
        """The text (0) or a group, as re.Match.group()."""
        return ((self.text,) + self._groups)[number]

    __getitem__ = group

    def __repr__(self) -> str:
        return f"<Match {self.text!r} {self._groups}>"


class Uart:
    """UART 0 to 4. Text is UTF-8; bytes that are not are replaced by U+FFFD."""

    def __init__(self, simulation: Simulation, number: int) -> None:
        self._simulation, self.number = simulation, number
        self._text = ""
        self._seen = 0  # characters up to the end of the last match

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

        within: limit in simulated seconds. `^` and `$` are also the ends of lines. Use what Python and RE2 have in
        common. Raises ExpectationError, with the text that was seen, if the limit or the program's end comes first.
        """
        expression, text = _compiled(pattern)
        if found := self._search(expression):
            return found
        stop = self._simulation.until(uart=(self.number, text), within=within)
        if found := self._search(expression):
            return found
        if stop.reason == "uart":
            return self._found_by_session(stop.match or {})
        raise self._unmet(text, within, stop)

    def _search(self, expression: re.Pattern[str]) -> Optional[Match]:
        text = self.text
        found = expression.search(text, self._seen)
        if found is None:
            return None
        before = text[self._seen : found.start()]
        self._seen = found.end()
        return Match(found.group(), found.groups(), before)

    def _found_by_session(self, match: dict[str, Any]) -> Match:
        # RE2 found what Python's expressions do not: the session's word counts.
        before, self._seen = self._text[self._seen :], len(self._text)
        return Match(str(match.get("text", "")), tuple(match.get("groups", ())), before)

    def _unmet(self, pattern: str, within: float, stop: Stop) -> ExpectationError:
        unseen = self._text[self._seen :]
        lines = self._text.splitlines()[-SHOWN_LINES:]
        state = stop.state
        why = {
            "over": "before the program ended",
            "interrupted": "before it was interrupted",
        }.get(stop.reason, f"within {within:g} simulated s")
        shown = "\n".join(["", *(f"  | {line}" for line in lines)]) if lines else " It sent nothing."
        message = (
            f"UART {self.number} did not send {pattern!r} {why}: it is {state.time_s:.6f} s and the program is at "
            f"{state.place or hex(state.pc)}. "
        )
        if lines:
            message += f"The last {len(lines)} lines:"
        return ExpectationError(message.rstrip() + shown, unseen, state.time_s, state.place)

    def _copy(self) -> tuple[str, int]:
        """What belongs to the simulation's state on this side: text and position."""
        return self._text, self._seen

    def _set(self, copy: tuple[str, int]) -> None:
        self._text, self._seen = copy

    def __repr__(self) -> str:
        return f"<UART {self.number}: {len(self._text)} characters>"


def _compiled(pattern: Union[str, re.Pattern[str]]) -> tuple[re.Pattern[str], str]:
    """An expression for the text here, and its text for the session, with the flags that both sides know."""
    if isinstance(pattern, str):
        return re.compile(pattern, re.MULTILINE), pattern
    flags = "".join(letter for letter, flag in (("i", re.IGNORECASE), ("s", re.DOTALL)) if pattern.flags & flag)
    text = f"(?{flags}){pattern.pattern}" if flags else pattern.pattern
    return re.compile(pattern.pattern, pattern.flags | re.MULTILINE), text
