"""Records as lines: JSON that is JSON, CSV that a spreadsheet shows and does not
compute.
"""

import csv
import json

import pytest

from rocking_cli.errors import UsageError
from rocking_cli.reports.tables import (
    MANY,
    Above,
    csv_lines,
    json_line,
    lines,
    table_lines,
)

FORMULAS = [
    "=1+1",
    "  =1+1",
    "\t=1+1",
    "＝1+1",
    "＋1",
    "\u3000＠SUM(A1)",
    "+1",
    "-1",
    "@SUM(A1)",
    '=HYPERLINK("http://x","y")',
]


@pytest.mark.parametrize("name", FORMULAS)
def test_a_name_is_no_formula_in_a_spreadsheet(name):
    rows = list(
        csv.reader(
            csv_lines(
                [{"structure": name, "A": -1.5, "n": -3, "theta_ratio": float("nan")}]
            )
        )
    )
    assert rows == [
        ["structure", "A", "n", "theta_ratio"],
        [f"'{name}", "-1.5", "-3", ""],
    ]


@pytest.mark.parametrize("heading", FORMULAS)
def test_a_heading_is_no_formula_in_a_spreadsheet(heading):
    with_rows, _ = csv.reader(csv_lines([{heading: 1.0, "A": -1.5}]))
    (alone,) = csv.reader(csv_lines([], [heading, "A"]))
    assert with_rows == alone == [f"'{heading}", "A"]


def test_other_names_stay_as_they_are():
    rows = list(
        csv.reader(csv_lines([{"a": "Column -1", "b": "", "c": None, "e": "1=2"}]))
    )
    assert rows[1] == ["Column -1", "", "", "1=2"]


def test_nothing_is_json_inside_csv():
    record = {
        "name": "x",
        "hinges": [
            {"angle": 0.5, "face": "intrados"},
            {"angle": 1.0, "face": "extrados"},
        ],
        "varied": {"a": [1, 2]},
    }
    header, row = csv.reader(lines([record], "csv"))
    assert header == [
        "name",
        "hinges_1_angle [rad]",
        "hinges_1_face",
        "hinges_2_angle [rad]",
        "hinges_2_face",
        "varied_a_1",
        "varied_a_2",
    ]
    assert row == ["x", "0.5", "intrados", "1.0", "extrados", "1", "2"]


@pytest.mark.parametrize(
    "name", [*FORMULAS, "Säule", "\x1b[31m\x7f\x9b", "\u202e", "\udcff", "\U0001f5fc"]
)
@pytest.mark.parametrize("encoding", ["utf-8", "ascii", "latin-1"])
def test_json_gives_every_text_back_and_shows_no_control_character(name, encoding):
    (line,) = lines([{"name": name}], "json", encoding=encoding)
    assert line.isprintable()
    assert json.loads(line.encode(encoding).decode(encoding)) == {"name": name}


def test_json_of_people_s_names_is_readable():
    assert (
        json_line({"name": "Säule", "x": float("inf")})
        == '{"name": "Säule", "x": null}'
    )


LONG = (
    "a sentence of many words that no table of a hundred columns holds, so that it is"
    " cut or goes on below the first line"
)


@pytest.mark.parametrize("rows", range(4))
@pytest.mark.parametrize("width", [60, 80])
def test_a_table_of_a_few_rows_fits_its_width_and_shows_every_cell(rows, width):
    records = [
        {"name": f"n{i}", "empty": None, "said": LONG}
        | {f"column_{k}": 1e3 * i + k for k in range(20)}
        for i in range(rows)
    ]
    shown = list(table_lines(records, width=width))
    assert max(map(len, shown), default=0) <= width
    words = " ".join(shown).split()
    assert "empty" not in words
    for record in records:
        numbers = {f"{x:.4g}" for x in record.values() if isinstance(x, float)}
        assert numbers <= set(words)


ROW = {
    "structure": "Apollo of Piombino",
    "first_overturning_a [g]": 0.25,
    "p [rad/s]": 2.0,
}


@pytest.mark.parametrize(
    ("width", "shown"),
    [
        (
            80,
            [
                "structure           first_overturning_a [g]  p [rad/s]",
                "Apollo of Piombino                     0.25          2",
            ],
        ),
        (
            50,
            [
                "                               first_        p",
                "structure           overturning_a [g]  [rad/s]",
                "Apollo of Piombino               0.25        2",
            ],
        ),
        (
            34,
            [
                "                    first_",
                "              overturning_       p",
                "structure            a [g] [rad/s]",
                "Apollo of             0.25       2",
                "Piombino",
            ],
        ),
        (
            30,
            [
                "                first_",
                "          overturning_       p",
                "structure        a [g] [rad/s]",
                "Apollo of         0.25       2",
                "Piombino",
            ],
        ),
    ],
)
def test_a_wide_table_breaks_headings_then_texts_then_stands_upright(width, shown):
    assert list(table_lines([ROW], width=width)) == shown


def test_columns_are_chosen_and_an_unknown_one_is_refused():
    rows = [
        {"name": "A", "p": 2.0 / 3.0, "n": None},
        {"name": "B", "p": 12345.678, "n": 3},
    ]
    assert list(table_lines(rows, digits=8, chosen=["p", "name"])) == [
        "         p  name",
        "0.66666667  A",
        " 12345.678  B",
    ]
    assert list(table_lines([])) == []
    with pytest.raises(
        UsageError,
        match=(
            r"`columns`: found 'P' .did you mean 'p'\?.; expected names among name,"
            r" p, n"
        ),
    ):
        list(table_lines(rows, chosen=["P"]))


def test_what_is_the_same_in_all_rows_stands_above_and_labels_as_they_fit():
    rows = [
        {"structure": name, "room": "I", "box": LONG, "motion": "sine", "a_g": 1.0}
        for name in "ABC"
    ]
    more = {"above": ("motion", "room", "a_g"), "spare": ("room", "box")}
    shown = list(lines(rows, "table", width=60, **more))
    assert shown == ["room I; motion sine; a_g 1 m/s2", "", "structure", "A", "B", "C"]
    rows[0] |= {"room": "II", "a_g": 2.0}
    shown = list(lines(rows, "table", width=60, **more))
    assert shown[:3] == ["motion sine", "", "structure  room  a_g [m/s2]"]


def test_a_long_table_is_written_as_its_rows_come_with_every_column():
    taken = []

    def rows():
        for i in range(5000):
            taken.append(i)
            yield {"structure": f"S{i}", "empty": None, "motion": "sine"}

    written = table_lines(rows(), width=10, above=("motion",))
    assert next(written) == "structure  empty  motion"
    assert len(taken) == MANY + 1
    assert next(written) == "S0             -  sine"
    assert len(list(written)) == 4999


@pytest.mark.parametrize("width", range(1, 40))
def test_a_terminal_may_be_too_narrow_for_any_table(width):
    rows = [{**ROW, "said": LONG} for _ in range(3)]
    for count in (1, 3):
        shown = list(table_lines(rows[:count], width=width, above=("said",)))
        assert "Apol" in "".join("".join(shown).split())


def test_numbers_and_bounds_are_aligned_on_the_right():
    rows = [{"n": "a", "c": c} for c in (1.5, "> 13", None, 0.02, -1e-9)]
    lines_ = [line[3:] for line in table_lines(rows)]
    assert lines_ == ["     c", "   1.5", "  > 13", "     -", "  0.02", "-1e-09"]
    said = [{"n": "a", "c": c} for c in (1.5, "no", None, 0.02)]
    assert [line[3:] for line in table_lines(said)] == ["c", "1.5", "no", "-", "0.02"]


@pytest.mark.parametrize(
    ("number", "shown"),
    [
        (13.0, "> 13"),
        (13.3399, "> 13.33"),
        (2.0, "> 2"),
        (1.99999, "> 1.999"),
        (0.12349, "> 0.1234"),
        (57143.7, "> 5.714e+04"),
    ],
)
def test_a_limit_that_the_true_number_exceeds_is_rounded_down(number, shown):
    rows = [{"name": str(i), "x": Above(number) if i else 1.5} for i in range(5)]
    lines = list(table_lines(rows))
    assert lines[2].split(maxsplit=1)[1].strip() == shown
    assert len({len(line) for line in lines}) == 1  # aligned as numbers


ROWS = [
    {"structure": "a|b", "theta_ratio": 0.46287, "share": 12.0},
    {"structure": "50 %_c", "theta_ratio": None, "share": 1e-7},
]


def test_a_table_for_markdown():
    assert list(lines(ROWS, "markdown", digits=3, chosen=[])) == [
        "| structure | theta_ratio | share |",
        "| --- | ---: | ---: |",
        r"| a\|b | 0.463 | 12 |",
        "| 50 %_c | - | 1e-07 |",
    ]


def test_a_table_for_latex():
    assert list(lines(ROWS, "latex", digits=3, chosen=["structure", "share"])) == [
        r"\begin{tabular}{lr}",
        r"structure & share \\",
        r"\hline",
        r"a|b & 12 \\",
        r"50 \%\_c & 1e-07 \\",
        r"\end{tabular}",
    ]


def test_a_table_for_spreadsheets_with_decimal_commas():
    assert list(lines(ROWS, "csv-semicolon")) == [
        "structure;theta_ratio;share",
        "a|b;0,46287;12,0",
        "50 %_c;;1e-07",
    ]
