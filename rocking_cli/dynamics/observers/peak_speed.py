"""The largest angular speed of each cell.

Within an arc |v| is largest at an end or where the acceleration is zero. Under straight
lines the acceleration of the linear oscillator between samples is a sum of two
exponentials, which has at most one zero; the nonlinear equations differ little from it
over one sample. A propagation over samples is halved while the bounds of y'' allow a
larger speed in it. The march replaces a Taylor step in which y'' changes its sign and
y'' >= -K (Lemma 12) allows a larger speed. After the shaking the speed is largest
before the next impact: by the energy, or with damping by following the body to it.
"""

from collections.abc import Callable

import numpy as np

from ..batch import Batch
from ..lanes import Array, Lanes
from .extremes import ExtremePoint, Extremes, SearchStretches, parts
from .observer import Arcs, Observer, Propagation, TaylorSteps


class PeakSpeed(Observer):
    """The observer that finds max |d theta/d tau|/alpha [-] of each cell, in `speed`;
    tau = p t, with p and alpha of the reference.
    """

    def __init__(self, batch: Batch) -> None:
        self.equation = batch.equation
        self.contact = batch.contact
        self.shaken = batch.shaken
        self.speed = Extremes(np.zeros(batch.size))

    def _speed(self, side: Array, cell: Array, y: Array, v: Array) -> Array:
        """|d theta/d tau|/alpha of lanes of these cells on these sides."""
        return np.abs(
            self.contact.speed(side, self.equation.on(side, cell).rotation_rate(y, v))
        )

    def arcs(self, arcs: Arcs) -> None:
        lanes, arc, reach, y, v, b, _ = arcs
        b = b - 2.0 * arc.damping * v
        self.speed.include(lanes.cell, self._speed(lanes.side, lanes.cell, y, v))
        # Where y'' changes its sign the speed has an extreme inside the arc. Only arcs
        # whose bound exceeds the largest speed so far are searched.
        within = np.maximum(np.abs(arc.v), np.abs(v)) + 0.5 * reach * np.maximum(
            np.abs(arc.b), np.abs(b)
        )
        at = np.flatnonzero(
            (arc.b * b < 0.0)
            & self.speed.can_exceed(
                lanes.cell, self._speed(lanes.side, lanes.cell, y, within)
            )
        )
        if not at.size:
            return
        side = lanes.side[at]
        cell = lanes.cell[at]
        sign = np.sign(arc.b[at])
        arc = arc.take(at)
        zero = np.zeros(at.size)

        def rates(own: Array, y: Array, *of: Array) -> ExtremePoint:
            equation = self.equation.on(side[own], cell[own])
            speed, slope = (
                sign[own] * self.contact.speed(side[own], equation.rotation_rate(y, x))
                for x in of
            )
            return ExtremePoint(speed, slope)

        def along(own: Array, h: Array) -> ExtremePoint:
            point = arc.take(own).at(h)
            return rates(own, point.y, point.v, point.b)

        indices = np.arange(at.size)
        whole = SearchStretches(np.arange(at.size), zero, reach[at], arc.fastest)
        ends = rates(indices, arc.y, arc.v, arc.b), rates(indices, y[at], v[at], b[at])
        s, one, other = parts(along, whole, *ends)
        self.speed.search(cell[s.own], along, s, one, other)

    def steps(self, steps: TaylorSteps, go: Array) -> None:
        """Take in the speeds at the ends of Taylor steps; reject steps that may hold a
        larger speed inside.
        """
        cell, side, equation = steps.cell, steps.side, steps.equation
        end_y, end_v = steps.end
        speed = np.abs(self.contact.speed(side, equation.rotation_rate(end_y, end_v)))

        # Steps whose bound of the speed allows a larger one, where the acceleration
        # changes its sign.
        within = _largest_rate(steps)
        highest = self.contact.speed(side, equation.rotation_rate(end_y, within))
        at = np.flatnonzero(
            go & (highest > speed) & self.speed.can_exceed(cell, highest)
        )
        if at.size:
            first, last = self._accelerations(steps, at)
            go[at[first * last < 0.0]] = False
        self.speed.include(cell[go], speed[go])

    def _accelerations(self, steps: TaylorSteps, at: Array) -> tuple[Array, Array]:
        """The accelerations y'' at the start and at the end of these steps."""
        (y, v), (end_y, end_v) = steps.start, steps.end
        drive, gain = steps.ramp.line
        there = self.equation.on(steps.side[at], steps.cell[at])
        drag = 2.0 * steps.equation.damping
        first = there.force(y[at], drive[at]) - drag * v[at]
        return first, there.force(end_y[at], drive[at] + gain[at]) - drag * end_v[at]

    def propagates(
        self,
        lanes: Lanes,
        step: Propagation,
        proved: Array,
        strongest: Callable[[Array], Array],
    ) -> Array:
        """Return propagations that may hold a larger speed. With c - 1 <= y'' <= r, v
        is below the lines of slope r from the start and c - 1 to the end, and above
        those of slope c - 1 from the start and r to the end.
        """
        cell, side, at = lanes.cell, lanes.side, np.flatnonzero(proved)
        self.speed.include(cell[at], np.abs(self.contact.speed(side[at], step.v[at])))
        fastest = self.speed.largest[cell] / self.contact.speed(
            side, np.ones(side.size)
        )
        at = np.flatnonzero(
            (step.fall * step.time + np.maximum(step.v, -lanes.v) > fastest) & proved
        )
        v, end, fall, time = lanes.v[at], step.v[at], step.fall[at], step.time[at]
        highest = (
            np.maximum(lanes.y[at], step.y[at])
            + 0.125 * np.maximum(fall, 0.0) * time * time
        )
        rise = highest - 1.0 + strongest(at)
        top = v + rise * (end - v + fall * time) / (rise + fall)
        bottom = v - fall * (v - end + rise * time) / (rise + fall)
        # y'' may change its sign here, and the speed may exceed the largest so far.
        return at[
            (rise > 0.0) & (fall > 0.0) & (np.maximum(top, -bottom) > fastest[at])
        ]

    def free(self, lanes: Lanes) -> None:
        zero = np.zeros(lanes.cell.size)
        there = self.equation.on(lanes.side, lanes.cell)
        at_ground = np.sqrt(
            there.fall(lanes.y, lanes.v)[1] / there.fall(zero, zero + 1.0)[1]
        )
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


def _largest_rate(steps: TaylorSteps) -> Array:
    """A bound of |y'| on each step, by y'' >= -K (Lemma 12)."""
    (_, v), (_, end_v), ramp = steps.start, steps.end, steps.ramp
    drive, gain = ramp.line
    lift, push = steps.equation.bounds
    steepest = lift + push * np.maximum(0.0, -np.minimum(drive, drive + gain))
    growth = np.exp(2.0 * steps.equation.damping * ramp.unit)
    return np.asarray(
        (np.maximum(np.abs(v), np.abs(end_v)) + steepest * ramp.unit) * growth
    )
