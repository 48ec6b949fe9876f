"""Rows that satisfy a condition, and their order."""

import pytest

from rocking_cli.errors import UsageError
from rocking_cli.reports.conditions import in_order, parse_condition
from rocking_cli.reports.tables import Above


@pytest.mark.parametrize(
    ("text", "yes", "no"),
    [
        ("capacity_demand < 1.5", [0, 1.49], [1.5, None, Above(13.0)]),
        ("demand_a>=0.5g", [4.91], [4.9, 0.5]),
        ("alpha <= 10deg", [0.17], [0.18]),
        ("outcome = rocked", ["rocked"], ["no_uplift", None]),
        ("outcome != rocked", ["no_uplift"], ["rocked", None]),
        ("opens = true", [True], [False]),
        ("room = 2", ["2", 2.0], ["2 b", "3", ""]),
    ],
)
def test_a_condition_holds_for_some_cells(text, yes, no):
    condition = parse_condition(text)
    assert all(condition.holds(cell) for cell in yes)
    assert not any(condition.holds(cell) for cell in no)


@pytest.mark.parametrize("text", ["p", "p 3", "p < ", "< 3", "p < 3furlong", "p << 3"])
def test_what_is_no_condition_is_refused(text):
    with pytest.raises(UsageError, match="`where`"):
        parse_condition(text)


def test_words_have_no_order():
    with pytest.raises(UsageError, match="expected a column and a value that are"):
        parse_condition("outcome < 3").holds("rocked")


def test_rows_are_sorted_with_empty_cells_last():
    cells = [None, "b", Above(2.0), 3.0, -1, "a"]
    found = in_order(({"x": cell} for cell in cells), lambda row: row["x"])
    assert [row["x"] for row in found] == [-1, 3.0, Above(2.0), "a", "b", None]
