"""Forces along a history, in columns, and their extremes in time. The structure gives
the forces at instants of one side.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Array
from ..dynamics.equations.equation import Equation
from ..dynamics.equations.taylor import Instant
from ..motions.blocks import blocks
from ..structures.mechanics.measured import Measured
from ..structures.parameters import RockingParameters
from .arcs import FREE, Event, History, Resultant
from .chebyshev import extent
from .ground_history import GroundMotion

_INSTANTS = 0.5 * (1.0 - np.cos(np.linspace(0.0, np.pi, 17)))  # of an arc
_INSIDE = 0.5 * (1.0 - np.cos(np.linspace(0.0, np.pi, 25)))[1:-1]
_TOGETHER = 256  # arcs
_ROWS = 4096  # instants
# rotation [rad] beyond which no forces are computed: the body has left the ground
_FAR = 100.0


class Worst(NamedTuple):
    """The extreme of a quantity over the joints of both sides and time."""

    value: float  # [-]
    tau: float  # its time [-]
    side: float  # the side that moves, +1 right or -1 left
    place: int  # number of the joint or hinge


class Instants(NamedTuple):
    """Instants of a structure on one side."""

    side: float  # +1 or -1
    equation: Equation  # of motion, on the side of each instant
    point: Instant  # y and its derivatives in the unit of the side
    across: Array  # xg''/g, (n,)
    up: Array  # zg''/g, (n,)
    pull: Resultant  # of ties and a tendon, (n,) each


@dataclass(frozen=True)
class ForceHistory:
    """The forces of one response, at the joints of a mechanism; `ContactForces` adds
    what is known of a rigid body alone.
    """

    structure: RockingParameters  # the one that rocks
    ground: GroundMotion  # motion and amplitude
    found: History  # the response
    # of each side, +1 right and -1 left: gives the forces at `Instants`
    statics: Mapping[float, Any]

    def forces_at(self, arc: Array, tau: Array) -> Measured:
        """Return the forces at times tau; arc: the index of the arc of each time, all
        on one side. The values of an arc hold at both of its ends.
        """
        arcs = self.found.arcs
        sides = arcs.side[arc]
        middle = 0.5 * (arcs.start[arc] + arcs.stop[arc])
        point, held = arcs.points(arc, tau), self.found.device_forces
        at = Instants(
            float(sides[0]),
            self.found.equation.on(sides),
            point,
            *self.ground.during(middle, tau),
            FREE if held is None else held.pull(middle, point.y),
        )
        return self.statics[at.side].forces_at(at)

    def at_rest(self, tau: Array) -> dict[str, Array]:
        """Return the columns of a structure at rest, NaN for a mechanism, which is then
        statically indeterminate.
        """
        one, other = (self.statics[side].joints.names for side in (1.0, -1.0))
        names = one + other if len(one) >= len(other) else other + one
        return {name: np.full(tau.shape, np.nan) for name in names}

    def columns(self, tau: Array) -> dict[str, Array]:
        """Return arrays by column at times tau: of a rigid body the forces of the
        ground, of a mechanism what `JointForces` or `RingForces` measures. At an impact
        or a jump the values are those after it, after the end NaN.
        """
        arcs, found = self.found.arcs, self.at_rest(tau)
        moving, arc = arcs.at(tau)
        for side in (1.0, -1.0):
            here = np.flatnonzero(arcs.side[arc] == side)
            for part in blocks(here.size, _ROWS):
                inside, on = moving[here[part]], arc[here[part]]
                now = np.minimum(tau[inside], arcs.stop[on])
                for name, values in self.forces_at(on, now).columns.items():
                    found[name][inside] = values
        for values in found.values():
            values[tau > self.found.end] = np.nan
        return found

    @cached_property
    def bounds(self) -> tuple[Array, dict[str, Array]]:
        """(indices of arcs, upper bounds of each quantity on them, (arcs, places)): the
        largest of 17 instants, raised by 5 % of their range. Arcs that begin beyond the
        rotation `_FAR` are left out.
        """
        s, arcs = self.structure, self.found.arcs
        turned = self.found.equation.on(arcs.side).rotation(arcs.flow.terms[0])
        known = (arcs.stop > arcs.start) & (s.alpha_on(arcs.side) * turned < _FAR)
        order, found = list[Array](), dict[str, list[Array]]()
        for side in (1.0, -1.0):
            here = np.flatnonzero(known & (arcs.side == side))
            for part in blocks(here.size, _TOGETHER):
                arc = here[part]
                span = (arcs.stop - arcs.start)[arc, None]
                tau = arcs.start[arc, None] + span * _INSTANTS
                measured = self.forces_at(
                    np.repeat(arc, _INSTANTS.size), tau.ravel()
                ).measures
                order.append(arc)
                for name, values in measured.items():
                    found.setdefault(name, []).append(
                        _raised(values.reshape(*tau.shape, -1))
                    )
        if not order:
            return np.zeros(0, dtype=np.int64), {}
        return np.concatenate(order), {
            name: _joined(parts) for name, parts in found.items()
        }

    def along(
        self, arc: int, of: Callable[[Measured], Array]
    ) -> tuple[Callable[[Array], Array], float, float]:
        """Return (f(tau), start, stop) of one arc, where f is the function `of` of the
        forces at tau.
        """
        arcs = self.found.arcs
        return (
            lambda tau: of(self.forces_at(np.full(tau.size, arc), tau)),
            float(arcs.start[arc]),
            float(arcs.stop[arc]),
        )

    def _worst(self, name: str) -> Worst | None:
        """Return the extreme of a quantity. Arcs and places go by their upper bound,
        until it is below the largest value found; of equal values the first counts.
        """
        arcs, bounds = self.bounds
        if name not in bounds or not bounds[name].size:
            return None
        bound, best = bounds[name], (-math.inf, 0, 0, 0.0)
        for at in np.argsort(-bound, axis=None, kind="stable").tolist():
            row, k = divmod(at, bound.shape[1])
            if bound[row, k] < best[0] or bound[row, k] == -math.inf:
                break

            def values(forces: Measured, k: int = k) -> Array:
                return forces.measures[name][:, k]

            arc = int(arcs[row])
            _, _, most, tau = extent(*self.along(arc, values))
            best = max(best, (most, -arc, -k, tau))
        most, arc, k, tau = best
        side = float(self.found.arcs.side[-arc])
        value = -most if name == "thrust_min" else most
        return Worst(value, tau, side, self.statics[side].joints.places(name)[-k])

    @cached_property
    def extremes(self) -> Any:
        """The extreme of each quantity by name; empty if nothing moved, or without a
        joint whose forces are known.

        thrust_min: least N over the weight; friction: largest |T|/N; of an arch also
        eccentricity: largest |M|/(N t/2) away from the hinges, and hinge_force: largest
        force at a hinge over the weight.
        """
        found = {name: self._worst(name) for name in self.statics[1.0].joints.SHOWN}
        return {name: worst for name, worst in found.items() if worst is not None}

    def opens(self) -> bool | None:
        """True if another mechanism follows: a further hinge of an arch opens, a hinge
        loses its compression, or a load leaves its body, at one of 23 instants inside
        each arc. None if that is not known of every hinge.
        """
        starts, stops, *_ = self.found.arcs
        tau = (starts + np.multiply.outer(_INSIDE, stops - starts)).ravel()
        if np.any(self.statics[1.0].joints.opened(self.columns(tau))):
            return True
        return False if all(x.joints.complete for x in self.statics.values()) else None

    def summary(self, when: str, time: float) -> dict[str, Any]:
        """Return the extremes as a row; `when`: suffix of the columns of times, `time`:
        the factor from tau to their unit.
        """
        found, row = self.extremes, dict[str, Any]()
        for name, (column, places) in self.statics[1.0].joints.SHOWN.items():
            worst = found.get(name)
            known = worst is not None and np.isfinite(worst.value)
            row[column] = worst.value if known else None
            for place in places:
                row[f"{name}_{place}"] = None if worst is None else _place(worst, place)
            row[f"{name}_{when}"] = None if worst is None else worst.tau * time
        values = {name: worst.value for name, worst in found.items()}
        lifted = bool(found) and bool(self.statics[1.0].joints.opened(values))
        row["opens"] = lifted or self.opens()
        if (limit := self.structure.friction) is not None:
            row["slides"] = "friction" in found and found["friction"].value > limit
        return row

    def event(self, event: Event, _: float) -> dict[str, float | None]:
        """Return the columns just after an event."""
        return {
            name: float(x[0]) if np.isfinite(x[0]) else None
            for name, x in self.columns(np.array([event.tau])).items()
        }


def _raised(values: Array) -> Array:
    """Return upper bounds of a function from its values, (arcs, instants, places)."""
    most, least = values.max(axis=1), values.min(axis=1)
    with np.errstate(invalid="ignore"):
        raised = most + 0.05 * (most - least)
    raised = np.where(np.isfinite(raised), raised, np.inf)
    return np.where(most == -np.inf, most, raised)


def _joined(parts: list[Array]) -> Array:
    """Return the rows of both sides, which may have other numbers of joints."""
    most = max(part.shape[1] for part in parts)
    return np.concatenate(
        [
            np.pad(x, ((0, 0), (0, most - x.shape[1])), constant_values=-np.inf)
            for x in parts
        ]
    )


def _place(worst: Worst, place: str) -> str | int:
    if place == "side":
        return "right" if worst.side > 0.0 else "left"
    return worst.place
