#!/usr/bin/python3
"""Faults in a session: at the same instants, whichever way the simulation came there."""

import unittest

from protocol_test import Driven, Refused

CTEST = {"name": "service: faults", "interpreter": "/usr/bin/python3"}

SETTINGS = {
    "program.demodulation_samples": "150",
    "program.calibration_samples": "20",
    "inject.faults": "flip coprocessor.bu[40] at 0.1s,flip mem:0x003fff00[3] at 0.3s,lose sample at sample 100",
}


class SessionFaults(Driven):
    def look(self, simulation, until):
        self.advance(simulation, until_s=until)
        return self.session("history.when", simulation=simulation, hash=True)["sha256"]

    def test_a_history_repeats_them(self):
        plain = self.construct("selfcal", **SETTINGS)
        early, late = self.look(plain, 0.2), self.look(plain, 0.6)
        driven = self.construct("selfcal", **SETTINGS)
        self.assertEqual(self.look(driven, 0.6), late)
        self.session("simulation.goto", simulation=driven, time_ps=50_000_000_000)
        self.assertEqual(self.look(driven, 0.2), early)
        self.assertEqual(self.look(driven, 0.6), late)
        free = dict(SETTINGS)
        free.pop("inject.faults")
        self.assertNotEqual(self.look(self.construct("selfcal", **free), 0.2), early)

    def test_a_snapshot_has_what_they_did(self):
        first = self.construct("selfcal", **SETTINGS)
        self.advance(first, until_s=0.2)
        snapshot = self.session("simulation.snapshot", simulation=first)["snapshot"]
        late = self.look(first, 0.6)
        second = self.construct("selfcal", **SETTINGS)
        self.session("simulation.restore", simulation=second, snapshot=snapshot)
        self.assertEqual(self.look(second, 0.6), late)

    def test_no_snapshot_while_one_lasts(self):
        held = SETTINGS | {"inject.faults": "stuck1 coprocessor.bu[40] at 0.1s"}
        simulation = self.construct("selfcal", **held)
        self.advance(simulation, until_s=0.2)
        with self.assertRaises(Refused) as refused:
            self.session("simulation.snapshot", simulation=simulation)
        self.assertIn("while a fault lasts (stuck1 coprocessor.bu[40] at 0.1s)", str(refused.exception))


if __name__ == "__main__":
    unittest.main()
