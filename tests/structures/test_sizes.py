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
    read_documents,
)

TALL = [
    (
        "kind: block\nwidth: 45\nheight: 190",
        (
            "f.yaml:3:9: height: 190 without a unit is 190 m, and the body is 190 m"
            " high; did you mean 190 cm?"
        ),
    ),
    (
        '{"kind": "wall", "thickness": 300, "height": 3000}',
        "f.yaml:1:46: height: 3000 without a unit .* did you mean 3000 mm",
    ),
    ("kind,width,height\nblock,45,190", "f.yaml:2:3: height: 190 without"),
    (
        "kind: prism\ncorners: [[0, 0], [45, 0], [45, 190], [0, 190]]",
        "f.yaml:2:33: corners: 190 without",
    ),
    (
        "kind: stack\npieces: [{width: 60, height: 90}, {width: 40, height: 120}]",
        "f.yaml:2:55: pieces.1.height: 120 without .* 210 m high",
    ),
    ("kind: spire\nbase_radius: 150\nheight: 900", "f.yaml:3:9: height: 900 without"),
    (
        "kind: arch\nradius: 500\nthickness: 75\nangle: 157.5 deg",
        "f.yaml:2:9: radius: 500 without",
    ),
]
MEANT = [
    "kind: block\nwidth: 45 m\nheight: 190 m",
    "kind: block\nwidth: 6\nheight: 29",
    "kind,width [cm],height [cm]\nblock,45,190",
    "kind: block\nradius: 1\nalpha: 0.2",
]


@pytest.mark.parametrize(("text", "words"), TALL)
def test_a_bare_length_that_makes_a_body_too_high_is_told(text, words):
    import re

    (remark,) = build_structure(parse_documents(text, "f.yaml")[0]).remarks
    assert re.match(words.replace("?", r"\?"), remark)


@pytest.mark.parametrize("text", MEANT)
def test_stated_units_and_usual_sizes_are_not_told(text):
    assert build_structure(parse_documents(text, "f.yaml")[0]).remarks == ()


def test_python_is_warned_and_the_command_line_too(rocking):
    (document,) = read_documents("block:45x190")
    assert "did you mean 190 cm?" in build_structure(document).remarks[0]
    with pytest.warns(
        UserWarning, match="block:45x190: height: 190 without a unit is 190 m"
    ):
        load_structures("block:45x190")
    done = rocking(
        "check",
        "block:45x190",
        "--a-g",
        "0.3g",
        "--f-g",
        "1",
        "--verdict-only",
        "--json",
    )
    assert (
        "block:45x190: height: 190 without a unit is 190 m, and the body is 190 m high;"
        " did you mean 190 cm?" in done.stderr
    )


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
