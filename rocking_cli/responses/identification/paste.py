"""Lines of a structure document to paste: `inset`, `restitution`, or the body."""

from __future__ import annotations

import math
from collections.abc import Mapping

from .identified import Estimate
from .told import Told
from .unknowns import INSET


def lines_of(told: Told) -> tuple[str, ...]:
    """Return the lines that one release gives."""
    head = (
        f"# {told.name}: {told.impacts} impacts, released at {told.ratio:.2f} alpha"
        f" ({told.found.model.theta[0]:.4g} rad)",
        f"# scatter between impacts {told.found.scatter:.1g}, between tests not known;"
        " +-: noise only, not the gain",
    )
    eta, x = told.restitution
    words = [f"at {x:.2g} alpha"] if x is not None else []
    if told.momentum is not None:
        words.append(f"momentum: {told.momentum:.3f}")
    restitution = _commented(f"restitution: {eta.text()}", ", ".join(words))
    if told.sides_apart:
        return *head, *_two_sided(told, eta, restitution)
    if told.fit == INSET and told.inset is not None and told.body is not None:
        assert told.body.rigid is not None
        share = 1.0 - told.inset.value / told.body.rigid.lever
        return *head, inset_line(told.inset, share), restitution
    p = float(told.found.model.p.mean())
    return *head, *_stated(p, told.alpha.value, f"eta: {eta.text()}")


def inset_line(inset: Estimate, share: float) -> str:
    """Return the line of an inset; share: half-width that is left."""
    return _commented(
        f"inset: {inset.text('mm', 1e-3)}",
        f"effective half-width {share:.3f} of the geometric",
    )


def lines_of_means(
    means: Mapping[str, Estimate],
    between: Mapping[str, float],
    head: str,
    lever: float | None,
) -> tuple[str, ...]:
    """Return the lines that several releases give; means: with the standard deviation
    of a test to come; between: that between tests; lever: of the body [m].
    """
    restitution = _commented(
        f"restitution: {means['eta'].text()}", f"between tests {between['eta']:.1g}"
    )
    if "inset" in means and lever:
        share = 1.0 - means["inset"].value / lever
        return head, inset_line(means["inset"], share), restitution
    if "alpha" not in means:
        return head, restitution
    alpha, p = means["alpha"].value, means["p"].value
    return head, *_stated(p, alpha, f"eta: {means['eta'].text()}")


def _commented(line: str, comment: str) -> str:
    return f"{line}  # {comment}" if comment else line


def _stated(p: float, alpha: float, eta: str) -> tuple[str, ...]:
    """Return the lines of a document of kind `parameters`. Without a_scale it would be
    alpha/lambda, which is no rigid body.
    """
    return (
        "kind: parameters",
        f"p: {p:.6g} rad/s",
        f"alpha: {alpha:.6g} rad",
        f"lambda: {math.tan(alpha):.6g}",
        "a_scale: 1",
        eta,
    )


def _two_sided(told: Told, eta: Estimate, restitution: str) -> tuple[str, ...]:
    """Return the lines of a body whose edges differ."""
    note = "# one restitution for both sides"
    right, left = told.found.model.alpha
    if told.fit == INSET and told.body is not None and told.body.height is not None:
        height, known = told.body.height, told.body.known.left_and_right[0]
        arm = known.arm or 0.0
        central = known_gyration(told.body.known.gravity, known.p, arm)
        return (
            note,
            "kind: rigid",
            f"right: {1e3 * height * math.tan(right):.5g} mm",
            f"left: {1e3 * height * math.tan(left):.5g} mm",
            f"height: {1e3 * height:.6g} mm",
            f"gyration: {1e3 * central:.6g} mm",
            restitution,
        )
    p = told.found.model.p
    sides = [
        f"  - {{side: {name}, p: {p[i]:.6g}, alpha: {alpha:.6g}, lambda:"
        f" {math.tan(alpha):.6g}, a_scale: 1, eta: {eta.value:.4f}}}"
        for i, (name, alpha) in enumerate((("right", right), ("left", left)))
    ]
    return note, "kind: parameters", "sides:", *sides


def known_gyration(gravity: float, p: float, arm: float) -> float:
    """Return the radius of gyration about the mass centre [m]: I = m g R/p^2 about the
    edge.
    """
    return math.sqrt(gravity * arm / p**2 - arm**2)
