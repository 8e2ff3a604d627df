"""The verdicts of campaigns of faults side by side: a column for each value, or pair of values, of some settings.

usage: fault_table STORE.sqlite... [--by SETTING,...] [--only SETTING=VALUE,...] [--limit DEG] [--silent]
[--build FOLDER]

Counts, shares and 95 % intervals (Wilson) of each verdict; then, of the faults that made an angle more than --limit
degrees wrong, how many something had detected within 0, 1, 3, 10 and 5,000 samples. --silent lists the silent ones,
each as a line that --inject takes. The stores of several descriptions are counted together.

Status 0: the table was printed; 2: usage, a store that is none, or a setting that the store's runs do not have.
"""

import argparse
import collections
import json
import math
import subprocess
import sys
import tempfile
from pathlib import Path

from capsoc_tools import ROOT as TOP
from capsoc_tools.faults.fault_verdicts import CLEAN, INTERVALS, VERDICTS, wilson

BY = "coprocessor.backend,firmware.elf"


class TableError(Exception):
    """One sentence for the user."""


def columns_of(store, build, file):
    """The campaign's rows as lists, one for each key."""
    done = subprocess.run(
        [build / "capsoc", "campaign", "export", store, "--json", file, "--all"],
        env=CLEAN,
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode != 0:
        raise TableError(done.stderr.strip().removeprefix("capsoc: "))
    return json.loads(Path(file).read_text(encoding="utf-8"))


def rows_of(stores, names, build):
    """A dictionary for each run that ended with a verdict; a run out of time hangs."""
    rows = []
    with tempfile.TemporaryDirectory(prefix="capsoc-faults-") as folder:
        for store in stores:
            columns = columns_of(store, build, Path(folder) / "rows.json")
            for name in [*names, "verdict"]:
                if name not in columns:
                    raise TableError(f"{store}: its runs have no '{name}'; an axis of the description, or a result")
            for i, ending in enumerate(columns["ending"]):
                row = {name: values[i] for name, values in columns.items()}
                if ending == "out of time":
                    row["verdict"] = "hung"
                if row["verdict"] in VERDICTS:
                    rows.append(row)
    return rows


def short(value):
    """A name without its folder and ending."""
    text = f"{value:g}" if isinstance(value, float) else str(value)
    return Path(text).stem if "/" in text else text


def group_of(row, names):
    return tuple(short(row[name]) for name in names)


def print_rows(title, groups, cell):
    print(f"{title:<22}" + "".join(f"{cell(rows):>30}" for rows in groups.values()))


def share(hits, count):
    """The count, its share and the interval, in percent."""
    if count == 0:
        return "-"
    if hits == 0:
        return f"0 (to {100 * wilson(0, count)[1]:.3g} %)"
    low, high = (f"{100 * bound:.3g}" for bound in wilson(hits, count))
    return f"{hits}, {100 * hits / count:.3g} % ({low} to {high})"


def wrong_of(rows, limit):
    return [row for row in rows if (row["error_deg"] or 0) > limit or row["trusted_wrong_samples"]]


def within(rows, most):
    return sum(not missing(row["detected.after_samples"]) and row["detected.after_samples"] <= most for row in rows)


def missing(value):
    return value is None or (isinstance(value, float) and math.isnan(value))


def print_table(rows, options):
    groups = collections.defaultdict(list)
    for row in rows:
        groups[group_of(row, options.by)].append(row)
    groups = dict(sorted(groups.items()))
    print(f"{'':<22}" + "".join(f"{' '.join(group):>30}" for group in groups))
    print_rows("faults", groups, lambda rows: str(len(rows)))
    for verdict in VERDICTS:
        print_rows(verdict, groups, lambda rows: share(sum(row["verdict"] == verdict for row in rows), len(rows)))
    print_rows(f"off by > {options.limit:g} deg", groups, lambda rows: str(len(wrong_of(rows, options.limit))))
    for most in INTERVALS:
        print_rows(f"  within {most} samples", groups, lambda rows: detected(wrong_of(rows, options.limit), most))


def detected(wrong, most):
    return share(within(wrong, most), len(wrong))


def options_of(words):
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", 1)[0], prog="fault_table")
    parser.add_argument("stores", nargs="+", type=Path, metavar="STORE.sqlite")
    parser.add_argument("--by", default=BY, help=f"settings or results that tell the columns apart ({BY})")
    parser.add_argument("--only", default="", metavar="SETTING=VALUE,...", help="only runs with these values")
    parser.add_argument("--limit", type=float, default=0.1, metavar="DEG", help="a larger error is wrong (0.1)")
    parser.add_argument("--silent", action="store_true", help="list the silent faults")
    parser.add_argument("--build", type=Path, default=TOP / "build", metavar="FOLDER", help="of the program (build)")
    options = parser.parse_args(words)
    options.by = [name for name in options.by.split(",") if name]
    options.only = [pair.partition("=") for pair in options.only.split(",") if pair]
    if not options.by or any(not sign for _, sign, _ in options.only):
        parser.error("give --by at least one name, and --only names with their values")
    return options


def main():
    options = options_of(sys.argv[1:])
    try:
        rows = rows_of(options.stores, [*options.by, *(name for name, _, _ in options.only)], options.build.resolve())
    except TableError as error:
        print(f"fault_table: {error}", file=sys.stderr)
        return 2
    rows = [row for row in rows if all(short(row[name]) == value for name, _, value in options.only)]
    print_table(rows, options)
    if options.silent:
        for row in rows:
            if row["verdict"] == "silent":
                group = " ".join(group_of(row, options.by))
                samples = row["trusted_wrong_samples"]
                print(f"silent ({group}): {row['fault.line']}: {row['error_deg']:.6g} deg, {samples:.0f} samples")
    return 0


if __name__ == "__main__":
    sys.exit(main())
