"""Arrays of the monotone segments of a motion."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np


@dataclass(frozen=True)
class SegmentArrays:
    """The K monotone segments of a motion. Arrays have the shape (K,), or (harmonics, K) for sin, cos and frequency.

    start, length [rad]; s_start, s_end: s at the ends, inside the segment; sin, cos: of the argument of each sinusoid at the start,
    times its amplitude; frequency: over omega_g; slope [1/rad]; joins: the next segment belongs to the same piece; later_max,
    later_min: largest and least s from the start of the segment on, with 0 for the ground at rest after the motion.
    """

    start: np.ndarray
    length: np.ndarray
    s_start: np.ndarray
    s_end: np.ndarray
    sin: np.ndarray
    cos: np.ndarray
    frequency: np.ndarray
    slope: np.ndarray
    joins: np.ndarray
    later_max: np.ndarray
    later_min: np.ndarray

    def __len__(self) -> int:
        return int(self.start.size)

    @property
    def harmonics(self) -> int:
        """The largest number of sinusoids of a piece."""
        return int(self.sin.shape[0])

    @cached_property
    def sloped(self) -> bool:
        """True if a piece has a term linear in the phase."""
        return bool(np.any(self.slope != 0.0))
