"""Short Taylor series under straight lines, from one sample of a record to the next.

The terms of y (`Equation.ramp_terms`) fall like (g h)^n/n!, so that each lane's numbers give its number of terms. Further terms are zero:
no digit depends on a lane's neighbours.
"""

from __future__ import annotations

import numpy as np

from ...motions.segments import Segments
from ..lanes import Lanes
from .equation import Equation, Ramp
from .taylor import LOCAL, TaylorSeries

Array = np.ndarray

LONGEST = 1.0  # tau: a series of `MOST_TERMS` holds any tolerance up to it
MOST_TERMS = 24
WITHIN = 1e-2 * LOCAL  # error of a step, in y', over the tolerance: after a hundred impacts it has grown further than under a pulse
_LEAST = 1e-3  # tau: the unit of lanes at the end of their line
_GROWTH = 1.3  # g of lanes not far beyond the barrier; where it is larger, the last terms show it
_ROOM = 0.1  # largest first term left out, over the error that a step may have


def degrees(size: Array, unit: Array, tolerance: float) -> Array:
    """Degree of each lane's series; size: bound of the accelerations, and of the drive's slope, over its unit."""
    degree = np.full(unit.shape, 3, dtype=np.int64)
    reach = _GROWTH * unit
    left = 0.5 * size * reach  # what term n adds to the acceleration, n (n - 1) c_n/unit^2, over n - 1; here n = 3
    for n in range(4, MOST_TERMS + 1):
        left *= reach / (n - 1.0)
        more = left > _ROOM * WITHIN * tolerance
        if not more.any():
            break
        degree[more] = n
    return degree


def factors_for(unit: Array, degree: Array) -> Array:
    """`Ramp.factors`, as many as the largest degree takes."""
    n = np.arange(1.0, float(degree.max(initial=3)))[:, None]
    rows: Array = unit * unit / (n * (n + 1.0))
    rows[n + 1.0 > degree] = 0.0
    return rows


def last_terms(terms: Array, last: Array, unit: Array) -> Array:
    """Size of the last two terms of each lane, (lanes,), at most `WITHIN` times tolerance and unit; last: flat index of the last term."""
    flat = terms.ravel()
    size = np.abs(flat.take(last - unit.size))
    size *= unit
    size *= 0.25
    size += np.abs(flat.take(last))
    return size


def ramp_flow(equation: Equation, segments: Segments, lanes: Lanes) -> TaylorSeries:
    """The series of lanes under straight lines, to the end of their line or for `LONGEST`."""
    outward = -lanes.side * lanes.amplitude
    slope = outward * segments.slope[lanes.k]
    drive = outward * segments.s_start[lanes.k] + slope * lanes.u
    unit = np.clip((segments.length[lanes.k] - lanes.u) / lanes.omega, _LEAST, LONGEST)
    gain = slope * lanes.omega * unit
    weight = None
    if (weighed := segments.weighed) is not None:
        heavier = weighed.sway(lanes.side, lanes.amplitude) * weighed.vertical.slope[lanes.k] * lanes.omega * unit
        weight = weighed.weight(lanes.side, lanes.amplitude, lanes.k, lanes.u), heavier
    return line_series(equation, lanes.y, lanes.v, Ramp(drive, gain, unit, unit, lanes.b, weight))


def line_series(equation: Equation, y: Array, v: Array, ramp: Ramp) -> TaylorSeries:
    """The series of lanes under ramps; it finds the factors."""
    unit = ramp.unit
    size = 2.0 + np.abs(ramp.drive) + np.abs(v) + np.abs(ramp.gain) / unit
    if ramp.weight is not None:
        size += np.abs(ramp.weight[0]) + np.abs(ramp.weight[1]) / unit
    degree = degrees(size, unit, equation.tolerance)
    terms = equation.ramp_terms(y, v, ramp._replace(factors=factors_for(unit, degree)))
    last = last_terms(terms, degree * unit.size + np.arange(unit.size), unit)
    with np.errstate(divide="ignore"):
        short = (WITHIN * equation.tolerance * unit / last) ** (1.0 / (degree - 1.0))
    if ramp.weight is not None:  # the digits of turning points depend on the number of terms, which must not depend on a lane's neighbours
        terms = np.concatenate([terms, np.zeros((MOST_TERMS + 1 - len(terms), unit.size))])
    return TaylorSeries(terms, unit, np.minimum(short, 1.0) * unit, np.full(unit.shape, _GROWTH), equation.damping)
