"""`rocking check --code` at the shell."""

import pytest

BLOCK = ("check", "block:0.5x2")
SHAKING = ("--a-g", "0.3g", "--T-g", "0.8")
TIED = (
    "wall:0.6x6,name=Tied,one_sided=true,mass=7200,ties=[{height: 5.5, stiffness: 2e6,"
    " ultimate: 30 mm, yield: 20 kN}]"
)


@pytest.fixture
def site(tmp_path):
    (tmp_path / "site.csv").write_text(
        "T [s],S_a [g]\n0,0.2\n0.15,0.5\n0.5,0.5\n2,0.12\n5,0.03\n"
    )
    return "site.csv"


@pytest.mark.slow
def test_the_columns_of_the_code_stand_after_those_of_the_dynamics(rocking):
    plain, done = (
        rocking(*BLOCK, *SHAKING, "--json"),
        rocking(*BLOCK, *SHAKING, "--code", "ntc2018", "--json", "--notes"),
    )
    row = done.record
    assert dict(list(row.items())[: len(plain.record)]) == plain.record
    assert list(row)[len(plain.record) :] == [
        "code_linear",
        "code_linear_ratio",
        "code_slv",
        "code_slv_ratio",
        "code_slc",
        "code_slc_ratio",
        "theta_04_a",
        "theta_04_ratio",
        "e_star",
        "d_slv",
        "t_slv",
        "d_slc",
        "t_slc",
    ]
    assert row["code_linear"] == pytest.approx(0.5 * 9.81)
    assert row["code_linear_ratio"] == pytest.approx(0.5 / 0.3)
    assert row["code_slv"] < row["theta_04_a"] < row["first_overturning_a"]
    said = done.stderr.splitlines()
    code = "code: Circolare 7/2019 C8.7.1, FC = 1, spectrum of"
    assert f"{code} one cycle of a sine: 0.3 g" in said
    assert (
        "the q = 2 method accepts 0.500 g, the body overturns at"
        f" {row['first_overturning_a'] / 9.81:.3f} g" in said
    )
    assert "code:" not in plain.stderr


def test_the_spectrum_of_a_site_needs_no_motion(rocking, site):
    done = rocking(
        "check",
        "configs/block.yaml",
        "configs/arch.yaml",
        "--code",
        "ntc2018",
        "--spectrum",
        site,
        "--json",
    )
    assert done.returncode == 0, done.stderr
    column, arch = done.records
    assert (column["motion"], column["demand_a"]) == ("site", pytest.approx(0.2 * 9.81))
    assert column["theta_04_a"] is None
    assert arch["e_star"] < 1.0
    demanded = rocking(
        "check",
        "configs/block.yaml",
        *SHAKING,
        "--code",
        "ntc2018",
        "--spectrum",
        site,
        "--json",
        "--verdict-only",
    ).record
    assert demanded["code_slv"] == pytest.approx(column["code_slv"], rel=1e-12)


def test_a_spectrum_is_that_of_one_limit_state(rocking, refused, site):
    call = ("check", "block:0.5x2", "block:0.6x14,name=Tall", "--code", "ntc2018")
    done = rocking(*call, "--spectrum", f"slv={site},slc={site}", "--json")
    body, tall = done.records
    assert body["code_slv_ratio"] > 0.0 < body["code_slc_ratio"]
    # the spectrum ends at 5 s, before the period of SLC of the tall body
    assert (tall["code_slc"], tall["t_slc"], done.returncode) == (None, None, 4)
    assert tall["code_slv_ratio"] > 0.0
    assert "Tall: SLC is not known: --spectrum site: found periods up to 5 s" in (
        done.stderr
    )
    alone = rocking(*call, "--spectrum", site, "--json")
    assert [row["code_slc"] for row in alone.records] == [None, None]
    assert [row["code_slv"] for row in alone.records] == [
        body["code_slv"],
        tall["code_slv"],
    ]
    assert "SLC is not checked" in alone.stderr
    assert "expected FILE, or slv=FILE,slc=FILE" in refused(
        2, *call, "--spectrum", f"slv={site},slv={site}"
    )


def test_a_floor_is_told_and_a_figure_is_drawn(rocking, site, tmp_path):
    floor = ("--floor", "T=0.4,xi=0.05,gamma_psi=1.3", "--fc", "1.35")
    done = rocking(
        *BLOCK,
        "--code",
        "ntc2018",
        "--spectrum",
        site,
        *floor,
        "-o",
        "curve.svg",
        "--notes",
    )
    assert done.returncode == 0, done.stderr
    assert "FC = 1.35, spectrum of SLV of site: 0.2 g on a floor" in done.stderr
    assert (tmp_path / "curve.svg").stat().st_size > 5000


def test_a_tied_body_has_its_rows_of_the_code(rocking):
    done = rocking(
        "check",
        TIED,
        "block:0.6x6",
        *SHAKING,
        "--code",
        "ntc2018",
        "--json",
        "--verdict-only",
    )
    rows = {row["structure"]: row for row in done.records}
    assert (
        rows["Tied"]["d_slv"]
        < 0.05
        < rows["block:0.6x6"]["d_slv"]
        == pytest.approx(0.12, rel=1e-6)
    )
    assert rows["Tied"]["code_slv"] > 0.0
    assert (
        "a tie or a tendon breaks before 0.4 d0, and decides d_slv: Tied" in done.stderr
    )


@pytest.mark.parametrize(
    ("peaks", "said"),
    [
        (
            (3.0, 3.5),
            "none passes alpha, the mean of theta_ratio is {:.3g}: SLV and SLC met",
        ),
        ((3.0, 40.0), "1 pass alpha: neither SLV nor SLC met"),
    ],
)
def test_several_records_are_judged_by_their_mean(rocking, tmp_path, peaks, said):
    for n, peak in enumerate(peaks):
        (tmp_path / f"r{n}.csv").write_text(
            "".join(
                f"{0.1 * i:.1f},{peak * x}\n"
                for i, x in enumerate((0, 1, 1, 0, -1, -1, 0))
            )
        )
    done = rocking(
        *BLOCK,
        "--motion",
        "r0.csv",
        "r1.csv",
        "--unit",
        "m/s2",
        "--code",
        "ntc2018",
        "--verdict-only",
        "--json",
    )
    mean = sum(row["theta_ratio"] or 0.0 for row in done.records) / 2
    assert (
        f"block:0.5x2: dynamics (C8.7.1.2.1.9), 2 motions: {said.format(mean)}"
        in done.stderr.splitlines()
    )
