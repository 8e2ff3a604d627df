"""The cost of a report of the main job (105,001 samples): size, writing, opening, and the run with and without it.

    scripts/tool report_times [--capsoc FILE] [--pairs N]

Times are this host's. Writing is `capsoc report` on a result with curves. A run's cost is its processor time with
--html over that without, the least of N runs of each, taken in turns.
"""

import argparse
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from capsoc_tools import ROOT, browser


def processor_seconds(command):
    with open(os.devnull, "wb") as nothing:
        process = subprocess.Popen(command, stdout=nothing, stderr=nothing)
        _, status, usage = os.wait4(process.pid, 0)
    if status != 0:
        sys.exit(f"report_times: {' '.join(map(str, command))} failed")
    return usage.ru_utime + usage.ru_stime


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--capsoc", type=Path, default=ROOT / "build" / "capsoc")
    parser.add_argument("--pairs", type=int, default=10)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        page, result = Path(folder) / "r.html", Path(folder) / "r.json"
        subprocess.run([arguments.capsoc, "run", "--curves", "--json", result], check=True, capture_output=True)
        begin = time.monotonic()
        subprocess.run([arguments.capsoc, "report", result, "--html", page], check=True)
        print(f"written in         {time.monotonic() - begin:.3f} s")
        print(f"size               {page.stat().st_size} bytes")
        if reason := browser.missing():
            print(f"not opened: {reason}")
        else:
            tab = browser.Browser()
            try:
                tab.open(page)
                ready = tab.wait("return document.documentElement.dataset.ready", "the page's script has run")
                print(f"interactive after  {int(ready) / 1000:.3f} s")
            finally:
                tab.close()
        plain, drawn = [], []
        for _ in range(arguments.pairs):
            plain.append(processor_seconds([arguments.capsoc, "run"]))
            drawn.append(processor_seconds([arguments.capsoc, "run", "--html", page]))
        print(
            f"a run              {min(plain):.3f} s without, {min(drawn):.3f} s with a report: "
            f"{100 * (min(drawn) / min(plain) - 1):+.1f} %"
        )


if __name__ == "__main__":
    main()
