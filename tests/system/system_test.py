#!/usr/bin/env python3
"""The program as a user runs it: what it prints, what it writes, how it ends."""

import json
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

BUILD = Path(os.environ.get("CAPSOC_TEST_BUILD", "build")).resolve()
SOURCE = Path(os.environ.get("CAPSOC_TEST_SOURCE", ".")).resolve()
CAPSOC = BUILD / "capsoc"
FIRMWARE = BUILD / "firmware"
TRACES = SOURCE / "traces"


def capsoc(*arguments, environment=None):
    """Runs the program; stdout and stderr as bytes and text."""
    clean = {k: v for k, v in os.environ.items() if not k.startswith("CAPSOC_")}
    return subprocess.run([CAPSOC, *map(str, arguments)], capture_output=True, timeout=570, check=False,
                          env={**clean, **(environment or {})})


def run(*arguments):
    """`capsoc run` with its results read back."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "r.json"
        process = capsoc("run", "--json", path, *arguments)
        result = json.loads(path.read_text()) if path.exists() else None
    return process, result


def without_wall_times(result):
    """What must be the same bytes from every run."""
    result = json.loads(json.dumps(result))
    result["time"].pop("wall_s")
    result["cpu"].pop("mips")
    return result


class MainJob(unittest.TestCase):
    """The SoC calibrates the sensor of Eq (21)."""

    def check(self, arithmetic, angle, relative, relative_angle):
        process, r = run("--arithmetic", arithmetic, "--uart0", "null")
        self.assertEqual(process.returncode, 0, process.stderr.decode())
        self.assertEqual(process.stdout, b"")
        self.assertEqual(r["exit"]["code"], 0)
        self.assertGreaterEqual(r["samples"], 100_000 + 5_000)
        for name in ("a1", "a2", "b1", "b2"):
            self.assertLessEqual(abs(r["parameters"][name]["relative_error"]), relative, name)
        for name in ("beta", "phi"):
            self.assertLessEqual(abs(r["parameters"][name]["relative_error"]), relative_angle, name)
        errors = r["angle_error_deg"]
        self.assertLessEqual(errors["calibrated_max_last_revolution"], angle)
        self.assertLessEqual(errors["calibration_mode_max"], angle)
        self.assertLessEqual(r["convergence_s"], 125)
        self.assertAlmostEqual(errors["uncalibrated_max"], 25.36, delta=0.005)
        self.assertAlmostEqual(errors["uncalibrated_max_paper"], 30.38, delta=0.005)
        self.assertGreater(r["uart0"]["bytes"], 100)

    def test_precise_reaches_its_figures(self):
        self.check("precise", angle=5e-7, relative=5e-9, relative_angle=1e-7)

    def test_paper_reaches_its_figures(self):
        self.check("paper", angle=1e-3, relative=2e-5, relative_angle=1e-4)

    def test_a_reversed_sensor_is_turned_round(self):
        process, r = run("--sensor", TRACES / "soc_experiment.toml")
        self.assertIn(b"reference turned round", process.stdout)
        self.assertLess(abs(r["parameters"]["beta"]["value"]), 1.0)


class Determinism(unittest.TestCase):
    """Same inputs, same bytes; the quantum and the executor are speed knobs."""

    def test_quantum_and_executor_change_nothing(self):
        results = {}
        for name, options in {
                "10 us": [], "again": [], "100 ns": ["--quantum", 100], "10 ms": ["--quantum", 1e7],
                "stepping": ["-C", "cpu.executor=stepping"]}.items():
            process, r = run("--simlimit", 20, *options)
            self.assertEqual(process.returncode, 124)
            r = without_wall_times(r)
            r.pop("command"), r["configuration"].pop("cpu.quantum_ns"), r["configuration"].pop("cpu.executor")
            results[name] = (process.stdout, r)
        for name, outcome in results.items():
            self.assertEqual(outcome, results["10 us"], name)


class Crashes(unittest.TestCase):
    """Firmware that crashes ends with exit 5 and a report that names the cause."""

    def check(self, program, *expected):
        process = capsoc("run", FIRMWARE / f"{program}.elf", "--simlimit", 5)
        text = process.stderr.decode()
        self.assertEqual(process.returncode, 5, text)
        for part in ("fault report", "CFSR", "pc", "lr", *expected):
            self.assertIn(part, text)

    def test_a_division_by_zero(self):
        self.check("divzero", "divi", "main")

    def test_a_jump_to_an_even_address(self):
        self.check("evenjump", "CFSR       0x00020000")

    def test_a_read_of_an_unmapped_address(self):
        self.check("badread", "0x60000000")

    def test_a_stack_overflow(self):
        self.check("stackoverflow")


class Limits(unittest.TestCase):
    """What does not end by itself ends at its limit with 124."""

    def test_simulated_time(self):
        process, r = run(FIRMWARE / "forever.elf", "--simlimit", 0.5)
        self.assertEqual(process.returncode, 124)
        self.assertEqual(r["time"]["simulated_s"], 0.5)

    def test_time_of_the_host(self):
        process, r = run(FIRMWARE / "forever.elf", "--timelimit", 0.5)
        self.assertEqual(process.returncode, 124)
        self.assertIn("of the host", r["exit"]["reason"])


class Inputs(unittest.TestCase):
    """A wrong input: exit 2, one sentence that names the file, nothing left behind."""

    def check(self, expected, *arguments):
        with tempfile.TemporaryDirectory() as folder:
            process = capsoc("run", "--json", Path(folder) / "r.json", *arguments)
            self.assertEqual(os.listdir(folder), [])
        text = process.stderr.decode()
        self.assertEqual(process.returncode, 2, text)
        self.assertEqual(process.stdout, b"")
        self.assertEqual(len(text.strip().splitlines()), 1, text)
        self.assertIn(expected, text)

    def check_file(self, suffix, contents, expected, option="--sensor"):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / f"input{suffix}"
            path.write_bytes(contents)
            arguments = [option, path] if option else [path]
            self.check(f"{path}{expected}", *arguments)

    def test_a_missing_elf(self):
        self.check("none.elf", "none.elf")

    def test_a_foreign_elf(self):
        self.check("another machine", CAPSOC)

    def test_a_file_that_is_no_elf(self):
        self.check("not an ELF", TRACES / "soc_eq21.toml")

    def test_an_elf_cut_short(self):
        whole = (FIRMWARE / "hello.elf").read_bytes()
        self.check_file(".elf", whole[:4096], "", option=None)

    def test_a_section_outside_memory(self):
        whole = bytearray((FIRMWARE / "hello.elf").read_bytes())
        table = int.from_bytes(whole[28:32], "little")  # e_phoff
        whole[table + 8:table + 16] = (0x60000000).to_bytes(4, "little") * 2  # p_vaddr, p_paddr
        self.check_file(".elf", bytes(whole), ": the segment 0x60000000", option=None)

    def test_a_missing_sensor(self):
        self.check("none.toml", "--sensor", "none.toml")

    def test_a_csv_with_a_bad_row(self):
        self.check_file(".csv", b"u,v\n0.1,0.2\n0.1,x\n", ":3")

    def test_a_toml_with_an_unknown_key(self):
        text = (TRACES / "soc_eq21.toml").read_text() + "\n[nonsense]\nkey = 1\n"
        self.check_file(".toml", text.encode(), f":{text[:text.index('nonsense')].count(chr(10)) + 1}")

    def test_a_json_that_cannot_be_written(self):
        process = capsoc("run", FIRMWARE / "hello.elf", "--json", "/nonexistent/r.json")
        self.assertEqual(process.returncode, 2)
        self.assertEqual(process.stdout, b"", "it is found out before the run")


class Options(unittest.TestCase):
    """Settings and their precedence."""

    def refuse(self, expected, *arguments, **keywords):
        process = capsoc(*arguments, **keywords)
        text = process.stderr.decode()
        self.assertEqual(process.returncode, 2, text)
        self.assertEqual(len(text.strip().splitlines()), 1, text)
        self.assertIn(expected, text)

    def test_wrong_ones_are_named_with_the_nearest(self):
        self.refuse("--sensor", "run", "--senser", "x")
        self.refuse("run", "rum")
        self.refuse("coprocessor.arithmetic", "run", "-C", "coprocessor.arithmetik=paper")
        self.refuse("paper, precise", "run", "--arithmetic", "exact")
        self.refuse("out of range", "run", "--quantum", "0")
        self.refuse("whole number", "run", "-C", "sensor.adc_bits=twelve")
        self.refuse("CAPSOC_SENSOR_FILE", "run", environment={"CAPSOC_SENSOR_FIEL": "x"})

    def value_of(self, setting, *arguments, **keywords):
        process = capsoc("run", "--list-params", *arguments, **keywords)
        self.assertEqual(process.returncode, 0, process.stderr.decode())
        line = next(l for l in process.stdout.decode().splitlines() if l.split()[0] == setting)
        return line.split()[1]

    def test_precedence(self):
        name, chosen = "coprocessor.arithmetic", {"CAPSOC_COPROCESSOR_ARITHMETIC": "paper"}
        self.assertEqual(self.value_of(name), "precise")
        with tempfile.TemporaryDirectory() as folder:
            config = Path(folder) / "c.toml"
            config.write_text("[coprocessor]\narithmetic = 'paper'\n[cpu]\nquantum_ns = 77\n")
            self.assertEqual(self.value_of(name, "--config", config), "paper")
            self.assertEqual(self.value_of("cpu.quantum_ns", "--config", config), "77")
            self.assertEqual(self.value_of("cpu.quantum_ns", "--config", config,
                                           environment={"CAPSOC_CPU_QUANTUM_NS": "88"}), "88")
            config.write_text("[coprocessor]\narithmetic = 'exact'\n")
            self.refuse(f"{config}:2", "run", "--config", config)
        self.assertEqual(self.value_of(name, environment=chosen), "paper")
        self.assertEqual(self.value_of(name, "--arithmetic", "precise", environment=chosen), "precise")

    def test_info_prints_the_map(self):
        self.assertIn(b"coprocessor", capsoc("info").stdout)


class Firmware(unittest.TestCase):
    """Small programs with known answers."""

    def test_hello(self):
        process = capsoc("run", FIRMWARE / "hello.elf")
        self.assertEqual(process.returncode, 0, process.stderr.decode())
        self.assertIn(b"ello", process.stdout)

    def test_a_status_of_its_own_is_a_failure(self):
        process, r = run(FIRMWARE / "exit_code.elf")
        self.assertEqual(process.returncode, 1)
        self.assertIn("status 7", r["exit"]["reason"])

    def test_the_drivers_pass_their_self_test(self):
        process = capsoc("run", FIRMWARE / "drivers.elf", "--simlimit", 10)
        self.assertEqual(process.returncode, 0, process.stdout.decode() + process.stderr.decode())

    def test_newlib_at_every_level_of_optimisation(self):
        outputs = set()
        for level in ("", "-O0", "-O2", "-O3"):
            for executor in ("blocks", "stepping"):
                process = capsoc("run", FIRMWARE / f"newlib{level}.elf", "--simlimit", 10, "-C", f"cpu.executor={executor}")
                self.assertEqual(process.returncode, 0, process.stdout.decode() + process.stderr.decode())
                outputs.add(process.stdout)
        self.assertEqual(len(outputs), 1)


class Track(unittest.TestCase):
    """The application that needs no known speed."""

    def test_an_unknown_speed_is_found_and_followed(self):
        process, r = run(FIRMWARE / "track.elf", "--sensor", TRACES / "soc_051hz.toml")
        self.assertEqual(process.returncode, 0, process.stdout.decode() + process.stderr.decode())
        self.assertLessEqual(r["angle_error_deg"]["calibrated_max_last_revolution"], 1e-6)


class Qemu(unittest.TestCase):
    """The same ELF on qemu-system-arm: the same bytes on UART 0 and the same end."""

    def test_programs_without_the_coprocessor(self):
        for program in ("hello", "newlib", "newlib-O0", "newlib-O2", "newlib-O3", "exit_code"):
            elf = FIRMWARE / f"{program}.elf"
            theirs = subprocess.run(
                ["qemu-system-arm", "-M", "mps2-an385", "-display", "none", "-monitor", "none", "-serial", "stdio",
                 "-semihosting-config", "enable=on,target=native", "-kernel", elf],
                capture_output=True, timeout=60, check=False, stdin=subprocess.DEVNULL)
            ours = capsoc("run", elf, "--simlimit", 10)
            self.assertEqual(ours.stdout, theirs.stdout, program)
            self.assertEqual(ours.returncode == 0, theirs.returncode == 0, program)


if __name__ == "__main__":
    unittest.main()
