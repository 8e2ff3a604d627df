"""The verdicts of campaigns of faults side by side: a column for each value, or pair of values, of some settings.

usage: fault_table STORE.sqlite... [--by SETTING,...] [--only SETTING=VALUE,...] [--limit DEG] [--silent]
[--alike SETTING] [--build FOLDER]

Counts, shares and 95 % intervals (Wilson) of each verdict; then, of the faults that made an angle more than --limit
degrees wrong, how many something had detected within 0, 1, 3, 10 and 5,000 samples. --silent lists the silent ones,
each as a line that --inject takes. --alike lists the faults of which something else became with another value of
SETTING. The stores of several descriptions are counted together.

Status 0: the table was printed. 1: --alike lists faults, or has none to compare. 2: usage, a store that is none, a run
that ended without a verdict, or a setting that the store's runs do not have.
"""

import argparse
import collections
import sys
from pathlib import Path

from capsoc_tools import ROOT as TOP
from capsoc_tools.faults.fault_verdicts import INTERVALS, VERDICTS, CampaignError, made_wrong, results_of, wilson

BY = "coprocessor.backend,firmware.elf"
OUTCOME = ("verdict", "detected.by", "detected.after_samples", "error_deg", "trusted_wrong_samples", "simulated_s")


def results_with(names, stores, build):
    """The runs of all stores. CampaignError: they have none of that name."""
    results = []
    for store in stores:
        results += results_of(build, store)
        for name in names:
            if results and name not in results[-1]:
                raise CampaignError(f"{store}: its runs have no '{name}'; an axis of the description, or a result")
    return results


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
    return [row for row in rows if made_wrong(row["error_deg"], row["trusted_wrong_samples"], limit)]


def within(wrong, most):
    """How many of them something had detected by then."""
    after = [row["detected.after_samples"] for row in wrong]
    return share(sum(samples is not None and samples <= most for samples in after), len(wrong))


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
        print_rows(f"  within {most} samples", groups, lambda rows: within(wrong_of(rows, options.limit), most))


def print_alike(rows, setting, by):
    """Whether the same became of each fault for all values of a setting. By: what else tells its runs apart."""
    values = {row[setting] for row in rows}
    runs = collections.defaultdict(lambda: collections.defaultdict(set))
    for row in rows:
        fault = (row["fault.line"], *(row[name] for name in by if name != setting))
        runs[fault][row[setting]].add(tuple(row.get(name) for name in OUTCOME))
    compared = {fault: outcomes for fault, outcomes in runs.items() if len(values) > 1 and outcomes.keys() == values}
    differ = {fault: outcomes for fault, outcomes in compared.items() if len(set.union(*outcomes.values())) > 1}
    count = len(compared) - len(differ)
    print(f"alike: {count} of {len(compared)} faults with {setting} {', '.join(sorted(map(short, values)))}", end="")
    print(f"; {len(runs) - len(compared)} without a run for each" if len(compared) < len(runs) else "")
    for fault, outcomes in differ.items():
        said = "; ".join(f"{short(value)}: {sorted(map(str, found))}" for value, found in sorted(outcomes.items()))
        print(f"differs ({' '.join(map(short, fault[1:]))}): {fault[0]}: {said}")
    return bool(compared) and not differ


def options_of(words):
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", 1)[0], prog="fault_table")
    parser.add_argument("stores", nargs="+", type=Path, metavar="STORE.sqlite")
    parser.add_argument("--by", default=BY, help=f"settings or results that tell the columns apart ({BY})")
    parser.add_argument("--only", default="", metavar="SETTING=VALUE,...", help="only runs with these values")
    parser.add_argument("--limit", type=float, default=0.1, metavar="DEG", help="a larger error is wrong (0.1)")
    parser.add_argument("--silent", action="store_true", help="list the silent faults")
    parser.add_argument(
        "--alike", metavar="SETTING", help="list the faults of which something else became with another value"
    )
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
        names = [*options.by, *(name for name, _, _ in options.only), *filter(None, [options.alike])]
        rows = results_with(names, options.stores, options.build.resolve())
    except CampaignError as error:
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
    if options.alike and not print_alike(rows, options.alike, options.by):
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
