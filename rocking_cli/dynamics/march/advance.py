"""One round of the engine: each lane goes from its present state to the end of a window
of the outward drive a, or to an impact.

The sign of a - 1 in a window proves whether y has a root in it (Lemmas 1 and 2). A
window with a < 1 ends at any inner maximum of a, so that a falls and then rises once
along it (Lemma 3). Boundaries are the crossings of a = 1 and the ends of pieces.
"""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ...motions.segments import Segments
from ..drive import crossing, phase_between, place
from ..equations.equation import Equation, Flow, Point
from ..equations.taylor import TaylorSeries
from ..lanes import Array, Lanes
from .roots import falls_through_zero, hidden_turn, impact_root, sense, turning_point

if TYPE_CHECKING:
    from ..weighed_drive import WeighedSegments

# a bound counts if it holds with this much room, which is more than rounding needs
_SAFE_SHARE = 1.0 - 1e-9


class Windows(NamedTuple):
    """The end of the present window of each lane. A window is an interval in which the
    drive stays subcritical, or stays supercritical. Every array is (lanes,).
    """

    segment: Array  # segment of the end
    phase: Array  # phase of the end in its segment [rad]
    supercritical: Array  # True if the drive is supercritical
    # phase of the whole segments between the present one and `segment` [rad]
    over: Array

    def phase_from(self, u: Array) -> Array:
        """The phase from u in the present segment to the end of the window."""
        return self.phase - u + self.over


def window_end(
    segments: Segments, k: Array, u: Array, side: Array, amplitude: Array
) -> Windows:
    """The end of the window that holds the position (k, u); a boundary belongs to the
    window that begins there. Where the weight varies, the windows are those of the net
    drive on the body's side.
    """
    if (weighed := segments.weighed) is not None:
        return _weighed_window_end(weighed, k, u, side, amplitude)
    # a at both ends of the segment, over the amplitude; above the level a > 1.
    level, length = 1.0 / amplitude, segments.length[k]
    from_a, to_a = -side * segments.s_start[k], -side * segments.s_end[k]
    start, end = from_a > level, to_a > level
    crosses = start != end

    # The window ends at the crossing of a = 1, if the lane is before it.
    cut = length.copy()
    at = np.flatnonzero(crosses)
    cut[at] = crossing(segments, k[at], -side[at] * level[at])
    before = u < cut
    supercritical = np.where(before, start, end)
    before &= crosses
    window = Windows(
        k, np.where(before, cut, length), supercritical, np.zeros(length.shape)
    )

    # Past the crossing (or without one) it runs to the segment's end. It continues into
    # the next segment if that segment has the same closed form and brings the drive
    # back towards a = 1.
    on = np.flatnonzero(
        ~before & segments.joins[k] & (supercritical != (to_a < from_a))
    )
    return _into_next(segments, window, on, side, level) if on.size else window


def _weighed_window_end(
    weighed: "WeighedSegments", k: Array, u: Array, side: Array, amplitude: Array
) -> Windows:
    """As `window_end`, of the net drive."""
    offset = weighed.offset(side)
    there = _beyond_cuts(
        weighed.edges,
        window_end(weighed.edges, k + offset, u, side, amplitude),
        side,
        amplitude,
    )
    return there._replace(segment=there.segment - offset)


def _into_next(
    segments: Segments, window: Windows, on: Array, side: Array, level: Array
) -> Windows:
    """The same windows, of which those of the lanes `on` go on into the next segment,
    up to the crossing of a = 1 or its end.
    """
    segment, phase, over = window.segment.copy(), window.phase, window.over
    over[on] = segments.length[segment[on]]
    segment[on] = following = segment[on] + 1
    cut = segments.length[following]
    ends = -side[on] * segments.s_end[following] > level[on]
    crosses = np.flatnonzero(window.supercritical[on] != ends)
    at = on[crosses]
    cut[crosses] = crossing(segments, following[crosses], -side[at] * level[at])
    phase[on] = cut
    return Windows(segment, phase, window.supercritical, over)


def _beyond_cuts(
    segments: Segments, window: Windows, side: Array, amplitude: Array
) -> Windows:
    """The same windows, extended past segment ends at which only the drive of the other
    edge turns, but not past inner maxima.
    """
    k, u, supercritical, over = window
    lanes = np.arange(k.size)
    while True:
        # Windows that reach the end of a segment after which the closed form goes on.
        ends = lanes[(u[lanes] >= segments.length[k[lanes]]) & segments.joins[k[lanes]]]
        rises, falls = (
            sense * side[ends] * (segments.s_end[at] - segments.s_start[at]) < 0.0
            for sense, at in ((1.0, k[ends]), (-1.0, k[ends] + 1))
        )
        # A subcritical window stops at a maximum of the drive: Lemma 3 needs a drive
        # that falls first and rises then.
        ends = ends[supercritical[ends] | ~(rises & falls)]
        if not ends.size:
            return Windows(k, u, supercritical, over)
        following = window_end(
            segments, k[ends] + 1, np.zeros(ends.size), side[ends], amplitude[ends]
        )
        # The window goes on where the drive is on the same side of 1 there.
        same = following.supercritical == supercritical[ends]
        lanes = ends[same]
        k, u, over = k.copy(), u.copy(), over.copy()
        over[lanes] += segments.length[k[lanes]] + following.over[same]
        k[lanes], u[lanes] = following.segment[same], following.phase[same]


class LaneStep(NamedTuple):
    """The time that each lane covers with one proof: one window of the drive, or a
    supercritical window that the lane leaves outwards together with the subcritical
    window after it. Every array is (lanes,).
    """

    segment: Array  # segment in which the step ends
    phase: Array  # phase of the end in its segment [rad]
    h: Array  # length of the step [tau]
    supercritical: Array  # True if the drive is supercritical throughout
    # time in the step at which its subcritical window begins [tau], 0 if the step has
    # no other window
    subcritical: Array


class StepResult(NamedTuple):
    """A step and its outcome. Every array is (lanes,)."""

    step: LaneStep  # the step
    arc: Flow  # the motion from its start
    end: Point  # the state at its end
    reach: Array  # time from the start to the impact, or to the end of the step [tau]
    hit: Array  # True where the lane hit the ground
    impact_v: Array  # velocity y' just before the impact
    impact_force: Array  # force y'' + 2 zeta y' at the impact
    # chord errors of `TaylorSeries.at_with_chord_errors`, where the weight varies
    chord_errors: Array | None = None

    @property
    def force(self) -> Array:
        """The force f at the end of the step."""
        return (
            self.end.b + 2.0 * self.arc.damping * self.end.v
            if self.arc.damping
            else self.end.b
        )


def next_step(segments: Segments, lanes: Lanes, longest: Array) -> LaneStep:
    """The longest step of each lane that one sign test covers and that the flow can
    make (`longest` [tau]).
    """
    window = window_end(
        segments, lanes.segment, lanes.phase, lanes.side, lanes.amplitude
    )
    k, u = window.segment.copy(), window.phase.copy()
    h = window.phase_from(lanes.phase) / lanes.omega
    supercritical, subcritical = window.supercritical.copy(), np.zeros(h.size)
    # A supercritical window entered outwards holds no event: go on to the end of the
    # subcritical window after it.
    on = np.flatnonzero(
        window.supercritical
        & (lanes.v >= 0.0)
        & (u < segments.length[k])
        & (h < longest)
    )
    if on.size:
        beyond = window_end(segments, k[on], u[on], lanes.side[on], lanes.amplitude[on])
        subcritical[on] = h[on]
        h[on] += beyond.phase_from(u[on]) / lanes.omega[on]
        k[on], u[on], supercritical[on] = beyond.segment, beyond.phase, False
    # A step that would be too long ends inside its window.
    long = np.flatnonzero(h > longest)
    if long.size:
        h[long] = longest[long]
        k[long], u[long] = place(
            segments,
            lanes.segment[long],
            lanes.phase[long] + longest[long] * lanes.omega[long],
        )
    return LaneStep(k, u, h, supercritical, subcritical)


def advance(
    segments: Segments, lanes: Lanes, equation: Equation, until: Array | float = np.inf
) -> StepResult:
    """Move each lane by one step, or to the impact in it, if there is one. until: the
    longest step [tau] that other events allow.
    """
    arc = equation.flow(segments, lanes)
    step = next_step(segments, lanes, np.minimum(arc.longest, until))
    if segments.weighed is not None and isinstance(arc, TaylorSeries):
        end, chord_errors = arc.at_with_chord_errors(step.h)
    else:
        end, chord_errors = arc.at(step.h), None
    # Lemmas 1 and 2: y <= 0 at the end of the step proves exactly one impact.
    reach = step.h.copy()
    hit = end.y <= 0.0
    # Lemma 2, a supercritical window entered inwards: y may touch the ground at its
    # only minimum although both ends are above the ground.
    dips = np.flatnonzero(step.supercritical & ~hit & (lanes.v < 0.0) & (end.v > 0.0))
    if dips.size:
        h = step.h[dips]
        h_min, y_min = turning_point(
            arc.take(dips), np.zeros(dips.size), h, 0.5 * h, -1.0
        )
        touched = ~(y_min > 0.0)
        hit[dips[touched]] = True
        reach[dips[touched]] = h_min[touched]
    # The impact lies between the start of the subcritical part of the step and the end,
    # or the minimum.
    impact_v, impact_force = np.zeros_like(reach), np.zeros_like(reach)
    at = np.flatnonzero(hit)
    if at.size:
        guess = _impact_guess(arc, step, end, reach, at)
        falling = arc.take(at)
        reach[at], impact_v[at] = impact_root(
            falling, step.subcritical[at], reach[at], guess
        )
        impact_force[at] = falling.at_ground(reach[at])
    return StepResult(step, arc, end, reach, hit, impact_v, impact_force, chord_errors)


def _impact_guess(
    arc: Flow, step: LaneStep, end: Point, reach: Array, at: Array
) -> Array:
    """A first guess of the impact time inside the bracket: from the start by y, y', y''
    where b < 0 there, else a step from the end.
    """
    low, high = step.subcritical[at], reach[at]
    y, v, b = arc.y[at], arc.v[at], arc.b[at]
    with np.errstate(all="ignore"):
        left = (v + np.sqrt(v * v - 2.0 * b * y)) / -b
        slope, second = end.v[at], end.b[at]
        right = step.h[at] - end.y[at] / (slope - 0.5 * end.y[at] * second / slope)
        guess = np.where((b < 0.0) & (left < high) & (left > low), left, right)
    return np.where((guess > low) & (guess < high), guess, 0.5 * (low + high))


def turning_points(
    segments: Segments, lanes: Lanes, result: StepResult, wanted: Array
) -> tuple[Array, Array, Array]:
    """(lanes, times [tau] since the start of their step, heights y) of the turning
    points in this step. A lane has at most one, and only where a is below 1 (Lemmas 3
    and 4). A body whose weight varies has as many as its series, in the order of lanes
    and times.
    """
    wanted = wanted & ~result.step.supercritical
    if segments.weighed is not None:
        return _turns_of_series(lanes, result, wanted)
    low, high = result.step.subcritical.copy(), result.reach.copy()

    # The body moves outwards where the subcritical window begins ...
    outwards = wanted & ((result.step.subcritical > 0.0) | (lanes.v > 0.0))
    # ... or turns outwards inside it, while the drive still falls (Lemma 4).
    at, turned = _turns_outwards(segments, lanes, result, wanted & ~outwards)
    outwards[at], low[at] = True, turned

    # Lemma 3: exactly one peak if it moves inwards at the end, or hits the ground.
    certain = outwards & (result.hit | (result.end.v <= 0.0))
    # Lemma 4: y' > 0 at both ends, and a peak and a trough between them.
    at, falls = _falls_again(segments, lanes, result, outwards & ~certain)
    certain[at], high[at] = True, falls

    at = np.flatnonzero(certain)
    low, high = low[at], high[at]
    if not at.size:
        return at, low, low
    return at, *turning_point(result.arc.take(at), low, high, 0.5 * (low + high), 1.0)


def _turns_of_series(
    lanes: Lanes, result: StepResult, wanted: Array
) -> tuple[Array, Array, Array]:
    """As `turning_points`, of bodies whose weight varies: all turns of their series."""
    arc = result.arc
    assert isinstance(arc, TaylorSeries)
    assert result.chord_errors is not None
    v = np.where(result.hit, result.impact_v, result.end.v)

    # No turn where y' keeps its sign, one at most where it is monotone; otherwise the
    # Bernstein coefficients of y' isolate the turns.
    kept, monotone = sense(arc, result.step.h, result.end, result.chord_errors)
    open_ = wanted & ~kept
    once = open_ & monotone & (lanes.v > 0.0) & (v <= 0.0)
    several = np.flatnonzero(open_ & ~monotone)
    at, low, high = falls_through_zero(arc, result.reach, several, np.flatnonzero(once))
    if not at.size:
        return at, low, high

    # The first guess is the root of the chord of y' if this is the only turn.
    chord = high * (lanes.v[at] / (lanes.v[at] - np.minimum(v[at], 0.0)))
    guess = np.where(high - low == result.reach[at], chord, 0.5 * (low + high))
    return at, *turning_point(arc.take(at), low, high, guess, 1.0)


def _turns_outwards(
    segments: Segments, lanes: Lanes, result: StepResult, inwards: Array
) -> tuple[Array, Array]:
    """(those of the lanes that enter `inwards` and turn outwards while the drive still
    falls, a time at which they move outwards). There y' is concave, so it is not above
    its tangent.
    """
    slope = _slope(lanes.force, lanes.v, -result.arc.damping)  # lanes carry the force
    at = np.flatnonzero(inwards & (slope > 0.0))
    if not at.size:
        return at, np.zeros(0)
    # The tangent at the start proves for most lanes that y' stays negative until the
    # drive rises again.
    bottom = np.minimum(_bottom(segments, lanes, result, at), result.reach[at])
    above = lanes.v[at] + slope[at] * bottom > 0.0
    at, bottom = at[above], bottom[above]
    turned = hidden_turn(result.arc.take(at), np.zeros(at.size), bottom, -1.0)
    found = np.isfinite(turned)
    return at[found], turned[found]


def _falls_again(
    segments: Segments, lanes: Lanes, result: StepResult, outwards: Array
) -> tuple[Array, Array]:
    """(those of the lanes with y' > 0 at both ends that fall in between, a time at
    which they do).

    A peak and a trough may hide where the drive rises again, and then b > 0 at the end.
    There y' is convex: its tangent at the end may prove at once that it never falls
    below zero.
    """
    step, end = result.step, result.end
    slope = _slope(end.b, end.v, result.arc.damping)
    tangent = slope * (step.h - step.subcritical)
    at = np.flatnonzero(outwards & (slope > 0.0) & (tangent > _SAFE_SHARE * end.v))
    if not at.size:
        return at, np.zeros(0)
    falls = _falling_again(segments, lanes, result, at)
    found = np.isfinite(falls)
    return at[found], falls[found]


def _slope(b: Array, v: Array, damping: float) -> Array:
    """Derivative of exp(zeta tau) y' over exp(zeta tau): y'' + zeta y' = f - zeta y'.
    Where b is f, damping is -zeta.
    """
    return b + damping * v if damping else b


def _bottom(segments: Segments, lanes: Lanes, result: StepResult, at: Array) -> Array:
    """The time [tau] for which the drive falls in these steps: until their last segment
    begins; 0 where the drive only rises.
    """
    k, u = lanes.segment[at], lanes.phase[at]
    to_k, to_u = result.step.segment[at], result.step.phase[at]
    to_k = np.where(to_u > 0.0, to_k, to_k - 1)
    # True where the whole step lies in one falling segment
    inside = -lanes.side[at] * (segments.s_end[k] - segments.s_start[k]) < 0.0
    bottom = (
        phase_between(segments, k, u, np.maximum(k, to_k), np.zeros(at.size))
        / lanes.omega[at]
    )
    return np.where(to_k > k, bottom, np.where(inside, result.step.h[at], 0.0))


def _falling_again(
    segments: Segments, lanes: Lanes, result: StepResult, at: Array
) -> Array:
    """A time with y' < 0 inside steps that begin and end with y' > 0, NaN where there
    is none.
    """
    subcritical, h = result.step.subcritical[at], result.step.h[at]
    bottom = np.clip(_bottom(segments, lanes, result, at), subcritical, h)
    arc = result.arc.take(at)
    # While the drive falls y' < 0 is concave, so it stays negative to this instant.
    # Afterwards y' > 0 is convex, and dips only if it still falls here.
    middle = arc.at(bottom)
    found = np.where(middle.v < 0.0, bottom, np.nan)
    hidden = np.flatnonzero(
        (middle.v >= 0.0) & (_slope(middle.b, middle.v, arc.damping) < 0.0)
    )
    if hidden.size:
        found[hidden] = hidden_turn(arc.take(hidden), bottom[hidden], h[hidden], 1.0)
    return found
