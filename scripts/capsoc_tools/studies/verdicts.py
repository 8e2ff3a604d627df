"""Compares the verdicts of the self-calibration programs with the truth, on random sensors, good and broken.

usage: verdicts [--good N] [--broken N] [--seed S] [--programs P,...] [--arithmetic A,...] [--coprocessor tlm|rtl]
[--kinds K,...]
                [--jobs N] [--build FOLDER] [--json FILE] [--records FILE] [--same-as FILE] [--details]
       verdicts --write FILE --kinds K --case N --programs P [--arithmetic A] [--seed S]
       verdicts --number N [the options of the first form]

A *wrong pass* is a pass whose bound the true angle leaves. The program never sees the true angle, so it would pass
without it, too. The truth is looked at twice: by `capsoc run`, and here, from the recorded angles. A wrong pass is
*excluded* if it has the condition that the kind breaks ("... if no sample is stale";
verdict_kinds.CONDITIONS); these are counted apart. A *false lock* is STATUS.LOCK with an error above 10 degrees for
longer than a turn. Status 0: no wrong pass; 1: some, each with the command that makes its recording again; 2: usage.

--number runs the Nth of these cases alone, counted from 1, and prints its answer as JSON (campaigns/verdicts.toml).
--write makes the recording of one case and prints the command that runs the program on it. --records FILE keeps every
answer as it comes, a line each; the same command with the same file continues where it was interrupted. --same-as
FILE (the records of another coprocessor) also counts where verdict, reason, bound or exit code differ from the
other's on the same sensor; each such difference makes the status 1, too.

Good: amplitudes 0.02 .. 0.95 of full scale (log-uniform), ratio 0.5 .. 2, offsets to 0.5 without clipping, beta from
-1.2 to 1.2 rad. Noise is 0 or 1e-6 .. 1e-2 of the amplitude; 70 % have harmonics of orders 2 to 5, up to 2 % in sum.
Half have a speed ripple of 1e-4 .. 2 %: at most 3 deg for programs that depend on a steady speed, 1 deg for harmonics.
Noise and harmonics are limited to about 5 deg of angle error. Converters have 12 to 24 bits; both directions occur
(random order for unordered). Half of the cases run with the usual settings (0.05 Hz at 250 Hz), the others with another
speed and times that are no whole turns.
Broken: a good one, and one thing that breaks it (verdict_motions.py and verdict_signals.py say what).
"""

import argparse
import collections
import concurrent.futures
import json
import math
import os
import re
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

try:
    import numpy as np
except ImportError:
    sys.exit("verdicts: the package python3-numpy is missing; run scripts/setup")

from capsoc_tools.studies import verdict_kinds, verdict_sensors

from capsoc_tools import ROOT as TOP

CLEAN = {k: v for k, v in os.environ.items() if not k.startswith("CAPSOC_")}
# Of these the arithmetic paper has nothing.
PRECISE_ONLY = ("quick", "quick_known", "harmonics", "follow")
LOCK = 2
# Of a case: the others are a wrong pass, or no answer.
RIGHT = ("pass", "refused", "excluded")
FALSE_LOCK_DEG = 10

Item = collections.namedtuple("Item", "kind number program arithmetic seed coprocessor build")


def case_name(item):
    return f"{item.kind} {item.number} {item.program} {item.arithmetic}"


def parameter_words(sensor):
    words = {
        name: {"word": round(value * (2**32 / (2 * math.pi) if name == "beta" else 2**31)), "value": value}
        for name, value in {**sensor.parameters(), "phi": 0}.items()
    }
    return json.dumps({"parameters": words})


def make_recording(item, trace):
    """Writes the recording of a case, and for calibrate the parameters next to it. Returns the case and the command
    without outputs.
    """
    case, *samples = verdict_kinds.make_case(item.seed, item.kind, item.number, item.program)
    verdict_sensors.write(trace, *samples)
    plan = case.plan
    command = [
        str(item.build / "capsoc"),
        "run",
        str(item.build / "firmware" / f"{plan.elf}.elf"),
        *plan.settings,
        "--sensor",
        str(trace),
        "--arithmetic",
        item.arithmetic,
        "--coprocessor",
        item.coprocessor,
        "-C",
        f"sensor.adc_bits={case.sensor.bits}",
    ]
    if item.program == "calibrate":
        parameters = trace.with_suffix(".parameters.json")
        parameters.write_text(parameter_words(case.sensor))
        command += ["--parameters", str(parameters)]
    return case, command


def read_record(path):
    """Errors of the recorded angles in degrees (absolute) and STATUS, a value a sample; none of either without a
    sample.
    """
    rows = path.read_bytes().split(b"\n", 2)[2]  # without the comment and the header
    pending = rows.find(b",,")  # samples that were on their way at the end
    if pending >= 0:
        rows = rows[: rows.rfind(b"\n", 0, pending) + 1]
    true, found, status = np.fromstring(rows.replace(b"\n", b","), sep=",").reshape(-1, 3).T
    error = found * (360 / 2**32) - true
    return np.abs(error - 360 * np.rint(error / 360)), status.astype(int)


def claimed(plan, samples, text):
    """First sample of those whose angles the bound is of."""
    if plan.claimed == "two turns":
        return max(0, samples - int(2 * plan.turn))
    if plan.claimed == "since the lock":
        locks = re.findall(r"t +(\d+) s: lock\n", text)
        return (int(locks[-1]) + 1) * plan.rate if locks else samples
    return max(0, samples - (plan.judged[1] - plan.judged[0]) + 5)


def false_lock(error, status, turn):
    """The longest time in turns with LOCK in which the error is above 10 degrees in each half turn, and in a tenth of
    all samples.
    """
    wrong = np.flatnonzero((error > FALSE_LOCK_DEG) & (status & LOCK != 0))
    if len(wrong) == 0:
        return 0.0
    unlocked = np.cumsum(status & LOCK == 0)[wrong]
    parts = np.flatnonzero((np.diff(wrong) > turn / 2) | (np.diff(unlocked) > 0))
    first, last = np.concatenate([[0], parts + 1]), np.concatenate([parts, [len(wrong) - 1]])
    samples = wrong[last] - wrong[first] + 1
    return float(np.max(np.where(10 * (last - first + 1) >= samples, samples, 0)) / turn)


def excludes(broken_by, conditions):
    """Whether a pass takes for granted that nothing of this kind is wrong."""
    broken = [words for words, kinds in verdict_kinds.CONDITIONS.items() if kinds.intersection(broken_by)]
    return any(condition.startswith(tuple(broken)) for condition in conditions)


def judge(answer, verdict, case, record, text):
    """Completes the answer: outcome, bound and true error."""
    error, status = read_record(record)
    plan = case.plan
    answer["locked_wrong_turns"] = round(false_lock(error, status, plan.turn), 3)
    if verdict is None:
        answer |= {"outcome": "no verdict", "reason": f"exit {answer['exit']}"}
        return
    if not verdict["pass"]:
        answer |= {"outcome": "refused" if answer["exit"] == 1 else "error", "reason": verdict["reason"]}
        return
    # The signal may have ended sooner: the pass says how many samples it is about.
    first = max(claimed(plan, len(error), text), len(error) - verdict["samples"])
    seen = error[first:]
    true = max(verdict["largest_error_deg"] or 0, float(seen.max()) if len(seen) else 0)
    answer |= {
        "outcome": "pass" if true <= verdict["bound_deg"] else "WRONG",
        "reason": "",
        "bound": verdict["bound_deg"],
        "error": true,
        "conditions": verdict["conditions"],
    }
    if answer["outcome"] == "WRONG" and excludes(case.broken_by, verdict["conditions"]):
        answer["outcome"] = "excluded"
    if answer["outcome"] == "pass" and answer["exit"] != 0:
        answer |= {"outcome": "error", "reason": "it passes, its bound holds, and the exit code is not 0"}


def one_case(item):
    """Runs one program on one sensor: what it says, and the command."""
    with tempfile.TemporaryDirectory(prefix="capsoc-verdict-") as folder:
        trace, result, record = (Path(folder) / name for name in ("case.csv", "result.json", "record.csv"))
        case, command = make_recording(item, trace)
        command += ["--json", str(result), "--record", str(record), "--record-columns", "angle_deg,found_word,status"]
        process = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=CLEAN, check=False)
        answer = {
            "case": case_name(item),
            **{name: getattr(item, name) for name in ("kind", "number", "program", "arithmetic")},
            "settings": " ".join(case.plan.settings),
            "exit": process.returncode,
        }
        try:
            verdict = json.loads(result.read_text())["verdict"]
        except OSError:
            answer |= {"outcome": "error", "reason": process.stderr.decode(errors="replace").strip().splitlines()[-1:]}
            return answer
        judge(answer, verdict, case, record, process.stdout.decode(errors="replace"))
    return answer


def again(answer, seed):
    """The command that makes the recording of a case again."""
    return (
        f"scripts/tool verdicts --write case.csv --seed {seed} --kinds {shlex.quote(answer['kind'])} "
        f"--case {answer['number']} "
        f"--programs {answer['program']} --arithmetic {answer['arithmetic']}"
    )


def refuse(why):
    print(f"verdicts: {why}", file=sys.stderr)
    sys.exit(2)


def read_records(path, head):
    """The answers of an interrupted run, by case; those of another program, coprocessor or seed are refused."""
    try:
        lines = [json.loads(line) for line in path.read_text(encoding="ascii").splitlines()]
    except FileNotFoundError:
        return {}
    except ValueError as fault:
        refuse(f"{path}: {fault}; remove what is after the last whole line")
    if not lines or (head and lines[0] != head):
        refuse(f"{path}: is of {lines[0] if lines else 'nothing'}, not of {head}; name another file")
    return {answer["case"]: answer for answer in lines[1:]}


def run_cases(items, known, head, options):
    """All answers in the order of the cases; what is new goes to the records as it comes."""
    left = [item for item in items if case_name(item) not in known]
    records = open(options.records, "a", encoding="ascii") if options.records else None
    if records and not known:
        print(json.dumps(head), file=records, flush=True)
    with concurrent.futures.ProcessPoolExecutor(options.jobs) as pool:
        for done, answer in enumerate(pool.map(one_case, left, chunksize=4), 1):
            known[answer["case"]] = answer
            if records:
                print(json.dumps(answer), file=records, flush=True)
            if done % 100 == 0:
                print(f"{len(items) - len(left) + done} of {len(items)}", file=sys.stderr)
    return [known[case_name(item)] for item in items]


def differing(answers, others):
    """The cases of both whose answer is not the same."""
    seen = ("outcome", "reason", "bound", "error", "exit")
    common = [a for a in answers if a["case"] in others]
    return common, [a for a in common if any(a.get(name) != others[a["case"]].get(name) for name in seen)]


def grouped(answers, *names):
    groups = collections.defaultdict(list)
    for answer in answers:
        groups[tuple(answer[name] for name in names)].append(answer)
    return groups.items()


def quantile(values, share):
    values = sorted(values)
    return values[min(len(values) - 1, int(share * len(values)))]


def kind_table(answers, names):
    """A line for each kind, or each kind, program and arithmetic."""
    lines = [
        f"{'kind':19} {'program':24} {'runs':>6} {'pass':>6} {'WRONG':>6} {'excluded':>8} {'refused':>7} "
        f"{'false lock':>10} {'median bound':>12}  most frequent reason"
    ]
    for key, those in grouped(answers, *names):
        count = collections.Counter(a["outcome"] for a in those)
        reasons = collections.Counter(str(a["reason"]) for a in those if a["reason"])
        bounds = [a["bound"] for a in those if "bound" in a]
        locks = sum(a.get("locked_wrong_turns", 0) > 1 for a in those)
        median = f"{quantile(bounds, 0.5):.3g} deg" if bounds else "-"
        lines.append(
            f"{key[0]:19} {' '.join(key[1:]) or 'all':24} {len(those):6} {count['pass']:6} "
            f"{count['WRONG']:6} {count['excluded']:8} "
            f"{sum('bound' not in a for a in those):7} {locks:10} {median:>12}  "
            f"{reasons.most_common(1)[0][0] if reasons else ''}"
        )
    return lines


def is_good(answer):
    return answer["kind"].startswith("good")


def good_tables(answers):
    """What good sensors got: refusals with their reasons, and how far the stated bound lies above the true error."""
    good = [a for a in answers if is_good(a)]
    if not good:
        return []
    lines = [
        f"{'good sensors':12} {'arithmetic':10} {'runs':>6} {'refused':>7}   bound / error: "
        f"{'median':>8} {'95 %':>8} {'worst':>8} {'least':>8}"
    ]
    for (program, arithmetic), those in grouped(good, "program", "arithmetic"):
        ratios = [a["bound"] / max(a["error"], 1e-9) for a in those if "bound" in a]
        refused = sum("bound" not in a for a in those)
        shown = (
            " ".join(f"{x:8.3g}" for x in (quantile(ratios, 0.5), quantile(ratios, 0.95), max(ratios), min(ratios)))
            if ratios
            else ""
        )
        lines.append(f"{program:12} {arithmetic:10} {len(those):6} {refused:7}   {'':14} {shown}")
    for (arithmetic,), those in grouped(good, "arithmetic"):
        refused = [a for a in those if "bound" not in a]
        lines.append(
            f"{arithmetic}: good sensors refused: {len(refused)} of {len(those)} "
            f"({100 * len(refused) / len(those):.1f} %)"
        )
        for (kind, program, reason), count in collections.Counter(
            (a["kind"], a["program"], str(a["reason"])) for a in refused
        ).most_common():
            lines.append(f"  {count:5}  {kind}, {program}: {reason}")
    return lines


def faults(answers, seed):
    """Wrong passes, false locks and runs without an answer, each with its command."""
    wrong = [a for a in answers if a["outcome"] == "WRONG"]
    excluded = sum(a["outcome"] == "excluded" for a in answers)
    lines = [
        f"wrong passes: {len(wrong)} of {len(answers)}"
        + (f"; {excluded} more are excluded by the words of the pass" if excluded else "")
    ]
    for a in sorted(wrong, key=lambda a: a["error"] / a["bound"]):
        lines += [
            f"  {a['kind']}: {a['program']}, {a['arithmetic']}: {a['bound']:.3g} deg stated, {a['error']:.3g} true",
            f"    {again(a, seed)}",
        ]
    locks = [a for a in answers if a.get("locked_wrong_turns", 0) > 1]
    passed = sum(a["outcome"] == "pass" for a in locks)
    lines.append(
        f"false locks (more than {FALSE_LOCK_DEG} deg for longer than a turn): {len(locks)} of {len(answers)}, "
        f"{passed} of them passed"
    )
    for a in sorted(locks, key=lambda a: -a["locked_wrong_turns"])[:20]:
        lines += [
            f"  {a['kind']}: {a['program']}, {a['arithmetic']}: {a['locked_wrong_turns']} turns",
            f"    {again(a, seed)}",
        ]
    lost = [a for a in answers if a["outcome"] in ("error", "no verdict")]
    for a in lost[:10]:
        lines += [
            f"  {a['outcome']}: {a['kind']}, {a['program']}, {a['arithmetic']}: {a['reason']}",
            f"    {again(a, seed)}",
        ]
    return lines, bool(wrong or lost)


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", 1)[0], prog="verdicts")
    parser.add_argument(
        "--good",
        type=int,
        default=300,
        help="random good sensors for each program and arithmetic (300); a fifth of that of other motions",
    )
    parser.add_argument("--broken", type=int, default=7, help=f"of each of the {len(verdict_kinds.BROKEN)} kinds (7)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--programs", default=",".join(verdict_sensors.PLANS))
    parser.add_argument("--arithmetic", default="precise,paper")
    parser.add_argument("--coprocessor", default="tlm", choices=("tlm", "rtl"))
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--build", type=Path, default=TOP / "build", metavar="FOLDER", help="of the program (build)")
    parser.add_argument("--json", type=Path, help="every answer")
    parser.add_argument(
        "--records", type=Path, metavar="FILE", help="keep the answers as they come, and continue with them"
    )
    parser.add_argument("--same-as", type=Path, metavar="FILE", help="records that the answers have to be equal to")
    parser.add_argument("--kinds", default="", help="only these, separated by commas")
    parser.add_argument("--details", action="store_true", help="a line for each kind, program and arithmetic")
    parser.add_argument("--case", type=int, metavar="N", help="only case N of each kind")
    parser.add_argument("--number", type=int, metavar="N", help="only the Nth case, counted from 1; prints JSON")
    parser.add_argument(
        "--write", type=Path, metavar="FILE", help="write the recording of one case and print the command that runs it"
    )
    options = parser.parse_args()
    options.kinds = options.kinds.split(",") if options.kinds else [*verdict_kinds.GOOD, *verdict_kinds.BROKEN]
    options.programs, options.arithmetic = options.programs.split(","), options.arithmetic.split(",")
    for given, known in (
        (options.kinds, {*verdict_kinds.GOOD, *verdict_kinds.BROKEN}),
        (options.programs, set(verdict_sensors.PLANS)),
        (options.arithmetic, {"precise", "paper"}),
    ):
        if unknown := sorted(set(given) - known):
            parser.error(f"'{unknown[0]}' is not known; choose from {', '.join(sorted(known))}")
    return options


def chosen(options):
    """The cases: for good sensors of other motions only the programs that can have them."""

    def count(kind):
        return options.good if kind == "good" else options.good // 5 if kind in verdict_kinds.GOOD else options.broken

    return [
        Item(kind, number, program, arithmetic, options.seed, options.coprocessor, options.build.resolve())
        for kind in options.kinds
        for program in options.programs
        for arithmetic in options.arithmetic
        for number in ([options.case] if options.case is not None else range(count(kind)))
        if (arithmetic == "precise" or program not in PRECISE_ONLY)
        and program in (verdict_kinds.GOOD.get(kind, (0, 0, None))[2] or options.programs)
    ]


def main():
    options = arguments()
    items = chosen(options)
    if options.write:
        if len({item[:3] for item in items}) != 1 or options.case is None:
            refuse("--write needs one kind, one case and one program: --kinds K --case N --programs P")
        print(shlex.join(make_recording(items[0], options.write)[1]))
        return 0
    if options.number is not None:
        if not 1 <= options.number <= len(items):
            refuse(f"--number {options.number}: there are 1 .. {len(items)}")
        answer = one_case(items[options.number - 1])
        right = answer["outcome"] in RIGHT
        print(json.dumps({"bound": None, "error": None, **answer, "right": right}))
        return 0
    if not items:
        refuse("no case is left: the arithmetic paper has no quick, harmonics or follow")
    version = subprocess.run(
        [str(options.build / "capsoc"), "--version"], stdout=subprocess.PIPE, check=True, env=CLEAN
    )
    head = {"capsoc": version.stdout.decode().strip(), "coprocessor": options.coprocessor, "seed": options.seed}
    known = read_records(options.records, head) if options.records else {}
    others = read_records(options.same_as, None) if options.same_as else {}
    answers = run_cases(items, known, head, options)
    print(f"seed {options.seed}, coprocessor {options.coprocessor}")
    print("\n".join(kind_table(answers, ("kind", "program", "arithmetic") if options.details else ("kind",))))
    lines, bad = faults(answers, options.seed)
    print("\n".join([*good_tables(answers), *lines]))
    different = []
    if options.same_as:
        common, different = differing(answers, others)
        print(f"other answers than {options.same_as.name}: {len(different)} of {len(common)}")
        for answer in different:
            print(f"  {answer['case']}: {answer['outcome']} here, {others[answer['case']]['outcome']} there")
    if options.json:
        options.json.write_text(json.dumps({"seed": options.seed, "answers": answers}, indent=1))
    return 1 if bad or different else 0


if __name__ == "__main__":
    sys.exit(main())
