#!/usr/bin/env python3
"""RTL with its assertions switched on and every edge evaluated whole: what the program's own libraries leave out.

The oracles are the assertions, which end the process, the model, and the program's libraries, which find the same.
"""

import subprocess
import unittest

from harness import BUILD, CAPSOC, CLEAN, FIRMWARE, TRACES, Case, without_host_times

CTEST = {"name": "rtl: checked", "whole": True, "timeout": 600}


def checked(arithmetic):
    return BUILD / f"libcapsoc_rtl_{arithmetic}_checked.so"


class Checked(Case):
    def run_capsoc(self, *arguments, code=0):
        command = [CAPSOC, *map(str, arguments)]
        done = subprocess.run(
            command, capture_output=True, text=True, check=False, cwd=self.folder, env=CLEAN, timeout=300
        )
        self.assertEqual(done.returncode, code, done.stdout[-2000:] + done.stderr[-2000:])
        return done.stdout

    def outcome(self, *arguments):
        """What a run prints and finds, without where its RTL is from."""
        printed = self.run_capsoc("run", *arguments, "--json", "r.json", code=124)
        found = without_host_times(self.result())
        found.pop("command")
        found["configuration"].pop("coprocessor.rtl_library")
        return printed, found

    def test_the_regression(self):
        for arithmetic in ("precise", "paper"):
            amounts = ("--samples", 5000, "--accesses", 2000)
            self.run_capsoc("regress", "--arithmetic", arithmetic, "--rtl-library", checked(arithmetic), *amounts)

    def test_programs_have_the_same_words(self):
        for program, trace in (("selfcal", "soc_eq21.toml"), ("track", "soc_051hz.toml")):
            for arithmetic in ("precise", "paper"):
                for backend in ("rtl", "lockstep"):
                    with self.subTest(program=program, arithmetic=arithmetic, backend=backend):
                        common = (FIRMWARE / f"{program}.elf", "--sensor", TRACES / trace, "--arithmetic", arithmetic)
                        common += ("--coprocessor", backend, "--simlimit", 2)
                        self.assertEqual(
                            self.outcome(*common, "--rtl-library", checked(arithmetic)), self.outcome(*common)
                        )


if __name__ == "__main__":
    unittest.main()
