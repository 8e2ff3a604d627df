#!/usr/bin/env python3
"""A proof that fails leaves its counterexample as waves, and says in which cycle of them it fails."""

import re
import subprocess
import unittest

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


if __name__ == "__main__":
    unittest.main()
