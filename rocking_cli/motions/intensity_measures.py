"""The intensity measures by name. A new measure is one function, and one line in
MEASURES.

The function returns the measure in SI. It takes one of

- the `Intensity` of a motion (`of_motion`), for sets of pulses and of records;
- an `Intensity` and the RockingParameters (`of_structure`), if the measure also depends
  on the structure;
- a `Record` (`of_record`), for what no `Intensity` holds: sets of records only.

A measure is proportional to a power of the scale factor of the motion, and so every
measure but those `of_structure` also scales a record (`scale_to`).

An installed package adds a measure of records by an entry point: a module, or an
object, with DIMENSION (a word of `quantities.UNITS`), `value(record)`, and if it is not
proportional to the record its POWER. Entry points are read only for a name that is not
in MEASURES.

    [project.entry-points."rocking.measures"]
    CAV5 = "my_package.cav5"
"""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass
from operator import attrgetter
from typing import TYPE_CHECKING

import numpy as np

from ..documents.quantities import DEFAULT_GRAVITY, UNITS, si_unit
from ..errors import UsageError, did_you_mean
from ..plugins import blamed, installed
from .intensity import Intensity, intensity
from .records import Record
from .response_spectra import mean_acceleration, periods_of

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

    from ..structures.parameters import RockingParameters

GROUP = "rocking.measures"


@dataclass(frozen=True)
class Measure:
    """An intensity measure, by one of three functions that return it in SI. Raises
    ValueError for an unknown dimension, or a power that is not positive.
    """

    name: str  # as options and tables have it
    dimension: str  # a word of `quantities.UNITS`
    # from the intensity of a motion
    of_motion: Callable[[Intensity], float] | None = None
    # from the intensity of a motion and the structure
    of_structure: Callable[[Intensity, RockingParameters], float] | None = None
    # from a record; no pulse has such a measure
    of_record: Callable[[Record], float] | None = None
    power: float = 1.0  # the measure is proportional to factor**power [-]
    periods: tuple[float, ...] = ()  # of SA and AvgSA [s]

    def __post_init__(self) -> None:
        if self.dimension not in UNITS or not 0.0 < self.power < math.inf:
            raise ValueError(
                f"found the dimension {self.dimension!r} and the power {self.power!r};"
                f" expected one of {', '.join(UNITS)}, and a positive number"
            )

    @property
    def unit(self) -> str:
        """The SI unit of the values, an empty text for a plain number."""
        return si_unit(self.dimension)

    def in_words(self, value: float) -> str:
        """Return a value of the measure [SI] in words; accelerations are in g."""
        if self.dimension == "acceleration":
            return f"{value / DEFAULT_GRAVITY:.4g} g"
        return f"{value:.4g} {self.unit}".rstrip()

    def value(self, of: Intensity, structure: RockingParameters) -> float:
        """Return the measure [SI] of a motion, and of a structure if it depends on the
        structure; NaN for a measure of records.
        """
        if self.of_motion is not None:
            return self.of_motion(of)
        if self.of_structure is not None:
            return self.of_structure(of, structure)
        return math.nan

    def value_of_record(self, record: Record) -> float:
        """Return the measure [SI] of a record; NaN if it depends on a structure."""
        if self.of_record is not None:
            return self.of_record(record)
        if self.of_motion is not None:
            return self.of_motion(intensity(record))
        return math.nan


def normalised_pga(i: Intensity, s: RockingParameters) -> float:
    """Return PGA/(lambda g) [-]."""
    return i.pga / (s.uplift * s.gravity)


def normalised_pgv(i: Intensity, s: RockingParameters) -> float:
    """Return p PGV/(g tan alpha) [-]."""
    return s.p * i.pgv / (s.gravity * math.tan(s.alpha))


def normalised_pgd(i: Intensity, s: RockingParameters) -> float:
    """Return p^2 PGD/(g tan alpha) [-]."""
    return s.p**2 * i.pgd / (s.gravity * math.tan(s.alpha))


MEASURES = {
    m.name: m
    for m in (
        Measure("PGA", "acceleration", of_motion=attrgetter("pga")),
        Measure("PGV", "velocity", of_motion=attrgetter("pgv")),
        Measure("PGD", "length", of_motion=attrgetter("pgd")),
        Measure("Arias", "velocity", of_motion=attrgetter("arias"), power=2.0),
        Measure("CAV", "velocity", of_motion=attrgetter("cav")),
        Measure("nPGA", "number", of_structure=normalised_pga),
        Measure("nPGV", "number", of_structure=normalised_pgv),
        Measure("nPGD", "number", of_structure=normalised_pgd),
    )
}


def measure_of(name: str) -> Measure:
    """Return the measure of a name, for the argument `im`. Raises UsageError."""
    if (found := measure_named(name, "im")) is not None:
        return found
    words = (*MEASURES, *installed(GROUP))
    raise UsageError(
        f"`im`: found {name!r}; expected {', '.join(words)}, SA(T),"
        f" AvgSA(T){did_you_mean(name, words)}"
    )


def measure_named(name: str, argument: str) -> Measure | None:
    """Return the measure of a name: one of MEASURES or of an installed package, or
    SA(T), AvgSA(T1), AvgSA(T, T, ...) (see `periods_of`); None for another name.
    argument: the one that states the name, for errors. Raises UsageError.
    """
    if (spectral := periods_of(name)) is not None:
        word, periods = spectral
        return Measure(
            word,
            "acceleration",
            of_record=lambda record: mean_acceleration(record, periods),
            periods=tuple(periods.tolist()),
        )
    for word, measure in MEASURES.items():
        if word.casefold() == name.strip().casefold():
            return measure
    added = installed(GROUP)
    return _added(added[name], argument) if name in added else None


def _added(entry: EntryPoint, argument: str) -> Measure:
    """Return the measure of an installed package. Raises UsageError."""

    def told() -> AbstractContextManager[None]:
        return blamed(
            entry, lambda said: UsageError(f"`{argument}`: the measure {said}")
        )

    def of_record(record: Record) -> float:
        with told():
            number = value(record)
            if not isinstance(number, int | float | np.integer | np.floating):
                raise TypeError(f"value returns {type(number).__name__}, not a number")
        return float(number)

    with told():
        found = entry.load()
        value, power = found.value, float(getattr(found, "POWER", 1.0))
        return Measure(entry.name, found.DIMENSION, of_record=of_record, power=power)
