"""Elastic spectra for the check by a code: that of a motion, of a file, and of a floor
(Circolare 7/2019, section C7.2.3).

A spectrum has `pga` [m/s2], `acceleration`, S_a [m/s2] at periods [s] of shape (n,),
and `demand`: the largest S_d [m] up to the secant period, since the stiffness falls to
the secant one.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

import numpy as np

from ..arrays import Array
from ..documents.files import named_after
from ..documents.quantities import quantity_at, split_quantity
from ..documents.table import Cell, rows_of
from ..documents.texts import text_at
from ..errors import DocumentError, UsageError, counted
from ..showing import Shown
from ..structures.building_modes import FloorMode
from .blocks import largest
from .motion import Motion
from .records.record import Record
from .response_spectra import DAMPING, acceleration_spectrum, displacement_spectrum

# of a pulse; their lines change S_d by less than 1e-5 of it, with a jump inside the
# pulse by 1e-3
_SAMPLES = 4000
_LEVELS = ("S_a", "Sa", "Se")  # headings of the accelerations of a file
# s, the longest first period of a file, whose S_a is the peak ground acceleration
_FIRST = 0.03
_A, _B = 0.8, 1.1  # ends of the plateau of a floor spectrum, over T_k (C7.2.6-8)


@dataclass(frozen=True)
class MotionSpectrum:
    """The spectrum of a motion of the site."""

    record: Record  # the motion in its own time

    @classmethod
    def of(cls, motion: Motion, amplitude: float, omega: float) -> Self:
        """Return the spectrum of the horizontal motion with amplitude a_g [m/s2] and
        frequency omega [rad/s].
        """
        if motion.samples is not None:
            dt, values = motion.samples.step / omega, motion.samples.values
        else:
            phase = np.linspace(
                0.0, motion.duration, max(_SAMPLES, 100 * len(motion.segments)) + 1
            )
            phase[-1] = np.nextafter(phase[-1], 0.0)
            dt, values = motion.duration / (phase.size - 1) / omega, motion.value(phase)
        return cls(
            Record(
                motion.name,
                "motion",
                None,
                dt,
                amplitude * values,
                None,
                "m/s2",
                motion.name,
                "",
            )
        )

    @property
    def pga(self) -> float:
        """The peak ground acceleration."""
        return largest(self.record.acceleration)

    def acceleration(self, periods: Array, damping: float) -> Array:
        """Return S_a [m/s2] at these periods."""
        return acceleration_spectrum(self.record, periods, damping)

    def demand(self, period: float, damping: float) -> float:
        """Return the largest S_d [m] at periods from 0.02 `period` to `period`."""
        periods = period * np.geomspace(0.02, 1.0, 100)
        for _ in range(3):  # then twice nine periods around the largest
            found = displacement_spectrum(self.record, periods, damping)
            i = int(found.argmax())
            periods = np.linspace(
                periods[max(0, i - 1)], periods[min(i + 1, periods.size - 1)], 9
            )
        return float(found[i])


@dataclass(frozen=True, eq=False, repr=False)
class SpectrumFile(Shown):
    """A design spectrum: S_a at 5 % damping, straight lines between its points.

    `read_spectrum` makes one of a CSV file, `code_check` takes it. For another damping
    S_a is multiplied by sqrt(10/(5 + xi)) from the largest S_a on, and stays as it is
    before, which is safe.

    Attributes
    ----------
    name: of the file
    periods: T of the points [s], rising, (n,)
    values: S_a at the points [m/s2], (n,)

    Examples
    --------
    >>> import numpy as np
    >>> periods, values = np.array([0.0, 0.5, 4.0]), np.array([2.0, 5.0, 1.0])
    >>> site = SpectrumFile("site", periods, values)
    >>> site.pga, f"{float(site.acceleration(np.array(0.25), 0.05)):.3f}"
    (2.0, '3.500')
    """

    name: str  # of the file
    periods: Array  # T of the points [s], rising, (n,)
    values: Array  # S_a at the points [m/s2], (n,)

    def _shown(self) -> dict[str, Any]:
        first, last = self.periods[0], self.periods[-1]
        return {
            "spectrum": self.name,
            "periods": f"{self.periods.size}: {first:.4g} to {last:.4g} s",
            "pga": self.pga,
            "largest S_a [m/s2]": float(self.values.max()),
        }

    def _rows(self) -> list[dict[str, float]]:
        pairs = zip(self.periods.tolist(), self.values.tolist(), strict=True)
        return [{"T": period, "s_a": value} for period, value in pairs]

    @property
    def pga(self) -> float:
        """S_a at the first period."""
        return float(self.values[0])

    def acceleration(self, periods: Array, damping: float) -> Array:
        """Return S_a at some periods.

        Parameters
        ----------
        periods
            T [s], of any shape
        damping
            ratio of critical damping [-]

        Returns
        -------
        array
            S_a [m/s2], in the shape of `periods`

        Raises
        ------
        UsageError
            for periods beyond the last one of the file
        """
        periods = np.asarray(periods)
        if np.max(periods) > self.periods[-1]:
            found = (
                f"`spectrum` {self.name}: found periods up to {self.periods[-1]:g} s"
            )
            raise UsageError(
                f"{found}; expected up to {np.max(periods):.4g} s, the longest period"
                " of the check"
            )
        factor = np.where(
            periods >= self.periods[self.values.argmax()], damping_factor(damping), 1.0
        )
        return np.asarray(np.interp(periods, self.periods, self.values) * factor)

    def demand(self, period: float, damping: float) -> float:
        """Return the largest displacement up to a period.

        Parameters
        ----------
        period
            T [s]
        damping
            ratio of critical damping [-]

        Returns
        -------
        float
            S_d [m], the largest at points of the file, at its top on a line between
            them, or at the period

        Raises
        ------
        UsageError
            for a period beyond the last one of the file
        """
        slope = np.diff(self.values) / np.diff(self.periods)
        # period at which a falling line would reach zero [s]
        tops = self.periods[:-1] - self.values[:-1] / np.where(
            slope < 0.0, slope, np.nan
        )
        periods = np.concatenate([self.periods, 2.0 / 3.0 * tops, [period]])
        periods = periods[periods <= period]
        return float(
            np.max(
                self.acceleration(periods, damping) * (periods / (2.0 * math.pi)) ** 2
            )
        )


@dataclass(frozen=True)
class FloorSpectrum:
    """The spectrum on a floor of a building."""

    ground: MotionSpectrum | SpectrumFile  # spectrum of the ground
    modes: Sequence[FloorMode]  # of the building

    @property
    def pga(self) -> float:
        """The peak acceleration of the floor."""
        return float(self.acceleration(np.zeros(1), DAMPING)[0])

    def acceleration(self, periods: Array, damping: float) -> Array:
        """Return S_eZ (C7.2.5-10): the root of the sum of squares over the modes."""
        squares = np.zeros(np.shape(periods))
        for mode in self.modes:
            own = float(
                self.ground.acceleration(np.array([mode.period]), mode.damping)[0]
            )
            a_z = (
                own
                * abs(mode.gamma_psi)
                * math.sqrt(1.0 + 0.0004 * (100.0 * mode.damping) ** 2)
            )
            gain = max(1.0, 1.1 / math.sqrt(mode.damping) * damping_factor(damping))
            r = np.asarray(periods) / mode.period
            away = np.where(
                r < _A,
                np.maximum(1.0 - r / _A, 0.0) ** 1.6,
                np.maximum(r / _B - 1.0, 0.0) ** 1.2,
            )
            squares += (gain * a_z / (1.0 + (gain - 1.0) * away)) ** 2
        return np.sqrt(squares)

    def demand(self, period: float, damping: float) -> float:
        """Return the displacement [m] at the period, at least the one at b T_1 with the
        acceleration at T_1 (C8.7.1.12).
        """
        first = max(mode.period for mode in self.modes)
        here, there = self.acceleration(np.array([period, first]), damping).tolist()
        least = there * (_B * first) ** 2 if period > _B * first else 0.0
        return max(here * period**2, least) / (4.0 * math.pi**2)


AnySpectrum = MotionSpectrum | SpectrumFile | FloorSpectrum


def damping_factor(damping: float) -> float:
    """eta = sqrt(10/(5 + xi)) >= 0.55, xi in %.

    >>> round(damping_factor(0.08), 4)
    0.8771
    """
    return max(0.55, math.sqrt(10.0 / (5.0 + 100.0 * damping)))


def read_spectrum(path: str | Path) -> SpectrumFile:
    """Return the design spectrum of a CSV file.

    Parameters
    ----------
    path
        the file, with columns T [s] and S_a (or Sa, Se), whose heading or cells state a
        unit; other columns are ignored

    Returns
    -------
    SpectrumFile

    Raises
    ------
    UsageError
        if the file cannot be read
    DocumentError
        for its faults, with file, line and column

    Examples
    --------
    >>> from pathlib import Path
    >>> rows = ["T,S_a [g]", "0,0.2", "0.5,0.5", "4,0.1"]
    >>> _ = Path("site.csv").write_text(chr(10).join(rows))
    >>> round(read_spectrum("site.csv").pga, 3)
    1.962
    """
    text = text_at(path)
    periods: list[float] = []
    values: list[float] = []
    for cells in rows_of(text):
        row = {cell.key: cell for cell in cells}
        levels = [row[key] for key in _LEVELS if key in row]
        if len(levels) > 1:
            raise DocumentError(
                f"{levels[1].place}: found both {levels[0].key} and {levels[1].key};"
                " expected one of them"
            )
        at, level = row.get("T"), next(iter(levels), None)
        if at is None or level is None:
            raise DocumentError(
                f"{cells[0].place}: found {', '.join(row)}; expected the columns T"
                " and S_a"
            )
        for cell, dimension, kept in (
            (at, "time", periods),
            (level, "acceleration", values),
        ):
            place = f"{cell.place}: {cell.key}"
            kept.append(quantity_at(place, cell.text, dimension, DocumentError))
        if periods[-1] < 0.0 or (len(periods) > 1 and not periods[-1] > periods[-2]):
            raise _fault(at, "periods that rise, of one spectrum")
        if (parts := split_quantity(level.text)) is not None and not parts[1]:
            raise _fault(
                level, f"{level.key} [g] or [m/s2] as heading", " without a unit"
            )
        if not values[-1] > 0.0:
            raise _fault(level, "a positive acceleration")
        if "damping" in row and row["damping"].text not in ("0.05", "5 %"):
            raise DocumentError(
                f"{row['damping'].place}: damping: found {row['damping'].text};"
                " expected 0.05"
            )
    if len(periods) < 2:
        raise DocumentError(
            f"{text.source}: found {counted(len(periods), 'point')} of a spectrum;"
            " expected two or more"
        )
    if periods[0] > _FIRST:
        wanted = (
            f"a first period up to {_FIRST:g} s, whose S_a is the peak ground"
            " acceleration"
        )
        raise DocumentError(
            f"{text.source}: found the first period {periods[0]:g} s; expected {wanted}"
        )
    return SpectrumFile(named_after(text.source), np.array(periods), np.array(values))


def _fault(cell: Cell, wanted: str, lacks: str = "") -> DocumentError:
    return DocumentError(
        f"{cell.place}: {cell.key}: found {cell.text!r}{lacks}; expected {wanted}"
    )
