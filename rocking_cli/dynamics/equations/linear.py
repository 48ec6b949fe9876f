"""The linear oscillator (Eqs. 2.4 and 3.6): y is |theta|/alpha, the flow is exact."""

from __future__ import annotations

import numpy as np

from ...motions.motion import Segments
from ..contacts.free import Fate, free_fate
from ..march.lanes import Lanes
from ..march.windows import segment_value
from .flow import Arc

Array = np.ndarray


class LinearModel:
    """y'' = y - 1 + a."""

    gain = 1.0
    initiation = 1.0
    limit = np.inf
    pool = 32768  # lanes: fewer rounds outweigh what no longer fits the second-level cache

    def flow(self, segments: Segments, lanes: Lanes) -> Arc:
        """The arc that each lane is about to follow: its state and the outward drive's coefficients."""
        _, sin, cos = segment_value(segments, lanes.k, lanes.u)
        outward = -lanes.side * lanes.amplitude
        ramp = outward * segments.slope[lanes.k] * lanes.omega if segments.sloped else None
        w = segments.frequency[:, lanes.k] * lanes.omega
        return Arc(lanes.y, lanes.v, lanes.b, outward * cos, outward * sin, w, ramp)

    def acceleration(self, y: Array, a: Array) -> Array:
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

    def fate(self, y: Array, v: Array, eta: Array) -> Fate:
        """Eq. 2.7."""
        return free_fate(y, v, eta)

    def certainly_overturns(self, y: Array, v: Array, inward: Array) -> Array:
        """The unstable mode z = y - 1 + v exceeds all the inward drive still to come: z' = z + a stays positive."""
        return y - 1.0 + v > inward
