"""The figures of a check: what their bars, lines and marks are."""

import math
from dataclasses import replace

import pytest
from matplotlib.figure import Figure

from rocking_cli import (
    build_structure,
    check,
    code_check,
    load_structures,
    parse_documents,
    parse_grid,
    sine,
)
from rocking_cli.reports.figures.canvas import FIGURE_UNITS
from rocking_cli.reports.figures.capacities import capacities, capacity_curve


def test_bars_end_at_the_first_overturning_and_lines_stand_at_the_demand():
    texts = (
        "kind: block\nwidth: 0.4\nheight: 2",
        "kind: block\nwidth: 1\nheight: 2\ngravity: 9.81",
    )
    verdicts = [
        check(
            build_structure(parse_documents(t)[0]),
            sine(),
            parse_grid("a_g=0.34g,f_g=1.2"),
        )
        for t in texts
    ]
    (axes,) = capacities(Figure(), verdicts, FIGURE_UNITS)
    assert [bar.get_width() for bar in axes.patches] == pytest.approx(
        [v.first_overturning_a / 9.81 for v in verdicts]
    )
    assert [line.get_xdata()[0] for line in axes.lines] == pytest.approx(
        [0.2, 0.5, 0.34]
    )
    title = axes.get_title().replace("\n", " ")
    assert title.endswith(", one cycle of a sine at 1.2 Hz, nonlinear equation")
    assert [t.get_text() for t in axes.get_yticklabels()] == [
        v.structure for v in verdicts
    ]
    assert [text.get_text().split()[0] for text in axes.texts] == [
        "0.791",  # of 0.7918, rounded down as in the table of a report
        "2.25",
    ]
    (axes,) = capacities(
        Figure(),
        [replace(verdicts[0], motion=name) for name in ("north", "east")],
        FIGURE_UNITS,
    )
    assert [t.get_text() for t in axes.get_yticklabels()] == ["north", "east"]


@pytest.mark.parametrize("a_max", [None, 0.6])
def test_a_capacity_that_was_not_found_has_no_bar(a_max):
    """Not searched, or only up to a_max: the body overturns above it."""
    verdict = check(
        load_structures("block:0.5x2")[0],
        sine(),
        parse_grid("a_g=0.05g,f_g=1"),
        a_max=a_max,
    )
    (axes,) = capacities(Figure(), [verdict], FIGURE_UNITS)
    assert [bar.get_width() for bar in axes.patches] == [0.0]
    said = (
        "no uplift; no capacity known" if a_max is None else "> 2.93  no uplift"
    )  # 0.6 alpha g over 0.05 g
    assert [text.get_text() for text in axes.texts] == [said]


def test_marks_stand_at_the_limit_states_and_at_their_demands():
    found = code_check(
        load_structures("block:0.5x2")[0], sine(), parse_grid("a_g=0.3g,T_g=0.4")
    )
    axes = Figure().add_subplot()
    capacity_curve(axes, found)
    lines = {line.get_label(): line for line in axes.lines}
    assert lines["capacity"].get_xydata()[0] == pytest.approx((0.0, 0.25))
    assert lines["capacity"].get_xydata()[-1] == pytest.approx((250.0, 0.0))
    assert lines["$d_{SLV}$ = 100 mm"].get_xydata()[0] == pytest.approx(
        (100.0, found.slv.acceleration / 9.81)
    )
    ratio = found.slv.amplitude / found.demand_a
    assert f"\nSLV: verified ({math.floor(100 * ratio) / 100:.2f})," in axes.get_title()
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    x, y = lines[f"demand at SLC {1000 * found.slc.demand:.3g} mm"].get_xydata()[0]
    assert left < x < right
    assert low < y < high
    assert y * 9.81 == pytest.approx(x / 1000 * (2 * math.pi / found.slc.period) ** 2)
