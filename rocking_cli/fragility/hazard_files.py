"""Hazard curves in files: the CSV that OpenQuake writes, or two columns."""

import math
import re
from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ..documents.quantities import DEFAULT_GRAVITY, is_bare, parse_quantity, quantity_at
from ..documents.table import Table, read_table, split_heading, with_unit
from ..errors import ArgumentError, DocumentError, UsageError, counted
from ..motions.intensity_measures import Measure, measure_of
from .hazard import HazardCurve

# the units [SI] in which OpenQuake gives its measures, besides SA and AvgSA; it calls
# Arias IA
OF_OPENQUAKE = {
    "PGA": DEFAULT_GRAVITY,
    "PGV": 0.01,
    "PGD": 0.01,
    "Arias": 1.0,
    "CAV": DEFAULT_GRAVITY,
}
_LEVEL = "poe-"  # what the columns of OpenQuake begin with
# the name of the measure; versions of OpenQuake quote it in different ways
_IMT = re.compile(r"""\bimt\s*=\s*["']*([A-Za-z]\w*(?:\([^)]*\))?)""")
_TIME = re.compile(r"""\binvestigation_time\s*=\s*["']*([\d.eE+-]+)""")
_TABLE = "a measure with its unit, and annual_rate or p_50_years: PGA [g],annual_rate"


class HazardPoint(NamedTuple):
    """A row of a file."""

    place: str  # file, line and column, for messages
    level: float  # [SI]
    rate: float  # [1/year]


def openquake_unit(measure: Measure) -> float:
    """Return the unit in which OpenQuake gives a measure [SI]."""
    return OF_OPENQUAKE.get(measure.name, DEFAULT_GRAVITY)


def read_hazard(
    path: str | Path, im: str = "PGA", site: str | None = None
) -> HazardCurve:
    """Return the hazard curve of a file.

    A probability p in t years is the rate -ln(1 - p)/t. A level of 0, first levels
    whose probability is 1, and last levels whose rate is 0, are left out.

    Parameters
    ----------
    path
        a CSV as OpenQuake writes it, or two columns, levels and annual rates or
        probabilities
    im
        the measure that the levels must have, such as "PGA" or "SA(1.0)"
    site
        "LON,LAT" of a row of OpenQuake's file, None if it has one row

    Returns
    -------
    HazardCurve
        levels in SI, rates in 1/year

    Raises
    ------
    UsageError
        for an unreadable file or another measure
    DocumentError
        for its faults, with file, line and column

    Examples
    --------
    >>> read_hazard("configs/hazard.csv").rate[:3].tolist()
    [0.1, 0.03, 0.008]
    """
    table, measure = read_table(path), measure_of(im)
    if not table.headings:
        raise DocumentError(
            f"{table.source}: found an empty file; expected a hazard curve"
        )
    if _IMT.search(table.comments) or any(
        name.startswith(_LEVEL) for name in table.headings
    ):
        points = _openquake(table, measure, site)
    elif site is not None:
        raise UsageError(
            f"{table.source}: `site` goes with a file of OpenQuake; found two columns"
        )
    else:
        points = _two_columns(table, measure)
    _require_a_hazard(points)
    kept = [
        (point.level, point.rate)
        for point in points
        if point.level > 0.0 and 0.0 < point.rate < math.inf
    ]
    if len(kept) < 2:
        raise DocumentError(
            f"{table.source}: found {counted(len(kept), 'level')} with a positive,"
            " finite rate; expected two or more"
        )
    x, rates = np.array(kept).T
    return HazardCurve(x, rates, measure.name)


def _require_a_hazard(points: Sequence[HazardPoint]) -> None:
    """Raise DocumentError unless the levels rise, from 0 or above, and the rates do not
    rise.
    """
    below = math.nextafter(0.0, -1.0)
    for before, now in pairwise([HazardPoint("", below, math.inf), *points]):
        if not now.level > before.level:
            raise DocumentError(
                f"{now.place}: found the level {now.level:g} after"
                f" {max(before.level, 0.0):g} (in SI units); expected rising levels"
                " from 0"
            )
        if now.rate > before.rate:
            raise DocumentError(
                f"{now.place}: found the rate {now.rate:g} above {before.rate:g} of the"
                " level before; expected a hazard curve that does not rise"
            )


def _openquake(table: Table, measure: Measure, site: str | None) -> list[HazardPoint]:
    """Return the points of a table of OpenQuake: the line above its heading has the
    measure, quoted or not, and the time of the poe.
    """
    years = _years(table, measure)
    line, row = _row_of(table, site)
    factor = openquake_unit(measure)
    found = []
    for i, (name, cell) in enumerate(zip(table.headings, row, strict=True), 1):
        if name.startswith(_LEVEL):
            heading = f"{table.source}, line {table.line}, column {i}"
            level = _number(heading, name.removeprefix(_LEVEL)) * factor
            place = f"{table.source}, line {line}, column {i}"
            found.append(HazardPoint(place, level, _rate(place, cell, years)))
    return found


def _years(table: Table, measure: Measure) -> float:
    """Return the time of the probabilities of a table of OpenQuake. Raises
    DocumentError, and UsageError for another measure.
    """
    first = f"{table.source}, line 1"
    imt, time = _IMT.search(table.comments), _TIME.search(table.comments)
    levels = any(name.startswith(_LEVEL) for name in table.headings)
    if imt is None or time is None or not levels:
        raise DocumentError(
            f"{first}: found no hazard curve of OpenQuake; expected imt=,"
            " investigation_time= and columns poe-"
        )
    _require_measure(first, imt[1], measure)
    years = _number(first, time[1])
    if not years > 0.0:
        raise DocumentError(
            f"{first}: found investigation_time={time[1]}; expected a positive number"
            " of years"
        )
    return years


def _row_of(table: Table, site: str | None) -> tuple[int, Sequence[str]]:
    """Return (line, cells) of the one row of a site. Raises UsageError if there is none
    or several.
    """
    every = rows = list(table.full_rows())
    if site is not None:
        rows = [
            (line, row)
            for line, row in every
            if _is_at(
                f"{table.source}, line {line}",
                site,
                dict(zip(table.headings, row, strict=True)),
            )
        ]
    if len(rows) == 1:
        return rows[0]
    wanted = (
        "one, named by `site` as LON,LAT"
        if len(every) > 1
        else "a row of longitude, latitude, depth and probabilities"
    )
    raise UsageError(
        f"{table.source}: found {len(rows)} sites{f' at {site}' if site else ''};"
        f" expected {wanted}"
    )


def _is_at(place: str, site: str, row: dict[str, str]) -> bool:
    """True if a row of a hazard table belongs to the site `LON,LAT` [deg]. Raises
    UsageError for a site of another form.
    """
    try:
        at = [parse_quantity(part, "number") for part in site.split(",")]
    except ArgumentError:
        at = []
    if len(at) != 2:
        raise UsageError(
            f"`site`: found {site!r}; expected LON,LAT in degrees, such as 9.15,45.15"
        )
    return all(
        abs(_number(place, row.get(key, "")) - value) < 1e-4
        for key, value in zip(("lon", "lat"), at, strict=True)
    )


def _two_columns(table: Table, measure: Measure) -> list[HazardPoint]:
    """Return the points of a table with a column of levels and one of annual rates, or
    of probabilities in so many years. Raises DocumentError.
    """
    names, first = table.headings, f"{table.source}, line {table.line}"
    (im, unit), (kind, _) = (
        (split_heading(name) for name in names)
        if len(names) == 2
        else (("", ""), ("", ""))
    )
    years = re.fullmatch(r"p_([\d.]+)_years?", kind)
    if kind != "annual_rate" and years is None:
        raise DocumentError(
            f"{first}: found the columns {', '.join(names)}; expected {_TABLE}"
        )
    _require_measure(first, im, measure)
    time = None if years is None else _number(first, years[1])
    if time == 0.0:
        raise DocumentError(
            f"{first}: found {kind}; expected a positive number of years"
        )
    found = []
    for at, (cell, rate) in table.full_rows():
        place, text = f"{table.source}, line {at}", with_unit(cell, unit)
        # The program would read m/s2 here, but most people mean g.
        if text == cell and is_bare(cell) and measure.unit:
            raise DocumentError(
                f"{place}: found the level {cell} without a unit; expected {_TABLE}"
            )
        level = _number(place, text, measure.dimension)
        found.append(HazardPoint(place, level, _rate(place, rate, time)))
    return found


def _require_measure(place: str, found: str, wanted: Measure) -> None:
    """Raise UsageError unless the measure that a file names is the wanted one."""
    try:
        name = measure_of("Arias" if found == "IA" else found).name
    except UsageError:
        name = ""
    # AvgSA of OpenQuake averages over periods that the file does not state.
    if found == "AvgSA" or name != wanted.name:
        raise UsageError(
            f"{place}: found levels of {found}; expected levels of {wanted.name}, the"
            " measure `im`"
        )


def _number(place: str, text: str, dimension: str = "number") -> float:
    return quantity_at(place, text, dimension, DocumentError)


def _rate(place: str, text: str, years: float | None) -> float:
    """Return the annual rate that a cell states; years: the time of a probability, None
    for a rate.
    """
    value = _number(place, text)
    if value < 0.0 or (years is not None and value > 1.0):
        raise DocumentError(
            f"{place}: found {text!r}; expected"
            f" {'a rate from 0' if years is None else 'a probability from 0 to 1'}"
        )
    if years is None:
        return value
    return -math.log1p(-value) / years if value < 1.0 else math.inf
