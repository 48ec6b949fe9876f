"""The figure of a check by a code: what its lines and marks are."""

import math

import pytest
from matplotlib.figure import Figure

from rocking_cli import code_check, load_structures, parse_grid, sine
from rocking_cli.reports.figures.capacity_curves import _panel


def test_marks_stand_at_the_limit_states_and_at_their_demands():
    found = code_check(load_structures("block:0.5x2")[0], sine(), parse_grid("a_g=0.3g,T_g=0.4"))
    axes = Figure().add_subplot()
    _panel(axes, found)
    lines = {line.get_label(): line for line in axes.lines}
    assert lines["capacity"].get_xydata()[0] == pytest.approx((0.0, 0.25))
    assert lines["capacity"].get_xydata()[-1] == pytest.approx((250.0, 0.0))
    assert lines["$d_{SLV}$ = 100 mm"].get_xydata()[0] == pytest.approx((100.0, found.slv.acceleration / 9.81))
    (x, y) = lines[f"demand at SLC {1000 * found.slc.demand:.3g} mm"].get_xydata()[0]
    assert y * 9.81 == pytest.approx(x / 1000 * (2 * math.pi / found.slc.period) ** 2)
