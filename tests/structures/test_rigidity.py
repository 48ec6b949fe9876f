"""How rigid a body is: omega_n over sqrt(g/R), and what is said of it."""

import json
import math

import pytest
from support.documents import built

from rocking_cli import DocumentError

BLOCK = "kind: block\nwidth: 0.5\nheight: 4\n"


@pytest.mark.parametrize(
    ("period", "said"),
    # shares of the table of a lumped mass on a column: the nearest ratio below
    [
        (0.1, ""),
        (0.15, "no table"),
        (0.19, "10 %"),
        (0.3, "13 %"),
        (0.6, "29 %"),
        (1.5, "no table"),
    ],
)
def test_the_ratio_is_that_of_the_mass_centre(period, said):
    body = built(f"{BLOCK}period: {period} s")
    ratio = 2.0 * math.pi / period / math.sqrt(9.81 / math.hypot(0.25, 2.0))
    assert body.details["omega_n"] == pytest.approx(2.0 * math.pi / period, rel=1e-12)
    assert body.details["omega_n_over_p"] == pytest.approx(ratio, rel=1e-12)
    assert len(body.remarks) == bool(said)
    assert all(said in remark and "not rigid" in remark for remark in body.remarks)


def test_a_steep_body_has_no_table():
    body = built("kind: block\nwidth: 2\nheight: 3\nperiod: 0.15")
    (remark,) = body.remarks
    assert body.details["omega_n_over_p"] < 20.0
    assert "no table" in remark


def test_what_params_prints_says_the_same():
    body = built(f"{BLOCK}period: 0.3 s")
    again = built(json.dumps(body.row()))
    assert again.details == body.details
    assert (
        again.remarks[0].partition(": omega_n/p")[2]
        == body.remarks[0].partition(": omega_n/p")[2]
    )


def test_a_rigid_body_has_no_word():
    assert "omega_n" not in built(BLOCK).details


def test_a_period_of_nothing_is_refused():
    with pytest.raises(DocumentError, match="period: found 0"):
        built(f"{BLOCK}period: 0 s")
