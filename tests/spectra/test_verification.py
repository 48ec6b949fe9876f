"""Which cells are checked, always the same ones; their condition; and what a linear
sweep says of its own validity.
"""

import math
from contextlib import nullcontext
from functools import cache, partial
from itertools import chain

import numpy as np
import pytest
from support.documents import built
from support.record_layouts import wave
from support.synthetic_records import recorded

from rocking_cli import (
    Axis,
    Method,
    UsageError,
    dimensionless_oscillator,
    linear_response,
    parse_grid,
    spectrum,
)
from rocking_cli.commands.help import page
from rocking_cli.dynamics.march import engine, proofs
from rocking_cli.dynamics.march.proofs import FREE_MOTION
from rocking_cli.dynamics.outcome import Difference, Outcome, falls
from rocking_cli.motions import sine
from rocking_cli.processes import processes
from rocking_cli.reports.summary import summary_lines
from rocking_cli.spectra.dimensions import QUANTITIES
from rocking_cli.spectra.record_scene import structures_scene
from rocking_cli.spectra.scene import PulseScene, cut_into_units
from rocking_cli.spectra.verification import (
    Answer,
    Verification,
    default_check,
    drawn_cells,
    validity,
)
from rocking_cli.spectra.work.jobs import Job

GRID = parse_grid("A=0.5:4:60,Omega=0.5:6:50")
OSCILLATORS = (dimensionless_oscillator(eta=0.5), dimensionless_oscillator(eta=0.9))


def checked(scene, check, chunk=None, units=None, workers=1):
    """The verification of a sweep of these units, which ends the sweep."""
    chunk = chunk or scene.shape[1:]
    every = list(cut_into_units(scene, chunk))
    verification = Verification(scene, check, chunk, units or every, len(every))
    job = Job(scene)
    here = nullcontext(partial(map, job))
    with processes(workers, job, "") if workers > 1 else here as run:
        reports = chain.from_iterable(run(job.batches(verification.units, workers)))
        for unit, report in zip(verification.units, reports, strict=True):
            verification.seen |= zip(unit.wanted, report.seen, strict=True)
        verification.ask(run)
    return verification


def conditions(scene, cells):
    eta = np.array([scene.structures[i].eta for i in cells[:, 0]])
    amplitude, omega = (
        scene.grid.amplitude.values[cells[:, 2]],
        scene.grid.frequency.values[cells[:, 1]],
    )
    return linear_response(scene.motion, amplitude, omega, eta).condition


def test_a_quarter_of_the_checked_cells_are_the_most_sensitive():
    scene = PulseScene(OSCILLATORS, GRID, sine(2))
    verification = checked(scene, 16)
    assert list(verification.answers)[:4] == verification.sensitive
    assert len(verification.answers) == 16
    chosen = conditions(scene, np.array(verification.sensitive))
    drawn = conditions(scene, np.array(drawn_cells(scene, 300, seed=3)))
    assert np.sort(chosen)[1] > np.nanquantile(drawn, 0.8)


def test_half_of_the_checked_cells_have_another_outcome_than_the_next():
    scene = PulseScene(OSCILLATORS[1:], GRID, sine())
    outcome = spectrum(OSCILLATORS[1:], sine(), GRID, check=0).outcome[0]
    cells = checked(scene, 16).answers
    around = [outcome[row, max(0, column - 1) : column + 2] for _, row, column in cells]
    assert sum(len(set(some.tolist())) > 1 for some in around) >= 8
    decided = {outcome[row, column] for _, row, column in cells}
    assert decided == {Outcome.ROCKED, *filter(Outcome.overturned.fget, Outcome)}


def too_early(segments, equation, lanes):
    """Lemma 6 made wrong: no body beyond its equilibrium comes back."""
    return np.ones(lanes.y.size, dtype=bool)


def stands(batch, lanes):
    """Lemma 8 made wrong: no body falls once the ground is still."""
    found = FREE_MOTION.proves(batch, lanes)
    peak = np.nan_to_num(found.peak)
    return found._replace(outcome=np.full(peak.size, Outcome.ROCKED), peak=peak)


def falls_early(batch, lanes):
    """Lemma 8 made wrong: bodies fall a tenth before their equilibrium."""
    found = FREE_MOTION.proves(batch, lanes)
    fallen = np.where(found.peak > 0.9, Outcome.OVERTURNED_AFTER_IMPACT, found.outcome)
    return found._replace(outcome=fallen)


@cache
def proved(method):
    """A spectrum of 3000 cells, of which 16 are computed again."""
    grid = parse_grid("A=0.5:8:60,Omega=0.5:8:50")
    return spectrum([block(0.3)], sine(), grid, method=method, check=16, workers=1)


@pytest.mark.parametrize(
    ("place", "name", "wrong"),
    [
        (engine, "cannot_return", too_early),
        (proofs, "FREE_MOTION", FREE_MOTION._replace(proves=stands)),
        (proofs, "FREE_MOTION", FREE_MOTION._replace(proves=falls_early)),
    ],
)
@pytest.mark.parametrize("method", [Method(), Method("nonlinear")])
def test_a_wrong_proof_is_found_by_the_cells_that_it_decides(
    monkeypatch, place, name, wrong, method
):
    right = proved(method)
    monkeypatch.setattr(place, name, wrong)
    found = proved.__wrapped__(method)
    differ = np.count_nonzero(found.outcome != right.outcome)
    assert 0 < differ < 0.4 * found.outcome.size
    assert right.summary.misjudged == 0 < found.summary.misjudged


def test_the_same_cells_are_checked_however_a_sweep_is_cut():
    scene = PulseScene(OSCILLATORS, GRID, sine())
    verification = checked(scene, 6, (7, 60), workers=2)
    assert list(verification.answers) == list(checked(scene, 6).answers)
    whole = spectrum(OSCILLATORS, sine(), GRID, check=6).summary
    found = verification.compared()
    assert found["checked_cells"] == whole.checked_cells == 6
    assert found["sensitive_cells"] == whole.sensitive_cells == 1
    assert found["largest_difference"] == whole.largest_difference > 0.0
    assert 0.0 < whole.check_time < whole.run_time


def test_only_cells_of_the_units_are_checked_and_an_answer_that_differs_shows():
    """A shard checks as large a part of the cells as it computes."""
    scene = PulseScene(OSCILLATORS, GRID, sine())
    units = list(cut_into_units(scene, (10, 60)))[:3]
    verification = checked(scene, 40, (10, 60), units)
    found = verification.compared()
    assert len(units) == 0.3 * len(list(cut_into_units(scene, (10, 60))))
    assert found["checked_cells"] == len(verification.answers) == 12
    assert all(row < 30 and i == 0 for i, row, _ in verification.answers)
    assert found["misjudged"] == found["beyond_tolerance"] == 0
    place = next(
        place
        for place, answer in verification.answers.items()
        if answer.outcome == Outcome.ROCKED
    )
    seen = verification.seen[place]
    verification.seen[place] = seen._replace(theta_ratio=seen.theta_ratio + 1e-3)
    assert verification.compared()["largest_difference"] == pytest.approx(
        1e-3, rel=1e-6
    )
    assert verification.compared()["beyond_tolerance"] == 1
    fallen = Answer(Outcome.OVERTURNED_NO_IMPACT, math.nan)
    verification.seen[place] = fallen
    assert verification.compared()["misjudged"] == 1


def test_a_small_sweep_checks_fewer_cells_but_never_none():
    counts = [
        default_check(PulseScene(OSCILLATORS[:1], parse_grid(axes), sine()))
        for axes in (
            "A=2,Omega=3",
            "A=0.5:4:30,Omega=0.5:6:40",
            "A=0.5:4:80,Omega=0.5:6:80",
            "A=0.5:4:3000,Omega=0.5:6:3000",
        )
    ]
    assert counts == [2, 4, 8, 36]


@pytest.mark.parametrize(("check", "sensitive"), [(0, 0), (1, 1), (2, 1), (9, 2)])
def test_the_summary_tells_how_many_cells_its_error_rests_on(check, sensitive):
    grid = parse_grid("A=0.5:4:20,Omega=0.5:6:10")
    found = spectrum(OSCILLATORS[1:], sine(), grid, check=check)
    assert (found.summary.checked_cells, found.summary.sensitive_cells) == (
        check,
        sensitive,
    )
    line = next(
        line
        for line in summary_lines(found.summary, "s.h5")
        if "largest difference" in line
    )
    many = f"{check} cell{'s' if check != 1 else ''}"
    assert (
        f"at {many}{f' ({sensitive} for their sensitivity)' if sensitive else ''}"
        " computed"
        if check
        else "not checked"
    ) in line


@pytest.mark.soak
def test_a_quarter_of_the_cells_checked_under_a_record_are_the_most_sensitive():
    """The rotations of no other cells differ more from those of the next scale."""
    block = built("kind: block\nwidth: 0.3 m\nheight: 1.2 m")
    scene = structures_scene(
        [block], [recorded(wave(24, 3.0), 0.1)], Axis("A", np.linspace(0.5, 2.5, 60))
    )
    sensitive = checked(scene, 16).sensitive
    assert len(sensitive) == 4
    motion, omega = scene.recordings[0].motion, 1.0 / block.p
    found = linear_response(motion, scene.columns.values, omega, block.eta)
    rocked = found.outcome == Outcome.ROCKED
    change = np.where(rocked[1:] & rocked[:-1], np.abs(np.diff(found.theta_ratio)), 0.0)
    chosen = {column for _, _, column in sensitive}
    assert chosen <= set(np.argsort(-change)[:8].tolist())


def test_a_grid_below_uplift_has_nothing_to_check():
    scene = PulseScene(OSCILLATORS, parse_grid("A=0.1:0.9:5,Omega=1:2:3"), sine())
    assert checked(scene, 4).answers == {}


def test_condition_is_computed_on_request():
    grid, structures = (
        parse_grid("A=0.5:3:6,Omega=4:8:5"),
        [dimensionless_oscillator(eta=0.9), dimensionless_oscillator(eta=0.5)],
    )
    assert spectrum(structures, sine(), grid).condition is None
    computed = linear_response(
        sine(), *np.meshgrid(grid.amplitude.values, grid.frequency.values), 0.9
    )
    found = spectrum(structures, sine(), grid, quantities=["condition"])
    np.testing.assert_array_equal(found.condition[0], computed.condition)
    with pytest.raises(
        UsageError,
        match=f"unknown quantity 'conditions'; expected {', '.join(QUANTITIES)}",
    ):
        spectrum(structures, sine(), grid, quantities=["conditions"])


FINE = parse_grid("A=0.5:6:60,Omega=1:6:30")


def block(slenderness):
    return built(f"kind: block\nwidth: {slenderness}\nheight: 1\nrestitution: 0.9")


def test_a_slender_body_is_linear_and_a_stocky_one_is_not():
    slender, stocky = (
        validity(PulseScene((block(b),), FINE, sine())) for b in (0.01, 0.5)
    )
    assert (slender.sampled, slender.differ) == (64, 0)
    assert stocky.sampled == 64
    assert 0 < stocky.unsafe <= stocky.differ < 32


def test_cells_beside_boundaries_are_looked_at_more_than_others():
    """Half of the cells are, so that the share that differs there is well above that of
    the whole grid.
    """
    found = validity(PulseScene((block(0.5),), FINE, sine()))
    whole = spectrum(
        [block(0.5)],
        sine(),
        FINE,
        method=Method("nonlinear", 1e-6),
        quantities=["linear"],
        check=0,
    ).quantities["difference"]
    assert found.differ / found.sampled > 1.5 * np.mean(whole > Difference.AGREES)


def test_nothing_is_said_where_the_nonlinear_equation_is_not_known_or_already_decides():
    assert (
        validity(PulseScene((dimensionless_oscillator(eta=0.9),), FINE, sine())) is None
    )
    assert (
        validity(PulseScene((block(0.5),), FINE, sine(), Method("nonlinear"))) is None
    )
    assert (
        validity(
            PulseScene((block(0.5),), parse_grid("A=0.1:0.9:5,Omega=1:6:5"), sine())
        )
        is None
    )
    mixed = validity(
        PulseScene((dimensionless_oscillator(eta=0.9), block(0.5)), FINE, sine())
    )
    assert mixed == validity(PulseScene((block(0.5),), FINE, sine()))


@pytest.mark.soak
def test_the_table_of_the_study_is_what_is_computed():
    """Two of its rows, at the tolerance and on the grid of `make study`."""
    table = {
        row[0]: row
        for row in (line.split() for line in page("accuracy").splitlines())
        if len(row) == 8 and row[0][:2] == "0."
    }
    grid = parse_grid("A=1:8:281,Omega=1:8:57")
    for b in ("0.30", "0.50"):
        body = built(f"kind: block\nwidth: {2 * float(b)}\nheight: 2")
        found = spectrum(
            [body],
            sine(),
            grid,
            method=Method("nonlinear", 1e-6),
            quantities=["linear"],
            check=0,
        )
        down, unsafe = (
            falls(found.outcome),
            found.quantities["difference"] == Difference.LINEAR_UNSAFE,
        )
        alarms = (
            found.quantities["difference"] == Difference.LINEAR_FALSE_ALARM
        ).sum() / (~down).sum()
        assert table[b][6:] == [
            f"{100.0 * unsafe.sum() / down.sum():.1f}",
            f"{100.0 * alarms:.1f}",
        ]


def test_what_the_reference_is_off_is_no_error_of_the_sweep():
    """Damped linear cells are within 1e-13 of the reference, and so is their bound."""
    bodies = [
        built("kind: block\nwidth: 0.19\nheight: 1.5\ndamping: 0.046"),
        built("kind: block\nwidth: 1.5\nheight: 4.8\ndamping: 0.014"),
    ]
    found = spectrum(
        bodies,
        sine(),
        parse_grid("a_g=0.1g:0.8g:10,f_g=0.5:3:10"),
        method="linear",
        workers=1,
        check=60,
    )
    assert found.summary.largest_difference < 1e-12
    assert found.summary.beyond_tolerance == 0
