"""Short Taylor series under straight lines: from one sample of a record to the next, with as many terms as that takes.

Under a drive a + r h the terms of y come from an equation's recurrence (`ramp_terms`). They fall like (g h)^n/n!, so that their number
is known beforehand: it follows from a lane's own numbers, and the terms beyond it are zero, so that no digit depends on its neighbours.
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
# The error of a step, in the velocity by tau, is this part of the tolerance: under a record, which strikes a body a hundred times, an error
# grows further than under a pulse (`taylor.LOCAL`).
WITHIN = 1e-2 * LOCAL
_LEAST = 1e-3  # tau: the unit of what has come to the end of its line
_GROWTH = 1.3  # g for what is not far beyond the barrier; where it is more, the last terms show it
_ROOM = 0.1  # part of the error allowed to a step that the first term left out may come to by this estimate


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
    """Size of the last two terms of each lane, by which the error is judged: at most `WITHIN` times tolerance and unit, (lanes,); last:
    where the last one stands in the terms, row after row."""
    flat = terms.ravel()
    size = np.abs(flat.take(last - unit.size))
    size *= unit
    size *= 0.25
    size += np.abs(flat.take(last))
    return size


def ramp_flow(equation: Equation, segments: Segments, lanes: Lanes) -> TaylorSeries:
    """The series of lanes under straight lines, good to the end of their line or for `LONGEST`."""
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
    """The series of lanes under ramps, whose factors are found here."""
    unit = ramp.unit
    size = 2.0 + np.abs(ramp.drive) + np.abs(v) + np.abs(ramp.gain) / unit
    if ramp.weight is not None:
        size += np.abs(ramp.weight[0]) + np.abs(ramp.weight[1]) / unit
    degree = degrees(size, unit, equation.tolerance)
    terms = equation.ramp_terms(y, v, ramp._replace(factors=factors_for(unit, degree)))
    with np.errstate(divide="ignore"):
        short = (WITHIN * equation.tolerance * unit / last_terms(terms, degree * unit.size + np.arange(unit.size), unit)) ** (
            1.0 / (degree - 1.0)
        )
    if ramp.weight is not None:  # turns are isolated by coefficients that depend on their number, and no digit may on a lane's neighbours
        terms = np.concatenate([terms, np.zeros((MOST_TERMS + 1 - len(terms), unit.size))])
    return TaylorSeries(terms, unit, np.minimum(short, 1.0) * unit, np.full(unit.shape, _GROWTH), equation.damping)
