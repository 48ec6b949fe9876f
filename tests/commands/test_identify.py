"""`rocking identify` at the shell: arguments by their content, forms of the output,
lines to paste, figures, refusals.
"""

import re

import pytest

TRACE, BLOCK = "configs/free_rocking.csv", "block:0.5x2"
# the body of the shipped trace, which `oracles.free_rocking` made: inset 25 mm, eta
# 0.915 with a scatter of 0.008 between impacts, noise of 0.3 % of the first peak
INSET, ETA = 0.025, 0.915


def test_a_table_has_the_numbers_and_lines_that_check_takes(rocking, tmp_path):
    done = rocking("identify", TRACE, BLOCK)
    assert done.returncode == 0
    assert re.search(r"^inset \[m\] +0\.0250", done.stdout, re.MULTILINE)
    head, _, inset, restitution = done.stdout.splitlines()[-4:]
    assert head.startswith("# free_rocking.csv: 13 impacts, released at 0.70 alpha")
    assert inset.startswith("inset: 25.0")
    assert inset.endswith("effective half-width 0.900 of the geometric")
    lines = ("kind: block", "width: 0.5 m", "height: 2 m", inset, restitution)
    (tmp_path / "m.yaml").write_text("\n".join(lines))
    demand = ("--a-g", "0.36g", "--f-g", "1.5", "--json")
    measured = rocking("check", "m.yaml", *demand).record
    assert measured["outcome"] == "overturned_after_impact"
    assert rocking("check", BLOCK, *demand).record["outcome"] == "rocked"


def test_the_structure_is_the_document_wherever_it_stands(rocking, tmp_path):
    (tmp_path / "b.yaml").write_text("# a trace?\nkind: block\nwidth: 0.5\nheight: 2\n")
    rows = rocking("params", BLOCK, "--json").stdout
    given = [
        rocking("identify", *words, "--to", "5s", "--json", stdin=rows).record
        for words in ((BLOCK, TRACE), (TRACE, "b.yaml"), (TRACE, "-"))
    ]
    assert given[0] == given[1]
    assert given[0]["inset_low"] < INSET < given[0]["inset_high"]
    assert given[0]["eta_low"] < ETA < given[0]["eta_high"]
    # a document of kind parameters gives p alone
    assert given[2]["inset"] is None
    assert given[2]["alpha"] == pytest.approx(given[0]["alpha"], rel=3e-3)
    done = rocking("identify", TRACE, BLOCK, "block:0.6x2")
    assert (done.returncode, done.stdout) == (2, "")
    assert "found 2 structures; expected one" in done.stderr


def test_csv_has_a_row_an_impact_and_json_one_a_release(rocking):
    part = ("--to", "5s")
    rows = rocking("identify", TRACE, BLOCK, *part, "--csv", "--units", "deg").rows
    assert [row["impact"] for row in rows] == [str(k + 1) for k in range(len(rows))]
    assert {row["side"] for row in rows[::2]} == {"right"}
    assert float(rows[0]["theta_before"]) == pytest.approx(8.87, abs=0.05)
    both = rocking("identify", TRACE, TRACE, BLOCK, *part, "--json")
    one, other, mean = both.records
    assert one == other
    assert mean["trace"] == "all"
    assert mean["inset"] == pytest.approx(one["inset"], rel=1e-9)
    assert "# mean of 2 releases" in both.stderr


def test_a_figure_shows_trace_residuals_and_restitutions(rocking, tmp_path):
    pytest.importorskip("matplotlib")
    call = ("identify", TRACE, BLOCK, "--to", "5s", "-o", "f.svg")
    assert rocking(*call).returncode == 0
    drawn = (tmp_path / "f.svg").read_text(encoding="utf-8")
    for word in ("measured", "residual [rad]", "angular momentum"):
        assert word in drawn
    done = rocking(*call)
    assert (done.returncode, done.stdout) == (2, "")


HEAD = "t [s],theta [rad]\n"
ROWS = "".join(f"{0.01 * i:.2f},{0.1 - 0.001 * i:.3f}\n" for i in range(60))
REFUSED = {
    "no impact": (HEAD + ROWS, 3, "never crosses its zero"),
    "time": (
        HEAD + ROWS + "0.20,0.1\n",
        3,
        "x.csv:62: found the time 0.2 s behind 0.59 s",
    ),
    "number": (HEAD + "0,0.1\n0.01,x\n", 3, "x.csv:3:2: found 'x'; expected a number"),
    "unit": (
        "t [s],theta [mm]\n0,1\n",
        3,
        "x.csv:1:2: found theta in 'mm'; expected rad",
    ),
    "degrees": (HEAD + "0,8.5\n0.1,8.4\n", 3, "found a rotation of 8.5 rad"),
    "columns": ("a,b\n1,2\n", 3, "expected t [s] first, then one of theta [rad|deg]"),
    "several": (
        "t,theta,theta_dot\n0,0.1,0\n",
        2,
        "theta, theta_dot; --column chooses",
    ),
    "displacement": (
        ROWS.join(("t [s],displacement [mm]\n", "")),
        2,
        "a displacement needs --height",
    ),
    "impacts": ("impact [s]\n1\n2\n2.5\n", 2, "impact times need a structure, for p"),
    "few": (HEAD + "0,0.1\n", 3, "found 1 sample"),
    "few uplifts": ("t [s],uplift [mm]\n0,1\n", 3, "found 1 sample"),
    "no accelerations": ("t [s],acceleration [g]\n", 3, "found 0 samples"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_a_refusal_is_one_sentence_with_its_code(rocking, tmp_path, name):
    text, code, said = REFUSED[name]
    (tmp_path / "x.csv").write_text(text)
    done = rocking("identify", "x.csv")
    assert (done.returncode, done.stdout) == (code, "")
    assert said in done.stderr
    assert done.stderr.count("\n") == 1


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--least", "0%"), "--least: found 0; expected above 0"),
        (("--level", "95"), "--level: found 95; expected above 0 and below 1"),
        (("--fit", "inset"), "--fit: inset needs a structure"),
        (("--column", "thta"), "did you mean 'theta'?"),
        (("--gain-error", "x"), "--gain-error: found 'x'; expected a number"),
    ],
)
def test_options_are_checked(rocking, words, said):
    done = rocking("identify", TRACE, *words)
    assert (done.returncode, done.stdout) == (2, "")
    assert said in done.stderr


def test_part_of_a_trace_counts(rocking):
    part = rocking("identify", TRACE, BLOCK, "--to", "6s", "--json").record
    assert 6 <= part["impacts"] < 13
    assert part["inset_low"] < INSET < part["inset_high"]
    done = rocking("identify", TRACE, BLOCK, "--to", "2s")
    assert done.returncode == 3
