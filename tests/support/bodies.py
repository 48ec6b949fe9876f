"""Bodies drawn at random, as the package takes them and as the integration does, and
what shakes them.
"""

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from oracles.collocation import Body as Solved
from oracles.collocation import Edge, Shaking

from rocking_cli import (
    LinearEquation,
    Method,
    Motion,
    Outcome,
    RigidBodyEquation,
    RockingParameters,
    System,
    cosine,
    load_structures,
    parse_grid,
    pulse,
    response,
    sine,
    time_history,
)
from rocking_cli.dynamics.contacts.contact import OneSided, Unequal
from rocking_cli.motions import Harmonic, Piece
from rocking_cli.motions.biaxial import with_vertical
from rocking_cli.motions.polyline import Polyline
from rocking_cli.responses.ground_forces import GroundForceExtremes
from rocking_cli.structures.parameters import Side

ACROSS = [
    sine(1),
    cosine(1.5),
    pulse("rectangular-impulse"),
    pulse("mavroeidis-papageorgiou"),
    sine(2).scaled(-1),
]
UP = [
    sine(1.5),
    cosine(1),
    pulse("rectangular-impulse"),
    Motion("other", (Piece(0.0, 4.0 * math.pi, (Harmonic(1.0, 2.7, 0.3),)),)),
]
KINDS = ("plain", "unequal", "one-sided", "damped")

Range = tuple[float, float]
ALPHA, LEFT = 0.25, 0.2


def unequal(*rotation: float) -> Unequal:
    """A contact of two edges on which y = 1 is so much of theta/alpha."""
    return Unequal(
        drive=(1.0, 0.8), omega=(1.0, 1.15), eta=(1.05, 0.6), rotation=rotation
    )


(ARCH,) = load_structures(Path(__file__).parents[2] / "configs/arch.yaml")
ANGLES = [math.sin(alpha) / alpha for alpha in (ALPHA, LEFT)]
_SYSTEMS = {
    "the oscillator": (System(LinearEquation(), scale=ALPHA), 0.9),
    "the oscillator on one side": (System(LinearEquation(), OneSided(), ALPHA), -0.5),
    "the oscillator of unlike edges": (
        System(LinearEquation(), unequal(1.0, 1.0), ALPHA),
        0.9,
    ),
    "the damped oscillator": (System(LinearEquation(0.05), scale=ALPHA), 0.9),
    "the damped oscillator on one side": (
        System(LinearEquation(0.02), OneSided(), ALPHA),
        -0.6,
    ),
    "the damped oscillator of unlike edges": (
        System(LinearEquation(0.1), unequal(1.0, 1.0), ALPHA),
        0.9,
    ),
    "a body": (System(RigidBodyEquation(ALPHA), scale=ALPHA), 0.9),
    "a body on one side": (System(RigidBodyEquation(0.5), OneSided(), 0.5), -0.5),
    "a damped body of unlike edges": (
        System(RigidBodyEquation((ALPHA, LEFT), damping=0.05), unequal(*ANGLES), ALPHA),
        0.9,
    ),
    "an arch": (Method("nonlinear").system_of(ARCH), 0.9),
}
SYSTEMS = {  # each has this restitution
    name: (system.with_restitution(eta), eta)
    for name, (system, eta) in _SYSTEMS.items()
}
# every equation and every kind of edge, in the tests outside the soak
QUICK = (
    "the oscillator of unlike edges",
    "a body on one side",
    "a damped body of unlike edges",
    "an arch",
)


def random_body(
    kind: str,
    random: np.random.Generator,
    alphas: Range,
    etas: Range,
    spread: float,
    zetas: Sequence[float] = (0.05,),
) -> tuple[RockingParameters, Solved, float]:
    """A body as the package takes it and as the integration does, with the arm from its
    edges to its mass centre [m].

    kind: words of KINDS, and `linear` or `nonlinear`, by chance if neither is there;
    spread: how far the angles of unequal edges differ.
    """
    p, alpha, kappa, eta = (
        random.uniform(1.0, 3.0),
        random.uniform(*alphas),
        random.uniform(0.6, 1.0),
        random.uniform(*etas),
    )
    arm, zeta = (
        kappa * 9.81 / p**2,
        float(random.choice(zetas)) if "damped" in kind else 0.0,
    )
    nonlinear = "nonlinear" in kind if "linear" in kind else bool(random.integers(2))
    if "unequal" in kind:
        other, angle, back = (
            p * random.uniform(0.9, 1.1),
            alpha * random.uniform(1.0 - spread, 1.0 + spread),
            random.uniform(*etas),
        )
        sides = (
            Side("left", p, alpha, math.tan(alpha), 1.0, eta, arm),
            Side("right", other, angle, math.tan(angle), 1.0, back, arm),
        )
        body = RockingParameters.of_sides("b", "prism", *sides, damping=zeta)
        return (
            body,
            Solved(Edge(other, angle, back), Edge(p, alpha, eta), zeta, nonlinear),
            arm,
        )
    one_sided = "one-sided" in kind
    eta = -eta if one_sided else eta
    body = RockingParameters(
        name="b",
        structure="block",
        p=p,
        alpha=alpha,
        eta=eta,
        uplift=math.tan(alpha),
        a_scale=1.0,
        arm=arm,
        one_sided=one_sided,
        damping=zeta,
    )
    edge = Edge(p, alpha, eta)
    return body, Solved(edge, None if one_sided else edge, zeta, nonlinear), arm


def shaking(motion: Motion, a_g: float, omega_g: float) -> Shaking:
    """The ground of a motion, as the integration takes it."""
    up = np.zeros_like if motion.vertical is None else motion.vertical.value
    return Shaking.of(motion.value, a_g, omega_g, motion.marks, up)


def shaking_of(
    body: RockingParameters, motion: Motion, amplitude: float, omega: float
) -> Shaking:
    """The same of a body's A and Omega."""
    return shaking(motion, float(body.ground_acceleration(amplitude)), omega * body.p)


def rotation_under(
    structure: RockingParameters,
    a_g: float,
    period: float,
    motion: Motion | None = None,
    *,
    tolerance: float = 1e-12,
    how: str = "arrays",
) -> float | None:
    """max |theta|/alpha by the nonlinear equation under a motion, one cycle of a sine
    by default, of a_g [m/s2], reversed if negative, and T_g [s]; None if it overturns.
    """
    found = response(
        Method("nonlinear", tolerance).system_of(structure),
        (motion or sine()).scaled(math.copysign(1.0, a_g)),
        structure.dimensionless_amplitude(abs(a_g)),
        2.0 * math.pi / period / structure.p,
        structure.eta,
        how=how,
    )
    outcome = Outcome(int(found.outcome))
    assert outcome.overturned or outcome is Outcome.ROCKED
    return None if outcome.overturned else float(found.theta_ratio)


def forces_of(
    body: RockingParameters,
    motion: Motion,
    amplitude: float,
    omega: float,
    method: Method,
) -> GroundForceExtremes:
    """The extremes of the forces on the ground along the history."""
    found = time_history(
        body, motion, parse_grid(f"A={amplitude!r},Omega={omega!r}"), [method]
    )
    return found.forces[method.model].extremes


def random_shaking(
    random: np.random.Generator,
    body: RockingParameters,
    shares: Sequence[float],
    amplitudes: Range,
    recorded: bool = False,
) -> tuple[Motion, float, float]:
    """(motion, A, Omega): a pulse, or a record in its own time, with another one
    upwards, at the most one of `shares` times as strong.
    """
    across, up, omega = (
        ACROSS[random.integers(len(ACROSS))],
        UP[random.integers(len(UP))],
        random.uniform(0.7, 10.0),
    )
    if recorded:
        t, omega = 0.15 * np.arange(23), 1.0 / body.p
        rows = np.pad(random.uniform(-1.0, 1.0, (2, 21)), ((0, 0), (1, 1)))
        across, up = (
            Polyline("r", t[:-1], t[1:], row[:-1], np.diff(row) / 0.15, 1.0)
            for row in rows
        )
    share = shares[random.integers(len(shares))] * random.uniform(-1.0, 1.0)
    return (
        with_vertical(across, up, share) if share else across,
        random.uniform(*amplitudes),
        omega,
    )


class OnSeries(LinearEquation):
    """The linear oscillator, followed by its Taylor series under every motion."""

    def has_exact_flow(self, segments):
        return False
