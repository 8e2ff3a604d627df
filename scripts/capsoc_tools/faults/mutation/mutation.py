"""Mutation score of the regression: how many faults in the RTL does it notice?

Writes one netlist with all mutants (yosys mutate -ctrl) and Verilates it. Compares each mutant with the model over the
first edges of each of the regression's scenarios (run_mutants), and the survivors over the whole stimulus. Looks for
proofs that the remaining survivors are equivalent to the RTL (equivalence.py). Prints killed, equivalent and surviving
mutants by source file. Ends with 0 if the score is at least 95 %, 1 if it is not, 2 if something is missing.
"""

import argparse
import collections
import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

from capsoc_tools.faults.mutation import equivalence

from capsoc_tools import ROOT
from capsoc_tools.rtl import sources as rtl_sources
from capsoc_tools.rtl.yosys_types import read_design

HERE = Path(__file__).resolve().parent
LEAST_PERCENT = 95.0
KILLED_BETWEEN_CHECKS = 50  # after this number of killed mutants the prover gets one, and must not prove it
ENTRY_FLAGS = [
    "-std=c++17",
    "-O2",
    "-fPIC",
    "-shared",
    "-w",
    "-DVM_COVERAGE=0",
    "-DVM_SC=0",
    "-DVM_TRACE=0",
    "-DVL_TIME_CONTEXT",
    "-fvisibility=hidden",
]


class MutationError(Exception):
    """What is missing and what to do."""


def run(command, log):
    """Runs a tool; what it says goes to a log file."""
    with open(log, "w", encoding="utf-8") as out:
        done = subprocess.run([str(part) for part in command], stdout=out, stderr=subprocess.STDOUT, check=False)
    if done.returncode:
        raise MutationError(f"{command[0]} failed; {log} says why")


def sources(folder, rtl):
    """Generated files, made in `folder`, then the RTL's in the order of its list."""
    try:
        return rtl_sources.sources(folder / "generated", rtl)
    except rtl_sources.RtlError as error:
        raise MutationError(str(error)) from error


def read_commands(files, arithmetic, folder):
    return [
        read_design(files, folder),
        f"hierarchy -check -top coprocessor -chparam Paper {int(arithmetic == 'paper')}",
        "proc",
        "flatten",
        "opt -full -purge",
        "rename -top coprocessor",
    ]


def write_netlist(files, arithmetic, arguments, folder):
    """All mutants in folder/mutants.v and mutants.aag; the list in folder/mutants.txt."""
    listing, script = folder / "mutants.txt", folder / "mutants.ys"
    commands = read_commands(files, arithmetic, folder)
    commands += [
        f"mutate -list {arguments.mutants} -seed {arguments.seed} -ctrl mutant 16 1 -o {listing} "
        "t:* t:$meminit* %d",  # a table's words are constants; tests/faults/regression.toml has some
        f"script {listing}",
        "opt_clean",
        # Verilator takes a word or a bundle of which some bits lead to others for a loop, and of the bundles' it
        # leaves some unsettled.
        "design -save mutants",
        "splitnets -driver",
        "splitnets t:$memrd %co1 w:* %i",
        f"write_verilog -noattr {folder / 'mutants.v'}",
        "design -load mutants",
        *equivalence.commands(folder / "mutants.aag"),
    ]
    script.write_text("\n".join(commands) + "\n", encoding="utf-8")
    run(["yosys", "-q", "-s", script], folder / "yosys.log")


def build_library(files, folder, options=(), definitions=()):
    """A shared library of a Verilated coprocessor that takes the number of a mutant."""
    made = folder / "verilated"
    shutil.rmtree(made, ignore_errors=True)  # files of another design would be compiled, too
    run(
        [
            "verilator",
            "--cc",
            "-O3",
            "--x-assign",
            "0",
            "--x-initial",
            "0",
            "-Wno-fatal",
            "-Wno-lint",
            "--no-timing",
            "--output-split",
            "0",
            "--prefix",
            "Vmutants",
            "--top-module",
            "coprocessor",
            "--Mdir",
            made,
            *options,
            *files,
        ],
        folder / "verilator.log",
    )
    include = subprocess.run(["verilator", "--getenv", "VERILATOR_ROOT"], capture_output=True, text=True, check=True)
    include = Path(include.stdout.strip()) / "include"
    library = folder / "mutants.so"
    units = sorted(made.glob("*.cpp")) + [
        HERE / "mutants_library.cpp",
        include / "verilated.cpp",
        include / "verilated_threads.cpp",
    ]
    run(
        [
            "g++",
            *ENTRY_FLAGS,
            *definitions,
            f"-I{made}",
            f"-I{include}",
            f"-I{include / 'vltstd'}",
            f"-I{ROOT / 'platform' / 'simulation'}",
            f"-I{folder / 'generated'}",
            f"-I{HERE}",
            *units,
            "-o",
            library,
            "-lpthread",
        ],
        folder / "compile.log",
    )
    return library


def depths(files):
    """How deep in the hierarchy the module of each file stands, by file name."""
    text = {file.stem: file.read_text(encoding="utf-8") for file in files}
    users = {
        name: {user for user in text if user != name and re.search(rf"^\s+{name}\s+(#|u_)", text[user], re.M)}
        for name in text
    }

    def depth(name, seen=()):
        return 1 + max((depth(user, seen + (name,)) for user in users[name] if user not in seen), default=0)

    return {name + ".sv": depth(name) for name in text}


def place(line, depth):
    """The source line that a mutant stands in: of all lines that yosys names the one deepest in the hierarchy."""
    found = re.findall(r"-src (\S+?\.sv):(\d+)\.\d+-(\d+)\.", line)
    named = re.search(r"([\w.]+\.sv):(\d+)\$", line)
    if named:
        return named[1], int(named[2])
    if not found:
        return "?", 0
    spans = [
        (-depth.get(Path(file).name, 0), int(last) - int(first), Path(file).name, int(first))
        for file, first, last in found
    ]
    _, _, file, first = min(spans)
    return file, first


def describe(line):
    parts = dict(re.findall(r"-(\w+) (\S+)", line))
    where = re.sub(r"/\S*/(?=\w+\.sv)", "", parts.get("wire", parts.get("cell", "?")))
    return f"{parts.get('mode')} of {parts.get('port')}[{parts.get('portbit')}] at {where}"


def build_runner(arguments, folder):
    """From the sources as they are: an older one would judge by another stimulus. Not in one of several workers."""
    if (arguments.build / "CMakeCache.txt").exists():
        run(["cmake", "--build", arguments.build, "--target", "run_mutants"], folder / "build.log")


def runner(arguments):
    found = sorted(arguments.build.glob("**/run_mutants"))
    if not found:
        raise MutationError(f"run_mutants is missing; run: cmake --build {arguments.build} --target run_mutants")
    return found[0]


def verdicts(library, arithmetic, numbers, arguments, edges, folder, known=None):
    """What run_mutants says of each mutant, by number: killed or survived, scenario, edge, difference. `folder`: for
    its output.
    """
    command = [
        runner(arguments),
        library,
        arithmetic,
        numbers[-1],
        "--first",
        numbers[0],
        "--samples",
        arguments.samples,
        "--accesses",
        arguments.accesses,
        "--edges",
        edges,
        "--jobs",
        arguments.jobs,
    ]
    command += ["--known", known] if known else []
    log = folder / "run_mutants.tsv"
    with open(log, "w", encoding="utf-8") as out:
        done = subprocess.run([str(part) for part in command], stdout=out, check=False)
    if done.returncode == 1:
        raise MutationError(f"the RTL itself differs from the model (line 0 of {log}): run capsoc regress")
    if done.returncode:
        raise MutationError("run_mutants ended with status " + str(done.returncode))
    lines = log.read_text(encoding="utf-8").splitlines()
    return {int(line.split("\t")[0]): line.split("\t")[1:] for line in lines}


def proofs(arithmetic, mutants, found, graph, folder):
    """Verdicts of the survivors that are proved to be equivalent, with the kind of proof; graph: the mutants'
    netlist.
    """
    left = [number for number, verdict in found.items() if number and verdict[0] == "survived"]
    # A mutant of a clock is not a change of gates.
    left = [number for number in left if " -port CLK " not in mutants[number - 1]]
    if not left:
        return {}
    try:
        prover = equivalence.Prover(graph, folder, arithmetic == "paper")
    except equivalence.Unproved as unproved:
        raise MutationError(str(unproved)) from unproved
    killed = [number for number, verdict in found.items() if verdict[0] == "killed"]
    for number in killed[::KILLED_BETWEEN_CHECKS]:
        if prover.prove(number):
            raise MutationError(f"mutant {number} is proved to be equivalent and was killed: equivalence.py is wrong")
    kinds = {number: prover.prove(number) for number in left}
    print(f"{len(left)} mutants left to prove, {sum(map(bool, kinds.values()))} proved", file=sys.stderr)
    return {number: ["equivalent", kind, "", ""] for number, kind in kinds.items() if kind}


def read_verdicts(file):
    if not file.exists():
        return {}
    lines = [line.split("\t") for line in file.read_text(encoding="utf-8").splitlines()]
    return {int(words[0]): words[1:] for words in lines}


def write_verdicts(found, file):
    file.write_text(
        "".join("\t".join([str(number), *verdict]) + "\n" for number, verdict in sorted(found.items())),
        encoding="utf-8",
    )


def decide(arithmetic, library, mutants, numbers, arguments, folder):
    """Cheap stimulus first, then more for what is left, then proofs: one that fails costs the most. `folder`: of the
    verdicts.
    """
    known = folder / "known.tsv"
    found = read_verdicts(known) if arguments.resume else {}
    if not found:
        found.update(verdicts(library, arithmetic, numbers, arguments, arguments.first_edges, folder))
        write_verdicts(found, known)
    found.update(verdicts(library, arithmetic, numbers, arguments, arguments.edges, folder, known))
    write_verdicts(found, known)
    found.update(proofs(arithmetic, mutants, found, library.with_name("mutants.aag"), folder))
    write_verdicts(found, known)
    return found


def prepare(arithmetic, arguments, folder):
    """The list of the mutants and their library; of an earlier run if it is to be resumed. Builds the runner, too."""
    folder.mkdir(parents=True, exist_ok=True)
    build_runner(arguments, folder)
    files = sources(folder, arguments.rtl)
    listing, library = folder / "mutants.txt", folder / "mutants.so"
    if not (arguments.resume and library.exists()):
        write_netlist(files, arithmetic, arguments, folder)
        build_library([folder / "mutants.v"], folder)
    return listing.read_text(encoding="utf-8").splitlines(), library


def measure(arithmetic, arguments):
    folder = arguments.output / arithmetic
    mutants, library = prepare(arithmetic, arguments, folder)
    found = decide(arithmetic, library, mutants, range(1, len(mutants) + 1), arguments, folder)
    depth = depths(rtl_sources.read_list(arguments.rtl / rtl_sources.DESIGN))
    columns = ["killed", "survived", "equivalent"]
    table = collections.defaultdict(lambda: [0, 0, 0])
    survivors, by_scenario, by_proof = [], collections.Counter(), collections.Counter()
    with open(folder / "verdicts.tsv", "w", encoding="utf-8") as out:
        for number, line in enumerate(mutants, 1):
            file, at = place(line, depth)
            verdict = found[number]
            out.write("\t".join([str(number), f"{file}:{at}", describe(line), *verdict]) + "\n")
            table[file][columns.index(verdict[0])] += 1
            if verdict[0] == "killed":
                by_scenario[verdict[1]] += 1
            elif verdict[0] == "equivalent":
                by_proof[verdict[1]] += 1
            else:
                survivors.append((file, at, number, describe(line)))
    arguments.found[arithmetic] = as_data(table, survivors, by_scenario, by_proof)
    return report(arithmetic, table, survivors, by_scenario, by_proof)


def as_data(table, survivors, by_scenario, by_proof):
    """For capsoc report."""
    return {
        "files": {
            file: dict(zip(("killed", "survived", "equivalent"), counts)) for file, counts in sorted(table.items())
        },
        "killed_by": dict(by_scenario.most_common()),
        "equivalent_by": dict(by_proof.most_common()),
        "survivors": [
            {"number": number, "place": f"{file}:{at}", "what": text} for file, at, number, text in sorted(survivors)
        ],
    }


def report(arithmetic, table, survivors, by_scenario, by_proof):
    print(f"arithmetic {arithmetic}\n{'source file':<28}{'mutants':>9}{'killed':>9}{'equivalent':>12}{'score':>9}")
    total = [0, 0, 0]
    for file in sorted(table):
        total = [a + b for a, b in zip(total, table[file])]
        print(row(file, table[file]))
    print(row("all", total))
    print("killed by: " + ", ".join(f"{name} {count}" for name, count in by_scenario.most_common()))
    print("equivalent by: " + ", ".join(f"{kind} {count}" for kind, count in by_proof.most_common()))
    for file, at, number, text in sorted(survivors):
        print(f"  survivor {number}: {file}:{at} {text}")
    print()
    return score(total)


def score(counts):
    killed, survived, _ = counts
    return 100.0 if killed + survived == 0 else 100.0 * killed / (killed + survived)


def row(name, counts):
    return f"{name:<28}{sum(counts):>9}{counts[0]:>9}{counts[2]:>12}{score(counts):>8.2f}%"


def add_options(parser):
    parser.add_argument("--arithmetic", choices=["precise", "paper", "both"], default="both")
    parser.add_argument("--samples", type=int, default=2000, help="random samples of the stimulus (2000)")
    parser.add_argument("--accesses", type=int, default=2000, help="random accesses of the stimulus (2000)")
    parser.add_argument("--edges", type=int, default=40000, help="clock edges of each scenario at most, 0: all (40000)")
    parser.add_argument("--jobs", type=int, default=2, help="threads (2)")
    parser.add_argument("--build", type=Path, default=ROOT / "build", help="build directory (build)")
    parser.add_argument("--rtl", type=Path, default=ROOT / "rtl", help="the RTL's folder (rtl)")
    parser.add_argument("--output", type=Path, help="where netlists and verdicts go (BUILD/mutation)")


def parse(parser):
    arguments = parser.parse_args()
    arguments.output = arguments.output or arguments.build / "mutation"
    arguments.found = {}
    arguments.arithmetics = ["precise", "paper"] if arguments.arithmetic == "both" else [arguments.arithmetic]
    return arguments


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    add_options(parser)
    parser.add_argument("--mutants", type=int, default=1000, help="of each arithmetic (1000)")
    parser.add_argument("--seed", type=int, default=1, help="of the choice of mutants (1)")
    parser.add_argument(
        "--resume",
        action="store_true",
        help="take netlist, library and verdicts from OUTPUT: the RTL is the same, more edges are tried",
    )
    parser.add_argument(
        "--first-edges", type=int, default=2000, help="clock edges of each scenario before the others (2000)"
    )
    parser.add_argument(
        "--prepare", action="store_true", help="write netlist and library alone, for scripts/tool mutation_block"
    )
    parser.add_argument("--json", type=Path, help="the tables as data, for capsoc report")
    arguments = parse(parser)
    try:
        if arguments.prepare:
            for arithmetic in arguments.arithmetics:
                prepare(arithmetic, arguments, arguments.output / arithmetic)
            return 0
        scores = [measure(arithmetic, arguments) for arithmetic in arguments.arithmetics]
        if arguments.json:
            data = {
                "schema": "capsoc-mutation-1",
                "mutants": arguments.mutants,
                "seed": arguments.seed,
                "arithmetics": arguments.found,
            }
            arguments.json.write_text(json.dumps(data, indent=2) + "\n", encoding="utf-8")
    except MutationError as error:
        print(f"mutation: {error}", file=sys.stderr)
        return 2
    return 0 if min(scores) >= LEAST_PERCENT else 1


if __name__ == "__main__":
    sys.exit(main())
