"""`rocking predict` at the shell."""

import pytest

TWO = ("block:0.5x2,name=One,restitution=0.9", "spire:1.5x12,name=Two,restitution=0.9")


@pytest.mark.slow
def test_prediction_is_the_computed_response_and_states_how_far_the_spectrum_is_off(
    rocking, spectrum_file
):
    for shaking in (("--a-g", "0.55g", "--f-g", "1.5"),):
        call = ("predict", str(spectrum_file), *TWO, *shaking, "--json")
        beside, exact = (
            rocking(*call, *how).records for how in ((), ("--beyond-range",))
        )
        assert (
            ",".join(beside[0])
            == "structure,eta,A,Omega,a_g,omega_g,theta_max,theta_ratio,outcome,"
            "capacity_demand,margin,margin_side,"
            "theta_ratio_interpolated,interpolation_error"
        )
        assert [r["structure"] for r in beside] == ["One", "Two"]
        for a, b in zip(beside, exact, strict=True):
            read_off, error = (
                a.pop(key)
                for key in ("theta_ratio_interpolated", "interpolation_error")
            )
            assert (
                b.pop("theta_ratio_interpolated")
                is b.pop("interpolation_error")
                is None
            )
            assert a == b
            if a["theta_ratio"] is not None:
                assert error == abs(read_off - a["theta_ratio"]) < 1e-3
                alpha = 0.24497866 if a["structure"] == "One" else 0.358771
                assert a["theta_max"] == pytest.approx(
                    a["theta_ratio"] * alpha, rel=1e-5, abs=0
                )


def test_prediction_near_a_boundary_is_decided(rocking, spectrum_file):
    record = rocking(
        "predict", str(spectrum_file), *TWO, "--A", "3.0187", "--Omega", "5", "--json"
    ).records[0]
    assert (
        record["outcome"],
        record["margin_side"],
        record["theta_ratio_interpolated"],
    ) == ("overturned_after_impact", "below", None)
    assert record["capacity_demand"] == pytest.approx(3.01860 / 3.0187, abs=5.1e-6)


def test_without_shaking_nothing_moves(rocking, spectrum_file):
    done = rocking(
        "predict",
        str(spectrum_file),
        *TWO,
        "--A",
        "0",
        "--Omega",
        "5",
        "--beyond-range",
        "--json",
    )
    assert done.stderr == ""
    record = done.records[0]
    assert (record["outcome"], record["theta_max"], record["a_g"]) == (
        "no_uplift",
        0.0,
        0.0,
    )
    assert [record[key] for key in ("capacity_demand", "margin", "margin_side")] == [
        None
    ] * 3


@pytest.mark.slow
def test_a_negative_amplitude_reverses_the_motion_of_the_spectrum(rocking, tmp_path):
    """The linear rotation is that of DOP853 with events at the impacts and at theta' =
    0, rtol 1e-12.
    """
    at = ("--grid", "A=1:3:3,Omega=2:6:3", "-o", "u.h5")
    sides = {
        "u.yaml": "left: 0.3\nright: 0.5",
        "m.yaml": "left: 0.5\nright: 0.3",
    }  # mirror images
    for file, lengths in sides.items():
        (tmp_path / file).write_text(
            f"kind: rigid\n{lengths}\nheight: 2\ngyration: 1.2\n"
        )
    rocking("spectrum", "u.yaml", *at)
    for file, stands in (("u.yaml", "-0.3g"), ("m.yaml", "0.3g")):
        for a_g in ("0.3g", "-0.3g"):
            for how in ((),) if file == "u.yaml" else (("--beyond-range",),):
                done = rocking(
                    "predict",
                    "u.h5",
                    file,
                    "--a-g",
                    a_g,
                    "--T-g",
                    "0.8",
                    "--json",
                    *how,
                )
                found = done.record
                assert found["theta_ratio"] == (
                    pytest.approx(0.682469157747, rel=1e-9, abs=0)
                    if a_g == stands
                    else None
                )
                assert found["outcome"] == (
                    "rocked" if a_g == stands else "overturned_after_impact"
                )
                assert "the other sign of --a-g gives the opposite one" in done.stderr
