"""The separatrix of mechanisms and damped bodies, against free motion from states just
inside and just outside it.
"""

import numpy as np
import pytest
from support.documents import built

from rocking_cli import Method
from rocking_cli.responses.separatrix import separatrix

ARCH = (
    "{kind: arch, name: A, radius: 10, angle: 157.5 deg, thickness: 1.5, voussoirs: 7}"
)
DAMPED = "{kind: block, name: B, width: 0.5, height: 2, damping: 0.1}"


@pytest.mark.parametrize(
    ("text", "model"), [(ARCH, "nonlinear"), (DAMPED, "nonlinear"), (DAMPED, "linear")]
)
@pytest.mark.parametrize("at", [0, 40, 80, 130])
def test_a_body_just_inside_comes_back_and_one_just_outside_falls(text, model, at):
    """The reference path's rates from there on, in (theta, w)."""
    body = built(text)
    ratio, rate = next(iter(separatrix(body, Method(model), 1.5)))
    edge = Method(model).problem_of(body).edges[1]
    spin = edge.of(ratio[at] * body.alpha, 1.0, 0.0, 1.0)[0]  # theta' of w = 1
    for share, falls in ((0.999, False), (1.001, True)):
        beyond = at > 100  # there a body comes back if it is fast enough
        theta, w = (
            ratio[at] * body.alpha,
            rate[at] * body.alpha / spin * (2.0 - share if beyond else share),
        )
        for _ in range(1000):
            theta, w = _after(edge, theta, w, 0.02)
            if theta < 0.0 or (theta > 1.4 * body.alpha and w > 0.0):
                break
        assert (theta > 0.0) == falls


def _after(edge, theta, w, h):
    """A step of the classical Runge-Kutta method."""

    def at(share, by):
        return np.array(
            edge.of(theta + share * h * by[0], w + share * h * by[1], 0.0, 1.0)
        )

    k1 = at(0.0, (0.0, 0.0))
    k2 = at(0.5, k1)
    k3 = at(0.5, k2)
    k4 = at(1.0, k3)
    theta, w = np.array([theta, w]) + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
    return float(theta), float(w)
