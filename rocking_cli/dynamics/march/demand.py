"""What each cell asks of the ground: the least vertical force and the largest |Fx|/Fz of a rigid body, found along with its march.

With z = alpha - u, u = |theta|, s the side and w = 1 + zg''/g, what moves the mass centre is (over m g, ' by tau of the side)

    s Fx = s xg''/g + kappa (u'' cos z + u'^2 sin z),   Fz = w + kappa (u'' sin z - u'^2 cos z)

where u'' follows from the drive by the equation of motion. At rest they are xg''/g and w. What the march closes is judged by bounds
(`closing`): where these leave room for a record it is followed afterwards (`aftermath`).
"""

from __future__ import annotations

from typing import NamedTuple, Self

import numpy as np

from ...motions.segments import Segments
from ..body import Body
from ..contacts.contact import Contact
from ..equations.equation import Equation, Flow
from ..lanes import Cells, Lanes
from ..weight import WeighedSegments
from .closing import Bounds, bouncing, free_bounds, train_bounds
from .extremes import EXACT, Course, Records
from .ground import Ground, value_and_slope

Array = np.ndarray


# Stretches, over the time in which an arc bends, through which a cubic tells where an extremum may be: of exact flows, whose steps
# are long, and of series.
_LONGEST, _MOST_PARTS = {True: 1.0, False: 1.5}, 6
_FAR = 1.0  # y beyond which a body on its way outwards mostly falls: its forces wait until that is known
_TOGETHER = 16384  # lanes that are taken in at a time of those that waited


class Waiting(NamedTuple):
    """Lanes as they began a step, its length [tau], and y, v at its end."""

    lanes: Lanes
    stop: Array
    y: Array
    v: Array

    def take(self, at: Array) -> Self:
        """Of some lanes."""
        return type(self)(self.lanes.take(at), self.stop[at], self.y[at], self.v[at])


class Demands(Records):
    """The records of the cells of a run; `open`: lanes that it closed, of which a record may still come; `far`: y of steps that wait for
    whether their body falls.

    shaken: the segment from which on the ground is still.
    """

    def __init__(self, body: Body, segments: Segments, shaken: int, contact: Contact, cells: Cells) -> None:
        super().__init__(cells.omega.shape[1])
        self.body, self.segments, self.shaken, self.contact, self.cells = body, segments, shaken, contact, cells
        self.ground = Ground(body, segments)
        self.open: list[Lanes] = []
        self.far, self._waiting = _FAR, list[Waiting]()
        self._steepest = max(edge.uplift for edge in body.edges)

    def course(self, lanes: Lanes, h: Array, y: Array, v: Array) -> Course:
        """The course of lanes that are at y, v after h; their forces follow from the drive there, not from differences of the series."""
        push, push_slope, weight, weight_slope = self.ground.shaking(lanes, h)
        alpha, k, unit, _ = self.body.on(lanes.side)
        z, rate = alpha - y * unit, v * unit
        sin, cos = np.sin(z), np.cos(z)
        if self.body.linear:
            bend, jerk = push - weight * z, push_slope + weight * rate - weight_slope * z
        else:
            bend = push * cos - weight * sin
            jerk = push_slope * cos + rate * (weight * cos + push * sin) - weight_slope * sin
        if self.body.damping:
            bend = bend - 2.0 * self.body.damping * rate
            jerk = jerk - 2.0 * self.body.damping * bend
        square = rate * rate
        fx = k * (bend * cos + square * sin) - push
        fz = weight + k * (bend * sin - square * cos)
        fx_slope = k * ((jerk - rate * square) * cos + 3.0 * rate * bend * sin) - push_slope
        fz_slope = weight_slope + k * ((jerk - rate * square) * sin - 3.0 * rate * bend * cos)
        return Course(np.array([-fz, fx / fz]), np.array([-fz_slope, (fx_slope * fz - fx * fz_slope) / (fz * fz)]))

    def follow(self, lanes: Lanes, arc: Flow, stop: Array, y: Array, v: Array, at: Array) -> None:
        """Take in the arcs of the lanes `at` until `stop` [tau], where they are at y, v; `lanes` as they are at 0."""
        far = (y[at] > self.far) & (v[at] > 0.0)
        if far.any():
            self._waiting.append(Waiting(lanes, stop, y, v).take(at[far]))
            at = at[~far]
        some, low, high = lanes.take(at), np.zeros(at.size), stop[at]

        def along(own: Array, h: Array) -> Course:
            point = arc.take(at[own]).at(h)
            return self.course(some.take(own), h, point.y, point.v)

        one, other = self.course(some, low, some.y, some.v), self.course(some, high, y[at], v[at])
        parts = np.clip(np.ceil(high * arc.fastest[at] / _LONGEST[self.body.linear]), 1, _MOST_PARTS).astype(np.int64)
        own = np.repeat(np.arange(at.size), parts)
        if own.size == at.size:
            self.search(some.cell, along, low, high, one, other)
            return
        part = np.arange(own.size) - np.repeat(np.cumsum(parts) - parts, parts)
        length = (high / parts)[own]
        begins, ends = part > 0, part + 1 < parts[own]
        cuts = along(own[begins], (part * length)[begins])
        left, right = one.take(own), other.take(own)
        for row in (0, 1):
            left[row][:, begins], right[row][:, ends] = cuts[row], cuts[row]

        def within(one: Array, h: Array) -> Course:
            return along(own[one], h)

        self.search(some.cell[own], within, part * length, np.where(ends, (part + 1) * length, high[own]), left, right)

    def take_in(self, equation: Equation, upright: Array) -> None:
        """The steps that waited, of cells that stayed upright, (cells,)."""
        if not self._waiting:
            return
        parts, *others = zip(*self._waiting, strict=True)
        lanes = Lanes.joined(parts)
        every = Waiting(lanes, *map(np.concatenate, others))
        every, self.far, self._waiting = every.take(np.flatnonzero(upright[lanes.cell])), np.inf, []
        cell = every.lanes.cell
        order = np.argsort(cell, kind="stable")
        first = np.searchsorted(cell[order], cell[order])
        turn = np.empty_like(order)  # a cell's steps are taken in one after the other, so that they depend on no other cell
        turn[order] = np.arange(order.size) - first
        for n in range(int(turn.max(initial=-1)) + 1):
            at = np.flatnonzero(turn == n)
            for begin in range(0, at.size, _TOGETHER):
                lanes, stop, y, v = every.take(at[begin : begin + _TOGETHER])
                with np.errstate(all="ignore"):
                    arc = equation.on(lanes.side, lanes.cell).flow(self.segments, lanes)
                    self.follow(lanes, arc, stop, y, v, np.arange(stop.size))

    def rest(self, cell: Array, k: Array, u: Array, to_k: Array, to_u: Array) -> None:
        """Bodies at rest from (k, u) to another position; to_k: the number of segments where they rest to the end."""
        seg = self.segments
        to_k, to_u = _within(seg, to_k, to_u)
        if isinstance(seg, WeighedSegments):
            with np.errstate(all="ignore"):  # where the ground falls away there is no weight to divide by
                self._rest_weighed(seg, cell, k, u, to_k, to_u)
        else:
            np.maximum.at(self.friction, cell, self._resting_friction(cell, k, u, to_k, to_u))

    def rest_beats(self, cell: Array, k: Array, u: Array, to_k: Array, to_u: Array) -> Array:
        """Whether such rests may beat the records."""
        seg = self.segments
        to_k, to_u = _within(seg, to_k, to_u)
        if not isinstance(seg, WeighedSegments):
            return self.beaten(cell, np.ones(cell.size), self._resting_friction(cell, k, u, to_k, to_u))
        largest, least = _range(seg.vertical, k, u, to_k, to_u)
        sway = seg.sway(np.ones(cell.size), self.cells.amplitude[0, cell])
        return self.beaten(cell, 1.0 + np.minimum(sway * largest, sway * least), np.full(cell.size, self._steepest))

    def _push_of(self, cell: Array) -> Array:
        """The outward push over g of s = -1 on the right edge."""
        return self.cells.amplitude[0, cell] * self.body.edges[0].uplift

    def _resting_friction(self, cell: Array, k: Array, u: Array, to_k: Array, to_u: Array) -> Array:
        """Where the weight is steady; of a one-sided body as far as it leans on no backing."""
        largest, least = _range(self.segments, k, u, to_k, to_u)
        return self._push_of(cell) * (-least if self.body.one_sided else np.maximum(-least, largest))

    def _rest_weighed(self, seg: WeighedSegments, cell: Array, k: Array, u: Array, to_k: Array, to_u: Array) -> None:
        """Segment after segment, on each of which Fz is monotone and Fx/Fz is not."""
        size = np.positive if self.body.one_sided else np.abs
        while True:
            going = np.flatnonzero((k < to_k) | ((k == to_k) & (u < to_u)))
            if not going.size:
                return
            cell, k, u, to_k, to_u = (x[going] for x in (cell, k, u, to_k, to_u))
            stop = np.where(k < to_k, seg.length[k], to_u)

            def along(own: Array, phase: Array, cell: Array = cell, k: Array = k) -> Course:
                return self._resting(seg, cell[own], k[own], phase)

            every = np.arange(cell.size)
            self.search(cell, along, u, stop, along(every, u), along(every, stop), size)
            k, u = k + 1, np.zeros(k.size)

    def _resting(self, seg: WeighedSegments, cell: Array, k: Array, phase: Array) -> Course:
        """The course of bodies at rest, by the phase; outwards is to the right edge."""
        (s, slope), (rise, rise_slope) = value_and_slope(seg, k, phase), value_and_slope(seg.vertical, k, phase)
        sway, push = seg.sway(np.ones(cell.size), self.cells.amplitude[0, cell]), -self._push_of(cell)
        weight = 1.0 + sway * rise
        ratio = push * s / weight
        return Course(np.array([-weight, ratio]), np.array([-sway * rise_slope, (push * slope - ratio * sway * rise_slope) / weight]))

    def close(self, lanes: Lanes, to_k: Array, to_u: Array) -> None:
        """Lanes just after an impact whose bouncing ends in rest, until they lift off again at a position."""
        found = train_bounds(self.body, self.ground, lanes, self.contact).bounds
        self._leave(lanes, self.beaten(lanes.cell, *found) | self.rest_beats(lanes.cell, lanes.k, lanes.u, to_k, to_u))

    def free(self, lanes: Lanes, at: Array, y: Array, v: Array) -> None:
        """The lanes `at`, undamped, which are at y, v (both of these lanes) when the shaking is over, and stay upright."""
        some = lanes.take(at)
        some.k, some.u, some.y, some.v = np.full(at.size, self.shaken), np.zeros(at.size), y, v
        eta = self.cells.eta[0, some.cell] * self.cells.eta[-1, some.cell]
        bounces = np.flatnonzero((eta > 0.0) & (eta < 1.0))  # ever lower
        for side in (some.side, -some.side):
            settling = bouncing(self.body, self.body.on(side[bounces]), np.zeros(bounces.size), 1.0)
            self.note(some.cell[bounces], settling.fz, settling.friction)
            if self.body.one_sided:
                break
        found = self.free_bounds(some)
        closed = (found.fz > -np.inf) & (found.friction <= self.friction[some.cell] + EXACT)
        np.minimum.at(self.fz_min, some.cell[closed], found.fz[closed])  # met at an impact
        self._leave(some, ~closed)

    def settle(self, lanes: Lanes) -> None:
        """Damped lanes on still ground that the march leaves."""
        self._leave(lanes, self.beaten(lanes.cell, *self.free_bounds(lanes)))

    def free_bounds(self, lanes: Lanes) -> Bounds:
        """Of lanes on still ground; undamped, what is to come has the least Fz itself."""
        here, there = self.body.on(lanes.side), self.body.on(-lanes.side)
        u = here.unit * lanes.y
        square = (here.unit * lanes.v) ** 2 + self.body.fall(here, u)
        found = free_bounds(self.body, here, square)
        if len(self.body.alpha) > 1:
            beyond = free_bounds(self.body, there, square * (lanes.eta * there.unit / here.unit) ** 2)
            found = Bounds(*(np.where(lanes.eta > 0.0, both, one) for both, one in zip(found.worst(beyond), found, strict=True)))
        inside = u <= 2.0 * here.alpha
        return Bounds(np.where(inside, found.fz, -np.inf), np.where(inside, found.friction, np.inf))

    def fell_away(self, cell: Array) -> None:
        """Cells from which the ground has fallen away."""
        self.note(cell, np.zeros(cell.size), np.zeros(cell.size))

    def _leave(self, lanes: Lanes, where: Array) -> None:
        at = np.flatnonzero(where)
        if at.size:
            self.open.append(lanes.take(at))


def _within(segments: Segments, k: Array, u: Array) -> tuple[Array, Array]:
    last = len(segments) - 1
    return np.minimum(k, last), np.where(k > last, segments.length[last], u)


def _range(segments: Segments, k: Array, u: Array, to_k: Array, to_u: Array) -> tuple[Array, Array]:
    """The largest s and the least, and 0, between two positions: just after the first and just before the last."""
    over, enters = to_k > k, to_u > 0.0
    ends = (
        np.where(over | (u < to_u), value_and_slope(segments, k, u)[0], 0.0),
        np.where(over, segments.s_end[k], 0.0),
        np.where(over & enters, segments.s_start[to_k], 0.0),
        np.where(enters & (over | (u < to_u)), value_and_slope(segments, to_k, to_u)[0], 0.0),
    )
    largest, least = segments.extent(k + 1, to_k)
    return np.maximum(np.maximum(largest, 0.0), np.max(ends, axis=0)), np.minimum(np.minimum(least, 0.0), np.min(ends, axis=0))
