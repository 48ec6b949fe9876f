"""The rows of `rocking fragility`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from .fragility_options import FragilityOptions
from .printing import emit, form, units_of, units_shown

if TYPE_CHECKING:
    from ..fragility.fitted_curve import Fit
    from ..fragility.study import Study


def emit_cells(studies: Sequence[Study]) -> None:
    """Print every motion at every level."""
    from ..fragility.study import CELL_COLUMNS

    rows = [row for study in studies for row in study.cells()]
    emit(rows, CELL_COLUMNS)


def emit_fits(
    fits: Sequence[Fit],
    exact: Sequence[Study],
    wanted: FragilityOptions,
    unit: str = "",
) -> None:
    """Print the rows of fits, or with --curve those of curves; unit: of the levels, as
    they are stated.
    """
    from ..fragility.fitted_curve import (
        CURVE_COLUMNS,
        FRAGILITY_COLUMNS,
        HAZARD_COLUMNS,
    )
    from ..fragility.hazard import RATE_COLUMNS
    from ..reports.units import OF_THE_MEASURE, dimension_of_measure

    columns: tuple[str, ...]
    measure = fits[0].im if fits else exact[0].motions.measure.name
    if wanted.curve:
        rows = curves_of(fits, exact)
        columns = CURVE_COLUMNS
        of_hazard: tuple[str, ...] = HAZARD_COLUMNS
    else:
        rows = [fit.row() for fit in fits]
        if wanted.hazard is not None:
            rows += [study.exact_row() for study in exact]
        _add_rejected(rows, wanted.standing)
        _name_the_unit(rows)
        columns, of_hazard = FRAGILITY_COLUMNS, RATE_COLUMNS

    if wanted.hazard is not None:
        columns = (*columns, *of_hazard)
    emit(
        rows,
        columns,
        table_units=_table_units(unit or wanted.unit_of_levels()),
        dimensions=dict.fromkeys(OF_THE_MEASURE, dimension_of_measure(measure)),
        unseen=("rate_without_fit",),
    )


def curves_of(fits: Sequence[Fit], exact: Sequence[Study]) -> list[dict[str, Any]]:
    """Return the points of the curves, and the exact shares."""
    rows = [row for fit in fits for row in fit.points_of_curve()]
    return rows + [row for study in exact for row in study.exact_rows()]


def _add_rejected(rows: list[dict[str, Any]], standing: float | None) -> None:
    """Add the probability that a body would have fallen in the years that
    it has stood.
    """
    if standing is None:
        return
    for row in rows:
        overturning = row["limit_state"] == "overturning"
        row["rejected"] = (
            -math.expm1(-row["annual_rate"] * standing) if overturning else None
        )


def _name_the_unit(rows: list[dict[str, Any]]) -> None:
    """State the unit beside the measure too, in a CSV whose units are asked for."""
    from ..documents.quantities import headed
    from ..reports.units import dimension_of_measure

    units = units_of()
    if form() != "csv" or units is None:
        return
    for row in rows:
        dimension = dimension_of_measure(row["im"])
        if dimension is not None:
            row["im"] = headed(row["im"], units.of(dimension)[0])


def emit_efficiency(studies: Sequence[Study], wanted: FragilityOptions) -> None:
    """Print a row for each measure. In a table and in CSV, its unit stands beside its
    name, because the medians of one column have several.
    """
    from ..documents.quantities import headed
    from ..fragility.efficiency import EFFICIENCY_COLUMNS, efficiency
    from ..reports.units import OF_THE_MEASURE, dimension_of_measure

    rows = [row for study in studies for row in efficiency(study)]
    units = units_shown(_table_units(wanted.unit_of_levels()))
    for row in rows if form() != "json" else ():
        dimension = dimension_of_measure(row["im"])
        if dimension is not None:
            unit, factor = units.of(dimension)
            row |= {"im": headed(row["im"], unit), "median": row["median"] / factor}
    dimensions = dict.fromkeys(OF_THE_MEASURE)
    emit(rows, EFFICIENCY_COLUMNS, dimensions=dimensions)


def _table_units(unit: str) -> str | None:
    """Return the unit of a table: that of the levels, if a table can have it."""
    from ..reports.units import is_choice

    return unit if is_choice(unit) else None
