"""Bodies drawn at random, as the package takes them and as the integrations do, and what shakes them."""

import math
from collections.abc import Sequence
from functools import partial

import numpy as np
from oracles.collocation import Body as Solved
from oracles.collocation import Edge
from oracles.vertical_motion import Shaking

from rocking_cli import Motion, RockingParameters, cosine, pulse, sine
from rocking_cli.motions.biaxial import with_vertical
from rocking_cli.motions.polyline import Polyline
from rocking_cli.structures.parameters import Side

ACROSS = [sine(1), cosine(1.5), pulse("rectangular-impulse"), pulse("mavroeidis-papageorgiou"), sine(2).scaled(-1)]
UP = [sine(1.5), cosine(1), sine(3)]
KINDS = ("plain", "unequal", "one-sided", "damped")

Range = tuple[float, float]


def drawn(
    kind: str, random: np.random.Generator, alphas: Range, etas: Range, spread: float, zetas: Sequence[float] = (0.05,)
) -> tuple[RockingParameters, Solved, tuple[float, float]]:
    """A body as the package takes it and as the integration does, with its arms [m].

    kind: words of KINDS, and `linear` or `nonlinear`, by chance if neither is there; spread: how far the angles of unequal edges differ.
    """
    p, alpha, kappa, eta = random.uniform(1.0, 3.0), random.uniform(*alphas), random.uniform(0.6, 1.0), random.uniform(*etas)
    arm, zeta = kappa * 9.81 / p**2, float(random.choice(zetas)) if "damped" in kind else 0.0
    nonlinear = "nonlinear" in kind if "linear" in kind else bool(random.integers(2))
    if "unequal" in kind:
        other, angle, back = p * random.uniform(0.9, 1.1), alpha * random.uniform(1.0 - spread, 1.0 + spread), random.uniform(*etas)
        sides = Side("left", p, alpha, math.tan(alpha), 1.0, eta, arm), Side("right", other, angle, math.tan(angle), 1.0, back, arm)
        body = RockingParameters.of_sides("b", "prism", *sides, damping=zeta)
        return body, Solved(Edge(other, angle, back), Edge(p, alpha, eta), zeta, nonlinear), (arm, arm)
    one_sided = "one-sided" in kind
    eta = -eta if one_sided else eta
    body = RockingParameters("b", "block", p, alpha, eta, math.tan(alpha), 1.0, arm=arm, one_sided=one_sided, damping=zeta)
    edge = Edge(p, alpha, eta)
    return body, Solved(edge, None if one_sided else edge, zeta, nonlinear), (arm, arm)


def ground(motion: Motion | None, a_g: float, omega_g: float, t: float) -> float:
    """Its acceleration [m/s2] at t [s], 0 without a motion."""
    return 0.0 if motion is None else a_g * float(motion.value(omega_g * t))


def shaking(motion: Motion, body: RockingParameters, amplitude: float, omega: float) -> Shaking:
    """The ground of a motion under a body, as `swing` takes it."""
    a_g, omega_g = float(body.ground_acceleration(amplitude)), omega * body.p
    across, up = (partial(ground, m, a_g, omega_g) for m in (motion, motion.vertical))
    marks = tuple(float(piece.stop) / omega_g for piece in motion.pieces)
    return Shaking(across, up, marks[-1], marks)


def shaken(
    random: np.random.Generator, body: RockingParameters, shares: Sequence[float], amplitudes: Range, recorded: bool = False
) -> tuple[Motion, float, float]:
    """(motion, A, Omega): a pulse, or a record in its own time, with another one upwards, at the most one of `shares` times as strong."""
    across, up, omega = ACROSS[random.integers(len(ACROSS))], UP[random.integers(len(UP))], random.uniform(1.0, 10.0)
    if recorded:
        t, omega = 0.15 * np.arange(23), 1.0 / body.p
        rows = np.pad(random.uniform(-1.0, 1.0, (2, 21)), ((0, 0), (1, 1)))
        across, up = (Polyline("r", t[:-1], t[1:], row[:-1], np.diff(row) / 0.15, 1.0) for row in rows)
    share = shares[random.integers(len(shares))] * random.uniform(-1.0, 1.0)
    return with_vertical(across, up, share) if share else across, random.uniform(*amplitudes), omega
