"""`rocking predict` at the shell."""

import pytest

TWO = ("block:0.5x2,name=One,restitution=0.9", "spire:1.5x12,name=Two,restitution=0.9")


def test_prediction_is_the_computed_response_and_states_how_far_the_spectrum_is_off(rocking, spectrum_file):
    for shaking in (("--a-g", "0.55g", "--f-g", "1.5"), ("--A", "7.5", "--Omega", "2")):
        call = ("predict", str(spectrum_file), *TWO, *shaking, "--json")
        beside, exact = (rocking(*call, *how).records for how in ((), ("--exact",)))
        assert [r["structure"] for r in beside] == ["One", "Two"]
        for a, b in zip(beside, exact, strict=True):
            read_off, error = (a.pop(key) for key in ("theta_ratio_interpolated", "interpolation_error"))
            assert b.pop("theta_ratio_interpolated") is b.pop("interpolation_error") is None
            assert a == b
            if a["theta_ratio"] is not None:
                assert error == abs(read_off - a["theta_ratio"]) < 1e-3
                alpha = 0.24497866 if a["structure"] == "One" else 0.358771
                assert a["theta_max"] == pytest.approx(a["theta_ratio"] * alpha, rel=1e-5, abs=0)


def test_columns_of_a_prediction(rocking, spectrum_file):
    lines = rocking("predict", str(spectrum_file), *TWO, "--A", "1.7", "--Omega", "3.3", "--csv").stdout.splitlines()
    assert lines[0] == (
        "structure,eta,A,Omega,a_g [m/s2],omega_g [rad/s],theta_max [rad],theta_ratio,outcome,capacity_demand,margin,margin_side,"
        "theta_ratio_interpolated,interpolation_error"
    )
    assert len(lines) == 3


def test_prediction_near_a_boundary_is_decided(rocking, spectrum_file):
    record = rocking("predict", str(spectrum_file), *TWO, "--A", "3.0187", "--Omega", "5", "--json").records[0]
    assert (record["outcome"], record["margin_side"], record["theta_ratio_interpolated"]) == ("overturned_after_impact", "below", None)
    assert record["capacity_demand"] == pytest.approx(3.01860 / 3.0187, abs=5.1e-6)


def test_without_shaking_nothing_moves(rocking, spectrum_file):
    done = rocking("predict", str(spectrum_file), *TWO, "--A", "0", "--Omega", "5", "--exact", "--json")
    assert done.stderr == "model: linear, as the spectrum's\n"
    record = done.records[0]
    assert (record["outcome"], record["theta_max"], record["a_g"]) == ("no_uplift", 0.0, 0.0)
    assert [record[key] for key in ("capacity_demand", "margin", "margin_side")] == [None] * 3
