"""The polynomials in the place of a linkage, against the linkage itself."""

import numpy as np
import pytest

from rocking_cli import load_structures
from rocking_cli.dynamics.references.tabulated import tabulated


def mechanisms(document):
    """(mechanism, alpha) of each side."""
    (structure,) = load_structures(f"configs/{document}.yaml")
    return [(side.mechanism, side.alpha) for side in structure.sides or (structure,)]


@pytest.mark.parametrize(
    "document", ["arch", "mechanism_portal", "wall_between_floors"]
)
def test_the_polynomials_are_the_linkage_to_rounding(document):
    """From below the ground, where the steps of a solver may end, to the rotation at
    which the links lock, where 1/sqrt(M) falls to zero like a root.
    """
    random = np.random.default_rng(3)
    for mechanism, alpha in mechanisms(document):
        functions = tabulated(mechanism, alpha)
        end = mechanism.reach_to(2.0 * alpha)
        places = random.uniform(-0.1 * alpha, end, 200)
        c = mechanism.coefficients(places)
        at_rest = mechanism.coefficients(0.0).inertia
        exact = np.stack([np.ones(200), c.lift / at_rest, c.push / at_rest])
        exact /= np.sqrt(c.inertia / at_rest)
        found = np.array([functions(float(theta)) for theta in places]).T
        assert np.all(np.abs(found - exact).max(axis=1) <= 1e-12 * np.abs(exact).max(1))


def test_where_no_polynomial_is_close_the_linkage_is_asked():
    """Up to the place where the links lock, where M is not analytic."""
    ((mechanism, alpha),) = mechanisms("mechanism")
    functions = tabulated(mechanism, alpha)
    at_rest = mechanism.coefficients(0.0).inertia
    for part in (0.5, 0.1, 1e-2, 1e-4, 1e-6):
        theta = mechanism.reach_to(2.0) * (1.0 - part)
        c = mechanism.coefficients(theta)
        root = np.sqrt(c.inertia / at_rest)
        exact = np.array([1.0, c.lift / at_rest, c.push / at_rest]) / root
        assert functions(theta) == pytest.approx(exact, rel=1e-11)
