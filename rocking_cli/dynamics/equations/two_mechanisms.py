"""The equation of a mechanism whose two sides differ: on each side Eq. 3.4 of its own
mechanism, as `MechanismEquation` has it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ...arrays import Array
from .equation import Equation
from .mechanism import MechanismEquation, composed
from .recurrence import Series, TermRows


class TwoMechanisms(Equation):
    """Eq. 3.4 for several mechanisms, one of them in each lane.

    Parameters
    ----------
    mechanisms
        the equations of the mechanisms: of the right edge and the left, or of cells
    which
        index of the mechanism of each lane, (lanes,); None before the lanes are known
    by_cell
        True if the mechanisms belong to cells, False if to the edges
    """

    composed = MechanismEquation.composed
    rotation_proportional = False

    def __init__(
        self,
        mechanisms: Sequence[MechanismEquation],
        which: Array | None = None,
        by_cell: bool = False,
    ) -> None:
        super().__init__(mechanisms[0].damping)
        self.mechanisms, self.which, self.by_cell = tuple(mechanisms), which, by_cell
        self.order = max(one.order for one in mechanisms)
        self.tolerance = mechanisms[0].tolerance
        self.limit, self.barrier = self._of("limit"), self._of("barrier")
        self.spread = math.prod(one.spread for one in mechanisms[:2])
        self.gain = max(one.gain for one in mechanisms)
        self.largest_m = self._of("largest_m")

    @classmethod
    def of_cells(cls, mechanisms: Sequence[Any]) -> Equation:
        """Return the equation of mechanisms that belong to cells."""
        first = mechanisms[0]
        if all(one.table is first.table for one in mechanisms):
            return first
        return cls(mechanisms, np.arange(len(mechanisms)), by_cell=True)

    def _of(self, name: str) -> Array:
        """A number of the mechanisms, (lanes,), or of all of them."""
        numbers = np.array([getattr(one, name) for one in self.mechanisms])
        return numbers if self.which is None else numbers[self.which]

    def _lanes(self, which: Array) -> Equation:
        """The equation of lanes with these mechanisms."""
        if not which.size or which.min() == which.max():
            return self.mechanisms[int(which[0]) if which.size else 0]
        return type(self)(self.mechanisms, which)

    def on(self, side: Array, cell: Array | None = None) -> Any:
        if self.by_cell:
            assert self.which is not None
            return self if cell is None else self._lanes(self.which[cell])
        return self._lanes((np.asarray(side) < 0.0).astype(np.int64))

    def part(self, lanes: slice) -> Any:
        return self if self.which is None else self._lanes(self.which[lanes])

    def edge(self, side: float) -> Any:
        return self.mechanisms[0 if side > 0.0 else 1]

    def _each(
        self, function: Callable[[MechanismEquation, Any], Any], size: int
    ) -> Array:
        """Fill (..., size) with what a function returns for each mechanism and the
        indices of its lanes.
        """
        which = self._which(size)
        found: Array | None = None
        for i, one in enumerate(self.mechanisms):
            at = np.flatnonzero(which == i)
            if at.size:
                values = np.asarray(function(one, at))
                if found is None:
                    found = np.empty((*values.shape[:-1], size), dtype=values.dtype)
                found[..., at] = values
        assert found is not None
        return found

    def _which(self, size: int) -> Array:
        assert self.which is not None  # `on` has chosen the lanes
        return self.which if self.which.size == size else self.which.repeat(size)

    def longest(self, terms: Array, fastest: Array) -> Array:
        return self._each(
            lambda one, at: one.longest(terms[:, at], fastest[at]), fastest.size
        )

    def along(
        self, y: Series, new: Callable[[], Series]
    ) -> tuple[Series, Series, Callable[[int], None]]:
        """The series of F and G about the present y, composed with that of the
        motion.
        """
        assert isinstance(y, TermRows)
        count = len(y.array) - 2
        local = self._each(lambda one, at: one.near(y[0][at], count), y[0].size)
        return composed(local, y, new)

    def force(self, y: Array, a: Array, weight: Array | float = 1.0) -> Array:
        a, weight = (np.broadcast_to(x, y.shape) for x in (a, weight))
        return self._each(lambda one, at: one.force(y[at], a[at], weight[at]), y.size)

    def rotation(self, y: Array) -> Array:
        y = np.broadcast_to(y, self._shape(y))
        return self._each(lambda one, at: one.rotation(y[at]), y.size)

    def rotation_rate(self, y: Array, v: Array) -> Array:
        return self._each(lambda one, at: one.rotation_rate(y[at], v[at]), y.size)

    def displacement(self, rotation: Array) -> Array:
        rotation = np.broadcast_to(rotation, self._shape(rotation))
        return self._each(lambda one, at: one.displacement(rotation[at]), rotation.size)

    def _shape(self, x: Array) -> tuple[int, ...]:
        assert self.which is not None
        return self.which.shape if np.size(x) == 1 else np.shape(x)

    def fall(self, y: Array, v: Array) -> tuple[Array, Array]:
        found = self._each(
            lambda one, at: np.stack(one.fall(y[at], v[at])).astype(float), y.size
        )
        return found[0] > 0.0, found[1]

    def peak(self, energy: Array) -> Array:
        return self._each(lambda one, at: one.peak(energy[at]), energy.size)

    def may_overturn(self, y: Array, v: Array) -> Array:
        return np.asarray((v > 0.0) | (y >= self.limit))

    def certainly_overturns(
        self, y: Array, v: Array, inward: Array, steady: bool = True
    ) -> Array:
        return self._each(
            lambda one, at: one.certainly_overturns(y[at], v[at], inward[at], steady),
            y.size,
        )
