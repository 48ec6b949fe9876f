"""`Equation`, the interface of an equation of motion to the march.

The linear oscillator has l = 1 - y, m = 1 (Eq. 2.4), a rigid body l = sin(alpha -
theta)/sin alpha, m = cos(alpha - theta)/cos alpha (Eq. 2.3), a mechanism the forces of
Eq. 3.4 in its canonical coordinate. Uplift, the Taylor series and impacts need only
this form.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import Any, Self

import numpy as np

from ...arrays import Array
from ...errors import ArgumentError
from ...motions.segments import Segments
from ..condition import STEP
from ..lanes import Lanes
from .recurrence import Series
from .straight_lines import line_flow
from .taylor import TaylorSeries, longest, series_flow


class Equation(ABC):
    """An equation of motion, y'' = f - 2 zeta y', in a displacement y of its own unit,
    with derivatives by tau = p t. Its numbers are floats, or (lanes,) arrays if the two
    sides of a body differ or every cell has a body of its own (`on`).
    """

    tolerance: float  # largest error of theta/alpha that a series may have [-]
    order: int  # number of terms less one of a series under sinusoids
    # upper bound of |df/dy| near the ground on either side, for drives |a| <= 1 [-]
    gain: Any
    # amplitude A at which a drive of s = 1 lifts the body [-]
    uplift_amplitude: Any = 1.0
    # y from which the body counts as overturned under any drive: it lies on its side,
    # the linkage has collapsed
    limit: Any
    # energy, as `fall` returns it, of a body that leaves the ground and just reaches
    # its unstable equilibrium
    barrier: Any
    largest_m: Any  # the largest m between the ground and `limit` [-]
    # largest degree of a series of one body, if F and G are series about each y: its
    # cost goes with the cube
    composed: int | None = None
    # True if the search for overturning amplitudes may use Lemmas 9 and 10
    bounded = False
    rotation_proportional = True  # False if |theta| is no constant times y
    # if not: its largest slope by y up to the unstable equilibrium over its least one,
    # or the product of these ratios of both sides
    spread = 1.0
    per_y: Any = 1.0  # |theta|/alpha at y = 1 [-], if they are proportional
    per_rotation: Any = 1.0  # y at |theta|/alpha = 1, if they are proportional
    # attributes that may differ from cell to cell in one march
    cellwise: tuple[str, ...] = ()
    damping: Any  # zeta [-], float, (cells,) or (lanes,)

    def __init__(self, damping: float) -> None:
        if not 0.0 <= damping < math.inf:
            raise ArgumentError(f"damping: found {damping:g}; expected a number from 0")
        self.damping = damping
        # without damping the motion after the shaking has a closed form
        self.damped = damping > 0.0

    @property
    def error_unit(self) -> float:
        """The tolerance in units of which errors are stated [-]."""
        return self.tolerance

    def damping_of(self, cell: Array) -> Any:
        """Return zeta of lanes of these cells [-], a float or (lanes,)."""
        return (
            self.damping[cell] if isinstance(self.damping, np.ndarray) else self.damping
        )

    def on(self, side: Array, cell: Array | None = None) -> Self:
        """Return the equation with the numbers of these lanes: of the sides, +1 or -1,
        that they are on, and of their cells.
        """
        return self

    def part(self, lanes: slice) -> Self:
        """Return the equation of some of the lanes that `on` has returned it for."""
        return self

    def edge(self, side: float) -> Self:
        """Return the equation of one edge, +1 or -1, with numbers that are floats."""
        return self

    def joined(self, others: Sequence[Self]) -> Self:
        """Return the equation of this edge and of others, each as `edge` returns it:
        `on` takes their numbers as cells.
        """
        return self

    def of_each_cell(self, equations: Sequence[Self], counts: Sequence[int]) -> Self:
        """Return one equation for so many cells of each of these equations, the first
        of which is this one; they differ in `cellwise` attributes only.
        """
        return self

    def has_exact_flow(self, segments: Segments) -> bool:
        """True if the march follows exact flows under this motion, not `flow`."""
        return False

    def flow(self, segments: Segments, lanes: Lanes) -> TaylorSeries:
        """Return the Taylor series of the lanes from their present state."""
        if segments.straight:
            return line_flow(self, segments, lanes)
        terms, fastest = series_flow(self, segments, lanes, self.order)
        step = self.longest(terms, fastest)
        return TaylorSeries(terms, 1.0 / fastest, step, self.damping)

    def longest(self, terms: Array, fastest: Array) -> Array:
        """Return the longest steps that the tolerance allows [tau], (lanes,); arguments
        as of `taylor.longest`.
        """
        return longest(terms, fastest, self.error_unit)

    @abstractmethod
    def along(
        self, y: Series, new: Callable[[], Series]
    ) -> tuple[Series, Series | None, Callable[[int], None]]:
        """Return F and G along a motion, and a function that adds their terms, as of
        `Recurrence`.
        """

    def held(
        self, y: Series, lift: Series, push: Series | None, new: Callable[[], Series]
    ) -> Callable[[int], Any] | None:
        """Return None: nothing holds a free body (`Recurrence`)."""
        return None

    def room(self, y: float) -> float:
        """The distance from y up to which F and G `along` a motion from y hold."""
        return math.inf

    @abstractmethod
    def force(self, y: Array, a: Array, weight: Array | float = 1.0) -> Array:
        """Return the force f at displacement y, under the outward drive a and the
        weight over m g.
        """

    def slope(self, y: Array | float, force: Array | float) -> Array | float:
        """df/dy at displacement y, under the drive that gives this force f."""
        y, force = np.atleast_1d(y), np.atleast_1d(force)
        still = self.force(y, np.zeros(y.shape))
        drive = (force - still) / (self.force(y, np.ones(y.shape)) - still)
        return np.asarray((self.force(y + STEP, drive) - force) / STEP)

    def rotation(self, y: Array) -> Array:
        """|theta|/alpha at displacement y, of any shape."""
        return y * self.per_y

    def rotation_rate(self, y: Array, v: Array) -> Array:
        """Derivative of |theta|/alpha by tau, at displacement y and velocity v."""
        return v * self.per_y

    def displacement(self, rotation: Array) -> Array:
        """The displacement y at which |theta|/alpha = rotation."""
        return rotation * self.per_rotation

    @abstractmethod
    def fall(self, y: Array, v: Array) -> tuple[Array, Array]:
        """(True if an undamped body overturns on this side on still ground; its energy,
        v^2/2 at the ground).
        """

    @abstractmethod
    def peak(self, energy: Array) -> Array:
        """Largest y of a body that has this energy and does not pass the barrier."""

    def damped_peak(self, y: Array, v: Array) -> Array:
        """Largest y of bodies that move outwards on still ground, with damping; NaN if
        they overturn, move inwards, or the equation has no closed form.
        """
        return np.full(y.shape, np.nan)

    def may_overturn(self, y: Array, v: Array) -> Array:
        """False where `certainly_overturns` is False under any drive to come."""
        # The least barrier is that of still ground, which y' > 1 - y is needed to pass.
        return np.asarray(y + v > 1.0)

    @abstractmethod
    def certainly_overturns(
        self, y: Array, v: Array, inward: Array, steady: bool = True
    ) -> Array:
        """True where no later inward drive up to `inward` >= 0 (over the drive at
        uplift) can bring the body back (Lemma 6). steady: True if the weight is
        constant; otherwise `inward` is the drive over the least later weight.
        """


def falls_by_energy(
    v: Array, energy: Array, barrier: Array | float, beyond: Array
) -> Array:
    """True where bodies with this energy on still ground overturn. beyond: True past
    the unstable equilibrium, where only an inward speed that carries the body back over
    the barrier saves it.
    """
    return np.where(
        beyond, (v >= 0.0) | (energy < barrier), (v > 0.0) & (energy > barrier)
    )
