"""The linear oscillator (Eqs. 2.4 and 3.6): y is |theta|/alpha. Its motion is a Taylor
series, whose tolerance is near rounding (a user does not choose it), or exact.
"""

from collections.abc import Callable, Sequence
from copy import copy
from typing import Any, Self

import numpy as np

from ...arrays import Array
from ...motions.segments import Segments
from .equation import Equation
from .recurrence import Series
from .taylor import order_for

SERIES = 1e-12  # tolerance of the series under sinusoids


class LinearEquation(Equation):
    """The linear oscillator, y'' = y - 1 + a - 2 zeta y' (Eq. 2.4).

    y = theta/alpha, a = the outward drive over its value at uplift, both over tau = p
    t. `System(LinearEquation())` is the oscillator of the paper.

    Parameters
    ----------
    damping
        zeta [-]

    Raises
    ------
    ArgumentError
        when the damping is negative or not finite

    Notes
    -----
    The motion is a Taylor series to 1e-12 of theta/alpha; without damping, under one
    sinusoid, the closed form. The equation holds for slender structures: angles for
    which sin(alpha) is close to alpha.

    Examples
    --------
    >>> damped = System(LinearEquation(damping=0.05))
    >>> found = response(damped, sine(), 2.0, 6.0, 0.9)
    >>> Outcome(int(found.outcome)).flag, f"{float(found.theta_ratio):.6f}"
    ('rocked', '0.291292')
    """

    gain = 1.0
    limit = np.inf
    # tolerance of the short series of straight lines: terms left out are below
    # rounding
    tolerance = 1e-13
    order = order_for(SERIES)
    largest_m = 1.0
    barrier = 0.5
    cellwise = ("damping",)

    def __init__(self, damping: float = 0.0) -> None:
        super().__init__(damping)
        self.bounded = not self.damped

    @property
    def growth(self) -> Any:
        """Rate of the unstable mode, over p [-]."""
        return np.sqrt(1.0 + self.damping * self.damping) - self.damping

    def _with(self, damping: Any) -> Self:
        there = copy(self)
        there.damping = damping
        return there

    def on(self, side: Array, cell: Array | None = None) -> Self:
        if cell is None or not isinstance(self.damping, np.ndarray):
            return self
        return self._with(self.damping[cell])

    def part(self, lanes: slice) -> Self:
        own = self.damping
        return self._with(own[lanes]) if isinstance(own, np.ndarray) else self

    def of_each_cell(self, equations: Sequence[Self], counts: Sequence[int]) -> Self:
        numbers = [one.damping for one in equations]
        one = len(set(numbers)) == 1
        return self if one else self._with(np.repeat(numbers, counts))

    @property
    def error_unit(self) -> float:
        """That of sinusoids; `tolerance` is that of straight lines."""
        return SERIES

    def has_exact_flow(self, segments: Segments) -> bool:
        """True under single sinusoids, without damping and vertical motion."""
        steady = not self.damped and segments.weighed is None
        return steady and segments.harmonics == 1 and not segments.sloped

    def along(
        self, y: Series, new: Callable[[], Series]
    ) -> tuple[Series, None, Callable[[int], None]]:
        """F = 1 - y, G = 1."""
        lift = new()
        lift.append(1.0 - y[0])
        return lift, None, lambda n: lift.append(-y[n])

    def force(self, y: Array, a: Array, weight: Array | float = 1.0) -> Array:
        """The force f = w (y - 1) + a."""
        return weight * (y - 1.0) + a

    def slope(self, y: Array | float, force: Array | float) -> float:
        """df/dy, 1 under the weight of the body alone."""
        return 1.0

    def fall(self, y: Array, v: Array) -> tuple[Array, Array]:
        """True if the unstable mode y - 1 + v is positive; twice the energy is 1 - D0*
        of Eq. 2.7, without cancellation.
        """
        return y - 1.0 + v > 0.0, 0.5 * (v * v + y * (2.0 - y))

    def peak(self, energy: Array) -> Array:
        """Largest y, 1 - sqrt(1 - v^2) (Eq. 2.7), computed without cancellation where v
        is small; at most 1.
        """
        square = 2.0 * energy
        return square / (1.0 + np.sqrt(np.maximum(0.0, 1.0 - square)))

    def damped_peak(self, y: Array, v: Array) -> Array:
        """The y at which y' = 0, from the two modes of y - 1; NaN where
        there is none.
        """
        up, down = self.growth, -1.0 / self.growth
        rising = (v > 0.0) & (y - 1.0 + up * v < 0.0)
        grows = (v - down * (y - 1.0)) / (up - down)
        decays = (up * (y - 1.0) - v) / (up - down)
        when = np.log(-decays * down / (grows * up)) / (up - down)
        return np.where(
            rising,
            y + grows * np.expm1(up * when) + decays * np.expm1(down * when),
            np.nan,
        )

    def certainly_overturns(
        self, y: Array, v: Array, inward: Array, steady: bool = True
    ) -> Array:
        """True if the unstable mode z = y - 1 + g v, of rate g, exceeds all inward
        drive to come: z' = g (z + a) > 0. Under a weight that varies, y - 1 must exceed
        it and the body must move outwards.
        """
        if not steady:
            return (v > 0.0) & (y - 1.0 > inward)
        return y - 1.0 + (self.growth * v if self.damped else v) > inward
