"""The amplitudes of a search: the largest one, and those of the scan
at one frequency.
"""

from dataclasses import dataclass
from typing import NamedTuple, Self

import numpy as np

from ..arrays import Array
from ..errors import UsageError
from ..structures.parameters import RockingParameters

SCAN_STEP = 0.999e-3  # in A; no interval wider than 1e-3 is missed
# under a motion with at most so many segments a capacity uses the scan of an envelope
LONGEST_FINE = 200
# ratio of neighbouring amplitudes, minus 1, in the search for the lowest fall under
# longer motions
COARSE = 1e-3


class Limit(NamedTuple):
    """The largest amplitude of a search."""

    # A [-], or an acceleration [m/s2], which gives a different A for each structure
    value: float
    acceleration: bool = False  # True if `value` is an acceleration


def limit_of(a_max: float | Limit, structure: RockingParameters) -> float:
    """Return the limit as A for a structure; a number is returned as it is. Raises
    UsageError for an acceleration without units.
    """
    if not isinstance(a_max, Limit):
        return a_max
    if not a_max.acceleration:
        return a_max.value
    if structure.dimensionless:
        raise UsageError(
            "`a_max`: found an acceleration; expected a number A for a structure"
            " without units"
        )
    return float(structure.dimensionless_amplitude(a_max.value))


@dataclass(frozen=True)
class ScanGrid:
    """The amplitudes A of a scan: SCAN_STEP apart, and closer just above uplift, where
    slow pulses have many intervals.
    """

    near: Array  # the first points one by one [-], (near,)
    start: float  # after them, point n is start + (n - near.size) step [-]
    step: float  # distance of these later points [-]
    size: int  # number of all points

    @classmethod
    def between(cls, lowest: float, highest: float, *, ratio: float = 0.0) -> Self:
        """The scan from the amplitude that lifts the body to another, both included.
        ratio: the ratio of neighbouring amplitudes minus 1, in place of a constant
        step.
        """
        if ratio:
            near = np.geomspace(
                lowest, highest, 2 + int(np.log(highest / lowest) / np.log1p(ratio))
            )
            near[0], near[-1] = lowest, highest
            return cls(near, highest, highest - lowest, near.size)
        count = int(np.ceil((highest - lowest) / SCAN_STEP))
        step = (highest - lowest) / count
        close = lowest * (1.0 + np.geomspace(1e-3, 0.1, 460))
        even = max(0, min(count, int(np.ceil((close[-1] - lowest) / step))))
        near = np.unique(
            np.concatenate(
                [
                    lowest + step * np.arange(even + 1),
                    close[(close > lowest) & (close < highest)],
                ]
            )
        )
        return cls(near, lowest + step * (even + 1), step, near.size + count - even)

    def amplitude(self, n: Array) -> Array:
        """The amplitudes of scan points n."""
        return np.where(
            n < self.near.size,
            self.near[np.minimum(n, self.near.size - 1)],
            self.start + self.step * (n - self.near.size),
        )

    def below(self, amplitude: Array) -> Array:
        """The last scan point that is surely not above each amplitude; the first point
        if there is none.
        """
        there = np.searchsorted(self.near, amplitude, side="right") - 1
        # larger scan numbers overflow a whole number
        top = self.start + self.step * (self.size - self.near.size + 1)
        beyond = (
            np.floor((np.minimum(amplitude, top) - self.start) / self.step).astype(
                np.int64
            )
            - 1
            + self.near.size
        )
        return np.clip(
            np.where(beyond >= self.near.size, beyond, there), 0, self.size - 1
        )
