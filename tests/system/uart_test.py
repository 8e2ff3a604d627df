#!/usr/bin/env python3
"""UARTs on pseudo-terminals, sockets, files and standard streams, with real clients."""

import os
import random
import re
import signal
import socket
import subprocess
import threading
import time
import tty
import unittest
from pathlib import Path

from harness import CAPSOC, CLEAN, Case, FIRMWARE

CTEST = {"name": "uart"}

ECHO, FOREVER, HELLO = FIRMWARE / "echo.elf", FIRMWARE / "forever.elf", FIRMWARE / "hello.elf"
ECHO_BYTES = int(os.environ.get("CAPSOC_ECHO_BYTES", "100000"))
PATIENCE = 60 + ECHO_BYTES / 10000  # seconds of the host; only a hang is that long


def random_bytes(count, seed=20260801):
    return random.Random(seed).randbytes(count)


def request(data):
    """What echo.elf takes: the number of bytes and the bytes."""
    return len(data).to_bytes(4, "little") + data


class UartCase(Case):
    def start(self, elf, *options, stdin=subprocess.DEVNULL):
        process = subprocess.Popen(
            [CAPSOC, "run", elf, *map(str, options)],
            stdin=stdin,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env=CLEAN,
        )
        self.addCleanup(self.stop, process)
        return process

    @staticmethod
    def stop(process):
        if process.poll() is None:
            process.kill()
        process.communicate()

    def place(self, process, uart="uart0"):
        """Where the program says that a UART is."""
        while line := process.stderr.readline().decode():
            if line.startswith(uart + ": "):
                return line.split()[-1].strip()
        self.fail("no place was printed")

    def connect(self, place):
        host, port = place.split(":")
        connection = socket.create_connection((host, int(port)), timeout=PATIENCE)
        self.addCleanup(connection.close)
        return connection

    def open_pty(self, path):
        descriptor = os.open(path, os.O_RDWR | os.O_NOCTTY)
        tty.setraw(descriptor)
        return descriptor

    def refuse(self, expected, *options):
        done = subprocess.run(
            [CAPSOC, "run", HELLO, *map(str, options)], capture_output=True, timeout=60, check=False, env=CLEAN
        )
        text = done.stderr.decode()
        self.assertEqual(done.returncode, 2, text)
        self.assertEqual(done.stdout, b"")
        self.assertEqual(len(text.strip().splitlines()), 1, text)
        self.assertIn(expected, text)

    def echoed(self, write, read, data):
        """Sends and receives at the same time; what came back."""
        sender = threading.Thread(target=write, args=(request(data),), daemon=True)
        sender.start()
        back = b""
        parts, count = [], 0
        while count < len(data) + 4:
            part = read()
            if not part:
                break
            parts.append(part)
            count += len(part)
        sender.join(PATIENCE)
        back = b"".join(parts)
        self.assertEqual(len(back), len(data) + 4)
        self.assertTrue(back == request(data), "the bytes differ")


def write_all(descriptor, data):
    while data:
        data = data[os.write(descriptor, data) :]


class Echo(UartCase):
    """Every byte arrives, in both directions; CAPSOC_ECHO_BYTES sets how many."""

    def test_tcp(self):
        process = self.start(ECHO, "--uart0", "tcp")
        client = self.connect(self.place(process))
        begin = time.monotonic()
        self.echoed(client.sendall, lambda: client.recv(65536), random_bytes(ECHO_BYTES))
        print(f"tcp: {ECHO_BYTES} bytes there and back, none lost, {time.monotonic() - begin:.1f} s", flush=True)
        self.assertEqual(process.wait(PATIENCE), 0)
        self.assertEqual(client.recv(1), b"", "the end of the run closes the connection")

    def test_pty(self):
        link = self.folder / "board"
        process = self.start(ECHO, "--uart0", f"pty:{link}")
        self.assertEqual(self.place(process), str(link))
        self.assertTrue(os.readlink(link).startswith("/dev/pts/"))
        terminal = self.open_pty(link)
        begin = time.monotonic()
        self.echoed(lambda data: write_all(terminal, data), lambda: os.read(terminal, 65536), random_bytes(ECHO_BYTES))
        print(f"pty: {ECHO_BYTES} bytes there and back, none lost, {time.monotonic() - begin:.1f} s", flush=True)
        self.assertEqual(process.wait(PATIENCE), 0)
        os.close(terminal)
        self.assertFalse(os.path.lexists(link), "the link goes with the run")

    def test_a_client_that_writes_first_and_reads_late_and_slowly(self):
        data = random_bytes(200000)  # more than the terminal's buffers
        process = self.start(ECHO, "--uart0", "pty")
        terminal = self.open_pty(self.place(process))
        write_all(terminal, request(data))
        time.sleep(1)
        back = b""
        while len(back) < len(data) + 4:
            part = os.read(terminal, 5000)
            self.assertTrue(request(data).startswith(back + part), "the simulation waited")
            back += part
        self.assertEqual(process.wait(PATIENCE), 0)
        os.close(terminal)

    def test_standard_streams_and_files_are_deterministic(self):
        data = random_bytes(5000)
        whole = self.folder / "in"
        whole.write_bytes(request(data))
        results = set()
        for _ in range(2):
            result = self.folder / "r.json"
            with whole.open("rb") as stdin:
                process = self.start(ECHO, "--uart0", "stdio", "--json", result, stdin=stdin)
                out, _ = process.communicate(timeout=PATIENCE)
            self.assertEqual((process.returncode, out), (0, request(data)))
            results.add(re.search(r'"cycles": \d+', result.read_text()).group())
        process = self.start(
            ECHO,
            "--uart0",
            f"file:{self.folder / 'out'}",
            "-C",
            f"uart0.input={whole}",
            "--json",
            result,
            "--quantum",
            1e4,
        )
        self.assertEqual(process.wait(PATIENCE), 0)
        self.assertEqual((self.folder / "out").read_bytes(), request(data))
        results.add(re.search(r'"cycles": \d+', result.read_text()).group())
        self.assertEqual(len(results), 1, "to the cycle")

    def test_a_pipe_on_standard_input(self):
        data = random_bytes(3000)
        process = self.start(ECHO, "--uart0", "stdio", stdin=subprocess.PIPE)
        out, _ = process.communicate(request(data), timeout=PATIENCE)
        self.assertEqual((process.returncode, out), (0, request(data)))


class Clients(UartCase):
    """Clients come and go; the run stays."""

    def plain(self, *options):
        result = self.folder / "plain.json"
        done = subprocess.run(
            [CAPSOC, "run", HELLO, "--json", result, *options], capture_output=True, timeout=60, check=True, env=CLEAN
        )
        return done.stdout, result.read_text()

    def test_nobody_there_changes_nothing(self):
        cycles = re.search(r'"cycles": \d+', self.plain()[1]).group()
        for backend in ("null", "tcp", "pty", f"file:{self.folder / 'u'}"):
            self.assertIn(cycles, self.plain("--uart0", backend)[1], backend)

    def test_a_vanished_client_does_not_end_the_run(self):
        process = self.start(ECHO, "--uart0", "tcp")
        place = self.place(process)
        with self.connect(place) as first:
            first.sendall((1000).to_bytes(4, "little") + bytes(100))
            first.recv(10)
        # The first one left bytes unread: its end is a reset. The board continues with the second.
        second = self.connect(place)
        second.sendall(bytes(range(256)) * 4)
        back = b""
        while not back.endswith(bytes(range(100))):
            part = second.recv(65536)
            if not part:
                break
            back += part
        self.assertIn(bytes(range(100)), back)
        self.assertEqual(process.wait(PATIENCE), 0)

    def test_a_terminal_that_is_closed_and_opened_again(self):
        process = self.start(ECHO, "--uart0", "pty")
        path = self.place(process)
        terminal = self.open_pty(path)
        write_all(terminal, (8).to_bytes(4, "little") + b"abcd")
        back = b""
        while len(back) < 8:
            back += os.read(terminal, 100)
        os.close(terminal)
        terminal = self.open_pty(path)
        write_all(terminal, b"efgh")
        back = b""
        while len(back) < 4:
            back += os.read(terminal, 100)
        self.assertEqual(back, b"efgh")
        self.assertEqual(process.wait(PATIENCE), 0)
        os.close(terminal)

    def test_a_reader_of_stdout_that_is_gone_ends_the_run(self):
        result = self.folder / "r.json"
        process = self.start(FIRMWARE / "selfcal.elf", "--simlimit", 100000, "--json", result)
        process.stdout.close()
        self.assertEqual(process.wait(PATIENCE), 128 + signal.SIGPIPE)
        self.assertIn('"code": 141', result.read_text())

    def test_waiting_for_a_listener(self):
        for backend in ("tcp", "pty"):
            process = self.start(HELLO, "--uart0", backend, "--uart-wait")
            place = self.place(process)
            with self.assertRaises(subprocess.TimeoutExpired):
                process.wait(0.3)  # it waits: that it never ends is all that this shows
            text = b""
            if backend == "tcp":
                client = self.connect(place)
                while part := client.recv(100):
                    text += part
            else:
                terminal = self.open_pty(place)
                while len(text) < 18:
                    text += os.read(terminal, 100)
                os.close(terminal)
            self.assertEqual(text, b"hello from capsoc\n", backend)
            self.assertEqual(process.wait(PATIENCE), 0)

    def test_a_signal_ends_the_waiting(self):
        link = self.folder / "l"
        process = self.start(HELLO, "--uart0", f"pty:{link}", "--uart-wait")
        self.place(process)
        process.send_signal(signal.SIGTERM)
        process.wait(PATIENCE)
        self.assertFalse(os.path.lexists(link))

    def test_input_arrives_while_the_processor_sleeps(self):
        process = self.start(ECHO, "--uart0", "tcp")
        client = self.connect(self.place(process))
        for byte in b"\x02\0\0\0ab":
            time.sleep(0.02)
            client.sendall(bytes([byte]))
            self.assertEqual(client.recv(1), bytes([byte]))
        self.assertEqual(process.wait(PATIENCE), 0)

    def test_limits_and_signals_end_a_sleeping_board(self):
        process = self.start(ECHO, "--uart0", "tcp", "--timelimit", 0.2)
        self.assertEqual(process.wait(PATIENCE), 124)
        process = self.start(ECHO, "--uart0", "tcp")
        self.place(process)
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(PATIENCE), 130)

    def test_a_sleep_without_any_input_to_come_ends(self):
        process = self.start(ECHO, "--uart0", "stdio", stdin=subprocess.DEVNULL)
        _, said = process.communicate(timeout=PATIENCE)
        self.assertEqual(process.returncode, 124)
        self.assertIn(b"sleeps", said)

    def test_only_the_loopback_interface(self):
        process = self.start(ECHO, "--uart0", "tcp")
        port = int(self.place(process).split(":")[1])
        table = Path("/proc/net/tcp").read_text().splitlines()
        local = [line.split()[1] for line in table if line.split()[3] == "0A"]
        self.assertEqual([a for a in local if a.endswith(f":{port:04X}")], [f"0100007F:{port:04X}"])


class Options(UartCase):
    """Logs, patterns, and what is refused."""

    def run_it(self, elf, *options):
        process = self.start(elf, *options)
        out, said = process.communicate(timeout=PATIENCE)
        return process.returncode, out, said.decode()

    def test_a_log_has_what_the_uart_sent(self):
        log = self.folder / "log"
        self.assertEqual(self.run_it(HELLO, "--uart0", "tcp", "-C", f"uart0.log={log}")[0], 0)
        self.assertEqual(log.read_bytes(), b"hello from capsoc\n")

    def test_patterns_end_the_run(self):
        code, out, said = self.run_it(FOREVER, "--until-uart", "^forever: loop+ing$")
        self.assertEqual((code, out), (0, b"forever: looping\n"))
        self.assertIn("uart0 printed what --until-uart names: forever: looping", said)
        self.assertEqual(self.run_it(FOREVER, "--fail-uart", "looping")[0], 1)
        self.assertEqual(self.run_it(FOREVER, "--until-uart", "forever", "--fail-uart", "loop")[0], 1)
        self.assertEqual(self.run_it(FOREVER, "--until-uart", "never", "--simlimit", 0.01)[0], 124)
        self.assertEqual(self.run_it(HELLO, "--until-uart", "never")[0], 0, "the program's own end stands")
        self.assertEqual(self.run_it(FIRMWARE / "exit_code.elf", "--until-uart", "7")[0], 0)
        self.assertEqual(self.run_it(HELLO, "--fail-uart", "capsoc")[0], 1, "though it ends with status 0")

    def test_what_cannot_be_used_is_refused(self):
        taken = socket.create_server(("127.0.0.1", 0))
        self.addCleanup(taken.close)
        file = self.folder / "file"
        file.write_text("")
        self.refuse("--uart0 console: choose stdout", "--uart0", "console")
        self.refuse("--uart3 tcp:65536: choose", "--uart3", "tcp:65536")
        self.refuse("choose another port", "--uart1", f"tcp:{taken.getsockname()[1]}")
        self.refuse("/nonexistent/x: cannot be written", "--uart0", "file:/nonexistent/x")
        self.refuse("cannot be made a link", "--uart0", f"pty:{file}")
        self.refuse("is taken by uart0", "--uart1", "stdio")
        self.refuse("is a directory", "-C", f"uart2.input={self.folder}")
        self.refuse("cannot be written", "-C", "uart2.log=/nonexistent/x")
        self.refuse("--until-uart (: is no regular expression", "--until-uart", "(")
        self.assertEqual(file.read_text(), "")


class Script(Case):
    """A UART whose outside is a script."""

    DIALOGUE = r"""
# echo.elf: the number of bytes first, then as many
at 0.001
send "\x0c\0\0\0"
send "hello\n"
expect /hello$/ within 1
wait 0.01
send "world\n"
expect /^world$/ within 1
"""

    def played(self, script, *options, name="played", elf=ECHO):
        (self.folder / "script.txt").write_text(script)
        log = self.folder / f"{name}.log"
        words = [elf, "--uart0", "script:script.txt", "-C", f"uart0.log={log}", "--json", f"{name}.json", *options]
        process = self.start("run", *words)
        out, said = process.communicate(timeout=PATIENCE)
        self.assertEqual(out, b"")
        return process.returncode, said.decode(), log.read_bytes() if log.exists() else b""

    def test_the_same_whatever_the_quantum_and_the_executor(self):
        figures = []
        for options in (
            (),
            ("-C", "cpu.quantum_ns=40"),
            ("-C", "cpu.quantum_ns=10000000"),
            ("-C", "cpu.executor=stepping"),
        ):
            code, said, log = self.played(self.DIALOGUE, *options)
            self.assertEqual((code, log), (0, b"\x0c\0\0\0hello\nworld\n"), said)
            result = self.result("played.json")
            figures.append([result["cpu"]["cycles"], result["cpu"]["instructions"], result["time"]["simulated_s"]])
        self.assertEqual(figures, figures[:1] * len(figures))
        self.assertGreater(figures[0][2], 0.011)

    def test_from_the_middle(self):
        self.assertEqual(self.played(self.DIALOGUE, "--save", "state@0.005")[0], 0)
        whole = self.result("played.json")
        self.assertEqual(self.played(self.DIALOGUE, "--restore", "state", name="second")[0], 0)
        second = self.result("second.json")
        for figure in ("cycles", "instructions"):
            self.assertEqual(whole["cpu"][figure], second["cpu"][figure])

    def test_what_is_missed_fails_the_run(self):
        script = "expect /something/ within 0.25\n"
        code, said, _ = self.played(script, elf=FOREVER)
        self.assertEqual(code, 1, said)
        self.assertIn("uart0: script.txt:1: no line matched /something/ within 0.25 s", said)
        self.assertAlmostEqual(self.result("played.json")["time"]["simulated_s"], 0.25, 6)
        code, said, _ = self.played("\nexpect /never/\n", elf=HELLO)
        self.assertEqual(code, 1, said)
        self.assertIn("uart0: script.txt:2: the run ended before a line matched /never/", said)
        self.assertEqual(self.played("expect /hello from/\n", elf=HELLO)[0], 0)
        code, said, _ = self.played("expect /never/\n", "--simlimit", "0.1", elf=FOREVER)
        self.assertEqual(code, 124, said)
        self.assertIn("simulated s was hit; uart0: script.txt:1: the run ended before a line matched /never/", said)

    def test_two_at_a_time(self):
        (self.folder / "other.txt").write_text('at 0.002\nsend "nobody reads this"\n')
        code, said, log = self.played(self.DIALOGUE, "--uart1", "script:other.txt")
        self.assertEqual((code, log[4:]), (1, b"hello\nworld\n"), said)
        self.assertIn("uart1: other.txt: the program did not take the last 17 bytes", said)

    def test_what_is_no_script_is_refused(self):
        for script, words in (("greet", "script.txt:1: is no step"), ("expect /(/", "is no regular expression")):
            code, said, _ = self.played(script)
            self.check_refused(code, b"", said, words)
        code, said, _ = self.played("", "-C", "uart0.input=script.txt")
        self.check_refused(code, b"", said, "uart0.input", "the script sends already")
        for backend, words in (("script:none.txt", "none.txt"), ("script:", "--uart0 script:: choose stdout")):
            process = self.start("run", ECHO, "--uart0", backend)
            out, said = process.communicate(timeout=PATIENCE)
            self.check_refused(process.returncode, out, said.decode(), words)


if __name__ == "__main__":
    unittest.main()
