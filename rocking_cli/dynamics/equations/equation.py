"""What the engine asks of an equation of motion.

Both equations are put in one form. On one side, with tau = p t and the displacement y >= 0 in the unit in which the
body at rest falls back with acceleration 1,

    y'' = -l(y) + a(tau) m(y),   l(0) = m(0) = 1,   l/m > 1 for y < 0

where a is the outward drive over its value at uplift. The linear oscillator has l = 1 - y, m = 1 (Eq. 2.4), a rigid body
l = sin(alpha - theta)/sin alpha, m = cos(alpha - theta)/cos alpha (Eq. 2.3), a mechanism the forces of Eq. 3.4 in its canonical
coordinate. Uplift, windows, impacts and chatter need nothing else.
"""

from __future__ import annotations

from typing import Any, Protocol, Self

import numpy as np

from ...motions.motion import Segments
from ..contacts.free import Fate
from ..march.lanes import Lanes
from .flow import Point

Array = np.ndarray


class Flow(Protocol):
    """The motion of each lane from its present state on, until the next impact or the end of a piece."""

    @property
    def y(self) -> Any:
        """Displacement at the start."""

    @property
    def v(self) -> Any:
        """Velocity at the start."""

    @property
    def b(self) -> Any:
        """Acceleration at the start."""

    @property
    def longest(self) -> Array:
        """Longest step [tau] that it can be followed."""

    @property
    def fastest(self) -> Array:
        """Rate at which it bends, for the roots' tolerances."""

    def take(self, lanes: Array) -> Self:
        """The flow of some lanes."""

    def at(self, h: Array) -> Point:
        """The state after h."""

    def at_ground(self, h: Array) -> Array:
        """y'' at an impact after h."""


class Model(Protocol):
    """An equation of motion in the form above."""

    @property
    def gain(self) -> float:
        """Bound of the growth of -l + a m with y, near the ground and for |a| <= 1; 1 for the linear oscillator."""

    @property
    def initiation(self) -> float:
        """The dimensionless amplitude A at which a drive of s = 1 lifts the body."""

    @property
    def limit(self) -> float:
        """y from which the body counts as overturned whatever comes: it lies on its side, the linkage has collapsed."""

    @property
    def pool(self) -> int:
        """Lanes that the engine advances together, for the best use of the caches."""

    def flow(self, segments: Segments, lanes: Lanes) -> Flow:
        """The flow of the lanes."""

    def acceleration(self, y: Array, a: Array) -> Array:
        """y'' at displacement y under the outward drive a."""

    def rotation(self, y: Array) -> Array:
        """|theta|/alpha at displacement y."""

    def rotation_rate(self, y: Array, v: Array) -> Array:
        """Its derivative by tau."""

    def displacement(self, rotation: Array) -> Array:
        """y of |theta|/alpha."""

    def fate(self, y: Array, v: Array, eta: Array) -> Fate:
        """What comes after the shaking, in closed form; peaks in units of y."""

    def certainly_overturns(self, y: Array, v: Array, inward: Array) -> Array:
        """Whether no drive up to `inward` (over the uplift's) can bring the body back."""
