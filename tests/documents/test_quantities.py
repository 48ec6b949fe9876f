"""Numbers as people write them."""

import pytest
from support.refusals import refuses

from rocking_cli.documents.quantities import parse_quantity, parse_whole


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
