"""Independent answers to one cell that tests share, and motions and lanes
to ask for.
"""

import math
from typing import Any

import numpy as np
from oracles.collocation import Answer, Body, Edge, integrate
from support.bodies import shaking

from rocking_cli import Method, Motion, Outcome, RockingParameters
from rocking_cli.dynamics.lanes import Lanes
from rocking_cli.motions import Harmonic, Piece

# One sine cycle, linear, eta = 0.9: overturning after impact from, to; without impact
# from (traced by two independent programs and the closed form of Fig. 2; given to the
# digits shown).
INTERVALS = [
    (2.0, 1.2252, 2.3144, 2.3499, 1e-4),
    (3.0, 1.4036, 3.4847, 3.6311, 1e-4),
    (4.0, 1.7954, 4.8501, 5.2390, 1e-4),
    (5.0, 3.01860, 6.31807, 7.16813, 1e-5),
    (6.0, 5.1642, 7.6699, 9.4170, 1e-4),
]
LADDER = Motion(
    "ladder",
    (
        Piece(0, 1, (), 0.5, -1.2),
        Piece(1, 2.5, (), 1.0),
        Piece(2.5, 4, (), -0.5),
        Piece(4, 6, (), -0.9, 0.9),
    ),
)
MIXED = Motion(
    "mixed",
    (
        Piece(
            0,
            12,
            (Harmonic(0.5, 1, 0.3), Harmonic(0.3, 1.7, 1.0), Harmonic(-0.4, 0.6, 0.2)),
            0.1,
            0.02,
        ),
    ),
)


def reference(
    motion: Motion,
    amplitude: float,
    omega: float,
    eta: float,
    alpha: float | None = None,
) -> tuple[Outcome, float]:
    """(outcome, max |theta|/alpha) of the linear oscillator, or of a rigid body of this
    alpha [rad], by the package's slower path.
    """
    angle = alpha or 0.1
    body = RockingParameters(
        name="body",
        structure="block",
        p=1.0,
        alpha=angle,
        eta=eta,
        uplift=math.tan(angle),
        a_scale=1.0,
    )
    return Method("nonlinear" if alpha else "linear").reference_of(body)(
        motion, amplitude, omega
    )


def integrated(
    motion: Motion,
    amplitude: float,
    omega: float,
    eta: float,
    alpha: float | None = None,
) -> Answer:
    """The answer of the same bodies by collocation, which shares no code with the
    package; errors are 1e-15 of the cell's condition.
    """
    edge = Edge(1.0, alpha or 0.1, eta)
    body = Body(edge, edge, nonlinear=alpha is not None)
    return integrate(
        body, shaking(motion, amplitude * edge.alpha * body.gravity, omega)
    )


def answers(
    motion: Motion, *cells: np.ndarray, alpha: float | None = None
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(outcome codes, largest |theta|/alpha, impacts) of `integrated` for arrays of A,
    Omega and eta.
    """
    found = [
        integrated(motion, *map(float, cell), alpha)
        for cell in zip(*cells, strict=True)
    ]
    codes = [Outcome[answer.outcome.upper()] for answer in found]
    return (
        np.array(codes),
        np.array([answer.rotation for answer in found]),
        np.array([answer.impacts for answer in found]),
    )


def lanes(**given: Any) -> Lanes:
    """Lanes of these numbers, broadcast against each other; other numbers are those of
    a body at rest under A = Omega = eta = 1.
    """
    size = np.broadcast_shapes((1,), *(np.shape(x) for x in given.values()))
    plain = (
        dict.fromkeys(("amplitude", "omega", "eta", "side"), 1.0)
        | {"cell": np.arange(size[0])}
        | given
    )
    whole = ("cell", "segment", "impacts", "steps")
    return Lanes(
        *(
            np.array(
                np.broadcast_to(
                    plain.get(x, 0), (4, *size) if x == "moments" else size
                ),
                dtype=int if x in whole else float,
            )
            for x in Lanes.__dataclass_fields__
        )
    )
