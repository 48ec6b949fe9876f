"""Envelopes, read back from the figure that would be saved."""

import numpy as np
import pytest
from support.axes import lines, numbers, same

from rocking_cli import Outcome
from rocking_cli.reports.figures.colours import COLOURS


def inside(axes, x, y):
    """Which outcomes' bands hold a point."""
    found = set()
    for bands in axes.collections:
        if hasattr(bands, "get_segments"):
            continue
        if any(path.contains_point((x, y)) for path in bands.get_paths()):
            found.add(tuple(bands.get_facecolor()[0]))
    return found


def test_an_envelope_is_a_band_from_where_overturning_begins_to_where_it_ends(
    drawn, table
):
    from matplotlib.colors import to_rgba

    source, rows = table("envelope", "--eta", "0.9", "--grid", "Omega=2:6:9")
    (axes,) = drawn(source).axes
    top = axes.get_ylim()[1]
    assert top == pytest.approx(
        1.1 * np.nanmax([numbers(rows, "A_from"), numbers(rows, "A_to")])
    )
    colour = {o.mode: to_rgba(COLOURS[o]) for o in Outcome}
    for row in rows:
        x, low, high = (
            float(row["Omega"]),
            float(row["A_from"]),
            float(row["A_to"] or top),
        )
        x += 1e-9 if x < 4 else -1e-9  # just within the frequencies that are joined
        assert colour[row["mode"]] in inside(axes, x, low + 1e-3)
        assert colour[row["mode"]] in inside(axes, x, high - 1e-3)
        assert colour[row["mode"]] not in inside(axes, x, low - 1e-3)
    assert inside(axes, 5.0, 6.7) == set()  # the safe window
    assert (axes.get_xlabel(), axes.get_ylabel()) == (
        r"$\Omega = \omega_g/p$ [-]",
        r"$A = a_{scale}\,a_g/(\alpha g)$ [-]",
    )
    assert axes.get_title() == "eta=0.9\none cycle of a sine, linear equation"


@pytest.mark.slow
def test_structures_have_a_panel_each_in_g_and_hz(drawn, table):
    source, rows = table(
        "envelope",
        "configs/block.yaml",
        "configs/spire.yaml",
        "--grid",
        "f_g=0.5:1:2",
        "--pulse",
        "rectangular",
        "--a-max",
        "6",
    )
    figure = drawn(source)
    assert [axes.get_title().split("\nintervals")[0] for axes in figure.axes] == [
        f"{name}\nrectangular, nonlinear equation" for name in ("Column", "Spire")
    ]
    assert {(axes.get_xlabel(), axes.get_ylabel()) for axes in figure.axes} == {
        ("$f_g$ [Hz]", "$a_g$ [g]")
    }
    for axes, name in zip(figure.axes, ("Column", "Spire"), strict=True):
        mine = [r for r in rows if r["structure"] == name and r["mode"] != "none"]
        corners = [
            tuple(corner)
            for c in axes.collections
            for path in c.get_paths()
            for corner in path.vertices
        ]
        wanted = np.array(
            [numbers(mine, "omega_g") / (2 * np.pi), numbers(mine, "a_from") / 9.81]
        ).T
        for one in wanted:
            assert np.isclose(corners, one, rtol=1e-12).all(axis=1).any()
        # no line ends beyond a corner of an area
        assert not any(hasattr(c, "get_segments") for c in axes.collections)
    assert [text.get_text() for text in figure.legends[0].get_texts()][-2:] == [
        "stands",
        "not searched",
    ]


def test_closed_form_curves_are_a_line_each(drawn, table):
    source, rows = table(
        "envelope", "--eta", "0.9", "--grid", "Omega=2:6:9", "--closed-form"
    )
    found = lines(drawn(source).axes[0])
    assert len(found) == 4
    title = "eta=0.9, one cycle of a sine, linear equation"
    assert drawn(source).axes[0].get_title() == title
    for label, line in found.items():
        mine = [r for r in rows if r["curve"].replace("_", " ") in label]
        same(line, numbers(mine, "Omega"), numbers(mine, "A"))


def test_both_equations_have_a_panel_each(drawn, table):
    source, _ = table(
        "envelope",
        "configs/block.yaml",
        "--grid",
        "f_g=1",
        "--model",
        "both",
        "--a-max",
        "2",
    )
    assert [
        axes.get_title().split("\nintervals")[0] for axes in drawn(source).axes
    ] == [
        f"Column\none cycle of a sine, 1 Hz, {model} equation"
        for model in ("linear", "nonlinear")
    ]


def test_records_are_bars_in_g(drawn):
    (axes,) = drawn(
        "record,structure,A_from,A_to,mode,a_from [m/s2],a_to [m/s2]\n"
        "one,Column,1,2,after_impact,2.4525,4.905\n"
        "one,Column,3,,no_impact,7.3575,\ntwo,Column,,,none,,\n"
    ).axes
    assert [tick.get_text() for tick in axes.get_xticklabels()] == ["one", "two"]
    assert (axes.get_ylabel(), axes.get_title()) == ("$a_g$ [g]", "Column")
    strokes = [
        np.array(s)
        for c in axes.collections
        if hasattr(c, "get_segments")
        for s in c.get_segments()
    ]
    top = axes.get_ylim()[1]
    assert top == pytest.approx(1.1 * 0.75, rel=1e-12)
    np.testing.assert_allclose(
        strokes, [[(0, 0.25), (0, 0.5)], [(0, 0.75), (0, top)]], rtol=1e-12
    )


def test_blocks_under_a_record_are_bands_over_their_size(drawn):
    first, second = drawn(
        "record,alpha [rad],T [s],A_from,mode\n"
        "one,0.1,1,2,after_impact\none,0.1,2,3,after_impact\none,0.2,1,4,no_impact\n"
    ).axes
    assert (first.get_title(), second.get_title()) == (
        r"one, $\alpha$ = 0.1 rad",
        r"one, $\alpha$ = 0.2 rad",
    )
    assert (first.get_xlabel(), first.get_ylabel()) == (
        r"$T = 2\pi/p$ [s]",
        r"$A = a_{scale}\,a_g/(\alpha g)$ [-]",
    )
    same(first.get_lines()[0].get_data(), np.array([1, 2]), np.array([2, 3]))


def test_no_mode_leaves_a_gap_and_nothing_unsearched_is_white(drawn):
    text = (
        "structure,Omega,A_from,A_to,mode\nx,1,4,,no_impact\nx,2,5,6,lost_contact\n"
        "x,2,6,,no_impact\nx,3,,,none\n"
    )
    (axes,) = drawn(text).axes
    assert inside(axes, 1.5, 5.0)  # one mode at 1, another at 2
    assert inside(axes, 2.5, 6.3)  # nothing falls at 3, up to what is searched
    assert not inside(axes, 1.5, 4.0)
    (span,) = axes.patches  # hatched
    assert span.get_y() == 6.0
