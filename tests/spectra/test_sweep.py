"""Sweeps: the same bits however they are cut and spread, the file's layout, and what a
reader sees.
"""

import math
import tracemalloc

import h5py
import numpy as np
import pytest
from support.documents import built

from rocking_cli import (
    Method,
    RockingParameters,
    dimensionless_oscillator,
    linear_response,
    load_structures,
    parse_grid,
    sine,
    spectrum,
)
from rocking_cli.dynamics.outcome import Outcome
from rocking_cli.errors import Interrupted, UsageError
from rocking_cli.spectra import sweep
from rocking_cli.spectra.sweep import write_spectrum

GRID = parse_grid("A=0.5:9:53,Omega=0.5:12:37")
TWO = [dimensionless_oscillator(eta=0.9), dimensionless_oscillator(eta=0.6)]


def read(path):
    with h5py.File(path) as f:
        return {
            name: f[name][...]
            for name in ("theta_ratio", "outcome", "impacts_at_least")
        }


@pytest.mark.parametrize(("workers", "chunk"), [(1, 1), (1, 100), (2, 1000)])
def test_workers_and_chunks_change_no_bit(tmp_path, workers, chunk):
    grid = GRID if chunk > 1 else parse_grid("A=0.5:9:9,Omega=0.5:12:7")
    write_spectrum(
        TWO,
        sine(1.5),
        grid,
        tmp_path / "s.h5",
        workers=workers,
        chunk_cells=chunk,
        impacts=True,
    )
    data = read(tmp_path / "s.h5")
    a, omega = grid.amplitude.values, grid.frequency.values
    for i, structure in enumerate(TWO):
        direct = linear_response(sine(1.5), a[None, :], omega[:, None], structure.eta)
        assert data["theta_ratio"][i].tobytes() == direct.theta_ratio.tobytes()
        assert data["outcome"][i].tobytes() == direct.outcome.tobytes()
        assert (
            data["impacts_at_least"][i].tobytes() == direct.impacts_at_least.tobytes()
        )
    assert not (tmp_path / "s.h5.part").exists()


def test_structures_of_equal_restitution_are_computed_once():
    structures = load_structures(
        ["block:1x5,restitution=0.9", "spire:1x9,restitution=0.9"]
    )
    shared = spectrum(structures, sine(), GRID)
    assert shared.summary.shared_cells == 53 * 37
    assert shared.theta_ratio[0].tobytes() == shared.theta_ratio[1].tobytes()
    dimensional = spectrum(
        structures,
        sine(),
        parse_grid("a_g=0.1g:2g:20,f_g=0.5:5:10"),
        method=Method("linear"),
    )
    assert dimensional.summary.shared_cells == 0
    a, omega = (
        structures[1].dimensionless_amplitude(np.linspace(0.981, 19.62, 20)),
        2 * np.pi * np.linspace(0.5, 5, 10) / structures[1].p,
    )
    direct = linear_response(sine(), a[None, :], omega[:, None], 0.9)
    assert np.array_equal(dimensional.outcome[1], direct.outcome)


def test_summary_adds_up_and_the_check_agrees():
    s = spectrum(TWO, sine(), GRID, check=40).summary
    assert s.cells == 2 * 53 * 37 == sum(s.outcomes.values())
    assert s.outcomes["no_uplift"] == s.work.no_uplift
    assert s.checked_cells == 40
    assert s.misjudged == 0
    assert s.largest_difference < 1e-12
    assert s.row()["time_per_cell"] * s.cells == pytest.approx(s.run_time)


def test_a_restitution_alone_needs_dimensionless_axes():
    with pytest.raises(UsageError, match="no units"):
        spectrum(TWO, sine(), parse_grid("a_g=1:2:3,omega_g=1:2:3"))
    with pytest.raises(UsageError, match="found an empty list"):
        spectrum([], sine(), GRID)


def test_a_model_is_refused_where_it_does_not_hold():
    with pytest.raises(UsageError, match="a rigid body, whose a_scale is 1"):
        Method("nonlinear").system_of(
            built("kind: parameters\np: 2\nalpha: 0.1\neta: 0.9\nlambda: 0.3")
        )
    for given, words in (
        (("quadratic",), "unknown model"),
        (("nonlinear", 0.5), "tolerance"),
    ):
        with pytest.raises(UsageError, match=words):
            Method(*given)


def test_an_interruption_names_the_part_that_it_leaves(tmp_path, monkeypatch):
    def stopped(*_):
        raise KeyboardInterrupt

    with pytest.raises(
        Interrupted,
        match=(
            r"interrupted; 1 of 20 chunks are kept in .*s\.h5\.part; `resume` goes on"
        ),
    ):
        write_spectrum(
            TWO,
            sine(),
            GRID,
            tmp_path / "s.h5",
            chunk_cells=53 * 4,
            workers=1,
            progress=stopped,
        )
    assert (tmp_path / "s.h5.part").exists()
    monkeypatch.setattr(sweep.Job, "__call__", stopped)
    with pytest.raises(
        Interrupted,
        match=r"^interrupted before the first chunk was done; nothing is kept$",
    ):
        write_spectrum(TWO, sine(), GRID, tmp_path / "none.h5", workers=1)
    assert not (tmp_path / "none.h5.part").exists()


@pytest.mark.soak
def test_memory_does_not_grow_with_the_number_of_cells(tmp_path):
    peaks = []
    for frequencies in (1000, 2000):
        grid = parse_grid(
            f"A=0.1:0.95:500,Omega=8:12:{frequencies}"
        )  # nothing lifts off: quick
        tracemalloc.start()
        write_spectrum(
            TWO[:1],
            sine(),
            grid,
            tmp_path / f"{frequencies}.h5",
            workers=1,
            chunk_cells=10_000,
        )
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    assert peaks[0] < 100e6
    assert (
        peaks[1] - peaks[0] < 500_000 * 9 / 2
    )  # half of the results that were added, 9 bytes a cell


def test_structures_share_rotations_but_not_where_they_leave_the_ground(tmp_path):
    """Two point masses of one restitution under the linear equation: one spectrum,
    except where the stocky one leaves the ground.
    """
    masses = [
        RockingParameters(
            name=f"{a}",
            structure="point_mass",
            p=2.0,
            alpha=a,
            eta=0.9,
            uplift=math.tan(a),
            a_scale=1.0,
            arm=9.81 / 4.0,
        )
        for a in (0.2, 1.0)
    ]
    grid = parse_grid("A=0.5:5:6,Omega=8:9:2")
    found = spectrum(masses, sine(), grid, check=4)
    assert (found.summary.shared_cells, found.summary.misjudged) == (12, 0)
    lost = found.outcome == Outcome.LOST_CONTACT
    assert (lost[0].any(), lost[1].any()) == (False, True)
    assert found.summary.outcomes["lost_contact"] == lost.sum()
    assert np.array_equal(found.outcome[0][~lost[1]], found.outcome[1][~lost[1]])
    assert np.array_equal(
        np.isnan(found.theta_ratio), np.isin(found.outcome, (3, 4, 6))
    )
    alone = [
        spectrum([mass], sine(), grid, check=0, quantities=("condition",))
        for mass in masses
    ]
    assert np.array_equal(found.outcome, np.concatenate([one.outcome for one in alone]))
    turned = spectrum(masses[::-1], sine(), grid, check=0, quantities=("condition",))
    np.testing.assert_array_equal(
        turned.condition[::-1], np.concatenate([one.condition for one in alone])
    )
    write_spectrum(masses, sine(), grid, tmp_path / "s.h5", impacts=True, chunk_cells=4)
    assert np.array_equal(read(tmp_path / "s.h5")["outcome"], found.outcome)
