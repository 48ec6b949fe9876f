"""Columns over the intervals of a long record that follow from its samples and the equal step: computed where they are asked for.

An array of a column holds eight bytes an interval, and a motion has a dozen of them. Each number is the one that an array would hold, to
the last bit. Short records are faster with arrays.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from functools import cached_property
from typing import Any

import numpy as np

from .blocks import blocks

Array = np.ndarray

LEAF_LEVEL = 3
LEAF = 1 << LEAF_LEVEL  # intervals between two numbers that are kept of a column which is not computed from a sample's neighbours alone


class Column(ABC):
    """Numbers by their index, as an array that cannot be written: `at` gives those of whole numbers from 0, of any shape."""

    ndim = 1

    def __init__(self, size: int) -> None:
        self.size = size

    @abstractmethod
    def at(self, k: Array) -> Array:
        """The numbers of these indices."""

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


class Instants(Column):
    """first, first + by, first + 2 by ... times a step."""

    def __init__(self, size: int, step: float, first: int = 0, by: int = 1) -> None:
        super().__init__(size)
        self.step, self.first, self.by = step, first, by

    def at(self, k: Array) -> Array:
        """The times of these indices."""
        return self.step * (self.first + self.by * k)

    def of(self, size: int, skipped: int = 0) -> Instants:
        """So many of them from another one on, also beyond the last."""
        return Instants(size, self.step, self.first + self.by * skipped, self.by)

    def begun(self, phase: Array) -> Array:
        """The last that is not after each phase, the first where there is none."""
        guess = np.clip(np.floor((phase / self.step - self.first) / self.by).astype(np.int64), 0, self.size - 1)
        guess -= self.at(guess) > phase
        guess += self.at(guess + 1) <= phase
        return np.asarray(np.clip(guess, 0, self.size - 1))

    def goes_on(self, other: Instants) -> bool:
        """Whether the others are these, and perhaps more."""
        return self.size <= other.size and (self.step, self.first, self.by) == (other.step, other.first, other.by)

    def hold(self, other: Instants) -> bool:
        """Whether each of the others is one of these, beyond the last too."""
        every = round(other.step * other.by / (self.step * self.by))
        return self.first == other.first == 0 and all(
            np.array_equal(other[x], self.at(every * np.arange(x.start, x.stop))) for x in blocks(other.size)
        )


class Levels(Column):
    """Every `by`-th of some values from the `first` on, times factors, one after the other."""

    def __init__(self, size: int, values: Array, factors: tuple[float, ...], first: int = 0, by: int = 1) -> None:
        super().__init__(size)
        self.values, self.factors, self.first, self.by = values, factors, first, by

    def at(self, k: Array) -> Array:
        """The values of these indices."""
        found = self.values.take(self.first + self.by * k if self.by > 1 else k + self.first if self.first else k)
        for factor in self.factors:
            found = factor * found
        return found

    def of(self, size: int, first: int = 0, by: int = 1) -> Levels:
        """So many of the same values, from another one on."""
        return Levels(size, self.values, self.factors, first, by)

    def times(self, factor: float) -> Levels:
        """These times one more factor."""
        return Levels(self.size, self.values, (*self.factors, factor), self.first, self.by)


class Computed(Column):
    """A function of other columns, number by number."""

    def __init__(self, function: Callable[..., Array], columns: tuple[Any, ...]) -> None:
        super().__init__(columns[0].size)
        self.function, self.columns = function, columns

    def at(self, k: Array) -> Array:
        """Computed from the others'."""
        return self.function(*(x[k] for x in self.columns))


def of_columns(function: Callable[..., Array], *columns: Any) -> Any:
    """A function of columns, or of arrays."""
    return Computed(function, columns) if isinstance(columns[0], Column) else function(*columns)


def followed_by(values: Any, last: float | bool) -> Any:
    """A column or an array, whose last axis counts, and one number after it."""
    if isinstance(values, Column):
        return Then(values, last)
    return np.concatenate([values, np.full((*values.shape[:-1], 1), last, dtype=values.dtype)], axis=-1)


class Then(Column):
    """Another column and one number, or several that are equal, after it."""

    def __init__(self, column: Any, last: float, times: int = 1) -> None:
        super().__init__(column.size + times)
        self.column, self.last = column, last

    def at(self, k: Array) -> Array:
        """Those of the other, or the last."""
        before = self.column.size
        return np.where(k < before, self.column[np.minimum(k, before - 1)], self.last)


class Joined(Column):
    """One column after another."""

    def __init__(self, one: Any, other: Any) -> None:
        super().__init__(one.size + other.size)
        self.one, self.other = one, other

    def at(self, k: Array) -> Array:
        """Those of the one, or of the other."""
        before, first = k < self.one.size, self.one.size
        if before.all():
            return np.asarray(self.one[k])
        if not before.any():
            return np.asarray(self.other[k - first])
        return np.where(before, self.one[np.minimum(k, first - 1)], self.other[np.maximum(k - first, 0)])


class After(Column):
    """Of another column the next number, and one more at the end."""

    def __init__(self, column: Any, last: float) -> None:
        super().__init__(column.size)
        self.column, self.last = column, last

    def at(self, k: Array) -> Array:
        """Those of the other at the next index."""
        there = k + 1
        return np.where(there < self.size, self.column[np.minimum(there, self.size - 1)], self.last)


class Largest(Column):
    """The largest of all numbers of another column from an index on, and at least 0.

    ahead: that from every LEAF-th index on, and 0; where it does not change from one to the next, neither does it in between.
    """

    def __init__(self, column: Any) -> None:
        super().__init__(column.size)
        self.column = column

    @cached_property
    def ahead(self) -> Array:
        """Found when it is first asked for: of a weight and two edges some never are."""
        ahead = np.zeros(-(-self.size // LEAF) + 1)
        for part in blocks(self.size):  # of whole leaves
            values = self.column[part]
            first = part.start // LEAF
            ahead[first : first - (-values.size // LEAF)] = np.maximum.reduceat(values, np.arange(0, values.size, LEAF))
        ahead[-1] = 0.0
        return np.maximum.accumulate(ahead[::-1])[::-1].copy()  # `take` copies what runs backwards, each time

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


class SumsAhead(Column):
    """The sum of all numbers of another column, none of them negative, from an index on, added from the end.

    ahead: that from every LEAF-th index on, and 0.
    """

    def __init__(self, column: Any) -> None:
        super().__init__(column.size)
        self.column = column
        self.ahead, total = np.zeros(-(-column.size // LEAF) + 1), 0.0
        for part in reversed(list(blocks(column.size))):
            sums = np.cumsum(np.append(total, column[part][::-1]))[:0:-1]
            total = float(sums[0])
            first = part.start // LEAF
            self.ahead[first : first - (-sums.size // LEAF)] = sums[::LEAF]

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
