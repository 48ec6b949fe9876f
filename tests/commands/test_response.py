"""`rocking response` at the shell."""

from __future__ import annotations

import json
import math

import pytest
from support.documents import csv_rows

IMPULSE = ("--pulse", "rectangular-impulse", "--a-g", "0.5g", "--T-g", "0.4")


def test_time_history_has_the_documented_columns(rocking):
    done = rocking("response", "configs/block.yaml", "--a-g", "3.5", "--f-g", "1.5", "--dt", "0.01", "--csv")
    found = csv_rows(done.stdout)
    assert list(found[0]) == ["t", "theta", "theta_dot", "ground_acceleration"]
    assert [float(r["t"]) for r in found[:3]] == pytest.approx([0.0, 0.01, 0.02])
    assert float(found[10]["ground_acceleration"]) == pytest.approx(3.5 * math.sin(2 * math.pi * 1.5 * 0.1))
    assert "Column, nonlinear: rocks and survives, largest theta" in done.stderr


def test_both_models_side_by_side_and_their_events(rocking):
    done = rocking("response", "configs/arch.yaml", *IMPULSE, "--model", "both", "--csv")
    assert list(csv_rows(done.stdout)[0])[:5] == ["t", "theta_linear", "theta_dot_linear", "theta_nonlinear", "theta_dot_nonlinear"]
    events = [
        json.loads(x)
        for x in rocking("response", "configs/arch.yaml", *IMPULSE, "--model", "both", "--events", "--json").stdout.splitlines()
    ]
    for model in ("linear", "nonlinear"):
        mine = [e for e in events if e["model"] == model]
        assert [e["event"] for e in mine][:3] == ["uplift", "peak", "impact"]
        assert [e["event"] for e in mine][-2:] == ["rest", "summary"]
        times = [e["t"] for e in mine[:-1]]
        assert times == sorted(times)


def test_dimensionless_history_is_the_same_curve(rocking):
    call = ("response", "configs/block.yaml", "--A", "2", "--Omega", "4", "--steps", "--json")
    si = [json.loads(x) for x in rocking(*call).stdout.splitlines()]
    plain = [json.loads(x) for x in rocking(*call, "--dimensionless").stdout.splitlines()]
    (block,) = (json.loads(x) for x in rocking("params", "configs/block.yaml", "--json").stdout.splitlines())
    assert list(plain[0]) == ["tau", "theta_ratio", "theta_ratio_rate", "A"]
    for a, b in zip(si, plain, strict=True):
        assert a["t"] * block["p"] == pytest.approx(b["tau"], rel=1e-12, abs=0)
        assert a["theta"] == pytest.approx(b["theta_ratio"] * block["alpha"], rel=1e-12, abs=0)


def test_free_rocking_by_release(rocking):
    done = rocking("response", "configs/arch.yaml", "--release", "0.6", "--model", "both", "--events", "--json")
    first = {}
    for line in done.stdout.splitlines():
        event = json.loads(line)
        if event["event"] == "impact":
            first.setdefault(event["model"], event["t"])
    assert first["nonlinear"] / first["linear"] == pytest.approx(1.0622, abs=2e-4)


def test_own_motion_in_every_command(rocking, tmp_path):
    own = ("--motion", "configs/motions/two_pulses.yaml")
    assert rocking("response", "configs/block.yaml", *own, "--a-g", "5", "--T-g", "1 s", "--csv").returncode == 0
    assert rocking("envelope", "configs/block.yaml", *own, "--grid", "T_g=1", "--a-max", "6").stdout.count("after_impact") > 0
    assert rocking("spectrum", "configs/block.yaml", *own, "--grid", "a_g=1:8:8,T_g=0.5:2:8", "-o", "own.h5").returncode == 0


BLOCK = ("response", "configs/block.yaml")


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        ((*BLOCK, "--a-g", "0", "--f-g", "1"), 2, "amplitude is 0"),
        ((*BLOCK, "--a-g", "1", "--f-g", "0"), 2, "--f-g"),
        ((*BLOCK, "--a-g", "1", "--f-g", "nan"), 2, "--f-g: found 'nan'"),
        ((*BLOCK, "--a-g", "nan", "--f-g", "1"), 2, "--a-g: found 'nan'"),
        ((*BLOCK, "--a-g", "1 s", "--f-g", "1"), 2, "an acceleration"),
        ((*BLOCK, "--a-g", "1"), 2, "expected A and Omega"),
        ((*BLOCK, "--a-g", "1:2:3", "--f-g", "1"), 2, "expected one value of each"),
        (BLOCK, 2, "no shaking"),
        ((*BLOCK, "--release", "1"), 2, "--release"),
        ((*BLOCK, "--release", "nan"), 2, "--release"),
        ((*BLOCK, "--release", "0.5", "--dt", "0"), 2, "--dt"),
        ((*BLOCK, "--release", "0.5", "--dt", "1e-9"), 2, "points"),
        ((*BLOCK, "--release", "0.5", "--duration", "-1"), 2, "--duration"),
        ((*BLOCK, "--release", "0.5", "--model", "quadratic"), 2, "unknown model 'quadratic'"),
        ((*BLOCK, "--a-g", "3", "--f-g", "1", "--pulse", "mavroeidis-papageorgiou", "--gamma", "0.5"), 2, "gamma is 0.5"),
        ((*BLOCK, "--a-g", "3", "--f-g", "1", "--phase", "3 m"), 2, "--phase"),
        (
            (*BLOCK, "--a-g", "3", "--f-g", "1", "--motion", "configs/motions/two_pulses.yaml", "--pulse", "sine"),
            2,
            "does not go with --pulse",
        ),
        ((*BLOCK, "--a-g", "3", "--f-g", "1", "--motion", "configs/block.yaml"), 3, "neither pieces nor points"),
        ((*BLOCK, "--a-g", "3", "--f-g", "1", "--motion", "nowhere.yaml"), 2, "nowhere.yaml: cannot be read"),
        (("compare", "configs/block.yaml"), 2, "no shaking"),
        (("compare", "--A", "1", "--Omega", "2"), 2, "no structure"),
    ],
)
def test_bad_input_is_one_sentence(refused, arguments, code, words):
    assert words in refused(code, *arguments)


def test_forces_in_the_history_and_in_the_closing_record(rocking, tmp_path):
    (tmp_path / "b.yaml").write_text("kind: block\nwidth: 0.6\nheight: 3\nfriction: 0.19\n")
    call = ("response", "b.yaml", "--a-g", "0.3g", "--f-g", "2", "--model", "nonlinear")
    done = rocking(*call, "--forces", "--csv")
    assert list(csv_rows(done.stdout)[0]) == ["t", "theta", "theta_dot", "fx_ratio", "fz_ratio", "ground_acceleration"]
    assert "with the friction 0.19 of the document the base would slide before it rocks" in done.stderr
    *events, last = [json.loads(x) for x in rocking(*call, "--forces", "--events", "--json").stdout.splitlines()]
    assert list(last)[:2] == ["model", "event"]
    assert (last["event"], last["outcome"], last["slides"]) == ("summary", "rocked", "before rocking")
    assert last["fz_min"] < 1.0 < last["friction"] / 0.19
    impact = next(e for e in events if e["event"] == "impact")
    assert abs(impact["impulse_x"]) / impact["impulse_z"] == pytest.approx(last["friction_impact"], rel=1e-12)
    bare = [json.loads(x) for x in rocking(*call, "--events", "--json").stdout.splitlines()][-1]
    assert bare == {key: last[key] for key in ("model", "event", "demand_a", "theta_ratio", "outcome")}
    again = rocking("params", "b.yaml", "--json").stdout
    assert json.loads(rocking("response", "-", *call[2:], "--forces", "--events", "--json", stdin=again).stdout.splitlines()[-1]) == last


def test_forces_of_an_arch_need_its_own_equation(refused, rocking):
    call = ("response", "configs/arch.yaml", "--a-g", "0.45g", "--f-g", "1", "--forces")
    assert "give --model nonlinear" in refused(2, *call, "--model", "linear")
    done = rocking(*call, "--events", "--json")
    *_, before, last = [json.loads(x) for x in done.stdout.splitlines()]
    assert before["event"] != "summary"
    assert 0.0 < last["thrust_min"] < 1.0 < last["eccentricity"]
    assert last["opens"] is True
    assert 0 <= last["eccentricity_joint"] <= 7
    assert "where a further hinge opens" in done.stderr


@pytest.mark.parametrize(("key", "words"), [("friction: 0", "a coefficient of friction"), ("friction: 5 m", "friction: found 5 m")])
def test_frictions_that_are_none(refused, tmp_path, key, words):
    (tmp_path / "b.yaml").write_text(f"kind: block\nwidth: 0.6\nheight: 3\n{key}\n")
    assert words in refused(3, "params", "b.yaml")


def test_an_arm_longer_than_that_of_a_point_mass_is_refused(refused, tmp_path):
    (tmp_path / "p.yaml").write_text("kind: parameters\np: 2\nalpha: 0.2\neta: 0.9\na_scale: 1\narm: 2.5\n")
    assert "arm: found 2.5; expected a positive length up to g/p^2, 2.4525 m" in refused(3, "params", "p.yaml")


def test_a_vertical_motion_in_the_response_the_spectrum_and_the_envelope(rocking):
    up = ("--vertical", "cosine", "--vertical-scale", "3")
    done = rocking("response", "configs/block.yaml", "--a-g", "0.4g", "--f-g", "1.5", *up, "--events", "--json", "--forces")
    *_, before, last = [json.loads(x) for x in done.stdout.splitlines()]
    assert (before["event"], last["outcome"], last["theta_ratio"]) == ("lost contact", "lost_contact", None)
    assert before["t"] == pytest.approx(math.acos(-1 / 1.2) / (3 * math.pi), rel=1e-12)
    call = ("configs/block.yaml", "--grid", "A=0.5:6:6,Omega=2:4:2")
    done = rocking("spectrum", *call, *up, "-o", "up.h5", "--model", "nonlinear", "--json")
    record = json.loads(done.stdout)
    assert record["cells_lost_contact"] > 0
    assert record["estimated_error"] < 1e-8
    assert record["misjudged_cells"] == 0
    assert "Fz <= 0 under a rigid body that rocks" in done.stderr
    found = rocking("envelope", "configs/block.yaml", "--grid", "Omega=2", *up, "--a-max", "6", "--csv")
    assert csv_rows(found.stdout)[-1]["mode"] == "lost_contact"
    (block,) = (json.loads(x) for x in rocking("params", "configs/block.yaml", "--json").stdout.splitlines())
    assert float(csv_rows(found.stdout)[-1]["A_from"]) == pytest.approx(1.0 / (3 * block["alpha"]), rel=1e-9)


RECORD = "configs/motions/synthetic.at2"


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (("envelope", "--eta", "0.9", "--grid", "Omega=2", "--vertical", "sine"), "no weight that a vertical motion could change"),
        (("response", "configs/block.yaml", "--a-g", "3", "--f-g", "1", "--vertical-scale", "2"), "--vertical-scale goes with --vertical"),
        (("response", "configs/block.yaml", "--a-g", "3", "--f-g", "1", "--vertical", "none.yaml"), "none.yaml"),
        (("response", "configs/block.yaml", "--a-g", "3", "--f-g", "1", "--vertical", "sine", "--vertical-dt", "1"), "goes with a record"),
        (
            ("response", "configs/block.yaml", "--motion", RECORD, "--vertical", RECORD, "--vertical-unit", "g"),
            "its own --vertical-unit and --vertical-dt",
        ),
    ],
)
def test_vertical_motions_that_are_none(refused, call, words):
    assert words in refused(2, *call)


@pytest.mark.parametrize("motion", [(), ("--motion", "configs/motions/synthetic.at2")], ids=["pulse", "record"])
def test_a_negative_amplitude_turns_the_motion_over(rocking, motion):
    frequency = () if motion else ("--f-g", "1")
    call = ("response", "wall:1.2x8,one_sided=true", *motion, *frequency, "--model", "linear", "--events", "--json")
    turned, scaled = rocking(*call, "--a-g=-0.2g"), rocking(*call, "--a-g", "0.2g", "--scale", "-1")
    assert turned.returncode == scaled.returncode == 0, turned.stderr + scaled.stderr
    assert turned.stdout == scaled.stdout != rocking(*call, "--a-g", "0.2g").stdout
