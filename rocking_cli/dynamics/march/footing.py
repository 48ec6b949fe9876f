"""Whether bodies press on the ground throughout, Fz > 0, looked for along their march where `body` proves nothing beforehand.

Cells under pushes well above what is proved beforehand are looked at on their way, the others where their largest rotation does not
prove it either; those of the undamped linear oscillator only so, since a step of theirs is long and costs less than a look at it.

Along a step y is smooth, and with bounds V, B, J and Q of the first four derivatives of u = |theta| [rad by tau]

    Fz/(m g) = w + kappa (u'' sin z - u'^2 cos z) >= min(its ends) - (h^2/8) M,
    M = W'' + kappa [Q |sin z| + 4 V J + 3 B^2 + 6 V^2 B |sin z| + V^4]

while V <= max(|u'| at its ends) + (h^2/8) J. Most steps are settled before that by the speed alone, which Fz <= 0 needs more of than V.
A stretch that is not settled is halved; one in which Fz <= 0 at an end has lost the ground.

Bounces that are summed press as bodies do that bounce without speed, on either edge. After the shaking Fz is least at the next impact,
on either edge; bodies that settle by damping have done that before.
"""

from __future__ import annotations

from typing import NamedTuple, Self

import numpy as np

from ...motions.segments import Segments
from ..body import Body, Edge
from ..contacts.contact import Contact
from ..equations.equation import Flow
from ..lanes import Cells, Lanes
from ..weight import WeighedSegments
from .ground import Ground

Array = np.ndarray

_HALVINGS = 30  # a stretch this short in which Fz is positive wherever it was looked at only touches zero
LIKELY = 2.0  # times the push that is proved beforehand: beyond it most cells would have to be looked at afterwards
_ROOM = 0.25  # of the bound of a speed, which a longer stretch does not have


class _Motion(NamedTuple):
    """Largest |s|, |s'| and |s''| of a motion, by its phase."""

    size: float
    slope: float
    bend: float


class _Ends(NamedTuple):
    """u, u', u'' [rad by tau] and Fz/(m g) at one end of stretches, (stretches,)."""

    u: Array
    v: Array
    b: Array
    fz: Array

    def take(self, at: Array) -> Self:
        """Of some stretches."""
        return type(self)(*(x[at] for x in self))

    def join(self, other: Self) -> Self:
        """These and others."""
        return type(self)(*(np.concatenate(pair) for pair in zip(self, other, strict=True)))


class _Shaking(NamedTuple):
    """Of each lane: the largest push over g and its first two derivatives by tau, and the same of the weight's change over m g."""

    push: Array
    push1: Array
    push2: Array
    sway: Array
    sway1: Array
    sway2: Array

    def take(self, at: Array) -> Self:
        """Of some lanes; a part without any motion stays one zero."""
        return type(self)(*(x if x.size == 1 else x[at] for x in self))


class Footing:
    """Which cells have lost the ground: `lost`, of those `watched` on their way; `open`: of which nothing is proved beforehand, (cells,).

    ahead: the push over the proved one, above 0, beyond which cells are watched.
    """

    def __init__(self, body: Body, segments: Segments, cells: Cells, ahead: float) -> None:
        self.body, self.segments, self.ground = body, segments, Ground(body, segments)
        self.across, self.up, share = _sizes(segments), _Motion(0.0, 0.0, 0.0), (0.0, 0.0)
        if isinstance(segments, WeighedSegments):  # whose horizontal extremes lie between the ends
            most, least = segments.inward
            largest = max(self.across.size, float(most.max()), -float(least.min()))
            self.across, self.up, share = self.across._replace(size=largest), _sizes(segments.vertical), segments.share
        edges = body.edges
        self.sway = tuple(abs(share[i]) * self.up.size / (e.uplift * self.across.size or 1.0) for i, e in enumerate(edges))
        safe = np.array(body.safe_push(self.sway))[:, None]
        pushes = cells.amplitude * (np.array([e.uplift for e in edges])[:, None] * self.across.size)
        self.open = np.any(pushes > safe, axis=0)
        self.watched: Array = self.open & np.any(pushes / ahead > safe, axis=0)
        self.any = bool(self.watched.any())
        self.lost = np.zeros(self.watched.size, dtype=bool)

    def pressed(self, at: Array, cells: Cells, theta_ratio: Array) -> Array:
        """Whether the largest rotation of these cells proves that they pressed on the ground throughout."""
        kept = np.ones(at.size, dtype=bool)
        for i, (edge, ratio) in enumerate(zip(self.body.edges, self.sway, strict=True)):
            push = cells.amplitude[i, at] * (edge.uplift * self.across.size)
            kept &= push <= self.body.safe_at(i, edge.alpha * theta_ratio, ratio)
        return kept

    def follow(self, lanes: Lanes, arc: Flow, reach: Array, y: Array, v: Array, b: Array, at: Array) -> None:
        """Take in the arcs of the lanes `at` until `reach` [tau], where they are at y, v under the force b; `lanes` as they are at 0."""
        cell = lanes.cell[at]
        at = at[self.watched[cell] & ~self.lost[cell]]
        if not at.size:
            return
        edge, shaking, high = self.body.on(lanes.side[at]), self._shaking(lanes.side[at], lanes.amplitude[at], lanes.omega[at]), reach[at]
        damping, unit = 2.0 * self.body.damping, edge.unit
        u0, v0, u1, v1 = unit * lanes.y[at], unit * lanes.v[at], unit * y[at], unit * v[at]
        speed = self._speed(edge, shaking, high, u0, v0, u1, v1)
        settled = speed * (speed + damping * np.tan(edge.alpha)) < _loosening(self.body, edge, shaking)
        settled &= u0 + u1 + speed * high <= 4.0 * edge.alpha
        left = np.flatnonzero(~settled)
        if not left.size:
            return
        at, edge, shaking, u0, v0, u1, v1 = at[left], _edge_of(edge, left), shaking.take(left), u0[left], v0[left], u1[left], v1[left]
        some, low, high = lanes.take(at), np.zeros(left.size), high[left]
        one = self._ends(edge, some, low, u0, v0, edge.unit * some.b - damping * v0)
        other = self._ends(edge, some, high, u1, v1, edge.unit * b[at] - damping * v1)
        self._halve(edge, shaking, some, arc.take(at), low, high, one, other)

    def _halve(self, edge: Edge, shaking: _Shaking, lanes: Lanes, arc: Flow, low: Array, high: Array, one: _Ends, other: _Ends) -> None:
        """Halve stretches until Fz > 0 is proved in each, or one has lost the ground."""
        own = np.arange(low.size)
        for _ in range(_HALVINGS):
            gone = ~((one.fz > 0.0) & (other.fz > 0.0))
            self.lost[lanes.cell[own[gone]]] = True
            open_ = np.minimum(one.fz, other.fz) <= self._sag(_edge_of(edge, own), shaking.take(own), high - low, one, other)
            more = np.flatnonzero(open_ & ~self.lost[lanes.cell[own]])
            if not more.size:
                return
            own, low, high, one, other = own[more], low[more], high[more], one.take(more), other.take(more)
            half = 0.5 * (low + high)
            there = arc.take(own).at(half)
            here = _edge_of(edge, own)
            middle = self._ends(here, lanes.take(own), half, here.unit * there.y, here.unit * there.v, here.unit * there.b)
            own = np.concatenate([own, own])
            low, high = np.concatenate([low, half]), np.concatenate([half, high])
            one, other = one.join(middle), middle.join(other)

    def _shaking(self, side: Array, amplitude: Array, omega: Array) -> _Shaking:
        size = self.body.on(side).uplift * amplitude
        rate = size * omega
        push = size * self.across.size, rate * self.across.slope, rate * (omega * self.across.bend)
        if not isinstance(self.segments, WeighedSegments):
            return _Shaking(*push, *(np.zeros(1),) * 3)
        size = np.abs(self.segments.sway(side, amplitude))
        rate = size * omega
        return _Shaking(*push, size * self.up.size, rate * self.up.slope, rate * (omega * self.up.bend))

    def _speed(self, edge: Edge, s: _Shaking, h: Array, u0: Array, v0: Array, u1: Array, v1: Array) -> Array:
        """A bound of |u'| on stretches between these ends; infinite where they are too long for one.

        |u'''| is at most P' + W' |z| + 2 zeta (P + W |z|) and (P + W + 4 zeta^2) |u'|, |sin z| in the place of |z| for the nonlinear
        equation; the linear one has no P |u'|.
        """
        zeta2, weight = 2.0 * self.body.damping, 1.0 + s.sway
        by_turn = s.sway1 + zeta2 * weight
        flat, steep = s.push1 + zeta2 * s.push, weight + zeta2 * zeta2
        if self.body.linear:
            flat, steep = flat + by_turn * (edge.alpha + 0.5 * (u0 + u1)), steep + by_turn * 0.5 * h
        else:
            flat, steep = flat + by_turn, steep + s.push
        eighth = 0.125 * h * h
        room = 1.0 - eighth * steep
        return np.where(room > _ROOM, (np.maximum(np.abs(v0), np.abs(v1)) + eighth * flat) / np.maximum(room, _ROOM), np.inf)

    def _sag(self, edge: Edge, s: _Shaking, h: Array, one: _Ends, other: _Ends) -> Array:
        """(h^2/8) M."""
        zeta2, heavy, v = 2.0 * self.body.damping, 1.0 + s.sway, self._speed(edge, s, h, one.u, one.v, other.u, other.v)
        middle = edge.alpha - 0.5 * (one.u + other.u)
        turn = np.abs(middle) + 0.5 * v * h
        sin = np.sin(np.minimum(turn, 0.5 * np.pi))
        lean = turn if self.body.linear else sin
        b = s.push + heavy * lean + zeta2 * v
        j = s.push1 + (s.push * sin + heavy) * v + s.sway1 * lean + zeta2 * b
        b = np.minimum(b, 0.5 * (np.abs(one.b) + np.abs(other.b) + j * h))
        q = s.push2 + 2.0 * (s.push1 * sin + s.sway1) * v + (s.push + heavy * sin) * v * v + (s.push * sin + heavy) * b
        q += s.sway2 * lean + zeta2 * j
        return 0.125 * h * h * (s.sway2 + edge.kappa * (q * sin + 4.0 * v * j + 3.0 * b * b + 6.0 * v * v * b * sin + v**4))

    def _ends(self, edge: Edge, lanes: Lanes, h: Array, u: Array, v: Array, b: Array) -> _Ends:
        """The ends of stretches after h, and Fz there."""
        z = edge.alpha - u
        return _Ends(u, v, b, self.ground.weight(lanes, h) + edge.kappa * (b * np.sin(z) - v * v * np.cos(z)))

    def settle(self, lanes: Lanes, contact: Contact) -> None:
        """Bodies whose bouncing is summed from now on, under a drive that is monotone until they rest."""
        some = lanes.take(np.flatnonzero(self.watched[lanes.cell]))
        if not some.cell.size:
            return
        here, there = self.body.on(some.side), self.body.on(-some.side)
        lasts = self.ground.bouncing_lasts(some, contact)
        for h in (np.zeros(some.cell.size), lasts):
            push, weight = self.ground.push(some, h), self.ground.weight(some, h)
            least = self.body.lying(here, push, weight)
            if not self.body.one_sided:
                least = np.minimum(least, self.body.lying(there, -push, weight))
            self.lost[some.cell[np.flatnonzero(least <= 0.0)]] = True

    def free(self, lanes: Lanes, at: Array, y: Array, v: Array) -> None:
        """Bodies at y, v that rock on over still ground: the next impact, and the first on the other edge."""
        some = np.flatnonzero(self.watched[lanes.cell[at]])
        at, y, v = at[some], y[some], v[some]
        side = lanes.side[at]
        edge = self.body.on(side)
        square = (edge.unit * v) ** 2 + self.body.fall(edge, edge.unit * y)
        least = self.body.at_impact(edge, square)
        if len(self.body.alpha) > 1:
            there = self.body.on(-side)
            least = np.minimum(least, self.body.at_impact(there, square * (lanes.eta[at] * there.unit / edge.unit) ** 2))
        self.lost[lanes.cell[at[np.flatnonzero(least <= 0.0)]]] = True


def _edge_of(edge: Edge, at: Array) -> Edge:
    """The edges of some lanes."""
    return Edge(*(x[at] if isinstance(x, np.ndarray) else x for x in edge))


def _loosening(body: Body, edge: Edge, s: _Shaking) -> Array:
    """What u'^2 + 2 zeta tan(alpha) |u'| must exceed for Fz <= 0 at |z| <= alpha.

    Fz/(kappa cos z) is w [(1/kappa - 1)/cos z + cos z] + push sin z - u'^2 - 2 zeta u' tan z; of the linear equation its first term is
    w (1/kappa - z sin z)/cos z and its second push tan z.
    """
    light, cos = 1.0 - s.sway, np.cos(edge.alpha)
    if body.linear:
        held = 1.0 / edge.kappa - edge.alpha * np.sin(edge.alpha)
        return light * np.where(held > 0.0, held, held / cos) - s.push * np.tan(edge.alpha)
    lack = 1.0 / edge.kappa - 1.0
    best = np.clip(np.sqrt(np.maximum(lack, 0.0)), cos, 1.0)  # the cos z at which it holds least
    return light * (lack / best + best) - s.push * np.sin(edge.alpha)


def _sizes(segments: Segments) -> _Motion:
    """Bounds over the whole motion."""
    return _Motion(segments.largest, *segments.steepest)
