#!/usr/bin/python3
"""The Python package against `capsoc serve`: time, state, stimulus, variants, results, speed, what is left behind."""

import os
import signal
import socket
import subprocess
import sys
import threading
import time
import unittest
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from harness import BUILD, CAPSOC, FIRMWARE, SOURCE, TRACES, Case

sys.path[:0] = [str(SOURCE / "platform" / "python")]
for name in [name for name in os.environ if name.startswith("CAPSOC_")]:
    del os.environ[name]

import capsoc  # noqa: E402

CTEST = {"name": "python session", "interpreter": "/usr/bin/python3", "timeout": 900}

SHORT = {"demodulation_samples": 100, "calibration_samples": 20}


class Real(Case):
    def setUp(self):
        super().setUp()
        self.session = capsoc.Session(CAPSOC, timeout=120)
        self.addCleanup(self.session.close)

    def run_elf(self, elf="selfcal.elf", *arguments, **options):
        simulation = self.session.run(elf, *arguments, **options)
        self.addCleanup(simulation.close)
        return simulation


class Time(Real):
    def test_it_advances_exactly(self):
        simulation = self.run_elf()
        self.assertEqual((simulation.state.time_ps, simulation.state.cycles), (0, 0))
        self.assertEqual(simulation.advance(0.5).state.time_ps, 500_000_000_000)
        self.assertEqual(simulation.advance(until_s=2).state.time_ps, 2_000_000_000_000)
        before = simulation.state
        self.assertGreaterEqual(simulation.advance(cycles=1000).state.cycles, before.cycles + 1000)
        before = simulation.state
        self.assertEqual(simulation.advance(instructions=100).state.instructions, before.instructions + 100)

    def test_many_small_steps_are_one_large_one(self):
        one, many = self.run_elf(), self.run_elf()
        one.advance(1)
        for step in range(1, 1001):
            many.advance(until_s=step / 1000)
        self.assertEqual(one.state, many.state)
        self.assertEqual(one.uart0.text, many.uart0.text)
        self.assertEqual(one.samples().error_deg.tolist(), many.samples().error_deg.tolist())

    def test_stops(self):
        simulation = self.run_elf()
        stop = simulation.until(symbol="main", within=1)
        self.assertEqual((bool(stop), stop.reason), (True, "address"))
        self.assertIn("main", simulation.state.place)
        self.assertEqual(simulation.processor.pc, stop.state.pc)
        self.assertFalse(simulation.until(exception="HardFault", within=0.01))
        self.assertEqual(simulation.until(expression="results >= 5", within=1).reason, "expression")
        self.assertGreaterEqual(simulation.variable("results"), 5)
        # The interrupt of the coprocessor, by its number.
        self.assertTrue(simulation.advance(samples=3))

    def test_text_beside_the_uarts(self):
        simulation = self.run_elf("itm.elf", settings={"itm.backend": "stdout"})
        simulation.advance()
        self.assertEqual((simulation.itm, simulation.console), ("itm: 42\n", ""))
        simulation = self.run_elf("endless.elf", program={"way": 22})  # reads the console for ever
        simulation.advance(0.1)  # it prints first
        simulation.type("Z")
        read = []
        for _ in range(60):
            simulation.advance(instructions=1)
            read.append(simulation.processor.r0)
        self.assertIn(ord("Z"), read)
        simulation = self.run_elf("questions.elf", settings={"semihosting.console": "stdio"})
        stop = simulation.advance()
        self.assertEqual((stop.reason, bool(stop), simulation.console), ("console", False, "line? "))
        simulation.type("quit\n", end=True)
        self.assertEqual(simulation.advance().reason, "over")
        self.assertIn('1: 5 bytes "quit"', simulation.console)

    def test_the_end(self):
        simulation = self.run_elf(program=SHORT)
        stop = simulation.advance()
        self.assertEqual((stop.reason, stop.state.over), ("over", True))
        with self.assertRaises(capsoc.SimulationOver):
            simulation.advance(1)
        self.assertIn("selfcal: fail", simulation.uart0.text)
        result = simulation.finish()
        self.assertEqual((result.code, result.passed), (1, False))
        self.assertGreater(result["samples"], 100)
        self.assertIs(simulation.finish(), result)

    def test_an_interrupt_from_the_keyboard(self):
        simulation = self.run_elf("endless.elf" if (FIRMWARE / "endless.elf").exists() else "forever.elf")
        timer = threading.Timer(1.0, os.kill, (os.getpid(), signal.SIGINT))
        self.addCleanup(timer.cancel)
        timer.start()
        with self.assertRaises(KeyboardInterrupt):
            simulation.advance(seconds=1e6)
        at = simulation.state.time_s
        self.assertGreater(at, 0)
        self.assertGreater(simulation.advance(seconds=0.01).state.time_s, at)


class Parts(Real):
    def test_registers_and_fields(self):
        simulation = self.run_elf()
        simulation.advance(1)
        coprocessor = simulation.coprocessor
        self.assertEqual(coprocessor.STATUS.LOCK, 0)
        self.assertEqual(coprocessor.CTRL.DEMOD, 1)
        self.assertEqual(int(coprocessor.CTRL), coprocessor.CTRL.value)
        coprocessor.LOCK_THRESHOLD = 77
        simulation.advance(cycles=100)
        self.assertEqual(coprocessor.LOCK_THRESHOLD, 77)
        self.assertNotEqual(simulation.registers.UART0.CTRL.value, 0)
        self.assertIn("STATUS", dir(coprocessor))
        self.assertIn("UART0", dir(simulation.registers))
        self.assertIn("LOCK", repr(coprocessor.STATUS))
        with self.assertRaises(capsoc.CapsocError) as raised:
            coprocessor.STATSU.LOCK
        self.assertIn("STATUS", str(raised.exception))

    def test_signals(self):
        simulation = self.run_elf()
        simulation.advance(100)
        coprocessor = simulation.coprocessor
        self.assertAlmostEqual(coprocessor.a1, 0.6079, delta=0.006)
        self.assertTrue(-360 < coprocessor.angle_deg <= 360)
        with self.assertRaisesRegex(
            AttributeError, "no signal of the coprocessor 'angel_deg'; the nearest is 'angle_deg'"
        ):
            coprocessor.angel_deg

    def test_memory_and_variables(self):
        simulation = self.run_elf()
        simulation.advance(1)
        count = simulation.variable("results")
        self.assertGreater(count, 200)
        self.assertEqual(simulation.mem32["results"], count)
        address = simulation.variables.address("results")
        simulation.mem16[address] = 0x1234
        self.assertEqual(simulation.variable("results") & 0xFFFF, 0x1234)
        self.assertEqual(simulation.mem8[address : address + 2], [0x34, 0x12])
        simulation.variables["results"] = 9
        self.assertEqual(simulation.mem32[address : address + 4], [9])
        with self.assertRaises(capsoc.CapsocError):
            simulation.variable("absent")
        with self.assertRaisesRegex(capsoc.SimulationError, "resutls"):
            simulation.mem32["resutls"]

    def test_processor_registers(self):
        simulation = self.run_elf()
        simulation.until(symbol="main", within=1)
        simulation.processor.r0 = 0x12345678
        self.assertEqual(simulation.processor.r0, 0x12345678)
        self.assertEqual(simulation.processor.sp, simulation.processor.msp)

    def test_uart_both_ways(self):
        simulation = self.run_elf("echo.elf")
        simulation.uart0.send("hello")
        self.assertEqual(simulation.uart0.expect("h(el+)o", within=1)[1], "ell")
        with self.assertRaisesRegex(capsoc.ExpectationError, "UART 0 did not send 'more' within 0.1 simulated s"):
            simulation.uart0.expect("more", within=0.1)

    def test_the_same_bytes_every_time(self):
        def text():
            simulation = self.run_elf("echo.elf")
            for word in ("one", "two", "three"):
                simulation.uart0.send(word)
                simulation.advance(0.003)
            return simulation.uart0.text, simulation.state

        self.assertEqual(text(), text())

    def test_pins(self):
        simulation = self.run_elf("pins.elf")
        simulation.gpio[0][3] = True
        self.assertTrue(simulation.gpio[0][3])
        self.assertEqual(len(simulation.gpio[0].pins), 16)
        simulation.gpio[0][3] = None
        self.assertFalse(simulation.gpio[0][3])

    def test_injected_samples(self):
        simulation = self.run_elf()
        simulation.advance(1)
        simulation.adc.inject(u=0.5, v=-0.25, samples=10)
        simulation.advance(samples=12)
        table = simulation.samples(last=12)
        self.assertEqual(list(table.u).count(0.5), 10)
        self.assertEqual(list(table.v).count(-0.25), 10)
        simulation.adc.inject([0.1, 0.2], [0.3, 0.4])
        with self.assertRaisesRegex(ValueError, "u and v have 2 and 3 values"):
            simulation.adc.inject([0.1, 0.2], [0.3, 0.4, 0.5])

    def test_sensor(self):
        simulation = self.run_elf(sensor=capsoc.Sensor(a1=0.5, b1=0.1, beta_deg=5))
        self.assertEqual(simulation.sensor.a1, 0.5)
        self.assertAlmostEqual(simulation.sensor.beta_deg, 5)
        simulation.advance(0.1)
        simulation.sensor.b1 += 0.25
        self.assertAlmostEqual(simulation.sensor.b1, 0.35)
        simulation.sensor.beta_deg += 2
        self.assertAlmostEqual(simulation.sensor.beta_deg, 7)
        before = simulation.samples(last=1).u[-1:]
        simulation.advance(samples=2)
        self.assertAlmostEqual(float(list(simulation.samples(last=1).u)[0]) - float(list(before)[0]), 0.25, delta=0.01)
        with self.assertRaises(capsoc.CapsocError):
            simulation.sensor.c1 = 1

    def test_files_as_sensors(self):
        for sensor in (TRACES / "soc_noise_1e-4.toml", TRACES / "recorded_example.csv"):
            simulation = self.run_elf(sensor=sensor)
            simulation.advance(0.5)
            self.assertGreater(len(simulation.samples()), 100)

    def test_events(self):
        simulation = self.run_elf(program=SHORT)
        simulation.subscribe("uart")
        stop = simulation.advance()
        self.assertEqual({event.kind for event in stop.events}, {"uart"})
        self.assertEqual(stop.events[0].details["line"], "selfcal: self-calibration at a known speed")
        self.assertEqual(simulation.events, stop.events)
        self.assertGreater(stop.events[0].time_s, 0)
        simulation = self.run_elf(program=SHORT)
        simulation.subscribe("verdict")
        stop = simulation.advance()
        verdict = simulation.finish().data["verdict"]
        self.assertEqual([event.details["pass"] for event in stop.events], [verdict["pass"]])
        self.assertEqual(stop.events[0].details.get("reason"), verdict.get("reason"))

    def test_figures(self):
        simulation = self.run_elf()
        simulation.advance(1)
        self.assertIn("<svg", simulation._repr_html_())
        self.assertIn("selfcal.elf at 1.000000 s", repr(simulation))

    def test_unknown_requests(self):
        simulation = self.run_elf()
        with self.assertRaises(capsoc.RequestError):
            self.session.call("session.abuot")
        with self.assertRaises(capsoc.RequestError):
            simulation.call("memory.read", address=[], size="x")
        with self.assertRaises(capsoc.SimulationError):
            self.run_elf(settings={"cpu.quantun_ns": 1})
        simulation.advance(0.001)
        self.assertIn("simulation.advance", {method["name"] for method in self.session.schema()["methods"]})


class Variants(Real):
    def test_snapshot_and_restore(self):
        simulation = self.run_elf()
        simulation.uart0.expect("Hz", within=1)
        snapshot = simulation.snapshot()
        first = (simulation.advance(1).state, simulation.uart0.text, simulation.samples(last=1).u[-1:])
        for _ in range(2):
            simulation.restore(snapshot)
            again = (simulation.advance(1).state, simulation.uart0.text, simulation.samples(last=1).u[-1:])
            self.assertEqual(first[:2], again[:2])
            self.assertEqual(list(first[2]), list(again[2]))
        simulation.drop(snapshot)
        with self.assertRaises(capsoc.CapsocError):
            simulation.restore(snapshot)

    def test_clones_go_their_own_ways(self):
        simulation = self.run_elf()
        simulation.advance(1)
        clones = simulation.clone(8)
        with ThreadPoolExecutor(8) as pool:
            states = list(pool.map(lambda clone: clone.advance(1).state, clones))
        self.assertEqual(set(states), {simulation.advance(1).state})
        self.assertEqual({clone.uart0.text for clone in clones}, {simulation.uart0.text})
        clones[0].variables["results"] = 1
        self.assertNotEqual(clones[1].variable("results"), 1)
        for clone in clones:
            clone.close()
        with self.assertRaises(capsoc.SimulationEnded):
            clones[0].advance(1)

    def test_a_checkpoint(self):
        simulation = self.run_elf()
        simulation.advance(1)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(self.folder)
        simulation.save("state.checkpoint")
        again = self.run_elf(settings={"checkpoint.restore": str(self.folder / "state.checkpoint")})
        self.assertEqual(again.advance(1).state.cycles, simulation.advance(1).state.cycles)

    def test_a_campaign(self):
        runs = [{"sensor": capsoc.Sensor(noise=10.0**-n), "program": SHORT} for n in (2, 3, 4)]
        rows = capsoc.Campaign(runs, program=CAPSOC).results()
        self.assertEqual([(row["run"], row["code"]) for row in rows], [(0, 1), (1, 1), (2, 1)], rows)


class Ends(Real):
    def test_a_killed_simulation_is_named_and_the_others_continue(self):
        first, second = self.run_elf(), self.run_elf()
        (pid,) = [
            s["process"]
            for s in self.session.call("session.simulations")["simulations"]
            if s["simulation"] == first.number
        ]
        os.kill(pid, signal.SIGKILL)
        with self.assertRaisesRegex(capsoc.SimulationEnded, "signal 9"):
            first.advance(1)
        first.close()
        self.assertTrue(second.advance(0.1))

    def test_nothing_is_left_behind(self):
        self.run_elf().advance(0.1)
        pids = [s["process"] for s in self.session.call("session.simulations")["simulations"]]
        self.session.close()
        self.assertEqual(self.session.process.returncode, 0)  # by itself, at the end of its input
        deadline = time.monotonic() + 10
        while any(Path(f"/proc/{pid}").exists() for pid in pids) and time.monotonic() < deadline:
            time.sleep(0.02)
        self.assertEqual([pid for pid in pids if Path(f"/proc/{pid}").exists()], [])

    def test_a_socket(self):
        path = self.folder / "socket"
        process = self.start("serve", "--socket", path)
        with self.connected(path) as session, session.run(FIRMWARE / "echo.elf") as simulation:
            simulation.uart0.send("x")
            simulation.uart0.expect("x", within=1)
        self.assertIsNone(process.poll())

    @staticmethod
    def connected(path):
        """A client of a session that may not listen yet."""
        for _ in range(500):
            try:
                return capsoc.Session(socket=path)
            except capsoc.SessionError:
                time.sleep(0.02)
        return capsoc.Session(socket=path)

    def test_another_user_is_refused(self):
        """Even if the socket's mode lets all users in."""
        if os.geteuid() != 0:
            self.skipTest("only root can become another user")
        path = self.folder / "socket"
        self.start("serve", "--socket", path)
        self.connected(path).close()
        self.assertEqual(path.stat().st_mode & 0o777, 0o600)
        self.folder.chmod(0o755)
        path.chmod(0o666)
        client = (
            "import socket, sys\ns = socket.socket(socket.AF_UNIX)\ns.settimeout(30)\ns.connect(sys.argv[1])\n"
            's.sendall(b\'{"jsonrpc": "2.0", "id": 1, "method": "session.about"}\\n\')\nprint(s.recv(999))'
        )
        for user, answered in ((0, True), (65534, False)):
            done = subprocess.run(
                ["/usr/bin/python3", "-c", client, path], capture_output=True, text=True, user=user, check=False
            )
            self.assertEqual("result" in done.stdout, answered, done.stdout + done.stderr)

    def test_a_port_needs_the_token(self):
        process = self.start("serve", "--port")
        said = process.stderr.readline().decode()
        port, token = int(said.split(":")[-1].split(",")[0]), said.split()[-1]
        with capsoc.Session(port=port, token=token) as session, session.run(FIRMWARE / "echo.elf") as simulation:
            simulation.advance(0.001)
        with self.assertRaises(capsoc.CapsocError):
            capsoc.Session(port=port, token="0" * len(token))
        with socket.create_connection(("127.0.0.1", port)):
            pass


class Speed(Real):
    """Wall time is printed; judged is the processor time of this side, which other programs do not change."""

    def measured(self, work):
        """(wall, processor) seconds of this process."""
        wall, processor = time.monotonic(), time.process_time()
        work()
        return time.monotonic() - wall, time.process_time() - processor

    def test_requests(self):
        simulation = self.run_elf("echo.elf")
        for name, request in (
            ("the session", lambda: self.session.call("session.about")),
            ("a simulation", lambda: simulation.state),
        ):
            wall, processor = self.measured(lambda: [request() for _ in range(2000)])
            print(f"{2000 / wall:.0f} requests/s to {name}, {processor / 2000 * 1e6:.0f} us of this side each")
            self.assertLess(processor / 2000, 1e-3)

    def test_samples(self):
        simulation = self.run_elf()
        simulation.advance(400)
        tables = []
        columns = ["u", "v", "error_deg"]
        wall, processor = self.measured(lambda: tables.append(simulation.samples(columns=columns)))
        print(f"{len(tables[0])} samples of three columns in {wall:.3f} s, {processor:.3f} s of this side")
        self.assertGreater(len(tables[0]), 90_000)
        self.assertLess(processor, 1)


if __name__ == "__main__":
    assert BUILD.exists()
    unittest.main()
