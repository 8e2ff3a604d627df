#!/usr/bin/python3
"""Hostile clients of a session: requests that are drawn, damaged, reordered and cut off end nothing else.

The session belongs to its own user, who may write in one folder: what that user owns outside is a failure. The
kernel kills a process of the session that starts a program. A build of the preset `sanitize` reports what the memory
checkers see:

    cmake --preset sanitize && cmake --build build-sanitize --target capsoc firmware
    export CAPSOC_TEST_BUILD=build-sanitize PYTHONPATH=tests
    CAPSOC_HOSTILE_MESSAGES=100000 python3 tests/service/hostile_test.py Files Some

`Many` sends 100,000 whatever that says. Under the sanitizers they take ten minutes, and 10,000 files four.
"""

import collections
import ctypes
import hashlib
import json
import os
import platform
import random
import resource
import signal
import socket
import struct
import subprocess
import time
import unittest
from pathlib import Path

from harness import CAPSOC, CLEAN, FIRMWARE, Case

CTEST = {"name": "service: hostile", "timeout": 3000, "interpreter": "/usr/bin/python3", "long": ["Many"]}

MESSAGES = int(os.environ.get("CAPSOC_HOSTILE_MESSAGES", "3000"))
SEED = int(os.environ.get("CAPSOC_HOSTILE_SEED", "20261127"))
#: No user of a Debian system has it. Each process has its own: several of these tests may run at once.
USER = 60_600 + os.getpid() % 500
#: execve and execveat, and the audit architecture, by machine (linux/audit.h, asm/unistd.h).
MACHINES = {"x86_64": (59, 322, 0xC000003E), "aarch64": (221, 281, 0xC00000B7)}
PROGRAMS = ("selfcal", "echo", "hello", "newlib")
WORDS = (
    "",
    "main",
    "samples",
    "state.turns",
    "COPROCESSOR.CTRL.ENABLE",
    "UART0.DATA",
    "$pc",
    "r3",
    "step",
    "run",
    "angle",
)
WORDS += (
    "x" * 3000,
    "..",
    "../../etc/passwd",
    "../beside",
    "file:../beside",
    "inside",
    "\u0000",
    "\u202e",
    "first[",
    "flip coprocessor.cv[39]",
    "HardFault",
    "*p->q",
)
#: They end what the others need, or start up to 1000 processes if a digit more is there.
LEFT_OUT = {"session.end", "simulation.clone"}
#: They end what the next ones need: drawn seldom.
SELDOM = {"simulation.close", "simulation.finish", "debugger.kill", "simulation.restore"}
ENDS = ("ended by signal", "ended by itself", "internal error")


class Sockets:
    """A client that never waits longer than a second."""

    def __init__(self, path):
        self.socket = socket.socket(socket.AF_UNIX)
        self.socket.settimeout(60)
        # A session takes clients of its own user alone.
        user = os.geteuid()
        os.seteuid(path.stat().st_uid)
        self.socket.connect(str(path))
        os.seteuid(user)
        self.received = b""

    def send(self, data):
        """Sends what is taken; False: the session has closed the connection."""
        try:
            self.socket.sendall(data)
        except (BrokenPipeError, ConnectionResetError):
            return False
        return True

    def answers(self, until, longest):
        """Reads until an answer has the id `until`, the session closes, or nothing comes within `longest` seconds."""
        self.socket.settimeout(longest)
        while True:
            while b"\n" in self.received:
                line, rest = self.received.split(b"\n", 1)
                answer = json.loads(line)
                size = sum(answer.get("frames", []))
                if len(rest) < size:
                    break
                self.received = rest[size:]
                yield answer
                if answer["id"] == until:
                    return
            try:
                data = self.socket.recv(1 << 20)
            except (TimeoutError, ConnectionResetError):
                return
            if not data:
                return
            self.received += data

    def ask(self, method, **params):
        """The answer to a request of a client that is not hostile."""
        request = {"jsonrpc": "2.0", "id": "call", "method": method, "params": params}
        self.send(json.dumps(request).encode() + b"\n")
        for answer in self.answers("call", 60):
            if answer["id"] == "call":
                return answer
        raise AssertionError(f"no answer to {method}")

    def call(self, method, **params):
        """Its result."""
        answer = self.ask(method, **params)
        assert "result" in answer, answer
        return answer["result"]


def forbid_programs():
    """This process and its children are killed if they call execve(); what starts them calls execveat()."""
    execve, _, architecture = MACHINES[platform.machine()]
    code = [  # linux/filter.h: of struct seccomp_data the architecture, then the number
        (0x20, 0, 0, 4),
        (0x15, 0, 2, architecture),
        (0x20, 0, 0, 0),
        (0x15, 1, 0, execve),
        (0x06, 0, 0, 0x7FFF0000),  # SECCOMP_RET_ALLOW
        (0x06, 0, 0, 0x80000000),  # SECCOMP_RET_KILL_PROCESS
    ]
    code = b"".join(struct.pack("HBBI", *each) for each in code)
    buffer = ctypes.create_string_buffer(code)
    program = struct.pack("HxxxxxxP", len(code) // 8, ctypes.addressof(buffer))
    libc = ctypes.CDLL(None, use_errno=True)
    if libc.prctl(38, 1, 0, 0, 0) != 0 or libc.prctl(22, 2, program, 0, 0) != 0:  # PR_SET_NO_NEW_PRIVS, PR_SET_SECCOMP
        raise OSError(ctypes.get_errno(), "seccomp")


def start_program(words, environment):
    """Becomes a program by execveat()."""
    arguments = (ctypes.c_char_p * (len(words) + 1))(*[os.fsencode(word) for word in words], None)
    variables = [os.fsencode(f"{name}={value}") for name, value in environment.items()]
    ctypes.CDLL(None).syscall(
        MACHINES[platform.machine()][1],
        -100,
        arguments[0],
        arguments,
        (ctypes.c_char_p * (len(variables) + 1))(*variables, None),
        0,
    )
    os._exit(127)


class Hostile(Case):
    """A session with its own folder, and what must hold after a storm."""

    def setUp(self):
        super().setUp()
        self.own = self.folder / "own"
        self.own.mkdir()
        (self.own / "tmp").mkdir()
        self.folder.chmod(0o755)
        self.is_root = os.geteuid() == 0
        if self.is_root:
            for each in (self.own, self.own / "tmp"):
                os.chown(each, USER, USER)
        self.process = os.fork()
        if self.process == 0:
            self.become_the_session()
        self.addCleanup(self.end_session)
        self.path = self.own / "socket"
        deadline = time.monotonic() + 60
        while not self.path.exists() and time.monotonic() < deadline:
            time.sleep(0.02)
        self.tally = collections.Counter()

    def become_the_session(self):
        try:
            os.chdir(self.own)
            error = os.open("stderr", os.O_WRONLY | os.O_CREAT)
            for to in (1, 2):
                os.dup2(error, to)
            if self.is_root:
                os.setgroups([])
                os.setgid(USER)
                os.setuid(USER)
                resource.setrlimit(resource.RLIMIT_NPROC, (100, 100))
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
            forbid_programs()
            said = {
                "TMPDIR": str(self.own / "tmp"),
                "ASAN_OPTIONS": "detect_leaks=0",
                "UBSAN_OPTIONS": "print_stacktrace=1",
            }
            start_program([CAPSOC, "serve", "--socket", "socket"], CLEAN | said)
        finally:
            os._exit(126)

    def end_session(self):
        if self.process:
            os.kill(self.process, signal.SIGKILL)
            os.waitpid(self.process, 0)

    def quiet_run(self):
        """What a simulation says that nothing disturbs."""
        client = Sockets(self.path)
        number = client.call("simulation.construct", settings={"firmware.elf": str(FIRMWARE / "hello.elf")})[
            "simulation"
        ]
        end = client.call("simulation.advance", simulation=number, seconds=0.05)
        text = client.call("uart.read", simulation=number, uart=0, raw=False)
        client.socket.close()
        return end, text["text"]

    def outside(self):
        """What the session's user has left where it should not."""
        left = sorted(each.name for each in self.folder.iterdir() if each != self.own)
        if self.is_root:
            places = ["/tmp", "/var/tmp", "/dev/shm", str(FIRMWARE)]
            found = subprocess.run(
                ["find", *places, "-xdev", "-path", str(self.own), "-prune", "-o", "-uid", str(USER), "-print"],
                capture_output=True,
                text=True,
                check=False,
            )
            left += found.stdout.splitlines()
        return left

    def check_what_is_left(self, before):
        """The session is well, and nothing was seen of its memory checkers; it ends by itself."""
        self.assertEqual(self.quiet_run(), before)
        client = Sockets(self.path)
        client.call("session.end")
        client.socket.close()
        _, status = os.waitpid(self.process, 0)
        self.process = 0
        said = (self.own / "stderr").read_text(encoding="utf-8", errors="replace")
        self.assertNotRegex(said, "Sanitizer|runtime error|internal error", f"seed {SEED}")
        self.assertEqual(os.waitstatus_to_exitcode(status), 0, said[-2000:])
        self.assertEqual(self.outside(), [], f"seed {SEED}")

    # What is sent.

    def any_value(self, draw, depth=0):
        kinds = [
            lambda: draw.randint(-5, 300),
            lambda: draw.choice([0, 1, 2**32, 2**53, 2**63, -(2**40), 1e308, -0.5]),
            lambda: draw.choice(WORDS),
            lambda: draw.choice([True, False, None]),
            lambda: {"uart": self.any_value(draw, 3), "pattern": draw.choice(["(", "a+", "", "(a*)*b"])},
            lambda: {"text": draw.choice(["samples > 3", "1/", "$pc"]), "every_s": draw.choice([0.001, -1, "x"])},
            lambda: {"frame": draw.randint(0, 3), "type": draw.choice(["<f8", "|u1", "O8"]), "shape": [1]},
            lambda: {draw.choice(["time_s", "instructions", "sample", "profile"]): self.any_value(draw, 3)},
            lambda: [self.any_value(draw, depth + 1) for _ in range(draw.randint(0, 4))] if depth < 3 else [],
        ]
        return draw.choice(kinds)()

    def likely_value(self, draw, parameter):
        """One of the right type."""
        return {
            "integer": lambda: draw.choice([0, 1, 2, 4, 100, 4096]),
            "number": lambda: draw.choice([0, 0.001, 0.01, 1.0]),
            "text": lambda: draw.choice(WORDS),
            "boolean": lambda: draw.random() < 0.5,
            "address": lambda: draw.choice(["main", 0, 0x20000000, 0x40004000, 0xE000ED00, 2**32 - 4]),
            "object": lambda: {"time_s": draw.choice([0, 0.001])},
            "list": lambda: [draw.choice(["sample", "interrupt", "fault", "u", "x"])],
            "array": lambda: [0.5, -0.25],
            "bytes": lambda: draw.choice(["abc", [1, 2, 255], {"frame": 0, "type": "|u1", "shape": [5]}]),
        }.get(parameter["type"], lambda: self.any_value(draw))()

    def request(self, draw, methods, number, simulation):
        """A request with its frames; three in four might be meant."""
        method = draw.choice(methods)
        if method["name"] in SELDOM:
            method = draw.choice(methods)
        likely = draw.random() < 0.75
        params = {
            each["name"]: self.likely_value(draw, each) if likely else self.any_value(draw)
            for each in method["params"]
            if each["required"] or draw.random() < 0.3
        }
        if method["simulation"]:
            params["simulation"] = simulation if draw.random() < 0.95 else draw.randint(0, simulation + 1)
        if method["name"] == "simulation.construct":
            params = {"settings": {"firmware.elf": str(FIRMWARE / f"{draw.choice(PROGRAMS)}.elf")}}
            params["settings"][
                draw.choice(["history_mb", "gdb.port", "uart0.backend", "trace.waves", "x"])
            ] = self.any_value(draw)
        if method["name"] == "simulation.advance" and likely:
            params["within_s"] = 0.01
        message = {"jsonrpc": "2.0", "id": number, "method": method["name"], "params": params}
        frames = [bytes(draw.randrange(256) for _ in range(draw.choice([0, 5, 8, 300])))] if draw.random() < 0.2 else []
        if frames:
            message["frames"] = [len(frame) for frame in frames]
        return json.dumps(message).encode() + b"\n" + b"".join(frames)

    @staticmethod
    def damaged(draw, data):
        """Bytes changed, taken, put in, doubled, or cut off."""
        data = bytearray(data)
        for _ in range(draw.choice([1, 1, 1, 2, 3, 10])):
            at = draw.randrange(len(data) or 1)
            kind = draw.randrange(6)
            if kind == 0 and data:
                data[at] ^= 1 << draw.randrange(8)
            elif kind == 1:
                del data[at : at + draw.randint(1, 9)]
            elif kind == 2:
                data[at:at] = draw.choice(
                    [b"{", b"}", b"[", b"]", b'"', b",", b":", b"\n", b"\x00", b"\xff\xfe", b"9", b"e"]
                )
            elif kind == 3:
                data[at:at] = data[at : at + draw.randint(1, 60)]
            elif kind == 4:
                data[at:at] = draw.choice([b"[" * 70, b'{"a":' * 70, b"1" * 400, b'\\ud800"', b"-", b'"frames": [9],'])
            elif draw.random() < 0.2:
                del data[at:]
        return bytes(data)

    def storm(self, messages):
        """Sends this number of messages by clients that come and go."""
        draw = random.Random(SEED)
        first = Sockets(self.path)
        methods = [each for each in first.call("session.schema")["methods"] if each["name"] not in LEFT_OUT]
        first.socket.close()
        before, sent = self.quiet_run(), 0
        while sent < messages:
            client = Sockets(self.path)
            construction = {
                "settings": {"firmware.elf": str(FIRMWARE / f"{draw.choice(PROGRAMS)}.elf"), "history_mb": 4}
            }
            number = client.call("simulation.construct", **construction)["simulation"]
            for _ in range(draw.randint(1, 12)):
                requests = [self.request(draw, methods, sent + i, number) for i in range(draw.randint(1, 20))]
                requests = [self.damaged(draw, each) if draw.random() < 0.4 else each for each in requests]
                draw.shuffle(requests)
                sent += len(requests)
                last = {"jsonrpc": "2.0", "id": "last", "method": "simulation.state", "params": {"simulation": number}}
                if not client.send(b"".join(requests) + b"\n" + json.dumps(last).encode() + b"\n"):
                    self.tally["closed by the session"] += 1
                    break
                if not self.take_answers(client):
                    break
            client.socket.close()
        print(
            f"seed {SEED}: {sent} messages: " + ", ".join(f"{count} {what}" for what, count in self.tally.most_common())
        )
        return before

    def take_answers(self, client):
        """False: what is sent now would be lost, or waits for a simulation that runs for long."""
        for answer in client.answers("last", 0.5):
            if answer["id"] == "last":
                return True
            self.tally["answers" if "result" in answer else f"errors {answer['error']['code']}"] += 1
            if "error" in answer and any(each in answer["error"]["message"] for each in ENDS):
                self.fail(f"seed {SEED}: {answer}; {(self.own / 'stderr').read_text(errors='replace')[-4000:]}")
        self.tally["left by the client"] += 1
        return False


class Some(Hostile):
    """The number that CAPSOC_HOSTILE_MESSAGES gives."""

    def test_a_storm(self):
        before = self.storm(MESSAGES)
        self.check_what_is_left(before)
        for kind in ("answers", "errors -32700", "errors -32600", "errors -32601", "errors -32602", "errors 1"):
            self.assertGreater(self.tally[kind], MESSAGES // 1000, kind)

    def test_the_guards(self):
        """That a program cannot be started, and that a file outside would be found."""
        child = os.fork()
        if child == 0:
            try:
                forbid_programs()
                os.execv("/bin/true", ["true"])
            finally:
                os._exit(1)
        self.assertEqual(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), -signal.SIGSYS)
        self.assertEqual(self.outside(), [])
        (self.folder / "beside").touch()
        self.assertEqual(self.outside(), ["beside"])
        if self.is_root:
            far = Path(self.folder.parent / f"capsoc-test-{os.getpid()}-outside")
            far.touch()
            self.addCleanup(far.unlink)
            os.chown(far, USER, USER)
            self.assertIn(str(far), self.outside())


class Confined(Hostile):
    """Clients that connect have files written below the session's folder, and in it alone."""

    def refusal(self, method, **params):
        client = Sockets(self.path)
        answer = client.ask(method, **params)
        client.socket.close()
        self.assertIn("error", answer)
        return answer["error"]["message"]

    def construct(self, **settings):
        return {"settings": {"firmware.elf": str(FIRMWARE / "hello.elf"), **settings}}

    def test_no_file_outside(self):
        (self.own / "link").symlink_to(self.folder)
        (self.own / "dangling").symlink_to(self.folder / "beside")
        client = Sockets(self.path)
        number = client.call("simulation.construct", **self.construct())["simulation"]
        client.call("simulation.advance", simulation=number, seconds=0.001)
        for place in ("../beside", str(self.folder / "beside"), "link/beside", "dangling", "tmp/../../beside", "."):
            asked = [
                self.refusal("simulation.save", simulation=number, file=place),
                self.refusal("simulation.record", simulation=number, file=place),
                self.refusal("history.trace", simulation=number, one={"time_s": 0}, files={"instructions": place}),
                self.refusal("simulation.construct", **self.construct(**{"trace.waves": place})),
                self.refusal("simulation.construct", **self.construct(**{"uart0.backend": f"file:{place}"})),
            ]
            for text in asked:
                self.assertRegex(text, f"is not below {self.own}, where clients of this session may write; name a")
        for file in ("inside", "tmp/../tmp/inside", str(self.own / "absolute"), "link/own/linked", "/dev/null"):
            client.call("simulation.save", simulation=number, file=file)
        client.socket.close()
        self.assertEqual(self.outside(), [])

    def test_by_no_setting(self):
        """Any of them, with values that lead outside."""
        listed = subprocess.run([CAPSOC, "run", "--list-params"], capture_output=True, text=True, check=True, env=CLEAN)
        names = [line.split()[0] for line in listed.stdout.splitlines()]
        self.assertIn("semihosting.directory", names)
        refused = set()
        for name in names:
            for value in ("../beside", "file:../beside", "pty:../beside", "../beside@0.001"):
                client = Sockets(self.path)
                settings = {**self.construct()["settings"], "checkpoint.every_s": 0.002, name: value}
                answer = client.ask("simulation.construct", settings=settings)
                if "result" in answer:
                    number = answer["result"]["simulation"]
                    client.call("simulation.advance", simulation=number, seconds=0.01)
                    client.call("simulation.close", simulation=number)
                elif "is not below" in answer["error"]["message"]:
                    refused.add(name)
                client.socket.close()
        self.assertLessEqual(
            {"trace.waves", "checkpoint.prefix", "checkpoint.save", "semihosting.directory", "uart3.backend"}, refused
        )
        self.assertEqual(self.outside(), [])

    def test_no_library(self):
        text = self.refusal("simulation.construct", **self.construct(**{"coprocessor.rtl_library": "/lib/libm.so.6"}))
        self.assertRegex(text, "coprocessor.rtl_library: clients of this session may name no library")


class Many(Hostile):
    """100,000."""

    def test_a_storm(self):
        self.check_what_is_left(self.storm(100_000))


class Files(Hostile):
    """Recorded sessions with other settings, files, inputs and states and the right checksums, one for 10 messages."""

    def recorded(self, last_s):
        """(header, contents of the files, state, inputs) of a session that has something of everything."""
        client = Sockets(self.path)
        settings = {"firmware.elf": str(FIRMWARE / "echo.elf")}
        number = client.call("simulation.construct", settings=settings)["simulation"]
        for method, params in (
            ("uart.send", {"uart": 0, "bytes": "abc"}),
            ("memory.write", {"address": 0x20000000, "bytes": [1, 2, 3]}),
            ("simulation.advance", {"seconds": 0.01}),
            ("history.keep", {}),
            ("sensor.set", {"parameters": {"b1": 0.1}}),
            ("adc.inject", {"u": [0.5, 0.25], "v": [0.5, -0.25]}),
            ("pin.drive", {"gpio": 0, "pin": 3, "level": True}),
            ("processor.write", {"register": "r3", "value": 7}),
            ("fault.inject", {"fault": "flip coprocessor.cv[39]"}),
            ("simulation.advance", {"seconds": 0.01}),
            ("simulation.record", {"file": "a.session", **({} if last_s is None else {"last_s": last_s})}),
        ):
            client.call(method, simulation=number, **params)
        client.socket.close()
        head, rest = (self.own / "a.session").read_bytes().split(b"\n", 1)
        size = int(head.split()[3])
        header, rest = json.loads(rest[:size]), rest[size:]
        files = []
        for each in header["files"]:
            files.append(rest[: each["size"]])
            rest = rest[each["size"] :]
        state = rest[: header.get("state", 0)]
        return header, files, state, rest[len(state) :]

    def replaced(self, draw, value):
        """With another value somewhere."""
        if isinstance(value, dict) and value and draw.random() < 0.9:
            name = draw.choice(list(value))
            return value | {name: self.replaced(draw, value[name])}
        if isinstance(value, list) and value and draw.random() < 0.9:
            at = draw.randrange(len(value))
            return value[:at] + [self.replaced(draw, value[at])] + value[at + 1 :]
        return self.any_value(draw)

    def forged(self, draw, recorded):
        header, files, state, inputs = recorded
        kind = draw.randrange(5)
        header = json.loads(json.dumps(header))
        if kind == 0:
            inputs = self.damaged(draw, inputs)
        elif kind == 1:
            lines = inputs.split(b"\n")
            draw.shuffle(lines)
            inputs = b"\n".join(lines)
        elif kind == 2:
            number = draw.randrange(len(files))
            files = files[:number] + [self.damaged(draw, files[number])] + files[number + 1 :]
        elif kind == 3 and state:
            state = self.damaged(draw, state)
        for each, content in zip(header["files"], files):
            each.update(size=len(content), sha256=hashlib.sha256(content).hexdigest())
        header.update(inputs=len(inputs), inputs_sha256=hashlib.sha256(inputs).hexdigest())
        if state:
            header.update(state=len(state), state_sha256=hashlib.sha256(state).hexdigest())
        if kind == 4:
            header = self.replaced(draw, header)
            if draw.random() < 0.3 and isinstance(header, dict) and isinstance(header.get("settings"), dict):
                name = draw.choice(
                    ["trace.waves", "uart0.backend", "coprocessor.rtl_library", "limits.simulated_s", "x"]
                )
                header["settings"][name] = draw.choice(
                    ["../beside", "file:../beside", str(self.folder / "beside"), "1"]
                )
        text = json.dumps(header).encode()
        return (
            f"capsoc session 1 {len(text)} {hashlib.sha256(text).hexdigest()}\n".encode()
            + text
            + b"".join([*files, state, inputs])
        )

    def test_forged_ones(self):
        before, draw = self.quiet_run(), random.Random(SEED)
        originals = [self.recorded(None), self.recorded(0.005)]
        self.assertTrue(originals[1][2])
        client = Sockets(self.path)
        for number in range(MESSAGES // 10):
            (self.own / "b.session").write_bytes(self.forged(draw, draw.choice(originals)))
            request = {"jsonrpc": "2.0", "id": 1, "method": "simulation.construct", "params": {"session": "b.session"}}
            client.send(json.dumps(request).encode() + b"\n")
            answer = list(client.answers(1, 60))[-1]
            if "result" in answer:
                simulation = answer["result"]["simulation"]
                request.update(method="simulation.goto", params={"simulation": simulation, "time_s": 0.02})
                client.send(json.dumps(request).encode() + b"\n")
                answer = list(client.answers(1, 60))[-1]
                self.tally["constructed"] += 1
                if answer.get("error", {}).get("code") != 2:
                    client.call("simulation.close", simulation=simulation)
            self.tally["answers" if "result" in answer else f"errors {answer['error']['code']}"] += 1
            self.assertFalse(
                "error" in answer and any(each in answer["error"]["message"] for each in ENDS),
                f"seed {SEED}, file {number}: {answer}",
            )
        print(f"seed {SEED}: {dict(self.tally)}")
        client.socket.close()
        self.assertGreater(self.tally["constructed"], MESSAGES // 100)
        self.assertGreater(self.tally["errors 1"], MESSAGES // 100)
        self.check_what_is_left(before)


if __name__ == "__main__":
    unittest.main()
