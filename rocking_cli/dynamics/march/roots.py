"""Roots on an arc: impact times and peaks inside brackets that hold exactly one root,
as `advance` proves, and brackets for the turning points of a series. Each lane iterates
by itself, so that its digits do not depend on its neighbours. Bernstein coefficients of
y' isolate its roots in (0, 1): their number equals the number of sign changes of the
coefficients, or is less by an even number.
"""

from functools import lru_cache
from math import comb

import numpy as np

from ...motions.blocks import blocks
from ..equations.equation import Flow, Point
from ..equations.taylor import CACHED, TaylorSeries, powers
from ..lanes import Array

# two turns closer than 1e-12 of a step are ignored: y differs between them by less than
# rounding
_HALVINGS = 40
# a Halley step this short, over every scale of the arc: the Taylor series of y then
# errs by its fourth power over 24
_NEAR = 1e-3
# a Householder step this short, over every scale of the arc, leaves an error of v of
# the third power of the step
_CLOSE = 3e-6
# bisection alone would end in 64 for any bracket that a double can hold between 1e-3
# and 1e3
_ROUNDS = 200


def impact_root(
    arc: Flow, low: Array, high: Array, guess: Array
) -> tuple[Array, Array]:
    """First h with y(h) = 0 and the velocity there (not positive); NaN where it does
    not converge. `low` is before the root (y > 0, or the arc's own start), `high` is at
    it or after it (y <= 0), and y falls through the root. Fourth-order Householder
    steps, a bisection where one leaves the bracket or starts on the rising side.
    """
    h_out, v_out = np.empty_like(low), np.empty_like(low)
    lanes = np.arange(low.size)
    low, high, h = low.copy(), high.copy(), guess.copy()
    for _ in range(_ROUNDS if lanes.size else 0):
        f = arc.at(h)
        step = _householder_step(f)
        target = h + step
        after = f.y <= 0.0
        # The step stays in the bracket, on the side of h where the root is.
        inside = (f.v < 0.0) & (target > low) & (target <= high)
        inside &= (target <= h) == after
        exact = np.abs(step) <= 4e-16 * h
        settled = inside & _is_close(f, h, step, arc.fastest)
        settled |= exact & (f.v < 0.0)

        # Few lanes go on: only their brackets are narrowed.
        keep = np.flatnonzero(~settled)
        low, high = _narrowed(low[keep], high[keep], h[keep], after[keep])
        closed = high - low <= 4e-16 * high
        if closed.any():
            settled[keep[closed]] = True
            keep, low, high = keep[~closed], low[~closed], high[~closed]

        # Lanes that are done take their last step, and the velocity after it by the
        # series about h.
        if keep.size < settled.size:
            done = np.flatnonzero(settled)
            d = np.where(inside[done] | exact[done], step[done], 0.0)
            h_out[lanes[done]] = h[done] + d
            v_out[lanes[done]] = np.minimum(
                0.0, f.v[done] + d * (f.b[done] + 0.5 * d * f.j[done])
            )
            if not keep.size:
                break
            arc, lanes = arc.take(keep), lanes[keep]
        h = np.where(inside[keep], target[keep], 0.5 * (low + high))
    else:
        h_out[lanes] = np.nan
    return h_out, v_out


def _householder_step(f: Point) -> Array:
    """The step of fourth order to the root of y, from y and its derivatives."""
    with np.errstate(all="ignore"):
        r, e = f.y / f.v, f.b / f.v
        return -r * (1.0 - 0.5 * r * e) / (1.0 - r * e + r * r * f.j / (6.0 * f.v))


def _is_close(f: Point, h: Array, step: Array, fastest: Array) -> Array:
    """True where a step is short over every scale of the arc: over the time, over the
    time of its fastest change, and over that in which its velocity changes.
    """
    size = np.abs(step)
    return (
        (size <= _CLOSE * h)
        & (size * fastest <= _CLOSE)
        & (size * np.abs(f.b) <= _CLOSE * np.abs(f.v))
    )


def _narrowed(low: Array, high: Array, h: Array, after: Array) -> tuple[Array, Array]:
    """The brackets (low, high) cut at h; after: True where h is at the root or after
    it.
    """
    return np.where(after, low, h), np.where(after, h, high)


def turning_point(
    arc: Flow, low: Array, high: Array, guess: Array, sense: float
) -> tuple[Array, Array]:
    """The h between `low` and `high` where sense * v falls through zero, and y there.
    sense = +1 finds a peak (v goes from + to -), sense = -1 a minimum. Halley steps
    with bisection as the safeguard; y at the turning point is taken to second order in
    what is left, so a step of 1e-5 leaves 1e-16.
    """
    h_out, y_out = np.empty_like(low), np.empty_like(low)
    lanes = np.arange(low.size)
    low, high, h = low.copy(), high.copy(), guess.copy()
    for _ in range(_ROUNDS if lanes.size else 0):
        f = arc.at(h)
        # Halley's step to the root of v, whose derivatives are b and j.
        with np.errstate(all="ignore"):
            step = -f.v / (f.b - 0.5 * f.v * f.j / f.b)
        low, high = _narrowed(low, high, h, sense * f.v <= 0.0)
        target = h + step
        inside = (sense * f.b < 0.0) & (target >= low) & (target <= high)
        # A lane is done if its step is short over every scale of the arc, or if the
        # bracket is as narrow as rounding allows.
        settled = (
            inside
            & (np.abs(step) * arc.fastest <= _NEAR)
            & (np.abs(step * f.j) <= 1e-2 * np.abs(f.b))
        )
        settled &= np.abs(step) <= 3e-3 * h
        settled |= high - low <= 4e-16 * high
        if settled.any():
            done = np.flatnonzero(settled)
            # The last step is taken, and y follows by its Taylor series about h.
            d = np.where(inside[done], step[done], 0.0)
            h_out[lanes[done]] = h[done] + d
            y_out[lanes[done]] = f.y[done] + d * (
                f.v[done] + d * (0.5 * f.b[done] + d * f.j[done] / 6.0)
            )
            keep = np.flatnonzero(~settled)
            if not keep.size:
                break
            arc, lanes = arc.take(keep), lanes[keep]
            low = low[keep]
            high = high[keep]
            target = target[keep]
            inside = inside[keep]
        h = np.where(inside, target, 0.5 * (low + high))
    else:
        y_out[lanes] = np.nan
    return h_out, y_out


def hidden_turn(arc: Flow, low: Array, high: Array, sense: float) -> Array:
    """A point with sense * v < 0 between two ends with sense * v >= 0, NaN if there is
    none (Lemma 4). sense = +1 looks for a dip of v while the drive rises: v'' = v + a'
    > 0 while v > 0, so v is convex there and the sign of its slope b tells on which
    side its minimum lies. sense = -1 looks for the mirror image, a rise of v while the
    drive falls.
    """
    found = np.full(low.shape, np.nan)
    lanes = np.arange(low.size)
    low, high = low.copy(), high.copy()
    for _ in range(60):
        if not lanes.size:
            break
        h = 0.5 * (low + high)
        f = arc.at(h)
        v = sense * f.v
        b = sense * (f.b + arc.damping * f.v) if arc.damping else sense * f.b
        # One point with v < 0 between the ends proves a pair of turns.
        turns = v < 0.0
        found[lanes[turns]] = h[turns]
        # Convexity bounds v from below by its tangents: stop where they prove that v
        # keeps its sign.
        keep = np.flatnonzero(~turns & (v - np.abs(b) * (high - low) <= 0.0))
        low, high = np.where(b < 0.0, h, low)[keep], np.where(b < 0.0, high, h)[keep]
        arc, lanes = arc.take(keep), lanes[keep]
    return found


def sense(arc: Flow, h: Array, end: Point, chord_errors: Array) -> tuple[Array, Array]:
    """(True if y' is proved to have no zero, True if y' is proved to be monotone) along
    steps of length h, from the values at both ends and the chord errors `chord_errors`
    (`TaylorSeries.at_with_chord_errors`).
    """
    # y' and y'' lie within their chord errors of the chords between the ends.
    speed, rate = (
        np.array([at_start * part, at_end * part])
        for at_start, at_end, part in ((arc.v, end.v, h), (arc.b, end.b, h * h))
    )
    kept, monotone = (
        (x.min(axis=0) > most) | (x.max(axis=0) < -most)
        for x, most in zip((speed, rate), chord_errors, strict=True)
    )
    return kept, monotone


def falls_through_zero(
    arc: TaylorSeries, reach: Array, lanes: Array, once: Array
) -> tuple[Array, Array, Array]:
    """The instants on (0, reach) at which y' falls through zero: (lane, low, high) with
    one instant in each bracket [tau]. once: lanes for which it is already known that
    there is exactly one.
    """
    found: list[tuple[Array, Array, Array]] = [
        (once, np.zeros(once.size), np.ones(once.size))
    ]
    own, low, high = lanes, np.zeros(lanes.size), np.ones(lanes.size)
    bernstein = bernstein_form(_speeds(arc, reach, lanes))
    for _ in range(_HALVINGS):
        # One sign change, from + to -: the interval holds one peak and no other turn.
        changes, falls = _sign_changes(bernstein)
        one = np.flatnonzero((changes == 1) & falls)
        found.append((own[one], low[one], high[one]))

        # Several: both halves are looked at.
        more = np.flatnonzero(changes > 1)
        if not more.size:
            break
        middle = 0.5 * (low[more] + high[more])
        bernstein = np.concatenate(_halves(bernstein[:, more]), axis=1)
        own = np.concatenate([own[more], own[more]])
        low = np.concatenate([low[more], middle])
        high = np.concatenate([middle, high[more]])
    which, low, high = (np.concatenate(parts) for parts in zip(*found, strict=True))
    order = np.lexsort((low, which))
    which, low, high = which[order], low[order], high[order]
    return which, low * reach[which], high * reach[which]


def _sign_changes(bernstein: Array) -> tuple[Array, Array]:
    """(number of sign changes of the coefficients of each lane, True where they fall
    through zero somewhere).
    """
    falls = (bernstein[:-1] > 0.0) & (bernstein[1:] <= 0.0)
    rises = (bernstein[:-1] <= 0.0) & (bernstein[1:] > 0.0)
    return falls.sum(axis=0) + rises.sum(axis=0), np.asarray(falls.any(axis=0))


def _speeds(arc: TaylorSeries, reach: Array, lanes: Array) -> Array:
    """`_speed` of these lanes over their reach, block by block."""
    parts = [
        _speed(arc.take(lanes[part]), reach[lanes[part]])
        for part in blocks(lanes.size, CACHED)
    ]
    return np.concatenate([np.zeros((len(arc.terms) - 1, 0)), *parts], axis=1)


def _speed(arc: TaylorSeries, span: Array) -> Array:
    """Coefficients of span y' in powers of time over span, (terms, lanes)."""
    terms = powers(span / arc.unit, len(arc.terms))
    terms *= arc.terms
    terms *= np.arange(float(len(terms)))[:, None]
    return np.asarray(terms[1:])


@lru_cache(maxsize=64)
def _from_powers(count: int) -> Array:
    """(count, count) matrix: converts coefficients of powers to Bernstein coefficients
    on [0, 1].
    """
    return np.array(
        [[comb(i, n) / comb(count - 1, n) for n in range(count)] for i in range(count)]
    )


def bernstein_form(terms: Array) -> Array:
    """Bernstein coefficients on [0, 1] of polynomials, (terms, lanes). The order of
    each sum does not depend on the other lanes.
    """
    if terms.shape[1] == 1:  # NumPy sums a single lane in another order
        return bernstein_form(np.repeat(terms, 2, axis=1))[:, :1]
    parts = [
        np.einsum("in,nl->il", _from_powers(len(terms)), terms[:, block])
        for block in blocks(terms.shape[1], CACHED)
    ]
    return np.concatenate([terms[:, :0], *parts], axis=1)


def _halves(bernstein: Array) -> tuple[Array, Array]:
    """Bernstein coefficients on the left half and on the right half (de Casteljau)."""
    left, right, row = np.empty_like(bernstein), np.empty_like(bernstein), bernstein
    for i in range(len(bernstein)):
        left[i], right[-1 - i] = row[0], row[-1]
        row = 0.5 * (row[:-1] + row[1:])
    return left, right
