"""One body at a time on floats: what a step may not miss; its answers stand in
samples/test_records.py.
"""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest
from support.bodies import ALPHA, random_body
from support.synthetic_records import RECORDS, motion_of_samples, noise

from rocking_cli import (
    Method,
    Outcome,
    RigidBodyEquation,
    System,
    cosine,
    response,
    sine,
)
from rocking_cli.dynamics.single.series_roots import first_root, turns

response_alone = partial(response, how="floats")


def test_a_body_that_bounces_for_ever_fails_as_on_arrays():
    system, motion = (
        System(RigidBodyEquation(ALPHA)),
        motion_of_samples(RECORDS[0][30:60], 0.05),
    )
    for a in (1.05, 1.5):
        assert (
            response_alone(system, motion, a, 0.5, 1.0).outcome
            == response(system, motion, np.array(a), np.array(0.5), 1.0).outcome
        )


def test_the_first_of_two_roots_is_found():
    """y = (t - 0.3)(t - 0.5): both ends are above the ground."""
    assert first_root((0.15, -0.8, 1.0), 1.0, 4.0, 0.0) == pytest.approx(0.3, rel=1e-14)
    assert first_root((0.1500001 + 0.01, -0.8, 1.0), 1.0, 4.0, 0.0) is None


def test_a_pair_of_turns_within_a_step():
    """y' = (x - 0.4)(x - 0.6)/2 + small: up, down and up again; and none where it only
    slows.
    """
    assert turns((1.0, 0.12, -0.25, 1.0 / 6.0), 1.0) == pytest.approx([0.4], rel=1e-12)
    assert turns((1.0, 0.13, -0.25, 1.0 / 6.0), 1.0) == []


@pytest.mark.slow
@pytest.mark.parametrize(
    "motion",
    [
        motion_of_samples(noise(60, 0.06, 3), 0.06),
        pytest.param(sine(2), marks=pytest.mark.soak),
        cosine(),
    ],
    ids=["record", "sine", "cosine"],
)
@pytest.mark.parametrize("kind", ["plain", "unequal", "one-sided"])
def test_a_body_loses_contact_where_it_does_on_arrays(kind, motion):
    random, seen = np.random.default_rng(4), set()
    for model in ("linear", "nonlinear"):
        body, _, _ = random_body(kind, random, (0.4, 1.2), (0.4, 0.9), 0.3)
        system = Method(model, 1e-10).system_of(body)
        cells = (
            system.least_uplift(motion) * np.geomspace(1.1, 7.0, 5),
            0.5 if motion.samples else 2.0,
            body.eta,
        )
        together, alone = (
            respond(system, motion, *cells, peaks=False).outcome
            for respond in (response, response_alone)
        )
        np.testing.assert_array_equal(alone, together)
        seen.update(alone.tolist())
    assert {Outcome.ROCKED, Outcome.LOST_CONTACT} <= seen
