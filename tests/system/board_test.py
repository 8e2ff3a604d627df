#!/usr/bin/env python3
"""Warnings about the board that a program runs on: priority bits, lost bytes, an end when it is idle; and the page on
what QEMU's board does otherwise, line by line on both."""

import json
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

from harness import CAPSOC, CLEAN, FIRMWARE, SOURCE

CTEST = {"name": "board", "timeout": 600}


def run(program, *options):
    """`capsoc run`: the process, and its results."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "r.json"
        done = subprocess.run(
            [CAPSOC, "run", FIRMWARE / f"{program}.elf", "--json", path, *map(str, options)],
            capture_output=True,
            timeout=300,
            check=False,
            env=CLEAN,
        )
        return done, json.loads(path.read_text()) if path.exists() else None


def qemu(program):
    return subprocess.run(
        [
            "qemu-system-arm",
            "-M",
            "mps2-an385",
            "-icount",
            "shift=5,sleep=off",
            "-display",
            "none",
            "-monitor",
            "none",
            "-serial",
            "stdio",
            "-semihosting-config",
            "enable=on,target=native",
            "-kernel",
            FIRMWARE / f"{program}.elf",
        ],
        capture_output=True,
        timeout=60,
        check=False,
        stdin=subprocess.DEVNULL,
    )


def instruction_at(program, address):
    """As objdump shows it."""
    return subprocess.run(
        [
            "arm-none-eabi-objdump",
            "-d",
            f"--start-address={address}",
            f"--stop-address={address + 2}",
            FIRMWARE / f"{program}.elf",
        ],
        capture_output=True,
        text=True,
        check=True,
    ).stdout


def warnings(done, about):
    return [line for line in done.stderr.decode().splitlines() if line.startswith("warning:") and about in line]


class Priorities(unittest.TestCase):
    """cpu.priority_bits, and the hint that leads to it."""

    HINT = "QEMU's board has 8: -C cpu.priority_bits=8"

    def test_with_8_bits_it_is_qemus_board(self):
        theirs = qemu("priority_bits")
        self.assertEqual(theirs.returncode, 0)
        self.assertIn(b"BASEPRI ff: 8 bits", theirs.stdout)
        for executor in ("blocks", "translator", "stepping"):
            ours, _ = run("priority_bits", "-C", "cpu.priority_bits=8", "-C", f"cpu.executor={executor}")
            self.assertEqual((ours.returncode, ours.stdout), (0, theirs.stdout))
            self.assertEqual(warnings(ours, "priority"), [])

    def test_every_width_on_both_executors(self):
        for bits in range(3, 8):
            mask = 0xFF & ~((1 << 8 - bits) - 1)
            outputs = set()
            for executor in ("blocks", "translator", "stepping"):
                ours, _ = run("priority_bits", "-C", f"cpu.priority_bits={bits}", "-C", f"cpu.executor={executor}")
                self.assertEqual(ours.returncode, 1, "it asks for 8")
                outputs.add(ours.stdout)
            self.assertEqual(len(outputs), 1)
            lines = outputs.pop().decode().splitlines()
            self.assertEqual(lines[0], f"BASEPRI {mask:02x}: {bits} bits")
            self.assertIn(f"IPR7 {mask * 0x01010101:08x} ", lines[1])
            for group in range(8):
                expected = [str(int(bool(1 << bit & mask and bit > group))) for bit in range(7, -1, -1)]
                self.assertIn(f"PRIGROUP {group}: {' '.join(expected)}", lines)

    def test_the_boards_own_width_is_3(self):
        self.assertEqual(run("priority_bits")[0].stdout, run("priority_bits", "-C", "cpu.priority_bits=3")[0].stdout)
        self.assertIn(b"BASEPRI e0: 3 bits", run("priority_bits")[0].stdout)

    def test_bits_that_do_not_exist_are_one_warning(self):
        said = warnings(run("priority_bits")[0], "priority bits")
        self.assertEqual(len(said), 1, said)
        self.assertRegex(
            said[0],
            r"IPR7 = 0x5a0000: the AN385 has 3 priority bits.*"
            + re.escape(self.HINT)
            + r" \(pc 0x[0-9a-f]{8} (main|read_back)\+",
        )
        self.assertIn(
            "the processor has 5 priority bits",
            warnings(run("priority_bits", "-C", "cpu.priority_bits=5")[0], "priority bits")[0],
        )

    def test_a_program_that_refuses_the_width_it_finds_gets_the_hint_at_the_end(self):
        ours, _ = run("priority_probe", "--simlimit", "0.01")
        self.assertEqual((ours.returncode, ours.stdout), (124, b"priority_probe: assertion failed\n"))
        said = warnings(ours, "priority bits")
        self.assertEqual(len(said), 1, said)
        self.assertRegex(said[0], r"IPR0 = 0xff: .*" + re.escape(self.HINT) + r" \(pc 0x[0-9a-f]{8} main\+")
        done, _ = run("priority_probe", "-C", "cpu.priority_bits=8")
        self.assertEqual((done.returncode, done.stdout), (0, qemu("priority_probe").stdout))

    def test_finding_out_the_width_is_no_error_in_a_run_that_passes(self):
        ours, _ = run("priority_probe", "--until-uart", "assertion")
        self.assertEqual((ours.returncode, warnings(ours, "priority")), (0, []))
        ours, _ = run("priority_probe", "--until-uart", "assertion", "-C", "log.level=info")
        self.assertIn("info: cpu: priority bits: IPR0 = 0xff: the AN385 has 3", ours.stderr.decode())

    def test_other_widths_are_refused(self):
        for bits in ("2", "9", "3.5", "eight"):
            done, _ = run("hello", "-C", f"cpu.priority_bits={bits}")
            self.assertEqual(done.returncode, 2, bits)
            self.assertIn(b"cpu.priority_bits", done.stderr)


class TaskStart(unittest.TestCase):
    """What schedulers do is worth a note and no warning: a return to a stacked PC with bit 0 set."""

    def test_is_told_at_level_info_with_the_instruction_that_returns(self):
        for executor in ("blocks", "translator", "stepping"):
            ours, _ = run("task_start", "-C", f"cpu.executor={executor}")
            self.assertEqual((ours.returncode, ours.stdout), (0, b"task_start: runs\n"))
            self.assertEqual(warnings(ours, ""), [])
            ours, _ = run("task_start", "-C", f"cpu.executor={executor}", "-C", "log.level=info")
            said = [line for line in ours.stderr.decode().splitlines() if "return_address" in line]
            self.assertEqual(len(said), 1, said)
            found = re.search(r"^info: .* at 0x([0-9a-f]{8}): .* \(pc 0x([0-9a-f]{8}) start_task\+", said[0])
            self.assertTrue(found and found.group(1) == found.group(2), said)
            self.assertRegex(instruction_at("task_start", int(found.group(1), 16)), r"\tbx\tlr")


class Overrun(unittest.TestCase):
    """A byte that a UART loses."""

    def test_is_one_warning_with_the_instruction_and_a_count(self):
        for executor in ("blocks", "translator", "stepping"):
            ours, _ = run("overrun", "-C", f"cpu.executor={executor}")
            self.assertEqual((ours.returncode, ours.stdout), (0, b"l\noverrun: done\n"))
            said = warnings(ours, "transmit overrun")
            self.assertEqual(len(said), 2, said)
            self.assertRegex(
                said[0],
                r"soc\.uart0 \(transmit overrun\): byte 0x73 is written while STATE\.TXFULL is 1, so "
                r"0x6f before it is lost \(pc 0x[0-9a-f]{8} main\+",
            )
            pc = int(re.search(r"pc (0x[0-9a-f]{8})", said[0]).group(1), 16)
            self.assertRegex(instruction_at("overrun", pc), r"\tstr\t", "the store, not the block that it is in")
            # 21 bytes: the first goes to the shifter, the second to the buffer.
            self.assertTrue(said[1].endswith("18 further messages left out"), said[1])

    def test_a_program_that_asks_is_told_nothing(self):
        self.assertEqual(warnings(run("hello")[0], "overrun"), [])


class Idle(unittest.TestCase):
    """run.end_on_idle."""

    def idle(self, mode, seconds, *options):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "mode"
            path.write_text(mode)
            return run(
                "idle", "-C", f"uart0.input={path}", "-C", f"run.end_on_idle={seconds}", "--simlimit", "8", *options
            )

    def check_ended(self, mode, seconds, at, *options):
        done, result = self.idle(mode, seconds, *options)
        self.assertEqual(done.returncode, 0, (mode, done.stderr.decode()))
        self.assertEqual(
            result["exit"]["reason"],
            f"the firmware is idle: for {seconds} simulated s only timers woke it, and only to sleep again",
        )
        self.assertAlmostEqual(result["time"]["simulated_s"], at, delta=0.01, msg=mode)
        return result

    def check_goes_on(self, mode, seconds=1):
        done, result = self.idle(mode, seconds)
        self.assertEqual((done.returncode, result["exit"]["reason"]), (124, "the limit of 8 simulated s was hit"), mode)

    def test_a_tick_that_only_wakes_to_sleep_again_is_idle(self):
        self.check_ended("t", 1, 1)
        self.check_ended("t", 2.5, 2.5)

    def test_so_are_a_late_tick_two_timers_a_busy_handler_and_no_timer_at_all(self):
        for mode in "ldhn":
            self.check_ended(mode, 1, 1)

    def test_it_counts_from_the_end_of_the_work(self):
        self.check_ended("c", 1, 4)

    def test_a_program_that_does_something_goes_on(self):
        for mode, what in (
            ("p", "prints every half second"),
            ("i", "so on the ITM"),
            ("b", "computes half of the time"),
            ("s", "never sleeps"),
            ("g", "switches a lamp"),
            ("r", "looks for a key"),
            ("a", "the ADC runs"),
        ):
            with self.subTest(what):
                self.check_goes_on(mode)

    def test_a_longer_pause_than_that_between_two_outputs_is_idle(self):
        self.check_ended("p", 0.4, 0.4)

    def test_neither_quantum_nor_executor_nor_debugger_moves_the_end(self):
        for mode in "tdc":
            ends = set()
            for options in (
                (),
                ("--quantum", 1000),
                ("--quantum", 77777),
                ("-C", "cpu.executor=stepping"),
                ("--gdb", 0),
            ):
                result = self.check_ended(mode, 0.5, 3.5 if mode == "c" else 0.5, *options)
                ends.add((result["time"]["simulated_s"], result["cpu"]["cycles"], result["cpu"]["instructions"]))
            self.assertEqual(len(ends), 1, ends)

    def test_off_it_changes_nothing(self):
        self.check_goes_on("t", 0)

    def test_what_was_waited_for_is_missing(self):
        done, result = self.idle("t", 1, "--until-uart", "^never$")
        self.assertEqual(done.returncode, 124)
        self.assertIn("no line matched --until-uart", result["exit"]["reason"])
        done, result = self.idle("t", 1, "--until-uart", "begins")
        self.assertEqual(done.returncode, 0)
        self.assertIn("printed what --until-uart names", result["exit"]["reason"])

    def test_the_main_job_is_never_idle(self):
        """The processor waits for samples, and the coprocessor works."""
        with_it, without = (run("selfcal", *options)[1] for options in (("-C", "run.end_on_idle=1"), ()))
        for result in (with_it, without):
            result["time"].pop("wall_s")
            result["cpu"].pop("mips")
            result.pop("translator", None)
            result.pop("configuration")
            result.pop("command", None)
        self.assertEqual(with_it, without)

    def test_nonsense_is_refused(self):
        for value in ("-1", "soon", "nan", "1e9"):
            done, _ = self.idle("t", value)
            self.assertEqual(done.returncode, 2, value)
            self.assertIn(b"run.end_on_idle", done.stderr)


class Differences(unittest.TestCase):
    """docs/reference/differences-from-qemu.md: every row's program on both boards."""

    PAGE = (SOURCE / "docs" / "reference" / "differences-from-qemu.md").read_text()

    @classmethod
    def rows(cls):
        """Program, line on QEMU, line here, of each row of the tables; `\\|` is a bar."""
        for line in cls.PAGE.splitlines():
            cells = [cell.strip() for cell in line.strip("|").split("|")]
            if len(cells) == 4 and re.fullmatch(r"`\w+`", cells[1]):
                yield cells[1].strip("`"), re.findall(r"`([^`]*)`", cells[2]), re.findall(r"`([^`]*)`", cells[3])

    def test_every_row_is_what_the_two_print(self):
        outputs = {}
        rows = list(self.rows())
        self.assertGreaterEqual(len(rows), 12)
        for program, theirs, ours in rows:
            if program not in outputs:
                done, _ = run(program, "--simlimit", 1)
                outputs[program] = [(p.stdout + p.stderr).decode().splitlines() for p in (qemu(program), done)]
            for name, expected, output in (
                ("QEMU", theirs, outputs[program][0]),
                ("capsoc", ours, outputs[program][1]),
            ):
                self.assertTrue(expected, f"{program}: the page does not say what {name} prints")
                for text in expected:
                    self.assertTrue(any(text in line for line in output), f"{program} on {name}: {text!r} in {output}")
            for text in theirs:
                self.assertFalse(
                    any(text == line for line in outputs[program][1]), f"{program}: {text!r} is no difference"
                )

    def test_a_program_without_differences_is_the_same_on_both(self):
        """A5.3.18, A2.3.1: what the page says both agree on."""
        done, _ = run("faults", "--simlimit", 1)
        output = qemu("faults").stdout
        self.assertEqual(done.stdout, output)
        for text in (
            rb"simd ef +6 cfsr 00010000",
            rb"simd ff +6 cfsr 00010000",
            rb"no line of ldc +6 cfsr 00080000",
            rb"even in device +4 cfsr 00000001",
            rb"even nowhere +5 cfsr 00000100",
        ):
            self.assertRegex(output, text)


if __name__ == "__main__":
    unittest.main()
