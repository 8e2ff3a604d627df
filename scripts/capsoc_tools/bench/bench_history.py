"""What a session's history costs, and how long going back takes.

The runs with and without a history alternate; processor times are those of the session with its simulation. Going back
is measured in the host's time, so other programs count: with --other another build does the same in turns, and nothing
else is measured.
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
#: The last write to this array of the program is some thousand instructions after its start.
FAR, ARRAY = "bench_matrix", "b"


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

    def timed(self, method, **params):
        """Host seconds of a request, and its result."""
        begin = time.perf_counter()
        result = self.call(method, **params)
        return time.perf_counter() - begin, result

    def close(self):
        self.process.stdin.close()
        self.process.wait()


def processor_time(capsoc, program, megabytes):
    begin = resource.getrusage(resource.RUSAGE_CHILDREN)
    session = Session(capsoc, {"firmware.elf": program, "history_mb": megabytes})
    session.call("simulation.advance", until_s=420)
    session.close()
    end = resource.getrusage(resource.RUSAGE_CHILDREN)
    return end.ru_utime + end.ru_stime - begin.ru_utime - begin.ru_stime


def cost(capsoc, program, name, repeat):
    times = {0: [], 64: []}
    for _ in range(repeat):
        for megabytes, all_times in times.items():
            all_times.append(processor_time(capsoc, program, megabytes))
    for kind, of in (("least", min), ("median", statistics.median)):
        without, with_history = (of(each) for each in times.values())
        share = with_history / without - 1
        print(f"{name}, {kind:6} {without:.3f} s, with a history {with_history:.3f} s: {share:+.1%}")


def near(programs, count):
    """Each request by all programs in turns."""
    sessions = [Session(each, {"firmware.elf": "selfcal"}) for each in programs]
    for session in sessions:
        session.call("simulation.advance", until_s=420)
        about = session.call("history.when")
        print(f"kept                      {about['snapshots']} snapshots, {about['bytes'] / 1024:.0f} KiB of 64 MiB")
    draw = random.Random(SEED)
    for name, request in (
        ("goto, any time", lambda: ("simulation.goto", {"time_s": draw.uniform(0, 400)})),
        ("back by an instruction", lambda: ("history.back", {"instructions": 1})),
        ("last write to results", lambda: ("history.last_write", {"variable": "results"})),
        ("last write to r3", lambda: ("history.last_write", {"register": "r3"})),
    ):
        taken = [[] for _ in sessions]
        for _ in range(count):
            method, params = request()
            for session, times in zip(sessions, taken):
                times.append(session.timed(method, **params)[0])
        spreads = [(min(times), statistics.median(times), max(times)) for times in taken]
        for least, median, longest in spreads:
            print(f"{name:25} least {least * 1e3:.1f} ms, median {median * 1e3:.1f} ms, longest {longest * 1e3:.1f} ms")
        if len(spreads) > 1:
            least, median = (spreads[1][each] / spreads[0][each] for each in range(2))
            print(f"{name:25} the other one takes {least:.2f} times as long (least), {median:.2f} (median)")
    for session in sessions:
        session.close()


def far(capsoc, instructions):
    session = Session(capsoc, {"firmware.elf": FAR})
    took, end = session.timed("simulation.advance", instructions=instructions)
    about = session.call("history.when")
    print(
        f"{end['state']['instructions'] / 1e6:.0f} million instructions of {FAR} in {took:.2f} s, "
        f"{about['snapshots']} snapshots, {about['bytes'] / 1024:.0f} KiB"
    )
    asked, write = session.timed("history.last_write", variable=ARRAY)
    assert write["found"]
    back = (end["state"]["instructions"] - write["position"]["instructions"]) / 1e6
    print(f"last write, {back:.0f} million instructions back: {asked:.2f} s")
    asked, write = session.timed("history.last_write", register="sp")
    back = (end["state"]["instructions"] - write["position"]["instructions"]) / 1e6
    print(f"last write to sp, {back:.0f} million instructions back: {asked:.2f} s")
    place = next(each for each in session.call("variable.list")["variables"] if each["name"] == ARRAY)
    points = [{"kind": "write", "address": place["address"], "size": place["size"]}]
    took, stop = session.timed("debugger.reverse", kind="run", points=points)
    assert stop["reason"] == "watchpoint"
    print(f"reverse-continue to it: {took:.2f} s")
    session.close()


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeat", type=int, default=15, help="runs of each kind")
    parser.add_argument("--capsoc", default=BUILD / "capsoc", help="the program")
    parser.add_argument("--other", help="another build of it, to compare going back")
    chosen = parser.parse_args()
    if chosen.other:
        near([chosen.capsoc, chosen.other], 20 * chosen.repeat)
        return
    cost(chosen.capsoc, "selfcal", "main job", chosen.repeat)
    cost(chosen.capsoc, FAR, FAR, max(1, chosen.repeat // 5))
    near([chosen.capsoc], 20)
    for instructions in (100_000_000, 1_000_000_000):
        far(chosen.capsoc, instructions)


if __name__ == "__main__":
    main()
