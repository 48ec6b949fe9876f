"""Lost contact: `ContactLoss` tests whether Fz > 0 all along the march, for cells for
which `body` does not prove it beforehand.

A cell is marched once more, and then watched, if neither its ground acceleration
(`body.safe_acceleration`) nor its largest rotation proves Fz > 0.

Along a step Fz stays above its chord less the chord error. A part of a step for which
this does not prove Fz > 0 is halved; if Fz <= 0 at an end of a part, the body has lost
the ground. A sequence of impacts is summed only if Fz > 0 is proved for all its
bounces.

The chord error: with bounds V, B, J and Q of the first four derivatives of u = |theta|
[rad by tau], P and W of the push over g and the weight over m g, the second derivative
of Fz over m g is at most

    W'' + kappa [T |sin z| + S],   T = Q + 6 V^2 B,   S = 4 V J + 3 B^2 + V^4

while V <= max(|u'| at its ends) + (h^2/8) J: between its ends Fz does not leave its
chord by more than h^2/8 of that.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ..batch import Batch
from ..body import Body, Edge, ground_reaction, safe_acceleration
from ..contacts.sequences import STILL, sequence_bounds
from ..lanes import Arrays, Lanes
from .observer import Arcs, Observer

# least denominator in the bound of |u'|; a part for which it is smaller is too long
# for a bound
_ROOM = 0.25
_MARGIN = 1.01  # times a speed that was found to 1e-6 bounds this speed
# after so many, Fz was positive at every point computed: it touches zero at most
_HALVINGS = 30


@dataclass
class Ends(Arrays):
    """The motion at one end of each part. Every array is (parts,)."""

    u: Array  # rotation |theta| [rad]
    v: Array  # u', by tau [rad]
    b: Array  # u'', by tau [rad]
    fz: Array  # vertical force on the ground, Fz/(m g) [-]


class ShakingBounds(NamedTuple):
    """Bounds of the shaking on each part, with derivatives by tau. Every array is
    (parts,).
    """

    push: Array  # largest |push| over g [-]
    push1: Array  # bound of its first derivative [-]
    push2: Array  # bound of its second derivative [-]
    sway: Array  # largest deviation of the weight over m g from 1 [-]
    sway1: Array  # bound of its first derivative [-]
    sway2: Array  # bound of its second derivative [-]


def chord_errors(
    body: Body, edge: Edge, s: ShakingBounds, h: Array, one: Ends, other: Ends
) -> Array:
    """h^2/8 times a bound of |Fz''| over m g; infinite where the part is too long
    for a bound of |u'|. |u'''| is at most P' + W' |z| + 2 zeta (P + W |z|) and (P + W +
    4 zeta^2) |u'|, for the nonlinear equation with |sin z| for |z|; the linear one has
    no P |u'|.
    """
    zeta2, heavy = 2.0 * edge.damping, 1.0 + s.sway
    v, turn = _largest_speed(body, edge, s, h, one, other)
    sin = np.sin(np.minimum(turn, 0.5 * np.pi))
    lean = turn if body.linear else sin

    # B and J, bounds of the second and of the third derivative of u.
    b = s.push + heavy * lean + zeta2 * v
    j = s.push1 + (s.push * sin + heavy) * v + s.sway1 * lean + zeta2 * b
    b = np.minimum(b, 0.5 * (np.abs(one.b) + np.abs(other.b) + j * h))

    # T = Q + 6 V^2 B, with Q the bound of the fourth derivative, and S.
    square = v * v
    q = (
        s.push2
        + 2.0 * (s.push1 * sin + s.sway1) * v
        + (s.push + heavy * sin) * square
        + (s.push * sin + heavy) * b
    )
    q += s.sway2 * lean + zeta2 * j + 6.0 * square * b
    rest = 4.0 * v * j + 3.0 * b * b + square * square
    return 0.125 * h * h * (s.sway2 + edge.kappa * (q * sin + rest))


def _largest_speed(
    body: Body, edge: Edge, s: ShakingBounds, h: Array, one: Ends, other: Ends
) -> tuple[Array, Array]:
    """(V, a bound of |u'| on each part, infinite where the part is too long; a
    bound of |z|).
    """
    zeta2, heavy, eighth = 2.0 * edge.damping, 1.0 + s.sway, 0.125 * h * h
    flat, steep = s.push1 + zeta2 * s.push, heavy + zeta2 * zeta2
    by_turn, mean_u = s.sway1 + zeta2 * heavy, 0.5 * (one.u + other.u)
    # The third derivative of u is at most flat + steep |u'|.
    if body.linear:
        flat = flat + by_turn * (edge.alpha + mean_u)
        steep = steep + by_turn * 0.5 * h
    else:
        flat, steep = flat + by_turn, steep + s.push
    room = 1.0 - eighth * steep
    at_ends = np.maximum(np.abs(one.v), np.abs(other.v))
    v = (at_ends + eighth * flat) / np.maximum(room, _ROOM)
    v = np.where(room > _ROOM, v, np.inf)
    return v, np.abs(edge.alpha - mean_u) + 0.5 * v * h


class ContactLoss(Observer):
    """Search for lost contact in the cells of a batch while they are marched."""

    def __init__(self, body: Body, batch: Batch) -> None:
        self.body, self.batch, self.segments = body, batch, batch.segments
        segments = batch.segments
        # Bounds of |s|, |s'| and |s''| by the phase, of the horizontal and the vertical
        # motion.
        self.across = (segments.largest, *segments.steepest)
        self.up = (0.0, 0.0, 0.0)
        share = (0.0, 0.0)
        weighed = segments.weighed
        if weighed is not None:
            # Extremes of the horizontal motion lie inside segments here.
            most, least = weighed.inward
            self.across = (
                max(segments.largest, float(most[0]), -float(least[0])),
                *segments.steepest,
            )
            self.up = (weighed.vertical.largest, *weighed.vertical.steepest)
            share = weighed.share
        size = batch.cells.omega.shape[1]
        uplifts = [np.broadcast_to(e.uplift, size) for e in body.edges]
        # The sway of a push of 1 g; the weight varies for cells of one body only.
        self.sway = tuple(
            abs(r) * self.up[0] / (float(np.ravel(e.uplift)[0]) * self.across[0] or 1.0)
            if weighed is not None
            else 0.0
            for r, e in zip(share, body.edges, strict=False)
        )
        safe = [
            np.broadcast_to(safe_acceleration(body, i, ratio), size)
            for i, ratio in enumerate(self.sway)
        ]
        accelerations = batch.cells.amplitude * (np.array(uplifts) * self.across[0])
        # True for cells without a proof
        self.open = np.any(accelerations > np.array(safe), axis=0)
        self._lost = np.zeros(self.open.size, dtype=bool)

    def contact_proved(
        self, at: Array, theta_ratio: Array, fastest: Array | None = None
    ) -> Array:
        """True for those of these cells whose largest rotation, and u' [rad] if it is
        given, prove that they never lost the ground.
        """
        kept = np.ones(at.size, dtype=bool)
        speed = np.inf if fastest is None or not self.body.alike else _MARGIN * fastest
        for accelerations, edge, ratio in zip(
            self.batch.cells.amplitude, self.body.of(at).edges, self.sway, strict=True
        ):
            push = accelerations[at] * (edge.uplift * self.across[0])
            kept &= self.body.contact_proved(
                edge, push, edge.alpha * theta_ratio, ratio * push, speed
            )
        return kept

    def arcs(self, arcs: Arcs) -> None:
        """Look for Fz <= 0 along these arcs: halve each arc until Fz > 0 is proved on
        every part, or Fz <= 0 is found at a point.
        """
        at = arcs.wanted[~self._lost[arcs.lanes.cell[arcs.wanted]]]
        lanes = arcs.lanes.take(at)
        arc = arcs.flow.take(at)
        low = np.zeros(at.size)
        high = arcs.stop[at]
        slowing = 2.0 * self.batch.equation.damping_of(lanes.cell)
        one = self._ends(lanes, low, arc.y, arc.v, arc.b)
        other = self._ends(
            lanes, high, arcs.y[at], arcs.v[at], arcs.force[at] - slowing * arcs.v[at]
        )
        for _ in range(_HALVINGS if at.size else 0):
            self._lost[lanes.cell[~((one.fz > 0.0) & (other.fz > 0.0))]] = True
            # a part too long for a bound of |u'| stays unproved
            with np.errstate(invalid="ignore"):
                error = chord_errors(
                    self.body,
                    self.body.on(lanes.side, lanes.cell),
                    self._shaking(lanes),
                    high - low,
                    one,
                    other,
                )
                proved = np.minimum(one.fz, other.fz) > error
            more = np.flatnonzero(~proved & ~self._lost[lanes.cell])
            if not more.size:
                return
            lanes = lanes.take(more)
            arc = arc.take(more)
            low = low[more]
            high = high[more]
            one = one.take(more)
            other = other.take(more)
            half = 0.5 * (low + high)
            there = arc.at(half)
            middle = self._ends(lanes, half, there.y, there.v, there.b)
            both = np.tile(np.arange(half.size), 2)
            lanes, arc = lanes.take(both), arc.take(both)
            low, high = np.append(low, half), np.append(half, high)
            one, other = one.join(middle), middle.join(other)

    def _shaking(self, lanes: Lanes) -> ShakingBounds:
        """Bounds of the push, of the weight less m g, and of their derivatives, by
        lane.
        """
        weighed = self.segments.weighed
        size = self.body.on(lanes.side, lanes.cell).uplift * lanes.amplitude
        sway = (
            np.zeros(size.size)
            if weighed is None
            else np.abs(weighed.sway(lanes.side, lanes.amplitude))
        )
        rates = 1.0, lanes.omega, lanes.omega**2
        return ShakingBounds(
            *(
                x * rate * bound
                for x, most in ((size, self.across), (sway, self.up))
                for rate, bound in zip(rates, most, strict=True)
            )
        )

    def _ends(self, lanes: Lanes, h: Array, y: Array, v: Array, b: Array) -> Ends:
        """State and Fz of lanes h after their present state, at displacement y,
        velocity v and acceleration b.
        """
        weight = self.segments.weight(
            lanes.side, lanes.amplitude, lanes.segment, lanes.phase + lanes.omega * h
        )
        edge = self.body.on(lanes.side, lanes.cell)
        u, v, b = edge.unit * y, edge.unit * v, edge.unit * b
        # Fz does not depend on the push itself
        return Ends(u, v, b, ground_reaction(edge, u, v, b, 0.0, weight)[1])

    def may_rest(self, lanes: Lanes) -> Array:
        """True for lanes whose bounces until they rest are proved to keep Fz > 0, and
        for lanes that have lost the ground (Lemma 13).

        Other lanes bounce on, each time more slowly, until one of both is proved.
        """
        moving = np.flatnonzero(lanes.v > 0.0)
        some = lanes.take(moving)
        if some.cell.size:
            kept, lost = self._bouncing(some)
            self._lost[some.cell[lost]] = True
            may = np.ones(lanes.cell.size, dtype=bool)
            may[moving] = kept | (some.v < STILL)
            return may | self._lost[lanes.cell]
        return super().may_rest(lanes)

    def _bouncing(self, lanes: Lanes) -> tuple[Array, Array]:
        """(True where a sequence of impacts is proved to keep Fz > 0, True where Fz <=
        0 is proved just after one of its impacts).
        """
        contact, body = self.batch.contact, self.body
        bounds = sequence_bounds(self.segments, lanes, contact.other_side(lanes))
        now, later = (
            self.segments.weight(lanes.side, lanes.amplitude, lanes.segment, u)
            for u in (lanes.phase, bounds.later)
        )
        lightest, heaviest = np.minimum(now, later), np.maximum(now, later)
        kept = np.ones(lanes.cell.size, dtype=bool)
        lost = np.zeros(lanes.cell.size, dtype=bool)
        for i, sense in enumerate((1.0,) if body.one_sided else (1.0, -1.0)):
            edge = body.on(sense * lanes.side, lanes.cell)
            inward, fastest = edge.unit * bounds.most[i], edge.unit * bounds.fastest[i]
            kept &= (
                body.fz_in_bounces(
                    edge, lightest, inward, fastest, edge.unit * bounds.height
                )
                > 0.0
            )
            # Now the body leaves this edge at a known speed; it will leave the other
            # edge at a speed above 0.
            weight, force, speed = (
                (heaviest, bounds.least[i], 0.0 * lanes.v)
                if i
                else (now, -lanes.force, lanes.v)
            )
            lost |= (
                body.fz_in_bounces(
                    edge, weight, edge.unit * force, edge.unit * speed, 0.0
                )
                <= 0.0
            )
        return kept, lost

    def free(self, lanes: Lanes) -> None:
        """Test Fz at the next impact on either edge: in the free motion it is least
        there.
        """
        self._lost[lanes.cell[np.flatnonzero(self._least_to_come(lanes) <= 0.0)]] = True

    def _least_to_come(self, lanes: Lanes) -> Array:
        """Least Fz/(m g) of the free motion, at the next impact on either edge; with
        damping a lower bound, -inf without a proof.
        """
        # With S = sin z (linear: z) and u'^2 = q at the impact Fz >= 1 - kappa (S sin z
        # + u'^2 cos z), which falls towards the ground while 3 cos z > cos(alpha) + q/2
        # (linear: q < 1). Damping takes energy, and adds at most 2 zeta kappa u' to the
        # force.
        here, there = (
            self.body.on(lanes.side, lanes.cell),
            self.body.on(-lanes.side, lanes.cell),
        )
        square = self.body.squared_speed_at_ground(here, lanes.y, lanes.v)
        least = np.full(lanes.y.size, np.inf)
        for edge, q in (
            (here, square),
            (there, square * (lanes.eta * there.unit / here.unit) ** 2),
        ):
            rate = np.sqrt(q)
            _, fz = ground_reaction(
                edge,
                0.0,
                rate,
                -self.body.pull(edge) - 2.0 * edge.damping * rate,
                0.0,
                1.0,
            )
            if self.batch.equation.damped:
                falls = (
                    q <= (1.0 if self.body.linear else 4.0 * np.cos(edge.alpha))
                ) & (here.unit * lanes.y <= 2.0 * here.alpha)
                fz = np.where(falls, fz, -np.inf)
            least = np.where(q > 0.0, np.minimum(least, fz), least)
        return least

    def lost(self, cell: Array) -> Array:
        return self._lost[cell]

    def may_settle(self, lanes: Lanes, bounced: Array) -> Array:
        """True for lanes that cannot lose the ground any more, or that have lost it
        already.
        """
        return self._lost[lanes.cell] | (self._least_to_come(lanes) > 0.0)
