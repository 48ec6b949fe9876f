"""The unit of every printed column, and the choices of `--units`, which change tables,
CSV and figures; JSON and files stay in SI.
"""

import math
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import Any

from ..arguments import check_fields
from ..documents.quantities import UNITS, headed, si_unit, unit_as_meant
from ..errors import UsageError

SI = {dimension: si_unit(dimension) for dimension in UNITS} | {
    "angular velocity": "rad/s",
    "circular frequency": "rad/s",
    "intensity": "m/s",
    "gravity": "m/s2",
    "moment": "N m",
    "annual rate": "1/yr",
    "years": "yr",
}
"""The SI unit of each dimension (years for rates), an empty text for numbers. `--units`
must not change gravity, Arias intensity and CAV: they are separate dimensions.
"""

OF_INTENSITY = ("arias", "cav")
"""The velocities that `--units` does not change."""


def _each(column: str) -> tuple[str, ...]:
    """Return a column with those of its interval and its sides."""
    ends = ("_low", "_high", "_right", "_left")
    return (column, *(column + end for end in ends))


# the columns of each dimension
_NAMES: dict[str, tuple[str, ...]] = {
    "angle": (
        *_each("alpha"),
        "alpha_geometric",
        "equilibrium",
        "theta",
        "theta_max",
        "theta_before",
        "angle",
        "azimuth",
        "largest_azimuth",
    ),
    "frequency parameter": (
        *_each("p"),
        "p_structure",
    ),
    "angular velocity": ("theta_dot",),
    "circular frequency": (
        "omega_g",
        "omega_n",
    ),
    "acceleration": (
        "a_g",
        "a_from",
        "a_to",
        "demand_a",
        "uplift_a",
        "first_overturning_a",
        "first_overturning_a_q05",
        "first_overturning_a_q50",
        "first_overturning_a_q95",
        "safe_to",
        "searched_to",
        "slide_a",
        "stuck_first_overturning_a",
        "first_overturning_a_free",
        "ground_acceleration",
        "pga",
        "header_pga",
        "floor_pga",
        "S_a",
        "code_linear",
        "code_slv",
        "code_slc",
        "theta_04_a",
    ),
    "length": (
        "slide",
        "slide_max",
        "slide_residual",
        "tie_elongation",
        "permanent",
        "pgd",
        "S_d",
        "top_displacement",
        "x",
        "z",
        "arm",
        "length",
        "tip_height",
        "crack_height",
        *_each("inset"),
        "d_slv",
        "d_slc",
    ),
    "velocity": (
        "slide_velocity",
        "slide_velocity_max",
        "slide_speed",
        "pgv",
    ),
    "time": (
        "t",
        "t_max",
        "dt",
        "duration",
        "pga_time",
        "d5_75",
        "d5_95",
        "T",
        "run_time",
        "check_time",
        "time_per_cell",
        "pgv_pga",
        "impulse_x",
        "impulse_z",
        "t_slv",
        "t_slc",
    ),
    "frequency": (
        "worst_f_g",
        "largest_f_g",
    ),
    "intensity": OF_INTENSITY,
    "gravity": ("gravity",),
    "mass": ("mass",),
    "force": (
        "force",
        "compression",
        "reaction",
        "top_reaction",
        "tendon_force",
    ),
    "stress": ("base_stress",),
    "annual rate": (
        "annual_rate",
        "annual_rate_low",
        "annual_rate_high",
        "rate_beyond",
        "rate_without_fit",
        "hazard",
        "deaggregation",
    ),
    "years": ("return_period",),
}

COLUMNS = {name: of for of, names in _NAMES.items() for name in names}
"""The dimension of each column that has a unit."""

OF_THE_MEASURE = ("x", "median", "median_low", "median_high")
"""The columns whose dimension is that of an intensity measure, which the row names."""

_OF_A_RESTRAINT = re.compile(r"(?:(?:ties|stands)_\d+|tendon)_(.+)")
_RESTRAINT = {
    **dict.fromkeys(("height", "behind", "ultimate", "lever"), "length"),
    **dict.fromkeys(("prestress", "yield", "rupture"), "force"),
    "stiffness": "stiffness",
    "moment": "moment",
}

_CHOICES: dict[str, dict[str, tuple[str, float]]] = {
    unit: {dimension: (unit, UNITS[dimension][unit])}
    for dimension, units in (
        ("acceleration", ("g", "m/s2", "cm/s2", "gal", "ft/s2", "in/s2")),
        ("length", ("mm", "cm", "m", "in", "ft")),
        ("velocity", ("cm/s", "m/s", "in/s", "ft/s")),
    )
    for unit in units
} | {
    "Hz": {"circular frequency": ("Hz", 2.0 * math.pi)},
    "rad/s": {"circular frequency": ("rad/s", 1.0)},
    **{
        unit: {
            "angle": (unit, UNITS["angle"][unit]),
            "angular velocity": (f"{unit}/s", UNITS["angle"][unit]),
        }
        for unit in ("deg", "mrad", "rad")
    },
}
"""The choices of `--units`: for each dimension that a choice changes, the unit and its
factor to SI.
"""

# a column for a side, a list item or an equation
_OF_ONE = re.compile(r"(?:left|right|[a-z]+_\d+)_(.+)|(.+)_(?:linear|nonlinear)")
_FREQUENCY = {"omega_g": "f_g"}  # the name of a column in Hz
HEADING = re.compile(r"(?P<column>.*?) \[(?P<unit>[^\[\]]*)\]")


@dataclass(frozen=True)
class Units:
    """The units of tables and figures; a dimension that is not chosen is shown in SI.

    `heading` and `shown` turn columns and rows of SI values into these units.

    Attributes
    ----------
    chosen: (unit, factor to SI) by dimension
    dimensions: dimension of columns that have another one here; None: no unit

    Examples
    --------
    >>> units = Units({"acceleration": ("g", 9.80665)})
    >>> units.column("a_g")
    ('a_g', 'g', 9.80665)
    >>> [(name, round(value, 3)) for row in units.shown([{"a_g": 3.0}])
    ...  for name, value in row.items()]
    [('a_g [g]', 0.306)]
    """

    # (unit, factor to SI) by dimension; any other dimension is shown in SI
    chosen: Mapping[str, tuple[str, float]] = field(default_factory=dict)

    # dimension of columns that have another one here than in `COLUMNS`; None: no unit
    dimensions: Mapping[str, str | None] = field(default_factory=dict)

    def __post_init__(self) -> None:
        check_fields(self)

    def of(self, dimension: str) -> tuple[str, float]:
        """Return the unit of a dimension.

        Parameters
        ----------
        dimension
            such as "acceleration" or "length"

        Returns
        -------
        tuple of (str, float)
            the unit and its factor to SI
        """
        return self.chosen.get(dimension, (SI[dimension], 1.0))

    def column(self, name: str) -> tuple[str, str, float]:
        """Return the unit of a column.

        Parameters
        ----------
        name
            of the column, such as "a_g"

        Returns
        -------
        tuple of (str, str, float)
            the name in this unit (f_g for omega_g in Hz), the unit and its factor to
            SI; "" and 1 for a column without a dimension
        """
        own = name in self.dimensions
        dimension = self.dimensions[name] if own else dimension_of(name)
        if dimension is None:
            return name, "", 1.0
        unit, factor = self.of(dimension)
        return (_FREQUENCY.get(name, name) if unit == "Hz" else name), unit, factor

    def heading(self, name: str) -> tuple[str, float]:
        """Return the heading of a column.

        Parameters
        ----------
        name
            of the column, such as "a_g"

        Returns
        -------
        tuple of (str, float)
            the heading with the unit, and its factor to SI
        """
        column, unit, factor = self.column(name)
        return headed(column, unit), factor

    def shown(self, records: Iterable[Mapping[str, Any]]) -> Iterator[dict[str, Any]]:
        """Yield rows in these units, which the headings state.

        Parameters
        ----------
        records
            rows of SI values by column

        Yields
        ------
        dict
            values by heading
        """
        heading = cache(self.heading)
        for record in records:
            out = {}
            for name, value in record.items():
                title, factor = heading(name)
                out[title] = (
                    value / factor
                    if factor != 1.0 and isinstance(value, int | float)
                    else value
                )
            yield out


def dimension_of(column: str) -> str | None:
    """Return the dimension of a column, also of a side (left_p), a list item
    (hinges_1_angle) or an equation (theta_linear), or None.
    """
    if found := COLUMNS.get(column):
        return found
    if (match := _OF_A_RESTRAINT.fullmatch(column)) and match[1] in _RESTRAINT:
        return _RESTRAINT[match[1]]
    match = _OF_ONE.fullmatch(column)
    return dimension_of(match[1] or match[2]) if match else None


def parse_units(text: str) -> Units:
    """Return the units that a text such as `g,Hz,deg` states. Raises UsageError for an
    unknown unit, or for two units of one dimension.
    """
    chosen: dict[str, tuple[str, float]] = {}
    names: dict[str, str] = {}
    for name in (part.strip() for part in text.split(",")):
        if name not in _CHOICES:
            raise UsageError(
                f"`units`: found {name!r}{unit_as_meant(name, _CHOICES)}; expected"
                f" {', '.join(_CHOICES)}, separated by commas"
            )
        for dimension, unit in _CHOICES[name].items():
            if dimension in names:
                raise UsageError(
                    f"`units`: found {names[dimension]} and {name}; expected one unit"
                    f" of {dimension}"
                )
            names[dimension], chosen[dimension] = name, unit
    return Units(chosen)


def is_choice(unit: str) -> bool:
    """True if `--units` may choose this unit."""
    return unit in _CHOICES


def dimension_of_measure(im: str) -> str | None:
    """Return the dimension of an intensity measure such as PGA or SA(1); None without a
    unit, and for a measure that is not known here.
    """
    from ..motions.intensity_measures import measure_named

    # also SA(T1) of a table made elsewhere, whose period is no number
    spectral = im.partition("(")[0].strip().casefold() in ("sa", "avgsa")
    measure = measure_named("AvgSA" if spectral else im, "im")
    if measure is None or not measure.unit:
        return None
    return "intensity" if im.lower() in OF_INTENSITY else measure.dimension


@cache
def si_of(heading: str) -> tuple[str, float]:
    """Return (column, factor of its unit to SI) of a heading; the heading itself and 1
    without a unit. f_g [Hz] becomes omega_g.
    """
    match = HEADING.fullmatch(heading)
    if match is None:
        return heading, 1.0
    if match["column"] in OF_THE_MEASURE:
        return match["column"], _factor_of(match["unit"])
    for units in [Units(), *(Units(choice) for choice in _CHOICES.values())]:
        for column in (
            match["column"],
            *(name for name, shown in _FREQUENCY.items() if shown == match["column"]),
        ):
            if units.column(column)[:2] == (match["column"], match["unit"]):
                return column, units.column(column)[2]
    return heading, 1.0


def _factor_of(unit: str) -> float:
    """Return the factor of a unit of tables to SI, 1 for an unknown one."""
    chosen = [pair for choice in _CHOICES.values() for pair in choice.values()]
    return dict(chosen).get(unit, 1.0)
