"""Sets of motions, and the measures of each motion."""

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ..documents.quantities import quantity_at
from ..documents.table import named_rows
from ..errors import DocumentError, UsageError, did_you_mean
from ..motions import Motion, pulse
from ..motions.biaxial import Upwards
from ..motions.intensity import Intensity, intensity_of_lines
from ..motions.intensity_measures import MEASURES, Measure, measure_of
from ..motions.recording import Recording
from ..structures.parameters import RockingParameters

# measures of records that are compared with MEASURES
SPECTRAL = ("SA(0.5)", "SA(1)", "SA(2)", "AvgSA(1)")


def compared(members: "Sequence[MotionMember]", own: Measure) -> Collection[Measure]:
    """Return the measures whose efficiency is compared: MEASURES and those of SPECTRAL,
    without those that a pulse among the members does not have, and `own`.
    """
    known = (*MEASURES.values(), *map(measure_of, SPECTRAL))
    if any(m.recording is None for m in members):
        known = tuple(m for m in known if m.of_record is None)
    return {m.name: m for m in (*known, own)}.values()


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
        positive, and for a measure of records of a pulse.
        """
        if measure.of_record is None:
            value = measure.value(self.intensity, structure)
        elif self.recording is None:
            raise UsageError(
                f"{self.label}: found {measure.name} of a pulse; expected a record, or"
                " another measure"
            )
        else:
            factor = abs(self.recording.factor) ** measure.power
            value = factor * measure.of_record(self.recording.record)
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
        scaled = replace(
            i,
            pga=f * i.pga,
            pgv=f * i.pgv,
            pgd=f * i.pgd,
            arias=f * f * i.arias,
            cav=f * i.cav,
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
        label = f"{motion.name} {a_g:.4g} m/s2 {omega / (2.0 * math.pi):.4g} Hz"
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
    [rad/s], by straight lines on each piece.
    """
    # 4096 lines a piece: measures to 1e-6
    phases = [np.linspace(piece.start, piece.stop, 4097) for piece in motion.pieces]
    pairs = zip(motion.pieces, phases, strict=True)
    a = a_g * np.concatenate([piece.value(phase) for piece, phase in pairs])
    t = np.concatenate(phases) / omega
    return intensity_of_lines(a, np.diff(t), t)
