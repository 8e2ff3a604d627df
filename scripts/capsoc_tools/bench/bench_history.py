"""What a session's history costs on the main job, and how long going back takes.

The runs with and without a history alternate; processor times are those of the session with its simulation.
"""

import argparse
import json
import random
import resource
import statistics
import subprocess
import time
from pathlib import Path

BUILD = Path(__file__).resolve().parents[3] / "build"
SEED = 1


class Session:
    """capsoc serve with one simulation of the main job."""

    def __init__(self, capsoc, settings):
        self.process = subprocess.Popen([capsoc, "serve"], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self.call("simulation.construct", settings=settings)

    def call(self, method, **params):
        request = {"jsonrpc": "2.0", "id": 1, "method": method, "params": params}
        if method != "simulation.construct":
            params["simulation"] = 1
        self.process.stdin.write(json.dumps(request).encode() + b"\n")
        self.process.stdin.flush()
        return json.loads(self.process.stdout.readline())["result"]

    def close(self):
        self.process.stdin.close()
        self.process.wait()


def processor_time(capsoc, megabytes):
    begin = resource.getrusage(resource.RUSAGE_CHILDREN)
    session = Session(capsoc, {"firmware.elf": "selfcal", "history_mb": megabytes})
    session.call("simulation.advance", until_s=420)
    session.close()
    end = resource.getrusage(resource.RUSAGE_CHILDREN)
    return end.ru_utime + end.ru_stime - begin.ru_utime - begin.ru_stime


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeat", type=int, default=15, help="runs of each kind")
    parser.add_argument("--capsoc", default=BUILD / "capsoc", help="the program")
    chosen = parser.parse_args()
    times = {0: [], 64: []}
    for _ in range(chosen.repeat):
        for megabytes, all_times in times.items():
            all_times.append(processor_time(chosen.capsoc, megabytes))
    for name, of in (("least", min), ("median", statistics.median)):
        without, with_history = (of(each) for each in times.values())
        share = with_history / without - 1
        print(f"main job, {name:6}          {without:.3f} s, with a history {with_history:.3f} s: {share:+.1%}")

    session = Session(chosen.capsoc, {"firmware.elf": "selfcal"})
    session.call("simulation.advance", until_s=420)
    about = session.call("history.when")
    print(f"kept                      {about['snapshots']} snapshots, {about['bytes'] / 1024:.0f} KiB")
    draw = random.Random(SEED)
    for name, request in (
        ("goto, any time", lambda: ("simulation.goto", {"time_s": draw.uniform(0, 400)})),
        ("back by an instruction", lambda: ("history.back", {"instructions": 1})),
        ("last write to results", lambda: ("history.last_write", {"variable": "results"})),
    ):
        taken = []
        for _ in range(20):
            method, params = request()
            begin = time.perf_counter()
            session.call(method, **params)
            taken.append(time.perf_counter() - begin)
        print(f"{name:25} median {statistics.median(taken) * 1e3:.1f} ms, longest {max(taken) * 1e3:.1f} ms")
    session.close()


if __name__ == "__main__":
    main()
