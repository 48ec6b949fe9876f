"""One round of the engine: each lane goes from its present state to the end of a window
of the outward drive a, or to an impact.

The sign of a - 1 in a window proves whether y has a root in it (Lemmas 1 and 2). A
window with a < 1 ends at any inner maximum of a, so that a falls and then rises once
along it (Lemma 3). Boundaries are the crossings of a = 1 and the ends of pieces.
"""

from typing import NamedTuple

import numpy as np

from ...motions.segments import Segments
from ..drive import crossing, phase_between, place
from ..equations.equation import Equation, Flow, Point
from ..equations.taylor import TaylorSeries
from ..lanes import Array, Lanes
from .roots import falls_through_zero, hidden_turn, impact_root, sense, turning_point

_SAFE_SHARE = (
    1.0 - 1e-9
)  # a bound counts if it holds with this much room, which is more than rounding needs


class Windows(NamedTuple):
    """The end of the present window of each lane. A window is an interval in which the
    drive stays subcritical, or stays supercritical. Every array is (lanes,).
    """

    segment: Array  # segment of the end
    phase: Array  # phase of the end in its segment [rad]
    supercritical: Array  # True if the drive is supercritical
    over: (
        Array  # phase of the whole segments between the present one and `segment` [rad]
    )

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
        offset = weighed.offset(side)
        there = _beyond_cuts(
            weighed.edges,
            window_end(weighed.edges, k + offset, u, side, amplitude),
            side,
            amplitude,
        )
        return there._replace(segment=there.segment - offset)
    inverse = 1.0 / amplitude

    def cut_at(lanes: Array, k: Array) -> Array:
        return crossing(segments, k, -side[lanes] * inverse[lanes])

    from_s, to_s = segments.s_start[k], segments.s_end[k]  # outwards
    from_s *= -side
    to_s *= -side
    start, end = from_s > inverse, to_s > inverse
    length = segments.length[k]
    cut = length.copy()
    cuts = np.flatnonzero(start != end)
    cut[cuts] = cut_at(cuts, k[cuts])  # where a = 1
    here = u < cut
    supercritical = np.where(here, start, end)
    here &= start != end
    # Past the crossing (or without one) the window runs to the segment's end. It
    # continues into the next segment if that segment has the same closed form and
    # brings the drive back towards a = 1.
    falling = to_s < from_s
    to_k, to_u, over = k, np.where(here, cut, length), np.zeros(length.shape)
    lanes = np.flatnonzero(~here & segments.joins[k] & (supercritical != falling))
    if lanes.size:
        to_k = k.copy()
        to_k[lanes] = nk = k[lanes] + 1
        n_cut = segments.length[nk]
        n_cuts = np.flatnonzero(
            supercritical[lanes] != (-side[lanes] * segments.s_end[nk] > inverse[lanes])
        )
        n_cut[n_cuts] = cut_at(lanes[n_cuts], nk[n_cuts])
        to_u[lanes] = n_cut
        over[lanes] = length[lanes]
    return Windows(to_k, to_u, supercritical, over)


def _beyond_cuts(
    segments: Segments, window: Windows, side: Array, amplitude: Array
) -> Windows:
    """The same windows, extended past segment ends at which only the drive of the other
    edge turns, but not past inner maxima.
    """
    k, u, supercritical, over = window
    lanes = np.arange(k.size)
    while True:
        ends = lanes[(u[lanes] >= segments.length[k[lanes]]) & segments.joins[k[lanes]]]
        rises, falls = (
            sense * side[ends] * (segments.s_end[at] - segments.s_start[at]) < 0.0
            for sense, at in ((1.0, k[ends]), (-1.0, k[ends] + 1))
        )
        ends = ends[supercritical[ends] | ~(rises & falls)]
        if not ends.size:
            return Windows(k, u, supercritical, over)
        following = window_end(
            segments, k[ends] + 1, np.zeros(ends.size), side[ends], amplitude[ends]
        )
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
    reach = step.h.copy()
    hit = end.y <= 0.0
    # A supercritical window entered inwards: y may touch the ground at its only minimum
    # although both ends are above the ground.
    dips = np.flatnonzero(step.supercritical & ~hit & (lanes.v < 0.0) & (end.v > 0.0))
    if dips.size:
        h = step.h[dips]
        h_min, y_min = turning_point(
            arc.take(dips), np.zeros(dips.size), h, 0.5 * h, -1.0
        )
        touched = ~(y_min > 0.0)
        hit[dips[touched]] = True
        reach[dips[touched]] = h_min[touched]
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
    step, end, damping = result.step, result.end, result.arc.damping
    wanted = wanted & ~step.supercritical
    if segments.weighed is not None:
        assert isinstance(result.arc, TaylorSeries)
        assert result.chord_errors is not None
        v, (kept, monotone) = (
            np.where(result.hit, result.impact_v, end.v),
            sense(result.arc, step.h, end, result.chord_errors),
        )
        at = wanted & ~kept
        once = at & monotone & (lanes.v > 0.0) & (v <= 0.0)
        at, low, high = falls_through_zero(
            result.arc,
            result.reach,
            *(np.flatnonzero(x) for x in (at & ~monotone, once)),
        )
        if not at.size:
            return at, low, high
        chord = high * (
            lanes.v[at] / (lanes.v[at] - np.minimum(v[at], 0.0))
        )  # if this is the only turn of the step
        guess = np.where(high - low == result.reach[at], chord, 0.5 * (low + high))
        return at, *turning_point(result.arc.take(at), low, high, guess, 1.0)
    rises = wanted & ((step.subcritical > 0.0) | (lanes.v > 0.0))
    low, high = step.subcritical.copy(), result.reach.copy()
    # Entered inwards, y' may rise through zero while the drive still falls: as a
    # concave function, not above its tangent.
    slope = _slope(lanes.force, lanes.v, -damping)  # lanes carry the force
    turning = np.flatnonzero(wanted & ~rises & (slope > 0.0))
    if turning.size:
        bottom = np.minimum(_bottom(segments, lanes, result, turning), high[turning])
        turning, bottom = (
            x[lanes.v[turning] + slope[turning] * bottom > 0.0]
            for x in (turning, bottom)
        )
        outwards = hidden_turn(
            result.arc.take(turning), np.zeros(turning.size), bottom, -1.0
        )
        found = np.isfinite(outwards)
        rises[turning[found]], low[turning[found]] = True, outwards[found]
    sure = rises & (result.hit | (end.v <= 0.0))
    # y' > 0 at both ends: a peak and a trough may hide where the drive rises again, and
    # then b > 0 at the end. There y' is convex (see `hidden_turn`): its tangent at the
    # end may prove at once that it never falls below zero.
    slope = _slope(end.b, end.v, damping)
    doubtful = np.flatnonzero(
        rises
        & ~sure
        & (slope > 0.0)
        & (slope * (step.h - step.subcritical) > _SAFE_SHARE * end.v)
    )
    if doubtful.size:
        falls = _falling_again(segments, lanes, result, doubtful)
        found = np.isfinite(falls)
        sure[doubtful[found]] = True
        high[doubtful[found]] = falls[found]
    at = np.flatnonzero(sure)
    low, high = low[at], high[at]
    if not at.size:
        return at, low, low
    return at, *turning_point(result.arc.take(at), low, high, 0.5 * (low + high), 1.0)


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
    inside = (
        -lanes.side[at] * (segments.s_end[k] - segments.s_start[k]) < 0.0
    )  # a step within one falling segment
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
    middle = arc.at(bottom)
    found = np.where(middle.v < 0.0, bottom, np.nan)
    hidden = np.flatnonzero(
        (middle.v >= 0.0) & (_slope(middle.b, middle.v, arc.damping) < 0.0)
    )
    if hidden.size:
        found[hidden] = hidden_turn(arc.take(hidden), bottom[hidden], h[hidden], 1.0)
    return found
