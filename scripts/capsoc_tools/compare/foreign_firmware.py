"""Runs programs that others wrote on capsoc and on qemu-system-arm, and demands the same output and the same exit.

usage: foreign_firmware [--match TEXT] [--level -O2] [--build FOLDER] [--work FOLDER] [--jobs N] [--limit SECONDS]

tests/foreign/programs.toml lists them: interpreters, crypto, signal processing, a compiler to Thumb code, GCC's
torture tests, and MicroPython in its own port to this board with its own tests. Their sources are Debian's source
packages. apt-get fetches them from this machine's configured servers into FOLDER (default build/foreign, some 200 MB,
kept). They are compiled with arm-none-eabi-gcc and run on both simulators: programs with newlib over semihosting, a
board's tests through the UART on a pseudo-terminal. MIPS are millions of simulated instructions in a second, start of
the simulator included; the ratio is QEMU's time to ours. The last table is that of docs/reference/processor.md;
benchmarks have a table of scores after it.

Status 0: the same everywhere; 1: a difference, or a program that does not say what it should; 2: something is missing.
"""

import argparse
import collections
import concurrent.futures
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import tomllib
from pathlib import Path

from capsoc_tools import ROOT

HERE = ROOT / "tests" / "foreign"
COMPILE = [
    "arm-none-eabi-gcc",
    "-mcpu=cortex-m3",
    "-mthumb",
    "-nostartfiles",
    "-w",
    "-ffunction-sections",
    "-Wl,--gc-sections",
    "-Wl,--no-warn-rwx-segments",
    "-T",
    HERE / "linker.ld",
    f"-I{HERE}",
]
LIBRARIES = ["-Wl,--start-group", "-lc", "-lrdimon", "-lm", "-lgcc", "-Wl,--end-group"]
QEMU = [
    "qemu-system-arm",
    "-M",
    "mps2-an385",
    "-nographic",
    "-monitor",
    "none",
    "-semihosting-config",
    "enable=on,target=native",
]
# The package python3-serial is Debian's own interpreter's.
PYTHON = "/usr/bin/python3"

Verdict = collections.namedtuple(
    "Verdict", "name status output instructions cycles seconds qemu_seconds complaint score"
)
# A test of a board's own suite: the runner's word for it, and what the board sent if that was wrong.
Test = collections.namedtuple("Test", "word output")
TABLE = "| programs of others | run | as on QEMU | QEMU's time over ours |\n|---|---|---|---|"
Row = collections.namedtuple("Row", "title count same seconds qemu_seconds")
# Of a benchmark: the unit's name, and how many of it the processor does with a clock of one MHz.
Score = collections.namedtuple("Score", "unit per_mhz")


class ForeignError(Exception):
    """One sentence for the user."""


def call(command, seconds=None, folder=None, errors=subprocess.STDOUT, environment=None):
    """Status ("limit" if the time was over) and everything it said."""
    try:
        done = subprocess.run(
            [str(part) for part in command],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=errors,
            timeout=seconds,
            cwd=folder,
            env=environment,
            check=False,
        )
    except subprocess.TimeoutExpired as expired:
        return "limit", expired.stdout or b""
    except FileNotFoundError as error:
        raise ForeignError(f"{command[0]} is missing; run scripts/setup") from error
    except OSError as error:
        raise ForeignError(f"{command[0]} cannot be run: {error.strerror}") from error
    return done.returncode, done.stdout


def must(command, hint, folder=None):
    status, text = call(command, folder=folder)
    if status:
        tail = text.decode(errors="replace").strip().splitlines()[-1:]
        raise ForeignError(f"{hint}: {' '.join(tail)}")
    return text.decode()


class Sources:
    """Debian's source packages, in a separate folder; apt's lists of the system stay as they are."""

    def __init__(self, folder):
        self.folder = folder
        self.options = {}

    def apt(self, release, *arguments, folder=None):
        """`release`: Debian's, or nothing for this machine's."""
        if release not in self.options:
            self.options[release] = self.prepare(release)
            self.apt(release, "update")
        return must(
            ["apt-get", "-q", *self.options[release], *arguments],
            "apt-get cannot fetch the sources (are Debian's packages within reach?)",
            folder,
        )

    def prepare(self, wanted):
        lists = self.folder / f"lists{wanted}"
        (lists / "partial").mkdir(parents=True, exist_ok=True)
        found = must(
            ["apt-get", "indextargets", "--format", "$(REPO_URI) $(RELEASE) $(ORIGIN)", "Created-By: Packages"],
            "apt-get does not say where packages come from",
        )
        # The release itself, without what came after it: the same sources everywhere.
        places = sorted({tuple(line.split()[:2]) for line in found.splitlines() if line.endswith(" Debian")})
        places = [(uri, release) for uri, release in places if "-" not in release]
        if not places:
            raise ForeignError("apt-get knows no package lists of Debian; run: apt-get update")
        places = sorted({(uri, wanted or release) for uri, release in places})
        listing = self.folder / f"sources{wanted}.list"  # apt-get tidies up the folder of its lists
        listing.write_text("".join(f"deb-src {uri} {release} main\n" for uri, release in places), encoding="utf-8")
        return [
            "-o",
            f"Dir::Etc::SourceList={listing}",
            "-o",
            "Dir::Etc::SourceParts=/dev/null",
            "-o",
            f"Dir::State::Lists={lists}",
            "-o",
            "APT::Sandbox::User=root",
        ]

    def unpack(self, entry):
        """The package's upstream files; a stamp says that they are complete."""
        package = entry["package"]
        folder, stamp = self.folder / "sources" / package, self.folder / "sources" / f"{package}.stamp"
        if stamp.exists():
            return folder
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        with tempfile.TemporaryDirectory(dir=self.folder) as scratch:
            self.apt(entry.get("release", ""), "source", "--tar-only", "--only-source", package, folder=scratch)
            archive = [file for file in Path(scratch).iterdir() if re.search(r"\.orig\.tar\.\w+$", file.name)]
            if len(archive) != 1:
                raise ForeignError(f"the source package {package} has {len(archive)} upstream archives, not one")
            must(["tar", "-xf", archive[0], "-C", folder, "--strip-components=1"], f"{package} is damaged")
            if "archive" in entry:
                inner, part = entry["archive"]
                for found in folder.glob(inner):  # without one files_of() finds no sources
                    must(
                        ["tar", "-xf", found, "-C", folder, "--strip-components=1", "--wildcards", part],
                        f"{package} does not hold {part}",
                    )
        for source, copy in entry.get("copies", []):
            shutil.copy(folder / source, folder / copy)
        stamp.touch()
        return folder


def files_of(entry, folder):
    """Sources of the package, in the order of their names, and those of tests/foreign."""
    patterns = entry["sources"]
    files = {file for pattern in patterns if pattern[0] != "!" for file in folder.glob(pattern)}
    files -= {file for pattern in patterns if pattern[0] == "!" for file in folder.glob(pattern[1:])}
    if not files:
        raise ForeignError(f"programs.toml: {entry['name']}: {folder} holds none of its sources")
    return sorted(files), [HERE / pattern for pattern in patterns if (HERE / pattern).is_file()]


def compared(output, entry):
    """The output without the lines that say how long something took."""
    if "hide" not in entry:
        return output.rstrip()
    hidden = re.compile(entry["hide"].encode())
    return b"\n".join(line for line in output.splitlines() if not hidden.search(line)).rstrip()


def score_of(entry, output, results):
    """Of what the program printed, by the clock of the run: cycles and simulated time."""
    if "score" not in entry:
        return None
    found = re.search(entry["score"]["line"], output.decode(errors="replace"))
    mhz = results["cpu"]["cycles"] / results["time"]["simulated_s"] / 1e6 if results else 0
    try:
        return Score(entry["score"]["unit"], float(found[1]) / entry["score"]["one"] / mhz)
    except (TypeError, ValueError, ZeroDivisionError):
        return None  # the program did not get there


class Bench:
    def __init__(self, capsoc, work, limit, jobs=2):
        self.capsoc, self.work, self.limit, self.jobs = capsoc, work, limit, jobs

    def compile(self, elf, sources, entry, folder, level, flags=()):
        arguments = ", ".join(json.dumps(text) for text in [entry["name"], *entry.get("arguments", [])])
        include = [f"-I{HERE / part if (HERE / part).is_dir() else folder / part}" for part in entry.get("include", [])]
        # startup.c is C11 whatever the program asks for.
        start = elf.with_suffix(".start.o")
        status, said = call(
            [*COMPILE, "-O2", f"-DPROGRAM_ARGUMENTS={arguments}", "-c", HERE / "startup.c", "-o", start]
        )
        if status == 0:
            status, said = call(
                [
                    *COMPILE,
                    *level.split(),
                    *include,
                    *entry.get("flags", []),
                    *flags,
                    start,
                    *sources,
                    *LIBRARIES,
                    "-o",
                    elf,
                ]
            )
        start.unlink(missing_ok=True)
        return None if status == 0 else said.decode(errors="replace")

    def compare(self, name, elf, entry):
        """Both runs have an empty folder for their files."""
        with tempfile.TemporaryDirectory(dir=self.work) as ours, tempfile.TemporaryDirectory(dir=self.work) as theirs:
            results_file = Path(f"{ours}.json")  # out of the program's reach
            begin = time.monotonic()
            status, output = call(
                [
                    self.capsoc,
                    "run",
                    elf,
                    "--uart0",
                    "null",
                    "--semihosting-console",
                    "stdout",
                    "--semihosting-dir",
                    ours,
                    "-C",
                    "semihosting.status=process",
                    "--log-level",
                    "off",
                    "--json",
                    results_file,
                    *entry.get("options", []),
                ],
                self.limit,
                ours,
                subprocess.DEVNULL,
            )
            between = time.monotonic()
            qemu_status, qemu_output = call([*QEMU, "-serial", "null", "-kernel", elf], self.limit, theirs)
            end = time.monotonic()
            results = json.loads(results_file.read_text()) if results_file.exists() else {}
            results_file.unlink(missing_ok=True)
        complaint = ""
        if status != qemu_status:
            complaint = f"ends with {status}, on QEMU with {qemu_status}"
        elif compared(output, entry) != compared(qemu_output, entry):
            complaint = "other output than on QEMU"
        elif status == "limit":
            complaint = f"no end in {self.limit} s on either"
        elif entry.get("expect", "").encode() not in output:
            complaint = f"does not say {entry['expect']!r}"
        cpu = results.get("cpu", {"instructions": 0, "cycles": 0})
        return Verdict(
            name,
            status,
            output,
            cpu["instructions"],
            cpu["cycles"],
            between - begin,
            end - between,
            complaint,
            score_of(entry, output, results),
        )


def error_of(said):
    """What a compiler or make stopped at."""
    error = re.search(r".*(error:|undefined reference|\*\*\*).*", said)
    return error[0].strip() if error else said[-200:]


def run_program(bench, entry, folder, level):
    name = f"{entry['name']} {level}"
    elf = bench.work / f"{entry['name']}{level}.elf"
    package_files, our_files = files_of(entry, folder)
    said = bench.compile(elf, package_files + our_files, entry, folder, level)
    if said is not None:
        raise ForeignError(f"{name} does not compile: {error_of(said)}")
    return bench.compare(name, elf, entry)


def print_programs(verdicts):
    print(f"{'program':<18}{'status':>7}{'bytes':>8}{'instructions':>15}{'MIPS':>7}{'ratio':>7}")
    for each in verdicts:
        ratio = each.qemu_seconds / each.seconds
        print(
            f"{each.name:<18}{each.status:>7}{len(each.output):>8}{each.instructions:>15}"
            f"{each.instructions / each.seconds / 1e6:>7.0f}{ratio:>7.2f}  {each.complaint or 'as on QEMU'}",
            flush=True,
        )


def options_of(source):
    """-f and -std of the test's own dg-options."""
    words = re.findall(r'dg-(?:additional-)?options "([^"]*)"', source.read_text(encoding="utf-8", errors="replace"))
    return [option for text in words for option in text.split() if option.startswith(("-f", "-std"))]


def run_case(bench, entry, folder, level, source):
    name = f"{source.parent.name}/{source.name}"
    with tempfile.TemporaryDirectory(dir=bench.work) as scratch:
        elf = Path(scratch) / "case.elf"
        if bench.compile(elf, [source], entry, folder, level, options_of(source)) is not None:
            return None
        return bench.compare(name, elf, entry)


def run_suite(bench, entry, folder, level):
    """What ran. A file that is not for this target does not compile; both simulators' status is counted."""
    cases, _ = files_of(entry, folder)
    with concurrent.futures.ThreadPoolExecutor(bench.jobs) as pool:
        verdicts = list(pool.map(lambda case: run_case(bench, entry, folder, level, case), cases))
    ran = [each for each in verdicts if each is not None]
    wrong = [each for each in ran if each.complaint]
    passed = sum(not each.complaint and each.status == 0 for each in ran)
    failed = [each for each in ran if not each.complaint and each.status != 0]
    print(
        f"{entry['name']} {level}: {len(cases)} programs, {passed} pass on both, {len(failed)} fail on both alike, "
        f"{len(cases) - len(ran)} not for this target, {len(wrong)} differ",
        flush=True,
    )
    for each in failed:
        print(f"  {each.name}: status {each.status} on both")
    for each in wrong:
        print(f"  {each.name}: {each.complaint}")
    return ran


class Board:
    """A simulator with UART 0 on a pseudo-terminal, to be left with `with`."""

    def __init__(self, command, folder):
        self.command, self.log = [str(part) for part in command], folder / "simulator.txt"
        self.process = self.terminal = None

    def __enter__(self):
        with self.log.open("wb") as said:
            try:
                self.process = subprocess.Popen(
                    self.command, stdin=subprocess.DEVNULL, stdout=said, stderr=subprocess.STDOUT, cwd=self.log.parent
                )
            except OSError as error:
                raise ForeignError(f"{self.command[0]} cannot be run: {error.strerror}") from error
        until = time.monotonic() + 30
        while self.terminal is None:
            found = re.search(r"/dev/pts/\d+", self.said())
            if found:
                self.terminal = found[0]
            elif self.process.poll() is not None or time.monotonic() > until:
                self.__exit__()
                raise ForeignError(f"{self.command[0]} opens no terminal: {self.said().strip()[-200:]}")
            else:
                time.sleep(0.01)
        return self

    def __exit__(self, *_):
        self.process.send_signal(signal.SIGTERM)
        if self.ended(20) is None:
            self.process.kill()
            self.process.wait()

    def ended(self, seconds):
        """Its status, if it ends within these seconds."""
        try:
            return self.process.wait(seconds)
        except subprocess.TimeoutExpired:
            return None

    def said(self):
        return self.log.read_text(encoding="utf-8", errors="replace")


def run_board(bench, entry, folder, command, arguments):
    """One pass of a suite on one simulator: each test, the seconds, and what is wrong with the pass as a whole."""
    runner = folder / entry["runner"]
    with tempfile.TemporaryDirectory(dir=bench.work) as scratch:
        results = Path(scratch) / "results"
        with Board(command, Path(scratch)) as board:
            begin = time.monotonic()
            status, output = call(
                [PYTHON, runner, "-t", f"port:{board.terminal}", "-r", results, *arguments],
                entry.get("limit", bench.limit),
                runner.parent,
                environment={**os.environ, "MICROPY_CPYTHON3": PYTHON},
            )
            seconds = time.monotonic() - begin
            text = output.decode(errors="replace")
            ended = board.ended(0 if status == "limit" or entry["expect"] in text else 5)
            last_words = board.said().strip().splitlines()[-1:]
        tests = {}
        for word, test in re.findall(r"^(pass|skip|FAIL) +(\S+)", text, re.MULTILINE):
            wrong = results / (test.replace("/", "_") + ".out")
            tests[test] = Test(word, wrong.read_bytes() if word == "FAIL" and wrong.exists() else b"")
    complaint = ""
    if ended is not None:
        complaint = f"the simulator ended with {ended}: {' '.join(last_words)}"
    elif status == "limit":
        complaint = "no end in time"
    elif entry["expect"] not in text:
        complaint = " ".join(text.strip().splitlines()[-1:]) or f"the runner ended with {status}"
    return tests, seconds, complaint


def compare_tests(name, tests, qemu_tests):
    """Prints the summary of a pass and what differs; the number of differences."""
    missing = Test("nothing", b"")
    wrong = []
    for test in sorted({*tests, *qemu_tests}):
        ours, theirs = tests.get(test, missing), qemu_tests.get(test, missing)
        if ours.word != theirs.word:
            wrong.append(f"  {test}: {ours.word}, on QEMU {theirs.word}")
        elif ours.output != theirs.output:
            wrong.append(f"  {test}: fails with other output than on QEMU")
    both = [test for test in tests if tests[test] == qemu_tests.get(test)]
    words = collections.Counter(tests[test].word for test in both)
    print(
        f"{name}: {len({*tests, *qemu_tests})} tests, {words['pass']} pass on both, {words['FAIL']} fail on both "
        f"alike, {words['skip']} not for this target, {len(wrong)} differ",
        flush=True,
    )
    print("".join(f"  {test}: fails on both\n" for test in both if tests[test].word == "FAIL"), end="")
    print("".join(line + "\n" for line in wrong), end="", flush=True)
    return len(wrong)


def run_passes(bench, entry, folder, elf, name):
    """A row for the suite with all its passes."""
    count = same = seconds = qemu_seconds = 0
    for label, arguments in entry["passes"].items():
        tests, ours, complaint = run_board(
            bench, entry, folder, [bench.capsoc, "run", elf, "--uart0", "pty", "--log-level", "warn"], arguments
        )
        qemu_tests, theirs, qemu_complaint = run_board(
            bench, entry, folder, [*QEMU, "-serial", "pty", "-kernel", elf], arguments
        )
        wrong = compare_tests(f"{name} {label}", tests, qemu_tests)
        for where, what in ("capsoc", complaint), ("QEMU", qemu_complaint):
            if what:
                print(f"  on {where}: {what}", flush=True)
                wrong = max(wrong, 1)
        ran = sum(not tests.get(test) == qemu_tests.get(test) == Test("skip", b"") for test in {*tests, *qemu_tests})
        ran = max(ran, wrong)  # a pass without any test is a difference
        count, same = count + ran, same + ran - wrong
        seconds, qemu_seconds = seconds + ours, qemu_seconds + theirs
    return Row(entry["title"], count, same, seconds, qemu_seconds)


def run_board_suite(bench, entry, folder, level):
    """The package's own makefile makes its own port to the board."""
    must([PYTHON, "-c", "import serial"], "the package python3-serial is missing; run scripts/setup")
    build = f"build{level}"
    for target in entry["make"]:
        words = [word.format(here=HERE, level=level, build=build) for word in target]
        status, said = call(["make", f"-j{bench.jobs}", *words], folder=folder)
        if status:
            raise ForeignError(f"{entry['name']} {level} does not compile: {error_of(said.decode(errors='replace'))}")
    return run_passes(bench, entry, folder, folder / entry["elf"].format(build=build), f"{entry['name']} {level}")


def row_of(title, verdicts):
    same = sum(not each.complaint for each in verdicts)
    return Row(
        title, len(verdicts), same, sum(each.seconds for each in verdicts), sum(each.qemu_seconds for each in verdicts)
    )


def print_table(rows):
    print(f"\n{TABLE}")
    for row in rows:
        print(f"| {row.title} | {row.count:,} | {row.same:,} | {row.qemu_seconds / row.seconds:.1f} |")


def print_scores(verdicts):
    """What benchmarks say of the processor's timing."""
    if verdicts:
        print("\n| benchmark | for a MHz | cycles for an instruction |\n|---|---|---|")
    for each in verdicts:
        print(f"| {each.name} | {each.score.per_mhz:.2f} {each.score.unit} | {each.cycles / each.instructions:.2f} |")


def levels_of(entry, wanted):
    return [level for level in entry["levels"] if level in (wanted or entry["levels"])]


def run_all(bench, sources, chosen):
    """Runs entries, each with a level of optimisation; the rows of the table, and benchmarks' verdicts."""
    verdicts = {}  # by title
    for entry, level in chosen["program"]:
        verdict = run_program(bench, entry, sources.unpack(entry), level)
        verdicts.setdefault(entry["title"], []).append(verdict)
    if verdicts:
        print_programs([verdict for each in verdicts.values() for verdict in each])
    for entry, level in chosen["suite"]:
        verdicts.setdefault(entry["title"], []).extend(run_suite(bench, entry, sources.unpack(entry), level))
    rows = [row_of(title, each) for title, each in verdicts.items()]
    rows += [run_board_suite(bench, entry, sources.unpack(entry), level) for entry, level in chosen["board"]]
    return rows, [verdict for each in verdicts.values() for verdict in each if verdict.score]


def positive(text):
    number = int(text)
    if number < 1:
        raise argparse.ArgumentTypeError(f"{text} is not positive")
    return number


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--match", default="", help="only programs whose name holds this")
    parser.add_argument(
        "--level", action="append", help="only this level of optimisation, --level=-O2; may be repeated"
    )
    parser.add_argument("--build", type=Path, default=ROOT / "build", help="build directory (build)")
    parser.add_argument("--work", type=Path, help="sources and programs (BUILD/foreign)")
    parser.add_argument("--jobs", type=positive, default=2, help="programs of a suite at a time (2)")
    parser.add_argument("--limit", type=positive, default=300, help="seconds for each run (300)")
    arguments = parser.parse_args()
    work = (arguments.work or arguments.build / "foreign").resolve()
    capsoc = (arguments.build / "capsoc").resolve()
    try:
        if not capsoc.exists():
            raise ForeignError(f"{capsoc} is missing; build it first, or name the build directory with --build")
        work.mkdir(parents=True, exist_ok=True)
        listed = tomllib.loads((HERE / "programs.toml").read_text(encoding="utf-8"))
        chosen = {
            kind: [
                (entry, level)
                for entry in listed[kind]
                if arguments.match in entry["name"]
                for level in levels_of(entry, arguments.level)
            ]
            for kind in ("program", "suite", "board")
        }
        if not any(arguments.match in entry["name"] for kind in chosen for entry in listed[kind]):
            raise ForeignError(f"programs.toml has no program with {arguments.match!r} in its name")
        if not any(chosen.values()):
            raise ForeignError(f"programs.toml has no level {' or '.join(arguments.level)} for these programs")
        rows, benchmarks = run_all(Bench(capsoc, work, arguments.limit, arguments.jobs), Sources(work), chosen)
    except (ForeignError, OSError) as error:
        print(f"foreign_firmware: {error}", file=sys.stderr)
        return 2
    print_table(rows)
    print_scores(benchmarks)
    return 1 if any(row.same != row.count for row in rows) else 0


if __name__ == "__main__":
    sys.exit(main())
