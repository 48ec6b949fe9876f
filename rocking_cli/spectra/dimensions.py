"""What the cells of a spectra file lie on: three dimensions, and what is known of each place on them, in one table.

A new parameter, coordinate or measure is one entry of a table below; a new kind of spectrum is one entry of FORMS.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..motions.grid import LONG_NAMES, UNITS, Grid
from ..structures.parameters import RockingParameters

if TYPE_CHECKING:
    from ..motions.recording import Recording

Values = np.ndarray | list[str]

PARAMETERS: dict[str, tuple[str, str, Callable[[RockingParameters], float]]] = {
    "p": ("rad s-1", "frequency parameter", lambda s: s.p),
    "alpha": ("rad", "critical angle", lambda s: s.alpha),
    "eta": ("1", "coefficient of restitution", lambda s: s.eta),
    "lambda": ("1", "static uplift acceleration over gravity", lambda s: s.uplift),
    "a_scale": ("1", "scale of the ground acceleration", lambda s: s.a_scale),
    "gravity": ("m s-2", "acceleration of gravity", lambda s: s.gravity),
}
"""Of each structure: units, long name, value."""


def _edge(number: int, word: str, key: str) -> tuple[str, str, Callable[[RockingParameters], float]]:
    units, long_name, _ = PARAMETERS[key]
    name = {"lambda": "uplift"}.get(key, key)
    return units, f"{long_name} on the {word} edge", lambda s: float(getattr(s.sides[number], name)) if s.sides else np.nan


EDGE_PARAMETERS = {
    f"{word}_{key}": _edge(number, word, key)
    for number, word in enumerate(("left", "right"))
    for key in ("p", "alpha", "eta", "lambda", "a_scale")
}
"""The same of each edge of a body whose edges differ, NaN for others; in files that hold such a body."""


def parameters_of(structures: Sequence[RockingParameters]) -> dict[str, tuple[str, str, Callable[[RockingParameters], float]]]:
    """The parameters that a file of these structures holds."""
    return {**PARAMETERS, **EDGE_PARAMETERS} if any(s.sides for s in structures) else PARAMETERS


_FLOAT, _WHOLE, _TEXT = np.dtype("<f8"), np.dtype("<i8"), None

RECORDED: dict[str, tuple[np.dtype | None, str, str, Callable[[Recording], Any]]] = {
    "factor": (_FLOAT, "1", "factor that the record was multiplied by", lambda r: r.factor),
    "pga": (_FLOAT, "m s-2", "peak ground acceleration of the record, before its factor", lambda r: r.intensity.pga),
    "pga_time": (_FLOAT, "s", "time of the peak ground acceleration", lambda r: r.intensity.pga_time),
    "pgv": (_FLOAT, "m s-1", "peak ground velocity of the record, before its factor", lambda r: r.intensity.pgv),
    "pgd": (_FLOAT, "m", "peak ground displacement of the record, before its factor", lambda r: r.intensity.pgd),
    "arias": (_FLOAT, "m s-1", "Arias intensity of the record, before the square of its factor", lambda r: r.intensity.arias),
    "cav": (_FLOAT, "m s-1", "cumulative absolute velocity of the record, before its factor", lambda r: r.intensity.cav),
    "d5_75": (_FLOAT, "s", "duration from 5 to 75 % of the Arias intensity", lambda r: r.intensity.d5_75),
    "d5_95": (_FLOAT, "s", "duration from 5 to 95 % of the Arias intensity", lambda r: r.intensity.d5_95),
    "npts": (_WHOLE, "1", "number of samples", lambda r: r.record.npts),
    "dt": (_FLOAT, "s", "time between samples", lambda r: r.record.dt),
    "format": (_TEXT, "1", "format of the file", lambda r: r.record.format),
    "component": (_TEXT, "1", "component as the file calls it", lambda r: r.record.component or ""),
    "record_unit": (_TEXT, "1", "unit of the file's numbers", lambda r: r.record.unit),
    "sha256": (_TEXT, "1", "SHA-256 of the file", lambda r: r.record.sha256),
}
"""Of each record: type, units, long name, value."""


VARIED = "varied_"  # the names of what families varied begin so


class About(NamedTuple):
    """How a list of values stands in a file: its type, None for text, and what it says of itself."""

    dtype: np.dtype | None
    units: str
    long_name: str


ABOUT: dict[str, About] = {
    "structure": About(_TEXT, "1", "name of the structure"),
    "record": About(_TEXT, "1", "name of the record"),
    **{name: About(_FLOAT, UNITS[name], LONG_NAMES[name]) for name in UNITS},
    **{name: About(_FLOAT, units, long_name) for name, (units, long_name, _) in {**PARAMETERS, **EDGE_PARAMETERS}.items()},
    **{name: About(dtype, units, long_name) for name, (dtype, units, long_name, _) in RECORDED.items()},
    "tan_alpha": About(_FLOAT, "1", "tangent of the critical angle"),
}


class Form(NamedTuple):
    """A kind of spectrum: its dimensions in their order, and the dimension of everything that always stands beside them."""

    dimensions: tuple[str, str, str]
    beside: Mapping[str, str]


_OF_STRUCTURES = dict.fromkeys(PARAMETERS, "structure")
_OF_RECORDS = dict.fromkeys(RECORDED, "record")

FORMS = (
    *(Form(("structure", *pair), _OF_STRUCTURES) for pair in (("Omega", "A"), ("omega_g", "a_g"), ("omega_g", "A"))),
    *(Form(("record", "structure", column), {**_OF_STRUCTURES, **_OF_RECORDS}) for column in ("scale", "A", "a_g")),
    Form(("record", "alpha", "T"), {"eta": "alpha", "tan_alpha": "alpha", "p": "T", **_OF_RECORDS}),
)


def form_among(names: Iterable[str]) -> Form:
    """The form whose dimensions are all among these names of datasets. Raises ValueError where none or several are."""
    there = set(names)
    found = [form for form in FORMS if there >= set(form.dimensions) and (form.dimensions[0] == "record") == ("record" in there)]
    if len(found) != 1:
        raise ValueError("it has no axes Omega and A, or omega_g and a_g or A, or those of records")
    return found[0]


@dataclass(frozen=True, eq=False)
class Frame:
    """The places of a file's cells.

    dimensions: the values on each of the three, in their order; beside: what stands beside them, by name, with its dimension; units: of
    what ABOUT does not know, the varied keys of a family.
    """

    dimensions: Mapping[str, Values]
    beside: Mapping[str, tuple[str, Values]]
    units: Mapping[str, str] = field(default_factory=dict)

    def about(self, name: str) -> About:
        """How a list stands in the file."""
        return About(_FLOAT, self.units[name], f"{name.removeprefix(VARIED)} as it was varied") if name in self.units else ABOUT[name]

    @property
    def labels(self) -> tuple[str, ...]:
        """What tells the places apart besides their dimensions, as CF's attribute `coordinates` names it."""
        return tuple(self.beside) if self.of_records else tuple(self.units)

    @property
    def shape(self) -> tuple[int, int, int]:
        """How many places there are on each dimension."""
        first, second, third = (len(values) for values in self.dimensions.values())
        return first, second, third

    @property
    def of_records(self) -> bool:
        """Whether these are spectra of records."""
        return "record" in self.dimensions


def pulse_frame(structures: Sequence[RockingParameters], grid: Grid) -> Frame:
    """The places of structures over a grid of frequency and amplitude."""
    axes = {axis.name: axis.values for axis in (grid.frequency, grid.amplitude)}
    return Frame({"structure": [s.name for s in structures], **axes}, beside_structures(structures), varied_units(structures))


def beside_structures(structures: Sequence[RockingParameters]) -> dict[str, tuple[str, Values]]:
    """The parameters of structures, as they stand beside their dimension."""
    of_each: dict[str, Callable[[RockingParameters], float]] = {name: get for name, (_, _, get) in parameters_of(structures).items()}
    for name in varied_units(structures):
        of_each[name] = partial(_varied, name.removeprefix(VARIED))
    return {name: ("structure", np.array([get(s) for s in structures], dtype=_FLOAT)) for name, get in of_each.items()}


def varied_units(structures: Sequence[RockingParameters]) -> dict[str, str]:
    """The keys that families among these structures varied, as they stand in a file (varied_KEY), with the units of their values."""
    return {f"{VARIED}{key}": unit or "1" for s in structures for key, unit in s.details.get("varied_units", {}).items()}


def _varied(key: str, structure: RockingParameters) -> float:
    return float(structure.details.get("varied", {}).get(key, np.nan))


def beside_records(recordings: Sequence[Recording]) -> dict[str, tuple[str, Values]]:
    """What is known of records, as it stands beside their dimension."""
    found: dict[str, tuple[str, Values]] = {}
    for name, (dtype, _, _, get) in RECORDED.items():
        values = [get(r) for r in recordings]
        found[name] = ("record", values if dtype is None else np.array(values, dtype=dtype))
    return found
