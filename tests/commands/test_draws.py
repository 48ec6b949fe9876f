"""--draws at the shell: numbers with a spread."""

import re

import pytest
from support.soak import quick

WALL = "block:0.62+-0.01x2"
DEMAND = ("--a-g", "0.4g", "--f-g", "1")


def test_the_means_are_taken_and_a_line_says_so(rocking):
    done = rocking("params", "block:0.5+-0.01x2", "--json")
    assert done.record["lambda"] == 0.25
    assert "means are taken of numbers with a spread: width" in done.stderr


def test_params_has_a_row_for_each_quantity(rocking):
    rows = rocking("params", "block:0.5+-0.01x2", "--draws", "1024", "--json").records
    found = {row["quantity"]: row for row in rows}
    # lambda = w/h is normal: mean 0.25, sd 0.005, q05 = 0.25 - 1.644854 * 0.005.
    assert found["lambda"]["sd"] == pytest.approx(0.005, rel=0.01)
    assert found["lambda"]["q05"] == pytest.approx(0.24177573, abs=5e-5)
    assert list(found) == ["p", "alpha", "eta", "lambda", "a_scale"]


def test_a_document_may_come_through_a_pipe(rocking):
    text = '{"kind": "block", "width": "0.5 +- 0.01", "height": 2}'
    done = rocking("params", "-", "--draws", "8", "--csv", stdin=text)
    assert len(done.rows) == 5


@pytest.mark.parametrize("workers", quick(["1", "2"], "1"))
def test_check_gives_the_share_that_falls(rocking, workers):
    calls = ("check", WALL, "block:0.7x2", *DEMAND, "--draws", "256")
    done = rocking(*calls, "--verdict-only", "--workers", workers, "--json")
    row, certain = done.records
    # Phi((w* - mean)/sd) with w* = 0.62312019 m (independent integrator)
    assert row["share_low"] < 0.62248696 < row["share_high"]
    assert (row["key_1"], row["draws"]) == ("width", 256)
    assert certain["share_falls"] is None
    assert "of 256 draws 62" in done.stderr
    assert "of the means, 1 of 2 overturn: block:0.62+-0.01x2\n" in done.stderr


def test_quantiles_of_the_first_overturning_have_the_units_of_the_table(rocking):
    call = ("check", WALL, *DEMAND, "--draws", "16", "--units", "g")
    done = rocking(*call, "--columns", "all")
    assert "first_overturning_a_q50 [g]" in done.stdout
    row = rocking("check", WALL, *DEMAND, "--draws", "16", "--json").record
    quantiles = [row[f"first_overturning_a_{q}"] for q in ("q05", "q50", "q95")]
    assert quantiles == sorted(quantiles)
    assert quantiles[0] < row["first_overturning_a"] < quantiles[2]


def test_families_and_draws_go_together(rocking):
    call = ("check", WALL, *DEMAND, "--vary", "height=1.9:2.1:2", "--draws", "64")
    low, high = rocking(*call, "--verdict-only", "--json").records
    assert low["share_falls"] < 0.1 < 0.9 < high["share_falls"]


EVEN = (
    '{"kind": "rigid", "left": 0.3, "right": "0.3 +- 0.02", "height": 1,'
    ' "gyration": 0.6}'
)


@pytest.mark.parametrize(
    ("body", "amplitude", "code"),
    [
        ('{"kind": "block", "width": "0.63 +- 0.01", "height": 2}', "0.4g", 5),
        ('{"kind": "block", "width": "0.7 +- 0.01", "height": 2}', "0.4g", 0),
        # equal means, unequal draws: they fall under the opposite motion alone
        (EVEN, "0.34g", 5),
    ],
)
def test_pipelines_fail_if_a_draw_falls_though_the_means_stand(
    rocking, body, amplitude, code
):
    draws = "64" if body == EVEN else "16"
    call = ("check", "-", "--a-g", amplitude, "--f-g", "1", "--draws", draws)
    done = rocking(
        *call, "--verdict-only", "--fail-on", "overturning", "--json", stdin=body
    )
    assert (done.record["outcome"], done.returncode) == ("rocked", code)
    if body == EVEN:
        assert done.record["share_falls"] == 0.0
        assert "opposite direction (--scale -1)" in done.stderr


def test_a_range_says_that_draws_share_its_worst_frequency(rocking):
    call = ("check", "block:0.7+-0.01x2", "--a-g", "0.1g", "--f-g", "1:2")
    done = rocking(*call, "--draws", "4", "--verdict-only")
    assert "worst frequency of the means" in done.stderr


def test_draws_without_a_structure_are_left_out_and_named(rocking):
    call = ("params", "block:1.2..3x2", "--draws", "64", "--csv")
    done = rocking(*call)
    assert done.returncode == 4
    assert "draws make no structure and are left out" in done.stderr


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (("params", "block:0.5x2", "--draws", "8"), "no number of the structures"),
        (("check", "block:0.5x2", *DEMAND, "--draws", "8"), "no number"),
        (
            ("check", WALL, *DEMAND, "--draws", "8", "--fail-on", "slide=1cm"),
            "draws have no displacement",
        ),
        (("params", WALL, "--draws", "1"), "--draws"),
        (("params", WALL, "--draws", "8", "--seed", "-1"), "--seed"),
        (("params", WALL, "--vary", "width=1:2:2"), "has a spread"),
        (("params", WALL, "--vary", "height=1:2:2", "--draws", "8"), "--vary"),
        (("params", "block:0.5x2,restitution=0.95..0.85"), "lower bound first"),
        (("params", "block:0.5x2,restitution=0.95+-0.05"), "15.9 %"),
        (("params", "block:0.5+-0.1+-0.1x2"), "MEAN +- SD"),
        (("params", "block:0.5...0.6x2"), "MEAN +- SD"),
        (("params", "block:..0.6x2"), "MEAN +- SD"),
    ],
)
def test_what_has_no_draws_is_refused(rocking, call, said):
    done = rocking(*call)
    assert done.returncode in (2, 3)
    assert said in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.soak
@pytest.mark.usefixtures("undrawn")
def test_a_report_says_how_many_fall(rocking, tmp_path):
    out = tmp_path / "r.html"
    call = ("report", WALL, *DEMAND, "--draws", "64", "-o", str(out))
    assert rocking(*call).returncode == 0
    text = out.read_text()
    assert re.search(r": of 64 draws 6\d.* % fall \(.* to .* %\)", text)
    assert 'alt="Share of the draws of' in text
