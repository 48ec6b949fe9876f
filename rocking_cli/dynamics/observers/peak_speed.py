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
from .extremes import ExtremePoint, Extremes, TimeSpans, parts
from .observer import Arcs, Observer


class PeakSpeed(Observer):
    """The observer that finds max |d theta/d tau|/alpha [-] of each cell, in `speed`;
    tau = p t, with p and alpha of the reference.
    """

    selects = True

    def __init__(self, batch: Batch) -> None:
        self.equation = batch.equation
        self.contact = batch.contact
        self.shaken = batch.shaken
        self.speed = Extremes(np.zeros(batch.size))

    def _speed(self, side: Array, cell: Array, y: Array, v: Array) -> Array:
        """|d theta/d tau|/alpha of lanes of these cells on these sides."""
        return np.abs(
            self.contact.speed(
                side, cell, self.equation.on(side, cell).rotation_rate(y, v)
            )
        )

    def arcs(self, arcs: Arcs) -> None:
        lanes, arc, reach, y, v, _, _, fastest = arcs
        self.speed.include(lanes.cell, self._speed(lanes.side, lanes.cell, y, v))
        # The speed is largest at the end of a step, or where y'' is 0 inside it.
        highest = np.maximum(arc.y, y) + 0.5 * reach * fastest
        at = np.flatnonzero(self.needs(lanes.side, lanes.cell, highest, fastest))
        if not at.size:
            return
        side, cell, arc = lanes.side[at], lanes.cell[at], arc.take(at)
        zero = np.zeros(at.size)
        end = arc.at(reach[at])

        for sign in (1.0, -1.0):  # outwards and inwards

            def rates(
                own: Array, y: Array, *of: Array, sign: float = sign
            ) -> ExtremePoint:
                equation = self.equation.on(side[own], cell[own])
                speed, slope = (
                    sign
                    * self.contact.speed(
                        side[own], cell[own], equation.rotation_rate(y, x)
                    )
                    for x in of
                )
                return ExtremePoint(speed, slope)

            def along(own: Array, h: Array, rates: Any = rates) -> ExtremePoint:
                point = arc.take(own).at(h)
                return rates(own, point.y, point.v, point.b)

            indices = np.arange(at.size)
            whole = TimeSpans(indices, zero, reach[at], arc.fastest)
            ends = (
                rates(indices, arc.y, arc.v, arc.b),
                rates(indices, end.y, end.v, end.b),
            )
            s, one, other = parts(along, whole, *ends)
            self.speed.search(cell[s.own], along, s, one, other)

    def needs(self, side: Array, cell: Array, highest: Array, fastest: Array) -> Array:
        ends = (self._speed(side, cell, y, fastest) for y in (0.0 * highest, highest))
        return self.speed.can_exceed(cell, np.maximum(*ends))

    def free(self, lanes: Lanes) -> None:
        zero = np.zeros(lanes.cell.size)
        there = self.equation.on(lanes.side, lanes.cell)
        at_ground = np.sqrt(2.0 * there.fall(lanes.y, lanes.v)[1])
        self.speed.include(
            lanes.cell, self._speed(lanes.side, lanes.cell, zero, at_ground)
        )

    def may_settle(self, lanes: Lanes, bounced: Array) -> Array:
        """False for lanes that fall for the first time on still ground: the march
        follows them to the impact.
        """
        return ~(
            (lanes.segment >= self.shaken) & (lanes.y > 0.0) & ~bounced[lanes.cell]
        )
