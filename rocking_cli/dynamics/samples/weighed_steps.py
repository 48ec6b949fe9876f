"""Taylor steps over samples where the ground moves upwards too: between samples the drive and the weight are straight lines (`weight`).

Lemma 12 holds with L times the larger weight of a stretch's ends, while that is positive throughout.
"""

from __future__ import annotations

import numpy as np

from ...motions.blocks import largest
from ...motions.segments import Samples, followed_by
from ..equations.equation import Equation, Ramp
from ..equations.ramp import degrees
from ..march.engine import Run
from .stepper import gains
from .taylor_steps import TaylorStepper

Array = np.ndarray


class WeighedTaylorStepper(TaylorStepper):
    """As `TaylorStepper`, under the segments of a body whose weight varies; samples: the horizontal ones."""

    def __init__(self, run: Run, samples: Samples) -> None:
        super().__init__(run, samples)
        segments = run.batch.segments.weighed
        self.share, upwards = segments.share, segments.vertical
        shaken = run.batch.shaken
        self.ups = followed_by(upwards.s_start[:shaken], float(upwards.s_end[shaken - 1]))
        self.rises = gains(self.ups)
        self.highest, self.steepest_up = largest(self.ups), largest(self.rises)

    def march(self, waiting: Array) -> None:
        """Those that the ground does not fall away from before it lifts them."""
        if self.run.batch.free_fall is not None and waiting.size:
            waiting = self.run.end_free_fall(self.run.start(waiting)).cell
        super().march(waiting)

    def _degree(self, amplitude: Array, pace: Array) -> Array:
        """Terms grow with the root of the weight."""
        drive, sway = amplitude * np.maximum(2.0, self.steepest / pace), max(abs(x) for x in self.share) * amplitude
        added = sway * self.highest
        weight = np.maximum(added, sway * self.steepest_up / pace)
        return degrees(2.0 + drive + weight, pace * np.sqrt(1.0 + added), self.equation.tolerance)

    def _sway(self, outward: Array) -> Array:
        """zg''/g of s_v = 1."""
        return np.where(outward < 0.0, *self.share) * np.abs(outward)

    def _ramp(self, k: Array, outward: Array, pace: Array, factors: Array) -> Ramp:
        sway = self._sway(outward)
        weight = sway * self.ups.take(k)
        weight += 1.0
        return super()._ramp(k, outward, pace, factors)._replace(weight=(weight, sway * self.rises.take(k)))

    def _step(self, equation: Equation, y: Array, v: Array, peak: Array, ramp: Ramp, last: Array) -> tuple[Array, Array, Array]:
        end_y, end_v, proved = super()._step(equation, y, v, peak, ramp, last)
        assert ramp.weight is not None
        weight, heavier = ramp.weight
        proved &= np.minimum(weight, weight + heavier) > 0.0
        return end_y, end_v, proved
