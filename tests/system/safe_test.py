#!/usr/bin/env python3
"""The program `safe`: each of its checks by a fault, in the sample of the fault, and no false alarm."""

import json
import re
import subprocess
import unittest

from harness import CAPSOC, CLEAN, Case, FIRMWARE

CTEST = {"name": "system: Safe", "timeout": 300}

#: An eighth of the main job: a faster shaft, in calibration from 50 s on.
SHORT = ["-P", "demodulation_samples=12500", "-P", "calibration_samples=1000", "-P", "frequency_hz=0.5"]
SHORT += ["-P", "step=0", "-C", "sensor.motion.frequency_hz=0.5"]
#: A sample of the calibration, and a time before the next one.
SAMPLE, WHEN = 12600, "50.405s"


class SafeCase(Case):
    def run_safe(self, *options, program="safe", settings=tuple(SHORT)):
        done = subprocess.run(
            [CAPSOC, "run", FIRMWARE / f"{program}.elf", *settings, "--json", "r.json", "--simlimit", "60", *options],
            capture_output=True,
            text=True,
            check=False,
            env=CLEAN,
            cwd=self.folder,
            timeout=100,
        )
        self.assertIn(done.returncode, (0, 1), done.stderr)
        return done.stdout, json.loads((self.folder / "r.json").read_text())


#: Without those of the coprocessor, and without those that the program computes.
PROGRAM = (*SHORT, "-P", "coprocessor_checks=0")
COPROCESSOR = (*SHORT, "-P", "program_checks=0")


class Checks(SafeCase):
    def test_without_a_fault(self):
        _, selfcal = self.run_safe(program="selfcal")
        for settings in (tuple(SHORT), PROGRAM, COPROCESSOR):
            said, result = self.run_safe(settings=settings)
            self.assertEqual(result["exit"]["code"], 0, said)
            self.assertTrue(result["verdict"]["bound_holds"])
            # The test of the coprocessor comes first, so that sampling begins a little later.
            if settings == PROGRAM:
                for key in ("parameters", "angle_error_deg"):
                    self.assertEqual(result[key], selfcal[key], key)

    def test_each_check_by_a_fault(self):
        at, then = f"at sample {SAMPLE}", f"at {WHEN}"
        inverse = "the angle is not the one of its sample"
        for fault, sentence, late in (
            # Coefficients that move every angle and raise no flag.
            (f"flip coprocessor.cv[39] {then}", inverse, 3),
            (f"flip coprocessor.au[43] {then}", inverse, 60),
            (f"flip sin[25] {at}", inverse, 0),
            (f"flip cos[25] {at}", inverse, 0),
            (f"freeze sin {at}", inverse, 60),
            (f"freeze cos {at}", inverse, 60),
            (f"double sample {at}", "a sample is missing, or there is one too many", 0),
            (f"flip mem:safe+0[30] {then}", "the copy of the parameters has changed", 3),
            # The limits of the checks, and the complement.
            (f"flip mem:safe+28[31] {then}", "the copy of the parameters has changed", 3),
            (f"flip mem:safe+32[31] {then}", "the copy of the parameters has changed", 3),
            (f"flip mem:safe+52[0] {then}", "the copy of the parameters has changed", 3),
            (f"flip COPROCESSOR.CTRL.CALIB[0] {then}", "no valid angle, no lock, or an alarm", 3),
            (f"flip coprocessor.angle[31] {then}", None, None),
        ):
            with self.subTest(fault=fault):
                said, result = self.run_safe("--inject", fault, settings=PROGRAM)
                if sentence is None:
                    # Written again by the next sample before it was read.
                    self.assertEqual(result["exit"]["code"], 0, said)
                    continue
                self.assertEqual(result["exit"]["code"], 1, said)
                self.assertIn(f"safe: fail: {sentence}", said)
                sample = int(re.search(r"no angle for sample (\d+)", said)[1])
                self.assertLessEqual(sample, SAMPLE + late)
                self.assertLess(result["angle_error_deg"]["calibration_mode_max"] or 0, 95)

    def test_each_mechanism_of_the_coprocessor_by_a_fault(self):
        at, then = f"at sample {SAMPLE}", f"at {WHEN}"
        lost, misfit = "a register of the coprocessor has lost a bit", "the coprocessor's error is beyond its limit"
        jumped = "the coprocessor's angle moved beyond its limit"
        for fault, sentences, late in (
            (f"flip coprocessor.cv[39] {then}", (lost,), 3),
            (f"flip coprocessor.au[43] {then}", (lost,), 3),
            # Too small for any other check.
            (f"flip coprocessor.au[5] {then}", (lost,), 3),
            (f"flip coprocessor.beta[31] {then}", (lost,), 3),
            (f"flip coprocessor.step_au[3] {then}", (lost,), 3),
            (f"flip coprocessor.mechanisms[0] {then}", (lost,), 3),
            (f"flip coprocessor.registers_parity[4] {then}", (lost,), 3),
            (f"flip COPROCESSOR.CTRL.CALIB[0] {then}", (lost,), 3),
            (f"flip sin[25] {at}", (misfit,), 0),
            (f"flip cos[25] {at}", (misfit,), 0),
            (f"freeze sin {at}", (misfit, jumped), 60),
            (f"double sample {at}", ("a result of the coprocessor was not taken", misfit), 1),
        ):
            with self.subTest(fault=fault):
                said, result = self.run_safe("--inject", fault, settings=COPROCESSOR)
                self.assertEqual(result["exit"]["code"], 1, said)
                self.assertIn(re.search("safe: fail: (.*)", said)[1], sentences)
                sample = int(re.search(r"no angle for sample (\d+)", said)[1])
                self.assertLessEqual(sample, SAMPLE + late)

    def test_faults_while_it_learns(self):
        lost, misfit = "a register of the coprocessor has lost a bit", "the coprocessor's error is beyond its limit"
        for fault, sentence in (
            # A wrong step of the learning changes no angle at once.
            ("flip coprocessor.step_av[25] at 5.2s", lost),
            ("flip coprocessor.bv[41] at 5.2s", lost),
            ("flip coprocessor.step_au[27] at 40.1s", lost),
            ("flip coprocessor.mechanisms[2] at 40.1s", lost),
            ("flip sin[28] at sample 10000", misfit),
            ("freeze cos at sample 10000", misfit),
        ):
            with self.subTest(fault=fault):
                said, result = self.run_safe("--inject", fault, settings=COPROCESSOR)
                self.assertEqual(result["exit"]["code"], 1, said)
                self.assertIn(f"safe: fail: {sentence}", said)
                # Looked at once a turn, of 500 samples, or a second.
                sample = int(re.search(r"no angle for sample (\d+)", said)[1])
                begin = result["faults"][0]["time_s"] * 250
                self.assertLessEqual(sample, begin + 501)

    def test_mechanisms_that_are_left_out(self):
        for fault, found_by, sentence in (
            (f"flip coprocessor.cv[39] at {WHEN}", 1, "a register of the coprocessor has lost a bit"),
            (f"flip sin[25] at sample {SAMPLE}", 2, "the coprocessor's error is beyond its limit"),
        ):
            for mechanisms in (15, found_by, 15 - found_by):
                with self.subTest(fault=fault, mechanisms=mechanisms):
                    said, _ = self.run_safe("--inject", fault, "-P", f"mechanisms={mechanisms}", settings=COPROCESSOR)
                    self.assertEqual(f"safe: fail: {sentence}" in said, mechanisms & found_by != 0, said)

    def test_a_coefficient_on_its_way(self):
        core = "rtl.u_datapath.g_{0}.u_core."
        for arithmetic, place in (
            ("precise", "u_weight_ring.place0_q[37]"),
            ("precise", "u_weight_ring.parity_q[4]"),
            ("paper", "weights_q[100]"),
            ("paper", "parameters_q[89]"),
        ):
            with self.subTest(arithmetic=arithmetic, place=place):
                fault = f"flip {core.format(arithmetic)}{place} at sample {SAMPLE} cycle 116"
                words = ("--coprocessor", "rtl", "-C", f"coprocessor.arithmetic={arithmetic}", "--inject", fault)
                said, _ = self.run_safe(*words, settings=COPROCESSOR)
                self.assertIn("safe: fail: a register of the coprocessor has lost a bit", said)

    def test_the_start_finds_a_mechanism_that_does_not_work(self):
        monitor, settings = "rtl.u_datapath.u_safety_monitor.", "rtl.u_register_bank.u_settings."
        ring = "rtl.u_datapath.g_precise.u_core.u_weight_ring."
        for fault, sentence in (
            (f"stuck0 {monitor}bad_parity_q[4]", "the test of the parity bits"),
            (f"stuck1 {monitor}bad_safety_q[4]", "the coprocessor has no safety mechanisms, or finds a fault"),
            # The bits of LOOP and BV are 1 after a reset.
            (f"stuck1 {settings}parity_q[1]", "the test of the parity bits"),
            (
                "stuck0 rtl.u_register_bank.u_state.u_bv.parity_q[0]",
                "the coprocessor has no safety mechanisms, or finds a fault",
            ),
            (f"stuck0 {ring}came_bad_q[0]", "the test of the parity bits"),
            (f"stuck0 {monitor}misfit3_q[0]", "the test of the limit of the error"),
            (f"stuck0 {monitor}error_limit_q[3]", "the test of the limit of the error"),
            (f"stuck0 {monitor}step_limit_q[0]", "the test of the limit of the step"),
            (f"stuck0 {monitor}enables_q[2]", "the test of the limit of the step"),
            (f"stuck0 {monitor}enables_q[3]", "the test of results that software does not take"),
        ):
            with self.subTest(fault=fault):
                words = ("--coprocessor", "rtl", "--inject", f"{fault} at 0s")
                said, result = self.run_safe(*words, settings=COPROCESSOR)
                self.assertEqual(result["exit"]["code"], 1, said)
                self.assertIn(f"safe: fail: {sentence}", said)

    def test_the_start_tests_the_bit_of_every_register(self):
        """A bit that is stuck is wrong either at once or when it should be the other one."""
        places = subprocess.run(
            [CAPSOC, "run", FIRMWARE / "safe.elf", "--coprocessor", "rtl", "--list-fault-places"],
            capture_output=True,
            text=True,
            check=True,
            env=CLEAN,
        )
        flip_flops = [
            (each["place"], bit)
            for each in json.loads(places.stdout)["places"]
            if re.fullmatch(r"rtl\.u_register_bank\.(.*\.)?parity_q", each["place"])
            for bit in range(each["bits"])
        ]
        self.assertEqual(len(flip_flops), 27)
        for place, bit in flip_flops:
            for kind in ("stuck0", "stuck1"):
                fault = f"{kind} {place}[{bit}] at 0s"
                with self.subTest(fault=fault):
                    said, _ = self.run_safe("--coprocessor", "rtl", "--inject", fault, settings=COPROCESSOR)
                    self.assertRegex(
                        said, "safe: fail: (the test of the parity bits|.* finds a fault in a good sample)"
                    )

    def test_a_signal_that_only_seems_to_have_ended(self):
        said, result = self.run_safe("--inject", f"flip mem:ended[0] at {WHEN}")
        self.assertEqual(result["exit"]["code"], 1, said)
        self.assertIn("safe: fail: a sample is missing, or there is one too many", said)

    def test_a_calibration_that_only_seems_to_be_over(self):
        for fault in ("flip mem:parameters+24[10]", "flip mem:parameters+28[10]", "flip mem:results[16]"):
            with self.subTest(fault=fault):
                said, result = self.run_safe("--inject", f"{fault} at {WHEN}")
                self.assertEqual(result["exit"]["code"], 1, said)
                self.assertRegex(
                    said, "safe: (fail: (the copy of the parameters has changed|a sample is missing)|stopped)"
                )

    def test_a_stop_does_without_the_drivers(self):
        """With one of their functions broken the program still says by its status why it stopped."""
        # gpio_write returns by its last instruction: no longer, and what comes after it runs, too.
        code = subprocess.run(
            ["arm-none-eabi-objdump", "-d", "--disassemble=gpio_write", FIRMWARE / "safe.elf"],
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        address, instruction = re.findall(r"^ *([0-9a-f]+):\t([0-9a-f]{4}) +\tpop", code, re.M)[-1]
        self.assertEqual(int(instruction, 16) & 0xFF00, 0xBD00, code)
        bit = 8 * (int(address, 16) + 1) + 1  # 0xbd becomes 0xbf: a hint, which does nothing
        said, result = self.run_safe("--inject", f"flip mem:0x00000000[{bit}] at {WHEN}")
        self.assertIn("safe: stopped by the", said)
        self.assertEqual(result["exit"]["code"], 1, said)

    def test_the_watchdog(self):
        for fault in (
            f"lose irq coprocessor at {WHEN}",
            f"lose sample at sample {SAMPLE}",
            f"flip cpu.pc[28] at {WHEN}",
        ):
            with self.subTest(fault=fault):
                said, result = self.run_safe("--inject", fault, settings=PROGRAM)
                self.assertEqual(result["exit"]["reason"], "the firmware ended with status 4", said)
                self.assertIn("safe: stopped by the watchdog", said)
                self.assertLess(result["time"]["simulated_s"], 50.42)

    def test_the_watchdog_from_the_start_to_the_exit(self):
        short = [word.replace("=12500", "=5000") for word in SHORT]
        for fault, at_s in (
            # While it learns.
            ("lose irq coprocessor at 10s for 100", 10),
            # After the last angle, at 24 s: the verdict is never sent.
            ("lose irq uart0.tx at 23.9s for 100", 24),
        ):
            with self.subTest(fault=fault):
                said, result = self.run_safe("--inject", fault, settings=short)
                self.assertEqual(result["exit"]["reason"], "the firmware ended with status 4", said)
                self.assertIn("safe: stopped by the watchdog", said)
                self.assertGreater(result["time"]["simulated_s"], at_s)
                self.assertLess(result["time"]["simulated_s"], at_s + 12)

    def test_faults_and_memory_protection(self):
        for fault, sentence in (
            # In the handler of the result: data are not executed.
            (f"flip cpu.pc[29] at sample {SAMPLE} cycle 260", "memory protection"),
            # Asleep, with interrupts masked: there is no memory.
            (f"flip cpu.pc[29] at {WHEN}", "processor's fault"),
            (f"flip cpu.sp[30] at {WHEN}", "processor's fault"),
        ):
            with self.subTest(fault=fault):
                said, result = self.run_safe("--inject", fault)
                self.assertEqual(result["exit"]["reason"], "the firmware ended with status 5", said)
                self.assertIn(f"safe: stopped by the {sentence}", said)

    def test_the_pin_says_when_there_is_an_angle(self):
        for fault, low_s in ((f"flip coprocessor.cv[39] at {WHEN}", 50.41), (f"lose irq coprocessor at {WHEN}", 50.42)):
            with self.subTest(fault=fault):
                self.run_safe("--inject", fault, "--gpio0", "file:pins.txt")
                lines = (self.folder / "pins.txt").read_text().splitlines()
                changes = [(float(line.split()[0]), line.split()[1:]) for line in lines]
                self.assertEqual([change[1] for change in changes], [["0", "0"], ["0", "1"], ["0", "0"]])
                self.assertAlmostEqual(changes[1][0], 50.01, places=2)
                self.assertTrue(50.405 < changes[2][0] < low_s, changes)


class GoodSensors(SafeCase):
    def test_no_false_alarm(self):
        """What selfcal passes, safe passes: the checks look at no noise but that of a step."""
        passed = 0
        for seed in range(1, 9):
            sensor = [
                f"sensor.a1={0.1 + 0.09 * seed}",
                f"sensor.a2={0.85 - 0.08 * seed}",
                f"sensor.b1={0.02 * (seed - 4)}",
                f"sensor.beta_rad={0.2 * (seed - 4)}",
                f"sensor.noise.sigma={10.0 ** (-6 + seed / 2.5)}",
                f"sensor.noise.seed={seed}",
                f"sensor.adc_bits={10 + 2 * seed}",
            ]
            options = [word for setting in sensor for word in ("-C", setting)]
            _, selfcal = self.run_safe(*options, program="selfcal")
            said, safe = self.run_safe(*options)
            with self.subTest(seed=seed):
                if selfcal["exit"]["code"] == 0:
                    self.assertEqual(safe["exit"]["code"], 0, said)
                    passed += 1
        self.assertGreaterEqual(passed, 5)


if __name__ == "__main__":
    unittest.main()
