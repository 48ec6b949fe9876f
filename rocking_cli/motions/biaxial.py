"""Horizontal and vertical ground motion together, with one time and one amplitude."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ..errors import UsageError
from .blocks import blocks
from .motion import Motion, checked_scale
from .piece import Piece, plus
from .polyline import Polyline
from .segments import Samples, Segments


class Biaxial(Motion):
    """A horizontal and a vertical motion cut into the same pieces. The methods of `Motion` are those of the horizontal motion.

    The horizontal acceleration is s a_g and the vertical one, positive upwards, is s_v a_g. told: name of the vertical motion as
    recorded.
    """

    across: Motion
    _vertical: Motion
    told: str

    __eq__ = object.__eq__  # caches hold results by motion, and a comparison of all pieces would be slow
    __hash__ = object.__hash__

    def __init__(self, across: Motion, vertical: Motion, told: str) -> None:
        name = f"{across.name} with {told} upwards"
        for key, value in {"name": name, "across": across, "_vertical": vertical, "told": told}.items():
            object.__setattr__(self, key, value)

    @property
    def vertical(self) -> Motion:
        """The vertical motion, on the same pieces."""
        return self._vertical

    @cached_property
    def pieces(self) -> Sequence[Piece]:
        """The horizontal pieces."""
        return self.across.pieces

    @property
    def acceleration(self) -> float | None:
        """The amplitude of the horizontal motion, see `Motion.acceleration`."""
        return self.across.acceleration

    @property
    def duration(self) -> float:
        """Phase at which both motions have ended [rad]."""
        return self.across.duration

    @property
    def samples(self) -> Samples | None:
        """The horizontal samples; None if the vertical motion has no samples at the same instants."""
        return None if self._vertical.samples is None else self.across.samples

    def value(self, phase: np.ndarray | float) -> np.ndarray:
        """The horizontal s(phase) [-]."""
        return self.across.value(phase)

    def still_until(self, phase: float) -> Biaxial:
        """Both motions, with the ground at rest after them up to a phase [rad]."""
        return Biaxial(self.across.still_until(phase), self._vertical.still_until(phase), self.told)

    def scaled(self, factor: float) -> Biaxial:
        """Both motions times a factor. A negative factor reverses the horizontal motion only; the vertical one takes |factor|."""
        share = abs(factor)
        return Biaxial(self.across.scaled(factor), self._vertical.scaled(share), _times(self.told, share))

    @cached_property
    def segments(self) -> Segments:
        """The segments of the horizontal motion."""
        return self.across.segments


def with_vertical(motion: Motion, vertical: Motion, scale: float = 1.0) -> Biaxial:
    """A horizontal motion together with a vertical one times `scale`, which may be negative.

    Two records keep the ratio of their amplitudes. Two pulses or motion documents share a_g and phase.
    Raises UsageError if only one of the two is a record.
    """
    own, other = motion.acceleration, vertical.acceleration
    if (own is None) != (other is None):
        raise UsageError("only one of the horizontal and the vertical motion is a record; expected two records, or none")
    factor = checked_scale(vertical.name, scale) * (1.0 if own is None or other is None else other / own)
    told = _times(vertical.name, scale)
    marks = np.sort(np.concatenate([motion.marks, vertical.marks]))
    marks = marks[np.diff(marks, prepend=-np.inf) > 1e-12 * marks[-1]]
    return Biaxial(motion.on(marks), vertical.on(marks).scaled(factor), told)


def _times(name: str, factor: float) -> str:
    """A name with its factor, or without a factor of 1."""
    return name if factor == 1.0 else f"{name}, times {factor:g}"


@dataclass(frozen=True, eq=False)
class Upwards:
    """A vertical motion times `scale`, to be added to horizontal motions."""

    vertical: Motion
    scale: float = 1.0

    def __call__(self, motion: Motion) -> Biaxial:
        """The horizontal motion `motion` together with this one, see `with_vertical`."""
        return with_vertical(motion, self.vertical, self.scale)

    def identity(self) -> list[Any]:
        """The data on which a result depends: name, hash of the samples of a record, its amplitude [m/s2], scale."""
        lines, found = self.vertical, hashlib.sha256()
        if isinstance(lines, Polyline):
            for part in blocks(lines.start.size):
                for column in (lines.start, lines.stop, lines.constant, lines.slope):
                    found.update(np.ascontiguousarray(column[part]).tobytes())
        return [lines.name, found.hexdigest(), lines.acceleration, self.scale]


def combined(motion: Biaxial, factor: float) -> Motion:
    """The horizontal motion plus `factor` times the vertical one, as one motion."""
    across, up = motion.across, motion.vertical
    if isinstance(across, Polyline) and isinstance(up, Polyline):
        return across.plus(up, factor)
    return Motion(motion.name, tuple(plus(a, b.scaled(factor)) for a, b in zip(across.pieces, up.pieces, strict=True)))
