"""One step of every lane: the Taylor series of its motion from its present state, over
a time in which the body turns once at most.

A step ends where the series no longer holds, where the closed form of the drive ends,
or before the second turn. The Bernstein coefficients of y' count the turns: their
number of sign changes is the number of turns, or more by an even number (Lemma 1). So
the signs of y and y' at both ends tell what happens in a step:

    y' stays positive                    nothing
    y' stays negative                    an impact if y <= 0 at the end
    y' turns from positive to negative   a peak; an impact after it if y <= 0 at the end
    y' turns from negative to positive   a lowest point; an impact before it if y <= 0
                                         there
"""

from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...arrays import Array
from ...motions.segments import Segments
from ..equations.equation import Equation
from ..equations.taylor import MOST_TERMS, Instant, TaylorSeries, powers, product
from ..lanes import Lanes
from .roots import bernstein_form, fall_guess, only_root, turn_guess

if TYPE_CHECKING:
    from ..equations.linear_flow import LinearFlow

# a step with several sign changes is halved so often at the most; two turns closer than
# 1e-9 of a step change y by less than rounding
_HALVINGS = 30


class StepResult(NamedTuple):
    """A step of lanes and its outcome. Every array is (lanes,)."""

    arc: "TaylorSeries | LinearFlow"  # the motion from its start
    whole: Array  # True where the step ends with the closed form, or with a segment
    segment: Array  # the segment that begins there
    end: Instant  # the state at the end of the step
    reach: Array  # time from the start to the impact, or to the end of the step [tau]
    hit: Array  # True where the lane hit the ground
    impact_v: Array  # velocity y' just before the impact
    impact_force: Array  # force y'' + 2 zeta y' at the impact
    top: Array  # y at the peak of the step, -inf without one, or if it is not wanted
    top_at: Array  # time from the start to that peak [tau]
    error: Array  # bound of the error of y' that the step adds
    # bounds of |y'| and |y''| during the step of a Taylor series; none of an exact flow
    fastest: Array = np.zeros(0)
    acceleration: Array = np.zeros(0)


class Turns(NamedTuple):
    """Steps with one turn at most. Every array is (lanes,)."""

    share: Array  # length of the step over that which was asked for
    outward: Array  # True where y' >= 0 at the start
    turns: Array  # True where y' changes its sign
    guess: Array  # where it does, over the step; 1 without a turn
    fastest: Array  # bound of |y'| times the length of the step
    largest_acceleration: Array  # bound of |y''| times the square of that length


def one_turn_step(arc: TaylorSeries, longest: Array) -> tuple[Array, Array, Turns]:
    """Return (the length h of the step of each lane [tau], at most `longest`; the terms
    of y in powers of the time over h; its turns).
    """
    h = np.minimum(arc.longest, longest)
    terms = arc.over(h)
    turns = one_turn(terms)
    shorter = np.flatnonzero(turns.share < 1.0)
    if shorter.size:
        h[shorter] *= turns.share[shorter]
        terms[:, shorter] *= powers(turns.share[shorter], len(terms))
    return h, terms, turns


def advance(
    segments: Segments,
    lanes: Lanes,
    equation: Equation,
    until: Array | float = np.inf,
    tops: bool = True,
) -> StepResult:
    """Move each lane by one step, or to the impact in it, if there is one. until: the
    longest step [tau] that other events allow; tops: False if no peak is wanted but
    those that may reach the limit of y.
    """
    arc = equation.flow(segments, lanes)
    left = segments.left_of_piece(lanes.segment, lanes.phase) / lanes.omega
    h, terms, one = one_turn_step(arc, np.minimum(left, until))
    end = arc.point(terms, h)

    hit = (end.y <= 0.0) & (one.turns | ~one.outward)
    s, top, top_at = np.ones(h.size), np.full(h.size, -np.inf), np.zeros(h.size)
    _lowest_points(terms, one, hit, s)
    wanted = tops | (np.maximum(end.y, lanes.y) + one.fastest >= equation.limit)
    peaks = np.flatnonzero(one.turns & one.outward & wanted)
    if peaks.size:
        own = terms.take(peaks, axis=1)
        top_at[peaks], top[peaks] = only_root(own, one.guess[peaks], speed=True)[:2]
    impact_v, impact_force = _impacts(arc, terms, h, np.flatnonzero(hit), s)
    return StepResult(
        arc,
        (h == left) & ~hit,
        segments.after_piece(lanes.segment),
        end,
        s * h,
        hit,
        impact_v,
        impact_force,
        top,
        top_at * h,
        error_of(arc, terms, h),
        one.fastest / h,
        one.largest_acceleration / (h * h),
    )


def _lowest_points(terms: Array, one: Turns, hit: Array, s: Array) -> None:
    """Where a body turns outwards below the ground or on it: set `hit`, and `s` to the
    instant of the lowest point, over the step.
    """
    dips = np.flatnonzero(one.turns & ~one.outward & ~hit)
    if dips.size:
        when, height = only_root(
            -terms.take(dips, axis=1), one.guess[dips], speed=True
        )[:2]
        touched = ~(height < 0.0)  # heights are those of -y
        hit[dips[touched]] = True
        s[dips[touched]] = when[touched]


def _impacts(
    arc: TaylorSeries, terms: Array, h: Array, at: Array, s: Array
) -> tuple[Array, Array]:
    """(velocity, force) of the impacts of the lanes `at`, which come before the shares
    `s` of their steps; `s` becomes the shares at the impacts.
    """
    velocity, force = np.zeros(h.size), np.zeros(h.size)
    if at.size:
        own = terms.take(at, axis=1)
        before = s[at]
        if (before < 1.0).any():
            own *= powers(before, len(own))
        when, _, speed, rate = only_root(own, *fall_guess(own), speed=False)
        over = 1.0 / (before * h[at])
        s[at] *= when
        velocity[at] = np.minimum(0.0, speed * over)
        force[at] = rate * over * over
        force[at] += 2.0 * np.broadcast_to(arc.damping, h.shape)[at] * velocity[at]
    return velocity, force


def error_of(arc: TaylorSeries, terms: Array, h: Array) -> Array:
    """Return a bound of the error of y' after steps of the length h: the last two terms
    of y', where the series does not tell it.
    """
    if arc.error is not None:
        return arc.error
    n = len(terms) - 1
    found: Array = n * np.abs(terms[n]) + (n - 1.0) * np.abs(terms[n - 1])
    return found / h


@lru_cache(maxsize=64)
def _degrees(count: int) -> Array:
    return np.arange(float(count))[:, None]


def one_turn(terms: Array) -> Turns:
    """The longest part of steps, of which `terms` are the series of y, that is proved
    to have one turn at most: for most of them by the chords of y' and of y''.
    """
    count, sizes = len(terms), np.abs(terms)
    derivatives, chord_errors = _chord_tables(count)
    start, bend = terms[1], 2.0 * terms[2]
    end, end_bend = product(derivatives, terms)
    # y' and y'' leave the chords between their ends by no more than this.
    speed, rate = product(chord_errors, sizes)
    bends = np.minimum(np.abs(bend), np.abs(end_bend)) > rate
    monotone = bends & ((bend > 0.0) == (end_bend > 0.0))
    at_once = np.where(bend == 0.0, terms[3], bend)
    outward = np.where(start == 0.0, at_once, start) >= 0.0
    outward_end = end >= 0.0
    kept = np.minimum(np.abs(start), np.abs(end)) > speed
    kept &= outward == outward_end
    turns = outward != outward_end
    with np.errstate(all="ignore"):
        guess = np.where(turns, np.clip(start / (start - end), 1e-3, 1.0), 1.0)
    one = Turns(
        np.ones(start.size),
        outward,
        turns,
        guess,
        np.maximum(np.abs(start), np.abs(end)) + speed,
        np.maximum(np.abs(bend), np.abs(end_bend)) + rate,
    )
    doubtful = np.flatnonzero(~(kept | monotone))
    if doubtful.size:
        # As many terms as the longest series has: no digit may depend on the others.
        own = terms.take(doubtful, axis=1)
        if count <= MOST_TERMS:
            more = np.zeros((MOST_TERMS + 1 - count, doubtful.size))
            own = np.concatenate([own, more])
        for whole, part in zip(one, turns_by_signs(own), strict=True):
            whole[doubtful] = part
    return one


def turns_by_signs(terms: Array) -> Turns:
    """As `one_turn`, by the signs of the Bernstein coefficients of y' (Lemma 1)."""
    speeds = bernstein_form(terms[1:] * _degrees(len(terms))[1:])
    positive = _signs(speeds)
    changes = _sign_changes(positive)
    share = np.ones(changes.size)
    several = np.flatnonzero(changes > 1)
    for _ in range(_HALVINGS if several.size else 0):
        share[several] *= 0.5
        part = terms.take(several, axis=1) * powers(share[several], len(terms))
        part = bernstein_form(part[1:] * _degrees(len(terms))[1:])
        speeds[:, several], positive[:, several] = part, _signs(part)
        changes[several] = more = _sign_changes(positive.take(several, axis=1))
        several = several[more > 1]
        if not several.size:
            break
    turns = changes % 2 == 1
    guess, at = np.ones(changes.size), np.flatnonzero(turns)
    if at.size:
        guess[at] = turn_guess(speeds.take(at, axis=1), positive.take(at, axis=1))
    rates = np.abs(np.diff(speeds, axis=0)).max(axis=0) * (len(speeds) - 1.0)
    return Turns(share, positive[0], turns, guess, np.abs(speeds).max(axis=0), rates)


def _signs(speeds: Array) -> Array:
    """True where Bernstein coefficients are not negative. A body that does not move at
    the start has the sign of its motion after it.
    """
    positive = speeds >= 0.0
    still = np.flatnonzero(speeds[0] == 0.0)
    positive[0, still] = positive[1, still]
    return positive


def _sign_changes(positive: Array) -> Array:
    changes: Array = np.add.reduce(
        (positive[1:] != positive[:-1]).view(np.int8), axis=0, dtype=np.int8
    )
    return changes


@lru_cache(maxsize=64)
def _chord_tables(count: int) -> tuple[Array, Array]:
    """(rows: y' and y'' at the end of a step, from its terms; rows: n times the maximum
    of t - t^(n - 1) on [0, 1], and n (n - 1) times that of t - t^(n - 2), 0 below n =
    3).
    """
    n = np.arange(float(count))
    factors = np.array([n, n * (n - 1.0)])
    m = np.maximum(np.array([n - 1.0, n - 2.0]), 1.0 + 1e-9)
    errors = factors * m ** (-1.0 / (m - 1.0)) * (1.0 - 1.0 / m)
    errors[:, :3] = 0.0
    return factors, errors
