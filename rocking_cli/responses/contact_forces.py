"""Forces between a rigid body and the ground along a history, their extremes in time,
and the impulses of impacts, by the formulas of `ground_forces`.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ..arrays import Array
from ..dynamics.outcome import Outcome
from ..structures.mechanics.measured import Measured
from .arcs import FREE, LATE, Event, Resultant
from .chebyshev import Extent, extent
from .force_history import ForceHistory
from .ground_forces import (
    ForceEdge,
    Forces,
    GroundForceExtremes,
    RequiredFriction,
    body_forces,
)


@dataclass(frozen=True)
class ContactForces(ForceHistory):
    """The forces of one response of a rigid body on its edges, with those at rest and
    the impulses of impacts.
    """

    statics: Mapping[float, ForceEdge]

    def impulses(self, event: Event) -> Forces | None:
        """Return the impulses of an impact; None for a one-sided body, whose backing
        bears an unknown part of them.
        """
        if self.structure.one_sided:
            return None
        here, there = self.statics[event.side], self.statics[-event.side]
        w = abs(event.rate) * here.alpha  # by tau of the history
        scale = w * here.kappa * (self.structure.p / here.p) ** 2 / here.arm
        across = here.arm * math.cos(here.alpha) * (1.0 - here.eta)
        upwards = here.arm * math.sin(here.alpha) + here.eta * there.arm * math.sin(
            there.alpha
        )
        return Forces(event.side * scale * across, scale * upwards)

    def at_rest(self, tau: Array) -> dict[str, Array]:
        across, up = self.ground.at(tau)
        held = self.found.device_forces
        pull = FREE if held is None else held.at_ground(tau)
        return {"fx_ratio": across + pull.inward, "fz_ratio": 1.0 + up + pull.down}

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
            self.forces_at(arc, np.minimum(at, arcs.stop[arc])).columns
            if arc.size
            else self.columns(at)
            for arc in (before, after)
        ]
        first, then = (Forces(*(float(x[0]) for x in f.values())) for f in found)
        return first, then

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
        ends = np.array([low, high])
        across, up = self.ground.during(0.5 * (low + high), ends)
        held = self.found.device_forces
        for side in (1.0,) if self.structure.one_sided else (1.0, -1.0):
            edge, equation = (
                self.statics[side],
                self.found.equation.on(np.full(2, side)),
            )
            drive = -side * across / (edge.alpha * equation.uplift_amplitude)
            force, pull = equation.force(np.zeros(2), drive, 1.0 + up), FREE
            if held is not None:
                force = force - held.holds(ends[:1], side)
                pull = held.at_ground(ends[:1], side)
            acceleration = edge.alpha * equation.rotation(force)
            still = np.zeros(2)
            found = body_forces(
                edge, side, still, still, acceleration, across, up, pull
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
        resting, weights = self._at_rest()
        bounces = [
            bounce
            for low, high, _ in self.rests()
            for bounce in self._low_bounces(low, high)
        ]
        rocking = [RequiredFriction(forces.friction, tau) for tau, forces in bounces]
        still = self.at_rest(np.zeros(1))["fz_ratio"] - self.ground.at(np.zeros(1))[1]
        weights += [(float(still[0]), 0.0)]
        weights += [(forces.fz, tau) for tau, forces in bounces]
        least, without_weight = self._least_on_arcs(min(weights))
        rocking += without_weight
        rocking += self._frictions_on_arcs(max(rocking, default=None))
        lifting = [
            self._after(event) for event in self.found.events if event.event == "uplift"
        ][:1]
        falls_freely = self.found.lost == self.found.end
        if self.found.outcome == Outcome.LOST_CONTACT and falls_freely:
            # From a jump on there may be no weight; no instant before it shows that.
            least = min(least, (0.0, self.found.end))
            (rocking if lifting else resting).append(
                RequiredFriction(math.inf, self.found.end)
            )
        impacts = [
            RequiredFriction(impulses.friction, event.tau)
            for event in self.found.events
            if event.event == "impact" and (impulses := self.impulses(event))
        ]
        worst = [
            max(group, default=None) for group in (resting, lifting, rocking, impacts)
        ]
        return GroundForceExtremes(worst[0], worst[1], worst[2], worst[3], *least)

    def _at_rest(self) -> tuple[list[RequiredFriction], list[tuple[float, float]]]:
        """Return (the frictions that the body needs at rest, its least weights as (Fz
        over m g, tau)) of the pieces of the motion.
        """
        frictions: list[RequiredFriction] = []
        weights: list[tuple[float, float]] = []
        held = self.found.device_forces
        for _, rests, lifts in self.rests():
            pull = FREE
            if held is not None:
                pull = Resultant(
                    *(float(x[0]) for x in held.at_ground(np.array([rests])))
                )
            for weight, ratio in (
                self.ground.extents(rests, lifts, *pull) if lifts > rests else ()
            ):
                weights.append((weight.least, weight.at_least))
                frictions += (
                    self._required_at_rest(ratio)
                    if weight.least > 0.0
                    else [RequiredFriction(math.inf, weight.at_least)]
                )
        return frictions, weights

    @property
    def _contact_bounds(self) -> tuple[Array, Array, Array]:
        """(indices of arcs, lower bounds of Fz, upper bounds of |Fx|/Fz) on each."""
        arcs, bounds = self.bounds
        if not arcs.size:
            return arcs, arcs, arcs
        low, high = -bounds["fz_min"][:, 0], bounds["friction"][:, 0]
        return arcs, low, np.where(low > 0.0, high, np.inf)

    def _least_on_arcs(
        self, least: tuple[float, float]
    ) -> tuple[tuple[float, float], list[RequiredFriction]]:
        """Return (the least (Fz, tau) of `least` and the arcs, the infinite frictions
        of the arcs without weight). Arcs go by their lower bound, until it is larger
        than the least Fz that is known.
        """
        arcs, lows, _ = self._contact_bounds
        without_weight: list[RequiredFriction] = []
        for i in np.argsort(lows, kind="stable").tolist():
            if lows[i] > max(least[0], 0.0):
                break
            fz, tau, *_ = extent(*self.along(int(arcs[i]), _fz))
            least = min(least, (fz, tau))
            if fz <= 0.0:
                without_weight.append(RequiredFriction(math.inf, tau))
        return least, without_weight

    def _frictions_on_arcs(
        self, known: RequiredFriction | None
    ) -> Iterator[RequiredFriction]:
        """Yield the largest friction of each arc that may need more than `known`. Arcs
        go by their upper bound, until it is below the largest friction found.
        """
        arcs, _, highs = self._contact_bounds
        most = 0.0 if known is None else known.friction
        for i in np.argsort(-highs, kind="stable").tolist():
            if highs[i] < most or math.isinf(most):
                break
            ratio = extent(
                *self.along(int(arcs[i]), lambda at: at.columns["fx_ratio"] / _fz(at))
            )
            required = max(
                RequiredFriction(-ratio.least, ratio.at_least),
                RequiredFriction(ratio.largest, ratio.at_largest),
            )
            most = max(most, required.friction)
            yield required

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
        first, then = self.forces_at(arc, self.found.arcs.start[arc]).columns.values()
        return RequiredFriction(
            Forces(float(first[0]), float(then[0])).friction, uplift.tau
        )

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


def _fz(at: Measured) -> Array:
    return at.columns["fz_ratio"]
