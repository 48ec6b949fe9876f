"""Taylor series of each lane's motion. The last terms of a series give the length of
its step, so no step is rejected. Impacts and peaks are roots of the series.
"""

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ...errors import ArgumentError
from ...motions.blocks import blocks
from ...motions.segments import Segments
from ..drive import segment_value
from ..lanes import Arrays, Lanes
from .recurrence import Recurrence, TermRows, motion_terms

# Allowed error of a step, in y', over the tolerance: errors double every 0.7 in tau,
# and grow by a factor of tens under a pulse.
LOCAL = 3e-2
CACHED = 4096  # lanes for which the recurrences stay in the second-level cache
LOWEST, HIGHEST = 1e-13, 1e-2  # range of tolerances
LONGEST = 1.0  # tau: a series of `MOST_TERMS` holds any tolerance up to it
MOST_TERMS = 24
# 1/((n + 1)(n + 2)), by which term n + 2 of y follows from term n of y''
RECIPROCALS = [1.0 / ((n + 1) * (n + 2)) for n in range(2 * MOST_TERMS)]
# error of a step, in y', over the tolerance: after a hundred impacts it has grown
# further than under a pulse
WITHIN = 1e-2 * LOCAL
# replaces x = 0, since derivatives are computed as n (n - 1) ... c_n x^n / x^d
_TINY = 1e-90


class Instant(NamedTuple):
    """State of lanes at an instant of an arc. Every array is (lanes,)."""

    y: Array  # displacement, in the unit of the side
    v: Array  # velocity y', by tau
    b: Array  # acceleration y'', by tau
    j: Array  # jerk y''', by tau


class Drive(NamedTuple):
    """The shaking of lanes: series in powers of the time over `unit`, from now on."""

    # terms of the outward drive over its value at uplift [-], (terms, lanes)
    terms: TermRows
    unit: Array  # unit of time of the series [tau], (lanes,)
    # terms of the weight over m g [-], (terms, lanes); None if it is constant
    weight: TermRows | None = None


@dataclass
class TaylorSeries(Arrays):
    """The series of each lane in powers of h / unit, with h the time from its start."""

    terms: Array  # coefficients of y, (terms, lanes)
    unit: Array  # unit of time of the series [tau], (lanes,)
    longest: Array  # longest h for which the series holds [tau], (lanes,)
    damping: Array | float = 0.0  # zeta [-], float or (lanes,)
    # bound of the error of y' after `longest`, None where the terms tell it, (lanes,)
    error: Array | None = None

    def at(self, h: Array) -> Instant:
        """y and its first three derivatives after h [tau], (lanes,)."""
        return self.point(self.over(h), h)

    def over(self, h: Array) -> Array:
        """Return the terms of y in powers of the time over h, (terms, lanes)."""
        terms = powers(np.maximum(h, _TINY) / self.unit, len(self.terms))
        terms *= self.terms
        return terms

    @staticmethod
    def point(terms: Array, h: Array) -> Instant:
        """Return the state after h, by the terms of y `over` h."""
        # NumPy sums a single lane in another order: no digit may depend on a lane's
        # neighbours
        if h.size == 1:
            terms = np.repeat(terms, 2, axis=1)
        y, v, b, j = np.einsum("dn,nl->dl", _falling_factors(len(terms)), terms)[
            :, : h.size
        ]
        over = 1.0 / np.maximum(h, _TINY)
        return Instant(y, v * over, b * over * over, j * over * over * over)


def powers(x: Array, count: int) -> Array:
    """The powers x^0 ... x^(count - 1) as rows, (count, ...)."""
    rows = np.empty((count, *x.shape), dtype=x.dtype)
    rows[0], rows[1] = 1.0, x
    have = 2
    while have < count:
        more = min(have, count - have)
        half = rows[have // 2]
        np.multiply(rows[:more], half * half, out=rows[have : have + more])
        have += more
    return rows


def product(table: Array, terms: Array) -> Array:
    """table @ terms, (rows, lanes). The order of each sum does not depend on the other
    lanes, as it would in a product of matrices.
    """
    if terms.shape[1] == 1:  # NumPy sums a single lane in another order
        return product(table, np.repeat(terms, 2, axis=1))[:, :1]
    if terms.shape[1] <= CACHED:
        return np.einsum("in,nl->il", table, terms)
    parts = [
        np.einsum("in,nl->il", table, terms[:, block])
        for block in blocks(terms.shape[1], CACHED)
    ]
    return np.concatenate(parts, axis=1)


@lru_cache(maxsize=64)
def _falling_factors(count: int) -> Array:
    """(4, count): 1, n, n (n - 1), n (n - 1)(n - 2), for n from 0."""
    n = np.arange(float(count))
    return np.array([np.ones(count), n, n * (n - 1.0), n * (n - 1.0) * (n - 2.0)])


def order_for(tolerance: float, terms: float = 0.98) -> int:
    """Number of terms of a series: -`terms` log(error of a step). Raises ArgumentError
    when the tolerance is out of range.
    """
    if not LOWEST <= tolerance <= HIGHEST:
        raise ArgumentError(
            f"tolerance: found {tolerance:g}; expected a number from {LOWEST:g} to"
            f" {HIGHEST:g}"
        )
    return max(8, math.ceil(-terms * math.log(tolerance * LOCAL)))


def drive_series(
    segments: Segments, lanes: Lanes, order: int, rate: Array | float = 1.0
) -> tuple[Drive, Array]:
    """Return (the drive of lanes up to term `order`; the rate [1/tau] of its fastest
    change, 1 over its unit).

    rate: fastest change of the body on still ground [1/tau].
    """
    weighed = segments.weighed
    if weighed is None and segments.comb is not None:
        return _comb_series(segments, segments.comb, lanes, order, rate)
    here = segment_value(segments, lanes.segment, lanes.phase)
    # The rate of the fastest change is the unit of the series: terms then fall off.
    w, *up = (
        part.frequency.take(lanes.segment, axis=1) * lanes.omega
        for part in (segments, *((weighed.vertical,) if weighed else ()))
    )
    fastest = rate + np.maximum.reduce([x.max(axis=0, initial=0.0) for x in (w, *up)])
    unit = 1.0 / fastest
    terms = np.empty((order + 1, lanes.phase.size))
    outward = -lanes.side * lanes.amplitude
    terms[0] = outward * (segments.s_start[lanes.segment] + here[0])
    _fill(terms, segments, lanes, here, outward, w, unit)
    if weighed is None:
        return Drive(TermRows.from_array(terms), unit), fastest
    # The weight over m g is a series in the same powers: 1 + sway s_v.
    rows, vertical = np.empty(terms.shape), weighed.vertical
    sway = weighed.sway(lanes.side, lanes.amplitude)
    rise = segment_value(vertical, lanes.segment, lanes.phase)
    change = (
        rise[0]
        if vertical.table is None
        else vertical.table.change_at(lanes.segment, lanes.phase)[0]
    )
    rows[0] = 1.0 + sway * (vertical.s_start[lanes.segment] + change)
    _fill(rows, vertical, lanes, rise, sway, up[0], unit)
    return Drive(TermRows.from_array(terms), unit, TermRows.from_array(rows)), fastest


def _comb_series(
    segments: Segments, w: Array, lanes: Lanes, order: int, rate: Array | float
) -> tuple[Drive, Array]:
    """`drive_series` under many sinusoids that are the same in all pieces, of
    frequencies w, multiples of the first one: their sines and cosines are powers.
    """
    k, u = lanes.segment, lanes.phase
    angle = w[0] * u
    turns = powers(np.cos(angle) + 1j * np.sin(angle), w.size + 1)[1:]
    cos, sin = turns.real, turns.imag
    a, b = segments.sin.take(k, axis=1), segments.cos.take(k, axis=1)
    now, grows = a * cos, b * cos
    now += b * sin
    grows -= a * sin

    # term n of a sinusoid in powers of the time over `unit`, with w the fastest rate
    n = np.arange(order + 1)
    size = (w / w.max()) ** n[:, None] * (1.0 - 2.0 * (n // 2 % 2))[:, None]
    size /= np.array([float(math.factorial(i)) for i in n])[:, None]
    terms = np.empty((order + 1, u.size))
    terms[::2], terms[1::2] = product(size[::2], now), product(size[1::2], grows)
    terms[0] += segments.s_start[k] - segments.sin.sum(axis=0)[k]
    fastest = w.max() * lanes.omega
    unit = 1.0 / (rate + fastest)
    if segments.sloped:
        slope = segments.slope[k]
        terms[0] += slope * u
        terms[1] += slope / w.max()
    terms *= powers(fastest * unit, order + 1)
    terms *= -lanes.side * lanes.amplitude
    return Drive(TermRows.from_array(terms), unit), 1.0 / unit


def _fill(
    terms: Array,
    segments: Segments,
    lanes: Lanes,
    here: tuple[Array, Array, Array],
    outward: Array,
    w: Array,
    unit: Array,
) -> None:
    """Fill (terms, lanes) from row 1 on with `outward` times a motion; here: its
    `segment_value` now; w: its frequencies [1/tau].
    """
    if not len(w):
        terms[1:] = 0.0
    mine = terms
    for i, (a, b, f) in enumerate(zip(*here[1:], w, strict=True)):
        if i:
            mine = np.empty(terms.shape)
        x = f * unit
        back = x * x
        np.multiply(outward * b, x, out=mine[1])  # b sin(x) + a cos(x), term by term
        np.multiply(outward * a, back * -0.5, out=mine[2])
        for n in range(3, len(terms)):
            row = np.multiply(mine[n - 2], back, out=mine[n])
            row *= -1.0 / (n * (n - 1))
        if i:
            terms[1:] += mine[1:]
    if segments.sloped:
        terms[1] += outward * segments.slope[lanes.segment] * lanes.omega * unit


def series_flow(
    equation: Recurrence,
    segments: Segments,
    lanes: Lanes,
    order: int,
    rate: Array | float = 1.0,
) -> tuple[Array, Array]:
    """Return (the terms of y of each lane from its present state, (order + 1, lanes);
    the rate [1/tau]: they are in powers of rate h).
    """
    y, fastest = np.empty((order + 1, lanes.y.size)), np.empty(lanes.y.size)
    for block in blocks(lanes.y.size, CACHED):
        some, own = lanes.take(block), equation.part(block)
        drive, fastest[block] = drive_series(
            segments, some, order - 2, rate if isinstance(rate, float) else rate[block]
        )
        square = drive.unit * drive.unit
        factors = [square * c for c in RECIPROCALS[: order - 1]]
        y[:, block] = motion_terms(
            own,
            some.y,
            some.v,
            drive.unit,
            factors,
            drive.terms,
            drive.weight,
            some.force,
        )
    return y, fastest


def longest(terms: Array, fastest: Array, tolerance: float) -> Array:
    """The longest step [tau] that the tolerance allows. fastest: rate of the fastest
    change [1/tau]; terms: coefficients of the powers of (fastest h), (terms, lanes).
    """
    # Four terms, since one or two can be small by accident: after a jump from rest the
    # series has even powers only.
    last = np.arange(terms.shape[0] - 4.0, terms.shape[0])[:, None]
    size = np.abs(terms[-4:])
    size *= last / (LOCAL * tolerance)
    size *= fastest
    with np.errstate(divide="ignore"):
        np.log(size, out=size)
    size *= 1.0 / (1.0 - last)
    return np.minimum(np.exp(size.min(axis=0)), 4.0 * fastest) * (1.0 / fastest)
