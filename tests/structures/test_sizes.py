"""Lengths that were probably meant in another unit, and sizes that were probably
swapped.
"""

import pytest
from support.documents import built

from rocking_cli import (
    DocumentError,
    build_structure,
    load_structures,
    parse_documents,
)

BARE = [
    (
        "kind: block\nwidth: 0.5\nheight: 190",
        "f.yaml:3:9: height: 190 without a unit is",
    ),
    ('{"kind": "wall", "thickness": 0.3, "height": 3000}', "f.yaml:1:46: height: 3000"),
    ("kind,width,height\nblock,0.5,190", "f.yaml:2:3: height: 190 without"),
    ("kind: prism\ncorners: [[0, 0], [4, 0], [4, 190]]", "f.yaml:2:31: corners: 190"),
    (
        "kind: stack\npieces: [{width: 60 cm, height: 90 cm}, {width: 4, height: 120}]",
        "f.yaml:2:60: pieces.1.height: 120 without",
    ),
]
USUAL = [
    "kind: block\nwidth: 45 m\nheight: 190 m",
    "kind: block\nwidth: 6\nheight: 29",
    "kind: wall\nthickness: 1\nheight: 9\nlength: 40",
    "kind,width [cm],height [cm]\nblock,45,190",
]


@pytest.mark.parametrize(("text", "words"), BARE)
def test_a_bare_length_beyond_the_usual_is_told(text, words):
    (remark,) = build_structure(parse_documents(text, "f.yaml")[0]).remarks
    assert remark.startswith(words)
    assert " to 30; did you mean " in remark
    assert " mm = " in remark


@pytest.mark.parametrize("text", USUAL)
def test_stated_units_and_usual_sizes_are_not_told(text):
    assert build_structure(parse_documents(text, "f.yaml")[0]).remarks == ()


def test_python_is_warned_and_the_command_line_too(rocking):
    told = "block:4x190: height: 190 without a unit is 190 m; usual is 0 to 30"
    with pytest.warns(UserWarning, match=told):
        load_structures("block:4x190")
    assert told in rocking("params", "block:4x190", "--json").stderr


@pytest.mark.parametrize(
    "text",
    [
        "block, width: 2",
        "wall, thickness: 2",
        "point_mass, width: 2",
        "drum, radius: 2",
        "spire, base_radius: 2",
    ],
)
def test_swapped_sizes_are_told_as_such(text):
    key = text.split(", ")[1].partition(":")[0]
    with pytest.raises(
        DocumentError,
        match=(
            f"{key} 2 m and height 0.5 m, wider than high .did you swap {key} and"
            " height"
        ),
    ):
        built(f"{{kind: {text}, height: 0.5}}")
