"""Numbers with a spread, as people write them."""

import math

import pytest

from rocking_cli import DocumentError, build_structure, parse_documents
from rocking_cli.documents.spreads import Spread, parse_spread
from rocking_cli.structures.draws import uncertain_keys
from rocking_cli.structures.inline import inline_document

DEGREE = math.pi / 180.0


@pytest.mark.parametrize(
    ("text", "dimension", "shape", "first", "second"),
    [
        ("0.5 m +- 10 mm", "length", "normal", 0.5, 0.01),
        ("0.5 m ± 2 %", "length", "normal", 0.5, 0.01),
        ("500 +- 10 mm", "length", "normal", 0.5, 0.01),
        ("0.5+-0.01", "length", "normal", 0.5, 0.01),
        ("0.85 .. 0.95", "number", "uniform", 0.85, 0.95),
        ("45 .. 55 cm", "length", "uniform", 0.45, 0.55),
        ("1e-1..2e-1", "number", "uniform", 0.1, 0.2),
        ("157.5 deg +- 0.5 deg", "angle", "normal", 157.5 * DEGREE, 0.5 * DEGREE),
    ],
)
def test_both_numbers_have_one_unit(text, dimension, shape, first, second):
    found = parse_spread(text, dimension)
    assert found.shape == shape
    assert (found.first, found.second) == pytest.approx((first, second), rel=1e-14)


@pytest.mark.parametrize(
    "text",
    [
        "0.95 .. 0.85",
        "0.5 m +- -1 mm",
        "0.5 m +- ",
        "1...2",
        "0.5 +- 0.1 +- 0.1",
        "0.5 .. 0.6 +- 0.1",
        "0.5 m +- 1 deg",
        ".. 0.9",
        "0.5 m +- 1 %%",
        "0.5 m + - 1 mm",
        "0.5 m .. 0.6 %",
        "nan +- 1",
        "0.4 +- inf",
    ],
)
def test_what_is_not_understood_is_refused(text):
    with pytest.raises(ValueError, match=r"MEAN \+- SD|LOW \.\. HIGH|a length"):
        parse_spread(text, "length")


def test_the_shares_outside_of_a_range():
    # Phi(-1) and Phi(-2.5), from tables of the normal distribution.
    assert Spread("normal", 0.95, 0.05).cut(0.0, 1.0) == pytest.approx(
        0.15865525, abs=1e-8
    )
    assert Spread("normal", 0.5, 0.2).cut(0.0, math.inf) == pytest.approx(
        0.0062096653, abs=1e-10
    )


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("{kind: block, width: 0.5, height: 2, restitution: 0.95 +- 0.05}", "15.9 %"),
        (
            "{kind: block, width: 0.5, height: 2, restitution: 0.9 .. 1.1}",
            "from 0 to 1",
        ),
        ("{kind: block, width: 0.5 +- 0.01, height: -2 .. 2}", "height"),
        (
            "{kind: arch, radius: 10, angle: 157.5 deg, thickness: 1.5,"
            " voussoirs: 7 +- 1}",
            "takes no spread",
        ),
        (
            "{kind: prism, corners: [[0, 0], [0.5 +- 0.1, 0], [0.5, 2], [0, 2]]}",
            "corners",
        ),
    ],
)
def test_a_range_of_the_key_holds_for_its_spread(text, said):
    (document,) = parse_documents(text)
    with pytest.raises(DocumentError, match=said):
        build_structure(document)


def test_the_unit_of_a_heading_and_of_a_size_holds_for_both_numbers():
    (row,) = parse_documents("kind,width [cm],height [m]\nblock,50 +- 1,2\n")
    keys = [*uncertain_keys(row), *uncertain_keys(inline_document("block:50+-1x200cm"))]
    assert [key.spread for key in keys] == [Spread("normal", 0.5, 0.01)] * 2


def test_a_document_without_draws_has_its_means():
    (document,) = parse_documents("{kind: block, width: 0.4 .. 0.6, height: 2 +- 1 %}")
    found = build_structure(document)
    assert found.uplift == pytest.approx(0.25, rel=1e-14)
    (certain,) = parse_documents("{kind: block, width: 0.5 +- 0, height: 2 .. 2}")
    assert uncertain_keys(certain) == []
