"""The linear oscillator (Eqs. 2.4 and 3.6): y is |theta|/alpha, the flow is exact.

y'' = y - 1 + a - 2 zeta y'
"""

from __future__ import annotations

import math
from typing import Self

import numpy as np

from ...motions.motion import Segments
from ..drive import segment_value
from ..lanes import Lanes
from .damped_flow import DampedFlow
from .flow import LinearFlow
from .summed_flow import SummedFlow, can_be_summed

Array = np.ndarray


class LinearEquation:
    """y'' = y - 1 + a - 2 zeta y'; damping: zeta [-]. Raises ValueError when it is negative or not finite."""

    gain = 1.0
    uplift_amplitude = 1.0
    limit = np.inf
    barrier = 1.0
    pool = 32768  # lanes: fewer rounds outweigh what no longer fits the second-level cache

    def __init__(self, damping: float = 0.0) -> None:
        if not 0.0 <= damping < math.inf:
            raise ValueError(f"damping is {damping:g}, accepted is a number from 0")
        self.damping = damping
        self.bounded = damping == 0.0
        self.growth = math.sqrt(1.0 + damping * damping) - damping  # rate of the unstable mode, over p

    def on(self, side: Array) -> Self:
        """Both sides have the same equation in their own units."""
        return self

    def flow(self, segments: Segments, lanes: Lanes) -> LinearFlow | SummedFlow | DampedFlow:
        """The arc that each lane is about to follow: its state and the outward drive's coefficients."""
        _, sin, cos = segment_value(segments, lanes.k, lanes.u)
        outward = -lanes.side * lanes.amplitude
        ramp = outward * segments.slope[lanes.k] * lanes.omega if segments.sloped else None
        w = segments.frequency.take(lanes.k, axis=1) * lanes.omega
        if self.damping:
            return DampedFlow(lanes.y, lanes.v, lanes.b, outward * cos, outward * sin, w, ramp, self.damping)
        if can_be_summed(segments):
            return SummedFlow.of(lanes.y, lanes.v, lanes.b, outward * cos, outward * sin, w)
        return LinearFlow(lanes.y, lanes.v, lanes.b, outward * cos, outward * sin, w, ramp)

    def force(self, y: Array, a: Array) -> Array:
        """y - 1 + a."""
        return y - 1.0 + a

    def rotation(self, y: Array) -> Array:
        """y itself."""
        return y

    def rotation_rate(self, y: Array, v: Array) -> Array:
        """v itself."""
        return v

    def displacement(self, rotation: Array) -> Array:
        """|theta|/alpha itself."""
        return rotation

    def fall(self, y: Array, v: Array) -> tuple[Array, Array]:
        """The unstable mode y - 1 + v, and v^2 at the ground, which is 1 - D0* of Eq. 2.7, without cancellation."""
        return y - 1.0 + v > 0.0, v * v + y * (2.0 - y)

    def crest(self, energy: Array) -> Array:
        """1 - sqrt(1 - v^2) (Eq. 2.7), without cancellation where v is small; at most 1."""
        return energy / (1.0 + np.sqrt(np.maximum(0.0, 1.0 - energy)))

    def damped_crest(self, y: Array, v: Array) -> Array:
        """The two modes of y - 1 have grown alike where y' = 0."""
        up, down = self.growth, -1.0 / self.growth
        rising = (v > 0.0) & (y - 1.0 + up * v < 0.0)
        grows, decays = (v - down * (y - 1.0)) / (up - down), (up * (y - 1.0) - v) / (up - down)
        when = np.log(-decays * down / (grows * up)) / (up - down)
        return np.where(rising, y + grows * np.expm1(up * when) + decays * np.expm1(down * when), np.nan)

    def certainly_overturns(self, y: Array, v: Array, inward: Array) -> Array:
        """The unstable mode z = y - 1 + g v, whose rate is g, exceeds all the inward drive still to come: z' = g (z + a) > 0."""
        return y - 1.0 + (self.growth * v if self.damping else v) > inward
