"""Contact with the ground, watched while bodies are marched, free or with ties: where
along a step the vertical force Fz of the ground falls to zero.

With u = |theta|, z = alpha - u, w the weight over m g and D the vertical force of a
tendon on the body over m g,

    Fz/(m g) = w + kappa (u'' sin z - u'^2 cos z) + D,    D = F cos(u/2)/(m g)

A tie pulls horizontally: it changes Fz by the acceleration alone. Between two instants
h apart Fz does not leave its chord by more than h^2/8 times a bound of |Fz''|. With
bounds V, B, J and Q of the first four derivatives of u (by tau), and F the largest
force and k b the largest stiffness of the tendon,

    |Fz''|/(m g) <= |w''| + kappa [(Q + 6 V^2 B) |sin z| + 4 V J + 3 B^2 + V^4]
                    + [(F/4 + k b) V^2 + (F/2 + k b) B]/(m g)
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ...arrays import Array
from ...motions.blocks import blocks
from ...motions.segments import Segments
from ..body import Body, ground_reaction, relief
from ..contacts.contact import Contact
from ..contacts.sequences import STILL, sequence_bounds
from ..drive import summed
from ..equations.equation import Equation
from ..equations.taylor import powers
from ..lanes import Arrays, Lanes
from .observer import Arcs, Observer

if TYPE_CHECKING:
    from ..tied.bounces import Bounces
    from ..tied.devices import Devices

# largest number of parts into which a part of a step is cut at once; of a step at which
# the first instant without force is looked for
_MOST_PARTS, _FINEST = 32, 32**3
_TOGETHER = 512  # lanes whose parts are cut together
# after so many cuts Fz was positive at every instant computed: it touches zero at most
_CUTS = 30


@dataclass
class StepParts(Arrays):
    """Parts of steps between two instants after their start, (parts,)."""

    lane: Array  # index of the lane
    low: Array  # first instant [tau]
    high: Array  # last instant [tau]
    fz_low: Array  # Fz/(m g) at the first instant [-]
    fz_high: Array  # Fz/(m g) at the last instant [-]


class ContactWatch(Observer):
    """Finds cells in whose march Fz <= 0 occurs."""

    def __init__(
        self,
        body: Body,
        equation: Equation,
        contact: Contact,
        segments: Segments,
        watched: Array,
        bounces: Bounces | None = None,
    ) -> None:
        """body: gives the forces of the free body on the ground; watched: True for
        cells that may lose contact, (cells,); bounces: those of bodies with ties or a
        tendon.
        """
        self.body, self.equation, self.contact = body, equation, contact
        self.segments, self.bounces = segments, bounces
        self.devices: Devices | None = None if bounces is None else bounces.devices
        # True for cells that may still lose contact; for those that have, (cells,)
        self._open, self._lost = watched.copy(), np.zeros(watched.size, dtype=bool)

    def lost(self, cell: Array) -> Array:
        return self._lost[cell]

    def _lose(self, cell: Array) -> None:
        """Note that these cells have lost contact."""
        self._lost[cell], self._open[cell] = True, False

    # Along the steps of the march.

    def needs(
        self,
        side: Array,
        cell: Array,
        highest: Array,
        fastest: Array,
        acceleration: Array,
        lightest: Array | float,
    ) -> Array:
        edge = self.body.on(side, cell)
        proved = relief(edge, highest, fastest, acceleration) < lightest
        return ~proved & self._open[cell]

    def arcs(self, arcs: Arcs) -> None:
        self.losses(arcs)

    def losses(self, steps: Arcs) -> Array:
        """Mark the cells that lose the ground on these steps; returns the indices of
        their lanes.
        """
        # Three proofs of Fz > 0, each for the lanes that the one before leaves open: by
        # the largest speed and acceleration, by the chord over the whole step, and by
        # the chords of its parts.
        cell = steps.lanes.cell
        wanted = steps.wanted & self._open[cell]
        at = np.flatnonzero(wanted & ~self._proved_by_size(steps))
        if at.size:
            bound = np.zeros(cell.size)
            bound[at] = self._largest_curvature(steps, at)
            ends = (self.fz(steps, at, h) for h in (0.0 * at, steps.reach[at]))
            whole = StepParts(at, 0.0 * at, steps.reach[at], *ends)
            at = np.concatenate(
                [
                    self._search(steps, whole.take(block), bound)
                    for block in blocks(at.size, _TOGETHER)
                ]
            )
            self._lose(cell[at])
        return at

    def fz(self, steps: Arcs, at: Array, h: Array) -> Array:
        """Return Fz/(m g) of the lanes `at`, h [tau] after the start of their steps."""
        lanes = steps.lanes
        edge = self.body.on(lanes.side[at], lanes.cell[at])
        here = steps.arc.take(at).at(h)
        weight = 1.0 if steps.weight is None else steps.weight.take(at).at(h).y
        u, v, b = (edge.theta_per_y * x for x in (here.y, here.v, here.b))
        _, fz = ground_reaction(edge, u, v, b, 0.0, weight)
        if self.devices is not None and steps.held is not None:
            row, now = steps.held
            fz = fz + self.devices.downwards(row[at], now.take(at), here.y)
        return np.asarray(fz)

    def first(self, steps: Arcs) -> float:
        """Return the instant [tau] at which Fz of the first lane falls to zero on its
        step.
        """
        reach, parts = float(steps.reach[0]), _MOST_PARTS
        while True:
            h = np.linspace(0.0, reach, parts + 1)
            below = ~(self.fz(steps, np.zeros(h.size, dtype=np.int64), h) > 0.0)
            if below.any() or parts >= _FINEST:
                break
            parts *= _MOST_PARTS
        i = int(below.argmax())
        low, high = float(h[max(i - 1, 0)]), float(h[i])
        lane = np.zeros(1, dtype=np.int64)
        while low < (middle := 0.5 * (low + high)) < high:
            in_contact = self.fz(steps, lane, np.array([middle]))[0] > 0.0
            low, high = (middle, high) if in_contact else (low, middle)
        return high

    def _proved_by_size(self, steps: Arcs) -> Array:
        """True where the largest speed and acceleration of a step leave Fz > 0."""
        edge = self.body.on(steps.lanes.side, steps.lanes.cell)
        lightest, _ = _weight_bounds(steps)
        taken = relief(edge, _highest(steps), steps.fastest, steps.acceleration)
        return np.asarray(taken < lightest)

    def _largest_curvature(self, steps: Arcs, at: Array) -> Array:
        """A bound of |Fz''|/(m g) on the steps of the lanes `at`."""
        edge = self.body.on(steps.lanes.side[at], steps.lanes.cell[at])
        unit, turned = edge.theta_per_y, edge.theta_per_y * _highest(steps)[at]
        v, b = unit * steps.fastest[at], unit * steps.acceleration[at]
        # Bounds of u''' (j) and u'''' (q): the sums of the sizes of the terms.
        arc, n = steps.arc.take(at), np.arange(3.0, len(steps.arc.terms))[:, None]
        share = steps.reach[at] / arc.unit
        third = n * (n - 1.0) * (n - 2.0) * np.abs(arc.terms[3:])
        j = unit * np.sum(third * share ** (n - 3.0), axis=0) / arc.unit**3
        q = (
            unit
            * np.sum(third[1:] * (n[1:] - 3.0) * share ** (n[1:] - 4.0), axis=0)
            / arc.unit**4
        )
        # Second derivative of kappa (u'' sin z - u'^2 cos z), with |cos z| <= 1.
        sin = np.minimum(np.maximum(edge.alpha, turned - edge.alpha), 1.0)
        curvature = edge.kappa * (
            (q + 6.0 * v * v * b) * sin + 4.0 * v * j + 3.0 * b * b + v**4
        )
        if self.devices is not None and steps.held is not None:
            # A tendon adds its force times cos(u/2).
            row, now = steps.held
            force, rate = self.devices.tendon_bounds(row[at], now.take(at), turned)
            curvature += (0.25 * force + rate) * v * v + (0.5 * force + rate) * b
        _, bends = _weight_bounds(steps)
        return np.asarray(curvature + bends[at])

    def _search(self, steps: Arcs, left: StepParts, bound: Array) -> Array:
        """Lanes with Fz <= 0 at an end of a part of their steps. Parts are cut until
        Fz > 0 is proved or Fz <= 0 is found; bound: of |Fz''|/(m g), (lanes,).
        """
        lost = np.zeros(steps.reach.size, dtype=bool)
        for _ in range(_CUTS):
            falls = ~((left.fz_low > 0.0) & (left.fz_high > 0.0))
            lost[left.lane[falls]] = True
            least = np.minimum(left.fz_low, left.fz_high)
            error = 0.125 * (left.high - left.low) ** 2 * bound[left.lane]
            open_ = np.flatnonzero(~(least > error) & ~lost[left.lane])
            if not open_.size:
                break
            # as many parts as prove it if Fz is no less inside
            left, share = left.take(open_), error[open_] / least[open_]
            count = np.clip(np.ceil(np.sqrt(share)), 2, _MOST_PARTS).astype(np.int64)
            own = np.repeat(np.arange(open_.size), count)
            n = np.arange(own.size) - np.repeat(np.cumsum(count) - count, count)
            part = ((left.high - left.low) / count)[own]
            lane, low = left.lane[own], left.low[own] + n * part
            fz_low, fz_high = left.fz_low[own], left.fz_high[own]
            inner = np.flatnonzero(n)
            fz_low[inner] = self.fz(steps, lane[inner], low[inner])
            fz_high[inner - 1] = fz_low[inner]
            left = StepParts(lane, low, low + part, fz_low, fz_high)
        return np.flatnonzero(lost)

    # Where the march takes no steps.

    def may_rest(self, lanes: Lanes) -> Array:
        """True for lanes whose bounces until they rest are proved to keep Fz > 0 (Lemma
        13), and for lanes that have lost the ground or have no speed.

        Other lanes bounce on, each time more slowly, until one of both is proved.
        """
        may: Array = ~self._open[lanes.cell] | (lanes.v < STILL)
        at = np.flatnonzero(~may)
        if at.size:
            may[at] = self._bounces_press(lanes.take(at))
        return may

    def _bounces_press(self, lanes: Any) -> Array:
        """True for lanes whose sequence of impacts is proved to keep Fz > 0. A tie
        pulls horizontally: it changes Fz by the acceleration alone. A tendon also
        presses the body to the ground.
        """
        body, segments, held = self.body, self.segments, self.bounces
        free, there = lanes, self.contact.other_side(lanes)
        if held is not None:
            free, there = held.free(lanes)
        bounds = sequence_bounds(segments, free, there)
        now, later = (
            segments.weight(lanes.side, lanes.amplitude, lanes.segment, u)
            for u in (lanes.phase, bounds.later)
        )
        lightest, kept = np.minimum(now, later), np.ones(lanes.cell.size, dtype=bool)
        for i, sense in enumerate((1.0,) if body.one_sided else (1.0, -1.0)):
            side = sense * lanes.side
            edge = body.on(side, lanes.cell)
            unit: Any = 1.0
            pull: Any = 0.0
            press: Any = 0.0
            if held is not None:
                unit, pull, press = held.during(lanes, side, bounds.height)
            # Lemma 13: the weight, the largest -u'' at the ground (B) and the largest
            # speed (V), with what the devices add up to the highest arc.
            top = edge.theta_per_y * unit * bounds.height
            weight = lightest + press * np.cos(0.5 * top)
            inward = edge.theta_per_y * (unit * bounds.most[i] + pull)
            fastest = edge.theta_per_y * unit * bounds.fastest[i]
            kept &= body.fz_in_bounces(edge, weight, inward, fastest, top) > 0.0
        return kept

    def free(self, lanes: Lanes) -> None:
        """Test Fz at the next impact on either edge: in the free motion it is least
        there.
        """
        falls = self._open[lanes.cell] & (self.least_to_come(lanes) <= 0.0)
        self._lose(lanes.cell[falls])

    def may_settle(self, lanes: Lanes, bounced: Array) -> Array:
        """True for lanes that cannot lose the ground any more, or that have lost it
        already.
        """
        return ~self._open[lanes.cell] | (self.least_to_come(lanes) > 0.0)

    def least_to_come(self, lanes: Lanes) -> Array:
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
            (there, square * (lanes.eta * there.theta_per_y / here.theta_per_y) ** 2),
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
            if self.equation.damped:
                falls = (
                    q <= (1.0 if self.body.linear else 4.0 * np.cos(edge.alpha))
                ) & (here.theta_per_y * lanes.y <= 2.0 * here.alpha)
                fz = np.where(falls, fz, -np.inf)
            least = np.where(q > 0.0, np.minimum(least, fz), least)
        return least


def _highest(steps: Arcs) -> Array:
    """A bound of y on each step."""
    return np.asarray(steps.lanes.y + steps.reach * steps.fastest)


def _weight_bounds(steps: Arcs) -> tuple[Array, Array]:
    """(the least weight over m g, a bound of its second derivative) on each step."""
    if steps.weight is None:
        return np.ones(steps.reach.size), np.zeros(steps.reach.size)
    weight, n = steps.weight, np.arange(float(len(steps.weight.terms)))[:, None]
    sizes, powers_of_h = np.abs(weight.terms), powers(steps.reach / weight.unit, n.size)
    bends = n[2:] * (n[2:] - 1.0) * powers_of_h[: n.size - 2] / weight.unit**2
    # No weight is less than the first term less the sizes of all others.
    return (
        weight.terms[0] - summed(sizes[1:] * powers_of_h[1:]),
        summed(sizes[2:] * bends),
    )
