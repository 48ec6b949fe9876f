"""The flight: cells under one record, advanced by jumps over many samples that are proved free of impacts (Lemma 11).

A lane whose next samples cannot be jumped takes its present interval alone, where the drive is a ramp, with the sign tests of the march.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, fields
from typing import NamedTuple

import numpy as np

from ...motions.motion import Samples, Segments
from ..drive import place
from ..equations.equation import Point
from ..lanes import Lanes
from ..march.account import Work
from ..march.engine import Run
from ..march.roots import hidden_turn, impact_root, turning_point
from ..outcome import Outcome
from ..system import System
from .bounded import LONGEST, bounded_response
from .ramp import RampFlow
from .windows import windows

Array = np.ndarray

_TABLES = 1 << 25  # bytes of tables at a time
_LONGEST_JUMP = 24.0  # tau: exp of it stays below 3e10, so that growth cannot bury the state in rounding
_LEAST = 1e-8  # over 1 + A: a displacement below it, which a jump knows to 1e-15 only, is left to single intervals
_SURELY = 1.0 - 1e-6  # part of a horizon that is used: y at a jump's end may be off by 1e-15 of 1e-8


@dataclass
class Flights(Lanes):
    """Lanes that can jump.

    row: where the table of the lane's pace begins; pace: tau between samples; face: where the windows of its side begin; anchor: the
    sample at which `up` and `down` are the coefficients of exp(tau) and exp(-tau) in y; level: of the window that is tried next,
    at most `top`, which follows from the pace alone: no jump depends on a lane's neighbours; slot: place in the pool.
    """

    row: Array
    pace: Array
    face: Array
    anchor: Array
    up: Array
    down: Array
    level: Array
    top: Array
    slot: Array


class Leap(NamedTuple):
    """Jumps of all lanes: state at their ends, the peak with them, 1 - a at the most, and their time [tau]."""

    y: Array
    v: Array
    peak: Array
    fall: Array
    time: Array


class Flight(Run):
    """One batch of cells of the undamped linear oscillator under a record. Parameters as in `Run`."""

    def __init__(
        self, system: System, segments: Segments, samples: Samples, amplitude: Array, omega: Array, eta: Array, peaks: bool,
        pool: int | None,
    ) -> None:  # fmt: skip
        super().__init__(system, segments, amplitude, omega, eta, peaks, pool or system.equation.pool)
        self.samples, self.step, self.last = samples.values, samples.step, samples.values.size - 1
        self.rows = np.zeros(self.cells.omega.shape, dtype=np.int64)

    def _march(self, waiting: Array) -> None:
        """Fly these cells, those of few frequencies together, so that their tables stay small; march where samples are far apart."""
        pace = self.step / self.cells.omega[:, waiting]
        far = (pace > LONGEST).any(axis=0)
        super()._march(waiting[far])
        waiting, pace = waiting[~far], pace[:, ~far]
        if not waiting.size:
            return
        self.windows = windows(self.samples, 1 + math.ceil(math.log2(self.last)))
        paces, which = np.unique(pace, return_inverse=True)
        which = which.reshape(pace.shape)
        order = np.argsort(which[0], kind="stable")
        for some in _shares(order, which[0][order], max(1, _TABLES // (16 * len(pace) * self.samples.size))):
            mine, row = np.unique(which[:, some], return_inverse=True)
            self.rows[:, waiting[some]] = row.reshape(len(pace), -1) * self.samples.size
            self.table = bounded_response(self.samples, paces[mine]).ravel()
            self._fly(np.sort(waiting[some]))

    def _fly(self, waiting: Array) -> None:
        """Keep a pool of lanes in the air until these cells are done."""
        with np.errstate(all="ignore"):
            taken = min(self.pool, waiting.size)
            flights = self._launch(self.start(waiting[:taken]), np.arange(taken))
            free = np.zeros(taken, dtype=bool)
            while flights.cell.size:
                free[self._round(flights, free)] = True
                places = np.flatnonzero(free)
                more = waiting[taken : taken + places.size]
                if more.size:
                    taken += more.size
                    flights.put(places[: more.size], self._launch(self.start(more), places[: more.size]))
                    free[places[: more.size]] = False
                elif 4 * places.size >= free.size:
                    flights = flights.take(np.flatnonzero(~free))
                    flights.slot = np.arange(flights.slot.size)
                    free = np.zeros(flights.slot.size, dtype=bool)

    def _launch(self, lanes: Lanes, slot: Array) -> Flights:
        """Lanes ready to jump: their state as modes about the bounded response, at the next sample."""
        lanes.k, lanes.u = place(self.segments, lanes.k, lanes.u)
        row, k, inside = self.rows[self.cells.row(lanes.side), lanes.cell], lanes.k, lanes.u > 0.0
        pace = self.step / lanes.omega
        drive = -lanes.side * lanes.amplitude
        left = np.where(inside, pace - lanes.u / lanes.omega, 0.0)
        rate = drive * (self.samples[np.minimum(k + 1, self.last)] - self.samples[k]) / pace
        there = RampFlow(lanes.y, lanes.v, lanes.b, rate).at(left)
        anchor = k + inside
        bounded = self.table.take(row + anchor)
        y, v = there.y - 1.0 - drive * bounded.real, there.v - drive * bounded.imag
        face = np.where(lanes.side > 0.0, 0, self.windows.face)
        fall = (lanes.v + np.sqrt(lanes.v * lanes.v - 2.0 * lanes.b * lanes.y)) / -lanes.b
        top = np.minimum(np.frexp(_LONGEST_JUMP / pace)[1] - 1, self.windows.levels - 1).astype(np.int64)
        level = np.clip(np.frexp(np.where(fall > 0.0, 0.5 * fall / pace, 8.0))[1], 0, top)
        own = {f.name: getattr(lanes, f.name) for f in fields(Lanes)}
        return Flights(
            **own,
            row=row,
            pace=pace,
            face=face,
            anchor=anchor,
            up=0.5 * (y + v),
            down=0.5 * (y - v),
            level=level.astype(np.int64),
            top=top,
            slot=slot,
        )

    def _round(self, lanes: Flights, free: Array) -> Array:
        """One round of all lanes that are not free; the slots that it frees."""
        free[self._ended(lanes, free)] = True
        lanes.steps += 1
        k, y, v, amplitude, pace = lanes.k, lanes.y, lanes.v, lanes.amplitude, lanes.pace
        least = amplitude * self.windows.at(lanes.face, lanes.level, k)  # of the outward drive
        horizon, fall = _horizon(y, v, least)
        past = lanes.u * (1.0 / self.step)  # samples since the start of the interval
        ahead = np.fmin(past + horizon * (_SURELY / pace), np.minimum(np.left_shift(1, lanes.level), self.last - k))
        jump = ahead.astype(np.int64)
        to = k + jump
        grown = np.exp((to - lanes.anchor) * pace)
        up, down = lanes.up * grown, lanes.down / grown
        bounded = self.table.take(lanes.row + to)
        drive = -lanes.side * amplitude
        end_y, end_v = drive * bounded.real, drive * bounded.imag
        end_y += up + down
        end_y += 1.0
        end_v += up - down
        single = ((jump < 1) | (end_y < _LEAST * (1.0 + amplitude))) & ~free
        peak = np.maximum(lanes.peak, end_y)
        level = np.clip(np.frexp(ahead)[1], 0, lanes.top)
        held = self._doubtful(lanes, Leap(end_y, end_v, peak, fall, (jump - past) * pace), ~(single | free))
        single[held[jump[held] == 1]] = True
        held = held[jump[held] > 1]
        level[held] = np.frexp(jump[held] // 2)[1] - 1
        alone = np.flatnonzero(single)
        back = np.concatenate([alone, held])
        mine = lanes.take(alone)
        new = {"k": to, "u": np.zeros_like(y), "y": end_y, "v": end_v, "b": np.full_like(y, np.nan), "up": up, "down": down}
        for name, values in {**new, "anchor": to.copy(), "peak": peak}.items():
            values[back] = getattr(lanes, name)[back]
            setattr(lanes, name, values)
        lanes.level = level
        going = self._single(mine)
        lanes.put(going.slot, going)
        ended = np.ones(free.size, dtype=bool)
        ended[going.slot] = False
        return alone[ended[alone]]

    def _ended(self, lanes: Flights, free: Array) -> Array:
        """Lanes whose fate is known: the shaking is over, or nothing can bring them back (Lemma 6)."""
        past = np.flatnonzero((lanes.k >= self.last) & ~free)
        if past.size:
            failed = ~np.isfinite(lanes.y[past])
            self._finish(lanes, past[failed], Outcome.FAILED, np.nan)
            self._shaken(lanes, past[~failed])
        lost = np.flatnonzero((lanes.y + lanes.v > 1.0) & (lanes.k < self.last) & ~free)
        if lost.size:
            inward = np.where(lanes.side[lost] > 0.0, self.segments.later_max[lanes.k[lost]], -self.segments.later_min[lanes.k[lost]])
            lost = lost[self.equation.certainly_overturns(lanes.y[lost], lanes.v[lost], lanes.amplitude[lost] * inward)]
            self._overturn(lanes, lost)
            self.work += Work(certain_overturning=lost.size)
        return np.concatenate([past, lost])

    def _doubtful(self, lanes: Flights, leap: Leap, flying: Array) -> Array:
        """Flying lanes whose leap may hold a crest above the peak, by Lemma 11: they leap half as far."""
        if not self.peaks:
            return np.zeros(0, dtype=np.int64)
        high = np.flatnonzero((np.maximum(lanes.y, leap.y) + 0.125 * leap.fall * leap.time * leap.time > leap.peak) & flying)
        y, v, time, end_v = lanes.y[high], lanes.v[high], leap.time[high], leap.v[high]
        pull = self._strongest(lanes, high) - 1.0
        start, end = y + pull, leap.y[high] + pull
        rises = end_v >= np.maximum(end, 0.0) * (0.5 * time)  # no more than at the end
        falls = -v >= np.maximum(start, 0.0) * (0.5 * time)
        top = np.where((start < 0.0) & (v > 0.0), y + v * v / (-start + np.sqrt(start * start - v * v)), np.inf)
        return high[~(rises | falls | (top <= leap.peak[high]))]

    def _strongest(self, lanes: Flights, at: Array) -> Array:
        """Upper bound of the outward drive over the windows of these lanes."""
        return -lanes.amplitude[at] * self.windows.at(self.windows.face - lanes.face[at], lanes.level[at], lanes.k[at])

    def _noted(self, lanes: Flights, arc: RampFlow, reach: Array, hit: Array, end: Point) -> None:
        """What a listener wants to know of intervals taken alone: `end` is the state after `reach`, with velocity and force."""

    def _single(self, lanes: Flights) -> Flights:
        """Each lane through its present interval, up to where the drive passes 1, or to an impact; the lanes that go on."""
        k, y, v = lanes.k, lanes.y, lanes.v
        drive = -lanes.side * lanes.amplitude
        s = self.samples[k]
        fresh = np.isnan(lanes.b)
        b = lanes.b = np.where(fresh, y - 1.0 + drive * s, lanes.b)
        left = lanes.pace - lanes.u / lanes.omega
        rate = drive * (self.samples[k + 1] - s) / lanes.pace
        arc = RampFlow(y, v, b, rate)
        one = (y - b) / rate  # when the drive is 1
        ridge = (b > y) | ((b == y) & (rate > 0.0))
        rises = (v > 0.0) | (ridge & (v >= 0.0))
        crosses = (one > 0.0) & (one < left)
        valley = np.where(ridge & crosses, one, 0.0)
        cut = crosses & ~(ridge & rises)
        h = np.where(cut, one, left)
        end = arc.at(h)
        hit = end.y <= 0.0
        dips = np.flatnonzero(ridge & ~hit & (v < 0.0) & (end.v > 0.0))
        reach = h.copy()
        if dips.size:
            h_min, y_min = turning_point(arc.take(dips), np.zeros(dips.size), h[dips], 0.5 * h[dips], -1.0)
            touched = ~(y_min > 0.0)
            hit[dips[touched]], reach[dips[touched]] = True, h_min[touched]
        at = np.flatnonzero(hit)
        low = np.where(rises, valley, 0.0)
        guess = _impact_guess(arc, end, h, low, reach, at)
        reach[at], impact_v = impact_root(arc.take(at), low[at], reach[at], guess)
        if self.peaks:
            self._raise_peaks(lanes, arc, end, low, reach, rises, hit, ridge & ~(rises & crosses))
        struck = arc.take(at).at_ground(reach[at])
        for values, there in ((end.y, 0.0), (end.v, impact_v), (end.b, struck)):
            values[at] = there
        self._noted(lanes, arc, reach, hit, end)
        lost = (lanes.steps > self.most_steps) | ~np.isfinite(reach)
        self._finish(lanes, np.flatnonzero(lost), Outcome.FAILED, np.nan)
        self.work += Work(impacts=at.size, steps=hit.size)
        landed = lanes.take(at)
        landed, _ = self._land(landed, reach[at], impact_v, struck)
        on = np.flatnonzero(~hit & ~lost)
        onward = lanes.take(on)
        onward.k, onward.u = k[on] + ~cut[on], np.where(cut[on], lanes.u[on] + one[on] * lanes.omega[on], 0.0)
        onward.y, onward.v, onward.b = end.y[on], end.v[on], np.where(cut[on], end.y[on], end.b[on])
        onward.peak = np.maximum(onward.peak, onward.y)
        going = onward.join(landed)
        return self._launch(going, going.slot)

    def _raise_peaks(self, lanes: Flights, arc: RampFlow, end: Point, low: Array, high: Array, rises: Array, hit: Array, no: Array) -> None:
        """Raise the peaks to the turning points of these intervals (Lemmas 3 and 4); `no`: only a ridge, which holds none."""
        fall = np.maximum(arc.y - arc.b, arc.y - arc.b - arc.rate * high)
        at = np.flatnonzero((np.maximum(arc.y, np.where(hit, 0.0, end.y)) + 0.125 * fall * high * high > lanes.peak) & ~no)
        if not at.size:
            return
        arc, low, high, up = arc.take(at), low[at], high[at], rises[at]
        down = hit[at] | (end.v[at] <= 0.0)
        sure = up & down
        slope = end.b[at]  # where v is convex its tangent at the end may prove that it keeps its sign
        hidden = np.flatnonzero(up & ~down & (arc.rate > 0.0) & (slope * (high - low) > _SURELY * end.v[at]))
        turn = hidden_turn(arc.take(hidden), low[hidden], high[hidden], 1.0)
        found = np.isfinite(turn)
        high[hidden[found]], sure[hidden[found]] = turn[found], True
        hidden = np.flatnonzero(~up & down & (arc.rate < 0.0) & (arc.v + arc.b * high > 0.0))
        turn = hidden_turn(arc.take(hidden), low[hidden], high[hidden], -1.0)
        found = np.isfinite(turn)
        low[hidden[found]], sure[hidden[found]] = turn[found], True
        turns = np.flatnonzero(sure)
        _, top = turning_point(arc.take(turns), low[turns], high[turns], 0.5 * (low[turns] + high[turns]), 1.0)
        lanes.peak[at[turns]] = np.maximum(lanes.peak[at[turns]], top)


def _shares(order: Array, rows: Array, most: int) -> Iterator[Array]:
    """`order`, sorted by rows, cut so that each part has at most so many of them."""
    first = 0
    while first < order.size:
        stop = int(np.searchsorted(rows, rows[first] + most))
        yield order[first:stop]
        first = stop


def _horizon(y: Array, v: Array, least: Array) -> tuple[Array, Array]:
    """Time [tau] for which y + v sinh h + (y - 1 + least)(cosh h - 1) stays positive, and 1 - least."""
    fall = 1.0 - least
    q = y - fall
    grows = q + v
    root = fall * fall
    root -= grows * (q - v)
    np.sqrt(root, out=root)
    root += fall
    root /= -grows  # exp of the time
    never = (grows >= 0.0) & ~(root > 1.0)
    time = np.log(np.maximum(root, 1.0))
    time[never] = np.inf
    return time, fall


def _impact_guess(arc: RampFlow, end: Point, h: Array, low: Array, high: Array, at: Array) -> Array:
    """A first guess inside the bracket: ballistic from the left where b < 0 at the start, else a step from the right; then the cubic."""
    y, v, b = arc.y[at], arc.v[at], arc.b[at]
    left = (v + np.sqrt(v * v - 2.0 * b * y)) / -b
    slope = end.v[at]
    right = h[at] - end.y[at] / (slope - 0.5 * end.y[at] * end.b[at] / slope)
    guess = np.where((b < 0.0) & (left < high[at]) & (left > low[at]), left, right)
    jerk = v + arc.rate[at]  # what the cubic adds
    slope = v + guess * (b + 0.5 * guess * jerk)
    bend = b + guess * jerk
    short = (y + guess * (v + guess * (0.5 * b + guess * jerk * (1.0 / 6.0)))) / slope
    guess = guess - short / (1.0 - 0.5 * short * bend / slope)
    return np.where((guess > low[at]) & (guess < high[at]), guess, 0.5 * (low[at] + high[at]))
