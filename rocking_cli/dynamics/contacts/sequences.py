"""Tests of sequences of impacts: which ones end in rest before any other event, and
when (Lemma 7); which ones last until the shaking is over (Lemma 7, under a record Lemma
14); which ones need more steps than the march follows.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ...motions.blocks import blocks
from ...motions.segments import Segments
from ..drive import drive_change
from ..equations.equation import Equation
from ..lanes import Array, Arrays, Lanes

# With (nearly) no loss at impacts a sequence (nearly) never ends: a speed and a height
# below these are rest to every digit of theta/alpha.
BELOW_ROUNDING, LOWEST = 1e-12, 1e-16
STILL = 1e-100  # speed that counts as zero, since its square is below double precision
_ELASTIC = (
    1.0 - 1e-6
)  # least part of its speed that a cycle (nearly) without loss keeps
# eta above which bodies are tested for lasting bounces: bodies with a smaller eta come
# to rest soon
NEARLY_ELASTIC = 0.99
_FIRST = 16  # steps of a lane before the first test
# largest part of its speed that such a body may lose: a body that loses all of it could
# come to rest
_MOST_LOSS = 0.1
_SHARES = (
    0.0,
    0.125,
    0.375,
    0.625,
    0.875,
)  # instants as parts of the rest of a segment: now, and the middles of its quarters
_ROOM = (0.05, 0.1, 0.2, 0.4, 0.8)  # values of G (Lemma 14) that are tried
_SMALL = 0.095  # largest W over D^2/g (Lemma 14)
# largest y over W/D: 1.053 during the shaking, and after it, where a goes to 0 with M
# <= 1.05 y, 1.053 (1 + 1.106 e/D) D
_PEAK = 1.17
_JOINED = 1e-15  # over the largest |s|: a larger change of s between lines is a jump
_SAFE_SHARE = 1.0 - 1e-6  # share of a bound that is used; the rest is room for rounding


@dataclass
class OtherSide(Arrays):
    """The side of the next arc (the motion between two impacts), compared with the
    present side. From one arc on this side to the next one the speed is multiplied by
    eta times back.
    """

    # the outward drive there is -drive times the outward drive here [-], (lanes,)
    drive: Array | float
    # duration of an arc there over that of the same arc here [-], (lanes,)
    time: Array | float
    # speed after over before the impact that leaves the present side [-], (lanes,)
    eta: Array
    back: Array  # the same for the impact that leaves the other side [-], (lanes,)
    rotation: Array | float  # |theta|/alpha of y = 1 there over that here [-], (lanes,)


def sequence_ends(
    segments: Segments,
    lanes: Lanes,
    equation: Equation,
    there: OtherSide | None,
    more: float = 0.0,
) -> Array:
    """Return True for lanes that are proved to come to rest by a sequence of impacts
    before any other event, without an arc higher than their peak so far (Lemma 7 of
    `lemmas`), (lanes,). there: the side of the next arc, None if it is the same side;
    more: amount by which ties and a tendon raise |df/dy|.
    """
    v, speed_ratio = lanes.v, lanes.eta if there is None else there.eta * there.back
    slow = np.flatnonzero(
        (lanes.force < 0.0)
        & ((v * v < 0.05 * lanes.force * lanes.force) | (v < BELOW_ROUNDING))
    )
    gap = np.zeros(v.shape)
    gap[slow] = np.minimum(
        *_forces(
            segments, lanes.take(slow), None if there is None else there.take(slow)
        )
    )
    proved = (
        (speed_ratio > _ELASTIC) & (v < BELOW_ROUNDING) & (0.5 * v * v < LOWEST * gap)
    )
    at = np.flatnonzero((gap > 0.0) & (v * v < 0.05 * gap * gap) & (speed_ratio < 1.0))
    room = (
        segments.length[lanes.segment[at]] - lanes.phase[at]
    )  # `_ends` tries a duration longer than 3 v / (1 - q) / (1 - a)
    at = at[
        3.0 * v[at] * lanes.omega[at]
        < room * (1.0 - speed_ratio[at]) * -lanes.force[at]
    ]
    if at.size:
        proved[at] |= _ends(
            segments,
            lanes.take(at),
            equation,
            None if there is None else there.take(at),
            speed_ratio[at],
            more,
        )
    return proved


class SequenceBounds(NamedTuple):
    """Bounds of a sequence of impacts that is proved to end in rest. Every array is
    (lanes,). Pairs are (on this side, on the other side), each in the unit of its side;
    without another side the second forces are infinite.
    """

    later: Array  # phase of the segment before which the sequence ends [rad]
    least: tuple[Array, Array]  # smallest inward force on bodies at the ground
    most: tuple[Array, Array]  # largest inward force on bodies at the ground
    fastest: tuple[Array, Array]  # largest |y'|
    height: Array  # largest y on either side


def sequence_bounds(
    segments: Segments, lanes: Lanes, there: OtherSide | None
) -> SequenceBounds:
    """Return bounds of sequences of impacts for which `sequence_ends` is True, for
    lanes just after an impact.
    """
    speed_ratio = lanes.eta if there is None else there.eta * there.back
    path = _path_of(
        segments,
        lanes,
        there,
        speed_ratio,
        (speed_ratio > _ELASTIC) & (lanes.v < BELOW_ROUNDING),
    )
    n = 1.0 if there is None else there.eta
    fastest = path.growth * lanes.v
    (here, other), (then, other_then) = path.now, path.then
    return SequenceBounds(
        path.later,
        (np.minimum(here, then), np.minimum(other, other_then)),
        (np.maximum(here, then), np.maximum(other, other_then)),
        (fastest, n * fastest),
        path.height(lanes.v, n),
    )


class _Path(NamedTuple):
    """The forces over the longest duration of a sequence of impacts, and how far they
    let its speeds grow. Every array is (lanes,).
    """

    scale: Array  # 2 v / (1 - q)
    duration: Array  # upper bound of the duration that is tried [tau of this side]
    later: Array  # phase of the segment after this duration [rad]
    # inward force on bodies at the ground at the start, on this side and on the other
    now: tuple[Array, Array]
    then: tuple[Array, Array]  # the same after the duration
    growth: Array  # bound of later speeds over v, on either side [-]
    gains: Array  # G: bound of the speeds at which arcs on this side begin, over v [-]
    # H: the same on the other side, less what shorter arcs make up for [-]
    other_gains: Array

    def height(self, v: Array, n: Array | float) -> Array:
        """The largest y of an arc, while y and damping take less than
        half the force.
        """
        here, other = (
            np.minimum(now, then) for now, then in zip(self.now, self.then, strict=True)
        )
        return np.asarray(
            v
            * v
            * np.maximum(
                self.gains * self.gains / here, (n * self.other_gains) ** 2 / other
            )
        )


def _path_of(
    segments: Segments,
    lanes: Lanes,
    there: OtherSide | None,
    q: Array,
    still: Array | bool = False,
) -> _Path:
    """Return the forces over the longest duration of these sequences; still: True for
    lanes whose bounces are below rounding.
    """
    n, r = (0.0, 1.0) if there is None else (there.eta, there.time)
    here, other = _forces(segments, lanes, there)
    with np.errstate(invalid="ignore", divide="ignore"):
        scale = 2.0 * lanes.v / (1.0 - q)
        duration = np.where(still, 0.0, 1.5 * scale * (1.0 / here + n * r / other))
    later = np.minimum(
        lanes.phase + lanes.omega * duration, segments.length[lanes.segment]
    )
    then, other_then = _forces(segments, lanes, there, later)
    with np.errstate(invalid="ignore", divide="ignore"):
        grows, other_grows = then / here, 1.0 if there is None else other_then / other
        if segments.weighed is None:  # the force grows on one side only
            growth = np.sqrt(np.where(then < here, other_grows, grows))
            gains, other_gains = (
                np.where(then < here, growth, 1.0),
                np.where(then < here, 1.0, growth),
            )  # of the arcs here and there
        else:
            gains = other_gains = growth = np.sqrt(
                np.maximum(grows, 1.0 / grows)
                * np.maximum(other_grows, 1.0 / other_grows)
            )
    return _Path(
        scale,
        duration,
        later,
        (here, other),
        (then, other_then),
        growth,
        gains,
        other_gains,
    )


def _ends(
    segments: Segments,
    lanes: Lanes,
    equation: Equation,
    there: OtherSide | None,
    q: Array,
    more: float,
) -> Array:
    """As `sequence_ends`, for lanes whose sequence may be short enough."""
    k, v = lanes.segment, lanes.v
    n, r, rotation = (
        (0.0, 1.0, 1.0) if there is None else (there.eta, there.time, there.rotation)
    )
    path = _path_of(segments, lanes, there, q)
    heaviest: Array | float = 1.0
    if (weighed := segments.weighed) is not None:
        most = np.maximum(weighed.vertical.s_start[k], weighed.vertical.s_end[k])
        heaviest = np.maximum(
            1.0, 1.0 + weighed.sway(lanes.side, lanes.amplitude) * most
        )
    here, other = (
        np.minimum(now, then) for now, then in zip(path.now, path.then, strict=True)
    )
    height = path.height(v, n)
    lever = equation.on(lanes.side, lanes.cell).gain + more
    extra = (
        lever * heaviest * height
        + 2.0 * equation.damping * path.growth * v * np.maximum(1.0, n)
    )
    ends = (
        (path.later < segments.length[k])
        & (here > 0.0)
        & (other > 0.0)
        & (extra < 0.5 * np.minimum(here, other))
    )
    lasts = path.scale * (
        path.gains / (here - extra) + n * r * path.other_gains / (other - extra)
    )
    return np.asarray(
        ends
        & (lasts <= path.duration)
        & (np.maximum(1.0, rotation) * height <= lanes.peak)
    )


def _forces(
    segments: Segments, lanes: Lanes, there: OtherSide | None, u: Array | None = None
) -> tuple[Array, Array]:
    """Inward force on bodies at the ground, on this side and on the other (infinite if
    there is none), now or at phase u of the segment.
    """
    if (weighed := segments.weighed) is not None:
        here = (
            -lanes.force
            if u is None
            else 1.0 - weighed.net(lanes.side, lanes.amplitude, lanes.segment, u)
        )
        if there is None:
            return here, np.full(here.shape, np.inf)
        return here, 1.0 - weighed.net(
            -lanes.side,
            lanes.amplitude * there.drive,
            lanes.segment,
            lanes.phase if u is None else u,
        )
    drive = 1.0 + lanes.force
    if u is not None:
        outward = -lanes.side * lanes.amplitude
        drive = drive + outward * (
            drive_change(segments, lanes.segment, u)
            - drive_change(segments, lanes.segment, lanes.phase)
        )
    return 1.0 - drive, (
        np.full(drive.shape, np.inf) if there is None else 1.0 + there.drive * drive
    )


def sequence_time(
    lanes: Lanes, there: OtherSide | None, weight: Array | float = 1.0
) -> Array:
    """Duration [tau] of the sequence of arcs under a constant drive and weight; 0 if it
    does not end.
    """
    if there is None:
        return 2.0 * lanes.v / (1.0 - lanes.eta) / -lanes.force
    drive, speed_ratio = weight + lanes.force, there.eta * there.back
    ends = (lanes.v > 0.0) & (speed_ratio < 1.0)
    total = (
        2.0
        * lanes.v
        / (1.0 - speed_ratio)
        * (
            1.0 / (weight - drive)
            + there.eta * there.time / (weight + there.drive * drive)
        )
    )
    return np.where(ends, total, 0.0)


def stays_below_peak(segments: Segments, lanes: Lanes) -> Array:
    """True for lanes just after an impact that bounce or rest until the shaking is over
    and never rise above their peak (Lemma 7). It holds for undamped linear oscillators
    with equal edges.
    """
    drive, ends = (
        1.0 + lanes.force,
        -lanes.side * lanes.amplitude * segments.s_end[lanes.segment],
    )
    left = 1.0 - np.maximum(
        np.maximum(np.abs(drive), np.abs(ends)),
        lanes.amplitude * segments.largest_later[lanes.segment],
    )
    variation = (
        np.abs(ends - drive) + lanes.amplitude * segments.variation[lanes.segment]
    )
    with np.errstate(over="ignore", divide="ignore", invalid="ignore"):
        fastest = lanes.v * lanes.v * np.exp(4.0 / 3.0 * variation / left)
        return np.asarray(
            (left > 0.0)
            & (fastest <= 0.75 * left * left)
            & (fastest <= 1.5 * left * lanes.peak)
        )


def too_many_impacts(segments: Segments, lanes: Lanes, most: int) -> Array:
    """Return True for undamped lanes on equal edges, just after an impact, that would
    have more than `most` impacts until their segment ends; the march then gives them
    up. This is an estimate, not a proof, so it requires twice as many: two arcs last 4
    v/(1 - a^2), and v^3 goes with 1 - a^2 (Lemma 14).
    """
    found = np.zeros(lanes.v.shape, dtype=bool)
    at = _tested(lanes)
    if not at.size:
        return found
    lanes = lanes.take(at)
    left = segments.length[lanes.segment] - lanes.phase
    now, *later = (
        1.0 - (1.0 - _forces(segments, lanes, None, lanes.phase + share * left)[0]) ** 2
        for share in _SHARES
    )
    pace = np.mean([np.cbrt(np.maximum(still, 0.0)) ** 2 for still in later], axis=0)
    impacts = 0.5 * pace * np.cbrt(now) * left / lanes.omega / lanes.v
    found[at] = (
        (impacts > 2.0 * most)
        & (impacts * (1.0 - lanes.eta) < _MOST_LOSS)
        & (lanes.v > 10.0 * BELOW_ROUNDING)
    )
    return found


def _tested(lanes: Lanes) -> Array:
    """Indices of lanes at the ground that lose almost no speed, under |a| < 1: after
    `_FIRST` steps, then each time these have doubled.
    """
    tested = (
        (lanes.steps >= _FIRST)
        & (lanes.steps & (lanes.steps - 1) == 0)
        & (lanes.eta > NEARLY_ELASTIC)
        & (lanes.v > 0.0)
    )
    return np.flatnonzero(tested & (lanes.force < 0.0) & (lanes.force > -2.0))


def bounces_to_end(segments: Segments, lanes: Lanes, equation: Equation) -> Array:
    """True for lanes just after an impact that bounce until the shaking is over and
    stay below their peak (Lemma 14).
    """
    found = np.zeros(lanes.v.shape, dtype=bool)
    at = _tested(lanes)
    if not at.size:
        return found
    k = lanes.segment[at]
    later = np.minimum(k + 1, len(segments) - 1)
    largest = np.maximum(
        np.maximum(segments.later_max[later], -segments.later_min[later]),
        np.abs(segments.s_end[k]),
    )
    at = at[lanes.amplitude[at] * largest < 1.0]
    gains = np.broadcast_to(equation.on(lanes.side[at], lanes.cell[at]).gain, at.shape)
    for lane, gain in zip(
        at.tolist(), gains.tolist(), strict=True
    ):  # one by one: no sum depends on a lane's neighbours
        highest = bound_of_peaks(segments, lanes.take(slice(lane, lane + 1)), gain)
        found[lane] = (
            math.isfinite(highest) and highest <= lanes.peak[lane]
        )  # the peak is infinite where none is wanted
    return found


def bound_of_peaks(segments: Segments, lane: Lanes, gain: float) -> float:
    """Return an upper bound of all later peaks [y] of one body just after an impact, if
    nothing lifts it again (Lemma 14); infinite if none is proved. gain: that of the
    equation, a bound of |df/dy|.
    """
    (k,), (u,), (amplitude,), (omega,), (v,), (b,) = (
        x.tolist()
        for x in (
            lane.segment,
            lane.phase,
            lane.amplitude,
            lane.omega,
            lane.v,
            lane.force,
        )
    )
    jump = (
        _JOINED
        * amplitude
        * max(float(segments.later_max[0]), -float(segments.later_min[0]))
    )
    now, sums, most, steepest, gain_sum = abs(1.0 + b), 0.0, 0.0, 0.0, 0.0
    if now == 1.0:  # the force is below rounding
        return np.inf
    end, before, phase_before = (
        now,
        0.0,
        0.0,
    )  # of the line before: c at its end, c', the factor of phi
    for part in blocks(len(segments) - k):
        at = slice(k + part.start, k + part.stop)
        ends = np.append(end, amplitude * segments.s_end[at])
        if (
            np.abs(amplitude * segments.s_start[at] - ends[:-1])[
                0 if part.start else 1 :
            ].max(initial=0.0)
            > jump
        ):
            return np.inf
        e = np.maximum(np.abs(ends[:-1]), np.abs(ends[1:]))
        force, square = 1.0 - e, 1.0 - e * e  # D, 1 - e^2
        slope = amplitude * omega * segments.slope[at]  # c'
        rate, lasts = np.abs(slope), segments.length[at] / omega
        if not part.start:
            lasts[0] -= u / omega
            before = slope[0]
        phase = 2.0 / 3.0 / square + 0.36 / (force * force)
        turns = np.abs(np.diff(slope, prepend=before)) * np.maximum(
            np.append(phase_before, phase[:-1]), phase
        )
        lines = (
            rate * rate * lasts * (4.0 / 3.0 * e / (square * square) + 0.74 / force**3)
        )
        sums += float(lines.sum()) + float(turns.sum())
        gain_sum += 2.0 * gain * float((rate * lasts / force**3).sum())
        most, steepest = (
            max(most, float(e.max())),
            max(steepest, float((rate * phase).max())),
        )
        end, before, phase_before = float(ends[-1]), float(slope[-1]), float(phase[-1])
    for room in _ROOM:
        still = (
            0.5 * v * v * math.exp(room) / (1.0 - now * now) ** (2.0 / 3.0)
        )  # the most that W could be where c = 0
        if (
            math.sqrt(2.0 * still) * (sums + 2.0 * steepest) + still * gain_sum
            <= _SAFE_SHARE * room
        ):
            highest = (
                still * (1.0 - most * most) ** (2.0 / 3.0) / (1.0 - most)
            )  # W/D, which grows with |c|
            return (
                _PEAK * highest / _SAFE_SHARE
                if highest <= _SMALL * (1.0 - most) / gain
                else np.inf
            )
    return np.inf
