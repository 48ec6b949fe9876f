"""What each cell asks of the ground under straight lines of the drive: stretches are judged by their ends.

Under a line the forces are smooth, and by how much they leave their chords is known (`bends`). What their ends ask is noted; between them
a record can be only where a force may turn, and where its chord and its sag reach the record. The few stretches that are left are halved
until that is settled, each by itself: so that neither the order in which they come nor what has been found before changes a digit.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple, Self

import numpy as np

from ...motions.segments import Segments
from ..body import FAR, Body, Edge
from ..contacts.contact import Contact
from ..equations.equation import Equation, Flow, Ramp
from ..equations.ramp import line_series
from ..lanes import Cells, Lanes
from ..weight import WeighedSegments
from .bends import Ends, Forces, Shakes, forces_on, sags
from .demand import Demands
from .extremes import Records
from .ground import Shaking
from .resting import LineResting

Array = np.ndarray

_TOGETHER = 4096  # strides that are judged at once: fewer cost calls, and more the cache
_MARGIN = 1e-9  # of forces and m g: far more than rounding adds to what is found in a stretch
_NEAR, _HALVINGS = 1e-10, 60  # of the same: what may be missed of an extreme


class Stretches(NamedTuple):
    """Motion under straight lines, (stretches,): of which cells, on which side, y and v at either end, the outward drive at the start and
    what it gains in its time [tau], and the weight in the same way, floats where it is steady."""

    cell: Array
    side: Array
    y: Array
    v: Array
    end_y: Array
    end_v: Array
    drive: Array
    gain: Array
    unit: Array
    weight: Array | float
    heavier: Array | float

    @classmethod
    def joined(cls, parts: Sequence[Self]) -> Self:
        """All of these, which are of one motion."""
        if len(parts) == 1:
            return parts[0]
        rows: list[Any] = [np.concatenate(x) if isinstance(x[0], np.ndarray) else x[0] for x in zip(*parts, strict=True)]
        return cls(*rows)

    def take(self, at: Array) -> Self:
        """Some of them."""
        rows: list[Any] = [x[at] if isinstance(x, np.ndarray) else x for x in self]
        return type(self)(*rows)

    def halves(self, y: Array, v: Array) -> Self:
        """Their first halves and then the second ones; y, v: in the middle."""
        half: dict[str, Any] = {"gain": 0.5 * self.gain, "unit": 0.5 * self.unit, "heavier": 0.5 * self.heavier}
        first = self._replace(end_y=y, end_v=v, **half)
        return self.joined([first, self._replace(y=y, v=v, drive=self.drive + half["gain"], weight=self.weight + half["heavier"], **half)])

    def shaking(self, edge: Edge, h: Array | float) -> Shaking:
        """After h [tau]."""
        rate = self.gain / self.unit
        rise = self.heavier / self.unit if isinstance(self.heavier, np.ndarray) else 0.0
        return Shaking(edge.uplift * (self.drive + rate * h), edge.uplift * rate, self.weight + rise * h, rise)


class LineDemands(Demands):
    """As `Demands`, under straight lines. Parameters as there."""

    def __init__(self, body: Body, equation: Equation, segments: Segments, shaken: int, contact: Contact, cells: Cells) -> None:
        super().__init__(body, equation, segments, shaken, contact, cells)
        self.resting = LineResting(body, segments, cells)
        self._strides, self._held = list[Stretches](), 0

    def stride(self, cell: Array, side: Array, start: tuple[Array, Array], end: tuple[Array, Array], ramp: Ramp, go: Array) -> None:
        """Take in strides from one (y, y') to another, those that `go`."""
        found = Stretches(cell, side, *start, *end, ramp.drive, ramp.gain, ramp.unit, *(ramp.weight or (1.0, 0.0)))
        if not go.all():
            found = found.take(np.flatnonzero(go))
        self._strides.append(found)
        self._held += found.cell.size
        if self._held >= _TOGETHER:
            self._sift()

    def take_in(self, going: Lanes, outcome: Array) -> None:
        """Look at all that is left when no lanes go on."""
        if not going.cell.size:
            self._sift()
        super().take_in(going, outcome)

    def _sift(self) -> None:
        """Judge the strides that are held."""
        if not self._held:
            return
        every, self._strides, self._held = Stretches.joined(self._strides), [], 0
        at = self._doubtful(every, self, _MARGIN)
        if at.size:
            some = every.take(at)
            ramp = Ramp(some.drive, some.gain, some.unit, some.unit)
            if isinstance(some.weight, np.ndarray) and isinstance(some.heavier, np.ndarray):
                ramp = ramp._replace(weight=(some.weight, some.heavier))
            self._find(some, line_series(self.equation.on(some.side, some.cell), some.y, some.v, ramp))

    def follow(self, lanes: Lanes, arc: Flow, stop: Array, y: Array, v: Array, at: Array) -> Array:
        """Take in the arcs of the lanes `at` until `stop` [tau], where they are at y, v; `lanes` as they are at 0. The lanes `at`."""
        every, at = at, at[(stop[at] > 0.0) & (self.body.on(lanes.side[at]).unit * lanes.y[at] < FAR)]
        seg, k, u, side = self.segments, lanes.k[at], lanes.u[at], lanes.side[at]
        outward, phase = -side * lanes.amplitude[at], lanes.omega[at] * stop[at]
        drive = outward * (seg.s_start[k] + seg.slope[k] * u)
        weight: Array | float = 1.0
        heavier: Array | float = 0.0
        if isinstance(seg, WeighedSegments):
            weight = seg.weight(side, lanes.amplitude[at], k, u)
            heavier = seg.sway(side, lanes.amplitude[at]) * seg.vertical.slope[k] * phase
        state = lanes.y[at], lanes.v[at], y[at], v[at]
        found = Stretches(lanes.cell[at], side, *state, drive, outward * seg.slope[k] * phase, stop[at], weight, heavier)
        left = self._doubtful(found, self, _MARGIN)
        if left.size:
            self._find(found.take(left), arc.take(at[left]))
        return every

    def _doubtful(self, s: Stretches, records: Records, margin: float) -> Array:
        """Note what the ends of stretches ask; those that may ask more between them than the records of their cells and less a margin, by
        index."""
        body, edge = self.body, self.body.on(s.side)
        one, other = (forces_on(body, edge, s.shaking(edge, h), edge.unit * y, edge.unit * v) for h, y, v in _ends(s))
        low = np.minimum(one.fz, other.fz)
        ratio = np.maximum(_ratio(one), _ratio(other))
        at = np.flatnonzero(~((low >= records.fz_min[s.cell]) & (ratio <= records.friction[s.cell])))
        records.note(s.cell[at], low[at], ratio[at])
        fz_min, friction = records.fz_min[s.cell], records.friction[s.cell]
        across, up = self._sags(s, edge, one, other)
        fast = edge.unit * np.maximum(np.abs(s.v), np.abs(s.end_v))
        room = margin * (1.0 + np.maximum(np.abs(one.fx) + np.abs(one.fz), np.abs(other.fx) + np.abs(other.fz)) + fast * fast)
        maybe = ~(low - up >= fz_min + room)
        held = np.maximum(np.abs(one.fx) - friction * one.fz, np.abs(other.fx) - friction * other.fz)
        more = ~(held + across + friction * up <= -room) & (friction < np.inf)
        maybe &= ~_monotone(one.fz_slope, other.fz_slope, up, s.unit)
        sense = np.sign(one.fx)
        pull, pulls = sense * one.fx_slope - ratio * one.fz_slope, sense * other.fx_slope - ratio * other.fz_slope
        steady = (one.fx * other.fx > 0.0) & _monotone(pull, pulls, across + ratio * up, s.unit)
        steady &= np.maximum(-np.abs(one.fx) - ratio * one.fz, -np.abs(other.fx) - ratio * other.fz) + across + ratio * up < 0.0
        return np.flatnonzero((maybe | (more & ~steady)) & (edge.unit * s.y < FAR))

    def _sags(self, s: Stretches, edge: Edge, one: Forces, other: Forces) -> tuple[Array, Array]:
        """By how much Fx and Fz may leave their chords."""
        push = np.maximum(np.abs(s.drive), np.abs(s.drive + s.gain)) * edge.uplift
        zero = np.zeros(1)
        sway, sway1 = (np.asarray(x) for x in (np.maximum(s.weight, s.weight + s.heavier) - 1.0, np.abs(s.heavier) / s.unit))
        ends = (Ends(edge.unit * y, edge.unit * v, f.bend, f.fz) for (_, y, v), f in zip(_ends(s), (one, other), strict=True))
        return sags(self.body, edge, Shakes(push, np.abs(s.gain) / s.unit * edge.uplift, zero, sway, sway1, zero), s.unit, *ends)

    def _find(self, s: Stretches, arc: Flow) -> None:
        """Halve stretches of these arcs until no part may ask more than is found, each by itself."""
        own, parts, low = Records(s.cell.size), s._replace(cell=np.arange(s.cell.size)), np.zeros(s.cell.size)
        own.fz_min[:] = np.inf
        for _ in range(_HALVINGS):
            left = self._doubtful(parts, own, -_NEAR)
            if not left.size:
                break
            parts, low = parts.take(left), low[left]
            half = low + 0.5 * parts.unit
            point = arc.take(parts.cell).at(half)
            parts, low = parts.halves(point.y, point.v), np.concatenate([low, half])
        self.note(s.cell, own.fz_min, own.friction)


def _ends(s: Stretches) -> tuple[tuple[Array, Array, Array], tuple[Array, Array, Array]]:
    """Time, y and v at the ends of stretches."""
    return (np.zeros(s.unit.size), s.y, s.v), (s.unit, s.end_y, s.end_v)


def _ratio(forces: Forces) -> Array:
    """|Fx|/Fz, infinite without a hold."""
    return np.where(forces.fz > 0.0, np.abs(forces.fx) / forces.fz, np.inf)


def _monotone(slope: Array, other: Array, sag: Array, h: Array) -> Array:
    """Whether functions of these slopes at the ends of stretches of length h, which leave their chords by no more than `sag`, have no
    turn between them: their slopes change by no more than 8 sag/h."""
    return (slope * other > 0.0) & ((np.abs(slope) + np.abs(other)) * h > 8.0 * sag)
