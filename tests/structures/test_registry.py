"""From a document to a structure: which failures are the document's, and which are not."""

from __future__ import annotations

import math
import re

import pytest

from rocking_cli import DocumentError, build_structure, parse_documents
from rocking_cli.errors import StructureError
from rocking_cli.structures import KINDS


@pytest.mark.parametrize("bug", [ZeroDivisionError("bug"), ValueError("bug"), OverflowError("bug"), KeyError("bug")])
def test_a_bug_in_a_builder_is_not_the_documents_fault(monkeypatch, bug):
    def build(document, name):
        raise bug

    monkeypatch.setitem(KINDS, "block", build)
    with pytest.raises(type(bug), match="bug"):
        build_structure(parse_documents("kind: block")[0])


def test_geometry_without_a_structure_is_the_documents_fault(monkeypatch):
    def build(document, name):
        raise StructureError("never reaches an unstable equilibrium")

    monkeypatch.setitem(KINDS, "block", build)
    with pytest.raises(DocumentError, match=r"tower.yaml:1:1: block: never reaches an unstable equilibrium"):
        build_structure(parse_documents("kind: block", "tower.yaml")[0])


@pytest.mark.parametrize(
    ("document", "words"),
    [
        ("kind: block\nwidth: 1e-300\nheight: 1", "width: found 1e-300; accepted is a positive length, from 1e-09 m"),
        ("kind: block\nwidth: 1e300\nheight: 1", "width: found 1e300; accepted is a length"),
        ("kind: block\nwidth: 1e7 km\nheight: 1", "up to 1e+09 m"),
        ("kind: drum\nbase_radius: 1\ntop_radius: 1e200\nheight: 3", "top_radius: found 1e200"),
        ("kind: prism\ncorners: [[0, 0], [1e200, 0], [0, 1]]", "corners: found a corner"),
        (
            "kind: spire\nbase_radius: 1e9\nheight: 1e9\nthickness: 1e-9",
            "thickness: found 1e-9; accepted is a positive length below base_radius (1e+09 m) and above 1 m",
        ),
        ("kind: arch\nradius: 1e200\nthickness: 1\nangle: 1\nvoussoirs: 12", "radius: found 1e200"),
        ("kind: parameters\np: 1\nalpha: 1e-300\neta: 1\nlambda: 1e300", "a_scale is 0"),
    ],
)
def test_numbers_that_overflow_are_refused_by_name(document, words):
    with pytest.raises(DocumentError, match=re.escape(words)):
        build_structure(parse_documents(document)[0])


SIMILAR = [
    "kind: block\nwidth: {a}\nheight: {b}",
    "kind: drum\nbase_radius: {a}\ntop_radius: {c}\nheight: {b}",
    "kind: prism\ncorners: [[0, 0], [{a}, 0], [{c}, {b}]]",
    "kind: spire\nbase_radius: {a}\nheight: {b}\nthickness: {c}\ncrack: diagonal",
    "kind: arch\nradius: {b}\nthickness: {a}\nangle: 157.5 deg\nvoussoirs: 7",
]


@pytest.mark.parametrize("document", SIMILAR, ids=lambda text: text.split()[1])
def test_the_smallest_and_the_largest_lengths_are_similar_to_those_of_a_building(document):
    def built(size):
        return build_structure(parse_documents(document.format(a=size, b=6 * size, c=0.4 * size))[0])

    usual = built(1.0)
    for size in (1e-8, 1e8):
        found = built(size)
        assert (found.alpha, found.eta, found.uplift) == pytest.approx((usual.alpha, usual.eta, usual.uplift), rel=1e-9)
        assert found.p * math.sqrt(size) == pytest.approx(usual.p, rel=1e-9)
