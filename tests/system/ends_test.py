#!/usr/bin/env python3
"""Every run ends soon at a limit of the host's time and at a signal, whatever the processor and the host do."""

import json
import os
import signal
import subprocess
import time
import unittest

from harness import FIRMWARE, SOURCE, Case, signal_is_caught

CTEST = {"name": "ends", "timeout": 600}

ENDLESS = FIRMWARE / "endless.elf"
SENSOR = SOURCE / "traces" / "soc_eq21.toml"
SOON = 20  # seconds; a tenth of one is what it takes on an idle machine
LIMIT = 124
ENDING = (signal.SIGHUP, signal.SIGINT, signal.SIGQUIT, signal.SIGTERM)

WAYS = (
    "compute wfi_adc wfe_adc wfi_fast_adc wfi_timer wfi_tick sleep_on_exit wfi_pending wfi_for_good poll_gpio "
    "poll_uart poll_timer poll_adc poll_running_adc poll_coprocessor poll_systick poll_two poll_and_count write_gpio "
    "feed_coprocessor print semihosting_write semihosting_read fault_again"
).split()
ENDS_ITSELF = ("wfi_timer", "wfi_for_good")  # without a host that could wake it
SOME = ("compute", "wfi_adc", "wfi_tick", "poll_gpio", "poll_running_adc", "poll_coprocessor")


class EndlessCase(Case):
    def start(self, way, *options, **keywords):
        arguments = [
            "run",
            ENDLESS,
            "--sensor",
            SENSOR,
            "-P",
            f"way={WAYS.index(way)}",
            "--json",
            "r.json",
            *map(str, options),
        ]
        return super().start(*arguments, **{"stdout": subprocess.DEVNULL, **keywords})

    def wait(self, process, code, reason):
        began = time.monotonic()
        try:
            process.wait(SOON)
        except subprocess.TimeoutExpired:
            self.fail(f"{' '.join(map(str, process.args))}: still runs after {SOON} s")
        took = time.monotonic() - began
        if log := os.environ.get("CAPSOC_TEST_TIMES"):
            with open(log, "a", encoding="ascii") as file:
                file.write(f"{took:.3f} {' '.join(map(str, process.args))}\n")
        said = process.stderr.read().decode() if process.stderr else ""
        self.assertEqual(process.returncode, code, said)
        result = json.loads((self.folder / "r.json").read_text())
        self.assertEqual(result["exit"]["code"], code)
        self.assertIn(reason, result["exit"]["reason"])
        (self.folder / "r.json").unlink()
        return result, said

    def wait_until_it_runs(self, process, seconds=0.15):
        """Until it has caught its signals, and a little longer: no result depends on how far it has come."""
        until = time.monotonic() + SOON
        while time.monotonic() < until and process.poll() is None:
            if signal_is_caught(process, signal.SIGALRM):
                break
            time.sleep(0.01)
        time.sleep(seconds)
        self.assertIsNone(process.poll(), "it has ended already")

    def ends_by_limit(self, way, *options, **keywords):
        process = self.start(way, "--timelimit", 0.2, *options, **keywords)
        return self.wait(process, LIMIT, "of the host was hit")

    def ends_by_signal(self, way, number, *options, **keywords):
        process = self.start(way, *options, **keywords)
        self.wait_until_it_runs(process)
        process.send_signal(number)
        return self.wait(process, 128 + number, f"ended by signal {int(number)}")


class Limits(EndlessCase):
    def test_every_way(self):
        for way in WAYS:
            if way in ENDS_ITSELF:
                continue
            with self.subTest(way):
                self.ends_by_limit(way)

    def test_every_executor_and_quantum(self):
        for way in SOME:
            for executor in ("translator", "blocks", "stepping"):
                for quantum in (1, 1000, 1_000_000, 1_000_000_000):
                    with self.subTest(way, executor=executor, quantum=quantum):
                        self.ends_by_limit(way, "-C", f"cpu.executor={executor}", "--quantum", quantum)

    def test_other_speeds_of_the_host(self):
        for way in SOME:
            for options in (
                ("-C", "cpu.fast_forward=false"),
                ("-C", "cpu.translate_after=1"),
                ("--trace-instructions", "i"),
                ("--profile", "p"),
                ("--realtime",),
                ("--realtime", "1000"),
                ("--realtime", "0.01"),
                ("--waves", "w.fst"),
                ("--record", "c.csv"),
                ("--coverage", "v.info"),
                ("--curves",),
            ):
                with self.subTest(way, options=options):
                    self.ends_by_limit(way, *options)


class Signals(EndlessCase):
    def test_every_way(self):
        for number, way in enumerate(WAYS):
            if way in ENDS_ITSELF:
                continue
            with self.subTest(way):
                self.ends_by_signal(way, ENDING[number % len(ENDING)])

    def test_every_signal(self):
        for number in ENDING:
            for way in ("wfi_adc", "poll_gpio"):
                with self.subTest(way, number=number):
                    self.ends_by_signal(way, number, "--record", "c.csv", "--trace-bus", "b", "--html", "r.html")
                    self.assertEqual(sorted(p.name for p in self.folder.iterdir()), ["b", "c.csv", "r.html"])

    def test_every_coprocessor(self):
        for coprocessor in ("tlm", "rtl", "lockstep"):
            for way in (*SOME, "wfi_fast_adc", "feed_coprocessor"):
                with self.subTest(way, coprocessor=coprocessor):
                    self.ends_by_signal(way, signal.SIGTERM, "--coprocessor", coprocessor)
                    self.ends_by_limit(way, "--coprocessor", coprocessor)


class Backends(EndlessCase):
    """A host that takes nothing, gives nothing, or is not there."""

    def both(self, way, *options, **keywords):
        with self.subTest(way, options=options):
            self.ends_by_limit(way, *options, **keywords)
            self.ends_by_signal(way, signal.SIGTERM, *options, **keywords)

    def full_pipe(self):
        """Its writing end; the other end has no reader."""
        ends = os.pipe()
        for end in ends:
            self.addCleanup(os.close, end)
        os.set_blocking(ends[1], False)
        try:
            while True:
                os.write(ends[1], b"x" * 4096)
        except BlockingIOError:
            os.set_blocking(ends[1], True)
        return ends[1]

    def test_streams_that_are_full(self):
        for way in ("print", "wfi_adc"):
            self.both(way, stdout=self.full_pipe())
        self.both("semihosting_write", "--semihosting-console", "stdout", stdout=self.full_pipe())
        for way in ("semihosting_write", "print"):
            self.both(way, "--log-level", "trace", stderr=self.full_pipe())

    def test_streams_that_are_closed(self):
        for way in ("print", "wfi_adc", "semihosting_write"):
            self.both(
                way, preexec_fn=lambda: [os.close(number) for number in (0, 1, 2)], stdin=None, stdout=None, stderr=None
            )

    def test_ports_without_a_peer(self):
        for backend in ("pty", "tcp:0"):
            for way in ("print", "wfi_adc", "wfi_for_good", "poll_gpio", "poll_uart"):
                self.both(way, "--uart0", backend)
                self.both(way, "--uart0", "null", "--uart1", backend)
            self.both("print", "--uart0", backend, "-C", "run.uart_wait=true")
            self.both("semihosting_read", "--semihosting-console", backend)

    def test_input_that_never_comes(self):
        for way in ("poll_uart", "wfi_for_good", "wfi_adc", "semihosting_read"):
            silent, writer = os.pipe()
            self.addCleanup(os.close, silent)
            self.addCleanup(os.close, writer)
            taker = ("--semihosting-console",) if way == "semihosting_read" else ("--uart0", "null", "--uart1")
            self.both(way, *taker, "stdio", stdin=silent)
        self.both("semihosting_read", *taker, "stdio", "--record-session", "a.session", stdin=silent)

    def test_a_debugger_that_does_not_come(self):
        for way in SOME:
            self.both(way, "--gdb", 0)
            self.both(way, "--gdb", 0, "--halt")

    def test_a_pipe_without_a_reader(self):
        fifo = self.folder / "fifo"
        os.mkfifo(fifo)
        for options in (("--uart0", "file:fifo"), ("--trace-instructions", "fifo"), ("-C", "uart0.log=fifo")):
            for ending, code in ((("--timelimit", "0.2"), LIMIT), ((), 128 + signal.SIGTERM)):
                with self.subTest(options=options, code=code):
                    process = self.start("print", *options, *ending)
                    if not ending:
                        self.wait_until_it_runs(process)
                        process.send_signal(signal.SIGTERM)
                    self.assertEqual(process.wait(SOON), code)
                    self.assertIn("fifo: cannot be written", process.stderr.read().decode())
        process = self.start("wfi_adc", "--record", "fifo")
        self.wait_until_it_runs(process)
        process.send_signal(signal.SIGTERM)
        self.assertIn("fifo: cannot be written", self.wait(process, 128 + signal.SIGTERM, "ended by signal")[1])

    def test_a_pipe_whose_reader_stopped_reading(self):
        fifo = self.folder / "fifo"
        os.mkfifo(fifo)
        reader = os.open(fifo, os.O_RDONLY | os.O_NONBLOCK)
        self.addCleanup(os.close, reader)
        for options in (("--uart0", "file:fifo"), ("-C", "uart0.log=fifo")):
            self.both("print", *options)
        for options in (("--trace-instructions", "fifo"), ("--trace-bus", "fifo")):
            self.both("poll_gpio", *options)


class Checkpoints(EndlessCase):
    def test_a_signal_saves_whatever_the_processor_does(self):
        for way in WAYS:
            if way in ENDS_ITSELF:
                continue
            with self.subTest(way):
                process = self.start(way, stderr=subprocess.DEVNULL)
                self.wait_until_it_runs(process)
                process.send_signal(signal.SIGUSR1)
                until = time.monotonic() + SOON
                while not list(self.folder.glob("checkpoint-*.capsoc")) and time.monotonic() < until:
                    time.sleep(0.01)
                saved = list(self.folder.glob("checkpoint-*.capsoc"))
                self.assertEqual(len(saved), 1)
                process.send_signal(signal.SIGTERM)
                self.wait(process, 128 + signal.SIGTERM, "ended by signal")
                saved[0].unlink()


class Unchanged(EndlessCase):
    """Where the host cuts in changes nothing but the end."""

    def results(self, process, code):
        self.assertEqual(process.wait(SOON), code)
        result = json.loads((self.folder / "r.json").read_text())
        for key in ("time", "command", "translator"):
            result.pop(key, None)
        result["cpu"].pop("mips")
        return result

    def test_signals_that_end_nothing(self):
        for way, limit in (
            ("wfi_adc", 20000),
            ("wfi_tick", 500),
            ("poll_gpio", 1),
            ("poll_running_adc", 1),
            ("compute", 2),
        ):
            options = ("--simlimit", limit, "--uart0", "null", "--record", "c.csv")
            alone = self.results(self.start(way, *options), LIMIT)
            rows = (self.folder / "c.csv").read_bytes().split(b"\n", 1)[1]
            process = self.start(way, *options)
            self.wait_until_it_runs(process, 0)
            for _ in range(20):
                if process.poll() is None:
                    process.send_signal(signal.SIGALRM)  # the timer's
                    time.sleep(0.02)
            self.assertEqual(self.results(process, LIMIT), alone, way)
            self.assertEqual((self.folder / "c.csv").read_bytes().split(b"\n", 1)[1], rows, way)

    def test_real_time_of_one_that_sleeps(self):
        """Paced although the processor never wakes, and the same result."""
        process = self.start("wfi_adc", "--simlimit", 0.5, "--uart0", "null")
        alone = self.results(process, LIMIT)
        began = time.monotonic()
        process = self.start("wfi_adc", "--simlimit", 0.5, "--uart0", "null", "--realtime")
        paced = self.results(process, LIMIT)
        self.assertGreaterEqual(time.monotonic() - began, 0.45)
        for result in (alone, paced):
            result["configuration"].pop("run.realtime", None)
        self.assertEqual(paced, alone)


if __name__ == "__main__":
    unittest.main()
