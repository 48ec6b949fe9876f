"""The recurrences as straight-line code on floats, against those on arrays and against what they solve."""

from __future__ import annotations

import numpy as np
import pytest

from rocking_cli import LinearEquation, Method, RigidBodyEquation, load_structures
from rocking_cli.dynamics.equations.equation import Ramp
from rocking_cli.dynamics.equations.taylor import factors_for
from rocking_cli.dynamics.single.recurrence import compiled

ORDER = 11
EQUATIONS = {
    "linear": LinearEquation(),
    "damped linear": LinearEquation(0.1),
    "rigid body": RigidBodyEquation(0.3),
    "damped rigid body": RigidBodyEquation(0.3, damping=0.2),
    "mechanism": None,
}


@pytest.mark.parametrize("weight", [None, (0.8, 0.3)], ids=["steady", "weighed"])
@pytest.mark.parametrize("name", EQUATIONS)
def test_the_same_terms_as_on_arrays(name, weight):
    equation = EQUATIONS[name] or Method("nonlinear").system_of(load_structures("configs/arch.yaml")[0]).equation
    law = equation.law(1.0)
    y, v, h, a, g = 0.3, -0.7, 0.2, 1.3, -0.4
    unit = np.full(2, h)
    pair = None if weight is None else (np.full(2, weight[0]), np.full(2, weight[1]))
    factors = factors_for(unit, np.full(2, ORDER))
    expected = equation.ramp_terms(np.full(2, y), np.full(2, v), Ramp(np.full(2, a), np.full(2, g), unit, factors, None, pair))[:, 0]
    local = None if law.local is None else law.local(y, ORDER - 1)[1]
    code = compiled(law, ORDER, equation.damping, True, weight is not None)
    found = np.array(code.terms(y, v, h, a, g, *(weight or ()), None, local))
    np.testing.assert_allclose(found, expected, rtol=2e-12, atol=1e-15)
    listed = compiled(law, ORDER, equation.damping, False, weight is not None)
    lines = [[first, rise, *[0.0] * (ORDER - 3)] for first, rise in ((a, g), weight or (1.0, 0.0))]
    np.testing.assert_allclose(listed.terms(y, v, h, *lines[: 1 if weight is None else 2], None, local), found, rtol=1e-13, atol=1e-18)


def test_a_force_that_is_known_takes_the_place_of_its_difference():
    code = compiled(RigidBodyEquation(0.3).law(1.0), ORDER, 0.0, True, False)
    assert code.terms(0.0, 0.0, 0.1, 1.0, 0.5, 0.0)[2] == 0.0
