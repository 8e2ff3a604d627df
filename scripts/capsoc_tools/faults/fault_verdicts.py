"""Takes random faults in proportion to bits, injects each into its own run, and says what became of the run.

usage: fault_verdicts [--count N] [--seed S] [--jobs N] [--units TEXT,...] [--kind flip|stuck0|stuck1]
[--coprocessor tlm|rtl] [--pipeline] [--program NAME] [--from S] [--to S] [--until S] [--limit DEG] [--silent N]
[--store FILE.sqlite] [--rows FILE.csv] [--rates FILE.toml] [--build FOLDER] [-- PATH=VALUE...]

A campaign of kind `fault` (docs/guide/safety.md), described by these options, and a table of its verdicts. With --store
an interrupted one resumes where it was, and capsoc campaign report shows it. With --rates, failure rates of a bit by
unit (capsoc_tools/faults/rates.py), the single-point and the latent fault metric. PATH=VALUE are settings of the runs.

Status 0: the table was printed; 2: usage, or the golden run failed. The rows depend on seed and options alone.
"""

import argparse
import collections
import csv
import json
import math
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from capsoc_tools import ROOT as TOP
from capsoc_tools.faults import rates as failure_rates

CLEAN = {k: v for k, v in os.environ.items() if not k.startswith("CAPSOC_")}
VERDICTS = ("unapplied", "silent", "detected", "crashed", "hung", "wrong", "masked", "latent")
#: Samples from the first wrong angle, within which a detection counts; a turn of the main job has 5,000.
INTERVALS = (0, 1, 3, 10, 5000)
KEYS = {
    "number": "run",
    "unit": "fault.unit",
    "fault": "fault.line",
    "verdict": "verdict",
    "by": "detected.by",
    "after": "detected.after_samples",
    "largest_deg": "error_deg",
    "trusted": "trusted_wrong_samples",
    "not_simulated": "not_simulated",
}
LIMITS = {"seconds": 60}


def wilson(hits, count, z=1.959964):
    """The 95 % interval of a share."""
    share = hits / count
    middle = share + z * z / (2 * count)
    half = z * math.sqrt(share * (1 - share) / count + z * z / (4 * count * count))
    scale = 1 + z * z / count
    return max(0.0, (middle - half) / scale), min(1.0, (middle + half) / scale)


def description(options):
    """The campaign of the options, as TOML."""
    settings = {
        "firmware.elf": str(options.build / "firmware" / f"{options.program}.elf"),
        "coprocessor.backend": options.coprocessor,
        "fault.units": options.units,
        "fault.kind": options.kind,
        "fault.pipeline": options.pipeline,
        "fault.from_s": options.begin,
        "fault.to_s": options.end,
        "fault.until_s": options.until,
        "fault.limit_deg": options.limit,
        "fault.silent_samples": options.silent,
        **dict(word.split("=", 1) for word in options.rest),
    }
    lines = ['name = "faults"', 'kind = "fault"', f"seed = {options.seed}", "least_yield = 0", "[settings]"]
    # TOML's texts, numbers and truth values are written as JSON's.
    lines += [f"{name} = {json.dumps(value)}" for name, value in settings.items()]
    lines += ["[repetitions]", f"count = {options.count}", 'seeds = ["fault.seed"]']
    lines += ["[by]", 'unit = "fault.unit"', 'place = "fault.place"']
    lines += ["[limits]", *(f"{name} = {value}" for name, value in LIMITS.items())]
    return "\n".join(lines) + "\n"


class CampaignError(Exception):
    """One sentence for the user."""


def capsoc(build, *words):
    """The output of `capsoc campaign`. CampaignError with its own sentence."""
    done = subprocess.run(
        [build / "capsoc", "campaign", *map(str, words)], env=CLEAN, capture_output=True, text=True, check=False
    )
    if done.returncode not in (0, 1):
        raise CampaignError(done.stderr.strip().removeprefix("capsoc: "))
    return done.stdout


def results_of(build, store):
    """A dictionary with all keys for each run of a store. A run out of time hangs. CampaignError: no verdict."""
    with tempfile.TemporaryDirectory(prefix="capsoc-faults-") as folder:
        file = Path(folder) / "rows.json"
        capsoc(build, "export", store, "--json", file, "--all")
        columns = json.loads(file.read_text(encoding="utf-8"))
    results = [dict(zip(columns, values)) for values in zip(*columns.values())]
    for result in results:
        ending = result["ending"]
        if ending.startswith("refused: "):
            raise CampaignError(ending.removeprefix("refused: "))
        if ending == "out of time":
            result["verdict"] = "hung"
        elif ending != "finished":
            raise CampaignError(f"{store}: run {result['run']} {ending}")
        elif result.get("verdict") not in VERDICTS:
            raise CampaignError(f"{store}: its runs have no verdict of a fault; it is a campaign of another kind")
    return results


def rows_of(options, store):
    """A row for each fault, with the keys of KEYS."""
    return [{name: result.get(key) for name, key in KEYS.items()} for result in results_of(options.build, store)]


def made_wrong(error_deg, trusted, limit):
    """An angle was off by more than the limit, or did not come."""
    return (error_deg or 0) > limit or bool(trusted)


def print_table(rows, options):
    print(f"{len(rows)} faults, seed {options.seed}, limit {options.limit} deg for {options.silent} samples")
    print(f"{'verdict':<10}{'faults':>8}{'share':>10}   95 % interval (Wilson)")
    verdicts = collections.Counter(row["verdict"] for row in rows)
    for verdict in VERDICTS:
        hits = verdicts[verdict]
        low, high = wilson(hits, len(rows))
        print(f"{verdict:<10}{hits:>8}{hits / len(rows):>10.4f}   {low:.4f} to {high:.4f}")
    units = collections.Counter((row["unit"], row["verdict"]) for row in rows)
    print(f"\n{'unit':<28}" + "".join(f"{verdict:>10}" for verdict in VERDICTS))
    for unit in sorted({row["unit"] or "" for row in rows}):
        print(f"{unit:<28}" + "".join(f"{units[unit, verdict]:>10}" for verdict in VERDICTS))
    means = collections.Counter(row["by"] for row in rows if row["verdict"] == "detected")
    if means:
        print("\ndetected by: " + ", ".join(f"{name} {count}" for name, count in sorted(means.items())))
    print_coverage(rows, options)
    for reason, count in sorted(
        collections.Counter(row["not_simulated"] for row in rows if row["not_simulated"]).items()
    ):
        print(f"\n{count} latent ones were not simulated: {reason}")
    for row in rows:
        if row["verdict"] == "silent":
            print(f"silent: {row['fault']}: {row['largest_deg']:.6g} deg, {row['trusted']} samples")


def print_coverage(rows, options):
    """Of the faults that make an angle wrong: how many something has detected by then."""
    wrong = [row for row in rows if made_wrong(row["largest_deg"], row["trusted"], options.limit)]
    if not wrong:
        return
    print(f"\nof {len(wrong)} faults that made an angle wrong, detected")
    for most in INTERVALS:
        hits = sum(row["after"] is not None and row["after"] <= most for row in wrong)
        low, high = wilson(hits, len(wrong))
        print(f"  within {most:>4} samples {hits:>7}{hits / len(wrong):>10.4f}   {low:.4f} to {high:.4f}")


def rated_bits(options):
    """The rates, and the bits of each unit that faults come from. Before anything runs."""
    try:
        rates = failure_rates.read_rates(options.rates)
        settings = {"coprocessor.backend": options.coprocessor, **dict(word.split("=", 1) for word in options.rest)}
        words = [word for name, value in settings.items() for word in ("-C", f"{name}={value}")]
        run = [options.build / "capsoc", "run", options.build / "firmware" / f"{options.program}.elf", *words]
        bits = failure_rates.bits_of(run, [unit for unit in options.units.split(",") if unit])
        for unit in bits:
            failure_rates.rate_of(rates, unit, options.rates)
    except ValueError as error:
        raise SystemExit(f"fault_verdicts: {error}") from None
    return rates, bits


def print_metrics(rows, rates, bits, options):
    try:
        units = failure_rates.units_of(rows, bits, rates, options.rates)
    except ValueError as error:
        raise SystemExit(f"fault_verdicts: {error}") from None
    failure_rates.print_metrics(units, lambda hits, count: wilson(hits, count)[1])
    unknown = sum(row["unit"] is None for row in rows)
    if unknown:
        print(f"left out: {unknown} faults whose runs took longer than {LIMITS['seconds']} s of the host")


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
    parser.add_argument("--store", type=Path, metavar="FILE.sqlite", help="of the campaign, kept")
    parser.add_argument("--rows", type=Path, metavar="FILE.csv", help="a row for each fault")
    parser.add_argument("--rates", type=Path, metavar="FILE.toml", help="failures of a bit in 1e9 hours, by unit")
    parser.add_argument("--build", type=Path, default=TOP / "build", metavar="FOLDER", help="of the program (build)")
    options = parser.parse_args(own)
    options.rest = rest
    options.build = options.build.resolve()
    if options.count < 1 or options.jobs < 1 or not all("=" in word for word in rest):
        parser.error("give at least one fault and one job, and PATH=VALUE after --")
    return options


def main():
    options = options_of(sys.argv[1:])
    rates, bits = rated_bits(options) if options.rates else (None, None)
    with tempfile.TemporaryDirectory(prefix="capsoc-faults-") as folder:
        file = Path(folder) / "faults.toml"
        file.write_text(description(options), encoding="utf-8")
        store = options.store or Path(folder) / "faults.sqlite"
        begin = time.monotonic()
        try:
            capsoc(options.build, "run", file, "--store", store, "--jobs", options.jobs)
            seconds = time.monotonic() - begin
            rows = rows_of(options, store)
        except CampaignError as error:
            raise SystemExit(f"fault_verdicts: {error}") from None
    print_table(rows, options)
    if rates:
        print_metrics(rows, rates, bits, options)
    print(f"{len(rows) / seconds:.1f} faults/s with {options.jobs} jobs", file=sys.stderr)
    if options.rows:
        with open(options.rows, "w", encoding="ascii", newline="") as out:
            writer = csv.DictWriter(out, KEYS, lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)


if __name__ == "__main__":
    main()
