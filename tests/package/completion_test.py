#!/usr/bin/env python3
"""The man pages and completions that the build makes: what the shells complete with them."""

import os
import pty
import re
import select
import subprocess
import time
import unittest

from harness import BUILD, CAPSOC, Case

CTEST = {"name": "package: completion", "whole": True}

SHARE = BUILD / "generated" / "share"
BASH = SHARE / "bash-completion/completions/capsoc"
ZSH = SHARE / "zsh/site-functions/_capsoc"
FISH = SHARE / "fish/vendor_completions.d/capsoc.fish"
CLEAN = {k: v for k, v in os.environ.items() if not k.startswith("CAPSOC_")} | {"LC_ALL": "C.UTF-8", "TERM": "dumb"}

CAMPAIGN = ("check", "run", "resume", "report", "merge", "export", "slurm")

# What is typed, and what the line must be after the Tab key, in a folder with the files below.
FILES = ["trace_of_mine.csv", "program.elf", "library.so", "folder/waves.fst"]
LINES = {
    "capsoc regr": "regress",
    "capsoc bench c": "bench cpu",
    "capsoc run --arithm": "run --arithmetic",
    "capsoc run --coprocessor lo": "run --coprocessor lockstep",
    "capsoc fit --method hey": "fit --method heydemann",
    "capsoc regress --arithmetic bo": "regress --arithmetic both",
    "capsoc run -C coprocessor.arith": "run -C coprocessor.arithmetic=",
    "capsoc run -C coprocessor.arithmetic=pa": "run -C coprocessor.arithmetic=paper",
    "capsoc run -C run.golden=t": "run -C run.golden=true",
    "capsoc run -C sensor.file=trace_": "run -C sensor.file=trace_of_mine.csv",
    "capsoc run --sensor trace_": "run --sensor trace_of_mine.csv",
    "capsoc run --sensor=trace_": "run --sensor=trace_of_mine.csv",
    "capsoc run --itm fi": "run --itm file:",
    "capsoc run prog": "run program.elf",
    "capsoc fit --method adam trace_": "fit --method adam trace_of_mine.csv",
    "capsoc run --quantum 100 --coprocessor lo": "run --quantum 100 --coprocessor lockstep",
}


def output_of(*command, **options):
    return subprocess.run(
        [*map(str, command)], capture_output=True, text=True, timeout=60, check=True, env=CLEAN, **options
    ).stdout


class Terminal:
    """A shell on its own terminal, in which capsoc is a function that prints its arguments."""

    def __init__(self, folder, *command):
        self.child, self.descriptor = pty.fork()
        if self.child == 0:
            os.chdir(folder)
            os.execvpe(command[0], command, CLEAN)

    def send(self, text):
        os.write(self.descriptor, text.encode())

    def read_to(self, pattern, seconds=30):
        """What was printed up to the first match of the pattern."""
        text, end = "", time.monotonic() + seconds
        while time.monotonic() < end:
            if select.select([self.descriptor], [], [], 0.2)[0]:
                try:
                    text += os.read(self.descriptor, 65536).decode(errors="replace")
                except OSError:
                    break
            if match := re.search(pattern, text):
                return match
        raise AssertionError(f"no {pattern} in {text!r}")

    def close(self):
        os.close(self.descriptor)
        os.waitpid(self.child, 0)


class Completion(Case):
    def setUp(self):
        super().setUp()
        for name in FILES:
            (self.folder / name).parent.mkdir(exist_ok=True)
            (self.folder / name).touch()

    def on_a_terminal(self, set_up, *shell):
        terminal = Terminal(self.folder, *shell)
        self.addCleanup(terminal.close)
        terminal.send(set_up + "; echo read''y\n")
        terminal.read_to("ready")
        for typed, expected in LINES.items():
            with self.subTest(typed):
                terminal.send(f"{typed}\t\n")
                # Some add a blank after a whole word, which the shell drops.
                self.assertEqual(terminal.read_to(r"RAN<([^>\r\n]*)>")[1].strip(), expected)

    def test_bash(self):
        self.on_a_terminal(
            f"PS1='> '; capsoc() {{ echo \"RAN<$*>\"; }}; source {BASH}", "bash", "--norc", "--noprofile", "-i"
        )

    def test_zsh(self):
        self.on_a_terminal(
            f"PS1='> '; capsoc() {{ print \"RAN<$*>\" }}; fpath=({ZSH.parent} $fpath); autoload -Uz compinit; "
            f"compinit -u -d {self.folder}/dump",
            "zsh",
            "-f",
            "-i",
        )

    def test_fish(self):
        for typed, expected in LINES.items():
            with self.subTest(typed):
                script = f"source {FISH}; complete -C {typed!r}"
                found = output_of("fish", "--no-config", "-c", script, cwd=self.folder).splitlines()
                self.assertIn(expected.split()[-1], [line.split("\t")[0] for line in found])

    def test_options_of_one_command_are_not_offered_for_another(self):
        bash = output_of("bash", "-c", f"source {BASH}; _capsoc_options 'capsoc fit'")
        self.assertIn("--method", bash)
        self.assertNotIn("--sensor", bash)
        fish = output_of("fish", "--no-config", "-c", f"source {FISH}; complete -C 'capsoc fit --'")
        self.assertIn("--method", fish)
        self.assertNotIn("--sensor", fish)

    def test_what_the_program_lists_is_completed(self):
        """There is no second list to maintain: every setting and every option of the help is there."""
        settings = output_of(CAPSOC, "run", "--list-params").splitlines()
        # program.NAME and the like stand for what the program or the sensor has.
        paths = {line.split()[0] for line in settings if not line.split()[0].endswith(".NAME")}
        self.assertEqual(paths, set(output_of("bash", "-c", f"source {BASH}; _capsoc_settings").split()))
        for command in ("run", "fit", "regress", "bench cpu"):
            words = output_of(CAPSOC, *command.split(), "--help")
            options = set(re.findall(r"^  (?:-\w,)?(--?[\w-]+)", words, re.MULTILINE))
            known = set(output_of("bash", "-c", f"source {BASH}; _capsoc_options 'capsoc {command}'").split())
            self.assertGreater(len(options), 3)
            self.assertLessEqual(options, known, command)
            manual = (SHARE / "man/man1" / f"capsoc-{command.replace(' ', '-')}.1").read_text().replace("\\-", "-")
            for option in known | (paths if command == "run" else set()):
                self.assertIn(f"\\fB{option}\\fR", manual)


class Manual(unittest.TestCase):
    def test_there_is_a_page_for_every_command(self):
        commands = output_of("bash", "-c", f"source {BASH}; _capsoc_commands capsoc").split()
        pages = {page.stem for page in (SHARE / "man/man1").iterdir()}
        self.assertEqual(
            pages,
            {
                "capsoc",
                "capsoc-bench-cpu",
                *(f"capsoc-campaign-{command}" for command in CAMPAIGN),
                *(f"capsoc-{command}" for command in commands),
            },
        )
        self.assertNotIn("capsoc-generate", pages)

    def test_pages_render_without_a_warning(self):
        for page in (SHARE / "man/man1").iterdir():
            groff = subprocess.run(
                ["groff", "-man", "-Tutf8", "-ww", "-z", page], capture_output=True, text=True, check=True
            )
            self.assertEqual(groff.stderr, "", page)
            man = subprocess.run(
                ["man", "--warnings", "-l", page], capture_output=True, text=True, check=True, env=CLEAN
            )
            self.assertEqual(man.stderr, "", page)
            self.assertRegex(man.stdout, r"(?s)NAME.*SYNOPSIS.*DESCRIPTION.*EXIT STATUS.*SEE ALSO")

    def test_a_page_reads_as_the_help(self):
        page = output_of("man", "-l", SHARE / "man/man1/capsoc-run.1")
        text = " ".join(re.sub(r".\x08", "", page).split())
        for part in (
            "--coprocessor tlm|rtl|lockstep The model, the Verilated RTL, or both compared",
            "-C PATH=VALUE Set any setting. May be repeated.",
            "coprocessor.arithmetic=paper|precise paper or precise. Built-in: precise.",
            "128+n ended by signal n",
        ):
            self.assertIn(part, text)

    def test_no_path_of_the_build_is_in_them(self):
        for page in SHARE.glob("**/*"):
            if page.is_file():
                self.assertNotIn(str(BUILD), page.read_text(), page)


if __name__ == "__main__":
    unittest.main()
