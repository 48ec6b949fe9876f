"""A second, slower solver for every equation and contact, as a check: a Runge-Kutta
method on the equation as the paper writes it.

It shares no series, table, window, closed form or energy argument with the engine. The
state is (theta, w), w = sqrt(M/M0) theta', which takes the velocity term out of Eq.
3.4; M0 is M at rest, and w = theta' of a rigid body. A span is half a radian of the
fastest motion; impacts and peaks are found where signs change (`extrapolation`). A body
loses contact where the ground falls away from it, and a rigid body that rocks where Fz
<= 0 at instants along its steps.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise
from typing import NamedTuple

from ...motions.motion import Motion, Piece, extremes, plus
from ..outcome import FALLEN, Outcome
from .extrapolation import EdgeMotion, Path, Slopes, StatePoint, path

# limit of the number of spans of a cell: a constant, and an addition for each
# segment of the motion
_MOST, _A_SEGMENT = (5_000, 50)
# tau between two tests of overturning where the solver chooses its steps
_SCRIPT_SPAN = 10.0
_AT_REST = 1e-11
# the least force of a step is searched for if it may be below the first plus the second
# times its variation
_NEAR, _PART = (0.1, 0.1)
_STILL = Piece(0.0, math.inf)  # the ground after the shaking
_ROUNDS = 32  # rounds of the search; each leaves two thirds of the interval


# of (theta, w, the inward ground acceleration [g], the weight over m g), which returns
# (theta', w') by tau
Rates = Callable[[float, float, float, float], tuple[float, float]]


class RockingEdge(NamedTuple):
    """One edge of a structure, with the equation of motion on it."""

    alpha: float  # critical angle [rad]
    uplift: float  # static uplift acceleration lambda [-]
    limit: float  # theta from which the body counts as overturned [rad]
    of: Rates  # the equation of motion
    # False if a body that loses contact beyond alpha has an unknown outcome, so that
    # its cell fails
    returns: bool = True
    eta: float = 1.0  # |theta'| after over |theta'| before the impact that leaves it
    # R p^2/g with the p of tau [-], None if its forces are not known: Fz over m g is
    # w + rise (cos(alpha - u))'', with u = |theta|
    rise: float | None = None


class Problem(NamedTuple):
    """A structure for a general solver."""

    # +1 for theta > 0, and -1 unless the body rocks to the right only
    edges: dict[int, RockingEdge]
    scale: float  # ground acceleration of A = 1 [g]
    # function that builds a body with ties or a tendon, None for a free body
    body: Callable[..., ReferenceBody] | None = None


def solve_cell(
    motion: Motion,
    amplitude: float,
    omega: float,
    problem: Problem,
    solver: Callable[..., Path] = path,
) -> tuple[Outcome, float]:
    """(outcome, max |theta|/alpha, NaN where overturned) of one cell. FAILED if it
    takes too long, if no step is short enough, or if the solver of a script finds no
    root.
    """
    try:
        return (problem.body or ReferenceBody)(
            motion, problem, float(amplitude), float(omega), solver
        ).run()
    except (ArithmeticError, ValueError):
        return Outcome.FAILED, math.nan


def value(piece: Piece, phase: float) -> float:
    """s(phase) of a piece, computed with plain Python numbers."""
    total = piece.constant + piece.slope * (phase - piece.start)
    for h in piece.harmonics:
        total += h.amplitude * math.sin(h.frequency * phase + h.phase)
    return total


def next_uplift(piece: Piece, phase: float, push: float) -> float | None:
    """The first phase with push s > 1, from `phase` to the end of the piece, by
    bisection between extremes; None if there is none.
    """
    low = phase
    # s is monotone from one of these phases to the next.
    later = (x for x in extremes(piece) if x > phase)
    for mark in (phase, *later, piece.stop):
        high = mark
        if push * value(piece, high) > 1.0:
            while low < (middle := 0.5 * (low + high)) < high:
                low, high = (
                    (low, middle)
                    if push * value(piece, middle) > 1.0
                    else (middle, high)
                )
            return high
        low = mark
    return None


def falls_to_zero(
    rough: tuple[float, float, float], force: Callable[[float], float]
) -> bool:
    """True if a force falls to zero on a step that holds at most one minimum. rough:
    the force at the start, about the middle and at the end; force: function of the time
    over the step. It skips the search if the parabola through the three values stays
    well above zero.
    """
    first, middle, last = rough
    if first <= 0.0 or last <= 0.0:
        return True
    slope, second_difference = 0.5 * (last - first), first - 2.0 * middle + last
    dip = (
        middle - 0.5 * slope * slope / second_difference
        if second_difference > abs(slope)
        else min(rough)
    )
    low, high = 0.0, 1.0
    for _ in range(_ROUNDS if dip <= _NEAR + _PART * (max(rough) - min(rough)) else 0):
        third = (high - low) / 3.0
        one, other = force(low + third), force(high - third)
        if one <= 0.0 or other <= 0.0:
            return True
        low, high = (low, high - third) if one < other else (low + third, high)
    return False


class ReferenceBody:
    """A body under a motion, from event to event."""

    def __init__(
        self,
        motion: Motion,
        problem: Problem,
        amplitude: float,
        omega: float,
        solver: Callable[..., Path],
    ) -> None:
        self.motion, self.problem, self.solver = motion, problem, solver
        self.drive = amplitude * problem.scale
        self.omega = omega
        self.time = self.theta = self.w = self.peak = 0.0
        self.side = self.turns = 0  # turns: peaks since the last impact
        self.edges = problem.edges
        self.here = self.edges[1]  # the equation on the side of the body
        self.impacts = 0  # after the shaking and the last rupture
        # contact_lost: True if Fz fell to zero on the way
        self.bounced = self.contact_lost = False
        self.up: Piece | None = None  # the present piece of the vertical motion
        vertical = motion.vertical
        # weight over m g
        self.least = (
            1.0
            if vertical is None
            else 1.0 + self.drive * float(vertical.segments.later_min[0])
        )

    def run(self) -> tuple[Outcome, float]:
        left = _MOST + _A_SEGMENT * len(self.motion.segments)
        vertical = self.motion.vertical
        for piece, up in zip(
            self.motion.pieces,
            vertical.pieces if vertical else (None,) * len(self.motion.pieces),
            strict=True,
        ):
            # The weight falls to zero where the ground falls away; the body is followed
            # to this instant.
            self.up = up
            fall = (
                next_uplift(up, up.start, -self.drive)
                if up is not None and self.least <= 0.0
                else None
            )
            end = (piece.stop if fall is None else fall) / self.omega
            while end - self.time > 1e-14 * end:
                left -= 1
                if left < 0:
                    return Outcome.FAILED, math.nan
                (self.move if self.side else self.rest)(piece, end)
                self.follow()
                if self.theta > self.here.limit or (
                    self.side and self.theta > self.here.alpha and self.cannot_return()
                ):
                    return self.overturned(), math.nan
            if fall is not None and self.theta >= FALLEN * self.here.alpha:
                return self.overturned(), math.nan
            # A body that has lost its weight above the unstable equilibrium may or may
            # not come back: its outcome is not known unless the equation lets it
            # return.
            if fall is not None:
                known = self.theta <= self.here.alpha or self.here.returns
                return Outcome.LOST_CONTACT if known else Outcome.FAILED, math.nan
        outcome, peak = self.still()
        return (
            (Outcome.LOST_CONTACT, math.nan)
            if outcome in (Outcome.ROCKED, Outcome.LEANING) and self.contact_lost
            else (outcome, peak)
        )

    def weight(self, time: float) -> float:
        """The weight over m g at this time."""
        return (
            1.0
            if self.up is None
            else 1.0 + self.drive * value(self.up, self.omega * time)
        )

    def pressure(self, at: StatePoint) -> float:
        """The forces downwards at an instant, over m g."""
        return self.weight(at.time)

    def cut(self, flow: EdgeMotion, found: Path) -> Path:
        """Hook: the part of a path on which the equation holds."""
        return found

    def follow(self) -> None:
        """Hook at the end of each part of a path."""

    def rest(self, piece: Piece, end: float) -> None:
        """Let the body rest until its first uplift or the end of the piece."""
        lifts = []
        # With a vertical motion each edge has an effective motion of its own.
        for side, edge in self.edges.items():
            signal = (
                piece
                if self.up is None
                else plus(piece, self.up.scaled(side * self.problem.edges[side].uplift))
            )
            phase = next_uplift(
                signal, self.omega * self.time, -side * self.drive / edge.uplift
            )
            # An uplift at the end of the piece belongs to the next piece.
            if phase is not None and phase / self.omega < end:
                lifts.append((max(self.time, phase / self.omega), side))
        self.time, self.side = min(lifts, default=(end, 0))
        self.here, self.theta, self.w = self.edges[self.side or 1], 0.0, 0.0

    def move(self, piece: Piece, end: float) -> None:
        """Move the body over one span of time, or to the impact in it."""
        start = StatePoint(self.time, self.theta, self.w)
        flow = self._flow(piece)
        rate = flow.rate
        fastest = max((h.frequency for h in piece.harmonics), default=0.0)
        span = 0.5 / (1.0 + self.omega * fastest)
        if self.solver is not path:
            span = _SCRIPT_SPAN
        stop = min(end, self.time + span)
        limit = self.here.limit * (1.0 + 1e-9)  # surely beyond it
        found = self.solver(flow, start, stop, limit)
        peaks, there, hits, steps = self.cut(flow, found)
        self.check_contact(flow, steps)
        for peak in peaks:
            speed, force = rate(*peak)
            height = (peak.theta - 0.5 * speed * peak.w / force) / self.here.alpha
            self.peak, self.turns = max(self.peak, height), self.turns + 1
        if hits:
            self._land(piece, there, rate, math.nextafter(start.time, math.inf))
        else:
            self.time, self.theta, self.w = there

    def _flow(self, piece: Piece) -> EdgeMotion:
        """The equation on this side under a piece of the motion."""
        of, push = self.here.of, self.side * self.drive

        def rate(t: float, theta: float, w: float) -> tuple[float, float]:
            return (
                of(theta, w, push * value(piece, self.omega * t), self.weight(t))
                if piece is not _STILL
                else of(theta, w, 0.0, 1.0)
            )

        return EdgeMotion(rate, self.here.alpha)

    def _land(
        self, piece: Piece, there: StatePoint, rate: Slopes, earliest: float
    ) -> None:
        """Apply the impact next to the instant `there`, not before `earliest`; a body
        that is too slow to bounce rests.
        """
        # A tangent step to the impact.
        speed, force = rate(*there)
        miss, eta = -there.theta / speed if speed < 0.0 else 0.0, self.here.eta
        self.time, self.bounced = max(there.time, earliest) + miss, True
        self.turns = 0
        self.side = -self.side if -self.side in self.edges else self.side
        self.here, self.theta = self.edges[self.side], 0.0
        self.w = -eta * (there.w + miss * force)
        push = self.drive * value(piece, self.omega * self.time)
        weight = self.weight(self.time)
        # Under a weight that varies the edge lifts by so much more or less.
        lifted = any(
            -side * push - edge.uplift >= self.problem.edges[side].uplift * (weight - 1)
            for side, edge in self.edges.items()
        )
        if self.w <= 0.0 or (self.w < _AT_REST and not lifted and eta < 1.0):
            self.side, self.w = 0, 0.0

    def check_contact(self, flow: EdgeMotion, steps: list[StatePoint]) -> None:
        """Record in `contact_lost` if Fz falls to zero along these steps of a body
        whose forces are known; such a body has theta' = w.
        """
        alpha, rise = self.here.alpha, self.here.rise
        if rise is None or self.contact_lost:
            return

        def acceleration_and_fz(at: StatePoint) -> tuple[float, float]:
            acceleration, z = flow.rate(*at)[1], alpha - at.theta
            return acceleration, self.pressure(at) + rise * (
                acceleration * math.sin(z) - at.w * at.w * math.cos(z)
            )

        after = acceleration_and_fz(steps[0])
        for one, other in pairwise(steps):
            before = after
            after = acceleration_and_fz(other)
            length = other.time - one.time
            # The state halfway, by Hermite interpolation, for a third value of Fz.
            theta, w = 0.5 * (one.theta + other.theta), 0.5 * (one.w + other.w)
            theta = theta + 0.125 * length * (one.w - other.w)
            w = w + 0.125 * length * (before[0] - after[0])
            middle = acceleration_and_fz(StatePoint(one.time + 0.5 * length, theta, w))

            def within(
                part: float, one: StatePoint = one, length: float = length
            ) -> float:
                at = flow.step(one, part * length) or one
                return acceleration_and_fz(at)[1]

            self.contact_lost = self.contact_lost or falls_to_zero(
                (before[1], middle[1], after[1]), within
            )

    def cannot_return(self) -> bool:
        """True if the body moves outwards where the strongest inward ground
        acceleration does not pull it in, and w > 0 always.
        """
        return (
            self.least > 0.0 < self.w
            and self.here.of(
                self.theta, self.w, self.drive * self.motion.largest, self.least
            )[1]
            > 0.0
        )

    def falls_on_still_ground(self) -> bool:
        return self.theta > self.here.alpha and self.w >= 0.0

    def overturned(self) -> Outcome:
        return (
            Outcome.OVERTURNED_AFTER_IMPACT
            if self.bounced
            else Outcome.OVERTURNED_NO_IMPACT
        )

    def still(self) -> tuple[Outcome, float]:
        """After the shaking: march over still ground until the outcome is certain;
        returns (outcome, max |theta|/alpha).
        """
        self.impacts, self.up, self.turns = 0, None, 0
        for _ in range(_MOST):
            if self.side == 0 or self.impacts > 2:
                return (
                    Outcome.ROCKED if self.peak > 0.0 else Outcome.NO_UPLIFT
                ), self.peak
            if self.turns > 1:  # it turned outwards between two peaks
                return Outcome.LEANING, self.peak
            if self.falls_on_still_ground():
                return self.overturned(), math.nan
            before, bounced, self.bounced = self.time, self.bounced, False
            self.move(_STILL, math.inf)
            self.follow()
            self.impacts += self.bounced
            self.bounced |= bounced
            if not self.time > before:
                break
        return Outcome.FAILED, math.nan
