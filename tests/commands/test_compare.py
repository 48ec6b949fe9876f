"""`rocking compare` at the shell."""

import pytest


def test_comparison_collapses_and_tells_the_models_apart(rocking):
    files = ("configs/block.yaml", "configs/spire.yaml", "configs/arch.yaml")
    for shaking in (
        ("--A", "2", "--Omega", "4"),
        ("--a-g", "0.35g", "--f-g", "1.6", "--model", "linear"),
    ):
        done = rocking("compare", *files, *shaking, "--eta", "0.8", "--json")
        found = done.records
        assert len({round(r["theta_ratio"], 10) for r in found}) == 1
        assert len({round(r["theta_max"], 4) for r in found}) == 3
        assert float(done.stderr.split("up to ")[1].split()[0]) < 1e-10
    (arch,) = rocking(
        "compare", files[2], "--A", "1.2", "--Omega", "4", "--model", "both", "--json"
    ).records
    ratios = [arch[f"quarter_period_ratio_{x}"] for x in (0.3, 0.6, 0.9)]
    assert ratios == pytest.approx([1.0737, 1.0622, 1.0441], abs=2e-4)
    assert arch["peak_difference"] == pytest.approx(
        arch["theta_ratio_nonlinear"] / arch["theta_ratio_linear"] - 1
    )


def test_a_record_has_no_frequency_and_its_reversal_a_name(rocking):
    record = ("--motion", "configs/motions/synthetic.at2", "--json")
    (row,) = rocking("compare", "configs/block.yaml", *record).records
    assert (row["a_g"], row["Omega"], row["omega_g"]) == (
        pytest.approx(0.4 * 9.81, rel=1e-3),
        None,
        None,
    )
    found = [
        rocking("check", "configs/block.yaml", *record, "--verdict-only", *more).records
        for more in ((), ("--scale", "-1"))
    ]
    assert [row["motion"] for (row,) in found] == ["synthetic", "synthetic times -1"]
