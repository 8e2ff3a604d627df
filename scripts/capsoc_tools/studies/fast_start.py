"""How soon `quick` is calibrated, and how well: random sensors without noise, with the speed known and unknown.

usage: fast_start [--sensors N] [--seed S] [--jobs N] [--turns N] [--build FOLDER]

Random sensors have amplitudes of 0.05 .. 0.95 of full scale (log-uniform), their ratio 0.5 .. 2, offsets to 0.5 without
clipping, beta -1.2 .. 1.2 rad, any phi and either direction. They turn at 0.05 Hz, with 250 samples/s and 32 bits.

Prints for each way, as median, 95 % and the worst of all sensors:
- when all six parameters were within 1 % for good (speed known)
- when the angle was within 0.5 degrees and within 1e-5 degrees for good
- the largest error in the turn of calibration after that

Status 0: every run passed, kept its bound and reached 1e-5 degrees; 1: one did not, with its command; 2: usage.
"""

import argparse
import concurrent.futures
import json
import math
import random
import subprocess
import sys
import tempfile
from pathlib import Path

from capsoc_tools import ROOT as TOP

WAYS = {"known speed": True, "unknown speed": False}
LIMITS = (0.5, 1e-5)  # degrees
TURN_SAMPLES = 5000


def draw(random_source):
    a1 = math.exp(random_source.uniform(math.log(0.05), math.log(0.95)))
    a2 = min(0.95, max(0.05, a1 * math.exp(random_source.uniform(math.log(0.5), math.log(2)))))
    return {
        "a1": a1,
        "a2": a2,
        "b1": random_source.uniform(-1, 1) * min(0.5, 0.98 - a1),
        "b2": random_source.uniform(-1, 1) * min(0.5, 0.98 - a2),
        "beta_rad": random_source.uniform(-1.2, 1.2),
        "phi_rad": random_source.uniform(-math.pi, math.pi),
        "motion.frequency_hz": random_source.choice((0.05, -0.05)),
    }


def settled(rows, limit):
    """Seconds after which no error is above the limit."""
    time = 0.0
    for seconds, error in rows:
        if error > limit:
            time = seconds
    return time


def run(build, sensor, known, turns):
    command = [
        str(build / "capsoc"),
        "run",
        str(build / "firmware" / "quick.elf"),
        "--uart0",
        "null",
        "-P",
        f"turns={turns}",
    ]
    for key, value in sensor.items():
        command += ["-C", f"sensor.{key}={value:.9g}"]
    if known:
        command += ["-P", f"frequency_hz={sensor['motion.frequency_hz']}"]
    with tempfile.TemporaryDirectory() as folder:
        record, result = Path(folder) / "record.csv", Path(folder) / "result.json"
        done = subprocess.run(
            [*command, "--record", str(record), "--record-columns", "t,error_deg", "--json", str(result)],
            capture_output=True,
            text=True,
            check=False,
        )
        if done.returncode not in (0, 1):
            return {"command": command, "passed": False, "said": done.stderr.strip()}
        values = json.loads(result.read_text(encoding="utf-8"))
        rows = []
        for line in record.read_text(encoding="ascii").splitlines():
            seconds, _, error = line.partition(",")
            try:
                rows.append((float(seconds), abs(float(error))))
            except ValueError:  # comments, the heading, samples without an angle
                continue
    return {
        "command": command,
        "passed": done.returncode == 0 and values["verdict"]["bound_holds"],
        "parameters": values["convergence_s"] if values["convergence"] == "reached" else None,
        "angles": [settled(rows, limit) for limit in LIMITS],
        "floor": values["angle_error_deg"]["calibration_mode_max"],
    }


def quantiles(values):
    ordered = sorted(values)
    return ordered[len(ordered) // 2], ordered[min(len(ordered) - 1, math.ceil(0.95 * len(ordered)) - 1)], ordered[-1]


def line(title, values, unit, form):
    print(f"  {title:44}" + "".join(f"{format(value, form):>12}" for value in quantiles(values)) + f" {unit}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sensors", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--turns", type=int, default=8, help="of learning")
    parser.add_argument("--build", type=Path, default=TOP / "build")
    options = parser.parse_args()
    if not (options.build / "capsoc").is_file():
        parser.error(f"{options.build}: holds no capsoc; build it (./scripts/setup), or name another --build")
    if options.sensors < 1 or options.jobs < 1:
        parser.error("at least one sensor and one job")
    random_source = random.Random(options.seed)
    sensors = [draw(random_source) for _ in range(options.sensors)]
    bad = 0
    print(f"{options.sensors} sensors, seed {options.seed}, {options.turns} turns of learning")
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for way, known in WAYS.items():
            results = list(
                pool.map(lambda sensor, k=known: run(options.build.resolve(), sensor, k, options.turns), sensors)
            )
            good = [
                r
                for r in results
                if r["passed"] and (r["parameters"] is not None or not known) and r["floor"] <= LIMITS[-1]
            ]
            print(f"{way}: {len(good)} of {len(results)}\n  {'':44}{'median':>12}{'95 %':>12}{'worst':>12}")
            if good:
                if known:  # else phi is not to be seen
                    line("parameters within 1 % after", [r["parameters"] for r in good], "s", ".1f")
                for i, limit in enumerate(LIMITS):
                    line(f"angle within {limit:g} degrees after", [r["angles"][i] for r in good], "s", ".1f")
                line("largest error in calibration mode", [r["floor"] for r in good], "deg", ".1e")
            for r in results:
                if r not in good:
                    bad += 1
                    print("  not so: " + " ".join(r["command"]))
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
