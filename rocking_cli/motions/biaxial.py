"""Horizontal and vertical ground motion in one motion: both have the same pieces, the
same time and the same amplitude.
"""

import hashlib
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..errors import UsageError
from .blocks import blocks
from .motion import Motion, checked_scale, plus
from .polyline import Polyline


def with_vertical(motion: Motion, vertical: Motion, scale: float = 1.0) -> Motion:
    """Return a horizontal motion with a vertical one times `scale`; two records keep
    the ratio of their amplitudes, others share a_g and phase. Raises UsageError if only
    one of them is a record.
    """
    own, other = motion.acceleration, vertical.acceleration
    if (own is None) != (other is None):
        raise UsageError(
            "only one of the horizontal and the vertical motion is a record; expected"
            " two records, or none"
        )
    factor = checked_scale(vertical.name, scale) * (
        1.0 if own is None or other is None else other / own
    )
    marks = np.sort(np.concatenate([motion.marks, vertical.marks]))
    marks = marks[np.diff(marks, prepend=-np.inf) > 1e-12 * marks[-1]]
    name = vertical.name if scale == 1.0 else f"{vertical.name} times {scale:g}"
    return motion.on(marks, vertical.on(marks).scaled(factor, name))


@dataclass(frozen=True, eq=False)
class Upwards:
    """A vertical motion times `scale`, to be added to horizontal motions."""

    vertical: Motion  # the motion, positive upwards
    scale: float = 1.0  # factor of the vertical motion, with its sign [-]

    def __call__(self, motion: Motion) -> Motion:
        """Return the motion with this vertical one, see `with_vertical`."""
        return with_vertical(motion, self.vertical, self.scale)

    def identity(self) -> list[Any]:
        """Return name, hash of the samples, amplitude of a record [m/s2] and factor:
        the data on which a result depends.
        """
        lines, found = self.vertical, hashlib.sha256()
        if isinstance(lines, Polyline):
            # The digest takes the columns block by block, as earlier versions did.
            for part in blocks(lines.start.size):
                for column in (lines.start, lines.stop, lines.constant, lines.slope):
                    found.update(np.ascontiguousarray(column[part]).tobytes())
        return [lines.name, found.hexdigest(), lines.acceleration, self.scale]


def combined(motion: Motion, factor: float) -> Motion:
    """Return the sum of the horizontal motion and `factor` times its vertical one."""
    up = motion.vertical
    assert up is not None
    if isinstance(motion, Polyline) and isinstance(up, Polyline):
        constant = motion.constant + factor * up.constant
        slope = motion.slope + factor * up.slope
        return Polyline(motion.name, motion.start, motion.stop, constant, slope)
    return Motion(
        motion.name,
        tuple(
            plus(a, b.scaled(factor))
            for a, b in zip(motion.pieces, up.pieces, strict=True)
        ),
    )
