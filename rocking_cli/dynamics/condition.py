"""The condition of a cell: by how much its largest rotation takes over the errors of
the march. The march carries it along.

Every step adds an independent error to y and to y', which the last terms of its series
bound. The errors move with the body. The march on arrays carries their second moments
M = [yy, yv; yv, vv], in units of the tolerance; that on floats lets every unit of tau
add errors of one unit:

- along an arc of duration h, y'' = f(y), by the flow of the error, with r^2 = df/dy:
  J = [cosh r h, sinh(r h)/r; r sinh r h, cosh r h], M -> J M J^T
- through an impact, which an error dy delays by D = dy/|v|: with b before it, b+ after
  it and the ratio e of the speeds, dy+ = -e dy and dv+ = -e dv - (e b + b+) D
- at rest nothing is left of them, since the next uplift depends on the drive alone

The condition is sqrt(yy) at the largest peak, in theta/alpha. Where two impacts follow
each other at once M stays finite: no speed below `_SLOWEST` counts.
"""

from typing import Any

import numpy as np

from ..arrays import Array
from .equations.equation import Equation

_SLOWEST = 1e-6  # speed: an error of y of its square may lead past such an impact
_LARGEST = 1e100  # moments stay below it, so that none overflows
STEEP = 1e-6  # least df/dy of which a root is taken
_TINY = 1e-300  # an arc without duration has a mean force too
_STEP = 1e-6  # change of y for a derivative by differences

Moments = tuple[Any, Any, Any]  # yy, yv and vv


def along(
    m: Moments, grow: Any, h: Any, rate: Any, lost: Any = 1.0, error: Any = None
) -> Moments:
    """Return the moments after an arc of duration h [tau], with the errors that it
    adds, half at its start; grow: exp(rate h), rate: root of df/dy, lost: the part of
    an error that damping leaves, error: that of the step, None for one unit in every
    unit of tau. Arrays or floats.
    """
    half = 0.5 * h if error is None else 0.5 * error * error
    yy, yv, vv = m[0] + half, m[1], m[2] + half
    shrunk = 1.0 / grow
    c, s = 0.5 * lost * (grow + shrunk), 0.5 * lost * (grow - shrunk)
    t, s = rate * s, s / rate
    # J M, then (J M) J^T
    a, b, d, e = c * yy + s * yv, c * yv + s * vv, t * yy + c * yv, t * yv + c * vv
    return a * c + b * s + half, a * t + b * c, d * t + e * c + half


def through_impact(
    m: Moments, before: tuple[Any, Any], after: tuple[Any, Any], pace: Any
) -> Moments:
    """Return the moments after an impact; before, after: (v, b), arrays or floats;
    pace: duration of a unit of tau before it, in units after it.
    """
    (v, b), (v_after, b_after) = before, after
    delay = 1.0 / np.maximum(np.abs(v), _SLOWEST)
    turn = v_after * delay
    p, q = turn * pace, (turn * b + b_after * pace) * delay
    yy, yv, vv = m
    found = (
        p * p * yy,
        p * (q * yy + turn * yv),
        q * q * yy + 2.0 * q * turn * yv + turn * turn * vv,
    )
    yy, yv, vv = (np.clip(x, -_LARGEST, _LARGEST) for x in found)
    return yy, yv, vv


def moved(
    moments: Array, h: Array, slope: Array | float, damping: float, error: Array
) -> Array:
    """Return the moments of lanes, (3, lanes), after arcs of duration h [tau]; slope:
    df/dy on them; error: that of the step, over the tolerance.
    """
    rate = np.sqrt(np.maximum(slope, STEEP) + damping * damping)
    lost = np.exp(-damping * h) if damping else 1.0
    m = moments[0], moments[1], moments[2]
    return np.array(along(m, np.exp(rate * h), h, rate, lost, error))


def slope_between(
    equation: Equation, start: tuple[Any, Any], end: tuple[Any, Any], h: Any
) -> Any:
    """Return df/dy in the middle of arcs of duration h between two states (y, v);
    arrays or floats.
    """
    y, v = 0.5 * (start[0] + end[0]), 0.5 * (start[1] + end[1])
    force = (end[1] - start[1]) / (h + _TINY) + 2.0 * equation.damping * v
    return equation.slope(y, force)


def at_free_peak(moments: Array, y: Array, v: Array, peak: Any) -> Array:
    """Return the second moment of the peak that bodies have from the state (y, v) on,
    by differences; moments: (3, lanes); peak: function of (y, v).
    """
    here = peak(y, v)
    # A body that overturns by the difference is as sensitive as one can see.
    by_y, by_v = (
        np.nan_to_num((there - here) / _STEP, nan=1.0 / _STEP)
        for there in (peak(y + _STEP, v), peak(y, v + _STEP))
    )
    yy, yv, vv = moments
    return np.asarray(by_y * by_y * yy + 2.0 * by_y * by_v * yv + by_v * by_v * vv)
