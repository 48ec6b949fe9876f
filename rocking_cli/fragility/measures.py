"""Intensity measures of fragility curves, and sets of motions.

A measure that depends on the structure is dimensionless: PGA/(lambda g), p PGV/(g tan
alpha), p^2 PGD/(g tan alpha). Each measure is proportional to a power of the scale
factor of a motion.

An installed package adds a measure of records by an entry point: a module, or an
object, with DIMENSION (a word of `quantities.UNITS`), `value(record)`, which returns it
for a Record in SI, and if it is not proportional to the record its POWER. Entry points
are read only for a name that is not in MEASURES.

    [project.entry-points."rocking.measures"]
    CAV5 = "my_package.cav5"
"""

import math
from collections.abc import Callable, Collection, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..documents.quantities import DEFAULT_GRAVITY, UNITS, quantity_at, si_unit
from ..documents.table import named_rows
from ..errors import DocumentError, UsageError, did_you_mean
from ..motions import Motion, pulse
from ..motions.biaxial import Upwards
from ..motions.intensity import Intensity
from ..motions.recording import Recording
from ..motions.records import Record
from ..motions.response_spectra import mean_acceleration, periods_of
from ..plugins import blamed, installed
from ..structures.parameters import RockingParameters

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

GROUP = "rocking.measures"

# of a motion and a structure
Evaluate = Callable[[Intensity, RockingParameters], float]
# measures of records that are compared with MEASURES
SPECTRAL = ("SA(0.5)", "SA(1)", "SA(2)", "AvgSA(1)")


@dataclass(frozen=True)
class Measure:
    """An intensity measure."""

    name: str  # as options and tables have it
    unit: str  # SI unit of its values, "" for a plain number
    dimension: str  # a word of `quantities.UNITS`
    evaluate: Evaluate  # returns it from the intensity of a motion and a structure
    power: float = 1.0  # the measure is proportional to factor**power [-]
    of_structure: bool = False  # True if it also depends on the structure
    periods: tuple[float, ...] = ()  # of SA and AvgSA [s]
    # returns it from a record, in place of `value`; None for a measure of this package
    of_record: Callable[[Record], float] | None = None

    def in_words(self, value: float) -> str:
        """Return a value of the measure [SI] in words; accelerations are in g."""
        if self.dimension == "acceleration":
            return f"{value / DEFAULT_GRAVITY:.4g} g"
        return f"{value:.4g} {self.unit}".rstrip()


def _tan(s: RockingParameters) -> float:
    return s.gravity * math.tan(s.alpha)


MEASURES = {
    m.name: m
    for m in (
        Measure("PGA", "m/s2", "acceleration", lambda i, s: i.pga),
        Measure("PGV", "m/s", "velocity", lambda i, s: i.pgv),
        Measure("PGD", "m", "length", lambda i, s: i.pgd),
        Measure("Arias", "m/s", "velocity", lambda i, s: i.arias, power=2.0),
        Measure("CAV", "m/s", "velocity", lambda i, s: i.cav),
        Measure(
            "nPGA",
            "",
            "number",
            lambda i, s: i.pga / (s.uplift * s.gravity),
            of_structure=True,
        ),
        Measure(
            "nPGV", "", "number", lambda i, s: s.p * i.pgv / _tan(s), of_structure=True
        ),
        Measure(
            "nPGD",
            "",
            "number",
            lambda i, s: s.p**2 * i.pgd / _tan(s),
            of_structure=True,
        ),
    )
}


def measure_of(name: str) -> Measure:
    """Return the measure of a name, one of MEASURES or SA(T), AvgSA(T1), AvgSA(T, T,
    ...) (see `periods_of`). Raises UsageError.
    """
    if (spectral := periods_of(name)) is not None:
        return Measure(
            spectral[0],
            "m/s2",
            "acceleration",
            lambda i, s: math.nan,
            periods=tuple(spectral[1].tolist()),
        )
    found = next(
        (m for key, m in MEASURES.items() if key.casefold() == name.strip().casefold()),
        None,
    )
    if found is not None:
        return found
    added = installed(GROUP)
    if name not in added:
        words = (*MEASURES, *added)
        raise UsageError(
            f"`im`: found {name!r}; expected {', '.join(words)}, SA(T),"
            f" AvgSA(T){did_you_mean(name, words)}"
        )
    return _added(added[name])


def _added(entry: "EntryPoint") -> Measure:
    """Return the measure of an installed package. Raises UsageError."""
    with _blamed(entry):
        found = entry.load()
        dimension, value = (getattr(found, key, None) for key in ("DIMENSION", "value"))
        power = getattr(found, "POWER", 1.0)
        if not (isinstance(dimension, str) and dimension in UNITS and callable(value)):
            raise TypeError(
                f"{entry.value} needs a DIMENSION ({', '.join(UNITS)}) and a function"
                " value(record)"
            )
        if not (isinstance(power, int | float) and 0.0 < power < math.inf):
            raise TypeError(f"its POWER is {power!r}, which is no positive number")

    def of_record(record: Record) -> float:
        with _blamed(entry):
            number = value(record)
            if not isinstance(number, int | float | np.floating):
                raise TypeError(f"value returns {type(number).__name__}, not a number")
        return float(number)

    return Measure(
        entry.name,
        si_unit(dimension),
        dimension,
        lambda i, s: math.nan,
        power=float(power),
        of_record=of_record,
    )


def _blamed(entry: "EntryPoint") -> AbstractContextManager[None]:
    return blamed(entry, lambda said: UsageError(f"`im`: the measure {said}"))


def compared(members: "Sequence[MotionMember]", own: Measure) -> Collection[Measure]:
    """Return the measures whose efficiency is compared: MEASURES, those of SPECTRAL if
    all members are records, and `own`.
    """
    spectral = (
        map(measure_of, SPECTRAL)
        if all(m.recording is not None for m in members)
        else ()
    )
    return {m.name: m for m in (*MEASURES.values(), *spectral, own)}.values()


@dataclass(frozen=True, eq=False)
class MotionMember:
    """A motion of a set: a pulse or a record."""

    label: str  # name of the record in the set
    acceleration: float  # peak [m/s2]
    omega: float  # circular frequency [rad/s], 1 for a record
    intensity: Intensity  # measures of the unscaled motion
    weight: float = 1.0  # in means over the set [-]
    pulse: Motion | None = None  # None for a record
    recording: Recording | None = None  # None for a pulse

    @property
    def motion(self) -> Motion:
        """The motion over its phase; that of a record is computed on request."""
        if self.pulse is not None:
            return self.pulse
        assert self.recording is not None
        return self.recording.motion

    def measured(self, measure: Measure, structure: RockingParameters) -> float:
        """Return the measure of the unscaled motion. Raises UsageError unless it is
        positive, and for SA, AvgSA or a measure of a package of a pulse.
        """
        of_record = measure.of_record
        if not measure.periods and of_record is None:
            value = measure.evaluate(self.intensity, structure)
        elif self.recording is None:
            raise UsageError(
                f"{self.label}: found {measure.name} of a pulse; expected a record, or"
                " another measure"
            )
        elif of_record is not None:
            factor = abs(self.recording.factor) ** measure.power
            value = factor * of_record(self.recording.record)
        else:
            value = abs(self.recording.factor) * mean_acceleration(
                self.recording.record, np.array(measure.periods)
            )
        if not (math.isfinite(value) and value > 0.0):
            raise UsageError(
                f"{self.label}: its {measure.name} is {value:g}; the motion must have a"
                " positive one"
            )
        return value


def shaken_upwards(
    members: Sequence[MotionMember], upwards: Upwards
) -> tuple[MotionMember, ...]:
    """Return the motions with a vertical motion added to each; the measures stay.
    Raises UsageError if one is a record and the other a pulse.
    """
    upwards(members[0].motion)  # the motions of records are computed later
    return tuple(
        (
            replace(m, pulse=upwards(m.motion))
            if m.recording is None
            else replace(m, recording=replace(m.recording, upwards=upwards))
        )
        for m in members
    )


def members_of(recordings: Sequence[Recording]) -> tuple[MotionMember, ...]:
    """Return the set of these records, with equal weights."""
    found = []
    for r in recordings:
        i, f = r.intensity, abs(r.factor)
        scaled = Intensity(
            f * i.pga,
            i.pga_time,
            f * i.pgv,
            f * i.pgd,
            f * f * i.arias,
            f * i.cav,
            i.d5_75,
            i.d5_95,
        )
        found.append(MotionMember(r.label, r.acceleration, 1.0, scaled, recording=r))
    return tuple(found)


def site_pulses(
    path: str | Path, factor: float | None = None
) -> tuple[MotionMember, ...]:
    """Read the pulses of a site: CSV with columns a_g, one of f_g, T_g, omega_g,
    optionally weight (default 1) and pulse (default sine).

    factor: of each pulse. Cells are numbers in SI, or with a unit; weights are scaled
    to a mean of 1. Raises UsageError for an unreadable file, DocumentError with file,
    line and column for its faults.
    """
    columns, rows = named_rows(path)
    frequencies = {"f_g": "frequency", "T_g": "time", "omega_g": "angular frequency"}
    known = ("a_g", *frequencies, "weight", "pulse")
    for name in columns:
        if name not in known:
            raise DocumentError(
                f"{path}, line 1: unknown column {name!r}; expected"
                f" {', '.join(known)}{did_you_mean(name, known)}"
            )
    given = [name for name in columns if name in frequencies]
    if "a_g" not in columns or len(given) != 1:
        found = ", ".join(columns) or "none"
        raise DocumentError(
            f"{path}, line 1: found the columns {found}; expected a_g and one of"
            f" {', '.join(frequencies)}"
        )
    members: list[MotionMember] = []
    for line, row in rows:
        stated = _positive(path, line, row, given[0], frequencies[given[0]])
        omega = (
            stated
            if given[0] == "omega_g"
            else 2.0 * math.pi * (stated if given[0] == "f_g" else 1.0 / stated)
        )
        a_g = _positive(path, line, row, "a_g", "acceleration")
        try:
            motion = pulse((row.get("pulse") or "sine").strip())
        except UsageError as error:
            raise DocumentError(f"{path}, line {line}: {error}") from None
        motion = motion if factor is None else motion.scaled(factor)
        weight = (
            _positive(path, line, row, "weight", "number")
            if "weight" in columns
            else 1.0
        )
        label = f"{motion.name}, {a_g:.4g} m/s2, {omega / (2.0 * math.pi):.4g} Hz"
        members.append(
            MotionMember(
                label,
                a_g * motion.largest,
                omega,
                pulse_intensity(motion, a_g, omega),
                weight,
                pulse=motion,
            )
        )
    if not members:
        raise DocumentError(f"{path}: holds no pulse")
    # Only the ratios of the weights count; their mean is 1.
    mean = sum(m.weight for m in members) / len(members)
    return tuple(replace(m, weight=m.weight / mean) for m in members)


def cell(
    path: str | Path, line: int, row: dict[str, str], column: str, dimension: str
) -> float:
    """Return the quantity that a cell of a table states. Raises DocumentError with
    file, line and column.
    """
    return quantity_at(
        f"{path}, line {line}: {column}",
        (row[column] or "").strip(),
        dimension,
        DocumentError,
    )


def _positive(
    path: str | Path, line: int, row: dict[str, str], column: str, dimension: str
) -> float:
    """Return a positive quantity [SI] of a row of a table. Raises DocumentError."""
    value = cell(path, line, row, column, dimension)
    if not value > 0.0:
        raise DocumentError(
            f"{path}, line {line}: {column}: found {row[column].strip()!r}; expected a"
            " positive number"
        )
    return value


def pulse_intensity(motion: Motion, a_g: float, omega: float) -> Intensity:
    """Return the measures of a pulse of amplitude a_g [m/s2] and frequency omega
    [rad/s], by the trapezium rule on each piece.
    """
    from scipy.integrate import cumulative_trapezoid

    # 4096 steps a piece: measures to 1e-6
    phases = [np.linspace(piece.start, piece.stop, 4097) for piece in motion.pieces]
    pairs = zip(motion.pieces, phases, strict=True)
    t = np.concatenate(phases) / omega
    a = a_g * np.concatenate([piece.value(phase) for piece, phase in pairs])
    v, energy, cav = (
        cumulative_trapezoid(y, t, initial=0.0) for y in (a, a * a, np.abs(a))
    )
    d = cumulative_trapezoid(v, t, initial=0.0)
    pga, pgv, pgd = (float(np.abs(y).max()) for y in (a, v, d))
    at_5, at_75, at_95 = np.interp(
        energy[-1] * np.array([0.05, 0.75, 0.95]), energy, t
    ).tolist()
    return Intensity(
        pga=pga,
        pga_time=float(t[int(np.abs(a).argmax())]),
        pgv=pgv,
        pgd=pgd,
        arias=math.pi / (2.0 * DEFAULT_GRAVITY) * float(energy[-1]),
        cav=float(cav[-1]),
        d5_75=at_75 - at_5,
        d5_95=at_95 - at_5,
    )
