"""Taylor steps over samples, for cells of any equation under a record; rounds of the
march where an event may happen. A step is taken where Lemma 12 proves that it holds no
impact and no peak above the highest one so far.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...motions.blocks import largest
from ...motions.segments import Samples, followed_by
from ..condition import moved, slope_between
from ..equations.equation import Drive, Equation
from ..equations.recurrence import Rows, motion_terms
from ..equations.taylor import WITHIN, degrees, factors_for, last_terms
from ..lanes import Array
from ..march.engine import Run
from ..observers.observer import TaylorSteps
from .stepper import PooledLanes, SampleStepper, gains

LANES = 32768  # lanes: the cost of a round depends on its calls more than on its lanes
_STEPS = 16  # Taylor steps in one call of `propagate`
_CARRIED = 0.5  # tau over which the moments are carried at once, at most
# share of the limit of y: beyond it the march decides whether the body overturns
_NEARLY = 0.9


@dataclass
class SteppingLanes(PooledLanes):
    """Lanes in the pool that take Taylor steps."""

    degree: Array  # degree of the Taylor series of each lane, (lanes,)


class TaylorStepper(SampleStepper[SteppingLanes]):
    """Advances the cells of a `Run` by Taylor steps from sample to sample of a record;
    for every equation.
    """

    def __init__(self, run: Run, samples: Sequence[Samples]) -> None:
        super().__init__(run, samples)
        self.steepest = np.array([largest(gains(one)) for one in self.values])[
            self.motion
        ]

    def prepare(self, lanes: PooledLanes) -> SteppingLanes:
        return lanes.extended(SteppingLanes, degree=self._degree(lanes))

    def _degree(self, lanes: PooledLanes) -> Array:
        """Degree of the series of each lane, enough for speeds that are usual in
        rocking.
        """
        drive = lanes.amplitude * np.maximum(
            2.0, self.steepest.take(lanes.cell) / lanes.pace
        )
        return degrees(2.0 + drive, lanes.pace, self.equation.tolerance)

    def propagate(self, lanes: SteppingLanes, at: Array) -> Array:
        """Take several Taylor steps. A lane stops when a step is not proved."""
        own, go = lanes.take(at), np.ones(at.size, dtype=bool)
        equation, end = self.equation.on(own.side, own.cell), self.last.take(own.cell)
        factors = factors_for(own.pace, own.degree)
        last = own.degree * at.size + np.arange(at.size)
        # The moments change so slowly that they are carried over several steps at once.
        every = max(1, int(_CARRIED / own.pace.max(initial=_CARRIED)))
        started = own.take(slice(None))
        for n in range(_STEPS):
            ramp = self._ramp(own.segment, own.outward, own.pace)
            y, v, proved = self._step(equation, own, ramp, factors, last)
            go &= proved
            for observer in self.run.observers:
                taken = (own.y, own.v), (y, v)
                observer.steps(
                    TaylorSteps(own.cell, own.side, equation, *taken, ramp), go
                )
            own.y, own.v = np.where(go, y, own.y), np.where(go, v, own.v)
            own.peak = np.where(go, np.maximum(own.peak, y), own.peak)
            own.segment = own.segment + go
            if self.run.batch.peaks and n % every == every - 1:
                self._carry(equation, started, own)
                started = own.take(slice(None))
            go &= own.segment < end
            if not go.any():
                break
        if self.run.batch.peaks:
            self._carry(equation, started, own)
        lanes.segment[at], lanes.peak[at] = own.segment, own.peak
        lanes.y[at], lanes.v[at] = own.y, own.v
        lanes.moments[:, at] = own.moments
        return go

    def _carry(
        self, equation: Equation, started: SteppingLanes, own: SteppingLanes
    ) -> None:
        """Carry the moments of lanes over the steps since they `started`."""
        time = (own.segment - started.segment) * own.pace
        states = (started.y, started.v), (own.y, own.v)
        slope = slope_between(equation, *states, time)
        own.moments[:3] = moved(own.moments, time, slope, equation.damping)

    def _ramp(self, k: Array, outward: Array, pace: Array) -> Drive:
        """The drive of lanes from sample k to the next one."""
        return Drive(
            Rows.of(outward * self.samples.take(k), outward * self.gains.take(k)), pace
        )

    def _step(
        self,
        equation: Equation,
        own: SteppingLanes,
        ramp: Drive,
        factors: Array,
        last: Array,
    ) -> tuple[Array, ...]:
        """(y, y', True if neither an impact nor a higher peak occurs on the way (Lemma
        12)) at the end of a straight line; factors, last: as of `motion_terms` and
        `last_terms`.
        """
        unit = ramp.unit
        terms = motion_terms(
            equation, own.y, own.v, unit, factors, ramp.terms, ramp.weight
        )
        first, drop = terms[1], _drop(equation, ramp)

        # No impact, and a series that holds.
        proved = _no_impact(own.y, first, drop, unit, equation.damping)
        proved &= last_terms(terms, last, unit) <= WITHIN * equation.tolerance * unit

        # The end lies above the ground and well below the limit.
        end_y, end_v = _sums(terms)
        end_y += own.y
        proved &= (end_y > 0.0) & (end_y < _NEARLY * equation.limit)

        # No peak that may be above the highest one so far.
        rise, higher = first, 0.125 * drop
        if equation.damping:
            lag = equation.damping * unit
            rise, higher = first * (1.0 - 2.0 * lag), higher * np.exp(2.0 * lag)
        higher += np.maximum(own.y, end_y)
        proved &= ~((higher > own.peak) & (rise < drop) & (end_v > -drop))
        end_v /= unit
        return end_y, end_v, proved

    def after_round(self, lanes: SteppingLanes) -> None:
        """Take lanes that are inside an interval after an impact to its end, where a
        Taylor step is proved; `propagate` would cost more.
        """
        super().after_round(lanes)
        if len(self.cells.amplitude) > 1:  # the other edge needs another degree
            lanes.degree = self._degree(lanes)
        at = np.flatnonzero(
            (lanes.phase > 0.0)
            & (lanes.segment < self.last.take(lanes.cell))
            & (lanes.v > 0.0)
        )
        if not at.size:
            return
        some = lanes.take(at)
        equation = self.equation.on(some.side, some.cell)
        share = some.phase / self.step.take(some.cell)
        factors = factors_for(some.pace * (1.0 - share), some.degree)
        last = some.degree * at.size + np.arange(at.size)
        ramp = self._ramp(some.segment, some.outward, some.pace).after(share)
        y, v, proved = self._step(equation, some, ramp, factors, last)
        for observer in self.run.observers:
            taken = (some.y, some.v), (y, v)
            observer.steps(
                TaylorSteps(some.cell, some.side, equation, *taken, ramp), proved
            )
        on = np.flatnonzero(proved)
        at = at[on]
        lanes.segment[at], lanes.phase[at] = some.segment[on] + 1, 0.0
        lanes.y[at], lanes.v[at] = y[on], v[on]
        lanes.peak[at] = np.maximum(some.peak[on], y[on])
        if self.run.batch.peaks:
            slope = slope_between(equation, (some.y, some.v), (y, v), ramp.unit)
            carried = moved(some.moments, ramp.unit, slope, equation.damping)
            lanes.moments[:3, at] = carried[:, on]


def _drop(equation: Equation, ramp: Drive) -> Array:
    """K h^2 of Lemma 12, K = w_+ L + M max(0, -a), along straight lines of duration
    h.
    """
    drive, gain = ramp.line
    drop = np.minimum(drive, drive + gain)
    np.minimum(drop, 0.0, out=drop)
    lift, push = equation.bounds
    drop *= -push
    weight, heavier = ramp.weight_line
    drop += lift * np.maximum(weight, weight + heavier)
    drop *= ramp.unit
    drop *= ramp.unit
    return np.asarray(drop)


def _no_impact(
    y: Array, first: Array, drop: Array, unit: Array, damping: float
) -> Array:
    """True where no impact comes on a step of duration `unit` (Lemma 12); first: h y'
    at its start; drop: K h^2.
    """
    low = y + first
    low -= 0.5 * drop
    if damping:
        low -= damping * unit * np.abs(first)
    return np.asarray(low > 0.0)


def _sums(terms: Array) -> tuple[Array, Array]:
    """(sum of the terms from 1 on, sum of n times term n), (lanes,)."""
    top = len(terms) - 1
    end_y, end_v = terms[top].copy(), terms[top].copy()
    for n in range(top - 1, 0, -1):
        end_y += terms[n]
        end_v += end_y
    return end_y, end_v


class WeighedTaylorStepper(TaylorStepper):
    """A `TaylorStepper` for bodies whose weight varies; samples: those of the
    horizontal motion.
    """

    def __init__(self, run: Run, samples: Sequence[Samples]) -> None:
        super().__init__(run, samples)
        segments = run.batch.segments.weighed
        # zg''/g of s_v = 1 over the outward drive of A = 1, on the right and the left
        self.share, upwards = segments.share, segments.vertical
        shaken = run.batch.shaken
        # The vertical motion at the samples of the horizontal one.
        self.vertical = followed_by(
            upwards.s_start[:shaken], float(upwards.s_end[shaken - 1])
        )
        self.vertical_gains = gains(self.vertical)
        self.largest_vertical = largest(self.vertical)
        self.steepest_vertical = largest(self.vertical_gains)

    def march(self, waiting: Array) -> None:
        """March the cells that are lifted before the ground falls away from them;
        finish the others.
        """
        if self.run.batch.free_fall is not None and waiting.size:
            waiting = self.run.end_free_fall(self.run.start(waiting)).cell
        super().march(waiting)

    def _degree(self, lanes: PooledLanes) -> Array:
        """As `TaylorStepper._degree`; the number of terms grows with the root of the
        weight.
        """
        amplitude, pace = lanes.amplitude, lanes.pace
        drive = amplitude * np.maximum(2.0, self.steepest.take(lanes.cell) / pace)
        sway = max(abs(x) for x in self.share) * amplitude
        added = sway * self.largest_vertical
        weight = np.maximum(added, sway * self.steepest_vertical / pace)
        return degrees(
            2.0 + drive + weight, pace * np.sqrt(1.0 + added), self.equation.tolerance
        )

    def _ramp(self, k: Array, outward: Array, pace: Array) -> Drive:
        # zg''/g of s_v = 1
        sway = np.where(outward < 0.0, *self.share) * np.abs(outward)
        weight = sway * self.vertical.take(k)
        weight += 1.0
        return (
            super()
            ._ramp(k, outward, pace)
            ._replace(weight=Rows.of(weight, sway * self.vertical_gains.take(k)))
        )

    def _step(
        self,
        equation: Equation,
        own: SteppingLanes,
        ramp: Drive,
        factors: Array,
        last: Array,
    ) -> tuple[Array, ...]:
        y, v, proved = super()._step(equation, own, ramp, factors, last)
        weight, heavier = ramp.weight_line
        proved &= np.minimum(weight, weight + heavier) > 0.0
        return y, v, proved
