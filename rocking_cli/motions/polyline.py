"""Motions of straight lines, as arrays: records, and points joined by straight lines.
All extremes are at points.
"""

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from ..arrays import Array
from ..errors import MotionError
from .blocks import largest
from .motion import Floor, Motion, Piece, upwards
from .segments import Samples, Segments, largest_from

# second difference over the largest s of three points on a line: the rounding of an
# interpolation
_STRAIGHT = 1e-13
# rounding of equal steps over the duration, and of joined lines over the largest s
_ROUNDING = 4e-16


class Polyline(Motion):
    """Straight lines over contiguous intervals of phase, s = constant + slope (phase -
    start). Raises MotionError if an interval is empty or a number is not finite.
    """

    start: Array  # phase at the start of each interval [rad], the first is 0, (n,)
    stop: Array  # phase at the end of each interval [rad], (n,)
    constant: Array  # s at the start of each interval [-], (n,)
    slope: Array  # [1/rad], (n,)
    _floor: Floor | None  # see `floor`

    def __init__(
        self,
        name: str,
        start: Array,
        stop: Array,
        constant: Array,
        slope: Array,
        acceleration: float | None = None,
        vertical: Motion | None = None,
        floor: Floor | None = None,
    ) -> None:
        arrays = {"start": start, "stop": stop, "constant": constant, "slope": slope}
        if not start.size:
            raise MotionError(
                f"motion {name!r}: no pieces; a motion needs at least one"
            )
        if not all(np.all(np.isfinite(x)) for x in arrays.values()):
            raise MotionError(f"motion {name!r}: holds a number that is not finite")
        if not np.all(stop > start):
            raise MotionError(
                f"motion {name!r}: an interval is empty or runs backwards"
            )
        for key, value in {
            "name": name,
            **arrays,
            "acceleration": acceleration,
            "vertical": vertical,
            "_floor": floor,
        }.items():
            object.__setattr__(self, key, value)

    @cached_property
    def pieces(self) -> Sequence[Piece]:
        """The intervals as pieces."""
        rows = zip(
            *(x.tolist() for x in (self.start, self.stop, self.constant, self.slope)),
            strict=True,
        )
        return tuple(
            Piece(start, stop, (), constant, slope)
            for start, stop, constant, slope in rows
        )

    @property
    def floor(self) -> Floor | None:
        """See `Motion.floor`."""
        return self._floor

    @property
    def ground_peak(self) -> float:
        """See `Motion.ground_peak`."""
        return self.largest if self.floor is None else self.floor.ground.largest

    @property
    def duration(self) -> float:
        """See `Motion.duration`."""
        return float(self.stop[-1])

    def value(self, phase: Array | float) -> Array:
        """See `Motion.value`."""
        phase = np.asarray(phase, dtype=float)
        i = self._at(phase)
        inside = (phase >= self.start[0]) & (phase < self.stop[-1])
        return np.where(
            inside, self.constant[i] + self.slope[i] * (phase - self.start[i]), 0.0
        )

    def _at(self, phase: Array) -> Array:
        """The index of the interval that holds each phase [rad], or of
        the nearest one.
        """
        return np.asarray(
            np.clip(
                np.searchsorted(self.start, phase, side="right") - 1,
                0,
                self.start.size - 1,
            )
        )

    def scaled(self, factor: float, name: str | None = None) -> "Polyline":
        """See `Motion.scaled`."""
        scaled_name, up = self._scaled_name(factor)
        return Polyline(
            name or scaled_name,
            self.start,
            self.stop,
            factor * self.constant,
            factor * self.slope,
            vertical=up,
            floor=self.floor
            and self.floor._replace(ground=self.floor.ground.scaled(factor)),
        )

    @property
    def marks(self) -> Array:
        """See `Motion.marks`."""
        return np.append(self.start, self.stop[-1])

    def on(self, marks: Array, vertical: Motion | None = None) -> "Polyline":
        """See `Motion.on`."""
        start, stop = marks[:-1], marks[1:]
        i = self._at(0.5 * (start + stop))
        moves = start < self.stop[-1]
        constant = np.where(
            moves, self.constant[i] + self.slope[i] * (start - self.start[i]), 0.0
        )
        slope = np.where(moves, self.slope[i], 0.0)
        name = self.name.removesuffix(upwards(vertical)) + upwards(vertical)
        return Polyline(
            name, start, stop, constant, slope, self.acceleration, vertical, self.floor
        )

    @cached_property
    def samples(self) -> Samples | None:
        """Step and samples; None if intervals are unequal beyond rounding or lines not
        joined, here or in the vertical motion.
        """
        if self.vertical is not None and self.vertical.samples is None:
            return None
        count, last, end = self.start.size, self.duration, self.segments.s_end
        apart = _ROUNDING * largest(self.constant)
        if (
            not largest(self.start - (last / count) * np.arange(count))
            <= _ROUNDING * last
        ):
            return None
        if not largest(end[:-1] - self.constant[1:]) <= apart:
            return None
        return Samples(last / count, np.append(self.constant, end[-1]))

    @cached_property
    def coarsest(self) -> "Polyline":
        """The same lines in the fewest equal intervals with a point at every kink,
        without interpolated samples.
        """
        if self.samples is None or self.vertical is not None:
            return self
        s = self.samples.values
        kinks = np.flatnonzero(
            np.abs(s[2:] - 2.0 * s[1:-1] + s[:-2]) > _STRAIGHT * largest(s)
        )
        spacing = int(np.gcd.reduce(np.append(kinks + 1, self.start.size)))
        if spacing == 1:
            return self
        start, stop = self.start[::spacing], self.stop[spacing - 1 :: spacing]
        return Polyline(
            self.name,
            start,
            stop,
            s[:-1:spacing],
            np.diff(s[::spacing]) / (stop - start),
            self.acceleration,
            floor=self.floor,
        )

    @cached_property
    def segments(self) -> Segments:
        """The monotone segments of the motion, one for each interval."""
        length, none = self.stop - self.start, np.zeros((0, self.start.size))
        end = self.constant + self.slope * length
        return Segments(
            start=self.start,
            length=length,
            s_start=self.constant,
            s_end=end,
            sin=none,
            cos=none,
            frequency=none,
            slope=self.slope,
            joins=np.broadcast_to(np.False_, end.size),
            later_max=largest_from(np.maximum(self.constant, end)),
            later_min=-largest_from(-np.minimum(self.constant, end)),
        )
