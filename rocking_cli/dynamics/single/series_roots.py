"""Roots of the series of one step: the instant of an impact, and the turning points."""

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any


def value(terms: Sequence[Any], x: Any, h: float = 1.0) -> tuple[Any, Any]:
    """(y, dy/dt) at the time x h of a step h, x from 0 to 1; terms: of y, in powers of
    x; floats or arrays.
    """
    y = v = 0.0
    for c in reversed(terms):
        v = v * x + y
        y = y * x + c
    return y, v / h


def only_root(terms: Sequence[float], h: float, fall: float, zeta: float) -> float:
    """The time of the only root of y within a step h, at whose end y <= 0; fall: K of
    Lemma 12, which bounds this time from below.
    """
    y, v, pull = max(terms[0], 0.0), terms[1] / h, -2.0 * terms[2] / (h * h)
    slow = v - zeta * h * abs(v)
    low, high = (slow + math.sqrt(slow * slow + 2.0 * fall * y)) / fall, h
    t = (v + math.sqrt(v * v + 2.0 * pull * y)) / pull if pull > 0.0 else high
    for _ in range(100):
        if not low <= t <= high:
            t = 0.5 * (low + high)
        y, v = value(terms, t / h, h)
        if y > 0.0:
            low = t
        else:
            high = t
        step = y / v if v < 0.0 else math.inf
        if abs(step) <= 1e-9 * t or high - low <= 4e-16 * high:
            return min(max(t - step, low), high) if v < 0.0 else t
        t -= step
    return t


def first_root(
    terms: Sequence[float], h: float, fall: float, zeta: float
) -> float | None:
    """The first time within a step h, after its start, at which y is 0; None if there
    is none. fall: bound K of the inward force.
    """
    t, y, v = 0.0, max(terms[0], 0.0), terms[1] / h
    for _ in range(500):
        slow = v - zeta * (h - t) * abs(v)
        step = (slow + math.sqrt(slow * slow + 2.0 * fall * y)) / fall
        t += step
        if not t < h:
            return None
        y, v = value(terms, t / h, h)
        if y <= 0.0 or (step <= 1e-6 * t and v < 0.0 and -y / v <= 1e-9 * t):
            break
    for _ in range(3):
        if v < 0.0:
            t = min(max(t - y / v, 0.0), h)
            y, v = value(terms, t / h, h)
    return t


def turns(terms: Sequence[float], stop: float) -> list[float]:
    """Times over the step, up to `stop`, at which y' falls through 0. It searches
    between the extremes of y', which are few.
    """
    rate = [n * c for n, c in enumerate(terms)][1:]
    marks = [0.0, stop]
    ends = [value(rate, 0.0), value(rate, stop)]
    if not ends[0][0] > 0.0 >= ends[1][0]:
        if ends[0][1] * ends[1][1] >= 0.0:
            return []
        second_derivative = [n * c for n, c in enumerate(rate)][1:]
        marks.insert(1, _crossing(second_derivative, 0.0, stop))
    found = []
    for low, high in pairwise(marks):
        if value(rate, low)[0] > 0.0 >= value(rate, high)[0]:
            found.append(_crossing(rate, low, high))
    return found


def _crossing(terms: Sequence[float], low: float, high: float) -> float:
    """The root of a polynomial between two points at which its signs differ: Newton's
    method in a bracket that only shrinks.
    """
    falls = value(terms, low)[0] > value(terms, high)[0]
    x = 0.5 * (low + high)
    for _ in range(100):
        height, slope = value(terms, x)
        if (height > 0.0) == falls:
            low = x
        else:
            high = x
        step = height / slope if slope else math.inf
        if abs(step) <= 1e-9 * x or high - low <= 1e-15 * high:
            return min(max(x - step, low), high)
        x -= step
        if not low < x < high:
            x = 0.5 * (low + high)
    return x
