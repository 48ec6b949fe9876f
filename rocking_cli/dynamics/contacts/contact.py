"""The contact with the ground: where a body lifts off, the result of an impact, and the outcome of the free motion.

`symmetric`, `unequal` and `one_sided` are the contacts; `Contact` holds their common part.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import NamedTuple

import numpy as np

from ...motions.segments import Segments
from ..drive import crossing, drive_change
from ..equations.equation import Equation
from ..lanes import Cells, Lanes
from .sequences import OtherSide, sequence_ends, sequence_time

Array = np.ndarray


class Uplift(NamedTuple):
    """Uplifts of bodies at rest: segment (the number of segments if there is none), phase, side, force."""

    k: Array
    u: Array
    side: Array
    b: Array


class FreeMotion(NamedTuple):
    """Outcome of the free motion: overturns before or after an impact; the largest y to come, NaN if the body overturns."""

    overturns: Array
    overturns_after_impact: Array
    peak: Array


class Contact(ABC):
    """How a body stands on the ground. The methods here hold for equal edges and for a single one.

    alike: True if both edges are free and equal.
    """

    alike = False

    @abstractmethod
    def cells(self, equation: Equation, amplitude: Array, omega: Array, eta: Array) -> Cells:
        """The drive of each cell on its sides, from A, Omega and eta (each (cells,)). Raises ValueError if an eta is out of range."""

    @abstractmethod
    def strike(self, cells: Cells, lanes: Lanes, v: Array, b: Array) -> None:
        """Impact with velocity v <= 0 and force b, of the weight m g: set the new side, velocity and force (Eq. 2.6) of the lanes."""

    @abstractmethod
    def other_side(self, lanes: Lanes) -> OtherSide | None:
        """The side on which lanes land at their next impact; None for the same side."""

    def strongest(self, cells: Cells, segments: Segments) -> Array:
        """The motion's strongest drive of each cell over its value at uplift: above 1 the body lifts off, (cells,)."""
        return np.maximum(cells.amplitude[0] * -segments.later_min[0], cells.amplitude[-1] * segments.later_max[0])

    def uplift(self, cells: Cells, segments: Segments, cell: Array, k: Array, u: Array) -> Uplift:
        """The first uplift of bodies at rest at (k, u), on to either edge."""
        return first_uplift(segments, k, u, cells.amplitude[0, cell], cells.amplitude[-1, cell])

    def turn(self, cells: Cells, lanes: Lanes, at: Array, side: Array) -> None:
        """Put the lanes of these indices on a side: their numbers become those of the side, in its units."""
        lanes.side[at] = side

    def speed(self, side: Array, rate: Array) -> Array:
        """d(|theta|/alpha)/dtau on these sides, restated with the alpha and p of the reference, as A, Omega and results are."""
        return rate

    def sequence_ends(self, segments: Segments, lanes: Lanes, equation: Equation) -> Array:
        """True for lanes just after an impact whose sequence of impacts is proved to end in rest before any other event (Lemma 7)."""
        return sequence_ends(segments, lanes, equation, self.other_side(lanes))

    def sequence_time(self, lanes: Lanes, weight: Array | float = 1.0) -> Array:
        """Duration [tau of their side] of the sequence of impacts under the drive and the weight of now; 0 if it does not end."""
        return sequence_time(lanes, self.other_side(lanes), weight)

    def free_motion(self, equation: Equation, lanes: Lanes, at: Array, y: Array, v: Array) -> FreeMotion:
        """Outcome of undamped lanes of these indices, at y >= 0 and v when the shaking is over (Lemma 8, Eq. 2.7)."""
        lanes = lanes.take(at)
        other, here = self.other_side(lanes), equation.on(lanes.side, lanes.cell)
        there, back, unit = (here, lanes.eta, 1.0) if other is None else (equation.on(-lanes.side, lanes.cell), other.back, other.rotation)
        overturns, energy = here.fall(y, v)
        across = lanes.eta**2 * energy
        again = back**2 * across
        after = ~overturns & ((across > there.barrier) | (again > here.barrier))
        outward = np.where(v > 0.0, here.peak(energy), y)
        peak = np.maximum(np.maximum(outward, here.peak(again)), there.peak(across) * unit)
        return FreeMotion(overturns, after, np.where(overturns | after, np.nan, peak))


def first_uplift(segments: Segments, k: Array, u: Array, right: Array, left: Array) -> Uplift:
    """First instant at or after (k, u) that lifts bodies at rest: -right s > 1 on to their right edge, left s > 1 on to their left.

    right, left: amplitudes in units of each edge's uplift, 0 for an edge that does not exist. The force is 0 there unless
    the drive jumps. If the weight varies each edge has an effective motion of its own, and the earlier uplift counts.
    """
    if (weighed := segments.weighed) is not None:
        one = first_uplift(weighed.right, k, u, right, np.zeros_like(right))
        other = first_uplift(weighed.left, k, u, np.zeros_like(left), left)
        before = (one.k < other.k) | ((one.k == other.k) & (one.u <= other.u))
        return Uplift(*(np.where(before, a, b) for a, b in zip(one, other, strict=True)))
    k, u = k.copy(), u.copy()
    side, b = np.ones(k.shape), np.zeros(k.shape)
    last = len(segments)
    waiting = np.arange(k.size)
    while waiting.size:
        here = np.minimum(k[waiting], last - 1)
        over = (k[waiting] >= last) | (
            np.maximum(left[waiting] * segments.later_max[here], right[waiting] * -segments.later_min[here]) <= 1.0
        )
        k[waiting[over]] = last
        waiting = waiting[~over]
        kk, uu = k[waiting], u[waiting]
        s_now = segments.s_start[kk]
        inside = np.flatnonzero(uu > 0.0)
        s_now[inside] += drive_change(segments, kk[inside], uu[inside])
        s_end = segments.s_end[kk]
        push_now = np.where(s_now > 0.0, left[waiting], right[waiting]) * np.abs(s_now)
        a_end = np.where(s_end > 0.0, left[waiting], right[waiting])
        now = push_now > 1.0
        later = ~now & (a_end * np.abs(s_end) > 1.0)
        hit = np.flatnonzero(now)
        side[waiting[hit]] = -np.sign(s_now[hit])
        b[waiting[hit]] = push_now[hit] - 1.0
        hit = np.flatnonzero(later)
        side[waiting[hit]] = -np.sign(s_end[hit])
        u[waiting[hit]] = np.maximum(uu[hit], crossing(segments, kk[hit], np.sign(s_end[hit]) / a_end[hit]))
        waiting = waiting[~(now | later)]
        with np.errstate(divide="ignore"):
            k[waiting] = segments.next_beyond(k[waiting] + 1, 1.0 / left[waiting], 1.0 / right[waiting])
        u[waiting] = 0.0
    return Uplift(k, u, side, b)
