"""`Batch`: cells that the march computes together under one motion; `FreeFall`: when
the ground falls away from them.
"""

from typing import NamedTuple, Self

import numpy as np

from ..arrays import Array
from ..motions.segments import Segments
from .contacts.contact import Contact
from .contacts.uplift import first_uplift
from .equations.equation import Equation
from .lanes import Cells, Lanes
from .system import System

# tau, times (1 + 3 zeta): after so long on still ground every body has had its last
# impact that matters
SETTLING = 250.0
# a cell with more steps than this plus 10 for each segment of the motion fails
MAX_STEPS = 20_000
# tau: this close to a free fall of the ground the weight counts as zero
INSTANT = 1e-9


class FreeFall(NamedTuple):
    """The first instant at which the ground falls away from the body of each cell."""

    segments: Segments  # segments of the motion
    segment: Array  # segment of this instant, (cells,)
    phase: Array  # phase there [rad], (cells,)
    occurs: Array  # True if there is such an instant, (cells,)

    @classmethod
    def of(cls, segments: Segments, cells: Cells, shaken: int) -> Self | None:
        """Find the free fall of cells; the motion is over from segment `shaken` on.
        Returns None if the ground falls away from no cell.
        """
        weighed = segments.weighed
        if weighed is None:
            return None
        sway = weighed.sway(np.ones(cells.omega.shape[1]), cells.amplitude[0])
        zero = np.zeros(sway.size)
        # w = 1 + sway s_v falls below 0 where a body of uplift 1/sway would be lifted
        falls = first_uplift(weighed.vertical, zero.astype(np.int64), zero, sway, zero)
        occurs = falls.segment < shaken
        if not occurs.any():
            return None
        return cls(segments, falls.segment, falls.phase, occurs)

    def time_left(self, lanes: Lanes) -> Array:
        """Return the time [tau] left until the ground falls away; 0 after this instant,
        infinite if it never comes.
        """
        k, start = self.segment[lanes.cell], self.segments.start
        last = len(self.segments) - 1
        # The rounding error of this difference is far below `INSTANT`.
        ahead = start[np.minimum(k, last)] - start[np.minimum(lanes.segment, last)]
        until = (ahead + (self.phase[lanes.cell] - lanes.phase)) / lanes.omega
        return np.where(
            self.occurs[lanes.cell], np.where(lanes.segment > k, 0.0, until), np.inf
        )

    def has_begun(self, lanes: Lanes) -> Array:
        """True for lanes from which the ground falls away now."""
        return np.asarray(self.time_left(lanes) <= INSTANT)


class Batch(NamedTuple):
    """Cells with one kind of body."""

    equation: Equation  # equation of motion of all cells
    contact: Contact  # contact of all cells
    cells: Cells  # the drive of each cell
    # segments of the motion, then still ground if damping or restraints leave the free
    # motion without a closed form
    segments: Segments
    # index of the segment with which the motion of each cell begins, (cells,)
    first: Array
    shaken: int  # index of the segment from which on the ground is still
    peaks: bool  # True if the largest rotations are wanted
    # where the ground falls away from bodies; None if it never does
    free_fall: FreeFall | None
    most_steps: int  # a cell with more steps fails

    @classmethod
    def of(
        cls,
        system: System,
        segments: Segments,
        amplitude: Array,
        omega: Array,
        peaks: bool = True,
        first: Array | None = None,
    ) -> Self:
        """The batch of cells (A, Omega), each (cells,), under a motion. Raises
        ArgumentError if the restitution is not known.
        """
        equation, shaken = system.equation, len(segments)
        cells = system.contact.cells(equation, amplitude, omega)
        if system.devices is not None:
            segments = segments.followed_by_rest(np.inf)
        elif equation.damped and omega.size:
            zeta = equation.damping_of(np.arange(omega.size))
            slowly = SETTLING * (1.0 + 3.0 * zeta)
            segments = segments.followed_by_rest(float((slowly * cells.omega).max()))
        free_fall = FreeFall.of(segments, cells, shaken)
        first = np.zeros(omega.size, dtype=np.int64) if first is None else first
        return cls(
            equation,
            system.contact,
            cells,
            segments,
            first,
            shaken,
            peaks,
            free_fall,
            MAX_STEPS + 10 * shaken,
        )

    @property
    def size(self) -> int:
        """Number of cells."""
        return self.cells.omega.shape[1]

    def rotation(self, lanes: Lanes, at: Array | slice, y: Array | float) -> Array:
        """|theta|/alpha of the lanes `at` at displacement y."""
        return self.equation.on(lanes.side[at], lanes.cell[at]).rotation(np.asarray(y))


def inward_to_come(segments: Segments, lanes: Lanes) -> Array:
    """The strongest inward drive on lanes from their segment on, over the least weight
    from there on, (lanes,).
    """
    k = np.minimum(lanes.segment, len(segments) - 1)
    return segments.strongest_inward(lanes.side, lanes.amplitude, k)


def cannot_return(segments: Segments, equation: Equation, lanes: Lanes) -> Array:
    """True for lanes of free bodies that no later drive can bring back (Lemma 6)."""
    here, inward = equation.on(lanes.side, lanes.cell), inward_to_come(segments, lanes)
    return here.certainly_overturns(lanes.y, lanes.v, inward, segments.weighed is None)
