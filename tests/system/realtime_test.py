#!/usr/bin/env python3
"""`--realtime`: simulated time paced to the host's. How long a run takes, when a key arrives, and that nothing else
changes.
"""

import json
import re
import signal
import subprocess
import time
import unittest

from harness import CAPSOC, CLEAN, Case, FIRMWARE

CTEST = {"name": "realtime", "serial": True, "long": ["TenSeconds"]}


class Paced(Case):
    def start(self, program, *options):
        return subprocess.Popen(
            [CAPSOC, "run", FIRMWARE / f"{program}.elf", "--json", self.folder / "r.json", *map(str, options)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env=CLEAN,
        )

    def results(self):
        return json.loads((self.folder / "r.json").read_text())

    def timed(self, program, *options):
        """Exit code, stderr, and the host's seconds without what starting a process takes."""
        process = self.start(program, *options)
        _, said = process.communicate(timeout=60)
        return process.returncode, said.decode(), self.results()["time"]["wall_s"]

    def key_arrives(self, seconds):
        """A byte that is sent so long after another one arrives so much later in simulated time."""
        trace = self.folder / "bus.txt"
        process = self.start("echo", "--uart0", "stdio", "--realtime", "--trace-bus", trace)
        time.sleep(0.2)
        begin = time.monotonic()
        process.stdin.write(b"\0")
        process.stdin.flush()
        time.sleep(seconds)
        process.stdin.write(b"\0\0\0")
        process.stdin.flush()
        waited = time.monotonic() - begin
        process.communicate(timeout=60)
        self.assertEqual(process.returncode, 0)
        reads = [
            line.split()
            for line in trace.read_text().splitlines()
            if re.search(r"\b40004000\b.* read ", line + " ") or ("40004000" in line and " read" in line)
        ]
        times = [float(re.search(r"\d+\.\d{6,}", " ".join(line)).group(0)) for line in reads]
        self.assertEqual(len(times), 4, trace.read_text()[-2000:])
        self.assertAlmostEqual(times[1] - times[0], waited, delta=0.05)


class Pace(Paced):
    def test_an_idle_second_takes_a_second(self):
        code, _, wall = self.timed("echo", "--uart0", "null", "--realtime", "--simlimit", 1)
        self.assertEqual(code, 124)
        self.assertAlmostEqual(wall, 1, delta=0.05)

    def test_a_busy_one_too_and_a_factor(self):
        _, _, wall = self.timed("forever", "--realtime", "5", "--simlimit", 1)
        self.assertAlmostEqual(wall, 0.2, delta=0.05)
        _, _, wall = self.timed("forever", "--realtime", "0.1", "--simlimit", 0.1)
        self.assertAlmostEqual(wall, 1, delta=0.05)

    def test_a_key_arrives_when_it_is_typed(self):
        self.key_arrives(1)

    def test_an_interrupt_ends_it_at_once(self):
        process = self.start("echo", "--uart0", "null", "--realtime", "--simlimit", 100)
        time.sleep(0.4)
        begin = time.monotonic()
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=30)
        self.assertLess(time.monotonic() - begin, 0.3)
        self.assertEqual(process.returncode, 128 + signal.SIGINT)

    def test_after_a_pause_it_catches_up_for_a_second_at_most(self):
        process = self.start("forever", "--realtime", "--simlimit", 2)
        time.sleep(0.5)
        process.send_signal(signal.SIGSTOP)
        time.sleep(2.5)
        process.send_signal(signal.SIGCONT)
        _, said = process.communicate(timeout=60)
        self.assertIn("realtime: the host was too slow, or stopped, for 1.", said.decode())
        self.assertAlmostEqual(self.results()["time"]["wall_s"], 2 + 1.5, delta=0.3)

    def test_nothing_else_changes(self):
        (self.folder / "in").write_bytes(b"\x05\0\0\0hello")
        outcomes = set()
        for program, options in (
            ("echo", ["-C", f"uart0.input={self.folder}/in"]),
            ("threads", []),
            ("selfcal", ["--simlimit", "0.3"]),
        ):
            outcomes.clear()
            for pace in ([], ["--realtime", "3"], ["--realtime", "2", "--quantum", "10000"]):
                process = self.start(program, *options, *pace)
                printed, _ = process.communicate(timeout=60)
                r = self.results()
                outcomes.add(
                    (
                        process.returncode,
                        printed,
                        r["cpu"]["cycles"],
                        r["cpu"]["instructions"],
                        r["time"]["simulated_s"],
                    )
                )
            self.assertEqual(len(outcomes), 1, program)

    def test_a_sleep_without_end_is_still_seen(self):
        process = self.start("echo", "--uart0", "null", "--realtime")
        _, said = process.communicate(timeout=20)
        self.assertIn("sleeps and nothing is left that could wake it", said.decode())

    def test_wrong_factors_are_refused(self):
        for factor in ("fast", "-1", "1e9"):
            process = self.start("echo", f"--realtime={factor}")
            _, said = process.communicate(timeout=20)
            self.assertEqual(process.returncode, 2, said)
            self.assertIn("--realtime", said.decode())


class TenSeconds(Paced):
    """The same for as long as a person would look at it."""

    def test_ten_idle_seconds(self):
        _, _, wall = self.timed("echo", "--uart0", "null", "--realtime", "--simlimit", 10)
        print(f"realtime: 10 simulated s took {wall:.4f} s")
        self.assertAlmostEqual(wall, 10, delta=0.05)

    def test_a_key_at_three_seconds(self):
        self.key_arrives(3)


if __name__ == "__main__":
    unittest.main()
