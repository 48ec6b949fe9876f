"""Annual rates: a closed form, quadrature, exact shares, and hazard curves in files."""

from __future__ import annotations

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.stats import norm
from support.synthetic_records import pulsed

from rocking_cli import (
    DocumentError,
    HazardCurve,
    Rate,
    Resampling,
    RockingParameters,
    UsageError,
    annual_rate,
    read_hazard,
    sine,
)
from rocking_cli.dynamics.method import LINEAR
from rocking_cli.fragility.exposure import Exposure, MotionSet, share_overturned, traced
from rocking_cli.fragility.study import Study
from rocking_cli.motions.intensity_measures import MEASURES

POINTS = HazardCurve(
    [0.2, 0.5, 1.0, 2.0, 4.0, 9.0], [0.1, 0.03, 0.03, 1.6e-3, 2.5e-4, 3e-6]
)
G = 9.81


def by_quadrature(theta, beta, hazard):
    """The integral of P |dH|, line by line over ln x."""
    y, h, total = np.log(hazard.x), np.log(hazard.rate), 0.0
    for a, b, ha, hb in zip(y[:-1], y[1:], h[:-1], h[1:], strict=True):
        k = (ha - hb) / (b - a)
        nodes = [
            p
            for p in (
                math.log(theta) - 4 * beta,
                math.log(theta),
                math.log(theta) + 4 * beta,
            )
            if a < p < b
        ]

        def rate(t, a=a, ha=ha, k=k):
            return (
                norm.cdf((t - math.log(theta)) / beta) * k * math.exp(ha - k * (t - a))
            )

        total += quad(
            rate, a, b, points=nodes or None, epsabs=0, epsrel=1e-11, limit=400
        )[0]
    return total


@pytest.mark.requirement(
    "The annual rate is the integral of the curve over the hazard",
    "fragility/hazard.py",
    "Annual rate with a straight hazard curve",
)
def test_a_straight_hazard_curve_has_a_closed_form():
    """theta 0.43, beta 0.35, k 2.5, k0 5e-5 give 6.0472e-4 a year, k0 theta^-k exp(k^2
    beta^2/2) (Cornell 1996).
    """
    x = np.geomspace(1e-5, 1e5, 9)
    found = annual_rate(0.43, 0.35, HazardCurve(x, 5e-5 * x**-2.5))
    assert found == pytest.approx(
        5e-5 * 0.43**-2.5 * math.exp(0.5 * (2.5 * 0.35) ** 2), rel=1e-12
    )
    assert found == pytest.approx(6.0472e-4, rel=1e-5)


@pytest.mark.parametrize("theta", [0.05, 0.3, 1.0, 3.0, 20.0])
@pytest.mark.parametrize("beta", [0.01, 0.3, 1.0, 4.0])
def test_rates_are_those_of_quadrature(theta, beta):
    assert annual_rate(theta, beta, POINTS) == pytest.approx(
        by_quadrature(theta, beta, POINTS), rel=1e-9, abs=1e-15
    )


def test_rates_of_many_curves_are_those_of_each_and_stay_finite():
    theta, beta = np.meshgrid(np.geomspace(1e-4, 1e4, 9), np.geomspace(1e-4, 1e3, 9))
    found = POINTS.rate_of(np.log(theta), beta)
    assert found.ravel() == pytest.approx(
        [annual_rate(t, b, POINTS) for t, b in zip(theta.flat, beta.flat, strict=True)],
        rel=1e-12,
    )
    assert np.all((found >= 0.0) & (found <= 0.1))
    assert found[0, 0] == pytest.approx(
        0.1 - 3e-6, rel=1e-12
    )  # it falls at once: all between the ends is counted
    assert found[-1] == pytest.approx(0.5 * (0.1 - 3e-6), rel=0.01)


def test_intervals_count_between_their_ends_up_to_the_highest_level():
    h = POINTS
    assert h(0.01) == h(0.2)
    assert h(np.array([0.5, 2.0, 50.0])) == pytest.approx([0.03, 1.6e-3, 3e-6])
    found = h.of_intervals(
        [[(0.5, 2.0)], [(2.0, 4.0), (9.0, math.inf)], [], [(4.0, math.inf)]], 9.0
    )
    assert found == pytest.approx([0.03 - 1.6e-3, 1.6e-3 - 2.5e-4, 0.0, 2.5e-4 - 3e-6])


def study():
    body = RockingParameters(
        name="m",
        structure="parameters",
        p=2.6,
        alpha=0.245,
        eta=0.9,
        uplift=0.245,
        a_scale=1.0,
    )
    weights = {0.7: 0.6, 0.8: 1.4, 1.0: 1.2, 1.4: 0.8}  # by frequency [Hz]
    members = [
        pulsed(sine(), 2.0, 2 * np.pi * f, weight) for f, weight in weights.items()
    ]
    motions = MotionSet(members, MEASURES["PGA"], np.array([2.0, 4.0, 6.0]), LINEAR)
    cells = np.zeros((len(members), 3))
    return Study(
        body,
        motions,
        Resampling(200),
        Exposure(cells, cells + 2),
        traced([body], motions)[0],
        hazard=POINTS,
    )


@pytest.mark.slow
def test_the_rate_without_a_fit_is_the_integral_of_the_exact_share():
    some = study()
    found = some.rate_without_fit
    x, share = share_overturned(some.intervals, some.motions.weight)
    y = np.linspace(math.log(0.2), math.log(6.0), 20_001)
    at = np.searchsorted(x, np.exp(y), side="right") - 1
    p = np.where(at >= 0, share[np.maximum(at, 0)], 0.0)
    middle = 0.5 * (p[1:] + p[:-1])
    assert found.annual == pytest.approx(
        float(middle @ -np.diff(POINTS(np.exp(y)))), rel=1e-4
    )
    assert 0.0 <= found.low < found.annual < found.high
    assert (found.beyond, found.last) == (pytest.approx(float(POINTS(6.0))), 6.0)
    assert replace(some, how=Resampling(0)).rate_without_fit.low is None


def test_probabilities_and_what_is_missed():
    rate = Rate(6.0472e-4, None, None, 1e-4, 4.0, 0.0)
    assert rate.probability(50.0) == pytest.approx(
        1 - math.exp(-50 * 6.0472e-4), rel=1e-12
    )
    assert rate.row()["return_period"] == pytest.approx(1 / 6.0472e-4)
    assert Rate(0.0, None, None, 0.0, 1.0, 0.0).row()["return_period"] is None
    (words,) = rate.remarks(POINTS)
    assert (
        words
        == "0.000605 a year up to 0.4077 g; stronger motions, not counted, add 0.0001"
        " at most"
    )
    assert (
        "the probability is 0.3 at 0.02039 g"
        in Rate(1.0, None, None, 0.0, 4.0, 0.3).remarks(POINTS)[0]
    )


# As the engine writes it (layout of its version 3.20; the numbers are our own): levels
# in g, cm/s for PGV, m/s for IA.
OPENQUAKE = """#,,,,,,"generated_by='OpenQuake engine 3.20.0-git6a5db97d59', \
start_date='2024-06-03T09:36:03', checksum=1, kind='mean', \
investigation_time={years}, imt='{imt}'"
lon,lat,depth,poe-0.0500000,poe-0.1000000,poe-0.2000000,poe-0.4000000
9.15000,45.15000,0.00000,1.000000E+00,9.754115E-01,3.296800E-01,0.000000E+00
9.20000,45.15000,0.00000,9.000000E-01,5.000000E-01,1.000000E-01,1.000000E-02
"""


def test_a_file_of_openquake_is_read_as_it_is_written(tmp_path):
    path = tmp_path / "h.csv"
    path.write_text(OPENQUAKE.format(years="50.0", imt="PGA"))
    found = read_hazard(path, site="9.2,45.15")
    assert found.x == pytest.approx(G * np.array([0.05, 0.1, 0.2, 0.4]), rel=1e-14)
    assert found.rate == pytest.approx(
        -np.log1p(-np.array([0.9, 0.5, 0.1, 0.01])) / 50, rel=1e-12
    )
    first = read_hazard(
        path, site="9.15,45.15"
    )  # neither certainty nor a rate of zero is a point
    assert first.x == pytest.approx([0.1 * G, 0.2 * G])
    assert first.rate == pytest.approx(
        [-math.log1p(-0.9754115) / 50, 0.4 / 50], rel=1e-5
    )
    for imt, im, unit in (
        ("PGV", "PGV", 0.01),
        ("IA", "Arias", 1.0),
        ("SA(1.0)", "SA(1)", G),
        ("AvgSA(1.0)", "AvgSA(1)", G),
    ):
        path.write_text(OPENQUAKE.format(years="1.0", imt=imt))
        found = read_hazard(path, im, "9.2,45.15")
        assert (found.im, found.x[0], found.rate[0]) == (
            im,
            pytest.approx(0.05 * unit),
            pytest.approx(-math.log(0.1)),
        )


@pytest.mark.parametrize("kind", ["annual_rate", "p_50_years", "p_1_year"])
def test_two_columns_hold_rates_or_probabilities(tmp_path, kind):
    path, rates = tmp_path / "h.csv", np.array([0.02, 1e-3])
    years = {"annual_rate": None, "p_50_years": 50.0, "p_1_year": 1.0}[kind]
    first, second = (rates if years is None else -np.expm1(-years * rates)).tolist()
    path.write_text(
        f"PGA [g],{kind} [1/yr]\n0.1,{first!r}\n400 gal,{second!r}\n".replace(
            "[1/yr]", "[1/yr]" if years is None else ""
        )
    )
    found = read_hazard(path)
    assert found.x == pytest.approx([0.981, 4.0])
    assert found.rate == pytest.approx(rates, rel=1e-12)
    path.write_text("nPGV,annual_rate\n1,0.1\n2,0.01\n")
    assert read_hazard(path, "nPGV").x.tolist() == [1.0, 2.0]


def test_a_level_of_0_is_left_out(tmp_path):
    """OpenQuake writes one if the job asks for it; every motion exceeds it."""
    path = tmp_path / "h.csv"
    path.write_text("PGA [g],p_50_years\n0,1\n0.1,0.46\n0.2,0.18\n")
    assert read_hazard(path).x == pytest.approx([0.1 * G, 0.2 * G])


REFUSED = {
    "": "found an empty file; expected a hazard curve",
    "PGA [g],annual_rate\n": (
        "found 0 levels with a positive, finite rate; expected two or more"
    ),
    "PGA [g],annual_rate\n0.1,0\n0.2,0\n": "found 0 levels",
    "PGA [g],annual_rate\n0.1,1e-3\n0.2,2e-3\n": (
        "line 3: found the rate 0.002 above 0.001 of the level before; expected a"
    ),
    "PGA [g],annual_rate\n0.2,1e-3\n0.1,1e-4\n": (
        "line 3: found the level 0.981 after 1.962 (in SI units); expected rising"
    ),
    "PGA [g],annual_rate\n-0.1,1e-3\n0.1,1e-4\n": (
        "line 2: found the level -0.981 after 0 (in SI units); expected rising levels"
    ),
    "PGA [g],annual_rate\n0.1,1e-3\n0.2,nan\n": (
        "line 3: found 'nan'; expected a number"
    ),
    "PGA [g],annual_rate\nnan,1e-3\n0.2,1e-4\n": (
        "line 2: found 'nan'; expected an acceleration"
    ),
    "PGA [g],annual_rate\n0.1,1e-3\n0.2,-1e-4\n": (
        "line 3: found '-1e-4'; expected a rate from 0"
    ),
    "PGA [g],p_50_years\n0.1,1.2\n0.2,0.1\n": (
        "line 2: found '1.2'; expected a probability from 0 to 1"
    ),
    "PGA [g],p_0_years\n0.1,0.2\n0.2,0.1\n": "found p_0_years; expected a positive",
    "PGA,annual_rate\n0.1,1e-3\n0.2,1e-4\n": (
        "line 2: found the level 0.1 without a unit; expected a measure with its unit"
    ),
    "0.1,1e-3\n0.2,1e-4\n": (
        "found the columns 0.1, 1e-3; expected a measure with its unit"
    ),
    "PGA [g];rate\n0.1;1e-3\n": "found the columns PGA [g], rate; expected",
    "PGA [g],annual_rate\n0.1,1e-3,2\n": "h.csv:2:3: found 3 cells; expected 2",
    "PGA [g],annual_rate\n0.1 s,1e-3\n": (
        "line 2: found '0.1 s'; expected an acceleration"
    ),
    "PGV [cm/s],annual_rate\n1,1e-3\n2,1e-4\n": (
        "line 1: found levels of PGV; expected levels of PGA, the measure `im`"
    ),
    "#,imt='PGA'\nlon,lat\n": "found no hazard curve of OpenQuake",
    OPENQUAKE.format(years="50.0", imt="PGA"): "found 2 sites; expected one",
    OPENQUAKE.format(years="50.0", imt="PGA").partition("9.15000")[
        0
    ]: "found 0 sites; expected a row of longitude",
    OPENQUAKE.format(
        years="50.0", imt="SA(0.2)"
    ): "found levels of SA(0.2); expected levels of PGA",
    OPENQUAKE.format(
        years="50.0", imt="AvgSA"
    ): "found levels of AvgSA; expected levels of PGA",
    OPENQUAKE.format(
        years="0.0", imt="PGA"
    ): "found investigation_time=0.0; expected a positive",
    OPENQUAKE.format(years="1.0", imt="PGA").replace(
        ",9.000000E-01", ""
    ): "h.csv:4:7: found 6 cells; expected 7",
    OPENQUAKE.format(years="1.0", imt="PGA").replace("1.000000E-01", "6.000000E-01")
    + "at 9.2,45.15": "column 6: found the rate 0.916291 above 0.693147 of the",
    OPENQUAKE.format(years="1.0", imt="PGA").replace("1.000000E-01", "-1.00000E-01")
    + "at 9.2,45.15": "found '-1.00000E-01'; expected a",
    OPENQUAKE.format(years="1.0", imt="PGA")
    + "at 1,1": "found 0 sites at 1,1; expected one",
    OPENQUAKE.format(years="1.0", imt="PGA")
    + "at Pavia": "found 'Pavia'; expected LON,LAT",
}


@pytest.mark.parametrize("text", REFUSED, ids=list(REFUSED.values()))
def test_a_curve_that_is_none_is_refused(tmp_path, text):
    path = tmp_path / "h.csv"
    content, _, site = text.partition("at ")
    path.write_text(content)
    with pytest.raises((DocumentError, UsageError), match=re.escape(REFUSED[text])):
        read_hazard(path, site=site or None)


def test_numbers_that_are_no_curve_are_refused(tmp_path):
    for x, rate in (
        ([1.0], [0.1]),
        ([1.0, 1.0], [0.1, 0.1]),
        ([1.0, np.nan], [0.1, 0.1]),
        ([0.0, 1.0], [0.1, 0.1]),
    ):
        with pytest.raises(UsageError, match="two or more levels"):
            HazardCurve(np.array(x), np.array(rate))
    for rate in ([0.1, 0.2], [0.1, np.nan], [0.1, 0.0], [0.1, -0.1], [np.inf, 0.1]):
        with pytest.raises(UsageError, match="that do not rise"):
            HazardCurve(np.array([1.0, 2.0]), np.array(rate))
    with pytest.raises(UsageError, match="expected positive numbers"):
        annual_rate(-1.0, 0.3, POINTS)
    (tmp_path / "two.csv").write_text("PGA [g],annual_rate\n0.1,0.1\n0.2,0.01\n")
    with pytest.raises(UsageError, match="`site` goes with a file of OpenQuake"):
        read_hazard(tmp_path / "two.csv", site="1,2")


# The first lines of versions 2.4 to 3.5 of the engine, and of one that a user has
# commented; the numbers are our own.
FIRST_LINES = [
    '# mean, investigation_time=50.0, imt="PGA", checksum=1',
    "# mean, investigation_time=50.0, imt=PGA",
    (
        "# source_model_tree_path=('b1',), gsim_tree_path=('b1',),"
        ' investigation_time=50.0,imt="PGA"'
    ),
    "# site A\n# mean, investigation_time=50.0, imt='PGA'",
]


@pytest.mark.parametrize("first", FIRST_LINES)
def test_files_of_earlier_versions_of_openquake_are_read(first, tmp_path):
    path = tmp_path / "h.csv"
    path.write_text(
        f"{first}\nlon,lat,depth,poe-0.1,poe-0.4\n"
        "0.00000,0.00000,-0.10000,4.0E-01,5.0E-02\n"
    )
    found = read_hazard(path)
    assert found.x == pytest.approx([0.1 * G, 0.4 * G], rel=1e-14)
    assert found.rate == pytest.approx(
        -np.log1p(-np.array([0.4, 0.05])) / 50, rel=1e-12
    )


@pytest.mark.parametrize(
    "text",
    [
        "# site A\nPGA [g],annual_rate\n0.1,0.02\n0.4,0.001\n",
        "PGA [g];annual_rate\n0,1;0,02\n0,4;0,001\n",
        '"PGA [g]" "annual_rate"\n0.1 0.02\n0.4 0.001\n',
        "PGA [g]\tannual_rate\n0.1\t2e-2\n0.4\t1e-3\n",
    ],
)
def test_two_columns_stand_below_comments_and_between_other_separators(text, tmp_path):
    path = tmp_path / "h.csv"
    path.write_text(text)
    assert read_hazard(path).x == pytest.approx([0.1 * G, 0.4 * G])
    assert read_hazard(path).rate == pytest.approx([0.02, 0.001])
