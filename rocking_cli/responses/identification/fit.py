"""The fit of the closed form to one release: fit A, saturated, with a peak of its own
for each half-cycle, then fit B, in which the restitutions scatter about a mean or a
line over the amplitude (a mixed model).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ...errors import DocumentError
from .closed_form import energy, motion, peaks, quarter, slopes
from .first_look import Release
from .unknowns import Shape

LINE_FROM = 6  # impacts from which eta may be a line over the amplitude
_OUTLIER = 5.0  # robust standard deviations
_TURNS = 12  # of expectation and maximisation
_LEAST_SCATTER = 3e-4  # of eta
_FIRST_SCATTER = 0.01
_STEP = 1e-5  # s, of the centred differences in time
_FAR = 12.0  # |z| at most: a peak stays below alpha, and above 0

# (theta [rad], theta_dot [rad/s], alpha, p) with their signs: returns the reading in SI
Reading = Callable[[Array, Array, Array, Array], Array]


@dataclass(frozen=True)
class Window:
    """The samples of one release, and how they read the motion."""

    t: Array  # [s], (N,)
    y: Array  # readings [SI], (N,)
    release: Release
    reading: Reading
    beside: float  # samples so near an impact are left out [s]
    gain_error: float  # relative standard deviation of the gain of the sensor

    @property
    def sides(self) -> Array:
        """The side of each half-cycle, (n + 1,): 0 right, 1 left."""
        return np.asarray((self.release.side + np.arange(self.release.count + 1)) % 2)

    @property
    def middle(self) -> Array:
        """The time since the middle of the window, (N,): that of the drift."""
        return np.asarray(self.t - 0.5 * (self.t[0] + self.t[-1]))


class HalfCycles(NamedTuple):
    """The half-cycles at some unknowns w: those of the shape, the time of impact 1, z
    of each half-cycle (`peaks`), offset and drift of the zero, and ln gain.
    """

    logs: Array  # ln alpha right and left, ln p right and left, (4,)
    ln_alpha: Array  # of each half-cycle, (n + 1,)
    ln_p: Array  # (n + 1,)
    z: Array  # (n + 1,)
    impacts: Array  # times of impacts 1 to n + 1 [s], (n + 1,)
    peak_times: Array  # [s], (n + 1,)
    shape_slope: Array  # of `logs`, (4, unknowns of the shape)
    slope: Array  # of ln alpha, ln p and z of each half-cycle, (3, n + 1, w)
    time_slope: Array  # of the times of the peaks, (n + 1, w)


def half_cycles_at(window: Window, shape: Shape, w: Array) -> HalfCycles:
    """Return the half-cycles at the unknowns w."""
    count, sides, free = window.release.count, window.sides, shape.starts[0].size
    logs, shape_slope = shape.at(w[:free]), shape.slope(w[:free])
    ln_alpha, ln_p = logs[:2][sides], logs[2:][sides]
    z = np.clip(w[free + 1 : free + 2 + count], -_FAR, _FAR)

    each = np.arange(count + 1)
    slope = np.zeros((3, count + 1, w.size))
    slope[0, :, :free] = shape_slope[:2][sides]
    slope[1, :, :free] = shape_slope[2:][sides]
    slope[2, each, free + 1 + each] = 1.0

    # a half-cycle lasts two quarters; the first one lies before impact 1
    alpha = np.exp(ln_alpha)
    q = quarter(peaks(alpha, z), alpha, np.exp(ln_p))
    before = 2.0 * np.tri(count + 1) - np.eye(count + 1)
    before[:, 0] = 0.0
    before[0, 0] = -1.0
    q_slope = _chained(slopes(quarter, ln_alpha, ln_p, z), slope)
    time_slope = before @ q_slope
    time_slope[:, free] += 1.0
    impacts = w[free] + 2.0 * np.concatenate([[0.0], np.cumsum(q[1:])])
    return HalfCycles(
        logs,
        ln_alpha,
        ln_p,
        z,
        impacts,
        w[free] + before @ q,
        shape_slope,
        slope,
        time_slope,
    )


def _chained(along: tuple[Array, Array, Array], slope: Array) -> Array:
    """Return derivatives with respect to w from those with respect to ln alpha, ln p
    and z of each half-cycle.
    """
    return np.asarray(np.einsum("ik,ikw->kw", np.array(along), slope))


def _readings(window: Window, arcs: HalfCycles) -> tuple[Array, Array]:
    """Return (readings without offset, drift and gain, their derivatives). The reading
    of a sample depends on four numbers of its half-cycle: time of the peak, ln alpha,
    ln p and z.
    """
    arc = np.searchsorted(arcs.impacts[:-1], window.t, side="right")
    sign, since = 1.0 - 2.0 * window.sides[arc], window.t - arcs.peak_times[arc]

    def read(moved: float, *at: Array) -> Array:
        turned, rate = motion(since + moved, *at)
        return window.reading(sign * turned, sign * rate, at[1], at[2])

    of_arc = arcs.ln_alpha[arc], arcs.ln_p[arc], arcs.z[arc]
    alpha = np.exp(of_arc[0])
    at = peaks(alpha, of_arc[2]), alpha, np.exp(of_arc[1])
    later = (read(-_STEP, *at) - read(_STEP, *at)) / (2.0 * _STEP)
    slope = later[:, None] * arcs.time_slope[arc]
    own = slopes(lambda *at: read(0.0, *at), *of_arc)
    for along, of in zip(own, arcs.slope, strict=True):
        slope += along[:, None] * of[arc]
    return read(0.0, *at), slope


@dataclass(frozen=True)
class FittedMotion:
    """The closed form at some unknowns w, see `HalfCycles`."""

    impacts: Array  # times of impacts 1 to n + 1 [s], (n + 1,)
    alpha: Array  # [rad], right and left, (2,)
    p: Array  # [rad/s], right and left, (2,)
    theta: Array  # peak of each half-cycle [rad], (n + 1,)
    y: Array  # readings, (N,)
    slope: Array  # of the readings, (N, w)
    ln_eta: Array  # of impacts 1 to n, (n,)
    ln_eta_slope: Array  # (n, w)
    shape_slope: Array  # of ln alpha and ln p, (4, unknowns of the shape)

    def gradient(self, row: int) -> Array:
        """Return the derivative of a row of (ln alpha right, left, ln p right, left)
        with respect to all unknowns, (w,).
        """
        found = np.zeros(self.slope.shape[1])
        found[: self.shape_slope.shape[1]] = self.shape_slope[row]
        return found


def free_motion(window: Window, shape: Shape, w: Array) -> FittedMotion:
    """Return the closed form and its derivatives at the unknowns w."""
    arcs = half_cycles_at(window, shape, w)
    y, slope = _readings(window, arcs)
    if window.gain_error:
        gain = np.exp(w[-1])
        y, slope = gain * y, gain * slope
        slope[:, -1] = y
    at = shape.starts[0].size + 2 + window.release.count
    slope[:, at], slope[:, at + 1] = 1.0, window.middle
    alpha = np.exp(arcs.ln_alpha)
    theta = peaks(alpha, arcs.z)
    ln_energy = np.log(energy(theta, alpha, np.exp(arcs.ln_p)))
    along = slopes(lambda *at: np.log(energy(*at)), arcs.ln_alpha, arcs.ln_p, arcs.z)
    return FittedMotion(
        arcs.impacts,
        np.exp(arcs.logs[:2]),
        np.exp(arcs.logs[2:]),
        theta,
        y + w[at] + w[at + 1] * window.middle,
        slope,
        0.5 * np.diff(ln_energy),
        0.5 * np.diff(_chained(along, arcs.slope), axis=0),
        arcs.shape_slope,
    )


@dataclass(frozen=True)
class Saturated:
    """Fit A."""

    shape: Shape
    window: Window
    w: Array  # unknowns
    kept: Array  # True for the samples that are used, (N,)
    model: FittedMotion
    left_out: float  # share of the samples that lie far beside the fit
    rho: float  # autocorrelation of neighbouring residuals, 0 if not significant
    sigma: (
        float  # standard deviation of the whitened residuals, with what is correlated
    )

    @property
    def offset(self) -> int:
        """The index of the offset among the unknowns; that of the drift is the next."""
        return self.shape.starts[0].size + 2 + self.window.release.count

    @property
    def residuals(self) -> Array:
        """Readings less the model [SI], (N,)."""
        return np.asarray(self.window.y - self.model.y)

    def whitened(self, columns: Array) -> Array:
        """Return the used rows, less what their neighbour before tells of them."""
        rows = columns[self.kept]
        if not self.rho:
            return rows
        alone = np.diff(np.flatnonzero(self.kept), prepend=-2) > 1
        before = np.concatenate([rows[:1], rows[:-1]])
        scale = np.where(alone, np.sqrt(1.0 - self.rho**2), 1.0)
        shape = (-1,) + (1,) * (rows.ndim - 1)
        lessened = rows - self.rho * before
        return np.where(alone.reshape(shape), rows * scale.reshape(shape), lessened)


def start(window: Window, shape: Shape, u: Array) -> Array:
    """Return the unknowns for those of the shape: peaks that give the observed lengths
    of the half-cycles.
    """
    logs, sides = shape.at(u), window.sides
    p, alpha = np.exp(logs[2:][sides]), np.exp(logs[:2][sides])
    longs = np.diff(window.release.impacts)
    # linear: x = 1 - 1/cosh(p Q)
    x = np.concatenate(
        [window.release.peaks[:1] / alpha[0], 1.0 - 1.0 / np.cosh(0.5 * p[1:] * longs)]
    )
    x = np.clip(x, 1e-4, 0.97)
    gain = [0.0] if window.gain_error else []
    return np.concatenate(
        [u, window.release.impacts[:1], np.log(x / (1.0 - x)), [0.0, 0.0], gain]
    )


def saturated(
    window: Window, shape: Shape, sigma: float, w: Array | None = None
) -> Saturated:
    """Return fit A; sigma: noise of a reading [SI]; w: unknowns to begin with. Raises
    DocumentError if the fit does not end.
    """
    from scipy.optimize import least_squares

    near = np.abs(window.t[:, None] - window.release.impacts).min(axis=1)
    inside = near > window.beside
    if inside.sum() <= window.t.size // 10:
        raise DocumentError("nine of ten samples are too near an impact")
    last: list[tuple[Array, FittedMotion]] = []

    def at(w: Array) -> FittedMotion:
        if not last or not np.array_equal(last[0][0], w):
            last[:] = [(w.copy(), free_motion(window, shape, w))]
        return last[0][1]

    def solved(w: Array, kept: Array, loss: str) -> Array:
        prior = np.zeros((1, w.size))
        prior[0, -1] = 1.0 / window.gain_error if window.gain_error else 0.0
        found = least_squares(
            lambda w: np.append((at(w).y - window.y)[kept] / sigma, prior @ w),
            w,
            lambda w: np.vstack([at(w).slope[kept] / sigma, prior]),
            x_scale="jac",
            loss=loss,
            f_scale=3.0,
            max_nfev=60,
        )
        costs.append(found.cost)
        return np.asarray(found.x)

    costs: list[float] = []
    try:
        begins = [start(window, shape, u) for u in shape.starts] if w is None else [w]
        by_cost = [float(np.sum((at(w).y - window.y)[inside] ** 2)) for w in begins]
        best = [begins[i] for i in np.argsort(by_cost)[:2]]
        ends = [solved(w, inside, "soft_l1") for w in best]
        w = ends[int(np.argmin(costs))]
        residual = window.y - at(w).y
        spread = 1.4826 * np.median(np.abs(residual[inside]))
        kept = inside & (np.abs(residual) <= _OUTLIER * max(spread, sigma))
        w = solved(w, kept, "linear")
    except (np.linalg.LinAlgError, ValueError, FloatingPointError) as error:
        raise DocumentError(f"the fit has no end: {error}") from None
    left_out = 1.0 - float(kept.sum() / inside.sum())
    fitted = Saturated(shape, window, w, kept, at(w), left_out, 0.0, 1.0)
    return with_noise(fitted, fitted.residuals[kept])


def with_noise(fit: Saturated, rest: Array) -> Saturated:
    """Return fit A with the noise of what is left of the used samples: AR 1 if
    neighbours are correlated, and a larger variance for what correlation is left.
    """
    rho = float(correlations(rest, 1)[0])
    fit = replace(fit, rho=rho if abs(rho) > 2.6 / np.sqrt(rest.size) else 0.0)
    whole = np.zeros(fit.kept.size)
    whole[fit.kept] = rest
    rest = fit.whitened(whole)
    left = correlations(rest, 30)
    small = np.flatnonzero(left < 2.0 / np.sqrt(rest.size))
    left = left[: small[0]] if small.size else left
    freedom = max(rest.size - fit.w.size, 1)
    variance = np.sum(rest**2) / freedom * (1.0 + 2.0 * left.sum())
    return replace(fit, sigma=float(np.sqrt(variance)))


def correlations(x: Array, most: int) -> Array:
    """Return the autocorrelations of a series at lags 1 to `most`."""
    x = x - x.mean()
    total = float(x @ x) or 1.0
    return np.array([x[lag:] @ x[:-lag] / total for lag in range(1, most + 1)])


@dataclass(frozen=True)
class Mixed:
    """Fit B. Its unknowns are those of fit A and then b, the coefficients of eta: the
    mean and, from six impacts on, its slope over x = theta/alpha; with two sides the
    mean on leaving each of those that occur.
    """

    saturated: Saturated  # fit A
    model: FittedMotion  # at the unknowns of this fit
    w: Array  # unknowns, without b
    b: Array  # coefficients of eta
    covariance: Array  # of w and b
    scatter: float  # tau, standard deviation of eta between impacts
    x: Array  # theta/alpha before each impact, (n,), of fit A
    centre: float  # the x at which the mean holds

    @property
    def eta(self) -> Array:
        """The restitution of each impact, (n,)."""
        return np.exp(self.model.ln_eta)

    def deviation(self, gradient: Array) -> float:
        """Return the standard deviation of a quantity with this derivative with respect
        to w, or w and b.
        """
        g = np.zeros(len(self.covariance))
        g[: len(gradient)] = gradient
        return float(np.sqrt(max(g @ self.covariance @ g, 0.0)))


def covariance_of(rows: Array) -> Array:
    """Return the covariance of the unknowns of a linear problem, whose rows have unit
    variance. Raises DocumentError if it has no unique answer.
    """
    scale = np.linalg.norm(rows, axis=0)
    try:
        found = np.linalg.inv((rows / scale).T @ (rows / scale)) / np.outer(
            scale, scale
        )
    except np.linalg.LinAlgError:
        found = np.full((1, 1), np.nan)
    if not (np.isfinite(found).all() and np.all(np.diag(found) > 0.0)):
        raise DocumentError("the fit has no unique answer")
    return np.asarray(found)


def _design(fit: Saturated, x: Array) -> Array:
    """Return what multiplies the coefficients of eta, (n, coefficients); x: theta/alpha
    before each impact, less its mean.
    """
    if fit.shape.two_sides:
        return np.asarray(fit.window.sides[:-1, None] == np.arange(2), float)
    line = [np.ones(x.size), x]
    return np.stack(line[: 1 + (x.size >= LINE_FROM)], axis=1)


def mixed(fit: Saturated) -> Mixed:
    """Return fit B, from fit A. Raises DocumentError if its equations are singular."""
    x = fit.model.theta[:-1] / fit.model.alpha[fit.window.sides[:-1]]
    centre = float(x.mean())
    design = _design(fit, x - centre)
    w, tau = fit.w, _FIRST_SCATTER
    b = np.linalg.lstsq(design, np.exp(fit.model.ln_eta), rcond=None)[0]
    prior = np.zeros((1, w.size + b.size))
    if fit.window.gain_error:
        prior[0, w.size - 1] = 1.0 / fit.window.gain_error
    here = fit.model
    for _ in range(_TURNS):
        eta = np.exp(here.ln_eta)
        of_eta = np.hstack([eta[:, None] * here.ln_eta_slope, -design])
        of_trace = fit.whitened(here.slope) / fit.sigma
        rows = np.vstack([np.pad(of_trace, ((0, 0), (0, b.size))), of_eta / tau, prior])
        left = np.concatenate(
            [
                fit.whitened(fit.window.y - here.y) / fit.sigma,
                (design @ b - eta) / tau,
                -prior @ np.concatenate([w, b]),
            ]
        )
        covariance = covariance_of(rows)
        step = covariance @ (rows.T @ left)
        w, b = w + step[: w.size], b + step[w.size :]
        here = free_motion(fit.window, fit.shape, w)
        between = np.exp(here.ln_eta) - design @ b
        spread = np.einsum("iw,wv,iv->i", of_eta, covariance, of_eta)
        tau = max(float(np.sqrt(np.mean(between**2 + spread))), _LEAST_SCATTER)
    return Mixed(fit, here, w, b, covariance, tau, x, centre)
