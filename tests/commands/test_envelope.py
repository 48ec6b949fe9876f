"""`rocking envelope` at the shell."""

import json
import math

import pytest


def test_reference_row(rocking):
    call = ("envelope", "--eta", "0.9", "--grid", "Omega=5", "--json")
    done = rocking(*call, "--notes")
    assert (
        "intervals narrower than 0.001 in A, safe or overturning, may be missed"
        in done.stderr
    )
    assert rocking(*call).stderr == rocking(*call, "--notes", "-q").stderr == ""
    rows = done.records
    assert [r["mode"] for r in rows] == ["after_impact", "no_impact"]
    assert (rows[0]["A_from"], rows[0]["A_to"], rows[1]["A_from"]) == pytest.approx(
        (3.01860, 6.31807, 7.16813), abs=5.1e-6
    )
    assert rows[1]["A_to"] is None


def test_closed_form_curves(rocking):
    done = rocking(
        "envelope", "--eta", "0.9", "--grid", "Omega=5", "--closed-form", "--json"
    )
    rows = {r["curve"]: r["A"] for r in done.records}
    assert rows == pytest.approx(
        {
            "initiation": 1.0,
            "no_impact": 7.16813,
            "after_impact_lower": 3.01860,
            "after_impact_upper": 6.31807,
        },
        abs=5.1e-6,
    )


def test_no_overturning_is_said_and_still_a_table(rocking):
    done = rocking("envelope", "configs/block.yaml", "--grid", "f_g=5Hz", "--csv")
    assert done.returncode == 0
    assert (
        done.stdout.splitlines()[0]
        == "structure,Omega,A_from,A_to,mode,omega_g [rad/s],a_from [m/s2],a_to"
        " [m/s2],motion,model"
    )
    (row,) = done.rows
    assert (row["A_from"], row["A_to"], row["mode"], row["a_from"]) == (
        "",
        "",
        "none",
        "",
    )
    assert float(row["omega_g"]) == pytest.approx(10 * math.pi, rel=1e-12)
    assert (
        "Column: no overturning up to A = 20 at 1 of 1 frequencies"
        in done.stderr.splitlines()
    )


def test_the_lowest_interval_is_a_row_a_frequency_also_where_there_is_none(rocking):
    call = (
        "envelope",
        "--eta",
        "0.9",
        "--grid",
        "Omega=3:9:4",
        "--a-max",
        "8",
        "--json",
    )
    every, lowest = (rocking(*call, *more).records for more in ((), ("--lowest",)))
    assert [row["Omega"] for row in lowest] == [3, 5, 7, 9]
    assert [row["mode"] for row in lowest] == [
        "after_impact",
        "after_impact",
        "none",
        "none",
    ]
    assert lowest == [
        next(row for row in every if row["Omega"] == one["Omega"]) for one in lowest
    ]
    assert len(every) > 4


@pytest.mark.soak
def test_the_limit_may_be_an_acceleration(rocking):
    call = (
        "envelope",
        "configs/block.yaml",
        "configs/spire.yaml",
        "--grid",
        "f_g=0.5",
        "--json",
        "--a-max",
    )
    rows = rocking(*call, "0.5g").records
    assert {row["structure"] for row in rows} == {"Column", "Spire"}
    assert all(row["a_from"] < 0.5 * 9.81 for row in rows)
    assert [row["a_to"] for row in rows if row["mode"] == "no_impact"] == [None]
    alike = rocking(
        *call[:2], *call[3:], repr(0.5 / math.atan(0.25))
    ).stdout.splitlines()
    assert [json.loads(line) for line in alike] == [
        row for row in rows if row["structure"] == "Column"
    ]


@pytest.mark.soak
def test_both_equations_are_traced_and_their_difference_told(rocking):
    call = (
        "envelope",
        "configs/block.yaml",
        "--grid",
        "Omega=3.5",
        "--a-max",
        "5",
        "--json",
    )
    both = rocking(*call, "--model", "both")
    rows = both.records
    for model in ("linear", "nonlinear"):
        alone = rocking(*call, "--model", model).records
        assert [r for r in rows if r["model"] == model] == alone
    assert "Column: the linear equation is unsafe over " in both.stderr
