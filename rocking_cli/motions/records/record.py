"""A record: samples of ground acceleration at equal steps of time, joined by straight lines."""

from __future__ import annotations

from dataclasses import dataclass
from decimal import Decimal
from typing import NamedTuple

import numpy as np

from ...documents.quantities import DEFAULT_GRAVITY, UNITS
from ...errors import DocumentError
from ..blocks import largest

LARGEST = 1e6  # m/s2, beyond which no ground shakes
STEPS = (1e-7, 1e3)  # s, from the shortest to the longest
WRITTEN_UNITS = ("g", "gal", "cm/s2", "m/s2", "mm/s2")
_PEAKS = (0.002, 5.0)  # g; the largest recorded is about 4 g. A record in gal that is read as g lies above, one in g read as gal below
_PEAK_AGREES = 0.01  # part of a header's peak by which the samples' own may differ without a word


class Series(NamedTuple):
    """One component as a format's reader finds it: samples in the file's unit, and the header's peak as printed."""

    component: str | None
    dt: float
    samples: np.ndarray
    unit: str
    peak: str | None = None
    remark: str = ""


@dataclass(frozen=True, eq=False)
class Record:
    """One component of a ground motion as recorded.

    name: of the file, without its extension; format: as `rocking records` prints it; component: as the file calls it, or None;
    dt [s]; acceleration [m/s2], shape (npts,); header_pga [m/s2]: the peak that the file's header states; unit: of the file;
    source: path; sha256: of the file. Raises DocumentError if there are fewer than two samples, if one is not finite or beyond
    1e6 m/s2, or if dt is not from 1e-7 to 1000 s.
    """

    name: str
    format: str
    component: str | None
    dt: float
    acceleration: np.ndarray
    header_pga: float | None
    unit: str
    source: str
    sha256: str
    remarks: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if not STEPS[0] <= self.dt <= STEPS[1]:
            raise DocumentError(f"{self.source}: a time step of {self.dt:g} s; expected a step from {STEPS[0]:g} to {STEPS[1]:g} s")
        if self.acceleration.ndim != 1 or self.acceleration.size < 2:
            raise DocumentError(f"{self.source}: {self.acceleration.size} samples; a record has at least two")
        if not largest(self.acceleration) <= LARGEST:
            raise DocumentError(f"{self.source}: an acceleration that is not finite or beyond {LARGEST:g} m/s2")
        self.acceleration.flags.writeable = False

    @property
    def npts(self) -> int:
        """Number of samples."""
        return int(self.acceleration.size)

    @property
    def duration(self) -> float:
        """Time from the first sample to the last [s]."""
        return (self.npts - 1) * self.dt

    @property
    def label(self) -> str:
        """The name with the component."""
        return self.name if self.component is None else f"{self.name} {self.component}"


def unit_of(word: str) -> str | None:
    """The unit of acceleration that a file writes as cm/sec/sec, CM/S^2 or gals; None for any other word, such as cm/sec."""
    plain = word.strip(" .").lower().replace("sec", "s").replace("**", "").replace("^", "").replace("/s/s", "/s2").replace("gals", "gal")
    return plain if plain in WRITTEN_UNITS else None


def record_of(series: Series, name: str, format_: str, source: str, sha256: str) -> Record:
    """The record of a series in SI units. A remark says if the peak contradicts the header or the unit. Raises DocumentError."""
    factor = UNITS["acceleration"][series.unit]
    with np.errstate(over="ignore"):  # the record refuses infinite values
        acceleration = series.samples * factor
    remarks = [series.remark] if series.remark else []
    where = "" if series.component is None else f" of component {series.component}"
    peak, header = largest(acceleration), None
    small = series.peak is None and series.unit != "g" and 0.0 < peak < _PEAKS[0] * DEFAULT_GRAVITY  # no unit is larger than g
    if peak > _PEAKS[1] * DEFAULT_GRAVITY or small:
        remarks.append(f"a peak{where} of {peak / DEFAULT_GRAVITY:.3g} g, where the unit is taken to be {series.unit}")
    if series.peak is not None:
        stated, found = abs(float(series.peak)), peak / factor
        header = stated * factor
        half_a_digit = 0.5 * 10.0 ** float(Decimal(series.peak).as_tuple().exponent)
        if abs(found - stated) > max(_PEAK_AGREES * stated, half_a_digit):
            remarks.append(f"the header states a peak{where} of {stated:g} {series.unit}, the samples have {found:.6g} {series.unit}")
    return Record(name, format_, series.component, series.dt, acceleration, header, series.unit, source, sha256, tuple(remarks))
