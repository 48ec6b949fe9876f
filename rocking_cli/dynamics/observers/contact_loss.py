"""Whether bodies press on the ground throughout, Fz > 0, looked for along their march where `body` proves nothing beforehand.

Cells under pushes well above what is proved beforehand are looked at on their way, the others where their largest rotation does not
prove it either; those of the undamped linear oscillator only so, since a step of theirs is long and costs less than a look at it.

Along a step Fz stays above its chord less the chord error (`march.chord_errors`). Most steps are settled by the speed alone: Fz <= 0 needs
a larger speed than its bound there.
A stretch that is not settled is halved; one in which Fz <= 0 at an end has lost the ground.

Bounces that are summed press as bodies do that bounce without speed, on either edge. After the shaking Fz is least at the next impact,
on either edge; damped it may be least after one, and bodies march on until a bound says that Fz > 0.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...motions.segments import Segments
from ..body import Body, Edge
from ..contacts.contact import Contact
from ..equations.equation import Flow
from ..lanes import Cells, Lanes
from ..march.chord_errors import Ends, Shakes, chord_errors, edge_of, fastest
from ..march.ground import Ground
from .observer import Arcs, Observer

Array = np.ndarray

_HALVINGS = 30  # a stretch this short in which Fz is positive wherever it was looked at only touches zero


class _Motion(NamedTuple):
    """Largest |s|, |s'| and |s''| of a motion, by its phase."""

    size: float
    slope: float
    bend: float


class ContactLoss(Observer):
    """Which cells have lost the ground, of those `watched` on their way; `open`: of which nothing is proved beforehand, (cells,).

    ahead: the push over the proved one, above 0, beyond which cells are watched.
    """

    def __init__(self, body: Body, segments: Segments, contact: Contact, cells: Cells, ahead: float) -> None:
        self.body, self.segments, self.contact, self.ground = body, segments, contact, Ground(body, segments)
        self.across, self.up, share = _sizes(segments), _Motion(0.0, 0.0, 0.0), (0.0, 0.0)
        if (weighed := segments.weighed) is not None:  # whose horizontal extremes lie between the ends
            most, least = weighed.inward
            largest = max(self.across.size, float(most[0]), -float(least[0]))
            self.across, self.up, share = self.across._replace(size=largest), _sizes(weighed.vertical), weighed.share
        edges = body.edges
        self.sway = tuple(abs(share[i]) * self.up.size / (e.uplift * self.across.size or 1.0) for i, e in enumerate(edges))
        safe = np.array(body.safe_push(self.sway))[:, None]
        pushes = cells.amplitude * (np.array([e.uplift for e in edges])[:, None] * self.across.size)
        self.open = np.any(pushes > safe, axis=0)
        self.watched: Array = self.open & np.any(pushes / ahead > safe, axis=0)
        self.any = bool(self.watched.any())
        self._lost = np.zeros(self.watched.size, dtype=bool)

    def pressed(self, at: Array, cells: Cells, theta_ratio: Array) -> Array:
        """Whether the largest rotation of these cells proves that they pressed on the ground throughout."""
        kept = np.ones(at.size, dtype=bool)
        for i, (edge, ratio) in enumerate(zip(self.body.edges, self.sway, strict=True)):
            push = cells.amplitude[i, at] * (edge.uplift * self.across.size)
            kept &= push <= self.body.safe_at(i, edge.alpha * theta_ratio, ratio)
        return kept

    def arcs(self, arcs: Arcs) -> None:
        """Look for Fz <= 0 along these arcs."""
        lanes, arc, reach, y, v, b, at = arcs
        cell = lanes.cell[at]
        at = at[self.watched[cell] & ~self._lost[cell]]
        if not at.size:
            return
        edge, shaking, high = self.body.on(lanes.side[at]), self._shaking(lanes.side[at], lanes.amplitude[at], lanes.omega[at]), reach[at]
        damping, unit = 2.0 * self.body.damping, edge.unit
        u0, v0, u1, v1 = unit * lanes.y[at], unit * lanes.v[at], unit * y[at], unit * v[at]
        speed = fastest(self.body, edge, shaking, high, u0, v0, u1, v1)
        settled = speed * (speed + damping * np.tan(edge.alpha)) < _loosening(self.body, edge, shaking)
        settled &= u0 + u1 + speed * high <= 4.0 * edge.alpha
        left = np.flatnonzero(~settled)
        if not left.size:
            return
        at, edge, shaking, u0, v0, u1, v1 = at[left], edge_of(edge, left), shaking.take(left), u0[left], v0[left], u1[left], v1[left]
        some, low, high = lanes.take(at), np.zeros(left.size), high[left]
        one = self._ends(edge, some, low, u0, v0, edge.unit * some.b - damping * v0)
        other = self._ends(edge, some, high, u1, v1, edge.unit * b[at] - damping * v1)
        self._halve(edge, shaking, some, arc.take(at), low, high, one, other)

    def _halve(self, edge: Edge, shaking: Shakes, lanes: Lanes, arc: Flow, low: Array, high: Array, one: Ends, other: Ends) -> None:
        """Halve stretches until Fz > 0 is proved in each, or one has lost the ground."""
        own = np.arange(low.size)
        for _ in range(_HALVINGS):
            gone = ~((one.fz > 0.0) & (other.fz > 0.0))
            self._lost[lanes.cell[own[gone]]] = True
            with np.errstate(invalid="ignore"):  # of a stretch too long for a bound of its speed nothing is proved
                error = chord_errors(self.body, edge_of(edge, own), shaking.take(own), high - low, one, other)[1]
                proved = np.minimum(one.fz, other.fz) > error
            more = np.flatnonzero(~proved & ~self._lost[lanes.cell[own]])
            if not more.size:
                return
            own, low, high, one, other = own[more], low[more], high[more], one.take(more), other.take(more)
            half = 0.5 * (low + high)
            there = arc.take(own).at(half)
            here = edge_of(edge, own)
            middle = self._ends(here, lanes.take(own), half, here.unit * there.y, here.unit * there.v, here.unit * there.b)
            own = np.concatenate([own, own])
            low, high = np.concatenate([low, half]), np.concatenate([half, high])
            one, other = one.join(middle), middle.join(other)

    def _shaking(self, side: Array, amplitude: Array, omega: Array) -> Shakes:
        size = self.body.on(side).uplift * amplitude
        rate = size * omega
        push = size * self.across.size, rate * self.across.slope, rate * (omega * self.across.bend)
        weighed = self.segments.weighed
        if weighed is None:
            return Shakes(*push, *(np.zeros(1),) * 3)
        size = np.abs(weighed.sway(side, amplitude))
        rate = size * omega
        return Shakes(*push, size * self.up.size, rate * self.up.slope, rate * (omega * self.up.bend))

    def _ends(self, edge: Edge, lanes: Lanes, h: Array, u: Array, v: Array, b: Array) -> Ends:
        """The ends of stretches after h, and Fz there."""
        z = edge.alpha - u
        return Ends(u, v, b, self.ground.weight(lanes, h) + edge.kappa * (b * np.sin(z) - v * v * np.cos(z)))

    def may_close(self, lanes: Lanes) -> Array:
        """All. Of those that are watched the drive is monotone until they rest: they bounce without speed."""
        some = lanes.take(np.flatnonzero(self.watched[lanes.cell] & (lanes.v > 0.0)))
        lasts = self.ground.bouncing_lasts(some, self.contact) if some.cell.size else np.zeros(0)
        for sense in (1.0,) if self.body.one_sided else (1.0, -1.0):
            edge = self.body.on(sense * some.side)
            for h in (np.zeros(lasts.size), lasts):
                least = self.body.lying(edge, sense * self.ground.push(some, h), self.ground.weight(some, h))
                self._lost[some.cell[np.flatnonzero(least <= 0.0)]] = True
        return super().may_close(lanes)

    def free(self, lanes: Lanes) -> None:
        """Fz is least at the next impact, or at the first on the other edge."""
        some = lanes.take(np.flatnonzero(self.watched[lanes.cell]))
        here, there = self.body.on(some.side), self.body.on(-some.side)
        square = self.body.square_at_ground(here, some.y, some.v)
        least = self.body.at_impact(here, square)
        if len(self.body.alpha) > 1:
            least = np.minimum(least, self.body.at_impact(there, square * (some.eta * there.unit / here.unit) ** 2))
        self._lost[some.cell[np.flatnonzero(least <= 0.0)]] = True

    def lost(self, cell: Array) -> Array:
        """Those that were found."""
        return self._lost[cell]

    def may_settle(self, lanes: Lanes, bounced: Array) -> Array:
        """All but those that may still lose the ground."""
        from ..march.closing import still_bounds

        return ~self.watched[lanes.cell] | self._lost[lanes.cell] | (still_bounds(self.body, lanes).fz > 0.0)


def _loosening(body: Body, edge: Edge, s: Shakes) -> Array:
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
