"""What each cell asks of the ground: the least vertical force and the largest |Fx|/Fz of a rigid body, found along with its march.

With z = alpha - u, u = |theta|, s the side and w = 1 + zg''/g, what moves the mass centre is (over m g, ' by tau of the side)

    s Fx = s xg''/g + kappa (u'' cos z + u'^2 sin z),   Fz = w + kappa (u'' sin z - u'^2 cos z)

where u'' follows from the drive by the equation of motion. At rest they are xg''/g and w (`resting`). Steps wait until it is known whether
their body falls (`waiting`), and are looked at where their hull leaves room for a record (`hulls`). What the march closes is judged by
bounds (`closing`): where these leave room for a record it is followed afterwards (`aftermath`).
"""

from __future__ import annotations

import copy
from dataclasses import replace

import numpy as np

from ...motions.segments import Segments
from ..body import FAR, Body, Edge
from ..contacts.contact import Contact
from ..equations.equation import Equation, Flow, Point
from ..equations.taylor import TaylorSeries, Turn
from ..lanes import Cells, Lanes
from ..outcome import Outcome
from .bends import Ends, Forces, edge_of, forces_on, fourths
from .closing import Bounds, bouncing, still_bounds, train_bounds
from .extremes import EXACT, Course, Records
from .ground import Ground, Shaking
from .hulls import hull_of, hulls_of
from .quartics import Spans, search
from .resting import Resting
from .waiting import Steps, Waiting, joined, parts_done

Array = np.ndarray


_TURN = 1.2  # of the ground's motion [rad], on which quartics enclose the forces closely; two tau on still ground
_TINY = 1e-300
_HELD = 81920  # steps that wait at the most before those whose fate is known are looked at: five pools of series
_WITHIN = 0.1  # of the tolerance of the motion: what a record may be off by how it is searched for
_TOGETHER = 8192  # of these are looked at in full at a time


class Demands(Records):
    """The records of the cells of a run, whose steps wait for whether their body falls unless not `waits`.

    shaken: the segment from which on the ground is still.
    """

    def __init__(self, body: Body, equation: Equation, segments: Segments, shaken: int, contact: Contact, cells: Cells) -> None:
        super().__init__(cells.omega.shape[1])
        self.body, self.equation, self.segments, self.shaken = body, equation, segments, shaken
        self.contact, self.cells = contact, cells
        self.ground, self.resting = Ground(body, segments), Resting(body, segments, cells)
        self.waits, self._waiting = True, Waiting()
        self._unclear = list[tuple[Steps, Array]]()
        self._free, self._closed, self._open = list[Lanes](), list[tuple[Lanes, Array, Array]](), list[tuple[Lanes, Bounds]]()

    def course(self, lanes: Lanes, h: Array, y: Array, v: Array) -> Course:
        """The course of lanes that are at y, v after h."""
        found = self.forces(lanes, h, y, v)
        ratio_slope = (found.fx_slope * found.fz - found.fx * found.fz_slope) / (found.fz * found.fz)
        return Course(np.array([-found.fz, found.fx / found.fz]), np.array([-found.fz_slope, ratio_slope]))

    def show(self, lanes: Lanes, turn: Turn) -> tuple[Array, Array]:
        """What the hulls of steps are made from."""
        return hull_of(turn, self.body.on(lanes.side).kappa, self.equation.tolerance)

    def follow(self, lanes: Lanes, arc: Flow, stop: Array, y: Array, v: Array, at: Array) -> Array:
        """Take in the arcs of the lanes `at` until `stop` [tau], where they are at y, v; `lanes` as they are at 0. Those of them of which
        their hull does not prove Fz > 0."""
        hull = series = None
        doubtful, far = at, self.body.on(lanes.side).unit * lanes.y >= FAR
        near = at[~far[at]] if far.any() else at
        if isinstance(arc, TaylorSeries) and arc.shown is not None:
            hull = hulls_of(arc.shown, stop / arc.longest)
            series = arc._replace(shown=None)
            doubtful, cell = at[~(hull.possible[0, at] < 0.0)], lanes.cell[at]
            fz, friction = hull.reached.take(at, axis=1)
            self.fz_min[cell], self.friction[cell] = np.fmin(self.fz_min[cell], -fz), np.fmax(self.friction[cell], friction)
        steps = Steps(lanes, series, stop, y, v, hull)
        if self.waits:
            self._waiting.add(steps, near)
        else:
            self._look([(steps, near)])
        return doubtful

    def take_in(self, going: Lanes, outcome: Array) -> None:
        """Look at the steps that waited, of cells that stayed upright, when there are many or no lanes go on; outcome: of each cell."""
        if self._waiting.held < _HELD and going.cell.size:
            return
        done, upright = parts_done(going, outcome.size), (outcome == Outcome.ROCKED) | (outcome == Outcome.LOST_CONTACT)
        upright[going.cell] = True  # of which nothing is known
        for part in self._waiting.ready(done, upright, self._promising):
            self._look(part)
        if not going.cell.size or sum(row.size for _, row in self._unclear) >= _TOGETHER:
            self._clear()
        if self._free:
            self._rock_on(Lanes.joined(self._free))
            self._free = []

    def _look(self, every: list[tuple[Steps, Array]]) -> None:
        """Find the records of steps, which are all that is looked at of their cells at this time."""
        if every[0][0].hull is not None:
            self._approach(every)
            return
        steps = joined([steps.take(at) for steps, at in every])
        order = np.argsort(steps.lanes.cell, kind="stable")
        cell = steps.lanes.cell[order]
        turn = np.searchsorted(cell, cell) // _TOGETHER  # of each step's first one of its cell, none of which are parted
        for some in np.split(order, np.flatnonzero(np.diff(turn)) + 1) if order.size else ():
            self._cut(steps.take(some))

    def _promising(self, steps: Steps, at: Array) -> Array:
        """Of these steps with a hull, (2, steps): whether they may beat the record of -Fz, and of |Fx|/Fz."""
        assert steps.hull is not None
        cell, (loose, slips) = steps.lanes.cell[at], steps.hull.possible
        return ~np.array([loose[at] <= -self.fz_min[cell], slips[at] <= self.friction[cell]])

    def _approach(self, every: list[tuple[Steps, Array]]) -> None:
        """Look at steps where their hulls say that records of -Fz or |Fx|/Fz may be beaten. What is found of a step hangs on no other one,
        nor on its cell's record."""
        wanted = [np.nonzero(self._promising(*some)) for some in every]
        lanes, arc, stop, _, _, hull = steps = joined([steps.take(at[own]) for (steps, at), (_, own) in zip(every, wanted, strict=True)])
        row = np.concatenate([row for row, _ in wanted])  # 0: of -Fz, 1: of |Fx|/Fz
        assert hull is not None
        assert arc is not None  # which come together

        def along(own: Array, h: Array) -> Course:
            here, there = (arc, lanes) if own.size == stop.size else (arc.take(own), lanes.take(own))
            return self.course(there, h, *here.state(h))

        left = self.approach(lanes.cell, along, stop, row, hull.crests(row), max(_WITHIN * self.equation.tolerance, EXACT))
        if left.size:
            self._unclear.append((steps.take(left), row[left]))
            if not self.waits:
                self._clear()

    def _clear(self) -> None:
        """Look at steps whose hull does not show where the record is, each by itself."""
        if not self._unclear:
            return
        parts, rows = zip(*self._unclear, strict=True)
        steps, row, self._unclear = joined(parts), np.concatenate(rows), []
        for part in np.array_split(np.arange(row.size), range(_TOGETHER, row.size, _TOGETHER)):
            alone, some = copy.copy(self), steps.take(part)
            Records.__init__(alone, part.size)
            alone._cut(some._replace(lanes=replace(some.lanes, cell=np.arange(part.size))))
            self.note_row(row[part], some.lanes.cell, alone.fz_min, alone.friction)

    def _flow(self, lanes: Lanes) -> Flow:
        return self.equation.on(lanes.side, lanes.cell).flow(self.segments, lanes)

    def forces(self, lanes: Lanes, h: Array, y: Array, v: Array) -> Forces:
        """Of lanes that are at y, v after h; from the drive there, not from differences of the series."""
        edge = self.body.on(lanes.side)
        return forces_on(self.body, edge, self.ground.shaking(lanes, h), edge.unit * y, edge.unit * v)

    def _cut(self, steps: Steps) -> None:
        """Take in steps, stretch by stretch."""
        lanes, series, stop, y, v, _ = steps
        arc, body, every = self._flow(lanes) if series is None else series, self.body, self.body.on(lanes.side)
        exact = not (isinstance(arc, TaylorSeries) or body.damping)
        pushes, weights = self.ground.sizes(lanes, stop)
        parts = self._parts(pushes, weights, stop)
        own = np.repeat(np.arange(stop.size), parts)
        part = np.arange(own.size) - np.repeat(np.cumsum(parts) - parts, parts)
        length, edge = (stop / parts)[own], edge_of(every, own)
        first, inner, last = np.flatnonzero(part == 0), np.flatnonzero(part > 0), np.flatnonzero(part + 1 == parts[own])

        def motion(at: Array, h: Array) -> tuple[Point, Forces]:
            here = own[at]
            point = arc.take(here).at(h) if at.size else Point(*np.empty((4, 0)))
            edge = edge_of(every, here)
            shaking = told(edge, point) if exact else self.ground.shaking(lanes.take(here), h)
            return point, forces_on(body, edge, shaking, edge.unit * point.y, edge.unit * point.v)

        def laid(start: Array, cut: Array, end: Array) -> Array:
            ends = np.empty((2, own.size))
            ends[0, first], ends[0, inner], ends[1, last], ends[1, inner - 1] = start, cut, end, cut
            return ends

        point, cuts = motion(inner, (part * length)[inner])
        ys, vs = laid(lanes.y, point.y, y), laid(lanes.v, point.v, v)
        starts, stops = self.forces(lanes, np.zeros(stop.size), lanes.y, lanes.v), self.forces(lanes, stop, y, v)
        one, other = (Forces(*found) for found in zip(*map(laid, starts, cuts, stops), strict=True))
        ends = (Ends(edge.unit * ys[i], edge.unit * vs[i], f.bend, f.fz) for i, f in enumerate((one, other)))
        fourth = fourths(body, edge, pushes[:, own], weights[:, own], length, *ends)
        high = np.where(part + 1 < parts[own], (part + 1) * length, stop[own])
        spans = Spans(np.arange(own.size), part * length, high, fourth, one, other)
        search(self, lanes.cell[own], lambda at, h: motion(at, h)[1], spans)

    def _parts(self, pushes: Array, weights: Array, stop: Array) -> Array:
        """Into how many stretches steps are cut, on each of which quartics enclose the forces closely."""
        zeta2 = 2.0 * self.body.damping
        steep = weights[0] + zeta2 * zeta2 + (0.0 if self.body.linear else pushes[0])
        rate = np.maximum(*((x[4] / np.maximum(x[0] - still, _TINY)) ** 0.25 for x, still in ((pushes, 0.0), (weights, 1.0))))
        return np.maximum(np.ceil(stop * np.maximum(0.5 + rate / _TURN, np.sqrt(0.5 * steep))), 1.0).astype(np.int64)

    def rest(self, cell: Array, k: Array, u: Array, to_k: Array, to_u: Array) -> None:
        """Bodies at rest from (k, u) to another position; to_k: the number of segments where they rest to the end."""
        self.resting.note(self, cell, k, u, to_k, to_u)

    def spread(self, of: Array, cells: Array) -> None:
        """Give every cell the records of the one of `cells` that `of` says."""
        for records in (self.friction, self.fz_min):
            records[:] = records[cells][of]

    def close(self, lanes: Lanes, to_k: Array, to_u: Array) -> None:
        """Lanes just after an impact whose bouncing ends in rest, until they lift off again at a position."""
        self._closed.append((lanes, to_k, to_u))
        if sum(to_k.size for _, to_k, _ in self._closed) >= _TOGETHER:
            self._judge()

    def _judge(self) -> None:
        """What closed lanes can still bring."""
        if self._closed:
            parts, to_k, to_u = zip(*self._closed, strict=True)
            lanes, self._closed = Lanes.joined(parts), []
            with np.errstate(all="ignore"):
                found = train_bounds(self.body, self.ground, lanes, self.contact).bounds
            self._leave(lanes, found.worst(self.resting.bounds(lanes.cell, lanes.k, lanes.u, np.concatenate(to_k), np.concatenate(to_u))))

    def free(self, lanes: Lanes, at: Array, y: Array, v: Array) -> None:
        """The lanes `at`, undamped, which are at y, v (both of these lanes) when the shaking is over, and stay upright."""
        if not at.size:
            return
        some = lanes.take(at)
        some.k, some.u, some.y, some.v = np.full(at.size, self.shaken), np.zeros(at.size), y, v
        if self.waits:
            self._free.append(some)
        else:
            self._rock_on(some)

    def _rock_on(self, some: Lanes) -> None:
        """The same, when their shaking has been taken in."""
        eta = self.cells.eta[0, some.cell] * self.cells.eta[-1, some.cell]
        bounces = np.flatnonzero((eta > 0.0) & (eta < 1.0))  # ever lower
        for side in (some.side, -some.side):
            settling = bouncing(self.body, self.body.on(side[bounces]), np.zeros(bounces.size), 1.0)
            self.note(some.cell[bounces], settling.fz, settling.friction)
            if self.body.one_sided:
                break
        found = still_bounds(self.body, some)
        closed = (found.fz > -np.inf) & (found.friction <= self.friction[some.cell] + EXACT)
        np.minimum.at(self.fz_min, some.cell[closed], found.fz[closed])  # met at an impact
        at = np.flatnonzero(~closed)
        self._leave(some.take(at), found.take(at))

    def settle(self, lanes: Lanes) -> None:
        """Damped lanes on still ground that the march leaves."""
        self._leave(lanes, still_bounds(self.body, lanes))

    def fell_away(self, cell: Array) -> None:
        """Cells from which the ground has fallen away."""
        self.note(cell, np.zeros(cell.size), np.zeros(cell.size))

    def _leave(self, lanes: Lanes, bounds: Bounds) -> None:
        """Lanes that the march is done with, and what they can still bring."""
        at = np.flatnonzero(self.beaten(lanes.cell, *bounds))
        if at.size:
            self._open.append((lanes.take(at), bounds.take(at)))

    def open(self, upright: Array) -> list[Lanes]:
        """Those of which a record of an upright cell may still come when all steps have been taken in; upright: (cells,)."""
        self._judge()
        found = ((lanes, np.flatnonzero(self.beaten(lanes.cell, *bounds) & upright[lanes.cell])) for lanes, bounds in self._open)
        return [lanes.take(at) for lanes, at in found if at.size]


def told(edge: Edge, point: Point) -> Shaking:
    """What shakes an undamped linear body of steady weight, from its motion."""
    return Shaking(edge.uplift * (point.b + (1.0 - point.y)), edge.uplift * (point.j - point.v), 1.0, 0.0)
