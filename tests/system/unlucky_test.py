#!/usr/bin/env python3
"""Closed streams, full disks, signals, files that are each other, inputs that are none, and numbers out of range."""

import json
import os
import resource
import shutil
import signal
import subprocess
import time
import unittest
import xml.etree.ElementTree
from pathlib import Path

from harness import BUILD, CAPSOC, CLEAN, Case, FIRMWARE, TRACES

CTEST = {"name": "unlucky"}

HELLO, FOREVER, RDIMON = FIRMWARE / "hello.elf", FIRMWARE / "forever.elf", FIRMWARE / "rdimon.elf"
ITM = FIRMWARE / "itm.elf"
PATIENCE = 120
LOST = 74


class UnluckyCase(Case):
    def start(self, *arguments, **keywords):
        keywords = {
            "stdin": subprocess.DEVNULL,
            "stdout": subprocess.PIPE,
            "stderr": subprocess.PIPE,
            "env": CLEAN,
            "cwd": self.folder,
            **keywords,
        }
        process = subprocess.Popen([CAPSOC, *map(str, arguments)], **keywords)
        self.addCleanup(self.end, process)
        return process

    @staticmethod
    def end(process):
        if process.poll() is None:
            process.kill()
        process.communicate()

    def capsoc(self, *arguments, **keywords):
        """Exit code, stdout and stderr."""
        process = self.start(*arguments, **keywords)
        out, said = process.communicate(timeout=PATIENCE)
        return process.returncode, out, (said or b"").decode()

    def shell(self, command):
        """A command line of a shell, with $capsoc as the program."""
        done = subprocess.run(
            ["bash", "-c", command],
            capture_output=True,
            timeout=PATIENCE,
            check=False,
            cwd=self.folder,
            env={**CLEAN, "capsoc": str(CAPSOC), "hello": str(HELLO), "eq": str(TRACES / "csfn_eq.toml")},
        )
        return done.returncode, done.stdout, done.stderr.decode()

    def names(self):
        return sorted(path.name for path in self.folder.iterdir())

    def refuse(self, *arguments, saying=()):
        before = self.names()
        code, out, said = self.capsoc(*arguments)
        self.assertEqual((code, out), (2, b""), f"{arguments}: {said}")
        self.assertEqual(len(said.strip().splitlines()), 1, f"{arguments}: {said}")
        for words in saying:
            self.assertIn(str(words), said, arguments)
        self.assertEqual(self.names(), before, arguments)


class Streams(UnluckyCase):
    """Standard streams that are closed, full or left."""

    def test_stderr_that_takes_nothing_changes_nothing(self):
        for stream in ("2>&-", "2>/dev/full", "2> >(true)"):
            for command, expected in (
                ("$capsoc run $hello --json r.json", 0),
                ("$capsoc run $hello --json r.json --log-level trace", 0),
                (f"$capsoc run {FIRMWARE}/exit_code.elf --json r.json", 1),
                (f"$capsoc run {FIRMWARE}/divzero.elf --json r.json", 5),
                (f"$capsoc run {FOREVER} --simlimit 0.1 --uart1 tcp --gdb 0 --json r.json", 124),
                (f"$capsoc run {RDIMON} --semihosting-args x --json r.json", None),
            ):
                with self.subTest(stream=stream, command=command):
                    code, _, _ = self.shell(f"{command} {stream}")
                    result = json.loads((self.folder / "r.json").read_text())
                    (self.folder / "r.json").unlink()
                    self.assertEqual(code, result["exit"]["code"])
                    if expected is not None:
                        self.assertEqual(code, expected)
                    self.assertEqual(self.names(), [])

    def test_complaints_keep_their_exit_code_without_stderr(self):
        (self.folder / "few.csv").write_text("u,v\n1,0\n0,1\n")
        for stream in ("2>&-", "2>/dev/full", "2> >(true)"):
            for command, expected in (
                ("$capsoc run none.elf", 2),
                ("$capsoc rum", 2),
                ("$capsoc run --senser x", 2),
                ("$capsoc fit none.csv", 2),
                ("$capsoc fit few.csv", 3),
                ("$capsoc regress --scenario none", 2),
                ("$capsoc bench cpu none.elf", 2),
                ("$capsoc fit $eq --method lm >/dev/null", 0),
                ("$capsoc info >/dev/null", 0),
            ):
                with self.subTest(stream=stream, command=command):
                    self.assertEqual(self.shell(f"{command} {stream}")[0], expected)

    def test_all_streams_closed(self):
        code, _, _ = self.shell("$capsoc run $hello --uart0 file:u --json r.json <&- >&- 2>&-")
        self.assertEqual(code, 0)
        self.assertEqual((self.folder / "u").read_bytes(), b"hello from capsoc\n")
        self.assertEqual(json.loads((self.folder / "r.json").read_text())["exit"]["code"], 0)

    def test_no_file_takes_the_number_of_a_closed_stream(self):
        """What goes to stdout or stderr must not end in a file that was opened later."""
        for closed in (">&-", "2>&-", "<&-", "<&- >&- 2>&-"):
            code, _, _ = self.shell(
                f"$capsoc run $hello --uart1 file:a --trace-bus b -C uart2.log=c --json r.json {closed}"
            )
            self.assertIn(code, (0, LOST))
            self.assertEqual((self.folder / "a").read_bytes(), b"", closed)
            self.assertEqual((self.folder / "c").read_bytes(), b"", closed)
            self.assertNotIn("hello from", (self.folder / "b").read_text(), closed)
            json.loads((self.folder / "r.json").read_text())

    def test_stdout_that_takes_nothing_is_an_error(self):
        printed, uart = "standard output: could not take everything (", "stdout: takes no more bytes ("
        for stream in (">/dev/full", ">&-"):
            for command, sentence in (
                ("info", printed),
                ("--help", printed),
                ("--version", printed),
                ("run --help", printed),
                ("run --list-params", printed),
                ("regress --list", printed),
                ("fit $eq --method lm --json c.json", printed),
                ("run $hello", uart),
                (f"run {ITM} --uart0 null --itm stdout", uart),
            ):
                with self.subTest(stream=stream, command=command):
                    code, _, said = self.shell(f"$capsoc {command} {stream}")
                    self.assertEqual(code, LOST, said)
                    self.assertIn(sentence, said)
        self.assertTrue((self.folder / "c.json").exists(), "what can be written is")

    def test_long_reports_on_a_full_disk(self):
        code, _, said = self.shell(
            "$capsoc regress --scenario pairs --seeds 1 --samples 1 --accesses 1 --arithmetic precise "
            "--json r.json > /dev/full"
        )
        self.assertEqual(code, LOST, said)
        json.loads((self.folder / "r.json").read_text())

    def test_a_worse_end_keeps_its_code(self):
        for program, expected in (("exit_code", 1), ("divzero", 5)):
            code, _, said = self.shell(
                f"$capsoc run {FIRMWARE}/{program}.elf --simlimit 1 -C uart0.log=/dev/full > /dev/full"
            )
            self.assertEqual(code, expected, said)
        code, _, _ = self.shell(f"$capsoc run {FOREVER} --simlimit 0.1 > /dev/full")
        self.assertEqual(code, 124)

    def test_a_reader_that_leaves(self):
        reader, writer = os.pipe()
        os.close(reader)  # before the program starts: a shell's "| true" leaves when it likes
        code = subprocess.run([CAPSOC, "info"], stdout=writer, stderr=subprocess.DEVNULL, check=False).returncode
        os.close(writer)
        self.assertEqual(code, -signal.SIGPIPE)
        os.mkfifo(self.folder / "pipe")
        code, _, said = self.shell(
            "head -c 1 pipe > /dev/null & " f"$capsoc run {FOREVER} --simlimit 0.1 --trace-instructions pipe"
        )
        self.assertEqual(code, 124, said)
        self.assertIn("pipe: cannot be written (Broken pipe)", said)

    def test_a_name_of_a_stream_is_that_stream(self):
        code, out, said = self.shell("$capsoc run $hello --json /dev/fd/1 > out; code=$?; cat out; exit $code")
        self.assertEqual(code, 0, said)
        hello, text = out.split(b"\n", 1)
        self.assertEqual(hello, b"hello from capsoc")
        self.assertEqual(json.loads(text)["exit"]["code"], 0)
        code, out, said = self.shell("ln -s /dev/fd/7 link; $capsoc run $hello --uart0 null --json link 7>&1 | cat")
        self.assertEqual(json.loads(out)["exit"]["code"], 0, said)

    def test_a_dash_is_standard_output_and_no_file(self):
        code, out, said = self.capsoc("run", HELLO, "--uart0", "null", "--json", "-")
        self.assertEqual((code, json.loads(out)["exit"]["code"]), (0, 0), said)
        code, out, said = self.capsoc("fit", TRACES / "csfn_eq.toml", "--method", "lm", "--json", "-")
        self.assertEqual(code, 0, said)
        fitted, _ = json.JSONDecoder().raw_decode(out.decode())  # the table follows
        self.assertEqual(fitted["method"], "lm")
        self.refuse("run", HELLO, "--waves", "-", saying=("-: is no file",))
        self.assertEqual(self.names(), [])


class Disks(UnluckyCase):
    """A disk that is full, by a limit on the size of files; nothing is lost without a word and an exit code."""

    def limited(self, size, *arguments):
        def limit():
            resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))

        return self.capsoc(*arguments, preexec_fn=limit)

    def check(self, saying, *arguments, size=4):
        code, _, said = self.limited(size, *arguments)
        self.assertEqual(code, LOST, f"{arguments}: {said}")
        self.assertIn(saying, said, arguments)
        self.assertFalse([name for name in self.names() if "tmp" in name or "hier" in name], arguments)

    def test_every_output_of_a_run(self):
        for saying, options in (
            ("u: takes no more bytes (File too large)", ("--uart0", "file:u")),
            ("l: takes no more bytes", ("-C", "uart0.log=l")),
            ("r.json: cannot be written (File too large)", ("--json", "r.json")),
            ("i: cannot be written (File too large)", ("--trace-instructions", "i")),
            ("b: cannot be written (File too large)", ("--trace-bus", "b")),
            ("b: cannot be written (File too large)", ("--trace-bus", "b", "-C", "trace.depth=9")),
            ("p: cannot be written (File too large)", ("--profile", "p")),
            ("p.folded: cannot be written (File too large)", ("--profile", "p.folded")),
            ("w.fst: cannot be written", ("--trace-waves", "w.fst")),
            ("w.fst: cannot be written", ("--waves", "w.fst")),
            # Here the library's own temporary files have no room, either.
            ("is full; make room", ("--waves", "w.fst", "--coprocessor", "rtl")),
            ("c.csv: cannot be written (File too large)", ("--record", "c.csv")),
        ):
            with self.subTest(options):
                self.check(saying, "run", HELLO, *options)
        code, _, said = self.limited(4, "run", RDIMON, "--semihosting-console", "file:s")
        self.assertEqual(code, 1, "the program finds no files, which is worse")
        self.assertIn("s: takes no more bytes (File too large)", said)
        self.check("t: takes no more bytes", "run", ITM, "--itm", "file:t")

    def test_waves_that_grow(self):
        for size in (1000, 20_000, 60_000):
            with self.subTest(size=size):
                code, _, said = self.limited(size, "run", "--simlimit", 2, "--uart0", "null", "--trace-waves", "w.fst")
                self.assertEqual(code, 124, said)
                self.assertIn("w.fst: cannot be written", said)
                self.assertEqual(self.names(), [])

    def test_everything_else_is_written(self):
        code, _, said = self.capsoc(
            "run",
            HELLO,
            "-C",
            "uart0.log=/dev/full",
            "--uart1",
            "file:/dev/full",
            "--trace-bus",
            "b",
            "--profile",
            "/dev/full",
            "--record",
            "c.csv",
            "--json",
            "r.json",
        )
        self.assertEqual(code, LOST, said)
        result = json.loads((self.folder / "r.json").read_text())
        self.assertEqual(result["exit"]["code"], LOST)
        self.assertIn("status 0", result["exit"]["reason"])
        self.assertEqual(len(result["lost"]), 2, result["lost"])
        for sentence in result["lost"]:
            self.assertIn(sentence, said)
        self.assertEqual(self.names(), ["b", "c.csv", "r.json"])

    def test_other_commands(self):
        self.check(
            "c.json: cannot be written (File too large)",
            "fit",
            TRACES / "csfn_eq.toml",
            "--method",
            "lm",
            "--json",
            "c.json",
            "--convergence",
            "c.csv",
        )
        self.assertEqual(self.names(), [], "all or nothing")
        short = (
            "regress",
            "--scenario",
            "pairs",
            "--seeds",
            1,
            "--samples",
            1,
            "--accesses",
            1,
            "--arithmetic",
            "precise",
        )
        self.check("r.json: cannot be written (File too large)", *short, "--json", "r.json", "--junit", "/dev/null")
        self.check("j.xml: cannot be written (File too large)", *short, "--junit", "j.xml", size=200)

    def test_what_was_there_stays(self):
        for name in ("r.json", "b", "c.csv", "w.fst"):
            (self.folder / name).write_text("old")
        self.check(
            "r.json", "run", HELLO, "--json", "r.json", "--trace-bus", "b", "--record", "c.csv", "--waves", "w.fst"
        )
        for name in ("r.json", "b", "c.csv", "w.fst"):
            self.assertEqual((self.folder / name).read_text(), "old", name)


class Signals(UnluckyCase):
    """Every signal that ends a program ends it with 128 + n and leaves nothing half-made."""

    ENDING = (signal.SIGHUP, signal.SIGINT, signal.SIGQUIT, signal.SIGTERM)

    def wait_for(self, condition):
        until = time.monotonic() + PATIENCE
        while not condition():
            self.assertLess(time.monotonic(), until)
            time.sleep(0.02)

    def wait_until_caught(self, process, number):
        """Before the program has asked for it, a signal ends it as any other."""

        def caught():
            status = Path(f"/proc/{process.pid}/status").read_text()
            return int(status.split("SigCgt:")[1].split()[0], 16) >> (number - 1) & 1

        self.wait_for(caught)

    def is_gone(self, child):
        try:
            return "Z" in Path(f"/proc/{child}/stat").read_text().rsplit(")", 1)[1].split()[0]
        except (FileNotFoundError, ProcessLookupError):
            return True

    def test_a_run_writes_what_it_has(self):
        for number in self.ENDING:
            process = self.start(
                "run",
                FOREVER,
                "--uart0",
                "file:u",
                "--json",
                "r.json",
                "--trace-instructions",
                "i",
                "-C",
                "trace.depth=9",
                "--record",
                "c.csv",
                "--waves",
                "w.fst",
                "--uart1",
                "pty:link",
            )
            self.wait_for(lambda: (self.folder / "u").exists() and (self.folder / "u").stat().st_size > 0)
            process.send_signal(number)
            self.assertEqual(process.wait(PATIENCE), 128 + number)
            result = json.loads((self.folder / "r.json").read_text())
            self.assertEqual(result["exit"], {"code": 128 + number, "reason": f"ended by signal {int(number)}"})
            self.assertEqual(self.names(), ["c.csv", "i", "r.json", "u", "w.fst", "w.gtkw"])
            for name in self.names():
                (self.folder / name).unlink()

    def test_signals_of_a_closing_terminal(self):
        process = self.start("run", FOREVER, "--uart0", "file:u", "--json", "r.json")
        self.wait_for(lambda: (self.folder / "u").exists() and (self.folder / "u").stat().st_size > 0)
        for number in (signal.SIGHUP, signal.SIGCONT, signal.SIGHUP):
            process.send_signal(number)
        self.assertEqual(process.wait(PATIENCE), 128 + signal.SIGHUP)
        self.assertEqual(self.names(), ["r.json", "u"])

    def test_what_was_ignored_stays_ignored(self):
        for number in (signal.SIGHUP, signal.SIGINT, signal.SIGQUIT):
            process = self.start(
                "run",
                FOREVER,
                "--uart0",
                "file:u",
                "--json",
                "r.json",
                "--timelimit",
                100,
                preexec_fn=lambda n=number: signal.signal(n, signal.SIG_IGN),
            )
            self.wait_for(lambda: (self.folder / "u").exists() and (self.folder / "u").stat().st_size > 0)
            process.send_signal(number)
            with self.assertRaises(subprocess.TimeoutExpired):
                process.wait(0.5)
            process.send_signal(signal.SIGTERM)
            self.assertEqual(process.wait(PATIENCE), 128 + signal.SIGTERM)
            (self.folder / "u").unlink()

    def test_a_bench_takes_its_folder_and_its_child_with_it(self):
        for number in self.ENDING:
            process = self.start("bench", "cpu", FOREVER, env={**CLEAN, "TMPDIR": str(self.folder)})
            self.wait_for(lambda: list(self.folder.glob("capsoc-bench-*/stdout")))
            children = Path(f"/proc/{process.pid}/task/{process.pid}/children")
            self.wait_for(lambda: children.read_text().split())
            child = children.read_text().split()[0]
            process.send_signal(number)
            self.assertEqual(process.wait(PATIENCE), 128 + number)
            self.wait_for(lambda: self.is_gone(child))
            self.assertEqual(self.names(), [])

    def test_other_commands_leave_nothing(self):
        for command in (
            ("fit", TRACES / "soc_eq21.toml", "--samples", 20_000_000, "--json", "c.json", "--header", "c.h"),
            ("reproduce",),
            ("accuracy",),
            ("fit", "--tables"),
        ):
            process = self.start(*command)
            self.wait_until_caught(process, signal.SIGHUP)
            time.sleep(0.7)
            process.send_signal(signal.SIGHUP)
            self.assertEqual(process.wait(PATIENCE), 128 + signal.SIGHUP, command)
            self.assertEqual(self.names(), [], command)

    def test_a_regression_leaves_whole_reports_that_say_how_far_it_came(self):
        for number in self.ENDING:
            process = self.start(
                "regress",
                "--samples",
                100_000_000,
                "--json",
                "r.json",
                "--junit",
                "j.xml",
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
            )
            self.wait_until_caught(process, number)
            time.sleep(0.7)
            process.send_signal(number)
            self.assertEqual(process.wait(PATIENCE), 128 + number)
            self.assertEqual(self.names(), ["j.xml", "r.json"])
            partial = json.loads((self.folder / "r.json").read_text())["partial"]
            self.assertLess(partial["done"], partial["of"])
            suites = xml.etree.ElementTree.parse(self.folder / "j.xml").getroot().findall("testsuite")
            self.assertEqual(sum(int(suite.get("skipped")) for suite in suites), partial["of"] - partial["done"])
            for name in self.names():
                (self.folder / name).unlink()


class Conflicts(UnluckyCase):
    """No output is an input or another output, whatever they are called."""

    def setUp(self):
        super().setUp()
        for name in ("x.elf", "y.elf"):
            shutil.copy(HELLO, self.folder / name)
        shutil.copy(TRACES / "recorded_example.csv", self.folder / "x.csv")
        shutil.copy(TRACES / "csfn_eq.toml", self.folder / "x.toml")
        (self.folder / "c.toml").write_text("[cpu]\nquantum_ns = 1000\n")
        (self.folder / "in.txt").write_text("bytes")
        self.before = {name: (self.folder / name).read_bytes() for name in self.names()}

    def tearDown(self):
        for name, contents in self.before.items():
            self.assertEqual((self.folder / name).read_bytes(), contents, name)

    INPUTS = {
        "ELF": "x.elf",
        "--sensor": "x.csv",
        "--config": "c.toml",
        "--load": "y.elf@0x21000000",
        "-C uart3.input": "in.txt",
        "--parameters": "p.json",
        "--rtl-library": "x.so",
    }
    OUTPUTS = {
        "--json": "{}",
        "--record": "{}",
        "--waves": "{}",
        "--trace-instructions": "{}",
        "--trace-bus": "{}",
        "--trace-waves": "{}",
        "--profile": "{}",
        "--uart1": "file:{}",
        "--uart2": "pty:{}",
        "-C uart4.log": "{}",
        "--itm": "file:{}",
        "--semihosting-console": "file:{}",
    }

    @staticmethod
    def option(name, value):
        if name == "ELF":
            return [value]
        return ["-C", f"{name[3:]}={value}"] if name.startswith("-C ") else [name, value]

    @staticmethod
    def word(name):
        return name[3:] if name.startswith("-C ") else name

    def test_every_output_against_every_input(self):
        for name in ("p.json", "x.so"):
            (self.folder / name).write_text("{}")
            self.before[name] = b"{}"
        for source, value in self.INPUTS.items():
            for target, form in self.OUTPUTS.items():
                file = value.split("@")[0]
                given = self.option(source, value) + self.option(target, form.format(file))
                more = [] if source == "ELF" else ["x.elf"] if source != "--parameters" else []
                more += ["--coprocessor", "rtl"] if source == "--rtl-library" else []
                self.refuse("run", *more, *given, saying=(self.word(target), self.word(source), file, "the same file"))

    def test_every_output_against_every_other(self):
        targets = list(self.OUTPUTS.items())
        for i, (one, form) in enumerate(targets):
            for other, other_form in targets[i + 1 :]:
                for file in ("new.fst", "x.txt"):
                    (self.folder / "x.txt").write_text("old")
                    self.before["x.txt"] = b"old"
                    self.refuse(
                        "run",
                        "x.elf",
                        *self.option(one, form.format(file)),
                        *self.option(other, other_form.format(file)),
                        saying=(self.word(one), self.word(other), file, "the same file"),
                    )

    def test_one_file_by_many_names(self):
        os.link(self.folder / "x.csv", self.folder / "hard.csv")
        (self.folder / "soft.csv").symlink_to("x.csv")
        (self.folder / "soft2.csv").symlink_to(self.folder / "soft.csv")
        (self.folder / "folder").symlink_to(".")
        (self.folder / "dangling").symlink_to("folder/new")
        for name in (
            "x.csv",
            "./x.csv",
            f"{self.folder}/x.csv",
            "folder/x.csv",
            "hard.csv",
            "soft.csv",
            "soft2.csv",
            f"../{self.folder.name}/x.csv",
        ):
            self.refuse("fit", "x.csv", "--json", name, saying=("--json", "TRACE", name))
            self.refuse("run", "x.elf", "--sensor", name, "--record", "x.csv", saying=("--sensor", "--record", name))
        for one, other in (
            ("new", "./new"),
            ("new", "folder/new"),
            ("dangling", "new"),
            ("folder/dangling", "dangling"),
        ):
            self.refuse("fit", "x.toml", "--json", one, "--header", other, saying=("--json", "--header", one, other))
            self.refuse("run", "x.elf", "--json", one, "--uart1", f"file:{other}", saying=("--json", "--uart1"))

    def test_fit(self):
        for option in ("--json", "--header", "--convergence"):
            self.refuse("fit", "x.toml", option, "x.toml", saying=(option, "TRACE x.toml"))
        self.refuse("fit", "x.toml", "--json", "s", "--header", "s", saying=("--json s", "--header s"))
        self.refuse("fit", "x.toml", "--json", "s", "--convergence", "s", saying=("--json s", "--convergence s"))
        self.refuse("fit", "x.toml", "--convergence", "calibration.h", saying=("--header", "--convergence"))

    def test_regress(self):
        common = ("regress", "--arithmetic", "precise")
        self.refuse(*common, "--json", "s", "--junit", "s", saying=("--json", "--junit"))
        self.refuse(*common, "--json", BUILD / "libcapsoc_rtl_precise.so", saying=("--json", "--rtl-library"))
        self.refuse(*common, "--rtl-library", "x.elf", "--junit", "x.elf", saying=("--junit", "--rtl-library"))
        (self.folder / "e").write_text("")
        self.refuse(
            *common,
            "--coverage",
            ".",
            "--coverage-exceptions",
            "e",
            "--junit",
            "e",
            saying=("--junit", "--coverage-exceptions"),
        )
        self.refuse(
            *common,
            "--coverage",
            ".",
            "--coverage-exceptions",
            "e",
            "--json",
            "precise.dat",
            saying=("--json", "--coverage"),
        )

    def test_files_that_no_option_names(self):
        self.refuse("run", "x.elf", "--trace-waves", "w.fst", "--json", "w.gtkw", saying=("--json", "save file"))
        self.refuse(
            "run", "x.elf", "--coprocessor", "lockstep", "--json", "lockstep.fst", saying=("--json", "lockstep")
        )
        self.refuse("run", "--json", FIRMWARE / "selfcal.elf", saying=("--json", "firmware.elf"))
        code, _, said = self.shell("$capsoc run x.elf --json out > out")
        self.assertEqual(code, 2, said)
        self.assertIn("--json out and standard output are the same file", said)
        code, _, said = self.shell("$capsoc run x.elf --uart1 file:out 2>> out; code=$?; cat out >&2; exit $code")
        self.assertEqual(code, 2)
        self.assertIn("standard error", said)
        code, _, said = self.shell("$capsoc run x.elf --uart0 stdio --json in.txt < in.txt")
        self.assertEqual(code, 2)
        self.assertIn("standard input", said)

    def test_settings_from_elsewhere(self):
        (self.folder / "c.toml").write_text("[results]\njson = 'x.elf'\n")
        self.before["c.toml"] = (self.folder / "c.toml").read_bytes()
        self.refuse("run", "x.elf", "--config", "c.toml", saying=("results.json x.elf", "ELF x.elf"))
        code, _, said = self.capsoc("run", "x.elf", env={**CLEAN, "CAPSOC_RESULTS_JSON": "x.elf"})
        self.assertEqual(code, 2, said)

    def test_a_run_that_is_refused_changes_no_file(self):
        for name in ("u", "l", "t", "s"):
            (self.folder / name).write_text("old")
            self.before[name] = b"old"
        files = (
            "--uart0",
            "file:u",
            "-C",
            "uart1.log=l",
            "--itm",
            "file:t",
            "--semihosting-console",
            "file:s",
            "--uart1",
            "file:new",
            "-C",
            "uart2.log=new2",
        )
        for wrong in (("--uart4", "tcp:99999"), ("--uart4", "file:/nonexistent/x"), ("--until-uart", "("), ("--halt",)):
            self.refuse("run", "x.elf", *files, *wrong)
        self.refuse("run", "x.elf", "--waves", "a.fst", "--trace-waves", "b.fst", saying=("--waves", "--trace-waves"))
        code, _, said = self.capsoc("run", "x.elf", *files)
        self.assertEqual(code, 0, said)
        for name, contents in (
            ("u", b"hello from capsoc\n"),
            ("l", b""),
            ("t", b""),
            ("s", b""),
            ("new", b""),
            ("new2", b""),
        ):
            self.assertEqual((self.folder / name).read_bytes(), contents, name)
            self.before.pop(name, None)

    def test_what_is_no_conflict(self):
        code, _, said = self.capsoc(
            "run",
            "x.elf",
            "--json",
            "/dev/null",
            "--record",
            "/dev/null",
            "--uart1",
            "file:/dev/null",
            "-C",
            "uart1.log=/dev/null",
            "--trace-bus",
            "/dev/null",
        )
        self.assertEqual(code, 0, said)
        code, _, said = self.shell("$capsoc run x.elf --load x.elf --json out2 > out 2>&1")
        self.assertEqual(code, 0, said)
        self.assertTrue(Path("/dev/null").is_char_device())

    def test_a_link_stays_a_link(self):
        (self.folder / "link.json").symlink_to("real.json")
        self.assertEqual(self.capsoc("run", "x.elf", "--json", "link.json")[0], 0)
        self.assertTrue((self.folder / "link.json").is_symlink())
        self.assertEqual(json.loads((self.folder / "real.json").read_text())["exit"]["code"], 0)

    def test_waves_never_replace_a_pipe_or_a_device(self):
        """GTKWave's library removes what it finds."""
        os.mkfifo(self.folder / "pipe")
        for kind in ("tlm", "rtl", "lockstep"):
            self.refuse("run", "x.elf", "--coprocessor", kind, "--waves", "pipe", saying=("pipe: is no file",))
        self.assertTrue((self.folder / "pipe").is_fifo())


class FitFiles(UnluckyCase):
    """Which files `capsoc fit` writes."""

    def test_only_what_was_named(self):
        common = ("fit", TRACES / "csfn_eq.toml", "--method", "lm")
        for options, written in (
            ((), ["calibration.h", "calibration.json"]),
            (("--json", "a"), ["a"]),
            (("--header", "b"), ["b"]),
            (("--json", "a", "--header", "b"), ["a", "b"]),
            (("--convergence", "c"), ["c", "calibration.h", "calibration.json"]),
        ):
            code, out, said = self.capsoc(*common, *options)
            self.assertEqual(code, 0, said)
            self.assertEqual(self.names(), written)
            for name in written:
                self.assertIn(f"wrote        {name}\n".encode(), out)
                (self.folder / name).unlink()
        self.refuse(*common, "--json", "", saying=("--json",))

    def test_samples_that_tell_no_sensor(self):
        line = "".join(f"{0.01 * i},{0.005 * i}\n" for i in range(50))
        for text in (
            "u,v\n0.1,0.2\n",
            "u,v\n" + "".join(f"{0.1 * i},{0.2 - 0.1 * i * i}\n" for i in range(4)),
            "u,v\n" + "0.1,0.2\n0.3,0.1\n-0.2,0.3\n0.1,-0.3\n" * 50,
            "u,v\n" + "0.1,0.2\n" * 50,
            "u,v\n" + line,
        ):
            (self.folder / "r.csv").write_text(text)
            code, out, said = self.capsoc("fit", "r.csv")
            self.assertEqual((code, out), (3, b""), said)
            self.assertEqual(len(said.splitlines()), 1, said)
            self.assertEqual(said[:15], "capsoc: r.csv: ")
            self.assertEqual(self.names(), ["r.csv"])


class Inputs(UnluckyCase):
    """Every option that reads a file, with things that are none."""

    def setUp(self):
        super().setUp()
        (self.folder / "p.json").write_text("{}")

    READERS = {
        "ELF": (("run", "{}"), ".elf"),
        "--sensor": (("run", HELLO, "--sensor", "{}"), ".toml"),
        "--sensor (CSV)": (("run", HELLO, "--sensor", "{}"), ".csv"),
        "--config": (("run", "--config", "{}"), ".toml"),
        "--parameters": (("run", "--parameters", "{}"), ".toml"),
        "--load": (("run", HELLO, "--load", "{}"), ""),
        "--load @": (("run", HELLO, "--load", "{}@0x21000000"), ""),
        "uart input": (("run", HELLO, "-C", "uart1.input={}"), ""),
        "--rtl-library": (("run", HELLO, "--coprocessor", "rtl", "--rtl-library", "{}"), ".so"),
        "fit": (("fit", "{}"), ".csv"),
        "fit (TOML)": (("fit", "{}"), ".toml"),
        "bench": (("bench", "cpu", "{}"), ".elf"),
        "regress": (("regress", "--arithmetic", "paper", "--rtl-library", "{}"), ".so"),
        "exceptions": (("regress", "--coverage", ".", "--coverage-exceptions", "{}"), ".txt"),
        "semihosting": (("run", HELLO, "--semihosting-dir", "{}"), ""),
    }

    def each(self, make, but=()):
        for name, (command, suffix) in self.READERS.items():
            if name in but:
                continue
            path = self.folder / f"input{suffix}"
            make(path)
            with self.subTest(name):
                self.refuse(*(str(word).format(path) for word in command), saying=(path,))
            if path.is_dir() and not path.is_symlink():
                path.rmdir()
            else:
                path.unlink()

    def test_a_directory(self):
        self.each(lambda path: path.mkdir(), but=("semihosting",))

    def test_a_pipe_that_nobody_writes_to(self):
        self.each(os.mkfifo)

    def test_a_device_without_an_end(self):
        self.each(lambda path: path.symlink_to("/dev/zero"))

    def test_nothing_there(self):
        for name, (command, suffix) in self.READERS.items():
            path = self.folder / f"none{suffix}"
            with self.subTest(name):
                self.refuse(*(str(word).format(path) for word in command), saying=(path,))

    def test_an_empty_file(self):
        # No bytes for a UART and no exceptions are valid inputs.
        self.each(lambda path: path.write_bytes(b""), but=("uart input", "exceptions"))

    def test_bytes_that_are_zero(self):
        # For a UART and as a raw image they are bytes like others.
        self.each(lambda path: path.write_bytes(bytes(1000)), but=("uart input", "--load @"))

    def test_a_file_that_may_not_be_read(self):
        """Root may read everything, so this is tried as another user."""
        other = 65534
        self.folder.chmod(0o755)

        def make(path):
            path.write_text("secret")
            path.chmod(0)

        if os.geteuid() != 0:
            return self.each(make, but=("semihosting",))
        # Other users may have no access to the folder of the build.
        program = self.folder / "program"
        (program / "firmware").mkdir(parents=True)
        shutil.copy(CAPSOC, program / "capsoc")
        for name in (HELLO.name, "selfcal.elf", "calibrate.elf"):
            shutil.copy(FIRMWARE / name, program / "firmware" / name)
        shutil.copytree(TRACES, program / "traces")
        self.folder.chmod(0o777)
        for name, (command, suffix) in self.READERS.items():
            if name in ("semihosting",):
                continue
            path = self.folder / f"input{suffix}"
            make(path)
            words = [
                str(word).format(path).replace(str(HELLO), str(program / "firmware" / HELLO.name)) for word in command
            ]
            done = subprocess.run(
                [program / "capsoc", *words],
                capture_output=True,
                timeout=PATIENCE,
                check=False,
                env=CLEAN,
                cwd=self.folder,
                user=other,
                group=other,
                extra_groups=[],
            )
            said = done.stderr.decode()
            with self.subTest(name):
                self.assertEqual(done.returncode, 2, said)
                self.assertIn(f"{path}: cannot be read (Permission denied)", said)
            path.unlink()
        return None


class Numbers(UnluckyCase):
    """Every number has its range, and nothing that is no number becomes one."""

    def test_every_option_of_every_command(self):
        eq = TRACES / "csfn_eq.toml"
        wrong = ("-5", "-1", "nan", "inf", "1e999", "", " 1", "1x", "99999999999999999999999", "-18446744073709551615")
        whole = ("1.5", "0x", "1e3")
        for command, option, more in (
            (("fit", eq), "--harmonics", (*whole, "4")),
            (("fit", eq), "--batch", (*whole, "0")),
            (("fit", eq), "--rate", ("0", "2")),
            (("fit", eq), "--iterations", (*whole, "0")),
            (("fit", eq), "--seed", whole),
            (("fit", eq), "--samples", (*whole, "0")),
            (("fit", eq), "--adc-bits", (*whole, "11", "33")),
            (("regress",), "--seeds", (*whole, "0")),
            (("regress",), "--first-seed", whole),
            (("regress",), "--samples", whole),
            (("regress",), "--accesses", whole),
            (("regress",), "--jobs", (*whole, "0", "1025")),
            (("bench", "cpu"), "--repeat", (*whole, "0")),
            (("bench", "cpu"), "--quantum", ("0",)),
            (("bench", "cpu"), "--require", ()),
            (("run", HELLO), "--quantum", ("0",)),
            (("run", HELLO), "--simlimit", ()),
            (("run", HELLO), "--timelimit", ()),
            (("run", HELLO), "--vector-table", ("0x40000000", "0x81", "1.5")),
        ):
            for value in (*wrong, *more):
                with self.subTest(command=command, option=option, value=value):
                    self.refuse(*command, f"{option}={value}")

    def test_every_number_of_the_settings(self):
        listed = self.capsoc("run", "--list-params")[1].decode()
        self.assertIn("cpu.quantum_ns", listed)
        for setting, values in (
            ("sensor.adc_bits", ("-1", "33", "11")),
            ("itm.port", ("-1", "32")),
            ("trace.depth", ("-1", "1e8", "1.5")),
            ("semihosting.epoch_s", ("-1",)),
            ("gdb.port", ("-2", "65536")),
            ("cpu.quantum_ns", ("0", "1e10", "nan")),
            ("memory.psram.wait_states", ("-1", "201", "1.5")),
        ):
            for value in values:
                with self.subTest(setting=setting, value=value):
                    self.refuse("run", HELLO, "-C", f"{setting}={value}", saying=(setting,))

    def test_decimal_is_decimal(self):
        code, out, said = self.capsoc(
            "fit", TRACES / "csfn_eq.toml", "--method", "lm", "--samples", "0100", "--json", "c"
        )
        self.assertEqual(code, 0, said)
        self.assertEqual(json.loads((self.folder / "c").read_text())["samples"], 100)

    def test_the_speed_is_said_as_it_is(self):
        self.assertNotIn("(0 times", self.capsoc("run", HELLO)[2])
        said = self.capsoc("run", HELLO, "--trace-instructions", "/dev/null", "--trace-waves", "w.fst")[2]
        self.assertNotIn("(0 times", said)
        self.assertNotIn("0.00 s", said)
        self.assertNotIn(" 0.0 simulated", said)


if __name__ == "__main__":
    unittest.main()
