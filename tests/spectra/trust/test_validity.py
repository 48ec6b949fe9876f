"""What a linear sweep says of its own validity: cells that both equations judge, drawn and beside boundaries."""

from __future__ import annotations

import numpy as np
import pytest

from rocking_cli import build_structure, dimensionless_oscillator, parse_documents, parse_grid, sine, spectrum
from rocking_cli.commands.help import page
from rocking_cli.dynamics.method import Method
from rocking_cli.dynamics.outcome import Difference, falls
from rocking_cli.spectra.scene import PulseScene
from rocking_cli.spectra.trust.validity import validity

GRID = parse_grid("A=0.5:6:60,Omega=1:6:30")


def block(slenderness):
    return build_structure(parse_documents(f"kind: block\nwidth: {slenderness}\nheight: 1\nrestitution: 0.9")[0])


def test_a_slender_body_is_linear_and_a_stocky_one_is_not():
    slender, stocky = (validity(PulseScene((block(b),), GRID, sine())) for b in (0.01, 0.5))
    assert (slender.sampled, slender.differ) == (64, 0)
    assert stocky.sampled == 64
    assert 0 < stocky.unsafe <= stocky.differ < 32


def test_cells_beside_boundaries_are_looked_at_more_than_others():
    """Half of the cells are, so that the share that differs there is well above that of the whole grid."""
    found = validity(PulseScene((block(0.5),), GRID, sine()))
    whole = spectrum([block(0.5)], sine(), GRID, method=Method("nonlinear", 1e-6), quantities=["linear"], check=0).beside["difference"]
    assert found.differ / found.sampled > 1.5 * np.mean(whole > Difference.AGREES)


def test_nothing_is_said_where_the_nonlinear_equation_is_not_known_or_already_decides():
    assert validity(PulseScene((dimensionless_oscillator(0.9),), GRID, sine())) is None
    assert validity(PulseScene((block(0.5),), GRID, sine(), Method("nonlinear"))) is None
    assert validity(PulseScene((block(0.5),), parse_grid("A=0.1:0.9:5,Omega=1:6:5"), sine())) is None
    mixed = validity(PulseScene((dimensionless_oscillator(0.9), block(0.5)), GRID, sine()))
    assert mixed == validity(PulseScene((block(0.5),), GRID, sine()))


@pytest.mark.soak
def test_the_table_of_the_study_is_what_is_computed():
    """Two of its rows, at the tolerance and on the grid of `make study`."""
    table = {row[0]: row for row in (line.split() for line in page("accuracy").splitlines()) if len(row) == 8 and row[0][:2] == "0."}
    grid = parse_grid("A=1:8:281,Omega=1:8:57")
    for b in ("0.30", "0.50"):
        body = build_structure(parse_documents(f"kind: block\nwidth: {2 * float(b)}\nheight: 2")[0])
        found = spectrum([body], sine(), grid, method=Method("nonlinear", 1e-6), quantities=["linear"], check=0)
        down, unsafe = falls(found.outcome), found.beside["difference"] == Difference.LINEAR_UNSAFE
        alarms = (found.beside["difference"] == Difference.LINEAR_FALSE_ALARM).sum() / (~down).sum()
        assert table[b][6:] == [f"{100.0 * unsafe.sum() / down.sum():.1f}", f"{100.0 * alarms:.1f}"]
