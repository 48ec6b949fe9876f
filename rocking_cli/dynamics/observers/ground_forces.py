"""The ground forces of each cell, to 1e-6: the least vertical force and the largest |Fx|/Fz of a rigid body, found along with its march.

The forces on every arc, at rest and in the free motion after the shaking are searched for their extremes (`forces`, `resting`). A sequence
of impacts that the march leaves out is followed afterwards if its forces may be extremes, until its bounces have next to no speed.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple, Self

import numpy as np

from ...motions.segments import Segments
from ..body import FAR, Body, Edge
from ..contacts.contact import Contact
from ..drive import place
from ..equations.equation import Equation, Flow, Ramp
from ..equations.ramp import line_series
from ..lanes import Cells, Lanes
from ..march.advance import advance
from ..march.closing import still_bounds
from ..march.free_fall import FreeFall
from ..march.ground import Ground, Shaking
from ..outcome import Outcome
from .extremes import Extremes
from .forces import Forces, Stretches, forces_on, forces_on_still_ground, note_extremes
from .observer import Arcs, Quiet, TaylorSteps
from .resting import Resting

Array = np.ndarray

_CUT = 1.6  # of the time in which the forces bend by one: length of the stretches that are searched
_TOGETHER = 4096  # arcs, or Taylor steps over samples, that are searched at once
_EVEN = 1e-8  # square of the change of the force until lanes rest over that force: what the force at that time may be off
_STILL = 1e-8  # change of a force over m g by the speed of bounces, below which they are taken to have none
_ROOM = 2.0  # times that change: what bounces of some speed may ask more than those of none
_MOST = 100_000  # steps in which a sequence of impacts is followed
_ARCS = 3  # on still ground: each edge has had its fastest impact


class _Held(NamedTuple):
    """Motion under straight lines, (steps,): of which cells, on which side, y and y' at either end, the outward drive at the start and its
    gain over the step, of length `unit` [tau]; the weight over m g in the same way."""

    cell: Array
    side: Array
    y: Array
    v: Array
    end_y: Array
    end_v: Array
    drive: Array
    gain: Array
    unit: Array
    weight: Array
    heavier: Array

    @classmethod
    def joined(cls, parts: Sequence[Self]) -> Self:
        """All of these, which are of one motion."""
        return cls(*map(np.concatenate, zip(*parts, strict=True)))

    def take(self, at: Array) -> Self:
        """Those at these indices."""
        return type(self)(*(x[at] for x in self))

    def shaking(self, edge: Edge, h: Array | float) -> Shaking:
        """The push and the weight after h [tau]."""
        rate, rise = self.gain / self.unit, self.heavier / self.unit
        return Shaking(edge.uplift * (self.drive + rate * h), edge.uplift * rate, self.weight + rise * h, rise)


class GroundForces(Quiet):
    """The forces of the cells of a run. Parameters: shaken: the segment from which on the ground is still; free_fall: where the ground
    falls away from cells; friction, lift: the extremes so far of |Fx|/Fz and -Fz/(m g), those of a body at rest unless given."""

    def __init__(
        self, body: Body, equation: Equation, segments: Segments, shaken: int, contact: Contact, cells: Cells, free_fall: FreeFall | None,
        friction: Array | None = None, lift: Array | None = None,
    ) -> None:  # fmt: skip
        count = cells.omega.shape[1]
        self.body, self.equation, self.segments, self.shaken, self.contact, self.cells = body, equation, segments, shaken, contact, cells
        self.ground, self.resting, self.free_fall = Ground(body, segments), Resting(body, segments, cells), free_fall
        self.friction = Extremes(np.zeros(count) if friction is None else friction)
        self.lift = Extremes(np.full(count, -1.0) if lift is None else lift)
        self._steps, self._held = list[_Held](), 0
        self._closed, self._waiting = list[Lanes](), 0

    @property
    def fz_min(self) -> Array:
        """The least Fz over m g so far, (cells,)."""
        return -self.lift.largest

    def arcs(self, arcs: Arcs) -> None:
        """Search the forces on these arcs."""
        lanes, flow, stop, y, v, _, at = arcs
        unit = self.body.on(lanes.side).unit
        at = at[((unit * np.maximum(lanes.y, y) < FAR) & (stop > 0.0))[at]]
        for first in range(0, at.size, _TOGETHER):
            some = at[first : first + _TOGETHER]
            self._arcs(lanes.take(some), flow.take(some), stop[some], y[some], v[some])

    def _arcs(self, lanes: Lanes, flow: Flow, stop: Array, y: Array, v: Array) -> None:
        edge = self.body.on(lanes.side)
        rate = flow.fastest + edge.unit * np.maximum(np.abs(lanes.v), np.abs(v))
        parts = np.maximum(np.ceil(stop * rate / _CUT), 1.0).astype(np.int64)
        own = np.repeat(np.arange(stop.size), parts)
        n = np.arange(own.size) - np.repeat(np.cumsum(parts) - parts, parts)
        low, last = n * (stop / parts)[own], n + 1 == parts[own]

        def along(part: Array, h: Array) -> Forces:
            if not part.size:
                return Forces(*np.empty((4, 0)))
            point = flow.take(own[part]).at(h)
            return self._forces(lanes.take(own[part]), h, point.y, point.v)

        inner = np.flatnonzero(n > 0)
        cuts, begins = along(inner, low[inner]), self._forces(lanes, np.zeros(stop.size), lanes.y, lanes.v)
        ends = self._forces(lanes, stop, y, v)
        start, end = (Forces(*np.empty((4, own.size))) for _ in range(2))
        for rows, first, cut, final in zip(zip(start, end, strict=True), begins, cuts, ends, strict=True):
            rows[0][n == 0], rows[0][inner], rows[1][inner - 1], rows[1][last] = first, cut, cut, final
        high = np.where(last, stop[own], np.append(low[1:], 0.0))
        note_extremes(self.friction, self.lift, lanes.cell[own], along, Stretches(low, high, start, end, rate[own]))

    def _forces(self, lanes: Lanes, h: Array, y: Array, v: Array) -> Forces:
        """The value for lanes that are at y, v after h."""
        edge = self.body.on(lanes.side)
        return forces_on(self.body, edge, self.ground.shaking(lanes, h), edge.unit * y, edge.unit * v)

    def steps(self, steps: TaylorSteps, go: Array) -> None:
        """Hold steps until there are many to be searched."""
        cell, side, _, start, end, ramp = steps
        weight = (np.ones(cell.size), np.zeros(cell.size)) if ramp.weight is None else ramp.weight
        found = _Held(cell, side, *start, *end, ramp.drive, ramp.gain, ramp.unit, *weight)
        found = found.take(np.flatnonzero(go & (self.body.on(side).unit * start[0] < FAR)))
        self._steps.append(found)
        self._held += found.cell.size
        if self._held >= _TOGETHER:
            self._search_steps()

    def _search_steps(self) -> None:
        if not self._held:
            return
        s, self._steps, self._held = _Held.joined(self._steps), [], 0
        edge = self.body.on(s.side)

        def along(own: Array, h: Array) -> Forces:
            some = s.take(own)
            ramp = Ramp(some.drive, some.gain, some.unit, some.unit)
            if self.segments.weighed is not None:
                ramp = ramp._replace(weight=(some.weight, some.heavier))
            point = line_series(self.equation.on(some.side, some.cell), some.y, some.v, ramp).at(h)
            edge = self.body.on(some.side)
            return forces_on(self.body, edge, some.shaking(edge, h), edge.unit * point.y, edge.unit * point.v)

        start = forces_on(self.body, edge, s.shaking(edge, 0.0), edge.unit * s.y, edge.unit * s.v)
        end = forces_on(self.body, edge, s.shaking(edge, s.unit), edge.unit * s.end_y, edge.unit * s.end_v)
        rate = 1.0 + edge.unit * np.maximum(np.abs(s.v), np.abs(s.end_v))
        note_extremes(self.friction, self.lift, s.cell, along, Stretches(np.zeros(s.unit.size), s.unit, start, end, rate))

    def rest(self, cell: Array, k: Array, u: Array, to_k: Array, to_u: Array) -> None:
        """Take in bodies at rest from (k, u) to another position; to_k: the number of segments where they rest to the end."""
        self.resting.note(self.friction, self.lift, cell, k, u, to_k, to_u)

    def close(self, lanes: Lanes) -> None:
        """Hold lanes that are to be followed afterwards."""
        self._closed.append(lanes)
        self._waiting += lanes.cell.size
        if self._waiting >= _TOGETHER:
            self._sift()

    def settle(self, lanes: Lanes) -> None:
        """Those that damping settles too."""
        self.close(lanes)

    def _sift(self) -> None:
        """Leave out lanes whose forces cannot be extremes."""
        if self._waiting:
            lanes = Lanes.joined(self._closed)
            with np.errstate(all="ignore"):
                self._closed = [lanes.take(np.flatnonzero(self._may_beat(lanes)))]
            self._waiting = 0

    def free(self, lanes: Lanes, at: Array, y: Array, v: Array) -> None:
        """Take in the free motion of the lanes `at`, undamped, which are at y, v when the shaking is over, and stay upright."""
        if not at.size:
            return
        cell, side, zero = lanes.cell[at], lanes.side[at], np.zeros(at.size)
        edge, equation = self.body.on(side), self.equation.on(side, cell)
        square = (edge.unit * v) ** 2 + self.body.fall(edge, edge.unit * y)  # u'^2 at the ground
        energy = equation.fall(y, v)[1]
        top = np.where(v > 0.0, equation.peak(energy), y)
        kept = self.cells.eta[0, cell] * self.cells.eta[-1, cell]
        bounces = np.flatnonzero((kept > 0.0) & (kept < 1.0))  # ever lower
        for _ in range(_ARCS):
            edge = self.body.on(side)
            self._free_arc(cell, edge, square, edge.unit * top)
            self._bounces(cell[bounces], edge_of(edge, bounces), zero[bounces], 1.0)
            eta = self.cells.eta[self.cells.row(side), cell]
            if not self.body.one_sided:
                side = -side
            square, energy = square * (eta * self.body.on(side).unit / edge.unit) ** 2, eta * eta * energy
            top = self.equation.on(side, cell).peak(energy)

    def _free_arc(self, cell: Array, edge: Edge, square: Array, top: Array) -> None:
        """The forces from the ground up to u = top and back, under no push."""
        at = np.flatnonzero(top > 0.0)
        parts = np.ceil(4.0 * top[at] / _CUT).astype(np.int64)
        own = np.repeat(at, parts)
        n = np.arange(own.size) - np.repeat(np.cumsum(parts) - parts, parts)
        step = np.repeat(top[at] / parts, parts)

        def along(part: Array, u: Array) -> Forces:
            return forces_on_still_ground(self.body, edge_of(edge, own[part]), square[own[part]], u)

        every = np.arange(own.size)
        found = Stretches(n * step, (n + 1) * step, along(every, n * step), along(every, (n + 1) * step), np.full(own.size, 2.0))
        note_extremes(self.friction, self.lift, cell[own], along, found)

    def _bounces(self, cell: Array, edge: Edge, push: Array, weight: Array | float) -> None:
        """Bounces on an edge that have no speed, under this outward push [g] and weight over m g."""
        fx, fz = (np.broadcast_to(x, cell.shape) for x in self.body.low_bounces(edge, push, weight))
        self.lift.offer(cell, -fz)
        with np.errstate(divide="ignore", invalid="ignore"):
            self.friction.offer(cell, np.where(fz > 0.0, np.abs(fx) / fz, np.inf))

    def result(self, outcome: Array) -> tuple[Array, Array]:
        """The largest |Fx|/Fz (infinite where Fz <= 0) and the least Fz/(m g) of each cell, (cells,); outcome: of each cell."""
        self._search_steps()
        self._sift()
        for lanes in self._closed:
            upright = np.isin(outcome, (Outcome.ROCKED, Outcome.LOST_CONTACT))
            self._follow(lanes.take(np.flatnonzero(upright[lanes.cell])))
        if self.free_fall is not None:
            fallen = np.flatnonzero(self.free_fall.ever & (outcome == Outcome.LOST_CONTACT))
            self.lift.offer(fallen, np.zeros(fallen.size))
            self.friction.offer(fallen, np.full(fallen.size, np.inf))
        return self.friction.largest, self.fz_min

    def _follow(self, lanes: Lanes) -> None:
        """Follow lanes that the march left, each by itself, until their forces cannot be extremes."""
        with np.errstate(all="ignore"):
            for first in range(0, lanes.cell.size, _TOGETHER):
                some = lanes.take(slice(first, first + _TOGETHER))
                cell = some.cell
                cells, some.cell = Cells(*(x[:, cell] for x in self.cells)), np.arange(cell.size)
                given = self.body, self.equation, self.segments, self.shaken, self.contact, cells
                free_fall = None if self.free_fall is None else self.free_fall.of_cells(cell)
                alone = GroundForces(*given, free_fall, self.friction.largest[cell], self.lift.largest[cell])
                alone._go_on(some)
                self.friction.offer(cell, alone.friction.largest)
                self.lift.offer(cell, alone.lift.largest)

    def _go_on(self, lanes: Lanes) -> None:
        """Step after step, from an impact or in the air."""
        lanes = self._after_impact(lanes)
        for _ in range(_MOST):
            if not lanes.cell.size:
                break
            passage = advance(self.segments, lanes, self.equation.on(lanes.side, lanes.cell))
            hit, stop = passage.hit, passage.reach
            y, v = np.where(hit, 0.0, passage.end.y), np.where(hit, passage.impact_v, passage.end.v)
            self.arcs(Arcs(lanes, passage.arc, stop, y, v, passage.force, np.arange(hit.size)))
            k, u = np.where(hit, lanes.k, passage.step.k), np.where(hit, lanes.u + lanes.omega * stop, passage.step.u)
            lanes.k, lanes.u = place(self.segments, k, u)
            lanes.y, lanes.v, lanes.b = y, v, np.where(hit, passage.impact_b, passage.force)
            going = (lanes.k < len(self.segments)) & np.isfinite(v)
            landed, air = lanes.take(np.flatnonzero(going & hit)), lanes.take(np.flatnonzero(going & ~hit))
            self.contact.strike(self.cells, landed, landed.v, landed.b)
            landed.b = self.segments.force_at_impact(landed.side, landed.amplitude, landed.k, landed.u, landed.b)
            lanes = self._after_impact(landed).join(air)

    def _after_impact(self, lanes: Lanes) -> Lanes:
        """Those of these lanes, at the ground or in the air, that are to be followed on; takes in slow bounces and the rest after them."""
        lasts = self.ground.bouncing_lasts(lanes, self.contact)
        slow = (lanes.y == 0.0) & (self._change(lanes) <= _STILL) & self._ends_evenly(lanes, lasts)
        going = ~slow & ((lanes.y > 0.0) | self._may_beat(lanes))
        ends, lasts = lanes.take(np.flatnonzero(slow)), lasts[slow]
        for at, edge, push, weight in self._bouncing(ends, lasts):
            self._bounces(ends.cell[at], edge, push, weight)
        k, u = place(self.segments, ends.k, ends.u + ends.omega * lasts)
        shaking = np.flatnonzero(k < self.shaken)
        cell, k, u = ends.cell[shaking], k[shaking], u[shaking]
        self.rest(cell, k, u, *self._rests_until(cell, k, u))
        return lanes.take(np.flatnonzero(going))

    def _rests_until(self, cell: Array, k: Array, u: Array) -> tuple[Array, Array]:
        """Where bodies at rest at (k, u) lift off, or the ground falls away from them."""
        again = self.contact.uplift(self.cells, self.segments, cell, k, u)
        return (again.k, again.u) if self.free_fall is None else self.free_fall.sooner(cell, again)

    def _may_beat(self, lanes: Lanes) -> Array:
        """Whether the forces of lanes that bounce to rest, or are on still ground, may be extremes."""
        cell = lanes.cell
        friction, lift = self.resting.bounds(cell, lanes.k, lanes.u, *self._rests_until(cell, lanes.k, lanes.u))
        room = _ROOM * self._change(lanes)
        for at, edge, push, weight in self._bouncing(lanes, self.ground.bouncing_lasts(lanes, self.contact)):
            fx, fz = self.body.low_bounces(edge, push, weight)
            fz = fz - room[at]
            lift[at] = np.maximum(lift[at], -fz)
            friction[at] = np.maximum(friction[at], np.where(fz > 0.0, (np.abs(fx) + room[at]) / fz, np.inf))
        still = np.flatnonzero(lanes.k >= self.shaken)
        if still.size:
            bounds = still_bounds(self.body, lanes.take(still))
            friction[still], lift[still] = bounds.friction, -bounds.fz
        return self.friction.can_beat(cell, friction) | self.lift.can_beat(cell, lift)

    def _change(self, lanes: Lanes) -> Array:
        """By how much either force differs, roughly, from that of bounces without speed: kappa [(|P| + 2 w) U + V^2 + 2 zeta V]."""
        push, weight = self.ground.push(lanes, np.zeros(lanes.v.size)), self.ground.weight(lanes, 0.0)
        found = np.zeros(lanes.v.size)
        sides = [(lanes.side, 1.0, lanes.v)]
        if not self.body.one_sided:
            sides.append((-lanes.side, -1.0, lanes.eta * lanes.v))
        for side, sense, v in sides:
            edge = self.body.on(side)
            fast = edge.unit * v
            high = 0.5 * fast * fast / -self.body.lifting(edge, sense * push, weight)
            high = np.where(fast > 0.0, np.where(high >= 0.0, high, np.inf), 0.0)
            found = np.maximum(found, edge.kappa * ((np.abs(push) + 2.0 * weight) * high + fast * (fast + 2.0 * self.body.damping)))
        return found

    def _ends_evenly(self, lanes: Lanes, lasts: Array) -> Array:
        """Whether the push hardly changes until lanes rest, so that the time until then is known as well as under a constant one."""
        one, other = (self.body.lifting(self.body.on(lanes.side), self.ground.push(lanes, h), self.ground.weight(lanes, h))
                      for h in (np.zeros(lasts.size), lasts))  # fmt: skip
        return np.asarray((one - other) ** 2 <= _EVEN * np.minimum(np.abs(one), np.abs(other)))

    def _bouncing(self, lanes: Lanes, lasts: Array) -> Iterator[tuple[Array, Edge, Array, Array | float]]:
        """(lanes, edge, outward push over g, weight over m g) of bounces without speed, on each edge, at their start and at their end."""
        at = np.flatnonzero(lanes.v > 0.0)
        some, lasts = lanes.take(at), lasts[at]
        for h in (np.zeros(at.size), lasts):
            push, weight = self.ground.push(some, h), self.ground.weight(some, h)
            for sense in (1.0,) if self.body.one_sided else (1.0, -1.0):
                yield at, self.body.on(sense * some.side), sense * push, weight


def edge_of(edge: Edge, at: Array) -> Edge:
    """The edges of some lanes."""
    return Edge(*(x[at] if isinstance(x, np.ndarray) else x for x in edge))
