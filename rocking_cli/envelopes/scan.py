"""The approximate falls of bodies at many amplitudes of a record: a search uses them to
decide where the march must look.

A line lasts up to `_STEP` of tau. It replaces the record by a straight line with the
same integral and first moment. The difference r of the two moves a body by W times the
outward drive of s = 1, where W'' = r and W is 0 at both ends; this is added in the
search for an impact. A lane is a body at an amplitude. In a round each lane moves to
the end of its line or to an impact, with the Taylor terms of `recurrence` on arrays. So
lanes of many bodies share the cost of a round, and no bit depends on the others.
Bounces shorter than a part of a line are averaged. The boundaries between standing and
falling differ from those of the march: for 48 first falls by at most 5e-6 of the
amplitude where a line is one sample, 6e-5 where it covers several; 2.4e-4 was seen
once. Fine scans have lines of one sample: of 670 boundaries 647 lie within 5e-7.
"""

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ..dynamics.equations.recurrence import motion_terms
from ..dynamics.outcome import Outcome
from ..dynamics.single.lane import Lane
from ..dynamics.single.series_roots import value
from ..dynamics.system import System
from ..motions.motion import Motion
from ..motions.segments import Segments

Array = np.ndarray

_STEP = 0.05  # [tau]
_SLOW = 1e-7  # a body is at rest after an impact below this speed
_MOST_ROUNDS = 100  # rounds over lines, after which a lane is left to the march
# after so many rounds, lanes at rest go to their next uplift and lanes at the end of
# the record finish
_UPLIFT_ROUNDS = 8
_TOLD_ROUNDS = 128  # rounds between two calls of a function for the progress
_SEARCH_LINES = 64  # number of lines that one search for the next uplift covers


class Accuracy(NamedTuple):
    """How closely the scan follows bodies."""

    degree: int  # degree of the series of a step
    short: float  # bounces shorter than this times `_STEP` are averaged [-]
    # number of steps of Newton's method to an impact, plus one where a line differs
    # from the record
    roots: int


# if bounces shorter than 0.5 `_STEP` were averaged, more narrow falls would be missed
_COARSE = Accuracy(4, 0.1, 1)
_FINE = Accuracy(6, 1e-3, 3)


class Lines(NamedTuple):
    """The lines of a record."""

    s: Array  # s at the start of each line [-], (lines,)
    rise: Array  # increase of s over the line [-], (lines,)
    length: Array  # length of the line [rad], (lines,)
    # the difference r of record and line, for each sample of a line: W and W' at its
    # start, r there, and the rise of r, (4, lines, samples); without samples if the
    # lines are the record itself
    residual: Array


class Scan:
    """One body under one record at one Omega, followed approximately. If `fine` it is
    followed sample by sample, so that most boundaries lie within 1e-6 of those of the
    march.
    """

    def __init__(
        self,
        system: System,
        motion: Motion,
        omega: float,
        eta: float,
        fine: bool = False,
    ) -> None:
        self.lane = lane = Lane(system, system.segments(motion.coarsest), omega, eta)
        self.edges = list(lane.edges(1.0).values())
        step, self.accuracy = (
            _STEP * min(edge.omega for edge in self.edges),
            _FINE if fine else _COARSE,
        )
        self.lines = _lines(
            lane.segments,
            min(step, float(lane.segments.length[:].max())) if fine else step,
        )
        # bodies with equal kinds can be followed together
        self.kind = (
            type(system.equation),
            lane.zeta,
            len(self.edges),
            self.lines.residual.size > 0,
            fine,
        )
        # amplitudes A that were computed [-], and their outcomes, (amplitudes,) each
        self.known = np.zeros(0), np.zeros(0, dtype=np.uint8)

    @staticmethod
    def supports(system: System, motion: Motion) -> bool:
        """True if the scan can follow bodies of this system under this motion."""
        if system.devices is not None:
            return False
        straight = system.segments(motion.coarsest).straight
        return straight and motion.vertical is None and system.equation.composed is None

    def outcomes(self, amplitude: Array) -> Array:
        """The approximate outcome at each amplitude A, codes of `Outcome`, with ROCKED
        for every body that stands, (lanes,).
        """
        follow([self], [amplitude])
        return self.known[1][np.searchsorted(self.known[0], amplitude)]


def follow(
    scans: Sequence[Scan],
    amplitudes: Sequence[Array],
    progress: Callable[[float], None] | None = None,
) -> None:
    """Compute the outcomes of each body at those of its amplitudes A that are not known
    yet, for all bodies and motions together. progress: called now and then with the
    share that is done.
    """
    new = [
        np.setdiff1d(a, scan.known[0])
        for scan, a in zip(scans, amplitudes, strict=True)
    ]
    for kind in dict.fromkeys(scan.kind for scan in scans):
        alike = [i for i, scan in enumerate(scans) if scan.kind == kind and new[i].size]
        if not alike:
            continue
        with np.errstate(all="ignore"):
            found = _Pool([scans[i] for i in alike], [new[i] for i in alike]).outcomes(
                progress
            )
        for i, outcome in zip(
            alike,
            np.split(found, np.cumsum([new[i].size for i in alike])),
            strict=False,
        ):
            amplitude = np.append(scans[i].known[0], new[i])
            order = np.argsort(amplitude)
            scans[i].known = (
                amplitude[order],
                np.append(scans[i].known[1], outcome)[order],
            )


class _Pool:
    """The lanes of a scan: those that still move, and the results of all."""

    # The fields of lanes that still move, (lanes,) each
    _EACH = (
        "number",  # index of the lane among all lanes
        "amplitude",  # A [-]
        "k",  # index of the line
        "x",  # time in the line over its length [-]
        "row",  # index of the body and the side
        "y",  # displacement, in the unit of the side
        "v",  # velocity y', by tau
        "drive",  # outward drive of s = 1 times A [-]
        "pace",  # tau over the phase [1/rad]
        "rested",  # line after the one in which the lane came to rest, -1 for others
    )

    def __init__(self, scans: list[Scan], amplitudes: list[Array]) -> None:
        edges = [edge for scan in scans for edge in scan.edges]
        self.scans, self.sides, row = scans, len(scans[0].edges), np.arange(len(edges))
        self.others = row + self.sides - 1 - 2 * (row % self.sides)
        self.drives, self.speed_ratio, self.limit, omega = (
            np.array([getattr(f, n) for f in edges])
            for n in ("drive", "speed_ratio", "limit", "omega")
        )
        self.paces, self.lowest_limit = 1.0 / omega, float(self.limit.min())
        first, *others = (edge.equation for edge in edges)
        self.equations, self.accuracy = first.joined(others), scans[0].accuracy
        self._store_lines([scan.lines for scan in scans])
        body = np.repeat(np.arange(len(scans)), [a.size for a in amplitudes])
        self.number, self.amplitude, self.row = (
            np.arange(body.size),
            np.concatenate(amplitudes),
            body * self.sides,
        )
        self.k, self.rested = self.end[body], self.begin[body]
        self.x, self.y, self.v, self.drive, self.pace = np.zeros((5, body.size))
        # the outcome, and True after an impact, of every lane, as far as they are known
        self.outcome, self.bounced = (
            np.full(body.size, Outcome.ROCKED, dtype=np.uint8),
            np.zeros(body.size, dtype=bool),
        )

    def _store_lines(self, lines_of: list[Lines]) -> None:
        """Store the lines of the bodies one after the other; after those of each body
        follow lines of length 0, in which lanes wait.
        """
        still = np.zeros(_UPLIFT_ROUNDS + 1)
        begins = np.cumsum([0] + [lines.s.size + still.size for lines in lines_of])
        self.begin, self.end = begins[:-1], begins[1:] - still.size
        self.s, self.rise, self.length = (
            np.concatenate([x for lines in lines_of for x in (lines[i], still)])
            for i in range(3)
        )
        padding = np.zeros(_SEARCH_LINES)
        high, low = (
            np.maximum(self.s, self.s + self.rise),
            np.maximum(-self.s, -self.s - self.rise),
        )
        self.later = np.empty((2, self.s.size))
        for begin, end in pairwise(begins.tolist()):
            for later, x in zip(self.later, (high, low), strict=True):
                later[begin:end] = np.maximum.accumulate(x[begin:end][::-1])[::-1]
        high[self.end] = low[self.end] = np.inf
        self.high, self.low = np.append(high, padding), np.append(low, padding)
        samples = [lines.residual.shape[2] for lines in lines_of]
        residuals = [
            np.pad(lines.residual, ((0, 0), (0, still.size), (0, 0))).reshape(4, -1)
            for lines in lines_of
        ]
        self.residual = np.concatenate(residuals, axis=1) if any(samples) else None
        self.count = np.repeat(samples, np.diff(begins))
        self.sample = np.cumsum(self.count) - self.count

    def outcomes(self, progress: Callable[[float], None] | None = None) -> Array:
        """March all lanes; returns the outcome of each lane."""
        rounds, most = 0, _MOST_ROUNDS * self.s.size
        while self.number.size and rounds < most:
            if rounds % _UPLIFT_ROUNDS == 0:
                self._next_uplifts()
            if progress is not None and rounds % _TOLD_ROUNDS == 0:
                progress(self._done())
            self._round()
            rounds += 1
        self.outcome[self.number] = Outcome.FAILED
        return self.outcome

    def _done(self) -> float:
        """The share of their records that the lanes that still move
        have behind them.
        """
        body = self.row // self.sides
        begin, end = self.begin[body], self.end[body]
        return float(np.mean((self.k - begin) / (end - begin))) if body.size else 1.0

    def _falls(self, number: Array) -> None:
        """Store the outcome of lanes that fall, with or without an impact before."""
        self.outcome[number] = np.where(
            self.bounced[number],
            Outcome.OVERTURNED_AFTER_IMPACT,
            Outcome.OVERTURNED_NO_IMPACT,
        )

    def _keep(self, stay: Array) -> None:
        for name in self._EACH:
            setattr(self, name, getattr(self, name)[stay])
        self.equation = self.equations.on(self.row, self.row)

    def _next_uplifts(self) -> None:
        """Move lanes at rest to their next uplift; remove lanes without one, and lanes
        at the end of their record.
        """
        waiting = self.length[self.k] == 0.0
        over = waiting & (self.rested < 0)
        self._end(np.flatnonzero(over))
        at = np.flatnonzero(waiting & ~over)
        body = self.row[at] // self.sides
        first = body * self.sides
        drives = [
            self.drives[first + side] * self.amplitude[at] for side in range(self.sides)
        ]
        above, below = np.full((2, at.size), np.inf)
        for drive in drives:
            above, below = (
                np.where(drive > 0.0, 1.0 / drive, above),
                np.where(drive < 0.0, -1.0 / drive, below),
            )
        k = self.rested[at]
        lifts = (self.later[0, k] > above) | (self.later[1, k] > below)
        k[~lifts] = self.end[body[~lifts]]
        searching = np.flatnonzero(lifts)
        while searching.size:
            lines = k[searching, None] + np.arange(_SEARCH_LINES)
            lifting = (self.high[lines] > above[searching, None]) | (
                self.low[lines] > below[searching, None]
            )
            found = lifting.argmax(axis=1)
            none = ~lifting[np.arange(searching.size), found]
            k[searching] += np.where(none, _SEARCH_LINES, found)
            searching = searching[none]
        s, rise, open_ = self.s[k], self.rise[k], np.ones(at.size, dtype=bool)
        for side, drive in enumerate(drives):
            begin, gain = drive * s, drive * rise
            up = open_ & (np.maximum(begin, begin + gain) > 1.0)
            i, open_ = at[up], open_ & ~up
            self.row[i], self.drive[i], self.pace[i] = (
                first[up] + side,
                drive[up],
                self.paces[first[up] + side],
            )
            self.x[i] = np.where(begin[up] < 1.0, (1.0 - begin[up]) / gain[up], 0.0)
        self.k[at], self.y[at], self.v[at], self.rested[at] = k, 0.0, 0.0, -1
        over[at] = k == self.end[body]
        self._keep(~over)

    def _round(self) -> None:
        """Move each lane to the end of its line, or to an impact."""
        k, x, drive = self.k, self.x, self.drive
        left, s, rise = 1.0 - x, self.s[k], self.rise[k]
        lasts = self.length[k] * self.pace
        h = np.maximum(lasts * left, 1e-12)
        square = h * h
        factors = [
            square * (1.0 / ((n + 1) * (n + 2)))
            for n in range(self.accuracy.degree - 1)
        ]
        terms = motion_terms(
            self.equation,
            self.y,
            self.v,
            h,
            factors,
            [drive * (s + rise * x), drive * (rise * left)],
        )
        self.y, self.v = (
            sum(terms[1:], terms[0]),
            sum((n * c for n, c in enumerate(terms[2:], 2)), terms[1]) / h,
        )
        self.k, self.x = k + 1, np.zeros_like(x)
        hit = np.flatnonzero(self.y <= 0.0)
        if hit.size:
            self._strike(
                hit, k[hit], x[hit], h[hit], lasts[hit], [c[hit] for c in terms]
            )
        if not self.y.max(initial=0.0) <= self.lowest_limit:
            fallen = ~(self.y <= self.limit[self.row])
            self._falls(self.number[fallen])
            self._keep(~fallen)

    def _strike(
        self, at: Array, k: Array, x: Array, h: Array, lasts: Array, terms: list[Array]
    ) -> None:
        """Apply the impacts of the lanes `at`, whose step of h began at x of line k."""
        before, row = self.drive[at], self.row[at]
        self.bounced[self.number[at]] = True
        x, v, w, dw = self._impact(terms, x, h, k, lasts, before)
        v = -self.speed_ratio[row] * np.minimum(v, 0.0)
        unit, row = 1.0 / self.pace[at], self.others[row]
        pace, drive = self.paces[row], self.drives[row] * self.amplitude[at]
        unit *= pace
        self.row[at], self.drive[at], self.pace[at], self.y[at] = row, drive, pace, 0.0
        self.equation = self.equations.on(self.row, self.row)
        # Further bounces within the line, averaged under the drive halfway to its end.
        push = self.s[k] + self.rise[k] * (0.5 + 0.5 * x)
        here = 1.0 - drive * push
        averaged = (here > 0.0) & (2.0 * v < self.accuracy.short * here * _STEP)
        bounce, cycle_ratio = 2.0 * v / here, self.speed_ratio[row]
        if self.sides == 2:
            other = self.others[row]
            bounce = bounce + 2.0 * cycle_ratio * v / np.maximum(
                1.0 - self.drives[other] * self.amplitude[at] * push, 1e-3
            )
            cycle_ratio = cycle_ratio * self.speed_ratio[other]
        slow = v * (
            1.0 - self.length[k] * pace * (1.0 - x) * (1.0 - cycle_ratio) / bounce
        )
        self.v[at] = np.where(averaged, np.fmax(slow, 0.0), v)
        # A body that hardly bounces, where the drive lifts it later in the line, waits
        # in the line, or at its end for the next one.
        next_line = k + (averaged | (x > 1.0 - 1e-9))
        rests = np.where(averaged, ~(slow > _SLOW), v <= _SLOW)
        on = np.flatnonzero(~averaged & ~rests)
        i = at[on]
        self.k[i], self.x[i] = k[on], x[on]
        self.y[i], self.v[i] = (
            -drive[on] * w[on] * unit[on] ** 2,
            v[on] - drive[on] * dw[on] * unit[on],
        )
        i = at[rests]
        self.rested[i], self.k[i], self.y[i], self.v[i] = (
            next_line[rests],
            self.end[row[rests] // self.sides],
            1e-9,
            0.0,
        )

    def _impact(
        self,
        terms: list[Array],
        x: Array,
        h: Array,
        k: Array,
        lasts: Array,
        drive: Array,
    ) -> tuple[Array, Array, Array, Array]:
        """(x of line k at which y comes to 0, y' there, W and W' there) of lanes whose
        step of h began at x of the line.
        """
        y, v, half = terms[:3]
        root = np.sqrt(np.maximum(v * v - 4.0 * half * y, 0.0))
        t = np.where(v > 0.0, -0.5 * (v + root) / half, 2.0 * y / (root - v))
        w = dw = np.zeros_like(x)
        roots = self.accuracy.roots + (self.residual is not None)
        for n in range(roots + 1):
            t = np.fmin(np.fmax(t, 0.0), 1.0)
            y, v = value(terms, t)
            if self.residual is not None and n:
                w, dw = self._residual_motion(
                    self.residual, x + (1.0 - x) * t, k, lasts
                )
                y, v = y + drive * w, v + drive * dw * h
            if n < roots:
                t = t - y / v
        return x + (1.0 - x) * t, v / h, w, dw

    def _residual_motion(
        self, residual: Array, share: Array, k: Array, lasts: Array
    ) -> tuple[Array, Array]:
        """(W, W') at x of lines that last `lasts` [tau]."""
        count = self.count[k]
        j = np.minimum((share * count).astype(np.intp), count - 1)
        w, dw, start, rise = residual[:, self.sample[k] + j]
        part, over, pace = lasts / count, share * count - j, lasts / self.length[k]
        first, second = start * over, rise * over * over
        w = (
            w * pace**2
            + dw * pace * part * over
            + part * part * over * (0.5 * first + second / 6.0)
        )
        return w, dw * pace + part * (first + 0.5 * second)

    def _end(self, at: Array) -> None:
        """Find the outcome of lanes that still rock at the end of their record, by
        their free motion.
        """
        for row in np.unique(self.row[at]).tolist():
            i, lane, side = (
                at[self.row[at] == row],
                self.scans[row // self.sides].lane,
                row % self.sides,
            )
            contact, equation = lane.system.contact, lane.system.equation
            cells = contact.cells(
                equation,
                self.amplitude[i],
                np.broadcast_to(lane.omega, i.shape),
                np.broadcast_to(lane.eta, i.shape),
            )
            lanes = lane.lanes(cells, self.scans[0].edges[side].side)
            free = contact.free_motion(
                equation, lanes, np.arange(i.size), self.y[i], self.v[i]
            )
            self._falls(self.number[i[free.overturns]])
            self.outcome[self.number[i[free.overturns_after_impact]]] = (
                Outcome.OVERTURNED_AFTER_IMPACT
            )


def _lines(segments: Segments, step: float) -> Lines:
    """The lines of a record. Each line covers whole segments, up to `step` [rad] in
    all, or a part of a segment.
    """
    start, length = segments.s_start[:], segments.length[:]
    change = segments.s_end[:] - start
    count = max(1, int(step / length.max() * (1.0 + 1e-9)))
    if count == 1 or np.ptp(length) > 1e-9 * length.max():
        cuts = np.maximum(1, np.ceil(length / step * (1.0 - 1e-9))).astype(np.intp)
        part = np.arange(cuts.sum()) - np.repeat(np.cumsum(cuts) - cuts, cuts)
        start, change, length, cuts = (
            np.repeat(x, cuts) for x in (start, change, length, cuts)
        )
        return Lines(
            start + change * part / cuts,
            change / cuts,
            length / cuts,
            np.zeros((4, length.size, 0)),
        )
    size = float(length[0])
    s, rise = (
        np.append(x, np.zeros(-x.size % count)).reshape(-1, count)
        for x in (start, change)
    )
    middle = size * (np.arange(count) + 0.5 - 0.5 * count)
    moment = (size * (s + 0.5 * rise) * middle + size * size * rise / 12.0).sum(axis=1)
    whole = size * count
    gain = 12.0 * moment / whole**2
    begin = (s + 0.5 * rise).mean(axis=1) - 0.5 * gain
    r, r_rise = (
        s - begin[:, None] - gain[:, None] * np.arange(count) / count,
        rise - gain[:, None] / count,
    )
    gains = size * (r + 0.5 * r_rise)
    dw = np.cumsum(gains, axis=1) - gains  # before each sample of a line
    gains = size * dw + size * size * (0.5 * r + r_rise / 6.0)
    w = np.cumsum(gains, axis=1) - gains
    return Lines(begin, gain, np.full(begin.size, whole), np.array([w, dw, r, r_rise]))
