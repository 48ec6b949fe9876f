"""Parameters stated directly, and what `rocking params --json` prints read back."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest
from support.documents import built

from rocking_cli import RockingParameters
from rocking_cli.structures.parameters import Side

TWO = RockingParameters.of_sides("Statue", "rigid", Side("left", 2.1, 0.3, 0.31, 1.0, 0.8), Side("right", 1.9, 0.2, 0.21, 1.0, 0.9))
ONE = RockingParameters("Wall", "block", 1.3, 0.15, -0.4366730773, 0.151, 1.0, one_sided=True)
STATUE = "kind: rigid\nleft: 0.42\nright: 31 cm\nheight: 1.15\ngyration: 0.68\n"
TEXTS = [STATUE + more for more in ("", "mass: 3 t", "restitution: 0.7\ndamping: 0.05", "one_sided: true\nrestitution: -0.3")]
TEXTS += ["kind: block\nwidth: 0.5\nheight: 2", "kind: spire\nbase_radius: 1\nheight: 9\nname: Ö 'x'"]


@pytest.mark.parametrize("body", [TWO, ONE, replace(TWO, damping=0.05), replace(ONE, damping=0.02), *map(built, TEXTS)], ids=range(10))
def test_what_is_printed_is_a_document_of_the_same_body(body):
    assert built(json.dumps(body.record())) == body


SIDES = "kind: parameters\nsides:\n- {side: left, p: 2, alpha: 0.2, lambda: 0.2, eta: 0.9}\n"
OTHER = "- {side: right, p: 2, alpha: 0.3, a_scale: 1, eta: 0.8}\n"


def test_sides_are_read_with_lambda_or_a_scale():
    body = built(SIDES + OTHER)
    assert body.sides[1] == Side("right", 2.0, 0.3, 0.3, 1.0, 0.8)
    assert (body.alpha, body.eta) == (0.2, 0.9)
    assert built(SIDES + OTHER + "alpha: 0.2\np: 2 rad/s") == body


def test_parameters_give_lambda_and_a_scale_from_each_other():
    base = "kind: parameters\np: 2\nalpha: 0.2\neta: 0.9\n"
    assert built(base + "lambda: 0.4").a_scale == pytest.approx(0.5)
    assert built(base + "a_scale: 0.5").uplift == pytest.approx(0.4)
    both = built(base + "lambda: 0.3\na_scale: 1")
    assert (both.uplift, both.a_scale) == (0.3, 1.0)
