"""The slower, independent path to one cell of a body that has no document."""

from __future__ import annotations

import math

from rocking_cli import Method, Motion, Outcome, RockingParameters


def reference(motion: Motion, amplitude: float, omega: float, eta: float, alpha: float | None = None) -> tuple[Outcome, float]:
    """(outcome, max |theta|/alpha) of the linear oscillator, or of a rigid body of this alpha [rad]."""
    angle = alpha or 0.1
    body = RockingParameters("body", "block", 1.0, angle, eta, math.tan(angle), 1.0)
    return Method("nonlinear" if alpha else "linear").reference_of(body)(motion, amplitude, omega, eta)
