"""Parts of a simulation as Python objects: registers and fields by attribute, pins, sensor, ADC."""

from __future__ import annotations

import difflib
import math
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Any, Optional, Union

from .arrays import Outgoing

if TYPE_CHECKING:
    from .simulation import Simulation

Numbers = Union[float, Iterable[float]]


class Register:
    """A register, read at each use without side effects. Its fields are attributes; assigning one keeps the others.

    The coprocessor takes a write a few cycles later, as on the bus: advance before the register is read or another of
    its fields is written.
    """

    _simulation: Simulation
    _name: str
    __hash__ = None  # type: ignore[assignment]

    def __init__(self, simulation: Simulation, name: str) -> None:
        self.__dict__.update(_simulation=simulation, _name=name)

    @property
    def value(self) -> int:
        """The word."""
        return int(self._read()["value"])

    @property
    def fields(self) -> dict[str, int]:
        """All fields by name."""
        return dict(self._read().get("fields", {}))

    def _read(self) -> dict[str, Any]:
        return dict(self._simulation.call("register.read", name=self._name))

    def __getattr__(self, field: str) -> int:
        if field.startswith("_"):
            raise AttributeError(field)
        return int(self._simulation.call("register.read", name=f"{self._name}.{field}")["value"])

    def __setattr__(self, field: str, value: int) -> None:
        name = self._name if field == "value" else f"{self._name}.{field}"
        self._simulation.call("register.write", name=name, value=int(value))

    def __int__(self) -> int:
        return self.value

    __index__ = __int__

    def __bool__(self) -> bool:
        return self.value != 0

    def __eq__(self, other: object) -> bool:
        return self.value == (other.value if isinstance(other, Register) else other)

    def __repr__(self) -> str:
        read = self._read()
        fields = ", ".join(f"{name} {value}" for name, value in read.get("fields", {}).items())
        return f"<{self._name} 0x{read['value']:08x}{': ' if fields else ''}{fields}>"


class Peripheral:
    """A peripheral by its name in the register description: its registers are attributes."""

    _simulation: Simulation
    _name: str

    def __init__(self, simulation: Simulation, name: str) -> None:
        self.__dict__.update(_simulation=simulation, _name=name)

    def __getattr__(self, register: str) -> Any:
        if register.startswith("_"):
            raise AttributeError(register)
        return Register(self._simulation, f"{self._name}.{register}")

    def __setattr__(self, register: str, value: int) -> None:
        self._simulation.call("register.write", name=f"{self._name}.{register}", value=int(value))

    def __dir__(self) -> list[str]:
        found = self._simulation.call("register.list")["peripherals"]
        return [r["name"] for peripheral in found if peripheral["name"] == self._name for r in peripheral["registers"]]

    def __repr__(self) -> str:
        return f"<{self._name}: {', '.join(self.__dir__())}>"


class Coprocessor(Peripheral):
    """The coprocessor: registers in capitals (STATUS.LOCK), signals of its newest result in small letters.

    Signals: a1, a2, b1, b2, error_u, error_v, error_average (fractions of full scale), beta_deg, phi_deg, angle_deg
    (degrees), angle_valid, status, flags.
    """

    def __getattr__(self, name: str) -> Any:
        if not name.islower() or name.startswith("_"):
            return super().__getattr__(name)
        return member(self._simulation.call("coprocessor.read")["signals"], name, "signal of the coprocessor")

    def __dir__(self) -> list[str]:
        return super().__dir__() + list(self._simulation.call("coprocessor.read")["signals"])


class Registers:
    """All peripherals as attributes, such as `simulation.registers.UART0.STATE.TXFULL`."""

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation

    def __getattr__(self, name: str) -> Peripheral:
        if name.startswith("_"):
            raise AttributeError(name)
        return Peripheral(self._simulation, name)

    def __dir__(self) -> list[str]:
        return [peripheral["name"] for peripheral in self._simulation.call("register.list")["peripherals"]]


class Processor:
    """The processor's registers as attributes: r0 to r12, sp, lr, pc, xpsr, msp, psp, primask and so on."""

    _simulation: Simulation

    def __init__(self, simulation: Simulation) -> None:
        self.__dict__.update(_simulation=simulation)

    def __getattr__(self, name: str) -> int:
        return int(member(self._simulation.call("processor.read")["registers"], name, "register of the processor"))

    def __setattr__(self, name: str, value: int) -> None:
        self._simulation.call("processor.write", register=name, value=int(value))

    def __dir__(self) -> list[str]:
        return list(self._simulation.call("processor.read")["registers"])


class SensorParameters:
    """The sensor's parameters as attributes; an assignment holds from this simulated instant on.

    a1, a2, b1, b2 are fractions of full scale; the angles are beta_deg and phi_deg, or beta_rad and phi_rad. set()
    takes further keys of the sensor's description, such as set(**{"noise.sigma": 0.01}).
    """

    _simulation: Simulation

    def __init__(self, simulation: Simulation) -> None:
        self.__dict__.update(_simulation=simulation)

    def set(self, **parameters: float) -> None:
        """Sets several parameters at the same instant."""
        known = {}
        for name, value in parameters.items():
            is_angle = name.endswith("_deg")
            known[name[:-3] + "rad" if is_angle else name] = math.radians(value) if is_angle else value
        self._simulation.call("sensor.set", parameters=known)

    def read(self) -> dict[str, Optional[float]]:
        """All parameters that the session knows; None for what is not known, as of a recording."""
        found: dict[str, Optional[float]] = dict(self._simulation.call("sensor.read")["parameters"])
        for name in [name for name in found if name.endswith("_rad")]:
            angle = found[name]
            found[name[:-3] + "deg"] = None if angle is None else math.degrees(angle)
        return found

    def __getattr__(self, name: str) -> float:
        value = member(self.read() if not name.startswith("_") else {}, name, "parameter of the sensor")
        if value is None:
            raise AttributeError(f"The sensor's {name} is not known.")
        return float(value)

    def __setattr__(self, name: str, value: float) -> None:
        self.set(**{name: float(value)})

    def __dir__(self) -> list[str]:
        return ["read", "set", *self.read()]


class Adc:
    """The converter between sensor and coprocessor."""

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation

    def inject(self, u: Numbers, v: Numbers, samples: Optional[int] = None) -> None:
        """The next conversions give these values, fractions of full scale; after them the sensor continues.

        u, v: sequences of the same length, or numbers that are repeated for `samples` conversions (1 unless said).
        """
        lists = [[float(x)] if isinstance(x, (int, float)) else [float(value) for value in x] for x in (u, v)]
        length = samples if samples is not None else max(map(len, lists))
        repeated = [part * length if len(part) == 1 else part for part in lists]
        if {len(part) for part in repeated} != {length}:
            raise ValueError(
                f"adc.inject: u and v have {len(lists[0])} and {len(lists[1])} values for {length} samples."
            )
        outgoing = Outgoing()
        self._simulation.call(
            "adc.inject", outgoing, u=outgoing.add_doubles(repeated[0]), v=outgoing.add_doubles(repeated[1])
        )


class Gpio:
    """The 16 pins of a port: `gpio[0][3]` is a level, an assignment drives the pin from outside.

    None releases the pin, which the board's pull-down then holds low.
    """

    def __init__(self, simulation: Simulation, number: int) -> None:
        self._simulation, self._number = simulation, number

    @property
    def pins(self) -> list[bool]:
        """The levels of all pins."""
        return [bool(level) for level in self._simulation.call("pin.read", gpio=self._number)["pins"]]

    def __getitem__(self, pin: int) -> bool:
        return self.pins[pin]

    def __setitem__(self, pin: int, level: Optional[bool]) -> None:
        self._simulation.call("pin.drive", gpio=self._number, pin=pin, level=bool(level))

    def __len__(self) -> int:
        return 16

    def __iter__(self) -> Iterator[bool]:
        return iter(self.pins)


def nearest(name: str, names: Iterable[str]) -> str:
    """The end of a message about an unknown name: the nearest known one, or nothing."""
    near = difflib.get_close_matches(name, list(names), 1)
    return f"; the nearest is {near[0]!r}" if near else ""


def member(values: dict[str, Any], name: str, what: str) -> Any:
    """A value by its name. Raises AttributeError, which says what it is no name of."""
    if name not in values:
        raise AttributeError(f"There is no {what} {name!r}{nearest(name, values)}.")
    return values[name]
