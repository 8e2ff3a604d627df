#!/usr/bin/env python3
"""docs/reference/commands.md has the exit codes of --help, which are those of exit_codes.def."""

import re
import subprocess
import unittest

from harness import CAPSOC, CLEAN, SOURCE

CTEST = {"name": "quality: exit codes", "whole": True}


class ExitCodes(unittest.TestCase):
    def test_the_page_has_those_of_help(self):
        said = subprocess.run([CAPSOC, "--help"], capture_output=True, text=True, check=True, env=CLEAN).stdout
        told = re.findall(r"^  (\d+(?:\+n)?) +(.+)$", said[said.index("Exit codes:") :], re.MULTILINE)
        self.assertGreater(len(told), 8)
        page = (SOURCE / "docs" / "reference" / "commands.md").read_text(encoding="utf-8")
        rows = dict(re.findall(r"^\| (\d+(?:\+n)?) \| (.+) \|$", page[page.index("## Exit codes") :], re.MULTILINE))
        self.assertEqual(list(rows), [code for code, _ in told])
        for code, meaning in told[:-1]:
            self.assertTrue(rows[code].startswith(meaning), (code, meaning, rows[code]))


if __name__ == "__main__":
    unittest.main()
