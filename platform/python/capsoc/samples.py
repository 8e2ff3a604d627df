"""The samples that the coprocessor latched: a pandas frame if pandas can be imported, else a small table like one."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, Callable, Union

from .figure import line_plot

try:
    import pandas
except ImportError:
    pandas = None


class Column:
    """One column: doubles, NaN where there is no value. Statistics leave NaN out, as pandas does."""

    def __init__(self, values: Sequence[float]) -> None:
        self.values = values

    def abs(self) -> Column:
        """The absolute values."""
        return Column([abs(value) for value in self.values])

    def max(self) -> float:
        """The largest value; NaN of an empty column."""
        return self._of(max)

    def min(self) -> float:
        """The least value; NaN of an empty column."""
        return self._of(min)

    def mean(self) -> float:
        """The mean value; NaN of an empty column."""
        return self._of(lambda values: sum(values) / len(values))

    def _of(self, statistic: Callable[[list[float]], float]) -> float:
        values = [float(value) for value in self.values if value == value]
        return statistic(values) if values else float("nan")

    def tolist(self) -> list[float]:
        """The values as a list of floats."""
        return [float(value) for value in self.values]

    def __array__(self, dtype: Any = None, copy: Any = None) -> Any:
        import numpy

        return numpy.asarray(self.values, dtype=dtype)

    def __len__(self) -> int:
        return len(self.values)

    def __iter__(self) -> Iterator[float]:
        return iter(self.values)

    def __getitem__(self, index: Any) -> Any:
        found = self.values[index]
        return Column(found) if isinstance(index, slice) else float(found)

    def __repr__(self) -> str:
        return f"<Column of {len(self)} values, {self.min():.6g} to {self.max():.6g}>"


class Samples:
    """A table of columns of equal length. `index` has the number of each sample, from 0."""

    def __init__(self, first: int, columns: dict[str, Sequence[float]]) -> None:
        self._columns = {name: Column(values) for name, values in columns.items()}
        length = len(next(iter(columns.values()), ()))
        self.index = range(first, first + length)

    @property
    def columns(self) -> list[str]:
        """The names of the columns."""
        return list(self._columns)

    def __getattr__(self, name: str) -> Column:
        try:
            columns: dict[str, Column] = self.__dict__["_columns"]
            return columns[name]
        except KeyError:
            raise AttributeError(f"The samples have no column {name!r}, but {', '.join(self._columns)}.") from None

    def __getitem__(self, name: str) -> Column:
        return self._columns[name]

    def __len__(self) -> int:
        return len(self.index)

    def __repr__(self) -> str:
        return f"<Samples {self.index.start} to {self.index.stop - 1}: {', '.join(self._columns)}>"

    def _repr_html_(self) -> str:
        shown = [name for name in ("u", "v", "error_deg") if name in self._columns]
        return "".join(line_plot(self._columns[name].values, name) for name in shown)


#: What Simulation.samples() returns: a pandas.DataFrame where there is pandas.
Table = Union[Samples, Any]


def table(first: int, columns: dict[str, Sequence[float]]) -> Table:
    """The columns of an answer, from sample `first` on."""
    if pandas is None:
        return Samples(first, columns)
    length = len(next(iter(columns.values()), ()))
    return pandas.DataFrame(columns, index=pandas.RangeIndex(first, first + length, name="sample"))
