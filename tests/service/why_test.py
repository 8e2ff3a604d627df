#!/usr/bin/python3
"""history.why: the values that made a signal of the coprocessor, compared with the papers' equations in double."""

import math
import random
import re
import unittest

from history_test import SHORT, Past
from protocol_test import Refused

CTEST = {"name": "service: why", "timeout": 300, "interpreter": "/usr/bin/python3"}

SEED = 20261127
SIGNALS = ("angle", "error_u", "error_v", "a_u", "phi", "turn_flags", "status")


class Reasons(Past):
    def why(self, simulation, signal, **sample):
        return self.session("history.why", simulation=simulation, signal=signal, **sample)

    def values(self, answer):
        return {step["name"]: step.get("value", step["word"]) for step in answer["steps"]}


class Values(Reasons):
    def check_equations(self, answer):
        """Of `precise`: Eq (7), (13) and (8) to (12) of the paper, as docs/reference/coprocessor.md has them."""
        value, inputs = self.values(answer), answer["inputs"]

        def weight(name):
            high, low = ((int(inputs[f"{name}_{half}"]) ^ 1 << 31) - (1 << 31) for half in ("HI", "LO"))
            return high / 2**31 + low / 2**46

        if "error_u" in value:
            estimate = weight("AU") * value["sine"] + weight("BU") * value["cosine"] + weight("CU")
            self.assertAlmostEqual(value["error_u"], inputs["sample.sin"] / 2**31 - estimate, delta=1e-8)
        if "error_v" in value:
            estimate = weight("AV") * value["sine"] + weight("BV") * value["cosine"] + weight("CV")
            self.assertAlmostEqual(value["error_v"], inputs["sample.cos"] / 2**31 - estimate, delta=1e-8)
        if "det" in value:
            self.assertAlmostEqual(value["det"], weight("AU") * weight("BV") - weight("AV") * weight("BU"), delta=1e-8)
        if "relative" in value:
            u, v = inputs["sample.sin"] / 2**31 - weight("CU"), inputs["sample.cos"] / 2**31 - weight("CV")
            s, c = weight("BV") * u - weight("BU") * v, weight("AU") * v - weight("AV") * u
            away = math.degrees(math.atan2(s, c)) - value["relative"]
            self.assertAlmostEqual(math.remainder(away, 360), 0, delta=1e-6)
        if "found_angle" in value:
            away = value["relative"] + value["found_phi"] - value["found_angle"]
            self.assertAlmostEqual(math.remainder(away, 360), 0, delta=1e-6)
            away = math.degrees(math.atan2(value["b_u"], value["a_u"])) - value["found_phi"]
            self.assertAlmostEqual(math.remainder(away, 360), 0, delta=1e-6)

    def test_any_result(self):
        simulation = self.construct(**SHORT)
        self.advance(simulation, until_s=2)
        before = self.session("history.when", simulation=simulation, hash=True)
        rng = random.Random(SEED)
        last = before["now"]["samples"]
        for sample in [1, 2, last, *(rng.randrange(3, last) for _ in range(6))]:
            answers = [self.why(simulation, signal, sample=sample) for signal in SIGNALS]
            self.session("simulation.goto", simulation=simulation, sample=sample)
            seen = self.session("coprocessor.read", simulation=simulation)["signals"]
            self.session("simulation.goto", simulation=simulation, time_ps=before["now"]["time_ps"])
            for signal, answer in zip(SIGNALS, answers):
                with self.subTest(sample=sample, signal=signal):
                    self.assertEqual((answer["sample"], answer["position"]["samples"]), (sample, sample))
                    first = answer["steps"][0]
                    self.assertEqual(first["name"], signal)
                    self.check_equations(answer)
                    name = {"angle": "angle_deg", "phi": "phi_deg"}.get(signal, signal)
                    if name in seen:
                        away = first.get("value", first["word"]) - seen[name]
                        self.assertAlmostEqual(math.remainder(away, 360), 0, delta=1e-9)
        self.assertEqual(self.session("history.when", simulation=simulation, hash=True), before)

    def test_every_step_names_what_is_there(self):
        simulation = self.construct(**SHORT)
        self.advance(simulation, samples=300)
        for signal in SIGNALS:
            answer = self.why(simulation, signal)
            names = [step["name"] for step in answer["steps"]]
            pairs = {name[:-3] for name in answer["inputs"] if name.endswith(("_HI", "_LO"))}
            for at, step in enumerate(answer["steps"]):
                for source in step["made_from"]:
                    self.assertTrue(
                        source in names[at + 1 :] or source in answer["inputs"] or source in pairs, (step, source)
                    )

    def test_model_and_rtl_say_the_same(self):
        answers = []
        for backend in ("tlm", "rtl", "lockstep"):
            simulation = self.construct(**SHORT, **{"coprocessor.backend": backend})
            self.advance(simulation, samples=70)
            answers.append([self.why(simulation, signal) for signal in SIGNALS])
            self.session("simulation.close", simulation=simulation)
        self.assertEqual(answers[0], answers[1])
        self.assertEqual(answers[0], answers[2])

    def test_of_paper(self):
        simulation = self.construct(**SHORT, **{"coprocessor.arithmetic": "paper"})
        self.advance(simulation, samples=300)
        answer = self.why(simulation, "angle")
        value = self.values(answer)
        self.assertIn("BETA", answer["inputs"])
        self.assertNotIn("AU_HI", self.why(simulation, "relative")["inputs"])
        self.assertAlmostEqual(
            math.degrees(math.atan2(value["cal_s"], value["cal_c"])) % 360, value["angle"] % 360, delta=1e-3
        )

    def test_what_was_written_on_the_way(self):
        simulation = self.construct(**SHORT)
        self.advance(simulation, samples=100)
        for word in (0x123456, 0x654321):
            self.session("register.write", simulation=simulation, name="COPROCESSOR.STEP_AU", value=word)
            self.advance(simulation, samples=1)
            self.assertEqual(self.why(simulation, "a_u")["inputs"]["STEP_AU"], word)
        self.assertEqual(self.why(simulation, "a_u", sample=101)["inputs"]["STEP_AU"], 0x123456)

    def test_refusals(self):
        simulation = self.construct(**SHORT)
        with self.assertRaisesRegex(Refused, "there are 0 results"):
            self.why(simulation, "angle")
        self.advance(simulation, samples=3)
        for signal, sample, sentence in (
            ("angel", {}, "the coprocessor has no signal 'angel'; did you mean angle"),
            ("angle", {"sample": 0}, "sample counts from 1"),
            ("angle", {"sample": 4}, "there are 3 results"),
        ):
            with self.subTest(sentence), self.assertRaisesRegex(Refused, re.escape(sentence)):
                self.why(simulation, signal, **sample)


if __name__ == "__main__":
    unittest.main()
