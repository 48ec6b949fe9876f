"""`rocking fragility` at the shell."""

import csv
import io
import json
import re

import numpy as np
import pytest
from matplotlib.figure import Figure
from support.soak import quick

from rocking_cli.reports.figures.fragility_curves import (
    MEASURE_LABELS,
    fragility_curves,
)
from rocking_cli.reports.rows import rows_of
from rocking_cli.reports.units import parse_units

SITE = (
    "--pulses",
    "configs/motions/site_pulses.csv",
    "--levels",
    "0.2g:0.45g:4",
    "--bootstrap",
    "8",
)
# which only the linear equation knows: it is quicker
STATED = "parameters:name=Stated,p=2.67,alpha=0.245,eta=0.9,lambda=0.25"


def test_counts_that_exist_are_fitted(rocking, tmp_path):
    (tmp_path / "c.csv").write_text(
        "im,n,z\n0.2,40,0\n0.3,40,0\n0.4,40,0\n0.6,40,4\n"
        "0.7,40,6\n0.8,40,13\n0.9,40,12\n1,40,16\n"
    )
    (row,) = rocking("fragility", "--counts", "c.csv", "--json").records
    assert (row["median"], row["beta"], row["n"]) == (
        pytest.approx(1.0761158, abs=5.1e-8),
        pytest.approx(0.4292372, abs=5.1e-8),
        40,
    )
    assert list(row) == [
        "structure",
        "im",
        "limit_state",
        "method",
        "median",
        "beta",
        "median_low",
        "median_high",
        "beta_low",
        "beta_high",
        "n",
    ]
    assert (
        rocking(
            "fragility",
            "--counts",
            "c.csv",
            "--seed",
            "1",
            "--bootstrap",
            "5",
            "--csv",
            "--units",
            "g",
            "-q",
        ).returncode
        == 0
    )


@pytest.mark.parametrize(
    ("heading", "levels"),
    [("im [g]", "0.1,0.2,0.4"), ("PGA", "0.1 g,0.2 g,0.4 g"), ("PGV [cm/s]", "5,9,20")],
)
def test_the_table_of_counts_has_the_unit_of_their_levels(
    rocking, tmp_path, heading, levels
):
    rows = (
        f"{level},20,{z}\n"
        for level, z in zip(levels.split(","), (1, 9, 17), strict=True)
    )
    (tmp_path / "c.csv").write_text(f"{heading},n,z\n" + "".join(rows))
    call = ("fragility", "--counts", "c.csv", "--bootstrap", "0")
    unit, si = ("cm/s", 0.01) if "cm/s" in heading else ("g", 9.81)
    heads, cells = rocking(
        *call, "--digits", "9", "--columns", "median,n"
    ).stdout.splitlines()
    shown = dict(zip(re.split("  +", heads.strip()), cells.split(), strict=True))
    stored = rocking(*call, "--json").record["median"]
    assert float(shown[f"median [{unit}]"]) * si == pytest.approx(
        stored, rel=1e-8, abs=0
    )
    assert f"x [{unit}]" in rocking(*call, "--curve").stdout
    asked = rocking(*call, "--units", "m/s2" if unit == "g" else "m/s").stdout
    assert f"median [{unit}]" not in asked


def test_limit_states_and_methods_are_rows(rocking):
    rows = rocking(
        "fragility",
        STATED,
        *SITE,
        "--method",
        "stripes,first",
        "--limit",
        "0.5,overturning",
        "--csv",
    ).rows
    assert [(r["limit_state"], r["method"]) for r in rows] == [
        ("0.5", "stripes"),
        ("overturning", "stripes"),
        ("overturning", "first"),
    ]
    assert all(
        float(r["median_low"]) < float(r["median"]) < float(r["median_high"])
        for r in rows
    )
    assert float(rows[0]["median"]) < float(rows[1]["median"])
    assert {r["n"] for r in rows} == {"9"}
    in_g = rocking(
        "fragility",
        STATED,
        *SITE,
        "--limit",
        "overturning",
        "-q",
        "--csv",
        "--units",
        "g",
    ).rows[0]
    assert (in_g["im"], float(in_g["median"])) == (
        "PGA [g]",
        pytest.approx(float(rows[1]["median"]) / 9.81, rel=1e-14),
    )
    table = rocking(
        "fragility",
        STATED,
        *SITE,
        "--limit",
        "overturning",
        "-q",
        "--columns",
        "im,median",
        "--digits",
        "8",
    ).stdout
    assert table.splitlines()[0].split() == ["im", "median", "[g]"]
    assert float(table.split()[-1]) == pytest.approx(
        float(rows[1]["median"]) / 9.81, rel=1e-7
    )


@pytest.mark.slow
def test_a_vertical_motion_moves_the_curves(rocking, tmp_path):
    (tmp_path / "few.csv").write_text(
        "a_g,T_g\n"
        + "".join(f"{0.1 * i:.1f} g,{0.3 + 0.2 * i:.1f} s\n" for i in range(1, 6))
    )
    call = (
        "fragility",
        STATED,
        "--pulses",
        "few.csv",
        *SITE[2:],
        "--method",
        "stripes",
        "--limit",
        "overturning",
        "--csv",
    )
    done = [
        rocking(*call, *more)
        for more in ((), ("--vertical", "sine", "--vertical-scale", "0.8"))
    ]
    flat, both = (float(one.rows[0]["median"]) for one in done)
    assert flat < both  # heavier while it is pushed, it takes more


@pytest.mark.parametrize(
    ("im", "heading", "factor"),
    [("PGA", "PGA [g]", 9.81), ("PGV", "PGV [cm/s]", 0.01), ("nPGA", "nPGA", 1.0)],
)
def test_a_figure_speaks_the_units_asked_for(im, heading, factor):
    keys = (
        "structure",
        "im",
        "limit_state",
        "method",
        "x",
        "probability",
        "low",
        "high",
        "fraction",
    )
    rows = [
        dict(
            zip(
                keys,
                ("S", im, "1", "stripes", x, "0.5", "0.4", "0.6", "0.5"),
                strict=True,
            )
        )
        for x in ("1", "3")
    ]
    (axes,) = fragility_curves(Figure(), rows, parse_units("g,cm/s"))
    assert axes.get_xlabel() == MEASURE_LABELS.get(im, heading)
    assert axes.lines[0].get_xdata().tolist() == pytest.approx(
        [1 / factor, 3 / factor], rel=1e-14
    )


def test_what_the_data_do_not_bear_is_said_and_the_rest_kept(rocking):
    done = rocking(
        "fragility",
        STATED,
        *SITE[:2],
        "--levels",
        "0.05g,0.1g,0.35g,0.6g",
        "--limit",
        "0.001,overturning",
        "--bootstrap",
        "0",
    )
    assert done.returncode == 4
    assert done.stdout.count("overturning") == 1
    assert "Stated, 0.001, stripes: 0 levels with some records beyond" in done.stderr


def test_exact_shares_curves_and_their_figure(rocking, tmp_path):
    done = rocking(
        "fragility",
        STATED,
        *SITE,
        "--exact",
        "--curve",
        "--limit",
        "overturning",
        "--csv",
    )
    (tmp_path / "c.csv").write_text(done.stdout)
    rows = done.rows
    exact = [
        (float(r["x"]), float(r["fraction"])) for r in rows if r["method"] == "exact"
    ]
    at = {
        float(r["x"]): float(r["fraction"])
        for r in rows
        if r["method"] == "stripes" and r["fraction"]
    }
    assert len(at) == 4
    for x, fraction in at.items():
        assert fraction == pytest.approx(
            next((f for edge, f in reversed(exact) if edge <= x), 0.0), abs=1e-12
        )
    assert rocking("plot", "c.csv", "-o", "c.svg").returncode == 0


@pytest.mark.parametrize(
    ("levels", "unit"),
    [
        (("200gal:450gal:4",), "gal"),
        (("2,3,4,4.5",), "m/s2"),
        (("0.2g:0.45g:4", "--units", "m/s2"), "m/s2"),
    ],
)
def test_a_table_has_the_unit_of_the_levels_if_nothing_else_is_asked_for(
    rocking, levels, unit
):
    assert (
        f"median [{unit}]"
        in rocking(
            "fragility", STATED, *SITE[:2], "--bootstrap", "0", "--levels", *levels
        ).stdout
    )


@pytest.mark.slow
@pytest.mark.parametrize("how", quick([(), ("--exact",)], ()), ids=["cells", "exact"])
def test_the_measure_that_explains_most_comes_first(rocking, how):
    rows = rocking("fragility", STATED, *SITE, "--efficiency", *how, "--json").records
    assert {r["im"] for r in rows} == {
        "PGA",
        "PGV",
        "PGD",
        "Arias",
        "CAV",
        "nPGA",
        "nPGV",
        "nPGD",
    }
    assert [r["beta"] for r in rows] == sorted(r["beta"] for r in rows)
    assert rows[0]["efficiency"] == 1.0
    beta = {r["im"]: r["beta"] for r in rows}
    for name in (
        "PGA",
        "PGV",
        "PGD",
    ):  # of one structure a factor changes no dispersion
        assert beta[f"n{name}"] == pytest.approx(beta[name], rel=1e-7)
    (fit,) = rocking(
        "fragility",
        STATED,
        *SITE,
        "--method",
        "first" if how else "stripes",
        "--limit",
        "overturning",
        "--json",
    ).records
    assert beta["PGA"] == pytest.approx(fit["beta"], rel=1e-7)


def test_cells_are_every_motion_at_every_level_over_two_measures(rocking):
    done = rocking("fragility", STATED, *SITE, "--cells", "--csv")
    rows = done.rows
    assert (
        done.stdout.splitlines()[0]
        == "structure,motion,pga [m/s2],pgv_pga [s],theta_ratio,outcome"
    )
    assert len(rows) == 9 * 4
    assert [float(r["pga"]) / 9.81 for r in rows[:4]] == pytest.approx(
        np.linspace(0.2, 0.45, 4), rel=1e-12
    )
    assert float(rows[0]["pgv_pga"]) == pytest.approx(
        2 / (2 * np.pi * 0.7), rel=1e-6
    )  # of a sine 2/omega


HAZARD = ("--hazard", "configs/hazard.csv")


@pytest.mark.slow
def test_a_hazard_curve_gives_annual_rates(rocking):
    fitted, exact = rocking(
        "fragility",
        STATED,
        *SITE,
        *HAZARD,
        "--limit",
        "overturning",
        "--standing",
        "10kyr",
        "--json",
    ).records
    assert (
        fitted["annual_rate_low"] < fitted["annual_rate"] < fitted["annual_rate_high"]
    )
    assert (fitted["method"], exact["method"], exact["median"]) == (
        "stripes",
        "exact",
        None,
    )
    assert (
        fitted["rate_without_fit"] == exact["rate_without_fit"] == exact["annual_rate"]
    )
    assert 0.3 < exact["annual_rate"] / fitted["annual_rate"] < 1.0
    assert fitted["rate_beyond"] == 2.5e-6
    assert exact["rate_beyond"] == pytest.approx(
        np.exp(np.interp(np.log(0.45), np.log([0.4, 0.8]), np.log([2.5e-4, 3e-5])))
    )
    for row in (fitted, exact):
        assert row["return_period"] == pytest.approx(1 / row["annual_rate"])
        assert row["p_50_years"] == pytest.approx(1 - np.exp(-50 * row["annual_rate"]))
        assert row["rejected"] == pytest.approx(1 - np.exp(-1e4 * row["annual_rate"]))
    done = rocking(
        "fragility",
        STATED,
        *SITE,
        *HAZARD,
        "--limit",
        "0.5,overturning",
        "--standing",
        "10000yr",
        "--csv",
    )
    rows = done.rows
    assert [(r["limit_state"], r["rejected"] == "") for r in rows] == [
        ("0.5", True),
        ("overturning", False),
        ("overturning", False),
    ]
    assert float(rows[1]["annual_rate"]) == fitted["annual_rate"]
    assert "Stated, overturning, exact: 0.000" in done.stderr
    assert (
        sum("report that of the row exact" in line for line in done.stderr.splitlines())
        == 1
    )
    table = rocking(
        "fragility", STATED, *SITE, *HAZARD, "--limit", "overturning"
    ).stdout
    assert ("annual_rate" in table, "rate_without_fit" in table) == (True, False)
    assert (
        "a year up to 0.45 g; stronger motions, not counted, add 0.000174 at most"
        in done.stderr
    )


def test_a_rate_needs_no_fit(rocking):
    """At levels at which two motions of nine overturn the body, and no fit stands."""
    call = (
        "fragility",
        STATED,
        *SITE[:2],
        "--levels",
        "0.1g,0.31g",
        *HAZARD,
        "--limit",
        "overturning",
        "--bootstrap",
        "0",
    )
    done = rocking(*call, "--json")
    (row,) = done.records
    assert (done.returncode, row["method"], row["annual_rate_low"]) == (
        4,
        "exact",
        None,
    )
    assert row["annual_rate"] > 0.0
    assert "report that of the row exact" not in done.stderr  # it is the only one


def test_a_figure_holds_hazard_fragility_and_the_part_of_each_level(rocking):
    rows = rocking(
        "fragility",
        STATED,
        *SITE,
        *HAZARD,
        "--limit",
        "1,overturning",
        "--curve",
        "--csv",
    ).rows
    fit = [
        r
        for r in rows
        if r["method"] == "stripes" and r["limit_state"] == "overturning"
    ]
    x, part = (
        np.array([float(r[name]) for r in fit]) for name in ("x", "deaggregation")
    )
    assert float(0.5 * (part[1:] + part[:-1]) @ np.diff(np.log(x))) == pytest.approx(
        float(fit[0]["annual_rate"]), rel=0.03
    )
    figure = Figure()
    read = [{key: text or None for key, text in row.items()} for row in rows]
    (axes,) = fragility_curves(figure, read, parse_units("g"))
    left, right = figure.axes
    assert (left, left.get_xscale(), right.get_yscale()) == (axes, "log", "log")
    (hazard,) = right.get_lines()
    assert hazard.get_xdata()[[0, -1]] == pytest.approx([0.02, 1.6])
    assert hazard.get_ydata()[[0, -1]] == pytest.approx([0.1, 2.5e-6])
    shown = [
        line
        for line in left.get_lines()
        if line.get_linestyle() == ":" and len(line.get_xdata())
    ]
    assert max(float(np.max(line.get_ydata())) for line in shown) == 1.0
    assert len(shown) == 2  # of the fits, not of the exact shares


@pytest.mark.soak
def test_a_negative_scale_reverses_site_pulses(rocking, tmp_path):
    (tmp_path / "p.csv").write_text(
        "a_g,T_g\n" + "".join(f"{0.3 + 0.05 * i} g,{0.5 + 0.1 * i}\n" for i in range(8))
    )
    for file, lengths in (
        ("u.yaml", "left: 0.3\nright: 0.5"),
        ("m.yaml", "left: 0.5\nright: 0.3"),
    ):
        (tmp_path / file).write_text(
            f"kind: rigid\nname: w\n{lengths}\nheight: 2\ngyration: 1.2\n"
        )
    how = (
        "--pulses",
        "p.csv",
        "--levels",
        "0.1g:2g:39",
        "--bootstrap",
        "0",
        "--limit",
        "overturning",
        "--csv",
    )
    forwards, back, mirrored = (
        rocking("fragility", *of, *how).stdout
        for of in (("u.yaml",), ("u.yaml", "--scale", "-1"), ("m.yaml",))
    )
    assert back == mirrored != forwards


@pytest.mark.parametrize(
    ("im", "levels", "units", "unit", "factor"),
    [
        ("PGA", "0.2g:0.45g:4", ("--units", "g"), "g", 9.81),
        ("nPGA", "0.8:2:4", ("--units", "g"), "", 1.0),
    ],
)
def test_the_abscissa_of_a_curve_and_the_median_state_their_unit(
    rocking, tmp_path, im, levels, units, unit, factor
):
    call = (
        "fragility",
        STATED,
        *SITE[:2],
        "--im",
        im,
        "--levels",
        levels,
        "--limit",
        "overturning",
        "--bootstrap",
        "0",
        "-q",
    )
    in_si = [
        json.loads(line)
        for line in rocking(*call, "--curve", "--json").stdout.splitlines()
    ]
    printed = rocking(*call, "--curve", "--csv", *units)
    heading = f"x [{unit}]" if unit else "x"
    x = [
        float(row[heading]) * factor
        for row in csv.DictReader(io.StringIO(printed.stdout))
    ]
    assert x == pytest.approx([row["x"] for row in in_si], rel=1e-14)

    (tmp_path / "c.csv").write_text(
        printed.stdout
    )  # plot reads the unit of the heading
    assert [
        float(row["x"]) for row in rows_of(str(tmp_path / "c.csv"))
    ] == pytest.approx(x, rel=1e-14)
    median = f"median [{unit}]" if unit else "median"
    assert median in rocking(*call, "--csv", *units).stdout.splitlines()[0].split(",")


@pytest.mark.parametrize("units", quick([(), ("--units", "g,cm")], ("--units", "g,cm")))
def test_every_measure_of_an_efficiency_has_its_median_and_its_unit(rocking, units):
    call = (
        "fragility",
        STATED,
        *SITE[:2],
        "--levels",
        "0.2g:0.45g:4",
        "--bootstrap",
        "0",
        "--efficiency",
        "-q",
    )
    in_si = {
        row["im"]: row["median"]
        for row in map(json.loads, rocking(*call, "--json").stdout.splitlines())
    }
    printed = rocking(*call, "--csv", *units).rows
    factors = {"m/s2": 1.0, "m/s": 1.0, "m": 1.0, "g": 9.81, "cm": 0.01}
    assert len(printed) == 8
    for row in printed:
        im, _, unit = row["im"].rstrip("]").partition(" [")
        assert bool(unit) is not im.startswith("n")
        assert float(row["median"]) * factors.get(unit, 1.0) == pytest.approx(
            in_si[im], rel=1e-14
        )


def test_the_structures_of_a_class_have_one_curve(rocking, tmp_path):
    (tmp_path / "t.csv").write_text(
        "kind,name,stone,width,height\n"
        "block,A,tuff,0.5,2\nblock,B,marble,0.5,2\nblock,C,marble,0.56,2\n"
    )
    call = ("fragility", "t.csv", *SITE[:-1], "0", "--limit", "0.5")
    call += ("--model", "linear")
    a, b, c = rocking(*call, "--json").records
    tuff, marble = rocking(*call, "--by", "stone", "--json").records
    assert (tuff["structure"], marble["structure"]) == ("tuff", "marble")
    assert [tuff[key] for key in ("median", "beta")] == [a["median"], a["beta"]]
    assert b["median"] < marble["median"] < c["median"]
    refused = rocking(*call, "--by", "stane")
    assert (refused.returncode, refused.stdout) == (2, "")
    assert "--by: found 'stane' (did you mean 'stone'?)" in refused.stderr
