"""The condition of a cell: by how much its largest rotation takes over the errors of
the march. The march carries it along.

Every step adds an error to y', which the last terms of its series bound, and that
times its duration to y. The errors move with the body. The march carries their second
moments M = [yy, yv; yv, vv], in units of the tolerance. On arrays a step adds its
errors to the roots of yy and vv: the errors of the short steps under a record have the
same sign for long. On floats every unit of tau adds independent errors of one unit.

- along an arc of duration h, y'' = f(y), by the flow of the error, with r^2 = df/dy:
  J = [cosh r h, sinh(r h)/r; r sinh r h, cosh r h], M -> J M J^T; of cos and sin where
  df/dy is negative, as under stiff restraints
- through an impact, which an error dy delays by D = dy/|v|: with b before it, b+ after
  it and the ratio e of the speeds, dy+ = -e dy and dv+ = -e dv - (e b + b+) D
- at rest nothing is left of them, since the next uplift depends on the drive alone;
  but a drive that lifts the body again at once does so with that delay

The condition is sqrt(yy) at the largest peak, in theta/alpha. Where two impacts follow
each other at once M stays finite: no speed below `_SLOWEST` counts.
"""

import math
from typing import Any

import numpy as np

from ..arrays import Array

_SLOWEST = 1e-6  # speed: an error of y of its square may lead past such an impact
_LARGEST = 1e100  # moments stay below it, so that none overflows
STEEP = 1e-6  # least df/dy of which a root is taken
_TINY = 1e-300  # an arc without duration has a mean force too
# The error of a step is at most so many times its last terms, and a rounding, which
# takes in that of the drive.
_SAFETY, _ROUNDING = 3.0, 1e-14
STEP = 1e-6  # change of y for a derivative by differences

ErrorMoments = tuple[Any, Any, Any]  # yy, yv and vv


def along(m: ErrorMoments, h: float, slope: float, damping: float) -> ErrorMoments:
    """Return the moments after an arc of duration h [tau], which adds errors of one
    unit in every unit of tau; slope: df/dy on it.
    """
    half, square = 0.5 * h, slope + damping * damping
    lost = math.exp(-damping * h)
    rate = math.sqrt(max(abs(square), STEEP))
    if square < 0.0:
        c, s = lost * math.cos(rate * h), lost * math.sin(rate * h)
        flow = c, s / rate, -rate * s
    else:
        grow = math.exp(rate * h)
        c, s = 0.5 * lost * (grow + 1.0 / grow), 0.5 * lost * (grow - 1.0 / grow)
        flow = c, s / rate, rate * s
    yy, yv, vv = _by_flow((m[0] + half, m[1], m[2] + half), flow)
    return yy + half, yv, vv + half


def _by_flow(m: ErrorMoments, flow: tuple[Any, Any, Any]) -> ErrorMoments:
    """The moments after the flow J = [c, s; t, c]."""
    (c, s, t), (yy, yv, vv) = flow, m
    # J M, then (J M) J^T
    a, b, d, e = c * yy + s * yv, c * yv + s * vv, t * yy + c * yv, t * yv + c * vv
    return a * c + b * s, a * t + b * c, d * t + e * c


def through_impact(
    m: ErrorMoments, before: tuple[Any, Any], after: tuple[Any, Any], pace: Any
) -> ErrorMoments:
    """Return the moments after an impact; before, after: (v, b), arrays or floats;
    pace: duration of a unit of tau before it, in units after it.
    """
    (v, b), (v_after, b_after) = before, after
    one = isinstance(v, float)
    delay = 1.0 / (max(abs(v), _SLOWEST) if one else np.maximum(np.abs(v), _SLOWEST))
    turn = v_after * delay
    p, q = turn * pace, (turn * b + b_after * pace) * delay
    yy, yv, vv = m
    found = (
        p * p * yy,
        p * (q * yy + turn * yv),
        q * q * yy + 2.0 * q * turn * yv + turn * turn * vv,
    )
    if one:
        yy, yv, vv = (min(max(x, -_LARGEST), _LARGEST) for x in found)
    else:
        yy, yv, vv = (np.clip(x, -_LARGEST, _LARGEST) for x in found)
    return yy, yv, vv


def lifted_at_once(vv: Any, before: tuple[Any, Any], after: tuple[Any, Any]) -> Any:
    """Return the moment vv of bodies that come to rest at an impact and are lifted at
    once; vv: after the impact; before, after: (force, Omega) on the edge that the
    impact leads to and on that of the uplift, arrays or floats.
    """
    (force, omega), (lift, lift_omega) = before, after
    turn = lift * omega / (np.where(force == 0.0, np.inf, force) * lift_omega)
    return np.minimum(vv * turn * turn, _LARGEST)


def moved(
    moments: Array, h: Array, slope: Array | float, damping: Array | float, error: Array
) -> Array:
    """Return the moments of lanes, (3, lanes), after arcs of duration h [tau]; slope:
    df/dy on them; error: that of the step, over the tolerance.
    """
    square = np.broadcast_to(slope + damping * damping, h.shape)
    rate = np.sqrt(np.maximum(np.abs(square), STEEP))
    grow = np.exp(rate * h)
    shrunk = 1.0 / grow
    c, s = 0.5 * (grow + shrunk), 0.5 * (grow - shrunk)
    t = rate * s
    swings = np.flatnonzero(square < 0.0)
    if swings.size:
        angle = (rate * h)[swings]
        c[swings], s[swings] = np.cos(angle), np.sin(angle)
        t[swings] = -(rate * s)[swings]
    if np.any(damping):
        lost = np.exp(-damping * h)
        c, s, t = c * lost, s * lost, t * lost
    yy, yv, vv = _by_flow(rows(moments), (c, s / rate, t))
    y, v = np.sqrt(np.maximum(yy, 0.0)), np.sqrt(np.maximum(vv, 0.0))
    more_y, more_v = y + error * h, v + error
    return np.array([more_y * more_y, yv + more_y * more_v - y * v, more_v * more_v])


def rows(moments: Array) -> ErrorMoments:
    """Return yy, yv and vv of lanes."""
    return moments[0], moments[1], moments[2]


def in_tolerances(error: Any, stated: float) -> Any:
    """Return a bound of the error of steps with these last terms, arrays or floats,
    over the tolerance that an equation states.
    """
    return (_SAFETY * error + _ROUNDING) / stated


def sheared(m: ErrorMoments, jump: Any, v: Any) -> Array:
    """Return the moments after a jump of the force at a place that bodies pass with the
    velocity v; arrays or floats.
    """
    yy, yv, vv = m
    turn = jump * np.sign(v) / np.maximum(np.abs(v), _SLOWEST)
    return np.array([yy, yv + turn * yy, vv + turn * (2.0 * yv + turn * yy)])


def slope_between(
    law: Any, start: tuple[Any, Any], end: tuple[Any, Any], h: Any
) -> Any:
    """Return df/dy in the middle of arcs of duration h between two states (y, v);
    arrays or floats; law: an equation, alone or with restraints.
    """
    y, v = 0.5 * (start[0] + end[0]), 0.5 * (start[1] + end[1])
    force = (end[1] - start[1]) / (h + _TINY) + 2.0 * law.damping * v
    return law.slope(y, force)


def at_free_peak(
    moments: Array, state: tuple[Array, Array, Array], highest: Array, peak: Any
) -> Array:
    """Return the second moment of the peak `highest` that bodies have from a state (y,
    y', y'') on, by a difference; moments: (3, lanes); peak: function of (y, v).
    """
    # The peak depends on the energy alone, whose gradient is (-y'', y').
    y, v, force = state
    size = np.hypot(v, force) + _TINY
    by_y, by_v = -force / size, v / size
    # A body that overturns by the difference is as sensitive as one can see.
    higher = (peak(y + STEP * by_y, v + STEP * by_v) - highest) / STEP
    rate = np.nan_to_num(higher, nan=1.0 / STEP)
    yy, yv, vv = moments
    square = by_y * by_y * yy + 2.0 * by_y * by_v * yv + by_v * by_v * vv
    return np.asarray(rate * rate * square)
