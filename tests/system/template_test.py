#!/usr/bin/env python3
"""A project that `capsoc new` made outside the tree, built both ways, run and debugged."""

import json
import os
import re
import shlex
import subprocess
import unittest
from pathlib import Path

from harness import BUILD, CAPSOC, Case, SOURCE

CTEST = {"name": "system: Template", "whole": True, "timeout": 300}

PRINTED = "hello\nangle: 30.0000 degrees\n"
CLEAN = {k: v for k, v in os.environ.items() if not k.startswith("CAPSOC_") and k not in ("CFLAGS", "MAKEFLAGS")}


class Template(Case):
    def setUp(self):
        super().setUp()
        self.app = self.folder / "app"
        self.new(self.app)

    def new(self, *arguments, code=0):
        done = subprocess.run(
            [CAPSOC, "new", *map(str, arguments)], capture_output=True, text=True, check=False, env=CLEAN
        )
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        return done.stderr

    def do(self, *command):
        done = subprocess.run(
            command, cwd=self.app, capture_output=True, text=True, timeout=300, check=False, env=CLEAN
        )
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done.stdout

    def test_make(self):
        files = {p for p in self.app.glob("**/*")}
        self.do("make", "-j4", f"CAPSOC={BUILD}")
        self.assertEqual(self.do("make", "-s", f"CAPSOC={BUILD}", "run"), PRINTED)
        self.do("make", f"CAPSOC={BUILD}", "clean")
        self.assertEqual({p for p in self.app.glob("**/*")}, files)

    def test_cmake(self):
        self.do("cmake", "-B", "build", "--toolchain", "toolchain.cmake", f"-DCAPSOC={BUILD}")
        self.do("cmake", "--build", "build", "-j4")
        self.assertEqual(self.do(CAPSOC, "run", "build/app.elf"), PRINTED)
        self.assertIn(PRINTED, self.do("cmake", "--build", "build", "--target", "run"))

    def test_folders_of_any_name(self):
        for name in ("my app (copy)", "it's mine", "größe 日本", "a & b", "[old], 100 % = done"):
            self.app = self.folder / name
            said = self.new(self.app)
            command = re.fullmatch(r".*: a project that prints; build and run it with: (.*)\n", said)[1]
            shown = subprocess.run(
                command.replace("make ", f"make -s CAPSOC={shlex.quote(str(BUILD))} ", 1),
                shell=True,
                capture_output=True,
                text=True,
                check=False,
                env=CLEAN,
            )
            self.assertEqual((shown.returncode, shown.stdout), (0, PRINTED), shown.stderr)
            self.do("cmake", "-B", "build", "--toolchain", "toolchain.cmake", f"-DCAPSOC={BUILD}")
            self.assertIn(PRINTED, self.do("cmake", "--build", "build", "-j4", "--target", "run"))
            # The coverage of a project in such a folder has its sources.
            for elf in ("app.elf", "build/app.elf"):
                self.do(CAPSOC, "run", elf, "--coverage", "c.info")
                self.assertIn(f"SF:{self.app}/main.c\n", (self.app / "c.info").read_text())
                (self.app / "c.info").unlink()

    def test_without_warnings(self):
        done = subprocess.run(["make", "-j4"], cwd=self.app, capture_output=True, text=True, check=False, env=CLEAN)
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_newlib_is_there(self):
        (self.app / "main.c").write_text(
            """#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
int main(void) {
  char* text = malloc(100000);
  memset(text, 'x', 99999);
  printf("%.3f %g %lu\\n", 2.0 / 3, 1e-300, (unsigned long)strlen(text));
  free(text);
  text = malloc(100u << 20);
  printf("%s\\n", text == NULL ? "no more" : "too much");
  return 7;
}
""".replace(
                "\\\\", "\\"
            )
        )
        self.do("make", "-j4", f"CAPSOC={BUILD}")
        done = subprocess.run(
            [CAPSOC, "run", "app.elf"], cwd=self.app, capture_output=True, text=True, check=False, env=CLEAN
        )
        self.assertEqual(done.stdout, "0.667 1e-300 99999\nno more\n")
        self.assertIn("ended with status 7", done.stderr)

    def test_a_failure_is_told_with_its_own_lines(self):
        (self.app / "main.c").write_text("int main(void) {\n  *(volatile int*)0x60000000 = 1;\n  return 0;\n}\n")
        self.do("make", "-j4", f"CAPSOC={BUILD}")
        done = subprocess.run(
            [CAPSOC, "run", "app.elf"], cwd=self.app, capture_output=True, text=True, check=False, env=CLEAN
        )
        self.assertEqual(done.returncode, 5)
        self.assertRegex(done.stderr, r"by +0x[0-9a-f]{8}  main\S*, \S*main.c:2,")

    def test_what_an_ide_reads_is_json(self):
        for file in (self.app / ".vscode").iterdir():
            json.loads(file.read_text())
        launch = json.loads((self.app / ".vscode/launch.json").read_text())["configurations"][0]
        for key in ("svdFile", "executable"):
            path = launch[key].replace("${workspaceFolder}", str(self.app))
            self.assertTrue(path.endswith("app.elf") or Path(path).is_file(), path)

    def test_the_machine_interface_as_cortex_debug_uses_it(self):
        self.do("make", "-j4", f"CAPSOC={BUILD}")
        run = subprocess.Popen(
            [CAPSOC, "run", "app.elf", "--gdb", "0", "--halt"],
            cwd=self.app,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env=CLEAN,
        )
        try:
            port = re.search(r"127\.0\.0\.1:(\d+)", run.stderr.readline().decode()).group(1)
            commands = [
                "-gdb-set mi-async on",
                f"-target-select extended-remote localhost:{port}",
                '-interpreter-exec console "monitor reset halt"',
                "-target-download",
                "-break-insert -t main",
                "-exec-continue",
                "-exec-next",
                "-stack-list-frames",
                "-stack-list-variables --simple-values",
                "-data-list-register-values x 0 15",
                "-data-read-memory-bytes 0x40004000 16",
                "-thread-info",
                "-data-disassemble -s $pc -e $pc+8 -- 0",
            ]
            mi = subprocess.Popen(
                ["gdb-multiarch", "-nx", "-q", "--interpreter=mi2", "app.elf"],
                cwd=self.app,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                text=True,
                bufsize=1,
            )
            answers = []
            for number, command in enumerate(commands, 1):
                mi.stdin.write(f"{number}{command}\n")
                mi.stdin.flush()
                waits_for_stop = command.startswith("-exec")
                while line := mi.stdout.readline():
                    if line.startswith(f"{number}^"):
                        answers.append(line.strip())
                        if not waits_for_stop or "^error" in line:
                            break
                    if waits_for_stop and line.startswith("*stopped"):
                        answers[-1] += " " + line.strip()
                        break
            mi.stdin.write("-gdb-exit\n")
            mi.communicate(timeout=30)
        finally:
            run.kill()
            run.communicate()
        self.assertEqual(len(answers), len(commands))
        for command, answer in zip(commands, answers):
            self.assertNotIn("^error", answer, command)
        self.assertIn('reason="breakpoint-hit"', answers[5])
        self.assertIn('func="main"', answers[7])

    def test_places_that_are_refused(self):
        self.assertIn("is there and not empty", self.new(self.app, code=2))
        file = self.folder / "file"
        file.write_text("")
        self.assertIn("is a file", self.new(file, code=2))
        self.assertIn("cannot be written", self.new(file / "below", code=2))
        (self.folder / "empty").mkdir()
        self.new(self.folder / "empty")
        self.new(self.folder / "deep" / "er")

    def test_the_template_alone_says_what_is_missing(self):
        for command in (["make"], ["cmake", "-B", self.folder / "b", "--toolchain", "toolchain.cmake"]):
            done = subprocess.run(
                command, cwd=SOURCE / "firmware/template", capture_output=True, text=True, check=False, env=CLEAN
            )
            self.assertNotEqual(done.returncode, 0)
            self.assertIn("capsoc new DIR", done.stderr)

    def test_settings_of_its_own(self):
        main = self.app / "main.c"
        text = main.read_text().replace(
            '#include "capsoc_device.h"',
            """#include "capsoc_device.h"
#include "program_settings.h"

#define SETTINGS(NUMBER, TEXT)                                                   \\
  NUMBER(int16_t, offset, -3, -300, 300, 1, "tenths", "added to the angle")      \\
  NUMBER(uint8_t, share, 0.5, 0, 0.75, 256, "", "of nothing")                    \\
  TEXT(label, 8, "angle", "what is printed before it")
PROGRAM_SETTINGS(SETTINGS)
#define settings (*program_settings_values())""",
        )
        text = text.replace('printf("angle: %.4f', 'printf("%s: ", settings.label);\n  printf("%.1f')
        main.write_text(text.replace("angle_of(0.5235987756)", "angle_of(0.5235987756) + settings.offset / 10.0"))
        self.do("make", f"CAPSOC={BUILD}")
        run = [CAPSOC, "run", "app.elf"]
        self.assertEqual(self.do(*run), "hello\nangle: 29.7 degrees\n")
        self.assertEqual(self.do(*run, "-P", "offset=-100", "-P", "label=phi"), "hello\nphi: 20.0 degrees\n")
        listing = self.do(*run, "--list-program-settings", "-P", "share=0.25")
        self.assertRegex(listing, r"offset +-3 +tenths +-300 \.\. 300 +built-in +added to the angle\n")
        self.assertRegex(listing, r"share +0.25 +0 \.\. 0.75 +command line")
        self.assertRegex(listing, r"label +angle +at most 7 bytes")
        for arguments, expected in (
            (["-P", "label=longer than it"], "too long; give at most 7 bytes"),
            (["-P", "offset=301"], "give -300 .. 300 tenths"),
        ):
            done = subprocess.run(
                [*run, *arguments], cwd=self.app, capture_output=True, text=True, check=False, env=CLEAN
            )
            self.assertEqual(done.returncode, 2)
            self.assertIn(expected, done.stderr)

    def test_the_board_without_the_coprocessor(self):
        self.do("make", f"CAPSOC={BUILD}")
        done = subprocess.run(
            ["qemu-system-arm", "-M", "mps2-an385", "-nographic", "-semihosting", "-kernel", "app.elf"],
            cwd=self.app,
            capture_output=True,
            timeout=60,
            check=False,
            stdin=subprocess.DEVNULL,
        )
        self.assertEqual((done.returncode, done.stdout), (0, b"hello\nno coprocessor\n"))

    def test_without_the_simulator_it_says_what_to_do(self):
        for command in (
            ["make", "CAPSOC=/nowhere", "run"],
            ["cmake", "-B", "build", "--toolchain", "toolchain.cmake", "-DCAPSOC=/nowhere"],
        ):
            done = subprocess.run(command, cwd=self.app, capture_output=True, text=True, check=False, env=CLEAN)
            self.assertIn("/path/to/capsoc/build", done.stderr)


if __name__ == "__main__":
    unittest.main()
