"""Arrays of the protocol's binary frames: NumPy arrays if NumPy can be imported, else `array.array`."""

from __future__ import annotations

import array
import sys
from collections.abc import Iterable
from typing import Any, Union

from .errors import SessionError

try:
    import numpy
except ImportError:
    numpy = None  # type: ignore[assignment]

Bytes = Union[bytes, bytearray, memoryview]

#: NumPy's type string (without byte order) -> type code of array.array.
CODES = {"f8": "d", "f4": "f", "i8": "q", "u8": "Q", "i4": "i", "u4": "I", "i2": "h", "u2": "H", "i1": "b", "u1": "B"}


def decode(value: Any, frames: list[bytearray]) -> Any:
    """A copy of a JSON value in which every {"frame", "type", "shape"} is an array over its frame.

    Arrays of type u1 are `bytes`. An array that does not fit its frame raises SessionError.
    """
    if isinstance(value, list):
        return [decode(item, frames) for item in value]
    if not isinstance(value, dict):
        return value
    if "frame" in value and "type" in value:
        return _array(value, frames)
    return {name: decode(item, frames) for name, item in value.items()}


def _array(value: dict[str, Any], frames: list[bytearray]) -> Any:
    index, kind, shape = value["frame"], value["type"], value.get("shape")
    if not isinstance(index, int) or not 0 <= index < len(frames):
        raise SessionError(f"The session named frame {index!r}, but the answer has {len(frames)}.")
    code = CODES.get(str(kind)[1:])
    if code is None or str(kind)[0] not in "<|":
        raise SessionError(f"The session sent an array of the unknown type {kind!r}.")
    data = frames[index]
    size = int(kind[2:])
    if not isinstance(shape, list) or len(shape) != 1 or shape[0] != len(data) // size or len(data) % size:
        raise SessionError(f"The session sent {len(data)} bytes for an array of type {kind} and shape {shape}.")
    if code == "B":
        return bytes(data)
    if numpy is not None:
        return numpy.frombuffer(data, dtype=kind)
    values = array.array(code)
    values.frombytes(data)
    if sys.byteorder != "little":
        values.byteswap()
    return values


class Outgoing:
    """The frames of a request under construction."""

    def __init__(self) -> None:
        self.frames: list[bytes] = []

    def add_bytes(self, data: Bytes) -> dict[str, Any]:
        """The JSON value of an array of type <u1."""
        return self._add(bytes(data), "<u1", len(data))

    def add_doubles(self, values: Iterable[float]) -> dict[str, Any]:
        """The JSON value of an array of type <f8."""
        doubles = array.array("d", [float(value) for value in values])
        if sys.byteorder != "little":
            doubles.byteswap()
        return self._add(doubles.tobytes(), "<f8", len(doubles))

    def _add(self, data: bytes, kind: str, length: int) -> dict[str, Any]:
        self.frames.append(data)
        return {"frame": len(self.frames) - 1, "type": kind, "shape": [length]}
