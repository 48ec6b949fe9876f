"""The bound of the error of cells and of sweeps, against a tolerance of 1e-13 and the
independent solver; and a fault of the march itself, which a sweep must tell.
"""

import numpy as np
import pytest
from rocking_cli.dynamics.samples import exact
from support.documents import built
from support.record_layouts import wave
from support.synthetic_records import recorded

from rocking_cli import Method, load_records, parse_grid, response, spectrum
from rocking_cli.motions import pulse, sine
from rocking_cli.reports.summary import summary_lines
from rocking_cli.spectra.error_bound import Conditions
from rocking_cli.spectra.record_scene import scene_of_words
from rocking_cli.spectra.sweep import SweepOptions, spectrum_of

BODIES = {
    "slender": "kind: block\nwidth: 0.5 m\nheight: 2 m\nrestitution: 0.9",
    "stocky": "kind: block\nwidth: 2 m\nheight: 2.2 m\nrestitution: 0.7",
    "elastic": "kind: block\nwidth: 0.2 m\nheight: 2 m\nrestitution: 0.99",
}
MOTIONS = {
    "sine": sine(),
    "cycles": sine(4),
    "ricker": pulse("ricker-symmetric"),
    "record": recorded(wave(24, 3.0), 0.1).motion,
}
TOLERANCES = (1e-4, 1e-6, 1e-9, 1e-11)


def errors(body, motion, tolerance, count, how="arrays"):
    """(errors against a tolerance of 1e-13, bounds) of random cells that stand."""
    random = np.random.default_rng(20)
    structure = built(BODIES[body])
    amplitude = random.uniform(1.05, 5.0, count)
    omega = np.exp(random.uniform(np.log(0.6), np.log(10.0), count))
    found, exactly = (
        response(
            Method("nonlinear", t).system_of(structure),
            MOTIONS[motion],
            amplitude,
            omega,
            structure.eta,
            how=how,
        )
        for t in (tolerance, 1e-13)
    )
    known = (found.outcome == exactly.outcome) & np.isfinite(found.condition)
    bound = np.minimum(1.0, tolerance * found.condition[known])
    return np.abs(found.theta_ratio - exactly.theta_ratio)[known], bound


@pytest.mark.parametrize("tolerance", TOLERANCES)
@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize("body", BODIES)
def test_the_error_is_below_its_bound_and_not_far_below(body, motion, tolerance):
    error, bound = errors(body, motion, tolerance, 100)
    assert error.size >= 3
    assert (error <= bound + 1e-14).all()
    # Under a record the samples make the steps shorter than the tolerance asks for; of
    # a hundred cells the one with the largest bound may err little by chance.
    if motion != "record":
        assert bound.max() <= 1e7 * error.max()


@pytest.mark.soak
@pytest.mark.parametrize("tolerance", TOLERANCES)
@pytest.mark.parametrize("motion", MOTIONS)
@pytest.mark.parametrize("body", BODIES)
def test_the_error_of_thousands_of_cells_is_below_its_bound(body, motion, tolerance):
    error, bound = errors(body, motion, tolerance, 5_000)
    assert (error <= bound + 1e-14).all()


def test_one_cell_after_the_other_has_the_condition_of_arrays():
    for body in BODIES:
        (_, many), (_, one) = (
            errors(body, "cycles", 1e-9, 40, how) for how in ("arrays", "floats")
        )
        assert one == pytest.approx(many, rel=0.5)


def test_a_sweep_states_a_bound_above_its_largest_error():
    """The block of restitution 0.9, 36 cells at 1e-4: the largest error is 2.2e-5."""
    block = built(BODIES["slender"])
    grid = parse_grid("a_g=0.26g:0.9g:6,T_g=0.3:1:6")
    found, exactly = (
        spectrum([block], sine(), grid, method=Method("nonlinear", t), workers=1)
        for t in (1e-4, 1e-13)
    )
    error = np.nanmax(np.abs(found.theta_ratio - exactly.theta_ratio))
    assert error == pytest.approx(2.2e-5, rel=0.05)
    summary = found.summary
    assert error <= summary.error_bound <= 1e3 * error
    assert summary.error_bound_median <= summary.error_bound
    assert summary.largest_difference <= summary.error_bound
    assert any(line.startswith("error bound: 4") for line in summary_lines(summary, ""))


def test_a_sweep_tells_a_fault_of_its_own(monkeypatch):
    """With a sign reversed in the largest y of a stretch peaks are missed."""
    scene = scene_of_words(
        [],
        load_records(["configs/motions/synthetic.at2"]),
        axes="T=1:6:20",
        alphas="0.05:0.35:20",
        model="linear",
    )
    options = SweepOptions(workers=1)
    right = spectrum_of(scene, options)
    assert right.summary.beyond_tolerance == 0
    monkeypatch.setattr(
        exact,
        "turn_below",
        lambda y, v, start: y + v * v / (-start + np.sqrt(start * start + v * v)),
    )
    wrong = spectrum_of(scene, options)
    apart = np.abs(wrong.theta_ratio - right.theta_ratio)
    assert (apart > 1e-6).sum() > 10
    assert wrong.summary.beyond_tolerance > 0
    assert any("do not rely" in line for line in summary_lines(wrong.summary, ""))


def test_conditions_add_up_and_one_large_one_does_not_hide_the_others():
    method = Method("nonlinear", 1e-9)
    one, other = np.full(60, 2.0), np.append(np.full(40, 3.0), [np.nan, 1e6, 50.0])
    found = (Conditions.of(one) + Conditions.of(other)).bounds(method)
    assert found["error_bound"] == pytest.approx(1e-3)
    assert found["error_bound_median"] == pytest.approx(2e-9, rel=0.04)
    assert found["cells_above_ten_medians"] == 2
    nothing = Conditions.of(np.zeros(0)).bounds(method)
    assert set(nothing.values()) == {0}
