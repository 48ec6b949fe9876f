"""`rocking predict` at the shell."""

from __future__ import annotations

import json

import pytest

STRUCTURE = """
{kind: block, name: One, width: 0.5, height: 2, restitution: 0.9}
---
{kind: spire, name: Two, base_radius: 1.5, height: 12, restitution: 0.9}
"""


def test_prediction_is_the_computed_response_within_its_stated_error(rocking, spectrum_file, tmp_path):
    (tmp_path / "two.yaml").write_text(STRUCTURE)
    for shaking in (("--A", "1.7", "--Omega", "3.3"), ("--a-g", "0.55g", "--f-g", "1.5"), ("--A", "7.5", "--Omega", "2")):
        call = ("predict", str(spectrum_file), "two.yaml", *shaking, "--json")
        read, exact = ([json.loads(x) for x in rocking(*call, *how).stdout.splitlines()] for how in ((), ("--exact",)))
        for a, b in zip(read, exact, strict=True):
            assert a["outcome"] == b["outcome"]
            assert a["margin"] == pytest.approx(b["margin"], abs=0.03)
            if a["theta_ratio"] is not None:
                assert abs(a["theta_ratio"] - b["theta_ratio"]) <= a["interpolation_error"] + 1e-12
                assert a["theta_max"] == pytest.approx(
                    a["theta_ratio"] * (0.24497866 if a["structure"] == "One" else 0.358771), rel=1e-5, abs=0
                )


def test_prediction_near_a_boundary_is_undecided_and_outside_refused(rocking, refused, spectrum_file, tmp_path):
    (tmp_path / "two.yaml").write_text(STRUCTURE)
    near = rocking("predict", str(spectrum_file), "two.yaml", "--A", "3.0186", "--Omega", "5", "--json")
    assert json.loads(near.stdout.splitlines()[0])["outcome"] == "undecided"
    assert "--exact decides" in near.stderr
    assert "is outside the spectrum" in refused(2, "predict", str(spectrum_file), "two.yaml", "--A", "9", "--Omega", "5")
    other = ("predict", str(spectrum_file), "configs/spire.yaml", "--A", "2", "--Omega", "5")
    assert "the spectrum holds 0.9" in refused(2, *other)


def test_prediction_is_never_a_guess(rocking, tmp_path):
    """Tongues of three-cycle overturning narrower than the grid's cells; and below uplift nothing moves."""
    rocking("spectrum", "--eta", "0.9", "--grid", "A=0.5:6:400,Omega=0.2:10:100", "--cycles", "3", "-o", "s3.h5", "-q")
    (tmp_path / "x.yaml").write_text("{kind: parameters, p: 2, alpha: 0.2, eta: 0.9, lambda: 0.2, a_scale: 1}")
    for cell, outcome in ((("1.8385398861885287", "3.2245844713068648"), "undecided"), (("0.99", "5"), "no_uplift")):
        done = rocking("predict", "s3.h5", "x.yaml", "--A", cell[0], "--Omega", cell[1], "--json")
        assert json.loads(done.stdout)["outcome"] == outcome
    call = ("predict", "s3.h5", "x.yaml", "--A", "1.0618680975437393", "--Omega", "3.266321116592374", "--json")
    record = json.loads(rocking(*call).stdout)
    assert record["outcome"] == "undecided" or abs(record["theta_ratio"] - 0.606) <= record["interpolation_error"] + 1e-3
