#!/usr/bin/env python3
"""A proof that fails leaves its counterexample as waves, and says in which cycle of them it fails."""

import os
import re
import signal
import subprocess
import time
import unittest
from pathlib import Path

from harness import CLEAN, SOURCE, Case

CTEST = {"name": "rtl: waves of proofs", "timeout": 120}
FAILS = re.compile(r"(\w+): fails in cycle (\d+) \(0 is ([^)]*)\): (\S+), at (\d+) ns")


def words(text, name):
    """The values of a signal of the outermost module, cycle by cycle, of a VCD file of yosys-smtbmc."""
    code = re.search(rf"^\$var wire \d+ (\S+) {name} \$end$", text, re.MULTILINE)[1]
    return [int(word, 2) for word in re.findall(rf"^b([01]+) {code}$", text, re.MULTILINE)]


class Waves(Case):
    def formal(self, *arguments):
        return subprocess.run(
            [SOURCE / "scripts" / "tool", "formal", *arguments],
            capture_output=True,
            text=True,
            check=False,
            cwd=self.folder,
            env=CLEAN,
            timeout=100,
        )

    def test_a_counterexample_is_a_file_whose_last_cycle_fails(self):
        done = self.formal("--with-fault", "--waves", "w", "sequencer", "sample_counters")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        found = {match[1]: match for match in FAILS.finditer(done.stdout)}
        self.assertEqual(set(found), {"sequencer", "sample_counters"}, done.stdout)
        for proof, begin in (("sequencer", "the first"), ("sample_counters", "a state that the assertions allow")):
            _, cycle, first, file, time = found[proof].groups()
            self.assertTrue(first.startswith(begin), first)
            self.assertEqual(int(time), 10 * int(cycle))
            self.assertIn(f"#{10 * int(cycle) + 10}\n", (self.folder / file).read_text())
        # The assertion that fails compares these two.
        text = (self.folder / found["sample_counters"][4]).read_text()
        count, due = words(text, "early_count"), words(text, "early_due")
        self.assertNotEqual(count[-1], due[-1])
        self.assertEqual(count[-2], due[-2])

    def test_faults_that_are_found_leave_nothing_unasked(self):
        done = self.formal("--with-fault", "sample_counters")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertEqual(list(self.folder.iterdir()), [])
        self.assertNotIn("fails in cycle", done.stdout)


def working_below(folder):
    """The processes whose working directory is there."""
    found = []
    for each in Path("/proc").glob("[0-9]*/cwd"):
        try:
            if Path(os.readlink(each)).is_relative_to(folder):
                found.append((each.parent / "comm").read_text().strip())
        except OSError:
            pass  # it has ended
    return found


class Ended(Case):
    def wait(self, condition, seconds=60):
        end = time.monotonic() + seconds
        while not condition() and time.monotonic() < end:
            time.sleep(0.1)
        self.assertTrue(condition(), working_below(self.folder))

    def test_a_signal_ends_the_solver_and_leaves_no_files(self):
        command = [SOURCE / "scripts" / "tool", "formal", "register_bank"]
        with subprocess.Popen(
            command, env={**CLEAN, "TMPDIR": str(self.folder)}, stdout=subprocess.DEVNULL, start_new_session=True
        ) as formal:
            self.wait(lambda: "z3" in working_below(self.folder))
            formal.terminate()
            self.assertEqual(formal.wait(20), 128 + signal.SIGTERM)
        self.wait(lambda: not working_below(self.folder), 5)
        self.assertEqual(list(self.folder.iterdir()), [])


if __name__ == "__main__":
    unittest.main()
