#!/usr/bin/env python3
"""The translator as a user meets it: what it says, what it writes, and that it changes nothing."""

import ctypes
import json
import os
import re
import struct
import subprocess
import unittest
from pathlib import Path

from harness import CAPSOC, CLEAN, Case, FIRMWARE

CTEST = {"name": "system: Translator", "whole": True}

HAS_TRANSLATOR = os.uname().machine == "x86_64"
INFO = ("--log-level", "info")


def refuse_executable_memory():
    """For a child: a seccomp filter under which mmap(PROT_EXEC, MAP_ANONYMOUS) is EACCES; libraries load."""
    load, equal, set_, give = 0x20, 0x15, 0x45, 0x06
    steps = [
        (load, 0, 0, 0),
        (equal, 0, 5, 9),
        (load, 0, 0, 32),
        (set_, 0, 3, 4),
        (load, 0, 0, 40),
        (set_, 0, 1, 0x20),
        (give, 0, 0, 0x00050000 | 13),
        (give, 0, 0, 0x7FFF0000),
    ]
    code = b"".join(struct.pack("=HBBI", *step) for step in steps)
    buffer = ctypes.create_string_buffer(code, len(code))
    program = ctypes.create_string_buffer(struct.pack("@HP", len(steps), ctypes.addressof(buffer)))
    libc = ctypes.CDLL(None, use_errno=True)
    if libc.prctl(38, 1, 0, 0, 0) or libc.prctl(22, 2, program):
        raise OSError(ctypes.get_errno(), "no seccomp")


class Translator(Case):
    def run_with(self, program, *options, **how):
        """What the run came to, without what the host's clock says, and what it said."""
        path = self.folder / "r.json"
        # Turns of polling loops that are skipped are no executor's.
        done = subprocess.run(
            [
                CAPSOC,
                "run",
                FIRMWARE / f"{program}.elf",
                "--json",
                path,
                "-C",
                "cpu.fast_forward=false",
                *map(str, options),
            ],
            capture_output=True,
            timeout=300,
            check=False,
            env=CLEAN,
            **how,
        )
        self.assertTrue(path.exists(), done.stderr.decode())
        result = json.loads(path.read_text())
        result["time"].pop("wall_s"), result["cpu"].pop("mips"), result.pop("command"), result.pop("configuration")
        counts = result.pop("translator", None)
        return (done.returncode, done.stdout, result), counts, done.stderr.decode()

    def test_neither_the_threshold_nor_the_buffer_changes_a_result(self):
        for program in ("newlib", "threads", "mpu-O2", "exceptions-O2"):
            blocks, none, _ = self.run_with(program, "-C", "cpu.executor=blocks")
            self.assertIsNone(none)
            for options in (
                (),
                ("-C", "cpu.translate_after=1"),
                ("-C", "cpu.translate_after=2", "-C", "cpu.code_buffer_kib=72"),
            ):
                outcome, counts, _ = self.run_with(program, *options)
                self.assertEqual(outcome, blocks, (program, options))
                if HAS_TRANSLATOR and options:
                    self.assertGreater(counts["instructions"], 1000)

    @unittest.skipUnless(HAS_TRANSLATOR, "x86-64")
    def test_the_results_say_what_each_executor_did(self):
        outcome, counts, _ = self.run_with("bench_crc")
        self.assertGreater(counts["blocks"], 0)
        self.assertGreater(counts["bytes"], 100)
        self.assertGreater(counts["share"]["translator"], 0.99)
        self.assertAlmostEqual(sum(counts["share"].values()), 1)
        self.assertAlmostEqual(
            counts["share"]["translator"], counts["instructions"] / outcome[2]["cpu"]["instructions"], 6
        )

    @unittest.skipUnless(HAS_TRANSLATOR, "x86-64")
    def test_a_small_buffer_is_emptied(self):
        _, counts, _ = self.run_with("newlib", "-C", "cpu.translate_after=1", "-C", "cpu.code_buffer_kib=72")
        self.assertGreater(counts["evictions"], 3)

    @unittest.skipUnless(HAS_TRANSLATOR, "x86-64")
    def test_where_memory_may_not_be_executed_the_log_says_so_once(self):
        usual, _, said = self.run_with("newlib", *INFO)
        self.assertNotIn("translator", said)
        try:
            outcome, counts, said = self.run_with("newlib", *INFO, preexec_fn=refuse_executable_memory)
        except subprocess.SubprocessError:
            self.skipTest("no seccomp")
        self.assertEqual(outcome, usual)
        self.assertIsNone(counts)
        self.assertEqual(said.count("blocks instead of the translator: this system refuses executable memory"), 1, said)
        _, _, said = self.run_with("newlib", preexec_fn=refuse_executable_memory)
        self.assertNotIn("translator", said)

    @unittest.skipUnless(HAS_TRANSLATOR, "x86-64")
    def test_a_trace_shows_instructions_and_host_code_and_is_the_same_again(self):
        texts = []
        for name in ("a.txt", "b.txt"):
            self.run_with("newlib", "-C", "cpu.translate_after=1", "--trace-translation", self.folder / name)
            texts.append((self.folder / name).read_text())
        self.assertEqual(*texts)
        self.assertRegex(texts[0], r"(?m)^block [0-9a-f]{8} main\+0x")
        self.assertRegex(texts[0], r"(?m)^  [0-9a-f]{8} push \{")
        self.assertRegex(texts[0], r"(?m)^ {12}mov [a-z0-9]+, .* ; [0-9A-F]+$")
        _, counts, _ = self.run_with(
            "newlib", "-C", "cpu.translate_after=1", "--trace-translation", self.folder / "c.txt"
        )
        blocks = re.findall(r"(?m)^block .*: (\d+) bytes", texts[0])
        self.assertEqual((len(blocks), sum(map(int, blocks))), (counts["blocks"], counts["bytes"]))

    @unittest.skipUnless(HAS_TRANSLATOR, "x86-64")
    def test_perf_finds_the_names_of_blocks(self):
        before = set(Path("/tmp").glob("perf-*.map"))
        process = subprocess.Popen(
            [
                CAPSOC,
                "run",
                FIRMWARE / "newlib.elf",
                "--uart0",
                "null",
                "-C",
                "cpu.translate_after=1",
                "-C",
                "trace.perf_map=true",
            ],
            env=CLEAN,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        self.assertEqual(process.wait(), 0)
        names = Path(f"/tmp/perf-{process.pid}.map")
        self.addCleanup(names.unlink)
        self.assertRegex(names.read_text(), r"(?m)^[0-9a-f]+ [0-9a-f]+ [0-9a-f]{8} main\+0x")
        self.run_with("hello")
        self.assertLessEqual(set(Path("/tmp").glob("perf-*.map")) - before - {names}, set(), "only on request")

    def test_a_place_that_cannot_be_written_is_said_before_the_run(self):
        done = subprocess.run(
            [CAPSOC, "run", FIRMWARE / "hello.elf", "--trace-translation", self.folder / "none" / "t.txt"],
            capture_output=True,
            check=False,
            env=CLEAN,
        )
        self.assertEqual((done.returncode, done.stdout), (2, b""))
        self.assertIn(b"cannot be written", done.stderr)

    def test_it_needs_less_than_200_mb(self):
        process = subprocess.Popen(
            [CAPSOC, "run", FIRMWARE / "newlib.elf", "--uart0", "null", "-C", "cpu.translate_after=1"],
            env=CLEAN,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        _, _, usage = os.wait4(process.pid, 0)
        process.returncode = 0
        self.assertLess(usage.ru_maxrss, 200 << 10)


if __name__ == "__main__":
    unittest.main()
