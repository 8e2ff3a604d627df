#!/usr/bin/env python3
"""What scripts change and read: settings of programs, keys of a sensor, columns of a record, tables as data."""

import csv
import json
import re
import shlex
import subprocess
import unittest

from harness import CAPSOC, CLEAN, Case, FIRMWARE, TRACES

CTEST = {"name": "scripting"}


def capsoc(*arguments, environment=None, stdin=b""):
    """Runs the program; stdout and stderr as bytes."""
    return subprocess.run(
        [CAPSOC, *map(str, arguments)],
        capture_output=True,
        timeout=570,
        check=False,
        input=stdin,
        env={**CLEAN, **(environment or {})},
    )


class ScriptingCase(Case):
    def run_soc(self, *arguments, code=0, **keywords):
        """`capsoc run` with its results read back."""
        path = self.folder / "r.json"
        process = capsoc("run", "--json", path, *arguments, **keywords)
        self.assertEqual(process.returncode, code, process.stdout.decode() + process.stderr.decode())
        return process, json.loads(path.read_text())

    def refuse(self, expected, *arguments, **keywords):
        process = capsoc(*arguments, **keywords)
        text = process.stderr.decode()
        self.assertEqual(process.returncode, 2, text)
        self.assertEqual(process.stdout, b"")
        self.assertEqual(len(text.strip().splitlines()), 1, text)
        self.assertIn(expected, text)


class ProgramSettings(ScriptingCase):
    """`-P name=value` and what else sets them."""

    def listed(self, *arguments, **keywords):
        process = capsoc("run", "--list-program-settings", *arguments, **keywords)
        self.assertEqual(process.returncode, 0, process.stderr.decode())
        return {line.split()[0]: line for line in process.stdout.decode().splitlines()}

    def test_every_application_lists_its_own(self):
        for program, name in (
            ("selfcal", "frequency_hz"),
            ("track", "drift_divider"),
            ("unordered", "step"),
            ("calibrate", "angle_stride"),
        ):
            lines = self.listed(FIRMWARE / f"{program}.elf")
            self.assertIn(name, lines)
            self.assertIn("rate_hz", lines)
            self.assertRegex(lines["rate_hz"], r"250 +Hz +1 \.\. 100000 +built-in +samples a second")

    def test_precedence(self):
        config = self.folder / "c.toml"
        config.write_text("[program]\nrate_hz = 111\n")
        chosen = {"CAPSOC_PROGRAM_RATE_HZ": "222"}
        for expected, source, arguments, keywords in (
            ("250", "built-in", [], {}),
            ("111", "file", ["--config", config], {}),
            ("222", "environment", ["--config", config], {"environment": chosen}),
            ("333", "command line", ["--config", config, "-P", "rate_hz=333"], {"environment": chosen}),
            ("444", "command line", ["-C", "program.rate_hz=444"], {}),
        ):
            line = self.listed(*arguments, **keywords)["rate_hz"]
            self.assertEqual(line.split()[1], expected)
            self.assertIn(source, line)

    def test_wrong_ones_are_a_sentence(self):
        self.refuse("-P stap=1: ", "run", "-P", "stap=1")
        self.refuse("it has baud, rate_hz, frequency_hz, step,", "run", "-P", "stap=1")
        self.refuse("-P step=fast: step cannot be 'fast'; give a number", "run", "-P", "step=fast")
        self.refuse("give 1 .. 100000 Hz", "run", "-P", "rate_hz=0")
        self.refuse("write name=value", "run", "-P", "step")
        self.refuse("lower-case", "run", "-P", "Step=1")
        self.refuse("hello.elf has no settings", "run", FIRMWARE / "hello.elf", "-P", "step=1")
        self.refuse("environment CAPSOC_PROGRAM_STAP", "run", environment={"CAPSOC_PROGRAM_STAP": "1"})
        config = self.folder / "c.toml"
        config.write_text("[program]\n\nrate_hz = 0\n")
        self.refuse(f"{config}:3: rate_hz = 0 is out of range", "run", "--config", config)

    def test_another_rate_keeps_the_speed_of_the_shaft(self):
        # 300 does not divide the clock: the reference has to follow the converter's own period.
        for rate, bound in ((500, 1e-5), (300, 1e-6)):
            _, r = self.run_soc("-P", f"rate_hz={rate}", "-P", "step=0", "-P", "demodulation_samples=150000")
            self.assertEqual(r["samples"], 155_000)
            self.assertAlmostEqual(r["time"]["simulated_s"], 155_000 / rate, delta=0.1)
            self.assertLessEqual(r["angle_error_deg"]["calibrated_max_last_revolution"], bound)
            self.assertLessEqual(r["convergence_s"], 125)  # six turns, whatever the rate
            self.assertEqual(r["configuration"]["program.rate_hz"], str(rate))
            self.assertEqual(r["configuration"]["program.frequency_hz"], "0.05")

    def test_the_step_follows_the_speed_when_it_is_0(self):
        trace = self.folder / "fast.toml"
        trace.write_text((TRACES / "soc_eq21.toml").read_text().replace("frequency_hz = 0.05", "frequency_hz = -1"))
        _, r = self.run_soc(
            "--sensor", trace, "-P", "frequency_hz=-1", "-P", "step=0", "-P", "demodulation_samples=10000"
        )
        self.assertLessEqual(r["angle_error_deg"]["calibrated_max_last_revolution"], 1e-5)
        self.assertLessEqual(r["convergence_s"], 10)

    def test_a_length_that_is_no_whole_second_is_kept(self):
        process, r = self.run_soc("-P", "demodulation_samples=30001", "-P", "calibration_samples=7")
        self.assertEqual(r["samples"], 30_008)
        self.assertIn(b"selfcal: pass", process.stdout)

    def test_a_shaft_that_is_too_fast_is_told(self):
        process, _ = self.run_soc("-P", "frequency_hz=125", code=1)
        self.assertIn(b"too high for rate_hz", process.stdout)
        self.run_soc("-P", "frequency_hz=-124", "-P", "demodulation_samples=250", code=1)

    def test_the_command_reproduces_the_run(self):
        first, r = self.run_soc("-P", "baud=57600", "-P", "demodulation_samples=50000", "-P", "calibration_samples=500")
        self.assertIn("-C program.baud=57600 -C program.demodulation_samples=50000", r["command"])
        words = shlex.split(r["command"])
        again = capsoc(*words[1:])
        self.assertEqual(again.returncode, 0)
        self.assertEqual(again.stdout, first.stdout)


class SensorSettings(ScriptingCase):
    """`-C sensor.KEY=value` over a description, and what comes on standard input."""

    SHORT = ("--simlimit", 0.5, "--uart0", "null")

    def short(self, *arguments, **keywords):
        """A run that ends early: its results tell what was set."""
        return self.run_soc(*self.SHORT, *arguments, code=124, **keywords)[1]

    def test_keys_lie_over_the_file(self):
        r = self.short("-C", "sensor.a1=0.5", "-C", "sensor.phi_rad=-1", "-C", "sensor.motion.frequency_hz=0.25")
        self.assertEqual(r["parameters"]["a1"]["true"], 0.5)
        self.assertEqual(r["parameters"]["a2"]["true"], 0.6228)
        self.assertEqual(r["parameters"]["phi"]["true"], -1)
        self.assertEqual(r["configuration"]["sensor.a1"], "0.5")
        self.assertNotIn("sensor.a2", r["configuration"])
        self.assertIn("-C sensor.a1=0.5 -C sensor.phi_rad=-1 -C sensor.motion.frequency_hz=0.25", r["command"])

    def test_precedence(self):
        config = self.folder / "c.toml"
        config.write_text("[sensor]\na1 = 0.4\n[sensor.noise]\nsigma = 1e-3\nseed = 7\n")
        chosen = {"CAPSOC_SENSOR_A1": "0.3", "CAPSOC_SENSOR_NOISE_SEED": "8"}
        for a1, seed, arguments, keywords in (
            (0.4, "7", [], {}),
            (0.3, "8", [], {"environment": chosen}),
            (0.2, "9", ["-C", "sensor.a1=0.2", "-C", "sensor.noise.seed=9"], {"environment": chosen}),
        ):
            r = self.short("--config", config, *arguments, **keywords)
            self.assertEqual(r["parameters"]["a1"]["true"], a1)
            self.assertEqual(r["configuration"]["sensor.noise.seed"], seed)

    def samples(self, *arguments):
        path = self.folder / "record.csv"
        self.short("--record", path, *arguments)
        return path.read_text().splitlines()[1:]

    def test_the_samples_are_those_of_an_edited_file(self):
        edited = self.folder / "edited.toml"
        text = (TRACES / "soc_eq21.toml").read_text().replace('kind = "constant"', 'kind = "shuffled"\nseed = 3')
        text = text.replace("frequency_hz = 0.05", "")
        edited.write_text(
            text + '\n[[harmonics]]\nchannel = "u"\norder = 3\namplitude = 0.01\nphase_rad = 0.5\n'
            "[noise]\nsigma = 1e-3\nseed = 4\n"
        )
        overlaid = self.samples(
            "-C",
            "sensor.motion.kind=shuffled",
            "-C",
            "sensor.motion.seed=3",
            "-C",
            "sensor.harmonics.u3_amplitude=0.01",
            "-C",
            "sensor.harmonics.u3_phase_rad=0.5",
            "-C",
            "sensor.noise.sigma=1e-3",
            "-C",
            "sensor.noise.seed=4",
        )
        self.assertEqual(overlaid, self.samples("--sensor", edited))
        self.assertNotEqual(overlaid, self.samples())
        self.assertEqual(
            self.samples(
                "--sensor",
                edited,
                "-C",
                "sensor.harmonics.u3_amplitude=",
                "-C",
                "sensor.noise.sigma=",
                "-C",
                "sensor.noise.seed=",
                "-C",
                "sensor.motion.kind=constant",
                "-C",
                "sensor.motion.frequency_hz=0.05",
            ),
            self.samples(),
        )

    def test_noise_of_the_other_kind_goes(self):
        self.short("--sensor", TRACES / "soc_noise_1e-2.toml", "-C", "sensor.noise.sigma=1e-4")

    def test_wrong_ones_are_a_sentence(self):
        for assignment, expected in (
            ("a1=0", "'a1' in [signal] = 0 is out of range"),
            ("a1=big", "is not a number"),
            ("samples=0.5", "is not an integer"),
            ("noise.sigma=1", "'seed' is missing in [noise]"),
            ("motion.kind=walking", "nearest known are walk"),
            ("motion.ripple_hz=1", "unknown key 'ripple_hz' in [motion]"),
            ("harmonics.u1_amplitude=0.1", "'order' in [harmonics] = 1 is out of range"),
            ("harmonics.w3_amplitude=0.1", "u3_amplitude"),
            ("harmonics.u3_phase_rad=1", "'amplitude' is missing"),
            ("a3=1", "did you mean"),
        ):
            self.refuse(f"-C sensor.{assignment}: ", "run", "-C", f"sensor.{assignment}")
            self.refuse(expected, "run", "-C", f"sensor.{assignment}")
        self.refuse("environment CAPSOC_SENSOR_A1: ", "run", environment={"CAPSOC_SENSOR_A1": "0"})
        self.refuse("-C sensor.a1=1: ", "run", "--sensor", TRACES / "recorded_example.csv", "-C", "sensor.a1=1")

    def test_standard_input_is_a_description_or_a_recording(self):
        for name in ("soc_ripple.toml", "recorded_example.csv"):
            contents = (TRACES / name).read_bytes()
            direct = self.short("--sensor", TRACES / name)
            piped = self.short("--sensor", "-", stdin=b"# a comment\n\n" + contents)
            self.assertEqual(piped["parameters"], direct["parameters"])
            self.assertEqual(piped["samples"], direct["samples"])
            piped = self.short("--sensor", "-", stdin=contents)
            self.assertEqual(piped["inputs"][1]["path"], "-")
            self.assertEqual(piped["inputs"][1]["sha256"], direct["inputs"][1]["sha256"])
        r = self.short("--sensor", "-", "-C", "sensor.a1=0.5", stdin=(TRACES / "soc_eq21.toml").read_bytes())
        self.assertEqual(r["parameters"]["a1"]["true"], 0.5)

    def test_standard_input_that_cannot_be_used(self):
        self.refuse("standard input:1: ", "run", "--sensor", "-", stdin=b"")
        self.refuse("standard input:2: ", "run", "--sensor", "-", stdin=b"u,v\n1,x\n")
        self.refuse("standard input:2: ", "run", "--sensor", "-", stdin=b"[signal]\na1 = = 2\n")
        self.refuse("standard input already", "run", "--sensor", "-", "--uart0", "stdio")
        self.refuse("standard input already", "run", "--sensor", "-", "--uart0", "null", "--uart1", "stdio")
        self.refuse("standard input:2: ", "fit", "-", stdin=b"u,v\n0.1\n")

    def test_fit_takes_it_too(self):
        contents = (TRACES / "csfn_eq.toml").read_bytes()
        results = []
        for trace, stdin in ((TRACES / "csfn_eq.toml", b""), ("-", contents)):
            process = capsoc(
                "fit", trace, "--json", self.folder / "c.json", "--header", self.folder / "c.h", stdin=stdin
            )
            self.assertEqual(process.returncode, 0, process.stderr.decode())
            results.append(json.loads((self.folder / "c.json").read_text()))
        self.assertEqual(results[0]["parameters"], results[1]["parameters"])
        self.assertEqual(results[1]["inputs"][0]["path"], "-")
        self.assertEqual(results[0]["inputs"][0]["sha256"], results[1]["inputs"][0]["sha256"])


class Record(ScriptingCase):
    """`--record-columns`"""

    ALL = (
        "sample,t,u,v,angle_deg,found_deg,found_word,error_deg,a1,a2,b1,b2,beta_rad,phi_rad,err_u,err_v,error_average,"
        "error_average_word,status,flags"
    )

    def rows(self, path):
        lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
        names = lines[0].split(",")
        return [dict(zip(names, line.split(","))) for line in lines[1:]]

    def test_every_column_of_the_main_job(self):
        path = self.folder / "all.csv"
        _, r = self.run_soc("--record", path, "--record-columns", self.ALL)
        rows = self.rows(path)
        self.assertEqual(len(rows), 105_001)  # the turn ends one sample after the 5000 of calibration
        self.assertEqual(list(rows[0]), self.ALL.split(","))
        last = rows[99_999]  # the last sample of demodulation
        self.assertEqual(last["sample"], "99999")
        self.assertAlmostEqual(float(last["t"]), 399.996, places=9)
        for name, key in (("a1", "a1"), ("b2", "b2"), ("beta", "beta_rad"), ("phi", "phi_rad")):
            self.assertEqual(float(last[key]), r["parameters"][name]["value"], name)
        self.assertAlmostEqual(int(last["found_word"]) / 2**32 * 360, float(last["found_deg"]), places=12)
        largest = max(abs(float(row["error_deg"])) for row in rows[100_000:])
        self.assertAlmostEqual(largest, r["angle_error_deg"]["calibration_mode_max"], places=12)
        for row in (rows[0], last):
            difference = (float(row["found_deg"]) - float(row["angle_deg"]) + 180) % 360 - 180
            self.assertAlmostEqual(float(row["error_deg"]), difference, places=9)
        # Before anything was learnt the whole sample is the error.
        self.assertAlmostEqual(float(rows[0]["err_u"]), float(rows[0]["u"]), places=8)
        self.assertLess(abs(float(last["err_u"])), 1e-8)
        self.assertLess(float(last["error_average"]), float(rows[1000]["error_average"]))

    def test_the_default_is_as_it_was(self):
        path, chosen = self.folder / "r.csv", self.folder / "c.csv"
        short = ("--simlimit", 2, "--uart0", "null")
        self.run_soc(*short, "--record", path, code=124)
        self.run_soc(*short, "--record", chosen, "--record-columns", "t,u,v,angle_deg", code=124)
        self.assertEqual(path.read_bytes(), chosen.read_bytes())
        self.assertEqual(path.read_text().splitlines()[1], "t,u,v,angle_deg")

    def test_it_still_is_a_trace(self):
        path = self.folder / "all.csv"
        _, first = self.run_soc(
            "--record",
            path,
            "--record-columns",
            self.ALL,
            "-P",
            "demodulation_samples=40000",
            "-P",
            "calibration_samples=0",
        )
        _, again = self.run_soc("--sensor", path, "-P", "demodulation_samples=40000", "-P", "calibration_samples=0")
        self.assertEqual(
            {n: p["word"] for n, p in first["parameters"].items()},
            {n: p["word"] for n, p in again["parameters"].items()},
        )
        process = capsoc("fit", path, "--json", self.folder / "c.json", "--header", self.folder / "c.h")
        self.assertEqual(process.returncode, 0, process.stderr.decode())

    def test_the_rtl_gives_the_same_bytes(self):
        for arithmetic in ("precise", "paper"):
            records = []
            for backend in ("tlm", "rtl", "lockstep"):
                path = self.folder / f"{backend}.csv"
                self.run_soc(
                    "--coprocessor",
                    backend,
                    "--arithmetic",
                    arithmetic,
                    "--record",
                    path,
                    "--record-columns",
                    self.ALL,
                    "-P",
                    "demodulation_samples=2000",
                    "-P",
                    "calibration_samples=500",
                    code=1,
                )
                records.append(path.read_text().split("\n", 1)[1])  # the first line names the run
            self.assertEqual(records[0].count("\n"), 2501)
            self.assertEqual(records[0], records[1])
            self.assertEqual(records[0], records[2])

    def test_a_sensor_without_a_truth_leaves_its_columns_out(self):
        trace = self.folder / "t.csv"
        trace.write_text("u,v\n" + "0.1,0.2\n" * 10)
        path = self.folder / "r.csv"
        self.run_soc("--sensor", trace, "--record", path, "--record-columns", "u,v,angle_deg,error_deg,status", code=1)
        rows = self.rows(path)
        self.assertEqual(list(rows[0]), ["u", "v", "error_deg", "status"])
        self.assertEqual({row["error_deg"] for row in rows}, {""})

    def test_wrong_columns_are_a_sentence(self):
        path = self.folder / "r.csv"
        self.refuse(
            "there is no column 'angel'; choose from sample, t, u, v,",
            "run",
            "--record",
            path,
            "--record-columns",
            "u,angel",
        )
        self.refuse("'u' is there twice", "run", "--record", path, "--record-columns", "u,v,u")
        self.refuse("there is no column ''", "run", "--record", path, "--record-columns", "u,,v")
        self.refuse("give --record", "run", "--record-columns", "u,v")
        self.assertFalse(path.exists())


class Tables(ScriptingCase):
    """`--table`, `--json` and `--csv` of what prints tables."""

    def data(self, *arguments, code=0):
        """Rows of the CSV, the JSON and the text of one call."""
        files = {suffix: self.folder / f"t.{suffix}" for suffix in ("csv", "json")}
        process = capsoc(*arguments, "--csv", files["csv"], "--json", files["json"])
        self.assertEqual(process.returncode, code, process.stderr.decode())
        with open(files["csv"], newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        return rows, json.loads(files["json"].read_text()), process.stdout.decode()

    def check_same(self, rows, results):
        """CSV and JSON carry the same fields."""
        flat = [dict(row, table=table["id"]) for table in results["tables"] for row in table["rows"]]
        self.assertEqual(len(rows), len(flat))
        for row, other in zip(rows, flat):
            self.assertEqual(set(row), set(other))
            for name, value in other.items():
                if isinstance(value, float):
                    self.assertEqual(float(row[name]), value)
                else:
                    self.assertEqual(row[name], value or "")

    def test_reproduce(self):
        rows, results, text = self.data("reproduce", "--table", "8", "--table", "1")
        self.check_same(rows, results)
        self.assertEqual({row["table"] for row in rows}, {"1", "8"})
        self.assertEqual(results["command"], "capsoc reproduce --table 8 --table 1")
        for row in rows:
            label = row["quantity"] + (f", {row['unit']}" if row["unit"] not in ("", "s") else "")
            verdict = {
                "agrees": r"agrees [^\n]+",
                "holds": r"holds [^\n]+",
                "known": rf"differs \([^\n]+\): {re.escape(row['note'])}",
            }[row["verdict"]]
            line = f"  {label:<34} {row['paper']:>10}  {row['here']:>18}  "
            self.assertRegex(text, re.escape(line) + verdict + "\n")
            self.assertNotEqual(row["bound_least"] + row["bound_greatest"], "", line)
        word = next(row for row in rows if row["table"] == "8" and row["quantity"] == "a1")
        self.assertEqual((word["paper_value"], word["tolerance"]), ("1305449920", "10737"))
        self.assertLessEqual(abs(float(word["here_least"]) - 1305449920), 10737)
        self.assertNotIn("Table 2", text)

    def test_table_7_takes_what_the_synthesis_wrote(self):
        rows, _, _ = self.data("reproduce", "--table", "7")
        self.assertEqual(
            [(row["quantity"], row["paper"], row["here"], row["verdict"]) for row in rows],
            [
                ("ALMs", "12192", "-", ""),
                ("registers", "7106", "-", ""),
                ("DSP blocks", "125", "-", ""),
                ("pins", "233", "-", ""),
                ("thermal power, mW", "361.875", "-", ""),
            ],
        )
        area = self.folder / "area.json"

        def figures(slowest=25.5, **changes):
            found = {"alm": 3950, "registers": 3505, "dsp": 12, **changes}
            area.write_text(
                json.dumps(
                    {
                        "precise": {"area": found, "f_max_mhz": [37.0, 46.3]},
                        "paper": {"area": {"alm": 9150, "registers": 3616, "dsp": 53}},
                        "two-clocks": {
                            "area": {"alm": 8900, "registers": 4060, "dsp": 53},
                            "f_max_mhz": [slowest, 32.0],
                        },
                    }
                )
            )

        figures()
        rows, _, text = self.data("reproduce", "--table", "7", "--synthesis", area)
        verdicts = {row["quantity"]: (row["here"], row["verdict"]) for row in rows}
        self.assertEqual(verdicts["ALMs, precise"], ("3950", "known"))
        self.assertEqual(verdicts["DSP blocks, paper"], ("53", "agrees"))
        self.assertEqual(verdicts["largest frequency, precise, MHz"], ("37.0 .. 46.3", "known"))
        self.assertNotIn("largest frequency, paper, MHz", verdicts)
        self.assertEqual(verdicts["largest frequency, paper in two clocks, MHz"], ("25.5 .. 32.0", "known"))
        for changes in ({"alm": 4065}, {"registers": 3554}, {"dsp": 13}, {"slowest": 24.9}):
            figures(**changes)
            process = capsoc("reproduce", "--table", "7", "--synthesis", area)
            self.assertEqual(process.returncode, 1)
            self.assertIn("1 rows differ that should agree", process.stdout.decode())
        for damage, sentence in (
            ("[]", "is not a JSON object"),
            ("{", "is not a JSON object"),
            ("{}", "has neither precise nor paper"),
            ('{"channels": 4, "precise": {"area": {"alm": 1, "registers": 2, "dsp": 3}}}', "is of several channels"),
            ('{"paper": {"area": {"alm": 1}}}', "paper.area has no numbers"),
            ('{"paper": {"area": {"alm": -1, "registers": 2, "dsp": 3}}}', "paper.area has no numbers"),
        ):
            area.write_text(damage)
            self.refuse(sentence, "reproduce", "--table", "7", "--synthesis", area)
        self.refuse("cannot be read", "reproduce", "--synthesis", self.folder / "none.json")

    def test_accuracy_of_drift_and_peers(self):
        rows, results, _ = self.data("accuracy", "--table", "peers")
        self.check_same(rows, results)
        found = {row["quantity"]: row for row in rows}
        for method in (
            "adam",
            "lm",
            "heydemann",
            "taubin",
            "direct",
            "sgd",
            "momentum",
            "rls",
            "fourier",
            "observer",
            "two-step",
        ):
            self.assertIn(f"Eq (21): {method}", found)
        self.assertEqual(found["random: fourier"]["precise"], "")  # needs an order
        self.assertLess(float(found["Eq (21): taubin"]["precise"]), 1e-8)
        for record in ("Eq (21)", "12 bit", "noise", "3rd 1 %", "beta 1", "ripple", "random", "drift"):
            self.assertEqual(found[f"{record}: LMS"]["verdict"], "holds")
            self.assertNotEqual(found[f"{record}: LMS"]["paper"], "")

    def test_accuracy(self):
        rows, results, text = self.data("accuracy", "--table", "widths", "--table", "ripple")
        self.check_same(rows, results)
        self.assertEqual([row["quantity"] for row in rows], ["12", "16", "20", "24", "32", "tracking, 0.05 Hz"])
        for row in rows:
            self.assertIn(f"{float(row['precise']):>12.2e} {float(row['paper']):>12.2e}", text)
        self.assertEqual((rows[-1]["bound"], rows[-1]["verdict"]), ("0.001", "holds"))

    def test_bench(self):
        rows, results, text = self.data("bench", "cpu", FIRMWARE / "hello.elf", "--repeat", "1")
        self.check_same(rows, results)
        self.assertEqual([row["program"] for row in rows], ["hello", "geometric mean"])
        self.assertIn(
            f"{float(rows[0]['mips']):>8.0f} {float(rows[0]['qemu_mips']):>8.0f} {float(rows[0]['qemu_ratio']):>8.2f}",
            text,
        )

    def test_data_instead_of_the_text(self):
        for option in ("--csv", "--json"):
            process = capsoc("accuracy", "--table", "reference", option, "-")
            self.assertEqual(process.returncode, 0, process.stderr.decode())
            text = process.stdout.decode()
            if option == "--json":
                self.assertEqual(json.loads(text)["tables"][0]["id"], "reference")
            else:
                self.assertEqual(text.splitlines()[0], "table,quantity,unit,precise,paper,bound,verdict")

    def test_tables_are_listed(self):
        for command, expected in ((["reproduce"], "csfn-2"), (["accuracy"], "shuffled"), (["bench", "cpu"], "cpu")):
            process = capsoc(*command, "--list-tables")
            self.assertEqual(process.returncode, 0)
            self.assertIn(expected, [line.split()[0] for line in process.stdout.decode().splitlines()])

    def test_wrong_uses_are_a_sentence(self):
        self.refuse("there is no such table; choose from 1, figure-7, 2,", "reproduce", "--table", "99")
        self.refuse("cannot both be -", "accuracy", "--csv", "-", "--json", "-")
        self.refuse("t.csv", "accuracy", "--csv", self.folder / "t.csv", "--json", self.folder / "t.csv")
        program = self.folder / "p.elf"
        program.write_bytes((FIRMWARE / "hello.elf").read_bytes())
        self.refuse("p.elf", "bench", "cpu", program, "--csv", program)
        self.assertEqual(program.read_bytes(), (FIRMWARE / "hello.elf").read_bytes())
        self.refuse("/nonexistent/t.csv: cannot be written", "reproduce", "--csv", "/nonexistent/t.csv")


if __name__ == "__main__":
    unittest.main()
