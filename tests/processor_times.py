"""When the processor slept and which handlers ran, out of a file of --timeline."""

import json
from collections import defaultdict
from decimal import Decimal


def processor_times(file, end_ps=None):
    """Begin and end in ps of each time, by `asleep`, `thread` and the names of handlers, up to a time."""
    events = json.loads(file.read_text(encoding="utf-8"), parse_float=Decimal)["traceEvents"]
    tracks = {(e["pid"], e.get("tid")): e["args"]["name"] for e in events if e["name"].endswith("_name")}
    times = defaultdict(list)
    for event in events:
        if event["ph"] != "X" or tracks[event["pid"], None] != "processor":
            continue
        begin = int(event["ts"] * 1_000_000)
        end = begin + int(event["dur"] * 1_000_000)
        if end_ps is not None:
            end = min(end, end_ps)
        if begin < end:
            name = {"runs": "thread", "sleeps": "asleep"}.get(event["name"], event["name"])
            times[name].append((begin, end))
    return {name: sorted(each) for name, each in times.items()}
