"""The connection to a session: lines of JSON-RPC 2.0 with binary frames, over pipes or a socket.

Any number of threads may call at the same time. It has no thread: a caller that waits reads for all.
"""

from __future__ import annotations

import json
import os
import select
import threading
import time
import weakref
from typing import Any, Callable, Optional

from . import arrays, errors

#: Limits of the protocol, in bytes.
LONGEST_LINE, LARGEST_FRAMES = 16 << 20, 1 << 30
CHUNK = 1 << 16
_encode = json.JSONEncoder(separators=(",", ":"), allow_nan=False).encode

_open: weakref.WeakSet[Connection] = weakref.WeakSet()


def _close_in_child() -> None:
    # A forked child must not keep the session's input open: the session ends when its input is closed.
    for connection in list(_open):
        connection.close()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_close_in_child)


class Connection:
    """Requests and answers over two file descriptors, which this object owns.

    timeout: host seconds that an answer may take, None for any time. log: gives the session's stderr for messages.
    """

    def __init__(
        self,
        reading: int,
        writing: int,
        *,
        timeout: Optional[float] = None,
        log: Callable[[], str] = str,
    ) -> None:
        self.timeout = timeout
        self._reading, self._writing, self._log = reading, writing, log
        self._buffer = bytearray()
        self._next = 0
        self._answers: dict[int, Any] = {}
        self._awaited: set[int] = set()
        self._reader_busy = False
        self._failure: Optional[str] = None
        self._changed = threading.Condition()
        self._sending = threading.Lock()
        _open.add(self)

    @property
    def usable(self) -> bool:
        """False once the session ended or the connection was closed."""
        return self._failure is None

    def call(self, method: str, params: dict[str, Any], outgoing: Optional[arrays.Outgoing] = None) -> Any:
        """The result of a request. Raises the exception of errors.py that its error stands for."""
        __tracebackhide__ = True
        return self.wait(self.send(method, params, outgoing))

    def send(self, method: str, params: dict[str, Any], outgoing: Optional[arrays.Outgoing] = None) -> int:
        """Sends a request and returns its number, for wait()."""
        frames = outgoing.frames if outgoing else []
        with self._changed:
            self._next += 1
            number = self._next
            self._awaited.add(number)
        message: dict[str, Any] = {"jsonrpc": "2.0", "id": number, "method": method, "params": params}
        if frames:
            message["frames"] = [len(frame) for frame in frames]
        try:
            text = _encode(message)
        except (TypeError, ValueError) as error:
            self.forget(number)
            raise errors.RequestError(f"{method}: a parameter cannot be sent: {error}.", -32602) from None
        data = b"".join([text.encode(), b"\n", *frames])
        with self._sending:
            if self._failure is not None:
                raise errors.SessionError(self._failure)
            try:
                view = memoryview(data)
                while view:
                    view = view[os.write(self._writing, view) :]
            except OSError as error:
                raise self._fail(f"The session does not take requests any more ({error.strerror}).") from None
        return number

    def wait(self, number: int) -> Any:
        """The result of a request that was sent. Interrupted by KeyboardInterrupt, it may be called again."""
        __tracebackhide__ = True
        deadline = None if self.timeout is None else time.monotonic() + self.timeout
        while True:
            with self._changed:
                while number not in self._answers and self._failure is None and self._reader_busy:
                    self._changed.wait()
                if number in self._answers:
                    self._awaited.discard(number)
                    answer = self._answers.pop(number)
                    break
                if self._failure is not None:
                    raise errors.SessionError(self._failure)
                self._reader_busy = True
            try:
                self._read_answer(deadline)
            finally:
                with self._changed:
                    self._reader_busy = False
                    self._changed.notify_all()
        if isinstance(answer, errors.CapsocError):
            raise answer
        return answer

    def forget(self, number: int) -> None:
        """Its answer will be dropped."""
        with self._changed:
            self._awaited.discard(number)
            self._answers.pop(number, None)

    def close(self) -> None:
        """Closes both descriptors; the session, or its part for this client, ends. May be called twice."""
        self._failure = self._failure or "The session was closed; start another one."
        descriptors, self._reading, self._writing = {self._reading, self._writing}, -1, -1
        for descriptor in descriptors - {-1}:
            os.close(descriptor)

    def _fail(self, message: str, kind: type[errors.SessionError] = errors.SessionError) -> errors.SessionError:
        self._failure = self._failure or errors.with_tail(message, self._log())
        return kind(self._failure)

    def _read_answer(self, deadline: Optional[float]) -> None:
        """Reads one message and files its answer. What an exception interrupts stays in the buffer."""
        end = self._fill_line(deadline)
        try:
            line = self._buffer[:end].decode()
            message = json.loads(line)
            sizes = message.get("frames", [])
            if not isinstance(sizes, list) or not all(type(size) is int and size >= 0 for size in sizes):
                raise ValueError("its frames are no list of sizes")
            if sum(sizes) > LARGEST_FRAMES:
                raise ValueError(f"its frames have more than {LARGEST_FRAMES} bytes")
        except (ValueError, AttributeError, RecursionError) as error:
            shown = bytes(self._buffer[: min(end, 80)])
            raise self._fail(f"The session sent a damaged answer ({error}): {shown!r}") from None
        self._fill(end + sum(sizes), deadline)
        frames, begin = [], end
        for size in sizes:
            frames.append(self._buffer[begin : begin + size])
            begin += size
        del self._buffer[:begin]
        self._file(message, frames, '"frame"' in line)

    def _file(self, message: dict[str, Any], frames: list[bytearray], has_arrays: bool) -> None:
        number = message.get("id")
        answer: Any
        if "error" in message:
            answer = errors.from_answer(message["error"])
            if number is None:  # the session could not read a request: which one, it does not know
                raise self._fail(str(answer))
        elif "result" in message and isinstance(number, int):
            try:
                answer = arrays.decode(message["result"], frames) if has_arrays else message["result"]
            except errors.SessionError as error:
                raise self._fail(str(error)) from None
        else:
            raise self._fail(f"The session sent an answer without a result: {str(message)[:80]}")
        with self._changed:
            if number in self._awaited:
                self._answers[number] = answer

    def _fill_line(self, deadline: Optional[float]) -> int:
        """Length of the buffer's first line with its end."""
        searched = 0
        while (found := self._buffer.find(b"\n", searched)) < 0:
            searched = len(self._buffer)
            if searched > LONGEST_LINE:
                raise self._fail(f"The session sent a line of more than {LONGEST_LINE} bytes.")
            self._fill(searched + 1, deadline)
        return found + 1

    def _fill(self, size: int, deadline: Optional[float]) -> None:
        """Reads until the buffer has `size` bytes or more."""
        while len(self._buffer) < size:
            if deadline is not None:
                poll = select.poll()
                poll.register(self._reading, select.POLLIN)
                if not poll.poll(max(0.0, deadline - time.monotonic()) * 1000):
                    raise self._fail(f"The session did not answer within {self.timeout:g} s.", errors.AnswerTimeout)
            try:
                data = os.read(self._reading, max(CHUNK, min(size - len(self._buffer), 2 * CHUNK)))
            except OSError as error:
                raise self._fail(f"The session cannot be read ({error.strerror}).") from None
            if not data:
                raise self._fail("The session has ended.")
            self._buffer += data
