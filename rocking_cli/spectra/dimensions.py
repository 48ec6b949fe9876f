"""The tables of a spectra file: the variables of its cells, their three dimensions, and
the lists of values that belong to each.

A new variable, parameter, coordinate or measure is one entry of a table below.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from ..dynamics.outcome import Difference, Outcome
from ..motions.grid import AXES
from ..structures.parameters import RockingParameters

Values = np.ndarray | list[str]

_TEXT = None  # the type of a list of texts


class About(NamedTuple):
    """The attributes of a list of values in a file."""

    units: str  # as CF writes them
    long_name: str  # in words
    get: Callable[[Any], Any] = str  # reads a value of a structure or record
    dtype: np.dtype | None = np.dtype("<f8")  # None for text


PARAMETERS = {
    "p": About("rad s-1", "frequency parameter", lambda s: s.p),
    "alpha": About("rad", "critical angle", lambda s: s.alpha),
    "eta": About("1", "coefficient of restitution", lambda s: s.eta),
    "lambda": About("1", "static uplift acceleration over gravity", lambda s: s.uplift),
    "a_scale": About("1", "scale of the ground acceleration", lambda s: s.a_scale),
    "gravity": About("m s-2", "acceleration of gravity", lambda s: s.gravity),
}
"""The lists of structures."""


def _edge(number: int, word: str, key: str) -> About:
    """Return what a file says of a parameter of one edge, NaN for a body with equal
    edges.
    """
    name = {"lambda": "uplift"}.get(key, key)
    long_name = f"{PARAMETERS[key].long_name} on the {word} edge"
    return About(
        PARAMETERS[key].units,
        long_name,
        lambda s: float(getattr(s.sides[number], name)) if s.sides else np.nan,
    )


EDGE_PARAMETERS = {
    f"{word}_{key}": _edge(number, word, key)
    for number, word in enumerate(("left", "right"))
    for key in ("p", "alpha", "eta", "lambda", "a_scale")
}
"""The lists for each edge of a body with unequal edges, NaN for other bodies; only in
files with such a body.
"""

RECORDED = {
    "factor": About(
        "1", "factor that the record was multiplied by", lambda r: r.factor
    ),
    "pga": About(
        "m s-2",
        "peak ground acceleration of the record, before its factor",
        lambda r: r.intensity.pga,
    ),
    "pga_time": About(
        "s", "time of the peak ground acceleration", lambda r: r.intensity.pga_time
    ),
    "pgv": About(
        "m s-1",
        "peak ground velocity of the record, before its factor",
        lambda r: r.intensity.pgv,
    ),
    "pgd": About(
        "m",
        "peak ground displacement of the record, before its factor",
        lambda r: r.intensity.pgd,
    ),
    "arias": About(
        "m s-1",
        "Arias intensity of the record, before the square of its factor",
        lambda r: r.intensity.arias,
    ),
    "cav": About(
        "m s-1",
        "cumulative absolute velocity of the record, before its factor",
        lambda r: r.intensity.cav,
    ),
    "d5_75": About(
        "s",
        "duration from 5 to 75 % of the Arias intensity",
        lambda r: r.intensity.d5_75,
    ),
    "d5_95": About(
        "s",
        "duration from 5 to 95 % of the Arias intensity",
        lambda r: r.intensity.d5_95,
    ),
    "npts": About("1", "number of samples", lambda r: r.record.npts, np.dtype("<i8")),
    "dt": About("s", "time between samples", lambda r: r.record.dt),
    "format": About("1", "format of the file", lambda r: r.record.format, _TEXT),
    "component": About(
        "1", "component as the file calls it", lambda r: r.record.component or "", _TEXT
    ),
    "record_unit": About(
        "1", "unit of the file's numbers", lambda r: r.record.unit, _TEXT
    ),
    "sha256": About("1", "SHA-256 of the file", lambda r: r.record.sha256, _TEXT),
}
"""The lists of records."""

VARIED = "varied_"  # prefix of the keys that families varied
LABEL = "label_"  # prefix of the labels of a table

ABOUT: dict[str, About] = {
    "structure": About("1", "name of the structure", dtype=_TEXT),
    "record": About("1", "name of the record", dtype=_TEXT),
    "motion": About("1", "name of the motion", dtype=_TEXT),
    "sign": About(
        "1", "direction of the motion: as stated, or the opposite one", dtype=_TEXT
    ),
    **{name: About(*about) for name, about in AXES.items()},
    **PARAMETERS,
    **EDGE_PARAMETERS,
    **RECORDED,
    "tan_alpha": About("1", "tangent of the critical angle"),
}


@dataclass(frozen=True, eq=False)
class Frame:
    """The axes of a spectra file."""

    # values on each of the three dimensions, in their order
    dimensions: Mapping[str, Values]
    # further lists of values by name, each with its dimension
    extra: Mapping[str, tuple[str, Values]]
    # attributes of the varied keys of a family, which are not in ABOUT
    units: Mapping[str, str] = field(default_factory=dict)

    def about(self, name: str) -> About:
        """Return the attributes of a list in the file."""
        if name.startswith(LABEL):
            return About("1", name.removeprefix(LABEL), dtype=_TEXT)
        return (
            About(self.units[name], f"{name.removeprefix(VARIED)} as it was varied")
            if name in self.units
            else ABOUT[name]
        )

    @property
    def lists(self) -> dict[str, tuple[str, Values]]:
        """All lists by name, those of the dimensions first, each with its dimension."""
        return {
            **{name: (name, values) for name, values in self.dimensions.items()},
            **self.extra,
        }

    @property
    def labels(self) -> tuple[str, ...]:
        """The further lists that distinguish places, for the CF attribute
        `coordinates`.
        """
        return tuple(self.extra) if self.of_records else tuple(self.units)

    @property
    def shape(self) -> tuple[int, int, int]:
        """The number of places on each dimension."""
        first, second, third = (len(values) for values in self.dimensions.values())
        return first, second, third

    @property
    def of_records(self) -> bool:
        """True for spectra of records."""
        return "record" in self.dimensions

    @property
    def of_verdicts(self) -> bool:
        """True for a table of verdicts, which holds no spectra."""
        return "sign" in self.dimensions


def lists_of(
    table: Mapping[str, About], dimension: str, of: Sequence[Any]
) -> dict[str, tuple[str, Values]]:
    """Return the lists of a table (PARAMETERS, RECORDED) along these structures or
    records.
    """
    values = {name: [about.get(one) for one in of] for name, about in table.items()}
    return {
        name: (
            dimension,
            some if table[name].dtype is None else np.array(some, table[name].dtype),
        )
        for name, some in values.items()
    }


def structure_lists(
    structures: Sequence[RockingParameters],
) -> dict[str, tuple[str, Values]]:
    """Return the lists along the structures: their parameters, the parameters of each
    edge if the edges differ, and varied keys.
    """
    found = lists_of(
        PARAMETERS | (EDGE_PARAMETERS if any(s.sides for s in structures) else {}),
        "structure",
        structures,
    )
    for name in varied_units(structures):
        values = [
            s.details.get("varied", {}).get(name.removeprefix(VARIED), np.nan)
            for s in structures
        ]
        found[name] = "structure", np.array(values, dtype=float)
    return found


def varied_units(structures: Sequence[RockingParameters]) -> dict[str, str]:
    """Return the names (varied_KEY) of the keys that families among these structures
    vary, with the units of their values.
    """
    return {
        f"{VARIED}{key}": unit or "1"
        for s in structures
        for key, unit in s.details.get("varied_units", {}).items()
    }


Codes = type[Outcome] | type[Difference]


class Variable(NamedTuple):
    """A variable of a spectra file."""

    dtype: np.dtype  # type of its values
    attributes: dict[str, Any]  # in the file
    codes: Codes | None = None  # meaning of its values where they are codes

    @property
    def fill(self) -> float:
        """The value of cells that are not computed."""
        return float(self.attributes.get("_FillValue", 0))


def _real(long_name: str, comment: str = "", units: str = "1") -> Variable:
    """Return a variable of double precision, NaN where it is not known."""
    about = {
        "units": units,
        "long_name": long_name,
        "_FillValue": np.nan,
        "comment": comment,
    }
    return Variable(
        np.dtype("<f8"), {key: value for key, value in about.items() if value != ""}
    )


def _coded(long_name: str, codes: Codes) -> Variable:
    """Return a variable of codes, with the meaning of each code."""
    flags = {
        "flag_values": np.array([c.value for c in codes], dtype="u1"),
        "flag_meanings": " ".join(c.flag for c in codes),
    }
    return Variable(
        np.dtype("u1"), {"units": "1", "long_name": long_name, **flags}, codes
    )


VARIABLES: dict[str, Variable] = {
    "theta_ratio": _real(
        "largest rotation over critical angle",
        "max over time of abs(theta)/alpha; NaN where overturned or not computed",
    ),
    "outcome": _coded("outcome", Outcome),
    "impacts_at_least": Variable(
        np.dtype("<i4"),
        {
            "units": "1",
            "long_name": "number of impacts, at least",
            "comment": "those computed until a proof ended the computation of the cell",
        },
    ),
    "velocity_ratio": _real(
        "largest angular speed over p",
        "max over time of abs(d theta/dt)/p; NaN where overturned or not computed",
        units="rad",
    ),
    "condition": _real(
        "condition of the largest rotation",
        "bound of the error of theta_ratio over the tolerance, from the last terms of"
        " all steps, carried through arcs and impacts; NaN where no body rocks and"
        " stands",
    ),
    "theta_ratio_linear": _real(
        "largest rotation over critical angle by the linear equation"
    ),
    "outcome_linear": _coded("outcome by the linear equation", Outcome),
    "difference": _coded(
        "how the linear equation judges what the nonlinear one decides", Difference
    ),
    "slide_max": _real(
        "largest displacement over the ground of a body that slides",
        "max over time of abs(u) for a body whose friction is below lambda, which"
        " slides and never rocks; NaN for another body, and where contact is lost",
        units="m",
    ),
}
"""A file has theta_ratio and outcome, and others on request, in this order; a chunk's
checksum runs over them in the same order.
"""

VERDICTS: dict[str, Variable] = {
    **{
        name: VARIABLES[name]
        for name in ("theta_ratio", "outcome", "outcome_linear", "slide_max")
    },
    "capacity_demand": _real(
        "lowest overturning amplitude over the demand",
        "NaN where none up to searched_to overturns",
    ),
    "first_overturning_a": _real(
        "lowest amplitude that overturns the body", units="m s-2"
    ),
    "searched_to": _real("largest amplitude of the search", units="m s-2"),
    "safe_to": _real(
        "end of the interval around the demand in which the body stands", units="m s-2"
    ),
    "uplift_a": _real("lowest amplitude that lifts the body", units="m s-2"),
    "demand_a": _real("amplitude of the motion", units="m s-2"),
    "falls_nearby": _real(
        "share of the amplitudes up to 5 % above the lowest fall that overturns",
        "NaN unless the body overturns in many narrow intervals",
    ),
    "top_displacement": _real("largest displacement of the top", units="m"),
    "friction_needed": _real("friction that the base needs between impacts"),
    "fz_min": _real("least vertical force over the weight"),
}
"""The variables of a table of verdicts, in the order of VARIABLES."""

VARIABLES |= VERDICTS

QUANTITIES: dict[str, tuple[str, ...]] = {
    "velocity_ratio": ("velocity_ratio",),
    "condition": ("condition",),
    "linear": ("theta_ratio_linear", "outcome_linear", "difference"),
    "slide": ("slide_max",),
}
"""The quantities that may be asked for, each with its variables."""
