"""Numbers with a spread: `MEAN +- SD`, `MEAN +- N %` and `LOW .. HIGH`."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..errors import ArgumentError
from .quantities import UNITS, accepted, parse_quantity, split_quantity, unit_of

if TYPE_CHECKING:
    import numpy as np

FORMS = (
    "MEAN +- SD, MEAN +- N % or LOW .. HIGH; +- is one standard deviation: a tolerance"
    " of 10 mm that 95 % of the bodies keep is +- 5 mm"
)
MOST_CUT = 0.05  # share of a normal outside the range of its key that is refused
NOTED_CUT = 1e-3  # the share that a line tells


@dataclass(frozen=True)
class Spread:
    """A number that is not known exactly: normal or uniform.

    A document has one where it states `MEAN +- SD` or `LOW .. HIGH`. A normal number is
    cut at the range of its key, so that no draw is lost.

    Attributes
    ----------
    shape
        "normal" or "uniform"
    first
        mean of a normal number, lower bound of a uniform one [SI]
    second
        standard deviation of a normal number, upper bound of a uniform one [SI]

    Examples
    --------
    >>> width = Spread('normal', 0.5, 0.01)
    >>> width.mean, width.sd
    (0.5, 0.01)
    """

    shape: str  # "normal" or "uniform"
    first: float  # mean of a normal, lower bound of a uniform number [SI]
    second: float  # standard deviation of a normal, upper bound of a uniform one [SI]

    @property
    def mean(self) -> float:
        """The mean [SI]."""
        if self.shape == "normal":
            return self.first
        return 0.5 * (self.first + self.second)

    @property
    def sd(self) -> float:
        """The standard deviation [SI]."""
        if self.shape == "normal":
            return self.second
        return (self.second - self.first) / math.sqrt(12.0)

    @property
    def bounded(self) -> bool:
        """True for a uniform number, whose bounds must be in the range of its key."""
        return self.shape == "uniform"

    @property
    def certain(self) -> bool:
        """True if the number does not vary: `+- 0`, or equal bounds."""
        return self.sd == 0.0

    def cut(self, low: float, high: float) -> float:
        """Return the share of a normal number outside of a range.

        Parameters
        ----------
        low, high
            the range [SI]

        Returns
        -------
        float
            the share [-], 0 for a uniform number
        """
        if self.shape != "normal" or self.certain:
            return 0.0
        below = _normal_share((low - self.first) / self.second)
        above = _normal_share((self.first - high) / self.second)
        return below + above

    def at(self, share: np.ndarray, low: float, high: float) -> np.ndarray:
        """Return the values [SI] below which these shares lie.

        Parameters
        ----------
        share
            shares of the draws [-], within (0, 1), of any shape
        low, high
            range of the key [SI], at which a normal is cut

        Returns
        -------
        numpy.ndarray
            values [SI], in the shape of `share`
        """
        if self.shape == "uniform":
            return self.first + share * (self.second - self.first)
        if self.certain:
            return self.first + 0.0 * share
        from scipy.special import ndtri

        least, most = (
            _normal_share((x - self.first) / self.second) for x in (low, high)
        )
        found = self.first + self.second * ndtri(least + share * (most - least))
        return found.clip(low, high)


def _normal_share(x: float) -> float:
    """Return the share of a standard normal below x."""
    return 0.5 * math.erfc(-x / math.sqrt(2.0))


def is_spread(text: str) -> bool:
    """True for a text that states a spread, right or wrong."""
    return "+-" in text or "±" in text or ".." in text


def parse_spread(text: str, dimension: str) -> Spread:
    """Return the spread that a text states.

    Parameters
    ----------
    text
        such as `0.5 m +- 10 mm`, `0.5 m +- 2 %` or `0.85 .. 0.95`; a number without a
        unit takes the unit of the other one
    dimension
        one of `UNITS`

    Raises
    ------
    ArgumentError
        if the text states no spread of this dimension; its text states the accepted
        forms

    Examples
    --------
    >>> parse_spread('45 .. 55 cm', 'length')
    Spread(shape='uniform', first=0.45, second=0.55)
    """
    plain = text.replace("±", "+-")
    if "..." in plain:
        raise ArgumentError(FORMS)
    for mark in ("+-", ".."):
        parts = [part.strip() for part in plain.split(mark)]
        if len(parts) == 1:
            continue
        if len(parts) != 2 or not all(parts) or is_spread(parts[0] + parts[1]):
            raise ArgumentError(FORMS)
        read = _normal if mark == "+-" else _uniform
        return read(parts[0], parts[1], dimension)
    raise ArgumentError(FORMS)


def _normal(mean: str, sd: str, dimension: str) -> Spread:
    """Return a normal spread from the texts of its mean and its standard deviation,
    which may be in % of the mean. Raises ArgumentError.
    """
    middle = parse_quantity(mean, dimension)
    percent = split_quantity(sd)
    if percent is not None and percent[1] == "%":
        width = abs(middle) * percent[0] / 100.0
    else:
        middle, width = _in_one_unit(mean, sd, dimension)
    if width < 0.0:
        raise ArgumentError(f"{FORMS}; a standard deviation is not negative")
    return Spread("normal", middle, width)


def _uniform(low: str, high: str, dimension: str) -> Spread:
    least, most = _in_one_unit(low, high, dimension)
    if least > most:
        raise ArgumentError(f"LOW .. HIGH with the lower bound first: {high} .. {low}")
    return Spread("uniform", least, most)


def _in_one_unit(first: str, second: str, dimension: str) -> tuple[float, float]:
    """Return the SI values of two quantities; a bare one has the unit of the other."""
    units = [unit_of(text) for text in (first, second)]
    given = [unit for unit in units if unit]
    if given and given[0] in UNITS[dimension]:
        first, second = (
            text if unit else f"{text} {given[0]}"
            for text, unit in zip((first, second), units, strict=True)
        )
    try:
        return parse_quantity(first, dimension), parse_quantity(second, dimension)
    except ArgumentError:
        raise ArgumentError(f"{FORMS}, each {accepted(dimension)}") from None


def has_no_unit(text: str) -> bool:
    """True for a spread whose numbers both state no unit."""
    parts = [split_quantity(part) for part in _numbers(text)]
    return all(part is not None and part[1] in ("", "%") for part in parts)


def unit_of_last(text: str) -> str:
    """Return the unit that the last number of a quantity, or of a spread, states; an
    empty text without one.
    """
    return unit_of(_numbers(text)[-1])


def _numbers(text: str) -> list[str]:
    """Return the texts of the numbers of a spread, of a quantity its only one."""
    return text.replace("±", "+-").replace("..", "+-").split("+-")


def in_unit(text: str, unit: str) -> str:
    """Return the text of a spread without a unit with this one after its first number,
    from which the other takes it.
    """
    for mark in ("+-", "±", ".."):
        if mark in text:
            first, second = text.split(mark, 1)
            return f"{first.strip()} {unit} {mark} {second.strip()}"
    return text
