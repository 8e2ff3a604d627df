"""What the harmonic correction takes off the angle's error, learnt by the SoC alone at a constant speed that it is
not told.

usage: chip_harmonics [--sensors N] [--seed S] [--jobs N] [--build FOLDER]

Each sensor runs once with `quick`, six parameters by block learning, and once with `harmonics`, which adds the table.
The sensors are:
- the rebuilt experiment of the SoC paper (traces/soc_experiment.toml)
- the CSFN paper's signal with its third harmonic (traces/csfn_h3.toml) on a shaft that turns steadily
- random sensors

Random sensors have amplitudes of 0.05 .. 0.95 of full scale (log-uniform), their ratio 0.5 .. 2, offsets to 0.5 without
clipping, beta -1.2 .. 1.2 rad, any phi, and both directions. They have orders 2 to 5 in both channels, 0.1 to 2 % in
sum, noise of 0 or 1e-6 .. 1e-3 of the smaller amplitude, and 16 to 24 bits. They turn at 0.04 .. 0.06 Hz, with 250
samples/s.

Prints the largest angle error in calibration mode and the bound of a program with the setting that the shaft turns
evenly (-P ripple_deg=0.001), in degrees. Then follow cases that no table can correct:
- the paper's sensor on a shaft with a ripple that repeats with each turn, with and without that setting
- the third harmonic with a ripple by inertia, a quarter of it at twice the speed, learnt at one speed and at both
  (-P second_speed_s=400)

Status 0: every run passed, kept its bound, and its error stayed below a limit. The limit is 0.03 for the experiment and
0.01 for the CSFN paper's signal. For random sensors it is a tenth of the error without the table, or four times the
noise's share. Status 1: one did not, with its command; 2: usage.
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

EVEN = ("-P", "ripple_deg=0.001")


def harmonic_tables(harmonics):
    return "".join(
        f'\n[[harmonics]]\nchannel = "{channel}"\norder = {order}\namplitude = {amplitude!r}\nphase_rad = {phase!r}\n'
        for channel, order, amplitude, phase in harmonics
    )


def description(name, signal, speed, bits, noise, harmonics, ripple=""):
    return (
        f'name = "{name}"\n\n[sampling]\nrate_hz = 250\nadc_bits = {bits}\n\n[signal]\n'
        + "".join(f"{key} = {value!r}\n" for key, value in signal.items())
        + f'\n[motion]\nkind = "{"ripple" if ripple else "constant"}"\nfrequency_hz = {speed!r}\n{ripple}'
        + (f"\n[noise]\nsigma = {noise!r}\nseed = 1\n" if noise else "")
        + harmonic_tables(harmonics)
    )


def csfn_sensor():
    """The signal of traces/csfn_h3.toml, but on a shaft at constant speed."""
    signal = {"a1": 0.3428, "a2": 0.2537, "b1": 0.0485, "b2": -0.0224, "beta_rad": 0.9032, "phi_rad": 0.0}
    return description("csfn_h3_steady", signal, 0.05, 32, 0, [("u", 3, 0.01, 0.0), ("v", 3, 0.01, 0.0)])


def draw(source, number):
    a1 = math.exp(source.uniform(math.log(0.05), math.log(0.95)))
    a2 = min(0.95, max(0.05, a1 * math.exp(source.uniform(math.log(0.5), math.log(2)))))
    signal = {
        "a1": a1,
        "a2": a2,
        "b1": source.uniform(-1, 1) * min(0.5, 0.97 - a1),
        "b2": source.uniform(-1, 1) * min(0.5, 0.97 - a2),
        "beta_rad": source.uniform(-1.2, 1.2),
        "phi_rad": source.uniform(-math.pi, math.pi),
    }
    shares = [source.random() for _ in range(8)]
    total = math.exp(source.uniform(math.log(1e-3), math.log(2e-2)))
    harmonics = [
        ("uv"[i % 2], 2 + i // 2, total * share / sum(shares), source.uniform(-math.pi, math.pi))
        for i, share in enumerate(shares)
    ]
    relative = source.choice((0, math.exp(source.uniform(math.log(1e-6), math.log(1e-3)))))
    speed = source.choice((1, -1)) * source.uniform(0.04, 0.06)
    bits = source.randint(16, 24)
    return (
        description(f"drawn_{number}", signal, speed, bits, relative * min(a1, a2), harmonics),
        noise_share(signal, relative, bits),
        relative,
    )


def two_speeds():
    """A recording: 26 turns at 0.05 Hz, a change over a turn, and 30 turns at 0.1 Hz; a ripple of 0.1 degrees once a
    turn, then of 0.025.
    """
    lines = ["t,u,v,angle_deg"]
    turns = 0.0
    for k in range(200_000):
        speed = 0.05 if turns < 26 else 0.1 if turns > 27 else 0.05 * (1 + (turns - 26))
        shaft = 2 * math.pi * turns + math.radians(0.1) * (0.05 / speed) ** 2 * math.sin(2 * math.pi * turns + 0.7)
        u = 0.3428 * (math.sin(shaft) + 0.01 * math.sin(3 * shaft)) + 0.0485
        v = 0.2537 * (math.cos(shaft + 0.9032) + 0.01 * math.cos(3 * shaft)) - 0.0224
        lines.append(f"{k / 250!r},{u!r},{v!r},{math.degrees(shaft) % 360!r}")
        turns += speed / 250
    return "\n".join(lines) + "\n"


def noise_share(signal, relative, bits):
    """Degrees: the largest of some thousand samples' noise and rounding, as an angle."""
    least = min(signal["a1"], signal["a2"])
    step = 2 ** (1 - bits) / least
    return math.degrees(4.5 * relative + step) / math.cos(signal["beta_rad"])


def run(build, program, trace, *settings):
    command = [
        str(build / "capsoc"),
        "run",
        str(build / "firmware" / f"{program}.elf"),
        "--uart0",
        "null",
        "--sensor",
        str(trace),
        *settings,
    ]
    with tempfile.TemporaryDirectory() as folder:
        result = Path(folder) / "result.json"
        done = subprocess.run([*command, "--json", str(result)], capture_output=True, text=True, check=False)
        if done.returncode not in (0, 1):
            return {
                "command": command,
                "passed": False,
                "error": math.inf,
                "bound": math.inf,
                "said": done.stderr.strip(),
            }
        values = json.loads(result.read_text(encoding="utf-8"))
    verdict = values.get("verdict") or {}
    error = values["angle_error_deg"]["calibration_mode_max"]
    return {
        "command": command,
        "passed": done.returncode == 0 and bool(verdict.get("bound_holds")),
        "error": math.inf if error is None else error,
        "bound": verdict.get("bound_deg", math.inf),
        "said": verdict.get("reason", ""),
    }


def show(title, before, after, limit):
    good = after["passed"] and after["error"] <= limit
    print(
        f"  {title:34}{before['error']:10.4f}{after['error']:12.5f}{after['bound']:10.3f}  {'' if good else 'NOT SO'}"
    )
    if not good:
        print(f"    {after['said']}\n    " + " ".join(after["command"]))
    return 0 if good else 1


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sensors", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--build", type=Path, default=TOP / "build")
    options = parser.parse_args()
    build = options.build.resolve()
    if not (build / "capsoc").is_file():
        parser.error(f"{options.build}: holds no capsoc; build it (./scripts/setup), or name another --build")
    if options.sensors < 1 or options.jobs < 1:
        parser.error("at least one sensor and one job")
    source = random.Random(options.seed)
    with tempfile.TemporaryDirectory() as folder:

        def written(name, text):
            path = Path(folder) / f"{name}.toml"
            path.write_text(text, encoding="utf-8")
            return path

        cases = [
            ("rebuilt experiment, SoC paper", TOP / "traces" / "soc_experiment.toml", 0.03, 0.0, 0.0),
            ("third harmonic, CSFN paper", written("csfn", csfn_sensor()), 0.01, 0.0, 0.0),
        ]
        for number in range(options.sensors):
            text, share, noise = draw(source, number)
            cases.append((f"drawn {number}", written(f"drawn_{number}", text), None, share, noise))
        with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
            before = list(pool.map(lambda case: run(build, "quick", case[1]), cases))
            after = list(pool.map(lambda case: run(build, "harmonics", case[1], *EVEN), cases))
        print(
            f"largest angle error, degrees; seed {options.seed}\n"
            f"  {'':34}{'six only':>10}{'with table':>12}{'bound':>10}"
        )
        bad = 0
        for case, one, other in zip(cases[:2], before, after):
            bad += show(case[0], one, other, case[2])
        for case, one, other in zip(cases[2:], before[2:], after[2:]):
            limit = max(0.1 * one["error"], 4 * case[3])
            if not other["passed"] or other["error"] > limit:
                bad += show(case[0], one, other, limit)
        for title, noisy in (("without noise", False), ("with noise", True)):
            chosen = [i for i, case in enumerate(cases) if i > 1 and (case[4] > 0) == noisy]
            if not chosen:
                continue
            for rank, pick in (("median", lambda values: sorted(values)[len(values) // 2]), ("worst", max)):
                one, other, bound = (
                    pick([results[i][key] for i in chosen])
                    for results, key in ((before, "error"), (after, "error"), (after, "bound"))
                )
                print(f"  {f'{len(chosen)} drawn, {title}, {rank}':34}{one:10.4f}{other:12.5f}{bound:10.3f}")
        signal = {"a1": 0.6079, "a2": 0.6228, "b1": 0.1336, "b2": 0.1831, "beta_rad": 0.0629, "phi_rad": 0.0876}
        # 1.8e-3 of the speed, once a turn: 0.103 degrees of the angle.
        ripple = written(
            "ripple", description("ripple", signal, 0.05, 32, 0, [], "ripple_amplitude = 0.0018\nripple_hz = 0.05\n")
        )
        print("a ripple that repeats with each turn")
        for title, settings in (("told: 0.11 degrees", ("-P", "ripple_deg=0.11")), ("not told", ())):
            result = run(build, "harmonics", ripple, *settings)
            bad += show(title, run(build, "quick", ripple), result, 0.11)
        inertia = Path(folder) / "inertia.csv"
        inertia.write_text(two_speeds(), encoding="ascii")
        print("the third harmonic, and a ripple by inertia")
        for title, settings, limit in (("one speed", (), 0.5), ("both speeds", ("-P", "second_speed_s=400"), 0.01)):
            result = run(build, "harmonics", inertia, *settings)
            bad += show(title, run(build, "quick", inertia), result, limit)
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
