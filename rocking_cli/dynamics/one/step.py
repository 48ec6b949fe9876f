"""One step of a body on floats: the Taylor series of y, as far as it holds, cut to a
part on which y' changes its sign at most once (Lemma 1).

The terms of a step are in powers of the time over its length, x from 0 to 1.
"""

import math
from collections.abc import Sequence
from itertools import pairwise
from operator import mul
from typing import Any

from ..equations.taylor import MOST_TERMS
from ..march.roots import from_powers

_HALVINGS = 40  # two turns closer than 1e-12 of a step count as none
NUMBERS = [float(n) for n in range(MOST_TERMS + 1)]
# n (n - 1), of the terms of h^2 y''; an eighth of it, and so on: by so much of term n
# at most do y, h y' and h^2 y'' leave their chords
BENDS = [float(n * (n - 1)) for n in range(MOST_TERMS + 1)]
_CHORD_OF_Y = [0.125 * n * (n - 1) for n in range(MOST_TERMS + 1)]
_CHORD_OF_V = [0.125 * n * (n - 1) * (n - 2) for n in range(MOST_TERMS + 1)]
_CHORD_OF_BEND = [
    0.125 * n * (n - 1) * (n - 2) * (n - 3) for n in range(MOST_TERMS + 1)
]


def value(terms: Sequence[Any], x: Any, h: float = 1.0) -> tuple[Any, Any]:
    """(y, dy/dt) at the time x h of a step h, x from 0 to 1; terms: of y, in powers of
    x; floats or arrays.
    """
    y = v = 0.0
    for c in reversed(terms):
        v = v * x + y
        y = y * x + c
    return y, v / h


def end_of(terms: list[float]) -> tuple[float, float]:
    """(y, h y') at the end of a step."""
    return sum(terms), sum(map(mul, NUMBERS, terms))


def bulge(terms: list[float]) -> float:
    """Bound of how far y leaves the chord between its ends."""
    return sum(map(mul, _CHORD_OF_Y, map(abs, terms)))


def keeps_its_sign(terms: list[float], speed: float) -> bool:
    """True if the chord of h y', which is `speed` at the end, proves that it keeps its
    sign.
    """
    error = sum(map(mul, _CHORD_OF_V, map(abs, terms)))
    first = terms[1]
    return (first > error and speed > error) or (first < -error and speed < -error)


def shorter(terms: list[float], share: float) -> list[float]:
    """The terms over a share of the step."""
    found, power = [], 1.0
    for c in terms:
        found.append(c * power)
        power *= share
    return found


def one_turn(terms: list[float]) -> tuple[float, bool, bool]:
    """(share of the step on which y' changes its sign at most once, True if the body
    then moves outwards first, True if it turns).
    """
    # The chord of h^2 y'' proves that y' only rises, or only falls.
    start, first, bend = terms[1], 2.0 * terms[2], sum(map(mul, BENDS, terms))
    error = sum(map(mul, _CHORD_OF_BEND, map(abs, terms)))
    if (first > error and bend > error) or (first < -error and bend < -error):
        outward = start > 0.0 or (start == 0.0 and first > 0.0)
        speed = end_of(terms)[1]
        return 1.0, outward, outward != (speed > 0.0) and speed != 0.0

    # The Bernstein coefficients of y' on the share change their sign at least as often.
    rate, share = list(map(mul, NUMBERS[1:], terms[1:])), 1.0
    for _ in range(_HALVINGS):
        signs = [b > 0.0 for b in (from_powers(len(rate)) @ rate).tolist() if b]
        changes = sum(a != b for a, b in pairwise(signs))
        if changes < 2:
            break
        share *= 0.5
        rate = shorter(rate, 0.5)
    return share, bool(signs and signs[0]), changes % 2 == 1


def turn_of(terms: list[float]) -> float:
    """The only x from 0 to 1 at which y' changes its sign."""
    rate = list(map(mul, NUMBERS[1:], terms[1:]))
    return root(rate, 0.0, 1.0, -rate[0] / rate[1] if rate[1] else 0.5)


def after_turn(terms: list[float]) -> float:
    """The only x at which a body that first moves outwards and then inwards comes to y
    = 0, in a step at whose end y <= 0.
    """
    # Any point with y > 0 lies before it, such as one close to the peak.
    high = -0.5 * terms[1] / terms[2] if terms[2] < 0.0 else 1.0
    if not (0.0 < high < 1.0 and value(terms, high)[0] > 0.0):
        high = turn_of(terms)
    return root(terms, high, 1.0, 2.0 * high)


def only_fall(terms: list[float], stop: float) -> float:
    """The only x from 0 to `stop` at which a body that moves inwards comes to y = 0."""
    y, v, b = terms[0], terms[1], terms[2]
    fall = v * v - 4.0 * b * y
    guess = 2.0 * y / (math.sqrt(fall) - v) if fall > v * v or v < 0.0 < fall else stop
    return root(terms, 0.0, stop, guess)


def root(terms: list[float], low: float, high: float, guess: float) -> float:
    """The only root of a polynomial between two points at which its signs differ, or at
    the first of which it is 0: Newton's method in a bracket that only shrinks.
    """
    falls = value(terms, high)[0] <= 0.0
    x = guess if low < guess < high else 0.5 * (low + high)
    for _ in range(200):
        height, slope = value(terms, x)
        if (height > 0.0) == falls:
            low = x
        else:
            high = x
        step = height / slope if slope else math.inf
        if abs(step) <= 1e-9 * x or high - low <= 4e-16 * high:
            return min(max(x - step, low), high)
        x -= step
        if not low < x < high:
            x = 0.5 * (low + high)
    return x
