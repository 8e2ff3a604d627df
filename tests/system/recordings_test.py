#!/usr/bin/env python3
"""Recordings: the dialects of docs/reference/recordings.md, and files that other programs wrote or read."""

import json
import math
import os
import random
import struct
import subprocess
import unittest
import wave

from harness import CAPSOC, CLEAN, Case, FIRMWARE, SOURCE

CTEST = {"name": "recordings"}

PAGE = SOURCE / "docs" / "reference" / "recordings.md"
# Debian's own: it has scipy.
PYTHON = "/usr/bin/python3"

# What every dialect of the table holds: 500 samples of 2.3 turns at 250 Hz.
SENSOR = (0.45, 0.40, 0.06, -0.09, 0.2)
COUNT, RATE, HZ = 500, 250.0, 1.15


def samples(noise=1e-4):
    """(t, u, v, angle in turns) of the sensor."""
    r = random.Random(1)
    rows = []
    for k in range(COUNT):
        turns = HZ * k / RATE
        theta = 2 * math.pi * turns
        rows.append(
            (
                k / RATE,
                SENSOR[0] * math.sin(theta) + SENSOR[2] + r.gauss(0, noise),
                SENSOR[1] * math.cos(theta + SENSOR[4]) + SENSOR[3] + r.gauss(0, noise),
                turns % 1,
            )
        )
    return rows


class RecordingCase(Case):
    def capsoc(self, *arguments, **keywords):
        return subprocess.run(
            [CAPSOC, *map(str, arguments)],
            capture_output=True,
            timeout=300,
            check=False,
            env=CLEAN,
            cwd=self.folder,
            **keywords,
        )

    def fit(self, *arguments, warnings=0, **keywords):
        process = self.capsoc("fit", *arguments, "--json", "c.json", **keywords)
        said = process.stderr.decode()
        self.assertEqual(process.returncode, 0, said)
        self.assertEqual(len(said.splitlines()), warnings, said)
        return json.loads((self.folder / "c.json").read_text()), said

    def refused(self, *arguments, **keywords):
        """The one sentence of what is not read, the same of fit and of run."""
        process = self.capsoc("fit", *arguments, **keywords)
        said = process.stderr.decode()
        self.assertEqual((process.returncode, process.stdout), (2, b""), said)
        self.assertEqual(len(said.splitlines()), 1, said)
        run = self.capsoc("run", FIRMWARE / "hello.elf", "--sensor", *arguments, **keywords)
        self.assertEqual(run.returncode, 2, run.stderr)
        self.assertEqual(run.stderr.decode(), said)
        return said

    def check_sensor(self, result, scale=1.0, zero=0.0, turned=False):
        """The parameters are those of SENSOR, in the unit `scale` and `zero` made of it."""
        p = {name: result["parameters"][name]["value"] for name in ("a1", "a2", "b1", "b2", "beta")}
        a1, a2, b1, b2, beta = SENSOR
        if turned:
            a1, a2, b1, b2 = a2, a1, b2, b1
        for name, right in (
            ("a1", a1 * scale),
            ("a2", a2 * scale),
            ("b1", b1 * scale + zero),
            ("b2", b2 * scale + zero),
            ("beta", beta),
        ):
            self.assertAlmostEqual(p[name], right, delta=6e-4, msg=name)


class Dialects(RecordingCase):
    """Each row of the table is written, read, and found to be the sensor."""

    def rows(self):
        section = PAGE.read_text().split("## Dialects")[1].split("\n## ")[0]
        table = [line for line in section.splitlines() if line.startswith("|")]
        cells = [[cell.strip() for cell in line.strip("|").replace("\\|", "\0").split("|")] for line in table]
        self.assertEqual(cells[0], ["kind", "file", "first lines", "options"])
        return [[cell.replace("\0", "|").strip("`").replace("&nbsp;", " ") for cell in row] for row in cells[2:]]

    @staticmethod
    def text(first):
        """The file whose first lines the table shows: `<br>` ends a line, and the row in braces is that of every
        sample.
        """
        lines = first.replace("` `", "").split("<br>")
        lines = [line.strip("`") for line in lines]
        pattern = lines.pop()
        out = []
        comma = "{,}" in pattern
        pattern = pattern.replace("{,}", "").replace("\\t", "\t")
        for k, (t, u, v, turns) in enumerate(samples()):
            values = {
                "k": k,
                "t": t,
                "ms": t * 1e3,
                "us": t * 1e6,
                "u": u,
                "v": v,
                "deg": turns * 360,
                "rad": turns * 2 * math.pi,
                "turns": turns,
                "u12": round(2048 + 2000 * u),
                "v12": round(2048 + 2000 * v),
                "us16": round(32767 * u),
                "vs16": round(32767 * v),
                "uV": 1.65 + 1.5 * u,
                "vV": 1.65 + 1.5 * v,
                "umV": 1650 + 1500 * u,
                "vmV": 1650 + 1500 * v,
                "upc": 50 + 50 * u,
                "vpc": 50 + 50 * v,
            }
            line = pattern
            for name, value in sorted(values.items(), key=lambda item: -len(item[0])):
                number = f"{value}" if isinstance(value, int) else f"{value:.9f}"
                line = line.replace("{" + name + "}", number.replace(".", ",") if comma else number)
            out.append(line)
        return "\n".join(line.replace("\\t", "\t") for line in lines + out) + "\n"

    def files(self, row):
        """Writes what the row says; the name for the command line."""
        kind, name, first, _ = row
        ends = {"UTF-16": "utf-16", "byte order mark": "utf-8-sig", "Latin-1": "latin-1"}
        encoding = next((code for word, code in ends.items() if word in kind), "utf-8")
        texts = [self.text(part) for part in first.split("` and `")]
        names = name.split(",") if len(texts) == 2 else [name]
        for one, text in zip(names, texts):
            if "CR LF" in kind:
                text = text.replace("\n", "\r\n")
            if "CR alone" in kind:
                text = text.replace("\n", "\r")
            (self.folder / one).write_bytes(text.encode(encoding))
        return name

    def check(self, row):
        name = self.files(row)
        options = row[3].split()
        result, _ = self.fit(name, *options)
        self.assertEqual(result["samples"], COUNT)
        unit = result.get("unit", {"full_scale": 1, "zero": 0})
        # Every row of another unit is 2000, 32767, 1.5 or 50 of it, about its middle.
        scales = {2048: 2000 / 2048, 32768: 32767 / 32768, 1.65: 1.5 / 1.65, 1650: 1500 / 1650, 50: 1, 1: 1}
        self.check_sensor(result, scale=scales[unit["full_scale"]])
        has_angle = any(word in row[2] for word in ("{deg}", "{rad}", "{turns}"))
        errors = result["angle_error_deg"]
        if has_angle:
            self.assertLess(errors["calibrated_peak_to_peak"], 0.3)
        else:
            self.assertIsNone(errors["calibrated_peak_to_peak"])
        # The run reads the same: its samples are the record's, and its rate where there is one.
        process = self.capsoc(
            "run",
            FIRMWARE / "calibrate.elf",
            "--parameters",
            "c.json",
            "--sensor",
            name,
            *options,
            "--uart0",
            "null",
            "--json",
            "r.json",
        )
        self.assertIn(process.returncode, (0, 1), process.stderr.decode())
        self.assertNotIn("warning", process.stderr.decode())

    def test_every_row(self):
        rows = self.rows()
        self.assertGreaterEqual(len(rows), 30)
        self.assertEqual(len({row[0] for row in rows}), len(rows))
        for row in rows:
            with self.subTest(row[0]):
                self.check(row)


class Refusals(RecordingCase):
    """What is not read, in one sentence that names what is there and what chooses."""

    def write(self, name, head, pattern="{u:.6f},{v:.6f}", rows=None):
        lines = [
            pattern.format(k=k, t=t, u=u, v=v, turns=turns) for k, (t, u, v, turns) in enumerate(rows or samples())
        ]
        (self.folder / name).write_text("\n".join(([head] if head else []) + lines) + "\n")
        return name

    def test_names_that_are_not_known(self):
        self.write("a.csv", "time,left,right", "{t},{u:.6f},{v:.6f}")
        said = self.refused("a.csv")
        self.assertTrue(said.startswith("capsoc: a.csv:1: the columns are 'time', 'left', 'right'; "), said)
        self.assertIn("--columns", said)
        result, _ = self.fit("a.csv", "--columns", "time,left,right")
        self.check_sensor(result)
        self.assertIn("--columns time,left,right", result["command"])
        self.assertIn(
            "there is no column 'middle'; the columns are 'time', 'left', 'right'",
            self.refused("a.csv", "--columns", "left,middle"),
        )
        self.assertIn("'left' is there twice", self.refused("a.csv", "--columns", "left,2"))
        self.assertIn("has 5 parts", self.refused("a.csv", "--columns", "1,2,3,4,5"))

    def test_units(self):
        for pattern, sentence in (
            ("{u12},{v12}", "12-bit counts? Use --full-scale 2048 --zero 2048, or --scale auto"),
            ("{uV:.5f},{vV:.5f}", "volts of a 3.3 V supply? Use --full-scale 1.65 --zero 1.65, or --scale auto"),
        ):
            rows = [
                pattern.format(
                    u12=round(2048 + 1500 * u), v12=round(2048 + 1500 * v), uV=1.65 + 0.9 * u, vV=1.65 + 0.9 * v
                )
                for _, u, v, _ in samples()
            ]
            (self.folder / "a.csv").write_text("u,v\n" + "\n".join(rows) + "\n")
            said = self.refused("a.csv")
            self.assertIn("lie outside full scale (-1..1): " + sentence, said)
            options = sentence.split("Use ")[1].split(",")[0].split()
            given, _ = self.fit("a.csv", *options)
            auto, _ = self.fit("a.csv", "--scale", "auto")
            self.assertEqual(given["parameters"], auto["parameters"])
            assigned, _ = self.fit("a.csv", "-C", "sensor.scale=auto")
            self.assertEqual(given["parameters"], assigned["parameters"])
        self.assertIn("reach 1.", self.refused("a.csv", "--full-scale", "1.65"))

    def test_the_step_is_the_converters(self):
        rows = [f"{round(2048 + 1500 * u)},{round(2048 + 1500 * v)}" for _, u, v, _ in samples()]
        (self.folder / "a.csv").write_text("u,v\n" + "\n".join(rows) + "\n")
        result, _ = self.fit("a.csv", "--scale", "auto")
        self.assertAlmostEqual(result["unit"]["step"], 2**-11, places=12)
        self.assertEqual(result["unit"]["name"], "12-bit counts")

    def test_options_that_contradict(self):
        self.write("a.csv", "u,v")
        self.assertIn("give one or the other", self.refused("a.csv", "--scale", "auto", "--zero", "1"))
        self.assertIn("--full-scale 0", self.refused("a.csv", "--full-scale", "0"))
        self.assertIn("--zero cannot be 'one'", self.refused("a.csv", "--zero", "one"))
        self.assertIn("--scale cannot be 'car'", self.refused("a.csv", "--scale", "car"))
        self.assertIn("for recordings", self.refused(SOURCE / "traces" / "soc_eq21.toml", "--scale", "auto"))

    def test_an_angle_without_a_unit(self):
        self.write("a.csv", "u,v,angle", "{u:.6f},{v:.6f},{turns:.6f}")
        self.assertIn("column 'angle' goes from 0 to 0.998", said := self.refused("a.csv"))
        self.assertIn("angle_rad", said)
        result, _ = self.fit("a.csv", "--columns", "-,u,v,angle:turns")
        self.assertLess(result["angle_error_deg"]["calibrated_peak_to_peak"], 0.3)

    def test_two_files_of_two_lengths(self):
        self.write("u.csv", "volts", "{u:.6f}")
        self.write("v.csv", "volts", "{v:.6f}", samples()[:-1])
        self.assertIn("v.csv:500: the file ends after 499 samples, and u.csv continues", self.refused("u.csv,v.csv"))
        self.assertIn("w.csv: cannot be read", self.refused("u.csv,w.csv"))
        self.assertIn("there is one column", self.refused("u.csv"))

    def test_no_output_is_one_of_two_files(self):
        self.write("u.csv", "volts", "{u:.6f}")
        self.write("v.csv", "volts", "{v:.6f}")
        before = (self.folder / "v.csv").read_bytes()
        process = self.capsoc("fit", "u.csv,v.csv", "--json", "v.csv")
        self.assertEqual(process.returncode, 2)
        process = self.capsoc("run", FIRMWARE / "hello.elf", "--sensor", "u.csv,v.csv", "--json", "v.csv")
        self.assertEqual(process.returncode, 2)
        self.assertEqual((self.folder / "v.csv").read_bytes(), before)


class LongRecords(RecordingCase):
    """How much memory a fit needs: the two numbers of a row, and little more."""

    def peak(self, rows):
        """Largest resident size of a fit of `rows` rows, in bytes."""
        r = random.Random(2)
        with open(self.folder / "long.csv", "w", encoding="ascii") as file:
            file.write("u,v\n")
            for k in range(rows):
                theta = 0.0643 * k
                u, v = 0.7 * math.sin(theta) + 0.1, 0.6 * math.cos(theta + 0.1) - 0.05
                file.write(f"{u + r.uniform(-1e-3, 1e-3):.7f},{v + r.uniform(-1e-3, 1e-3):.7f}\n")
        process = subprocess.Popen([CAPSOC, "fit", "long.csv"], env=CLEAN, cwd=self.folder, stdout=subprocess.DEVNULL)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        self.assertEqual(process.returncode, 0)
        return usage.ru_maxrss << 10

    def test_little_more_than_sixteen_bytes_a_row(self):
        few, many = 400_000, 1_600_000
        self.assertLess((self.peak(many) - self.peak(few)) / (many - few), 22)


class TimeStamps(RecordingCase):
    """Lost, doubled and coarse stamps: one warning that names the place, the same of fit and run."""

    def record(self, rows, times=None):
        lines = [f"{t:.6f},{u:.9f},{v:.9f},{turns * 360:.9f}" for t, u, v, turns in rows]
        (self.folder / "a.csv").write_text("t,u,v,angle_deg\n" + "\n".join(lines) + "\n")

    def both(self):
        result, said = self.fit("a.csv", warnings=1)
        self.assertEqual(["warning: " + said for said in result["sensor_warnings"]], said.splitlines())
        process = self.capsoc("run", FIRMWARE / "hello.elf", "--sensor", "a.csv", "--json", "r.json")
        self.assertEqual(process.stderr.decode().splitlines()[0], said.strip())
        self.assertEqual(
            json.loads((self.folder / "r.json").read_text())["sensor_warnings"][0], said.strip()[len("warning: ") :]
        )
        return said

    def test_lost_samples(self):
        rows = samples()
        self.record(rows[:200] + rows[250:])
        said = self.both()
        self.assertIn(
            "warning: a.csv: 1 gap in the time stamps of 0.204 s after t = 0.796 (line 202): about 50 samples", said
        )
        # The rate is the median step: nothing is said of another one, and the speed is the shaft's.
        process = self.capsoc("run", "--sensor", "a.csv", "--uart0", "null")
        said = process.stderr.decode()
        self.assertNotIn("resample", said)
        self.assertIn("the sensor turns at 1.15 Hz", said)

    def test_doubled_rows(self):
        rows = samples()
        self.record(rows[:200] + rows[199:])
        self.assertIn("1 row has the time stamp of the row before (the first in line 202", self.both())

    def test_a_clock_that_begins_again(self):
        rows = samples()
        self.record([(t if k < 300 else t - 1.2, u, v, turns) for k, (t, u, v, turns) in enumerate(rows)])
        self.assertIn("the clock begins again once", self.both())

    def test_rows_out_of_order(self):
        rows = samples()
        random.Random(2).shuffle(rows)
        self.record(rows)
        self.assertIn("sort the rows by time", self.refused("a.csv"))


class Wav(RecordingCase):
    """WAV files of Python's wave and of sox."""

    def write(self, width, channels=2):
        frames = bytearray()
        for _, u, v, _ in samples():
            for x in [u, v, 0][:channels]:
                word = round(x * (1 << (8 * width - 1)))
                frames += (
                    (word + 128).to_bytes(1, "little") if width == 1 else word.to_bytes(width, "little", signed=True)
                )
        with wave.open(str(self.folder / "a.wav"), "wb") as out:
            out.setnchannels(channels)
            out.setsampwidth(width)
            out.setframerate(250)
            out.writeframes(frames)

    def test_pcm(self):
        for width in (2, 3, 4):
            with self.subTest(width):
                self.write(width)
                result, _ = self.fit("a.wav")
                self.check_sensor(result)
                self.assertEqual(result["samples"], COUNT)
        self.write(1)
        result, _ = self.fit("a.wav")
        self.assertAlmostEqual(result["unit"]["step"], 2**-7)

    def test_what_sox_makes_of_it(self):
        self.write(4)
        for options in (
            ["-e", "floating-point", "-b", "32"],
            ["-e", "floating-point", "-b", "64"],
            ["-e", "signed-integer", "-b", "24"],
            ["-t", "wavpcm", "-b", "16"],
        ):
            with self.subTest(options):
                subprocess.run(
                    ["sox", "-D", "a.wav", *options, "b.wav"], cwd=self.folder, check=True, capture_output=True
                )
                self.check_sensor(self.fit("b.wav")[0])
        subprocess.run(
            ["sox", "-D", "a.wav", "-e", "mu-law", "b.wav"], cwd=self.folder, check=True, capture_output=True
        )
        self.assertIn("its samples are coded", self.refused("b.wav"))

    def test_standard_input_and_a_cut(self):
        self.write(2)
        whole = (self.folder / "a.wav").read_bytes()
        self.check_sensor(self.fit("-", input=whole)[0])
        (self.folder / "b.wav").write_bytes(whole[:-501])
        result, said = self.fit("b.wav", warnings=1)
        self.assertIn("ends within its samples", said)
        self.assertEqual(result["samples"], COUNT - 126)
        self.write(2, channels=3)
        self.assertIn("there are 3 channels of sound; choose two with --columns 1,2", self.refused("a.wav"))
        self.check_sensor(self.fit("a.wav", "--columns", "1,2")[0])
        self.write(2, channels=1)
        self.assertIn("there is one channel of sound", self.refused("a.wav"))


class Mat(RecordingCase):
    """MAT files of scipy."""

    def scipy(self, code, *arguments):
        script = "import sys, numpy as np, scipy.io as io\n" "d = np.loadtxt('d.txt'); t, u, v, turns = d.T\n" + code
        (self.folder / "d.txt").write_text("\n".join(" ".join(repr(x) for x in row) for row in samples()) + "\n")
        subprocess.run([PYTHON, "-c", script, *arguments], cwd=self.folder, check=True)

    def test_vectors_matrices_and_types(self):
        for code in (
            "io.savemat('a.mat', dict(t=t, u=u, v=v, angle_deg=360 * turns))",
            "io.savemat('a.mat', dict(u=u, v=v, fs=250.0), do_compression=True)",
            "io.savemat('a.mat', dict(u=u, v=v), oned_as='column')",
            "io.savemat('a.mat', dict(sin=u.astype(np.float32), cos=v.astype(np.float32), note='words'))",
            "io.savemat('a.mat', dict(m=np.column_stack([u, v])))",
            "io.savemat('a.mat', dict(m=np.column_stack([t, u, v]).T), do_compression=True)",
        ):
            with self.subTest(code):
                self.scipy(code)
                result, _ = self.fit("a.mat")
                self.check_sensor(result)
                self.assertEqual(result["samples"], COUNT)

    def test_counts(self):
        for kind, scale in (("int16", 1), ("uint16", 1), ("int32", 1)):
            self.scipy(
                f"io.savemat('a.mat', dict(u=np.round(2048+2000*u).astype(np.{kind}), "
                f"v=np.round(2048+2000*v).astype(np.{kind})))"
            )
            self.assertIn("12-bit counts?", self.refused("a.mat"))
            self.check_sensor(self.fit("a.mat", "--scale", "auto")[0], scale=2000 / 2048)

    def test_what_has_no_signals(self):
        self.scipy("io.savemat('a.mat', dict(s=dict(u=u, v=v), note='words'))")
        said = self.refused("a.mat")
        self.assertIn("the variables are 's' (no real numbers), 'note' (no real numbers)", said)
        self.scipy("io.savemat('a.mat', dict(left=u, right=v))")
        self.assertIn("the columns are 'left', 'right'", self.refused("a.mat"))
        self.check_sensor(self.fit("a.mat", "--columns", "left,right")[0])
        self.scipy("io.savemat('a.mat', dict(u=u, v=v), format='4')")
        self.assertIn("is no MAT file of level 5; save it with -v7", self.refused("a.mat"))
        (self.folder / "a.mat").write_bytes(b"MATLAB 7.3 MAT-file".ljust(512) + b"\x89HDF\r\n\x1a\n")
        self.assertIn("version 7.3 (HDF5); save it with -v7", self.refused("a.mat"))


class Sds(RecordingCase):
    """Recordings of Arm's SDS-Framework, written as its documentation says."""

    META = "sds:\n  name: Resolver\n  description: two coils\n  sample-frequency: 250\n  content:\n"
    PAIR = "  - value: {u}\n    type: {type}{more}\n  - value: {v}\n    type: {type}{more}\n"

    def write(self, meta, code, convert, block=25, lost=None, name="Resolver.0.sds"):
        rows = samples()
        out = b""
        for number, start in enumerate(range(0, COUNT, block)):
            data = b"".join(
                struct.pack("<" + code, *(convert(x) for x in row[1:3])) for row in rows[start : start + block]
            )
            if number != lost:
                out += struct.pack("<II", round(1000 * start / RATE) + 4_294_967_000 & 0xFFFFFFFF, len(data)) + data
        (self.folder / name).write_bytes(out)
        (self.folder / "Resolver.sds.yml").write_text(meta)

    def test_types(self):
        for kind, code, scale in (
            ("int16_t", "hh", 2**-15),
            ("int32_t", "ii", 2**-31),
            ("float", "ff", 1),
            ("double", "dd", 1),
        ):
            with self.subTest(kind):
                more = "" if scale == 1 else f"\n    scale: {scale!r}"
                self.write(
                    self.META + self.PAIR.format(u="u", v="v", type=kind, more=more),
                    code,
                    (lambda x, s=scale: x) if scale == 1 else (lambda x, s=scale: round(x / s)),
                )
                result, _ = self.fit("Resolver.0.sds")
                self.check_sensor(result)
                self.assertEqual(result["samples"], COUNT)

    def test_offsets_units_and_labels(self):
        meta = self.META.replace("sample-frequency", "frequency") + self.PAIR.format(
            u="sin", v="cos", type="uint16_t", more="\n    scale: 0.5\n    offset: -4\n    unit: mV  # of the amplifier"
        )
        self.write(meta, "HH", lambda x: round((1650 + 1500 * x + 4) * 2), name="Resolver.bench.3.p.sds")
        self.assertIn("millivolts of a 3.3 V supply?", self.refused("Resolver.bench.3.p.sds"))
        self.check_sensor(self.fit("Resolver.bench.3.p.sds", "--scale", "auto")[0], scale=1500 / 1650)

    def test_audio_and_a_lost_block(self):
        meta = (
            "sds:\n  name: Stereo\n  content:\n  - audio:\n      sample-frequency: 250\n      bit-depth: 16\n"
            "      audio-channels: 2\n      format: pcm\n"
        )
        self.write(meta, "hh", lambda x: round(x * 32768))
        self.check_sensor(self.fit("Resolver.0.sds")[0])
        self.write(meta, "hh", lambda x: round(x * 32768), lost=7)
        result, said = self.fit("Resolver.0.sds", warnings=1)
        self.assertIn("1 gap in the time stamps of 0.2 s after t = 0.6 (block 8): about 1 blocks are missing", said)
        self.assertEqual(result["samples"], COUNT - 25)

    def test_what_is_wrong_with_it(self):
        good = self.META + self.PAIR.format(u="u", v="v", type="int16_t", more="")
        self.write(good, "hh", lambda x: round(x * 32768))
        (self.folder / "Resolver.sds.yml").unlink()
        self.assertIn("its metadata Resolver.sds.yml is not there", self.refused("Resolver.0.sds"))
        for meta, sentence in (
            (good.replace("int16_t", "int16_t:3"), "Resolver.sds.yml:6: 'u' has the type 'int16_t:3'"),
            (good.replace("int16_t", "int24_t"), "has the type 'int24_t'"),
            ("sds:\n  name: x\n  content: [\n", "is no YAML"),
            ("x: 1\n", "there is no 'sds:'"),
            ("sds:\n  name: x\n", "no list 'content:'"),
            (good.replace("250", "fast"), "Resolver.sds.yml:4: 'sample-frequency' is 'fast'"),
            (
                good.replace("int16_t", "int32_t").replace("value: v\n    type: int32_t", "value: v\n    type: double"),
                "block 1 (byte 0) has 100 bytes, and a sample has 12",
            ),
        ):
            (self.folder / "Resolver.sds.yml").write_text(meta)
            if sentence:
                self.assertIn(sentence, self.refused("Resolver.0.sds"))
        (self.folder / "Resolver.sds.yml").write_text(good)
        whole = (self.folder / "Resolver.0.sds").read_bytes()
        (self.folder / "Resolver.0.sds").write_bytes(whole[:-3])
        self.assertIn("block 20 (byte 2052) has 100 bytes, and the file ends before", self.refused("Resolver.0.sds"))

    def test_no_output_is_its_metadata(self):
        self.write(self.META + self.PAIR.format(u="u", v="v", type="double", more=""), "dd", lambda x: x)
        process = self.capsoc("fit", "Resolver.0.sds", "--json", "Resolver.sds.yml")
        self.assertEqual(process.returncode, 2)
        self.assertIn("Resolver.sds.yml", process.stderr.decode())


class Written(RecordingCase):
    """`--record` in other formats, read by programs that are not ours and by capsoc again."""

    def record(self, name, *options):
        """The recording, and the same run's as CSV; rows of numbers by column."""
        files = {}
        for file in ("r.csv", name):
            process = self.capsoc(
                "run",
                "--record",
                file,
                "-P",
                "demodulation_samples=2000",
                "-P",
                "calibration_samples=0",
                "--uart0",
                "null",
                *options,
            )
            self.assertIn(process.returncode, (0, 1), process.stderr.decode())
        lines = [line for line in (self.folder / "r.csv").read_text().splitlines() if not line.startswith("#")]
        names = lines[0].split(",")
        rows = [[float(cell or "nan") for cell in line.split(",")] for line in lines[1:]]
        files.update(zip(names, map(list, zip(*rows))))
        return files

    def test_wav(self):
        right = self.record("r.wav")
        with wave.open(str(self.folder / "r.wav"), "rb") as file:
            self.assertEqual((file.getnchannels(), file.getsampwidth(), file.getframerate()), (2, 4, 250))
            words = struct.unpack(f"<{2 * file.getnframes()}i", file.readframes(file.getnframes()))
        self.assertEqual([word / 2**31 for word in words[0::2]], right["u"])
        self.assertEqual([word / 2**31 for word in words[1::2]], right["v"])
        said = subprocess.run(["sox", "--info", "r.wav"], cwd=self.folder, capture_output=True, check=True, text=True)
        self.assertEqual(said.stderr, "")
        self.assertIn("32-bit Signed Integer PCM", said.stdout)
        process = self.capsoc("run", "--record", "s.wav", "--record-columns", "u,v,a1")
        self.assertEqual(process.returncode, 2)
        self.assertIn("a WAV file has the channels u and v", process.stderr.decode())
        self.assertFalse((self.folder / "s.wav").exists())

    def check_mat(self, right):
        script = (
            "import sys, json, scipy.io as io\nm = io.loadmat('r.mat')\n"
            "print(json.dumps({k: v.ravel().tolist() for k, v in m.items() if not k.startswith('_')}))"
        )
        said = subprocess.run([PYTHON, "-c", script], cwd=self.folder, capture_output=True, check=True, text=True)
        read = json.loads(said.stdout)
        self.assertEqual(list(read), list(right))
        for name, column in right.items():
            self.assertEqual(repr(read[name]), repr(column), name)

    def test_mat(self):
        self.check_mat(self.record("r.mat"))
        self.check_mat(self.record("r.mat", "--record-columns", "sample,t,u,v,angle_deg,found_deg,a1,status"))

    def test_sds(self):
        right = self.record("r.0.sds")
        data = (self.folder / "r.0.sds").read_bytes()
        self.assertEqual(len(data), 24 * len(right["u"]))
        for k in range(len(right["u"])):
            slot, size, u, v, angle = struct.unpack_from("<IIiid", data, 24 * k)
            self.assertEqual((slot, size), (round(1000 * right["t"][k]), 16))
            self.assertEqual((u / 2**31, v / 2**31, angle), (right["u"][k], right["v"][k], right["angle_deg"][k]))
        meta = (self.folder / "r.sds.yml").read_text()
        self.assertIn("sample-frequency: 250\n  tick-frequency: 1000\n", meta)
        self.assertIn("  - value: u\n    type: int32_t\n    scale: 4.656612873077393e-10\n", meta)
        # Nothing of a run that writes over its own input.
        process = self.capsoc("run", "--sensor", "r.0.sds", "--record", "r.1.sds")
        self.assertEqual(process.returncode, 2)
        self.assertIn("r.sds.yml", process.stderr.decode())

    def test_each_is_a_recording_again(self):
        self.record("r.mat")
        parameters = []
        for name in ("r.csv", "r.wav", "r.mat", "r.0.sds"):
            if name in ("r.wav", "r.0.sds"):
                self.record(name)
            process = self.capsoc(
                "run",
                "--sensor",
                name,
                "-P",
                "demodulation_samples=1500",
                "-P",
                "calibration_samples=0",
                "--uart0",
                "null",
                "--json",
                "r.json",
            )
            self.assertIn(process.returncode, (0, 1), process.stderr.decode())
            parameters.append(
                {n: p["word"] for n, p in json.loads((self.folder / "r.json").read_text())["parameters"].items()}
            )
        self.assertEqual(parameters, parameters[:1] * 4)

    def test_a_sensor_without_a_truth(self):
        (self.folder / "t.csv").write_text("u,v\n" + "0.1,0.2\n" * 10)
        for name in ("r.mat", "r.sds"):
            self.capsoc("run", "--sensor", "t.csv", "--record", name, "--uart0", "null")
        self.assertNotIn(b"angle_deg", (self.folder / "r.mat").read_bytes())
        self.assertNotIn("angle_deg", (self.folder / "r.sds.yml").read_text())
        self.assertEqual((self.folder / "r.sds").stat().st_size, 160)


if __name__ == "__main__":
    unittest.main()
