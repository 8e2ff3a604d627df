#!/usr/bin/python3
"""The Python package's connection: frames, damaged answers, sessions that die or hang, several threads."""

import array
import json
import os
import signal
import subprocess
import sys
import threading
import time
import unittest
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from harness import SOURCE, Case

sys.path[:0] = [str(SOURCE / "platform" / "python"), str(Path(__file__).parent)]

import fake_session  # noqa: E402
from capsoc import Session, SessionError, SimulationEnded, arrays, errors  # noqa: E402
from capsoc.connection import Connection  # noqa: E402

CTEST = {"name": "python connection", "interpreter": "/usr/bin/python3"}


class Pipes(Case):
    """A connection whose other end is the test's."""

    def setUp(self):
        super().setUp()
        reading, self.answers = os.pipe()
        self.requests, writing = os.pipe()
        self.connection = Connection(reading, writing, timeout=5)
        self.addCleanup(self.connection.close)
        self.addCleanup(os.close, self.requests)
        self.addCleanup(lambda: self.answers is None or os.close(self.answers))

    def hang_up(self):
        os.close(self.answers)
        self.answers = None

    def answer(self, *parts):
        """Writes raw bytes, in the background as far as the pipe does not take them."""
        threading.Thread(target=lambda: [os.write(self.answers, part) for part in parts], daemon=True).start()

    def requested(self):
        return os.read(self.requests, 1 << 20)


class Framing(Pipes):
    def test_a_request_is_a_line_and_its_frames(self):
        outgoing = arrays.Outgoing()
        value = outgoing.add_doubles([0.5, -1])
        self.connection.send("adc.inject", {"simulation": 1, "u": value}, outgoing)
        line, _, frames = self.requested().partition(b"\n")
        self.assertEqual(
            json.loads(line),
            {
                "jsonrpc": "2.0",
                "id": 1,
                "method": "adc.inject",
                "params": {"simulation": 1, "u": {"frame": 0, "type": "<f8", "shape": [2]}},
                "frames": [16],
            },
        )
        self.assertEqual(frames, array.array("d", [0.5, -1]).tobytes())

    def test_frames_become_arrays(self):
        result = {
            "t": {"frame": 1, "type": "<f8", "shape": [2]},
            "nested": [{"frame": 0, "type": "<i4", "shape": [1]}],
            "bytes": {"frame": 2, "type": "<u1", "shape": [3]},
        }
        line = json.dumps({"id": 1, "result": result, "frames": [4, 16, 3]}).encode() + b"\n"
        data = line + b"\xff\xff\xff\xff" + array.array("d", [1.5, 2.5]).tobytes() + b"\n{}"
        self.answer(*(data[i : i + 1] for i in range(len(data))))  # byte by byte
        got = self.connection.call("m", {})
        self.assertEqual((list(got["t"]), list(got["nested"][0]), got["bytes"]), ([1.5, 2.5], [-1], b"\n{}"))

    def test_arrays_without_numpy(self):
        numpy, arrays.numpy = arrays.numpy, None
        self.addCleanup(setattr, arrays, "numpy", numpy)
        got = arrays.decode({"frame": 0, "type": "<u4", "shape": [2]}, [bytearray(b"\1\0\0\0\0\1\0\0")])
        self.assertEqual(got, array.array("I", [1, 256]))

    def test_answers_out_of_order(self):
        first, second = (self.connection.send("m", {"n": n}) for n in (1, 2))
        self.answer(b'{"id":2,"result":"b"}\n{"id":77,"result":"not asked"}\n{"id":1,"result":"a"}\n')
        self.assertEqual([self.connection.wait(first), self.connection.wait(second)], ["a", "b"])
        self.assertEqual(self.connection._answers, {})  # what was not asked for is not kept

    def test_a_million_samples(self):
        values = array.array("d", range(1_000_000))
        line = b'{"id":1,"result":{"frame":0,"type":"<f8","shape":[1000000]},"frames":[8000000]}\n'
        data = values.tobytes()
        self.answer(line, *(data[i : i + 65536] for i in range(0, len(data), 65536)))
        begin = time.monotonic()
        got = self.connection.call("samples.read", {})
        self.assertLess(time.monotonic() - begin, 1)
        self.assertEqual((len(got), got[999_999]), (1_000_000, 999_999))

    def test_what_cannot_be_sent_is_refused_and_nothing_else_happens(self):
        for value in (float("nan"), object(), {1, 2}):
            with self.assertRaisesRegex(errors.RequestError, "m: a parameter cannot be sent"):
                self.connection.call("m", {"value": value})
        self.answer(b'{"id":4,"result":5}\n')
        self.assertEqual(self.connection.call("m", {}), 5)


class Errors(Pipes):
    def raised(self, code, message="a sentence"):
        number = self.connection.send("m", {})
        self.answer(
            json.dumps({"id": number, "error": {"code": code, "message": message, "data": [1]}}).encode() + b"\n"
        )
        with self.assertRaises(errors.CapsocError) as raised:
            self.connection.wait(number)
        self.assertEqual((str(raised.exception), raised.exception.data), (message, [1]))
        self.assertEqual(raised.exception.code, code)
        return type(raised.exception)

    def test_each_code_has_its_exception(self):
        kinds = {
            -32601: errors.RequestError,
            -32602: errors.RequestError,
            1: errors.SimulationError,
            2: errors.SimulationEnded,
            3: errors.SimulationOver,
            99: errors.SimulationError,
        }
        self.assertEqual({code: self.raised(code) for code in kinds}, kinds)
        self.assertTrue(self.connection.usable)


class Damage(Pipes):
    """Each ends the connection with a sentence, and the next call gets that sentence, too."""

    CASES = {
        b"no json\n": "damaged answer",
        b"[1]\n": "damaged answer",
        b"\xff\xfe\n": "damaged answer",
        b"[" * 100000 + b"\n": "damaged answer",
        b'{"id":1}\n': "without a result",
        b'{"id":"x","result":1}\n': "without a result",
        b'{"id":null,"error":{"code":-32700,"message":"cannot be read"}}\n': "cannot be read",
        b'{"id":1,"result":1,"frames":[-1]}\n': "no list of sizes",
        b'{"id":1,"result":1,"frames":"x"}\n': "no list of sizes",
        b'{"id":1,"result":1,"frames":[1e3]}\n': "no list of sizes",
        b'{"id":1,"result":1,"frames":[2000000000]}\n': "more than 1073741824 bytes",
        b'{"id":1,"result":{"frame":0,"type":"<f8"}}\n': "named frame 0, but the answer has 0",
        b'{"id":1,"result":{"frame":-1,"type":"<f8"},"frames":[1]}\nx': "named frame -1",
        b'{"id":1,"result":{"frame":0,"type":"<O8","shape":[1]},"frames":[8]}\n12345678': "unknown type",
        b'{"id":1,"result":{"frame":0,"type":7,"shape":[1]},"frames":[8]}\n12345678': "unknown type",
        b'{"id":1,"result":{"frame":0,"type":"<f8","shape":[2]},"frames":[8]}\n12345678': "8 bytes for an array",
        b'{"id":1,"result":{"frame":0,"type":"<f8","shape":[1]},"frames":[9]}\n123456789': "9 bytes for an array",
        b'{"id":1,"result":{"frame":0,"type":"<f8","shape":"x"},"frames":[8]}\n12345678': "8 bytes for an array",
        b'{"id":1,"error":"x"}\n': "error without a code",
        b"x" * (17 << 20): "more than 16777216 bytes",
    }

    def test_damaged_answers(self):
        for data, said in self.CASES.items():
            with self.subTest(data[:60]):
                reading, answers = os.pipe()
                connection = Connection(reading, os.open("/dev/null", os.O_WRONLY), timeout=10)
                self.addCleanup(connection.close)
                writer = threading.Thread(target=self.write_all, args=(answers, data))
                writer.start()
                with self.assertRaisesRegex(SessionError, said):
                    connection.call("m", {})
                if said != "error without a code":
                    with self.assertRaisesRegex(SessionError, said):
                        connection.call("m", {})
                connection.close()
                writer.join()

    @staticmethod
    def write_all(descriptor, data):
        try:
            while data:
                data = data[os.write(descriptor, data) :]
        except BrokenPipeError:
            pass
        os.close(descriptor)

    def test_an_answer_that_ends_early(self):
        self.answer(b'{"id":1,"result":1,"frames":[100]}\nabc')
        time.sleep(0.1)
        self.hang_up()
        with self.assertRaisesRegex(SessionError, "The session has ended"):
            self.connection.call("m", {})
        self.assertFalse(self.connection.usable)

    def test_a_call_after_close(self):
        self.connection.close()
        self.connection.close()
        with self.assertRaisesRegex(SessionError, "was closed; start another one"):
            self.connection.call("m", {})


class Processes(Case):
    """Sessions that die, hang, or outlive their client."""

    def session(self, timeout=20, **faults):
        session = Session(fake_session.program(self.folder, **faults), timeout=timeout)
        self.addCleanup(session.close)
        return session

    def test_a_session_that_dies_says_why(self):
        session = self.session(die="simulation.advance")
        simulation = session.run("x.elf")
        with self.assertRaisesRegex(SessionError, r"The session has ended\.\n  capsoc: it dies as told"):
            simulation.advance(1)
        self.assertFalse(session.alive)
        simulation.close()
        with self.assertRaises(SimulationEnded):
            simulation.advance(1)

    def test_a_session_that_is_killed(self):
        session = self.session()
        session.process.send_signal(signal.SIGKILL)
        with self.assertRaisesRegex(SessionError, "The session has ended|does not take requests"):
            session.call("echo")

    def test_one_that_does_not_answer(self):
        session = self.session(timeout=0.3, hang="echo")
        with self.assertRaisesRegex(errors.AnswerTimeout, "did not answer within 0.3 s"):
            session.call("echo")
        session.process.kill()

    def test_another_version_of_the_protocol(self):
        damage = {"session.about": b'{"id":1,"result":{"protocol":2}}\n'}
        with self.assertRaisesRegex(SessionError, "speaks version 2 of the protocol, this package 1"):
            self.session(damage=damage)

    def test_a_simulation_that_has_died(self):
        session = self.session()
        simulation = session.run("x.elf")
        session.call("simulation.close", simulation=simulation.number)
        with self.assertRaisesRegex(SimulationEnded, "simulation 1 was ended by signal 9"):
            simulation.advance(1)
        simulation.close()

    def test_threads_share_a_session(self):
        session = self.session(late={"echo": 0.001})
        with ThreadPoolExecutor(8) as pool:
            answers = list(pool.map(lambda n: session.call("echo", n=n)["n"], range(200)))
        self.assertEqual(answers, list(range(200)))

    def client(self, text):
        """A client in its own interpreter; its first line is the session's process."""
        path = fake_session.program(self.folder)
        code = f"import sys; sys.path[:0] = [{str(SOURCE / 'platform/python')!r}]\nimport os, time, capsoc\n"
        code += f"session = capsoc.Session({str(path)!r}); print(session.process.pid, flush=True)\n{text}"
        client = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True)
        self.addCleanup(client.communicate)
        return client, int(client.stdout.readline())

    def gone(self, pid):
        deadline = time.monotonic() + 10
        while time.monotonic() < deadline:
            try:
                state = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0]
            except (FileNotFoundError, ProcessLookupError):
                return True
            if state == "Z":  # waits for init
                return True
            time.sleep(0.02)
        return False

    def test_nothing_outlives_a_client(self):
        kill = "os.kill(os.getpid(), 9)"
        ends = {
            "end of the program": "",
            "os._exit": "os._exit(3)",
            "an exception": "raise SystemExit(1)",
            "SIGKILL": kill,
            "SIGKILL with a forked child": "if os.fork() == 0: os.close(1), time.sleep(30), os._exit(0)\n" + kill,
        }
        for name, text in ends.items():
            with self.subTest(name):
                _, session = self.client(text)
                self.assertTrue(self.gone(session), "the session still runs")


if __name__ == "__main__":
    unittest.main()
