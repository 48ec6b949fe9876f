"""A motion of straight lines, kept in arrays: a record, or points joined by straight lines.

Its extremes are at its points, so each interval is one segment; that spares the objects and the search that other motions need.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import MotionError
from .blocks import blocks, largest
from .columns import Column, Computed, Instants, Levels, Then, followed_by, of_columns
from .motion import Motion, checked_scale
from .piece import Piece
from .segments import Samples, Segments, line_segments

if TYPE_CHECKING:
    from .records import Record

Array = np.ndarray
Lines = np.ndarray | Column

_STRAIGHT = 1e-13  # of the largest s: what three points may be off a line by the rounding of one who puts points between samples
_ARRAYS = 1 << 19  # intervals up to which a record has arrays: they take 65 bytes each, and narrow rounds two thirds of the time
_ROUNDING = 4e-16  # of the duration, and of the largest s: what equal steps and joined lines may differ by


class Polyline(Motion):
    """Straight lines over contiguous intervals of phase: s = constant + slope (phase - start), like so many pieces without harmonics.

    start, stop [rad], constant [-], slope [1/rad]: arrays of one shape (n,), start[0] = 0; a `Column` each of a long record. acceleration:
    the a_g [m/s2] that with omega_g = 1 rad/s gives the motion as it was recorded, None where it has no amplitude of its own.
    Raises MotionError when an interval is empty or a number is not finite.
    """

    start: Lines
    stop: Lines
    constant: Lines
    slope: Lines
    _acceleration: float | None

    def __init__(self, name: str, start: Lines, stop: Lines, constant: Lines, slope: Lines, acceleration: float | None = None) -> None:
        arrays = {"start": start, "stop": stop, "constant": constant, "slope": slope}
        if not start.size:
            raise MotionError(f"motion {name!r}: no pieces; a motion needs at least one")
        if not all(np.all(np.isfinite(x[part])) for x in arrays.values() for part in blocks(start.size)):
            raise MotionError(f"motion {name!r}: holds a number that is not finite")
        if not all(np.all(stop[part] > start[part]) for part in blocks(start.size)):
            raise MotionError(f"motion {name!r}: an interval is empty or runs backwards")
        for key, value in {"name": name, **arrays, "_acceleration": acceleration}.items():
            object.__setattr__(self, key, value)

    @property
    def acceleration(self) -> float | None:
        """The amplitude a_g [m/s2] that the motion has of its own, in its own time (omega_g = 1 rad/s); None where it has none."""
        return self._acceleration

    @cached_property
    def pieces(self) -> Sequence[Piece]:
        """The intervals as pieces, one by one: for what has no use for arrays; of a long record made where they are asked for."""
        found = _Pieces(self)
        return found if isinstance(self.start, Column) else tuple(found)

    @property
    def duration(self) -> float:
        """Phase at which shaking ends [rad]; the time is duration / omega_g."""
        return float(self.stop[-1])

    def value(self, phase: Array | float) -> Array:
        """s(phase) [-], any shape; right-hand values at jumps, zero outside the motion."""
        phase = np.asarray(phase, dtype=float)
        i = self._at(phase)
        inside = (phase >= self.start[0]) & (phase < self.stop[-1])
        return np.where(inside, self.constant[i] + self.slope[i] * (phase - self.start[i]), 0.0)

    def _at(self, phase: Array) -> Array:
        """The interval that holds each phase, or the nearest."""
        if isinstance(self.start, Instants):
            return self.start.begun(phase)
        if not isinstance(self.start, Column):
            return np.asarray(np.clip(np.searchsorted(self.start, phase, side="right") - 1, 0, self.start.size - 1))
        low, high = np.zeros(phase.shape, dtype=np.int64), np.full(phase.shape, self.start.size)
        for _ in range(self.start.size.bit_length()):
            middle = (low + high) >> 1
            begun = self.start[np.minimum(middle, self.start.size - 1)] <= phase
            begun &= middle < self.start.size
            low, high = np.where(begun, middle, low), np.where(begun, high, middle)
        return low

    def still_until(self, phase: float) -> Polyline:
        """The motion with the ground at rest after it, up to a phase [rad]."""
        lasts = {"start": self.duration, "stop": phase, "constant": 0.0, "slope": 0.0}
        columns = {key: followed_by(getattr(self, key), last) for key, last in lasts.items()}
        return Polyline(self.name, **columns, acceleration=self.acceleration)

    def scaled(self, factor: float) -> Polyline:
        """The motion times a factor, which may be negative. Raises MotionError for one that is zero or not finite."""
        name = f"{self.name}, times {checked_scale(self.name, factor):g}"
        return Polyline(name, self.start, self.stop, _times(factor, self.constant), _times(factor, self.slope))

    @property
    def marks(self) -> Lines:
        """Where an interval begins, and the end."""
        start = self.start
        return start.of(start.size + 1) if isinstance(start, Instants) else followed_by(start, self.stop[-1])

    def on(self, marks: Array | Instants | Levels) -> Polyline:
        """The same motion with an interval from each of these phases to the next, still after its end; they hold all of its own."""
        if isinstance(marks, (Instants, Levels)):
            return self._on(marks)
        start, stop = marks[:-1], marks[1:]
        i = self._at(0.5 * (start + stop))
        moves = start < self.stop[-1]
        constant = np.where(moves, self.constant[i] + self.slope[i] * (start - self.start[i]), 0.0)
        return Polyline(self.name, start, stop, constant, np.where(moves, self.slope[i], 0.0), self.acceleration)

    def _on(self, marks: Instants | Levels) -> Polyline:
        """The same, with columns."""
        count = marks.size - 1
        start, stop = marks.of(count), marks.of(count, 1)
        if isinstance(self.start, Instants) and isinstance(marks, Instants) and self.start.goes_on(marks):
            more = count - self.start.size
            constant, slope = (Then(x, 0.0, more) if more else x for x in (self.constant, self.slope))
            return Polyline(self.name, start, stop, constant, slope, self.acceleration)
        constant, slope = Computed(self._start_on, (start, stop)), Computed(self._slope_on, (start, stop))
        return Polyline(self.name, start, stop, constant, slope, self.acceleration)

    def _start_on(self, start: Array, stop: Array) -> Array:
        i = self._at(0.5 * (start + stop))
        return np.where(start < self.duration, self.constant[i] + self.slope[i] * (start - self.start[i]), 0.0)

    def _slope_on(self, start: Array, stop: Array) -> Array:
        return np.where(start < self.duration, self.slope[self._at(0.5 * (start + stop))], 0.0)

    def plus(self, other: Polyline, factor: float) -> Polyline:
        """This and `factor` times another motion over the same intervals."""
        constant, slope = (
            of_columns(partial(_plus, factor), a, b) for a, b in ((self.constant, other.constant), (self.slope, other.slope))
        )
        return Polyline(self.name, self.start, self.stop, constant, slope)

    @cached_property
    def samples(self) -> Samples | None:
        """Step and samples, where the intervals are equal to rounding and the lines joined."""
        count, last, end = self.start.size, self.duration, self.segments.s_end
        if isinstance(self.start, Instants) and isinstance(self.constant, Levels):
            return Samples(last / count, self.constant.of(count + 1, self.constant.first, self.constant.by))
        apart = _ROUNDING * max(largest(self.constant[part]) for part in blocks(count))
        for part in blocks(count):
            following = slice(part.start + 1, min(part.stop + 1, count))
            if not largest(self.start[part] - (last / count) * np.arange(part.start, part.stop)) <= _ROUNDING * last:
                return None
            if following.start < count and not largest(end[part][: following.stop - following.start] - self.constant[following]) <= apart:
                return None
        return Samples(last / count, followed_by(self.constant, end[-1]))

    @cached_property
    def coarsest(self) -> Polyline:
        """The same lines in the fewest equal intervals that hold all their kinks: a record that was sampled more finely afterwards."""
        if self.samples is None:
            return self
        s, every = self.samples.values, self.start.size
        straight = _STRAIGHT * max(largest(s[part]) for part in blocks(s.size))
        for part in blocks(s.size - 2):
            here = s[part.start : part.stop + 2]
            bends = np.flatnonzero(np.abs(here[2:] - 2.0 * here[1:-1] + here[:-2]) > straight)
            every = int(np.gcd.reduce(np.append(bends + (part.start + 1), every)))
            if every == 1:
                return self
        if every == 1:
            return self
        if isinstance(s, Levels):
            assert isinstance(self.start, Instants)
            return _even(self.name, self.start.step, every, s, self.acceleration)
        start, stop = self.start[::every], self.stop[every - 1 :: every]
        return Polyline(self.name, start, stop, s[:-1:every], np.diff(s[::every]) / (stop - start), self.acceleration)

    @cached_property
    def segments(self) -> Segments:
        """The monotone segments of the motion: its intervals, none of which is known to go on in the next."""
        return line_segments(self.start, self.stop, self.constant, self.slope)


class _Pieces(Sequence[Piece]):
    """The intervals of a motion, each made when it is asked for."""

    def __init__(self, motion: Polyline) -> None:
        self.columns = motion.start, motion.stop, motion.constant, motion.slope

    def __len__(self) -> int:
        return int(self.columns[0].size)

    def __iter__(self) -> Iterator[Piece]:
        for part in blocks(len(self)):
            for row in zip(*(x[part].tolist() for x in self.columns), strict=True):
                yield Piece(row[0], row[1], (), row[2], row[3])

    def __getitem__(self, i: Any) -> Any:
        if isinstance(i, slice):
            return tuple(self[j] for j in range(*i.indices(len(self))))
        start, stop, constant, slope = (float(x[i]) for x in self.columns)
        return Piece(start, stop, (), constant, slope)


def _times(factor: float, values: Lines) -> Lines:
    """A factor times each."""
    if isinstance(values, Levels):
        return values.times(factor)
    return of_columns(partial(np.multiply, factor), values)


def _plus(factor: float, a: Array, b: Array) -> Array:
    return np.asarray(a + factor * b)


def _rate(now: Array, then: Array, start: Array, stop: Array) -> Array:
    return np.asarray((then - now) / (stop - start))


def _even(name: str, step: float, by: int, levels: Levels, acceleration: float | None) -> Polyline:
    """Lines over every `by`-th of the levels that a motion has at equal steps."""
    count = (levels.size - 1) // by
    start, stop = Instants(count, step, 0, by), Instants(count, step, by, by)
    now, then = levels.of(count, 0, by), levels.of(count, by, by)
    return Polyline(name, start, stop, now, Computed(_rate, (now, then, start, stop)), acceleration)


def record_motion(record: Record, scale: float = 1.0, name: str = "") -> Polyline:
    """The motion of a record in its own time, times `scale`: phase = t in s, so omega_g = 1 rad/s; s is 1 at the larger peak.

    Its `acceleration` is then |scale| PGA; name: in place of the record's label. Raises MotionError for a record that is zero
    throughout, or a scale of zero.
    """
    peak = largest(record.acceleration)
    if not peak > 0.0:
        raise MotionError(f"motion {record.label!r}: zero throughout, accepted is one with an amplitude")
    factor = float(np.copysign(1.0, checked_scale(record.label, scale))) / peak
    if record.npts > _ARRAYS:
        return _even(
            name or record.label, record.dt, 1, Levels(record.npts, np.ascontiguousarray(record.acceleration), (factor,)), abs(scale) * peak
        )
    s = factor * record.acceleration
    time = record.dt * np.arange(record.npts)
    return Polyline(name or record.label, time[:-1], time[1:], s[:-1], np.diff(s) / np.diff(time), abs(scale) * peak)
