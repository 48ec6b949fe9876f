"""Both equations in one sweep: each as by itself, and where they part."""

import numpy as np
import pytest
from matplotlib.figure import Figure

from rocking_cli import (
    Method,
    SpectraFile,
    Units,
    UsageError,
    build_structure,
    parse_documents,
    parse_grid,
    sine,
    spectrum,
    write_spectrum,
)
from rocking_cli.dynamics.outcome import Difference, Outcome, difference
from rocking_cli.reports.figures.maps import outcome_map
from rocking_cli.reports.summary import summary_lines
from rocking_cli.spectra.dimensions import QUANTITIES

STOCKY = build_structure(
    parse_documents("kind: block\nname: Stocky\nwidth: 1\nheight: 2")[0]
)
GRID = parse_grid("A=0.8:6:14,Omega=1:6:12")
NONLINEAR = Method("nonlinear", 1e-6)


@pytest.fixture(scope="module")
def both(tmp_path_factory):
    path = tmp_path_factory.mktemp("both") / "both.h5"
    summary = write_spectrum(
        [STOCKY],
        sine(),
        GRID,
        path,
        method=NONLINEAR,
        quantities=["linear"],
        workers=1,
        check=0,
        chunk_cells=50,
    )
    with SpectraFile(path) as file:
        yield summary, file


def test_each_equation_is_as_by_itself(both):
    _, file = both
    for method, suffix in ((NONLINEAR, ""), (Method(), "_linear")):
        alone = spectrum([STOCKY], sine(), GRID, method=method, check=0)
        np.testing.assert_array_equal(file.array(f"outcome{suffix}"), alone.outcome)
        # Watched cells go by series, those of a linear sweep by the exact flow.
        np.testing.assert_allclose(
            file.array(f"theta_ratio{suffix}"), alone.theta_ratio, rtol=1e-12
        )
    inside = spectrum(
        [STOCKY], sine(), GRID, method=NONLINEAR, quantities=["linear"], check=0
    )
    np.testing.assert_array_equal(
        inside.quantities["difference"], file.array("difference")
    )


def test_cells_that_linear_misjudges_are_marked_and_counted(both):
    summary, file = both
    falls, linear = (
        np.isin(file.array(name), [3, 4]) for name in ("outcome", "outcome_linear")
    )
    wanted = np.select(
        [falls & ~linear, ~falls & linear],
        [Difference.LINEAR_UNSAFE, Difference.LINEAR_FALSE_ALARM],
        Difference.AGREES,
    )
    np.testing.assert_array_equal(file.array("difference"), wanted)
    counts = {d.flag: int((wanted == d).sum()) for d in Difference}
    assert summary.differences == counts
    assert counts["linear_unsafe"] > 0
    assert counts["linear_false_alarm"] > 0
    record = summary.row()
    assert (record["cells_linear_unsafe"], record["cells_linear_false_alarm"]) == (
        counts["linear_unsafe"],
        counts["linear_false_alarm"],
    )
    cells = list(file.cells())
    assert {c["difference"] for c in cells} == {flag for flag, n in counts.items() if n}


def test_every_quantity_asked_for_at_once_is_read_as_it_was_computed(tmp_path):
    """In whatever order they are asked for: a chunk's checksum runs over its variables
    in one order.
    """
    wanted, grid = ["linear", "condition", "slide"], parse_grid("A=1.5:5:2,Omega=4")
    assert {*wanted, "velocity_ratio"} == set(QUANTITIES)  # the latter of records alone
    path = tmp_path / "all.h5"
    write_spectrum(
        [STOCKY],
        sine(),
        grid,
        path,
        method=NONLINEAR,
        quantities=wanted,
        impacts=True,
        workers=1,
        check=0,
    )
    inside = spectrum(
        [STOCKY], sine(), grid, method=NONLINEAR, quantities=wanted, check=0
    )
    with SpectraFile(path) as file:
        assert set(file.names) == {
            "theta_ratio",
            "outcome",
            "impacts_at_least",
            *inside.quantities,
        }
        for name, values in inside.quantities.items():
            np.testing.assert_array_equal(file.array(name), values)


def test_what_is_not_known_is_no_difference():
    codes = [
        Outcome.FAILED,
        Outcome.NOT_COMPUTED,
        Outcome.ROCKED,
        Outcome.LOST_CONTACT,
        Outcome.NO_UPLIFT,
        Outcome.OVERTURNED_NO_IMPACT,
    ]
    other = [
        Outcome.ROCKED,
        Outcome.ROCKED,
        Outcome.FAILED,
        Outcome.FAILED,
        Outcome.ROCKED,
        Outcome.OVERTURNED_AFTER_IMPACT,
    ]
    assert difference(np.array(codes), np.array(other)).tolist() == [0, 0, 0, 0, 1, 1]


def test_a_body_that_leaves_the_ground_is_not_safe(tmp_path):
    """Under a pulse near 1 Hz at which a squat block lets go of the ground while the
    linear oscillator rocks on.
    """
    body = build_structure(
        parse_documents("kind: block\nwidth: 1.6\nheight: 2\nrestitution: 0.6")[0]
    )
    grid = parse_grid("a_g=1.7g:2.5g:9,f_g=0.9:1.3:9")
    summary = write_spectrum(
        [body],
        sine(),
        grid,
        tmp_path / "f.h5",
        method=NONLINEAR,
        quantities=["linear"],
        workers=1,
        check=0,
    )
    with SpectraFile(tmp_path / "f.h5") as file:
        found = [
            list(map(Outcome, file.array(name).ravel()))
            for name in ("outcome", "outcome_linear")
        ]
    falls, linear = (
        [
            o
            in (
                Outcome.OVERTURNED_NO_IMPACT,
                Outcome.OVERTURNED_AFTER_IMPACT,
                Outcome.LOST_CONTACT,
            )
            for o in x
        ]
        for x in found
    )
    unsafe = [a and not b for a, b in zip(falls, linear, strict=True)]
    assert (Outcome.LOST_CONTACT, Outcome.ROCKED) in zip(*found, strict=True)
    assert summary.differences["linear_unsafe"] == sum(unsafe)
    assert summary.differences["linear_false_alarm"] == sum(
        b and not a for a, b in zip(falls, linear, strict=True)
    )
    assert (
        f"unsafe in {sum(unsafe)} of the {sum(falls)} cells that overturn or lose"
        " contact" in "\n".join(summary_lines(summary, "f.h5"))
    )


def test_the_linear_equation_has_nothing_beside_it():
    with pytest.raises(UsageError, match="`model` must be nonlinear"):
        spectrum([STOCKY], sine(), GRID, quantities=["linear"])


def test_the_map_marks_them(both):
    _, file = both
    axes = Figure().add_subplot()
    entries = outcome_map(axes, file, 0, Units())
    marked = {
        layer.get_gid(): layer.get_array().count()
        for layer in axes.collections
        if layer.get_gid()
    }
    codes = file.array("difference")
    assert marked == {
        d.flag: int((codes == d).sum())
        for d in (Difference.LINEAR_UNSAFE, Difference.LINEAR_FALSE_ALARM)
    }
    assert {entry.get_label() for entry in entries} >= {
        "linear stands, the body falls",
        "linear falls, the body stands",
    }
