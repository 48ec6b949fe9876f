"""The approximate falls of one body at many amplitudes of a record: they tell a search where to look, and decide nothing.

All lanes take the same steps, up to `_STEP` of tau, with the Taylor terms of `recurrence` on arrays. Over a step the record is a
straight line with the same integral and first moment; the rest of it, r, moves a body by the outward drive of s = 1 times W, where
W'' = r and W is 0 at both ends, which is added where an impact is looked for. Bounces shorter than a part of a step are averaged. The
boundaries between standing and falling lie beside those of the march: of 48 first falls at most 5e-6 of the amplitude where a line is
one sample, 6e-5 where it covers several; 2.4e-4 was seen once.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from ...motions.motion import Motion
from ...motions.segments import Segments
from ..system import System
from .lane import Lane
from .recurrence import compiled

Array = np.ndarray

_STEP = 0.05  # [tau]
_ORDER = 4  # of the series of a step
_SHORT = 0.1  # times `_STEP`: bounces shorter than that are averaged; with 0.5 narrow falls are missed that march and scan find by chance
_MOST = 4  # impacts in a step; the later ones are averaged
_ROOTS = 2  # steps of Newton's method to an impact; one where a line is the record itself


class Rest(NamedTuple):
    """The rest r of the record within its line: W and W' at the start of each sample, r there, and how much r rises over it."""

    w: Array
    dw: Array
    start: Array
    rise: Array

    def at(self, share: Array, length: Array | float, pace: Array | float) -> tuple[Array, Array]:
        """(W, W' times the length) at shares of a line that lasts `length` [tau]; pace: tau over the phase."""
        count = self.w.size
        j = np.minimum((share * count).astype(np.intp), count - 1)
        part, over = length / count, share * count - j
        at, bend = self.start[j] * over, self.rise[j] * over * over
        w = self.w[j] * pace**2 + self.dw[j] * pace * part * over + part * part * over * (0.5 * at + bend / 6.0)
        return w, (self.dw[j] * pace + part * (at + 0.5 * bend)) * length


class Scan:
    """One body under one record at one Omega."""

    def __init__(self, system: System, motion: Motion, omega: float, eta: float) -> None:
        self.lane = lane = Lane(system, system.segments(motion.coarsest), omega, eta)
        faces = lane.faces(1.0)
        laws = [lane.laws[side] for side in faces]
        self.sides, self.others = np.array(list(faces)), np.arange(len(faces))[::-1]
        self.drive, self.keeps, self.limit = (np.array([getattr(f, name) for f in faces.values()]) for name in ("drive", "keeps", "limit"))
        self.lowest_limit = float(self.limit.min())
        self.pace = np.array([1.0 / f.omega for f in faces.values()])
        numbers = {name: np.array([law.numbers[name] for law in laws]) for name in laws[0].numbers}
        self.differ = {name: x for name, x in numbers.items() if x.min() < x.max()}
        self.numbers: dict[str, Any] = {"tan": np.tan, "exp": np.exp, **{name: float(x[0]) for name, x in numbers.items()}}
        self.terms: Callable[..., tuple[Any, ...]] = compiled(laws[0], _ORDER, lane.zeta, True, False).terms
        self.lines = _lines(lane.segments, _STEP / float(self.pace.max()))

    @staticmethod
    def serves(system: System, motion: Motion) -> bool:
        """True if the scan can follow bodies of this system under this motion."""
        straight = system.segments(motion.coarsest).straight
        return straight and motion.vertical is None and system.equation.law(1.0).local is None

    def falls(self, amplitude: Array) -> Array:
        """True for each amplitude A at which the body seems to fall, (lanes,)."""
        with np.errstate(all="ignore"):
            return _Lanes(self, amplitude).falls()


class _Lanes:
    """The state of the lanes that have not fallen: index, A, side (as a row of the scan's numbers), y, y', at rest."""

    def __init__(self, scan: Scan, amplitude: Array) -> None:
        self.scan, self.fallen = scan, np.zeros(amplitude.size, dtype=bool)
        self.at, self.amplitude = np.arange(amplitude.size), amplitude
        self.row = np.zeros(amplitude.size, dtype=np.intp)
        self.y, self.v, self.rest = np.zeros(amplitude.size), np.zeros(amplitude.size), np.ones(amplitude.size, dtype=bool)

    def falls(self) -> Array:
        """True for each lane that falls."""
        for line in zip(*self.scan.lines, strict=True):
            start = self._lifted(*line[:2])
            self._step(np.flatnonzero(~self.rest), start, *line)
            if not self.y.max(initial=0.0) <= self.scan.lowest_limit:
                gone = ~(self.y <= self.scan.limit[self.row])
                self.fallen[self.at[gone]] = True
                for name in ("at", "amplitude", "row", "y", "v", "rest"):
                    setattr(self, name, getattr(self, name)[~gone])
        self._end()
        return self.fallen

    def _lifted(self, s: float, rise: float) -> Array:
        """Share of the line at which lanes at rest lift off; 0 for the others."""
        start = np.zeros(self.at.size)
        if not self.rest.any():
            return start
        for row, drive in enumerate(self.scan.drive):
            if max(drive * s, drive * (s + rise)) <= 0.0:
                continue
            begin, gain = drive * s * self.amplitude, drive * rise * self.amplitude
            up = self.rest & (np.maximum(begin, begin + gain) > 1.0)
            start[up] = np.where(begin[up] < 1.0, (1.0 - begin[up]) / gain[up], 0.0)
            self.row[up], self.rest[up] = row, False
        return start

    def _step(self, at: Array, start: Array, s: float, rise: float, lasts: float, rest: Rest | None) -> None:
        """From shares `start` of a line to its end: lanes `at`, those that strike the ground once more from there."""
        scan = self.scan
        x, row, y, v = start[at], self.row[at], self.y[at], self.v[at]
        for impacts in range(_MOST + 1):
            if not at.size:
                return
            drive, pace = scan.drive[row] * self.amplitude[at], scan.pace[row]
            h = np.maximum(lasts * pace * (1.0 - x), 1e-12)
            numbers = scan.numbers | {name: values[row] for name, values in scan.differ.items()}
            terms = scan.terms(y, v, h, drive * (s + rise * x), drive * (rise * (1.0 - x)), **numbers)
            y, v = sum(terms[1:], terms[0]), sum((n * c for n, c in enumerate(terms[2:], 2)), terms[1])
            self.y[at], self.v[at] = y, v / h
            hit = np.flatnonzero(y <= 0.0)
            if not hit.size:
                return
            at, x, row, drive, pace, h = at[hit], x[hit], row[hit], drive[hit], pace[hit], h[hit]
            x, struck, away = _impact([c[hit] for c in terms], x, h, drive, lasts, pace, rest)
            v = -scan.keeps[row] * np.minimum(struck, 0.0)
            row = scan.others[row]
            self.row[at] = row
            self.y[at], self.v[at] = 0.0, v
            other, unit = scan.drive[row] * self.amplitude[at], scan.pace[row] / pace
            y, moving = -other * away[0] * unit**2, v - other * away[1] * unit
            on = np.flatnonzero(~self._averaged(at, x, v, s, rise, lasts, impacts == _MOST))
            at, x, row, y, v = at[on], x[on], row[on], y[on], moving[on]

    def _averaged(self, at: Array, x: Array, v: Array, s: float, rise: float, lasts: float, last: bool) -> Array:
        """True for lanes whose further bounces within the line are averaged under the drive halfway to its end."""
        scan, row = self.scan, self.row[at]
        push = self.amplitude[at] * (s + rise * (0.5 + 0.5 * x))
        here = 1.0 - scan.drive[row] * push
        few = (here > 0.0) & (last | (2.0 * v < _SHORT * here * _STEP))
        i = np.flatnonzero(few)
        if i.size:
            at, x, v, row, bounce = at[i], x[i], v[i], row[i], 2.0 * v[i] / here[i]
            cycle, other = scan.keeps[row], scan.others[row]
            if len(scan.sides) == 2:
                bounce = bounce + 2.0 * cycle * v / np.maximum(1.0 - scan.drive[other] * push[i], 1e-3)
                cycle = cycle * scan.keeps[other]
            left = v * (1.0 - lasts * scan.pace[row] * (1.0 - x) * (1.0 - cycle) / bounce)
            self.v[at], self.rest[at] = np.fmax(left, 0.0), ~(left > 1e-7)
        return few

    def _end(self) -> None:
        """The free motion of the lanes that still rock."""
        lane, up = self.scan.lane, np.flatnonzero(~self.rest)
        contact, equation = lane.system.contact, lane.system.equation
        for row, side in enumerate(self.scan.sides):
            i = up[self.row[up] == row]
            cells = contact.cells(equation, self.amplitude[i], np.broadcast_to(lane.omega, i.shape), np.broadcast_to(lane.eta, i.shape))
            lanes = lane.lanes(cells, float(side))
            free = contact.free_motion(equation, lanes, np.arange(i.size), self.y[i], self.v[i])
            self.fallen[self.at[i]] = free.overturns | free.overturns_after_impact


def _lines(segments: Segments, step: float) -> tuple[list[float], list[float], list[float], list[Rest | None]]:
    """(s at the start of each line, its rise, its length, the rest of the record)."""
    start, length = segments.s_start[:], segments.length[:]
    change = segments.s_end[:] - start
    count = max(1, int(step / length.max() * (1.0 + 1e-9)))
    if count == 1 or np.ptp(length) > 1e-9 * length.max():
        cuts = np.maximum(1, np.ceil(length / step * (1.0 - 1e-9))).astype(np.intp)
        part = np.arange(cuts.sum()) - np.repeat(np.cumsum(cuts) - cuts, cuts)
        start, change, length, cuts = (np.repeat(x, cuts) for x in (start, change, length, cuts))
        return (start + change * part / cuts).tolist(), (change / cuts).tolist(), (length / cuts).tolist(), [None] * length.size
    size = float(length[0])
    s, rise = (np.append(x, np.zeros(-x.size % count)).reshape(-1, count) for x in (start, change))
    middle = size * (np.arange(count) + 0.5 - 0.5 * count)
    moment = (size * (s + 0.5 * rise) * middle + size * size * rise / 12.0).sum(axis=1)
    whole = size * count
    gain = 12.0 * moment / whole**2
    begin = (s + 0.5 * rise).mean(axis=1) - 0.5 * gain
    left, bend = s - begin[:, None] - gain[:, None] * np.arange(count) / count, rise - gain[:, None] / count
    dw = _sums(size * (left + 0.5 * bend))
    w = _sums(size * dw + size * size * (0.5 * left + bend / 6.0))
    return begin.tolist(), gain.tolist(), [whole] * len(begin), [Rest(*rows) for rows in zip(w, dw, left, bend, strict=True)]


def _sums(gains: Array) -> Array:
    """The sums of the gains before each sample of a line."""
    return np.cumsum(gains, axis=1) - gains


def _value(terms: list[Array], x: Array) -> tuple[Array, Array]:
    """(y, y' times the step) of the series at a share of the step."""
    y, v = terms[-1], np.zeros_like(x)
    for c in terms[-2::-1]:
        v = v * x + y
        y = y * x + c
    return y, v


def _impact(
    terms: list[Array], x: Array, h: Array, drive: Array, lasts: float, pace: Array, rest: Rest | None
) -> tuple[Array, Array, tuple[Array | float, Array | float]]:
    """(share of the line at which y comes to 0, y' there, W and W' there) of lanes whose step of h began at share x of the line."""
    y, v, half = terms[:3]
    root = np.sqrt(np.maximum(v * v - 4.0 * half * y, 0.0))
    t = np.where(v > 0.0, -0.5 * (v + root) / half, 2.0 * y / (root - v))
    away: tuple[Array | float, Array | float] = 0.0, 0.0
    roots = 1 if rest is None else _ROOTS
    for n in range(roots + 1):
        t = np.fmin(np.fmax(t, 0.0), 1.0)
        y, v = _value(terms, t)
        if rest is not None and n:
            w, dw = rest.at(x + (1.0 - x) * t, lasts * pace, pace)
            away = w, dw / (lasts * pace)
            y, v = y + drive * w, v + drive * dw * (1.0 - x)
        if n < roots:
            t = t - y / v
    return x + (1.0 - x) * t, v / h, away
