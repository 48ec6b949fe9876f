"""Parameters stated directly, and what `rocking params --json` prints read back."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest
from support.documents import built

from rocking_cli import DocumentError, RockingParameters
from rocking_cli.structures.parameters import Side

TWO = RockingParameters.of_sides("Statue", "rigid", Side("left", 2.1, 0.3, 0.31, 1.0, 0.8), Side("right", 1.9, 0.2, 0.21, 1.0, 0.9))
ONE = RockingParameters("Wall", "block", 1.3, 0.15, -0.4366730773, 0.151, 1.0, one_sided=True)


@pytest.mark.parametrize("body", [TWO, ONE, replace(TWO, damping=0.05), replace(ONE, damping=0.02)], ids=range(4))
def test_what_is_printed_is_a_document_of_the_same_body(body):
    assert built(json.dumps(body.record())) == body


ONE_SIDED = "kind: parameters\np: 2\nalpha: 0.2\nlambda: 0.2\none_sided: true\n"
SIDES = "kind: parameters\nsides:\n- {side: left, p: 2, alpha: 0.2, lambda: 0.2, eta: 0.9}\n"
OTHER = "- {side: right, p: 2, alpha: 0.3, a_scale: 1, eta: 0.8}\n"


def test_sides_are_read_with_lambda_or_a_scale():
    body = built(SIDES + OTHER)
    assert body.sides[1] == Side("right", 2.0, 0.3, 0.3, 1.0, 0.8)
    assert (body.alpha, body.eta) == (0.2, 0.9)
    assert built(SIDES + OTHER + "alpha: 0.2\np: 2 rad/s") == body


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (ONE_SIDED + "eta: 0.4", r"f.yaml:6:6: eta: found 0.4; expected a number above -1 and up to 0"),
        (ONE_SIDED + "eta: -1", "found -1; expected a number above -1"),
        (ONE_SIDED.replace("true", "yes") + "eta: -0.4", "one_sided: found yes; expected true or false"),
        (ONE_SIDED.replace("p: 2", "p: 1e200") + "eta: -0.4", "f.yaml:2:4: p: found 1e200; expected a positive number, from 1e-150 to"),
        (ONE_SIDED.replace("p: 2", "p: 1e-200") + "eta: -0.4\narm: 1", "p: found 1e-200; expected a positive number, from 1e-150 to"),
        (SIDES, "sides: found a list; expected a list of two"),
        (SIDES + OTHER.replace("right", "left"), "sides: found the left side twice"),
        (SIDES + OTHER.replace("right", "rigth"), "side: found rigth; expected one of left, right"),
        (SIDES + OTHER.replace("eta", "ata"), "no key 'eta'"),
        (SIDES + OTHER.replace("}", ", q: 1}"), "f.yaml:4:60: unknown key 'q'"),
        (SIDES + OTHER + "alpha: 0.3", "alpha: found 0.3; expected 0.2 as in sides, where the left edge lifts first"),
        (SIDES + OTHER + "one_sided: true", "one_sided: found a one-sided body of two sides"),
        (ONE_SIDED + "eta: -0.4\ndamping: 1", "damping: found 1; expected a number from 0 to below 1"),
        (
            ONE_SIDED + "eta: -0.4\nstructure_kind: dimensionless",
            "structure_kind: found dimensionless; expected the kind of a structure",
        ),
    ],
)
def test_refusals(text, words):
    with pytest.raises(DocumentError, match=words):
        built(text)


def test_parameters_give_lambda_and_a_scale_from_each_other():
    base = "kind: parameters\np: 2\nalpha: 0.2\neta: 0.9\n"
    assert built(base + "lambda: 0.4").a_scale == pytest.approx(0.5)
    assert built(base + "a_scale: 0.5").uplift == pytest.approx(0.4)
    both = built(base + "lambda: 0.3\na_scale: 1")
    assert (both.uplift, both.a_scale) == (0.3, 1.0)


@pytest.mark.parametrize("text", ["kind: block\nwidth: 0.5\nheight: 2", "kind: spire\nbase_radius: 1\nheight: 9\nname: Ö 'x'"])
def test_a_record_is_a_document_of_the_same_parameters(text):
    first = built(text)
    assert built(json.dumps(first.record())) == first
