"""Families of structures: what is varied, in which unit and order, and members that
have no solution.
"""

import math

import numpy as np
import pytest
from support.documents import built
from support.refusals import refuses

from rocking_cli import DocumentError, UsageError, parse_documents
from rocking_cli.structures.family import MAX_MEMBERS, family, members, parse_variation

BLOCK = "kind: block\nname: Column\nwidth: 50 cm\nheight: 2"


def of(text, *variations):
    return list(
        family(
            parse_documents(text, "f.yaml")[0], [parse_variation(v) for v in variations]
        )
    )


def test_values_are_evenly_spaced_and_end_where_they_should():
    variation = parse_variation("width = 0.1:0.4:4")
    assert variation.key == "width"
    assert variation.values == pytest.approx((0.1, 0.2, 0.3, 0.4), rel=1e-14)
    assert variation.values[-1] == 0.4
    assert variation.unit is None
    assert parse_variation("angle=150deg:180deg:2")[1:] == ((150.0, 180.0), "deg")
    assert parse_variation("angle=150:180deg:2").unit == "deg"
    assert parse_variation("width=3:3:1").values == (3.0,)
    assert parse_variation("width=4m:1:3:log")[1:] == ((4.0, 2.0, 1.0), "m")
    document, given = (
        parse_documents(BLOCK, "f.yaml")[0],
        variation._replace(values=tuple(np.linspace(0.1, 0.4, 4))),
    )
    assert [one.parameters for one in family(document, [given])] == [
        one.parameters for one in family(document, [variation])
    ]


REFUSED = [
    ("width", "expected KEY=START:STOP:N"),
    ("=1:2:3", "expected KEY=START:STOP:N"),
    ("width=1m:2mm:3", "bounds in m and mm"),
    ("width=1:2", "expected KEY=START:STOP:N"),
    *(
        (f"width=1:2:{n}", "expected a whole number from 1")
        for n in ("0", "2.5", "²", "x")
    ),
    ("width=1:2:1", "one value from 1 to 2"),
    ("width=0:2:3:log", "a logarithmic axis needs a positive START"),
    (f"width=1:2:{MAX_MEMBERS + 1}", "expected a whole number from 1 to 1000000"),
]
test_variations_that_cannot_be_read = refuses(parse_variation, UsageError, REFUSED)


def test_a_family_is_every_combination_and_the_last_key_varies_fastest():
    found = of(BLOCK, "height=2:3:2", "width=40:60:3")
    assert [m.shown for m in found] == [
        {"height [m]": h, "width [cm]": w}
        for h in (2.0, 3.0)
        for w in (40.0, 50.0, 60.0)
    ]
    assert [m.varied for m in found] == [
        {"height": h, "width": w} for h in (2.0, 3.0) for w in (0.4, 0.5, 0.6)
    ]
    assert found[1].parameters.name == "Column height=2 width=50cm"
    assert found[1].parameters.details["varied"] == {"height": 2.0, "width": 0.5}
    original = built(BLOCK)
    assert (found[1].parameters.p, found[1].parameters.alpha) == (
        original.p,
        original.alpha,
    )


def test_a_bare_bound_is_in_the_unit_that_the_document_uses():
    (bare,), (metres,) = of(BLOCK, "width=40:40:1"), of(BLOCK, "width=0.4m:0.4m:1")
    assert bare.parameters.uplift == pytest.approx(0.2, rel=1e-14)
    assert metres.parameters.uplift == pytest.approx(0.2, rel=1e-14)
    (angle,) = of("kind: block\nradius: 1\nalpha: 0.2", "alpha=0.1:0.1:1")
    assert angle.parameters.alpha == pytest.approx(0.1, rel=1e-14)


def test_a_member_without_a_solution_says_why_and_the_others_stay():
    found = of(BLOCK, "width=100:500:3")
    assert [m.parameters is None for m in found] == [False, True, True]
    assert "found width 3 m and height 2 m, wider than high" in found[1].fault
    assert found[0].fault is None
    assert math.isfinite(found[0].parameters.p)


def test_a_key_that_the_kind_does_not_take_is_refused_at_once():
    with pytest.raises(DocumentError, match="did you mean 'width'"):
        of(BLOCK, "widht=1:2:3")
    with pytest.raises(UsageError, match="`vary` name: found a key that takes a text"):
        of(BLOCK, "name=1:2:3")


def test_keys_vary_once_and_members_are_counted():
    width, height = (
        parse_variation("width=1:2:1000"),
        parse_variation("height=1:2:1001"),
    )
    assert members([width]) == 1000
    with pytest.raises(UsageError, match="varied twice"):
        members([width, width])
    with pytest.raises(
        UsageError, match="found 1001000 structures; expected up to 1000000"
    ):
        members([width, height])
