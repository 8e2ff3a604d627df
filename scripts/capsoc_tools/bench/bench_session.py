"""What a session costs: requests a second, samples to NumPy, the main job and capsoc run, simulations side by side.

Every ratio is of runs that alternate; medians are printed, with the least and the largest.
"""

import argparse
import importlib
import json
import os
import resource
import statistics
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[3]


def spread(values, unit, digits=3):
    return f"{statistics.median(values):.{digits}f} {unit} ({min(values):.{digits}f} to {max(values):.{digits}f})"


def timed(work):
    begun = time.perf_counter()
    work()
    return time.perf_counter() - begun


def processor_timed(work):
    """Host seconds, and those of processor time that the processes took which this one started."""
    begun = resource.getrusage(resource.RUSAGE_CHILDREN)
    wall = timed(work)
    ended = resource.getrusage(resource.RUSAGE_CHILDREN)
    return wall, ended.ru_utime + ended.ru_stime - begun.ru_utime - begun.ru_stime


def requests_a_second(session, simulation, count):
    """Of requests that wait for their answers, and of those that are sent ahead."""
    one = timed(lambda: [simulation.call("simulation.state") for _ in range(count)])
    connection = session.connection

    def ahead():
        asked = [connection.send("simulation.state", {"simulation": simulation.number}) for _ in range(count)]
        for request in asked:
            connection.wait(request)

    return count / one, count / timed(ahead)


def requests(capsoc, programs, blocks, count):
    """Rates of programs whose blocks of requests alternate: pairs as of requests_a_second() by program."""
    sessions = [capsoc.Session(program) for program in programs]
    simulations = [session.run() for session in sessions]
    for simulation in simulations:
        simulation.advance(seconds=1)
    pairs = [
        [requests_a_second(*each, count) for each in zip(sessions, simulations)]
        for _ in range(blocks + 1)  # the first one is to warm up
    ][1:]
    for session in sessions:
        session.close()
    return [list(of_program) for of_program in zip(*pairs)]


def print_requests(rates, names):
    for kind, what in enumerate(("requests that wait for answers", "requests sent ahead")):
        of_kind = [[pair[kind] for pair in of_program] for of_program in rates]
        for name, values in zip(names, of_kind):
            print(f"{what}{name}: {spread(values, '/s', 0)}")
        for name, values in zip(names[1:], of_kind[1:]):
            ratios = [ours / theirs for ours, theirs in zip(of_kind[0], values)]
            print(f"ratio to{name}: {spread(ratios, 'times')}")


def main_job(program, capsoc, count):
    """`count` main jobs: each by `capsoc run`, each in a separate session, all one after the other in one session."""

    def run():
        for _ in range(count):
            subprocess.run([program, "run", "--json", os.devnull], check=True, capture_output=True)

    def in_session(many):
        with capsoc.Session(program) as owner:
            for _ in range(many):
                with owner.run() as simulation:
                    simulation.advance()
                    assert simulation.finish().passed

    return run, lambda: [in_session(1) for _ in range(count)], lambda: in_session(count)


def print_main_jobs(ways, count, repeat):
    """In turns; the time of one main job."""
    seconds = [[] for _ in ways]
    for _ in range(repeat):
        for of_way, way in zip(seconds, ways):
            of_way.append([each / count for each in processor_timed(way)])
    names = ("by capsoc run", "in a separate session", f"in a session with {count - 1} others")
    for kind, what in enumerate(("main job", "main job, processor time")):
        direct, *driven = ([pair[kind] for pair in of_way] for of_way in seconds)
        print(f"{what}, {names[0]}: {spread(direct, 's')}")
        for name, times in zip(names[1:], driven):
            ratios = [ours / theirs for ours, theirs in zip(times, direct)]
            print(f"{what}, {name}: {spread(times, 's')}")
            print(f"ratio: {spread(ratios, 'times')}, of the least {min(times) / min(direct):.3f}")


def side_by_side(session, count):
    """Simulated seconds a second of the host: one simulation, and `count` at once."""
    rates = []
    for many in (1, count):
        simulations = [session.run() for _ in range(many)]
        with ThreadPoolExecutor(many) as pool:
            seconds = timed(lambda: list(pool.map(lambda each: each.advance(seconds=400), simulations)))
        rates.append(many * 400 / seconds)
        for each in simulations:
            each.close()
    return rates


def pieces(session, count):
    """Host seconds of one advance and of `count` of them, and whether both ended alike."""
    one, many = session.run(), session.run()
    begun = timed(lambda: one.advance(seconds=100))

    def cut():
        for step in range(1, count + 1):
            many.advance(until_s=100 * step / count)

    took = timed(cut)
    alike = one.state == many.state and one.uart0.text == many.uart0.text
    one.close()
    many.close()
    return begun, took, alike


def main():
    parser = argparse.ArgumentParser(prog="bench_session", description=__doc__)
    parser.add_argument("--program", default=SOURCE / "build" / "capsoc", type=Path)
    parser.add_argument("--repeat", default=5, type=int)
    parser.add_argument("--jobs", default=8, type=int, help="main jobs of a turn")
    parser.add_argument("--requests", default=1000, type=int, help="of a block")
    parser.add_argument("--blocks", default=40, type=int, help="of requests of each program")
    parser.add_argument("--other", type=Path, help="a program whose requests alternate with ours")
    parser.add_argument("--only-requests", action="store_true")
    parser.add_argument("--samples", default=1000000, type=int)
    parser.add_argument("--pieces", default=100000, type=int)
    arguments = parser.parse_args()
    try:
        capsoc = importlib.import_module("capsoc")
    except ModuleNotFoundError:
        parser.error("there is no module capsoc; begin the line with PYTHONPATH=platform/python")
    programs = [arguments.program] + ([arguments.other] if arguments.other else [])
    rates = requests(capsoc, programs, arguments.blocks, arguments.requests)
    print_requests(rates, [f" ({program.name})" for program in programs] if arguments.other else [""])
    if arguments.only_requests:
        return 0
    print_main_jobs(main_job(arguments.program, capsoc, arguments.jobs), arguments.jobs, arguments.repeat)

    with capsoc.Session(arguments.program) as session:
        settings = {"demodulation_samples": 1000000000}
        simulation = session.run(program=settings)
        seconds = timed(lambda: simulation.advance(samples=arguments.samples))
        print(f"{arguments.samples} samples simulated: {seconds:.2f} s")
        taken = []
        for _ in range(arguments.repeat):
            taken.append(timed(lambda: simulation.samples(last=arguments.samples)))
        columns = simulation.samples(last=arguments.samples)
        print(f"{len(columns.error_deg)} samples to arrays: {spread(taken, 's')}")
        simulation.close()

        one, many = side_by_side(session, 8)
        print(f"simulated s a second: {one:.0f} alone, {many:.0f} in 8 side by side ({os.cpu_count()} processors)")

        whole, cut, alike = pieces(session, arguments.pieces)
        print(f"100 simulated s in one advance: {whole:.3f} s; in {arguments.pieces}: {cut:.2f} s; ")
        print(f"the same state and text: {json.dumps(alike)}")
        return 0 if alike else 1


if __name__ == "__main__":
    sys.exit(main())
