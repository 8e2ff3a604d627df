#!/usr/bin/env python3
"""The README's exit codes are those of --help, which are those of platform/simulation/results/exit_codes.def."""

import re
import subprocess
import unittest

from harness import CAPSOC, CLEAN, SOURCE

CTEST = {"name": "quality: exit codes", "whole": True}


class ExitCodes(unittest.TestCase):
    def test_the_readme_has_those_of_help(self):
        said = subprocess.run([CAPSOC, "--help"], capture_output=True, text=True, check=True, env=CLEAN).stdout
        told = re.findall(r"^  (\d+(?:\+n)?) +(.+)$", said[said.index("Exit codes:") :], re.MULTILINE)
        self.assertGreater(len(told), 8)
        readme = (SOURCE / "README.md").read_text(encoding="utf-8")
        rows = dict(
            re.findall(r"^\| (\d+(?:\+n)?) \| (.+) \|$", readme[readme.index("### Exit codes") :], re.MULTILINE)
        )
        self.assertEqual(list(rows), [code for code, _ in told])
        for code, meaning in told[:-1]:
            self.assertTrue(rows[code].startswith(meaning), (code, meaning, rows[code]))


if __name__ == "__main__":
    unittest.main()
