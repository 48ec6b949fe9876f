"""`Observer`, the interface through which a run shows its motion to observers and asks
them what it may skip.
"""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...arrays import Array
from ..equations.taylor import TaylorSeries
from ..lanes import Lanes

if TYPE_CHECKING:
    from ..tied.devices import Branch


class Arcs(NamedTuple):
    """Steps of lanes from their present state. Every array is (lanes,)."""

    lanes: Lanes  # the present state
    arc: TaylorSeries  # the motion from there
    reach: Array  # time that the lane goes along it [tau]
    fastest: Array  # bound of |y'| on the way
    acceleration: Array  # bound of |y''| on the way
    wanted: Array  # True for lanes whose outcome is still open
    # the weight over m g from now on, None where it is constant
    weight: TaylorSeries | None = None
    # row of the devices of the side, and their branches; None without devices
    held: "tuple[Array, Branch] | None" = None


class Observer:
    """Base of observers of a run. Its methods do nothing; a subclass overrides those
    that it needs.
    """

    def arcs(self, arcs: Arcs) -> None:
        """Called when lanes have moved along these arcs."""

    def needs(
        self,
        side: Array,
        cell: Array,
        highest: Array,
        fastest: Array,
        acceleration: Array,
        lightest: Array | float,
    ) -> Array:
        """True where the observer must see an arc of a cell on a side, with these
        bounds of y, |y'| and |y''|, and this least weight over m g, (lanes,) each.
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
