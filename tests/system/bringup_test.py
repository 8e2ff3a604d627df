#!/usr/bin/env python3
"""Programs that start elsewhere, use semihosting, crash in their fault handler, or reset the board over and over."""

import json
import os
import subprocess
import unittest

from harness import CAPSOC, CLEAN, Case, FIRMWARE

CTEST = {"name": "bring-up", "timeout": 600}

RESETS = int(os.environ.get("CAPSOC_RESETS", "20"))


class BringUpCase(Case):
    def run_it(self, elf, *options):
        """Exit code, stdout, stderr and results."""
        result = self.folder / "r.json"
        done = subprocess.run(
            [CAPSOC, "run", FIRMWARE / f"{elf}.elf", "--json", result, *map(str, options)],
            capture_output=True,
            timeout=570,
            check=False,
            env=CLEAN,
            stdin=subprocess.DEVNULL,
        )
        return (
            done.returncode,
            done.stdout,
            done.stderr.decode(),
            json.loads(result.read_text()) if result.exists() else None,
        )

    def words(self, *values):
        """A file of 32-bit words."""
        path = self.folder / "words.bin"
        path.write_bytes(b"".join(value.to_bytes(4, "little") for value in values))
        return path


class Semihosting(BringUpCase):
    """newlib's rdimon, start-up included."""

    def rdimon(self, *options):
        files = self.folder / "files"
        files.mkdir(exist_ok=True)
        console = self.folder / "console"
        code, uart, said, result = self.run_it(
            "rdimon",
            "--semihosting-dir",
            files,
            "--semihosting-args",
            "one two",
            "--semihosting-console",
            f"file:{console}",
            *options,
        )
        self.assertEqual(uart, b"")
        self.assertEqual(list(files.iterdir()), [], "it removes its files")
        return code, console.read_bytes(), said, result

    def test_same_text_and_status_as_qemu(self):
        code, text, said, _ = self.rdimon("-C", "semihosting.status=process")
        self.assertEqual(code, 23, text.decode() + said)
        theirs = subprocess.run(
            [
                "qemu-system-arm",
                "-M",
                "mps2-an385",
                "-display",
                "none",
                "-monitor",
                "none",
                "-serial",
                "null",
                "-semihosting-config",
                "enable=on,target=native,arg=rdimon.elf,arg=one,arg=two",
                "-kernel",
                FIRMWARE / "rdimon.elf",
            ],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            timeout=60,
            check=False,
            stdin=subprocess.DEVNULL,
            cwd=self.folder,
        )
        self.assertEqual((code, sorted(text.splitlines())), (theirs.returncode, sorted(theirs.stdout.splitlines())))

    def test_every_run_is_the_same(self):
        def essence(outcome):
            return outcome[0], outcome[1], outcome[3]["cpu"]["cycles"]

        first = essence(self.rdimon())
        self.assertEqual(first[0], 1, "a verdict, unless the status itself is asked for")
        for options in (["--quantum", 100], ["-C", "cpu.executor=stepping"], ["--uart0", "pty"]):
            self.assertEqual(essence(self.rdimon(*options)), first, options)

    def test_without_a_directory_there_are_no_files(self):
        code, _, said, _ = self.run_it("rdimon")
        self.assertEqual(code, 1)
        self.assertIn("open for writing             FAILED", said)
        self.assertIn("an unknown file", said)

    def test_a_wrong_directory_is_refused(self):
        code, _, said, result = self.run_it("rdimon", "--semihosting-dir", "/nonexistent")
        self.assertEqual((code, result), (2, None))
        self.assertIn("/nonexistent: cannot be opened", said)


class Calls(BringUpCase):
    """Each call against the semihosting specification (Arm, "Semihosting for AArch32 and AArch64", 2.0) and against
    QEMU.
    """

    # What SYS_READ and SYS_WRITE have not done is their result, all of it if they fail.
    SPECIFIED = """open for writing: 1
write ten bytes: 0
length: 10
read of a file for writing: 5
its error is EBADF: 1
is a terminal: 0
seek to 3: 0
write over two: 0
close: 0
close again: -1
read four: 0 "012X"
read ten of six: 4 "Y56789"
read at the end: 16
read nothing: 0
seek past the end: 0
read past the end: 3
write to a file for reading: 1
append two: 0
length behind append: 12
seek to 20: 0
write behind a hole: 0
length with the hole: 21
the hole is zero: 0
open what is not there: -1
its error is ENOENT: 1
open it for reading and writing: -1
rename: 0
remove the old name: -1
remove: 0
open with mode 12: -1
read from no handle: 3
write to no handle: 3
length of no handle: -1
no handle is a terminal: -1
seek in no handle: -1
close no handle: -1
three consoles: 1
write to the console: 0
write to its errors: 0
write to its input: 1
features: 1
their length: 5
their magic: 0 "SHFB"
their byte: 0
its bits: 3
read behind them: 1
write to them: 1
seek in them: 0
close them: 0
open them for writing: -1
5 is an error: 0
-3 is an error: 1
clock: 1
time: 1
tick frequency: 1
elapsed: 0
it is not zero: 1
command line: 0
its length: 1
command line in two bytes: -1
temporary name: 0
it is a name: 1
"""
    # QEMU 7.2: a read that fails leaves no errno, and what was appended is not in the file.
    QEMU_DIFFERS = {
        "its error is EBADF: 1": "its error is EBADF: 0",
        "length behind append: 12": "length behind append: 10",
    }

    def test_every_line_is_as_specified(self):
        for options in ((), ("-C", "cpu.executor=stepping"), ("--quantum", 1000)):
            code, uart, said, _ = self.run_it("semihosting_calls", "--semihosting-dir", self.folder, *options)
            self.assertEqual((code, uart.decode()), (0, self.SPECIFIED))
            self.assertIn("[out]\n[err]\n", said)

    def test_qemu_prints_the_same_lines(self):
        theirs = subprocess.run(
            [
                "qemu-system-arm",
                "-M",
                "mps2-an385",
                "-display",
                "none",
                "-monitor",
                "none",
                "-serial",
                "stdio",
                "-semihosting-config",
                "enable=on,target=native",
                "-kernel",
                FIRMWARE / "semihosting_calls.elf",
            ],
            capture_output=True,
            timeout=60,
            check=False,
            stdin=subprocess.DEVNULL,
            cwd=self.folder,
        )
        # Whether its input can be written is a matter of the host's descriptor there.
        lines = [
            line
            for line in theirs.stdout.decode().splitlines()
            if line not in ("[out]", "x") and not line.startswith("write to its input")
        ]
        self.assertEqual(
            lines,
            [
                self.QEMU_DIFFERS.get(line, line)
                for line in self.SPECIFIED.splitlines()
                if not line.startswith("write to its input")
            ],
        )

    def test_a_text_has_any_length(self):
        expected = "".join("\n" if i % 50 == 49 else chr(ord("a") + i % 26) for i in range(30000))
        console = self.folder / "console"
        self.assertEqual(self.run_it("long_text", "--semihosting-console", f"file:{console}")[0], 0)
        self.assertEqual(console.read_text(), expected)
        theirs = subprocess.run(
            [
                "qemu-system-arm",
                "-M",
                "mps2-an385",
                "-display",
                "none",
                "-monitor",
                "none",
                "-serial",
                "null",
                "-semihosting-config",
                "enable=on,target=native",
                "-kernel",
                FIRMWARE / "long_text.elf",
            ],
            capture_output=True,
            timeout=60,
            check=False,
            stdin=subprocess.DEVNULL,
        )
        self.assertEqual((theirs.stdout + theirs.stderr).decode(), expected)


class VectorTable(BringUpCase):
    """A program whose vector table is not at 0."""

    def test_it_is_found(self):
        for program in ("hello_psram", "hello_sram"):
            self.assertEqual(self.run_it(program)[:2], (0, b"hello from capsoc\n"), program)

    def test_it_is_found_in_hex(self):
        path = self.folder / "hello.hex"
        subprocess.run(["arm-none-eabi-objcopy", "-O", "ihex", FIRMWARE / "hello_psram.elf", path], check=True)
        done = subprocess.run([CAPSOC, "run", path], capture_output=True, timeout=60, check=False, env=CLEAN)
        self.assertEqual((done.returncode, done.stdout), (0, b"hello from capsoc\n"))

    def test_it_is_named(self):
        raw = self.folder / "hello.bin"
        subprocess.run(
            [
                "arm-none-eabi-objcopy",
                "-O",
                "binary",
                "-j",
                ".text",
                "-j",
                ".ARM.exidx",
                "-j",
                ".data",
                FIRMWARE / "hello_psram.elf",
                raw,
            ],
            check=True,
        )
        load = ("--load", f"{raw}@0x21000000")
        self.assertEqual(self.run_it("forever", *load, "--simlimit", 0.01)[1], b"forever: looping\n", "0 comes first")
        self.assertEqual(self.run_it("forever", *load, "--vector-table", "0x21000000")[1], b"hello from capsoc\n")

    def test_what_is_none_is_refused(self):
        for address in ("0x21000040", "0x40000000", "here", "-128", ""):
            code, _, said, _ = self.run_it("hello", "--vector-table", address)
            self.assertEqual(code, 2, address)
            self.assertIn("--vector-table", said)
        raw = bytearray((FIRMWARE / "hello_psram.elf").read_bytes())
        raw[24:28] = (0x21000001).to_bytes(4, "little")  # e_entry
        path = self.folder / "odd.elf"
        path.write_bytes(raw)
        done = subprocess.run([CAPSOC, "run", path], capture_output=True, timeout=60, check=False, env=CLEAN)
        self.assertEqual(done.returncode, 2)
        self.assertIn(b"nothing is loaded at 0", done.stderr)


class FaultHandler(BringUpCase):
    """A fault handler that branches to itself."""

    def spin(self, mode, *options):
        return self.run_it("spin", "--load", f"{self.words(mode)}@0x21000000", *options)

    def test_it_is_a_crash_with_a_report(self):
        cycles = set()
        for options in ([], ["-C", "cpu.executor=stepping"], ["--quantum", 100]):
            code, uart, said, result = self.spin(0, *options)
            self.assertEqual((code, uart), (5, b"spin: faulting\n"), said)
            for part in ("branches to itself", "fault report: HardFault", "0x60000000", "main"):
                self.assertIn(part, said)
            cycles.add(result["cpu"]["cycles"])
        self.assertEqual(len(cycles), 1)

    def test_it_may_spin(self):
        code, _, _, result = self.spin(0, "-C", "run.stop_in_fault=false", "--simlimit", 0.1)
        self.assertEqual((code, result["time"]["simulated_s"]), (124, 0.1))

    def test_a_watchdog_may_still_help(self):
        code, uart, said, _ = self.spin(1)
        self.assertEqual((code, uart), (0, b"spin: faulting\nspin: the watchdog helped\n"), said)

    def test_a_loop_elsewhere_is_none(self):
        self.assertEqual(self.spin(3, "--simlimit", 0.1)[0], 124)


class Resets(BringUpCase):
    """Reset the board many times in one process, then run the main job; CAPSOC_RESETS sets how often."""

    def test_the_main_job_is_the_same_as_in_a_fresh_process(self):
        fresh = self.run_it("selfcal")
        plan = f"{self.words(RESETS, 0, 0)}@0x21F00000"
        selfcal = FIRMWARE / "selfcal.elf"
        used = self.run_it(
            "resets", "--load", selfcal, "--load", plan, "--vector-table", "0x21000000", "--log-level", "off"
        )
        self.assertEqual(fresh[0], 0, fresh[2])
        self.assertEqual(used[0], 0, used[2])
        self.assertTrue(used[1] == fresh[1], "UART 0")
        for key in ("parameters", "samples", "uart0"):
            self.assertEqual(used[3][key], fresh[3][key], key)
        self.assertGreater(used[3]["cpu"]["cycles"], fresh[3]["cpu"]["cycles"])
        print(
            f"resets: {RESETS}, then the same {used[3]['uart0']['bytes']} bytes of UART 0 and the same parameters "
            f"as in a fresh process",
            flush=True,
        )


if __name__ == "__main__":
    unittest.main()
