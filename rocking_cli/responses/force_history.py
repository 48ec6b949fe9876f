"""The forces between a rigid body and the ground: along a history, at their extremes, and as impulses at impacts.

With s = sgn theta, phi = alpha - |theta|, R from the edge to the mass centre and kappa = R p^2/g = m R^2/I,

    Fx/(m g) = xg''/g + kappa (s u'' cos phi + s u'^2 sin phi)
    Fz/(m g) = 1 + zg''/g + kappa (u'' sin phi - u'^2 cos phi),   u = |theta| [rad], ' = d/d(p t)

under any equation of motion: they move the mass centre as in the response. At rest they are xg''/g and 1 + zg''/g. The
base needs a coefficient of friction of max |Fx|/Fz, and Fz > 0 throughout. On passing from edge to edge the ground gives the impulses

    Jx = s m R cos(alpha) w (1 - eta),   Jz = m w (R sin(alpha) + eta R' sin(alpha')),   w = |theta'| before

the primes those of the other edge; their ratio is the friction that the impact needs.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any, NamedTuple

import numpy as np

from ..dynamics.body import FAR
from ..dynamics.outcome import Outcome
from ..errors import UsageError
from ..motions.blocks import blocks
from ..structures.parameters import RockingParameters, Side
from .chebyshev import Extent, extent, first_below
from .ground_history import Ground
from .history import LATE, Event, History

Array = np.ndarray

_INSTANTS = 0.5 * (1.0 - np.cos(np.linspace(0.0, np.pi, 17)))  # of an arc
_TOGETHER = 4096  # arcs


class Forces(NamedTuple):
    """Horizontal (towards +x) and vertical force of the ground on the body, over its weight m g [-]."""

    fx: Any
    fz: Any


class Impulses(NamedTuple):
    """Impulses of the ground on the body at an impact over m g, times p [-]: divided by p they are in s."""

    jx: float
    jz: float

    @property
    def friction(self) -> float:
        """|Jx|/Jz: the coefficient of friction with which the base does not slide in the impact."""
        return abs(self.jx) / self.jz if self.jz > 0.0 else math.inf


class Demand(NamedTuple):
    """A required coefficient of friction [-] and when [tau]."""

    friction: float
    tau: float


@dataclass(frozen=True)
class Demands:
    """The ground forces that a response needs.

    resting: the largest demand while at rest, up to the uplift; lifting: that in the first instant after the first uplift, which where the
    drive jumps is Shenton's boundary; rocking: the largest while it rocks, impact: of the impulses. Each is None where there was none.
    fz_min: least Fz over m g [-], and fz_min_tau when. A demand is infinite where Fz <= 0.
    """

    resting: Demand | None
    lifting: Demand | None
    rocking: Demand | None
    impact: Demand | None
    fz_min: float
    fz_min_tau: float

    @property
    def friction(self) -> Demand:
        """The largest demand of the forces, impulses apart."""
        return max((d for d in (self.resting, self.rocking) if d is not None), key=lambda d: d.friction, default=Demand(0.0, 0.0))

    def slides(self, friction: float) -> str | None:
        """When a base of this coefficient of friction first cannot hold: "before rocking" (at rest, or at the instant of the first
        uplift), "rocking" or "impact"; None where it holds throughout."""
        for word, demand in (("before rocking", self.resting), ("before rocking", self.lifting), ("rocking", self.rocking)):
            if demand is not None and demand.friction > friction:
                return word
        return "impact" if self.impact is not None and self.impact.friction > friction else None


def kappa(p: float, arm: float, gravity: float) -> float:
    """R p^2/g = m R^2/I [-] from p [rad/s], R [m] and g [m/s2]: 3/4 for a rectangular block, 1 for a point mass."""
    return arm * p * p / gravity


def body_forces(kappa: Any, alpha: Any, side: Any, u: Array, rate: Array, bend: Array, ground: Array, vertical: Array) -> Forces:
    """Forces over m g on one side, +1 or -1.

    u = |theta| [rad], its first and second derivative by tau = p t of the side, and the ground acceleration xg''/g and zg''/g [-],
    arrays of one shape.

    >>> at_uplift = body_forces(0.75, math.atan(0.2), -1.0, 0.0, 0.0, 0.0, 0.2, 0.0)
    >>> round(at_uplift.fx / at_uplift.fz, 12)  # tan(alpha)
    0.2
    """
    sin, cos = np.sin(alpha - u), np.cos(alpha - u)
    return Forces(
        ground + kappa * side * (bend * cos + rate * rate * sin),
        1.0 + vertical + kappa * (bend * sin - rate * rate * cos),
    )


class Edge(NamedTuple):
    """An edge: alpha [rad], kappa [-], R [m], p [rad/s], eta on leaving it [-]."""

    alpha: float
    kappa: float
    arm: float
    p: float
    eta: float


@dataclass(frozen=True)
class Body:
    """A rigid body on its edges, as its forces need it; p of the edge that lifts first, whose tau a history runs in."""

    right: Edge
    left: Edge
    p: float
    one_sided: bool

    @classmethod
    def of(cls, structure: RockingParameters) -> Body:
        """Raises UsageError if the structure is no rigid body, or if its mass centre is not known."""
        if structure.arm is None:
            raise UsageError(
                f"{structure.name}: forces need one rigid body on its edges, and arm, the distance of its mass centre from them"
            )
        sides: list[Side | RockingParameters] = [*reversed(structure.sides)] or [structure, structure]
        edges = []
        for side in sides:
            if side.arm is None:
                raise UsageError(f"{structure.name}: forces need arm, the distance of the mass centre, of both edges")
            edges.append(Edge(side.alpha, kappa(side.p, side.arm, structure.gravity), side.arm, side.p, side.eta))
        return cls(edges[0], edges[1], structure.p, structure.one_sided)

    def on(self, side: float) -> Edge:
        """The edge of a side, +1 right or -1 left."""
        return self.right if side > 0.0 else self.left

    def impulses(self, event: Event) -> Impulses | None:
        """The impulses of an impact; None of a one-sided body, whose backing bears a part that nobody knows."""
        if self.one_sided:
            return None
        here, there = self.on(event.side), self.on(-event.side)
        w = abs(event.rate) * here.alpha  # by tau of the history
        scale = w * here.kappa * (self.p / here.p) ** 2 / here.arm
        across = here.arm * math.cos(here.alpha) * (1.0 - here.eta)
        return Impulses(
            event.side * scale * across, scale * (here.arm * math.sin(here.alpha) + here.eta * there.arm * math.sin(there.alpha))
        )


@dataclass(frozen=True)
class ForceHistory:
    """The forces of one response of a rigid body."""

    body: Body
    ground: Ground
    found: History

    def at(self, tau: Array) -> Forces:
        """Forces at times tau, arrays of one shape: after an impact or a jump where there is one; NaN after the end."""
        tau = np.asarray(tau, dtype=float)
        fx, fz = self.ground.at(tau)
        fz = 1.0 + fz
        inside, arc = self.found.arcs.at(tau)
        fx[inside], fz[inside] = self.along(arc, np.minimum(tau[inside], self.found.arcs.stop[arc]))
        fx[tau > self.found.end] = fz[tau > self.found.end] = np.nan
        return Forces(fx, fz)

    def columns(self, tau: Array) -> dict[str, Array]:
        """By name at times tau."""
        fx, fz = self.at(tau)
        return {"fx_ratio": fx, "fz_ratio": fz}

    def around(self, tau: float) -> tuple[Forces, Forces]:
        """The forces just before and just after an instant; they differ at impacts and where the ground acceleration jumps."""
        arcs, at = self.found.arcs, np.array([tau])
        before = np.flatnonzero((arcs.start < tau) & (tau <= arcs.stop * LATE))[:1]
        after = np.flatnonzero((arcs.start <= tau * LATE) & (tau < arcs.stop))[:1]
        found = [self.along(arc, np.minimum(at, arcs.stop[arc])) if arc.size else self.at(at) for arc in (before, after)]
        first, then = (Forces(float(f.fx[0]), float(f.fz[0])) for f in found)
        return first, then

    def along(self, arc: Array, tau: Array) -> Forces:
        """The forces at times tau on these arcs, by index, each from end to end its own."""
        arcs = self.found.arcs
        side, start, stop, pace = (x[arc] for x in (arcs.side, arcs.start, arcs.stop, arcs.pace))
        point, equation = arcs.flow.take(arc).at((tau - start) * pace), self.found.equation.on(side)  # of which the rotation is linear in y
        right, left = self.body.right, self.body.left
        alpha, kappa = (np.where(side > 0.0, *pair) for pair in ((right.alpha, left.alpha), (right.kappa, left.kappa)))
        u, rate, bend = (alpha * equation.rotation(x) for x in (point.y, point.v, point.b))
        return body_forces(kappa, alpha, side, u, rate, bend, *self.ground.during(0.5 * (start + stop), tau))

    def _on(self, arc: int) -> Callable[[Array], Forces]:
        """The same as a function of tau on one arc."""
        return lambda tau: self.along(np.full(tau.size, arc), tau)

    @cached_property
    def _bounds(self) -> tuple[Array, Array, Array]:
        """(arcs, by index; the least that Fz and the most that |Fx|/Fz may come to on each): of 17 instants, and a twentieth more than they
        lie apart. A body that begins an arc too far is not looked at."""
        arcs = self.found.arcs
        alpha = np.where(arcs.side > 0.0, self.body.right.alpha, self.body.left.alpha)
        arc = np.flatnonzero((arcs.stop > arcs.start) & (alpha * self.found.equation.on(arcs.side).rotation(arcs.flow.y) < FAR))
        low, high = np.empty(arc.size), np.empty(arc.size)
        for part in blocks(arc.size, _TOGETHER):
            some = arc[part]
            tau = arcs.start[some, None] + (arcs.stop - arcs.start)[some, None] * _INSTANTS
            fx, fz = (x.reshape(tau.shape) for x in self.along(np.repeat(some, _INSTANTS.size), tau.ravel()))
            with np.errstate(all="ignore"):
                friction = np.where(fz > 0.0, np.abs(fx) / fz, np.inf)
                low[part] = fz.min(axis=1) - 0.05 * np.ptp(fz, axis=1)
                high[part] = np.where(low[part] > 0.0, friction.max(axis=1) + 0.05 * np.ptp(friction, axis=1), np.inf)
        return arc, low, high

    def rests(self) -> Iterator[tuple[float, float, float]]:
        """The stretches [tau] in which the body bounces too low to be seen, until it stands still, and stands still."""
        arcs, found = self.found.arcs, self.found
        begins, ends = np.append(0.0, arcs.stop), np.append(arcs.start, found.end)
        still = [event.tau for event in found.events if event.event == "rest"]
        for i in np.flatnonzero(ends > begins * (1.0 + 1e-12)).tolist():
            a, b = float(begins[i]), float(ends[i])
            yield a, next((x for x in still if a <= x <= b), b) if i else a, b

    def _lying(self, low: float, high: float) -> Iterator[tuple[float, Forces]]:
        """The forces of bounces without speed, on each edge, at both ends of a stretch of them, if it is one: one of its instants has its
        extremes."""
        if not high > low * (1.0 + 1e-12):
            return
        across, up = (along(low, high)(np.array([low, high])) for along in (self.ground.along, self.ground.up_along))
        for side in (1.0,) if self.body.one_sided else (1.0, -1.0):
            edge, equation = self.body.on(side), self.found.equation.on(np.full(2, side))
            drive = -side * across / (edge.alpha * equation.uplift_amplitude)
            bend = edge.alpha * equation.rotation(equation.force(np.zeros(2), drive, 1.0 + up))
            found = body_forces(edge.kappa, edge.alpha, side, np.zeros(2), np.zeros(2), bend, across, up)
            yield from ((tau, Forces(float(fx), float(fz))) for tau, fx, fz in zip((low, high), *found, strict=True))

    @cached_property
    def demands(self) -> Demands:
        """The ground forces that the response needs; of a one-sided body at rest without those of its backing."""
        resting: list[Demand] = []
        rocking: list[Demand] = []
        least = (1.0, 0.0)  # Fz/(m g), tau
        for bounces, rests, lifts in self.rests():
            lines = self.ground.lines(rests, lifts) if lifts > rests else None
            if lines is not None:
                stretches: Iterable[tuple[Extent, Extent]] = [lines]
            else:
                stretches = (self._resting(*ends) for ends in self.ground.cut(rests, lifts)) if lifts > rests else ()
            for weight, ratio in stretches:
                least = min(least, (weight.least, weight.at_least))
                resting += self._leaning(ratio) if weight.least > 0.0 else [Demand(math.inf, weight.at_least)]
            for tau, (fx, fz) in self._lying(bounces, rests):
                least = min(least, (fz, tau))
                rocking.append(Demand(abs(fx) / fz if fz > 0.0 else math.inf, tau))
        arcs, lows, highs = self._bounds
        for i in np.argsort(lows, kind="stable").tolist():
            if lows[i] > max(least[0], 0.0):
                break
            arc = int(arcs[i])
            low, at_low, *_ = extent(_vertical(self._on(arc)), *self._ends(arc))
            least = min(least, (low, at_low))
            if low <= 0.0:
                rocking.append(Demand(math.inf, at_low))
        most = max((demand.friction for demand in rocking), default=0.0)
        for i in np.argsort(-highs, kind="stable").tolist():
            if highs[i] < most or math.isinf(most):
                break
            arc = int(arcs[i])
            ratio = extent(_ratio(self._on(arc)), *self._ends(arc))
            rocking.append(max(Demand(-ratio.least, ratio.at_least), Demand(ratio.largest, ratio.at_largest)))
            most = max(most, rocking[-1].friction)
        lifting = [self._after(event) for event in self.found.events if event.event == "uplift"][:1]
        if self.found.outcome == Outcome.LOST_CONTACT:  # from a jump on there may be no weight, and none before it shows that
            least = min(least, (0.0, self.found.end))
            (rocking if lifting else resting).append(Demand(math.inf, self.found.end))
        impacts = [Demand(j.friction, e.tau) for e in self.found.events if e.event == "impact" and (j := self.body.impulses(e))]
        worst = [max(group, default=None) for group in (resting, lifting, rocking, impacts)]
        return Demands(worst[0], worst[1], worst[2], worst[3], *least)

    @cached_property
    def lost(self) -> float | None:
        """The first instant tau at which Fz <= 0; None where the body presses on the ground throughout."""
        if self.demands.fz_min > 0.0:
            return None
        found = [self.demands.fz_min_tau] + [self.found.end] * (self.found.outcome == Outcome.LOST_CONTACT)
        for bounces, rests, _ in self.rests():
            found += [tau for tau, (_, fz) in self._lying(bounces, rests) if fz <= 0.0]
        arcs, lows, _ = self._bounds
        for arc in arcs[lows <= 0.0].tolist():
            low, high = self._ends(arc)
            if low < min(found):
                first = first_below(partial(_pressed, self._on(arc)), low, high, 1.0)
                found += [] if first is None else [first]
        return min(found)

    def _ends(self, arc: int) -> tuple[float, float]:
        return float(self.found.arcs.start[arc]), float(self.found.arcs.stop[arc])

    def _resting(self, start: float, stop: float) -> tuple[Extent, Extent]:
        """The weight over m g, and the push over the weight while there is one, in a stretch at rest in which no piece ends."""
        across, up = self.ground.along(start, stop), self.ground.up_along(start, stop)
        weight = extent(lambda tau: 1.0 + up(tau), start, stop)
        return weight, extent(lambda tau: across(tau) / (1.0 + up(tau)), start, stop) if weight.least > 0.0 else weight

    def _leaning(self, ratio: Extent) -> list[Demand]:
        """The largest demands of either sign of a body at rest, the push over the weight being in this extent."""
        demands = [Demand(max(0.0, -ratio.least), ratio.at_least)]
        if not self.body.one_sided:
            demands.append(Demand(max(0.0, ratio.largest), ratio.at_largest))
        return demands

    def _after(self, uplift: Event) -> Demand:
        """The demand in the first instant after an uplift."""
        arc = np.flatnonzero(self.found.arcs.stop > uplift.tau)[:1]
        if not arc.size:  # the ground falls away in the same instant
            return Demand(math.inf, uplift.tau)
        fx, fz = (float(x[0]) for x in self.along(arc, self.found.arcs.start[arc]))
        return Demand(abs(fx) / fz if fz > 0.0 else math.inf, uplift.tau)


def _vertical(forces: Callable[[Array], Forces]) -> Callable[[Array], Array]:
    return lambda tau: forces(tau).fz


def _pressed(forces: Callable[[Array], Forces], tau: Array) -> Array:
    """1 + Fz/(m g): of a root of Fz, too, the series of this ends."""
    return 1.0 + forces(tau).fz


def _ratio(forces: Callable[[Array], Forces]) -> Callable[[Array], Array]:
    return lambda tau: np.divide(*forces(tau))
