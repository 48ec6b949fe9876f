"""The interface of a run to its observers: the motion that it shows them, and their answers."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ..equations.equation import Equation, Flow, Ramp
from ..lanes import Array, Lanes


class Arcs(NamedTuple):
    """The motion of lanes from their present state until `stop` [tau], each along its flow. lanes: as they are at 0; flow: of these lanes;
    y, v, b: displacement, velocity and force at `stop`, (lanes,); wanted: indices of the lanes whose outcome is still open."""

    lanes: Lanes
    flow: Flow
    stop: Array
    y: Array
    v: Array
    b: Array
    wanted: Array


class TaylorSteps(NamedTuple):
    """Motion of bodies in the air from one sample to the next, (steps,). cell: which cell; side: +1 or -1; equation: of these cells on
    these sides; start, end: (y, y') at either end; ramp: what drives them."""

    cell: Array
    side: Array
    equation: Equation
    start: tuple[Array, Array]
    end: tuple[Array, Array]
    ramp: Ramp


class Propagation(NamedTuple):
    """The propagation of all lanes: y and y' at their ends, the peak with them, 1 - a at the most, and their time [tau]."""

    y: Array
    v: Array
    peak: Array
    fall: Array
    time: Array


class Observer:
    """Base of observers of a run. Each method does nothing here; an observer overrides those that it needs."""

    def rest(self, cell: Array, k: Array, u: Array, to_k: Array, to_u: Array) -> None:
        """Bodies of these cells rest from (k, u), segment and phase in it, to another position; (rests,) each. to_k is the number of
        segments where they rest to the end."""

    def arcs(self, arcs: Arcs) -> None:
        """Lanes have moved along these arcs."""

    def steps(self, steps: TaylorSteps, go: Array) -> None:
        """Lanes are to take these Taylor steps over samples, those that `go`, (steps,); sets `go` to False for those that the march must
        look at more closely."""

    def propagates(self, lanes: Lanes, step: Propagation, proved: Array, strongest: Callable[[Array], Array]) -> Array:
        """The lanes that are `proved` are to be propagated over samples, (lanes,); returns the indices of those that must go half as far.
        strongest: upper bound of the outward drive on the propagations of given indices."""
        return np.zeros(0, dtype=np.int64)

    def may_close(self, lanes: Lanes) -> Array:
        """Lanes just after an impact, whose sequence of impacts ends in rest, that may be taken there at once, (lanes,)."""
        return np.ones(lanes.cell.size, dtype=bool)

    def free(self, lanes: Lanes) -> None:
        """Undamped lanes stay upright over still ground from now on."""

    def may_settle(self, lanes: Lanes, bounced: Array) -> Array:
        """Lanes on still ground, which stay upright, that need not be marched on, (lanes,); bounced: True for cells that have had an impact
        there, (cells,)."""
        return np.ones(lanes.cell.size, dtype=bool)

    def lost(self, cell: Array) -> Array:
        """True for those of these cells that have lost contact with the ground, (n,)."""
        return np.zeros(cell.size, dtype=bool)
