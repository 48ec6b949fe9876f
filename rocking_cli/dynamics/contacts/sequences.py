"""Tests of sequences of impacts: which ones end in rest before any other event, when,
and within which bounds (Lemma 7).
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ...motions.segments import Segments
from ..drive import drive_change
from ..equations.equation import Equation
from ..lanes import Arrays, Lanes

# With (nearly) no loss at impacts a sequence (nearly) never ends: a speed and a height
# below these are rest to every digit of theta/alpha.
BELOW_ROUNDING, LOWEST = 1e-12, 1e-16
STILL = 1e-100  # speed that counts as zero, since its square is below double precision
# least part of its speed that a cycle (nearly) without loss keeps
_ELASTIC = 1.0 - 1e-6


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
    more: Array | float = 0.0,
) -> Array:
    """Return True for lanes that are proved to come to rest by a sequence of impacts
    before any other event, without an arc higher than their peak so far (Lemma 7 of
    `lemmas`), (lanes,). there: the side of the next arc, None if it is the same side;
    more: amount by which ties and a tendon raise |df/dy|.
    """
    v = lanes.v
    speed_ratio = lanes.eta if there is None else there.eta * there.back

    # The least inward force now, of lanes that are slow for the force on this side.
    slow = (v * v < 0.05 * lanes.force * lanes.force) | (v < BELOW_ROUNDING)
    slow = np.flatnonzero((lanes.force < 0.0) & slow)
    gap = np.zeros(v.shape)
    others = None if there is None else there.take(slow)
    gap[slow] = np.minimum(*forces_at_ground(segments, lanes.take(slow), others))

    # Bounces (nearly) without loss, below rounding.
    proved = (
        (speed_ratio > _ELASTIC) & (v < BELOW_ROUNDING) & (0.5 * v * v < LOWEST * gap)
    )

    # Lemma 7, for lanes whose sequence may be short enough: `_ends` tries a duration
    # longer than 3 v / (1 - q) / (1 - a).
    at = np.flatnonzero((gap > 0.0) & (v * v < 0.05 * gap * gap) & (speed_ratio < 1.0))
    room = segments.length[lanes.segment[at]] - lanes.phase[at]
    shortest = 3.0 * v[at] * lanes.omega[at]
    at = at[shortest < room * (1.0 - speed_ratio[at]) * -lanes.force[at]]
    if at.size:
        others = None if there is None else there.take(at)
        raised = np.broadcast_to(more, v.shape)[at]
        proved[at] |= _ends(
            segments, lanes.take(at), equation, others, speed_ratio[at], raised
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
    # q; where the bounces are below rounding the sequence counts as over at once.
    speed_ratio = lanes.eta if there is None else there.eta * there.back
    still = (speed_ratio > _ELASTIC) & (lanes.v < BELOW_ROUNDING)
    path = _path_of(segments, lanes, there, speed_ratio, still)
    eta = 1.0 if there is None else there.eta
    fastest = path.growth * lanes.v
    # The drive is monotone, so the largest forces are those at the ends.
    (here, other), (then, other_then) = path.now, path.then
    return SequenceBounds(
        path.later,
        path.least,
        (np.maximum(here, then), np.maximum(other, other_then)),
        (fastest, eta * fastest),
        path.height(lanes.v, eta),
    )


class _ForcesAhead(NamedTuple):
    """The forces over the longest duration of a sequence of impacts, and how far they
    let its speeds grow. Every array is (lanes,).
    """

    scale: Array  # 2 v / (1 - q)
    duration: Array  # upper bound of the duration that is tried [tau of this side]
    later: Array  # phase of the segment after this duration [rad]
    # inward force on bodies at the ground at the start, on this side and on the other
    now: tuple[Array, Array]
    then: tuple[Array, Array]  # inward force after the duration, on both sides
    growth: Array  # bound of later speeds over v, on either side [-]
    gains: Array  # G: bound of the speeds at which arcs on this side begin, over v [-]
    # H: the same on the other side, less what shorter arcs make up for [-]
    other_gains: Array

    @property
    def least(self) -> tuple[Array, Array]:
        """The smallest inward force on this side and on the other."""
        here, other = (
            np.minimum(now, then) for now, then in zip(self.now, self.then, strict=True)
        )
        return here, other

    def height(self, v: Array, eta: Array | float) -> Array:
        """The largest y of an arc, while y and damping take less than half the force;
        eta: of the impact that leaves this side.
        """
        here, other = self.least
        return np.asarray(
            v
            * v
            * np.maximum(
                self.gains * self.gains / here, (eta * self.other_gains) ** 2 / other
            )
        )


def _path_of(
    segments: Segments,
    lanes: Lanes,
    there: OtherSide | None,
    speed_ratio: Array,
    still: Array | bool = False,
) -> _ForcesAhead:
    """Return the forces over the longest duration of these sequences; still: True for
    lanes whose bounces are below rounding.
    """
    eta, time = (0.0, 1.0) if there is None else (there.eta, there.time)
    here, other = now = forces_at_ground(segments, lanes, there)

    # The duration that is tried: half as long again as under the present forces.
    with np.errstate(invalid="ignore", divide="ignore"):
        scale = 2.0 * lanes.v / (1.0 - speed_ratio)
        duration = np.where(still, 0.0, 1.5 * scale * (1.0 / here + eta * time / other))
    later = np.minimum(
        lanes.phase + lanes.omega * duration, segments.length[lanes.segment]
    )
    then = forces_at_ground(segments, lanes, there, later)
    growth, gains, other_gains = _growth(now, then, there, segments.weighed is not None)
    return _ForcesAhead(scale, duration, later, now, then, growth, gains, other_gains)


def _growth(
    now: tuple[Array, Array],
    then: tuple[Array, Array],
    there: OtherSide | None,
    weighed: bool,
) -> tuple[Array, Array, Array]:
    """(bound of later speeds over v, G, H) of Lemma 7, from the forces at both ends of
    the duration; weighed: True if the weight varies.
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        grows = then[0] / now[0]
        other_grows = 1.0 if there is None else then[1] / now[1]
        if weighed:  # speeds gain on either side
            growth = np.sqrt(
                np.maximum(grows, 1.0 / grows)
                * np.maximum(other_grows, 1.0 / other_grows)
            )
            return growth, growth, growth
        # The force grows on one side only. Where the drive rises, it falls here.
        rises = then[0] < now[0]
        growth = np.sqrt(np.where(rises, other_grows, grows))
        return growth, np.where(rises, growth, 1.0), np.where(rises, 1.0, growth)


def _ends(
    segments: Segments,
    lanes: Lanes,
    equation: Equation,
    there: OtherSide | None,
    speed_ratio: Array,
    more: Array,
) -> Array:
    """As `sequence_ends`, for lanes whose sequence may be short enough."""
    v = lanes.v
    eta, time, rotation = (
        (0.0, 1.0, 1.0) if there is None else (there.eta, there.time, there.rotation)
    )
    path = _path_of(segments, lanes, there, speed_ratio)
    here, other = path.least
    height = path.height(v, eta)

    # e: the force that y and damping add to that at the ground.
    on_edge = equation.on(lanes.side, lanes.cell)
    lever = on_edge.gain + more
    fastest = 2.0 * on_edge.damping * path.growth * v * np.maximum(1.0, eta)
    extra = lever * _largest_weight(segments, lanes) * height + fastest

    # The drive stays subcritical on both sides within the segment, and e is small.
    alone = path.later < segments.length[lanes.segment]
    alone &= (here > 0.0) & (other > 0.0) & (extra < 0.5 * np.minimum(here, other))

    # The bound of the duration must not be longer than the duration that was tried.
    lasts = path.scale * (
        path.gains / (here - extra) + eta * time * path.other_gains / (other - extra)
    )
    below_peak = np.maximum(1.0, rotation) * height <= lanes.peak
    return np.asarray(alone & (lasts <= path.duration) & below_peak)


def _largest_weight(segments: Segments, lanes: Lanes) -> Array | float:
    """The largest weight over m g in the present segment of each lane, at least 1."""
    if (weighed := segments.weighed) is None:
        return 1.0
    k, vertical = lanes.segment, weighed.vertical
    most = np.maximum(vertical.s_start[k], vertical.s_end[k])
    return np.maximum(1.0, 1.0 + weighed.sway(lanes.side, lanes.amplitude) * most)


def forces_at_ground(
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
    # f = a - 1 at the ground, under a steady weight.
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


def sequence_time(segments: Segments, lanes: Lanes, there: OtherSide | None) -> Array:
    """Duration [tau] of the sequence of arcs under the present drive and weight; 0 if
    it does not end.
    """
    # A geometric series: an arc with initial speed v under the constant force f lasts
    # 2 v/f, and each cycle keeps q of the speed.
    here, other = forces_at_ground(segments, lanes, there)
    if there is None:
        return 2.0 * lanes.v / (1.0 - lanes.eta) / here
    speed_ratio = there.eta * there.back
    ends = (lanes.v > 0.0) & (speed_ratio < 1.0)
    total = 2.0 * lanes.v / (1.0 - speed_ratio)
    total = total * (1.0 / here + there.eta * there.time / other)
    return np.where(ends, total, 0.0)
