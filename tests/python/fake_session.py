"""A session without a simulator, for what a real one does not do on demand: it dies, hangs, or sends damaged answers.

program(folder, **faults) writes a program `capsoc` whose `serve` speaks the protocol. A simulation here has a time,
UART texts ({"fake.uart0": [[seconds, text], ...]}) and an end ("fake.end_s"). Faults, by the name of a method: die
(status 7, after a sentence on stderr), hang, damage (bytes instead of the answer), late (seconds).
"""

import json
import os
import re
import sys
import time
from pathlib import Path


def program(folder, **faults):
    """The path of a program that behaves so."""
    file = Path(folder) / "capsoc"
    lines = [f"#!{sys.executable}", "import sys", f"sys.path[:0] = [{str(Path(__file__).parent)!r}]"]
    file.write_text("\n".join([*lines, "import fake_session", f"fake_session.serve({faults!r})", ""]))
    file.chmod(0o755)
    return file


class Refusal(Exception):
    """An error of the protocol: code and message."""


class Simulation:
    def __init__(self, settings):
        self.settings, self.time, self.read = settings, 0.0, {}  # read: by UART, how much of its text
        self.end = settings.get("fake.end_s", 1e9)
        if settings.get("sensor.a1", 1) <= 0:
            raise Refusal(1, "sensor.a1: -1 is not between 1e-6 and 10.")
        if "fake.refuse" in settings:
            raise Refusal(1, f"{settings['fake.refuse']}: {settings.get(settings['fake.refuse'])!r} is refused.")

    def state(self):
        cycles = int(self.time * 25e6)
        return {"time_s": self.time, "cycles": cycles, "pc": 0x100, "over": self.time >= self.end}

    def text(self, uart):
        return "".join(text for at, text in self.settings.get(f"fake.uart{uart}", []) if at <= self.time)

    def advance(self, seconds=None, within_s=None, uart=None):
        if self.time >= self.end:
            raise Refusal(3, "The program has ended; construct another simulation.")
        begin, limit = self.time, self.end if within_s is None else self.time + within_s
        goal = limit if seconds is None else self.time + seconds
        reason = "time" if seconds is not None else "limit"
        times = [at for at, _ in self.settings.get(f"fake.uart{uart['uart']}", [])] if uart else []
        for at in [begin, *(at for at in times if begin < at <= goal)] if uart else ():
            self.time = at
            read = self.read.get(uart["uart"], 0)
            text = self.text(uart["uart"])[read:]
            if found := re.search(uart["pattern"], text):
                self.read[uart["uart"]] = read + found.end()
                match = {"text": text[: found.end()], "groups": [found[0], *found.groups()]}
                return {"state": self.state(), "reason": "uart", "match": match, "events": []}
        self.time = min(goal, self.end)
        return {"state": self.state(), "reason": "over" if self.time >= self.end else reason, "events": []}


class Fake:
    def __init__(self):
        self.simulations, self.constructed = {}, 0

    def answer(self, method, params):
        name = method.replace(".", "_")
        if not hasattr(self, name):
            raise Refusal(-32601, f"There is no method {method}; the nearest is simulation.state.")
        if "simulation" in params:
            number = params.pop("simulation")
            if number not in self.simulations:
                raise Refusal(2, f"simulation {number} was ended by signal 9")
            return getattr(self, name)(self.simulations[number], **params)
        return getattr(self, name)(**params)

    def session_about(self):
        return {"version": "0", "commit": "", "protocol": 1, "pid": os.getpid()}

    def simulation_construct(self, settings):
        number = self.constructed = self.constructed + 1
        self.simulations[number] = Simulation(settings)
        return {"simulation": number, "state": self.simulations[number].state()}

    def simulation_state(self, simulation):
        return {"state": simulation.state(), "place": "main (main.c:55)"}

    def simulation_advance(self, simulation, **goal):
        return simulation.advance(**goal)

    def simulation_save(self, simulation, file):
        Path(file).write_text("a checkpoint")
        return {}

    def simulation_finish(self, simulation):
        return {"code": 5, "reason": "the firmware crashed", "result": {}, "reports": ["HardFault at main.c:55"]}

    def simulation_close(self, simulation):
        for number in [n for n, other in self.simulations.items() if other is simulation]:
            del self.simulations[number]
        return {}

    def uart_read(self, simulation, uart):
        text, begin = simulation.text(uart), simulation.read.get(uart, 0)
        simulation.read[uart] = len(text)
        return {"text": text[begin:]}

    def echo(self, **params):
        return params


def serve(faults):
    """Answers requests on stdin until its end; `report FILE... --html PAGE` writes the files' names."""
    if sys.argv[1] == "report":
        Path(sys.argv[-1]).write_text(" ".join(sys.argv[2:-2]))
        return
    fake, reading, writing = Fake(), sys.stdin.buffer, sys.stdout.buffer
    for line in iter(reading.readline, b""):
        request = json.loads(line)
        method, frames = request["method"], [reading.read(size) for size in request.get("frames", [])]
        if method == faults.get("die"):
            print("capsoc: it dies as told", file=sys.stderr)
            sys.stderr.flush()
            os._exit(7)
        if method == faults.get("hang"):
            time.sleep(3600)
        time.sleep(faults.get("late", {}).get(method, 0))
        answer = {"jsonrpc": "2.0", "id": request["id"]}
        try:
            answer["result"] = fake.answer(method, request["params"])
        except Refusal as refusal:
            answer["error"] = {"code": refusal.args[0], "message": refusal.args[1]}
        if frames:
            answer["frames"] = [len(frame) for frame in frames]
        text = json.dumps(answer).encode() + b"\n" + b"".join(frames)
        writing.write(faults.get("damage", {}).get(method, text))
        writing.flush()
