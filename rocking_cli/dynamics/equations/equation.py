"""`Equation`, the interface of an equation of motion to the march, and the records that it uses.

The linear oscillator has l = 1 - y, m = 1 (Eq. 2.4), a rigid body l = sin(alpha - theta)/sin alpha, m = cos(alpha - theta)/cos alpha
(Eq. 2.3), a mechanism the forces of Eq. 3.4 in its canonical coordinate. Uplift, windows and impacts need only this form.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Any, NamedTuple, Protocol, Self

import numpy as np

from ...motions.segments import Segments
from ..lanes import Array, Lanes


class Point(NamedTuple):
    """State of lanes at an instant of an arc: displacement y, velocity v, acceleration b, jerk j; (lanes,), derivatives by tau."""

    y: Array
    v: Array
    b: Array
    j: Array


class Flow(Protocol):
    """The motion of each lane from its present state to the next impact or the end of a piece. Arrays are (lanes,). damping: zeta [-]; y,
    v, b: displacement, velocity and acceleration at the start; longest: longest step [tau]; fastest: rate [1/tau] of the fastest change,
    from which the tolerances of roots follow."""

    @property
    def damping(self) -> float: ...
    @property
    def y(self) -> Any: ...
    @property
    def v(self) -> Any: ...
    @property
    def b(self) -> Any: ...
    @property
    def longest(self) -> Array: ...
    @property
    def fastest(self) -> Array: ...

    def take(self, lanes: Array) -> Self:
        """Return the flow of the lanes with these indices."""

    def at(self, h: Array) -> Point:
        """The state of each lane h >= 0 [tau] after the start; h: (lanes,)."""

    def at_ground(self, h: Array) -> Array:
        """The force f of each lane at an impact h [tau] after the start, (lanes,)."""


class Ramp(NamedTuple):
    """A drive that is a straight line in time, for each lane. unit: duration of the line [tau]; drive: its value at the start; gain: its
    increase over the unit, (lanes,); factors: unit^2/((n + 1)(n + 2)) for the terms n + 2 of y, 0 beyond a lane's degree, (degrees, lanes);
    force: f at the start, if it is known to more digits than follow from the drive (it is 0 at uplift); weight: (weight over m g at the
    start, its increase over the unit), None if it is constant."""

    drive: Array
    gain: Array
    unit: Array
    factors: Array
    force: Array | None = None
    weight: tuple[Array, Array] | None = None

    def after(self, share: Array) -> "Ramp":
        """The rest of the ramp when this part of its unit is over. The factors are not changed: the caller gives those of the rest."""
        left = 1.0 - share
        weight = None if self.weight is None else (self.weight[0] + self.weight[1] * share, self.weight[1] * left)
        return Ramp(self.drive + self.gain * share, self.gain * left, self.unit * left, self.factors, None, weight)


class Law(NamedTuple):
    """An equation of motion as text, y'' = -w F(y) + a G(y) - 2 zeta y', from which `single.recurrence` makes straight-line code. name: of
    the equation; compiled code is stored under it; start: lines that compute F0 and G0 from y; term: lines that compute F<n> and G<n> from
    Y1 ... Y<n> and earlier terms; numbers: floats that the lines use by name; constant: True if G = 1, which no line computes; local:
    function of a y and a number of terms that returns (the largest |y - y(0)| for which the terms hold, the argument `local` of the lines).
    """

    name: str
    start: tuple[str, ...]
    term: Callable[[int], tuple[str, ...]]
    numbers: dict[str, float]
    constant: bool = False
    local: Callable[[float, int], tuple[float, tuple[tuple[float, ...], ...]]] | None = None


class Equation(ABC):
    """An equation of motion, y'' = f - 2 zeta y', in a displacement y of its own unit, with derivatives by tau = p t. Its numbers are
    floats, or (lanes,) arrays if the two sides of a body differ or every cell has a body of its own (`on`). damping: zeta [-]; without
    damping the motion after the shaking has a closed form. The comments state the other attributes."""

    tolerance: float  # largest error of theta/alpha that a series may have
    gain: Any  # upper bound of |df/dy| near the ground on either side, for drives |a| <= 1
    uplift_amplitude: Any = 1.0  # the dimensionless amplitude A at which a drive of s = 1 lifts the body
    limit: Any  # y from which the body counts as overturned under any drive: it lies on its side, the linkage has collapsed
    barrier: Any  # energy, as `fall` returns it, of a body that leaves the ground and just reaches its unstable equilibrium
    bounds: tuple[Any, Any]  # the largest l and the largest m between the ground and `limit`
    bounded = False  # True if the search for overturning amplitudes may use Lemmas 9 and 10
    per_y: Any = 1.0  # |theta|/alpha at y = 1, if they are proportional
    per_rotation: Any = 1.0  # y at |theta|/alpha = 1, if they are proportional
    pool = 16384  # lanes that the march advances together: fewer rounds against arrays that no longer fit the caches (24 terms)

    def __init__(self, damping: float) -> None:
        if not 0.0 <= damping < math.inf:
            raise ValueError(f"damping: found {damping:g}; expected a number from 0")
        self.damping = damping

    def on(self, side: Array, cell: Array | None = None) -> Self:
        """Return the equation with the numbers of these lanes: of the sides, +1 or -1, that they are on, and of their cells."""
        return self

    @abstractmethod
    def flow(self, segments: Segments, lanes: Lanes) -> Flow:
        """Return the flow of the lanes from their present state."""

    @abstractmethod
    def ramp_terms(self, y: Array, v: Array, ramp: Ramp) -> Array:
        """Taylor terms of y, in powers of time over `ramp.unit`, under a drive that is a straight line, (degrees + 2, lanes)."""

    @abstractmethod
    def law(self, side: float) -> Law:
        """Return the equation of one side as text."""

    @abstractmethod
    def force(self, y: Array, a: Array, weight: Array | float = 1.0) -> Array:
        """Return the force f at displacement y, under the outward drive a and the weight over m g."""

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
        """(True if an undamped body overturns on this side on still ground; its energy, proportional to v^2 at the ground)."""

    @abstractmethod
    def peak(self, energy: Array) -> Array:
        """Largest y of a body that has this energy and does not pass the barrier."""

    def damped_peak(self, y: Array, v: Array) -> Array:
        """Largest y of bodies that move outwards on still ground, with damping; NaN if they overturn, move inwards, or the equation has no
        closed form."""
        return np.full(y.shape, np.nan)

    @abstractmethod
    def certainly_overturns(self, y: Array, v: Array, inward: Array, steady: bool = True) -> Array:
        """True where no later inward drive up to `inward` >= 0 (over the drive at uplift) can bring the body back (Lemma 6). steady: True
        if the weight is constant; otherwise `inward` is the drive over the least later weight."""


class SeriesEquation(Equation):
    """An equation whose l and m are series in y, so that a recurrence gives the terms of y."""

    @abstractmethod
    def along(self, y: Array) -> Callable[[int], Array]:
        """Return a function of n that returns terms n of l and m, (2, lanes), from the terms 0 to n of y, (terms, lanes). The caller calls
        it for n = 0, 1 ... in this order."""

    def ramp_terms(self, y: Array, v: Array, ramp: Ramp) -> Array:
        terms = np.empty((len(ramp.factors) + 2, y.size))
        terms[0] = y
        np.multiply(v, ramp.unit, out=terms[1])
        term, drag = self.along(terms), 2.0 * self.damping / ramp.unit
        before = np.empty((2, y.size))
        for n, factor in enumerate(ramp.factors):
            lift, push = here = term(n)
            pushed = np.multiply(ramp.drive, push, out=terms[n + 2])
            if n:
                pushed += ramp.gain * before[1]
            pushed -= lift if ramp.weight is None else ramp.weight[0] * lift
            if n and ramp.weight is not None:
                pushed -= ramp.weight[1] * before[0]
            if not n and ramp.force is not None:
                pushed[:] = ramp.force
            if self.damping:
                pushed -= drag * ((n + 1) * terms[n + 1])
            pushed *= factor
            before = here
        return terms


def falls_by_energy(v: Array, energy: Array, barrier: Array | float, beyond: Array) -> Array:
    """True where bodies with this energy on still ground overturn. beyond: True past the unstable equilibrium, where only an inward speed
    that carries the body back over the barrier saves it."""
    return np.where(beyond, (v >= 0.0) | (energy < barrier), (v > 0.0) & (energy > barrier))
