"""What the march asks of the contact with the ground: where a body lifts off, what an impact does, when bouncing ends, and what
becomes of it after the shaking. `symmetric`, `unequal` and `one_sided` answer; what they share stands here."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from ...motions.segments import Segments
from ..arrays import Arrays
from ..drive import crossing, drive_change
from ..equations.equation import Equation
from ..lanes import Cells, Lanes
from ..weight import WeighedSegments

Array = np.ndarray

# Without loss at impacts a bounce never ends, with hardly any its end lies beyond counting; one this slow and this low is the same as rest
# to every digit of theta/alpha.
BELOW_ROUNDING, LOWEST = 1e-12, 1e-16
_HARDLY_LOSES = 1.0 - 1e-6  # what a cycle of a bounce keeps of its speed


class Uplift(NamedTuple):
    """Where bodies at rest leave the ground: segment (the number of segments where they never do), phase, side, force."""

    k: Array
    u: Array
    side: Array
    b: Array


class Fate(NamedTuple):
    """What free motion comes to: overturns before or after an impact; the largest y to come, NaN where the body overturns."""

    overturns: Array
    overturns_after_impact: Array
    peak: Array


class Contact(Protocol):
    """How a body stands on the ground."""

    @property
    def alike(self) -> bool:
        """Whether both edges are free and alike, which the bounds of an envelope ask for."""

    def cells(self, equation: Equation, amplitude: Array, omega: Array, eta: Array) -> Cells:
        """What drives each cell on its sides, from A, Omega and eta (each (cells,)). Raises ValueError when an eta is out of range."""

    def strongest(self, cells: Cells, segments: Segments) -> Array:
        """The motion's strongest drive of each cell over what lifts it: above 1 it leaves the ground, (cells,)."""

    def uplift(self, cells: Cells, segments: Segments, cell: Array, k: Array, u: Array) -> Uplift:
        """Where bodies at rest at (k, u) leave the ground."""

    def turn(self, cells: Cells, lanes: Lanes, at: Array, side: Array) -> None:
        """Put lanes on a side: what they carry becomes that side's, in its units. `at`: their indices."""

    def speed(self, side: Array, rate: Array) -> Array:
        """d(|theta|/alpha)/dtau on these sides, restated with the alpha and p of the reference, which A, Omega and results refer to."""

    def strike(self, cells: Cells, lanes: Lanes, v: Array, b: Array) -> None:
        """Impact with velocity v <= 0 and force b: the lanes' new side, velocity and force (Eq. 2.6), of the weight m g."""

    def bouncing_ends(self, segments: Segments, lanes: Lanes, equation: Equation) -> Array:
        """Lanes just after an impact whose bouncing is proved to end in rest before anything else can happen (Lemma 7)."""

    def bouncing_time(self, lanes: Lanes, weight: Array | float = 1.0) -> Array:
        """How long [tau of their side] lanes just after an impact go on bouncing under the drive and the weight of now; 0 where they do
        not end."""

    def fate(self, equation: Equation, lanes: Lanes, at: Array, y: Array, v: Array) -> Fate:
        """What becomes of the lanes of these indices, which are at y, v when the shaking is over, undamped (Lemma 8)."""


def first_uplift(segments: Segments, k: Array, u: Array, right: Array, left: Array) -> Uplift:
    """First instant at or after (k, u) that lifts bodies at rest: -right s > 1 on to their right edge, left s > 1 on to their left.

    right, left: amplitudes in units of each edge's uplift, 0 where an edge cannot be stood on. The force is 0 there unless
    the drive jumps. Where the weight varies each edge has an effective motion of its own, and the earlier uplift counts.
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


@dataclass
class Bounce(Arrays):
    """The other side of a bounce, in units of this one: its outward drive is -drive a, its speed on leaving eta times the speed
    here at the impact before, its time `time` times that of the same arc here. `eta` and `back`, on leaving this side and the
    other, make up what a cycle keeps."""

    drive: Array | float
    time: Array | float
    eta: Array
    back: Array
    higher: Array | float  # |theta|/alpha of an arc there over that of an arc of equal speed here, at least 1


def bouncing_ends(segments: Segments, lanes: Lanes, equation: Equation, there: Bounce) -> Array:
    """Lemma 7 for a body that bounces from side to side; false where an arc could rise above the lane's peak so far, (lanes,)."""
    if segments.weighed is not None:
        return bouncing_weighed(segments.weighed, lanes, equation, there)
    drive, v = 1.0 + lanes.b, lanes.v
    keeps = there.eta * there.back
    gap = np.minimum(1.0 - drive, 1.0 + there.drive * drive)
    proved = (keeps > _HARDLY_LOSES) & (v < BELOW_ROUNDING) & (0.5 * v * v < LOWEST * gap)
    maybe = np.flatnonzero((gap > 0.0) & (v * v < 0.05 * gap * gap) & (keeps < 1.0))
    room = segments.length[lanes.k[maybe]] - lanes.u[maybe]  # a trial is longer than 3 v / (1 - q) / (1 - a)
    maybe = maybe[3.0 * v[maybe] * lanes.omega[maybe] < room * (1.0 - keeps[maybe]) * (1.0 - drive[maybe])]
    if not maybe.size:
        return proved
    k, u, v, a0, q = lanes.k[maybe], lanes.u[maybe], v[maybe], drive[maybe], keeps[maybe]
    there = there.take(maybe)
    d, r, n, higher = there.drive, there.time, there.eta, there.higher
    scale = 2.0 * v / (1.0 - q)
    trial = 1.5 * scale * (1.0 / (1.0 - a0) + n * r / (1.0 + d * a0))
    a1, inside = _drive_after(segments, lanes, maybe, k, u, a0, trial)
    lowest, highest = np.minimum(a0, a1), np.maximum(a0, a1)
    here, beyond = 1.0 - highest, 1.0 + d * lowest  # the least forces on either side
    rises = a1 > a0
    growth = np.sqrt(np.where(rises, (1.0 + d * a1) / (1.0 + d * a0), (1.0 - a1) / (1.0 - a0)))
    gains, gained = np.where(rises, growth, 1.0), np.where(rises, 1.0, growth)  # of the arcs here, which lose force, and there
    height = v * v * np.maximum(gains * gains / here, (n * gained) ** 2 / beyond)  # while y and damping take less than half the force
    extra = equation.on(lanes.side[maybe], lanes.cell[maybe]).gain * height
    if equation.damping:
        extra += 2.0 * equation.damping * growth * v * np.maximum(1.0, n)
    up, down = here - extra, beyond - extra
    ends = inside & (here > 0.0) & (beyond > 0.0) & (extra < 0.5 * np.minimum(here, beyond))
    lasts = scale * (gains / up + n * r * gained / down)
    ends &= (lasts <= trial) & (higher * height <= lanes.peak[maybe])
    proved[maybe[ends]] = True
    return proved


def bouncing_weighed(segments: WeighedSegments, lanes: Lanes, equation: Equation, there: Bounce | None) -> Array:
    """Lemma 7 where the weight varies; there: the other side of a bounce, None of a body that always returns to this side."""
    b, v, side = lanes.b, lanes.v, lanes.side
    keeps = lanes.eta if there is None else there.eta * there.back
    amplitude = lanes.amplitude if there is None else lanes.amplitude * there.drive
    slow = np.flatnonzero((b < 0.0) & (v * v < 0.05 * b * b))
    gap, across = np.zeros(b.size), np.ones(b.size)  # elsewhere
    if there is not None and slow.size:
        across[slow] -= segments.net(-side[slow], amplitude[slow], lanes.k[slow], lanes.u[slow])
    gap[slow] = np.minimum(-b[slow], across[slow])
    proved = (keeps == 1.0) & (v < BELOW_ROUNDING * gap)
    at = np.flatnonzero((gap > 0.0) & (v * v < 0.05 * gap * gap) & (keeps < 1.0))
    if not at.size:
        return proved
    k, u, b, v, side, q, own = lanes.k[at], lanes.u[at], b[at], v[at], side[at], keeps[at], lanes.amplitude[at]
    n, r, other = (np.zeros(at.size), 1.0, own) if there is None else (there.eta[at], there.time, amplitude[at])
    r = np.broadcast_to(r, lanes.v.shape)[at]
    scale = 2.0 * v / (1.0 - q)
    other_gap = across[at]
    trial = 1.5 * scale * (1.0 / -b + n * r / other_gap)
    later = np.minimum(u + lanes.omega[at] * trial, segments.length[k])
    ends = later < segments.length[k]
    then = 1.0 - segments.net(side, own, k, later)
    here, most_here = np.minimum(-b, then), np.maximum(-b, then)
    then = np.ones(at.size) if there is None else 1.0 - segments.net(-side, other, k, later)
    beyond, most_beyond = np.minimum(other_gap, then), np.maximum(other_gap, then)
    with np.errstate(invalid="ignore", divide="ignore"):
        growth = np.sqrt(most_here / here * (most_beyond / beyond))
    height = (v * growth) ** 2 * np.maximum(1.0 / here, n * n / beyond)
    heaviest = 1.0 + segments.sway(side, own) * np.maximum(segments.vertical.s_start[k], segments.vertical.s_end[k])
    gain = equation.on(side, lanes.cell[at]).gain
    extra = gain * np.maximum(1.0, heaviest) * height + 2.0 * equation.damping * growth * v * np.maximum(1.0, n)
    higher = 1.0 if there is None else np.broadcast_to(there.higher, lanes.v.shape)[at]
    ends &= (here > 0.0) & (beyond > 0.0) & (extra < 0.5 * np.minimum(here, beyond))
    lasts = scale * growth * (1.0 / (here - extra) + n * r / (beyond - extra))
    proved[at[ends & (lasts <= trial) & (higher * height <= lanes.peak[at])]] = True
    return proved


def bouncing_time(lanes: Lanes, there: Bounce, weight: Array | float = 1.0) -> Array:
    """The sum of the series of arcs from side to side under a constant drive and weight."""
    drive, keeps = weight + lanes.b, there.eta * there.back
    ends = (lanes.v > 0.0) & (keeps < 1.0)
    total = 2.0 * lanes.v / (1.0 - keeps) * (1.0 / (weight - drive) + there.eta * there.time / (weight + there.drive * drive))
    return np.where(ends, total, 0.0)


def _drive_after(segments: Segments, lanes: Lanes, at: Array, k: Array, u: Array, a0: Array, trial: Array) -> tuple[Array, Array]:
    """(outward drive after `trial` [tau], whether that is inside the segment); in between the drive is monotone."""
    later = np.minimum(u + lanes.omega[at] * trial, segments.length[k])
    outward = -lanes.side[at] * lanes.amplitude[at]
    a1 = a0 + outward * (drive_change(segments, k, later) - drive_change(segments, k, u))
    return a1, later < segments.length[k]


def settled_on_one_side(segments: Segments, lanes: Lanes, equation: Equation) -> Array:
    """Lemma 7 for a body that always returns to the same side: 2 v / (1 - eta) / (1 - a_+ - e), and any inward drive holds it."""
    if segments.weighed is not None:
        return bouncing_weighed(segments.weighed, lanes, equation, None)
    drive, v, eta = 1.0 + lanes.b, lanes.v, lanes.eta
    gap = 1.0 - drive
    ends = np.zeros(v.shape, dtype=bool)
    maybe = np.flatnonzero((gap > 0.0) & (v * v < 0.05 * gap * gap) & (eta < 1.0))
    k, u, v, a0 = lanes.k[maybe], lanes.u[maybe], v[maybe], drive[maybe]
    scale = 2.0 * v / (1.0 - eta[maybe])
    trial = 1.5 * scale / (1.0 - a0)
    a1, inside = _drive_after(segments, lanes, maybe, k, u, a0, trial)
    margin = 1.0 - np.maximum(a0, a1)
    fastest = v * np.sqrt(np.maximum(1.0, (1.0 - a1) / (1.0 - a0)))
    gain = equation.on(lanes.side[maybe], lanes.cell[maybe]).gain
    height = gain * fastest * fastest / margin
    extra = height + 2.0 * equation.damping * fastest
    sure = inside & (margin > 0.0) & (extra < 0.5 * margin) & (scale <= trial * (margin - extra))  # arcs that gain speed are shorter
    ends[maybe[sure & (height <= gain * lanes.peak[maybe])]] = True
    return ends


def free_motion(equation: Equation, lanes: Lanes, at: Array, y: Array, v: Array) -> Fate:
    """Lemma 8 where the next side is like this one: after the next peak and impact nothing larger comes, since eta <= 1.

    at: indices of lanes; y >= 0, v: at the end of the shaking, of these lanes.
    """
    eta, own = lanes.eta[at], equation.on(lanes.side[at], lanes.cell[at])
    overturns, energy = own.fall(y, v)
    rebound = eta * eta * energy
    after = ~overturns & (rebound > own.barrier)
    peak = np.full(np.shape(y), np.nan)
    stays = np.flatnonzero(~(overturns | after))
    out = v[stays] > 0.0  # the next peak is the higher one
    own = equation.on(lanes.side[at[stays]], lanes.cell[at[stays]])
    top = own.crest(np.where(out, energy[stays], rebound[stays]))
    peak[stays] = np.where(out, top, np.maximum(y[stays], top))
    return Fate(overturns, after, peak)
