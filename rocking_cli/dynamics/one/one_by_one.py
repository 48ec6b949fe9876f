"""Cells one after the other on floats, for `response` with how="floats"."""

from functools import cache

import numpy as np

from ...arrays import Array
from ...motions.motion import Motion
from ..outcome import Work
from ..system import System
from .lane import Lane
from .march import march


class OneByOne:
    """The march of flat cells of one structure, (cells,) each.

    A cell that bounces for very long is left with the outcome FAILED.
    """

    def __init__(
        self,
        system: System,
        motion: Motion,
        cells: tuple[Array, Array],
        peaks: bool,
    ) -> None:
        @cache
        def lane_of(omega: float, *eta: float) -> Lane:
            """The lane of one Omega, and of an eta of its own; it serves every A."""
            own = system.with_restitution(*eta) if eta else system
            return Lane(own, motion.coarsest, omega)

        eta = system.contact.eta
        own = [eta] if isinstance(eta, np.ndarray) else []  # of each cell
        with np.errstate(all="ignore"):
            found = [
                march(lane_of(*lane), amplitude, peaks=peaks)
                for amplitude, *lane in np.array([*cells, *own]).T.tolist()
            ]
        # codes of `Outcome`
        self.outcome = np.array([one.outcome for one in found], dtype=np.uint8)
        # max |theta|/alpha [-], NaN where the body fell
        self.theta_ratio = np.array([one.theta_ratio for one in found])
        # impacts during the shaking
        self.impacts = np.array([one.impacts for one in found], dtype=np.int32)
        # condition of the largest rotation
        self.condition = np.array([one.condition for one in found])
        self.work = Work(cells=len(found))
