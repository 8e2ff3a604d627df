#!/usr/bin/env python3
"""Runs that are saved on their way, and what becomes of those that continue."""

import json
import re
import signal
import subprocess
import sys
import time
import unittest
from pathlib import Path

from harness import BUILD, CAPSOC, CLEAN, Case, FIRMWARE, SOURCE

CTEST = {"name": "checkpoints", "timeout": 900}


class CheckpointCase(Case):
    def capsoc(self, *arguments, code=0):
        done = subprocess.run(
            [CAPSOC, "run", *map(str, arguments)],
            capture_output=True,
            text=True,
            timeout=300,
            check=False,
            env=CLEAN,
            cwd=self.folder,
        )
        self.assertEqual(done.returncode, code, done.stderr)
        return done

    def bytes_of(self, name):
        return (self.folder / name).read_bytes()

    def result(self, name="r.json"):
        return json.loads((self.folder / name).read_text())


class Cuts(CheckpointCase):
    """scripts/tool checkpoint_cuts in small."""

    def cuts(self, count, *options):
        done = subprocess.run(
            [
                sys.executable,
                SOURCE / "scripts" / "tool",
                "checkpoint_cuts",
                "--count",
                str(count),
                "--jobs",
                "2",
                "--build",
                BUILD,
                *options,
            ],
            capture_output=True,
            text=True,
            timeout=900,
            check=False,
            env=CLEAN,
        )
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn(f"different: 0 of {count}", done.stdout)

    def test_every_program_goes_on_as_if_nothing_had_been(self):
        self.cuts(12, "--pairs", "tlm-tlm", "--seed", "5")

    def test_with_the_rtl_and_in_lockstep(self):
        self.cuts(6, "--pairs", "rtl-rtl,lockstep-lockstep", "--programs", "selfcal,track,drivers", "--seed", "6")

    def test_from_one_coprocessor_to_another(self):
        self.cuts(
            36,
            "--pairs",
            "tlm-rtl,tlm-lockstep,rtl-tlm,rtl-lockstep,lockstep-tlm,lockstep-rtl",
            "--programs",
            "selfcal,track,unordered",
            "--seed",
            "7",
        )


class Places(CheckpointCase):
    def test_several_checkpoints_and_a_chain_of_them(self):
        self.capsoc("--json", "whole.json", "--uart0", "file:whole")
        self.capsoc("--uart0", "file:first", "--save", "a@10", "--save", "b@250.5")
        self.capsoc("--uart0", "file:second", "--restore", "a", "--save", "c@300")
        self.capsoc("--uart0", "file:third", "--restore", "c", "--json", "r.json")
        whole = self.bytes_of("whole")
        for part in ("first", "second", "third"):
            self.assertTrue(whole.endswith(self.bytes_of(part)), part)
        self.assertLess(len(self.bytes_of("third")), len(self.bytes_of("second")))
        for key in ("cpu", "parameters", "angle_error_deg", "verdict", "uart0", "samples", "convergence_s"):
            one, other = self.result("whole.json")[key], self.result()[key]
            if key == "cpu":
                one, other = one["cycles"], other["cycles"]
            self.assertEqual(one, other, key)

    def test_the_same_state_has_the_same_bytes(self):
        self.capsoc(FIRMWARE / "drivers.elf", "--uart0", "null", "--save", "a@0.03")
        self.capsoc(
            FIRMWARE / "drivers.elf",
            "--uart0",
            "file:x",
            "--quantum",
            "100",
            "-C",
            "cpu.executor=stepping",
            "--save",
            "b@0.03",
        )
        self.assertEqual(self.bytes_of("a"), self.bytes_of("b"))

    def test_the_state_has_the_same_bytes_whatever_the_coprocessor_is(self):
        for arithmetic in ("precise", "paper"):
            for kind in ("tlm", "rtl", "lockstep"):
                self.capsoc(
                    "--coprocessor",
                    kind,
                    "--arithmetic",
                    arithmetic,
                    "--uart0",
                    "null",
                    "--simlimit",
                    "1.2",
                    "--save",
                    f"{kind}@1",
                    code=124,
                )
            self.assertEqual(self.bytes_of("rtl"), self.bytes_of("tlm"))
            self.assertEqual(self.bytes_of("lockstep"), self.bytes_of("tlm"))

    def test_the_last_second_of_the_models_run_in_lockstep(self):
        self.capsoc("--uart0", "null", "--simlimit", "400", "--save", "s@399", "--json", "whole.json", code=124)
        self.capsoc(
            "--uart0",
            "null",
            "--simlimit",
            "400",
            "--restore",
            "s",
            "--coprocessor",
            "lockstep",
            "--json",
            "r.json",
            code=124,
        )
        for key in ("samples", "parameters", "angle_error_deg", "convergence_s"):
            self.assertEqual(self.result()[key], self.result("whole.json")[key], key)

    def test_every_so_many_seconds(self):
        self.capsoc("--simlimit", "9.5", "--uart0", "null", "--save-every", "4", code=124)
        self.assertEqual(
            sorted(path.name for path in self.folder.iterdir()), ["checkpoint-4.capsoc", "checkpoint-8.capsoc"]
        )
        self.capsoc(
            "--simlimit",
            "9.5",
            "--uart0",
            "null",
            "--restore",
            "checkpoint-8.capsoc",
            "--save-every",
            "1",
            "-C",
            "checkpoint.prefix=later-",
            code=124,
        )
        self.assertEqual(sorted(path.name for path in self.folder.glob("later*")), ["later-9.capsoc"])

    def test_on_a_signal(self):
        run = subprocess.Popen(
            [CAPSOC, "run", FIRMWARE / "forever.elf", "--uart0", "null", "--timelimit", "60"],
            cwd=self.folder,
            env=CLEAN,
            stderr=subprocess.PIPE,
            text=True,
        )
        try:
            deadline = time.monotonic() + 50
            while not any(self.folder.glob("checkpoint-*.capsoc")) and time.monotonic() < deadline:
                time.sleep(0.2)
                if "capsoc" in Path(f"/proc/{run.pid}/comm").read_text() and self.catches(run.pid, signal.SIGUSR1):
                    run.send_signal(signal.SIGUSR1)
            run.send_signal(signal.SIGINT)
            _, said = run.communicate(timeout=30)
        finally:
            run.kill()
        self.assertEqual(run.returncode, 128 + signal.SIGINT, said)
        saved = sorted(self.folder.glob("checkpoint-*.capsoc"))
        self.assertTrue(saved, said)
        self.assertIn(f"{saved[0].name}: saved", said)
        self.capsoc(FIRMWARE / "forever.elf", "--uart0", "null", "--restore", saved[0], "--timelimit", "1", code=124)

    @staticmethod
    def catches(pid, number):
        for line in Path(f"/proc/{pid}/status").read_text().splitlines():
            if line.startswith("SigCgt:"):
                return int(line.split()[1], 16) >> (number - 1) & 1
        return False

    def test_open_files_of_the_guest_go_on_where_they_were(self):
        for folder in ("whole", "cut"):
            (self.folder / folder).mkdir()
        self.capsoc(FIRMWARE / "newlib.elf", "--semihosting-dir", "whole", "--uart0", "file:w", "--json", "w.json")
        length = self.result("w.json")["time"]["simulated_s"]
        for place in (0.2, 0.5, 0.8, 0.95):
            self.capsoc(
                FIRMWARE / "newlib.elf", "--semihosting-dir", "cut", "--uart0", "null", "--save", f"s@{place * length}"
            )
            # What the run wrote after the checkpoint is there now, and goes.
            self.capsoc(
                FIRMWARE / "newlib.elf",
                "--semihosting-dir",
                "cut",
                "--uart0",
                "null",
                "--restore",
                "s",
                "--json",
                "r.json",
            )
            self.assertEqual(self.result()["cpu"]["cycles"], self.result("w.json")["cpu"]["cycles"])
            names = sorted(path.name for path in (self.folder / "whole").iterdir())
            self.assertEqual(sorted(path.name for path in (self.folder / "cut").iterdir()), names)
            for name in names:
                self.assertEqual(self.bytes_of(f"cut/{name}"), self.bytes_of(f"whole/{name}"))

    def test_input_of_a_uart_goes_on_where_it_was(self):
        text = b"".join(b"line %d\n" % n for n in range(40))
        (self.folder / "in").write_bytes(len(text).to_bytes(4, "little") + text)
        echo = [FIRMWARE / "echo.elf", "-C", "uart0.input=in", "--simlimit", "0.05"]  # 0.0026 s for all
        self.capsoc(*echo, "--uart0", "file:whole", "--save", "s@0.001")
        self.capsoc(*echo, "--uart0", "file:rest", "--restore", "s")
        whole, rest = self.bytes_of("whole"), self.bytes_of("rest")
        self.assertGreater(len(rest), 20)
        self.assertLess(len(rest), len(whole))
        self.assertTrue(whole.endswith(rest))


class Refusals(CheckpointCase):
    def refused(self, sentence, *arguments):
        said = self.capsoc(*arguments, code=2).stderr
        self.assertIn(sentence, said)
        self.assertEqual(said.count("\n"), 1, said)

    def setUp(self):
        super().setUp()
        self.capsoc("--uart0", "null", "--simlimit", "3", "--save", "s@2", code=124)

    def test_another_program_sensor_or_setting(self):
        self.refused("s: was saved with another the file of firmware", FIRMWARE / "track.elf", "--restore", "s")
        self.refused(
            "s: was saved with another the file of sensor",
            "--sensor",
            SOURCE / "traces" / "soc_051hz.toml",
            "--restore",
            "s",
        )
        self.refused(
            "s: was saved with another coprocessor.arithmetic (precise, here paper); give the same as then",
            "--arithmetic",
            "paper",
            "--restore",
            "s",
        )
        self.refused(
            "s: was saved with another cpu.priority_bits (3, here 8)", "-C", "cpu.priority_bits=8", "--restore", "s"
        )
        self.refused("s: was saved with another program.step", "-P", "step=0.5", "--restore", "s")

    def test_what_is_damaged_names_its_part(self):
        good = self.bytes_of("s")
        (self.folder / "d").write_bytes(good[:-1])
        self.refused("d: the checkpoint is damaged (it ends in the part host)", "--restore", "d")
        at = len(good) // 2
        (self.folder / "d").write_bytes(good[:at] + bytes([good[at] ^ 16]) + good[at + 1 :])
        self.refused("d: the checkpoint is damaged (the part code_sram)", "--restore", "d")
        (self.folder / "d").write_bytes(good.replace(b"capsoc checkpoint 1 ", b"capsoc checkpoint 2 "))
        self.refused("d: is a checkpoint of format 2, and this program has format 1", "--restore", "d")
        self.refused("is no checkpoint; give a file that capsoc run --save wrote", "--restore", FIRMWARE / "hello.elf")
        self.refused("absent", "--restore", "absent")
        self.refused("capsoc", "--restore", ".")

    def save_while_it_computes(self, kind):
        run = subprocess.Popen(
            [CAPSOC, "run", FIRMWARE / "forever.elf", "--uart0", "null", "--gdb", "0", "--halt", "--coprocessor", kind],
            cwd=self.folder,
            env=CLEAN,
            stderr=subprocess.PIPE,
            text=True,
        )
        try:
            port = re.search(r"127\.0\.0\.1:(\d+)", run.stderr.readline()).group(1)
            load = "set *(unsigned *)0x4000c014 = 1"  # CMD.LOAD: 97 cycles
            commands = [f"target remote :{port}", load, "stepi", "stepi", "stepi", f"monitor save busy-{kind}", "kill"]
            done = subprocess.run(
                ["gdb-multiarch", "-nx", "-batch", *(f"-ex={command}" for command in commands)],
                capture_output=True,
                text=True,
                timeout=60,
                check=False,
            )
            self.assertIn(f"busy-{kind}: saved", done.stdout + done.stderr)
        finally:
            run.kill()
            run.communicate()

    def test_another_coprocessor_than_the_one_that_computed(self):
        for saved in ("tlm", "rtl", "lockstep"):
            self.save_while_it_computes(saved)
            for kind in ("tlm", "rtl", "lockstep"):
                again = (
                    FIRMWARE / "forever.elf",
                    "--uart0",
                    "null",
                    "--restore",
                    f"busy-{saved}",
                    "--coprocessor",
                    kind,
                )
                if kind == saved:
                    self.capsoc(*again, "--timelimit", "0.5", code=124)
                else:
                    self.refused(
                        f"busy-{saved}: coprocessor: was saved while the coprocessor computed; "
                        f"only --coprocessor {saved} can resume from there",
                        *again,
                    )

    def test_a_refused_run_leaves_its_places_alone(self):
        (self.folder / "out").write_text("old")
        good = self.bytes_of("s")
        (self.folder / "d").write_bytes(good[:-1])
        self.refused("damaged", "--restore", "d", "--uart0", "file:out")
        self.assertEqual((self.folder / "out").read_text(), "old")

    def test_what_cannot_be_asked(self):
        self.refused("--golden needs all samples", "--golden", "--restore", "s")
        self.refused("begins at 2 s, where --simlimit 1 has ended the run", "--simlimit", "1", "--restore", "s")
        for wrong in ("s", "@1", "x@", "x@-1", "x@nan", "x@1e99"):
            self.refused(f"--save {wrong}: write FILE@SECONDS", "--save", wrong)
        self.refused("is named twice", "--save", "x@1", "--save", "x@2")
        self.refused("--save", "--restore", "s", "--save", "s@3")
        self.refused("at least 0.001 s", "--save-every", "0.0001")

    def test_a_checkpoint_that_is_not_written_is_told(self):
        said = self.capsoc(FIRMWARE / "hello.elf", "--uart0", "null", "--save", "late@99", code=74).stderr
        self.assertIn("late: not saved: the run ended at", said)
        self.assertFalse((self.folder / "late").exists())
        said = self.capsoc(FIRMWARE / "hello.elf", "--uart0", "null", "--save", "nowhere/x@0", code=74).stderr
        self.assertIn("nowhere/x", said)
        said = self.capsoc("--uart0", "null", "--simlimit", "3", "--restore", "s", "--save", "x@1", code=124).stderr
        self.assertIn("x: not saved: the run resumes from a later time", said)


if __name__ == "__main__":
    unittest.main()
