"""The rows of a CSV that a command printed, in SI under plain names."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable
from contextlib import suppress

import numpy as np

from ..documents.composition import read_text
from ..errors import DocumentError, UsageError
from .units import si_of

Rows = list[dict[str, str]]


def rows_of(source: str) -> Rows:
    """All rows of a file, `-` for standard input. Raises UsageError where it is no CSV or holds none."""
    try:
        text, name = read_text(source)
        rows = [_in_si(row) for row in csv.DictReader(io.StringIO(text, newline=""), strict=True)]
    except (DocumentError, csv.Error) as error:
        raise UsageError(f"{source}: neither a spectra file nor CSV ({error})") from None
    if not rows:
        raise UsageError(f"{name}: holds no rows")
    return rows


def _in_si(row: dict[str, str]) -> dict[str, str]:
    """A row in SI; what stands before the name is what a family varied, which keeps its headings."""
    found = {}
    headings = list(row)
    varied = set(headings[: headings.index("name")]) if "name" in row else set()
    for heading, text in row.items():
        column, factor = si_of(heading or "") if heading not in varied else (heading, 1.0)
        if factor != 1.0 and text:
            with suppress(ValueError):
                text = repr(float(text) * factor)
        found[column] = text
    return found


def column(rows: Iterable[dict[str, str]], key: str) -> np.ndarray:
    """A column as numbers, NaN where it is empty. Raises ValueError."""
    return np.array([float(row[key]) if row[key] else np.nan for row in rows])


def groups(rows: Rows, *keys: str) -> dict[tuple[str, ...], Rows]:
    """The rows by what stands in these columns, of those that there are, in order."""
    found: dict[tuple[str, ...], Rows] = {}
    for row in rows:
        found.setdefault(tuple(row[key] for key in keys if key in row), []).append(row)
    return found
