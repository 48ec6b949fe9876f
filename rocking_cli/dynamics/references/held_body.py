"""Ties and a tendon for the general solver.

The force of a device depends on the rotation, its permanent elongation and the law that
it follows now: slack, elastic, yielding or broken. A law holds for a whole span of
the solver. A span ends where a law changes, which single steps find by bisection.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from ...motions.motion import Motion
from ...structures.restraints import Strand
from .extrapolation import EdgeMotion, Path, StatePoint, passes
from .general_solver import Problem, Rates, ReferenceBody, RockingEdge

if TYPE_CHECKING:
    from ...structures.restraints import Restraints, Tie

_HALVINGS = 60
_YIELDS = 1e-12  # part of the elongation at yield within which a device yields
# rotation over alpha at which a body has overturned under the linear equation
_FAR = 1e6


class _Device:
    """A tie, or the tendon, on one side of a body."""

    def __init__(self, tie: Tie, linear: bool) -> None:
        self.tie, self.linear = tie, linear
        # elongation from the prestress P0 to the yield force F_y
        self.reach = (
            (tie.yield_force - tie.prestress) / tie.stiffness
            if tie.stiffness
            else math.inf
        )
        self.slackens = tie.prestress / tie.stiffness if tie.stiffness else math.inf
        self.permanent, self.law = 0.0, "elastic"

    def elongation(self, u: float) -> float:
        return self.tie.height * u if self.linear else self.tie.elongation(u)

    def moment(self, u: float) -> float:
        return self.force(u) * (self.tie.height if self.linear else self.tie.lever(u))

    def force(self, u: float) -> float:
        if self.law == "yielding":
            return self.tie.yield_force
        return (
            self.tie.prestress
            + self.tie.stiffness * (self.elongation(u) - self.permanent)
            if self.law == "elastic"
            else 0.0
        )

    def at_ground(self) -> float:
        return (
            max(0.0, self.tie.prestress - self.tie.stiffness * self.permanent)
            if self.law != "broken"
            else 0.0
        )

    def holds(self, u: float) -> float:
        """The elongation [m] that is left until the present law ends, negative beyond
        its end.
        """
        e, slack = self.elongation(max(u, 0.0)), self.permanent - self.slackens
        if self.law == "slack":
            return slack - e
        left = math.inf if self.law == "broken" else self.tie.ultimate - e
        return (
            min(left, e - slack, self.permanent + self.reach - e)
            if self.law == "elastic"
            else left
        )

    def follow(self, u: float, w: float) -> None:
        """Choose the law at a rotation and velocity, and keep
        the permanent elongation.
        """
        e = self.elongation(u)
        if self.law == "broken" or e >= self.tie.ultimate:
            self.law = "broken"
            return
        yields = e - self.permanent >= self.reach * (1.0 - _YIELDS)
        self.permanent = max(self.permanent, e - self.reach)
        slack = self.permanent - self.slackens
        taut = e >= slack if w >= 0.0 else e > slack
        self.law = "yielding" if yields and w > 0.0 else "elastic" if taut else "slack"


def _end_of_law(
    devices: list[_Device], flow: EdgeMotion, one: StatePoint, other: StatePoint
) -> StatePoint:
    """The first instant between two states, with no peak between them, at which a law
    of a device has ended.
    """
    # The laws depend on the rotation alone.
    low, high = one.theta, other.theta
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if all(d.holds(middle) >= 0.0 for d in devices):
            low = middle
        else:
            high = middle
    falls = 1.0 if other.theta < one.theta else -1.0
    there = passes(flow, one, other, 1, falls, high)
    # A tangent step to this rotation.
    speed, force = flow.rate(*there)
    miss = (high - there.theta) / speed if speed else 0.0
    time = min(max(there.time + miss, one.time), other.time)
    return StatePoint(time, high, there.w + (time - there.time) * force)


class TiedBody(ReferenceBody):
    """A body with ties and a tendon. paces: for each side, its p over the p of tau = p
    t [-]; arm: R, the distance from the edge to the mass centre [m]; linear: True for
    the linear equation, in which levers do not change.
    """

    def __init__(
        self,
        restraints: Restraints,
        paces: Mapping[int, float],
        arm: float,
        linear: bool,
        motion: Motion,
        problem: Problem,
        *numbers: Any,
    ) -> None:
        super().__init__(motion, problem, *numbers)
        stands = dict(zip((-1, 1), restraints.stands, strict=True))
        self.devices = {
            i: [
                _Device(tie, linear)
                for tie in restraints.on(stands[i].side, stands[i].lever)
            ]
            for i in paces
        }
        self.factors = {i: pace**2 / stands[i].moment for i, pace in paces.items()}
        self.paces, self.arm, self.linear = paces, arm, linear
        self.edges = {
            i: e._replace(of=self._restrained(i, e), limit=self._limit(i, e.alpha))
            for i, e in problem.edges.items()
        }
        self.follow()

    def _restrained(self, side: int, edge: RockingEdge) -> Rates:
        """Return the rates of `edge` with the pull of the devices added."""
        factor, devices = self.factors[side], self.devices[side]

        def rates(
            theta: float, w: float, push: float, weight: float
        ) -> tuple[float, float]:
            speed, force = edge.of(theta, w, push, weight)
            return speed, force - factor * sum(d.moment(theta) for d in devices)

        return rates

    def _limit(self, side: int, alpha: float) -> float:
        """The rotation [rad] from which the body counts as overturned: a tie has lost
        its lever, or the body lies on its side.
        """
        turned = (
            math.atan2(d.tie.height, -min(d.tie.behind, 0.0))
            for d in self.devices[side]
        )
        return _FAR * alpha if self.linear else min(turned, default=0.5 * math.pi)

    def pressure(self, at: StatePoint) -> float:
        """The forces downwards at an instant, over m g: with that of a tendon."""
        force = sum(
            d.force(at.theta)
            for d in self.devices[self.side]
            if isinstance(d.tie, Strand)
        )
        share = self.arm * self.factors[self.side] / self.paces[self.side] ** 2
        return self.weight(at.time) + force * math.cos(0.5 * at.theta) * share

    def cut(self, flow: EdgeMotion, found: Path) -> Path:
        """The part of a path on which no law changes: it ends where one does, or at the
        first peak if a device yields.
        """
        devices, peaks = self.devices[self.side], found.peaks
        passed = [found.steps[0]]
        yields = any(d.law == "yielding" for d in devices)
        for one, other in pairwise(sorted((*found.steps, *peaks))):
            if all(d.holds(other.theta) >= 0.0 for d in devices):
                passed.append(other)
                if yields and other in peaks:
                    return Path([other], other._replace(w=0.0), False, passed)
                continue
            there = _end_of_law(devices, flow, one, other)
            return Path(
                [p for p in peaks if p in passed], there, False, [*passed, there]
            )
        return found

    def follow(self) -> None:
        """Choose the laws of the devices where the body is now, and the drive that
        lifts it from each edge. A tendon breaks on both sides.
        """
        every = [d for devices in self.devices.values() for d in devices]
        whole = sum(d.law != "broken" for d in every)
        for side, devices in self.devices.items():
            at = (self.theta, self.w) if side == self.side else (0.0, 0.0)
            for d in devices:
                d.follow(*at)
        tendons = [d for d in every if isinstance(d.tie, Strand)]
        if any(d.law == "broken" for d in tendons):
            for d in tendons:
                d.law = "broken"
        if sum(d.law != "broken" for d in every) < whole:
            self.turns = self.impacts = 0
        for side, edge in self.problem.edges.items():
            # the restoring acceleration -theta'' by tau that holds the body at rest
            held = self.factors[side] * sum(
                d.at_ground() * d.tie.height for d in self.devices[side]
            )
            lifts = edge.uplift * (1.0 - held / edge.of(0.0, 0.0, 0.0, 1.0)[1])
            self.edges[side] = self.edges[side]._replace(uplift=lifts)
        self.here = self.edges[self.side or 1]

    def cannot_return(self) -> bool:
        return False  # it overturns at the limit of its edge

    def falls_on_still_ground(self) -> bool:
        return self.theta > self.here.limit
