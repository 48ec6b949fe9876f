"""The largest speed of each cell. A step of the march is searched where the bound of
its speed allows a larger one than was found so far. After the shaking the speed is
largest before the next impact: by the energy, or with damping by following the body to
it.
"""

from typing import Any

import numpy as np

from ...arrays import Array
from ..batch import Batch
from ..lanes import Lanes
from .observer import Arcs, Observer

# equidistant instants of a step at which the speed is computed, and then as many times
# between the neighbours of the fastest: a parabola gives the largest to 1e-6
_INSTANTS, _ROUNDS = 9, 3


class PeakSpeed(Observer):
    """The observer that finds max |d theta/d tau|/alpha [-] of each cell, in `largest`;
    tau = p t, with p and alpha of the reference.
    """

    def __init__(self, batch: Batch) -> None:
        self.equation = batch.equation
        self.contact = batch.contact
        self.shaken = batch.shaken
        self.largest = np.zeros(batch.size)

    def _speed(self, side: Array, cell: Array, y: Array, v: Array) -> Array:
        """|d theta/d tau|/alpha of lanes of these cells on these sides."""
        return np.abs(
            self.contact.speed(
                side, cell, self.equation.on(side, cell).rotation_rate(y, v)
            )
        )

    def arcs(self, arcs: Arcs) -> None:
        side, cell = arcs.lanes.side, arcs.lanes.cell
        highest = arcs.lanes.y + arcs.reach * arcs.fastest
        exceeds = self._exceeds(side, cell, highest, arcs.fastest)
        at = np.flatnonzero(arcs.wanted & exceeds)
        if not at.size:
            return
        every = np.repeat(at, _INSTANTS)
        side, own, arc = side[every], cell[every], arcs.arc.take(every)
        lanes, low, high = np.arange(at.size), np.zeros(at.size), arcs.reach[at]
        for _ in range(_ROUNDS):
            h = np.linspace(low, high, _INSTANTS, axis=1)
            point = arc.at(h.ravel())
            speeds = self._speed(side, own, point.y, point.v).reshape(h.shape)
            middle = np.clip(np.argmax(speeds, axis=1), 1, _INSTANTS - 2)
            low, high = h[lanes, middle - 1], h[lanes, middle + 1]
        before, here, after = (speeds[lanes, middle + i] for i in (-1, 0, 1))
        with np.errstate(all="ignore"):
            top = here + (after - before) ** 2 / (8.0 * (2.0 * here - before - after))
        inside = here > np.maximum(before, after)
        found = np.where(inside, top, np.maximum(np.maximum(before, after), here))
        np.fmax.at(self.largest, cell[at], found)

    def _exceeds(
        self, side: Array, cell: Array, highest: Array, fastest: Array
    ) -> Array:
        """True where a body with these bounds of y and |y'| may be faster than so far,
        or the bound is NaN.
        """
        ends = (self._speed(side, cell, y, fastest) for y in (0.0 * highest, highest))
        return ~(np.maximum(*ends) <= self.largest[cell])

    def needs(
        self, side: Array, cell: Array, highest: Array, fastest: Array, *_: Any
    ) -> Array:
        return self._exceeds(side, cell, highest, fastest)

    def free(self, lanes: Lanes) -> None:
        zero = np.zeros(lanes.cell.size)
        there = self.equation.on(lanes.side, lanes.cell)
        at_ground = np.sqrt(2.0 * there.fall(lanes.y, lanes.v)[1])
        speed = self._speed(lanes.side, lanes.cell, zero, at_ground)
        np.fmax.at(self.largest, lanes.cell, speed)

    def may_settle(self, lanes: Lanes, bounced: Array) -> Array:
        """False for lanes that fall for the first time on still ground: the march
        follows them to the impact.
        """
        return ~(
            (lanes.segment >= self.shaken) & (lanes.y > 0.0) & ~bounced[lanes.cell]
        )
