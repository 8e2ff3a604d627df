"""A session: the process `capsoc serve`, which owns clients and files and runs each simulation in a worker process."""

from __future__ import annotations

import atexit
import os
import socket as sockets
import subprocess
import tempfile
import threading
from types import TracebackType
from typing import IO, Any, Optional, Union

from . import arrays, errors
from .connection import Connection
from .program import Place, find_firmware, find_program
from .sensor import Sensor, Setting, settings_of
from .simulation import Simulation

PROTOCOL = 1


class Session:
    """Starts `capsoc serve`, or connects to one that listens.

    program: the file `capsoc` (see find_program). socket: path of the Unix socket of a session that runs. port, token:
    of one that listens on the loopback interface. timeout: host seconds that any answer may take, None for any time.
    Raises ProgramNotFound or SessionError.

    Close it, or use it in a `with` statement. Its simulations end with it, and both end with this interpreter, however
    that ends: the session sees the end of its input.
    """

    def __init__(
        self,
        program: Optional[Place] = None,
        *,
        socket: Optional[Place] = None,
        port: Optional[int] = None,
        token: str = "",
        timeout: Optional[float] = None,
    ) -> None:
        self.process: Optional[subprocess.Popen[bytes]] = None
        self._stderr: Optional[IO[bytes]] = None
        self._last_log = ""
        self.program = None if socket is not None or port is not None else find_program(program)
        if self.program is not None:
            reading, writing = self._start(timeout)
        else:
            reading = writing = _connect(socket, port, timeout)
        self.connection = Connection(reading, writing, timeout=timeout, log=self.log)
        try:
            if port is not None:
                self.call("session.authenticate", token=token)
            self.about: dict[str, Any] = self.call("session.about")
            if self.about.get("protocol") != PROTOCOL:
                raise errors.SessionError(
                    f"The session speaks version {self.about.get('protocol')} of the protocol, this package "
                    f"{PROTOCOL}. Use the package that comes with the program."
                )
        except BaseException:
            self.close()
            raise

    def _start(self, timeout: Optional[float]) -> tuple[int, int]:
        self._stderr = tempfile.TemporaryFile(prefix="capsoc-")  # has no name: nothing is left behind
        try:
            self.process = subprocess.Popen(
                [str(self.program), "serve"],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=self._stderr,
                bufsize=0,
                # Ctrl-C is this interpreter's: it interrupts the simulation, not the session.
                start_new_session=True,
            )
        except OSError as error:
            raise errors.ProgramNotFound(f"{self.program}: cannot be started ({error.strerror}).") from None
        assert self.process.stdin is not None and self.process.stdout is not None
        # The connection owns its own descriptors, and closes them.
        reading, writing = os.dup(self.process.stdout.fileno()), os.dup(self.process.stdin.fileno())
        self.process.stdin.close()
        self.process.stdout.close()
        return reading, writing

    def call(self, method: str, outgoing: Optional[arrays.Outgoing] = None, /, **params: Any) -> Any:
        """The result of a request of the protocol (docs/reference/protocol.md), for what has no method here."""
        __tracebackhide__ = True
        return self.connection.call(method, params, outgoing)

    @property
    def alive(self) -> bool:
        """Whether the session takes requests."""
        return self.connection.usable and (self.process is None or self.process.poll() is None)

    def log(self) -> str:
        """The last 64 KiB of what the session and its simulations wrote on standard error; "" for a socket's."""
        if self._stderr is None:
            return self._last_log
        descriptor = self._stderr.fileno()
        size = os.fstat(descriptor).st_size
        return os.pread(descriptor, 1 << 16, max(0, size - (1 << 16))).decode(errors="replace")

    def schema(self) -> dict[str, Any]:
        """All methods with their parameters and results, as the session describes them."""
        return dict(self.call("session.schema"))

    def run(
        self,
        elf: Place = "selfcal.elf",
        sensor: Union[None, Sensor, Place] = None,
        *,
        backend: Optional[str] = None,
        program: Optional[dict[str, Setting]] = None,
        settings: Optional[dict[str, Setting]] = None,
    ) -> Simulation:
        """A simulation at time 0, before the program's first instruction.

        elf: a file, or the name of a program that comes with capsoc. sensor: a Sensor, or the file of a description or
        recording. backend: of the coprocessor, "tlm", "rtl" or "lockstep". program: settings of the program, as
        `capsoc run -P` takes them. settings: any other settings of `capsoc run --list-params`. Raises SimulationError
        for what is refused.
        """
        chosen: dict[str, Setting] = {"firmware.elf": find_firmware(elf, self.program), **settings_of(sensor)}
        if backend is not None:
            chosen["coprocessor.backend"] = backend
        chosen.update({f"program.{name}": value for name, value in (program or {}).items()})
        chosen.update(settings or {})
        answer = self.call("simulation.construct", settings=chosen)
        return Simulation(self, answer["simulation"], answer["state"], os.path.basename(str(chosen["firmware.elf"])))

    def replay(self, file: Place, *, settings: Optional[dict[str, Setting]] = None) -> Simulation:
        """A simulation at time 0 that repeats a recorded session (Simulation.record(), capsoc run --record-session):
        each input comes at its instant, until another one is given. settings: these come over the recorded ones."""
        path = os.path.abspath(os.fspath(file))
        answer = self.call("simulation.construct", session=path, settings=settings or {})
        return Simulation(self, answer["simulation"], answer["state"], os.path.basename(path))

    def close(self) -> None:
        """Ends the session and its simulations. May be called twice."""
        connection: Optional[Connection] = getattr(self, "connection", None)
        if connection is not None:
            connection.close()
        if self.process is not None and self.process.poll() is None:
            try:
                self.process.wait(timeout=10)
            except subprocess.TimeoutExpired:
                self.process.kill()
                self.process.wait()
        if self._stderr is not None:
            self._last_log = self.log()
            self._stderr.close()
            self._stderr = None

    def __enter__(self) -> Session:
        return self

    def __exit__(
        self, kind: Optional[type[BaseException]], error: Optional[BaseException], trace: Optional[TracebackType]
    ) -> None:
        self.close()

    def __repr__(self) -> str:
        where = f"process {self.process.pid}" if self.process is not None else "socket"
        return f"<capsoc.Session {where}{'' if self.alive else ', ended'}>"


def _connect(path: Optional[Place], port: Optional[int], timeout: Optional[float]) -> int:
    address: Union[str, tuple[str, Optional[int]]] = ("127.0.0.1", port) if path is None else str(path)
    family = sockets.AF_INET if path is None else sockets.AF_UNIX
    connecting = sockets.socket(family, sockets.SOCK_STREAM)
    try:
        connecting.settimeout(timeout)
        connecting.connect(address)
        connecting.settimeout(None)
    except OSError as error:
        connecting.close()
        raise errors.SessionError(f"No session listens on {path or port} ({error.strerror or error}).") from None
    return connecting.detach()


_default: Optional[Session] = None
_default_of = 0
_default_lock = threading.Lock()


def default_session() -> Session:
    """The session of this process, which is started when it is first needed and ends with the interpreter."""
    global _default, _default_of
    with _default_lock:
        if _default is None or _default_of != os.getpid() or not _default.alive:
            _default, _default_of = Session(), os.getpid()
            atexit.register(_default.close)
        return _default


def run(elf: Place = "selfcal.elf", sensor: Union[None, Sensor, Place] = None, **options: Any) -> Simulation:
    """A simulation in the session of this process; the arguments are those of Session.run()."""
    return default_session().run(elf, sensor, **options)


def replay(file: Place, **options: Any) -> Simulation:
    """A recorded session again, in the session of this process; the arguments are those of Session.replay()."""
    return default_session().replay(file, **options)
