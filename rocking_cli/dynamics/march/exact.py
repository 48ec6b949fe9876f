"""One step of every lane along an exact flow: to the end of the monotone segment of the
drive, or less. In it the body turns once at most, which the velocities at both ends
decide (Lemma 2).
"""

from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ...motions.segments import Segments
from ..equations.linear_flow import LONGEST, LinearFlow
from ..equations.taylor import Instant
from ..lanes import Lanes
from .one_turn import StepResult

# a step of Halley's method this short, over every scale of the arc, leaves an error
# below rounding after the last one: of a turn, where y is stationary, and of an impact
_CLOSE_TURN, _CLOSE = 1e-3, 3e-6
_SOON = 0.3  # over the rate of the fastest change: up to there three terms tell a turn
_ROUNDS = 200  # more than bisection needs for any bracket
_HALVINGS = 60
_LAST_DIGIT = 1e-15  # of an exact flow, over the sizes of its terms


class ExactStep(NamedTuple):
    """A step with one turn at most. Every array is (lanes,)."""

    h: Array  # its length [tau]
    end: Instant  # the state at its end
    segment: Array  # the segment that begins where the step ends with a segment
    whole: Array  # True where it does
    outward: Array  # True where y' >= 0 at the start
    turns: Array  # True where y' changes its sign


def advance_exactly(
    segments: Segments, lanes: Lanes, until: Array | float, tops: bool
) -> StepResult:
    """As `advance`, along exact flows, whose y has no limit."""
    arc = LinearFlow.of(segments, lanes)
    step = exact_step(arc, segments, lanes, until)
    end = step.end
    hit = (end.y <= 0.0) & (step.turns | ~step.outward)
    reach, top_at, top = _turns(arc, step, hit, tops)
    impact_v, impact_force = _impacts(arc, step, np.flatnonzero(hit), top_at, reach)
    size = np.abs(end.y) + np.abs(end.v) + np.abs(arc.b) + np.abs(arc.v)
    return StepResult(
        arc,
        step.whole & ~hit,
        step.segment,
        end,
        reach,
        hit,
        impact_v,
        impact_force,
        top,
        top_at,
        _LAST_DIGIT * size,
    )


def _turns(
    arc: LinearFlow, step: ExactStep, hit: Array, tops: bool
) -> tuple[Array, Array, Array]:
    """(the time to the lowest point where that lies below the ground, else to the end;
    the time to the peak, 0 without one; y at the peak, -inf without one); sets `hit`
    for lowest points below the ground.
    """
    reach, top_at = step.h.copy(), np.zeros(hit.size)
    top = np.full(hit.size, -np.inf)
    at = np.flatnonzero(step.turns & (step.outward & tops | ~step.outward & ~hit))
    if at.size:
        own, h, out = arc.take(at), step.h[at], step.outward[at]
        guess = peak_guess(own, Instant(*(x[at] for x in step.end)), h)
        bracket = np.zeros(at.size), h
        when, y, _ = root(own, bracket, guess, np.where(out, 1.0, -1.0))
        top_at[at[out]], top[at[out]] = when[out], y[out]
        dips = ~out & ~(y > 0.0)
        hit[at[dips]], reach[at[dips]] = True, when[dips]
    return reach, top_at, top


def _impacts(
    arc: LinearFlow, step: ExactStep, at: Array, after: Array, reach: Array
) -> tuple[Array, Array]:
    """(velocity, force) of the impacts of the lanes `at`, which come after the times
    `after` and before `reach`; `reach` becomes the times of the impacts.
    """
    velocity, force = np.zeros(reach.size), np.zeros(reach.size)
    if at.size:
        own, bracket = arc.take(at), (after[at], reach[at])
        end = Instant(*(x[at] for x in step.end))
        guess = impact_guess(own, end, step.h[at], bracket)
        reach[at], _, v = root(own, bracket, guess, None)
        velocity[at] = np.minimum(0.0, v)
        force[at] = own.at_ground(reach[at])
    return velocity, force


def exact_step(
    arc: LinearFlow, segments: Segments, lanes: Lanes, until: Array | float
) -> ExactStep:
    """Return the step of each lane, at most `until` [tau] long."""
    k = lanes.segment
    left = segments.length[k] - lanes.phase
    fall = lanes.side * (segments.s_end[k] - segments.s_start[k])
    # While the drive rises a body that speeds up outwards goes on to do so: then the
    # step covers the fall of the drive too.
    on = segments.joins[k] & (fall < 0.0) & (lanes.v >= 0.0) & (arc.b >= 0.0)
    following = np.where(on, k + 1, k)
    left = np.where(on, left + segments.length[following], left) / lanes.omega
    falls = (fall > 0.0) | on
    h = np.minimum(np.minimum(left, until), LONGEST)
    end = arc.at(h)

    # With z = y' where the drive falls, and z = -y' where it rises, z'' <= z: z has the
    # signs - + - at most (Lemma 2).
    sense = np.where(falls, 1.0, -1.0)
    z, rate = sense * arc.v, sense * arc.b
    starts = on | (z > 0.0) | ((z == 0.0) & (rate > 0.0))
    hidden = np.flatnonzero(~(starts | (sense * end.v > 0.0)) & (rate > 0.0))
    if hidden.size:
        _end_before_hidden_turns(arc, hidden, sense, h, end)
    turns = starts != (sense * end.v > 0.0)
    outward = np.where(falls, starts, ~starts)
    return ExactStep(h, end, following + 1, h == left, outward, turns)


def _end_before_hidden_turns(
    arc: LinearFlow, open_: Array, sense: Array, h: Array, end: Instant
) -> None:
    """Halve the steps h of the lanes `open_`, which have z < 0 at both ends, until z is
    positive at the end or its tangents prove that it is nowhere positive.
    """
    for _ in range(_HALVINGS):
        own = sense[open_]
        first, slope = -arc.v[open_] / arc.b[open_], own * end.b[open_]
        with np.errstate(all="ignore"):
            last = np.where(slope < 0.0, h[open_] - own * end.v[open_] / slope, -np.inf)
        open_ = open_[last >= first]
        if not open_.size:
            break
        h[open_] *= 0.5
        part = arc.take(open_).at(h[open_])
        for whole, some in zip(end, part, strict=True):
            whole[open_] = some
        open_ = open_[~(sense[open_] * part.v > 0.0)]


def root(
    arc: LinearFlow, bracket: tuple[Array, Array], guess: Array, turning: Array | None
) -> tuple[Array, Array, Array]:
    """Return (h, y and y' after h) at the one root of y in a bracket (low, high] that
    falls through zero there, or of y' with `turning`, the sign of y' before it; NaN
    where it does not converge. Householder's steps, a bisection where one leaves the
    bracket.
    """
    found = np.full((3, guess.size), np.nan)
    lanes, h = np.arange(guess.size), guess
    low, high = bracket
    close = _CLOSE if turning is None else _CLOSE_TURN
    for _ in range(_ROUNDS):
        f = arc.at(h)
        step, after, falling = _householder(f, turning)
        low, high = np.where(after, low, h), np.where(after, h, high)
        target, size = h + step, np.abs(step)
        inside = falling & (target >= low) & (target <= high)
        settled = inside & (size <= close * h) & (size * arc.fastest <= close)
        scale, change = (f.v, f.b) if turning is None else (f.b, f.j)
        settled &= size * np.abs(change) <= close * np.abs(scale)
        settled |= falling & (size <= 4e-16 * h) | (high - low <= 4e-16 * high)
        done = np.flatnonzero(settled)
        if done.size:
            last = np.where(inside, step, 0.0)
            found[:, lanes[done]] = _after(f, h, last)[:, done]
            keep = np.flatnonzero(~settled)
            if not keep.size:
                break
            arc, lanes, h, target = arc.take(keep), lanes[keep], h[keep], target[keep]
            low, high, inside = low[keep], high[keep], inside[keep]
            turning = None if turning is None else turning[keep]
        h = np.where(inside, target, 0.5 * (low + high))
    return found[0], found[1], found[2]


def _after(f: Instant, h: Array, step: Array) -> Array:
    """(h, y and y') after a short step from the states f at h, by the series there."""
    return np.array(
        [
            h + step,
            f.y + step * (f.v + step * (0.5 * f.b + step * f.j / 6.0)),
            f.v + step * (f.b + 0.5 * step * f.j),
        ]
    )


def _householder(f: Instant, turning: Array | None) -> tuple[Array, Array, Array]:
    """(the step to the root, True where it is passed, True where the value falls)."""
    with np.errstate(all="ignore"):
        if turning is not None:
            step = -f.v / (f.b - 0.5 * f.v * f.j / f.b)
            return step, turning * f.v <= 0.0, turning * f.b < 0.0
        r, e = f.y / f.v, f.b / f.v
        step = -r * (1.0 - 0.5 * r * e) / (1.0 - r * e + r * r * f.j / (6.0 * f.v))
        return step, f.y <= 0.0, f.v < 0.0


def peak_guess(arc: LinearFlow, end: Instant, h: Array) -> Array:
    """Return a guess of the turn of arcs between their start and h: where the cubic of
    y' and y'' at both ends is 0, and where that is soon, by the state at the start.
    """
    jerk = arc.v + arc.sin * arc.w
    with np.errstate(all="ignore"):
        root = np.sqrt(arc.b * arc.b - 2.0 * arc.v * jerk)
        soon = -2.0 * arc.v / (arc.b + np.copysign(root, arc.b))
    a, b, c, d = arc.v, h * arc.b, end.v, h * end.b
    with np.errstate(all="ignore"):
        s = np.nan_to_num(a / (a - c), nan=1.0)  # no speed at either end
    low, high = np.zeros(h.size), np.ones(h.size)
    for _ in range(3):
        t = 1.0 - s
        value = (a * (1.0 + 2.0 * s) + b * s) * t * t
        value += (c * (1.0 + 2.0 * t) - d * t) * s * s
        slope = (
            6.0 * (c - a) * s * t + b * t * (1.0 - 3.0 * s) + d * s * (3.0 * s - 2.0)
        )
        same = value * a > 0.0
        low, high = np.where(same, s, low), np.where(same, high, s)
        with np.errstate(all="ignore"):
            s = s - value / slope
        s = np.where((s > low) & (s < high), s, 0.5 * (low + high))
    near = (soon > 0.0) & (soon < h) & (soon * arc.fastest < _SOON)
    return np.where(near, soon, np.clip(s, 1e-3, 1.0) * h)


def impact_guess(
    arc: LinearFlow, end: Instant, h: Array, bracket: tuple[Array, Array]
) -> Array:
    """Return a guess of the impact inside its bracket: from the start by y, y' and y''
    where y'' < 0 there, else a step from the end of the arcs, at h.
    """
    low, high = bracket
    with np.errstate(all="ignore"):
        left = (arc.v + np.sqrt(arc.v * arc.v - 2.0 * arc.b * arc.y)) / -arc.b
        right = h - end.y / (end.v - 0.5 * end.y * end.b / end.v)
        guess = np.where((arc.b < 0.0) & (left < high) & (left > low), left, right)
    return np.where((guess > low) & (guess < high), guess, 0.5 * (low + high))
