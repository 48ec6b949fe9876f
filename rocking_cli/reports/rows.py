"""The rows of a table that a figure draws, in SI units by column name: those that a
command printed hold texts, those in memory values; None stands for an empty cell.
"""

import json
from collections.abc import Iterable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from ..documents.files import read_bytes
from ..documents.table import table_of
from ..documents.texts import text_of
from ..errors import ArgumentError, DocumentError, UsageError
from .units import si_of

Rows = list[dict[str, Any]]


def rows_of(source: str) -> Rows:
    """Return the rows of a CSV file, or of JSON Lines without summaries; `-` is
    standard input. Raises UsageError for others or no rows.
    """
    try:
        name, raw = read_bytes(source)
        text = text_of(name, raw)
        if text.lstrip().startswith("{"):
            found = _objects_of(text)
            rows = [row for row in found if row.get("event") != "summary"]
        else:
            table = table_of(text, name)
            rows = [
                _in_si(
                    {k: x or None for k, x in zip(table.headings, cells, strict=True)}
                )
                for _, cells in table.full_rows()
            ]
    except (DocumentError, ArgumentError) as error:
        if Path(source).suffix.lower() in (".yaml", ".yml"):
            raise UsageError(
                f"{source}: found a document; expected a spectra file or the rows of a"
                " command (rocking draw draws structures)"
            ) from None
        raise UsageError(
            f"{source}: neither a spectra file nor CSV ({error})"
        ) from None
    if not rows:
        raise UsageError(f"{source}: holds no rows")
    return rows


def _objects_of(text: str) -> list[dict[str, Any]]:
    """Return the objects of JSON Lines. Raises ArgumentError for other lines."""
    try:
        found = [json.loads(line) for line in text.splitlines() if line.strip()]
    except (ValueError, RecursionError) as error:  # a number of 5,000 digits, depth
        raise ArgumentError(str(error)) from None
    if not all(isinstance(row, dict) for row in found):
        raise ArgumentError("a line that is no JSON object")
    return found


def rows_in_memory(rows: Iterable[Mapping[str, Any]]) -> Rows:
    """Return rows in SI that a command has computed, each with every column."""
    from .tables import flat

    found = [flat(row) for row in rows]
    columns = dict.fromkeys(key for row in found for key in row)
    return [_in_si({key: row.get(key) for key in columns}) for row in found]


def _in_si(row: Mapping[str, Any]) -> dict[str, Any]:
    """Return a row in SI units. The columns before `name`, the varied keys of a family,
    keep their headings and units.
    """
    found = {}
    varied = "name" in row and "structure" not in row
    for heading, value in row.items():
        varied = varied and heading != "name"
        column, factor = (heading, 1.0) if varied else si_of(heading or "")
        if factor != 1.0 and value is not None:
            with suppress(ValueError):
                value = float(value) * factor
        found[column] = value
    return found


def column(rows: Iterable[Mapping[str, Any]], key: str) -> np.ndarray:
    """Return a column as numbers, NaN for an empty cell. Raises ValueError."""
    cells = (row[key] for row in rows)
    return np.array([np.nan if cell is None else float(cell) for cell in cells])


def groups(rows: Rows, *keys: str) -> dict[tuple[str, ...], Rows]:
    """Return the rows grouped by their texts in those of the columns `keys` that they
    have, in order.
    """
    found: dict[tuple[str, ...], Rows] = {}
    for row in rows:
        cells = (row[key] for key in keys if key in row)
        texts = tuple("" if cell is None else str(cell) for cell in cells)
        found.setdefault(texts, []).append(row)
    return found
