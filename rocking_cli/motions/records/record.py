"""A record: samples of ground acceleration at equal steps of time, joined by straight
lines. The components of a file.
"""

import hashlib
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from typing import Any, NamedTuple, Self

import numpy as np

from ...documents.quantities import parse_whole
from ...errors import ArgumentError, DocumentError, MotionError, NoComponent, UsageError
from ...showing import Shown
from ..blocks import largest
from ..motion import checked_scale
from ..polyline import Polyline
from .directions import ACROSS, UNKNOWN, direction_of, is_vertical_name
from .guard import require_no_mark, unlike_ground, unusual
from .units import ACCELERATIONS, WRITTEN_UNITS, require_known

LARGEST = 1e6  # m/s2, beyond which no ground shakes
STEPS = (1e-7, 1e3)  # s, from the shortest to the longest
EVERY = "all"  # columns that follow each other: several values of one record on a line
PAIRS = "pairs"  # several times on a line, each with its value
HORIZONTAL, ALL, STATION = "horizontal", "all", "station"


class Given(NamedTuple):
    """What the user states of a file."""

    unit: str | None = None  # unit of acceleration
    dt: float | None = None  # time step [s]
    column: str | None = None  # number of a column from 1, EVERY or PAIRS
    skip: int = 0  # lines above, which are not read
    below: int = 0  # lines at the end, which are not read
    as_it_stands: bool = False  # True takes numbers that are unlike a ground motion
    named: bool = True  # False for a file of a directory

    @classmethod
    def of(cls, stated: Mapping[str, Any]) -> Self:
        """Return the fields that the keywords of a reader state; others are passed
        over. Raises UsageError for an unknown unit, column or number of lines.
        """
        said = {
            key: value
            for key in ("unit", "dt", "column", "skip", "as_it_stands")
            if (value := stated.get(key)) is not None
        }
        unit, column = said.get("unit"), said.get("column")
        if unit is not None:
            said["unit"] = require_known(unit)
            if said["unit"] is None:
                known = ", ".join(WRITTEN_UNITS)
                raise UsageError(f"`unit`: found {unit!r}; expected {known}")
        words = (None, EVERY, PAIRS)
        if column not in words and not re.fullmatch(r"[1-9]\d{0,4}", column):
            raise UsageError(
                f"`column`: found {column!r}; expected a number from 1, {EVERY} or"
                f" {PAIRS}"
            )
        lines = re.fullmatch(r"\s*(\d+)(?::(\d+))?\s*", str(said.pop("skip", 0)))
        if lines is None:
            raise UsageError(
                f"`skip`: found {stated['skip']}; expected a number from 0, or two as"
                " 4:60, of lines above and below"
            )
        return cls(**said, skip=int(lines[1]), below=int(lines[2] or 0))


class Series(NamedTuple):
    """One component as the reader of a format finds it."""

    component: str | None  # as the file calls it, None without a name
    dt: float  # time step [s]
    samples: np.ndarray  # in the unit of the file, (npts,)
    unit: str  # unit of the samples
    pga: str | None = None  # PGA of the header, as printed there
    remark: str = ""  # a sentence for the user, "" without one


def require_series(read: object) -> None:
    """Raise TypeError unless the reader of a format returned a list of Series with
    samples in a known unit.
    """
    fits = isinstance(read, list) and all(
        isinstance(one, Series)
        and one.unit in ACCELERATIONS
        and one.samples.dtype.kind in "fi"
        for one in read
    )
    if not (fits and read):
        raise TypeError(
            f"read returns {read!r:.60}; expected a list of Series, one or more, with"
            f" real numbers in {', '.join(WRITTEN_UNITS)}"
        )


@dataclass(frozen=True, eq=False, repr=False)
class Record(Shown):
    """One component of a ground motion as recorded.

    `read_record` makes one of a file, `Record.of` one of an array. `motion` is its
    motion, `npts` and `duration` its length, `intensity` measures it. Raises
    DocumentError for fewer than two samples, for one that is not finite or beyond 1e6
    m/s2, and for dt outside 1e-7 to 1000 s.

    Attributes
    ----------
    name: of the file
    format: of the file
    component: as the file calls it, None without a name
    dt: time step [s]
    acceleration: [m/s2], (npts,)
    header_pga: PGA that the header states [m/s2], None without one
    unit: of the file
    source: the file, for messages
    sha256: of the file
    remarks: sentences for the user
    fault: why its numbers are no ground motion, "" for most; `pick` refuses such a one

    Examples
    --------
    >>> record = read_record("configs/motions/synthetic.at2")
    >>> record.npts, record.dt, record.duration, record.unit
    (1600, 0.01, 15.99, 'g')
    >>> f"{abs(record.acceleration).max():.4f} m/s2"
    '3.9240 m/s2'
    """

    name: str  # of the file
    format: str  # of the file
    component: str | None  # as the file calls it, None without a name
    dt: float  # time step [s]
    acceleration: np.ndarray  # [m/s2], (npts,)
    header_pga: float | None  # PGA that the header states [m/s2], None without one
    unit: str  # of the file
    source: str  # the file, for messages
    sha256: str  # of the file
    remarks: tuple[str, ...] = ()  # sentences for the user
    fault: str = ""  # why it is no ground motion and is not taken, "" for most

    @classmethod
    def of(
        cls,
        acceleration: Sequence[float] | np.ndarray,
        dt: float,
        name: str = "record",
    ) -> Self:
        """Return the record of an array.

        Parameters
        ----------
        acceleration
            samples at equal steps [m/s2], (npts,)
        dt
            time step [s]
        name
            for tables and messages

        Returns
        -------
        Record

        Raises
        ------
        ArgumentError
            for what is no list of numbers, and a step that is no number
        DocumentError
            for fewer than two samples, one that is not finite or beyond 1e6 m/s2, and
            a step outside 1e-7 to 1000 s

        Examples
        --------
        >>> import numpy as np
        >>> record = Record.of(3.0 * np.sin(0.1 * np.arange(200)), dt=0.02)
        >>> check("block:0.5x2", record, a_max=None).outcome.flag
        'rocked'
        """
        try:
            samples, step = np.array(acceleration, dtype=float), float(dt)
        except (TypeError, ValueError) as error:
            raise ArgumentError(
                f"{name}: {error}; expected samples in m/s2 and a step in s"
            ) from None
        if samples.ndim != 1:
            raise ArgumentError(
                f"{name}: `acceleration`: found an array of the shape {samples.shape};"
                " expected one of one dimension, samples in m/s2"
            )
        digest = hashlib.sha256(samples.tobytes()).hexdigest()
        return cls(name, "array", None, step, samples, None, "m/s2", name, digest)

    def __post_init__(self) -> None:
        if not STEPS[0] <= self.dt <= STEPS[1]:
            raise DocumentError(
                f"{self.source}: a time step of {self.dt:g} s; expected a step from"
                f" {STEPS[0]:g} to {STEPS[1]:g} s"
            )
        if self.acceleration.ndim != 1 or self.acceleration.size < 2:
            raise DocumentError(
                f"{self.source}: {self.acceleration.size} samples; a record has at"
                " least two"
            )
        if not largest(self.acceleration) <= LARGEST:
            raise DocumentError(
                f"{self.source}: an acceleration that is not finite or beyond"
                f" {LARGEST:g} m/s2"
            )
        self.acceleration.flags.writeable = False

    def _shown(self) -> dict[str, Any]:
        return {
            "record": self.label,
            "format": self.format,
            "npts": self.npts,
            "dt": self.dt,
            "duration": self.duration,
            "pga": largest(self.acceleration),
            "file_unit": self.unit,
        }

    def _rows(self) -> list[dict[str, float]]:
        times = self.dt * np.arange(self.npts)
        return [
            {"t": t, "acceleration": a}
            for t, a in zip(times.tolist(), self.acceleration.tolist(), strict=True)
        ]

    @property
    def npts(self) -> int:
        """Number of samples."""
        return int(self.acceleration.size)

    @property
    def duration(self) -> float:
        """Time from the first sample to the last [s]."""
        return (self.npts - 1) * self.dt

    @property
    def motion(self) -> Polyline:
        """The motion as recorded, in its own time (omega_g = 1 rad/s)."""
        return record_motion(self)

    @property
    def label(self) -> str:
        """The name with the component."""
        return self.name if self.component is None else f"{self.name} {self.component}"


def record_motion(record: Record, scale: float = 1.0, name: str = "") -> Polyline:
    """Return the motion of a record in its own time, omega_g = 1 rad/s, max |s| = 1,
    `acceleration` = |scale| PGA [m/s2]; name: by default the label. Raises MotionError
    if all samples are zero, or for the scale.
    """
    pga = largest(record.acceleration)
    if not pga > 0.0:
        raise MotionError(
            f"motion {record.label!r}: zero throughout; the motion must have a non-zero"
            " value"
        )
    factor = float(np.copysign(1.0, checked_scale(record.label, scale))) / pga
    s = factor * record.acceleration
    time = record.dt * np.arange(record.npts)
    return Polyline(
        name or record.label,
        time[:-1],
        time[1:],
        s[:-1],
        np.diff(s) / np.diff(time),
        abs(scale) * pga,
    )


def record_of(
    series: Series,
    name: str,
    format_: str,
    source: str,
    sha256: str,
    as_it_stands: bool = False,
) -> Record:
    """Return the record of a series, with what its header and its numbers give cause to
    tell; as_it_stands: take numbers that are unlike a ground motion. Raises
    DocumentError.
    """
    factor = ACCELERATIONS[series.unit]
    with np.errstate(over="ignore"):  # the record refuses infinite values
        acceleration = series.samples * factor
    require_no_mark(series.samples, source)
    where = "" if series.component is None else f"component {series.component}: "
    told, header = unusual(acceleration, series.dt, series.unit, series.pga), None
    if series.pga is not None:
        stated, peak = abs(float(series.pga)), largest(acceleration) / factor
        header = stated * factor
        half_a_digit = 0.5 * 10.0 ** float(Decimal(series.pga).as_tuple().exponent)
        if abs(peak - stated) > max(0.01 * stated, half_a_digit):
            told.append(
                f"the header states a PGA of {stated:g} {series.unit}, the samples have"
                f" {peak:.6g} {series.unit}"
            )
    if direction_of(series.component or "N") == UNKNOWN and format_ != "K-NET":
        told.append("no direction is known, so that `component` alone takes it")
    fault = unlike_ground(acceleration)
    if fault and as_it_stands:
        told, fault = [*told, fault], ""
    return Record(
        name,
        format_,
        series.component,
        series.dt,
        acceleration,
        header,
        series.unit,
        source,
        sha256,
        tuple(x for x in (series.remark, *(where + x for x in told)) if x),
        fault
        and f"{source}: {where}{fault}; expected an acceleration of the ground, about"
        " zero, or `as_it_stands`",
    )


def is_vertical(record: Record) -> bool:
    """True if the component is vertical by its name, such as Up, U-D, Vert, HNZ or, in
    KiK-net, 3 and 6.
    """
    name = record.component or ""
    if record.format == "K-NET" and name.isdecimal():  # of two instruments
        return name in ("3", "6")
    return is_vertical_name(name)


def is_horizontal(record: Record) -> bool:
    """True if the component is horizontal by its name, or has no name."""
    name = record.component
    known = name is None or direction_of(name) == ACROSS
    return known or (record.format == "K-NET" and not is_vertical(record))


def accepted(records: list[Record]) -> list[Record]:
    """Return the records. Raises DocumentError for one that is no ground motion."""
    for record in records:
        if record.fault:
            raise DocumentError(record.fault)
    return records


def pick(records: Sequence[Record], component: str | None) -> Record:
    """Return the record of a component, given by its name or its number from 1; None:
    the only component. Raises UsageError.
    """
    found = list(records) if component is None else chosen(records, component)
    if len(found) == 1:
        return accepted(found)[0]
    raise UsageError(
        f"{records[0].source}: holds the components {names_of(found or records)}; give"
        " one as component"
    )


def chosen(records: Sequence[Record], component: str | None) -> list[Record]:
    """Return the records `horizontal`, `all`, or one by name or number from 1; None:
    the horizontal ones of a station. Raises NoComponent for an unknown name, and
    UsageError for None if more than two are horizontal.
    """
    source = records[0].source
    word = None if component is None else component.strip().casefold()
    if word == ALL:
        return accepted(list(records))
    if word in (None, HORIZONTAL):
        found = [r for r in records if is_horizontal(r)]
        if word is None and len(found) > 2:  # a file of a building or an array
            raise UsageError(
                f"{source}: holds the components {names_of(records)}; give one as"
                f" component, or {HORIZONTAL} for all of those"
            )
        return accepted(found)
    for record in records:
        if (record.component or "").casefold() == word != "":
            return accepted([record])
    if (number := parse_whole(word or "")) and number <= len(records):
        return accepted([records[number - 1]])
    known = (
        names_of(records)
        if records[0].component is not None
        else "1, the only one, which has no name"
    )
    raise NoComponent(
        f"{source}: component: found {component!r}; expected {known}, {HORIZONTAL} and"
        f" {ALL}"
    )


def vertical_of(records: Sequence[Record]) -> Record:
    """Return the one vertical component of a file. Raises UsageError if it has none or
    several.
    """
    found = [r for r in records if is_vertical(r)]
    if len(found) != 1:
        held = (
            f"{len(found)} vertical components ({names_of(found)})"
            if found
            else f"no vertical component, only {names_of(records)}"
        )
        raise UsageError(
            f"{records[0].source}: holds {held}; expected one where `vertical` is"
            f" {STATION}"
        )
    return accepted(found)[0]


def names_of(records: Sequence[Record]) -> str:
    return ", ".join(r.component or "one without a name" for r in records)
