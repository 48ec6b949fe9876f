"""Lost contact: whether Fz > 0 all along the march, where `body` proves nothing beforehand.

Cells under pushes well above the one proved beforehand are watched on their way, the others where their largest rotation does not prove it
either; those of the undamped linear oscillator only so, since a step of theirs is long and costs less than a look at it.

Along a step Fz stays above its chord less the chord error (`march.chord_errors`). A stretch that is not proved is halved; one in which
Fz <= 0 at an end has lost the ground. Bodies press in sequences of impacts that are closed early as they do in bounces without speed.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...motions.segments import Segments
from ..body import Body
from ..contacts.contact import Contact
from ..lanes import Cells, Lanes
from ..march.chord_errors import Ends, Shakes, chord_errors
from ..march.ground_push import Ground
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
        """Look for Fz <= 0 along these arcs: halve them until Fz > 0 is proved in each part, or one has lost the ground."""
        at = arcs.wanted[(self.watched & ~self._lost)[arcs.lanes.cell[arcs.wanted]]]
        lanes, arc, low, high = arcs.lanes.take(at), arcs.flow.take(at), np.zeros(at.size), arcs.stop[at]
        slowing = 2.0 * self.body.damping
        one = self._ends(lanes, low, lanes.y, lanes.v, lanes.b - slowing * lanes.v)
        other = self._ends(lanes, high, arcs.y[at], arcs.v[at], arcs.b[at] - slowing * arcs.v[at])
        for _ in range(_HALVINGS if at.size else 0):
            self._lost[lanes.cell[~((one.fz > 0.0) & (other.fz > 0.0))]] = True
            with np.errstate(invalid="ignore"):  # of a stretch too long for a bound of its speed nothing is proved
                error = chord_errors(self.body, self.body.on(lanes.side), self._shaking(lanes), high - low, one, other)
                proved = np.minimum(one.fz, other.fz) > error
            more = np.flatnonzero(~proved & ~self._lost[lanes.cell])
            if not more.size:
                return
            lanes, arc, low, high, one, other = lanes.take(more), arc.take(more), low[more], high[more], one.take(more), other.take(more)
            half = 0.5 * (low + high)
            there = arc.at(half)
            middle, both = self._ends(lanes, half, there.y, there.v, there.b), np.tile(np.arange(half.size), 2)
            lanes, arc = lanes.take(both), arc.take(both)
            low, high = np.append(low, half), np.append(half, high)
            one, other = one.join(middle), middle.join(other)

    def _shaking(self, lanes: Lanes) -> Shakes:
        weighed, size = self.segments.weighed, self.body.on(lanes.side).uplift * lanes.amplitude
        sway = np.zeros(size.size) if weighed is None else np.abs(weighed.sway(lanes.side, lanes.amplitude))
        return Shakes(*(x for motion, size in ((self.across, size), (self.up, sway)) for x in (
            size * motion.size, size * lanes.omega * motion.slope, size * lanes.omega**2 * motion.bend)))  # fmt: skip

    def _ends(self, lanes: Lanes, h: Array, y: Array, v: Array, b: Array) -> Ends:
        """The ends of stretches after h at displacement y, and Fz there."""
        edge = self.body.on(lanes.side)
        u, v, b = edge.unit * y, edge.unit * v, edge.unit * b
        z = edge.alpha - u
        return Ends(u, v, b, self.ground.weight(lanes, h) + edge.kappa * (b * np.sin(z) - v * v * np.cos(z)))

    def may_close(self, lanes: Lanes) -> Array:
        """True for all. Watched lanes bounce without speed under a drive that is monotone until they rest: Fz is least at an end."""
        some = lanes.take(np.flatnonzero(self.watched[lanes.cell] & (lanes.v > 0.0)))
        lasts = self.ground.bouncing_lasts(some, self.contact) if some.cell.size else np.zeros(0)
        for sense in (1.0,) if self.body.one_sided else (1.0, -1.0):
            edge = self.body.on(sense * some.side)
            for h in (np.zeros(lasts.size), lasts):
                least = self.body.lying(edge, sense * self.ground.push(some, h), self.ground.weight(some, h))
                self._lost[some.cell[np.flatnonzero(least <= 0.0)]] = True
        return super().may_close(lanes)

    def free(self, lanes: Lanes) -> None:
        """Fz is least at the next impact on either edge."""
        some = lanes.take(np.flatnonzero(self.watched[lanes.cell]))
        self._lost[some.cell[np.flatnonzero(self._least_to_come(some) <= 0.0)]] = True

    def _least_to_come(self, lanes: Lanes) -> Array:
        """Least Fz/(m g) over still ground, of the next impact on either edge; damped a lower bound, -inf where none is proved.

        With S = sin z (linear: z) and u'^2 = q at the next impact Fz >= 1 - kappa (S sin z + u'^2 cos z), which falls towards the ground
        while 3 cos z > cos(alpha) + q/2 (linear: q < 1). Damping takes energy, and adds at most 2 zeta kappa u' to the force.
        """
        here, there = self.body.on(lanes.side), self.body.on(-lanes.side)
        square, least = self.body.square_at_ground(here, lanes.y, lanes.v), np.full(lanes.y.size, np.inf)
        for edge, q in ((here, square), (there, square * (lanes.eta * there.unit / here.unit) ** 2)):
            fz = self.body.at_impact(edge, q)
            if self.body.damping:
                fz = fz - edge.kappa * 2.0 * self.body.damping * np.sqrt(q) * np.sin(edge.alpha)
                falls = (q <= (1.0 if self.body.linear else 4.0 * np.cos(edge.alpha))) & (here.unit * lanes.y <= 2.0 * here.alpha)
                fz = np.where(falls, fz, -np.inf)
            least = np.where(q > 0.0, np.minimum(least, fz), least)
        return least

    def lost(self, cell: Array) -> Array:
        """Those that were found."""
        return self._lost[cell]

    def may_settle(self, lanes: Lanes, bounced: Array) -> Array:
        """All but those that may still lose the ground."""
        return ~self.watched[lanes.cell] | self._lost[lanes.cell] | (self._least_to_come(lanes) > 0.0)


def _sizes(segments: Segments) -> _Motion:
    """Bounds over the whole motion."""
    return _Motion(segments.largest, *segments.steepest)
