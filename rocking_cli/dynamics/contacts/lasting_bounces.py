"""Tests of bounces that last: under a record those below the peak so far until the
shaking is over (Lemma 14), and those that need more steps than the march follows.
"""

import math
from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ...motions.blocks import blocks
from ...motions.segments import Segments
from ..equations.equation import Equation
from ..lanes import Lanes
from .sequences import BELOW_ROUNDING, forces_at_ground

# eta above which bodies are tested for lasting bounces: bodies with a smaller eta come
# to rest soon
NEARLY_ELASTIC = 0.99
_FIRST = 16  # steps of a lane before the first test
# largest part of its speed that such a body may lose: a body that loses all of it could
# come to rest
_MOST_LOSS = 0.1
# instants as parts of the rest of a segment: now, and the middles of its quarters
_SHARES = (0.0, 0.125, 0.375, 0.625, 0.875)
_ROOM = (0.05, 0.1, 0.2, 0.4, 0.8)  # values of G (Lemma 14) that are tried
_SMALL = 0.095  # largest W over D^2/g (Lemma 14)
# largest y over W/D: 1.053 during the shaking, and after it, where a goes to 0 with M
# <= 1.05 y, 1.053 (1 + 1.106 e/D) D
_PEAK = 1.17
_JOINED = 1e-15  # over the largest |s|: a larger change of s between lines is a jump
_SAFE_SHARE = 1.0 - 1e-6  # share of a bound that is used; the rest is room for rounding


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
    # 1 - a^2 now and at instants to come: v is proportional to its cube root.
    left = segments.length[lanes.segment] - lanes.phase
    now, *later = (
        1.0
        - (1.0 - forces_at_ground(segments, lanes, None, lanes.phase + share * left)[0])
        ** 2
        for share in _SHARES
    )
    # The number of arcs is the integral of (1 - a^2)/(2 v) over the time that is left.
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
    # |c| stays below 1 to the end, so nothing lifts the body again.
    k = lanes.segment[at]
    later = np.minimum(k + 1, len(segments) - 1)
    largest = np.maximum(
        np.maximum(segments.later_max[later], -segments.later_min[later]),
        np.abs(segments.s_end[k]),
    )
    at = at[lanes.amplitude[at] * largest < 1.0]
    gains = np.broadcast_to(equation.on(lanes.side[at], lanes.cell[at]).gain, at.shape)
    # One by one: no sum depends on a lane's neighbours. The peak is infinite where none
    # is wanted.
    for lane, gain in zip(at.tolist(), gains.tolist(), strict=True):
        highest = bound_of_peaks(segments, lanes.take(slice(lane, lane + 1)), gain)
        found[lane] = math.isfinite(highest) and highest <= lanes.peak[lane]
    return found


class _BounceLines(NamedTuple):
    """Lines of a record under one body (Lemma 14). Every array is (lines,)."""

    largest: Array  # e: largest |c|, the drive towards +x [-]
    slope: Array  # c' [1/tau]
    duration: Array  # duration [tau]

    @property
    def phi(self) -> Array:
        """Bound of |phi| over (2 W)^(1/2)."""
        d = 1.0 - self.largest
        return 2.0 / 3.0 / (1.0 - self.largest * self.largest) + 0.36 / (d * d)

    @property
    def by_speed(self) -> Array:
        """Bound of the change of Q along each line over (2 W)^(1/2), without the terms
        that go with W.
        """
        e, rate = self.largest, np.abs(self.slope)
        d, square = 1.0 - e, 1.0 - e * e
        return (
            rate
            * rate
            * self.duration
            * (4.0 / 3.0 * e / (square * square) + 0.74 / d**3)
        )

    @property
    def by_energy(self) -> Array:
        """The terms that go with W, over 2 g W."""
        return np.abs(self.slope) * self.duration / (1.0 - self.largest) ** 3


class _ActionBounds(NamedTuple):
    """Bounds of the changes of Q, the logarithm of the action, from now to the end of
    the record (Lemma 14); W is the energy of the bounces.
    """

    by_speed: float  # sum of the terms with the factor (2 W)^(1/2), without it
    by_energy: float  # sum of the terms with the factor W, without it
    largest: float  # largest |c| [-]
    steepest: float  # largest |c' phi| over (2 W)^(1/2)


def bound_of_peaks(segments: Segments, lane: Lanes, gain: float) -> float:
    """Return an upper bound of all later peaks [y] of one body just after an impact, if
    nothing lifts it again (Lemma 14); infinite if none is proved. gain: that of the
    equation, a bound of |df/dy|.
    """
    now, v = abs(1.0 + float(lane.force[0])), float(lane.v[0])
    if now == 1.0:  # the force is below rounding
        return np.inf
    bounds = _action_bounds(segments, lane, now, gain)
    if bounds is None:
        return np.inf
    d = 1.0 - bounds.largest
    for room in _ROOM:
        # W of a body with this room G where c = 0, the most that W could be.
        still = 0.5 * v * v * math.exp(room) / (1.0 - now * now) ** (2.0 / 3.0)
        changes = (
            math.sqrt(2.0 * still) * (bounds.by_speed + 2.0 * bounds.steepest)
            + still * bounds.by_energy
        )
        if changes <= _SAFE_SHARE * room:
            # The changes sum up to no more than G, so W is bounded to the end. W/D,
            # which bounds y, grows with |c|.
            highest = still * (1.0 - bounds.largest * bounds.largest) ** (2.0 / 3.0) / d
            small = highest <= _SMALL * d / gain
            return _PEAK * highest / _SAFE_SHARE if small else np.inf
    return np.inf


def _action_bounds(
    segments: Segments, lane: Lanes, now: float, gain: float
) -> _ActionBounds | None:
    """The bounds of one body from its present position on, None if the record jumps;
    now: |c| now.
    """
    k, amplitude = int(lane.segment[0]), float(lane.amplitude[0])
    by_speed = by_energy = most = steepest = 0.0
    end = now  # c at the end of the line before
    slope = phi = 0.0  # c' and the bound of phi on the line before
    for part in blocks(len(segments) - k):
        at = slice(k + part.start, k + part.stop)
        first = not part.start
        ends = np.append(end, amplitude * segments.s_end[at])
        if _jumps(segments, at, ends, amplitude, 1 if first else 0):
            return None
        lines = _lines(segments, lane, at, ends, first)
        if first:
            slope = lines.slope[0]

        # The changes along each line, and at its start by phi times the change of c'.
        later_phi = np.maximum(np.append(phi, lines.phi[:-1]), lines.phi)
        turns = np.abs(np.diff(lines.slope, prepend=slope)) * later_phi
        by_speed += float(lines.by_speed.sum()) + float(turns.sum())
        by_energy += 2.0 * gain * float(lines.by_energy.sum())
        most = max(most, float(lines.largest.max()))
        steepest = max(steepest, float((np.abs(lines.slope) * lines.phi).max()))
        end, slope, phi = float(ends[-1]), float(lines.slope[-1]), float(lines.phi[-1])
    return _ActionBounds(by_speed, by_energy, most, steepest)


def _jumps(
    segments: Segments, at: slice, ends: Array, amplitude: float, skipped: int
) -> bool:
    """True if c jumps at the start of one of these lines, except the first `skipped`;
    ends: c at the end of the line before each, and of the last one.
    """
    largest = max(float(segments.later_max[0]), -float(segments.later_min[0]))
    jumps = np.abs(amplitude * segments.s_start[at] - ends[:-1])[skipped:]
    return bool(jumps.max(initial=0.0) > _JOINED * amplitude * largest)


def _lines(
    segments: Segments, lane: Lanes, at: slice, ends: Array, first: bool
) -> _BounceLines:
    """The lines of these segments for one body; ends: c at the start of the first and
    at the end of each; first: True if the body is on the first of them now.
    """
    (phase,), (amplitude,), (omega,) = (
        x.tolist() for x in (lane.phase, lane.amplitude, lane.omega)
    )
    duration = segments.length[at] / omega
    if first:
        duration[0] -= phase / omega
    return _BounceLines(
        np.maximum(np.abs(ends[:-1]), np.abs(ends[1:])),
        amplitude * omega * segments.slope[at],
        duration,
    )
