"""The unit of every column that a command prints, and the units that a reader may ask for instead.

Records are in SI, and so are JSON and spectra files; tables, CSV and figures show the units asked for, in their headings.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from ..documents.quantities import DEFAULT_GRAVITY, headed
from ..errors import UsageError

SI = {
    "angle": "rad", "angular velocity": "rad/s", "frequency parameter": "rad/s", "circular frequency": "rad/s",
    "acceleration": "m/s2", "velocity": "m/s", "length": "m", "mass": "kg", "time": "s", "intensity": "m/s", "gravity": "m/s2",
}  # fmt: skip
"""Of each dimension; gravity and Arias intensity are dimensions of their own, which keep their units."""

COLUMNS = {
    **dict.fromkeys(("alpha", "theta", "theta_max", "angle"), "angle"),
    "p": "frequency parameter", "theta_dot": "angular velocity", "omega_g": "circular frequency",
    **dict.fromkeys(("a_g", "a_from", "a_to", "demand_a", "uplift_a", "first_overturning_a", "safe_to"), "acceleration"),
    **dict.fromkeys(("ground_acceleration", "pga", "header_pga"), "acceleration"),
    **dict.fromkeys(("t", "t_max", "dt", "duration", "pga_time", "d5_75", "d5_95", "T", "run_time", "time_per_cell"), "time"),
    "pgv": "velocity", "arias": "intensity", "cav": "intensity", "gravity": "gravity", "mass": "mass",
    **dict.fromkeys(("pgd", "x", "z", "arm", "length", "tip_height", "crack_height"), "length"),
}  # fmt: skip
"""The dimension of every column that has one."""

_CHOICES: dict[str, dict[str, tuple[str, float]]] = {
    "g": {"acceleration": ("g", DEFAULT_GRAVITY)},
    "m/s2": {"acceleration": ("m/s2", 1.0)},
    "cm/s2": {"acceleration": ("cm/s2", 1e-2)},
    "gal": {"acceleration": ("gal", 1e-2)},
    "Hz": {"circular frequency": ("Hz", 2.0 * math.pi)},
    "rad/s": {"circular frequency": ("rad/s", 1.0)},
    "deg": {"angle": ("deg", math.pi / 180.0), "angular velocity": ("deg/s", math.pi / 180.0)},
    "mrad": {"angle": ("mrad", 1e-3), "angular velocity": ("mrad/s", 1e-3)},
    "rad": {"angle": ("rad", 1.0), "angular velocity": ("rad/s", 1.0)},
    "mm": {"length": ("mm", 1e-3)},
    "cm": {"length": ("cm", 1e-2)},
    "m": {"length": ("m", 1.0)},
    "cm/s": {"velocity": ("cm/s", 1e-2)},
    "m/s": {"velocity": ("m/s", 1.0)},
}
"""What may be asked for: of each dimension that it changes, the unit's name and what it is in SI."""

_OF_ONE = re.compile(r"(?:left|right|[a-z]+_\d+)_(.+)|(.+)_(?:linear|nonlinear)")  # of a side, of an item of a list, by a model
_FREQUENCY = {"omega_g": "f_g"}  # what a column is called in Hz
HEADING = re.compile(r"(?P<column>.*?) \[(?P<unit>[^\]]*)\]")


@dataclass(frozen=True)
class Units:
    """The units of a table: of each dimension the name of the unit and what it is in SI; SI where it does not say.

    without: columns that have no unit of their own in this table, whatever their name means elsewhere.
    """

    chosen: Mapping[str, tuple[str, float]] = field(default_factory=dict)
    without: frozenset[str] = frozenset()

    def of(self, dimension: str) -> tuple[str, float]:
        """(name, factor to SI) of the unit of a dimension."""
        return self.chosen.get(dimension, (SI[dimension], 1.0))

    def column(self, name: str) -> tuple[str, str, float]:
        """(name, unit, factor to SI) of a column in these units; no unit and 1 for one without a dimension."""
        dimension = None if name in self.without else dimension_of(name)
        if dimension is None:
            return name, "", 1.0
        unit, factor = self.of(dimension)
        return (_FREQUENCY.get(name, name) if unit == "Hz" else name), unit, factor

    def heading(self, name: str) -> tuple[str, float]:
        """The heading of a column, which states its unit, and the factor to SI."""
        column, unit, factor = self.column(name)
        return headed(column, unit), factor

    def shown(self, records: Iterable[Mapping[str, Any]]) -> Iterator[dict[str, Any]]:
        """Records as they are shown: values in these units, under headings that state them."""
        headings: dict[str, tuple[str, float]] = {}
        for record in records:
            out = {}
            for name, value in record.items():
                if name not in headings:
                    headings[name] = self.heading(name)
                heading, factor = headings[name]
                out[heading] = value / factor if factor != 1.0 and isinstance(value, int | float) else value
            yield out


def dimension_of(column: str) -> str | None:
    """The dimension of a column, of one for a side (left_p), an item (hinges_1_angle) or a model (theta_linear) too."""
    found = COLUMNS.get(column)
    if found is None and (match := _OF_ONE.fullmatch(column)):
        return dimension_of(match[1] or match[2])
    return found


def parse_units(text: str) -> Units:
    """The units of `g,Hz,deg`. Raises UsageError for one that is unknown, or two of one dimension."""
    chosen: dict[str, tuple[str, float]] = {}
    names: dict[str, str] = {}
    for name in (part.strip() for part in text.split(",")):
        if name not in _CHOICES:
            raise UsageError(f"`units`: found {name!r}; accepted are {', '.join(_CHOICES)}, separated by commas")
        for dimension, unit in _CHOICES[name].items():
            if dimension in names:
                raise UsageError(f"`units`: found {names[dimension]} and {name}; accepted is one unit of {dimension}")
            names[dimension], chosen[dimension] = name, unit
    return Units(chosen)


def si_of(heading: str) -> tuple[str, float]:
    """(column, factor to SI) of a heading that `Units` wrote, a column in Hz being its circular frequency; others stay as they are."""
    match = HEADING.fullmatch(heading)
    if match is None:
        return heading, 1.0
    for units in [Units(), *(Units(choice) for choice in _CHOICES.values())]:
        for column in (match["column"], *(name for name, shown in _FREQUENCY.items() if shown == match["column"])):
            if units.column(column)[:2] == (match["column"], match["unit"]):
                return column, units.column(column)[2]
    return heading, 1.0
