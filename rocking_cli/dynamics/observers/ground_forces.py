"""The ground forces of each cell, to 1e-6: the least vertical force and the largest |Fx|/Fz of a rigid body (formulas in `body`).
A sequence of impacts is marched until its forces cannot be extremes, or nearly equal those of bounces without speed.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ...motions.segments import Segments
from ..body import FAR, Body, Edge, Ground, Shaking, value_and_slope
from ..drive import place
from ..equations.equation import Drive
from ..equations.recurrence import Rows
from ..equations.taylor import line_series
from ..lanes import Array, Arrays, Lanes
from ..march.batch import Batch
from ..outcome import Outcome
from .extremes import Extremes, Ratio, Stretches, parts
from .observer import Arcs, Observer, TaylorSteps

_TOGETHER = 4096  # Taylor steps over samples that are searched at once
_SEGMENTS = 1 << 16  # segments of times of rest that are searched at once
_STILL = 1e-7  # if the speed of bounces changes a force over m g by less, the speed counts as zero
_ROOM = 1.25  # largest later speed in a sequence of impacts, over the present speed
_LEAST = 1e-20  # least u'^2, for the top of an arc: slopes by u are slopes by time divided by u'
_BY_TURN = 3.0  # rate of change of the forces on still ground, with u as the variable


@dataclass
class Forces(Arrays):
    """Outward Fx and Fz over m g [-], and their slopes by the time of the stretch; arrays of one shape."""

    fx: Array
    fz: Array
    fx_slope: Array
    fz_slope: Array

    def ratio(self, kind: Array) -> Ratio:
        """-Fz/1 for kind 0, Fx/Fz for kind 1, -Fx/Fz for kind -1, as `Ratio`."""
        up = kind == 0
        return Ratio(
            np.where(up, -self.fz, kind * self.fx), np.where(up, 1.0, self.fz),
            np.where(up, -self.fz_slope, kind * self.fx_slope), np.where(up, 0.0, self.fz_slope),
        )  # fmt: skip


Along = Callable[[Array, Array], Forces]  # function of (indices of motions, times)


def forces_on(body: Body, edge: Edge, shaking: Shaking, u: Array, rate: Array) -> Forces:
    """Forces on a body at u with speed u' [rad, by tau] on an edge, under this push and weight over m g; arrays of one shape."""
    push, push_slope, weight, weight_slope = shaking
    z = edge.alpha - u
    sin, cos = np.sin(z), np.cos(z)
    if body.linear:
        acceleration, jerk = push - weight * z, push_slope + weight * rate - weight_slope * z
    else:
        acceleration = push * cos - weight * sin
        jerk = push_slope * cos + rate * (weight * cos + push * sin) - weight_slope * sin
    if body.damping:
        acceleration = acceleration - 2.0 * body.damping * rate
        jerk = jerk - 2.0 * body.damping * acceleration
    square, turns = rate * rate, 3.0 * rate * acceleration
    jerk = jerk - rate * square
    return Forces(
        edge.kappa * (acceleration * cos + square * sin) - push,
        weight + edge.kappa * (acceleration * sin - square * cos),
        edge.kappa * (jerk * cos + turns * sin) - push_slope,
        weight_slope + edge.kappa * (jerk * sin - turns * cos),
    )


class ForceExtremes(Extremes):
    """The largest |Fx|/Fz of each cell, then the largest -Fz/(m g) of each, (2 cells,). It starts with the values of a body at rest."""

    def __init__(self, cells: int) -> None:
        super().__init__(np.repeat([0.0, -1.0], cells))
        self.cells = cells

    def include_forces(self, cell: Array, fx: Array, fz: Array) -> None:
        """Raise the extremes of these cells to those of forces, (..., n)."""
        self.include(np.broadcast_to(cell, fx.shape), _friction(fx, fz))
        self.include(np.broadcast_to(self.cells + cell, fz.shape), -fz)

    def can_be_exceeded(self, cell: Array, fx: Array, fz: Array) -> Array:
        """True for cells in which one of these forces, (..., n), exceeds the extremes so far or is NaN, (n,)."""
        exceeds = self.can_exceed(cell, _friction(fx, fz)) | self.can_exceed(self.cells + cell, -fz)
        return np.any(exceeds, axis=tuple(range(exceeds.ndim - 1)))

    def include_along(self, cell: Array, along: Along, whole: Stretches, start: Forces, end: Forces, one_way: bool = False) -> None:
        """Raise the extremes of these cells to those on stretches. along: function that returns the forces inside the motions; start, end:
        the forces at the ends of each stretch; one_way: True if only an outward Fx counts."""
        s, one, other = parts(along, whole, start, end)
        kinds = np.array([0, 1] if one_way else [0, 1, -1])
        kind, own = np.repeat(kinds, s.own.size), np.tile(s.own, kinds.size)
        indices = np.tile(np.arange(s.own.size), kinds.size)
        s, one, other = s.take(indices), one.take(indices), other.take(indices)
        s.own = np.arange(own.size)

        def of_kind(at: Array, x: Array) -> Ratio:
            return along(own[at], x).ratio(kind[at])

        self.search(cell[own] + np.where(kind == 0, self.cells, 0), of_kind, s, one.ratio(kind), other.ratio(kind))


def _friction(fx: Array, fz: Array) -> Array:
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(np.isnan(fz), np.nan, np.where(fz > 0.0, np.abs(fx) / fz, np.inf))


class GroundForces(Observer):
    """The observer that finds the ground forces of the cells of a batch."""

    def __init__(self, body: Body, batch: Batch) -> None:
        self.body, self.batch, self.cells, self.segments = body, batch, batch.cells, batch.segments
        self.ground, self.extremes = Ground(body, batch.segments), ForceExtremes(batch.size)
        self._steps = np.empty((11, 0))

    def arcs(self, arcs: Arcs) -> None:
        unit = self.body.on(arcs.lanes.side).unit
        at = arcs.wanted[((unit * np.maximum(arcs.lanes.y, arcs.y) < FAR) & (arcs.stop > 0.0))[arcs.wanted]]
        lanes, flow, stop, y, v = arcs.lanes.take(at), arcs.flow.take(at), arcs.stop[at], arcs.y[at], arcs.v[at]
        zero, unit = np.zeros(at.size), self.body.on(lanes.side).unit

        def along(own: Array, h: Array) -> Forces:
            point = flow.take(own).at(h)
            return self._forces(lanes.take(own), h, point.y, point.v)

        # On still ground only the motion of the body changes the forces.
        fastest = np.where(lanes.k < self.batch.shaken, flow.fastest, 1.0 + 2.0 * self.body.damping)
        rate = fastest + unit * np.maximum(np.abs(lanes.v), np.abs(v))
        ends = self._forces(lanes, zero, lanes.y, lanes.v), self._forces(lanes, stop, y, v)
        self.extremes.include_along(lanes.cell, along, Stretches(np.arange(at.size), zero, stop, rate), *ends)

    def _forces(self, lanes: Lanes, h: Array, y: Array, v: Array) -> Forces:
        """The forces on lanes that have y, v at h [tau] after their present state."""
        edge = self.body.on(lanes.side)
        return forces_on(self.body, edge, self.ground.shaking(lanes, h), edge.unit * y, edge.unit * v)

    def steps(self, steps: TaylorSteps, go: Array) -> None:
        """Store steps, and search them when there are `_TOGETHER`."""
        cell, side, _, (y, v), (end_y, end_v), ramp = steps
        weight = np.broadcast_to(ramp.weight_line, (2, cell.size))
        at = np.flatnonzero(go & (self.body.on(side).unit * y < FAR))
        rows = np.array([cell, side, y, v, end_y, end_v, *ramp.line, ramp.unit, *weight])[:, at]
        self._steps = np.concatenate([self._steps, rows], axis=1)
        if self._steps.shape[1] >= _TOGETHER:
            self._search_steps()

    def _search_steps(self) -> None:
        s, self._steps = self._steps, self._steps[:, :0]
        indices, zero, unit = np.arange(s.shape[1]), np.zeros(s.shape[1]), s[8]

        def at(own: Array, h: Array, y: Array, v: Array) -> Forces:
            side, drive, gain, unit, weight, heavier = s[[1, 6, 7, 8, 9, 10]][:, own]
            edge, rate, rise = self.body.on(side), gain / unit, heavier / unit
            shaking = Shaking(edge.uplift * (drive + rate * h), edge.uplift * rate, weight + rise * h, rise)
            return forces_on(self.body, edge, shaking, edge.unit * y, edge.unit * v)

        def along(own: Array, h: Array) -> Forces:
            cell, side, y, v, _, _, drive, gain, unit, *weight = s[:, own]
            ramp = Drive(Rows.of(drive, gain), unit, None if self.segments.weighed is None else Rows.of(weight[0], weight[1]))
            point = line_series(self.batch.equation.on(side, cell.astype(np.int64)), y, v, ramp).at(h)
            return at(own, h, point.y, point.v)

        rate = 1.0 + self.body.on(s[1]).unit * np.maximum(np.abs(s[3]), np.abs(s[5]))
        ends = at(indices, zero, s[2], s[3]), at(indices, unit, s[4], s[5])
        self.extremes.include_along(s[0].astype(np.int64), along, Stretches(indices, zero, unit, rate), *ends)

    def rest(self, cell: Array, k: Array, u: Array, to_k: Array, to_u: Array) -> None:
        """Take in the forces of bodies that rest from position (k, u) to (to_k, to_u), xg''/g across and 1 + zg''/g upwards; on a one-sided
        body only an outward Fx counts."""
        last = len(self.segments) - 1
        to_k, to_u = np.minimum(to_k, last), np.where(to_k > last, self.segments.length[last], to_u)
        push = self.cells.amplitude[0, cell] * self.body.edges[0].uplift  # outward, over g, of s = -1 on the right edge
        if self.segments.weighed is None:
            largest, least = _range(self.segments, k, u, to_k, to_u)
            self.extremes.include(cell, push * (-least if self.body.one_sided else np.maximum(-least, largest)))
            return
        most = max(1, _SEGMENTS // (last + 1))  # whole rests at a time, so that no digit depends on other cells
        for first in range(0, cell.size, most):
            some = slice(first, first + most)
            self._weighed_rest(*(x[some] for x in (cell, push, k, u, to_k, to_u)))

    def _weighed_rest(self, cell: Array, push: Array, k: Array, u: Array, to_k: Array, to_u: Array) -> None:
        """As `rest`, under a weight that varies: search every segment of these rests. push: outward push [g] of s = -1, right edge."""
        seg = self.segments.weighed
        count = np.maximum(to_k - k + (to_u > 0.0), 0) * ((k < to_k) | (u < to_u))
        rest = np.repeat(np.arange(cell.size), count)
        at = k[rest] + np.arange(rest.size) - np.repeat(np.cumsum(count) - count, count)
        low, high = np.where(at == k[rest], u[rest], 0.0), np.where(at == to_k[rest], to_u[rest], seg.length[at])
        cell, push = cell[rest], -push[rest]
        sway = seg.sway(np.ones(cell.size), self.cells.amplitude[0, cell])

        def along(own: Array, phase: Array) -> Forces:
            (s, slope), (rise, rise_slope) = (value_and_slope(x, at[own], phase) for x in (seg, seg.vertical))
            return Forces(push[own] * s, 1.0 + sway[own] * rise, push[own] * slope, sway[own] * rise_slope)

        indices, rate = np.arange(cell.size), np.zeros(cell.size)
        if not seg.straight:  # of straight lines the ends have the extremes
            rate = np.maximum(*(x.frequency[:, at].max(axis=0, initial=0.0) for x in (seg, seg.vertical)))
        whole = Stretches(indices, low, high, rate)
        self.extremes.include_along(cell, along, whole, along(indices, low), along(indices, high), self.body.one_sided)

    def free(self, lanes: Lanes) -> None:
        """Search three arcs of each free motion, so that each edge has its fastest impact, and the forces of bounces without speed."""
        cell, side, zero, edge = lanes.cell, lanes.side, np.zeros(lanes.cell.size), self.body.on(lanes.side)
        square = self.body.squared_speed_at_ground(edge, lanes.y, lanes.v)
        top = np.where(lanes.v > 0.0, self.body.top(edge, square), edge.unit * lanes.y)
        kept = self.cells.eta[0, cell] * self.cells.eta[-1, cell]
        bounces = np.flatnonzero((kept > 0.0) & (kept < 1.0))
        for _ in range(3):
            edge = self.body.on(side)
            self._free_arc(cell, side, square, top)
            found = forces_on(self.body, edge, Shaking(zero, zero, 1.0, 0.0), zero, zero)
            self.extremes.include_forces(cell[bounces], found.fx[bounces], found.fz[bounces])
            side, unit, eta = side if self.body.one_sided else -side, edge.unit, self.cells.eta[self.cells.row(side), cell]
            edge = self.body.on(side)
            square = square * (eta * edge.unit / unit) ** 2
            top = self.body.top(edge, square)

    def _free_arc(self, cell: Array, side: Array, square: Array, top: Array) -> None:
        """Search the forces from the ground up to u = top, with u as the variable; on the way back the forces are the same."""
        at = np.flatnonzero(top > 0.0)
        cell, side, square, top = cell[at], side[at], square[at], top[at]

        def along(own: Array, u: Array) -> Forces:
            edge, zero = self.body.on(side[own]), np.zeros(own.size)
            rate = np.sqrt(np.maximum(square[own] - self.body.fall(edge, u), _LEAST))
            found = forces_on(self.body, edge, Shaking(zero, zero, 1.0, 0.0), u, rate)
            return Forces(found.fx, found.fz, found.fx_slope / rate, found.fz_slope / rate)

        indices, zero = np.arange(at.size), np.zeros(at.size)
        whole = Stretches(indices, zero, top, zero + _BY_TURN)
        self.extremes.include_along(cell, along, whole, along(indices, zero), along(indices, top))

    def may_settle(self, lanes: Lanes, bounced: Array) -> Array:
        """The same test as `may_close`."""
        return self.may_close(lanes)

    def may_close(self, lanes: Lanes) -> Array:
        """Return True for lanes whose forces until they rest cannot exceed the largest ones so far, or differ by at most `_STILL` from
        those of bounces without speed. It compares the forces at the fastest impact and at the highest point, under the drive and the
        weight of now and of the time of rest."""
        cell, count, lasts = lanes.cell, lanes.cell.size, self.ground.sequence_time(lanes, self.batch.contact)
        here, shaking = self.body.on(lanes.side), self.ground.shaking(lanes.join(lanes), np.append(np.zeros(count), lasts))
        push, weight = (np.broadcast_to(x, 2 * count).reshape(2, count) for x in (shaking.push, shaking.weight))
        u, zero = here.unit * lanes.y, np.zeros((2, count))
        speed = _ROOM * np.sqrt(self.body.squared_speed_at_ground(here, lanes.y, lanes.v)) / here.unit
        drift, found = np.zeros(count), []
        with np.errstate(all="ignore"):
            for sense, v in ((1.0, speed), (-1.0, lanes.eta * speed))[: 1 if self.body.one_sided else 2]:
                edge = self.body.on(sense * lanes.side)
                fast, pull = edge.unit * v + zero, -self.body.lifting(edge, sense * push, weight)
                high = np.where(fast > 0.0, np.where(pull > 0.0, np.maximum(u, 0.5 * fast * fast / pull), np.inf), 0.0)
                forces = forces_on(self.body, edge, Shaking(sense * push, zero, weight, zero),
                                   np.array([zero, zero, zero, high]), np.array([zero, fast, -fast, zero]))  # fmt: skip
                found.append((forces.fx, forces.fz))
                drift = np.maximum(drift, (pull[0] - pull[1]) ** 2 / np.abs(pull).min(axis=0))  # how far the push changes until they rest
            fx, fz = (np.array(x) for x in zip(*found, strict=True))  # (edges, 4, 2, lanes)
            change = np.maximum(np.abs(fx - fx[:, :1]), np.abs(fz - fz[:, :1])).max(axis=(0, 1, 2))
            known = (speed == 0.0) | (change + drift < _STILL * np.clip(fz.min(axis=(0, 1, 2)), 0.0, 1.0))
            can = self.extremes.can_be_exceeded(cell, fx, fz)
        bounces, done = np.flatnonzero(known & (speed > 0.0)), known | ~can
        self.extremes.include_forces(cell[bounces], fx[:, 0][..., bounces], fz[:, 0][..., bounces])
        at = np.flatnonzero(done & (lanes.k < self.batch.shaken))  # they rest after their bounces until their next uplift
        cell, (k, u) = lanes.cell[at], place(self.segments, lanes.k[at], lanes.u[at] + lanes.omega[at] * lasts[at])
        self.rest(cell, k, u, *self.batch.rests_until(cell, k, u)[1])
        return done

    def result(self, outcome: Array) -> tuple[Array, Array]:
        """(largest |Fx|/Fz, infinite where Fz <= 0; least Fz/(m g)) of each cell, (cells,). outcome: codes of each cell."""
        self._search_steps()
        if self.batch.free_fall is not None:
            fallen = np.flatnonzero(self.batch.free_fall.occurs & (outcome == Outcome.LOST_CONTACT))
            self.extremes.include_forces(fallen, np.zeros(fallen.size), np.zeros(fallen.size))
        friction, lift = self.extremes.largest.reshape(2, -1)
        return friction, -lift


def _range(segments: Segments, k: Array, u: Array, to_k: Array, to_u: Array) -> tuple[Array, Array]:
    """(largest s or 0, least s or 0) between two positions: just after the first and just before the last."""
    over, enters = to_k > k, to_u > 0.0
    ends = (
        np.where(over | (u < to_u), value_and_slope(segments, k, u)[0], 0.0),
        np.where(over, segments.s_end[k], 0.0),
        np.where(over & enters, segments.s_start[to_k], 0.0),
        np.where(enters & (over | (u < to_u)), value_and_slope(segments, to_k, to_u)[0], 0.0),
    )
    largest, least = segments.extent(k + 1, to_k)
    return np.maximum(np.maximum(largest, 0.0), np.max(ends, axis=0)), np.minimum(np.minimum(least, 0.0), np.min(ends, axis=0))
