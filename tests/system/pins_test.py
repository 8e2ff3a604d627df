#!/usr/bin/env python3
"""GPIO, buttons and LEDs on files, scripts and sockets."""

import re
import socket
import subprocess
import unittest

from harness import CAPSOC, CLEAN, Case, FIRMWARE

CTEST = {"name": "system: Pins", "whole": True}

PINS = FIRMWARE / "pins.elf"
PATIENCE = 60


class Pins(Case):
    def setUp(self):
        super().setUp()
        self.script = self.folder / "pins.txt"
        self.script.write_text("# time pin level\n0.010 0 1\n0.010 2 1\n\n0.020 0 0  # 4\n0.030 2 0\n")
        self.buttons = self.folder / "buttons.txt"
        self.buttons.write_text("0.015 0 1\n0.016 0 0\n0.040 1 1\n")

    def run_it(self, *options, code=0):
        done = subprocess.run(
            [CAPSOC, "run", PINS, *map(str, options)], capture_output=True, timeout=PATIENCE, check=False, env=CLEAN
        )
        self.assertEqual(done.returncode, code, done.stderr.decode())
        return done.stdout.decode(), done.stderr.decode()

    def test_a_script_drives_and_files_take(self):
        gpio, leds = self.folder / "gpio1.txt", self.folder / "leds.txt"
        results = set()
        for options in ([], ["-C", "cpu.executor=stepping"], ["--quantum", "1000"], ["-C", "cpu.fast_forward=false"]):
            out, _ = self.run_it(
                "--gpio0",
                f"script:{self.script}",
                "--buttons",
                f"script:{self.buttons}",
                "--gpio1",
                f"file:{gpio}",
                "--leds",
                f"file:{leds}",
                *options,
            )
            results.add((out, gpio.read_text(), leds.read_text()))
        ((out, said, lit),) = results
        self.assertEqual(
            out, "".join(f"pins {p} buttons {b}\n" for p, b in ((0, 0), (5, 0), (5, 1), (5, 0), (4, 0), (0, 0), (0, 2)))
        )
        events = [(float(t), int(pin), level) for t, pin, level in map(str.split, said.splitlines())]
        # From 0 (0x3f) to 5 (0x6d): b and e go out, g comes on; to 4 (0x66): a, d go out, b comes on.
        self.assertEqual([e[1:] for e in events if 0.010 < e[0] < 0.015], [(1, "0"), (4, "0"), (6, "1")])
        self.assertEqual([e[1:] for e in events if 0.020 < e[0] < 0.025], [(0, "0"), (1, "1"), (3, "0")])
        self.assertTrue(
            all(
                0 < time - base < 1e-3
                for time, base in zip((float(line.split()[0]) for line in lit.splitlines()), (0.010, 0.020))
            ),
            lit,
        )
        self.assertEqual([line.split()[1:] for line in lit.splitlines()], [["0", "1"], ["0", "0"]])

    def test_what_one_board_says_another_one_hears(self):
        said = self.folder / "said.txt"
        self.run_it("--gpio0", f"script:{self.script}", "--buttons", f"script:{self.buttons}", "--leds", f"file:{said}")
        out, _ = self.run_it("--gpio0", f"script:{said}", "--buttons", f"script:{self.buttons}")
        self.assertIn("pins 1 buttons 0", out)

    def test_a_socket(self):
        process = subprocess.Popen(
            [CAPSOC, "run", PINS, "--gpio0", "tcp", "--buttons", "tcp"],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env=CLEAN,
        )
        self.addCleanup(process.stderr.close)
        self.addCleanup(process.stdout.close)
        try:
            ports = {}
            for _ in range(2):
                name, port = re.search(r"(\w+): .*?:(\d+)", process.stderr.readline().decode()).groups()
                ports[name] = int(port)
            with socket.create_connection(("127.0.0.1", ports["gpio0"]), PATIENCE) as gpio:
                gpio.sendall(b"nonsense\n99 1\n3 1\n")
                self.assertEqual(gpio.recv(200).splitlines()[0], b"# write PIN LEVEL (3 1), the pin below 16")
                while b"pins 8" not in process.stdout.readline():
                    pass
                with socket.create_connection(("127.0.0.1", ports["buttons"]), PATIENCE) as buttons:
                    buttons.sendall(b"1 1\n")
                    self.assertIn(b"buttons 2", process.stdout.read())
                    self.assertEqual(process.wait(PATIENCE), 0)
        finally:
            process.kill()
            process.wait()

    def test_the_terminal_has_leds_and_a_digit(self):
        _, said = self.run_it(
            "--gpio0",
            f"script:{self.script}",
            "--buttons",
            f"script:{self.buttons}",
            "--leds",
            "terminal",
            "-C",
            "leds.seven_segment=1",
        )
        shown = re.findall(r"^\[\d\.\d{6} s\]  LEDs ([.*]{2} [.*]{8})  digit (.)", said, re.MULTILINE)
        self.assertEqual(
            shown,
            [
                (".. ........", " "),
                (".. ........", "0"),
                (".. ........", "5"),
                ("*. ........", "5"),
                ("*. ........", "4"),
                (".. ........", "4"),
                (".. ........", "0"),
            ],
        )

    def test_what_is_wrong_is_one_sentence(self):
        for text, line in (
            ("0.5 3\n", 1),
            ("\n0.5 16 1\n", 2),
            ("0.5 3 2\n", 1),
            ("soon 3 1\n", 1),
            ("1 0 1\n0.5 0 0\n", 2),
            ("-1 0 1\n", 1),
            ("1e7 0 1\n", 1),
            ("0.5 3 1 1\n", 1),
            ("0.5 99999999999999999999 1\n", 1),
        ):
            self.script.write_text(text)
            _, said = self.run_it("--gpio0", f"script:{self.script}", code=2)
            self.assertRegex(said, rf"^capsoc: .*pins\.txt:{line}: ")
            self.assertEqual(said.count("\n"), 1)
        for option, spec in (
            ("--gpio0", "stdout"),
            ("--gpio3", "script:"),
            ("--gpio1", "telepathy"),
            ("--buttons", "tcp:99999"),
            ("--gpio2", "file:"),
            ("--leds", "stdio"),
        ):
            _, said = self.run_it(option, spec, code=2)
            self.assertIn(f"{option} {spec}: choose ", said)
            self.assertNotIn("stdout,", said, "what pins cannot have is not offered")
        _, said = self.run_it("--gpio0", f"script:{self.folder}/none", code=2)
        self.assertIn("none: cannot be read", said)
        _, said = self.run_it("--gpio0", f"script:{self.buttons}", "--gpio1", f"file:{self.buttons}", code=2)
        self.assertIn("gpio1", said)
        self.assertTrue(self.buttons.read_text().startswith("0.015"), "an input is no output")


if __name__ == "__main__":
    unittest.main()
