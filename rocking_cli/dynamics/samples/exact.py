"""Exact propagation of the undamped linear oscillator over many samples of a record, each proved free of impacts (Lemma 11).

A lane that cannot be propagated takes its present interval alone, where the drive is a ramp, with the sign tests of the march.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace

import numpy as np

from ...motions.segments import Samples
from ..drive import place
from ..lanes import Lanes
from ..march.account import Work
from ..march.engine import STILL, Run, WindowStepper
from ..observers.observer import Arcs
from ..outcome import Outcome
from .bounded import LONGEST, LONGEST_STRETCH, bounded_response, shares
from .interval import raise_peaks, through_interval
from .peaks import Rise, peak_heights
from .propagation import ExactLanes, Propagation, horizon
from .ramp import RampFlow
from .stretches import stretches

Array = np.ndarray

LANES = 65536  # lanes: fewer rounds outweigh what no longer fits any cache
_TABLES = 1 << 25  # bytes of tables at a time
_LEAST = 1e-8  # over 1 + A: a displacement below it, which a propagation knows to 1e-15 only, is left to single intervals
_STRAGGLERS = 8  # one in so many lanes may still be propagated when the others take their intervals; as many at rest are lifted together
_STATE = ("k", "u", "y", "v", "peak")  # what a propagation changes in a lane of the pool
_FIXED = ("slot", "cell", "amplitude", "omega", "eta")  # what no interval changes in it, the last three where the sides are alike
_SURELY = 1.0 - 1e-6  # part of a horizon that is used: y at a propagation's end may be off by 1e-15 of 1e-8


@dataclass
class PooledLanes(Lanes):
    """Lanes of the pool; slot: place in it."""

    slot: Array


class ExactStepper:
    """How a run of the undamped linear oscillator goes through a record."""

    def __init__(self, run: Run, samples: Samples) -> None:
        self.run, batch = run, run.batch
        self.equation, self.contact, self.cells, self.segments = batch.equation, batch.contact, batch.cells, batch.segments
        self.samples, self.step, self.last = samples.values, samples.step, samples.values.size - 1
        self.changing = [f.name for f in fields(PooledLanes) if f.name not in (_FIXED if self.contact.alike else _FIXED[:2])]
        self.rows = np.zeros(self.cells.omega.shape, dtype=np.int64)

    def march(self, waiting: Array) -> None:
        """Those of few frequencies together, so that their tables stay small; from window to window where samples are far apart."""
        pace = self.step / self.cells.omega[:, waiting]
        far = (pace > LONGEST).any(axis=0)
        WindowStepper(self.run).march(waiting[far])
        waiting, pace = waiting[~far], pace[:, ~far]
        if not waiting.size:
            return
        self.stretches = stretches(self.samples, 1 + math.ceil(math.log2(self.last)))
        paces, which = np.unique(pace, return_inverse=True)
        which = which.reshape(pace.shape)
        order = np.argsort(which[0], kind="stable")
        for some in shares(order, which[0][order], max(1, _TABLES // (16 * len(pace) * self.samples.size))):
            mine, row = np.unique(which[:, some], return_inverse=True)
            self.bounded = bounded_response(self.samples, paces[mine]).ravel()
            self.rows[:, waiting[some]] = row.reshape(len(pace), -1) * self.samples.size
            self._advance(np.sort(waiting[some]))

    def _advance(self, waiting: Array) -> None:
        """Keep a pool of lanes moving until these cells are done."""
        with np.errstate(all="ignore"):
            taken = min(self.run.pool, waiting.size)
            self.free, self.waits = np.zeros(taken, dtype=bool), np.zeros(taken, dtype=bool)
            self.top = np.zeros(taken)  # peaks in propagations since the last interval that was taken alone
            self.pooled = self._begin(waiting[:taken], np.arange(taken))
            self.resting: list[PooledLanes] = []
            moving = self._launch(self.pooled)
            while moving.k.size or self.resting or self.waits.any():
                moving = self._propagate(moving)
                parts = [moving, self._alone()]
                at_rest = sum(lanes.k.size for lanes in self.resting)
                going = sum(lanes.k.size for lanes in parts) or self.waits.any()
                if at_rest and (_STRAGGLERS * at_rest >= np.count_nonzero(~self.free) or not going):
                    parts.append(self._lift())
                places = np.flatnonzero(self.free)[: waiting.size - taken]
                if places.size:
                    new = self._begin(waiting[taken : taken + places.size], places)
                    taken += places.size
                    parts.append(self._onto(new))
                moving = ExactLanes.joined(parts)

    def _begin(self, cells: Array, slot: Array) -> PooledLanes:
        """These cells at their first uplift."""
        lanes = self.run.start(cells)
        lanes.k, lanes.u = place(self.segments, lanes.k, lanes.u)
        self.top[slot] = 0.0
        return PooledLanes(**{f.name: getattr(lanes, f.name) for f in fields(Lanes)}, slot=slot)

    def _gain(self, k: Array) -> Array:
        """How much s grows over the interval after sample k, 0 after the last."""
        return self.samples.take(np.minimum(k + 1, self.last)) - self.samples.take(k)

    def _launch(self, lanes: PooledLanes) -> ExactLanes:
        """Lanes ready to be propagated: their state as modes about the bounded response, at the next sample."""
        n = lanes.k + (lanes.u > 0.0)
        row, k, inside = self.rows[self.cells.row(lanes.side), lanes.cell], lanes.k, lanes.u > 0.0
        pace = self.step / lanes.omega
        drive = -lanes.side * lanes.amplitude
        left = (pace - lanes.u / lanes.omega) * inside
        there = RampFlow(lanes.y, lanes.v, lanes.b, drive * self._gain(k) / pace).at(left)
        bounded = self.bounded.take(row + n)
        y, v = there.y - 1.0 - drive * bounded.real, there.v - drive * bounded.imag
        fall = (lanes.v + np.sqrt(lanes.v * lanes.v - 2.0 * lanes.b * lanes.y)) / -lanes.b
        top = np.minimum(np.frexp(LONGEST_STRETCH / pace)[1] - 1, self.stretches.levels - 1).astype(np.int64)
        level = np.clip(np.frexp(np.where(fall > 0.0, 0.5 * fall / pace, 8.0))[1], 0, top).astype(np.int64)
        state = (lanes.k, lanes.u, lanes.y, lanes.v, lanes.peak, np.ones(k.shape, dtype=bool))
        return ExactLanes(lanes.slot, *state, 0.5 * (y + v), 0.5 * (y - v), drive, pace, row, level, top)

    def _propagate(self, moving: ExactLanes) -> ExactLanes:
        """Propagate lanes until few are left, which are returned; the others wait until they take their interval alone."""
        most = moving.k.size // _STRAGGLERS
        self.rises: list[Rise] = []
        while moving.k.size > most:
            moving = self._once(moving)
        if self.rises:  # all at once
            arcs = Rise.joined(self.rises)
            np.maximum.at(self.top, arcs.lanes.slot, peak_heights(arcs, self.bounded, self.samples))
        return moving

    def _once(self, lanes: ExactLanes) -> ExactLanes:
        """One propagation of each of these lanes; those that were held up before wait, the others are returned."""
        least = np.abs(lanes.drive) * self.stretches.at((lanes.drive > 0.0) * self.stretches.face, lanes.level, lanes.k)  # outward drive
        time, fall = horizon(lanes.y, lanes.v, least)
        past = lanes.u * (1.0 / self.step)  # samples since the start of the interval
        ahead = np.fmin(past + time * (_SURELY / lanes.pace), np.minimum(np.left_shift(1, lanes.level), self.last - lanes.k))
        goes = (ahead >= 1.0) & lanes.may
        self._wait(lanes, goes, self._lost(lanes))
        count = ahead.astype(np.int64)
        if not goes.all():
            go = np.flatnonzero(goes)
            lanes, count, ahead, past, fall = lanes.take(go), count[go], ahead[go], past[go], fall[go]
        to = lanes.k + count
        grown = np.exp((count - (lanes.u > 0.0)) * lanes.pace)  # where u is 0 the modes belong to this sample, else to the next
        up, down = lanes.up * grown, lanes.down / grown
        bounded = self.bounded.take(lanes.row + to)
        y, v = lanes.drive * bounded.real, lanes.drive * bounded.imag
        y += up + down
        y += 1.0
        v += up - down
        may = y >= _LEAST * (1.0 + np.abs(lanes.drive))
        peak = np.maximum(lanes.peak, y)
        level = np.minimum(np.frexp(ahead)[1], lanes.top)
        held = self._doubtful(lanes, Propagation(to, y, v, peak, fall, (count - past) * lanes.pace), may)
        may[held[count[held] == 1]] = False
        held = held[count[held] > 1]
        level[held] = np.frexp(count[held] // 2)[1] - 1
        new = replace(lanes, k=to, u=np.zeros(to.size), y=y, v=v, peak=peak, up=up, down=down)
        back = np.concatenate([np.flatnonzero(~may), held])
        new.put(back, lanes.take(back))
        return replace(new, may=may, level=level)

    def _wait(self, lanes: ExactLanes, goes: Array, lost: Array) -> None:
        """Lay those that do not go into the pool, where they wait; those that are lost, which do not go either, make room there."""
        self.free[lanes.slot[lost]] = True
        goes[lost] = True
        stay = np.flatnonzero(~goes)
        goes[lost] = False
        slot = lanes.slot[stay]
        self.waits[slot] = True
        self.pooled.b[slot[lanes.k[stay] != self.pooled.k[slot]]] = np.nan  # after a propagation
        for name in _STATE:
            getattr(self.pooled, name)[slot] = getattr(lanes, name)[stay]

    def _lost(self, lanes: ExactLanes) -> Array:
        """Lanes that nothing to come can bring back (Lemma 6)."""
        lost = np.flatnonzero(lanes.y + lanes.v > 1.0)
        lost = lost[lanes.k[lost] < self.last]
        if lost.size:
            k, drive = lanes.k[lost], lanes.drive[lost]
            inward = np.where(drive < 0.0, -drive * self.segments.later_max[k], -drive * self.segments.later_min[k])
            lost = lost[self.equation.certainly_overturns(lanes.y[lost], lanes.v[lost], inward)]
            self.run.overturn(self._as_they_are(lanes, lost), np.arange(lost.size))
        return lost

    def _as_they_are(self, lanes: ExactLanes, at: Array) -> PooledLanes:
        """The lanes of the pool with the state that they have come to by propagation."""
        some = self.pooled.take(lanes.slot[at])
        for name in _STATE:
            setattr(some, name, getattr(lanes, name)[at])
        return some

    def _doubtful(self, lanes: ExactLanes, step: Propagation, proved: Array) -> Array:
        """Lanes whose propagation may hold a peak above the highest one that is not found, by Lemma 11: they go half as far."""
        if not self.run.batch.peaks:
            return np.zeros(0, dtype=np.int64)
        highest = np.maximum(lanes.y, step.y) + 0.125 * step.fall * step.time * step.time
        high = np.flatnonzero((highest > step.peak) & proved)
        y, v, time, end_v = lanes.y[high], lanes.v[high], step.time[high], step.v[high]
        pull = self._strongest(lanes, high) - 1.0
        start, end = y + pull, step.y[high] + pull
        rises = end_v >= np.maximum(end, 0.0) * (0.5 * time)  # no more than at the end
        falls = -v >= np.maximum(start, 0.0) * (0.5 * time)
        top = np.where((start < 0.0) & (v > 0.0), y + v * v / (-start + np.sqrt(start * start - v * v)), np.inf)
        doubt = ~(rises | falls | (top <= step.peak[high]))
        single = doubt & (highest[high] + pull < 0.0) & (v > 0.0) & (end_v < 0.0) & (lanes.u[high] == 0.0)
        at = high[single]
        self.rises.append(Rise(lanes.take(at), step.to[at], step.v[at]))
        held = high[doubt & ~single]
        cell, side = self.pooled.cell[lanes.slot], self.pooled.side[lanes.slot]
        for observer in self.run.observers:
            held = np.union1d(held, observer.propagates(cell, side, lanes, step, proved, lambda at: self._strongest(lanes, at)))
        return held

    def _strongest(self, lanes: ExactLanes, at: Array) -> Array:
        """Upper bound of the outward drive over the windows of these lanes."""
        drive = lanes.drive[at]
        return -np.abs(drive) * self.stretches.at((drive < 0.0) * self.stretches.face, lanes.level[at], lanes.k[at])

    def _alone(self) -> ExactLanes:
        """The lanes that wait through their present interval; those that are ready to be propagated again."""
        before, at = len(self.resting), np.flatnonzero(self.waits)
        self.pooled.peak[at] = np.maximum(self.pooled.peak[at], self.top[at])
        self.top[at], self.waits[at], self.free[at] = 0.0, False, True
        over = self.pooled.k[at] >= self.last
        self._end(self.pooled.take(at[over]))
        going = self._single(self.pooled.take(at[~over]))
        for lanes in self.resting[before:]:
            self.free[lanes.slot] = False
        for name in self.changing:
            getattr(self.pooled, name)[going.slot] = getattr(going, name)
        self.free[going.slot] = False
        low = (going.y == 0.0) & (2.0 * going.v * going.omega < -going.b * (self.step - going.u))  # bounces within this interval
        self.waits[going.slot[low]] = True
        return self._launch(going.take(np.flatnonzero(~low)))

    def _end(self, lanes: PooledLanes) -> None:
        """The outcome of the free motion of lanes that are at the end of the shaking."""
        failed = ~np.isfinite(lanes.y)
        self.run.finish(lanes, np.flatnonzero(failed), Outcome.FAILED, np.nan)
        self.run.end_shaking(lanes.take(np.flatnonzero(~failed)))

    def _onto(self, lanes: PooledLanes) -> ExactLanes:
        """These lanes in their slots of the pool, and ready to be propagated."""
        self.pooled.put(lanes.slot, lanes)
        self.free[lanes.slot] = False
        return self._launch(lanes)

    def _hold_at_rest(self, lanes: PooledLanes) -> PooledLanes:
        """Bodies whose bouncing is over wait until there are many of them: to look for their uplift costs calls, not lanes."""
        resting = self.contact.sequence_ends(self.segments, lanes, self.equation) | (lanes.v < STILL)
        if not resting.any():
            return lanes
        self.resting.append(lanes.take(np.flatnonzero(resting)))
        return lanes.take(np.flatnonzero(~resting))

    def _lift(self) -> ExactLanes:
        """Bodies at rest, where they lift off again; those that nothing lifts are done."""
        lanes = self.resting[0]
        for others in self.resting[1:]:
            lanes = lanes.join(others)
        self.resting, slot = [], lanes.slot
        self.free[slot] = True
        return self._onto(self.run.rest(lanes))

    def _single(self, lanes: PooledLanes) -> PooledLanes:
        """Each lane through its present interval, up to where the drive passes 1, or to an impact; the lanes that go on."""
        lanes.steps += 1
        k, drive = lanes.k, -lanes.side * lanes.amplitude
        passage = through_interval(lanes, drive, self.samples.take(k), self._gain(k), self.step)
        reach, hit, end = passage.reach, passage.hit, passage.end
        if self.run.batch.peaks:
            raise_peaks(lanes.peak, passage)
        self.run.show(Arcs(lanes, passage.arc, reach, end.y, end.v, end.b, np.arange(hit.size)))
        lost = (lanes.steps > self.run.batch.most_steps) | ~np.isfinite(reach)
        self.run.finish(lanes, np.flatnonzero(lost), Outcome.FAILED, np.nan)
        at = np.flatnonzero(hit)
        self.run.work += Work(impacts=at.size, steps=hit.size)
        landed = self.run.land(lanes.take(at), reach[at], end.v[at], end.b[at], self._hold_at_rest)
        on = np.flatnonzero(~(hit | lost))
        onward = lanes.take(on)
        stays = np.flatnonzero(passage.cut[on])  # in this interval
        cuts = on[stays]
        onward.k, onward.u = k[on] + 1, np.zeros(on.size)
        onward.y, onward.v, onward.b = end.y[on], end.v[on], end.b[on]
        onward.k[stays], onward.u[stays] = k[cuts], lanes.u[cuts] + reach[cuts] * lanes.omega[cuts]
        onward.b[stays] = end.y[cuts]
        onward.peak = np.maximum(onward.peak, onward.y)
        going = onward.join(landed)
        going.k, going.u = place(self.segments, going.k, going.u)
        return going
