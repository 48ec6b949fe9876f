"""Stocky bodies whose mass centre is known, and what shakes them: drawn at random for what is told of their forces."""

from __future__ import annotations

import math

import numpy as np
from oracles.collocation import Body as Solved
from oracles.collocation import Edge

from rocking_cli import Motion, RockingParameters, cosine, pulse, sine
from rocking_cli.structures.parameters import Side

ACROSS = [sine(1), cosine(1.5), pulse("rectangular-impulse"), pulse("mavroeidis-papageorgiou"), sine(2).scaled(-1)]
UP = [sine(1.5), cosine(1), sine(3)]
KINDS = ("plain", "unequal", "one-sided", "damped")

Range = tuple[float, float]


def drawn(
    kind: str, random: np.random.Generator, alphas: Range, etas: Range, spread: float
) -> tuple[RockingParameters, Solved, tuple[float, float]]:
    """A body as the package takes it and as the integration does, with its arms [m]; spread: how far the angles of unequal edges differ."""
    p, alpha, kappa, eta = random.uniform(1.0, 3.0), random.uniform(*alphas), random.uniform(0.6, 1.0), random.uniform(*etas)
    arm, zeta, nonlinear = kappa * 9.81 / p**2, 0.05 if kind == "damped" else 0.0, bool(random.integers(2))
    if kind == "unequal":
        other, angle = p * random.uniform(0.9, 1.1), alpha * random.uniform(1.0 - spread, 1.0 + spread)
        sides = Side("left", p, alpha, math.tan(alpha), 1.0, eta, arm), Side("right", other, angle, math.tan(angle), 1.0, eta, arm)
        body = RockingParameters.of_sides("b", "prism", *sides)
        return body, Solved(Edge(other, angle, eta), Edge(p, alpha, eta), 0.0, nonlinear), (arm, arm)
    eta = -eta if kind == "one-sided" else eta
    body = RockingParameters("b", "block", p, alpha, eta, math.tan(alpha), 1.0, arm=arm, one_sided=kind == "one-sided", damping=zeta)
    edge = Edge(p, alpha, eta)
    return body, Solved(edge, None if kind == "one-sided" else edge, zeta, nonlinear), (arm, arm)


def ground(motion: Motion | None, a_g: float, omega_g: float, t: float) -> float:
    """Its acceleration [m/s2] at t [s], 0 without a motion."""
    return 0.0 if motion is None else a_g * float(motion.value(omega_g * t))
