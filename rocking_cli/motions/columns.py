"""Columns over the intervals of a long record that follow from its samples and the equal step: computed where they are asked for.

An array of a column holds eight bytes an interval, and a motion has a dozen of them. Each number is the one that an array would hold, to
the last bit. Short records are faster with arrays.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from .blocks import blocks

Array = np.ndarray

LEAF_LEVEL = 3
LEAF = 1 << LEAF_LEVEL  # intervals between two numbers that are kept of a column which is not computed from a sample's neighbours alone


class Column:
    """Numbers by their index, as an array that cannot be written: `at` gives those of whole numbers from 0, of any shape."""

    size: int
    ndim = 1

    def at(self, k: Array) -> Array:
        """The numbers of these indices."""
        raise NotImplementedError

    def __getitem__(self, k: Any) -> Any:
        if isinstance(k, slice):
            return self.at(np.arange(*k.indices(self.size)))
        if isinstance(k, (int, np.integer)):
            return self.at(np.array([k % self.size]))[0]
        return self.at(k)

    def take(self, k: Array) -> Array:
        """The numbers of these indices."""
        return self.at(k)

    def __len__(self) -> int:
        return self.size

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Array:
        whole = np.empty(self.size)
        for part in blocks(self.size):
            whole[part] = self[part]
        return whole


@dataclass(frozen=True, eq=False)
class Instants(Column):
    """first, first + by, first + 2 by ... times a step."""

    size: int
    step: float
    first: int = 0
    by: int = 1

    def at(self, k: Array) -> Array:
        """The times of these indices."""
        return self.step * (self.first + self.by * k)


@dataclass(frozen=True, eq=False)
class Levels(Column):
    """Every `by`-th of some values from the `first` on, times factors, one after the other."""

    size: int
    values: Array
    factors: tuple[float, ...]
    first: int = 0
    by: int = 1

    def at(self, k: Array) -> Array:
        """The values of these indices."""
        found = self.values.take(self.first + self.by * k if self.by > 1 else k + self.first if self.first else k)
        for factor in self.factors:
            found = factor * found
        return found


@dataclass(frozen=True, eq=False)
class Computed(Column):
    """A function of other columns, number by number."""

    function: Callable[..., Array]
    columns: tuple[Any, ...]

    @property
    def size(self) -> int:  # type: ignore[override]
        """As many as the others have."""
        return int(self.columns[0].size)

    def at(self, k: Array) -> Array:
        """Computed from the others'."""
        return self.function(*(x[k] for x in self.columns))


@dataclass(frozen=True, eq=False)
class Then(Column):
    """Another column and one number after it."""

    column: Any
    last: float

    @property
    def size(self) -> int:  # type: ignore[override]
        """One more than the other."""
        return int(self.column.size) + 1

    def at(self, k: Array) -> Array:
        """Those of the other, or the last."""
        before = self.column.size
        return np.where(k < before, self.column[np.minimum(k, before - 1)], self.last)


@dataclass(frozen=True, eq=False)
class After(Column):
    """Of another column the next number, and one more at the end."""

    column: Any
    last: float

    @property
    def size(self) -> int:  # type: ignore[override]
        """As many as the other."""
        return int(self.column.size)

    def at(self, k: Array) -> Array:
        """Those of the other at the next index."""
        there = k + 1
        return np.where(there < self.size, self.column[np.minimum(there, self.size - 1)], self.last)


@dataclass(frozen=True, eq=False)
class Largest(Column):
    """The largest of all numbers of another column from an index on, and at least 0.

    ahead: that from every LEAF-th index on, and 0; where it does not change from one to the next, neither does it in between.
    """

    column: Any
    ahead: Array

    @classmethod
    def of(cls, column: Any) -> Largest:
        """Gone through part by part."""
        ahead = np.zeros(-(-column.size // LEAF) + 1)
        for part in blocks(column.size):  # of whole leaves
            values = column[part]
            first = part.start // LEAF
            ahead[first : first - (-values.size // LEAF)] = np.maximum.reduceat(values, np.arange(0, values.size, LEAF))
        ahead[-1] = 0.0
        return cls(column, np.maximum.accumulate(ahead[::-1])[::-1].copy())  # `take` copies what runs backwards, each time

    @property
    def size(self) -> int:  # type: ignore[override]
        """As many as the other."""
        return int(self.column.size)

    def at(self, k: Array) -> Array:
        """The largest from there on."""
        leaf = k >> LEAF_LEVEL
        found = self.ahead.take(leaf + 1)
        doubtful = np.flatnonzero(self.ahead.take(leaf) != found)
        if doubtful.size:
            within = k[doubtful] + np.arange(LEAF)[:, None]
            values = self.column[np.minimum(within, self.size - 1)]
            values[within >> LEAF_LEVEL != leaf[doubtful]] = 0.0
            found[doubtful] = np.maximum(found[doubtful], values.max(axis=0))
        return found


@dataclass(frozen=True, eq=False)
class SumsAhead(Column):
    """The sum of all numbers of another column, none of them negative, from an index on, added from the end.

    ahead: that from every LEAF-th index on, and 0.
    """

    column: Any
    ahead: Array

    @classmethod
    def of(cls, column: Any) -> SumsAhead:
        """Gone through part by part."""
        ahead, total = np.zeros(-(-column.size // LEAF) + 1), 0.0
        for part in reversed(list(blocks(column.size))):
            sums = np.cumsum(np.append(total, column[part][::-1]))[:0:-1]
            total = float(sums[0])
            first = part.start // LEAF
            ahead[first : first - (-sums.size // LEAF)] = sums[::LEAF]
        return cls(column, ahead)

    @property
    def size(self) -> int:  # type: ignore[override]
        """As many as the other."""
        return int(self.column.size)

    def least(self, k: Array) -> Array:
        """Less than the sum, or as much."""
        return self.ahead.take((k >> LEAF_LEVEL) + 1)

    def at(self, k: Array) -> Array:
        """The sums from there on."""
        found, end = self.least(k), ((k >> LEAF_LEVEL) + 1) << LEAF_LEVEL
        for back in range(1, LEAF + 1):
            there = end - back
            adds = (there >= k) & (there < self.size)
            found = found + np.where(adds, self.column[np.minimum(there, self.size - 1)], 0.0)
        return found
