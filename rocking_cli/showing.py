"""How results show themselves: a short text in a terminal, a small table in a notebook,
rows of pandas.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Any, Protocol

from .plugins import require

if TYPE_CHECKING:
    import pandas

_MOST_LINES = 14  # below the name of the class
_WIDEST = 100  # characters of a line


class RowWriter(Protocol):
    """What writes rows: `reports.tables`."""

    def shown_cells(self, row: Mapping[str, Any], /) -> Iterator[tuple[str, str]]:
        """Yield (heading with unit, text) of the columns that have a value."""


# Returns what writes rows. The package adds it: results stand below reports, and a
# program that shows none does not load them.
WRITERS: list[Callable[[], RowWriter]] = []


class Shown:
    """A result with one row of quantities that a person wants to see first."""

    def _shown(self) -> Mapping[str, Any]:
        """Return these quantities by column name, in SI units."""
        raise NotImplementedError

    def _rows(self) -> Iterable[Mapping[str, Any]]:
        """Return the rows of `to_pandas`."""
        return [self._shown()]

    def __repr__(self) -> str:
        cells = list(WRITERS[0]().shown_cells(self._shown()))
        width = max(len(heading) for heading, _ in cells)
        shown = [_cut(f"{heading:{width}}  {text}") for heading, text in cells]
        left = len(shown) - _MOST_LINES
        if left > 0:
            shown[_MOST_LINES - 1 :] = [f"and {left + 1} more lines"]
        return "\n  ".join([type(self).__name__, *shown])

    def _repr_html_(self) -> str:
        return html_table(type(self).__name__, self._shown())

    def to_pandas(self) -> pandas.DataFrame:
        """Return the rows as a DataFrame, with the columns that the commands print in
        JSON, in SI units. Raises OutputError without pandas.
        """
        require("to_pandas needs", "pandas")
        import pandas as pd

        return pd.DataFrame(list(self._rows()))


def _cut(line: str) -> str:
    """Return a line of at most `_WIDEST` characters."""
    return line if len(line) <= _WIDEST else f"{line[: _WIDEST - 4]} ..."


def html_table(title: str, row: Mapping[str, Any]) -> str:
    """Return a table in HTML with a line for each quantity that has a value."""
    from html import escape

    lines = "".join(
        f"<tr><th style='text-align:left'>{escape(heading)}</th>"
        f"<td style='text-align:left'>{escape(text)}</td></tr>"
        for heading, text in WRITERS[0]().shown_cells(row)
    )
    return f"<table><caption>{escape(title)}</caption>{lines}</table>"
