"""What the coprocessor's RTL costs: the main job with the model, with the RTL and with both, in turns.

    scripts/tool bench_rtl [--repeat N] [--other FOLDER] [BUILD]

FOLDER has libcapsoc_rtl_precise.so and libcapsoc_rtl_paper.so of another build, which are run in addition.
"""

import argparse
from pathlib import Path

from capsoc_tools.bench.process_time import seconds


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", nargs="?", default="build", type=Path)
    parser.add_argument("--repeat", type=int, default=3, help="runs of each, of which the fastest counts")
    parser.add_argument("--other", type=Path, metavar="FOLDER", help="folder with other libraries of RTL")
    options = parser.parse_args()
    print(f"{'arithmetic':<11} {'coprocessor':<12} {'time':>8}  {'of the model':>12}")
    for arithmetic in ("precise", "paper"):
        plain = [options.build / "capsoc", "run", "--arithmetic", arithmetic, "--coprocessor"]
        commands = {"tlm": [*plain, "tlm"], "rtl": [*plain, "rtl"], "lockstep": [*plain, "lockstep"]}
        if options.other:
            commands["other rtl"] = [*plain, "rtl", "--rtl-library", options.other / f"libcapsoc_rtl_{arithmetic}.so"]
        times = {name: [] for name in commands}
        for _ in range(options.repeat):
            for name, command in commands.items():
                times[name].append(seconds(command))
        for name in commands:
            print(
                f"{arithmetic:<11} {name:<12} {min(times[name]):>7.3f}s  {min(times[name]) / min(times['tlm']):>12.2f}",
                flush=True,
            )


if __name__ == "__main__":
    main()
