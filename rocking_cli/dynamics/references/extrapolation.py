"""An equation of second order by the modified midpoint rule, extrapolated to steps of no length (Gragg, Bulirsch and Stoer).

Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I, II.9. It is a Runge-Kutta method of any order and a page of
plain arithmetic; SciPy's solvers, which it stands for in checks, take longer to import than a small sweep takes.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

Rate = Callable[[float, float, float], tuple[float, float]]  # (theta', w') of (time, theta, w)

_PARTS = (2, 4, 6, 8, 10, 12, 14, 16)  # of a step, in one midpoint rule after the other
_TOLERANCE = 1e-11  # between the last two extrapolations, over the state; the last one is nearer by (length/2)^2
_LEAST = 1e-15  # what they may differ by in any case: forces that hardly lift a body are differences of terms of order one
_PIECES = 5  # steps of a stretch, at the ends of which signs are compared
_SHORTEST = 1e-12  # of a stretch
_HOP = 1e-6  # of a stretch: hops from rest that are shorter count as none
_NEAR = 1e-9  # of the time to a root
_ROUNDS = 100  # of a search for a root; bisection alone takes 60


class Point(NamedTuple):
    """An instant of a path; w is the velocity that the equation goes by."""

    time: float
    theta: float
    w: float


class Path(NamedTuple):
    """Where a stretch of time leads: the crests on it, its last instant, which is on the ground where the body struck, and the ends of
    the steps on the way, from its first instant to the last."""

    crests: list[Point]
    end: Point
    struck: bool
    steps: list[Point]


def step(rate: Rate, start: Point, length: float) -> Point | None:
    """The instant `length` later; None where the extrapolations do not agree, so that the step is too long."""
    try:
        return _extrapolated(rate, start, length)
    except (ArithmeticError, ValueError):  # a trial has left what a double, or the equation, can hold
        return None


def _extrapolated(rate: Rate, start: Point, length: float) -> Point | None:
    time, theta, w = start
    first = rate(time, theta, w)
    table: list[tuple[float, float]] = []  # the last row: the rule itself, then extrapolated once, twice, ...
    for k, parts in enumerate(_PARTS):
        h = length / parts
        before, here = (theta, w), (theta + h * first[0], w + h * first[1])
        for i in range(1, parts):
            speed, force = rate(time + i * h, *here)
            before, here = here, (before[0] + 2.0 * h * speed, before[1] + 2.0 * h * force)
        speed, force = rate(time + length, *here)
        row = [(0.5 * (before[0] + here[0] + h * speed), 0.5 * (before[1] + here[1] + h * force))]
        for j in range(k):
            over = (parts / _PARTS[k - 1 - j]) ** 2 - 1.0
            row.append((row[j][0] + (row[j][0] - table[j][0]) / over, row[j][1] + (row[j][1] - table[j][1]) / over))
        if k > 2:
            found, other = row[-1], row[-2]
            span = abs(length * first[0]), abs(length * first[1])
            known = (theta, w)
            if all(
                abs(a - b) <= max(_LEAST, _TOLERANCE * max(abs(a), abs(c), d)) for a, b, c, d in zip(found, other, known, span, strict=True)
            ):
                return Point(time + length, *found)
        table = row
    return None


def path(rate: Rate, start: Point, stop: float, limit: float) -> Path:
    """From an instant on or above the ground until `stop`, an impact, or an angle beyond `limit`.

    Between the ends of two steps there is at most one crest, or one dip, which may come to the ground where both ends lie above it.
    """
    crests: list[Point] = []
    stretch, passed = stop - start.time, 0.0
    length, here, steps = stretch / _PIECES, start, [start]
    while passed < stretch:
        if stretch - passed < 1.001 * length:
            length = stretch - passed
        there = step(rate, here, length)
        if there is None:
            length *= 0.5
            if length < _SHORTEST * stretch:
                raise ArithmeticError(f"no step from {here} is short enough")
            continue
        if here.theta == here.w == 0.0 >= there.w and length > _HOP * stretch:  # from rest into the air and down again in one step
            length *= 0.5
            continue
        passed += length
        there = there._replace(time=stop if passed >= stretch else start.time + passed)
        if here.w < 0.0 < there.w and there.theta > 0.0:
            bottom = _passes_zero(rate, here, there, 2, -1.0)
            there = bottom if bottom.theta <= 0.0 else there
        struck = there.theta <= 0.0
        if struck:
            there = _passes_zero(rate, here, there, 1)
        if here.w > 0.0 >= there.w:
            crests.append(_passes_zero(rate, here, there, 2))
        steps.append(there)
        if struck:
            return Path(crests, there, True, steps)
        here = there
        if here.theta > limit:
            break
    return Path(crests, here, False, steps)


def _passes_zero(rate: Rate, start: Point, end: Point, which: int, sense: float = 1.0) -> Point:
    """The instant between two at which theta (which = 1) or w (2) falls (sense = 1) or rises (-1) through zero, by Newton's method in a
    bracket.

    It begins at the root of Hermite's cubic and ends 1e-9 of the way from the root: what is left the caller's tangent takes.
    """
    span = end.time - start.time
    low, high = 0.0, span
    ends = (sense * x for x in (start[which], span * rate(*start)[which - 1], end[which], span * rate(*end)[which - 1]))
    length, there = span * _cubic_root(*ends), end
    for _ in range(_ROUNDS):
        there = step(rate, start, length) or there
        value, slope = sense * there[which], sense * rate(*there)[which - 1]
        low, high = (length, high) if value > 0.0 else (low, length)
        target = length - value / slope if slope < 0.0 else low
        target = target if low < target < high else 0.5 * (low + high)
        if abs(target - length) <= _NEAR * target or not low < target < high:
            break
        length = target
    return there


def _cubic_root(a: float, rate_a: float, b: float, rate_b: float) -> float:
    """Where the cubic of these values and slopes at 0 and 1 falls through zero, b <= 0; halved twenty times."""
    low, high = 0.0, 1.0
    for _ in range(20):
        x = 0.5 * (low + high)
        rest = 1.0 - x
        cubic = rest * rest * ((1.0 + 2.0 * x) * a + x * rate_a) + x * x * ((1.0 + 2.0 * rest) * b - rest * rate_b)
        low, high = (x, high) if cubic > 0.0 else (low, x)
    return 0.5 * (low + high)
