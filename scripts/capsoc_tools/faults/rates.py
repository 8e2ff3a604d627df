"""Single-point and latent fault metric (ISO 26262-5, annex C) from failure rates and the verdicts of injected faults.

A file of rates (TOML) names units, or how their names begin, and the failures of one bit in 1e9 hours (FIT):

    [fit_per_bit]
    coprocessor = 1e-4
    processor = 2e-4

A unit's rate is that of a bit times its bits. The share of its faults that are residual or latent is that of the
faults that were injected into it.
"""

import collections
import json
import math
import subprocess
import sys
import tomllib
from dataclasses import dataclass


@dataclass(frozen=True)
class Unit:
    """Rate and verdicts of one unit. residual: faults not detected in time; latent: without any effect so far."""

    name: str
    bits: int
    fit: float  # of all bits
    faults: int
    residual: int
    latent: int


@dataclass(frozen=True)
class Metric:
    """A metric, and what it is at least with 95 % confidence in each unit."""

    value: float
    least: float


def read_rates(file):
    """FIT of a bit by the beginning of a unit's name. ValueError: what is wrong with the file."""
    try:
        with open(file, "rb") as rates:
            table = tomllib.load(rates)
    except (OSError, tomllib.TOMLDecodeError) as error:
        raise ValueError(f"{file}: {error}") from None
    found = table.get("fit_per_bit")
    if set(table) != {"fit_per_bit"} or not isinstance(found, dict) or not found:
        raise ValueError(f"{file}: has to have one table, [fit_per_bit], with UNIT = FIT")
    for unit, fit in found.items():
        if isinstance(fit, bool) or not isinstance(fit, (int, float)) or not 0 < fit < math.inf:
            raise ValueError(f"{file}: {unit}: has to be a number above 0")
    return found


def rate_of(rates, unit, file):
    """That of the longest beginning of the unit's name."""
    known = [name for name in rates if unit.startswith(name)]
    if not known:
        raise ValueError(f"{file}: has no rate for {unit}; add it to [fit_per_bit]")
    return rates[max(known, key=len)]


def units_of(rows, bits, rates, file):
    """A Unit for each with bits among the drawn ones. `rows`: dictionaries with unit and verdict."""
    verdicts = collections.Counter((row["unit"], row["verdict"]) for row in rows)
    units = []
    for name, count in sorted(bits.items()):
        faults = sum(number for (unit, verdict), number in verdicts.items() if unit == name and verdict != "unapplied")
        if faults == 0:
            raise ValueError(f"no fault was injected into {name}: give more faults, or leave it out of --units")
        fit = rate_of(rates, name, file) * count
        units.append(Unit(name, count, fit, faults, verdicts[name, "silent"], verdicts[name, "latent"]))
    return units


def single_point_metric(units, upper):
    """1 - residual / all, as rates. `upper(hits, count)`: the upper bound of a share."""
    whole = sum(unit.fit for unit in units)
    residual = sum(unit.fit * unit.residual / unit.faults for unit in units)
    most = sum(unit.fit * upper(unit.residual, unit.faults) for unit in units)
    return Metric(1 - residual / whole, 1 - most / whole)


def latent_metric(units, upper):
    """1 - latent / (all - residual). Whatever differs at the end counts as latent, also what the program never uses."""

    def of(residual, latent):
        return 1 - latent / (sum(unit.fit for unit in units) - residual) if latent else 1.0

    residual = sum(unit.fit * unit.residual / unit.faults for unit in units)
    latent = sum(unit.fit * unit.latent / unit.faults for unit in units)
    most = sum(unit.fit * upper(unit.latent, unit.faults) for unit in units)
    most_residual = sum(unit.fit * upper(unit.residual, unit.faults) for unit in units)
    return Metric(of(residual, latent), max(0.0, of(most_residual, most)))


def bits_of(command, beginnings):
    """Bits of each unit that begins with one of these, as `command` lists the places."""
    done = subprocess.run([*command, "--list-fault-places"], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise ValueError(done.stderr.strip())
    bits = collections.Counter()
    for place in json.loads(done.stdout)["places"]:
        if place["unit"].startswith(tuple(beginnings)):
            bits[place["unit"]] += place["bits"]
    return dict(bits)


def print_metrics(units, upper, out=None):
    """The table of the units and both metrics."""
    out = out or sys.stdout
    print(f"\n{'unit':<28}{'bits':>8}{'FIT':>12}{'faults':>8}{'residual':>10}{'latent':>8}", file=out)
    for unit in units:
        row = f"{unit.name:<28}{unit.bits:>8}{unit.fit:>12.4g}{unit.faults:>8}{unit.residual:>10}{unit.latent:>8}"
        print(row, file=out)
    for name, metric in (
        ("single-point fault metric", single_point_metric(units, upper)),
        ("latent fault metric", latent_metric(units, upper)),
    ):
        print(f"{name:<28}{metric.value:>8.4f}, at least {metric.least:.4f} (95 %)", file=out)
