"""Bounds of the energy after the shaking, for amplitudes at which the first arc outlasts the shaking.

This holds for the undamped linear oscillator on equal edges, under motions whose first segment lifts it at any amplitude (Lemma 10 of
`dynamics`). From uplift at psi to the end T of the shaking the body has no impact, so both of its modes are known at T:

    z = y - 1 + v = A Z - exp(T - psi),      Z = int exp(T - t) s dt from psi to T = dz/dA,      s outwards
    x = v + 1 - y = A X + exp(psi - T),      X = int exp(t - T) s dt from psi to T = dx/dA

since A s = 1 at psi. The energy is 1 + z x: if z < 0 the body falls back, and overturns after its impact if z x > 1/eta^2 - 1.
psi decreases with A, so Z and X grow, and z and x are convex. The ends of a stretch of amplitudes therefore bound all four over the
stretch, and so z x and its slope Z x + X z. A stretch whose bounds do not exclude a change is cut in two.
"""

from typing import NamedTuple

import numpy as np

from ..dynamics.contacts.contact import first_uplift
from ..dynamics.drive import segment_value, summed
from ..motions.segments import Segments
from .amplitudes import ScanGrid

Array = np.ndarray

_ROUNDING = 1e-12  # bound of rounding errors, relative to the terms of z and x; a sum over ten segments loses a hundredth of it


class Modes(NamedTuple):
    """z and x at the end of the shaking, their derivatives by A, and bounds of the rounding errors of z and x; arrays of one shape."""

    z: Array
    x: Array
    z_slope: Array
    x_slope: Array
    z_noise: Array
    x_noise: Array


def modes_at_end(segments: Segments, amplitude: Array, omega: Array) -> Modes:
    """The modes at the end of bodies that lift off on the first segment and have no impact until then; amplitude, omega: (lanes,)."""
    first = first_uplift(segments, np.zeros(amplitude.size, dtype=np.int64), np.zeros(amplitude.size), amplitude, amplitude)
    z_slope, x_slope = np.zeros(amplitude.size), np.zeros(amplitude.size)
    end = segments.start[-1] + segments.length[-1]
    with np.errstate(over="ignore", invalid="ignore"):
        for k in range(len(segments)):
            at = np.full(amplitude.size, k)
            begin = first.u if k == 0 else np.zeros(amplitude.size)
            lasts, left = (segments.length[k] - begin) / omega, (end - segments.start[k] - begin) / omega
            for slope, sense in ((z_slope, 1.0), (x_slope, -1.0)):
                there = bounded_response(segments, at, segments.length[at], omega, sense) * np.exp(-sense * lasts)
                slope += np.exp(sense * left) * (there - bounded_response(segments, at, begin, omega, sense))
        z_slope *= -first.side
        x_slope *= -first.side
        left = (end - segments.start[0] - first.u) / omega
        z, x = amplitude * z_slope - np.exp(left), amplitude * x_slope + np.exp(-left)
        z_noise, x_noise = (_ROUNDING * (1.0 + amplitude) * np.exp(left)), _ROUNDING * (1.0 + amplitude)
    return Modes(z, x, z_slope, x_slope, z_noise, x_noise)


def bounded_response(segments: Segments, k: Array, u: Array, omega: Array, sense: float) -> Array:
    """Return the bounded solution g of dg/dtau - sense g = s at phase u of segment k; sense is 1 or -1. exp(-sense tau) g is then an
    antiderivative of exp(-sense tau) s."""
    _, sin, cos = segment_value(segments, k, u)
    w = segments.frequency.take(k, axis=1) * omega
    level = segments.s_start[k] - summed(segments.sin.take(k, axis=1))
    rate = segments.slope[k] * omega
    return -sense * (level + segments.slope[k] * u) - rate - summed((sense * sin + w * cos) / (1.0 + w * w))


def undecided(segments: Segments, grid: ScanGrid, omegas: Array, eta: float, row: Array, low: Array, high: Array) -> Array:
    """Return (gaps, 2): row and lower scan point of each gap between neighbouring scan points in which the outcome may change, for bodies
    that fall back after the shaking. row, low, high: rows, and the scan points between which to look."""
    found = [np.zeros((0, 2), dtype=np.int64)]
    at = np.flatnonzero(low < high)
    row, low, high = row[at], low[at], high[at]
    one, other = (modes_at_end(segments, grid.amplitude(point), omegas[row]) for point in (low, high))
    while row.size:
        at = np.flatnonzero(may_change(one, other, grid.amplitude(high) - grid.amplitude(low), eta))
        narrow = high[at] - low[at] == 1
        found.append(np.column_stack([row[at[narrow]], low[at[narrow]]]))
        at = at[~narrow]
        middle = (low[at] + high[at]) // 2
        between = modes_at_end(segments, grid.amplitude(middle), omegas[row[at]])
        one = Modes(*(np.concatenate([x[at], y]) for x, y in zip(one, between, strict=True)))
        other = Modes(*(np.concatenate([y, x[at]]) for x, y in zip(other, between, strict=True)))
        row, low, high = np.tile(row[at], 2), np.concatenate([low[at], middle]), np.concatenate([middle, high[at]])
    return np.concatenate(found)


def may_change(one: Modes, other: Modes, width: Array, eta: float) -> Array:
    """True if the outcome of bodies that fall back after the shaking may change between two amplitudes, `width` apart; (lanes,)."""
    least = 1.0 / eta**2 - 1.0 if eta else np.inf  # z x from which the energy after the impact is sufficient
    with np.errstate(over="ignore", invalid="ignore"):
        z = _convex(one.z, other.z, one.z_slope, other.z_slope, width, np.maximum(one.z_noise, other.z_noise))
        x = _convex(one.x, other.x, one.x_slope, other.x_slope, width, np.maximum(one.x_noise, other.x_noise))
        z_slope = one.z_slope - one.z_noise, other.z_slope + other.z_noise
        x_slope = one.x_slope - one.x_noise, other.x_slope + other.x_noise
        lowest, highest = _product(z, x)
        falls, rises = (one_way + other_way for one_way, other_way in zip(_product(z_slope, x), _product(x_slope, z), strict=True))
        clear = (lowest > least) | (highest < least)
        over = [m.z * m.x - least for m in (one, other)]
        noise = [m.z_noise * (1.0 + np.abs(m.x)) + m.x_noise * np.abs(m.z) for m in (one, other)]
        alike = (over[0] * over[1] > 0.0) & (np.abs(over[0]) > noise[0]) & (np.abs(over[1]) > noise[1])
    return ~(clear | (alike & ((falls > 0.0) | (rises < 0.0))))


def _convex(one: Array, other: Array, slope: Array, end_slope: Array, width: Array, noise: Array) -> tuple[Array, Array]:
    """(lower, upper) bound of a convex function, from its values and slopes at both ends."""
    bottom = np.where(slope >= 0.0, one, np.where(end_slope <= 0.0, other, one + slope * width))
    return bottom - noise, np.maximum(one, other) + noise


def _product(one: tuple[Array, Array], other: tuple[Array, Array]) -> tuple[Array, Array]:
    """(lower, upper) bound of a product, from the bounds of its factors."""
    corners = [a * b for a in one for b in other]
    return np.minimum.reduce(corners), np.maximum.reduce(corners)
