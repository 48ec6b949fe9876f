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
from .recurrence import Series


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

    def _each(self, name: str, *numbers: Any, **options: Any) -> Array:
        """Return what a method of the mechanisms returns for numbers of the lanes, each
        (..., lanes), where every lane has its own mechanism.
        """
        assert self.which is not None  # `on` has chosen the lanes
        found: Array | None = None
        for i, one in enumerate(self.mechanisms):
            at = np.flatnonzero(self.which == i)
            if not at.size:
                continue
            own = (
                np.broadcast_to(x, (*np.shape(x)[:-1], self.which.size))[..., at]
                for x in numbers
            )
            values = np.asarray(getattr(one, name)(*own, **options))
            if found is None:
                shape = *values.shape[:-1], self.which.size
                found = np.empty(shape, dtype=values.dtype)
            found[..., at] = values
        assert found is not None
        return found

    def longest(self, terms: Array, fastest: Array) -> Array:
        return self._each("longest", terms, fastest)

    def along(
        self, y: Series, new: Callable[[], Series]
    ) -> tuple[Series, Series, Callable[[int], None]]:
        """The series of F and G about the present y, composed with that of the
        motion.
        """
        return composed(self._each("near", y[0], count=len(y.array) - 2), y, new)

    def force(self, y: Array, a: Array, weight: Array | float = 1.0) -> Array:
        return self._each("force", y, a, weight)

    def rotation(self, y: Array) -> Array:
        return self._each("rotation", y)

    def rotation_rate(self, y: Array, v: Array) -> Array:
        return self._each("rotation_rate", y, v)

    def displacement(self, rotation: Array) -> Array:
        return self._each("displacement", rotation)

    def fall(self, y: Array, v: Array) -> tuple[Array, Array]:
        overturns, energy = self._each("fall", y, v)
        return overturns > 0.0, energy

    def peak(self, energy: Array) -> Array:
        return self._each("peak", energy)

    def may_overturn(self, y: Array, v: Array) -> Array:
        return np.asarray((v > 0.0) | (y >= self.limit))

    def certainly_overturns(
        self, y: Array, v: Array, inward: Array, steady: bool = True
    ) -> Array:
        return self._each("certainly_overturns", y, v, inward, steady=steady)
