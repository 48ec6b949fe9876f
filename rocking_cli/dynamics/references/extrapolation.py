"""Solves an equation of second order, with its peaks and its impact: by the modified
midpoint rule, extrapolated to step length 0 (Gragg, Bulirsch and Stoer; Hairer, Norsett
and Wanner, Solving Ordinary Differential Equations I, II.9).
SciPy's solvers take longer to import than a small sweep takes.
"""

import math
from collections.abc import Callable
from contextlib import suppress
from typing import NamedTuple

# (theta', w') of (time, theta, w)
Slopes = Callable[[float, float, float], tuple[float, float]]

# numbers of parts of a step, in the successive midpoint rules
_PARTS = (2, 4, 6, 8, 10, 12, 14, 16)
# difference of the last two extrapolations over the state; the error of the last one is
# (length/2)^2 times as large
_TOLERANCE = 1e-14
# difference that is always accepted, over the critical angle: a force that hardly lifts
# a body is a difference of terms of the order of this angle
_LEAST = 1e-15
# number of extrapolations that are compared at the least
_ROWS = 3
# a step with a dip of the velocity inside is halved down to this length, over the
# span
_DIP = 1.0 / 64.0
# first step from an impact over speed/force: four times as long as the bounce
_BOUNCES = 8.0
_SHORTEST = 1e-12  # least step, over the length of the span
# a motion from rest back to the ground that is shorter, over the span, is ignored
_HOP = 1e-6
_NEAR = 1e-9  # error of the time to a root
_ROUNDS = 100  # limit of a search for a root; bisection alone takes 60


class StatePoint(NamedTuple):
    """An instant of a path."""

    time: float  # the instant [tau]
    theta: float  # rotation [rad]
    w: float  # velocity of the equation, by tau


class Path(NamedTuple):
    """The motion on a span of time."""

    peaks: list[StatePoint]  # peaks of the rotation
    end: StatePoint  # its last instant
    struck: bool  # True if the body struck the ground at the last instant
    steps: list[StatePoint]  # the ends of all steps


class EdgeMotion(NamedTuple):
    """An equation of motion on one edge, under one piece of a motion."""

    rate: Slopes  # its right side
    unit: float = 1.0  # critical angle [rad]

    def step(
        self,
        start: StatePoint,
        length: float,
        first: tuple[float, float] | None = None,
    ) -> StatePoint | None:
        """Return the state `length` after `start`; None if the step is too long for the
        extrapolations to agree. first: the rates at the start, where they are known.
        """
        time, theta, w = start
        last: list[tuple[float, float]] = []  # the row before in the table
        # A midpoint may leave the range of doubles, or of the equation.
        with suppress(ArithmeticError, ValueError):
            first = first or self.rate(time, theta, w)
            for k, parts in enumerate(_PARTS):
                # The rule itself, then extrapolated once, twice, ...
                row = [_midpoint_rule(self.rate, start, first, length, parts)]
                for j in range(k):
                    over = (parts / _PARTS[k - 1 - j]) ** 2 - 1.0
                    row.append(
                        (
                            row[j][0] + (row[j][0] - last[j][0]) / over,
                            row[j][1] + (row[j][1] - last[j][1]) / over,
                        )
                    )
                if k + 1 >= _ROWS and all(
                    abs(a - b)
                    <= max(
                        _LEAST * self.unit,
                        _TOLERANCE * max(abs(a), abs(c), abs(length * d)),
                    )
                    for a, b, c, d in zip(
                        row[-1], row[-2], (theta, w), first, strict=True
                    )
                ):
                    return StatePoint(time + length, *row[-1])
                last = row
        return None


def _midpoint_rule(
    rate: Slopes,
    start: StatePoint,
    first: tuple[float, float],
    length: float,
    parts: int,
) -> tuple[float, float]:
    """(theta, w) after a step of this length, by the modified midpoint rule in so many
    parts; first: the rates at the start.
    """
    time, theta, w = start
    h = length / parts
    before, here = (theta, w), (theta + h * first[0], w + h * first[1])
    for i in range(1, parts):
        speed, force = rate(time + i * h, *here)
        after = (before[0] + 2.0 * h * speed, before[1] + 2.0 * h * force)
        before, here = here, after
    speed, force = rate(time + length, *here)
    return (
        0.5 * (before[0] + here[0] + h * speed),
        0.5 * (before[1] + here[1] + h * force),
    )


def path(flow: EdgeMotion, start: StatePoint, stop: float, limit: float) -> Path:
    """The path from an instant on or above the ground until `stop`, an impact, or an
    angle beyond `limit`. It finds at most one peak in a step, or one dip, which may
    reach the ground although both ends of the step lie above it. The span is one
    step where the extrapolations agree. Raises ArithmeticError when no step is short
    enough.
    """
    rate = flow.rate
    peaks: list[StatePoint] = []
    span, passed = stop - start.time, 0.0
    longest, here, steps = span, start, [start]
    rates, length = rate(*start), span
    if start.theta == 0.0 < start.w and rates[1] < 0.0:
        # a bounce must not hide within a step
        length = min(span, -_BOUNCES * start.w / rates[1])
    while passed < span and here.theta <= limit:
        if span - passed < 1.001 * length:
            length = span - passed
        there = flow.step(here, length, rates)
        if there is None or _hides(
            here, rates, there, after := rate(*there), length / span
        ):
            length = longest = 0.5 * length
            if length < _SHORTEST * span:
                raise ArithmeticError(f"no step from {here} is short enough")
            continue
        passed += length
        there = there._replace(time=stop if passed >= span else start.time + passed)
        if here.w < 0.0 < there.w and there.theta > 0.0:
            bottom = passes(flow, here, there, 2, -1.0)
            there = bottom if bottom.theta <= 0.0 else there
        struck = there.theta <= 0.0
        if struck:
            there = passes(flow, here, there, 1)
        if here.w > 0.0 >= there.w:
            peaks.append(passes(flow, here, there, 2))
        steps.append(there)
        length = min(2.0 * length, longest)
        if struck:
            return Path(peaks, there, True, steps)
        here, rates = there, after
    return Path(peaks, here, False, steps)


def _hides(
    here: StatePoint,
    rates: tuple[float, float],
    there: StatePoint,
    after: tuple[float, float],
    part: float,
) -> bool:
    """True if an arc or a dip may hide within a step between two states with these
    rates; part: its length over the span.
    """
    # A step from rest that ends without outward speed: the body may have gone up and
    # down again inside it.
    hop = here.theta == here.w == 0.0 >= there.w and part > _HOP
    # A velocity that first falls and then rises may be negative between the ends.
    falls_and_rises = rates[1] < 0.0 < after[1] and min(here.w, there.w) > 0.0
    return hop or (falls_and_rises and part > _DIP)


def passes(
    flow: EdgeMotion,
    start: StatePoint,
    end: StatePoint,
    which: int,
    sense: float = 1.0,
    level: float = 0.0,
) -> StatePoint:
    """Where theta (which = 1) or w (2) falls (sense = 1) or rises (-1) through a level,
    to `_NEAR`; the caller adds a tangent step.
    """
    rate = flow.rate
    low, high = 0.0, end.time - start.time
    # First a parabola through both ends, with the slope of the start.
    first, last = (sense * (one[which] - level) for one in (start, end))
    slope = sense * rate(*start)[which - 1] * high
    bend = first + slope - last
    root = math.sqrt(max(0.0, slope * slope + 4.0 * bend * first))
    length = high * min(1.0, 0.5 * (slope + root) / bend) if bend > 0.0 else high
    there = flow.step(start, length) or end
    for _ in range(_ROUNDS):
        value = sense * (there[which] - level)
        slope = sense * rate(*there)[which - 1]
        low, high = (length, high) if value > 0.0 else (low, length)
        target = length - value / slope if slope < 0.0 else low
        target = target if low < target < high else 0.5 * (low + high)
        if abs(target - length) <= _NEAR * target or not low < target < high:
            break
        length = target
        there = flow.step(start, length) or there
    return there
