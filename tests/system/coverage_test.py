#!/usr/bin/env python3
"""`--coverage`: compared with counts by single steps (the instruction trace), whose lines addr2line knows."""

import os
import re
import subprocess
import tempfile
import unittest
from collections import Counter, defaultdict
from pathlib import Path

from harness import CAPSOC, CLEAN, Case, FIRMWARE, SOURCE

CTEST = {"name": "coverage"}

CONDITIONS = ["eq", "ne", "cs", "cc", "mi", "pl", "vs", "vc", "hi", "ls", "ge", "lt", "gt", "le"]
CONDITIONS = {name: number for number, name in enumerate(CONDITIONS)} | {"hs": 2, "lo": 3}


def capsoc(*arguments, code=0):
    done = subprocess.run(
        [CAPSOC, "run", *map(str, arguments)], capture_output=True, timeout=300, check=False, env=CLEAN
    )
    if done.returncode != code:
        raise AssertionError(f"exit code {done.returncode}, not {code}:\n{done.stderr.decode()}")
    return done.stdout + done.stderr


def tool(name, *arguments, **more):
    return subprocess.run(
        [f"arm-none-eabi-{name}", *map(str, arguments)], stdout=subprocess.PIPE, check=True, text=True, **more
    ).stdout


def read_lcov(path):
    """file below SOURCE -> kind -> what it has: counts of lines and functions, outcomes of the decisions of a line."""
    files = {}
    for line in Path(path).read_text().splitlines():
        kind, _, rest = line.partition(":")
        if kind == "SF":
            file = files[rest.removeprefix(f"{SOURCE}/")] = {"DA": {}, "FNDA": {}, "BRDA": defaultdict(dict)}
        elif kind == "DA":
            number, count = rest.split(",")
            file["DA"][int(number)] = int(count)
        elif kind == "FNDA":
            count, name = rest.split(",", 1)
            file["FNDA"][name] = int(count)
        elif kind == "BRDA":
            number, block, way, count = rest.split(",")
            file["BRDA"][int(number), int(block)][int(way)] = count
    return files


def holds(condition, flags):
    """ConditionPassed of the architecture manual (A7.3.1)."""
    n, z, c, v = (flags >> bit & 1 for bit in (31, 30, 29, 28))
    value = (z, c, n, v, c and not z, n == v, n == v and not z)[condition >> 1]
    return bool(value) != bool(condition & 1)


class Steps:
    """What a trace of every instruction comes to."""

    def __init__(self, trace):
        self.executed, self.skipped, self.outcomes = Counter(), Counter(), defaultdict(Counter)
        flags, conditions, registers = 0, [], {}
        lines = [line for line in trace.splitlines()[1:]]
        pattern = re.compile(r" +\d+ +[\d.]+  ([0-9a-f]{8}) \S* +(\S+) ?(.*?)(?:  +|$)((?:\w+=[0-9a-f]+ ?)*)$")
        for line in lines:
            found = pattern.match(line)
            if found is None:
                conditions = []  # of what was interrupted: the programs here have no exception in an IT block
                continue
            pc, operation, operands, changes = int(found[1], 16), found[2], found[3], found[4]
            self.executed[pc] += 1
            condition = conditions.pop(0) if conditions else None
            passed = condition is None or holds(condition[0], flags)
            if not passed:
                self.skipped[pc] += 1
            if condition is not None and condition[1]:
                self.outcomes[pc][passed] += 1
            branch = re.fullmatch(r"b(\w\w)(?:\.[nw])?", operation)
            if operation.startswith("it"):
                first = CONDITIONS[operands.strip()]
                conditions = [(first if letter == "t" else first ^ 1, n == 0) for n, letter in enumerate(operation[1:])]
            elif operation in ("cbz", "cbnz"):
                zero = registers[operands.split(",")[0]] == 0
                self.outcomes[pc][zero == (operation == "cbz")] += 1
            elif branch and branch[1] in CONDITIONS and condition is None:
                self.outcomes[pc][holds(CONDITIONS[branch[1]], flags)] += 1
            for change in changes.split():
                name, value = change.split("=")
                registers[name] = int(value, 16)
                if name == "xpsr":
                    flags = int(value, 16)


def relative(place):
    """file and line as addr2line has them, or nothing."""
    file, _, line = place.rpartition(":")
    line = line.split()[0]
    file = os.path.normpath(file).removeprefix("build/firmware/")  # where the compiler was started
    return (file, int(line)) if line.isdigit() and int(line) and not file.startswith(("..", "/")) else None


class Counts(Case):
    maxDiff = 3000

    def check(self, name, *options, code=0):
        elf = FIRMWARE / f"{name}.elf"
        capsoc(elf, "--coverage", self.folder / "c.info", *options, code=code)
        capsoc(elf, "--trace-instructions", self.folder / "t.txt", *options, code=code)
        steps = Steps((self.folder / "t.txt").read_text())
        self.assertGreater(sum(steps.executed.values()), 1000)
        addresses = sorted(steps.executed)
        places = tool("addr2line", "-e", elf, input="\n".join(map(hex, addresses))).splitlines()
        place_of = {address: relative(place) for address, place in zip(addresses, places)}
        functions = [
            (int(f[0], 16) & ~1, int(f[1], 16), f[3])
            for f in map(str.split, tool("nm", "-S", elf).splitlines())
            if len(f) == 4 and f[2] in "tTwW"
        ]
        files = read_lcov(self.folder / "c.info")
        self.check_lines(steps, place_of, functions, files)
        self.check_functions(steps, place_of, functions, files)
        self.check_decisions(steps, place_of, files)
        return files

    def check_lines(self, steps, place_of, functions, files):
        most = defaultdict(int)
        for address, count in steps.executed.items():
            inside = min((f[2] for f in functions if f[0] <= address < f[0] + f[1]), default="")
            if place_of[address]:
                key = place_of[address], inside
                most[key] = max(most[key], count - steps.skipped[address])
        lines = Counter()
        for (place, _), count in most.items():
            lines[place] += count
        found = {(file, line): count for file, about in files.items() for line, count in about["DA"].items() if count}
        expected = {place: count for place, count in lines.items() if count}
        self.assertGreater(len(expected), 20)
        self.assertEqual(found, expected)

    def check_functions(self, steps, place_of, functions, files):
        calls = defaultdict(int)
        for address, _, name in functions:
            if place_of.get(address):
                calls[place_of[address][0], name] += steps.executed[address]
        found = {(file, name): count for file, about in files.items() for name, count in about["FNDA"].items() if count}
        self.assertEqual(found, calls)

    def check_decisions(self, steps, place_of, files):
        expected = defaultdict(Counter)
        for address, outcomes in steps.outcomes.items():
            place = place_of[address]
            if place:
                expected[place][outcomes[True], outcomes[False]] += 1
        found = defaultdict(Counter)
        for file, about in files.items():
            for (line, _), ways in about["BRDA"].items():
                self.assertEqual(set(ways), {0, 1})
                if ways[0] != "-":
                    found[file, line][int(ways[0]), int(ways[1])] += 1
        self.assertGreater(len(expected), 5)
        self.assertEqual(found, expected)

    def test_drivers(self):
        files = self.check("drivers")
        self.assertIn(0, files["firmware/tests/drivers.c"]["DA"].values(), "a line that is never executed")

    def test_threads_and_interrupts(self):
        self.check("threads")

    def test_a_crash(self):
        files = self.check("failures", "-P", "failure=1", code=5)
        lines = (SOURCE / "firmware/tests/failures.c").read_text().splitlines()
        crashed = next(n for n, line in enumerate(lines, 1) if line.endswith("// null write"))
        self.assertEqual(files["firmware/tests/failures.c"]["DA"][crashed], 1)


class Files(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.file = Path(folder.name) / "c.info"

    def cover(self, program="drivers", *options, code=0):
        return capsoc(FIRMWARE / f"{program}.elf", "--coverage", self.file, *options, code=code)

    def test_the_same_for_every_executor_and_quantum(self):
        texts = set()
        for options in (
            ["-C", "cpu.executor=stepping"],
            ["-C", "cpu.executor=blocks"],
            ["-C", "cpu.translate_after=1"],
            [],
            ["--quantum", "777"],
            ["-C", "cpu.fast_forward=false"],
        ):
            self.cover("drivers", *options)
            texts.add(self.file.read_bytes())
            self.file.unlink()
        self.assertEqual(len(texts), 1)

    def test_runs_are_added(self):
        self.cover()
        once = read_lcov(self.file)
        self.cover()
        self.cover()
        for name, about in read_lcov(self.file).items():
            self.assertEqual(about["DA"], {line: 3 * count for line, count in once[name]["DA"].items()}, name)
            self.assertEqual(about["FNDA"], {line: 3 * count for line, count in once[name]["FNDA"].items()}, name)
            self.assertEqual(
                about["BRDA"],
                {
                    at: {way: n if n == "-" else str(3 * int(n)) for way, n in ways.items()}
                    for at, ways in once[name]["BRDA"].items()
                },
                name,
            )

    def test_what_is_not_of_this_program_stays(self):
        self.cover("hello")
        for text, what in (
            (self.file.read_text(), "of another program"),
            ("no coverage\n", "c.info:1: "),
            ("TN:capsoc_1\nSF:a.c\nDA:1,2\nDA:1,3\nend_of_record\n", "c.info:4: "),
            ("TN:capsoc_1\nSF:a.c\nDA:1,x\nend_of_record\n", "c.info:3: "),
            ("TN:capsoc_1\nSF:a.c\nDA:1,1\n", "c.info:4: "),
            ("TN:capsoc_1\nSF:a.c\nBRDA:1,1,2,1\nend_of_record\n", "c.info:3: "),
            ("TN:capsoc_1\nSF:a.c\nFNDA:1,f\nend_of_record\n", "c.info:3: "),
            ("TN:capsoc_1\nSF:a.c\nDA:1,99999999999999999999\nend_of_record\n", "c.info:3: "),
        ):
            self.file.write_text(text)
            self.assertIn(what, self.cover(code=2).decode())
            self.assertEqual(self.file.read_text(), text)

    def test_a_program_without_lines_is_refused(self):
        stripped = self.file.parent / "stripped.elf"
        tool("strip", "-g", "-o", stripped, FIRMWARE / "hello.elf")
        self.assertIn(
            "has no lines of source; compile it with -g", capsoc(stripped, "--coverage", self.file, code=2).decode()
        )
        self.assertFalse(self.file.exists())

    def test_lines_whose_file_has_no_name_are_left_out(self):
        damaged, whole = self.file.parent / "damaged.elf", (FIRMWARE / "hello.elf").read_bytes()
        # DW_LNS_set_file in front of DW_LNS_set_column and DW_LNE_set_address: there is no file 99.
        damaged.write_bytes(re.sub(rb"\x04.(?=\x05.\x00\x05\x02)", b"\x04\x63", whole, count=1, flags=re.DOTALL))
        for _ in range(2):  # the second reads what the first wrote
            capsoc(damaged, "--coverage", self.file)
        self.assertIn("firmware/drivers/uart.c", read_lcov(self.file))
        self.assertNotIn("SF:\n", self.file.read_text())

    def test_what_cannot_be_read_is_told(self):
        damaged, whole = self.file.parent / "damaged.elf", bytearray((FIRMWARE / "hello.elf").read_bytes())
        listing = tool("readelf", "-SW", FIRMWARE / "hello.elf")
        start, size = (
            int(text, 16) for text in re.search(r"\.debug_abbrev +PROGBITS +\w+ (\w+) (\w+)", listing).groups()
        )
        whole[start + size // 2 : start + size] = b"\xff" * (size - size // 2)
        damaged.write_bytes(whole)
        for option in ("--coverage", "--profile"):
            said = capsoc(damaged, option, self.file).decode()
            self.assertRegex(said, r"warning: .*damaged\.elf: cannot read the \w+")
            self.file.unlink()
        self.assertNotIn("cannot read", capsoc(damaged).decode())

    def test_nothing_else_changes(self):
        for program in ("drivers", "threads", "debuggee"):
            results = []
            for options in ([], ["--coverage", self.file]):
                capsoc(
                    FIRMWARE / f"{program}.elf",
                    *options,
                    "--json",
                    self.file.parent / "r.json",
                    "--uart0",
                    f"file:{self.file.parent / 'uart'}",
                )
                text = (self.file.parent / "r.json").read_text()
                results.append(
                    [re.search(f'"{key}": .*', text)[0] for key in ("instructions", "cycles", "sha256")]
                    + [(self.file.parent / "uart").read_bytes()]
                )
            self.assertEqual(*results)
            self.file.unlink()

    def test_lcov_and_genhtml_read_it(self):
        self.cover()
        options = ("--rc", "lcov_branch_coverage=1")
        summary = subprocess.run(["lcov", *options, "--summary", self.file], capture_output=True, text=True, check=True)
        files = read_lcov(self.file).values()
        lines = [count for about in files for count in about["DA"].values()]
        ways = [count for about in files for each in about["BRDA"].values() for count in each.values()]
        self.assertIn(f"({sum(map(bool, lines))} of {len(lines)} lines)", summary.stdout + summary.stderr)
        self.assertIn(
            f"({sum(w not in ('-', '0') for w in ways)} of {len(ways)} branches)", summary.stdout + summary.stderr
        )
        subprocess.run(
            ["genhtml", "-q", "--branch-coverage", "-o", self.file.parent / "html", self.file],
            check=True,
            cwd=self.file.parent,
            capture_output=True,
        )
        self.assertTrue(
            all(Path(line[3:]).is_file() for line in self.file.read_text().splitlines() if line.startswith("SF:"))
        )
        self.assertTrue(list((self.file.parent / "html").rglob("drivers.c.gcov.html")))


if __name__ == "__main__":
    unittest.main()
