"""A motion: ground acceleration over its amplitude a_g, as exact pieces over the phase
phi = omega_g t, so that one serves every frequency.

`Segments` cuts the pieces at the extremes of s: on a segment s is monotone, and so the
engine can prove where roots are.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from ..errors import MotionError
from ..showing import Shown
from .segments import Samples, Segments, largest_from
from .sinusoids import isolated_extremes

LARGEST_SCALE = 1e100  # larger amplitudes may overflow
# the name of a motion times a factor, and the floor that it moves
_TIMES = re.compile(
    r"(?P<name>.+) times (?P<factor>-?[0-9.]+(?:e[-+]?[0-9]+)?)(?P<floor> on floor .+)?"
)


class Floor(NamedTuple):
    """What the motion of a floor is made of."""

    # what its straight lines miss at most, over its largest acceleration [-]
    chord: float
    ground: Motion  # motion of the ground, over the same a_g
    omega: float  # frequency of the ground's motion [rad/s], 1 of a record


@dataclass(frozen=True)
class Harmonic:
    """A sinusoid C sin(w phi + f)."""

    amplitude: float  # C [-]
    frequency: float = 1.0  # w [multiples of omega_g]
    phase: float = 0.0  # f [rad]


@dataclass(frozen=True)
class Piece:
    """One piece of a motion between two phases."""

    start: float  # phase at its start [rad]
    stop: float  # phase at its end [rad]
    harmonics: tuple[Harmonic, ...] = ()  # its sinusoids, which are added
    constant: float = 0.0  # c0 [-]
    slope: float = 0.0  # c1 [1/rad]

    def value(self, phase: np.ndarray | float) -> np.ndarray:
        """Return s(phase) [-], in the shape of `phase`."""
        phase = np.asarray(phase, dtype=float)
        total = self.constant + self.slope * (phase - self.start)
        for h in self.harmonics:
            total = total + h.amplitude * np.sin(h.frequency * phase + h.phase)
        return np.asarray(total)

    def scaled(self, factor: float) -> Piece:
        """Return the piece times a factor."""
        harmonics = tuple(
            replace(h, amplitude=factor * h.amplitude) for h in self.harmonics
        )
        return Piece(
            self.start,
            self.stop,
            harmonics,
            factor * self.constant,
            factor * self.slope,
        )


def plus(a: Piece, b: Piece) -> Piece:
    """Return the sum of two pieces; sinusoids of equal frequency become one."""
    waves: dict[float, complex] = {}
    for h in (*a.harmonics, *b.harmonics):
        waves[h.frequency] = waves.get(h.frequency, 0.0) + h.amplitude * np.exp(
            1j * h.phase
        )
    harmonics = tuple(
        Harmonic(float(abs(c)), w, float(np.angle(c))) for w, c in waves.items()
    )
    return Piece(a.start, a.stop, harmonics, a.constant + b.constant, a.slope + b.slope)


@dataclass(frozen=True, eq=False, repr=False)
class Motion(Shown):
    """A ground motion as exact pieces; the ground acceleration is a_g s(phi), phi =
    omega_g t.

    `sine`, `cosine`, `pulse` and `read_motion` make one; a record has one in its own
    time (`Record.motion`). `value` evaluates s, `largest` is max |s|, `duration` the
    phase at which the shaking ends, and `scaled` returns the motion times a factor.
    Raises MotionError if there is no piece, if pieces overlap or leave a gap, or if a
    number is not finite.

    Attributes
    ----------
    pieces: contiguous, the first one from phase 0
    vertical: vertical motion on the same pieces, over the same a_g, positive upwards
    acceleration: a_g of a record [m/s2], which has omega_g = 1 rad/s; else None

    Examples
    --------
    >>> motion = sine()
    >>> motion.value([0.5, 2.0]).round(6).tolist()
    [0.479426, 0.909297]
    >>> round(motion.duration, 6), motion.largest
    (6.283185, 1.0)
    """

    name: str  # as messages and files call the motion
    pieces: Sequence[Piece]  # contiguous, the first one from phase 0
    # vertical motion on the same pieces, over the same a_g, positive upwards
    vertical: Motion | None = None
    # a_g of a record [m/s2], which has omega_g = 1 rad/s; else None
    acceleration: float | None = None

    def _shown(self) -> dict[str, Any]:
        found: dict[str, Any] = {"motion": self.name}
        if self.acceleration is None:
            found["periods"] = self.duration / (2.0 * np.pi)
        else:  # in its own time
            pga = self.acceleration * self.largest
            found |= {"duration": self.duration, "pga": pga}
        if self.vertical is not None:
            found["vertical"] = "with a vertical motion"
        return found

    @property
    def samples(self) -> Samples | None:
        """The samples of straight lines at equal steps; None for any other motion."""
        return None

    @property
    def coarsest(self) -> Motion:
        """The same motion with consecutive intervals of the same line joined."""
        return self

    def __post_init__(self) -> None:
        if not self.pieces:
            raise MotionError(
                f"motion {self.name!r}: no pieces; a motion needs at least one"
            )
        at = 0.0
        for i, piece in enumerate(self.pieces):
            waves = [
                x for h in piece.harmonics for x in (h.amplitude, h.frequency, h.phase)
            ]
            found = ""
            if not np.all(
                np.isfinite(
                    [piece.start, piece.stop, piece.constant, piece.slope, *waves]
                )
            ):
                found = "holds a number that is not finite"
            elif any(h.frequency <= 0.0 for h in piece.harmonics):
                found = "has a frequency that is not positive"
            elif abs(piece.start - at) > 1e-12 * max(1.0, at):
                found = (
                    f"begins at {piece.start:g} rad, expected {at:g}: pieces must"
                    " follow one another without gap or overlap"
                )
            elif not piece.stop > piece.start:
                found = "is empty or runs backwards"
            if found:
                raise MotionError(f"motion {self.name!r}: piece {i + 1} {found}")
            at = piece.stop

    @property
    def duration(self) -> float:
        """Phase at which the shaking ends [rad]; the time is duration / omega_g."""
        return self.pieces[-1].stop

    def still_until(self, phase: float) -> Motion:
        """Return the motion followed by the ground at rest.

        Parameters
        ----------
        phase
            phase at which the rest ends [rad]

        Returns
        -------
        Motion
        """
        up = None if self.vertical is None else self.vertical.still_until(phase)
        return self.on(np.append(self.marks, phase), up)

    @property
    def marks(self) -> np.ndarray:
        """The starts of the pieces and the end of the last one [rad], shape
        (n + 1,).
        """
        return np.array([0.0, *(p.stop for p in self.pieces)])

    def on(self, marks: np.ndarray, vertical: Motion | None = None) -> Motion:
        """Return the motion on finer pieces, at rest after its end.

        Parameters
        ----------
        marks
            the ends of all pieces [rad], (n + 1,), which include the marks of the
            motion
        vertical
            a vertical motion on the same pieces, None without one

        Returns
        -------
        Motion
            with n pieces
        """
        pieces = []
        for start, stop in pairwise(marks.tolist()):
            middle = 0.5 * (start + stop)
            piece = next(
                (p for p in self.pieces if p.start <= middle < p.stop),
                Piece(start, stop),
            )
            pieces.append(
                replace(
                    piece,
                    start=start,
                    stop=stop,
                    constant=piece.constant + piece.slope * (start - piece.start),
                )
            )
        return Motion(
            self.name.removesuffix(upwards(vertical)) + upwards(vertical),
            tuple(pieces),
            vertical,
        )

    def scaled(self, factor: float, name: str | None = None) -> Motion:
        """Return the motion times a factor, and its vertical motion times |factor|.

        Parameters
        ----------
        factor
            [-], may be negative, not zero
        name
            of the new motion; by default with the factor

        Returns
        -------
        Motion

        Raises
        ------
        MotionError
            for a factor of zero, or one that is not finite or above 1e100
        """
        scaled_name, up = self._scaled_name(factor)
        return Motion(
            name or scaled_name, tuple(p.scaled(factor) for p in self.pieces), up
        )

    def _scaled_name(self, factor: float) -> tuple[str, Motion | None]:
        """Return the name and the vertical part of this motion times a factor. The
        vertical part keeps its sign.
        """
        own = self.name.removesuffix(upwards(self.vertical))
        words, before = f" times {checked_scale(own, factor):g}", _TIMES.fullmatch(own)
        # the opposite direction of "times 2" is "times -2", that of "times -1" the name
        if before is not None and -1.0 in (factor, float(before["factor"])):
            own, total = before["name"], factor * float(before["factor"])
            words = "" if total == 1.0 else f" times {total:g}"
            words += before["floor"] or ""
        up = (
            self.vertical
            if self.vertical is None or abs(factor) == 1.0
            else self.vertical.scaled(abs(factor))
        )
        return own + words + upwards(up), up

    @property
    def largest(self) -> float:
        """max |s| over the motion."""
        return float(max(self.segments.later_max[0], -self.segments.later_min[0]))

    @property
    def floor(self) -> Floor | None:
        """What the motion of a floor of a building is made of; None for the ground."""
        return None

    @property
    def ground_peak(self) -> float:
        """max |s| of the ground: `largest`, but of the motion of a floor that of the
        ground below its building.
        """
        return self.largest

    def value(self, phase: np.ndarray | float) -> np.ndarray:
        """Return s at some phases; at a jump the value after it, outside the motion
        zero.

        Parameters
        ----------
        phase
            phi = omega_g t [rad], of any shape

        Returns
        -------
        array
            s [-], in the shape of `phase`
        """
        phase = np.asarray(phase, dtype=float)
        result = np.zeros_like(phase)
        for piece in self.pieces:
            inside = (phase >= piece.start) & (phase < piece.stop)
            result = np.where(inside, piece.value(phase), result)
        return result

    @cached_property
    def segments(self) -> Segments:
        """The monotone segments of the motion."""
        return self.cut([extremes(piece) for piece in self.pieces])

    def cut(self, inner: Sequence[Sequence[float]]) -> Segments:
        """Return the segments of the pieces.

        Parameters
        ----------
        inner
            the phases of the cuts inside each piece [rad], among them its extremes,
            (pieces,) lists

        Returns
        -------
        Segments
            on each of which s is monotone
        """
        index, start, stop = self._cuts(inner)
        shape = max(len(p.harmonics) for p in self.pieces), start.size
        sin, cos, frequency = np.zeros(shape), np.zeros(shape), np.ones(shape)
        s_start, s_end = np.empty(start.size), np.empty(start.size)
        length = stop - start
        for i, piece in enumerate(self.pieces):
            mine = np.flatnonzero(index == i)
            s_start[mine] = _exact_value(piece, start[mine])
            s_end[mine] = _exact_value(piece, stop[mine])
            for j, h in enumerate(piece.harmonics):
                sin[j, mine], cos[j, mine] = _sin_cos(h, start[mine])
                frequency[j, mine] = h.frequency
            # Exact between quarter turns, as the sines: the rounding of phases adds up
            # over many cycles.
            if len(piece.harmonics) == 1:
                h = piece.harmonics[0]
                quarters, exact = _whole_quarters(h, start[mine], stop[mine])
                length[mine[exact]] = quarters[exact] * (np.pi / 2) / h.frequency
        return Segments(
            start=start,
            length=length,
            s_start=s_start,
            s_end=s_end,
            sin=sin,
            cos=cos,
            frequency=frequency,
            slope=np.array([p.slope for p in self.pieces])[index],
            joins=np.append(index[1:] == index[:-1], False),
            later_max=largest_from(np.maximum(s_start, s_end)),
            # no negative zero
            later_min=0.0 - largest_from(-np.minimum(s_start, s_end)),
        )

    def _cuts(
        self, inner: Sequence[Sequence[float]]
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """(index of the piece, start [rad], stop [rad]) of each segment; inner: as of
        `cut`.
        """
        marks = [
            [piece.start, *within, piece.stop]
            for piece, within in zip(self.pieces, inner, strict=True)
        ]
        index = np.repeat(np.arange(len(marks)), [len(m) - 1 for m in marks])
        start = np.concatenate([m[:-1] for m in marks])
        return index, start, np.concatenate([m[1:] for m in marks])


def extremes(piece: Piece) -> list[float]:
    """Return the phases [rad] strictly inside the piece at which s has an extreme, in
    order.
    """
    if not piece.harmonics:
        return []
    if len(piece.harmonics) == 1 and piece.slope == 0.0:
        h = piece.harmonics[0]
        first = np.ceil((h.frequency * piece.start + h.phase) / np.pi - 0.5)
        last = np.floor((h.frequency * piece.stop + h.phase) / np.pi - 0.5)
        found = (
            ((np.arange(first, last + 1) + 0.5) * np.pi - h.phase) / h.frequency
        ).tolist()
    else:
        waves = np.array([(h.amplitude, h.frequency, h.phase) for h in piece.harmonics])
        found = isolated_extremes(piece.start, piece.stop, piece.slope, waves).tolist()
    margin = 1e-12 * (piece.stop - piece.start)
    return [float(x) for x in found if piece.start + margin < x < piece.stop - margin]


def upwards(vertical: Motion | None) -> str:
    """Return what the name of a motion gets for this vertical motion."""
    return "" if vertical is None else f" with {vertical.name} upwards"


def checked_scale(name: str, factor: float) -> float:
    """Return the factor. Raises MotionError if it is zero, not finite or above
    LARGEST_SCALE.
    """
    if 0.0 < abs(factor) <= LARGEST_SCALE:
        return factor
    raise MotionError(
        f"motion {name!r}: a scale of {factor:g}; expected a number that is not zero,"
        f" up to {LARGEST_SCALE:g}"
    )


def _quarters(h: Harmonic, phase: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(quarter turns, rest [rad]) of the argument of a sinusoid; a rest within rounding
    is 0.
    """
    argument = h.frequency * phase + h.phase
    quarter = np.rint(argument / (np.pi / 2))
    rest = argument - quarter * (np.pi / 2)
    return quarter, np.where(
        np.abs(rest) < 4e-16 * np.maximum(1.0, np.abs(argument)), 0.0, rest
    )


def _whole_quarters(
    h: Harmonic, start: np.ndarray, stop: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """(quarter turns of a sinusoid between two phases, True where both phases are at
    quarter turns).
    """
    (first, rest), (last, left) = _quarters(h, start), _quarters(h, stop)
    return last - first, (rest == 0.0) & (left == 0.0) & (last > first)


def _sin_cos(h: Harmonic, phase: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """C sin and C cos of the argument, exact (0 or 1) at quarter turns, so that 10^4
    cycles do not drift.
    """
    quarter, rest = _quarters(h, phase)
    turn = quarter.astype(np.int64) % 4
    sin, cos = np.sin(rest), np.cos(rest)
    return h.amplitude * np.choose(
        turn, [sin, cos, -sin, -cos]
    ), h.amplitude * np.choose(turn, [cos, -sin, -cos, sin])


def _exact_value(piece: Piece, phase: np.ndarray) -> np.ndarray:
    total = piece.constant + piece.slope * (phase - piece.start)
    for h in piece.harmonics:
        total = total + _sin_cos(h, phase)[0]
    return np.asarray(total)
