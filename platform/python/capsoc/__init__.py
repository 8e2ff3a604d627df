"""Drives simulations of the capsoc virtual prototype, and tests firmware on it.

    import capsoc

    with capsoc.run("selfcal.elf", sensor=capsoc.Sensor(a1=0.6, noise=1e-4)) as sim:
        sim.uart0.expect(r"(\\d+) s: lock", within=120)
        sim.advance(seconds=60)
        print(sim.samples(last=500).error_deg.abs().max())

The fixture `capsoc` of the pytest plugin has the same names. The guide is docs/guide/python.md.
"""

from .campaign import Campaign
from .errors import (
    AnswerTimeout,
    CapsocError,
    ExpectationError,
    ProgramNotFound,
    RequestError,
    SessionError,
    SimulationEnded,
    SimulationError,
    SimulationOver,
)
from .program import find_program
from .sensor import Harmonic, Sensor
from .session import Session, replay, run
from .simulation import Simulation
from .state import (
    Change,
    Event,
    Fault,
    FunctionCost,
    History,
    Position,
    Result,
    Snapshot,
    State,
    Step,
    Stop,
    Why,
    Write,
)

__version__ = "0.1.0"

__all__ = [
    "AnswerTimeout",
    "Campaign",
    "CapsocError",
    "Change",
    "Event",
    "ExpectationError",
    "Fault",
    "FunctionCost",
    "Harmonic",
    "History",
    "Position",
    "ProgramNotFound",
    "RequestError",
    "Result",
    "Sensor",
    "Session",
    "SessionError",
    "Simulation",
    "SimulationEnded",
    "SimulationError",
    "SimulationOver",
    "Snapshot",
    "State",
    "Step",
    "Stop",
    "Why",
    "Write",
    "find_program",
    "replay",
    "run",
]
