"""Figures of fragility, read back from the figure that would be saved."""

import math

import numpy as np
import pytest
from scipy.special import ndtr


def test_a_fragility_curve_is_dashed_beyond_its_last_level(drawn):
    head = "structure,im,limit_state,method,x,probability,low,high,fraction\n"
    (axes,) = drawn(
        head
        + "".join(
            f"S,PGA,0.5,stripes,{x},{x / 50},,,{0.1 if x in (10, 20) else ''}\n"
            for x in (5, 10, 20, 30)
        )
    ).axes
    assert axes.get_ylabel() == "P(θ/α > 0.5 | PGA)"
    solid, dashed = axes.get_lines()[:2]
    named = axes.get_legend_handles_labels()[1]
    assert "beyond the last level" in named
    assert "95 % band of the fit" not in named  # the rows have none
    assert (solid.get_xdata()[-1], dashed.get_xdata()[0], dashed.get_linestyle()) == (
        20 / 9.81,
        20 / 9.81,
        "--",
    )
    assert axes.get_title() == "S, stripes"


def test_a_state_below_another_one_is_named(drawn):
    """theta/alpha > 1 and overturning of the same motions are one curve."""
    head = "structure,im,limit_state,method,x,probability,low,high,fraction\n"
    (axes,) = drawn(
        head
        + "".join(
            f"S,PGA,{state},stripes,{x},{x / most},{x / 60},{x / 40},\n"
            for state, most in (("0.5", 40), ("1", 50), ("overturning", 50))
            for x in (5, 10, 20)
        )
    ).axes
    named = axes.get_legend_handles_labels()[1]
    assert "overturning: as θ/α > 1" in named
    assert "95 % band of the fit" in named
    assert len([name for name in named if ": as " in name]) == 1


def test_fragility_over_two_measures_has_its_cells_and_lines_of_equal_probability(
    drawn,
):
    """The line of P = 0.5 parts cells that fall from PGA PGV/PGA = 0.8 on: it lies
    between their logarithms.
    """
    cells = [(x, y) for x in np.geomspace(1, 8, 7) for y in np.geomspace(0.1, 0.8, 7)]
    flags = [
        (
            "overturned_after_impact"
            if x * y > 0.8 * (1 + 0.3 * math.sin(9 * x))
            else "rocked"
        )
        for x, y in cells
    ]
    rows = "".join(
        f"S,m,{x},{y},0.5,{flag}\n" for (x, y), flag in zip(cells, flags, strict=True)
    )
    (axes,) = drawn(
        "structure,motion,pga [m/s2],pgv_pga [s],theta_ratio,outcome\n" + rows
    ).axes
    falls, stands = (line.get_xdata().size for line in axes.get_lines()[:2])
    assert (falls, stands) == (
        flags.count("overturned_after_impact"),
        flags.count("rocked"),
    )
    (contours,) = [c for c in axes.collections if hasattr(c, "levels")]
    assert ndtr(contours.levels) == pytest.approx([0.1, 0.5, 0.9])
    x, y = contours.get_paths()[1].vertices.T
    assert np.exp(np.mean(np.log(9.81 * x * y))) == pytest.approx(0.8, rel=0.15)
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("PGA [g]", "PGV/PGA [s]")
