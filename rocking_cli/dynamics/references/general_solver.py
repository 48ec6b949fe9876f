"""Any equation and contact by a second, slower path, for checking: a Runge-Kutta method on the equation as the paper writes it.

It shares no series, table, window or energy argument with the engine. The state is (theta, w), w = sqrt(M) theta', which takes
the velocity term out of Eq. 3.4; for a rigid body M = 1. Strides are half a radian of the fastest motion, in five steps or
more; impacts and crests are sought where signs change (`extrapolation`). A body has lost contact where the ground falls away from it,
and a rigid one that rocks where its Fz is not positive (`contact_check`).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import TYPE_CHECKING, Protocol

from ...motions.biaxial import plus
from ...motions.motion import Motion
from ...motions.piece import Piece
from ...structures.mechanics.kinematics import Mechanism, linearise
from ..outcome import FALLEN, Outcome
from .contact_check import Arm, arms_of, lets_go
from .extrapolation import Path, Point, Rate, path, step
from .uplift import lies_still, next_uplift

if TYPE_CHECKING:
    from ...structures.parameters import RockingParameters, Side

    Edge = Side | RockingParameters  # what has a p, alpha and a_scale

_MAX_STRIDES, _A_SEGMENT = 5_000, 50  # strides of a cell, and these for each segment of the motion
_SCRIPT_STRIDE = 10.0  # tau between two looks at whether a body is lost, where steps are the solver's own
_AT_REST = 1e-11


class Rates(Protocol):
    """An equation of motion on one side: critical angle alpha [rad], static uplift lambda [-], theta [rad] at which the body has
    overturned whatever comes, and its rates by tau of the reference."""

    @property
    def alpha(self) -> float: ...

    @property
    def uplift(self) -> float: ...

    @property
    def limit(self) -> float: ...

    def __call__(self, theta: float, w: float, push: float, weight: float = 1.0) -> tuple[float, float]:
        """(theta', w') under the inward ground acceleration push [g] and the weight over m g."""


@dataclass(frozen=True)
class LinearRates:
    """Eq. 2.4 or 3.6; pace: p of the side over that of the reference; damping: zeta."""

    alpha: float
    uplift: float
    pace: float = 1.0
    damping: float = 0.0
    limit: float = math.inf

    def __call__(self, theta: float, w: float, push: float, weight: float = 1.0) -> tuple[float, float]:
        """theta - alpha - a_scale push - 2 zeta w; a_scale is alpha over the uplift of this equation."""
        return w, self.pace**2 * (weight * (theta - self.alpha) - self.alpha / self.uplift * push) - 2.0 * self.damping * self.pace * w


@dataclass(frozen=True)
class RigidBodyRates:
    """Eq. 2.3."""

    alpha: float
    pace: float = 1.0
    damping: float = 0.0
    limit: float = 0.5 * math.pi

    @property
    def uplift(self) -> float:
        """tan(alpha) (Eq. 2.2)."""
        return math.tan(self.alpha)

    def __call__(self, theta: float, w: float, push: float, weight: float = 1.0) -> tuple[float, float]:
        """-sin(alpha - theta) - push cos(alpha - theta) - 2 zeta w."""
        z = self.alpha - theta
        return w, self.pace**2 * (-weight * math.sin(z) - push * math.cos(z)) - 2.0 * self.damping * self.pace * w


class MechanismRates:
    """Eq. 3.4, from the mechanism's own coefficients."""

    limit = 0.5 * math.pi

    def __init__(self, mechanism: Mechanism, damping: float = 0.0) -> None:
        form = linearise(mechanism)
        self.mechanism, self.stiffness, self.damping = mechanism, form.stiffness, damping
        self.alpha, self.uplift = form.alpha, form.uplift

    def __call__(self, theta: float, w: float, push: float, weight: float = 1.0) -> tuple[float, float]:
        """w/sqrt(M) and -(L + push B)/sqrt(M), over p^2/g, less 2 zeta w."""
        c = self.mechanism.coefficients(theta)
        root = math.sqrt(c.inertia)
        return w / root, -float(weight * c.lift + push * c.push) / root / self.stiffness - 2.0 * self.damping * w


@dataclass(frozen=True)
class Problem:
    """A structure as general solvers take it.

    right, left: the equation on each edge, right that of theta > 0, left None for a body that is free to the right only; scale:
    ground acceleration of A = 1 [g]; eta: theta' after over before on leaving each edge, None for that of the cell; arms: of a rigid body,
    from the right edge and the left one, None where its forces are not known.
    """

    right: Rates
    left: Rates | None
    scale: float
    eta: tuple[float, float] | None = None
    arms: tuple[Arm, Arm] | None = None


def linear_rates(structure: RockingParameters, edge: Edge, pace: float) -> Rates:
    """Eq. 2.4 or 3.6 of an edge of a structure."""
    return LinearRates(edge.alpha, edge.alpha / edge.a_scale, pace, structure.damping)


def rigid_body_rates(structure: RockingParameters, edge: Edge, pace: float) -> Rates:
    """Eq. 2.3 of an edge of a structure."""
    return RigidBodyRates(edge.alpha, pace, structure.damping)


def mechanism_rates(structure: RockingParameters, edge: Edge, pace: float) -> Rates:
    """Eq. 3.4 of a structure."""
    assert structure.mechanism is not None  # asked only where there is one
    return MechanismRates(structure.mechanism, structure.damping)


def problem_of(structure: RockingParameters, rates: Callable[[RockingParameters, Edge, float], Rates]) -> Problem:
    """A structure with the rates of an equation."""
    scale, arms = structure.alpha / structure.a_scale, arms_of(structure)
    if structure.sides:
        left, right = structure.sides
        there = [rates(structure, side, side.p / structure.p) for side in (right, left)]
        return Problem(there[0], there[1], scale, (right.eta, left.eta), arms)
    one = rates(structure, structure, 1.0)
    return Problem(one, None if structure.one_sided else one, scale, arms=arms)


def solve_cell(
    motion: Motion, amplitude: float, omega: float, eta: float, problem: Problem, solver: Callable[..., Path] = path
) -> tuple[Outcome, float]:
    """(outcome, max |theta|/alpha, NaN where overturned) of one cell; FAILED if it takes too long, or no step is short enough."""
    try:
        return _solved(motion, _Body(problem, float(amplitude), float(omega), eta, solver))
    except ArithmeticError:
        return Outcome.FAILED, math.nan


def _solved(motion: Motion, body: _Body) -> tuple[Outcome, float]:
    most_strides = _MAX_STRIDES + _A_SEGMENT * len(motion.segments)
    if motion.vertical is not None:
        body.least = 1.0 + body.drive * float(motion.vertical.segments.later_min[0])
    for piece, up in zip(motion.pieces, motion.vertical.pieces if motion.vertical else (None,) * len(motion.pieces), strict=True):
        body.up = up
        fall = next_uplift(up, up.start, body.drive, 0.0) if up is not None and body.least <= 0.0 else None
        end = (piece.stop if fall is None else fall[0]) / body.omega
        while end - body.time > 1e-14 * end:
            body.strides += 1
            if body.strides > most_strides:
                return Outcome.FAILED, math.nan
            if body.side == 0:
                body.wait(piece, end)
            else:
                body.move(piece, end)
            if body.theta > body.here.limit or (body.side and body.theta > body.here.alpha and body.lost(motion)):
                return body.overturned(), math.nan
        if fall is not None and body.theta >= FALLEN * body.here.alpha:
            return body.overturned(), math.nan
        if fall is not None:  # a mechanism on its way down may have collapsed before, of which this path knows nothing
            known = body.theta <= body.here.alpha or not isinstance(body.here, MechanismRates)
            return Outcome.LOST_CONTACT if known else Outcome.FAILED, math.nan
    outcome, peak = body.still()
    return (Outcome.LOST_CONTACT, math.nan) if outcome == Outcome.ROCKED and body.let_go else (outcome, peak)


def value(piece: Piece, phase: float) -> float:
    """s(phase) of a piece, in plain numbers."""
    total = piece.constant + piece.slope * (phase - piece.start)
    for h in piece.harmonics:
        total += h.amplitude * math.sin(h.frequency * phase + h.phase)
    return total


class _Body:
    def __init__(self, problem: Problem, amplitude: float, omega: float, eta: float, solver: Callable[..., Path]) -> None:
        self.solver = solver
        self.problem, self.drive, self.omega = problem, amplitude * problem.scale, omega
        self.etas = problem.eta or (abs(eta), abs(eta))
        self.time = self.theta = self.w = self.peak = 0.0
        self.side = self.strides = 0
        self.bounced = self.let_go = False  # let_go: of the ground, on the way
        self.up: Piece | None = None  # the vertical motion of now
        self.least = 1.0  # weight over m g

    def weight(self, time: float) -> float:
        """The weight over m g."""
        return 1.0 if self.up is None else 1.0 + self.drive * value(self.up, self.omega * time)

    @property
    def here(self) -> Rates:
        """The equation on the side that the body is on."""
        return self.problem.right if self.side > 0 or self.problem.left is None else self.problem.left

    def stride(self, piece: Piece) -> float:
        return 0.5 / (1.0 + self.omega * max((h.frequency for h in piece.harmonics), default=0.0))

    def excess(self, piece: Piece, time: float) -> float:
        """How far the ground acceleration exceeds what lifts the body on to the edge that it pushes it to [g]."""
        push = self.drive * value(piece, self.omega * time)
        if push <= 0.0:
            return -push - self.problem.right.uplift * self.weight(time)
        return push - self.problem.left.uplift * self.weight(time) if self.problem.left is not None else -push

    def wait(self, piece: Piece, end: float) -> None:
        """At rest: on to the first instant of uplift, or to the end of the piece."""
        right, left = self.problem.right, self.problem.left
        onto = (self.drive / right.uplift, self.drive / left.uplift if left is not None else 0.0)
        if self.up is None and lies_still(piece, *onto):
            self.time, self.theta, self.w = end, 0.0, 0.0
            return
        if self.up is None:
            lift = next_uplift(piece, self.omega * self.time, *onto)
        else:  # each edge has an effective motion of its own
            found = [next_uplift(plus(piece, self.up.scaled(right.uplift)), self.omega * self.time, onto[0], 0.0)]
            if left is not None:
                found.append(next_uplift(plus(piece, self.up.scaled(-left.uplift)), self.omega * self.time, 0.0, onto[1]))
            lift = min((x for x in found if x is not None), default=None)
        lift = None if lift is None or lift[0] / self.omega >= end else lift  # at the end of the piece the next one decides
        self.time = end if lift is None else max(self.time, lift[0] / self.omega)
        self.side, self.theta, self.w = 0 if lift is None else lift[1], 0.0, 0.0

    def move(self, piece: Piece, end: float) -> None:
        """One stride, or on to the impact in it."""
        here, start, push = self.here, Point(self.time, self.theta, self.w), self.side * self.drive

        def rate(t: float, theta: float, w: float) -> tuple[float, float]:
            return here(theta, w, push * value(piece, self.omega * t), self.weight(t))

        stop = min(end, self.time + (self.stride(piece) if self.solver is path else _SCRIPT_STRIDE))
        crests, there, struck, steps = self.solver(rate, start, stop, here.limit * (1.0 + 1e-9))  # surely beyond it
        self.press(rate, steps)
        for crest in crests:
            speed, force = rate(*crest)
            self.peak = max(self.peak, (crest.theta - 0.5 * speed * crest.w / force) / here.alpha)
        if not struck:
            self.time, self.theta, self.w = there
            return
        speed, force = rate(*there)
        miss = -there.theta / speed if speed < 0.0 else 0.0
        eta = self.etas[0 if self.side > 0 else 1]
        self.time, self.bounced = max(there.time, math.nextafter(start.time, math.inf)) + miss, True
        self.side = self.side if self.problem.left is None else -self.side
        self.theta, self.w = 0.0, -eta * (there.w + miss * force)
        if self.w <= 0.0 or (self.w < _AT_REST and self.excess(piece, self.time) < 0.0 and eta < 1.0):
            self.side, self.w = 0, 0.0

    def press(self, rate: Rate, steps: list[Point]) -> None:
        """Look along these steps for whether the body lets go of the ground, where that is known; theta' is w of such a body."""
        if self.problem.arms is None or self.let_go:
            return
        arm = self.problem.arms[0 if self.side > 0 else 1]

        def pressed(at: Point) -> tuple[float, float]:
            bend = rate(*at)[1]
            return bend, arm.fz(at.theta, at.w, bend, self.weight(at.time))

        def within(start: Point, length: float, part: float) -> float:
            return pressed(step(rate, start, part * length) or start)[1]

        bend, fz = pressed(steps[0])
        for one, other in pairwise(steps):
            before, length = (bend, fz), other.time - one.time
            bend, fz = pressed(other)
            turn, speed = 0.5 * (one.theta + other.theta), 0.5 * (one.w + other.w)
            turn, speed = turn + 0.125 * length * (one.w - other.w), speed + 0.125 * length * (before[0] - bend)
            _, middle = pressed(Point(one.time + 0.5 * length, turn, speed))
            if lets_go((before[1], middle, fz), partial(within, one, length)):
                self.let_go = True
                return

    def lost(self, motion: Motion) -> bool:
        """Moving outwards where no ground acceleration of this motion pushes inwards, and the ground never falls away."""
        return self.least > 0.0 < self.w and self.here(self.theta, self.w, self.drive * motion.peak, self.least)[1] > 0.0

    def overturned(self) -> Outcome:
        return Outcome.OVERTURNED_AFTER_IMPACT if self.bounced else Outcome.OVERTURNED_NO_IMPACT

    def still(self) -> tuple[Outcome, float]:
        """After the shaking: on over still ground, until the fate shows."""
        ground, impacts, self.up = Piece(0.0, math.inf), 0, None
        for _ in range(_MAX_STRIDES):
            if self.side == 0 or impacts > 2:
                return (Outcome.ROCKED if self.peak > 0.0 else Outcome.NO_UPLIFT), self.peak
            if self.theta > self.here.alpha and self.w >= 0.0:
                return self.overturned(), math.nan
            before = self.time
            bounced, self.bounced = self.bounced, False
            self.move(ground, math.inf)
            impacts += self.bounced
            self.bounced |= bounced
            if not self.time > before:
                break
        return Outcome.FAILED, math.nan
