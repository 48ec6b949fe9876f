"""The drum and stacked drums."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from written import built

from rocking_cli import DocumentError, build_structure, parse_documents
from rocking_cli.structures.drum import frustum_moments


def test_drum_is_the_cylinder_and_the_cone():
    r, h = 0.5, 6.0
    cylinder = built(f"kind: drum\nradius: {r}\nheight: {h}")
    assert cylinder.p**2 == pytest.approx(9.81 * math.hypot(r, h / 2) / (1.25 * r * r + h * h / 3), rel=1e-13, abs=0)
    assert cylinder.alpha == pytest.approx(math.atan(2 * r / h), rel=1e-14, abs=0)
    cone = built(f"kind: drum\nbase_radius: {r}\ntop_radius: 0\nheight: {h}")
    assert cone.alpha == pytest.approx(math.atan(4 * r / h), rel=1e-14, abs=0)
    assert cone.p**2 == pytest.approx(9.81 * math.hypot(r, h / 4) / (0.15 * r * r + 0.1 * h * h + r * r), rel=1e-13, abs=0)


def test_stacked_drums_are_the_column_they_make():
    whole = built("kind: drum\nbase_radius: 0.6\ntop_radius: 0.4\nheight: 6")
    parts = "{base_radius: 0.6, top_radius: 0.5, height: 3}, {base_radius: 0.5, top_radius: 0.4, height: 3}"
    stacked = built(f"kind: drum\ndrums: [{parts}]")
    assert (stacked.p, stacked.alpha, stacked.eta) == pytest.approx((whole.p, whole.alpha, whole.eta), rel=1e-13, abs=0)


def test_a_column_on_a_plinth_rocks_on_the_plinth():
    stacked = built("kind: drum\ndrums: [{radius: 2, height: 0.5}, {radius: 0.3, height: 6}]")
    column = built("kind: drum\nradius: 0.3\nheight: 6")
    assert (stacked.p, stacked.alpha, stacked.eta) == pytest.approx((column.p, column.alpha, column.eta), rel=1e-13, abs=0)
    assert stacked.details["rocks_on"] == "drum 1 from below"


@given(st.floats(0.05, 3), st.floats(0, 3), st.floats(0.1, 20))
def test_frustum_moments_equal_quadrature(low, high, height):
    nodes, weights = np.polynomial.legendre.leggauss(4)
    z = 0.5 * height * (nodes + 1)
    w = 0.5 * height * weights * math.pi
    r = low + (high - low) * z / height
    expected = ((w * r**2).sum(), 0.0, (w * r**2 * z).sum(), (w * (r**2 * z**2 + r**4 / 4)).sum())
    assert frustum_moments(low, high, height) == pytest.approx(expected, rel=1e-12, abs=0)


REFUSED = [
    ("kind: drum\nradius: 1\nheight: 6\ntop_radius: 1", "not both"),
    ("kind: drum\ndrums: []", "accepted is a list of drums"),
    ("kind: drum\ndrums: [3]", "found 3; accepted is a mapping"),
    ("kind: drum\ndrums: [{radius: 1, heigth: 2}]", "unknown key 'heigth'"),
    ("kind: drum\nbase_radius: 1\ntop_radius: -1\nheight: 3", "top_radius: found -1"),
]


@pytest.mark.parametrize(("text", "words"), REFUSED, ids=range(len(REFUSED)))
def test_refusals(text, words):
    (document,) = parse_documents(text, "f.yaml")
    with pytest.raises(DocumentError, match=words):
        build_structure(document)
