"""Draws faults in proportion to bits, injects each into a run of its own, and says what became of the run.

usage: fault_verdicts [--count N] [--seed S] [--jobs N] [--units TEXT,...] [--kind flip|stuck0|stuck1]
[--coprocessor tlm|rtl] [--pipeline] [--program NAME] [--from S] [--to S] [--until S] [--limit DEG] [--silent N]
[--rows FILE.csv] [--build FOLDER] [-- OPTION...]

With --pipeline the time is a sample and one of the cycles that the pipeline takes for it, so that flip-flops of the RTL
are hit while they hold something.

A golden run saves checkpoints between --from and --to. A fault is a bit of `capsoc run --list-fault-places` at a time
between these; each run goes on from the nearest checkpoint before it and is compared with the same run without the
fault, sample by sample. Both end with the program. The verdicts, in the order in which they are given:

refused   capsoc does not take the fault (exit 2)
crashed   the program crashed, with a report (exit 5)
hung      the program does not end (exit 124)
unapplied nothing changed: the run ended before the fault's time, or the bit cannot be changed
silent    an angle was more than --limit off, or did not come, for more than --silent samples, with VALID, LOCK and no
          alarm
detected  an angle was off or the program failed, and a flag, an alarm or the exit code said so
wrong     an angle was more than --limit off, or did not come, for so few samples that it counts as no failure
masked    all results were as without the fault, and so is the whole state at --until
latent    all angles were within --limit, but the state at --until is another

Status 0: the table was printed; 2: usage, or the golden run failed. The rows depend on seed and options alone.
"""

import argparse
import collections
import concurrent.futures
import csv
import json
import math
import os
import random
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from capsoc_tools import ROOT as TOP

CLEAN = {k: v for k, v in os.environ.items() if not k.startswith("CAPSOC_")}
VERDICTS = ("refused", "crashed", "hung", "unapplied", "silent", "detected", "wrong", "masked", "latent")
#: What detects: bits of STATUS (models/registers/capsoc.svd) that go or come, and bits of FLAGS that come.
LOCK, DIVERGED, MIRROR, VALID, ALARM = 1 << 1, 1 << 2, 1 << 3, 1 << 4, 1 << 5
STATUS_GOES = {"LOCK": LOCK, "VALID": VALID}
STATUS_COMES = {"DIVERGED": DIVERGED, "MIRROR": MIRROR, "ALARM": ALARM}
FLAG_COMES = {"CLIP": 1, "SAT": 2, "ZERO": 3, "EARLY": 4, "LOCKCHG": 5, "CONFIG": 8, "UNSETTLED": 11}
#: Seconds between two checkpoints, and of the host that a run may take: a hang is found by the simulated limit.
EVERY, PATIENCE = 1.0, 60
#: Clock cycles from a sample to its result (docs/coprocessor.md, "Time").
PIPELINE = 162
COLUMNS = "found_deg,status,flags"
#: Parts of a checkpoint that are on the host.
HOST = ("observation", "host")


def wilson(hits, count, z=1.959964):
    """The 95 % interval of a share."""
    share = hits / count
    middle = share + z * z / (2 * count)
    half = z * math.sqrt(share * (1 - share) / count + z * z / (4 * count * count))
    scale = 1 + z * z / count
    return max(0.0, (middle - half) / scale), min(1.0, (middle + half) / scale)


def state_of(checkpoint):
    """Hashes of the parts of the chip; None without a file."""
    try:
        with open(checkpoint, "rb") as file:
            size = int(file.readline().split()[3])
            parts = json.loads(file.read(size))["parts"]
    except OSError:
        return None
    return {part["name"]: part["sha256"] for part in parts if part["name"] not in HOST}


def samples_of(recording):
    """(angle in degrees or None, STATUS, FLAGS) of each sample; None of a sample without a result."""
    samples = []
    for row in csv.reader(line for line in open(recording, encoding="ascii") if line[0] not in "#f"):
        samples.append((float(row[0]) if row[0] else None, int(row[1]), int(row[2])) if row[1] else None)
    return samples


class Run:
    """A run from a checkpoint to its end: exit code, samples, state."""

    def __init__(self, command, folder, *options):
        folder.mkdir(parents=True, exist_ok=True)
        names = [folder / name for name in ("samples.csv", "end.capsoc", "r.json")]
        for name in names:
            name.unlink(missing_ok=True)
        done = subprocess.run(
            [*command, "--record", names[0], "--record-columns", COLUMNS, "--json", names[2], *map(str, options)],
            cwd=folder,
            env=CLEAN,
            capture_output=True,
            text=True,
            check=False,
            timeout=PATIENCE,
        )
        self.code, self.said = done.returncode, done.stderr
        self.samples = samples_of(names[0]) if names[0].exists() else []
        self.state = state_of(names[1])
        self.result = json.loads(names[2].read_text()) if names[2].exists() else {}
        self.is_applied = all(fault["applied"] and "note" not in fault for fault in self.result.get("faults", []))


def detection(sample, golden):
    """What says that something is wrong which does not without the fault; None: nothing does."""
    status, flags, was, were = sample[1], sample[2], golden[1], golden[2]
    for name, bit in STATUS_GOES.items():
        if was & bit and not status & bit:
            return f"no {name}"
    for name, bit in STATUS_COMES.items():
        if status & bit and not was & bit:
            return name
    for name, bit in FLAG_COMES.items():
        if flags >> bit & 1 and not were >> bit & 1:
            return name
    return None


def off_by(sample, golden):
    """Degrees between two angles; 0 where one of them is none."""
    if sample[0] is None or golden[0] is None:
        return 0.0
    return abs((sample[0] - golden[0] + 180) % 360 - 180)


def is_trusted(sample):
    return sample[1] & (VALID | LOCK) == VALID | LOCK and not sample[1] & (ALARM | DIVERGED)


def judged(run, golden, limit, silent):
    """Verdict, what detected it, samples from the first wrong angle to that, largest error, trusted wrong samples."""
    first, found, largest, trusted, last = None, None, 0.0, 0, None
    # A program that gives up earlier takes no more samples.
    ends = len(golden.samples) if run.code == golden.code else len(run.samples)
    for number, was in enumerate(golden.samples[:ends]):
        sample = run.samples[number] if number < len(run.samples) else None
        if was is None:
            continue
        if sample is None:
            # Who reads the angle gets the one before.
            first = number if first is None else first
            trusted += found is None and is_trusted(last or was)
            continue
        last = sample
        error = off_by(sample, was)
        largest = max(largest, error)
        if error > limit:
            first = number if first is None else first
            trusted += found is None and is_trusted(sample)
        if found is None and (what := detection(sample, was)):
            found = what, number
    by, after = (found[0], max(0, found[1] - (found[1] if first is None else first))) if found else ("", "")
    if run.code == 2:
        verdict = "refused"
    elif run.code == 5:
        verdict, by = "crashed", "fault report"
    elif run.code == 124:
        verdict = "hung"
    elif not run.is_applied:
        verdict = "unapplied"
    elif trusted > silent:
        verdict = "silent"
    elif found or run.code != golden.code:
        verdict, by = "detected", by or f"exit {run.code}"
    elif first is not None:
        verdict = "wrong"
    elif run.samples == golden.samples and run.state == golden.state:
        verdict = "masked"
    else:
        verdict = "latent"
    return verdict, by, after, largest, trusted


def drawn(places, options, first_samples):
    """(unit, fault, checkpoint) with each bit as likely as another one, and each time.

    `first_samples`: checkpoint -> number of the first sample after it.
    """
    draw = random.Random(options.seed)
    weights = [place["bits"] for place in places]
    times = sorted(first_samples)
    for place in draw.choices(places, weights, k=options.count):
        bit = f"{options.kind} {place['place']}[{draw.randrange(place['bits'])}]"
        if options.pipeline:
            sample = draw.randrange(first_samples[times[0]], first_samples[times[-1]])
            at = max(time for time in times if first_samples[time] <= sample)
            yield place["unit"], f"{bit} at sample {sample} cycle {draw.randrange(PIPELINE)}", at
        else:
            when = round(draw.uniform(options.begin, options.end), 6)
            # A checkpoint is saved a little behind its time.
            at = max((time for time in times if time < when - 1e-3), default=times[0])
            yield place["unit"], f"{bit} at {when}s", at


class Campaign:
    """The golden runs, and each fault's beside them."""

    def __init__(self, options, folder):
        self.options, self.folder = options, folder
        program = options.build / "firmware" / f"{options.program}.elf"
        self.command = [options.build / "capsoc", "run", program, "-C", "log.level=off", "--uart0", "null"]
        self.command += ["--coprocessor", options.coprocessor, *options.rest]
        steps = int((options.end - options.begin) / EVERY) + 1
        self.times = [options.begin + EVERY * step for step in range(steps)]
        saves = [word for at in self.times for word in ("--save", f"{self.checkpoint(at)}@{at}")]
        self.whole = Run(self.command, folder / "golden", *saves)
        if any(not self.checkpoint(at).exists() for at in self.times):
            raise SystemExit(
                f"fault_verdicts: the golden run saved too little, exit {self.whole.code}:\n{self.whole.said}"
            )
        self.ended = self.whole.result["time"]["simulated_s"]
        self.golden = {at: self.run_from(at, folder / f"golden-{at}") for at in self.times}
        if any(run.state is None for run in self.golden.values()):
            raise SystemExit(f"fault_verdicts: the program ended at {self.ended} s; give an earlier --until")

    def checkpoint(self, at):
        return self.folder / f"at-{at}.capsoc"

    def run_from(self, at, folder, *more):
        limit = self.ended + 1.0
        end = f"end.capsoc@{self.options.until}"
        return Run(self.command, folder, "--restore", self.checkpoint(at), "--save", end, "--simlimit", limit, *more)

    def first_samples(self):
        """Checkpoint -> number of a sample soon after it. Results are counted, of which software has a few."""
        taken = self.whole.result["samples"]
        return {at: taken - len(run.samples) + 5 for at, run in self.golden.items()}

    def places(self):
        listed = subprocess.run(
            [*self.command, "--list-fault-places"], env=CLEAN, capture_output=True, text=True, check=True
        )
        wanted = self.options.units.split(",") if self.options.units else [""]
        places = json.loads(listed.stdout)["places"]
        return [place for place in places if any(place["unit"].startswith(unit) for unit in wanted)]

    def row(self, case):
        number, (unit, fault, at) = case
        with tempfile.TemporaryDirectory(dir=self.folder) as folder:
            run = self.run_from(at, Path(folder), "--inject", fault)
        verdict, by, after, largest, trusted = judged(run, self.golden[at], self.options.limit, self.options.silent)
        return number, unit, fault, verdict, by, after, f"{largest:.6g}", trusted, run.code


def print_table(rows, options, seconds):
    print(f"{len(rows)} faults, seed {options.seed}, limit {options.limit} deg for {options.silent} samples")
    print(f"{'verdict':<10}{'faults':>8}{'share':>10}   95 % interval (Wilson)")
    verdicts = collections.Counter(row[3] for row in rows)
    for verdict in VERDICTS:
        hits = verdicts[verdict]
        low, high = wilson(hits, len(rows))
        print(f"{verdict:<10}{hits:>8}{hits / len(rows):>10.4f}   {low:.4f} to {high:.4f}")
    units = collections.Counter((row[1], row[3]) for row in rows)
    print(f"\n{'unit':<28}" + "".join(f"{verdict:>10}" for verdict in VERDICTS))
    for unit in sorted({row[1] for row in rows}):
        print(f"{unit:<28}" + "".join(f"{units[unit, verdict]:>10}" for verdict in VERDICTS))
    means = collections.Counter(row[4] for row in rows if row[3] == "detected")
    if means:
        print("\ndetected by: " + ", ".join(f"{name} {count}" for name, count in sorted(means.items())))
        within = [row[5] for row in rows if row[3] == "detected" and row[5] != ""]
        for most in (0, 1, 3, 10, 5000):
            print(f"  within {most} samples of the first wrong angle: {sum(after <= most for after in within)}")
    for row in rows:
        if row[3] == "silent":
            print(f"silent: {row[2]}: {row[6]} deg, {row[7]} samples")
    print(f"{len(rows) / seconds:.1f} faults/s with {options.jobs} jobs", file=sys.stderr)


def options_of(words):
    own, rest = (words[: words.index("--")], words[words.index("--") + 1 :]) if "--" in words else (words, [])
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", 1)[0], prog="fault_verdicts")
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--units", default="coprocessor", help="beginnings of units to draw from (coprocessor)")
    parser.add_argument("--kind", choices=("flip", "stuck0", "stuck1"), default="flip")
    parser.add_argument("--coprocessor", choices=("tlm", "rtl"), default="tlm")
    parser.add_argument("--pipeline", action="store_true", help="at a cycle of the pipeline instead of any time")
    parser.add_argument("--program", default="selfcal", help="of the firmware (selfcal)")
    parser.add_argument("--from", type=float, default=402.0, dest="begin", metavar="S", help="faults come from here")
    parser.add_argument("--to", type=float, default=410.0, dest="end", metavar="S", help="to here")
    parser.add_argument("--until", type=float, default=418.0, metavar="S", help="where states are compared")
    parser.add_argument("--limit", type=float, default=0.1, metavar="DEG", help="a larger error is wrong (0.1)")
    parser.add_argument("--silent", type=int, default=3, metavar="N", help="samples that may be wrong (3)")
    parser.add_argument("--rows", type=Path, metavar="FILE.csv", help="a row for each fault")
    parser.add_argument("--build", type=Path, default=TOP / "build", metavar="FOLDER", help="of the program (build)")
    options = parser.parse_args(own)
    options.rest = rest
    options.build = options.build.resolve()
    if options.count < 1 or options.jobs < 1 or not 0 < options.begin < options.end < options.until:
        parser.error("give at least one fault and one job, and times 0 < --from < --to < --until")
    return options


def main():
    options = options_of(sys.argv[1:])
    with tempfile.TemporaryDirectory(prefix="capsoc-faults-") as folder:
        campaign = Campaign(options, Path(folder))
        places = campaign.places()
        if not places:
            raise SystemExit(f"fault_verdicts: no unit begins with {options.units}; capsoc run --list-fault-places")
        begin = time.monotonic()
        with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
            rows = list(pool.map(campaign.row, enumerate(drawn(places, options, campaign.first_samples()))))
        seconds = time.monotonic() - begin
    print_table(rows, options, seconds)
    if options.rows:
        with open(options.rows, "w", encoding="ascii", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(("number", "unit", "fault", "verdict", "by", "after", "largest_deg", "trusted", "exit"))
            writer.writerows(rows)


if __name__ == "__main__":
    main()
