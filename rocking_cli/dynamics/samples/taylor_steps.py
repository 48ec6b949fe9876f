"""Taylor steps over samples: cells of any equation under a record, in rounds of the march where an event may happen.

Between samples the drive is a straight line, over which a short Taylor series carries a lane (`equations.ramp`). A step is taken where
Lemma 12 proves that it holds no impact and no peak above the highest one; other lanes wait until enough have gathered for a round.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from ...motions.blocks import largest
from ...motions.segments import Samples
from ..equations.equation import Equation, Ramp
from ..equations.ramp import WITHIN, degrees, factors_for, last_terms
from ..lanes import Lanes
from ..march.engine import Run, WindowStepper
from ..observers.observer import TaylorSteps
from ..outcome import Outcome
from .bounded import LONGEST

Array = np.ndarray

LANES = 32768  # lanes: a round of the march costs calls, not lanes
_BLOCK = 5056  # lanes that step together: what they need fits the second-level cache, and no power of two lies between its rows
_STEPS, _NARROW = 4, 16  # in a row, before lanes that wait get their round: of many lanes, and of fewer than a block
_NEARLY = 0.9  # part of the displacement from which a body has overturned: beyond it the march judges


@dataclass
class SteppingLanes(Lanes):
    """Lanes that can take steps: those with u = 0, whose b is not kept.

    pace: tau between samples; outward: the outward drive of s = 1; degree: of the series; slot: place in the pool.
    """

    pace: Array
    outward: Array
    degree: Array
    slot: Array


class TaylorStepper:
    """How a run of any equation goes from sample to sample of a record."""

    def __init__(self, run: Run, samples: Samples) -> None:
        self.run, self.samples, self.gains = run, samples.values, gains(samples.values)
        self.equation, self.cells, self.segments = run.batch.equation, run.batch.cells, run.batch.segments
        self.step, self.last = samples.step, samples.values.size - 1
        self.steepest = largest(self.gains)

    def march(self, waiting: Array) -> None:
        """Those of like pace together; from window to window where samples are far apart."""
        pace = (self.step / self.cells.omega[:, waiting]).max(axis=0)
        WindowStepper(self.run).march(waiting[pace > LONGEST])
        waiting, pace = waiting[pace <= LONGEST], pace[pace <= LONGEST]
        if waiting.size:
            with np.errstate(all="ignore"):
                self._advance(waiting[np.argsort(pace, kind="stable")])

    def _advance(self, waiting: Array) -> None:
        """Advance these cells, as many at once as the pool holds, until all are done."""
        taken = min(self.run.pool, waiting.size)
        lanes = self._launch(self.run.start(waiting[:taken]), np.arange(taken))
        free = np.zeros(taken, dtype=bool)
        ready = self._can_step(lanes)
        while lanes.cell.size:
            self._in_blocks(lanes, ready)
            stopped = np.flatnonzero(~(ready | free))
            going = self._careful(lanes.take(stopped))
            free[stopped] = True
            lanes.put(going.slot, going)
            free[going.slot], ready[going.slot] = False, self._can_step(going)
            lost = self._lost(lanes, np.flatnonzero(ready))
            free[lost], ready[lost] = True, False
            places = np.flatnonzero(free)
            more = min(places.size, waiting.size - taken)
            if more:
                new = self._launch(self.run.start(waiting[taken : taken + more]), places[:more])
                taken += more
                lanes.put(new.slot, new)
                free[new.slot], ready[new.slot] = False, self._can_step(new)
            elif 4 * places.size >= free.size:
                keep = np.flatnonzero(~free)
                lanes, ready, free = lanes.take(keep), ready[keep], free[keep]
                lanes.slot = np.arange(keep.size)

    def _can_step(self, lanes: SteppingLanes) -> Array:
        """Whether lanes stand at a sample from which they can take a step."""
        return (lanes.u == 0.0) & (lanes.k < self.last)

    def _launch(self, lanes: Lanes, slot: Array) -> SteppingLanes:
        """Lanes with what they need for steps."""
        own = {f.name: getattr(lanes, f.name) for f in fields(Lanes)}
        pace = self.step / lanes.omega
        degree = self._degree(lanes.amplitude, pace)
        return SteppingLanes(**own, pace=pace, outward=-lanes.side * lanes.amplitude, degree=degree, slot=slot)

    def _degree(self, amplitude: Array, pace: Array) -> Array:
        """Degree of the series of lanes, for speeds that rocking usually has."""
        return degrees(2.0 + amplitude * np.maximum(2.0, self.steepest / pace), pace, self.equation.tolerance)

    def _in_blocks(self, lanes: SteppingLanes, ready: Array) -> None:
        """Some steps of all lanes that are `ready`, in blocks of like degree, whose series have no rows of zeros. A lane stops where a step
        is not proved."""
        at = np.flatnonzero(ready)
        at = at[np.argsort(lanes.degree[at].astype(np.int8), kind="stable")]
        steps = _STEPS if at.size > _BLOCK else _NARROW
        for first in range(0, at.size, _BLOCK):
            self._block(lanes, at[first : first + _BLOCK], ready, steps)

    def _block(self, lanes: SteppingLanes, at: Array, ready: Array, steps: int) -> None:
        k, y, v, peak, pace, outward, degree = (
            getattr(lanes, name).take(at) for name in ("k", "y", "v", "peak", "pace", "outward", "degree")
        )
        go, side, cell = np.ones(at.size, dtype=bool), lanes.side[at], lanes.cell[at]
        equation = self.equation.on(side, cell)
        factors, last = factors_for(pace, degree), degree * at.size + np.arange(at.size)
        for _ in range(steps):
            ramp = self._ramp(k, outward, pace, factors)
            end_y, end_v, proved = self._step(equation, y, v, peak, ramp, last)
            go &= proved
            for observer in self.run.observers:
                observer.steps(TaylorSteps(cell, side, equation, (y, v), (end_y, end_v), ramp), go)
            y, v, peak = np.where(go, end_y, y), np.where(go, end_v, v), np.where(go, np.maximum(peak, end_y), peak)
            k += go
            go &= k < self.last
            if not go.any():
                break
        lanes.k[at], lanes.y[at], lanes.v[at], lanes.peak[at], ready[at] = k, y, v, peak, go

    def _ramp(self, k: Array, outward: Array, pace: Array, factors: Array) -> Ramp:
        """What drives lanes from sample k to the next."""
        return Ramp(outward * self.samples.take(k), outward * self.gains.take(k), pace, factors)

    def _step(self, equation: Equation, y: Array, v: Array, peak: Array, ramp: Ramp, last: Array) -> tuple[Array, Array, Array]:
        """y and y' at the end of a ramp, and whether it is proved that nothing happens on the way (Lemma 12)."""
        terms = equation.ramp_terms(y, v, ramp)
        hop, unit = terms[1], ramp.unit
        drop = np.minimum(ramp.drive, ramp.drive + ramp.gain)
        np.minimum(drop, 0.0, out=drop)
        lift, push = equation.bounds
        drop *= -push
        drop += lift if ramp.weight is None else lift * np.maximum(ramp.weight[0], ramp.weight[0] + ramp.weight[1])
        drop *= unit
        drop *= unit  # K h^2
        low = y + hop
        low -= 0.5 * drop
        rise, higher = hop, 0.125 * drop
        if equation.damping:
            lag = equation.damping * unit
            low -= lag * np.abs(hop)
            rise, higher = hop * (1.0 - 2.0 * lag), higher * np.exp(2.0 * lag)
        proved = low > 0.0
        proved &= last_terms(terms, last, unit) <= WITHIN * equation.tolerance * unit
        top = len(terms) - 1
        end_y, end_v = terms[top].copy(), terms[top].copy()
        for n in range(top - 1, 0, -1):
            end_y += terms[n]
            end_v += end_y  # in the end n times term n
        end_y += y
        proved &= (end_y > 0.0) & (end_y < _NEARLY * equation.limit)
        higher += np.maximum(y, end_y)
        high = higher > peak
        high &= rise < drop
        high &= end_v > -drop
        np.logical_not(high, out=high)
        proved &= high
        end_v /= unit
        return end_y, end_v, proved

    def _careful(self, lanes: SteppingLanes) -> SteppingLanes:
        """A round of the march, and the rest of the interval after it where a step is proved."""
        past = lanes.k >= len(self.segments)
        if past.any():
            self._ended(lanes, np.flatnonzero(past))
            lanes = lanes.take(np.flatnonzero(~past))
        at_sample = np.flatnonzero((lanes.u == 0.0) & (lanes.y > 0.0))
        self.run.push(lanes, at_sample)
        going = self.run.round(lanes)
        going.pace, going.outward = self.step / going.omega, -going.side * going.amplitude
        if len(self.cells.amplitude) > 1:  # the other edge has its own
            going.degree = self._degree(going.amplitude, going.pace)
        self._rest_of_interval(going)
        return going

    def _rest_of_interval(self, lanes: SteppingLanes) -> None:
        """Lanes inside an interval, after an impact, on to its end where that is proved."""
        at = np.flatnonzero((lanes.u > 0.0) & (lanes.k < self.last) & (lanes.v > 0.0))
        if not at.size:
            return
        some = lanes.take(at)
        share = some.u / self.step
        factors = factors_for(some.pace * (1.0 - share), some.degree)
        ramp = self._ramp(some.k, some.outward, some.pace, factors).after(share)
        last = some.degree * at.size + np.arange(at.size)
        equation = self.equation.on(some.side, some.cell)
        y, v, proved = self._step(equation, some.y, some.v, some.peak, ramp, last)
        for observer in self.run.observers:
            observer.steps(TaylorSteps(some.cell, some.side, equation, (some.y, some.v), (y, v), ramp), proved)
        on = np.flatnonzero(proved)
        at = at[on]
        lanes.k[at], lanes.u[at] = some.k[on] + 1, 0.0
        lanes.y[at], lanes.v[at], lanes.peak[at] = y[on], v[on], np.maximum(some.peak[on], y[on])

    def _ended(self, lanes: SteppingLanes, past: Array) -> None:
        """Undamped lanes that have come to the end of the shaking."""
        failed = ~np.isfinite(lanes.y[past])
        self.run.finish(lanes, past[failed], Outcome.FAILED, np.nan)
        self.run.end_shaking(lanes.take(past[~failed]))

    def _lost(self, lanes: SteppingLanes, at: Array) -> Array:
        """Lanes between samples that nothing can bring back (Lemma 6)."""
        at = at[lanes.y[at] + lanes.v[at] > 1.0]
        at = at[self.run.batch.cannot_return(lanes, at, lanes.k[at], lanes.y[at], lanes.v[at])]
        self.run.overturn(lanes, at)
        return at


def gains(samples: Array) -> Array:
    """How much s grows over the interval after each sample, 0 after the last."""
    return np.append(np.diff(samples), 0.0)
