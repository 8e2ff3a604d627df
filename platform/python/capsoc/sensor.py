"""The description of a sensor, as the files in traces/ have it: what a simulation starts with.

    U = a1 (sin theta + harmonics) + b1 + noise,   V = a2 (cos(theta + beta) + harmonics) + b2 + noise
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from os import PathLike, fspath
from pathlib import Path
from typing import Any, Optional, Union

#: The sensor of the SoC paper's Eq (21), which the program has built in.
DEFAULT = "built-in:soc_eq21.toml"

Setting = Union[str, float, int, bool]


@dataclass(frozen=True)
class Harmonic:
    """A harmonic of one channel: order 2 to 1000, amplitude as part of the channel's, phase in degrees."""

    channel: str
    order: int
    amplitude: float
    phase_deg: float = 0.0


@dataclass
class Sensor:
    """A sensor by its parameters. What is not named is the file's, by default the SoC paper's Eq (21).

    file: a description (.toml) or a recording, which takes no parameters.
    a1, a2, b1, b2: amplitudes and offsets, fractions of full scale. beta_deg: phase shift of V. phi_deg: initial angle.
    frequency_hz: revolutions a second, negative backwards; 0.05 in Eq (21), which is what the firmware expects.
    noise: largest value in 100,000 samples as a part of each amplitude (the papers' scale); or
    noise_sigma: standard deviation, fraction of full scale. seed: of the noise.
    motion, drift: further keys of these tables, such as motion={"kind": "swing", "swing_hz": 0.1}.
    sampling: rate_hz, samples, adc_bits.

    The program checks ranges and names when a simulation is constructed (SimulationError).
    """

    file: Union[str, PathLike[str]] = DEFAULT
    a1: Optional[float] = None
    a2: Optional[float] = None
    b1: Optional[float] = None
    b2: Optional[float] = None
    beta_deg: Optional[float] = None
    phi_deg: Optional[float] = None
    frequency_hz: Optional[float] = None
    noise: Optional[float] = None
    noise_sigma: Optional[float] = None
    seed: int = 1
    harmonics: list[Harmonic] = field(default_factory=list)
    motion: dict[str, Any] = field(default_factory=dict)
    drift: dict[str, float] = field(default_factory=dict)
    sampling: dict[str, float] = field(default_factory=dict)

    def settings(self) -> dict[str, Setting]:
        """The settings of `capsoc run` for this sensor (`capsoc run --list-params` explains them)."""
        found: dict[str, Any] = {f"sensor.{name}": value for name, value in self._signal().items()}
        found.update({f"sensor.{name}": value for name, value in self.sampling.items()})
        motion = dict(self.motion)
        if self.frequency_hz is not None:
            motion["frequency_hz"] = self.frequency_hz
        for table, values in (("motion", motion), ("drift", self.drift), ("noise", self._noise())):
            found.update({f"sensor.{table}.{name}": value for name, value in values.items()})
        for part in self.harmonics:
            name = f"sensor.harmonics.{part.channel}{part.order}"
            found.update({f"{name}_amplitude": part.amplitude, f"{name}_phase_rad": math.radians(part.phase_deg)})
        file = fspath(self.file)
        built_in = file.startswith("built-in:") or file == ""
        settings: dict[str, Setting] = {"sensor.file": file if built_in else str(Path(file).resolve())}
        settings.update({name: _scalar(value) for name, value in found.items() if value is not None})
        return settings

    def _signal(self) -> dict[str, Optional[float]]:
        values = {name: getattr(self, name) for name in ("a1", "a2", "b1", "b2")}
        for name in ("beta", "phi"):
            degrees = getattr(self, f"{name}_deg")
            values[f"{name}_rad"] = None if degrees is None else math.radians(degrees)
        return values

    def _noise(self) -> dict[str, float]:
        if self.noise is not None and self.noise_sigma is not None:
            raise ValueError("Sensor: noise and noise_sigma exclude each other; name one of them.")
        if self.noise is not None:
            return {"peak": self.noise, "record_samples": 100_000, "seed": self.seed}
        return {} if self.noise_sigma is None else {"sigma": self.noise_sigma, "seed": self.seed}


def _scalar(value: Any) -> Setting:
    """A setting's value; lists (motion.speeds) are written as in TOML."""
    return value if isinstance(value, (str, bool, int, float)) else str([list(part) for part in value])


def settings_of(sensor: Union[None, Sensor, str, PathLike[str]]) -> dict[str, Setting]:
    """The settings for what callers name as a sensor: nothing, a Sensor, or a file."""
    if sensor is None:
        return {}
    return (sensor if isinstance(sensor, Sensor) else Sensor(file=sensor)).settings()
