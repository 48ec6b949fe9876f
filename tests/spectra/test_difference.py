"""Both equations in one sweep: each as by itself, and where they part."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.figure import Figure

from rocking_cli import UsageError, build_structure, parse_documents, parse_grid, sine, spectrum, write_spectrum
from rocking_cli.dynamics.method import Method
from rocking_cli.dynamics.outcome import Difference, Outcome, difference
from rocking_cli.reports.maps import outcome_map
from rocking_cli.reports.units import Units
from rocking_cli.spectra.reader import SpectraFile
from rocking_cli.spectra.scene import QUANTITIES

STOCKY = build_structure(parse_documents("kind: block\nname: Stocky\nwidth: 1\nheight: 2")[0])
GRID = parse_grid("A=0.8:6:14,Omega=1:6:12")
NONLINEAR = Method("nonlinear", 1e-6)


@pytest.fixture(scope="module")
def both(tmp_path_factory):
    path = tmp_path_factory.mktemp("both") / "both.h5"
    summary = write_spectrum([STOCKY], sine(), GRID, path, method=NONLINEAR, quantities=["linear"], workers=1, check=0, chunk_cells=50)
    with SpectraFile(path) as file:
        yield summary, file


def test_each_equation_is_as_by_itself(both):
    _, file = both
    for method, suffix in ((NONLINEAR, ""), (Method(), "_linear")):
        alone = spectrum([STOCKY], sine(), GRID, method=method, check=0)
        np.testing.assert_array_equal(file.array(f"outcome{suffix}"), alone.outcome)
        np.testing.assert_array_equal(file.array(f"theta_ratio{suffix}"), alone.theta_ratio)
    inside = spectrum([STOCKY], sine(), GRID, method=NONLINEAR, quantities=["linear"], check=0)
    np.testing.assert_array_equal(inside.beside["difference"], file.array("difference"))


def test_cells_that_linear_misjudges_are_marked_and_counted(both):
    summary, file = both
    falls, linear = (np.isin(file.array(name), [3, 4]) for name in ("outcome", "outcome_linear"))
    wanted = np.select([falls & ~linear, ~falls & linear], [Difference.LINEAR_UNSAFE, Difference.LINEAR_FALSE_ALARM], Difference.AGREES)
    np.testing.assert_array_equal(file.array("difference"), wanted)
    counts = {d.flag: int((wanted == d).sum()) for d in Difference}
    assert summary.differences == counts
    assert counts["linear_unsafe"] > 0
    assert counts["linear_false_alarm"] > 0
    record = summary.record()
    assert (record["cells_linear_unsafe"], record["cells_linear_false_alarm"]) == (counts["linear_unsafe"], counts["linear_false_alarm"])
    cells = list(file.cells())
    assert {c["difference"] for c in cells} == {flag for flag, n in counts.items() if n}


def test_every_quantity_asked_for_at_once_is_read_as_it_was_computed(tmp_path):
    """In whatever order they are asked for: a chunk's checksum runs over its variables in one order."""
    wanted, grid = ["linear", "fz_min", "friction", "condition"], parse_grid("A=1.5:5:2,Omega=4")
    assert {*wanted, "velocity_ratio"} == set(QUANTITIES)  # the latter of records alone
    path = tmp_path / "all.h5"
    write_spectrum([STOCKY], sine(), grid, path, method=NONLINEAR, quantities=wanted, impacts=True, workers=1, check=0)
    inside = spectrum([STOCKY], sine(), grid, method=NONLINEAR, quantities=wanted, check=0)
    with SpectraFile(path) as file:
        assert set(file.names) == {"theta_ratio", "outcome", "impacts", *inside.beside}
        for name, values in inside.beside.items():
            np.testing.assert_array_equal(file.array(name), values)


def test_what_is_not_known_is_no_difference():
    codes = [Outcome.FAILED, Outcome.NOT_COMPUTED, Outcome.ROCKED, Outcome.NO_UPLIFT, Outcome.OVERTURNED_NO_IMPACT]
    other = [Outcome.ROCKED, Outcome.ROCKED, Outcome.FAILED, Outcome.ROCKED, Outcome.OVERTURNED_AFTER_IMPACT]
    assert difference(np.array(codes), np.array(other)).tolist() == [0, 0, 0, 1, 1]


def test_the_linear_equation_has_nothing_beside_it():
    with pytest.raises(UsageError, match="accepted is nonlinear"):
        spectrum([STOCKY], sine(), GRID, quantities=["linear"])


def test_the_map_marks_them(both):
    _, file = both
    axes = Figure().add_subplot()
    entries = outcome_map(axes, file, 0, Units())
    marked = {layer.get_gid(): layer.get_array().count() for layer in axes.collections if layer.get_gid()}
    codes = file.array("difference")
    assert marked == {d.flag: int((codes == d).sum()) for d in (Difference.LINEAR_UNSAFE, Difference.LINEAR_FALSE_ALARM)}
    assert {entry.get_label() for entry in entries} >= {"linear stands, the body falls", "linear falls, the body stands"}
