"""Numbers as people write them."""

import pytest

from rocking_cli.documents.quantities import parse_quantity, parse_whole


@pytest.mark.parametrize(("text", "number"), [("7", 7), (" 010 ", 10), ("9" * 18, 10**18 - 1)])
def test_whole_numbers(text, number):
    assert parse_whole(text) == number


@pytest.mark.parametrize("text", ["", " ", "²", "٣", "-1", "+1", "1.0", "1e3", "1_000", "0x10", "9" * 19, "9" * 5000])
def test_texts_that_are_no_whole_number(text):
    assert parse_whole(text) is None


@pytest.mark.parametrize("text", ["٣", "٣ m", "1٣", "1.٣", ".٣", "1e٣", "３"])
def test_digits_are_those_of_ascii(text):
    with pytest.raises(ValueError, match="a length: a bare number in m"):
        parse_quantity(text, "length")
