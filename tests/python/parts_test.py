#!/usr/bin/python3
"""Parts of the Python package without a simulator: sensors as settings, tables, figures, expectations, campaigns."""

import math
import os
import re
import sys
import unittest
from pathlib import Path
from unittest import mock

from harness import SOURCE, Case

sys.path[:0] = [str(SOURCE / "platform" / "python"), str(Path(__file__).parent)]

import fake_session  # noqa: E402
import capsoc  # noqa: E402
from capsoc import figure, program, samples  # noqa: E402

CTEST = {"name": "python parts", "interpreter": "/usr/bin/python3"}


class Sensors(Case):
    def test_what_is_not_named_is_the_files(self):
        self.assertEqual(capsoc.Sensor().settings(), {"sensor.file": "built-in:soc_eq21.toml"})
        self.assertEqual(
            capsoc.Sensor(a1=0.6, b1=0.1, noise=1e-4).settings(),
            {
                "sensor.file": "built-in:soc_eq21.toml",
                "sensor.a1": 0.6,
                "sensor.b1": 0.1,
                "sensor.noise.peak": 1e-4,
                "sensor.noise.record_samples": 100_000,
                "sensor.noise.seed": 1,
            },
        )

    def test_all_tables(self):
        sensor = capsoc.Sensor(
            file=self.folder / "s.toml",
            beta_deg=180,
            noise_sigma=0.01,
            seed=7,
            harmonics=[capsoc.Harmonic("u", 3, 0.01, 90)],
            motion={"kind": "profile", "speeds": [(0, 1), (5, 2)]},
            drift={"a1_per_s": 1e-3},
            sampling={"rate_hz": 5000},
        )
        self.assertEqual(
            sensor.settings(),
            {
                "sensor.file": str(self.folder / "s.toml"),
                "sensor.beta_rad": math.pi,
                "sensor.rate_hz": 5000,
                "sensor.motion.kind": "profile",
                "sensor.motion.speeds": "[[0, 1], [5, 2]]",
                "sensor.drift.a1_per_s": 1e-3,
                "sensor.noise.sigma": 0.01,
                "sensor.noise.seed": 7,
                "sensor.harmonics.u3_amplitude": 0.01,
                "sensor.harmonics.u3_phase_rad": math.pi / 2,
            },
        )

    def test_two_kinds_of_noise_exclude_each_other(self):
        with self.assertRaisesRegex(ValueError, "noise and noise_sigma exclude each other"):
            capsoc.Sensor(noise=1, noise_sigma=1).settings()


class Tables(unittest.TestCase):
    def setUp(self):
        self.table = samples.Samples(40, {"t": [0.0, 0.5, 1.0], "error_deg": [1.0, -3.0, float("nan")]})

    def test_columns_as_pandas_has_them(self):
        self.assertEqual(self.table.error_deg.abs().max(), 3)
        self.assertEqual((self.table["error_deg"].min(), self.table.error_deg.mean()), (-3, -1))
        self.assertEqual(
            (len(self.table), list(self.table.index), self.table.columns), (3, [40, 41, 42], ["t", "error_deg"])
        )
        self.assertEqual(self.table.t[1:].tolist(), [0.5, 1.0])
        self.assertTrue(math.isnan(samples.Column([]).max()))
        with self.assertRaisesRegex(AttributeError, "no column 'x', but t, error_deg"):
            self.table.x

    def test_figures(self):
        html = self.table._repr_html_()
        self.assertEqual(html.count("<svg"), 1)
        self.assertIn('aria-label="error_deg"', html)
        self.assertEqual(figure.line_plot([float("nan")], "x"), "")
        self.assertIn("&lt;x", figure.line_plot([1, 1], "<x"))

    def test_a_long_curve_keeps_its_extremes_and_stays_small(self):
        values = [math.sin(i / 1000) for i in range(100_000)]
        values[54_321] = 9
        svg = figure.line_plot(values, "x")
        self.assertIn(">9<", svg)
        self.assertLess(len(svg), 20_000)


class Program(Case):
    def test_the_order_of_places(self):
        first, second = self.folder / "first", self.folder / "second"
        for folder in (first, second):
            folder.mkdir()
            fake_session.program(folder)
        with mock.patch.dict(os.environ, {"CAPSOC": str(second)}):
            self.assertEqual(program.find_program(first / "capsoc"), first / "capsoc")
            self.assertEqual(program.find_program(), second / "capsoc")

    def test_a_named_place_without_it(self):
        with self.assertRaisesRegex(capsoc.ProgramNotFound, "is no program .named by program."):
            capsoc.find_program(self.folder / "absent")
        with mock.patch.dict(os.environ, {"CAPSOC": "/nowhere"}):
            with self.assertRaisesRegex(capsoc.ProgramNotFound, "environment variable CAPSOC"):
                capsoc.Session()

    def test_firmware_by_name(self):
        (self.folder / "firmware").mkdir()
        (self.folder / "firmware" / "selfcal.elf").touch()
        own = self.folder / "own.elf"
        own.touch()
        place = self.folder / "capsoc"
        for name in ("selfcal", "selfcal.elf"):
            self.assertEqual(program.find_firmware(name, place), str(self.folder / "firmware" / "selfcal.elf"))
        self.assertEqual(program.find_firmware(own, place), str(own))
        self.assertEqual(program.find_firmware("absent.elf", place), "absent.elf")

    def test_no_socket(self):
        with self.assertRaisesRegex(capsoc.SessionError, "No session listens on .*/absent"):
            capsoc.Session(socket=self.folder / "absent")


class Expectations(Case):
    def setUp(self):
        super().setUp()
        session = capsoc.Session(fake_session.program(self.folder))
        self.addCleanup(session.close)
        texts = [[1.0, "boot\n"], [2.0, "one 1\ntwo 2\n"], [41.0, "t   41 s: lock\n"]]
        self.simulation = session.run("x.elf", settings={"fake.uart0": texts, "fake.end_s": 100.0})

    def test_groups_and_time(self):
        found = self.simulation.uart0.expect(r"(\d+) s: (lock|unlock)", within=120)
        self.assertEqual((found[0], found[1], found.groups()), ("41 s: lock", "41", ("41", "lock")))
        self.assertEqual(self.simulation.state.time_s, 41)

    def test_text_is_matched_once_and_in_order(self):
        uart = self.simulation.uart[0]
        self.assertEqual(uart.expect("one (.)").before, "boot\n")
        self.assertEqual(
            uart.expect(re.compile("^TWO (.)$", re.IGNORECASE))[1], "2"
        )  # was there already: no time passes
        self.assertEqual(self.simulation.time_s, 2)
        with self.assertRaises(capsoc.ExpectationError):
            uart.expect("one", within=10)

    def test_the_limit(self):
        with self.assertRaises(AssertionError) as raised:
            self.simulation.uart0.expect("pass", within=5)
        self.assertEqual(
            str(raised.exception),
            "UART 0 did not send 'pass' within 5 simulated s: it is 5.000000 s and the program is at main (main.c:55). "
            "The last 3 lines:\n  | boot\n  | one 1\n  | two 2",
        )
        self.assertEqual((raised.exception.time_s, raised.exception.place), (5, "main (main.c:55)"))
        self.assertIsInstance(raised.exception, capsoc.SimulationError)

    def test_the_end_of_the_program(self):
        with self.assertRaisesRegex(capsoc.ExpectationError, "did not send 'x' before the program ended: it is 100.0"):
            self.simulation.uart1.expect("x", within=1000)
        with self.assertRaises(capsoc.SimulationOver):
            self.simulation.advance(1)

    def test_advance_and_its_truth(self):
        self.assertTrue(self.simulation.advance(seconds=1))
        self.assertFalse(self.simulation.until(uart=(0, "never"), within=1))
        self.assertTrue(self.simulation.advance())
        with self.assertRaisesRegex(ValueError, "seconds and cycles exclude each other"):
            self.simulation.advance(1, cycles=2)

    def test_a_refused_setting(self):
        with self.assertRaisesRegex(capsoc.SimulationError, "sensor.a1: -1"):
            self.simulation.session.run("x.elf", sensor=capsoc.Sensor(a1=-1))

    def test_a_with_statement_closes_on_every_way_out(self):
        with self.simulation as simulation:
            pass
        self.assertTrue(simulation.closed)
        again = simulation.session.run("x.elf")
        with self.assertRaises(ZeroDivisionError), again:
            1 / 0
        self.assertTrue(again.closed)
        self.assertIn("closed", repr(again))


class Campaigns(Case):
    def setUp(self):
        super().setUp()
        self.program = fake_session.program(self.folder, late={"simulation.finish": 0.01})

    def test_rows_in_order(self):
        def run(session):
            with session.run("x.elf") as simulation:
                return {"time_s": simulation.advance(2).state.time_s}

        runs = [run, {"elf": "x.elf", "sensor": capsoc.Sensor(a1=-1)}, lambda session: 7]
        runs += [{"elf": "x.elf", "settings": {"fake.end_s": n}} for n in range(8)]
        rows = capsoc.Campaign(
            runs, measure=lambda simulation, result: {"end": simulation.time_s}, program=self.program, jobs=4
        ).results()
        self.assertEqual([row["run"] for row in rows], list(range(11)))
        self.assertEqual(rows[0], {"run": 0, "name": "run", "time_s": 2.0})
        self.assertEqual(rows[1]["error"], "SimulationError: sensor.a1: -1 is not between 1e-6 and 10.")
        self.assertEqual(rows[2]["value"], 7)
        self.assertIn("SimulationOver", rows[3]["error"])
        self.assertEqual([row["end"] for row in rows[4:]], [1, 2, 3, 4, 5, 6, 7])

    def test_the_usual_row(self):
        (row,) = capsoc.Campaign([{"elf": "x.elf", "settings": {"fake.end_s": 1}}], program=self.program).results()
        self.assertEqual((row["code"], row["reason"]), (5, "the firmware crashed"))


class Small(unittest.TestCase):
    def test_modules_stay_small(self):
        files = list((SOURCE / "platform" / "python" / "capsoc").glob("*.py"))
        self.assertGreater(len(files), 10)
        for file in files:
            self.assertLess(len(file.read_text().splitlines()), 300, file)

    def test_the_version_is_the_projects(self):
        version = re.search(r"VERSION (\d+\.\d+\.\d+)", (SOURCE / "CMakeLists.txt").read_text())[1]
        self.assertEqual(capsoc.__version__, version)
        self.assertIn(f'version = "{version}"', (SOURCE / "platform" / "python" / "pyproject.toml").read_text())


if __name__ == "__main__":
    unittest.main()
