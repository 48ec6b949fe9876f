"""Digits of numbers that are compared."""

import pytest

from rocking_cli.digits import digits_apart, rounded_down
from rocking_cli.reports.tables import lines


@pytest.mark.parametrize(
    ("value", "limit", "rounded"),
    [
        (1.23456, 1.0, 1.234),
        (1.0000279, 1.0, 1.00003),
        (0.9999721, 1.0, 0.9999),
        (1.0, 1.0, 1.0),
        (3.557199, 3.5571, 3.5572),
        (3.5569999, 3.5571, 3.556),
        (0.29, None, 0.29),
        (-0.40121, None, -0.4013),
    ],
)
def test_a_rounded_number_is_on_its_own_side_of_a_limit(value, limit, rounded):
    assert rounded_down(value, 4, limit) == rounded


@pytest.mark.parametrize(
    ("ratio", "text"),
    [(1.0000279, "1.00003"), (0.99997, "0.99997"), (0.99649, "0.9965"), (1.0, "1")],
)
def test_a_table_shows_on_which_side_of_1_a_ratio_lies(ratio, text):
    assert f"{ratio:.{digits_apart(ratio, 1.0, 4)}g}" == text
    shown = "".join(lines([{"capacity_demand": ratio}], "table")).split()
    assert shown == ["capacity_demand", text]
