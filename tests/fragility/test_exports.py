"""Exported fragility curves: the numbers of the formats, read as their schemas say, and
by the programs themselves where they stand.
"""

from __future__ import annotations

import csv
import json
import math
import os
import subprocess
import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import norm

from rocking_cli import Curve, Fit, UsageError, export_fragility

G = 9.81
NRML = "{http://openquake.org/xmlns/nrml/0.5}"
READERS = Path(__file__).parents[1] / "bench" / "readers.py"


def fit(
    structure="Column, 2 m",
    limit="overturning",
    theta=0.43 * G,
    beta=0.35,
    no_damage=0.25 * G,
):
    return Fit(
        structure,
        "PGA",
        limit,
        "stripes",
        Curve(theta, beta, 9),
        None,
        np.array([1.0]),
        no_damage=no_damage,
    )


BOTH = [
    fit(limit="0.5", theta=0.4 * G),
    fit(),
    fit("Other", "0.5"),
    fit("Other", no_damage=0.0),
    fit("Other", "0.1"),
]


def test_openquake_takes_mean_and_standard_deviation_of_the_level(tmp_path):
    """theta 0.43, beta 0.35 are a mean of 0.457161 and a standard deviation of 0.165034
    (mean = theta exp(beta^2/2)).
    """
    remarks = export_fragility(BOTH, tmp_path / "f.xml")
    assert remarks == [
        "0.1: not all structures have this limit state; left out of"
        f" {tmp_path / 'f.xml'}"
    ]
    model = ET.parse(tmp_path / "f.xml").getroot()[0]
    assert model.tag == f"{NRML}fragilityModel"
    assert model.attrib == {
        "id": "rocking",
        "assetCategory": "contents",
        "lossCategory": "contents",
    }
    assert [child.tag.removeprefix(NRML) for child in model] == [
        "description",
        "limitStates",
        "fragilityFunction",
        "fragilityFunction",
    ]
    assert model[1].text == "theta_0_5 overturning"
    assert [f.get("id") for f in model[2:]] == ["Column_2_m", "Other"]
    imls, first, second = model[2]
    assert (model[2].get("format"), model[2].get("shape")) == ("continuous", "logncdf")
    assert (imls.get("imt"), imls.get("noDamageLimit"), imls.get("minIML")) == (
        "PGA",
        "0.25",
        "0.25",
    )
    assert float(imls.get("maxIML")) == pytest.approx(0.43 * math.exp(3 * 0.35))
    assert (first.get("ls"), second.get("ls")) == ("theta_0_5", "overturning")
    assert float(second.get("mean")) == pytest.approx(0.457161, abs=5e-7)
    assert float(second.get("stddev")) == pytest.approx(0.165034, abs=5e-7)
    other = model[3][0]
    assert "noDamageLimit" not in other.attrib
    assert norm.cdf(math.log(float(other.get("minIML")) / 0.43) / 0.35) < 1e-4


def test_pelicun_takes_median_and_dispersion(tmp_path):
    export_fragility(
        BOTH[1::-1], tmp_path / "f.csv", "pelicun"
    )  # overturning is the last limit state in either order
    (row,) = csv.DictReader((tmp_path / "f.csv").read_text().splitlines())
    assert list(row)[:7] == [
        "ID",
        "Incomplete",
        "Demand-Type",
        "Demand-Unit",
        "Demand-Offset",
        "Demand-Directional",
        "LS1-Family",
    ]
    assert (row["Demand-Type"], row["Demand-Unit"], row["LS2-Family"]) == (
        "Peak Ground Acceleration",
        "g",
        "lognormal",
    )
    assert (float(row["LS1-Theta_0"]), float(row["LS2-Theta_0"])) == (
        pytest.approx(0.4),
        pytest.approx(0.43),
    )
    assert (float(row["LS2-Theta_1"]), row["LS2-DamageStateWeights"]) == (0.35, "")
    model = json.loads((tmp_path / "f.json").read_text())
    assert (
        model["Column_2_m"]["LimitStates"]["LS2"]["DS2"]["Description"] == "overturning"
    )


EXACT = [
    "fragility",
    "parameters:p=2.67,alpha=0.245,eta=0.9,lambda=0.25",
    "--pulses",
    "few.csv",
]
EXACT += [
    "--levels",
    "0.2g:0.7g:6",
    "--bootstrap",
    "0",
    "--limit",
    "overturning",
    "--exact",
]


@pytest.mark.slow
def test_exact_shares_are_points_that_do_not_fall(rocking, tmp_path):
    pulses = "0.25 g,0.7 Hz,1\n0.35 g,1.1 Hz,2\n0.4 g,1.5 Hz,1\n0.4 g,2 Hz,1\n"
    (tmp_path / "few.csv").write_text("a_g,f_g,weight\n" + pulses)
    done = rocking(*EXACT, "--curve", "--csv", "--export", "openquake", "-o", "e.xml")
    assert "e.xml: holds the running maximum of the exact share" in done.stderr
    imls, poes = ET.parse(tmp_path / "e.xml").getroot()[0][2]
    x, p = (np.array(node.text.split(), dtype=float) for node in (imls, poes))
    assert np.all(np.diff([x, p]) > 0.0)
    assert p[0] == 0.0
    assert float(imls.get("noDamageLimit")) <= x[0]
    steps = [
        (float(r["x"]), float(r["fraction"]))
        for r in done.rows
        if r["method"] == "exact"
    ]
    for level in np.linspace(0.2, 0.69, 50):
        most = max((share for edge, share in steps if edge <= level * G), default=0.0)
        assert float(np.interp(level, x, p)) >= most - 1e-9  # on the safe side
    assert max(share for _, share in steps) == pytest.approx(p[-1])
    assert rocking(*EXACT, "--export", "pelicun", "-o", "e.csv").returncode == 0
    (row,) = csv.DictReader((tmp_path / "e.csv").read_text().splitlines())
    levels, shares = (
        np.array(part.split(","), dtype=float) for part in row["LS1-Theta_0"].split("|")
    )
    assert row["LS1-Family"] == "multilinear_CDF"
    assert (shares[0], shares[-1]) == (0.0, 1.0)
    assert np.all(np.diff([levels, shares]) > 1e-8)
    assert levels[: x.size] == pytest.approx(x)


def test_other_measures_have_the_units_of_the_programs(tmp_path):
    for im, imt, unit in (
        ("PGV", "PGV", 0.01),
        ("Arias", "IA", 1.0),
        ("SA(1)", "SA(1.0)", G),
        ("AvgSA(0.5)", "AvgSA(0.5)", G),
    ):
        export_fragility(
            [fit(theta=0.43, no_damage=0.0)], tmp_path / "f.xml", im=im, overwrite=True
        )
        function = ET.parse(tmp_path / "f.xml").getroot()[0][2]
        assert function[0].get("imt") == imt
        assert float(function[1].get("mean")) == pytest.approx(
            0.43 * math.exp(0.5 * 0.35**2) / unit, rel=1e-8
        )
    export_fragility([fit()], tmp_path / "f.csv", "pelicun", im="SA(0.5)")
    assert "Spectral Acceleration|0.50,g" in (tmp_path / "f.csv").read_text()


def test_what_a_program_does_not_know_is_refused(tmp_path):
    (tmp_path / "f.json").write_text("{}")
    for fits, form, im, words in (
        *(
            ([fit()], "openquake", im, "expected a measure that openquake knows")
            for im in ("nPGV", "AvgSA(0.5,1)")
        ),
        *(
            ([fit()], "pelicun", im, "expected a measure that pelicun knows")
            for im in ("Arias", "AvgSA(1)")
        ),
        ([fit(), fit()], "openquake", "PGA", "found two curves; expected one"),
        (
            [fit(), fit("Other", "0.5")],
            "openquake",
            "PGA",
            "found no limit state that all",
        ),
        ([fit()], "hazus", "PGA", "found 'hazus'"),
        ([fit()], "pelicun", "PGA", "exists"),
    ):
        with pytest.raises(UsageError, match=words):
            export_fragility(
                fits,
                tmp_path / ("f.csv" if form == "pelicun" else "f.xml"),
                form,
                im=im,
            )
    with pytest.raises(UsageError, match=r"ends in \.xml"):
        export_fragility([fit()], tmp_path / "f.csv")
    assert [path.name for path in tmp_path.iterdir()] == ["f.json"]


@pytest.mark.soak
@pytest.mark.parametrize(
    ("form", "suffix"), [("openquake", ".xml"), ("pelicun", ".csv")]
)
def test_the_programs_themselves_read_the_same_probabilities(tmp_path, form, suffix):
    """With the Python that has openquake.engine 3.26 or pelicun 3.10, named in the
    environment (make readers).
    """
    python = os.environ.get(f"PYTHON_{form.upper()}")
    if not python:
        pytest.skip(f"PYTHON_{form.upper()} names no Python; make readers sets it")
    export_fragility(BOTH[:4], tmp_path / f"f{suffix}", form)
    levels = ["0.3", "0.43", "0.8"]
    read = subprocess.run(
        [python, READERS, form, tmp_path / f"f{suffix}", *levels],
        capture_output=True,
        text=True,
        check=True,
    )
    found = json.loads(read.stdout.splitlines()[-1])
    assert len(found) == 4
    for one, (name, values) in zip(BOTH[:4], found.items(), strict=True):
        assert name.split()[0] in ("Column_2_m", "Other")
        assert values == pytest.approx(
            one.curve(G * np.array(levels, dtype=float)).tolist(), rel=1e-6
        )
