"""Counts in files: whole numbers, units, measures."""

import tracemalloc

import numpy as np
import pytest
from support.refusals import refuses

from rocking_cli import DocumentError, HazardCurve, Resampling, UsageError, annual_rate
from rocking_cli.fragility.bootstrap import bootstrap_counts
from rocking_cli.fragility.counts import fit_counts, read_counts

ROWS = "0.1,20,2\n0.2,20,9\n0.4,20,15\n"
FORMS = [
    "im [g],n,z\n" + ROWS,
    "PGA [g], n, z\n" + ROWS.replace(",", ", "),
    "im [g];n;z\n" + ROWS.replace(",", ";").replace(".", ","),
    "im;n;z\n" + ROWS.replace(",20", " g,20").replace(",", ";"),
    '"im [g]","n","z"\n' + ROWS,
    "im [cm/s2]\tn\tz\n98,1\t20\t2\n196,2\t20\t9\n392,4\t20\t15\n",
]


@pytest.mark.parametrize("text", FORMS)
def test_one_set_of_counts_in_many_forms(text, tmp_path):
    (tmp_path / "c.csv").write_text(text)
    found = read_counts(tmp_path / "c.csv", needs_measure=True)
    assert found.measure is not None
    assert found.measure.name == "PGA"
    assert found.unit == ("cm/s2" if "cm/s2" in text else "g")
    assert found.x == pytest.approx(9.81 * np.array([0.1, 0.2, 0.4]))
    assert (found.n.tolist(), found.z.tolist()) == ([20.0] * 3, [2.0, 9.0, 15.0])


def test_counts_with_a_hazard_curve_have_the_annual_rate_of_their_curve(tmp_path):
    (tmp_path / "c.csv").write_text(FORMS[0])
    hazard = HazardCurve([0.2, 1.0, 4.0, 9.0], [0.1, 0.02, 1e-3, 1e-5])
    fit = fit_counts(read_counts(tmp_path / "c.csv"), Resampling(50), hazard=hazard)
    assert fit.rate is not None
    assert fit.rate.annual == pytest.approx(
        annual_rate(fit.curve.median, fit.curve.beta, hazard), rel=1e-12
    )
    assert fit.rate.low < fit.rate.annual < fit.rate.high


REFUSED = [
    (
        "im,n,z\n0.5,1,0.1\n",
        "c.csv, line 2: z: found '0.1'; expected a whole number of motions, from 0",
    ),
    (
        "im,n,z\n0.5,9.5,1\n",
        "line 2: n: found '9.5'; expected a whole number of motions, from 1",
    ),
    ("im,n,z\n0.5,9,1\n0.6,9,10\n", "line 3: z: found 10 of n = 9 motions"),
    ("im [g],n,z\n0.5,9,nan\n", "line 2: z: found 'nan'; expected a number"),
    ("im,n,z\n0.5 g,9,1\n0.7,9,2\n", "line 3: im: found the level 0.7 without a unit"),
    (
        "period,n,z\n0.5,9,1\n",
        "line 1: found the column period; expected im, or the name of a measure",
    ),
]
test_counts_that_are_none_are_refused = refuses(
    read_counts, DocumentError, REFUSED, file="c.csv"
)


def test_levels_must_be_of_the_measure_of_the_hazard_curve(tmp_path):
    path = tmp_path / "c.csv"
    path.write_text("PGV [cm/s],n,z\n5,9,1\n")
    with pytest.raises(UsageError, match="found levels of PGV; expected levels of PGA"):
        read_counts(path, "PGA")
    path.write_text("im,n,z\n" + ROWS)
    assert read_counts(path).measure is None
    counts = read_counts(path, needs_measure=True)
    assert counts.measure is not None
    assert counts.measure.name == "PGA"
    assert "levels without a unit are in m/s2" in str(counts.remark)


def test_the_command_gives_the_annual_rate_and_writes_the_file(rocking, tmp_path):
    (tmp_path / "c.csv").write_text(FORMS[0])
    call = (
        "fragility",
        "--counts",
        "c.csv",
        "--hazard",
        "configs/hazard.csv",
        "--bootstrap",
        "50",
    )
    (row,) = rocking(
        *call,
        "--limit",
        "overturning",
        "--standing",
        "1000yr",
        "--export",
        "openquake",
        "-o",
        "f.xml",
        "--json",
    ).records
    assert row["annual_rate_low"] < row["annual_rate"] < row["annual_rate_high"]
    assert (row["im"], row["limit_state"], row["rejected"]) == (
        "PGA",
        "overturning",
        pytest.approx(1 - np.exp(-1e3 * row["annual_rate"])),
    )
    assert '<params ls="overturning"' in (tmp_path / "f.xml").read_text()
    assert (
        rocking(
            "fragility",
            "--counts",
            "c.csv",
            "--export",
            "pelicun",
            "-o",
            "f.csv",
            "--bootstrap",
            "0",
        ).returncode
        == 0
    )
    assert rocking(*call, "--im", "PGV").returncode == 3


def test_the_samples_of_many_levels_need_little_memory():
    """600 samples of 600 levels are 2.9 MB an array, and their estimate needs tens of
    such arrays.
    """
    x = np.linspace(1.0, 3.0, 600)
    n, z = np.full(600, 20), np.arange(600) // 30
    how, few = Resampling(600), Resampling(6)
    bootstrap_counts(x, n, z, few, x)  # imports
    tracemalloc.start()
    try:
        band = bootstrap_counts(x, n, z, how, x)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert band is not None
    assert band.low.size == 600
    assert peak < 15e6
