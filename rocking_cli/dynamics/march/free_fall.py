"""Free fall: an instant from which the ground falls as fast as the bodies on it, w <= 0, so that nothing holds them to it any more."""

from __future__ import annotations

import numpy as np

from ...motions.segments import Segments
from ..contacts.contact import Uplift, first_uplift
from ..lanes import Cells, Lanes

Array = np.ndarray

_INSTANT = 1e-9  # tau: within it of a free fall the weight is as good as none


class FreeFall:
    """Where the ground first falls away from the body of each cell, (cells,): k, u its place in the motion; ever: True if it does."""

    def __init__(self, segments: Segments, first: Uplift, ever: Array) -> None:
        self.segments, self.k, self.u, self.ever = segments, first.k, first.u, ever

    @classmethod
    def of(cls, segments: Segments, cells: Cells, shaken: int) -> FreeFall | None:
        """The free fall of cells under a motion that ends with segment `shaken`; None if the ground falls away from none of them."""
        weighed = segments.weighed
        if weighed is None:
            return None
        sway = weighed.sway(np.ones(cells.omega.shape[1]), cells.amplitude[0])
        down, up = np.maximum(sway, 0.0), np.maximum(-sway, 0.0)
        first = first_uplift(weighed.vertical, np.zeros(sway.size, dtype=np.int64), np.zeros(sway.size), down, up)
        ever = first.k < shaken
        return cls(segments, first, ever) if ever.any() else None

    def until(self, lanes: Lanes) -> Array:
        """The time [tau] that is left until the ground falls away; 0 after it."""
        k, start = self.k[lanes.cell], self.segments.start
        last = len(self.segments) - 1
        ahead = start[np.minimum(k, last)] - start[np.minimum(lanes.k, last)]  # its rounding is far below `_INSTANT`
        until = (ahead + (self.u[lanes.cell] - lanes.u)) / lanes.omega
        return np.where(self.ever[lanes.cell], np.where(lanes.k > k, 0.0, until), np.inf)

    def now(self, lanes: Lanes) -> Array:
        """True for lanes from which the ground falls away now."""
        return np.asarray(self.until(lanes) <= _INSTANT)

    def sooner(self, cell: Array, lift: Uplift) -> tuple[Array, Array]:
        """(k, u) of the free fall or of the uplift of bodies at rest, the earlier one."""
        k, u = self.k[cell], self.u[cell]
        before = (k < lift.k) | ((k == lift.k) & (u < lift.u))
        return np.where(before, k, lift.k), np.where(before, u, lift.u)
