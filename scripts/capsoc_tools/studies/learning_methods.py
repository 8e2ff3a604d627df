"""Compares the ways in which the SoC learns a sensor at a known speed: LMS and blocks in the coprocessor, recursive
least squares and a Kalman filter in software next to it.

usage: learning_methods [--build FOLDER] [--arithmetic precise|paper]

Each way gets each of the sensors below for 400 s (blocks: 8 turns) at 250 samples/s, and then one turn to calibrate.
Prints:
- when all six parameters were within 1 % for good
- the largest error of a parameter afterwards (amplitudes and offsets in full scale, angles in rad)
- the largest error of an angle in calibration mode
- the cost of a sample

Status 0: every run passed and kept its bound; 1: one did not; 2: usage.
"""

import argparse
import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from capsoc_tools import ROOT as TOP

METHODS = {
    "LMS": ("selfcal", []),
    "blocks": ("quick", ["-P", "frequency_hz=0.05", "-P", "turns=8"]),
    "least squares": ("recursive", ["-P", "forgetting=0.0001"]),
    "the same, all samples": ("recursive", ["-P", "forgetting=0"]),
    "Kalman filter": ("recursive", ["-P", "forgetting=0", "-P", "drift=1e-8"]),
}
SENSORS = {
    "Eq (21)": "soc_eq21.toml",
    "noise 1e-3 of the amplitude at most": "soc_noise_1e-3.toml",
    "speed that changes (Eq (22), 1e-3)": "soc_speed_1e-3.toml",
}


def one(build, program, options, sensor, arithmetic):
    with tempfile.NamedTemporaryFile(suffix=".json") as file:
        done = subprocess.run(
            [
                build / "capsoc",
                "run",
                build / "firmware" / f"{program}.elf",
                "--sensor",
                TOP / "traces" / sensor,
                "--arithmetic",
                arithmetic,
                "-C",
                "sensor.samples=110000",
                "--json",
                file.name,
                *options,
            ],
            capture_output=True,
            text=True,
            check=False,
        )
        if done.returncode not in (0, 1):
            print(f"learning_methods: {done.stderr.strip() or done.stdout.strip()}", file=sys.stderr)
            sys.exit(2)
        result = json.loads(Path(file.name).read_text(encoding="utf-8"))
    found = re.search(r"(\d+) cycles a sample", done.stdout)
    cost = f"{found[1]} of the processor" if found else "32 of the coprocessor"
    return done.returncode, result, cost


def parameter_error(result):
    return max(
        abs(entry["value"] - entry["true"]) for entry in result["parameters"].values() if entry["true"] is not None
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=Path, default=TOP / "build")
    parser.add_argument("--arithmetic", choices=("precise", "paper"), default="precise")
    options = parser.parse_args()
    if not (options.build / "capsoc").is_file():
        parser.error(f"{options.build}: holds no capsoc; build it (./scripts/setup), or name another --build")
    wrong = 0
    for title, sensor in SENSORS.items():
        print(f"{title}\n  {'':22}{'1 % after':>10}{'parameters':>12}{'angle':>14}   cycles a sample")
        for name, (program, settings) in METHODS.items():
            if program == "quick" and options.arithmetic == "paper":
                continue
            code, result, cost = one(options.build.resolve(), program, settings, sensor, options.arithmetic)
            wrong += code != 0
            after = f"{result['convergence_s']:.1f} s" if result["convergence"] == "reached" else result["convergence"]
            angle = result["angle_error_deg"]["calibration_mode_max"]
            print(
                f"  {name:22}{after:>10}{parameter_error(result):12.1e}{angle:10.1e} deg   {cost}"
                + ("" if code == 0 else "   NOT PASSED"),
                flush=True,
            )
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
