"""The lanes of an approximate scan: bodies at amplitudes, which move line by line.

In a round each lane moves to the end of its line or to an impact, with the Taylor terms
of `recurrence` on arrays. Lanes of many bodies share the cost of a round, and no bit of
a lane depends on the others.
"""

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ..arrays import Array
from ..dynamics.body import Edge, relief
from ..dynamics.contacts.contact import rebound
from ..dynamics.equations.recurrence import motion_terms
from ..dynamics.method import joined
from ..dynamics.one.lane import Lane, LaneEdge
from ..dynamics.one.step import value
from ..dynamics.outcome import Outcome
from .record_lines import RecordLines

_BRIEF = 5e-5  # bounces that last less are averaged [tau]
_SLOW = 1e-7  # a body is at rest after an impact below this speed
_MOST_ROUNDS = 100  # rounds over lines, after which a lane is left to the march
# after so many rounds, lanes at rest go to their next uplift and lanes at the end of
# the record finish
_UPLIFT_ROUNDS = 8
_TOLD_ROUNDS = 128  # rounds between two calls of a function for the progress
_SEARCH_LINES = 64  # number of lines that one search for the next uplift covers
_MORE = 1.1  # what the motion takes from Fz, over that at the ends of lines


class Accuracy(NamedTuple):
    """How closely a scan follows bodies."""

    degree: int  # degree of the series of a step
    roots: int  # number of steps of Newton's method to an impact


class Followed:
    """A body under a record, as a pool follows it."""

    lane: Lane  # the body and the record
    edges: list[LaneEdge]  # its edges under A = 1
    lines: RecordLines  # the record as lines
    accuracy: Accuracy  # how closely it is followed


class Struck(NamedTuple):
    """Lanes that strike the ground in a round. Every array is (lanes,)."""

    at: Array  # index of the lane
    k: Array  # index of the line
    x: Array  # time in the line over its length, before the step or at the impact [-]
    h: Array  # step of the series [tau]
    lasts: Array  # time that the line lasts [tau]


class ScanPool:
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
        "sway",  # zg''/g of s_v = 1 times A [-]
        "pace",  # tau over the phase [1/rad]
        "rested",  # line after the one in which the lane came to rest, -1 for others
        "least",  # least Fz/(m g) at the ends of lines, less what it may err by [-]
    )

    def __init__(self, scans: Sequence[Followed], amplitudes: list[Array]) -> None:
        edges = [edge for scan in scans for edge in scan.edges]
        self.scans, self.sides, row = scans, len(scans[0].edges), np.arange(len(edges))
        # The row of a body and side; `others`: the row of the other side of the body.
        self.others = row + self.sides - 1 - 2 * (row % self.sides)
        self.drives, self.sways, self.speed_ratio, self.limit, omega = (
            np.array([getattr(f, n) for f in edges])
            for n in ("drive", "sway", "speed_ratio", "limit", "omega")
        )
        # numbers of each row for Fz, None if no body may lose contact
        self.feet = None
        pairs = zip(scans, amplitudes, strict=True)
        if any(np.any(a > scan.lane.safe) for scan, a in pairs):
            none = Edge(0.0, 0.0, 0.0, 0.0)  # of a body whose forces are not known
            feet = [s.lane.feet.get(e.side, none) for s in scans for e in s.edges]
            self.feet = Edge(*np.array(feet).T)
        self.weighed = bool(self.sways.any())  # True if the weight varies
        self.paces, self.lowest_limit = 1.0 / omega, float(self.limit.min())
        self.equations = joined([edge.equation for edge in edges])
        self.accuracy = scans[0].accuracy
        self._store_lines(
            [scan.lines for scan in scans], [scan.edges for scan in scans]
        )

        body = np.repeat(np.arange(len(scans)), [a.size for a in amplitudes])
        self.number = np.arange(body.size)
        self.amplitude, self.row = np.concatenate(amplitudes), body * self.sides
        self.k, self.rested = self.end[body], self.begin[body]
        self.x, self.y, self.v, self.drive, self.sway, self.pace = np.zeros(
            (6, body.size)
        )
        self.least = np.full(body.size, np.inf)
        # of every lane, as far as they are known: the outcome, True after an impact,
        # and the least Fz, as those of lanes that still move
        self.outcome = np.full(body.size, Outcome.ROCKED, dtype=np.uint8)
        self.bounced = np.zeros(body.size, dtype=bool)
        self.leasts = self.least.copy()
        # the least s_v of each body, of which the ground falls away where w <= 0
        least = np.minimum.reduceat(
            np.minimum(self.up, self.up + self.up_rise), self.begin
        )
        sway = self.sways[self.row] * self.amplitude
        self.falls_freely = 1.0 + sway * least[body] <= 0.0

    def _store_lines(
        self, lines_of: list[RecordLines], edges_of: list[list[LaneEdge]]
    ) -> None:
        """Store the lines of the bodies one after the other; after those of each body
        follow lines of length 0, in which lanes wait.
        """
        # A lane that comes to rest waits there until the next search for uplifts, while
        # each round moves it one line on.
        still = np.zeros(_UPLIFT_ROUNDS + 1)
        begins = np.cumsum([0] + [lines.s.size + still.size for lines in lines_of])
        self.begin, self.end = begins[:-1], begins[1:] - still.size
        self.s, self.rise, self.length, self.up, self.up_rise = (
            np.concatenate([x for lines in lines_of for x in (lines[i], still)])
            for i in range(5)
        )

        # The largest and the least s of each line, and of all lines from it on: of the
        # effective motions of the edges, c over the drive of s = 1.
        padding = np.zeros(_SEARCH_LINES)
        high, low = np.zeros((2, self.s.size))
        for edges, begin, end in zip(edges_of, begins, begins[1:], strict=False):
            own = slice(begin, end)
            for edge in edges:
                share = edge.sway / edge.drive
                s = self.s[own] - share * self.up[own]
                s_end = s + self.rise[own] - share * self.up_rise[own]
                if edge.drive > 0.0:
                    high[own] = np.maximum(s, s_end)
                else:
                    low[own] = np.maximum(-s, -s_end)
        self.later = np.empty((2, self.s.size))
        for begin, end in pairwise(begins.tolist()):
            for later, x in zip(self.later, (high, low), strict=True):
                later[begin:end] = np.maximum.accumulate(x[begin:end][::-1])[::-1]
        high[self.end] = low[self.end] = np.inf
        self.high, self.low = np.append(high, padding), np.append(low, padding)

        # The residuals of all lines in one array: `count` samples a line, which begin
        # at `sample`.
        samples = [lines.residual.shape[2] for lines in lines_of]
        residuals = [
            np.pad(lines.residual, ((0, 0), (0, still.size), (0, 0))).reshape(4, -1)
            for lines in lines_of
        ]
        self.residual = np.concatenate(residuals, axis=1) if any(samples) else None
        self.count = np.repeat(samples, np.diff(begins))
        self.sample = np.cumsum(self.count) - self.count

    def march(
        self, progress: Callable[[float], None] | None = None
    ) -> tuple[Array, Array]:
        """March all lanes; returns (the outcome, `least`) of each lane."""
        rounds, most = 0, _MOST_ROUNDS * self.s.size
        while self.number.size and rounds < most:
            if rounds % _UPLIFT_ROUNDS == 0:
                self._next_uplifts()
            if progress is not None and rounds % _TOLD_ROUNDS == 0:
                progress(self._done())
            self._round()
            rounds += 1
        self.outcome[self.number] = Outcome.FAILED
        lost = self.falls_freely & (self.outcome == Outcome.ROCKED)
        self.outcome[lost] = Outcome.LOST_CONTACT
        return self.outcome, self.leasts

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
        """Go on with some of the lanes only; store the extremes of the others."""
        leave = ~stay
        self.leasts[self.number[leave]] = self.least[leave]
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
        first = self.row[at] // self.sides * self.sides
        self.k[at] = self._lifting_lines(at, first)
        self.y[at], self.v[at], self.rested[at] = 0.0, 0.0, -1
        self._lift(at, first)
        over[at] = self.k[at] == self.end[first // self.sides]
        self._keep(~over)

    def _lifting_lines(self, at: Array, first: Array) -> Array:
        """The line in which the drive next lifts each of the lanes `at`, or the end of
        its record; first: the row of their first side.
        """
        above, below = np.full((2, at.size), np.inf)  # s that lifts, and -s
        for side in range(self.sides):
            drive = self.drives[first + side] * self.amplitude[at]
            above = np.where(drive > 0.0, 1.0 / drive, above)
            below = np.where(drive < 0.0, -1.0 / drive, below)
        k = self.rested[at]
        lifts = (self.later[0, k] > above) | (self.later[1, k] > below)
        k[~lifts] = self.end[self.row[at[~lifts]] // self.sides]
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
        return k

    def _lift(self, at: Array, first: Array) -> None:
        """Put the lanes `at` on the side to which the drive lifts them in their line,
        at the time of the uplift; first: the row of their first side.
        """
        k, open_ = self.k[at], np.ones(at.size, dtype=bool)
        for side in range(self.sides):
            drive, sway = self._drive_and_sway(at, first + side)
            begin, end = (self._net(k, x, drive, sway) for x in (0.0, 1.0))
            up = open_ & (np.maximum(begin, end) > 1.0)
            i, open_ = at[up], open_ & ~up
            self.row[i], self.drive[i], self.sway[i] = (
                first[up] + side,
                drive[up],
                sway[up],
            )
            self.pace[i] = self.paces[first[up] + side]
            begin, end = begin[up], end[up]
            self.x[i] = np.where(begin < 1.0, (1.0 - begin) / (end - begin), 0.0)

    def _drive_and_sway(self, at: Array, row: Array) -> tuple[Array, Array]:
        """(outward drive of s = 1, zg''/g of s_v = 1) of the lanes `at` on these
        rows.
        """
        return self.drives[row] * self.amplitude[at], self.sways[row] * self.amplitude[
            at
        ]

    def _net(self, k: Array, x: Array | float, drive: Array, sway: Array) -> Array:
        """The net drive c at x of lines k."""
        net: Array = drive * (self.s[k] + self.rise[k] * x)
        if self.weighed:
            net -= sway * (self.up[k] + self.up_rise[k] * x)
        return net

    def _round(self) -> None:
        """Move each lane to the end of its line, or to an impact."""
        k, x, drive = self.k, self.x, self.drive
        left, s, rise = 1.0 - x, self.s[k], self.rise[k]
        # The Taylor series of the line, over what is left of it.
        lasts = self.length[k] * self.pace
        h = np.maximum(lasts * left, 1e-12)
        square = h * h
        factors = [
            square * (1.0 / ((n + 1) * (n + 2)))
            for n in range(self.accuracy.degree - 1)
        ]
        weight = None
        if self.weighed:
            gain = self.sway * self.up_rise[k]
            weight = [1.0 + self.sway * self.up[k] + gain * x, gain * left]
        terms = motion_terms(
            self.equation,
            self.y,
            self.v,
            h,
            factors,
            [drive * (s + rise * x), drive * (rise * left)],
            weight,
        )
        # The state at the end of the line: y and y' are the sums of the terms.
        self.y = sum(terms[1:], terms[0])
        self.v = sum((n * c for n, c in enumerate(terms[2:], 2)), terms[1]) / h
        self.k, self.x = k + 1, np.zeros_like(x)
        if self.feet is not None:
            force = sum(n * (n - 1) * c for n, c in enumerate(terms[2:], 2)) / square
            self._press(np.arange(k.size), k, x + left, force)

        hit = np.flatnonzero(self.y <= 0.0)
        if hit.size:
            self._strike(
                Struck(hit, k[hit], x[hit], h[hit], lasts[hit]), [c[hit] for c in terms]
            )
        if not self.y.max(initial=0.0) <= self.lowest_limit:
            fallen = ~(self.y <= self.limit[self.row])
            self._falls(self.number[fallen])
            self._keep(~fallen)

    def _press(self, at: Array, k: Array, x: Array, force: Array) -> None:
        """Lower `least` of the lanes `at` to Fz at x of their lines, where y'' is
        `force`.
        """
        assert self.feet is not None
        here = Edge(*(foot[self.row[at]] for foot in self.feet))
        taken = relief(here, self.y[at], self.v[at], np.abs(force))
        weight = 1.0 + self.sway[at] * (self.up[k] + self.up_rise[k] * x)
        self.least[at] = np.fmin(self.least[at], weight - _MORE * taken)

    def _strike(self, struck: Struck, terms: list[Array]) -> None:
        """Apply the impacts of lanes in the step with these terms."""
        at, k = struck.at, struck.k
        row = self.row[at]
        self.bounced[self.number[at]] = True
        x, v, w, dw = self._impact(terms, struck, self.drive[at])
        v = rebound(self.speed_ratio[row], np.minimum(v, 0.0))

        # On to the other side.
        row, unit = self.others[row], 1.0 / self.pace[at]
        pace, (drive, sway) = self.paces[row], self._drive_and_sway(at, row)
        unit *= pace
        self.row[at], self.drive[at], self.sway[at] = row, drive, sway
        self.pace[at], self.y[at] = pace, 0.0
        self.equation = self.equations.on(self.row, self.row)
        if self.feet is not None:  # the bounces to come in the line begin here
            self.v[at] = v
            for end in (x, np.ones_like(x)):
                self._press(at, k, end, self._net(k, end, drive, sway) - 1.0)
        slow, averaged = self._averaged_bounces(struck._replace(x=x), v)
        self.v[at] = np.where(averaged, np.fmax(slow, 0.0), v)

        # A body that hardly bounces, where the drive lifts it later in the line, waits
        # in the line, or at its end for the next one.
        rests = np.where(averaged, ~(slow > _SLOW), v <= _SLOW)
        on = np.flatnonzero(~averaged & ~rests)
        i = at[on]
        self.k[i], self.x[i] = k[on], x[on]
        self.y[i] = -drive[on] * w[on] * unit[on] ** 2
        self.v[i] = v[on] - drive[on] * dw[on] * unit[on]

        i = at[rests]
        self.rested[i] = (k + (averaged | (x > 1.0 - 1e-9)))[rests]
        self.k[i] = self.end[row[rests] // self.sides]
        self.y[i], self.v[i] = 1e-9, 0.0

    def _averaged_bounces(self, struck: Struck, v: Array) -> tuple[Array, Array]:
        """(velocity at the end of the line if all bounces within it are averaged, True
        where they are) of lanes that leave the ground with v, at x of their line; the
        drive is that halfway to the end of the line.
        """
        at, k, x = struck.at, struck.k, struck.x
        row, middle = self.row[at], 0.5 + 0.5 * x
        # A bounce under the force f lasts 2 v/f; only short ones are averaged.
        here = 1.0 - self._net(k, middle, self.drive[at], self.sway[at])
        averaged = (here > 0.0) & (2.0 * v < _BRIEF * here)
        bounce, cycle_ratio = 2.0 * v / here, self.speed_ratio[row]
        if self.sides == 2:
            # A cycle has a bounce on each side, as in Lemma 7.
            other = self.others[row]
            there = 1.0 - self._net(k, middle, *self._drive_and_sway(at, other))
            bounce = bounce + 2.0 * cycle_ratio * v / np.maximum(there, 1e-3)
            cycle_ratio = cycle_ratio * self.speed_ratio[other]
        # A cycle takes the time `bounce` and 1 - q of the speed: under a constant force
        # the speed falls linearly with the time.
        left = self.length[k] * self.pace[at] * (1.0 - x)
        return v * (1.0 - left * (1.0 - cycle_ratio) / bounce), averaged

    def _impact(
        self, terms: list[Array], struck: Struck, drive: Array
    ) -> tuple[Array, Array, Array, Array]:
        """(x of the line at which y comes to 0, y' there, W and W' there) of lanes in
        the step with these terms.
        """
        x, h = struck.x, struck.h
        y, v, half = terms[:3]
        # First guess from the first three terms, then Newton's method within the line.
        root = np.sqrt(np.maximum(v * v - 4.0 * half * y, 0.0))
        t = np.where(v > 0.0, -0.5 * (v + root) / half, 2.0 * y / (root - v))
        w = dw = np.zeros_like(x)
        roots = self.accuracy.roots + (self.residual is not None)
        for n in range(roots + 1):
            t = np.fmin(np.fmax(t, 0.0), 1.0)
            y, v = value(terms, t)
            if self.residual is not None and n:
                w, dw = self._residual_motion(self.residual, x + (1.0 - x) * t, struck)
                y, v = y + drive * w, v + drive * dw * h
            if n < roots:
                t = t - y / v
        return x + (1.0 - x) * t, v / h, w, dw

    def _residual_motion(
        self, residual: Array, share: Array, struck: Struck
    ) -> tuple[Array, Array]:
        """(W, W') at these shares of the lines of lanes."""
        k, count = struck.k, self.count[struck.k]
        j = np.minimum((share * count).astype(np.intp), count - 1)
        w, dw, start, rise = residual[:, self.sample[k] + j]
        pace = struck.lasts / self.length[k]
        part, over = struck.lasts / count, share * count - j
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
            i, side = at[self.row[at] == row], row % self.sides
            lane = self.scans[row // self.sides].lane
            contact, equation = lane.system.contact, lane.system.equation
            cells = contact.cells(
                equation,
                self.amplitude[i],
                np.broadcast_to(lane.omega, i.shape),
            )
            lanes = lane.lanes(cells, self.scans[0].edges[side].side)
            free = contact.free_motion(
                equation, lanes, np.arange(i.size), self.y[i], self.v[i]
            )
            self._falls(self.number[i[free.overturns]])
            self.outcome[self.number[i[free.overturns_after_impact]]] = (
                Outcome.OVERTURNED_AFTER_IMPACT
            )
            if self.feet is not None and lane.body is not None:
                lanes.y, lanes.v = self.y[i], self.v[i]
                least = lane.watch().least_to_come(lanes)
                self.least[i] = np.fmin(self.least[i], least)
