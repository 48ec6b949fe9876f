"""The contact with the ground: `Symmetric`, `Unequal` and `OneSided`; `Contact` holds
their common part.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, NamedTuple, Self

import numpy as np

from ...arrays import Array
from ...errors import ArgumentError
from ...motions.segments import Segments
from ..equations.equation import Equation
from ..lanes import Cells, Lanes, of_each_cell
from ..outcome import Outcome
from .sequences import OtherSide
from .uplift import Uplift, first_uplift


class FreeMotion(NamedTuple):
    """Outcome of the motion after the shaking. Every array is (lanes,)."""

    overturns: Array  # True if the body overturns without a further impact
    overturns_after_impact: Array  # True if it overturns after one
    peak: Array  # largest rotation y to come, NaN if the body overturns

    def outcome(self, bounced: Any) -> Array:
        """The outcome of each body; bounced: True if it had an impact before."""
        after = self.overturns_after_impact | (self.overturns & bounced)
        return np.where(
            after,
            Outcome.OVERTURNED_AFTER_IMPACT,
            np.where(self.overturns, Outcome.OVERTURNED_NO_IMPACT, Outcome.ROCKED),
        )


@dataclass(frozen=True)
class Contact(ABC):
    """How a body stands on the ground. The methods of this class hold for two equal
    edges and for a single edge; `Unequal` overrides them.
    """

    alike = False  # True if the body has two free and equal edges
    left = 1.0  # 1 if the body can lift off onto its left edge, otherwise 0
    # fields that may differ from cell to cell in one march
    cellwise: ClassVar[tuple[str, ...]] = ("eta",)

    # restitution [-], a number or (cells,), None if it is not known
    eta: Any = None

    def with_restitution(self, eta: Any) -> Self:
        """Return this contact with another restitution, itself if its edges have their
        own. Raises ArgumentError for one out of range.
        """
        return replace(self, eta=eta)

    def of_each_cell(self, contacts: Sequence[Self], counts: Sequence[int]) -> Self:
        """Return one contact for so many cells of each of these contacts, the first of
        which is this one; they differ in `cellwise` fields only.
        """
        if all(one == self for one in contacts):
            return self
        return replace(self, **of_each_cell(contacts, counts))

    def amplitudes(self, equation: Equation, amplitude: Array) -> Array:
        """Return the amplitudes of cells on each side, as in `Cells`, from A,
        (cells,).
        """
        return (amplitude / equation.uplift_amplitude)[None]

    def cells(self, equation: Equation, amplitude: Array, omega: Array) -> Cells:
        """Return the drive of each cell on each side, from A and Omega, (cells,) each.
        Raises ArgumentError if the restitution is not known.
        """
        if self.eta is None:
            raise ArgumentError(
                "`eta`: found none; expected the restitution of the body"
            )
        eta = np.abs(np.asarray(self.eta, dtype=float))
        return Cells(
            self.amplitudes(equation, amplitude),
            omega[None],
            np.broadcast_to(eta, omega.shape)[None],
        )

    def impact(self, cells: Cells, lanes: Lanes, v: Array, b: Array) -> None:
        """Apply an impact with velocity v <= 0 and force b under the weight m g: set
        side, velocity, force of the lanes (Eq. 2.6).
        """
        lanes.v = rebound(lanes.eta, v)
        self.put_on_next_edge(cells, lanes, b)

    @abstractmethod
    def put_on_next_edge(self, cells: Cells, lanes: Lanes, b: Array) -> None:
        """Put lanes on the edge on which their impact leaves them: its side, and the
        force there, from the force b before the impact.
        """

    @abstractmethod
    def other_side(self, lanes: Lanes) -> OtherSide | None:
        """Return the side on which lanes land at their next impact; None if they land
        on the same side again.
        """

    def strongest(
        self, amplitudes: Array, segments: Segments, first: Array | int = 0
    ) -> Array:
        """The strongest drive of each cell from segment `first` on, over the drive at
        uplift, (cells,). Above 1 the body lifts off. amplitudes: as in `Cells`.
        """
        return np.maximum(
            amplitudes[0] * -segments.later_min[first],
            amplitudes[-1] * self.left * segments.later_max[first],
        )

    def uplift(
        self, cells: Cells, segments: Segments, cell: Array, k: Array, u: Array
    ) -> Uplift:
        """The first uplift of bodies that rest at (k, u), onto either edge."""
        return first_uplift(
            segments,
            k,
            u,
            cells.amplitude[0, cell],
            cells.amplitude[-1, cell] * self.left,
        )

    def turn(self, cells: Cells, lanes: Lanes, at: Array, side: Array) -> None:
        """Put the lanes of these indices on a side; their numbers then have the values
        and units of this side.
        """
        lanes.side[at] = side

    def converted(self, y: Array, side: Array, to: Array, cell: Array) -> Array:
        """Return the displacements on the sides `to` that are as large a part of alpha
        as the displacements y on these sides; cell: the cells of the lanes.
        """
        return y

    def speed(self, side: Array, cell: Array, rate: Array) -> Array:
        """Convert rates d(|theta|/alpha)/dtau on these sides to the alpha and p of the
        reference edge, as A and Omega are; cell: the cells of the lanes.
        """
        return rate

    def free_motion(
        self, equation: Equation, lanes: Lanes, at: Array, y: Array, v: Array
    ) -> FreeMotion:
        """Outcome of undamped lanes `at` that have y >= 0 and velocity v when the
        shaking ends (Lemma 8, Eq. 2.7).
        """
        lanes = lanes.take(at)
        other, here = self.other_side(lanes), equation.on(lanes.side, lanes.cell)
        there, back, unit = (
            (here, lanes.eta, 1.0)
            if other is None
            else (equation.on(-lanes.side, lanes.cell), other.back, other.rotation)
        )
        # The energy at the ground, before the first impact and after the next two.
        overturns, energy = here.fall(y, v)
        first = rebound(lanes.eta, -np.sqrt(2.0 * np.maximum(energy, 0.0)))
        second = rebound(back, -first)
        across, again = 0.5 * first * first, 0.5 * second * second
        after = ~overturns & ((across > there.barrier) | (again > here.barrier))
        # A body that moves inwards has the peak of its present arc behind it.
        outward = np.where(v > 0.0, here.peak(energy), y)
        beyond = there.peak(across)
        if equation.rotation_proportional or here is there:
            beyond = beyond * unit
        else:
            beyond = here.displacement(there.rotation(beyond))
        peak = np.maximum(np.maximum(outward, here.peak(again)), beyond)
        return FreeMotion(overturns, after, np.where(overturns | after, np.nan, peak))

    def settles(self, equation: Equation, lanes: Lanes) -> tuple[Array, Array]:
        """(True for damped lanes on still ground that stay upright: without damping, so
        with more energy, they would neither pass the barrier nor rise above their peak;
        their peaks, raised to the next one where it is known).
        """
        here = equation.on(lanes.side, lanes.cell)
        # Start the comparison from the next peak, where this is known: the body is at
        # rest there, and has lost the energy that damping takes on the way.
        top = here.damped_peak(lanes.y, lanes.v)
        known = np.isfinite(top)
        y, v = np.where(known, top, lanes.y), np.where(known, 0.0, lanes.v)
        peak = np.fmax(lanes.peak, top)
        # Without damping every later arc would be higher than it is (Lemma 8).
        most = self.free_motion(equation, lanes, np.arange(y.size), y, v)
        # above the barrier damping may keep the body from falling back
        upright = (here.rotation(y) < 1.0) & ~most.overturns
        upright &= ~most.overturns_after_impact & (most.peak <= peak)
        return upright, peak


def rebound(eta: Any, v: Any) -> Any:
    """Return the velocity after an impact with velocity v <= 0 (Eq. 2.6), each in the
    unit of its side; eta: the restitution that belongs to these units. Floats or arrays
    of one shape.
    """
    return -eta * v


@dataclass(frozen=True)
class Symmetric(Contact):
    """Two equal edges: an impact puts the body on the other edge with eta times its
    speed (Eq. 2.6). Raises ArgumentError for an eta outside [0, 1].
    """

    alike = True

    def __post_init__(self) -> None:
        if not _within(self.eta, lambda eta: (eta >= 0.0) & (eta <= 1.0)):
            raise ArgumentError("eta must be within [0, 1]")

    def put_on_next_edge(self, cells: Cells, lanes: Lanes, b: Array) -> None:
        """Reverse the side, and with it the sign of the drive."""
        lanes.side = -lanes.side
        lanes.force = -2.0 - b  # b = -1 + a at y = 0, and a changes its sign

    def other_side(self, lanes: Lanes) -> OtherSide:
        """Return the other side, whose numbers equal those of this one."""
        return OtherSide(1.0, 1.0, lanes.eta, lanes.eta, 1.0)


@dataclass(frozen=True)
class OneSided(Contact):
    """A body that is free for theta > 0 only, on its right edge: a facade against
    transverse walls (Sorrentino et al. 2011). At theta = 0 it hits its backing and
    returns on the same side with e times its speed. It lifts off outwards only; an
    inward drive presses it against its backing. eta is e; the eta of its cells is -e.
    Raises ArgumentError for an e outside (-1, 0].
    """

    left = 0.0

    def __post_init__(self) -> None:
        if not _within(self.eta, lambda eta: (eta > -1.0) & (eta <= 0.0)):
            raise ArgumentError("eta of a one-sided body must be within (-1, 0]")

    def put_on_next_edge(self, cells: Cells, lanes: Lanes, b: Array) -> None:
        """Return the body on the same side; the force stays the same."""
        lanes.force = b.copy()

    def other_side(self, lanes: Lanes) -> None:
        """Return None: every arc is on the same side."""


def _within(eta: Any, holds: Callable[[Array], Array]) -> bool:
    """True if every restitution is in a range, or none is known."""
    return eta is None or bool(np.all(holds(np.asarray(eta))))


def reciprocal_ratios(one: float, other: float) -> tuple[float, float]:
    """Return one/other and other/one of positive units, so that their product is 1 to
    every digit (each is exact to a few roundings): an impact without loss then has no
    loss in these units either.
    """
    there, back = one / other, other / one
    while 0.0 < abs(there * back - 1.0) < 1.0:
        there = math.nextafter(there, math.inf)
        back = 1.0 / there
    return there, back


@dataclass(frozen=True, kw_only=True)
class Unequal(Contact):
    """Two edges that differ. Each pair is (right edge, left edge), of numbers or of
    arrays, (cells,). A and Omega are those of the reference edge; on either side y and
    tau = p t have the unit and the p of that side. Raises ArgumentError for a number
    out of range.
    """

    cellwise = ("drive", "omega", "eta", "rotation", "pace")

    # uplift acceleration of the reference edge over that of the edge [-]
    drive: tuple[Any, Any]
    omega: tuple[Any, Any]  # p of the reference edge over that of the edge [-]
    # |y'| after over |y'| before the impact that leaves the edge [-], each in the units
    # of its side: one of the two may exceed 1, their product may not
    eta: tuple[Any, Any] = field()
    # |theta|/alpha at y = 1 [-], if they are proportional; else its slope at rest
    rotation: tuple[Any, Any]
    # of both sides, if |theta|/alpha is not proportional to y
    equation: Equation | None = None
    # alpha p of the edge over alpha p of the reference edge [-]
    pace: tuple[Any, Any] = (1.0, 1.0)

    def __post_init__(self) -> None:
        if not all(
            np.all(np.asarray(x) > 0.0)
            for x in (*self.drive, *self.omega, *self.rotation, *self.pace)
        ):
            raise ArgumentError(
                "drive, omega, rotation and pace of both edges must be positive"
            )
        right, left = np.array(self.eta)
        if not np.all((right >= 0.0) & (left >= 0.0) & (right * left <= 1.0)):
            raise ArgumentError(
                "eta of both edges must be from 0, and their product at most 1"
            )

    def with_restitution(self, eta: Any) -> Self:
        return self

    def _of(self, pair: tuple[Any, Any], side: Array, cell: Array) -> Array:
        """Return the number of the edge on which each lane is; cell: the cells of the
        lanes.
        """
        return np.where(
            side > 0.0, *(x[cell] if isinstance(x, np.ndarray) else x for x in pair)
        )

    def amplitudes(self, equation: Equation, amplitude: Array) -> Array:
        return np.array(self.drive).reshape(2, -1) * amplitude

    def cells(self, equation: Equation, amplitude: Array, omega: Array) -> Cells:
        """Return a row for each edge."""
        frequency, eta = (
            np.array(pair).reshape(2, -1) for pair in (self.omega, self.eta)
        )
        return Cells(
            self.amplitudes(equation, amplitude),
            frequency * omega,
            np.broadcast_to(eta, (2, omega.size)),
        )

    def turn(self, cells: Cells, lanes: Lanes, at: Array, side: Array) -> None:
        """Put lanes on a side: drive, time and restitution become those of the side,
        and the peak is converted to its unit.
        """
        lanes.peak[at] = self.converted(
            lanes.peak[at], lanes.side[at], side, lanes.cell[at]
        )
        lanes.side[at] = side
        row, cell = cells.row(side), lanes.cell[at]
        lanes.amplitude[at], lanes.omega[at], lanes.eta[at] = (
            values[row, cell] for values in cells
        )

    def converted(self, y: Array, side: Array, to: Array, cell: Array) -> Array:
        if self.equation is None:
            unit = self._of(self.rotation, side, cell)
            return y * (unit / self._of(self.rotation, to, cell))
        known = np.isfinite(y)
        turned = self.equation.on(side).rotation(np.where(known, y, 0.0))
        return np.where(known, self.equation.on(to).displacement(turned), y)

    def speed(self, side: Array, cell: Array, rate: Array) -> Array:
        return rate * self._of(self.pace, side, cell)

    def put_on_next_edge(self, cells: Cells, lanes: Lanes, b: Array) -> None:
        """Put lanes on the other edge, with its drive, time and unit."""
        # b = -1 + a at y = 0; a changes its sign, and its unit becomes the uplift of
        # the other edge
        lanes.force = -1.0 - (1.0 + b) * (
            self._of(self.drive, -lanes.side, lanes.cell)
            / self._of(self.drive, lanes.side, lanes.cell)
        )
        self.turn(cells, lanes, np.arange(lanes.side.size), -lanes.side)

    def other_side(self, lanes: Lanes) -> OtherSide:
        """Return the other edge, in units of this one."""
        here, there, cell = lanes.side, -lanes.side, lanes.cell
        drive, omega, rotation = (
            self._of(pair, there, cell) / self._of(pair, here, cell)
            for pair in (self.drive, self.omega, self.rotation)
        )
        if self.equation is not None:  # an upper bound
            rotation = rotation * self.equation.spread
        back = self._of(self.eta, there, cell)
        return OtherSide(drive, omega, lanes.eta, back, rotation)
