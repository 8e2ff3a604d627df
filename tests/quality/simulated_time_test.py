#!/usr/bin/env python3
"""Simulated time becomes seconds in one place, models/kit/seconds.h: versions of SystemC round otherwise."""

import re
import unittest

from harness import SOURCE

CTEST = {"name": "quality: simulated time", "whole": True}

#: The place itself, and a question for SystemC's resolution, in whole picoseconds.
PLACES = {"models/kit/seconds.h", "platform/simulation/trace/picoseconds.h"}


class SimulatedTime(unittest.TestCase):
    def test_seconds_come_from_one_place(self):
        found = set()
        for folder in ("models", "platform"):
            for path in sorted((SOURCE / folder).rglob("*")):
                if path.suffix in (".h", ".cpp") and re.search(
                    r"(?:\.|->)to_seconds\(\)|1000 \* 1e-15|resolution_fs", path.read_text(encoding="utf-8")
                ):
                    found.add(str(path.relative_to(SOURCE)))
        self.assertEqual(found, PLACES)


if __name__ == "__main__":
    unittest.main()
