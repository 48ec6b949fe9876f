"""Blocks over alpha and T that leave the ground: against an integration that shares no
code, and against blocks of a size.
"""

from __future__ import annotations

import math
from collections import Counter

import numpy as np
import pytest
from oracles.collocation import Body as Solved
from oracles.collocation import Edge, Shaking
from oracles.ground_forces import asked
from support.documents import built
from support.record_layouts import wave
from support.soak import quick
from support.synthetic_records import recorded

from rocking_cli import Axis, Method, Outcome, Spectrum, response
from rocking_cli.spectra.record_scene import angles_scene
from rocking_cli.spectra.sweep import spectrum_of
from rocking_cli.spectra.sweep_options import SweepOptions

SHORT = recorded(wave(12, 30.0), 0.1)


def judged(
    samples: np.ndarray,
    dt: float,
    degrees: np.ndarray,
    periods: np.ndarray,
    eta: float | None,
    model: str,
) -> Counter:
    """How often blocks keep and lose the ground, of those that do not overturn; both
    ways must tell the same of every cell.
    """
    scene = angles_scene(
        Axis("alpha", np.radians(degrees)),
        Axis("T", periods),
        [recorded(samples, dt)],
        eta,
        Method(model),
    )
    found, times, seen = (
        spectrum_of(scene, SweepOptions(workers=1, check=0)),
        dt * np.arange(samples.size),
        Counter(),
    )
    shaking = Shaking(
        lambda t: np.interp(t, times, samples), np.zeros_like, tuple(times[1:].tolist())
    )
    for j, block in enumerate(scene.structures):
        for k, period in enumerate(periods.tolist()):
            p = 2.0 * math.pi / period
            edge, arm = Edge(p, block.alpha, block.eta), 0.75 * 9.81 / p**2
            known, said = (
                asked(Solved(edge, edge, 0.0, model == "nonlinear"), arm, shaking),
                Outcome(int(found.outcome[0, j, k])),
            )
            lost = (
                known.answer.outcome in ("rocked", "no_uplift") and known.fz_min <= 0.0
            )
            assert said.flag == ("lost_contact" if lost else known.answer.outcome), (
                degrees[j],
                period,
                known,
            )
            seen[said] += 1
    return seen


def test_blocks_of_an_angle_leave_the_ground_where_an_integration_says():
    seen = judged(
        wave(12, 30.0), 0.1, np.array([12.0, 50.0]), np.array([6.0]), 0.5, "nonlinear"
    )
    assert min(seen[Outcome.ROCKED], seen[Outcome.LOST_CONTACT]) > 0


@pytest.mark.soak
@pytest.mark.parametrize(
    ("eta", "degrees"),
    [
        (None, (15.0, 54.0)),
        (0.5, (15.0, 65.0)),
        (0.8, (15.0, 65.0)),
        (0.95, (15.0, 65.0)),
    ],
)
@pytest.mark.parametrize("model", ["nonlinear", "linear"])
def test_no_stocky_block_of_many_is_said_to_rock_where_it_leaves_the_ground(
    eta, degrees, model
):
    random, seen = np.random.default_rng(5), Counter()
    for _ in range(6):
        samples = np.append(random.uniform(-1.0, 1.0, 13), 0.0)
        samples *= random.uniform(1.1, 5.0) * 9.81 / np.abs(samples).max()
        seen += judged(
            samples,
            0.08,
            np.sort(random.uniform(*degrees, 4)),
            np.sort(random.uniform(0.6, 8.0, 5)),
            eta,
            model,
        )
    assert min(seen[Outcome.ROCKED], seen[Outcome.LOST_CONTACT]) > 0


DEGREES, PERIODS = (12.0, 50.0), (1.5, 6.0)


def swept(method: Method, *quantities: str, check: int = 0) -> Spectrum:
    """A slender angle beside a stocky one."""
    axes = Axis("alpha", np.radians(DEGREES)), Axis("T", np.array(PERIODS))
    return spectrum_of(
        angles_scene(*axes, [SHORT], 0.5, method),
        SweepOptions(workers=1, check=check, quantities=quantities),
    )


@pytest.mark.slow
@pytest.mark.parametrize("model", quick(("linear", "nonlinear"), "nonlinear"))
def test_what_is_said_of_an_angle_is_said_of_blocks_of_that_angle(model):
    """A condition beside changes no outcome, and the slower path agrees."""
    method = Method(model)
    plain, found = swept(method, check=4), swept(method, "condition")
    assert (plain.summary.checked_cells, plain.summary.misjudged) == (4, 0)
    np.testing.assert_array_equal(plain.outcome, found.outcome)
    assert {Outcome.ROCKED, Outcome.LOST_CONTACT} <= set(found.outcome.flat)
    for j, angle in enumerate(DEGREES):
        for k, period in enumerate(PERIODS):
            radius = 0.75 * 9.81 / (2.0 * math.pi / period) ** 2
            block = built(
                f"kind: block\nradius: {radius!r}\nalpha: {angle!r}"
                " deg\nrestitution: 0.5"
            )
            at = (
                np.atleast_1d(block.dimensionless_amplitude(SHORT.acceleration)),
                np.array([1.0 / block.p]),
                block.eta,
            )
            assert (
                found.outcome[0, j, k]
                == response(method.system_of(block), SHORT.motion, *at).outcome[0]
            )
    lost = plain.outcome == Outcome.LOST_CONTACT
    assert np.isnan(found.condition[lost]).all()
    assert np.isnan(plain.velocity_ratio[lost]).all()


def test_the_linear_equation_beside_looks_at_each_angle_too():
    both = swept(Method("nonlinear"), "linear")
    np.testing.assert_array_equal(
        both.quantities["outcome_linear"], swept(Method()).outcome
    )
    assert Outcome.LOST_CONTACT in both.quantities["outcome_linear"]
