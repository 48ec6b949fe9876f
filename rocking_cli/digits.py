"""Significant digits of a number that is compared: what is printed lies on the same
side of a limit as the number itself.
"""

from decimal import ROUND_FLOOR, Context

_MOST = 17  # significant digits that tell any two numbers apart


def digits_apart(value: float, limit: float, digits: int) -> int:
    """Return how many significant digits, at least so many, tell a number from a limit;
    if they are equal, so many.
    """
    if value == limit:
        return digits
    several = range(digits, _MOST)
    return next((d for d in several if f"{value:.{d}g}" != f"{limit:.{d}g}"), _MOST)


def rounded_down(value: float, digits: int, limit: float | None = None) -> float:
    """Return a number rounded down to so many significant digits; if this does not
    exceed a limit that the number exceeds, the number with as few digits as exceed it.
    """
    # the shortest text of the number: 0.29 is not a little less than 0.29
    exact = repr(float(value))
    rounded = float(Context(prec=digits, rounding=ROUND_FLOOR).create_decimal(exact))
    if limit is None or rounded > limit or value <= limit:
        return rounded
    return float(f"{value:.{digits_apart(value, limit, digits)}g}")
