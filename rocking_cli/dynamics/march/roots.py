"""Roots in steps that hold exactly one, as `one_turn` proves: impact times and turning
points. Each lane iterates by itself; no digit depends on its neighbours.
"""

from dataclasses import dataclass
from functools import lru_cache
from math import comb

import numpy as np

from ...arrays import Array
from ..equations.taylor import powers, product
from ..lanes import Arrays

_NODES = 17  # points of a step at which an impact is looked for
_NEAR = 6  # degree of the series about a guess
# longest step of that series, over the time since the start, and error of the root over
# the same time
_MOST, _CLOSE = 0.03, 1e-14
# the same at a turn: y is stationary there
_MOST_TURN, _CLOSE_TURN = 0.2, 1e-8
_SETTLED = 1e-12  # what Newton's last step may leave of the root, over the same time
_ROUNDING = 4e-16  # over the first terms of y
_ROUNDS = 80


@lru_cache(maxsize=64)
def from_powers(count: int) -> Array:
    """(count, count) matrix: converts coefficients of powers to Bernstein coefficients
    on [0, 1].
    """
    return np.array(
        [[comb(i, n) / comb(count - 1, n) for n in range(count)] for i in range(count)]
    )


def bernstein_form(terms: Array) -> Array:
    """Bernstein coefficients on [0, 1] of polynomials, (terms, lanes)."""
    return product(from_powers(len(terms)), terms)


@lru_cache(maxsize=64)
def _nodes(count: int) -> Array:
    """Rows: the values at equidistant points of a step, from the terms."""
    return np.linspace(0.0, 1.0, _NODES)[:, None] ** np.arange(float(count))


@lru_cache(maxsize=64)
def _shift(count: int) -> Array:
    """Rows k: binomials, which turn terms c_n s^n into the terms of a series about s in
    powers of the relative change of s.
    """
    return np.array(
        [[float(comb(n, k)) for n in range(count)] for k in range(_NEAR + 1)]
    )


def turn_guess(speeds: Array, positive: Array) -> Array:
    """A guess of the one zero of y' on (0, 1], where the polygon of its Bernstein
    coefficients has its own; positive: True where they are not negative.
    """
    lanes = np.arange(speeds.shape[1])
    same = np.count_nonzero(positive, axis=0)
    j = np.where(positive[0], same, len(positive) - same)  # before the change of sign
    a, b = speeds[j - 1, lanes], speeds[j, lanes]
    found: Array = np.clip((j - 1.0 + a / (a - b)) / (len(positive) - 1.0), 1e-3, 1.0)
    return found


def fall_guess(terms: Array, after: Array | float = 0.0) -> tuple[Array, Array, Array]:
    """(guess, low, high) of the one fall of y through zero on (after, 1], from its
    values at equidistant points.
    """
    values = product(_nodes(len(terms)), terms)
    values[0] = 1.0  # a start at the ground does not count
    below = values <= 0.0
    if np.any(after):
        below &= np.linspace(0.0, 1.0, _NODES)[:, None] > after
    below[-1] = True
    j = below.argmax(axis=0)
    lanes = np.arange(j.size)
    high, low = values[j, lanes], values[j - 1, lanes]
    low = np.where(j == 1, terms[0], low)
    share = np.where(low > 0.0, low / (low - np.minimum(high, 0.0)), 0.5)
    # a bounce from the ground within the first interval: a parabola
    lasts = -terms[1] / terms[2] * (_NODES - 1)
    lasts = np.where((lasts > 0.0) & (lasts < 1.0), lasts, 0.5)
    share = np.where((j == 1) & (terms[0] <= 0.0), lasts, share)
    width = 1.0 / (_NODES - 1)
    base = (j - 1.0) * width
    return base + np.clip(share, 1e-3, 1.0) * width, base, base + width


def only_root(
    terms: Array,
    guess: Array,
    low: Array | float = 0.0,
    high: Array | float = 1.0,
    *,
    speed: bool,
) -> Array:
    """(s, y, dy/ds, d2y/ds2), (4, lanes), at the one root s of y on (low, high] that
    falls through zero, or with `speed` of y'; NaN where it does not converge. s is in
    units of the step, terms are those of y in powers of it. The second derivative is
    given for impacts only.

    The series about the guess, of degree 6, gives a Householder step of fourth order
    and a step of Newton. A root that is too far away for that series is bracketed.
    """
    found, every = np.full((4, guess.size), np.nan), terms
    lanes, s = np.arange(guess.size), guess
    bracket = tuple(np.broadcast_to(x, s.shape) for x in (low, high))
    for _ in range(_ROUNDS):
        near = powers(s, len(terms))
        near *= terms
        q = product(_shift(len(terms)), near)  # terms of y in powers of (s' - s)/s
        step = _step(q, speed)
        low, high = _narrowed(step, s, bracket)
        good = _is_root(step, q, near, speed) & _is_inside(step.to(s), *bracket)
        done = np.flatnonzero(good | (high - low <= 4e-16 * high))
        if done.size:
            at, here = lanes[done], s[done]
            r = np.where(np.abs(step.r) < _most(speed), step.r, 0.0)[done]
            y, rate = _horner(q.take(done, axis=1), r, 0)
            found[0, at], found[1, at], found[2, at] = here * (1.0 + r), y, rate / here
            if done.size == s.size:
                break
            keep = np.delete(np.arange(s.size), done)
            lanes, terms, step = lanes[keep], terms.take(keep, axis=1), step.take(keep)
            s, low, high = s[keep], low[keep], high[keep]
        bracket = low, high
        s = _next(step, s, low, high)
    if not speed:
        # A body leaves an impact with its force: the local series is too short for it.
        near = powers(found[0], len(every))
        near *= every
        found[3] = product(_second_derivative(len(every)), near)[0]
        found[3] /= found[0] * found[0]
    return found


@dataclass
class LocalStep(Arrays):
    """A step from s to the root by the series about s. Every array is (lanes,)."""

    r: Array  # the step over s
    slope: Array  # derivative of y, or of y', by r at s
    value: Array  # y, or y', at s
    off: Array  # what Newton's last step leaves of it

    def to(self, s: Array) -> Array:
        """The s to which the step leads."""
        return np.asarray(s * (1.0 + self.r))


def _most(speed: bool) -> float:
    return _MOST_TURN if speed else _MOST


def _narrowed(
    step: LocalStep, s: Array, bracket: tuple[Array, ...]
) -> tuple[Array, Array]:
    """The brackets with s for the end of its sign."""
    low, high = bracket
    after = step.value <= 0.0
    return np.where(after, low, s), np.where(after, s, high)


def _is_root(step: LocalStep, q: Array, near: Array, speed: bool) -> Array:
    """True where a step ends at the root, as far as the series about s tells; near:
    the terms of y at s.
    """
    size, slope = np.abs(step.r), np.abs(step.slope)
    close = _CLOSE_TURN if speed else _CLOSE
    left_out = np.abs(q[_NEAR]) * size
    left_out += np.abs(q[_NEAR - 1])
    left_out *= size ** (_NEAR - 1 - speed)
    good = (size < _most(speed)) & (left_out <= close * slope) & (step.slope < 0.0)
    if speed:  # y is stationary, but what is left out of its own series counts
        good &= left_out * size * size <= _CLOSE * slope
    # next to a turn Newton's step has not settled: there the error after it must be
    # small too, or below the rounding of the terms
    rounding = np.abs(near[0]) + np.abs(near[1]) + np.abs(near[2])
    settled = max(close, _SETTLED) * slope
    return np.asarray(good & (step.off <= np.maximum(settled, _ROUNDING * rounding)))


def _is_inside(target: Array, low: Array, high: Array) -> Array:
    return (target >= low * (1.0 - 1e-9)) & (target <= high * (1.0 + 1e-9))


def _next(step: LocalStep, s: Array, low: Array, high: Array) -> Array:
    """The next s: after the step, else after Newton's step, else the middle of the
    bracket.
    """
    target, falls = step.to(s), step.slope < 0.0
    newton = s * (1.0 - step.value / step.slope)
    inside = falls & (newton > low) & (newton < high)
    newton = np.where(inside, newton, 0.5 * (low + high))
    return np.where((target > low) & (target < high) & falls, target, newton)


@lru_cache(maxsize=64)
def _second_derivative(count: int) -> Array:
    """Row: the second derivative of a polynomial at 1, from its terms."""
    n = np.arange(float(count))
    return (n * (n - 1.0))[None]


def _step(q: Array, speed: bool) -> LocalStep:
    """The step to the root of y, or of y', whose terms in powers of r are q."""
    value, slope, bend, third = (
        (q[1], 2.0 * q[2], 3.0 * q[3], 4.0 * q[4]) if speed else q[:4]
    )
    over = 1.0 / slope
    e = bend * over
    g = value * over
    r = -g * (1.0 - g * e) / (1.0 - 2.0 * g * e + g * g * third * over)
    p, d = _horner(q, r, int(speed))
    last = p / d
    r -= last
    return LocalStep(r, slope, value, np.abs(bend) * last * last)


def _horner(q: Array, r: Array, derivative: int) -> tuple[Array, Array]:
    """(value, slope by r) of y, or of its derivative by r, at r."""
    top = _NEAR * q[_NEAR] if derivative else q[_NEAR]
    p, d = top.copy(), top * float(_NEAR - derivative)
    for k in range(_NEAR - 1, derivative, -1):
        c = k * q[k] if derivative else q[k]
        p *= r
        p += c
        d *= r
        d += float(k - derivative) * c
    p *= r
    p += q[derivative]
    return p, d
