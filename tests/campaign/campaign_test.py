#!/usr/bin/env python3
"""capsoc campaign as a user runs it: descriptions, workers, stores that are killed, damaged and merged, reports."""

import csv
import json
import os
import random
import re
import resource
import signal
import sqlite3
import subprocess
import time
import unittest
from pathlib import Path
from xml.etree import ElementTree

from harness import BUILD, CAPSOC, CLEAN, Case, FIRMWARE, SOURCE, output_of

CTEST = {"name": "campaign"}

KILLS = int(os.environ.get("CAPSOC_TEST_KILLS", "10"))

# Half a second of a sensor: long enough for samples, a few milliseconds of the host.
SHORT = """
name = "short"
seed = 5
least_yield = 0

[settings]
program.demodulation_samples = 100
program.calibration_samples = 20
"""
DRAWN = (
    SHORT
    + """
[[axes]]
combine = "independent"
runs = {runs}
sensor.a1 = {{ uniform = [0.2, 0.8] }}
sensor.noise.sigma = {{ log_uniform = [1e-6, 1e-3] }}
sensor.noise.seed = {{ seeds = true }}
sensor.adc_bits = {{ integers = [12, 24] }}

[metrics]
error_deg = "angle_error_deg.calibration_mode_max"

[criteria]
"measured" = "samples > 100 and error_deg != null"
"small" = "error_deg < 20"
"""
)


def rows_of(store):
    """What a store has, without what is the host's matter."""
    database = sqlite3.connect(store)
    rows = database.execute("SELECT key, ending, command, result, log FROM runs ORDER BY key").fetchall()
    plan = database.execute("SELECT number, key, axes FROM plan ORDER BY number").fetchall()
    database.close()
    clean = []
    for key, ending, command, result, log in rows:
        result = json.loads(result) if result else None
        if result:
            del result["time"]["wall_s"], result["cpu"]["mips"]
        clean.append((key, ending, command, json.dumps(result), log))
    return plan, clean


def rows_of_any(store):
    database = sqlite3.connect(store)
    rows = database.execute("SELECT key, ending, command, result, log FROM runs").fetchall()
    database.close()
    return rows


class CampaignCase(Case):
    def describe(self, text, name="d.toml"):
        (self.folder / name).write_text(text)
        return name

    def campaign(self, *arguments, code=0, **keywords):
        process = subprocess.run(
            [CAPSOC, "campaign", *map(str, arguments)],
            capture_output=True,
            cwd=self.folder,
            env=CLEAN,
            timeout=280,
            check=False,
            **keywords,
        )
        self.assertEqual(process.returncode, code, process.stdout.decode() + process.stderr.decode())
        return process.stdout.decode(), process.stderr.decode()

    def refuse(self, expected, *arguments, code=2):
        before = sorted(os.listdir(self.folder))
        out, said = self.campaign(*arguments, code=code)
        self.assertEqual(out, "")
        self.assertEqual(len(said.strip().splitlines()), 1, said)
        self.assertIn(expected, said)
        self.assertEqual(sorted(os.listdir(self.folder)), before, "nothing is started")

    def start(self, *arguments, **keywords):
        return subprocess.Popen(
            [CAPSOC, "campaign", *map(str, arguments)],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            cwd=self.folder,
            env=CLEAN,
            **keywords,
        )

    def path(self, name):
        return self.folder / name


class Descriptions(CampaignCase):
    """What is wrong in a description is a sentence with its line, and nothing is started."""

    def wrong(self, expected, text, line=None):
        self.describe(text)
        for command in ("check", "run"):
            self.refuse(f"d.toml:{line}: {expected}" if line else expected, command, "d.toml")

    def test_the_file(self):
        self.refuse("nothing.toml", "check", "nothing.toml")
        self.wrong("", "name = \n", 1)
        self.wrong("the campaign has no name", "seed = 1\n", 1)
        self.wrong("there is no key 'sead' in the description; did you mean seed", 'name = "n"\nsead = 1\n', 2)
        self.wrong("'seed' in the description is no whole number", 'name = "n"\nseed = -1\n', 2)
        self.wrong("there is no kind 'walk' of work", 'name = "n"\nkind = "walk"\n')
        self.wrong(
            "there is no key 'second' in [limits]; did you mean seconds", 'name = "n"\n[limits]\nsecond = 1\n', 3
        )
        self.wrong("'axes' in the description is no list of tables; write [[axes]]", 'name = "n"\naxes = 3\n', 2)

    def test_settings(self):
        self.wrong(
            "there is no setting 'sensor.a3'; did you mean sensor.a1", 'name = "n"\n[settings]\nsensor.a3 = 1\n', 3
        )
        self.wrong(
            "coprocessor.arithmetic cannot be 'fast'; choose one of paper, precise",
            'name = "n"\n[settings]\ncoprocessor.arithmetic = "fast"\n',
            3,
        )
        self.wrong(
            "sensor.a1 must be a text, a number or true/false; several values make an axis",
            'name = "n"\n[settings]\nsensor.a1 = [1, 2]\n',
            3,
        )
        self.wrong("results.json says where something goes", 'name = "n"\n[settings]\nresults.json = "r"\n', 3)
        self.wrong(f"{FIRMWARE}/selfcal.elf has no setting 'stap'", 'name = "n"\n[settings]\nprogram.stap = 1\n', 3)

        self.wrong(
            "coprocessor.backend = lockstep writes the waves of a difference",
            'name = "n"\n[settings]\ncoprocessor.backend = "lockstep"\n',
            3,
        )

    def test_axes(self):
        def axes(text, expected, line=3):
            self.wrong(expected, f'name = "n"\n[[axes]]\n{text}\n', line)

        axes("sensor.a1 = []", "the axis 'sensor.a1' is empty")
        axes("sensor.a1 = {}", "the axis 'sensor.a1' is empty")
        axes("sensor.a1 = 0.5", "'sensor.a1' has one value")
        axes("sensor.a1 = { uniform = [0.1, 0.5] }", "the axis 'sensor.a1' is empty; give it count = N")
        axes(
            "sensor.a1 = { range = [0.1, 0.5], points = 1 }",
            "'points' in the axis 'sensor.a1' is no whole number from 2",
        )
        axes("sensor.a1 = { log_range = [0, 0.5], points = 3 }", "'log_range' in the axis 'sensor.a1' has no logarithm")
        axes(
            "sensor.a1 = { normal = [0.5, 0], count = 3 }",
            "'normal' in the axis 'sensor.a1' is [mean, standard deviation]; the latter is above 0",
        )
        axes(
            "sensor.a1 = { integers = [0.5, 2], count = 3 }",
            "'integers' in the axis 'sensor.a1' is no list of two whole numbers",
        )
        axes(
            "sensor.a1 = { uniform = [0.1, nan], count = 3 }",
            "'uniform' in the axis 'sensor.a1' is no list of two numbers",
        )
        axes("sensor.a1 = { uniform = [0.1, 0.2], cuont = 3 }", "there is no key 'cuont' in the axis 'sensor.a1'")
        axes('combine = "some"\nsensor.a1 = [1]', "'combine' in [[axes]] is none of product, zip")
        axes('combine = "independent"\nsensor.a1 = [1]', 'combine = "independent" needs runs = N', 2)
        axes(
            'combine = "zip"\nsensor.a1 = [0.1, 0.2]\nsensor.a2 = [0.3]',
            "'sensor.a2' has 1 values and 'sensor.a1' 2; axes of a zip have as many",
            5,
        )
        axes("sensor.a4 = [1, 2]", "there is no setting 'sensor.a4'")
        axes("sensor.adc_bits = [12, 40]", "sensor.adc_bits = 40 is out of range; give 0 to 32")
        axes("sensor.a1 = [0.1, 0.2]\n[[axes]]\nsensor.a1 = [0.3]", "'sensor.a1' has values in d.toml:3 already", 5)
        axes("sensor.a1 = [0.5, 20.5]", "'a1' in [signal] = 20.5")  # the description of the sensor says so

    def test_a_million_million_runs(self):
        million = "{ range = [0.1, 0.2], points = 1000000 }"
        self.wrong(
            "with this the campaign has more than 1000000 runs",
            f'name = "n"\n[[axes]]\nsensor.a1 = {million}\nsensor.a2 = {million}\n',
            3,
        )
        self.wrong(
            "with this the campaign has more than 1000000 runs",
            f'name = "n"\n[[axes]]\nsensor.a1 = {million}\n[[axes]]\nsensor.a2 = {million}\n',
            5,
        )
        self.wrong(
            "with this the campaign has more than 1000000 runs",
            f'name = "n"\n[[axes]]\nsensor.a1 = {million}\n[repetitions]\n'
            'count = 1000000\nseeds = ["sensor.noise.seed"]\n',
            4,
        )

    def test_expressions(self):
        def criterion(text, expected):
            self.describe(f'name = "n"\n[criteria]\ngood = "{text}"\n')
            self.refuse(expected, "check", "d.toml")
            self.refuse("d.toml:3: ", "run", "d.toml")

        criterion(
            "exit.kode == 0", "good 'exit.kode' is no metric, no key of a result and no axis; did you mean exit.code"
        )
        criterion("exit.code ==", "a number, a name or '(' is missing at character 13")
        criterion("exit.code = 0", "an operator or the end is missing at character 11")
        criterion("log(3) > 1", "abs, sqrt, log10, min or max")
        criterion("1 < 'a", "the end of the text")
        criterion("(" * 1000 + "1" + ")" * 1000, "too deep")
        criterion("1 " + "+ 1" * 3000, "longer than")
        self.wrong("'good' in [criteria] is no text", 'name = "n"\n[criteria]\ngood = 1\n', 3)
        self.wrong(
            "sensor.a1 'seed' is no axis and is not in [settings]", 'name = "n"\n[derived]\nsensor.a1 = "seed * 2"\n', 3
        )
        self.wrong(
            "sensor.a2 = sensor.a1 / 0 has no value in a run",
            'name = "n"\n[settings]\nsensor.a1 = 1\n[derived]\nsensor.a2 = "sensor.a1 / 0"\n',
            5,
        )
        self.wrong("good 'exit.kode' is no metric", 'name = "n"\n[by]\ngood = "exit.kode"\n', 3)
        self.wrong("[metrics] has no 'x'", 'name = "n"\nworst = "x"\n', 2)

    def test_a_good_one_says_what_it_would_do(self):
        self.describe(
            SHORT + "[[axes]]\nsensor.a1 = { range = [0.2, 0.4], points = 3 }\n"
            "coprocessor.arithmetic = ['precise', 'paper']\n"
            "[derived]\nsensor.a2 = 'sensor.a1 * 2'\n"
        )
        out, _ = self.campaign("check", "d.toml")
        lines = out.splitlines()
        self.assertEqual(lines[0], "campaign short (run): 6 runs, seed 5")
        self.assertIn("-C sensor.a1=0.2 -C sensor.a2=0.4 -C coprocessor.arithmetic=precise", lines[1])
        self.assertIn("-C sensor.a1=0.2 -C sensor.a2=0.4 -C coprocessor.arithmetic=paper", lines[2])
        self.assertRegex(lines[4], r"the first run takes \d+\.\d\d s, all of them about \d+ s with --jobs")
        self.assertEqual(os.listdir(self.folder), ["d.toml"])

    def test_a_command_repeats_its_run(self):
        self.describe(DRAWN.format(runs=2))
        self.campaign("run", "d.toml")
        _, rows = rows_of(self.path("d.sqlite"))
        for _, ending, command, result, _ in rows:
            self.assertEqual(ending, "finished")
            words = command.replace("capsoc", str(CAPSOC), 1).split() + ["--json", "again.json"]
            subprocess.run(words, cwd=self.folder, env=CLEAN, capture_output=True, check=False)
            again = json.loads(self.path("again.json").read_text())
            del again["time"]["wall_s"], again["cpu"]["mips"]
            self.assertEqual(again, json.loads(result))


class Rows(CampaignCase):
    """The same rows for any number of jobs, shards and order; a changed description does what is new."""

    def test_jobs_shards_and_merge(self):
        self.describe(DRAWN.format(runs=40))
        for jobs in (1, 2, 5):
            self.campaign("run", "d.toml", "--jobs", jobs, "--store", f"jobs{jobs}.sqlite")
        whole = rows_of(self.path("jobs1.sqlite"))
        self.assertEqual(len(whole[1]), 40)
        for jobs in (2, 5):
            self.assertEqual(rows_of(self.path(f"jobs{jobs}.sqlite")), whole)
        for part in (3, 1, 2):
            self.campaign("run", "d.toml", "--shard", f"{part}/3", "--store", f"part{part}.sqlite")
        parts = [rows_of(self.path(f"part{part}.sqlite"))[1] for part in (1, 2, 3)]
        self.assertEqual(sum(map(len, parts)), 40)
        self.assertTrue(all(parts))
        self.campaign("merge", "all.sqlite", "part2.sqlite", "part1.sqlite", "part3.sqlite", "part1.sqlite")
        self.assertEqual(rows_of(self.path("all.sqlite")), whole)
        first, second = (self.campaign("export", name)[0] for name in ("all.sqlite", "jobs5.sqlite"))
        self.assertEqual(first, second)

    def test_shards_that_are_none(self):
        self.describe(DRAWN.format(runs=2))
        for shard in ("0/3", "4/3", "1", "1/", "a/b", "1/2/3", "-1/2", "1/0"):
            self.refuse(f"--shard {shard}", "run", "d.toml", f"--shard={shard}")

    def test_a_changed_description_does_what_is_new(self):
        self.describe(DRAWN.format(runs=10))
        self.campaign("run", "d.toml")
        ten = rows_of(self.path("d.sqlite"))[1]
        self.describe(DRAWN.format(runs=15))
        _, said = self.campaign("run", "d.toml")
        self.assertIn("10 runs are in d.sqlite already", said)
        self.assertIn("5 of 5 runs", said)
        fifteen = rows_of(self.path("d.sqlite"))[1]
        self.assertLess(set(ten), set(fifteen))
        self.assertEqual(len(fifteen), 15)
        # Another criterion changes no run.
        self.describe(DRAWN.format(runs=15).replace("error_deg < 20", "error_deg < 1e-9"))
        out, said = self.campaign("run", "d.toml")
        self.assertIn("0 of 0 runs", said)
        self.assertIn("yield 0.00 %", out)
        # A report and an export speak of the runs that the description has now.
        self.describe(DRAWN.format(runs=3))
        self.campaign("run", "d.toml")
        self.assertEqual(len(self.campaign("export", "d.sqlite")[0].splitlines()), 4)

    def test_a_changed_input_file_is_another_run(self):
        sensor = (SOURCE / "traces/soc_eq21.toml").read_text()
        self.path("s.toml").write_text(sensor)
        self.describe(SHORT + '[[axes]]\nsensor.file = ["s.toml"]\n')
        self.campaign("run", "d.toml")
        self.path("s.toml").write_text(sensor.replace("0.6079", "0.5"))
        self.campaign("run", "d.toml")
        database = sqlite3.connect(self.path("d.sqlite"))
        self.assertEqual(database.execute("SELECT count(*), count(DISTINCT key) FROM runs").fetchone(), (2, 2))
        database.close()

    def test_combinations(self):
        self.describe(
            SHORT
            + '[[axes]]\ncombine = "zip"\nsensor.a1 = [0.2, 0.3]\nsensor.a2 = { log_range = [0.1, 0.4], points = 2 }\n'
            '[[axes]]\nsensor.b1 = [0, 0.1, 0.1]\n[repetitions]\ncount = 2\nseeds = ["sensor.noise.seed"]\n'
            '[derived]\nsensor.noise.sigma = "0.001"\n'
        )
        out, _ = self.campaign("check", "d.toml")
        self.assertIn("8 runs, 4 more are the same as these", out)
        self.campaign("run", "d.toml")
        values = [json.loads(axes) for _, _, axes in rows_of(self.path("d.sqlite"))[0]]
        self.assertEqual(
            [v[:3] for v in values[::2]],
            [["0.2", "0.1", "0"], ["0.2", "0.1", "0.1"], ["0.3", "0.4", "0"], ["0.3", "0.4", "0.1"]],
        )
        self.assertEqual(len({v[3] for v in values}), 2)

    def test_a_hypercube_fills_every_share_once(self):
        self.describe(DRAWN.format(runs=20).replace("independent", "latin_hypercube"))
        self.campaign("run", "d.toml")
        values = [json.loads(axes) for _, _, axes in rows_of(self.path("d.sqlite"))[0]]
        shares = sorted(int((float(v[0]) - 0.2) / 0.6 * 20) for v in values)
        self.assertEqual(shares, list(range(20)))


class Workers(CampaignCase):
    """A run that crashes, hangs or eats is a result with its command."""

    def endings(self, description, code=1, **keywords):
        self.describe(description)
        out, said = self.campaign("run", "d.toml", "--jobs", 2, code=code, **keywords)
        return out, said, [row[1] for row in rows_of(self.path("d.sqlite"))[1]]

    def test_out_of_time(self):
        out, said, endings = self.endings(
            f"""
name = "hang"
[limits]
seconds = 3
[[axes]]
firmware.elf = ["{FIRMWARE}/forever.elf", "{FIRMWARE}/hello.elf"]
"""
        )
        self.assertEqual(sorted(endings), ["finished", "out of time"])
        self.assertIn("2 of 2 runs, 0 running", said)
        self.assertIn("1 failed", said)
        self.assertIn(f"capsoc run -C firmware.elf={FIRMWARE}/forever.elf", out)
        # Known as it is, it is not done again, unless one asks for it.
        _, said = self.campaign("run", "d.toml", code=1)
        self.assertIn("0 of 0 runs", said)
        _, said = self.campaign("run", "d.toml", "--retry", code=1)
        self.assertIn("1 of 1 runs", said)

    def test_programs_by_their_names(self):
        out, _, endings = self.endings('name = "names"\n[[axes]]\nfirmware.elf = ["hello", "newlib"]\n', code=0)
        self.assertEqual(endings, ["finished", "finished"], out)

    def test_out_of_memory(self):
        _, _, endings = self.endings(SHORT.replace("least_yield = 0", "") + "[limits]\nmemory_mib = 48\n")
        self.assertEqual(endings, ["out of memory"])

    def test_a_crash_of_the_worker(self):
        self.describe(f'name = "c"\n[[axes]]\nfirmware.elf = ["{FIRMWARE}/forever.elf", "{FIRMWARE}/hello.elf"]\n')
        process = self.start("run", "d.toml", "--jobs", 1)
        children = Path(f"/proc/{process.pid}/task/{process.pid}/children")
        while not children.read_text().split():
            time.sleep(0.01)
        time.sleep(0.3)
        os.kill(int(children.read_text().split()[0]), signal.SIGSEGV)
        self.assertEqual(process.wait(timeout=60), 1, process.stderr.read())
        process.stderr.close()
        rows = rows_of(self.path("d.sqlite"))[1]
        self.assertEqual(sorted(row[1] for row in rows), ["crashed: signal 11", "finished"])

    def test_a_crash_of_the_firmware(self):
        out, _, endings = self.endings(f'name = "c"\n[settings]\nfirmware.elf = "{FIRMWARE}/divzero.elf"\n')
        self.assertEqual(endings, ["finished"])
        self.assertIn("5: the firmware crashed", out)

    def test_an_input_that_goes_away(self):
        sensor = (SOURCE / "traces/soc_eq21.toml").read_text()
        self.path("s.toml").write_text(sensor)
        numbers = [0.5 + i / 1000 for i in range(61)] + [50.5] + [0.6 + i / 1000 for i in range(60)]
        _, _, endings = self.endings(SHORT.replace("least_yield = 0", "") + f"[[axes]]\nsensor.a1 = {numbers}\n")
        self.assertEqual(sum(ending.startswith("refused: d.toml:") for ending in endings), 1)

    def test_a_signal_ends_it_and_it_goes_on(self):
        self.describe(DRAWN.format(runs=60))
        for number in (signal.SIGTERM, signal.SIGINT):
            process = self.start("run", "d.toml", "--jobs", 1)
            time.sleep(0.8)
            process.send_signal(number)
            self.assertIn(process.wait(timeout=60), (128 + number, 0))
            process.stderr.close()
        self.campaign("resume", "d.sqlite")
        self.campaign("run", "d.toml", "--store", "whole.sqlite")
        self.assertEqual(rows_of(self.path("d.sqlite")), rows_of(self.path("whole.sqlite")))

    def test_failures_are_recorded(self):
        self.describe(DRAWN.format(runs=3) + '[keep]\nfailures = "kept"\n')
        text = (
            (self.folder / "d.toml")
            .read_text()
            .replace("error_deg < 20", "error_deg < 1e-9")
            .replace("least_yield = 0\n", "")
        )
        self.describe(text)
        self.campaign("run", "d.toml", code=1)
        keys = sorted(row[0] for row in rows_of(self.path("d.sqlite"))[1])
        self.assertEqual(sorted(os.listdir(self.path("kept"))), [key[:16] + ".csv" for key in keys])

    def test_failures_are_sessions(self):
        text = DRAWN.format(runs=2) + '[keep]\nfailures = "kept"\nsession_s = 0.2\n'
        self.describe(text.replace("error_deg < 20", "error_deg < 1e-9").replace("least_yield = 0\n", ""))
        self.campaign("run", "d.toml", code=1)
        rows = rows_of(self.path("d.sqlite"))[1]
        stems = sorted(row[0][:16] for row in rows)
        kept = sorted(os.listdir(self.path("kept")))
        self.assertEqual(kept, sorted(stem + ending for stem in stems for ending in (".csv", ".session")))
        for stem in stems:
            output_of(CAPSOC, "replay", self.path("kept") / (stem + ".session"), cwd=self.folder)

    def test_sessions_of_other_kinds_are_refused(self):
        self.describe(DRAWN.format(runs=2) + '[keep]\nfailures = "kept"\nsession_s = -1\n')
        self.assertIn("session_s", self.campaign("check", "d.toml", code=2)[1])
        kept = '[keep]\nfailures = "kept"\nsession_s = 1\n'
        self.describe('name = "fits"\nkind = "fit"\n' + kept)
        self.assertIn('[keep] session_s is for kind = "run"; remove it', self.campaign("check", "d.toml", code=2)[1])


class Kills(CampaignCase):
    """SIGKILL at random moments: the store is that of an uninterrupted campaign, and no run is done twice."""

    def test_random_moments(self):
        self.describe(DRAWN.format(runs=60))
        begin = time.monotonic()
        self.campaign("run", "d.toml", "--jobs", 2, "--store", "whole.sqlite")
        whole, took = rows_of(self.path("whole.sqlite")), time.monotonic() - begin
        draw = random.Random(1)
        kills = done = 0
        while kills < KILLS:
            for suffix in ("", "-wal", "-shm"):
                self.path("d.sqlite" + suffix).unlink(missing_ok=True)
            done = 0
            while done < 60 and kills < KILLS:
                process = self.start("run", "d.toml", "--jobs", 2)
                time.sleep(draw.uniform(0, 0.7 * took))
                process.kill()
                process.wait()
                process.stderr.close()
                kills += 1
                rows = self.rows_so_far()
                self.assertLessEqual(set(rows), set(whole[1]))
                self.assertGreaterEqual(len(rows), done, "what was there stays")
                done = len(rows)
            _, said = self.campaign("run", "d.toml")
            self.assertIn(f"{60 - done} of {60 - done} runs", said, "nothing twice")
            self.assertEqual(rows_of(self.path("d.sqlite")), whole)

    def rows_so_far(self):
        try:
            return rows_of(self.path("d.sqlite"))[1]
        except sqlite3.OperationalError:  # it has no tables yet
            return []

    def test_workers_go_with_their_campaign(self):
        self.describe(f'name = "c"\n[[axes]]\nfirmware.elf = ["{FIRMWARE}/forever.elf"]\n')
        process = self.start("run", "d.toml")
        children = Path(f"/proc/{process.pid}/task/{process.pid}/children")
        while not children.read_text().split():
            time.sleep(0.01)
        worker = int(children.read_text().split()[0])
        process.kill()
        process.wait()
        process.stderr.close()
        for _ in range(200):
            state = Path(f"/proc/{worker}/stat")
            if not state.exists() or state.read_text().rpartition(")")[2].split()[0] == "Z":
                return
            time.sleep(0.05)
        self.fail("the worker lives on")


class Disks(CampaignCase):
    def test_a_full_disk_loses_nothing(self):
        self.describe(DRAWN.format(runs=60))
        self.campaign("run", "d.toml", "--store", "whole.sqlite")
        whole = rows_of(self.path("whole.sqlite"))

        def limited(size):
            return lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, resource.RLIM_INFINITY))

        _, said = self.campaign("run", "d.toml", code=74, preexec_fn=limited(150_000))
        self.assertIn("d.sqlite: ", said)
        self.assertIn("is still there", said)
        some = rows_of(self.path("d.sqlite"))[1]
        self.assertTrue(0 < len(some) < 60, len(some))
        _, said = self.campaign("resume", "d.sqlite")
        self.assertIn(f"{60 - len(some)} of {60 - len(some)} runs", said)
        self.assertEqual(rows_of(self.path("d.sqlite")), whole)

    def test_files_that_are_no_stores(self):
        self.describe(DRAWN.format(runs=2))
        self.campaign("run", "d.toml")
        self.path("text.sqlite").write_text("nothing of the kind\n" * 100)
        foreign = sqlite3.connect(self.path("foreign.sqlite"))
        foreign.execute("CREATE TABLE runs(a)")
        foreign.commit()
        foreign.close()
        newer = sqlite3.connect(self.path("newer.sqlite"))
        with sqlite3.connect(self.path("d.sqlite")) as store:
            store.backup(newer)
        newer.execute("PRAGMA user_version = 99")
        newer.commit()
        newer.close()
        store.close()
        self.path("empty.sqlite").touch()
        self.path("folder.sqlite").mkdir()
        for name, expected in (
            ("text", "no store of a campaign"),
            ("foreign", "a database of another program"),
            ("newer", "a store of a newer capsoc (version 99"),
            ("empty", "holds no campaign yet"),
            ("folder", "no regular file"),
            ("none", "there is no such store"),
        ):
            with self.subTest(name):
                self.refuse(expected, "report", f"{name}.sqlite")
                self.refuse(expected, "resume", f"{name}.sqlite")
                if name not in ("empty", "none"):
                    self.refuse(expected, "run", "d.toml", "--store", f"{name}.sqlite")

    def test_what_a_campaign_leaves_that_was_killed_as_it_began(self):
        self.describe(DRAWN.format(runs=2))
        self.campaign("run", "d.toml")
        self.path("file.sqlite").touch()
        log = sqlite3.connect(self.path("log.sqlite"))
        log.execute("PRAGMA journal_mode = WAL")
        log.close()
        self.assertGreater(self.path("log.sqlite").stat().st_size, 0)
        tables = sqlite3.connect(self.path("tables.sqlite"))
        with sqlite3.connect(self.path("d.sqlite")) as store:
            store.backup(tables)
        store.close()
        for table in ("about", "plan", "runs"):
            tables.execute(f"DELETE FROM {table}")
        tables.commit()
        tables.close()
        unborn = ("file.sqlite", "log.sqlite", "tables.sqlite")
        for name in unborn:
            with self.subTest(name):
                self.refuse("holds no campaign yet", "report", name)
        _, said = self.campaign("merge", "all.sqlite", *unborn[:2], "d.sqlite", unborn[2])
        self.assertIn("2 runs taken into all.sqlite", said)
        for name in unborn:
            self.assertIn(f"{name}: holds no campaign yet, and no runs", said)
        self.assertEqual(rows_of(self.path("all.sqlite")), rows_of(self.path("d.sqlite")))

    def test_damage_is_a_sentence(self):
        self.describe(DRAWN.format(runs=12))
        self.campaign("run", "d.toml")
        whole = self.path("d.sqlite").read_bytes()
        draw = random.Random(3)
        for _ in range(40):
            damaged = bytearray(whole)
            for _ in range(draw.choice((1, 20, 400))):
                damaged[draw.randrange(len(damaged))] = draw.randrange(256)
            if draw.random() < 0.3:
                damaged = damaged[: draw.randrange(len(damaged))]
            self.path("x.sqlite").write_bytes(damaged)
            for command in (("report", "x.sqlite"), ("export", "x.sqlite", "--all")):
                process = subprocess.run(
                    [CAPSOC, "campaign", *command], capture_output=True, cwd=self.folder, env=CLEAN, check=False
                )
                self.assertIn(process.returncode, (0, 1, 2), process.stderr)
                if process.returncode == 2:
                    self.assertEqual(
                        len(process.stderr.decode(errors="replace").strip().splitlines()), 1, process.stderr
                    )

    def test_one_campaign_a_store(self):
        self.describe(f'name = "c"\n[[axes]]\nfirmware.elf = ["{FIRMWARE}/forever.elf"]\n')
        process = self.start("run", "d.toml")
        while not self.path("d.sqlite-wal").exists():
            time.sleep(0.01)
        time.sleep(0.2)
        _, said = self.campaign("run", "d.toml", code=2)
        self.assertIn("another campaign writes to this store", said)
        self.campaign("report", "d.sqlite", code=1)  # looking is free
        process.kill()
        process.wait()
        process.stderr.close()

    def test_no_output_is_an_input(self):
        self.describe(DRAWN.format(runs=2))
        self.refuse("d.toml", "run", "d.toml", "--store", "d.toml")
        self.refuse("d.toml", "run", "d.toml", "--json", "d.toml")
        self.campaign("run", "d.toml")
        self.refuse("d.sqlite", "report", "d.sqlite", "--json", "d.sqlite")
        self.refuse("d.sqlite", "merge", "d.sqlite", "d.sqlite")

    def test_merging_what_does_not_belong_together(self):
        self.describe(DRAWN.format(runs=2))
        self.campaign("run", "d.toml")
        self.describe(DRAWN.format(runs=3), "e.toml")
        self.campaign("run", "e.toml")
        _, said = self.campaign("merge", "d.sqlite", "e.sqlite", code=2)
        self.assertIn("is of another description than d.sqlite", said)


class Reports(CampaignCase):
    def test_text_json_and_junit(self):
        self.describe(
            DRAWN.format(runs=30)
            .replace("error_deg < 20", "error_deg < 5")
            .replace("least_yield = 0", "least_yield = 0.999")
        )
        out, _ = self.campaign("run", "d.toml", "--json", "r.json", "--junit", "r.xml", code=1)
        report = json.loads(self.path("r.json").read_text())
        with open(self.path("t.csv"), "w", encoding="utf-8") as file:
            file.write(self.campaign("export", "d.sqlite")[0])
        with open(self.path("t.csv"), encoding="utf-8", newline="") as file:
            table = list(csv.DictReader(file))
        errors = sorted(float(row["error_deg"]) for row in table)
        passed = sum(error < 5 for error in errors)
        self.assertTrue(0 < passed < 30)
        self.assertEqual((report["runs"], report["done"], report["passed"]), (30, 30, passed))
        # Wilson's interval, from its formula.
        z, n, p = 1.959963984540054, 30, passed / 30
        centre, width = (p + z * z / (2 * n)) / (1 + z * z / n), z * (p * (1 - p) / n + z * z / (4 * n * n)) ** 0.5 / (
            1 + z * z / n
        )
        for value, expected in zip(report["yield_interval"], (centre - width, centre + width)):
            self.assertAlmostEqual(value, expected, places=9)
        metric = report["metrics"][0]
        self.assertEqual(metric["summary"]["quantiles"]["0"], errors[0])
        self.assertEqual(metric["summary"]["quantiles"]["1"], errors[-1])
        self.assertAlmostEqual(metric["summary"]["quantiles"]["0.5"], (errors[14] + errors[15]) / 2)
        self.assertEqual(sum(metric["histogram"]["bins"]), 30)
        self.assertEqual([round(e["worst"], 9) for e in report["worst"]], [round(e, 9) for e in errors[:-11:-1]])
        self.assertEqual(set(metric["sensitivity"]), set(report["worst"][0]["axes"]))
        suite = ElementTree.parse(self.path("r.xml")).getroot().find("testsuite")
        self.assertEqual(
            (suite.get("tests"), suite.get("failures"), suite.get("errors")), ("30", str(30 - passed), "0")
        )
        self.assertEqual(len(suite.findall("testcase")), 30)
        self.assertIn("again: capsoc run", suite.find("testcase/failure").text)
        self.assertIn(f"yield {100 * passed / 30:.2f} % ({passed} of 30)", out)
        self.assertIn(report["worst"][0]["command"], out)

    def test_a_page(self):
        self.describe(DRAWN.format(runs=6))
        self.campaign("run", "d.toml", "--json", "r.json", "--html", "r.html")
        report, page = json.loads(self.path("r.json").read_text()), self.path("r.html").read_text()
        sample = report["sample"]
        self.assertEqual((sample["of"], sample["runs"], len(sample["passed"])), (6, list(range(6)), 6))
        for columns in (sample["axes"], sample["metrics"]):
            self.assertTrue(all(len(column) == 6 for column in columns.values()))
        self.assertTrue(all(isinstance(value, float) for value in sample["axes"]["sensor.a1"]))
        self.assertEqual(sum(sample["passed"]), report["passed"])
        # The same page from the store, and from the JSON.
        self.campaign("report", "d.sqlite", "--html", "again.html")
        self.assertEqual(self.path("again.html").read_text(), page)
        subprocess.run(
            [CAPSOC, "report", self.path("r.json"), "--html", self.path("later.html")], check=True, cwd=self.path(".")
        )
        self.assertEqual(self.path("later.html").read_text(), page)
        # No output is another one, and none is begun where it cannot be written.
        for said, *options in (
            ("--html r.json and --json r.json are the same", "--html", "r.json", "--json", "r.json"),
            ("none/r.html: cannot be written", "--html", "none/r.html"),
            ("--html d.sqlite", "--html", "d.sqlite"),
        ):
            self.assertIn(said, self.campaign("report", "d.sqlite", *options, code=2)[1])

    def test_what_it_tells_apart(self):
        self.describe(
            SHORT
            + "sensor.noise.sigma = 1e-4\n[[axes]]\nsensor.adc_bits = [12, 16, 24]\n"
            + "[repetitions]\ncount = 4\nseeds = ['sensor.noise.seed']\n"
            + '[criteria]\nfine = "sensor.adc_bits > 12 or seed_is_odd"\n'
            + '[metrics]\nseed_is_odd = "samples < 0"\nsamples = "samples"\n'
            + '[by]\nconverter = "sensor.adc_bits"\nwide = "sensor.adc_bits > 12"\n'
        )
        out, _ = self.campaign("run", "d.toml", "--json", "r.json", "--html", "r.html")
        by = json.loads(self.path("r.json").read_text())["by"]
        self.assertEqual([each["name"] for each in by], ["converter", "wide"])
        converter = by[0]["values"]
        # Those with most failures first.
        self.assertEqual(
            [(v["value"], v["runs"], v["passed"]) for v in converter], [("12", 4, 0), ("16", 4, 4), ("24", 4, 4)]
        )
        self.assertEqual(sum(exit["runs"] for value in converter for exit in value["exits"]), 12)
        self.assertEqual([(v["value"], v["runs"]) for v in by[1]["values"]], [("false", 4), ("true", 8)])
        self.assertRegex(out, r"(?m)^by converter +runs +passed")
        self.assertRegex(out, r"(?m)^  12 +4 +0.00 %")
        page = self.path("r.html").read_text()
        self.assertIn("By converter: sensor.adc_bits", page)

    def test_columns(self):
        self.describe(DRAWN.format(runs=4))
        self.campaign("run", "d.toml")
        self.campaign("export", "d.sqlite", "--json", "c.json", "--all")
        columns = json.loads(self.path("c.json").read_text())
        self.assertTrue(all(len(column) == 4 for column in columns.values()))
        self.assertIn("parameters.a1.value", columns)
        self.assertNotIn("time.wall_s", columns)
        # More digits than a double has: the seed is as the command has it.
        with sqlite3.connect(self.path("d.sqlite")) as store:
            commands = " ".join(command for (command,) in store.execute("SELECT command FROM runs"))
        rows = list(csv.DictReader(self.campaign("export", "d.sqlite")[0].splitlines()))
        for seed, row in zip(columns["sensor.noise.seed"], rows):
            self.assertIsInstance(seed, int)
            self.assertIn(f"sensor.noise.seed={seed} ", commands + " ")
            self.assertEqual(row["sensor.noise.seed"], str(seed))
        self.campaign("export", "d.sqlite", "--json", "c.json", "--all", "--times")
        self.assertIn("time.wall_s", json.loads(self.path("c.json").read_text()))

    def test_a_sensitivity_finds_what_decides(self):
        self.describe(
            SHORT
            + """
[[axes]]
combine = "latin_hypercube"
runs = 60
sensor.a1 = { uniform = [0.2, 0.8] }
sensor.b2 = { uniform = [-0.1, 0.1] }
sensor.phi_rad = { uniform = [0, 6] }
[metrics]
a1 = "parameters.a1.true"
offset = "abs(parameters.b2.true)"
"""
        )
        self.campaign("run", "d.toml", "--json", "r.json")
        a1, offset = json.loads(self.path("r.json").read_text())["metrics"]
        self.assertGreater(a1["sensitivity"]["sensor.a1"]["correlation"], 0.999)
        self.assertGreater(a1["sensitivity"]["sensor.a1"]["share"], 0.9)
        self.assertLess(a1["sensitivity"]["sensor.phi_rad"]["share"], 0.2)
        self.assertGreater(offset["sensitivity"]["sensor.b2"]["share"], 0.8)
        self.assertLess(abs(offset["sensitivity"]["sensor.b2"]["correlation"]), 0.3)

    def test_progress_in_a_log(self):
        self.describe(DRAWN.format(runs=5))
        _, said = self.campaign("run", "d.toml")
        self.assertRegex(
            said, r"5 runs, seed 5, store d.sqlite\n5 of 5 runs, 0 running, [0-9.e+]+ runs/s, \d failed in \d+ s\n"
        )


class Commands(CampaignCase):
    """A user's program as a run."""

    def describe_command(self, line, results="", more="", axis="value.a = [1, 2, 3]"):
        self.describe(
            f"name = 'c'\nkind = 'command'\nleast_yield = 0\n[settings]\ncommand.line = '''{line}'''\n"
            f"command.results = '{results}'\n{more}\n[[axes]]\n{axis}\n"
        )

    def results(self):
        rows = sorted(rows_of_any(self.path("d.sqlite")), key=lambda row: row[2])
        return [(row[1], json.loads(row[3]) if row[3] else None, row[4]) for row in rows]

    def test_values_reach_it_and_its_object_is_the_result(self):
        self.describe_command(
            'echo "{\\"square\\": $((a * a)), \\"word\\": \\"$word\\"}"; echo said >&2; exit $((a == 2))',
            "square, word",
            'value.word = "it\'s $a `pwd`"',
        )
        self.campaign("run", "d.toml", "--json", "r.json")
        for number, (ending, result, log) in enumerate(self.results(), 1):
            self.assertEqual(ending, "finished")
            self.assertEqual(result["output"], {"square": number * number, "word": "it's $a `pwd`"})
            self.assertEqual(
                result["exit"], {"code": int(number == 2), "reason": "failure" if number == 2 else "success"}
            )
            self.assertEqual(log, "said\n" if number == 2 else "")
            again = subprocess.run(result["command"], shell=True, capture_output=True, check=False)
            self.assertEqual(json.loads(again.stdout), result["output"])
        report = json.loads(self.path("r.json").read_text())
        self.assertEqual((report["done"], report["passed"]), (3, 2))
        metric = next(metric for metric in report["metrics"] if metric["name"] == "output.square")
        self.assertAlmostEqual(metric["summary"]["mean"], 14 / 3)

    def test_what_is_no_result_is_refused(self):
        for line, expected in (
            ("echo 7", "no JSON object, '7'"),
            ("echo '{}'", "printed no 'x'"),
            ("echo '{\"x\": 1'", "no JSON object"),
            ("true", "no JSON object, ''"),
            ("yes '{}' | head -c 17000000", "more than 16 MiB"),
        ):
            with self.subTest(line):
                self.path("d.sqlite").unlink(missing_ok=True)
                self.describe_command(line, "x", axis="value.a = [1]")
                self.campaign("run", "d.toml")
                ((ending, result, _),) = self.results()
                self.assertIn("refused: ", ending)
                self.assertIn(expected, ending)
                self.assertIsNone(result)

    def test_a_failure_needs_no_result_and_a_signal_is_told(self):
        self.describe_command("[ $a = 1 ] && exit 3; kill -$a $$", "x", axis="value.a = [1, 9, 11]")
        self.campaign("run", "d.toml")
        exits = {(result["exit"]["code"], result["exit"]["reason"]) for _, result, _ in self.results()}
        self.assertEqual(exits, {(3, "failure"), (137, "signal 9"), (139, "signal 11")})

    def test_its_processes_end_with_it(self):
        marker = 1000 + os.getpid()
        for line, ending in (
            (f"sleep {marker} & sleep {marker}; true", "out of time"),
            (f"sleep {marker} >/dev/null & true", "finished"),
        ):
            with self.subTest(ending):
                self.path("d.sqlite").unlink(missing_ok=True)
                self.describe_command(line, more="[limits]\nseconds = 0.5", axis="value.a = [1]")
                self.campaign("run", "d.toml")
                self.assertEqual(self.results()[0][0], ending)
                until = time.monotonic() + 10  # a process that was killed may need a moment to be gone
                search = ["pgrep", "-f", f"^sleep {marker}$"]
                while subprocess.run(search, capture_output=True, check=False).stdout and time.monotonic() < until:
                    time.sleep(0.05)
                left = subprocess.run(search, capture_output=True, check=False)
                self.assertEqual(left.stdout, b"", "nothing is left running")

    def test_a_signal_ends_the_campaign_with_its_commands(self):
        marker = 2000 + os.getpid()
        self.describe_command(f"sleep {marker}; true")
        running = ["pgrep", "-fc", f"^sleep {marker}$"]
        for words, workers in ((("run", "d.toml", "--jobs", "2"), b"2"), (("check", "d.toml"), b"1")):
            process = self.start(*words)
            while subprocess.run(running, capture_output=True, check=False).stdout.strip() != workers:
                self.assertIsNone(process.poll())
                time.sleep(0.05)
            process.send_signal(signal.SIGTERM)
            process.communicate(timeout=60)
            self.assertEqual(process.returncode, 128 + signal.SIGTERM)
            left = subprocess.run(running, capture_output=True, check=False).stdout.strip()
            self.assertEqual(left, b"0", words)

    def test_other_inputs_are_other_runs(self):
        self.path("in").mkdir()
        self.path("in/a").write_text("1")
        self.path("file").write_text("1")
        self.describe_command("true", more="command.inputs = 'file, in'")
        _, said = self.campaign("run", "d.toml")
        self.assertIn("3 of 3 runs", said)
        for change in (
            lambda: self.path("in/a").write_text("2"),
            lambda: self.path("in/b").write_text("1"),
            lambda: self.path("in/b").rename(self.path("in/c")),
            lambda: self.path("file").write_text("2"),
        ):
            _, said = self.campaign("run", "d.toml")
            self.assertIn("3 runs are in d.sqlite already", said)
            change()
            _, said = self.campaign("run", "d.toml")
            self.assertNotIn("already", said)

    def test_what_is_wrong_is_a_sentence(self):
        for expected, arguments in (
            ("d.toml:5: command.line: /bin/sh: 1: Syntax error", {"line": "if"}),
            (
                "d.toml:7: command.inputs: there is no nothing; make it first",
                {"line": "true", "more": "command.inputs = 'nothing'"},
            ),
            ("d.toml: command.line is missing", {"line": ""}),
            ("value.A", {"line": "true", "axis": "value.A = [1]"}),
            ("d.toml:9: command.results is the same in every run", {"line": "true", "axis": "command.results = ['x']"}),
        ):
            with self.subTest(expected):
                self.describe_command(**arguments)
                self.refuse(expected, "run", "d.toml")
        self.describe(
            "name = 'c'\nkind = 'command'\n[settings]\ncommand.line = 'true'\n[[axes]]\nvalue.a = [1]\n"
            "[criteria]\ngood = 'output.x == 1'\n"
        )
        self.refuse("output.x", "run", "d.toml")


class Kinds(CampaignCase):
    """fit and regress; the campaigns that come with capsoc."""

    def test_fit(self):
        self.describe(
            """
name = "fit"
kind = "fit"
[settings]
fit.samples = 600
sensor.motion.frequency_hz = 3
[[axes]]
combine = "independent"
runs = 20
sensor.a1 = { uniform = [0.2, 0.8] }
sensor.noise.sigma = { log_uniform = [1e-4, 1e-3] }
sensor.noise.seed = { seeds = true }
[metrics]
error = "abs(parameters.a1.value - parameters.a1.true)"
inside = "abs(parameters.a1.value - parameters.a1.true) <= parameters.a1.interval"
[criteria]
identified = "exit.code == 0"
near = "error < 0.001"
"""
        )
        self.campaign("run", "d.toml", "--json", "r.json")
        report = json.loads(self.path("r.json").read_text())
        self.assertEqual(report["passed"], 20)
        self.assertGreater(report["metrics"][1]["summary"]["mean"], 0.7)
        _, _, command, result, _ = rows_of_any(self.path("d.sqlite"))[0]
        self.assertRegex(command, r"^capsoc fit \S+ --samples 600 -C sensor.a1=")
        subprocess.run(
            [str(CAPSOC)] + command.split()[1:] + ["--json", "again.json"],
            cwd=self.folder,
            env=CLEAN,
            check=True,
            capture_output=True,
        )
        again, stored = json.loads(self.path("again.json").read_text()), json.loads(result)
        self.assertEqual(again["parameters"], stored["parameters"])

    def test_fit_takes_keys_of_the_sensor(self):
        for assignment, expected in (
            ("a1=1", "write sensor.KEY=VALUE"),
            ("sensor.a7=1", "a7"),
            ("sensor.a1", "write sensor.KEY=VALUE"),
            ("sensor.a1=x", "sensor.a1=x"),
        ):
            process = subprocess.run(
                [CAPSOC, "fit", "built-in:soc_eq21.toml", "-C", assignment],
                capture_output=True,
                cwd=self.folder,
                env=CLEAN,
                check=False,
            )
            self.assertEqual(process.returncode, 2)
            self.assertIn(expected, process.stderr.decode())

    def test_regress(self):
        if not (BUILD / "libcapsoc_rtl_precise.so").exists():
            self.skipTest("the RTL is not built")
        self.describe(
            """
name = "regress"
kind = "regress"
[settings]
regress.samples = 200
regress.accesses = 200
[[axes]]
regress.scenario = ["registers", "noise"]
regress.seed = [1, 2]
"""
        )
        out, _ = self.campaign("run", "d.toml")
        self.assertIn("0: no difference", out)
        command = rows_of_any(self.path("d.sqlite"))[0][2]
        self.assertRegex(
            command, r"^capsoc regress --arithmetic precise --scenario \w+ --first-seed [12] --seeds 1 --samples \d+"
        )

    def test_lockstep(self):
        if not (BUILD / "libcapsoc_rtl_precise.so").exists():
            self.skipTest("the RTL is not built")
        self.describe(
            SHORT + '[[axes]]\ncoprocessor.backend = ["tlm", "rtl", "lockstep"]\n[keep]\nfailures = "kept"\n'
            '[criteria]\nsame = "exit.code != 4"\n'
        )
        out, _ = self.campaign("run", "d.toml")
        self.assertIn("yield 100.00 % (3 of 3)", out)
        words = {json.loads(row[3])["uart0"]["sha256"] for row in rows_of_any(self.path("d.sqlite"))}
        self.assertEqual(len(words), 1)

    def without_its_command(self, text):
        """The same with a command that only prints all results, and inputs that are there: a check takes the first
        run's time.
        """
        command = re.search(r"^command.line = '(.*?) (--.*)'$", text, re.MULTILINE)
        program, *tool = command[1].split()
        self.assertTrue(os.access(SOURCE / program, os.X_OK), program)
        usage = subprocess.run(
            [SOURCE / program, *tool, "--help"], capture_output=True, check=True, text=True, env=CLEAN
        ).stdout
        for option in re.findall(r"--\w+", command[2]):
            self.assertIn(option, usage)
        results = re.search(r'^command.results = "(.*)"$', text, re.MULTILINE)[1].split(", ")
        inputs = re.search(r'^command.inputs = "(.*)"$', text, re.MULTILINE)[1].split(", ")
        for name in inputs:
            if not name.startswith("build/"):
                self.assertTrue((SOURCE / name).exists(), name)
        self.path("input").write_text("an input")
        text = text.replace(", ".join(inputs), "input")
        printed = json.dumps({name: 1 for name in results})
        return text.replace(command[0], 'command.line = """echo \'' + printed + '\'"""')

    def test_ready_campaigns(self):
        campaigns = sorted((SOURCE / "campaigns").glob("*.toml"))
        self.assertGreaterEqual(len(campaigns), 10)
        for path in campaigns:
            with self.subTest(path.name):
                if ('kind = "regress"' in path.read_text() or "lockstep" in path.read_text()) and not (
                    BUILD / "libcapsoc_rtl_precise.so"
                ).exists():
                    continue
                text = path.read_text().replace('"build/', f'"{BUILD}/')
                if 'kind = "command"' in text:
                    text = self.without_its_command(path.read_text())
                # To plan hundreds of thousands of runs takes its time; they differ in their seeds.
                self.describe(re.sub(r"^count = \d{4,}$", "count = 10", text, flags=re.MULTILINE))
                self.campaign("check", "d.toml")
        listed = subprocess.run(
            [CAPSOC, "regress", "--list"], capture_output=True, check=True, env=CLEAN
        ).stdout.decode()
        text = (SOURCE / "campaigns/regression.toml").read_text().partition("regress.scenario = [")[2].partition("]")[0]
        self.assertEqual(
            [word.strip('" ') for word in text.replace("\n", "").split(",")],
            [line.split()[0] for line in listed.splitlines()],
        )


if __name__ == "__main__":
    unittest.main()
