"""What the live page costs: a long main job by itself, in a session, and with a page that reads every frame.

The three alternate in one run. The time is that of the simulation from its first to its last instant. With the page it
includes everything between the simulation's slices. The processor time is that of the simulation's process, which other
work on the machine changes less. Then follows what a paced run costs in addition to the simulation.

    scripts/tool bench_view [--repeat N] [--samples N] [--capsoc FILE]
"""

import argparse
import http.client
import json
import os
import re
import resource
import statistics
import subprocess
import tempfile
from pathlib import Path

BUILD = Path(__file__).resolve().parents[3] / "build"


class Page:
    """capsoc run --view, and a reader of its frames."""

    def __init__(self, capsoc, *options):
        self.process = subprocess.Popen(
            [capsoc, "run", "--uart0", "null", "--view", *options], stderr=subprocess.PIPE, text=True
        )
        found = re.search(r"127\.0\.0\.1:(\d+)/\?token=(\w+)", self.process.stderr.readline())
        self.port, self.token = int(found[1]), found[2]
        self.connection = http.client.HTTPConnection("127.0.0.1", self.port)
        self.connection.request("GET", f"/events?token={self.token}")
        self.answer = self.connection.getresponse()

    def frames(self):
        """Each frame as it comes."""
        while line := self.answer.readline():
            if line.startswith(b"data: "):
                yield json.loads(line[6:])

    def close(self):
        """The page ends the run."""
        with_token = http.client.HTTPConnection("127.0.0.1", self.port)
        with_token.request("POST", "/do", '{"do": "end"}', {"X-Capsoc-Token": self.token})
        with_token.getresponse().read()
        with_token.close()
        self.answer.close()
        self.connection.close()
        self.process.stderr.read()
        self.process.wait()
        self.process.stderr.close()


def time_without_page(capsoc, folder, *options):
    """Seconds of the host, and of its processors, that a run takes beyond one that ends at once."""
    result = Path(folder) / "r.json"
    taken = []
    for limit in ([], ["--simlimit", "1e-6"]):
        command = [capsoc, "run", "--uart0", "null", "--json", result, *limit, *options]
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(command, stderr=subprocess.DEVNULL, check=not limit)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        taken.append((json.loads(result.read_text(encoding="utf-8"))["time"]["wall_s"], used))
    return tuple(of_run - of_none for of_run, of_none in zip(*taken))


def simulation_of(page):
    """The process below that of the session."""
    process = page.process.pid
    for _ in range(2):
        process = Path(f"/proc/{process}/task/{process}/children").read_text(encoding="ascii").split()[0]
    return process


def time_with_page(capsoc, *options):
    """((seconds of the host that the last frame tells, of the simulation's processor), frames)"""
    page, count = Page(capsoc, *options), 0
    for frame in page.frames():
        if count == 0:
            process = simulation_of(page)
            begin = processor_time(process)
        count += 1
        if frame["mode"] == "over":
            break
    used = processor_time(process) - begin
    page.close()
    return (frame["host_s"], used), count


def processor_time(process):
    """Seconds of one process (Linux)."""
    fields = Path(f"/proc/{process}/stat").read_text(encoding="ascii").rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def paced(capsoc, seconds=10):
    """(updates a second, processor time a second of the page's side) of a run at the shaft's own speed."""
    page, count, begin = Page(capsoc, "--realtime", "1"), 0, None
    for frame in page.frames():
        if frame["mode"] == "running" and begin is None:
            begin, used = frame["host_s"], processor_time(page.process.pid)
        count += begin is not None
        if begin is not None and frame["host_s"] > begin + seconds:
            break
    share = (processor_time(page.process.pid) - used) / (frame["host_s"] - begin)
    page.close()
    return count / seconds, share


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repeat", type=int, default=6, help="runs of each kind")
    parser.add_argument("--samples", type=int, default=1_000_000, help="of the job")
    parser.add_argument("--capsoc", default=BUILD / "capsoc", help="the program")
    chosen = parser.parse_args()
    job = ("-P", f"demodulation_samples={chosen.samples}")
    times = {"by itself": [], "in a session": [], "with a page": []}
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(chosen.repeat):
            times["by itself"].append(time_without_page(chosen.capsoc, folder, *job))
            session = ("--record-session", str(Path(folder) / "a.session"))
            times["in a session"].append(time_without_page(chosen.capsoc, folder, *job, *session))
            taken, frames = time_with_page(chosen.capsoc, *job)
            times["with a page"].append(taken)
    for place, what in enumerate(("main job", "processor time")):
        print(f"{what:14} {'least':>8} {'median':>8}   speed of the run by itself (least, median)")
        alone = [each[place] for each in times["by itself"]]
        for name, pairs in times.items():
            taken = [each[place] for each in pairs]
            least, median = min(taken), statistics.median(taken)
            speeds = f"{min(alone) / least:.0%} {statistics.median(alone) / median:.0%}"
            print(f"{name:14} {least:7.3f}s {median:7.3f}s   {speeds}")
    print(f"frames of the last run with a page: {frames}")
    updates, share = paced(chosen.capsoc)
    print(f"at the shaft's own speed: {updates:.0f} updates a second, {share:.1%} of a core for the page's side")


if __name__ == "__main__":
    main()
