"""What --coverage costs: the benchmark programs with and without it, in turns.

    scripts/tool bench_coverage [--repeat N] [BUILD]
"""

import argparse
import math
import tempfile
from pathlib import Path

from capsoc_tools.bench.process_time import seconds


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", nargs="?", default="build", type=Path)
    parser.add_argument("--repeat", type=int, default=3, help="runs of each, of which the fastest counts")
    options = parser.parse_args()
    ratios = []
    print(f"{'program':<20} {'without':>9} {'with':>9} {'speed':>6}")
    with tempfile.TemporaryDirectory() as folder:
        programs = set((options.build / "firmware").glob("bench_*.elf")) - {
            options.build / "firmware" / "bench_interrupts.elf"
        }
        for program in sorted(programs):  # the one left out has no end
            plain = [options.build / "capsoc", "run", program]
            times = {"without": [], "with": []}
            for number in range(options.repeat):
                times["without"].append(seconds(plain))
                times["with"].append(seconds([*plain, "--coverage", f"{folder}/{program.stem}_{number}.info"]))
            without, counted = min(times["without"]), min(times["with"])
            ratios.append(without / counted)
            print(f"{program.stem:<20} {without:>8.3f}s {counted:>8.3f}s {ratios[-1]:>6.2f}", flush=True)
    print(
        f"{'geometric mean':<20} {'':>9} {'':>9} {math.exp(sum(map(math.log, ratios)) / len(ratios)):>6.2f}"
        f"   worst {min(ratios):.2f}"
    )


if __name__ == "__main__":
    main()
