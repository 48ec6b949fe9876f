"""Many bodies of every kind against an integration that shares no code with the
package, on arrays and, under records, one at a time; `test_conformance.py` has some.
"""

import math
from functools import partial

import numpy as np
import pytest
from oracles.collocation import conditioning, integrate
from support.bodies import random_body, random_shaking, shaking_of

from rocking_cli import Method, Outcome, response

response_alone = partial(response, how="floats")

ERROR = 1e-10  # of theta/alpha where the cell's condition is 1 or less: ten tolerances


MANY = [
    (0.0, False, 2000, 2),
    (0.8, False, 500, 2),
    (0.0, True, 500, 2),
    (0.5, True, 200, 2),
]


@pytest.mark.soak
@pytest.mark.parametrize(
    ("share", "recorded", "count", "seed"),
    MANY,
)
@pytest.mark.parametrize("model", ["linear", "nonlinear"])
@pytest.mark.parametrize(
    "kind",
    [
        kind + damped
        for kind in ("symmetric", "unequal", "one-sided")
        for damped in ("", " damped")
    ],
)
def test_a_body_answers_as_an_independent_integration(
    kind, model, share, recorded, count, seed
):
    """Outcomes are equal where they are certain."""
    random, method, sensitive, asked, seen = (
        np.random.default_rng(seed),
        Method(model, 1e-11),
        0,
        0,
        set(),
    )
    while asked < count:
        structure, body, _ = random_body(
            f"{kind} {model}",
            random,
            (0.08, 0.4),
            (0.3, 0.98),
            0.4,
            (0.01, 0.05, 0.2, 0.6),
        )
        motion, amplitude, omega = random_shaking(
            random, structure, (share,), (0.8, 7.0), recorded
        )
        amplitude = (
            1.0 + 10.0 ** random.uniform(-3.0, -0.5)
            if random.random() < 0.2
            else amplitude
        )
        up = 0.0 if motion.vertical is None else motion.vertical.largest
        if (
            up * float(structure.ground_acceleration(amplitude))
            > 0.95 * structure.gravity
        ):
            continue  # the ground may fall away
        asked, shaking = asked + 1, shaking_of(structure, motion, amplitude, omega)
        answer, condition = integrate(body, shaking), None
        for respond in (response, response_alone) if recorded else (response,):
            found = respond(
                method.system_of(structure)._replace(body=None),
                motion,
                amplitude,
                omega,
                structure.eta,
            )
            same = Outcome(int(found.outcome)).flag == answer.outcome
            gap = (
                abs(answer.rotation - float(found.theta_ratio))
                if same and not math.isnan(answer.rotation)
                else 0.0
            )
            if same and gap <= ERROR:
                continue
            condition = conditioning(body, shaking) if condition is None else condition
            assert gap <= ERROR * condition if same else math.isinf(condition), (
                kind,
                model,
                motion.name,
                amplitude,
                omega,
                structure,
            )
        sensitive += condition is not None
        seen.add(answer.outcome)
    assert sensitive <= max(
        1.0, 0.01 * count
    )  # those that are only as sure as their condition allows
    assert len(seen) > 1
