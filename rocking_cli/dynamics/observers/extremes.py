"""The largest value of a quantity that each cell has come to."""

from __future__ import annotations

import numpy as np

Array = np.ndarray


class Extremes:
    """The largest values so far, `largest`, (cells,). Parameters: start: what each cell begins with, (cells,)."""

    def __init__(self, start: Array) -> None:
        self.largest = start

    def offer(self, cell: Array, value: Array) -> None:
        """Take in values of these cells, (n,), of which several may belong to one cell; NaN leaves a cell as it is."""
        np.fmax.at(self.largest, cell, value)

    def can_beat(self, cell: Array, bound: Array) -> Array:
        """Whether a value up to `bound` can be larger than those of these cells so far, (n,); True where the bound is NaN."""
        return ~(bound <= self.largest[cell])
