"""Families, read back from the figure that would be saved."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from support.axes import lines, numbers, same

from rocking_cli import UsageError

KEYS = ("p", "alpha", "eta", "lambda")
SPIRES = ("params", "configs/spire.yaml", "--vary", "base_radius=1:2:4", "--vary", "height=8:16:3")


def test_a_family_is_its_parameters_over_the_first_key_and_a_line_for_each_value_of_the_second(drawn, table):
    source, rows = table(*SPIRES)
    figure = drawn(source)
    assert [a.get_xlabel() for a in figure.axes] == ["", "", "base radius [m]", "base radius [m]"]
    assert [a.get_ylabel() for a in figure.axes] == ["$p$ [rad/s]", r"$\alpha$ [rad]", r"$\eta$ [-]", r"$\lambda$ [-]"]
    for axes, key in zip(figure.axes, KEYS, strict=True):
        found = lines(axes)
        assert list(found) == ["height = 8 m", "height = 12 m", "height = 16 m"]
        for label, line in found.items():
            mine = [r for r in rows if float(r["height"]) == float(label.split()[2])]
            same(line, numbers(mine, "base_radius"), numbers(mine, key))


def test_one_key_over_another_is_a_slenderness_on_which_spires_collapse(drawn, table):
    source, rows = table(*SPIRES)
    figure = drawn(source, over="base_radius/height")
    assert figure.axes[2].get_xlabel() == "base radius / height [-]"
    for label, line in lines(figure.axes[1]).items():
        mine = [r for r in rows if float(r["height"]) == float(label.split()[2])]
        same(line, numbers(mine, "base_radius") / numbers(mine, "height"), numbers(mine, "alpha"))
        np.testing.assert_allclose(line[1], np.arctan(3 * line[0]), rtol=1e-12)  # Eq. 3.1
    with pytest.raises(UsageError, match="`over`: found 'width'; expected base_radius, height, or one over another"):
        drawn(source, over="width")


def test_a_line_is_broken_where_the_mechanism_changes(drawn, table):
    source, rows = table("params", "configs/arch.yaml", "--vary", "thickness=1.45:1.75:7")
    figure = drawn(source)
    assert [a.get_ylabel() for a in figure.axes][:5] == [
        "$p$ [rad/s]", r"$\alpha$ [rad]", r"$\eta$ [-]", r"$\lambda$ [-]", "$a_{scale}$ [-]",
    ]  # fmt: skip
    (line,) = figure.axes[1].get_lines()
    x, y = line.get_data()
    # Of seven voussoirs the second hinge moves from 67.5 to 45 degrees between 1.6 and 1.65 m.
    changed = [float(a["hinges_2_angle"]) != float(b["hinges_2_angle"]) for a, b in pairwise(rows)]
    assert changed == [False, False, False, True, False, False]
    np.testing.assert_array_equal(np.isnan(y), [False] * 4 + [True] + [False] * 3)
    same((x[~np.isnan(x)], y[~np.isnan(y)]), numbers(rows, "thickness"), numbers(rows, "alpha"))


def test_a_varied_angle_keeps_the_unit_of_the_option(drawn, table):
    source, _ = table("params", "block:radius=1,alpha=10deg", "--vary", "alpha=10:20:3")
    axes = drawn(source).axes
    assert axes[2].get_xlabel() == "alpha varied [deg]"
    np.testing.assert_allclose(axes[1].get_lines()[0].get_xdata(), [10, 15, 20], rtol=1e-14)


def test_what_was_not_varied_is_no_family(drawn, tmp_path):
    (tmp_path / "table.csv").write_text("name,p,alpha,eta,lambda\nx,1,1,1,1\n")
    with pytest.raises(UsageError, match="a family is drawn over the keys that were varied"):
        drawn(tmp_path / "table.csv")
