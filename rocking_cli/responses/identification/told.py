"""What the fits of a release tell: estimates, rows, remarks, and lines to paste."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np

from ...arrays import Array
from .body import ALPHA, BOTH, INSET, KnownBody
from .checks import Residuals
from .fit import LINE_FROM, Mixed
from .identified import COLUMNS, Estimate, bounds

FEW = 6  # impacts: with fewer the intervals are too narrow
LOW = 0.3  # theta_0/alpha: released lower, alpha and p are hardly apart
DECIDES = 0.7  # theta/alpha of the impact that decides a fall
_KNOWN = 0.1  # relative standard deviation: an alpha less certain is not told
_APART = 3.0  # standard deviations
_SIDES = ("right", "left")


def is_certain(found: Mixed) -> bool:
    """False if a fit knows alpha so little that it is not told."""
    return found.deviation(found.motion.ln_slope[0]) <= _KNOWN


class Told(NamedTuple):
    """One release."""

    name: str  # of the trace
    found: Mixed  # the fit
    # by column; p is that of a fit of alpha and p; alpha and p are missing if they
    # cannot be told apart
    estimates: dict[str, Estimate]
    restitution: Estimate  # eta for a document
    at: float | None  # the theta/alpha at which it is taken, None for a mean
    insets: Array  # of the right and the left side [m]; zeros if none is fitted
    left: Residuals
    differ: bool  # True if the sides differ, though the fit takes them alike
    body: KnownBody | None  # None without a structure
    normal: float  # half the width of an interval over the standard deviation

    @property
    def p_structure(self) -> float | None:
        """p that the sizes give, with the inset that is found [rad/s]."""
        body = self.body
        return (
            None if body is None else float(np.exp(body.on(self.insets)[0][2:]).mean())
        )

    @property
    def apart(self) -> bool:
        """True if alpha of the two sides differs by 3 standard deviations."""
        slope, alpha = self.found.motion.ln_slope, self.found.motion.alpha
        sd = self.found.deviation(slope[0] - slope[1])
        return abs(math.log(alpha[0] / alpha[1])) > _APART * sd > 0.0


def told_of(
    name: str,
    found: Mixed,
    free: Mixed | None,
    left: Residuals,
    differ: bool,
    body: KnownBody | None,
    level: float,
) -> Told:
    """Return what a release tells. found: the fit; free: that of alpha and p, None if
    it fails; left: what fit A leaves; differ: see `Told`; level: of the intervals.
    """
    from scipy.special import ndtri, stdtrit

    shape, motion, count = found.first.model.shape, found.motion, found.x.size
    normal = float(ndtri(0.5 + 0.5 * level))
    # of a mean of so few
    student, of_slope = stdtrit(
        [count - 1, max(count - 2, 1)], 0.5 + 0.5 * level
    ).tolist()
    estimates: dict[str, Estimate] = {}
    sides = {"": np.full(2, 0.5)} | dict(
        zip(("_right", "_left"), np.eye(2), strict=True)
    )
    lever = body.lever if body is not None and shape.fit == INSET else None
    insets = np.broadcast_to(found.w[: 1 + shape.two_sides], 2) * (lever or 0.0)
    inset_slope = (lever or 0.0) * np.eye(2)[[0, 1 if shape.two_sides else 0]]
    for side, weights in sides.items() if shape.two_sides else [("", sides[""])]:
        if lever:
            sd = found.deviation(weights @ inset_slope)
            estimates[f"inset{side}"] = Estimate(float(weights @ insets), sd, normal)
        if shape.fit != BOTH or is_certain(found):
            alphas = weights * motion.alpha
            sd = found.deviation(alphas @ motion.ln_slope[:2])
            estimates[f"alpha{side}"] = Estimate(float(alphas.sum()), sd, normal)
        of_b = weights if shape.two_sides else np.eye(1)[0]
        estimates[f"eta{side}"] = found.of_eta(of_b, student)
    if "alpha" in estimates and free is not None:
        p = float(free.motion.p.mean())
        sd = free.deviation(p * free.motion.ln_slope[2])
        estimates["p"] = Estimate(p, sd, normal)
    at, restitution = None, estimates["eta"]
    if not shape.two_sides and count >= LINE_FROM:
        slope = found.of_eta(np.array([0.0, 1.0]), of_slope)
        estimates["eta_slope"] = slope
        if abs(slope.value) > slope.factor * slope.sd:
            at = min(DECIDES, float(found.x.max()))
            restitution = found.of_eta(np.array([1.0, at - found.x.mean()]), student)
    return Told(
        name, found, estimates, restitution, at, insets, left, differ, body, normal
    )


def row_of(told: Told) -> dict[str, Any]:
    """Return the row of a release, by COLUMNS, without its number."""
    found, body = told.found, told.body
    row = (
        dict.fromkeys(COLUMNS)
        | bounds(told.estimates)
        | {
            "trace": told.name,
            "impacts": found.x.size,
            "p_structure": told.p_structure,
            "eta_scatter": found.scatter,
            "noise": told.left.noise,
            "rms": told.left.rms,
            "offset": float(found.w[-3]),
            "drift": float(found.w[-2]),
            "unexplained": told.left.unexplained,
        }
    )
    if "alpha" in told.estimates:
        row["theta0_ratio"] = float(found.x[0])
    if body is not None:
        alpha = np.exp(body.on(np.zeros(2))[0][:2]).mean()
        row["alpha_ratio"] = float(found.motion.alpha.mean() / alpha)
        row["eta_momentum"] = body.on(told.insets)[1]
    return row


def impact_rows(told: Told) -> list[dict[str, Any]]:
    """Return a row for each impact, by IMPACT_COLUMNS, without the release."""
    motion, first, normal = told.found.motion, told.found.first, told.normal
    rows = []
    for k, eta in enumerate(motion.eta.tolist()):
        sd = told.found.deviation(eta * motion.ln_eta_slope[k])
        side = first.model.sides[k]
        rows.append(
            {
                "trace": told.name,
                "impact": k + 1,
                "t": float(motion.impacts[k]),
                "side": _SIDES[side],
                "theta_before": float(motion.theta[k]),
                "ratio": float(motion.theta[k] / motion.alpha[side]),
                **bounds({"eta": Estimate(eta, sd, normal)}),
                "eta_alone": float(first.motion.eta[k]),
            }
        )
    return rows


def faults(told: Told) -> Iterator[str]:
    """Yield why no line may be pasted, in sentences."""
    inset, p, sizes = *map(told.estimates.get, ("inset", "p")), told.p_structure
    if p and sizes and abs(p.value - sizes) > _APART * p.sd:
        yield (
            f"p of the trace is {p.value:.4g} +- {p.sd:.1g} rad/s, that of the sizes"
            f" {sizes:.4g}: sizes, time or a moving pivot are wrong"
        )
    if not told.left.is_noise:
        yield (
            f"the fit leaves {100.0 * told.left.unexplained:.2g} % of the first peak,"
            " which is no noise"
        )
    if told.body is None and ("alpha" not in told.estimates or told.found.x[0] < LOW):
        motion = told.found.motion
        best = float(motion.p[0] ** 2 * motion.alpha[0])
        sd = told.found.deviation(
            best * (2.0 * motion.ln_slope[2] + motion.ln_slope[0])
        )
        yield (
            f"alpha and p cannot be told apart: p2 alpha = {best:.4g} +- {sd:.1g}"
            " rad/s2 is what this trace says; give the structure or release higher"
        )
    if inset and inset.value + inset.factor * inset.sd < 0.0:
        yield (
            f"the inset is {inset.text('mm', 1e-3)}: the pivots would lie outside the"
            " edges: check the gain and the sizes"
        )
    if told.restitution.value > 1.0:
        yield f"eta is {told.restitution.text()}, above 1"
    if told.differ:
        yield (
            "the sides differ, or the ground slopes: one alpha does not fit both"
            " (`two_sides`)"
        )


def remarks_of(told: Told) -> tuple[str, ...]:
    """Return what the trace does not tell, or contradicts, in sentences."""
    found = [f"{why}; no lines to paste" for why in faults(told)]
    if told.at is not None:
        slope = told.estimates["eta_slope"]
        found.append(
            f"eta {'falls' if slope.value < 0.0 else 'grows'} with the amplitude, by"
            f" {slope.text()} for each theta/alpha of 1: restitution is taken at"
            f" {told.at:.2g} alpha, since large impacts decide"
        )
    if told.apart and "alpha" in told.estimates:
        right, left = (told.estimates[f"alpha_{side}"].text("rad") for side in _SIDES)
        found.append(
            f"alpha is {right} on the right side, {left} on the left: unequal pivots"
            " and a sloping ground give the same trace"
        )
    if told.found.x.size < FEW:
        found.append(
            f"{told.found.x.size} impacts: the intervals are 5 to 10 % too narrow"
        )
    return tuple(f"{told.name}: {one}" for one in found)


def lines_of(told: Told) -> tuple[str, ...]:
    """Return the lines of a document that one release gives; none with a fault."""
    if any(faults(told)):
        return ()
    found, motion, body = told.estimates, told.found.motion, told.body
    head = (
        f"# {told.name}: {told.found.x.size} impacts, released at"
        f" {told.found.x[0]:.2f} alpha ({motion.theta[0]:.4g} rad)",
        f"# scatter between impacts {told.found.scatter:.1g}, between tests not known;"
        " +-: noise only, not the gain",
    )
    if told.apart:
        return *head, *_two_sided(told)
    words = [f"at {told.at:.2g} alpha"] if told.at is not None else []
    if body is not None:
        words.append(f"momentum: {body.on(told.insets)[1]:.3f}")
    if told.found.first.model.shape.fit == ALPHA:
        found = found | {"p": Estimate(float(motion.p.mean()), 0.0)}
    found = found | {"eta": told.restitution}
    return *head, *document_lines(found, ", ".join(words), body)


def document_lines(
    found: Mapping[str, Estimate], comment: str, body: KnownBody | None
) -> tuple[str, ...]:
    """Return lines of a document: inset and restitution; alpha, p and eta; or
    restitution alone. comment: on restitution.
    """
    eta = found["eta"].text()
    restitution = f"restitution: {eta}" + (f"  # {comment}" if comment else "")
    if "inset" in found and body is not None and body.lever:
        share = 1.0 - found["inset"].value / body.lever
        return (
            f"inset: {found['inset'].text('mm', 1e-3)}  # effective half-width"
            f" {share:.3f} of the geometric",
            restitution,
        )
    if "alpha" not in found:
        return (restitution,)
    alpha = found["alpha"].value
    return (
        "kind: parameters",
        f"p: {found['p'].value:.6g} rad/s",
        f"alpha: {alpha:.6g} rad",
        f"lambda: {math.tan(alpha):.6g}",
        "a_scale: 1",  # else alpha/lambda, which is no rigid body
        f"eta: {eta}",
    )


def _two_sided(told: Told) -> tuple[str, ...]:
    """Return the lines of a body whose edges differ, with one restitution."""
    eta, motion, body = told.restitution, told.found.motion, told.body
    if told.insets.any() and body is not None and body.height is not None:
        side = body.known.left_and_right[0]
        arm = side.arm or 0.0
        # I = m g R/p^2 about the edge
        gyration = math.sqrt(body.known.gravity * arm / side.p**2 - arm**2)
        lengths = {
            **dict(zip(_SIDES, body.height * np.tan(motion.alpha), strict=True)),
            "height": body.height,
            "gyration": gyration,
        }
        return (
            "kind: rigid",
            *(f"{key}: {1e3 * x:.6g} mm" for key, x in lengths.items()),
            f"restitution: {eta.text()}  # one for both sides",
        )
    return (
        "kind: parameters  # one eta for both sides",
        "sides:",
        *(
            f"  - {{side: {side}, p: {p:.6g}, alpha: {alpha:.6g}, lambda:"
            f" {math.tan(alpha):.6g}, a_scale: 1, eta: {eta.value:.4f}}}"
            for side, alpha, p in zip(_SIDES, motion.alpha, motion.p, strict=True)
        ),
    )
