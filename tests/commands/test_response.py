"""`rocking response` at the shell."""

import json
import math

import pytest

IMPULSE = ("--pulse", "rectangular-impulse", "--a-g", "0.5g", "--T-g", "0.4")
NAMED = ("structure", "motion", "model", "outcome", "a_g", "omega_g")
NAMELESS = (*NAMED[:4], "demand_A", "Omega")


def test_time_history_has_the_documented_columns(rocking):
    done = rocking(
        "response",
        "configs/block.yaml",
        "--a-g",
        "3.5",
        "--f-g",
        "1.5",
        "--row-step",
        "0.01",
        "--csv",
    )
    found = done.rows
    assert list(found[0]) == [
        "t",
        "theta",
        "theta_dot",
        "ground_acceleration",
        "tau",
        "theta_ratio",
        "top_displacement",
        *NAMED,
    ]
    assert {tuple(row[key] for key in NAMED) for row in found} == {
        ("Column", "sine 1 cycle", "nonlinear", "rocked", "3.5", found[0]["omega_g"])
    }
    assert float(found[0]["omega_g"]) == pytest.approx(3.0 * math.pi, rel=1e-12)
    top = max(found, key=lambda row: abs(float(row["theta"])))
    assert float(top["top_displacement"]) == pytest.approx(  # of the far corner
        2.0 * math.hypot(0.5, 2.0) * math.sin(0.5 * float(top["theta"])), rel=1e-12
    )
    assert [float(r["t"]) for r in found[:3]] == pytest.approx([0.0, 0.01, 0.02])
    assert float(found[10]["ground_acceleration"]) == pytest.approx(
        3.5 * math.sin(2 * math.pi * 1.5 * 0.1)
    )
    assert "Column, nonlinear: rocks and survives, largest theta" in done.stderr


def test_both_models_side_by_side_and_their_events(rocking):
    done = rocking(
        "response", "configs/arch.yaml", *IMPULSE, "--model", "both", "--csv"
    )
    assert list(done.rows[0])[:5] == [
        "t",
        "theta_linear",
        "theta_dot_linear",
        "theta_nonlinear",
        "theta_dot_nonlinear",
    ]
    events = rocking(
        "response",
        "configs/arch.yaml",
        *IMPULSE,
        "--model",
        "both",
        "--events",
        "--json",
    ).records
    for model in ("linear", "nonlinear"):
        mine = [e for e in events if e["model"] == model]
        assert [e["event"] for e in mine][:3] == ["uplift", "peak", "impact"]
        assert [e["event"] for e in mine][-2:] == ["rest", "summary"]
        assert sorted(mine[:-1], key=lambda e: e["t"]) == mine[:-1]


def test_dimensionless_history_is_the_same_curve(rocking):
    call = (
        "response",
        "configs/block.yaml",
        "--A",
        "2",
        "--Omega",
        "4",
        "--steps",
        "--json",
    )
    si, plain = rocking(*call).records, rocking(*call, "--dimensionless").records
    block = rocking("params", "configs/block.yaml", "--json").record
    assert list(plain[0]) == ["tau", "theta_ratio", "theta_ratio_rate", "A", *NAMELESS]
    for a, b in zip(si, plain, strict=True):
        assert a["t"] * block["p"] == pytest.approx(b["tau"], rel=1e-12, abs=0)
        assert a["theta"] == pytest.approx(
            b["theta_ratio"] * block["alpha"], rel=1e-12, abs=0
        )


def test_free_rocking_by_release(rocking):
    done = rocking(
        "response",
        "configs/arch.yaml",
        "--release",
        "0.6",
        "--model",
        "both",
        "--events",
        "--json",
    )
    first = {
        event["model"]: event["t"]
        for event in reversed(done.records)
        if event["event"] == "impact"
    }
    assert first["nonlinear"] / first["linear"] == pytest.approx(1.0622, abs=2e-4)


@pytest.mark.slow
def test_own_motion_in_every_command(rocking, tmp_path):
    own = ("--motion", "configs/motions/two_pulses.yaml")
    assert (
        rocking(
            "response",
            "configs/block.yaml",
            *own,
            "--a-g",
            "5",
            "--T-g",
            "1 s",
            "--csv",
        ).returncode
        == 0
    )
    assert (
        rocking(
            "envelope", "configs/parameters.yaml", *own, "--grid", "T_g=1"
        ).stdout.count("after_impact")
        > 0
    )
    assert (
        rocking(
            "spectrum",
            "configs/block.yaml",
            *own,
            "--grid",
            "a_g=1:8:2,T_g=0.5:2:2",
            "-o",
            "own.h5",
        ).returncode
        == 0
    )


def test_forces_in_the_history_and_in_the_closing_record(rocking, tmp_path):
    (tmp_path / "b.yaml").write_text(
        "kind: block\nwidth: 0.6\nheight: 3\nfriction: 0.201\n"
    )
    call = ("response", "b.yaml", "--a-g", "0.3g", "--f-g", "2", "--model", "nonlinear")
    done = rocking(*call, "--forces", "--csv")
    assert list(done.rows[0]) == [
        "t",
        "theta",
        "theta_dot",
        "fx_ratio",
        "fz_ratio",
        "ground_acceleration",
        "tau",
        "theta_ratio",
        "top_displacement",
        *NAMED,
    ]
    assert (
        "with the friction 0.201 of the document the base would slide while rocking"
        in done.stderr
    )
    *events, last = rocking(*call, "--forces", "--events", "--json").records
    assert list(last)[:2] == ["model", "event"]
    assert (last["event"], last["outcome"], last["slides"]) == (
        "summary",
        "rocked",
        "rocking",
    )
    assert last["fz_min"] < 1.0 < last["friction_needed"] / 0.201
    impact = next(e for e in events if e["event"] == "impact")
    assert abs(impact["impulse_x"]) / impact["impulse_z"] == pytest.approx(
        last["friction_impact"], rel=1e-12
    )
    bare = rocking(*call, "--events", "--json").records[-1]
    assert bare == {
        key: last[key]
        for key in (
            "model",
            "event",
            "demand_a",
            "top_displacement",
            "theta_ratio",
            "outcome",
        )
    }
    again = rocking("params", "b.yaml", "--json").stdout
    assert json.loads(
        rocking(
            "response", "-", *call[2:], "--forces", "--events", "--json", stdin=again
        ).stdout.splitlines()[-1]
    ) == last | {"top_displacement": None}


def test_forces_of_an_arch(rocking):
    call = ("response", "configs/arch.yaml", "--a-g", "0.45g", "--f-g", "1", "--forces")
    done = rocking(*call, "--events", "--json")
    *_, before, last = done.records
    assert before["event"] != "summary"
    assert 0.0 < last["thrust_min"] < 1.0 < last["eccentricity"]
    assert last["opens"] is True
    assert last["friction_needed"] > 0.0
    assert "friction" not in last
    assert 0 <= last["eccentricity_joint"] <= 7
    assert "where a further hinge opens" in done.stderr


@pytest.mark.slow
def test_a_vertical_motion_in_the_response_the_spectrum_and_the_envelope(rocking):
    up = ("--vertical", "cosine", "--vertical-scale", "3")
    done = rocking(
        "response",
        "configs/block.yaml",
        "--a-g",
        "0.4g",
        "--f-g",
        "1.5",
        *up,
        "--events",
        "--json",
        "--forces",
    )
    *_, before, last = done.records
    assert (before["event"], last["outcome"], last["theta_ratio"]) == (
        "lost contact",
        "lost_contact",
        None,
    )
    assert before["t"] == pytest.approx(math.acos(-1 / 1.2) / (3 * math.pi), rel=1e-12)
    call = ("configs/block.yaml", "--grid", "A=0.5:6:6,Omega=2:4:2")
    done = rocking(
        "spectrum",
        *call,
        *up,
        "-o",
        "up.h5",
        "--model",
        "nonlinear",
        "--json",
        "--notes",
    )
    record = done.record
    assert record["cells_lost_contact"] > 0
    assert record["largest_difference"] < 1e-8
    assert record["misjudged_cells"] == 0
    assert "Fz <= 0 under a rigid body that rocks" in done.stderr
    found = rocking(
        "envelope",
        "configs/block.yaml",
        "--grid",
        "Omega=2",
        *up,
        "--a-max",
        "6",
        "--csv",
    )
    assert found.rows[-1]["mode"] == "lost_contact"
    (block,) = rocking("params", "configs/block.yaml", "--json").records
    assert float(found.rows[-1]["A_from"]) == pytest.approx(
        1.0 / (3 * block["alpha"]), rel=1e-9
    )


def test_impulses_over_the_weight_are_times_unless_they_are_dimensionless(rocking):
    call = (
        "response",
        "configs/block.yaml",
        "--a-g",
        "0.4g",
        "--f-g",
        "2",
        "--forces",
        "--events",
        "--csv",
        "-q",
    )
    assert (
        rocking(*call).stdout.splitlines()[0].endswith(",impulse_x [s],impulse_z [s]")
    )
    assert (
        rocking(*call, "--dimensionless")
        .stdout.splitlines()[0]
        .endswith(",impulse_x,impulse_z")
    )
