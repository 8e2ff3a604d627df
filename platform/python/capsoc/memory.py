"""The program's memory and its variables."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Any, Union

from .arrays import Outgoing
from .proxies import member

if TYPE_CHECKING:
    from .simulation import Simulation


class Memory:
    """Memory in units of 1, 2 or 4 bytes, little endian: `mem32["counter"]`, `mem32[0x20000000] = 7`, `mem8[a:b]`.

    Keys are addresses, symbols of the program (their first unit), or slices of addresses, which give a list.
    """

    def __init__(self, simulation: Simulation, size: int) -> None:
        self._simulation, self._size = simulation, size

    def __getitem__(self, key: Union[int, str, slice]) -> Any:
        if isinstance(key, slice):
            data = self._read(int(key.start), int(key.stop) - int(key.start))
            units = range(0, len(data) - self._size + 1, self._size)
            return [int.from_bytes(data[at : at + self._size], "little") for at in units]
        return int.from_bytes(self._read(key, self._size), "little")

    def __setitem__(self, key: Union[int, str, slice], value: Union[int, Iterable[int]]) -> None:
        mask = (1 << 8 * self._size) - 1
        values = [value] if isinstance(value, int) else list(value)
        data = b"".join((int(unit) & mask).to_bytes(self._size, "little") for unit in values)
        address = key.start if isinstance(key, slice) else key
        if isinstance(key, slice) and key.stop is not None and key.stop - key.start != len(data):
            raise ValueError(f"The slice has {key.stop - key.start} bytes, the values {len(data)}.")
        outgoing = Outgoing()
        self._simulation.call("memory.write", outgoing, address=address, bytes=outgoing.add_bytes(data))

    def _read(self, address: Union[int, str], size: int) -> bytes:
        return bytes(self._simulation.call("memory.read", address=address, size=size)["bytes"])


class Struct(dict):  # type: ignore[type-arg]
    """A struct of the program: its members are keys and attributes."""

    def __getattr__(self, name: str) -> Any:
        return member(self, name, "member of the struct")


class Variables:
    """The program's variables by C name and type: `variables["table[3].count"]`; iterates over the names."""

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation

    def __getitem__(self, name: str) -> Any:
        return _structs(self._simulation.call("variable.read", name=name)["value"])

    def __setitem__(self, name: str, value: Any) -> None:
        self._simulation.call("variable.write", name=name, value=value)

    def __iter__(self) -> Iterator[str]:
        return iter(variable["name"] for variable in self.list())

    def list(self) -> list[dict[str, Any]]:
        """name, type, address and size (bytes) of each variable."""
        return [dict(variable) for variable in self._simulation.call("variable.list")["variables"]]

    def address(self, name: str) -> int:
        """Where a variable is."""
        return int(self._simulation.call("variable.read", name=name)["address"])


def _structs(value: Any) -> Any:
    if isinstance(value, dict):
        return Struct({name: _structs(member) for name, member in value.items()})
    return [_structs(item) for item in value] if isinstance(value, list) else value
