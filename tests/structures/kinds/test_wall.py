"""The wall out of its plane."""

from __future__ import annotations

from dataclasses import replace

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
