"""What shows that a trace is no free rocking of a rigid body, or its sides differ."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ...errors import DocumentError
from .body import INSET, Shape
from .first_look import noise_of
from .fit import Mixed, Saturated, correlations, covariance_of, with_noise

_F = 5.0  # of one step of the zero an impact
_STEP = 0.003  # of the first peak: a smaller step of the zero is none
_LIKELY = 0.02  # of the first peak, a step of a body that slides
_GAIN, _GAIN_DEVIATIONS = 1.01, 4.0
_LEFT_OVER = 0.02  # of the first peak
_BESIDE = 0.03  # of the samples that lie beyond 5 standard deviations
_NOISY, _CORRELATED = 1.15, 0.2  # residuals beyond both are no noise
_SIDES = 4.0  # standard deviations of the ratio of the sides


class Residuals(NamedTuple):
    """What fit A leaves."""

    noise: float  # of a reading, from third differences [SI]
    rms: float  # of the residuals [SI]
    unexplained: float  # root of rms^2 - noise^2, over the first peak
    is_noise: bool  # False if they are larger than the noise, and correlated


def residuals(fit: Saturated) -> Residuals:
    """Return what fit A leaves."""
    rest = fit.residuals[fit.kept]
    noise, rms = noise_of(fit.model.y), float(np.sqrt(np.mean(rest**2)))
    more = np.sqrt(max(rms**2 - noise**2, 0.0)) / _first_peak(fit)
    large = rms > _NOISY * noise and correlations(rest, 1)[0] > _CORRELATED
    return Residuals(noise, rms, float(more), not large)


def _first_peak(fit: Saturated) -> float:
    """Return the largest reading of the motion [SI]."""
    zero = fit.motion.slope[:, -3:-1] @ fit.w[-3:-1]
    return float(np.max(np.abs(fit.motion.y - zero)))


def require_free_rocking(name: str, fit: Mixed, two_sided: Shape, rates: bool) -> bool:
    """Raise DocumentError, which names the trace, if it is no free rocking. Return True
    if the two sides differ although the fit takes them alike. two_sided: the shape with
    two sides; rates: True for angular speeds.
    """
    first, motion = fit.first, fit.motion
    no_rocking = f"{name}: this is not free rocking of a rigid body:"
    unexplained = residuals(first).unexplained
    if unexplained > _LEFT_OVER:
        raise DocumentError(
            f"{no_rocking} the fit leaves {100.0 * unexplained:.2g} % of the first peak"
        )
    differ = not first.model.shape.two_sides and _sides_differ(first, two_sided)
    hint = "; two sides fit it better: `two_sides`" if differ else ""
    for k, (eta, slope) in enumerate(zip(motion.eta, motion.ln_eta_slope, strict=True)):
        sd = fit.deviation(eta * slope)
        if eta > max(_GAIN, 1.0 + _GAIN_DEVIATIONS * sd):
            raise DocumentError(
                f"{name}: the body leaves impact {k + 1} faster than it arrives"
                f" ({eta:.3g} +- {sd:.1g}): somebody pushes, the ground moves, or the"
                f" sides differ{hint}"
            )
    moves = np.zeros(1) if rates else np.abs(_steps(first))
    at = int(np.argmax(moves))
    if moves[at] > _STEP:
        raise DocumentError(
            f"{name}: the zero moves at impact {at + 1} by {100.0 * moves[at]:.2g} % of"
            " the first peak: it slides, the sensor moved, or its edges are"
            f" round{hint}"
        )
    if first.left_out > _BESIDE:
        raise DocumentError(
            f"{no_rocking} {100.0 * first.left_out:.2g} % of the samples lie beside the"
            " fit"
        )
    return differ


def _sides_differ(fit: Saturated, two_sided: Shape) -> bool:
    """True if one linear solve beside fit A, which takes the sides alike, finds a ratio
    of them, or a difference of their insets.
    """
    free = fit.model.shape.starts[0].size
    more = fit.w[:free] if two_sided.fit == INSET else np.zeros(1)
    w = np.insert(fit.w, free, more)
    column = replace(fit.model, shape=two_sided).at(w).slope[:, free]
    rows = np.column_stack([fit.motion.slope[:, :-1], column])
    rows = fit.whitened(rows) / fit.sigma
    try:
        covariance = covariance_of(rows)
    except DocumentError:  # the trace does not tell them apart
        return False
    found = covariance[-1] @ (rows.T @ fit.whitened(fit.residuals)) / fit.sigma
    return bool(abs(found) > _SIDES * np.sqrt(covariance[-1, -1]))


def _steps(fit: Saturated) -> Array:
    """Return the steps of the zero at impacts 1 to n over the first peak, from linear
    solves beside fit A; zeros if they are not significant.
    """
    steps = _first_peak(fit) * (fit.model.t[:, None] >= fit.motion.impacts[:-1])
    columns, count = np.hstack([fit.motion.slope, steps]), steps.shape[1]
    # the noise is what is left beside the steps: they alone may correlate the rest
    alone = np.zeros(fit.kept.size)
    alone[fit.kept] = _left(columns[fit.kept], fit.residuals[fit.kept])
    fit = with_noise(fit, alone)
    rest, rows = fit.whitened(fit.residuals), fit.whitened(columns)
    least = float(np.sum(_left(rows, rest) ** 2))
    squares = float(np.sum(_left(rows[:, :-count], rest) ** 2))
    f = (squares - least) / count / (least / max(rest.size - rows.shape[1], 1))
    # drift and steps are almost alike: a likely size holds the steps
    held = fit.sigma / _LIKELY * np.eye(rows.shape[1])[-count:]
    found = _solved(np.vstack([rows, held]), np.append(rest, np.zeros(count)))
    return np.asarray(found[-count:] * (f > _F))


def _solved(rows: Array, rest: Array) -> Array:
    """Return the solution of a linear problem of least squares."""
    scale = np.maximum(np.linalg.norm(rows, axis=0), 1e-300)
    return np.asarray(np.linalg.lstsq(rows / scale, rest, rcond=None)[0] / scale)


def _left(rows: Array, rest: Array) -> Array:
    """Return what the solution of a linear problem leaves."""
    return np.asarray(rest - rows @ _solved(rows, rest))
