"""What shows that a trace is no free rocking of a rigid body, or its sides differ."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ...errors import DocumentError
from .first_look import noise_of
from .fit import Mixed, Saturated, correlations, covariance_of, free_motion, with_noise
from .unknowns import INSET, Shape

_TINY = 1e-300
_F = 5.0  # of one step of the zero an impact
_STEP = 0.003  # of the first peak: a smaller step of the zero is none
_LIKELY = 0.02  # of the first peak, a step of a body that slides
_GAIN, _GAIN_DEVIATIONS = 1.01, 4.0
_LEFT_OVER = 0.02  # of the first peak
_BESIDE = 0.03  # of the samples that lie beyond 5 standard deviations
_NOISY, _CORRELATED = 1.15, 0.2  # residuals beyond both are no noise
_SIDES = 4.0  # standard deviations of the ratio of the sides


class Residuals(NamedTuple):
    """What a fit leaves."""

    noise: float  # of a reading, from third differences [SI]
    rms: float  # of the residuals [SI]
    unexplained: float  # root of rms^2 - noise^2, over the first peak
    is_noise: bool  # False if they are larger than the noise, and correlated


def residuals(fit: Saturated) -> Residuals:
    """Return what fit A leaves."""
    rest = fit.residuals[fit.kept]
    noise, rms = noise_of(fit.window.y), float(np.sqrt(np.mean(rest**2)))
    more = np.sqrt(max(rms**2 - noise**2, 0.0)) / first_peak(fit)
    large = rms > _NOISY * noise and correlations(rest, 1)[0] > _CORRELATED
    return Residuals(noise, rms, float(more), not large)


def first_peak(fit: Saturated) -> float:
    """Return the largest reading of the motion [SI]."""
    zero = fit.model.y - fit.w[fit.offset] - fit.w[fit.offset + 1] * fit.window.middle
    return float(np.max(np.abs(zero)))


def require_free_rocking(name: str, fit: Mixed, two_sided: Shape, rates: bool) -> bool:
    """Raise DocumentError, which names the trace, if it is no free rocking. Return True
    if the two sides differ although the fit takes them alike. two_sided: the shape with
    two sides; rates: True for angular speeds.
    """
    left = residuals(fit.saturated)
    if left.unexplained > _LEFT_OVER:
        raise DocumentError(
            f"{name}: this is not free rocking of a rigid body: the fit leaves"
            f" {100.0 * left.unexplained:.2g} % of the first peak"
        )
    differ = not fit.saturated.shape.two_sides and _sides_differ(
        fit.saturated, two_sided
    )
    hint = "; two sides fit it better: `two_sides`" if differ else ""
    for k, (eta, slope) in enumerate(zip(fit.eta, fit.model.ln_eta_slope, strict=True)):
        sd = fit.deviation(eta * slope)
        if eta > max(_GAIN, 1.0 + _GAIN_DEVIATIONS * sd):
            raise DocumentError(
                f"{name}: the body leaves impact {k + 1} faster than it arrives"
                f" ({eta:.3g} +- {sd:.1g}): somebody pushes, the ground moves, or the"
                f" sides differ{hint}"
            )
    moves = np.zeros(1) if rates else _steps(fit.saturated)
    at = int(np.argmax(np.abs(moves)))
    if abs(moves[at]) > _STEP:
        raise DocumentError(
            f"{name}: the zero moves at impact {at + 1} by"
            f" {100.0 * abs(moves[at]):.2g} % of the first peak: it slides, the sensor"
            f" moved, or its edges are round{hint}"
        )
    beside = fit.saturated.left_out
    if beside > _BESIDE:
        raise DocumentError(
            f"{name}: this is not free rocking of a rigid body:"
            f" {100.0 * beside:.2g} % of the samples lie beside the fit"
        )
    return differ


def _sides_differ(fit: Saturated, two_sided: Shape) -> bool:
    """True if one linear solve beside fit A, which takes the sides alike, finds a ratio
    of them, or a difference of their insets.
    """
    u = fit.w[: fit.shape.starts[0].size]
    both = np.append(u, u if fit.shape.fit == INSET else 0.0)
    split = free_motion(fit.window, two_sided, np.append(both, fit.w[u.size :]))
    column = split.slope[:, u.size]
    rows = fit.whitened(np.column_stack([fit.model.slope, column])) / fit.sigma
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
    steps = first_peak(fit) * (fit.window.t[:, None] >= fit.model.impacts[:-1])
    columns = np.hstack([fit.model.slope, steps])
    count, unknowns = steps.shape[1], columns.shape[1]
    # the noise is what is left beside the steps: they alone may correlate the rest
    alone = _left(columns[fit.kept], fit.residuals[fit.kept])
    fit = with_noise(fit, alone)
    rest, rows = fit.whitened(fit.residuals), fit.whitened(columns)
    least = float(np.sum(_left(rows, rest) ** 2))
    squares = float(np.sum(_left(rows[:, :-count], rest) ** 2))
    f = (squares - least) / count / (least / max(rest.size - unknowns, 1))
    # drift and steps are almost alike: a likely size holds the steps
    held = fit.sigma / _LIKELY * np.eye(unknowns)[-count:]
    found = _solved(np.vstack([rows, held]), np.append(rest, np.zeros(count)))
    return np.asarray(found[-count:] * (f > _F))


def _solved(rows: Array, rest: Array) -> Array:
    """Return the solution of a linear problem of least squares."""
    scale = np.maximum(np.linalg.norm(rows, axis=0), _TINY)
    return np.asarray(np.linalg.lstsq(rows / scale, rest, rcond=None)[0] / scale)


def _left(rows: Array, rest: Array) -> Array:
    """Return what the solution of a linear problem leaves."""
    return np.asarray(rest - rows @ _solved(rows, rest))
