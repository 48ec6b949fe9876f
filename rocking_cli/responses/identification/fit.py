"""The fit of the closed form to one release: fit A, saturated, with a peak of its own
for each half-cycle, then fit B, in which the restitutions scatter about a mean or a
line over the amplitude (a mixed model).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ...errors import DocumentError
from .body import Reading, Shape
from .closed_form import energy, motion, quarter
from .first_look import Release
from .identified import Estimate

LINE_FROM = 6  # impacts from which eta may be a line over the amplitude
_OUTLIER = 5.0  # robust standard deviations
_TURNS = 12  # of expectation and maximisation
_LEAST_SCATTER = 3e-4  # of eta
_FIRST_SCATTER = 0.01
_STEP = 1e-5  # of central differences
_NOISE, _ALIKE = 0.75, 1.01  # of costs: half of the squares over the noise
_FAR = 12.0  # |z| at most: a peak stays below alpha, and above 0


def slopes(function: Callable[[Array], Array], x: Array) -> Array:
    """Return the derivatives of a function of x, along the last axis."""
    steps = _STEP * np.eye(x.size)
    found = [(function(x + h) - function(x - h)) / (2.0 * _STEP) for h in steps]
    return np.stack(found, axis=-1)


def _peaks(alpha: Array, z: Array) -> Array:
    """Return peak rotations [rad], which stay below alpha."""
    return alpha / (1.0 + np.exp(-z))


def _quarters(of: Array) -> Array:
    """Return (quarter [s], half of ln energy at the impacts) of half-cycles with these
    ln alpha, ln p and z, (2, n + 1).
    """
    alpha, p = np.exp(of[:2])
    theta = _peaks(alpha, of[2])
    return np.array([quarter(theta, alpha, p), 0.5 * np.log(energy(theta, alpha, p))])


def _sums(q: Array) -> Array:
    """Return the times from impact 1 to the ends of half-cycles with quarters q."""
    return np.asarray(2.0 * (np.cumsum(q, axis=0) - q[0]))


class ClosedForm(NamedTuple):
    """The closed form at some unknowns w."""

    alpha: Array  # [rad], right and left, (2,)
    p: Array  # [rad/s], right and left, (2,)
    ln_slope: Array  # of ln alpha right, left, ln p right, left, (4, w)
    impacts: Array  # times of impacts 1 to n + 1 [s], (n + 1,)
    theta: Array  # peak of each half-cycle [rad], (n + 1,)
    y: Array  # readings, (N,)
    slope: Array  # of the readings, (N, w)
    eta: Array  # of impacts 1 to n, (n,)
    ln_eta_slope: Array  # (n, w)


@dataclass(frozen=True)
class FreeRocking:
    """The readings of one release as a function of unknowns w: those of the shape, the
    time of impact 1, z of each half-cycle (the logit of peak over alpha), offset and
    drift of the zero, and ln gain over its standard deviation.
    """

    t: Array  # [s], (N,)
    y: Array  # readings [SI], (N,)
    release: Release
    reading: Reading
    shape: Shape
    beside: float  # samples so near an impact are left out [s]
    gain_error: float  # standard deviation of ln gain

    @cached_property
    def sides(self) -> Array:
        """The side of each half-cycle, (n + 1,): 0 right, 1 left."""
        return (self.release.side + np.arange(self.release.peaks.size)) % 2

    @cached_property
    def free(self) -> int:
        """The number of unknowns of the shape."""
        return self.shape.starts[0].size

    def start(self, u: Array) -> Array:
        """Return the unknowns for those of the shape: peaks that give the observed
        lengths of the half-cycles.
        """
        alpha, p = np.exp(self.shape.at(u).reshape(2, 2))[:, self.sides]
        # linear: x = 1 - 1/cosh(p Q)
        x = 1.0 - 1.0 / np.cosh(0.5 * p[1:] * np.diff(self.release.impacts))
        x = np.clip(np.append(self.release.peaks[0] / alpha[0], x), 1e-4, 0.97)
        return np.concatenate(
            [u, self.release.impacts[:1], np.log(x / (1.0 - x)), np.zeros(3)]
        )

    def arcs(self, w: Array) -> tuple[Array, Array, Array]:
        """Return (ln alpha, ln p, z and time of the peak of each half-cycle, (4, n +
        1); times of the impacts that end them; half of ln energy).
        """
        of = np.vstack(
            [
                self.shape.at(w[: self.free]).reshape(2, 2)[:, self.sides],
                np.clip(w[self.free + 1 : -3], -_FAR, _FAR),
            ]
        )
        q, ln_energy = _quarters(of)
        ends = w[self.free] + _sums(q)
        return np.vstack([of, ends - q]), ends, ln_energy

    def swing(self, of: Array, sides: Array) -> Array:
        """Return readings without offset, drift and gain; of: numbers of the half-cycle
        of each sample, (4, N); sides: its side.
        """
        sign, (alpha, p) = 1.0 - 2.0 * sides, np.exp(of[:2])
        turned, rate = motion(self.t - of[3], _peaks(alpha, of[2]), alpha, p)
        return self.reading(sign * turned, sign * rate, alpha, p)

    def readings(self, w: Array, swing: Array | None = None) -> Array:
        """Return the readings."""
        if swing is None:
            of, ends, _ = self.arcs(w)
            arc = np.searchsorted(ends[:-1], self.t, side="right")
            swing = self.swing(of[:, arc], self.sides[arc])
        drift = w[-2] * (self.t - self.t.mean())
        return np.exp(self.gain_error * w[-1]) * swing + w[-3] + drift

    def at(self, w: Array) -> ClosedForm:
        """Return the motion, with derivatives."""
        of, ends, ln_energy = self.arcs(w)
        ln_slope = np.zeros((4, w.size))
        ln_slope[:, : self.free] = slopes(self.shape.at, w[: self.free])
        # of the four numbers of each half-cycle, (4, n + 1, w)
        of_slope = np.zeros((*of.shape, w.size))
        of_slope[:2] = ln_slope.reshape(2, 2, -1)[:, self.sides]
        of_slope[2] = np.eye(ends.size, w.size, self.free + 1)
        local = slopes(lambda h: _quarters(of[:3] + h[:, None]), np.zeros(3))
        q, ln_energies = np.einsum("ikj,jkw->ikw", local, of_slope[:3])
        of_slope[3] = _sums(q) - q
        of_slope[3, :, self.free] += 1.0

        arc = np.searchsorted(ends[:-1], self.t, side="right")
        each, sides = of[:, arc], self.sides[arc]
        swing = self.swing(each, sides)
        own = slopes(lambda h: self.swing(each + h[:, None], sides), np.zeros(4))
        slope = np.exp(self.gain_error * w[-1]) * np.concatenate(
            [own[arc == k] @ of_slope[:, k] for k in range(ends.size)]
        )
        slope[:, -3], slope[:, -2] = 1.0, self.t - self.t.mean()
        slope[:, -1] = self.gain_error * swing
        alpha, p = np.exp(self.shape.at(w[: self.free]).reshape(2, 2))
        return ClosedForm(
            alpha,
            p,
            ln_slope,
            ends,
            _peaks(np.exp(of[0]), of[2]),
            self.readings(w, swing),
            slope,
            np.exp(np.diff(ln_energy)),
            np.diff(ln_energies, axis=0),
        )


@dataclass(frozen=True)
class Saturated:
    """Fit A."""

    model: FreeRocking
    w: Array  # unknowns
    kept: Array  # True for the samples that are used, (N,)
    motion: ClosedForm
    left_out: float  # share of the samples that lie far beside the fit
    rho: float = 0.0  # autocorrelation of neighbours, 0 if not significant
    sigma: float = 1.0  # standard deviation of whitened residuals, correlation included

    @property
    def residuals(self) -> Array:
        """Readings less the motion [SI], (N,)."""
        return np.asarray(self.model.y - self.motion.y)

    def whitened(self, columns: Array) -> Array:
        """Return the used rows, less what their neighbour before tells of them."""
        rows = columns[self.kept].T
        if not self.rho:
            return rows.T
        alone = np.diff(np.flatnonzero(self.kept), prepend=-2) > 1
        lessened = rows - self.rho * np.roll(rows, 1, axis=-1)
        return np.where(alone, rows * np.sqrt(1.0 - self.rho**2), lessened).T


def saturated(model: FreeRocking, sigma: float) -> Saturated:
    """Return fit A; sigma: noise of a reading [SI]. Raises DocumentError if the fit
    does not end.
    """
    from scipy.optimize import least_squares

    near = np.abs(model.t[:, None] - model.release.impacts).min(axis=1)
    inside = near > model.beside
    if inside.sum() <= model.t.size // 10:
        raise DocumentError("nine of ten samples are too near an impact")

    def solved(w: Array, kept: Array, loss: str) -> tuple[float, Array]:
        prior = np.eye(w.size)[-1:]  # of the gain
        found = least_squares(
            lambda w: np.append((model.readings(w) - model.y)[kept] / sigma, prior @ w),
            w,
            lambda w: np.vstack([model.at(w).slope[kept] / sigma, prior]),
            x_scale="jac",
            loss=loss,
            f_scale=3.0,
            max_nfev=60,
        )
        return found.cost, found.x

    def misfit(w: Array) -> float:
        return float(np.sum((model.readings(w) - model.y)[inside] ** 2))

    try:
        ends: list[tuple[float, Array]] = []
        for begin in sorted(map(model.start, model.shape.starts), key=misfit):
            ends.append(solved(begin, inside, "soft_l1"))
            ends.sort(key=lambda end: end[0])
            # a start may end where a peak is at alpha: noise is left, or two ends agree
            alike = len(ends) > 1 and ends[1][0] < _ALIKE * ends[0][0]
            if alike or ends[0][0] < _NOISE * inside.sum():
                break
        w = ends[0][1]
        residual = np.abs(model.y - model.readings(w))
        spread = max(1.4826 * float(np.median(residual[inside])), sigma)
        kept = inside & (residual <= _OUTLIER * spread)
        _, w = solved(w, kept, "linear")
    except (np.linalg.LinAlgError, ValueError, FloatingPointError) as error:
        raise DocumentError(f"the fit has no end: {error}") from None
    left_out = 1.0 - float(kept.sum() / inside.sum())
    fitted = Saturated(model, w, kept, model.at(w), left_out)
    return with_noise(fitted, fitted.residuals)


def with_noise(fit: Saturated, rest: Array) -> Saturated:
    """Return fit A with the noise of what is left of the samples, (N,): AR 1 if
    neighbours are correlated, and a larger variance for what correlation is left.
    """
    count = int(fit.kept.sum())
    rho = float(correlations(rest[fit.kept], 1)[0])
    fit = replace(fit, rho=rho if abs(rho) > 2.6 / np.sqrt(count) else 0.0)
    rest = fit.whitened(rest)
    left = correlations(rest, 30)
    small = np.flatnonzero(left < 2.0 / np.sqrt(count))
    more = 2.0 * left[: small[0] if small.size else None].sum()
    variance = np.sum(rest**2) / max(count - fit.w.size, 1) * (1.0 + more)
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

    first: Saturated  # fit A
    motion: ClosedForm  # at the unknowns of this fit
    w: Array  # unknowns, without b
    b: Array  # coefficients of eta
    covariance: Array  # of w and b
    scatter: float  # tau, standard deviation of eta between impacts
    x: Array  # theta/alpha before each impact, (n,), of fit A

    def deviation(self, gradient: Array) -> float:
        """Return the standard deviation of a quantity with this derivative with respect
        to w, or w and b.
        """
        g = np.zeros(len(self.covariance))
        g[: len(gradient)] = gradient
        return float(np.sqrt(max(g @ self.covariance @ g, 0.0)))

    def of_eta(self, weights: Array, factor: float) -> Estimate:
        """Return a combination of the coefficients of eta."""
        gradient = np.append(np.zeros(self.w.size), weights)
        value = float(weights @ self.b[: weights.size])
        return Estimate(value, self.deviation(gradient), factor)


def covariance_of(rows: Array) -> Array:
    """Return the covariance of the unknowns of a linear problem, whose rows have unit
    variance. Raises DocumentError if it has no unique answer.
    """
    scale = np.linalg.norm(rows, axis=0)
    try:
        found = np.linalg.inv((rows / scale).T @ (rows / scale))
    except np.linalg.LinAlgError:
        found = np.full((1, 1), np.nan)
    if not (np.isfinite(found).all() and np.all(np.diag(found) > 0.0)):
        raise DocumentError("the fit has no unique answer")
    return np.asarray(found / np.outer(scale, scale))


def mixed(fit: Saturated) -> Mixed:
    """Return fit B, from fit A. Raises DocumentError if its equations are singular."""
    model, here, w, tau = fit.model, fit.motion, fit.w, _FIRST_SCATTER
    sides = model.sides[:-1]
    x = here.theta[:-1] / here.alpha[sides]
    # what multiplies the coefficients of eta, (n, coefficients)
    line = np.vander(x - x.mean(), 1 + (x.size >= LINE_FROM), increasing=True)
    design = np.eye(2)[sides] if model.shape.two_sides else line
    b = np.linalg.lstsq(design, here.eta, rcond=None)[0]
    prior = np.eye(w.size + b.size)[w.size - 1]  # of the gain
    for _ in range(_TURNS):
        of_eta = np.hstack([here.eta[:, None] * here.ln_eta_slope, -design])
        of_trace = fit.whitened(here.slope) / fit.sigma
        rows = np.vstack([np.pad(of_trace, ((0, 0), (0, b.size))), of_eta / tau, prior])
        left = np.concatenate(
            [
                fit.whitened(model.y - here.y) / fit.sigma,
                (design @ b - here.eta) / tau,
                -w[-1:],
            ]
        )
        covariance = covariance_of(rows)
        step = covariance @ (rows.T @ left)
        w, b = w + step[: w.size], b + step[w.size :]
        here = model.at(w)
        spread = np.einsum("iw,wv,iv->i", of_eta, covariance, of_eta)
        variance = np.mean((here.eta - design @ b) ** 2 + spread)
        tau = max(float(np.sqrt(variance)), _LEAST_SCATTER)
    return Mixed(fit, here, w, b, covariance, tau, x)
