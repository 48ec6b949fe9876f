"""Which rows are printed, and in which order: --where and --sort."""

import operator
import re
from collections.abc import Callable, Iterable, Mapping
from typing import Any, NamedTuple

from ..documents.quantities import is_bare, parse_quantity, split_quantity
from ..errors import ArgumentError, UsageError
from .tables import Above
from .units import dimension_of

_COMPARISONS: dict[str, Callable[[Any, Any], bool]] = {
    "<=": operator.le,
    ">=": operator.ge,
    "!=": operator.ne,
    "=": operator.eq,
    "<": operator.lt,
    ">": operator.gt,
}
_CONDITION = re.compile(r"\s*([^<>=!\s]+)\s*(<=|>=|!=|=|<|>)\s*([^<>=!\s][^<>=!]*?)\s*")


class Condition(NamedTuple):
    """A comparison of a column with a value."""

    column: str
    sign: str  # of the comparison, such as <
    text: str  # of the value
    value: float | None  # in SI, None for a word

    def holds(self, cell: Any) -> bool:
        """True if a cell satisfies it; an empty cell, or one that is only known to be
        above a number, satisfies none. Raises UsageError for an order of words.
        """
        if cell is None or isinstance(cell, Above):
            return False
        if isinstance(cell, bool):
            cell = str(cell).lower()
        if isinstance(cell, str) and is_bare(cell) and self.value is not None:
            cell = float(cell)  # a label
        if not isinstance(cell, str) and self.value is not None:
            return _COMPARISONS[self.sign](cell, self.value)
        if self.sign not in ("=", "!="):
            raise UsageError(
                f"`where`: {self.column} {self.sign} {self.text}: found {cell};"
                " expected a column and a value that are numbers, or = or !="
            )
        return _COMPARISONS[self.sign](str(cell), self.text)


def parse_condition(text: str) -> Condition:
    """Return the condition of a text such as `capacity_demand < 1.5`; a number without
    a unit is in SI. Raises UsageError.
    """
    if (parts := _CONDITION.fullmatch(text)) is None:
        raise UsageError(
            f"`where`: found {text!r}; expected COLUMN, one of"
            f" {' '.join(_COMPARISONS)}, and a value, such as 'capacity_demand < 1.5'"
        )
    column, sign, value = parts.groups()
    if split_quantity(value) is None:
        return Condition(column, sign, value, None)
    try:
        number = parse_quantity(value, dimension_of(column) or "number")
    except ArgumentError as error:
        raise UsageError(f"`where`: {text}: {error}") from None
    return Condition(column, sign, value, number)


def in_order(
    rows: Iterable[Mapping[str, Any]], value: Callable[[Mapping[str, Any]], Any]
) -> list[Mapping[str, Any]]:
    """Return rows in the ascending order of a value of each: numbers first, then those
    that are only known to be above one, then words; rows without a value last.
    """

    def key(row: Mapping[str, Any]) -> tuple[int, float, str]:
        cell = value(row)
        if cell is None:
            return 3, 0.0, ""
        if isinstance(cell, int | float):
            return int(isinstance(cell, Above)), float(cell), ""
        return 2, 0.0, str(cell)

    return sorted(rows, key=key)
