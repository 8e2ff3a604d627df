#!/usr/bin/env python3
"""Campaigns of faults: verdicts compared with whole runs, the same rows for any number of jobs, refusals, the table."""

import csv
import json
import re
import shlex
import subprocess
import time
import types
import unittest

from capsoc_tools.faults import fault_verdicts as tool
from capsoc_tools.faults import rates
from harness import BUILD, CAPSOC, CLEAN, Case, FIRMWARE, SOURCE, output_of

CTEST = {"name": "system: FaultVerdicts", "timeout": 300}

VALID, LOCK, ALARM, DIVERGED, MIRROR = 1 << 4, 1 << 1, 1 << 5, 1 << 2, 1 << 3
#: FLAGS that say that something is wrong: CLIP, SAT, ZERO, EARLY, LOCKCHG, CONFIG, UNSETTLED.
WORDS = sum(1 << bit for bit in (1, 2, 3, 4, 5, 8, 11))

DESCRIPTION = """
name = "faults"
kind = "fault"
seed = 3
least_yield = 0
[settings]
fault.to_s = 404
fault.until_s = 406
{settings}
[repetitions]
count = {count}
seeds = ["fault.seed"]
"""


class FaultCase(Case):
    def campaign(self, command, *words):
        return subprocess.run(
            [CAPSOC, "campaign", command, *words],
            capture_output=True,
            text=True,
            check=False,
            env=CLEAN,
            cwd=self.folder,
            timeout=200,
        )

    def results(self, count=8, settings="", jobs=2):
        """Results of the runs, in their order."""
        (self.folder / "d.toml").write_text(DESCRIPTION.format(count=count, settings=settings))
        done = self.campaign("run", "d.toml", "--jobs", str(jobs), "--store", f"{jobs}.sqlite")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.campaign("export", f"{jobs}.sqlite", "--json", "columns.json", "--all")
        columns = json.loads((self.folder / "columns.json").read_text())
        return [{name: column[i] for name, column in columns.items()} for i in range(count)]


def samples_of(recording):
    """(angle in degrees or None, STATUS, FLAGS) of each sample; None of one without a result."""
    samples = []
    for row in csv.reader(line for line in open(recording, encoding="ascii") if line[0] not in "#f"):
        samples.append((float(row[0]) if row[0] else None, int(row[1]), int(row[2])) if row[1] else None)
    return samples


class BesideWholeRuns(FaultCase):
    """Each command is run to its end and recorded, and judged here by what docs/guide/safety.md says."""

    def run_whole(self, command, name):
        words = shlex.split(command)
        self.assertEqual(words[:2], ["capsoc", "run"])
        done = subprocess.run(
            [CAPSOC, *words[1:], "--uart0", "null", "--record", name, "--record-columns", "found_deg,status,flags"],
            cwd=self.folder,
            env=CLEAN,
            capture_output=True,
            check=False,
            timeout=100,
        )
        return types.SimpleNamespace(code=done.returncode, samples=samples_of(self.folder / name))

    @staticmethod
    def verdict(run, golden):
        trusted = wrong = 0
        is_detected = False
        last = None
        ends = len(golden.samples) if run.code == golden.code else len(run.samples)
        for number, was in enumerate(golden.samples[:ends]):
            sample = run.samples[number] if number < len(run.samples) else None
            if was is None or was[0] is None:
                continue
            seen = sample or last or was
            off = abs((seen[0] - was[0] + 180) % 360 - 180) if sample and sample[0] is not None else 0
            if sample is None or off > 0.1:
                wrong += 1
                good = seen[1] & (VALID | LOCK) == VALID | LOCK and not seen[1] & (ALARM | DIVERGED)
                trusted += good and not is_detected
            if sample:
                gone, come = was[1] & ~sample[1], sample[1] & ~was[1]
                is_detected |= bool(gone & (VALID | LOCK) or come & (ALARM | DIVERGED | MIRROR))
                is_detected |= bool(sample[2] & ~was[2] & WORDS)
                last = sample
        if trusted > 3:
            return "silent"
        if is_detected:
            return "detected"
        if run.code in (5, 124):
            return {5: "crashed", 124: "hung"}[run.code]
        if run.code != golden.code:
            return "detected"
        return "wrong" if wrong else "no error"

    def test_verdicts(self):
        results = self.results(10)
        # The bits that the first 10 do not hit: silent for a turn, detected at once, masked.
        for line in ("coprocessor.cv[39]", "coprocessor.au[47]", "coprocessor.lock[0]", "cpu.sp[30]"):
            results += self.results(1, f'fault.line = "flip {line} at 403.2701s"', jobs=1)
            (self.folder / "1.sqlite").unlink()
        golden = self.run_whole("capsoc run", "golden.csv")
        self.assertEqual(golden.code, 0)
        found = set()
        for result in results:
            with self.subTest(fault=result["fault.line"]):
                whole = self.verdict(self.run_whole(result["command"], "r.csv"), golden)
                mine = result["verdict"]
                self.assertEqual("no error" if mine in ("masked", "latent") else mine, whole)
                self.assertEqual(result["exit.code"], int(mine == "silent"))
                found.add(mine)
        self.assertLessEqual({"silent", "detected", "masked", "latent", "crashed"}, found)

    def test_the_documented_one(self):
        (one,) = self.results(1, 'fault.line = "flip coprocessor.cv[39] at 403.27s"', jobs=1)
        self.assertEqual(one["verdict"], "silent")
        self.assertAlmostEqual(one["error_deg"], 0.72, places=2)
        self.assertGreater(one["trusted_wrong_samples"], 1000)
        self.assertIn("flip coprocessor.cv[39] at 403.27s", one["command"])


class Rows(FaultCase):
    def test_what_is_not_simulated_has_the_verdict_of_its_simulation(self):
        pruned = self.results(40)
        (self.folder / "2.sqlite").unlink()
        simulated = self.results(40, "fault.prune = false")
        reasons = {row.get("not_simulated") for row in pruned} - {None}
        self.assertEqual(len(reasons), 1)
        self.assertRegex(reasons.pop(), r"^CTRL.CORRECT is 0 from 402 s to 4\d\d.*, so nothing reads the table$")
        left_out = 0
        for one, other in zip(pruned, simulated):
            is_of_table = one["fault.place"].startswith("coprocessor.corrections.")
            self.assertEqual(one.get("not_simulated") is not None, is_of_table, one)
            left_out += is_of_table
            for name in one:
                if name.startswith(("fault.", "verdict", "detected.", "exit.", "error_deg", "trusted", "command")):
                    self.assertEqual(one[name], other[name], name)
        self.assertGreater(left_out, 10)

    def test_memory_that_the_processor_does_not_use_is_not_simulated(self):
        units = 'fault.units = "code_sram,data_sram"\n'
        pruned = self.results(60, units)
        (self.folder / "2.sqlite").unlink()
        simulated = self.results(60, units + "fault.prune = false")
        left_out = [row for row in pruned if row.get("not_simulated") is not None]
        self.assertTrue(all("does not use the word" in row["not_simulated"] for row in left_out))
        self.assertGreater(len(left_out), 30)
        self.assertLess(len(left_out), 60)
        for one, other in zip(pruned, simulated):
            self.assertEqual((one["fault.line"], one["verdict"]), (other["fault.line"], other["verdict"]))

    def test_a_table_that_is_read_later_is_simulated(self):
        """The program sets CTRL.CORRECT after the last look at the state."""
        settings = f'firmware.elf = "{FIRMWARE}/harmonics.elf"\nfault.from_s = 300\n'
        text = DESCRIPTION.replace("404", "302").replace("406", "304").format(count=12, settings=settings)
        (self.folder / "d.toml").write_text(text)
        done = self.campaign("run", "d.toml", "--store", "r.sqlite")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.campaign("export", "r.sqlite", "--json", "columns.json", "--all")
        columns = json.loads((self.folder / "columns.json").read_text())
        self.assertGreater(sum(place.startswith("coprocessor.corrections.") for place in columns["fault.place"]), 3)
        self.assertNotIn("not_simulated", columns)

    def test_rows_do_not_depend_on_jobs(self):
        self.assertEqual(self.results(12, jobs=1), self.results(12, jobs=3))

    def test_the_pipeline_of_the_rtl(self):
        settings = 'fault.units = "rtl."\nfault.pipeline = true\ncoprocessor.backend = "rtl"'
        for result in self.results(6, settings):
            self.assertRegex(result["fault.line"], r"^flip rtl\.[\w.]+\[\d+\] at sample \d+ cycle \d+$")
            self.assertIn(result["verdict"], ("masked", "latent", "detected", "wrong"))

    def test_a_stuck_bit_is_never_forgotten(self):
        (one,) = self.results(1, 'fault.line = "stuck1 coprocessor.lock[0] at 403s"', jobs=1)
        self.assertEqual(one["verdict"], "latent")
        self.assertGreater(one["simulated_s"], 10)

    def test_a_state_that_differs_is_latent_whatever_the_clock_did_before(self):
        settings = f'firmware.elf = "{FIRMWARE}/safe.elf"\nfault.line = "flip coprocessor.corrections.0[3] at 403.27s"'
        (one,) = self.results(1, settings, jobs=1)
        self.assertEqual(one["verdict"], "latent")

    def test_a_program_without_an_end(self):
        """Its loop hits no data: what is flipped in registers that it does not use stays there."""
        settings = f'firmware.elf = "{FIRMWARE}/forever.elf"\nfault.from_s = 0.01\nfault.units = "processor"'
        settings += '\nfault.line = "flip cpu.r9[3] at 0.015s"'
        (self.folder / "d.toml").write_text(
            DESCRIPTION.replace("404", "0.03").replace("406", "0.1").format(count=1, settings=settings)
        )
        done = self.campaign("run", "d.toml", "--store", "r.sqlite")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, r"(?m)^ +1  0: latent$")

    def test_one_that_does_not_happen(self):
        (one,) = self.results(1, 'fault.line = "flip coprocessor.au[3] at 900s"', jobs=1)
        self.assertEqual((one["verdict"], one["detected.by"]), ("unapplied", "the run ended before its time"))


class Refusals(FaultCase):
    def test_before_anything_runs(self):
        for settings, sentence in (
            ('inject.faults = "flip cpu.r0[0] at 1s"', "inject.faults: a campaign of faults has its own"),
            ("fault.from_s = 405", "fault.from_s 405, fault.to_s 404 and fault.until_s 406 are not in this order"),
            ('fault.kind = "flop"', "fault.kind"),
            ("fault.seeds = 3", "did you mean fault.seed"),
            ('results.record = "r.csv"', "says where something goes"),
        ):
            with self.subTest(settings=settings):
                (self.folder / "d.toml").write_text(DESCRIPTION.format(count=2, settings=settings))
                done = self.campaign("run", "d.toml", "--store", "r.sqlite")
                self.assertEqual(done.returncode, 2, done.stdout)
                self.assertIn(sentence, done.stderr)
                self.assertIn("d.toml:", done.stderr)

    def test_by_the_run_without_a_fault(self):
        for settings, sentence in (
            ("program.demodulation_samples = 5000", "the run without a fault ends at"),
            ('fault.units = "coprozessor"', "fault.units: no unit begins with 'coprozessor'"),
            ('fault.line = "flop cpu.r0[0] at 403s"', "fault.line 'flop cpu.r0[0] at 403s': "),
            ('firmware.elf = "none.elf"', "none.elf"),
        ):
            with self.subTest(settings=settings):
                (self.folder / "d.toml").write_text(DESCRIPTION.format(count=1, settings=settings))
                done = self.campaign("check", "d.toml")
                self.assertEqual(done.returncode, 2, done.stdout)
                self.assertIn(sentence, done.stderr)

    def test_a_place_that_does_not_exist_is_the_result(self):
        (self.folder / "d.toml").write_text(
            DESCRIPTION.format(count=1, settings='fault.line = "flip cpu.r99[0] at 403s"')
        )
        done = self.campaign("run", "d.toml", "--store", "r.sqlite")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn(
            "refused: the drawn fault 'flip cpu.r99[0] at 403s': the processor has no register 'r99'", done.stdout
        )

    def test_a_signal_in_the_run_without_a_fault(self):
        (self.folder / "tmp").mkdir()
        settings = f'firmware.elf = "{FIRMWARE}/forever.elf"\nfault.from_s = 1'
        (self.folder / "d.toml").write_text(DESCRIPTION.replace("406", "1e5").format(count=1, settings=settings))
        process = subprocess.Popen(
            [CAPSOC, "campaign", "run", "d.toml", "--store", "r.sqlite"],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env={**CLEAN, "TMPDIR": str(self.folder / "tmp")},
            cwd=self.folder,
        )
        while not list((self.folder / "tmp").glob("*/*/lock")):
            time.sleep(0.01)
        process.terminate()
        _, said = process.communicate(timeout=10)
        self.assertNotEqual(process.returncode, 0)
        self.assertIn(b"a signal ended the run without a fault", said)
        self.assertEqual(list((self.folder / "tmp").iterdir()), [])

    def test_nothing_is_left_behind(self):
        (self.folder / "tmp").mkdir()
        (self.folder / "d.toml").write_text(DESCRIPTION.format(count=3, settings=""))
        done = subprocess.run(
            [CAPSOC, "campaign", "run", "d.toml", "--store", "r.sqlite"],
            capture_output=True,
            check=False,
            env={**CLEAN, "TMPDIR": str(self.folder / "tmp")},
            cwd=self.folder,
            timeout=100,
        )
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(list((self.folder / "tmp").iterdir()), [])


class Tool(Case):
    def run_tool(self, *options):
        return subprocess.run(
            [SOURCE / "scripts" / "tool", "fault_verdicts", "--build", BUILD, "--rows", "r.csv", *options],
            capture_output=True,
            text=True,
            check=False,
            env=CLEAN,
            cwd=self.folder,
            timeout=200,
        )

    def test_table(self):
        done = self.run_tool("--count", "20", "--seed", "3", "--units", "processor,code_sram,coprocessor")
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(self.folder / "r.csv", encoding="ascii") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), 20)
        self.assertIn("20 faults, seed 3", done.stdout)
        for verdict in tool.VERDICTS:
            hits = sum(row["verdict"] == verdict for row in rows)
            self.assertRegex(done.stdout, rf"(?m)^{verdict} +{hits} ")

    def test_table_of_stores(self):
        """Two programs side by side: the counts are those of the rows, and every run is in one column."""
        (self.folder / "d.toml").write_text(
            'name = "d"\nkind = "fault"\nleast_yield = 0\n[settings]\nfault.units = "coprocessor,processor"\n'
            '[[axes]]\nfirmware.elf = ["safe", "selfcal"]\n[repetitions]\ncount = 12\nseeds = ["fault.seed"]\n'
        )
        output_of(CAPSOC, "campaign", "run", "d.toml", "--store", "d.sqlite", cwd=self.folder)

        def table(*options, code=0):
            words = [SOURCE / "scripts" / "tool", "fault_table", "--build", BUILD, *options]
            done = subprocess.run(
                words, capture_output=True, text=True, check=False, env=CLEAN, cwd=self.folder, timeout=100
            )
            self.assertEqual(done.returncode, code, done.stderr)
            return done.stdout + done.stderr

        rows = json.loads(
            output_of(CAPSOC, *"campaign export d.sqlite --all --json /dev/stdout".split(), cwd=self.folder)
        )
        self.assertEqual(len(rows["verdict"]), 24)
        said = table("d.sqlite", "--by", "firmware.elf", "--silent")
        self.assertRegex(said, r"(?m)^ +safe +selfcal$")
        self.assertRegex(said, r"(?m)^faults +12 +12$")
        for verdict in tool.VERDICTS:
            counts = [
                sum(pair == (program, verdict) for pair in zip(rows["firmware.elf"], rows["verdict"]))
                for program in ("safe", "selfcal")
            ]
            self.assertRegex(said, rf"(?m)^{verdict} +{counts[0]}(,.*%.*| \(to .*\)) +{counts[1]}(,.*%.*| \(to .*\))$")
        self.assertEqual(said.count("\nsilent ("), rows["verdict"].count("silent"))
        self.assertRegex(table("d.sqlite", "--by", "firmware.elf", "--only", "firmware.elf=safe"), r"(?m)^faults +12$")
        self.assertIn("its runs have no 'colour'", table("d.sqlite", "--by", "colour", code=2))
        self.assertIn("this is no store of a campaign", table("d.toml", code=2))
        # What became of each fault in the two programs.
        said = table("d.sqlite", "--by", "firmware.elf", "--alike", "firmware.elf", code=1)
        became = {}
        for row in (dict(zip(rows, values)) for values in zip(*rows.values())):
            outcome = tuple(row[name] for name in ("verdict", "detected.by", "error_deg", "simulated_s"))
            became.setdefault(row["fault.line"], []).append(outcome)
        differ = sorted(line for line, outcomes in became.items() if len(set(outcomes)) > 1)
        self.assertTrue(0 < len(differ) < len(became), became)
        self.assertIn(f"\nalike: {12 - len(differ)} of 12 faults with firmware.elf safe, selfcal\n", said)
        self.assertEqual(sorted(re.findall(r"(?m)^differs \(\): (.*?): safe: ", said)), differ)
        none = table(
            "d.sqlite", "--by", "firmware.elf", "--only", "firmware.elf=safe", "--alike", "firmware.elf", code=1
        )
        self.assertIn("alike: 0 of 0 faults with firmware.elf safe; 12 without a run for each", none)
        # Runs without a verdict are not left out in silence.
        (self.folder / "e.toml").write_text(
            'name = "e"\nkind = "fault"\nleast_yield = 0\n[settings]\nfault.units = "coprocessor"\n'
            '[[axes]]\nfirmware.elf = ["safe", "hello"]\n[repetitions]\ncount = 1\nseeds = ["fault.seed"]\n'
        )
        output_of(CAPSOC, "campaign", "run", "e.toml", "--store", "e.sqlite", cwd=self.folder)
        self.assertIn("the run without a fault ends at", table("e.sqlite", code=2))
        (self.folder / "f.toml").write_text('name = "f"\n[settings]\nfirmware.elf = "hello"\n')
        output_of(CAPSOC, "campaign", "run", "f.toml", "--store", "f.sqlite", cwd=self.folder)
        self.assertIn("it is a campaign of another kind", table("f.sqlite", code=2))

    def test_metrics(self):
        (self.folder / "r.toml").write_text("[fit_per_bit]\ncoprocessor = 1e-4\nproc = 2e-3\n")
        done = self.run_tool("--count", "30", "--units", "processor,coprocessor", "--rates", "r.toml")
        self.assertEqual(done.returncode, 0, done.stderr)
        places = json.loads(output_of(CAPSOC, "run", "--list-fault-places"))["places"]
        for unit, rate in (("coprocessor", 1e-4), ("processor", 2e-3)):
            bits = sum(place["bits"] for place in places if place["unit"] == unit)
            self.assertRegex(done.stdout, rf"(?m)^{unit} +{bits} +{bits * rate:.4g} ")
        for name in ("single-point fault metric", "latent fault metric"):
            self.assertRegex(
                done.stdout, rf"(?m)^{name} +0\.\d+, at least 0\.\d+ \(95 %\)$|^{name} +1\.0000, at least 0"
            )

    def test_metrics_by_hand(self):
        """100 FIT with 1 of 50 residual and 10 FIT with 2 of 20; 25 and 0 latent. Bounds: shares twice as large."""
        rows = [{"unit": "a", "verdict": verdict} for verdict in ["silent"] + ["latent"] * 25 + ["masked"] * 24]
        rows += [{"unit": "b.c", "verdict": verdict} for verdict in ["silent"] * 2 + ["detected"] * 18 + ["unapplied"]]
        units = rates.units_of(rows, {"a": 1000, "b.c": 100}, {"a": 0.1, "b": 9, "b.": 0.1}, "r.toml")
        self.assertEqual([unit.fit for unit in units], [100, 10])

        def upper(hits, count):
            return 2 * hits / count

        single = rates.single_point_metric(units, upper)
        self.assertAlmostEqual(single.value, 1 - (2 + 1) / 110)
        self.assertAlmostEqual(single.least, 1 - (4 + 2) / 110)
        latent = rates.latent_metric(units, upper)
        self.assertAlmostEqual(latent.value, 1 - 50 / (110 - 3))
        self.assertAlmostEqual(latent.least, 1 - 100 / (110 - 6))

    def test_rates_that_are_none(self):
        for text, words in (
            ("", "has to have one table, [fit_per_bit]"),
            ("[fit_per_bit]\n", "has to have one table, [fit_per_bit]"),
            ("[fit_per_bit]\ncoprocessor = -1\n", "coprocessor: has to be a number above 0"),
            ("[fit_per_bit]\nprocessor = 1\n", "has no rate for coprocessor"),
            ("[fit_per_bit\n", "r.toml: "),
        ):
            (self.folder / "r.toml").write_text(text)
            with self.subTest(text=text):
                done = self.run_tool("--count", "2", "--rates", "r.toml")
                self.assertEqual(done.returncode, 1)
                self.assertIn(words, done.stderr)

    def test_what_is_wrong_is_said(self):
        done = self.run_tool("--count", "2", "--units", "nothing")
        self.assertEqual(done.returncode, 1)
        self.assertIn("fault.units: no unit begins with 'nothing'", done.stderr)

    def test_intervals(self):
        """Brown, Cai, DasGupta 2001: of 10 in 100."""
        low, high = tool.wilson(10, 100)
        self.assertAlmostEqual(low, 0.0552, places=4)
        self.assertAlmostEqual(high, 0.1744, places=4)
        self.assertEqual(tool.wilson(0, 10)[0], 0)


if __name__ == "__main__":
    unittest.main()
