"""Sequences of impacts (Lemma 7): those that end in rest before any other event and their duration, those that last until the shaking is
over, and those that take more steps than the march allows."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ...motions.segments import Segments
from ..arrays import Arrays
from ..drive import drive_change
from ..equations.equation import Equation
from ..lanes import Lanes

Array = np.ndarray

# With (nearly) no loss at impacts a sequence (nearly) never ends: a speed and a height below these are rest to every digit of theta/alpha.
BELOW_ROUNDING, LOWEST = 1e-12, 1e-16
_HARDLY_LOSES = 1.0 - 1e-6  # part of the speed that such a cycle keeps
_EVERY = 32  # steps of a lane from one test to the next
_SHARES = (0.003, 0.01, 0.03, 0.1, 0.25, 0.5)  # of the rest of the segment: ends of the stretches that bounces fill


@dataclass
class OtherSide(Arrays):
    """The side of the next arc, in units of this one: its outward drive is -drive a, its time `time` times that of the same arc here.

    eta, back: speed after over before an impact on leaving this side and the other; a cycle keeps their product. rotation:
    |theta|/alpha of y = 1 there over that here.
    """

    drive: Array | float
    time: Array | float
    eta: Array
    back: Array
    rotation: Array | float


def sequence_ends(segments: Segments, lanes: Lanes, equation: Equation, there: OtherSide | None) -> Array:
    """True for lanes for which Lemma 7 holds and no arc rises above the lane's peak so far, (lanes,)."""
    v, keeps = lanes.v, lanes.eta if there is None else there.eta * there.back
    slow = np.flatnonzero((lanes.b < 0.0) & ((v * v < 0.05 * lanes.b * lanes.b) | (v < BELOW_ROUNDING)))
    gap = np.zeros(v.shape)
    gap[slow] = np.minimum(*_forces(segments, lanes.take(slow), None if there is None else there.take(slow)))
    proved = (keeps > _HARDLY_LOSES) & (v < BELOW_ROUNDING) & (0.5 * v * v < LOWEST * gap)
    at = np.flatnonzero((gap > 0.0) & (v * v < 0.05 * gap * gap) & (keeps < 1.0))
    room = segments.length[lanes.k[at]] - lanes.u[at]  # a trial is longer than 3 v / (1 - q) / (1 - a)
    at = at[3.0 * v[at] * lanes.omega[at] < room * (1.0 - keeps[at]) * -lanes.b[at]]
    if at.size:
        proved[at] |= _ends(segments, lanes.take(at), equation, None if there is None else there.take(at), keeps[at])
    return proved


def _ends(segments: Segments, lanes: Lanes, equation: Equation, there: OtherSide | None, q: Array) -> Array:
    """The same for lanes whose sequence may be short enough."""
    k, v = lanes.k, lanes.v
    n, r, rotation = (0.0, 1.0, 1.0) if there is None else (there.eta, there.time, there.rotation)
    here, beyond = _forces(segments, lanes, there)
    scale = 2.0 * v / (1.0 - q)
    trial = 1.5 * scale * (1.0 / here + n * r / beyond)
    later = np.minimum(lanes.u + lanes.omega * trial, segments.length[k])
    then, beyond_then = _forces(segments, lanes, there, later)
    with np.errstate(invalid="ignore", divide="ignore"):
        grows, grows_there = then / here, 1.0 if there is None else beyond_then / beyond
        if (weighed := segments.weighed) is None:  # the force grows on one side only
            growth = np.sqrt(np.where(then < here, grows_there, grows))
            gains, gained = np.where(then < here, growth, 1.0), np.where(then < here, 1.0, growth)  # of the arcs here and there
            heaviest: Array | float = 1.0
        else:
            gains = gained = growth = np.sqrt(np.maximum(grows, 1.0 / grows) * np.maximum(grows_there, 1.0 / grows_there))
            most = np.maximum(weighed.vertical.s_start[k], weighed.vertical.s_end[k])
            heaviest = np.maximum(1.0, 1.0 + weighed.sway(lanes.side, lanes.amplitude) * most)
    here, beyond = np.minimum(here, then), np.minimum(beyond, beyond_then)
    height = v * v * np.maximum(gains * gains / here, (n * gained) ** 2 / beyond)  # while y and damping take less than half the force
    extra = equation.on(lanes.side, lanes.cell).gain * heaviest * height + 2.0 * equation.damping * growth * v * np.maximum(1.0, n)
    ends = (later < segments.length[k]) & (here > 0.0) & (beyond > 0.0) & (extra < 0.5 * np.minimum(here, beyond))
    lasts = scale * (gains / (here - extra) + n * r * gained / (beyond - extra))
    return np.asarray(ends & (lasts <= trial) & (np.maximum(1.0, rotation) * height <= lanes.peak))


def _forces(segments: Segments, lanes: Lanes, there: OtherSide | None, u: Array | None = None) -> tuple[Array, Array]:
    """Inward force on bodies at the ground on this side and on the other (infinite without one): now, or at phase u of the segment."""
    if (weighed := segments.weighed) is not None:
        here = -lanes.b if u is None else 1.0 - weighed.net(lanes.side, lanes.amplitude, lanes.k, u)
        if there is None:
            return here, np.full(here.shape, np.inf)
        return here, 1.0 - weighed.net(-lanes.side, lanes.amplitude * there.drive, lanes.k, lanes.u if u is None else u)
    drive = 1.0 + lanes.b
    if u is not None:
        outward = -lanes.side * lanes.amplitude
        drive = drive + outward * (drive_change(segments, lanes.k, u) - drive_change(segments, lanes.k, lanes.u))
    return 1.0 - drive, np.full(drive.shape, np.inf) if there is None else 1.0 + there.drive * drive


def sequence_time(lanes: Lanes, there: OtherSide | None, weight: Array | float = 1.0) -> Array:
    """The sum of the series of arcs under a constant drive and weight [tau]; 0 if it does not end."""
    if there is None:
        return 2.0 * lanes.v / (1.0 - lanes.eta) / -lanes.b
    drive, keeps = weight + lanes.b, there.eta * there.back
    ends = (lanes.v > 0.0) & (keeps < 1.0)
    total = 2.0 * lanes.v / (1.0 - keeps) * (1.0 / (weight - drive) + there.eta * there.time / (weight + there.drive * drive))
    return np.where(ends, total, 0.0)


def settles(segments: Segments, lanes: Lanes) -> Array:
    """True for lanes just after an impact that bounce or rest until the shaking is over and never rise above their peak: undamped linear
    oscillators with equal edges (Lemma 7 (a))."""
    drive, ends = 1.0 + lanes.b, -lanes.side * lanes.amplitude * segments.s_end[lanes.k]
    left = 1.0 - np.maximum(np.maximum(np.abs(drive), np.abs(ends)), lanes.amplitude * segments.largest_later[lanes.k])
    variation = np.abs(ends - drive) + lanes.amplitude * segments.variation[lanes.k]
    with np.errstate(over="ignore", divide="ignore", invalid="ignore"):
        fastest = lanes.v * lanes.v * np.exp(4.0 / 3.0 * variation / left)
        return np.asarray((left > 0.0) & (fastest <= 0.75 * left * left) & (fastest <= 1.5 * left * lanes.peak))


def outlasts(segments: Segments, lanes: Lanes, equation: Equation, most: int) -> Array:
    """True for lanes with equal sides, just after an impact, that need more than `most` steps (Lemma 7 (b)).

    G^2 is the last over the first force on the side whose force grows, G'^2 on the other. A sequence ends early only within the segment:
    with a speed below (1 - eta^2) M times the time left, M the largest 1 - |a|, or below rounding. `most` impacts leave eta^most v/G'.
    """
    found = np.zeros(lanes.v.shape, dtype=bool)
    at = np.flatnonzero((lanes.steps % _EVERY == 0) & (lanes.v > 0.0) & (lanes.y == 0.0) & (lanes.b < 0.0) & (lanes.b > -2.0))
    kept = lanes.eta[at] ** most
    at, kept = at[kept > 0.0], kept[kept > 0.0]  # others have come to rest by then
    if not at.size or equation.damping:
        return found
    k, u, v, eta, a0 = lanes.k[at], lanes.u[at], lanes.v[at], lanes.eta[at], 1.0 + lanes.b[at]
    left, gain = segments.length[k] - u, equation.on(lanes.side[at], lanes.cell[at]).gain
    outward, now = -lanes.side[at] * lanes.amplitude[at], drive_change(segments, k, u)
    begins = a0 + outward * (drive_change(segments, k, u + _SHARES[0] * left) - now)
    for share, to in pairwise(_SHARES):
        ends = a0 + outward * (drive_change(segments, k, u + to * left) - now)
        rises, here, there = ends > a0, (1.0 - ends) / (1.0 - a0), (1.0 + ends) / (1.0 + a0)
        fastest, slowest = v * np.sqrt(np.where(rises, there, here)), v * kept * np.sqrt(np.where(rises, here, there))
        least, first = 1.0 - np.maximum(np.abs(begins), np.abs(ends)), 1.0 - np.abs(a0)
        most_force = np.where(a0 * ends > 0.0, np.maximum(first, 1.0 - np.abs(ends)), 1.0)  # of the weaker side, until the stretch ends
        many = (to - share) * left / lanes.omega[at] * (0.5 * least) / (2.0 * fastest) > most
        goes_on = np.where(eta < 1.0, 3.0 * slowest * lanes.omega[at] > (1.0 - eta * eta) * left * most_force, True)
        goes_on &= slowest > BELOW_ROUNDING
        gap = np.minimum(least, first)
        found[at] |= (gap > 0.0) & (20.0 * gain * fastest**2 < gap**2) & many & goes_on
        begins = ends
    return found
