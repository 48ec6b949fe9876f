"""Bodies with two edges that differ, from cell to cell, in one march."""

from collections.abc import Sequence
from typing import Any, Self

import numpy as np

from ..equations.equation import Equation
from ..lanes import Array, Cells
from .contact import Unequal


class UnequalCells(Unequal):
    """Two edges that differ, and that differ from cell to cell: each pair of numbers is
    (right edges, left edges), (cells,) each. The bodies have one equation that takes
    cells, in which |theta|/alpha is proportional to y.
    """

    def __post_init__(self) -> None:
        """Accept the numbers, which are those of contacts that have been checked."""

    @classmethod
    def of(cls, contacts: Sequence[Unequal], counts: Sequence[int]) -> Self:
        """Return the contact of so many cells of each body."""

        def cells(name: str) -> Any:
            pairs = np.array([getattr(contact, name) for contact in contacts])
            right, left = np.repeat(pairs, counts, axis=0).T
            return right, left

        return cls(cells("drive"), cells("omega"), cells("eta"), cells("rotation"))

    def _of(self, pair: tuple[Any, Any], side: Array, cell: Array) -> Array:
        right, left = pair
        return np.where(side > 0.0, right[cell], left[cell])

    def cells(
        self, equation: Equation, amplitude: Array, omega: Array, eta: Array
    ) -> Cells:
        """Return a row for each edge; the argument `eta` is ignored."""
        drive, frequency, own = map(np.array, (self.drive, self.omega, self.eta))
        return Cells(drive * amplitude, frequency * omega, own)

    def speed(self, side: Array, rate: Array) -> Array:
        """Refuse: lanes of several bodies have no common alpha and p."""
        raise NotImplementedError("the speeds of several bodies with unequal edges")
