"""Whole straight lines of a record along which nothing happens to tied bodies: the
march takes such lines without a search for events.

Over a line of duration h the motion has the terms c_n of y, in powers of the time over
h. With a_j = sum n (n - 1) ... (n - j + 1) |c_n|,

    h |y'| <= a_1,    h^2 |y''| <= a_2,    |y - its chord| <= a_2/8,
    |h y' - its chord| <= a_3/8

since a function leaves the chord between its ends by at most an eighth of its largest
second derivative. A line is clear if these bounds prove that y stays between the ends
of the branch of the restraints and that no peak changes a result, if the largest speed
and acceleration leave Fz > 0 (as in `contact_watch`), and if the last terms show that
the series holds. Any other line goes through a round of the march.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from ...arrays import Array
from ...motions.segments import Segments
from ..body import Body
from ..equations.equation import Equation
from ..equations.recurrence import TermRows, motion_terms
from ..equations.taylor import (
    MOST_TERMS,
    WITHIN,
    changes,
    degrees,
    factors_for,
    last_terms,
    left_out,
    next_term,
)
from .carried import carry
from .devices import BROKEN, Devices
from .series import HeldBody, growth
from .tied_lanes import OnBranch, TiedLanes

LEAST_LINES = 100  # under fewer lines every line goes through a round
_LONGEST = 0.5  # duration of a line that is tried, at most [tau]
_TOGETHER = 12  # lines that many bodies take before the next round
_SHARE = 0.4  # of the bodies: if fewer go on, a round comes first
# factor of the size that gives the degree of a series: one term more at most, without
# which a third of the lines of stiff ties would not hold
_ROOM = 64.0
# n (n - 1) ... (n - j + 1) for j = 0 ... 3, (j, terms)
_FACTORS = np.array(
    [
        [np.prod(n - np.arange(float(j))) for n in range(MOST_TERMS + 1)]
        for j in range(4)
    ]
)


class LineLimits(NamedTuple):
    """Limits within which nothing happens to lanes, (lanes,) each."""

    low: Any  # y at the lower end of the branch
    high: Any  # y at its upper end
    # y up to which no peak is the largest of the body or of a restraint; negative if
    # every peak is an event
    known: Any
    top: Any  # y beyond which the march asks whether the body overturns
    unit: Any  # rotation of y = 1 [rad]
    alpha: Any  # critical angle [rad]
    kappa: Any  # m R^2/I times the unit [rad]; 0 for lanes whose contact is not watched


class LineCourse(NamedTuple):
    """What does not change for lanes that go over lines, (lanes,) each."""

    held: HeldBody  # the equation
    limits: Any  # `LineLimits`, None as long as they are not set
    omega: Any  # Omega of the side [-]
    outward: Any  # outward drive of s = 1 [-]
    constant: Any  # of the devices, as of `Devices.linear_terms`
    stiffness: Any
    rate: Any  # growth rate of the motion [1/tau]

    def law(self, line: Any, v: Any) -> tuple[Any, Any, Any]:
        """As `changes`."""
        return changes(self.rate * self.rate, self.held, line, v)

    def left_of(self, lines: Sequence[Any], k: Any, u: Any) -> tuple[Any, Any, Any]:
        """(duration [tau], drive at the start, its increase) of what is left of line k
        from phase u on; lines: start and rise of s, length [rad] of each line, as lists
        or arrays.
        """
        start, rise, length = (x[k] for x in lines)
        share, gain = u / length, self.outward * rise
        drive = self.outward * start + gain * share
        return (length - u) / self.omega, drive, gain - gain * share

    def size(self, y: Any, v: Any, line: tuple[Any, Any, Any]) -> Any:
        """The size of the motion that gives the degree of its series (`degrees`)."""
        h, drive, gain = line
        shaking = 2.0 + abs(drive) + abs(gain) / h
        return _ROOM * (
            shaking + self.rate * abs(v) + self.constant + self.stiffness * y
        )


class LineEnd(NamedTuple):
    """The end of a line, and the sums a_j over it, (lanes,) each."""

    y: Any  # displacement at the end
    first: Any  # h y' at the end
    speed: Any  # a_1
    acceleration: Any  # a_2
    jerk: Any  # a_3

    @classmethod
    def of(cls, terms: Any) -> LineEnd:
        """Return the end of a line with these terms, (terms, lanes)."""
        # NumPy sums a single lane in another order.
        lanes = terms.shape[1]
        rows = np.repeat(terms, 2, axis=1) if lanes == 1 else terms
        factors = _FACTORS[:, : len(rows)]
        ends = np.einsum("jn,nl->jl", factors[:2], rows)[:, :lanes]
        sums = np.einsum("jn,nl->jl", factors[1:], np.abs(rows))[:, :lanes]
        return cls(*ends, *sums)


def is_clear(limits: LineLimits, y: Any, first: Any, end: LineEnd, h: Any) -> Any:
    """True where nothing happens on a line of duration h [tau] that begins at y with h
    y' = `first`, (lanes,) each.
    """
    bend, turn = 0.125 * end.acceleration, 0.125 * end.jerk
    lowest, highest = (y - bend, end.y - bend), (y + bend, end.y + bend)

    # y stays on the branch, near its chord; or it leaves an end of the branch and does
    # not turn back.
    above = ((lowest[0] > limits.low) & (lowest[1] > limits.low)) | (
        (y >= limits.low) & (first > 0.5 * end.acceleration)
    )
    below = ((highest[0] < limits.high) & (highest[1] < limits.high)) | (
        (y <= limits.high) & (first < -0.5 * end.acceleration)
    )

    # y' keeps its sign, or its peaks are below those that are known.
    no_peak = (
        ((first > turn) & (end.first > turn))
        | ((first < -turn) & (end.first < -turn))
        | ((highest[0] < limits.known) & (highest[1] < limits.known))
    )

    # Fz > 0, where |z| is at most alpha or theta - alpha.
    over = 1.0 / (h * h)
    centripetal = limits.unit * end.speed * end.speed * over
    pressed = True
    for lean in (limits.alpha, *(limits.unit * x - limits.alpha for x in highest)):
        downwards = lean * end.acceleration * over + centripetal
        pressed = pressed & (limits.kappa * downwards < 1.0)

    goes_on = (end.y <= limits.top) | (end.first <= 0.0)
    return above & below & no_peak & pressed & goes_on


class WholeLines:
    """Takes tied bodies over the lines of a record."""

    def __init__(
        self,
        equation: Equation,
        devices: Devices,
        segments: Segments,
        shaken: int,
    ) -> None:
        # shaken: number of lines of the record
        self.equation, self.devices, self.shaken = equation, devices, shaken
        self.watched: Body | None = devices.body  # body whose contact is watched
        # largest size of the last terms, over the duration of a line
        self.least = WITHIN * equation.tolerance
        # start and rise of s [-] and length [rad] of each line
        self.lines = (
            segments.s_start,
            segments.s_end - segments.s_start,
            segments.length,
        )

    def follow(self, lanes: TiedLanes, branch: OnBranch, top: Array) -> Array:
        """Move lanes over lines that are clear; True for lanes that may go on so.

        branch: of the restraints; top: as of `LineLimits`, (lanes,).
        """
        course = self._course(lanes, branch)._replace(
            limits=self._limits(lanes, branch, top)
        )
        y, v, k, u = lanes.y, lanes.v, lanes.segment, lanes.phase
        time, square = np.zeros(y.size), np.zeros(y.size)
        go = self._short(lanes, k, u)
        # The degree of the first line serves all: the last terms show if it is enough.
        _, *line = course.left_of(self.lines, k, u)
        whole = np.minimum(self.lines[2][k] / lanes.omega, _LONGEST)
        size = course.size(y, v, (whole, *line))
        degree = degrees(size, whole, self.equation.tolerance, course.rate)
        size *= 1.0 / _ROOM
        factors = factors_for(np.ones(go.size), degree)
        last = degree * go.size + np.arange(go.size)
        for _ in range(_TOGETHER):
            if np.count_nonzero(go) <= _SHARE * go.size:
                break
            h, *line = course.left_of(self.lines, k, u)
            h = np.minimum(h, _LONGEST)
            terms = motion_terms(
                course.held, y, v, h, h * h * factors, TermRows.of(*line)
            )
            # Lanes on clear lines go to the next line.
            end = LineEnd.of(terms)
            go &= last_terms(terms, last, h) <= self.least * h
            go &= is_clear(course.limits, y, terms[1], end, h)
            time += np.where(go, h, 0.0)
            flat = np.abs(terms).ravel()
            sizes = [flat[last - i * go.size] for i in range(3)]
            error = left_out(sizes, degree, h, course.law(line, h * v))
            error += next_term(size, h, degree, course.rate)
            square += np.where(go, error * error, 0.0)
            y, v = np.where(go, end.y, y), np.where(go, end.first / h, v)
            k, u = k + go, np.where(go, 0.0, u)
            go &= self._short(lanes, k, u)
        carry(lanes, course.held, (y, v), time, np.sqrt(square))
        lanes.steps += k - lanes.segment
        lanes.exact &= k == lanes.segment
        lanes.y, lanes.v, lanes.segment, lanes.phase = y, v, k, u
        return go

    def _short(self, lanes: TiedLanes, k: Array, u: Array) -> Array:
        """True for lanes on a line of the record that is short from phase u on."""
        left = self.lines[2][k] - u
        return (k < self.shaken) & (left <= _LONGEST * lanes.omega)

    def _course(self, lanes: TiedLanes, branch: OnBranch) -> LineCourse:
        """The course of lanes on a branch, with `limits` still to be set."""
        equation, devices = self.equation.on(lanes.side), self.devices
        constant, stiffness = devices.linear_terms(branch.row, branch.now)
        return LineCourse(
            HeldBody.of(equation, devices, branch.row, branch.now),
            None,
            lanes.omega,
            -lanes.side * lanes.amplitude,
            constant,
            stiffness,
            growth(stiffness),
        )

    def _limits(self, lanes: TiedLanes, branch: OnBranch, top: Array) -> LineLimits:
        """The limits of lanes on a branch; top: as of `LineLimits`."""
        row, now, ones = branch.row, branch.now, np.ones(lanes.y.size)
        unit, alpha, kappa = ones, ones, 0.0 * ones
        if self.watched is not None:
            edge = self.watched.on(lanes.side, lanes.cell)
            unit, alpha = edge.unit * ones, edge.alpha * ones
            kappa = np.where(lanes.lost, 0.0, edge.kappa * unit)
        # A broken restraint is not stretched any more.
        farthest = lanes.farthest[row, :, np.arange(row.size)].T
        broken = lanes.branch[row, :, np.arange(row.size)].T == BROKEN
        stretched = np.where(broken, np.inf, self.devices.level(row, farthest))
        known = np.minimum(lanes.peak, stretched.min(axis=0))
        return LineLimits(
            branch.low,
            branch.high,
            np.where(now.yields, -1.0, known),
            top,
            unit,
            alpha,
            kappa,
        )
