"""Cells that are run together under one motion, as the march takes them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ...motions.segments import Segments
from ..contacts.contact import Contact, Uplift, first_uplift
from ..equations.equation import Equation
from ..lanes import Array, Cells, Lanes
from ..system import System

SETTLING = 250.0  # tau, times what damping slows the unstable mode: no body is longer on its way to its last impacts that matter
MAX_STEPS = 120_000  # a cell that takes more, and 40 for each segment of the motion, is given up as failed
_INSTANT = 1e-9  # tau: within it of a free fall the weight is as good as none


class FreeFall:
    """The first instant at which the ground falls away from the body of each cell, (cells,): k, u: its place in the motion; ever: True if
    there is one."""

    def __init__(self, segments: Segments, first: Uplift, ever: Array) -> None:
        self.segments, self.k, self.u, self.ever = segments, first.k, first.u, ever

    @classmethod
    def of(cls, segments: Segments, cells: Cells, shaken: int) -> FreeFall | None:
        """The free fall of cells under a motion that ends with segment `shaken`; None if the ground falls away from none of them."""
        weighed = segments.weighed
        if weighed is None:
            return None
        sway = weighed.sway(np.ones(cells.omega.shape[1]), cells.amplitude[0])
        down, up = np.maximum(sway, 0.0), np.maximum(-sway, 0.0)
        first = first_uplift(weighed.vertical, np.zeros(sway.size, dtype=np.int64), np.zeros(sway.size), down, up)
        ever = first.k < shaken
        return cls(segments, first, ever) if ever.any() else None

    def until(self, lanes: Lanes) -> Array:
        """The time [tau] that is left until the ground falls away; 0 after it."""
        k, start = self.k[lanes.cell], self.segments.start
        last = len(self.segments) - 1
        ahead = start[np.minimum(k, last)] - start[np.minimum(lanes.k, last)]  # its rounding is far below `_INSTANT`
        until = (ahead + (self.u[lanes.cell] - lanes.u)) / lanes.omega
        return np.where(self.ever[lanes.cell], np.where(lanes.k > k, 0.0, until), np.inf)

    def now(self, lanes: Lanes) -> Array:
        """True for lanes from which the ground falls away now."""
        return np.asarray(self.until(lanes) <= _INSTANT)

    def sooner(self, cell: Array, lift: Uplift) -> tuple[Array, Array]:
        """(k, u) of the free fall or of the uplift of bodies at rest, the earlier one."""
        k, u = self.k[cell], self.u[cell]
        before = (k < lift.k) | ((k == lift.k) & (u < lift.u))
        return np.where(before, k, lift.k), np.where(before, u, lift.u)


class Batch(NamedTuple):
    """Cells on one kind of body. segments: of the motion, followed by still ground where damping leaves the free motion without a closed
    form; first: the segment with which the motion of each cell begins; shaken: the one from which on the ground is still; peaks: True if
    the largest rotations are wanted; most_steps: after so many a cell is given up."""

    equation: Equation
    contact: Contact
    cells: Cells
    segments: Segments
    first: Array
    shaken: int
    peaks: bool
    free_fall: FreeFall | None
    most_steps: int

    @classmethod
    def of(
        cls, system: System, segments: Segments, amplitude: Array, omega: Array, eta: Array, peaks: bool = True, first: Array | None = None
    ) -> Batch:
        """Cells (A, Omega, eta), each (cells,), of a system under a motion. Raises ValueError when an eta does not fit the contact."""
        equation, shaken = system.equation, len(segments)
        cells = system.contact.cells(equation, amplitude, omega, eta)
        if equation.damping and omega.size:
            segments = segments.followed_by_rest(SETTLING * (1.0 + 3.0 * equation.damping) * float(cells.omega.max()))
        free_fall = FreeFall.of(segments, cells, shaken)
        first = np.zeros(omega.size, dtype=np.int64) if first is None else first
        return cls(equation, system.contact, cells, segments, first, shaken, peaks, free_fall, MAX_STEPS + 40 * shaken)

    @property
    def size(self) -> int:
        """Number of cells."""
        return self.cells.omega.shape[1]

    def rotation(self, lanes: Lanes, at: Array | slice, y: Array | float) -> Array:
        """|theta|/alpha of the lanes `at` at displacement y."""
        return self.equation.on(lanes.side[at], lanes.cell[at]).rotation(np.asarray(y))

    def cannot_return(self, lanes: Lanes, at: Array | slice, k: Array, y: Array, v: Array) -> Array:
        """True where no drive to come can bring the lanes `at` back from y, v in segments k (Lemma 6)."""
        side = lanes.side[at]
        inward = self.segments.hardest(side, lanes.amplitude[at], k)
        return self.equation.on(side, lanes.cell[at]).certainly_overturns(y, v, inward, self.segments.weighed is None)

    def rests_until(self, cell: Array, k: Array, u: Array) -> tuple[Uplift, tuple[Array, Array]]:
        """The uplift of bodies that rest from (k, u) on, and (k, u) of it or of the instant at which the ground falls away from them."""
        lift = self.contact.uplift(self.cells, self.segments, cell, k, u)
        return lift, (lift.k, lift.u) if self.free_fall is None else self.free_fall.sooner(cell, lift)
