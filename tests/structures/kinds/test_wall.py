"""The wall out of its plane."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from support.documents import built

WALL = "kind: wall\nthickness: 0.6\nheight: 5\n"


def test_a_wall_is_the_block_as_wide_as_it_is_thick():
    for more in ("", "one_sided: true", "one_sided: true\nrestitution: -0.3\ndamping: 0.02", "gravity: 1.62"):
        wall, block = built(WALL + more), built(f"kind: block\nwidth: 0.6\nheight: 5\n{more}")
        assert replace(wall, structure="block") == block


def test_its_length_changes_nothing_and_is_reported():
    short, long = built(WALL + "length: 2 m"), built(WALL + "length: 12 m")
    assert (short.p, short.alpha, short.eta) == (long.p, long.alpha, long.eta)
    assert (short.details, long.details) == ({"length": 2.0}, {"length": 12.0})
    assert built(WALL).details == {}


def test_three_impacts_return_a_one_sided_wall():
    a = math.atan(0.6 / 5)
    wanted = (1 - 1.5 * math.sin(a) ** 2) ** 2 * (1 - 1.5 * math.cos(a) ** 2)
    assert built(WALL + "one_sided: true").eta == pytest.approx(wanted, rel=1e-13, abs=0)
