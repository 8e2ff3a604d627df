#!/usr/bin/env python3
"""Faults injected into a run: the instant, the places, model against RTL, checkpoints, and what is refused."""

import json
import re
import subprocess
import unittest

from harness import BUILD, CAPSOC, CLEAN, Case, FIRMWARE, SOURCE, without_host_times

CTEST = {"name": "system: Inject", "timeout": 300}

#: 0.6 s of demodulation and 0.08 s of calibration mode.
SHORT = ["-P", "demodulation_samples=150", "-P", "calibration_samples=20", "-C", "log.level=off"]
PATIENCE = 120
#: The registers that model and RTL share.
STATE = SOURCE / "platform" / "simulation" / "rtl" / "rtl_state.def"
SETTINGS = BUILD / "generated" / "capsoc_coprocessor_settings.def"


def state_of(checkpoint):
    """Hashes of the state of a checkpoint, part by part, without what is on the host."""
    with open(checkpoint, "rb") as file:
        size = int(file.readline().split()[3])
        parts = json.loads(file.read(size))["parts"]
    return {part["name"]: part["sha256"] for part in parts if part["name"] not in ("observation", "host")}


class InjectCase(Case):
    def start_run(self, *options, code=None, program="selfcal"):
        done = subprocess.run(
            [CAPSOC, "run", FIRMWARE / f"{program}.elf", *SHORT, "--simlimit", "0.75", *map(str, options)],
            capture_output=True,
            timeout=PATIENCE,
            check=False,
            env=CLEAN,
            cwd=self.folder,
        )
        if code is not None:
            self.assertEqual(done.returncode, code, done.stderr.decode())
        return done

    def result_of(self, *options, code=1, faults=()):
        """The result file, the state at 0.65 s, and what the run printed."""
        given = [word for fault in faults for word in ("--inject", fault)]
        done = self.start_run(*given, "--json", "r.json", "--save", "s.capsoc@0.65", *options, code=code)
        result = without_host_times(json.loads((self.folder / "r.json").read_text()))
        for name in ("command", "configuration"):
            result.pop(name)
        saved = self.folder / "s.capsoc"
        return result, state_of(saved) if saved.exists() else None, done.stdout

    def refusal(self, *options):
        done = self.start_run(*options, code=2)
        self.assertEqual(done.stdout, b"")
        return done.stderr.decode()


class Instant(InjectCase):
    """The same fault at the same place of the run, however the run is made."""

    FAULTS = (
        "flip cpu.r7[1] at instruction 30000",
        "flip mem:0x003ffff0[3] at cycle 2500003",
        "flip coprocessor.cu[20] at sample 33",
        "flip coprocessor.bu[20] at sample 34 cycle 50000",
        "flip COPROCESSOR.BETA[28] at 0.2000000123s",
        "flip ADC.PERIOD[1] at 0.3s",
        "lose sample at sample 60",
        "double sample at 0.25s",
        "freeze cos at cycle 4000000 for 0.02s",
        "stuck1 coprocessor.av[40] at 0.4s for 0.05s",
        "stuck0 mem:0x003fffe0[0] at 0.45s for 0.001s",
        "lose irq coprocessor at 0.652s",
        "raise irq 12 at instruction 40000",
        "flip cpu.nvic.priority.30[0] at 0.31s",
        "flip cpu.systick.reload[3] at instruction 20000",
        "stuck1 cpu.scb.sevonpend[0] at 0.46s for 0.0002s",
        "flip write COPROCESSOR.STEP_AU[30] at 0s",
        "lose write COPROCESSOR.FLAGS at sample 90",
        "stuck1 read UART0.STATE[7] at instruction 1000 for 0.01s",
        "stuck0 read COPROCESSOR.STATUS[31] at instruction 100000",
        "flip read COPROCESSOR.TURN_FLAGS[3] at cycle 15000000",
        "lose clock at sample 170 cycle 40",
        "lose clock at 0.7s for 0.0101s",
    )

    def test_quantum_executor_and_observers_change_nothing(self):
        expected = self.result_of(faults=self.FAULTS, code=124)
        faults = expected[0]["faults"]
        self.assertEqual([fault["fault"] for fault in faults], list(self.FAULTS))
        self.assertTrue(all(fault["applied"] for fault in faults), faults)
        self.assertEqual(faults[0]["instruction"], 30000)
        self.assertEqual(faults[1]["cycle"] // 20, 2500003 // 20)
        self.assertEqual(faults[0]["before"] ^ faults[0]["after"], 1 << 1)
        self.assertAlmostEqual(faults[4]["time_s"], 0.2000000123, delta=1e-6)
        for options in (
            ["--quantum", 1000],
            ["--quantum", 70000],
            ["-C", "cpu.executor=blocks"],
            ["-C", "cpu.executor=stepping"],
            ["-C", "cpu.fast_forward=false"],
            ["--trace-bus", "bus.txt"],
        ):
            with self.subTest(options=options):
                self.assertEqual(self.result_of(*options, faults=self.FAULTS, code=124), expected)

    def test_a_line_repeats_its_fault_and_the_report_has_it(self):
        line = "flip coprocessor.a1[30] at 0.1s"
        (fault,) = self.result_of(faults=[line])[0]["faults"]
        done = self.start_run("--inject", fault["fault"], code=1)
        self.assertRegex(
            done.stderr.decode(), rf"(?m)^fault: {re.escape(line)}: at 0\.1\d* s, {fault['before']:#x} became "
        )

    def test_two_flips_of_one_bit_are_none(self):
        golden = self.result_of()
        for place in ("coprocessor.phase[40]", "coprocessor.corrections.7[3]", "cpu.r11[9]", "mem:0x003fff00[4]"):
            with self.subTest(place=place):
                faults = [f"flip {place} at 0.111s"] * 2
                result, state, said = self.result_of(faults=faults)
                self.assertEqual([f["changes"] for f in result.pop("faults")], [1, 1])
                self.assertEqual((result, state, said), golden)

    def test_what_never_comes_is_said(self):
        done = self.start_run("--inject", "flip cpu.r1[0] at 1000s", code=1)
        self.assertIn("flip cpu.r1[0] at 1000s: not applied: the run ended before its time", done.stderr.decode())

    def test_a_file_is_the_same_as_options(self):
        (self.folder / "f.txt").write_text("# two\n" + "\n".join(self.FAULTS[:2]) + "  # and why\n")
        self.assertEqual(self.result_of("--inject-file", "f.txt"), self.result_of(faults=self.FAULTS[:2]))


class Kinds(InjectCase):
    def test_samples(self):
        whole = self.result_of()[0]
        lost = self.result_of(faults=["lose sample at sample 50 for 0.0399s"])[0]
        self.assertEqual(lost["faults"][0]["changes"], 10)
        self.assertGreater(lost["cpu"]["cycles"], whole["cpu"]["cycles"])
        frozen = self.result_of(faults=["freeze sin at sample 10 for 0.0999s"])[0]["faults"][0]
        self.assertEqual(frozen["changes"], 25)
        stuck = self.result_of(faults=["stuck0 cos[31] at sample 1", "stuck1 cos[31] at sample 1"])[0]["faults"]
        self.assertEqual([fault["applied"] for fault in stuck], [True, True])
        flipped = self.result_of(faults=["flip sin[31] at sample 100"])[0]
        self.assertEqual(flipped["faults"][0]["before"] ^ flipped["faults"][0]["after"], 1 << 31)
        self.assertNotEqual(flipped["angle_error_deg"], whole["angle_error_deg"])

    def test_the_clock(self):
        """A lost edge of a computation makes its result one clock later and changes no state; without a clock there are
        no results, and what is written is lost. Model and RTL are the same."""
        golden = self.result_of()
        one, state, said = self.result_of(faults=["lose clock at sample 50 cycle 40"])
        self.assertEqual(one.pop("faults")[0]["changes"], 1)
        self.assertEqual((state, said), golden[1:])
        lost = "lose clock at 0.3s for 0.0399s"
        stopped = self.result_of(faults=[lost])
        self.assertEqual(stopped[0]["faults"][0]["changes"], 1)
        self.assertGreater(stopped[0]["cpu"]["cycles"], golden[0]["cpu"]["cycles"])
        self.assertEqual(
            self.result_of("--coprocessor", "lockstep", faults=[lost, "lose clock at sample 33 cycle 9"])[1:],
            self.result_of(faults=[lost, "lose clock at sample 33 cycle 9"])[1:],
        )

    def test_a_stuck_bit_is_set_again_whenever_it_is_written(self):
        """Each of the 50 results in 0.2 s adds 1 to an even number."""
        faults = ["stuck0 mem:results[0] at 0.1s for 0.2s", "stuck0 cpu.sp[3] at 0.5s for 0.01s"]
        counter, stack = self.result_of(faults=faults, code=5)[0]["faults"]
        self.assertEqual(counter["changes"], 50)
        self.assertEqual(stack["after"], stack["before"] & ~8)
        self.assertGreater(stack["changes"], 0)

    def test_a_pending_bit_is_an_interrupt(self):
        """The processor sleeps then; the flip wakes it like a pulse on the line."""
        pulse, pulsed = self.result_of(faults=["raise irq coprocessor at 0.3s"])[:2]
        flip, flipped = self.result_of(faults=["flip cpu.nvic.pending[30] at 0.3s"])[:2]
        self.assertTrue(flip["faults"][0]["applied"])
        self.assertEqual(flipped, pulsed)
        for result in (pulse, flip):
            result.pop("faults")
        self.assertEqual(flip, pulse)
        self.assertNotEqual(flipped, self.result_of()[1])

    def test_a_lost_interrupt_stops_the_program(self):
        """The line stays high, and no further edge comes: selfcal sleeps for ever."""
        whole = self.result_of()[0]
        lost = self.result_of(faults=["lose irq coprocessor at 0.3s"], code=124)[0]
        self.assertEqual((lost["faults"][0]["before"], lost["faults"][0]["after"]), (1, 0))
        self.assertLess(lost["cpu"]["instructions"], whole["cpu"]["instructions"])

    def test_a_variable_by_its_name(self):
        (fault,) = self.result_of(faults=["flip mem:program_verdict+4[1] at 0.1s"], code=None)[0]["faults"]
        self.assertEqual(fault["before"] ^ fault["after"], 2)


class Bus(InjectCase):
    """Accesses on their way: what arrives is what another writer would have written, or another device answered."""

    def text(self, *faults, code=1):
        return self.result_of(faults=faults, code=code)[2]

    def test_a_written_word(self):
        """The letters of the greeting."""
        text = self.text()
        self.assertEqual(self.text("flip write UART0.DATA[5] at 0s"), bytes([text[0] ^ 32]) + text[1:])
        self.assertEqual(self.text("lose write UART0.DATA at 0s"), text[1:])
        held = self.text("stuck1 write UART0.DATA[0] at 0s for 0.1s")
        end = text.index(b"\n") + 1
        self.assertEqual(held[:end], bytes(letter | 1 for letter in text[:end]))

    def test_a_written_register_is_as_if_it_had_been_flipped(self):
        """Nothing uses it before the first sample."""
        written = self.result_of(faults=["flip write ADC.PERIOD[4] at 0s"])
        (fault,) = written[0]["faults"]
        self.assertEqual(fault["before"] ^ fault["after"], 1 << 4)
        flipped = self.result_of(faults=[f"flip ADC.PERIOD[4] at cycle {fault['cycle'] + 20}"])
        self.assertEqual(written[1:], flipped[1:])
        self.assertNotEqual(written[1], self.result_of()[1])

    def test_a_read_word(self):
        """The device keeps what it has, and the next read is right."""
        text = self.text()
        missing = self.text("flip read COPROCESSOR.ID[3] at 0s", code=None)
        self.assertIn(b"no coprocessor", missing.lower())
        once = self.result_of(faults=["flip read UART0.STATE[0] at 0.62s"])
        self.assertTrue(once[0]["faults"][0]["applied"])
        self.assertEqual(len(once[2]), len(text))

    def test_an_access_that_fails(self):
        read = self.start_run("--inject", "fail read COPROCESSOR.STATUS at 0.1s", "-C", "log.level=warn", code=5)
        self.assertIn("PRECISERR", read.stderr.decode())
        write = self.start_run("--inject", "fail write COPROCESSOR.CMD at 0.1s", "-C", "log.level=warn", code=5)
        self.assertIn("IMPRECISERR", write.stderr.decode())

    def test_a_field(self):
        fault = self.result_of(faults=["flip write COPROCESSOR.CTRL.DEMOD[0] at 0s"], code=None)[0]["faults"][0]
        self.assertEqual(fault["before"] ^ fault["after"], 1)

    def test_what_never_comes(self):
        (fault,) = self.result_of(faults=["flip read TIMER0.VALUE[0] at 0.1s"])[0]["faults"]
        self.assertEqual((fault["applied"], fault["note"]), (False, "no such access came"))


class Sides(InjectCase):
    """The coprocessor's model and its RTL."""

    BITS = ("au[30]", "freq[35]", "beta[31]", "phase[47]", "error_sum_u[36]", "flags[2]", "demod[0]", "judge[3]")
    BITS += ("judge_words.24[30]", "last_angle[29]", "octants[4]", "sample_words.1[5]", "settled[5]", "step_cu[28]")

    def results(self, backend, faults):
        done = self.start_run("--coprocessor", backend, "--json", "r.json", *faults)
        result = without_host_times(json.loads((self.folder / "r.json").read_text()))
        for name in ("command", "configuration", "inputs"):
            result.pop(name)
        return done.returncode, result

    def test_shared_bits_do_the_same_in_both(self):
        for number, bits in enumerate((self.BITS[:7], self.BITS[7:])):
            faults = []
            for index, bit in enumerate(bits):
                faults += ["--inject", f"flip coprocessor.{bit} at {0.1 + 0.05 * index + 0.01 * number:.2f}s"]
            faults += ["--inject", "stuck0 coprocessor.cv[30] at 0.45s for 0.03s"]
            with self.subTest(bits=bits):
                model = self.results("tlm", faults)
                self.assertTrue(all(fault["applied"] for fault in model[1]["faults"]))
                self.assertEqual(self.results("rtl", faults), model)
                self.assertEqual(self.results("lockstep", faults), model)

    def test_every_bit_of_a_coefficient(self):
        """Also those that the paper's words leave out, two a sample, while the coprocessor learns and not."""
        weights = [f"{name}[{bit}]" for bit in range(48) for name in ("au", "bu", "cu", "av", "bv", "cv")]
        for arithmetic in ("precise", "paper"):
            for learns in (True, False):
                lines = [f"flip coprocessor.{each} at {0.1 + 0.002008 * i:.6f}s" for i, each in enumerate(weights)]
                lines += [] if learns else ["stuck0 coprocessor.demod[0] at 0.09s"]
                (self.folder / "faults").write_text("\n".join(lines) + "\n")
                with self.subTest(arithmetic=arithmetic, learns=learns):
                    options = ["--coprocessor", "lockstep", "--arithmetic", arithmetic, "--inject-file", "faults"]
                    done = self.start_run(*options, "--json", "r.json")
                    self.assertIn(done.returncode, (1, 124), done.stderr.decode())
                    faults = json.loads((self.folder / "r.json").read_text())["faults"]
                    self.assertEqual(len(faults), len(lines))
                    self.assertTrue(all(fault["applied"] for fault in faults), done.stdout.decode())

    def test_lockstep_finds_what_one_side_has(self):
        for fault in (
            "flip model.au[30] at 0.2s",
            "flip rtl.au[30] at 0.2s",
            "flip rtl.u_register_bank.u_state.u_au.value_q[30] at 0.2s",
            "stuck1 rtl.u_datapath.u_sample_tags.lock_q[0] at 0.2s",
        ):
            with self.subTest(fault=fault):
                done = self.start_run("--coprocessor", "lockstep", "--inject", fault, code=4)
                self.assertIn("model and RTL differ", done.stderr.decode())

    def test_lockstep_finds_what_the_pipeline_holds(self):
        """A sample takes 161 cycles; before it these hold nothing."""
        for place in ("u_datapath.u_q[30]", "u_sequencer.cycle_q[1]", "u_datapath.u_sample_tags.slot0_q[1]"):
            with self.subTest(place=place):
                fault = f"flip rtl.{place} at sample 60 cycle 14"
                self.start_run("--coprocessor", "lockstep", "--inject", fault, code=4)
        self.start_run(
            "--coprocessor", "lockstep", "--inject", "flip rtl.u_datapath.u_q[30] at sample 60 cycle 300", code=1
        )

    def test_a_stuck_flip_flop_follows_its_input_no_more(self):
        """A counter whose bit 0 is held at 0 stops counting, and then continues; another fault shows what it holds."""
        held = "stuck0 rtl.u_register_bank.u_counters.samples_q[0] at 0.2s for 0.2s"
        faults = [held, *(f"flip coprocessor.samples[31] at {when}s" for when in (0.21, 0.39, 0.5))]
        given = [word for fault in faults for word in ("--inject", fault)]
        _, first, second, third = self.results("rtl", given)[1]["faults"]
        self.assertEqual(first["before"] & 1, 0)
        self.assertEqual(second["before"], first["before"] ^ 1 << 31)
        self.assertEqual(third["before"], first["before"] + 25)
        self.start_run("--coprocessor", "lockstep", "--inject", held, code=4)

    def test_a_flip_flop_is_the_shared_bit(self):
        faults = ["--inject", "flip coprocessor.beta[30] at 0.2s"]
        flip_flop = ["--inject", "flip rtl.u_register_bank.u_state.u_beta.value_q[30] at 0.2s"]
        shared, own = self.results("rtl", faults), self.results("rtl", flip_flop)
        for _, result in (shared, own):
            result["faults"][0].pop("fault")
        self.assertEqual(shared, own)


class Checkpoints(InjectCase):
    def test_a_fault_behind_a_checkpoint(self):
        faults = ["--inject", "flip coprocessor.beta[30] at 0.4s", "--inject", "freeze sin at sample 80 for 0.02s"]
        self.start_run("--save", "golden.capsoc@0.3", code=1)
        self.start_run(*faults, "--save", "whole.capsoc@0.65", "--json", "whole.json")
        self.start_run(*faults, "--save", "cut.capsoc@0.65", "--json", "cut.json", "--restore", "golden.capsoc")
        self.assertEqual(state_of(self.folder / "cut.capsoc"), state_of(self.folder / "whole.capsoc"))
        whole, cut = (json.loads((self.folder / name).read_text()) for name in ("whole.json", "cut.json"))
        self.assertEqual(cut["faults"], whole["faults"])

    def test_what_is_past_is_refused(self):
        self.start_run("--save", "golden.capsoc@0.3", code=1)
        for when in ("0.2s", "cycle 10", "instruction 10", "sample 10"):
            with self.subTest(when=when):
                sentence = self.refusal("--restore", "golden.capsoc", "--inject", f"flip cpu.r1[0] at {when}")
                self.assertIn("its time is past", sentence)

    def test_nothing_is_saved_while_a_fault_lasts(self):
        done = self.start_run(
            "--inject", "stuck1 coprocessor.a1[3] at 0.2s for 0.2s", "--save", "a.capsoc@0.3", "--save", "b.capsoc@0.5"
        )
        self.assertIn("a.capsoc: not saved: host", done.stderr.decode())
        self.assertIn("while a fault lasts (stuck1 coprocessor.a1[3] at 0.2s for 0.2s)", done.stderr.decode())
        self.assertTrue((self.folder / "b.capsoc").exists())
        self.assertFalse((self.folder / "a.capsoc").exists())


class Refusals(InjectCase):
    def test_sentences(self):
        (self.folder / "f.txt").write_text("flip cpu.r1[0] at 1s\n\nflip cpu.r99[0] at 1s\n")
        (self.folder / "empty.txt").write_text("")
        (self.folder / "comment.txt").write_text("# nothing\n\n")
        for options, sentence in (
            (["--inject", "flip cpu.r99[0] at 1s"], "--inject 'flip cpu.r99[0] at 1s': the processor has no register"),
            (["--inject", "flip cpu.r99[0] at 1s"], "did you mean r9"),
            (["--inject", "flip cpu.r9[32] at 1s"], "cpu.r9 has no bit 32; its bits are 0 to 31"),
            (["--inject", "flip ADC.PERIOT[3] at 1s"], "did you mean PERIOD"),
            (["--inject", "flip ADX.PERIOD[3] at 1s"], "'ADX.PERIOD' is no place"),
            (["--inject", "flip COPROCESSOR.CTRL[3] at 1s"], "name one of its fields"),
            (["--inject", "flip coprocessor.a3[3] at 1s"], "did you mean au or av or a1"),
            (["--inject", "flip coprocessor.a1[32] at 1s"], "has no bit 32"),
            (["--inject", "flip rtl.u_datapath.angle_q[3] at 1s"], "there is no RTL"),
            (["--inject", "flip mem:0x70000000[3] at 1s"], "there is no memory at 0x70000000"),
            (["--inject", "flip mem:verdikt[3] at 1s"], "verdikt"),
            (["--inject", "flip sin[32] at 1s"], "its bits are 0 to 31"),
            (["--inject", "lose irq coprozessor at 1s"], "did you mean coprocessor"),
            (["--inject", "flip read COPROCESSOR.STATE[4] at 1s"], "did you mean STATUS"),
            (
                ["--inject", "flip write COPROCESSOR.STATUS.LOCK[4] at 1s"],
                "STATUS.LOCK has no bit 4; its bits are 0 to 0",
            ),
            (["--inject", "fail read SCB.CPUID at 1s"], "SCB.CPUID is the processor's own; its accesses use no bus"),
            (["--inject", "flip read mem:0x20000000[1] at 1s"], "mem:0x20000000"),
            (["--inject", "flip read sin[1] at 1s"], "sin"),
            (["--inject", "lose write"], "names no register"),
            (["--inject", "lose read ADC.ID at 1s"], "'lose' is no fault"),
            (["--inject", "raise irq 32 at 1s"], "there is no interrupt 32"),
            (["--inject", "flip cpu.r1[0]"], "has no time"),
            (["--inject-file", "f.txt"], "f.txt:3: the processor has no register 'r99'"),
            (["--inject-file", "none.txt"], "none.txt"),
            (["--inject-file", "empty.txt"], "empty.txt: is empty"),
            (["--inject-file", "comment.txt"], "comment.txt: has no fault"),
            (["--inject", ""], "--inject is empty"),
            (["-C", "inject.faults=nonsense"], "'nonsense' is no fault"),
        ):
            with self.subTest(options=options):
                self.assertIn(sentence, self.refusal(*options))


class Places(InjectCase):
    def test_every_listed_place_can_be_changed(self):
        listed = json.loads(self.start_run("--list-fault-places", "--coprocessor", "rtl", code=0).stdout)
        places = listed["places"]
        self.assertEqual(listed["bits"], sum(place["bits"] for place in places))
        self.assertEqual(len({place["place"] for place in places}), len(places))
        units = {place["unit"] for place in places}
        self.assertLessEqual({"processor", "code_sram", "ADC", "coprocessor", "rtl.u_turn_judge"}, units)
        bits = {place["place"]: place["bits"] for place in places}
        known = re.findall(r"^WORD\(\w+, (\d+), (\w+), (\w+)\)", STATE.read_text(), re.MULTILINE)
        settings = re.findall(r"^SETTING\((\w+), (\d+)\)", SETTINGS.read_text(), re.MULTILINE)
        self.assertGreaterEqual(len(settings), 10)
        known += [(width, "u_register_bank.u_settings.u_registers", f"{name}_q") for name, width in settings]
        self.assertGreater(len(known), 70)
        for width, instance, variable in known:
            self.assertEqual(bits[f"rtl.{instance.replace('__DOT__', '.')}.{variable}"], int(width))
        (self.folder / "all.txt").write_text(
            "".join(f"flip {place['place']}[{place['bits'] - 1}] at 100s\n" for place in places)
        )
        self.start_run("--coprocessor", "rtl", "--inject-file", "all.txt", code=1)


if __name__ == "__main__":
    unittest.main()
