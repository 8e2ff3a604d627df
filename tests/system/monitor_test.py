#!/usr/bin/env python3
"""The TLM-2.0 base protocol between all parts of the SoC, checked while programs run (soc.monitor)."""

import re
import unittest

from harness import CAPSOC, FIRMWARE, Case, output_of, without_host_times

CTEST = {"name": "system: monitor"}


class Monitor(Case):
    def run_program(self, name, *options, code=0):
        """The result of a run, without what the option and the host say."""
        output_of(
            CAPSOC, "run", FIRMWARE / name, "--uart0", "null", "--json", self.folder / "r.json", *options, code=code
        )
        result = without_host_times(self.result())
        result.pop("command")
        result["configuration"].pop("soc.monitor", None)
        return result

    def test_programs_give_the_same_results_and_break_no_rule(self):
        # Exit code 70 would say that a rule was broken.
        for name, code, *options in (
            ("drivers.elf", 0),
            ("board.elf", 0),
            ("transmit.elf", 0),
            ("threads.elf", 0),
            ("mpu.elf", 0),
            ("bench_interrupts.elf", 124, "--simlimit", "0.2"),
            ("selfcal.elf", 124, "--simlimit", "2"),
            ("selfcal.elf", 124, "--simlimit", "1", "-C", "cpu.executor=stepping", "-C", "cpu.fast_forward=false"),
            ("track.elf", 124, "--simlimit", "1", "--trace-bus", self.folder / "bus.txt"),
        ):
            with self.subTest(name, options=options):
                self.assertEqual(
                    self.run_program(name, *options, "-C", "soc.monitor=true", code=code),
                    self.run_program(name, *options, code=code),
                )

    def test_the_calls_are_counted_in_the_log(self):
        log = output_of(
            "sh",
            "-c",
            '"$@" 2>&1',
            "sh",
            CAPSOC,
            "run",
            FIRMWARE / "hello.elf",
            "-C",
            "soc.monitor=true",
            "--log-level",
            "info",
        )
        calls, violations = re.search(r"soc\.monitor: (\d+) calls, (\d+) violations", log).groups()
        self.assertGreater(int(calls), 50)
        self.assertEqual(violations, "0")


if __name__ == "__main__":
    unittest.main()
