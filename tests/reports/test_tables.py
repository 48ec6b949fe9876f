"""Records as lines: JSON that is JSON, CSV that a spreadsheet shows and does not
compute.
"""

import csv
import json

import pytest

from rocking_cli.errors import UsageError
from rocking_cli.reports.tables import Above, csv_lines, json_line, lines, table_lines
from rocking_cli.reports.units import parse_units

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


@pytest.mark.parametrize("rows", range(6))
@pytest.mark.parametrize("width", [60, 100])
def test_a_table_fits_its_width_and_shows_every_cell(rows, width):
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
        assert {f"{x:.4g}" for x in record.values() if isinstance(x, float)} <= set(
            words
        )


def test_three_rows_stand_upright_and_four_below_each_other():
    rows = [
        {"name": "A", "p": 2.0 / 3.0, "n": None},
        {"name": "B", "p": 12345.678, "n": 3},
    ]
    assert list(table_lines(rows)) == [
        "name  A       B",
        "p     0.6667  1.235e+04",
        "n     -       3",
    ]
    assert list(table_lines(2 * rows, digits=8, chosen=["p", "name"]))[:3] == [
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


RECORDS = [
    {"structure": "Column", "motion": f"RSN{i:04}_LOMA_PRIETA_{i}", "pga [g]": 0.1 * i}
    | {f"column_{k}": 1e3 * i + k for k in range(12)}
    for i in range(1, 23)
]


def blocks(shown):
    """Return the blocks of a table, each a list of lines."""
    return [block.splitlines() for block in "\n".join(shown).split("\n\n")]


@pytest.mark.parametrize("width", [60, 80, 120])
def test_every_block_of_a_table_that_is_cut_says_which_row_it_is(width):
    shown = list(table_lines(RECORDS, width=width, keys=("structure", "motion")))
    assert max(map(len, shown)) <= width
    found = blocks(shown)
    assert len(found) > 1
    for heading, *rows in found:
        assert heading.split()[:2] == ["structure", "motion"]
        names = [row.split()[:2] for row in rows]
        assert names == [["Column", record["motion"]] for record in RECORDS]


def test_keys_stand_first_where_a_table_is_cut_and_in_their_place_where_it_is_not():
    rows = [
        {"width [m]": 0.4, "structure": f"S{i}", "motion": f"M{i}"} for i in range(4)
    ]
    (whole,) = blocks(table_lines(rows, keys=("structure", "motion")))
    assert whole[0].split() == ["width", "[m]", "structure", "motion"]
    wide = [{**row, "said": "a" * 30, "more": "b" * 30} for row in rows]
    first, second = blocks(table_lines(wide, width=60, keys=("structure", "motion")))
    assert first[0].split() == ["structure", "motion", "width", "[m]", "said"]
    assert second[0].split() == ["structure", "motion", "more"]


def test_a_key_without_room_goes_on_below_and_is_never_cut():
    rows = [
        {"motion": "a long name of a record, and " * 3 + str(i), "x": LONG}
        for i in range(4)
    ]
    shown = list(table_lines(rows, width=60, keys=("motion",)))
    assert max(map(len, shown)) <= 60
    words = " ".join(line[:28] for line in shown).split()
    assert [word for word in words if word.isdigit()] == ["0", "1", "2", "3"]


@pytest.mark.parametrize("width", range(1, 40))
def test_a_terminal_may_be_too_narrow_for_any_table(width):
    for count in (1, 3, 5):
        shown = list(
            table_lines(RECORDS[:count], width=width, keys=("structure", "motion"))
        )
        assert "Colu" in "".join("".join(shown).split())


@pytest.mark.parametrize("width", [30, 40, 60, 80])
def test_the_heading_of_a_key_is_never_broken_inside_a_word(width):
    keys = ("structure", "motion", "limit_state")
    rows = [
        {
            "structure": "Apollo of the Belvedere",
            "motion": f"RSN1111_KOBE_NIS{i:03}" * 2,
            "limit_state": "overturning",
        }
        for i in range(4)
    ]
    rows = [
        {**row, "first_overturning_a [m/s2]": 3.1, "capacity_demand": 1.0}
        for row in rows
    ]
    shown = list(table_lines(rows, width=width, keys=keys))
    assert max(map(len, shown)) <= width
    words = [word for line in shown for word in line.split()]
    assert all(words.count(key) >= 2 for key in keys)
    assert not {"struc", "limit_", "motio"} & set(words)


def test_the_chosen_columns_are_all_that_a_table_has():
    shown = list(
        table_lines(RECORDS, width=60, chosen=["pga", "motion"], keys=("motion",))
    )
    assert shown[0].split() == ["pga", "[g]", "motion"]
    cut = blocks(
        table_lines(RECORDS, width=30, chosen=["pga", "motion"], keys=("motion",))
    )
    assert [heading.split()[0] for heading, *_ in cut] == ["motion"]


@pytest.mark.parametrize(("width", "count"), [(40, 3), (60, 2), (90, 1)])
def test_upright_rows_that_do_not_fit_stand_in_blocks_with_their_keys(width, count):
    rows = [{"name": f"record_{i}" * 3, "x": i / 3.0, "y": 1e-9 * i} for i in (1, 2, 3)]
    shown = list(table_lines(rows, digits=17, width=width, keys=("name",)))
    assert max(map(len, shown)) <= width
    found = blocks(shown)
    assert len(found) == count
    names = [name for block in found for name in block[0].split()[1:]]
    assert names == [row["name"] for row in rows]
    assert all(block[1].split()[0] == "x" for block in found)  # no number is broken


def test_numbers_and_bounds_are_aligned_on_the_right():
    rows = [{"n": "a", "c": c} for c in (1.5, "> 13", None, 0.02, -1e-9)]
    lines_ = [line[3:] for line in table_lines(rows)]
    assert lines_ == ["     c", "   1.5", "  > 13", "     -", "  0.02", "-1e-09"]
    said = [{"n": "a", "c": c} for c in (1.5, "no", None, 0.02)]
    assert [line[3:] for line in table_lines(said)] == ["c", "1.5", "no", "-", "0.02"]


def test_keys_are_found_by_their_name_in_the_units_that_are_shown():
    rows = [{"omega_g": float(i), "t": LONG, "u": LONG} for i in range(5)]
    shown = lines(rows, "table", units=parse_units("Hz"), keys=("omega_g",), width=60)
    assert [heading.split()[:2] for heading, *_ in blocks(shown)] == [
        ["f_g", "[Hz]"]
    ] * 2


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
