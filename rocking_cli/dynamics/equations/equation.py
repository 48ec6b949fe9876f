"""What the march asks of an equation of motion.

All equations are put in one form. On one side, with tau = p t of that side and the displacement y >= 0 in the unit in which
the body at rest falls back with acceleration 1,

    y'' = f - 2 zeta y',   f = -l(y) + a(tau) m(y),   l(0) = m(0) = 1,   l/m > 1 for y < 0

where a is the outward drive over its value at uplift and f the force. The linear oscillator has l = 1 - y, m = 1 (Eq. 2.4), a
rigid body l = sin(alpha - theta)/sin alpha, m = cos(alpha - theta)/cos alpha (Eq. 2.3), a mechanism the forces of Eq. 3.4 in
its canonical coordinate. Uplift, windows, impacts and chatter need nothing else.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple, Protocol, Self

import numpy as np

from ...motions.segments import Segments
from ..lanes import Lanes

Array = np.ndarray


class Point(NamedTuple):
    """A state on an arc: displacement y, velocity v, acceleration b, jerk j; (lanes,), per tau."""

    y: Array
    v: Array
    b: Array
    j: Array


class Flow(Protocol):
    """The motion of each lane from its present state on, until the next impact or the end of a piece."""

    @property
    def damping(self) -> float:
        """zeta [-]."""

    @property
    def y(self) -> Any:
        """Displacement at the start, (lanes,)."""

    @property
    def v(self) -> Any:
        """Velocity at the start, (lanes,)."""

    @property
    def b(self) -> Any:
        """Acceleration at the start, (lanes,)."""

    @property
    def longest(self) -> Array:
        """Longest step [tau] that it can be followed, (lanes,)."""

    @property
    def fastest(self) -> Array:
        """Rate [1/tau] at which it bends, for the roots' tolerances, (lanes,)."""

    def take(self, lanes: Array) -> Self:
        """The flow of the lanes of these indices."""

    def at(self, h: Array) -> Point:
        """The state after h >= 0 [tau], one for each lane."""

    def at_ground(self, h: Array) -> Array:
        """The force f at an impact after h [tau], (lanes,)."""


class Ramp(NamedTuple):
    """What drives each lane over its unit of time [tau]: the outward drive now and what it gains until the unit is over, (lanes,);
    factors: unit^2/((n + 1)(n + 2)) for the terms n + 2 of y, 0 beyond a lane's degree, (degrees, lanes); force: f now where it is known
    to more digits than the drive tells, as at uplift, where it is 0; weight: w now and what it gains, where it varies."""

    drive: Array
    gain: Array
    unit: Array
    factors: Array
    force: Array | None = None
    weight: tuple[Array, Array] | None = None

    def after(self, share: Array) -> Ramp:
        """What is left of it when this share of its unit is over, for which its factors must be."""
        left = 1.0 - share
        weight = None if self.weight is None else (self.weight[0] + self.weight[1] * share, self.weight[1] * left)
        return Ramp(self.drive + self.gain * share, self.gain * left, self.unit * left, self.factors, None, weight)


class Law(NamedTuple):
    """An equation of motion as text, y'' = -w F(y) + a G(y) - 2 zeta y', from which `single.recurrence` makes straight-line code.

    name: of the equation, by which compiled code is kept; start: lines that find F0 and G0 from y; term: lines that find F<n> and G<n>
    from Y1 ... Y<n> and earlier ones; numbers: floats that the lines name; constant: whether G = 1, which no line finds; local: what gives
    at a y the room |y - y(0)| in which it holds and, for so many terms, the argument `local` of the lines.
    """

    name: str
    start: tuple[str, ...]
    term: Callable[[int], tuple[str, ...]]
    numbers: dict[str, float]
    constant: bool = False
    local: Callable[[float, int], tuple[float, tuple[tuple[float, ...], ...]]] | None = None


def convolution(a: str, b: str, n: int, first: int = 0) -> str:
    """Text of the sum over i from `first` to n of a_i b_(n - i)."""
    return " + ".join(f"{a}{i}*{b}{n - i}" for i in range(first, n + 1))


class Equation(Protocol):
    """An equation of motion in the form above; y, v in its own unit, per tau.

    Its numbers are floats, or (lanes,) arrays where the two sides of a body differ or every cell has a body of its own (`on`).
    """

    @property
    def damping(self) -> float:
        """zeta [-]; where it is not zero there is no closed form of what comes after the shaking."""

    @property
    def gain(self) -> Any:
        """Bound of the growth of f with y, near the ground and for |a| <= 1, on either side; 1 for the linear oscillator."""

    @property
    def uplift_amplitude(self) -> Any:
        """The dimensionless amplitude A at which a drive of s = 1 lifts the body."""

    @property
    def limit(self) -> Any:
        """y from which the body counts as overturned whatever comes: it lies on its side, the linkage has collapsed."""

    @property
    def barrier(self) -> Any:
        """Energy (`fall`) at which a body that leaves the ground just reaches its unstable equilibrium."""

    @property
    def bounds(self) -> tuple[Any, Any]:
        """The largest l and m from the ground up to the limit."""

    @property
    def tolerance(self) -> float:
        """Error of theta/alpha that series are to keep; below rounding for an equation with an exact flow."""

    @property
    def bounded(self) -> bool:
        """Whether an envelope may use the bounds of the undamped linear oscillator (Lemmas 9 and 10)."""

    @property
    def pool(self) -> int:
        """Lanes that the march advances together, for the best use of the caches."""

    def on(self, side: Array, cell: Array | None = None) -> Equation:
        """The equation with the numbers of the sides, +1 or -1, that these lanes are on, and of their cells."""

    def flow(self, segments: Segments, lanes: Lanes) -> Flow:
        """The flow of the lanes from their present state."""

    def ramp_terms(self, y: Array, v: Array, ramp: Ramp) -> Array:
        """Terms of y in powers of time over `ramp.unit` under a straight line, (degrees + 2, lanes); see `ramp`."""

    def law(self, side: float) -> Law:
        """The equation of one side as text."""

    def force(self, y: Array, a: Array, weight: Array | float = 1.0) -> Array:
        """f at displacement y under the outward drive a and the weight w (`weight`)."""

    def rotation(self, y: Array) -> Array:
        """|theta|/alpha at displacement y, of any shape."""

    def rotation_rate(self, y: Array, v: Array) -> Array:
        """Its derivative by tau."""

    def displacement(self, rotation: Array) -> Array:
        """y of |theta|/alpha."""

    def fall(self, y: Array, v: Array) -> tuple[Array, Array]:
        """On still ground, undamped: (whether the body overturns on this side, its energy, proportional to v^2 at the ground)."""

    def peak(self, energy: Array) -> Array:
        """Largest y of a body that has this energy and does not pass the barrier."""

    def damped_peak(self, y: Array, v: Array) -> Array:
        """Largest y of bodies that move outwards on still ground, with damping; NaN where they overturn, move inwards, or it has no
        closed form."""

    def certainly_overturns(self, y: Array, v: Array, inward: Array, steady: bool = True) -> Array:
        """Whether no drive up to `inward` >= 0 (over the uplift's) can bring the body back; see Lemma 6. steady: whether the weight is;
        where it is not, `inward` is over the least weight to come."""
