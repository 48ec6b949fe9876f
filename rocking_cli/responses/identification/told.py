"""What the fits of a release tell, as estimates, rows and remarks."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...arrays import Array
from .body import KnownBody
from .checks import Residuals
from .fit import LINE_FROM, Mixed
from .identified import COLUMNS, Estimate, bounds
from .unknowns import BOTH, INSET

FEW = 6  # impacts: with fewer the intervals are too narrow
LOW = 0.3  # theta_0/alpha: released lower, alpha and p are hardly apart
DECIDES = 0.7  # theta/alpha of the impact that decides a fall
_KNOWN = 0.1  # relative standard deviation: an alpha less certain is not told
_APART = 3.0  # standard deviations
_SIDES = ("right", "left")


def is_certain(found: Mixed) -> bool:
    """False if a fit knows alpha so little that it is not told."""
    return found.deviation(found.model.gradient(0)) <= _KNOWN


@dataclass(frozen=True)
class Told:
    """One release."""

    name: str  # of the trace
    number: int  # of the release in it
    fit: str  # one of FITS
    found: Mixed  # the fit
    free: Mixed | None  # that of alpha and p, None if it fails
    left: Residuals
    differ: bool  # True if the sides differ, though the fit takes them alike
    body: KnownBody | None  # None without a structure
    level: float  # of the intervals

    @property
    def two_sides(self) -> bool:
        """True if the fit has two sides."""
        return self.found.saturated.shape.two_sides

    @property
    def impacts(self) -> int:
        """The number of impacts that are used."""
        return self.found.x.size

    @property
    def ratio(self) -> float:
        """theta/alpha of the release."""
        return float(self.found.x[0])

    def side(self, name: str) -> list[Estimate]:
        """Return `inset` or `alpha` of the right and the left side."""
        found = []
        for i in (0, 1):
            if name == INSET:
                at = i if self.two_sides else 0
                found.append(self._of(self.found.w[at], np.eye(at + 1)[at]))
            else:
                alpha = self.found.model.alpha[i]
                found.append(self._of(alpha, alpha * self.found.model.gradient(i)))
        return found

    @property
    def inset(self) -> Estimate | None:
        """The inset, the mean of both sides [m]; None if it is not fitted."""
        if self.fit != INSET:
            return None
        weights = np.full(2, 0.5) if self.two_sides else np.ones(1)
        return self._of(weights @ self.found.w[: weights.size], weights)

    @property
    def alpha(self) -> Estimate:
        """alpha, the mean of both sides [rad]."""
        model = self.found.model
        gradients = (model.alpha[i] * model.gradient(i) for i in (0, 1))
        return self._of(model.alpha.mean(), 0.5 * sum(gradients))

    @property
    def is_told(self) -> bool:
        """False if alpha and p cannot be told apart."""
        return self.fit != BOTH or is_certain(self.found)

    @property
    def p(self) -> Estimate | None:
        """p of the fit of alpha and p [rad/s]."""
        if self.free is None:
            return None
        p = float(self.free.model.p.mean())
        return Estimate(p, self.free.deviation(p * self.free.model.gradient(2)))

    @property
    def p_structure(self) -> float | None:
        """p that the sizes give, with the inset that is found [rad/s]."""
        if self.body is None:
            return None
        return float(np.mean(self.body.p if self.fit == BOTH else self.found.model.p))

    @property
    def p2alpha(self) -> Estimate:
        """p^2 alpha [rad/s2], which is known best."""
        model = self.found.model
        value = float(model.p[0] ** 2 * model.alpha[0])
        return self._of(value, value * (2.0 * model.gradient(2) + model.gradient(0)))

    @property
    def eta(self) -> Estimate:
        """The mean restitution."""
        return self._of_b(np.full(2, 0.5) if self.two_sides else np.ones(1))

    @property
    def slope(self) -> Estimate | None:
        """The slope of eta over theta/alpha, None for few impacts and two sides."""
        line = not self.two_sides and self.impacts >= LINE_FROM
        return self._of_b(np.array([0.0, 1.0])) if line else None

    @property
    def depends(self) -> bool:
        """True if the interval of the slope leaves 0 out."""
        slope = self.slope
        return slope is not None and abs(slope.value) > self.student(2) * slope.sd

    @property
    def restitution(self) -> tuple[Estimate, float | None]:
        """(eta for a document, the theta/alpha at which it holds, None for a mean)."""
        if not self.depends:
            return self.eta, None
        x = min(DECIDES, float(self.found.x.max()))
        return self._of_b(np.array([1.0, x - self.found.centre])), x

    @property
    def momentum(self) -> float | None:
        """eta from angular momentum, with the inset that is found."""
        if self.body is None:
            return None
        insets = (
            self.found.w[: 1 + self.two_sides] if self.fit == INSET else np.zeros(1)
        )
        return self.body.momentum(insets)

    @property
    def sides_apart(self) -> bool:
        """True if alpha of the two sides differs by 3 standard deviations."""
        if not self.two_sides:
            return False
        model = self.found.model
        ratio = np.log(model.alpha[0] / model.alpha[1])
        return abs(ratio) > _APART * self.found.deviation(
            model.gradient(0) - model.gradient(1)
        )

    @property
    def p_apart(self) -> bool:
        """True if p of the trace is not that of the sizes."""
        p, sizes = self.p, self.p_structure
        if p is None or sizes is None:
            return False
        return abs(p.value - sizes) > _APART * p.sd

    def _of(self, value: float, gradient: Array) -> Estimate:
        return Estimate(float(value), self.found.deviation(gradient))

    def _of_b(self, weights: Array) -> Estimate:
        """Return a combination of the coefficients of eta."""
        gradient = np.append(np.zeros(self.found.w.size), weights)
        return self._of(weights @ self.found.b[: weights.size], gradient)

    @property
    def normal(self) -> float:
        """Half the width of an interval over its standard deviation."""
        from scipy.special import ndtri

        return float(ndtri(0.5 + 0.5 * self.level))

    def student(self, unknowns: int = 1) -> float:
        """Return the same of a mean over the impacts (Student's t)."""
        from scipy.special import stdtrit

        return float(stdtrit(max(self.impacts - unknowns, 1), 0.5 + 0.5 * self.level))


def estimates_of(told: Told) -> dict[str, Estimate]:
    """Return what is told, by column."""
    found = {"inset": told.inset, "alpha": told.alpha, "p": told.p, "eta": told.eta}
    hidden = () if told.is_told else ("alpha", "p")
    return {
        key: one for key, one in found.items() if one is not None and key not in hidden
    }


def row_of(told: Told) -> dict[str, Any]:
    """Return the row of a release, by COLUMNS."""
    found, estimates = told.found, estimates_of(told)
    row: dict[str, Any] = dict.fromkeys(COLUMNS)
    for key in ("inset", "alpha", "p"):
        row |= bounds(key, estimates.get(key), told.normal)
    row |= bounds("eta", told.eta, told.student())
    row |= bounds("eta_slope", told.slope, told.student(2))
    if told.is_told:
        row["theta0_ratio"] = told.ratio
    if told.body is not None:
        row["alpha_ratio"] = told.alpha.value / told.body.alpha
    if told.two_sides:
        row |= {"eta_right": float(found.b[0]), "eta_left": float(found.b[1])}
        for key in (("inset",) if told.fit == INSET else ()) + ("alpha",):
            for side, one in zip(_SIDES, told.side(key), strict=True):
                row[f"{key}_{side}"] = one.value
    at = found.saturated.offset
    return row | {
        "trace": told.name,
        "release": told.number,
        "impacts": told.impacts,
        "p_structure": told.p_structure,
        "eta_scatter": found.scatter,
        "eta_momentum": told.momentum,
        "noise": told.left.noise,
        "rms": told.left.rms,
        "offset": float(found.w[at]),
        "drift": float(found.w[at + 1]),
        "unexplained": told.left.unexplained,
    }


def impact_rows(told: Told) -> list[dict[str, Any]]:
    """Return a row for each impact, by IMPACT_COLUMNS."""
    model, alone = told.found.model, np.exp(told.found.saturated.model.ln_eta)
    rows = []
    for k, eta in enumerate(told.found.eta):
        sd = told.found.deviation(eta * model.ln_eta_slope[k])
        side = told.found.saturated.window.sides[k]
        rows.append(
            {
                "trace": told.name,
                "release": told.number,
                "impact": k + 1,
                "t": float(model.impacts[k]),
                "side": _SIDES[side],
                "theta_before": float(model.theta[k]),
                "ratio": float(model.theta[k] / model.alpha[side]),
                **bounds("eta", Estimate(float(eta), sd), told.normal),
                "eta_alone": float(alone[k]),
            }
        )
    return rows


def faults(told: Told) -> Iterator[str]:
    """Yield why no line may be pasted, in sentences."""
    inset, p = told.inset, told.p
    if told.p_apart and p is not None:
        yield (
            f"p of the trace is {p.value:.4g} +- {p.sd:.1g} rad/s, that of the sizes"
            f" {told.p_structure:.4g}: sizes, time or a moving pivot are wrong"
        )
    if not told.left.is_noise:
        yield (
            f"the fit leaves {100.0 * told.left.unexplained:.2g} % of the first peak,"
            " which is no noise"
        )
    if told.body is None and (told.ratio < LOW or not told.is_told):
        best = told.p2alpha
        yield (
            f"alpha and p cannot be told apart: p2 alpha = {best.value:.4g} +-"
            f" {best.sd:.1g} rad/s2 is what this trace says; give the structure or"
            " release higher"
        )
    if inset is not None and inset.value + told.normal * inset.sd < 0.0:
        yield (
            f"the inset is {inset.text('mm', 1e-3)}: the pivots would lie outside the"
            " edges: check the gain and the sizes"
        )
    if told.restitution[0].value > 1.0:
        yield f"eta is {told.restitution[0].text()}, above 1"
    if told.differ:
        yield (
            "the sides differ, or the ground slopes: one alpha does not fit both"
            " (`two_sides`)"
        )


def remarks_of(told: Told) -> list[str]:
    """Return what the trace does not tell, or contradicts, in sentences."""
    found = [f"{told.name}: {why}; no lines to paste" for why in faults(told)]
    if told.depends and told.slope is not None:
        slope = told.slope
        found.append(
            f"{told.name}: eta {'falls' if slope.value < 0.0 else 'grows'} with the"
            f" amplitude, by {slope.text()} for each theta/alpha of 1: restitution is"
            f" taken at {told.restitution[1]:.2g} alpha, since large impacts decide"
        )
    if told.sides_apart:
        right, left = told.side("alpha")
        found.append(
            f"{told.name}: alpha is {right.text('rad')} on the right side,"
            f" {left.text('rad')} on the left: unequal pivots and a sloping ground give"
            " the same trace"
        )
    if told.impacts < FEW:
        found.append(
            f"{told.name}: {told.impacts} impacts: the intervals are 5 to 10 % too"
            " narrow"
        )
    return found
