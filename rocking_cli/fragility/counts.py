"""Counts that exist already, of tests or of another program: how many of n motions at a
level are beyond a limit state.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..arrays import Array
from ..documents.files import named_after
from ..documents.quantities import DEFAULT_GRAVITY, is_bare, unit_of
from ..documents.table import named_rows
from ..errors import DocumentError, UsageError
from ..motions.intensity_measures import Measure, measure_of
from .bootstrap import Resampling, bootstrap_counts
from .fits import fit_stripes
from .fitted_curve import Fit, drawn_at, rate_of
from .hazard import HazardCurve
from .measures import cell

CountRow = tuple[int, dict[str, str]]  # line and cells by column

_LEVEL = "im"  # the column of levels that names no measure


@dataclass(frozen=True, eq=False)
class Counts:
    """The counts of a file, (k,) levels."""

    source: str  # the file
    measure: Measure | None  # measure of the levels; None if the file states no unit
    x: Array  # levels, in SI; in the unit of the file without a measure
    n: Array  # motions at each level
    z: Array  # motions beyond the limit state
    remark: str | None = None  # says in which unit levels without one are read
    unit: str = ""  # unit of the levels, as the file states it


def read_counts(
    path: str | Path, im: str | None = None, *, needs_measure: bool = False
) -> Counts:
    """Return the counts of a CSV file with the columns im (levels), n and z. The
    heading of the levels may name their measure, and they may state their unit, in the
    heading or in every cell.

    im: the measure of the levels, None for that of the heading, PGA for `im`;
    needs_measure: refuse levels without a unit. Raises UsageError for another measure,
    DocumentError with file, line and column.
    """
    columns, rows = named_rows(path)
    levels = [name for name in columns if name not in ("n", "z")]
    if len(columns) != 3 or len(levels) != 1:
        raise DocumentError(
            f"{path}, line 1: found the columns {', '.join(columns) or 'none'};"
            " expected im, n and z"
        )
    (column,) = levels
    measure: Measure | None = _measure_of(path, column, im)
    bare = [(line, row[column]) for line, row in rows if is_bare(row[column])]
    if column == _LEVEL and len(bare) == len(rows) and im is None and not needs_measure:
        measure = None
    elif bare and measure is not None and measure.unit and len(bare) < len(rows):
        line, level = bare[0]
        raise DocumentError(
            f"{path}, line {line}: {column}: found the level {level} without a unit;"
            " expected one, as other levels have it"
        )
    dimension = "number" if measure is None else measure.dimension
    x = np.array([cell(path, line, row, column, dimension) for line, row in rows])
    n = np.array([_whole(path, one, "n", 1) for one in rows])
    z = np.array([_whole(path, one, "z", 0) for one in rows])
    for at in np.flatnonzero(z > n)[:1].tolist():
        raise DocumentError(
            f"{path}, line {rows[at][0]}: z: found {z[at]:g} of n = {n[at]:g} motions;"
            " expected a number from 0 to n"
        )
    unit = unit_of(rows[0][1][column]) if rows else ""
    return Counts(
        str(path), measure, x, n, z, _unstated(measure, x) if bare else None, unit
    )


def _unstated(measure: Measure | None, x: Array) -> str | None:
    """Return the sentence on levels that state no unit: SI is the rule, and the safe
    reading of levels that are meant in g.
    """
    if measure is None or not measure.unit:
        return None
    line = (
        f"levels without a unit are in {measure.unit}, up to {x.max():g} {measure.unit}"
    )
    if measure.dimension == "acceleration":
        line += (
            f" ({x.max() / DEFAULT_GRAVITY:.3g} g): if they are in g, write the heading"
            f" as {measure.name} [g]"
        )
    return line


def fit_counts(
    counts: Counts,
    how: Resampling,
    *,
    hazard: HazardCurve | None = None,
    limit: str = "counted",
) -> Fit:
    """Return the curve of counts; hazard: a curve of the same measure, for the annual
    rate; limit: the name of the limit state. Raises UsageError if the data do not
    support a fit.
    """
    x, n, z = counts.x, counts.n, counts.z
    try:
        curve = fit_stripes(x, n, z)
    except UsageError as error:
        raise UsageError(f"{counts.source}: {error}") from None
    at, rates = drawn_at(x, hazard)
    band = bootstrap_counts(x, n, z, how, at, rates) if how.samples else None
    return Fit(
        structure=named_after(counts.source),
        im=_LEVEL if counts.measure is None else counts.measure.name,
        limit=limit,
        method="stripes",
        curve=curve,
        band=band,
        x=at,
        points=dict(zip(x.tolist(), (z / n).tolist(), strict=True)),
        hazard=hazard,
        rate=None if hazard is None else rate_of(curve, band, hazard),
    )


def _measure_of(path: str | Path, column: str, im: str | None) -> Measure:
    """Return the measure of the levels. Raises UsageError if the heading names another
    one than `im`.
    """
    if column == _LEVEL:
        return measure_of(im or "PGA")
    try:
        stated = measure_of(column)
    except UsageError:
        wanted = "im, or the name of a measure, such as PGA [g]"
        raise DocumentError(
            f"{path}, line 1: found the column {column}; expected {wanted}"
        ) from None
    if im is not None and measure_of(im).name != stated.name:
        raise UsageError(
            f"{path}: found levels of {stated.name}; expected levels of"
            f" {measure_of(im).name}, the measure `im`"
        )
    return stated


def _whole(path: str | Path, one: CountRow, column: str, least: int) -> float:
    """Return the whole number of motions of a cell. Raises DocumentError."""
    line, row = one
    value = cell(path, line, row, column, "number")
    if value != int(value) or value < least:
        wanted = f"a whole number of motions, from {least}"
        raise DocumentError(
            f"{path}, line {line}: {column}: found {row[column]!r}; expected {wanted}"
        )
    return value
