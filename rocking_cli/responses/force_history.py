"""Forces between a rigid body and the ground along a history, their extremes in time,
and the impulses of impacts.

With s = sgn theta, phi = alpha - |theta|, R from the edge to the mass centre and kappa
= R p^2/g = m R^2/I,

    Fx/(m g) = xg''/g + kappa (s u'' cos phi + s u'^2 sin phi)
    Fz/(m g) = 1 + zg''/g + kappa (u'' sin phi - u'^2 cos phi),
    u = |theta| [rad], ' = d/d(p t)

for any equation of motion, since they are the forces that move the mass centre as in
the response. At rest they are xg''/g and 1 + zg''/g. The base needs a coefficient of
friction of max |Fx|/Fz, and Fz > 0 at all times. The impulses of the ground in an
impact are

    Jx = s m R cos(alpha) w (1 - eta),   Jz = m w (R sin(alpha) + eta R' sin(alpha')),
    w = |theta'| before

where R' and alpha' belong to the other edge. Jx/Jz is the friction that the impact
needs.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from ..dynamics.body import ground_reaction
from ..dynamics.outcome import Outcome
from ..errors import UsageError
from ..motions.blocks import blocks
from ..structures.parameters import RockingParameters
from .arcs import LATE, Event, History
from .chebyshev import Extent, extent, first_below
from .ground_history import GroundMotion

Array = np.ndarray

_INSTANTS = 0.5 * (1.0 - np.cos(np.linspace(0.0, np.pi, 17)))  # of an arc
_TOGETHER = 4096  # arcs
# rotation [rad] beyond which no forces are computed: the body has left the ground
_FAR = 100.0


class Forces(NamedTuple):
    """The force of the ground on the body over its weight m g; or its impulse in an
    impact over m g, times p, which is in s when divided by p.
    """

    fx: Any  # horizontal, towards +x [-]
    fz: Any  # vertical [-]

    @property
    def friction(self) -> float:
        """|Fx|/Fz of one instant, or of an impact: the friction with which the base
        does not slide; infinite where Fz <= 0.
        """
        return abs(self.fx) / self.fz if self.fz > 0.0 else math.inf


class RequiredFriction(NamedTuple):
    """A required coefficient of friction [-] and its time [tau]."""

    friction: float  # required coefficient [-], infinite if Fz <= 0
    tau: float  # its time [-]


@dataclass(frozen=True)
class GroundForceExtremes:
    """The friction and the vertical force that a response needs from the ground. A
    friction is None if the response has no such time, and infinite if Fz <= 0.
    """

    resting: RequiredFriction | None  # the largest while the body is at rest
    # just after the first uplift (Shenton's boundary, if the ground acceleration jumps
    # there)
    lifting: RequiredFriction | None
    rocking: RequiredFriction | None  # the largest while the body rocks
    impact: RequiredFriction | None  # the largest of the impulses
    fz_min: float  # least Fz over m g [-]
    fz_min_tau: float  # time of fz_min [tau]

    @property
    def friction(self) -> RequiredFriction:
        """The largest friction that the forces need, impulses apart."""
        return max(
            (d for d in (self.resting, self.rocking) if d is not None),
            key=lambda d: d.friction,
            default=RequiredFriction(0.0, 0.0),
        )

    def slides(self, friction: float) -> str | None:
        """Return when a base with this coefficient of friction slides first: "before
        rocking" (at rest, or at the first uplift), "rocking" or "impact"; None if it
        never slides.
        """
        for word, required in (
            ("before rocking", self.resting),
            ("before rocking", self.lifting),
            ("rocking", self.rocking),
        ):
            if required is not None and required.friction > friction:
                return word
        return (
            "impact"
            if self.impact is not None and self.impact.friction > friction
            else None
        )


def body_forces(
    edge: Any,
    side: Any,
    u: Array,
    rate: Array,
    acceleration: Array,
    ground: Array,
    vertical: Array,
) -> Forces:
    """Return the forces over m g on one side, +1 or -1, whose edge has these numbers: u
    = |theta| [rad], its first and second derivative by tau = p t of the side, and the
    ground acceleration xg''/g and zg''/g [-], arrays of one shape.
    """
    outward, up = ground_reaction(
        edge, u, rate, acceleration, -side * ground, 1.0 + vertical
    )
    return Forces(side * outward, up)


class ForceEdge(NamedTuple):
    """An edge and the body that stands on it."""

    alpha: Any  # critical angle [rad]
    kappa: Any  # R p^2/g = m R^2/I [-]
    arm: float  # R [m]
    p: float  # frequency parameter [rad/s]
    eta: float  # restitution on leaving the edge [-]


def edges_of(structure: RockingParameters) -> tuple[ForceEdge, ForceEdge]:
    """Return the right and the left edge. Raises UsageError if the structure is no
    rigid body, or if its mass centre is not known.
    """
    if structure.arm is None:
        raise UsageError(
            f"{structure.name}: forces need a single rigid body, and `arm`, the"
            " distance from its mass centre to its edges"
        )
    edges = []
    for side in (*reversed(structure.sides),) or (structure, structure):
        if side.arm is None:
            raise UsageError(
                f"{structure.name}: forces need arm, the distance of the mass centre,"
                " of both edges"
            )
        edges.append(
            ForceEdge(
                side.alpha,
                side.arm * side.p * side.p / structure.gravity,
                side.arm,
                side.p,
                side.eta,
            )
        )
    return edges[0], edges[1]


@dataclass(frozen=True)
class ForceHistory:
    """The forces of one response of a rigid body on its edges (right, left)."""

    structure: RockingParameters  # a rigid body whose mass centre is known
    edges: tuple[ForceEdge, ForceEdge]  # right, left
    ground: GroundMotion  # motion and amplitude
    found: History  # the response

    def edge(self, side: float) -> ForceEdge:
        """Return the edge on which the body stands on this side, +1 right
        or -1 left.
        """
        return self.edges[side < 0.0]

    def impulses(self, event: Event) -> Forces | None:
        """Return the impulses of an impact; None for a one-sided body, whose backing
        bears an unknown part of them.
        """
        if self.structure.one_sided:
            return None
        here, there = self.edge(event.side), self.edge(-event.side)
        w = abs(event.rate) * here.alpha  # by tau of the history
        scale = w * here.kappa * (self.structure.p / here.p) ** 2 / here.arm
        across = here.arm * math.cos(here.alpha) * (1.0 - here.eta)
        upwards = here.arm * math.sin(here.alpha) + here.eta * there.arm * math.sin(
            there.alpha
        )
        return Forces(event.side * scale * across, scale * upwards)

    def at(self, tau: Array) -> Forces:
        """Return the forces at times tau, in its shape; at an impact or a jump those
        after it, NaN after the end.
        """
        tau = np.asarray(tau, dtype=float)
        fx, fz = self.ground.at(tau)
        fz = 1.0 + fz
        inside, arc = self.found.arcs.at(tau)
        fx[inside], fz[inside] = self.along(
            arc, np.minimum(tau[inside], self.found.arcs.stop[arc])
        )
        fx[tau > self.found.end] = fz[tau > self.found.end] = np.nan
        return Forces(fx, fz)

    def columns(self, tau: Array) -> dict[str, Array]:
        """Return arrays by column name at times tau."""
        fx, fz = self.at(tau)
        return {"fx_ratio": fx, "fz_ratio": fz}

    def around(self, tau: float) -> tuple[Forces, Forces]:
        """Return the forces just before and just after an instant; they differ at
        impacts and at jumps of the ground acceleration.
        """
        arcs, at = self.found.arcs, np.array([tau])
        before = np.flatnonzero((arcs.start * LATE < tau) & (tau <= arcs.stop * LATE))[
            :1
        ]
        after = np.flatnonzero((arcs.start <= tau * LATE) & (tau * LATE < arcs.stop))[
            :1
        ]
        found = [
            self.along(arc, np.minimum(at, arcs.stop[arc])) if arc.size else self.at(at)
            for arc in (before, after)
        ]
        first, then = (Forces(float(f.fx[0]), float(f.fz[0])) for f in found)
        return first, then

    def along(self, arc: Array, tau: Array) -> Forces:
        """Return the forces at times tau; arc: the index of the arc of each time, whose
        own values hold at both of its ends.
        """
        arcs = self.found.arcs
        side, point = arcs.side[arc], arcs.points(arc, tau)
        equation = self.found.equation.on(side)  # of which the rotation is linear in y
        right, left = self.edges
        alpha, kappa = (
            np.where(side > 0.0, *pair)
            for pair in ((right.alpha, left.alpha), (right.kappa, left.kappa))
        )
        edge = right._replace(alpha=alpha, kappa=kappa)
        u, rate, acceleration = (
            edge.alpha * equation.rotation(x) for x in (point.y, point.v, point.b)
        )
        return body_forces(
            edge,
            side,
            u,
            rate,
            acceleration,
            *self.ground.during(0.5 * (arcs.start[arc] + arcs.stop[arc]), tau),
        )

    def _on(
        self, arc: int, of: Callable[[Forces], Array]
    ) -> tuple[Callable[[Array], Array], float, float]:
        """Return (f(tau), start, stop) of one arc, where f is the function `of` of the
        forces at tau.
        """
        arcs = self.found.arcs
        return (
            lambda tau: of(self.along(np.full(tau.size, arc), tau)),
            float(arcs.start[arc]),
            float(arcs.stop[arc]),
        )

    @cached_property
    def _bounds(self) -> tuple[Array, Array, Array]:
        """(indices of arcs, lower bounds of Fz, upper bounds of |Fx|/Fz) on each arc:
        the extremes of 17 instants, widened by 5 % of their range. Arcs that begin
        beyond the rotation `_FAR` are left out.
        """
        arcs = self.found.arcs
        alpha = np.where(arcs.side > 0.0, self.edges[0].alpha, self.edges[1].alpha)
        arc = np.flatnonzero(
            (arcs.stop > arcs.start)
            & (alpha * self.found.equation.on(arcs.side).rotation(arcs.flow.y) < _FAR)
        )
        low, high = np.empty(arc.size), np.empty(arc.size)
        for part in blocks(arc.size, _TOGETHER):
            some = arc[part]
            tau = (
                arcs.start[some, None]
                + (arcs.stop - arcs.start)[some, None] * _INSTANTS
            )
            fx, fz = (
                x.reshape(tau.shape)
                for x in self.along(np.repeat(some, _INSTANTS.size), tau.ravel())
            )
            with np.errstate(all="ignore"):
                friction = np.where(fz > 0.0, np.abs(fx) / fz, np.inf)
                low[part] = fz.min(axis=1) - 0.05 * np.ptp(fz, axis=1)
                high[part] = np.where(
                    low[part] > 0.0,
                    friction.max(axis=1) + 0.05 * np.ptp(friction, axis=1),
                    np.inf,
                )
        return arc, low, high

    def rests(self) -> Iterator[tuple[float, float, float]]:
        """Yield the intervals between visible arcs as times [tau]: the start, the end
        of invisible bounces, the end of the rest.
        """
        arcs, found = self.found.arcs, self.found
        begins, ends = np.append(0.0, arcs.stop), np.append(arcs.start, found.end)
        still = [event.tau for event in found.events if event.event == "rest"]
        for i in np.flatnonzero(ends > begins * (1.0 + 1e-12)).tolist():
            a, b = float(begins[i]), float(ends[i])
            yield a, next((x for x in still if a <= x <= b), b) if i else a, b

    def _low_bounces(self, low: float, high: float) -> Iterator[tuple[float, Forces]]:
        """Yield (tau, forces) of bounces too low to be seen, with zero speed, on each
        edge at both ends of the interval [low, high]. One of these instants has the
        extremes. Nothing for an empty interval.
        """
        if not high > low * (1.0 + 1e-12):
            return
        across, up = self.ground.during(0.5 * (low + high), np.array([low, high]))
        for side in (1.0,) if self.structure.one_sided else (1.0, -1.0):
            edge, equation = self.edge(side), self.found.equation.on(np.full(2, side))
            drive = -side * across / (edge.alpha * equation.uplift_amplitude)
            acceleration = edge.alpha * equation.rotation(
                equation.force(np.zeros(2), drive, 1.0 + up)
            )
            found = body_forces(
                edge, side, np.zeros(2), np.zeros(2), acceleration, across, up
            )
            yield from (
                (tau, Forces(float(fx), float(fz)))
                for tau, fx, fz in zip((low, high), *found, strict=True)
            )

    @cached_property
    def extremes(self) -> GroundForceExtremes:
        """The extremes of the response; those at rest leave out the forces between a
        one-sided body and its backing.
        """
        resting: list[RequiredFriction] = []
        rocking: list[RequiredFriction] = []
        least = (1.0, 0.0)  # Fz/(m g), tau
        for bounces, rests, lifts in self.rests():
            for weight, ratio in (
                self.ground.extents(rests, lifts) if lifts > rests else ()
            ):
                least = min(least, (weight.least, weight.at_least))
                resting += (
                    self._required_at_rest(ratio)
                    if weight.least > 0.0
                    else [RequiredFriction(math.inf, weight.at_least)]
                )
            for tau, forces in self._low_bounces(bounces, rests):
                least = min(least, (forces.fz, tau))
                rocking.append(RequiredFriction(forces.friction, tau))
        arcs, lows, highs = self._bounds
        for i in np.argsort(lows, kind="stable").tolist():
            if lows[i] > max(least[0], 0.0):
                break
            low, at_low, *_ = extent(*self._on(int(arcs[i]), lambda forces: forces.fz))
            least = min(least, (low, at_low))
            if low <= 0.0:
                rocking.append(RequiredFriction(math.inf, at_low))
        most = max((required.friction for required in rocking), default=0.0)
        for i in np.argsort(-highs, kind="stable").tolist():
            if highs[i] < most or math.isinf(most):
                break
            ratio = extent(
                *self._on(int(arcs[i]), lambda forces: forces.fx / forces.fz)
            )
            rocking.append(
                max(
                    RequiredFriction(-ratio.least, ratio.at_least),
                    RequiredFriction(ratio.largest, ratio.at_largest),
                )
            )
            most = max(most, rocking[-1].friction)
        lifting = [
            self._after(event) for event in self.found.events if event.event == "uplift"
        ][:1]
        if (
            self.found.outcome == Outcome.LOST_CONTACT
        ):  # from a jump on there may be no weight, and none before it shows that
            least = min(least, (0.0, self.found.end))
            (rocking if lifting else resting).append(
                RequiredFriction(math.inf, self.found.end)
            )
        impacts = [
            RequiredFriction(j.friction, e.tau)
            for e in self.found.events
            if e.event == "impact" and (j := self.impulses(e))
        ]
        worst = [
            max(group, default=None) for group in (resting, lifting, rocking, impacts)
        ]
        return GroundForceExtremes(worst[0], worst[1], worst[2], worst[3], *least)

    @cached_property
    def lost(self) -> float | None:
        """The first instant tau with Fz <= 0; None if Fz > 0 at all times."""
        if self.extremes.fz_min > 0.0:
            return None
        found = [self.extremes.fz_min_tau] + [self.found.end] * (
            self.found.outcome == Outcome.LOST_CONTACT
        )
        for bounces, rests, _ in self.rests():
            found += [
                tau for tau, (_, fz) in self._low_bounces(bounces, rests) if fz <= 0.0
            ]
        arcs, lows, _ = self._bounds
        for arc in arcs[lows <= 0.0].tolist():
            raised, low, high = self._on(
                arc, lambda forces: 1.0 + forces.fz
            )  # around 1 its series ends where Fz has a root
            if (
                low < min(found)
                and (first := first_below(raised, low, high, 1.0)) is not None
            ):
                found.append(first)
        return min(found)

    def _required_at_rest(self, ratio: Extent) -> list[RequiredFriction]:
        """Return the largest friction for each sign on a body at rest; ratio: the
        extent of the horizontal force over the weight.
        """
        found = [RequiredFriction(max(0.0, -ratio.least), ratio.at_least)]
        if not self.structure.one_sided:
            found.append(RequiredFriction(max(0.0, ratio.largest), ratio.at_largest))
        return found

    def _after(self, uplift: Event) -> RequiredFriction:
        """Return the friction just after an uplift."""
        arc = np.flatnonzero(self.found.arcs.stop > uplift.tau)[:1]
        if not arc.size:  # the ground falls away in the same instant
            return RequiredFriction(math.inf, uplift.tau)
        fx, fz = (float(x[0]) for x in self.along(arc, self.found.arcs.start[arc]))
        return RequiredFriction(Forces(fx, fz).friction, uplift.tau)

    def event(self, event: Event, time: float) -> dict[str, float | None]:
        """Return the forces before and after an event as columns, with the impulses of
        an impact [s, or in tau if `time` is 1].
        """
        before, after = self.around(event.tau)
        impulses = self.impulses(event) if event.event == "impact" else None
        return {
            "fx_ratio": before.fx,
            "fz_ratio": before.fz,
            "fx_ratio_after": after.fx,
            "fz_ratio_after": after.fz,
            "impulse_x": None if impulses is None else impulses.fx * time,
            "impulse_z": None if impulses is None else impulses.fz * time,
        }

    def summary(self, when: str, time: float) -> dict[str, Any]:
        """Return the extremes as a row; `when`: suffix of the columns of times, `time`:
        the factor from tau to their unit.
        """
        extremes, stated = self.extremes, self.structure.friction
        friction = (
            extremes.friction.friction
            if math.isfinite(extremes.friction.friction)
            else None
        )
        return {
            "friction_needed": friction,
            f"friction_{when}": extremes.friction.tau * time,
            "friction_impact": (
                None
                if extremes.impact is None
                or not math.isfinite(extremes.impact.friction)
                else extremes.impact.friction
            ),
            "fz_min": extremes.fz_min,
            f"fz_min_{when}": extremes.fz_min_tau * time,
            **({} if stated is None else {"slides": extremes.slides(stated)}),
        }

    def words(self) -> str:
        """Return a sentence on the extremes."""
        extremes, s = self.extremes, self.structure
        friction, tau = extremes.friction
        text = (
            f"least Fz {extremes.fz_min:.6g} m g at {extremes.fz_min_tau / s.p:.4g} s"
        )
        if not math.isfinite(friction):
            return f"{text}, so no friction holds the base"
        text += f", required friction {friction:.6g} at {tau / s.p:.4g} s"
        if extremes.impact is not None:
            text += f" ({extremes.impact.friction:.6g} in impacts)"
        if s.friction is None:
            return text
        when = {
            None: "does not slide",
            "impact": "would slide at an impact",
            "rocking": "would slide while rocking",
        }
        words = when.get(extremes.slides(s.friction), "would slide before it rocks")
        return (
            f"{text}: with the friction {s.friction:g} of the document the base {words}"
        )
