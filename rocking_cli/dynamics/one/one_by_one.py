"""Cells one after the other on floats, for `response` with how="floats"."""

import numpy as np

from ...arrays import Array
from ...motions.motion import Motion
from ..batch import most_steps
from ..system import System
from .lane import Lane
from .march import march


class OneByOne:
    """The march of flat cells of one structure, (cells,) each.

    A cell that bounces for very long is left with the outcome FAILED.
    """

    theta_ratio: Array  # max |theta|/alpha [-], NaN where the body fell
    outcome: Array  # codes of `Outcome`
    impacts: Array  # impacts during the shaking
    condition: Array  # condition of the largest rotation

    def __init__(
        self,
        system: System,
        motion: Motion,
        cells: tuple[Array, Array],
        peaks: bool,
    ) -> None:
        self.amplitude, self.omega = (x.tolist() for x in cells)
        # number of steps beyond which a cell fails
        self.most = most_steps(len(system.segments(motion.coarsest)))
        # one lane for each Omega; it serves every amplitude
        self.lanes = {
            omega: Lane(system, motion.coarsest, omega)
            for omega in dict.fromkeys(self.omega)
        }
        size = len(self.amplitude)
        self.theta_ratio = np.empty(size)
        self.outcome = np.empty(size, dtype=np.uint8)
        self.impacts = np.empty(size, dtype=np.int32)
        self.condition = np.empty(size)
        with np.errstate(all="ignore"):
            for i in range(size):
                ended = march(
                    self._lane(i), self.amplitude[i], peaks=peaks, most=self.most
                )
                self.outcome[i] = ended.outcome
                self.theta_ratio[i] = ended.theta_ratio
                self.impacts[i] = ended.impacts
                self.condition[i] = ended.condition

    def _lane(self, i: int) -> Lane:
        return self.lanes[self.omega[i]]
