"""Records as lines: JSON that is JSON, CSV that a spreadsheet shows and does not compute."""

import csv
import json

import pytest

from rocking_cli.errors import UsageError
from rocking_cli.reports.tables import Above, csv_lines, json_line, lines, table_lines

FORMULAS = ["=1+1", "  =1+1", "\t=1+1", "＝1+1", "＋1", "\u3000＠SUM(A1)", "+1", "-1", "@SUM(A1)", '=HYPERLINK("http://x","y")']


@pytest.mark.parametrize("name", FORMULAS)
def test_a_name_is_no_formula_in_a_spreadsheet(name):
    rows = list(csv.reader(csv_lines([{"structure": name, "A": -1.5, "n": -3, "theta_ratio": float("nan")}])))
    assert rows == [["structure", "A", "n", "theta_ratio"], [f"'{name}", "-1.5", "-3", ""]]


def test_other_names_stay_as_they_are():
    rows = list(csv.reader(csv_lines([{"a": "Column -1", "b": "", "c": None, "e": "1=2"}])))
    assert rows[1] == ["Column -1", "", "", "1=2"]


def test_nothing_is_json_inside_csv():
    record = {"name": "x", "hinges": [{"angle": 0.5, "face": "intrados"}, {"angle": 1.0, "face": "extrados"}], "varied": {"a": [1, 2]}}
    header, row = csv.reader(lines([record], "csv"))
    assert header == ["name", "hinges_1_angle [rad]", "hinges_1_face", "hinges_2_angle [rad]", "hinges_2_face", "varied_a_1", "varied_a_2"]
    assert row == ["x", "0.5", "intrados", "1.0", "extrados", "1", "2"]


@pytest.mark.parametrize("name", [*FORMULAS, "Säule", "\x1b[31m\x7f\x9b", "\u202e", "\udcff", "\U0001f5fc"])
@pytest.mark.parametrize("encoding", ["utf-8", "ascii", "latin-1"])
def test_json_gives_every_text_back_and_shows_no_control_character(name, encoding):
    (line,) = lines([{"name": name}], "json", encoding=encoding)
    assert line.isprintable()
    assert json.loads(line.encode(encoding).decode(encoding)) == {"name": name}


def test_json_of_people_s_names_is_readable():
    assert json_line({"name": "Säule", "x": float("inf")}) == '{"name": "Säule", "x": null}'


LONG = "a sentence of many words that no table of a hundred columns holds, so that it is cut or goes on below the first line"


@pytest.mark.parametrize("rows", range(6))
@pytest.mark.parametrize("width", [60, 100])
def test_a_table_fits_its_width_and_shows_every_cell(rows, width):
    records = [{"name": f"n{i}", "empty": None, "said": LONG} | {f"column_{k}": 1e3 * i + k for k in range(20)} for i in range(rows)]
    shown = list(table_lines(records, width=width))
    assert max(map(len, shown), default=0) <= width
    words = " ".join(shown).split()
    assert "empty" not in words
    for record in records:
        assert {f"{x:.4g}" for x in record.values() if isinstance(x, float)} <= set(words)


def test_three_rows_stand_upright_and_four_below_each_other():
    rows = [{"name": "A", "p": 2.0 / 3.0, "n": None}, {"name": "B", "p": 12345.678, "n": 3}]
    assert list(table_lines(rows)) == ["name  A       B", "p     0.6667  1.235e+04", "n     -       3"]
    assert list(table_lines(2 * rows, digits=8, chosen=["p", "name"]))[:3] == ["         p  name", "0.66666667  A", " 12345.678  B"]
    assert list(table_lines([])) == []
    with pytest.raises(UsageError, match=r"`columns`: found 'P' .did you mean 'p'\?.; expected names among name, p, n"):
        list(table_lines(rows, chosen=["P"]))


@pytest.mark.parametrize(
    ("number", "shown"),
    [(13.0, "> 13"), (13.3399, "> 13.33"), (2.0, "> 2"), (1.99999, "> 1.999"), (0.12349, "> 0.1234"), (57143.7, "> 5.714e+04")],
)
def test_a_limit_that_the_true_number_exceeds_is_rounded_down(number, shown):
    rows = [{"name": str(i), "x": Above(number) if i else 1.5} for i in range(5)]
    lines = list(table_lines(rows))
    assert lines[2].split(maxsplit=1)[1].strip() == shown
    assert len({len(line) for line in lines}) == 1  # aligned as numbers
