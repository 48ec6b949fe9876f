"""Responses and comparisons, read back from the figure that would be saved."""

from __future__ import annotations

import math

import numpy as np
import pytest
from support.axes import lines, numbers, same

from rocking_cli.reports.figures.curves import with_jumps
from rocking_cli.reports.units import parse_units


@pytest.mark.parametrize(
    ("extra", "x", "y", "ground", "labels"),
    [
        (("--model", "both"), "t", ("theta_linear", "theta_nonlinear"), "ground_acceleration",
         ("time $t$ [s]", r"rotation $\theta$ [rad]", r"$\ddot{x}_g$ [g]")),
        (("--dimensionless",), "tau", ("theta_ratio",), "A", (r"$p\,t$ [-]", r"$\theta/\alpha$ [-]", r"$A\,s$ [-]")),
    ],
)  # fmt: skip
def test_a_response_stands_above_its_motion(drawn, table, extra, x, y, ground, labels):
    source, rows = table("response", "configs/block.yaml", "--A", "2", "--Omega", "4", *extra)
    axes, below = drawn(source).axes
    for line, column in zip(axes.get_lines(), y, strict=True):
        same(line.get_data(), numbers(rows, x), numbers(rows, column))
    unit = 9.81 if x == "t" else 1.0
    same(below.get_lines()[0].get_data(), numbers(rows, x), numbers(rows, ground) / unit)  # a sine does not jump
    assert (below.get_xlabel(), axes.get_ylabel(), below.get_ylabel()) == labels
    assert (axes.get_legend() is not None) == (len(y) > 1)


def test_forces_stand_between_the_response_and_its_motion(drawn, table):
    source, rows = table("response", "configs/block.yaml", "--A", "2", "--Omega", "4", "--forces")
    axes, between, below = drawn(source).axes
    assert len(axes.get_lines()) == 1
    for line, name in zip(between.get_lines(), ("fx_ratio", "fz_ratio"), strict=True):
        t, force = line.get_data()
        upright = np.flatnonzero(np.diff(t) == 0.0) + 1  # a point more at each impact
        same((np.delete(t, upright - 1), np.delete(force, upright - 1)), numbers(rows, "t"), numbers(rows, name))
    assert [text.get_text() for text in between.get_legend().get_texts()] == ["$F_x/mg$", "$F_z/mg$"]
    for panel in (axes, between, below):  # no label runs into the panel beside it
        label = panel.yaxis.label.get_window_extent()
        assert panel.get_window_extent().height > label.height


def test_a_motion_jumps_upright(drawn, table):
    call = ("response", "configs/block.yaml", "--pulse", "rectangular-impulse", "--a-g", "0.26g", "--T-g", "0.4", "--duration", "3")
    source, _ = table(*call)
    t, a = drawn(source).axes[1].get_lines()[0].get_data()
    upright = np.flatnonzero(np.diff(t) == 0.0)
    np.testing.assert_allclose([(a[i], a[i + 1]) for i in upright], [(0.26, -0.13), (-0.13, 0)], rtol=1e-12)
    assert t[upright] == pytest.approx([0.4, 1.2], abs=3.0 / 500)
    assert not np.any((np.diff(t) > 0.0) & (np.abs(np.diff(a)) > 1e-12))


def test_only_jumps_are_upright():
    t = np.linspace(0, 1, 50)
    assert with_jumps(t, np.sin(7 * t))[0].size == 50
    assert with_jumps(t, np.where(t < 0.5, 1.0, 0.0))[0].size == 51
    assert with_jumps(t[:1], t[:1])[0].size == 1


def test_units_are_those_asked_for(drawn, table):
    source, rows = table("response", "configs/block.yaml", "--A", "2", "--Omega", "4", "--units", "deg,g")
    axes, below = drawn(source, units=parse_units("mrad,m/s2")).axes
    np.testing.assert_allclose(axes.get_lines()[0].get_ydata(), 1e3 * np.radians(numbers(rows, "theta")), rtol=1e-12)
    np.testing.assert_allclose(below.get_lines()[0].get_ydata(), 9.81 * numbers(rows, "ground_acceleration"), rtol=1e-12)
    assert (axes.get_ylabel(), below.get_ylabel()) == (r"rotation $\theta$ [mrad]", r"$\ddot{x}_g$ [m/s²]")


def test_a_comparison_collapses_from_left_to_right(drawn, table):
    call = ("compare", "configs/block.yaml", "configs/spire.yaml", "--A", "2", "--Omega", "4", "--eta", "0.8", "--curves")
    source, rows = table(*call)
    left, right = drawn(source).axes
    assert set(lines(left)) == {"Column, linear", "Spire, linear"}
    for name in ("Column", "Spire"):
        mine = [r for r in rows if r["structure"] == name]
        same(lines(left)[f"{name}, linear"], numbers(mine, "t"), numbers(mine, "theta"))
        same(lines(right)[f"{name}, linear"], numbers(mine, "tau"), numbers(mine, "theta_ratio"))
    heights = [[np.abs(y).max() for _, y in lines(axes).values()] for axes in (left, right)]
    assert max(heights[0]) > 1.2 * min(heights[0])
    assert max(heights[1]) == pytest.approx(min(heights[1]), rel=1e-3)
    assert math.isfinite(heights[0][0])
