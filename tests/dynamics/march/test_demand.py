"""What cells ask of the ground, against the forces along their histories, whose extremes are found in another way."""

from __future__ import annotations

import math

import numpy as np
import pytest

from rocking_cli import Method, Outcome, build_structure, cosine, parse_documents, parse_grid, pulse, response, sine
from rocking_cli.dynamics.march.demand import Course, _extremes
from rocking_cli.dynamics.response import response_with_demands
from rocking_cli.errors import UsageError
from rocking_cli.responses.time_history import time_history
from rocking_cli.spectra.scene import PulseScene
from rocking_cli.spectra.sweep import spectrum_of

MOTIONS = [sine(1), sine(2), pulse("rectangular-impulse"), cosine(1)]

BLOCK = "kind: block\nwidth: 0.6\nheight: 3\n"
BODIES = {"block": BLOCK, "one-sided": BLOCK + "one_sided: true\nrestitution: -0.4\n"}


def body_of(text):
    return build_structure(parse_documents(text)[0])


def worst(text, model, motion, cells, seed):
    """(cells compared, largest differences of friction and of fz_min from the histories)."""
    body, method, random = body_of(text), Method(model, 1e-11), np.random.default_rng(seed)
    amplitude, omega = random.uniform(0.6, 4.0, cells), random.uniform(0.8, 8.0, cells)
    found, asked = response_with_demands(method.system_of(body), motion, amplitude, omega, body.eta)
    differences = [(0.0, 0.0)]
    for i in np.flatnonzero(found.outcome == Outcome.ROCKED):
        grid = parse_grid(f"A={float(amplitude[i])!r},Omega={float(omega[i])!r}")
        history = time_history(body, motion, grid, [method], duration=(motion.duration / omega[i] + 40.0) / body.p)
        demands = history.forces[model].demands
        differences.append((abs(demands.friction.friction - asked["friction"][i]), abs(demands.fz_min - asked["fz_min"][i])))
    return len(differences) - 1, *np.max(differences, axis=0)


@pytest.mark.parametrize("model", ["linear", "nonlinear"])
@pytest.mark.parametrize("name", BODIES)
def test_the_extremes_are_those_of_the_histories(name, model):
    count, friction, least = worst(BODIES[name], model, sine(1).scaled(-1), 3, 4)
    assert count > 0
    assert max(friction, least) < 1e-9


@pytest.mark.soak
@pytest.mark.parametrize("model", ["linear", "nonlinear"])
@pytest.mark.parametrize("motion", MOTIONS, ids=lambda m: m.name)
def test_the_extremes_of_many_cells_are_those_of_their_histories(motion, model):
    count, friction, least = worst(BODIES["block"], model, motion, 80, 9)
    assert count >= 3  # most bodies overturn under a rectangular pulse
    assert max(friction, least) < 1e-9


def test_a_body_that_stays_at_rest_needs_the_ground_acceleration_over_g():
    body = body_of(BODIES["block"])
    for model in ("linear", "nonlinear"):
        system = Method(model).system_of(body)
        _, asked = response_with_demands(system, sine(1), [0.3, 0.6], 3.0, body.eta)
        assert asked["friction"] == pytest.approx(np.array([0.3, 0.6]) * body.alpha, rel=1e-14)
        assert asked["fz_min"].tolist() == [1.0, 1.0]


def test_following_the_forces_changes_no_bit_of_the_rest():
    body = body_of(BODIES["block"])
    amplitude, omega = np.meshgrid(np.linspace(0.5, 6.0, 9), np.linspace(0.6, 8.0, 7))
    system = Method("nonlinear").system_of(body)
    plain, (with_forces, asked) = (f(system, sine(1), amplitude, omega, body.eta) for f in (response, response_with_demands))
    assert np.array_equal(plain.theta_ratio, with_forces.theta_ratio, equal_nan=True)
    assert np.array_equal(plain.outcome, with_forces.outcome)
    assert np.array_equal(np.isnan(asked["friction"]), np.isnan(plain.theta_ratio))


def test_sweeps_hold_them_and_refuse_what_they_do_not_follow():
    grid, method = parse_grid("A=0.5:3:4,Omega=2:4:2"), Method("nonlinear")
    scene = PulseScene((body_of(BODIES["block"]),), grid, sine(1), method)
    found = spectrum_of(scene, quantities=("friction", "fz_min"))
    assert found.beside["friction"].shape == found.theta_ratio.shape
    assert np.nanmin(found.beside["friction"]) == pytest.approx(0.5 * scene.structures[0].alpha, rel=1e-14)
    for text, words in (("kind: block\nwidth: 2\nheight: 2.5\n", "alpha up to 0.6"), (BODIES["block"] + "damping: 0.1\n", "undamped")):
        with pytest.raises(UsageError, match=words):
            spectrum_of(PulseScene((body_of(text),), grid, sine(1), method), quantities=("fz_min",))
    mass = body_of(f"kind: point_mass\nradius: 3\nalpha: {math.atan(0.2)}\nrestitution: {scene.structures[0].eta!r}\n")
    with pytest.raises(UsageError, match="not its forces"):
        spectrum_of(PulseScene((*scene.structures, mass), grid, sine(1), Method()), quantities=("friction",))


def test_the_extreme_of_a_cubic():
    """x (1 - x)^2 on [0, 1]: 4/27 at 1/3."""
    ends = (Course(np.zeros((2, 1)), np.array([[1.0], [1.0]])), Course(np.zeros((2, 1)), np.zeros((2, 1))))
    most, where, bend = _extremes(*ends, np.ones(1))
    assert most.ravel() == pytest.approx([4 / 27, 4 / 27], rel=1e-14)
    assert where.ravel() == pytest.approx([1 / 3, 1 / 3], rel=1e-14)
    assert bend.ravel() == pytest.approx([-2.0, -2.0], rel=1e-13)
