"""Records as lines: JSON that is JSON, CSV that a spreadsheet shows and does not compute."""

from __future__ import annotations

import csv
import json

import pytest

from rocking_cli.reports.tables import csv_lines, json_line, lines

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
