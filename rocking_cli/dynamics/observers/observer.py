"""`Observer`, the interface through which a run shows its motion to observers and asks
them what it may skip.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ..equations.equation import Drive, Equation, Flow
from ..lanes import Array, Lanes


class Arcs(NamedTuple):
    """Motion of lanes from their present state until `stop`, each along its flow."""

    lanes: Lanes  # the present state
    flow: Flow  # flow of these lanes
    stop: Array  # end of the motion after the present state [tau], (lanes,)
    y: Array  # displacement at `stop`, in the unit of the side, (lanes,)
    v: Array  # velocity y' at `stop`, by tau, (lanes,)
    force: Array  # y'' + 2 zeta y' at `stop`, (lanes,)
    wanted: Array  # indices of the lanes whose outcome is still open, (wanted,)


class TaylorSteps(NamedTuple):
    """Motion in the air from one sample to the next. Every array is (steps,)."""

    cell: Array  # index of the cell
    side: Array  # +1 right, -1 left
    equation: Equation  # equation of these cells on these sides
    start: tuple[Array, Array]  # (y, y') at the start
    end: tuple[Array, Array]  # (y, y') at the end
    ramp: Drive  # the drive between the two samples


class Propagation(NamedTuple):
    """Propagation of all lanes over samples. Every array is (lanes,)."""

    y: Array  # displacement at the end, in the unit of the side
    v: Array  # velocity y' at the end, by tau
    peak: Array  # largest y so far
    fall: Array  # largest 1 - a on the way [-]
    time: Array  # duration [tau]


class Observer:
    """Base of observers of a run. Its methods do nothing; a subclass overrides those
    that it needs.
    """

    def arcs(self, arcs: Arcs) -> None:
        """Called when lanes have moved along these arcs."""

    def steps(self, steps: TaylorSteps, go: Array) -> None:
        """Called before lanes take those of these Taylor steps over samples that `go`,
        (steps,). An observer sets `go` to False where it needs the march instead.
        """

    def propagates(
        self,
        lanes: Lanes,
        step: Propagation,
        proved: Array,
        strongest: Callable[[Array], Array],
    ) -> Array:
        """Called before lanes are propagated over samples; proved: True for these
        lanes, (lanes,). Returns the indices of lanes that must go only half as far.
        strongest: function of indices that returns an upper bound of the outward drive
        on their way.
        """
        return np.zeros(0, dtype=np.int64)

    def may_close(self, lanes: Lanes) -> Array:
        """True for lanes just after an impact, whose sequence of impacts ends in rest,
        that may be taken to rest at once, (lanes,).
        """
        return np.ones(lanes.cell.size, dtype=bool)

    def free(self, lanes: Lanes) -> None:
        """Called when the march leaves undamped lanes that stay upright on still ground
        from now on.
        """

    def may_settle(self, lanes: Lanes, bounced: Array) -> Array:
        """True for lanes that need not be marched on, (lanes,). They are on still
        ground and stay upright. bounced: True for cells that have had an impact on
        still ground, (cells,).
        """
        return np.ones(lanes.cell.size, dtype=bool)

    def lost(self, cell: Array) -> Array:
        """True for those of these cells that have lost contact with
        the ground, (n,).
        """
        return np.zeros(cell.size, dtype=bool)
