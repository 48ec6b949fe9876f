"""`Observer`, the interface through which a run shows its motion to observers and asks
them what it may skip.
"""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...arrays import Array
from ..equations.taylor import TaylorSeries
from ..lanes import Lanes

if TYPE_CHECKING:
    from ..equations.linear_flow import LinearFlow


class Arcs(NamedTuple):
    """Motion of lanes from their present state until `stop`, each along its flow."""

    lanes: Lanes  # the present state
    flow: "TaylorSeries | LinearFlow"  # series or exact flow of these lanes
    stop: Array  # end of the motion after the present state [tau], (lanes,)
    y: Array  # displacement at `stop`, in the unit of the side, (lanes,)
    v: Array  # velocity y' at `stop`, by tau, (lanes,)
    force: Array  # y'' + 2 zeta y' at `stop`, (lanes,)
    wanted: Array  # indices of the lanes whose outcome is still open, (wanted,)
    fastest: Array = np.zeros(0)  # bound of |y'| until `stop`, (lanes,)


class Observer:
    """Base of observers of a run. Its methods do nothing; a subclass overrides those
    that it needs.
    """

    # True if `needs` tells which arcs the observer must see; otherwise it sees them all
    selects = False

    def arcs(self, arcs: Arcs) -> None:
        """Called when lanes have moved along these arcs."""

    def needs(self, side: Array, cell: Array, highest: Array, fastest: Array) -> Array:
        """True where the observer must see an arc of a cell on a side, with these
        bounds of y and of |y'|, (lanes,) each.
        """
        return np.ones(side.size, dtype=bool)

    def may_rest(self, lanes: Lanes) -> Array:
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
