"""Numbers as people write them."""

import pytest
from support.refusals import refuses

from rocking_cli.documents.quantities import (
    parse_quantity,
    parse_whole,
    with_a_point,
)


@pytest.mark.parametrize(
    ("text", "number"), [("7", 7), (" 010 ", 10), ("9" * 18, 10**18 - 1)]
)
def test_whole_numbers(text, number):
    assert parse_whole(text) == number


@pytest.mark.parametrize(
    "text",
    [
        "",
        " ",
        "²",
        "٣",
        "-1",
        "+1",
        "1.0",
        "1e3",
        "1_000",
        "0x10",
        "9" * 19,
        "9" * 5000,
    ],
)
def test_texts_that_are_no_whole_number(text):
    assert parse_whole(text) is None


OTHER_DIGITS = ("٣", "٣ m", "1٣", "1.٣", ".٣", "1e٣", "３")
test_digits_are_those_of_ascii = refuses(
    lambda text: parse_quantity(text, "length"),
    ValueError,
    [(text, "a length: a bare number in m") for text in OTHER_DIGITS],
)


MARKS = {
    "0,45 m": "; write 0.45 m with a decimal point",
    ",5": "; write 0.5 with a decimal point",
    "1,95 m": "; write 1.95 m with a decimal point",
    "1.234,5 mm": "; write 1234.5 mm with a decimal point",
    "1,950 mm": (
        "; does the comma stand for thousands? write 1950 mm, or 1.950 mm with a"
        " decimal point"
    ),
    "-1,234.5 mm": "; write -1234.5 mm without commas",
    "1,234,567": "; write 1234567 without commas",
    "0,5x2": "; write 0.5 with a decimal point",
    "1,2,3": "",
    "1.5": "",
    ",": "",
}


@pytest.mark.parametrize(("text", "hint"), MARKS.items())
def test_a_comma_may_be_decimal_or_stand_for_thousands(text, hint):
    assert with_a_point(text) == hint
