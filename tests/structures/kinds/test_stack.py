"""Pieces on each other: rectangular and round ones, the interface they rock on, and what each interface would give."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.documents import built

STATUE = "kind: stack\npieces: [{width: 1.2, depth: 1, height: 0.9}, {radius: 0.35, height: 0.2}, {radius: 0.3, height: 1.9}]"


def test_a_single_cuboid_is_the_block_and_a_single_cylinder_the_drum():
    for piece, other in (
        ("width: 0.5, height: 2", "kind: block\nwidth: 0.5\nheight: 2"),
        ("width: 0.5, depth: 7, height: 2", "kind: block\nwidth: 0.5\nheight: 2"),
        ("radius: 0.3, height: 2", "kind: drum\nradius: 0.3\nheight: 2"),
        ("base_radius: 0.3, top_radius: 0.1, height: 2", "kind: drum\nbase_radius: 0.3\ntop_radius: 0.1\nheight: 2"),
    ):
        found, wanted = built(f"kind: stack\npieces: [{{{piece}}}]"), built(other)
        assert (found.p, found.alpha, found.eta, found.uplift) == pytest.approx(
            (wanted.p, wanted.alpha, wanted.eta, wanted.uplift), rel=1e-13, abs=0
        )
        assert found.details == {}


def test_cuboids_cut_across_are_the_block_they_make():
    whole = built("kind: block\nwidth: 0.6\nheight: 6")
    cut = built("kind: stack\npieces: [{width: 0.6, height: 1.5}, {width: 0.6, height: 4}, {width: 0.6, height: 0.5}]")
    assert (cut.p, cut.alpha, cut.eta) == pytest.approx((whole.p, whole.alpha, whole.eta), rel=1e-13, abs=0)
    assert cut.details["rocks_on"] == "its base"


def test_every_interface_has_its_parameters():
    found = built(STATUE)
    plinth, disk, figure = 1.2 * 1 * 0.9, math.pi * 0.35**2 * 0.2, math.pi * 0.3**2 * 1.9  # volumes
    # By hand: each body about its own centre, then the parallel axes to the pivot.
    bodies = [
        (plinth, 0.45, plinth * (1.2**2 + 0.9**2) / 12),
        (disk, 1.0, disk * (0.35**2 / 4 + 0.2**2 / 12)),
        (figure, 2.05, figure * (0.3**2 / 4 + 1.9**2 / 12)),
    ]
    for i, (half, level, on) in enumerate([(0.6, 0.0, "its base"), (0.35, 0.9, "piece 1 from below"), (0.3, 1.1, "piece 2 from below")]):
        above = [(m, z - level, central) for m, z, central in bodies[i:]]
        mass = sum(m for m, _, _ in above)
        height = sum(m * z for m, z, _ in above) / mass
        inertia = sum(central + m * (z * z + half * half) for m, z, central in above)
        eta = 1 - 2 * mass * half * half / inertia
        told = dict(found.details["interfaces"][i])
        assert told.pop("on") == on
        wanted = {"p": math.sqrt(9.81 * mass * math.hypot(half, height) / inertia), "alpha": math.atan(half / height)}
        wanted |= {"eta": eta, "lambda": half / height}
        assert told == pytest.approx(wanted, rel=1e-13, abs=0)
    weakest = min(found.details["interfaces"], key=lambda one: one["lambda"])
    assert found.details["rocks_on"] == weakest["on"] == "piece 2 from below"
    assert (found.p, found.alpha, found.eta, found.uplift) == pytest.approx(
        tuple(weakest[key] for key in ("p", "alpha", "eta", "lambda")), rel=1e-13, abs=0
    )


def test_an_interface_too_squat_to_rock_on_has_no_restitution():
    found = built("kind: stack\npieces: [{width: 3, height: 0.5}, {width: 0.4, height: 2}]")
    assert [one["eta"] is None for one in found.details["interfaces"]] == [True, False]


@given(st.lists(st.tuples(st.floats(0.2, 2), st.floats(0.2, 2), st.floats(0.2, 3), st.floats(1, 5)), min_size=1, max_size=4))
def test_the_unit_of_density_changes_nothing(sizes):
    def stack(factor):
        rows = [f"{{width: {w!r}, depth: {d!r}, height: {h!r}, density: {rho * factor!r}}}" for w, d, h, rho in sizes]
        return built(f"kind: stack\nrestitution: 0.8\npieces: [{', '.join(rows)}]")

    one, other = stack(1.0), stack(1000.0)
    assert (one.p, one.alpha) == pytest.approx((other.p, other.alpha), rel=1e-12, abs=0)


def test_a_heavy_top_rocks_the_whole():
    light = "kind: stack\npieces: [{width: 1, height: 2, density: 1000 kg/m3}, {width: 1, height: 2, density: %s}]"
    # lambda = 0.5 mass / first moment
    assert built(light % "8 t/m3").uplift == pytest.approx(0.5 * 9 / (1 * 1 + 8 * 3), rel=1e-14, abs=0)


def test_a_piece_that_was_pushed_has_two_sides():
    found = built("kind: stack\npieces: [{width: 1, height: 2}, {width: 1, height: 2, offset: 0.2}]")
    assert [side.uplift for side in found.sides] == pytest.approx([0.6 / 2, 0.4 / 2], rel=1e-13, abs=0)
    assert found.details["interfaces"][1]["lambda"] == pytest.approx(0.3 / 1, rel=1e-13, abs=0)
