"""The walk where the ground moves upwards too: between samples the drive and the weight are straight lines (`weight`).

Lemma 12 holds with L times the larger weight of a stretch's ends, while that is positive throughout.
"""

from __future__ import annotations

import numpy as np

from ...motions.segments import Samples, Segments
from ..equations.equation import Equation, Ramp
from ..equations.ramp import degrees, factors_for
from ..march.account import Work
from ..system import System
from ..weight import WeighedSegments
from .walk import Walk, Walkers

Array = np.ndarray


class WeighedWalk(Walk):
    """As `Walk`, under the segments of a body whose weight varies; samples: the horizontal ones."""

    def __init__(
        self, system: System, segments: Segments, samples: Samples, amplitude: Array, omega: Array, eta: Array, peaks: bool,
        pool: int | None,
    ) -> None:  # fmt: skip
        assert isinstance(segments, WeighedSegments)
        super().__init__(system, segments, samples, amplitude, omega, eta, peaks, pool)
        self.share, upwards = segments.share, segments.vertical
        self.ups = np.append(upwards.s_start, upwards.s_end[-1])
        self.rises = np.append(np.diff(self.ups), 0.0)

    @property
    def _weighed(self) -> WeighedSegments:
        assert isinstance(self.segments, WeighedSegments)
        return self.segments

    def _march(self, waiting: Array) -> None:
        """Those that the ground does not fall away from before it lifts them."""
        if self.drops is not None and waiting.size:
            waiting = self._drop(self.start(waiting)).cell
        super()._march(waiting)

    def _degree(self, amplitude: Array, pace: Array) -> Array:
        """Terms grow with the root of the weight."""
        drive, sway = amplitude * np.maximum(2.0, self.steepest / pace), max(abs(x) for x in self.share) * amplitude
        added = sway * np.abs(self.ups).max()
        weight = np.maximum(added, sway * np.abs(self.rises).max() / pace)
        return degrees(2.0 + drive + weight, pace * np.sqrt(1.0 + added), self.equation.tolerance)

    def _sway(self, outward: Array) -> Array:
        """zg''/g of s_v = 1."""
        return np.where(outward < 0.0, *self.share) * np.abs(outward)

    def _ramp(self, k: Array, outward: Array, pace: Array, factors: Array) -> Ramp:
        sway = self._sway(outward)
        weight = sway * self.ups.take(k)
        weight += 1.0
        return super()._ramp(k, outward, pace, factors)._replace(weight=(weight, sway * self.rises.take(k)))

    def _stride(self, equation: Equation, y: Array, v: Array, peak: Array, ramp: Ramp, last: Array) -> tuple[Array, Array, Array]:
        end_y, end_v, proved = super()._stride(equation, y, v, peak, ramp, last)
        assert ramp.weight is not None
        weight, heavier = ramp.weight
        proved &= np.minimum(weight, weight + heavier) > 0.0
        return end_y, end_v, proved

    def _careful(self, lanes: Walkers) -> Walkers:
        """A round of the march, and the rest of the interval after it where that can be walked."""
        past = lanes.k >= len(self.segments)
        if past.any():
            self._ended(lanes, np.flatnonzero(past))
            lanes = lanes.take(np.flatnonzero(~past))
        walked = np.flatnonzero((lanes.u == 0.0) & (lanes.y > 0.0))
        k, side = lanes.k[walked], lanes.side[walked]
        drive = lanes.outward[walked] * self.segments.s_start[k]
        weight = self._weighed.weight(side, lanes.amplitude[walked], k, lanes.u[walked])
        lanes.b[walked] = self.equation.on(side, lanes.cell[walked]).force(lanes.y[walked], drive, weight)
        going = self.round(lanes).going
        assert isinstance(going, Walkers)
        going.pace, going.outward = self.step / going.omega, -going.side * going.amplitude
        if len(self.cells.amplitude) > 1:  # the other edge has its own
            going.degree = self._degree(going.amplitude, going.pace)
        self._rest_of_interval(going)
        return going

    def _rest_of_interval(self, lanes: Walkers) -> None:
        """Lanes inside an interval, after an impact, on to its end where that is proved."""
        at = np.flatnonzero((lanes.u > 0.0) & (lanes.k < self.last) & (lanes.v > 0.0))
        if not at.size:
            return
        some = lanes.take(at)
        share = some.u / self.step
        left = 1.0 - share
        unit = some.pace * left
        whole = self._ramp(some.k, some.outward, unit, factors_for(unit, some.degree))
        assert whole.weight is not None
        (weight, heavier), drive = whole.weight, whole.drive + whole.gain * share
        ramp = whole._replace(drive=drive, gain=whole.gain * left, weight=(weight + heavier * share, heavier * left))
        last = some.degree * at.size + np.arange(at.size)
        y, v, proved = self._stride(self.equation.on(some.side, some.cell), some.y, some.v, some.peak, ramp, last)
        on = np.flatnonzero(proved)
        at = at[on]
        lanes.k[at], lanes.u[at] = some.k[on] + 1, 0.0
        lanes.y[at], lanes.v[at], lanes.peak[at] = y[on], v[on], np.maximum(some.peak[on], y[on])

    def _lost(self, lanes: Walkers, at: Array) -> Array:
        """Walking lanes that nothing can bring back (Lemma 6)."""
        at = at[lanes.y[at] + lanes.v[at] > 1.0]
        side, cell = lanes.side[at], lanes.cell[at]
        inward = self._weighed.hardest(side, lanes.amplitude[at], lanes.k[at])
        at = at[self.equation.on(side, cell).certainly_overturns(lanes.y[at], lanes.v[at], inward, False)]
        self._overturn(lanes, at)
        self.work += Work(certain_overturning=at.size)
        return at
