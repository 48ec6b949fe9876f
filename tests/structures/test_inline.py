"""Structures stated on the command line itself."""

from dataclasses import replace

import pytest
from support.documents import built
from support.refusals import refuses

from rocking_cli import DocumentError, load_structures

STATED = [
    ("block:0.5x2", "kind: block\nwidth: 0.5\nheight: 2"),
    (
        "block: 50 cm x 2m ,restitution=0.9",
        "kind: block\nwidth: 0.5\nheight: 2\nrestitution: 0.9",
    ),
    ("block:radius=1,alpha=10 deg", "kind: block\nradius: 1\nalpha: 10 deg"),
    ("point_mass:1.2x4", "kind: point_mass\nwidth: 1.2\nheight: 4"),
    (
        "wall:0.6x5,one_sided=true",
        "kind: wall\nthickness: 0.6\nheight: 5\none_sided: true",
    ),
    ("drum:0.5x6", "kind: drum\nradius: 0.5\nheight: 6"),
    ("spire:1.5x12", "kind: spire\nbase_radius: 1.5\nheight: 12"),
    (
        "arch:10x1.5x157.5deg,voussoirs=7",
        "kind: arch\nradius: 10\nthickness: 1.5\nangle: 157.5 deg\nvoussoirs: 7",
    ),
    (
        "prism:corners=[[0,0],[1,0],[0.5,3]]",
        "kind: prism\ncorners: [[0, 0], [1, 0], [0.5, 3]]",
    ),
    (
        "parameters:p=2,alpha=0.2,eta=0.9,lambda=0.2",
        "kind: parameters\np: 2\nalpha: 0.2\neta: 0.9\nlambda: 0.2",
    ),
]


@pytest.mark.parametrize(("stated", "text"), STATED)
def test_it_is_the_document_that_a_file_would_hold(stated, text):
    (found,) = load_structures([stated])
    assert found.name == stated.replace(",", " ")
    assert replace(found, name="x") == replace(built(text), name="x")


def test_a_file_of_that_name_comes_first(rocking, tmp_path):
    (tmp_path / "block:1x2").write_text("kind: spire\nbase_radius: 1\nheight: 9\n")
    assert (
        '"structure_kind": "spire"' in rocking("params", "block:1x2", "--json").stdout
    )


REFUSED = [
    ("block:5", "found '5'; expected block:WIDTHxHEIGHT or block:KEY=VALUE,KEY=VALUE"),
    ("block:5x1x2", "found '5x1x2'; expected block:WIDTHxHEIGHT"),
    ("block:restitution=1,5x9", "found '5x9'; expected block:WIDTHxHEIGHT"),
    ("stack:1x2", "found '1x2'; expected stack:KEY=VALUE,KEY=VALUE"),
    ("block:1x5,width=2", "width is given twice"),
    ("block:1x5,widht=2", "unknown key 'widht' .did you mean 'width'"),
    ("block:1kgx5", "block:1kgx5: width: found 1kg; expected a length"),
    ("blokc:1x5", r"kind: found blokc; expected one of block, .*did you mean 'block'"),
]
test_refusals = refuses(
    lambda stated: load_structures([stated]), DocumentError, REFUSED
)


@pytest.mark.parametrize(
    ("text", "same"),
    [
        ("block:45x180cm", "block:45cmx180cm"),
        ("block:45 x 180 cm", "block:0.45x1.8"),
        ("block:0.45m x 180cm", "block:0.45x1.8"),
        ("block:45x180cm,friction=0.6", "block:0.45x1.8,friction=0.6"),
        ("block:0.45x1.8", "block:0.45x1.8m"),
        ("arch:10x1.5x157.5deg", "arch:10mx1.5mx157.5deg"),
    ],
)
def test_a_unit_behind_the_last_size_holds_for_those_without_one(text, same):
    first, second = load_structures([text, same])
    assert (first.p, first.alpha, first.eta) == pytest.approx(
        (second.p, second.alpha, second.eta), rel=1e-14
    )
