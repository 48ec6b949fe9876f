"""Forces at the joints of a mechanism along its response by Eq. 3.4, and their extremes
in time.

Hinges and sliders have the numbers 1, 2 ... of the joints of the side that moves, in
the order of the document, or from left to right if they were searched.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar, NamedTuple

import numpy as np

from ..errors import UsageError
from ..structures.mechanics.joint_forces import JointForce, JointForces, Moving
from ..structures.mechanics.linkage import Linkage
from ..structures.parameters import RockingParameters, Side
from .arcs import Event, History
from .chebyshev import extent
from .ground_history import GroundMotion

Array = np.ndarray


class WorstHinge(NamedTuple):
    """The extreme of a quantity over hinges and time."""

    value: float  # [-]
    side: str  # the side that moves, right or left
    hinge: int  # number of the hinge
    tau: float  # its time [-]


@dataclass(frozen=True)
class MechanismHistory:
    """The forces of one response of a mechanism by Eq. 3.4. Raises UsageError if they
    are not known: damping has no place in them, and they may not be unique.
    """

    structure: RockingParameters  # a mechanism
    ground: GroundMotion  # motion and amplitude
    found: History  # the response

    lost: ClassVar[None] = None  # contact with the ground, as `ForceHistory` finds it

    def __post_init__(self) -> None:
        if self.structure.damping:
            raise UsageError(
                f"{self.structure.name}: found damping; expected none for the forces at"
                " the joints of a mechanism"
            )
        if not all(forces.unique for forces in self._forces.values()):
            raise UsageError(
                f"{self.structure.name}: the forces at the joints are not unique (more"
                " than two columns)"
            )

    @cached_property
    def _edges(self) -> dict[float, Side | RockingParameters]:
        """The parameters of each side."""
        left, right = self.structure.sides or (self.structure, self.structure)
        return {1.0: right, -1.0: left}

    @cached_property
    def _forces(self) -> dict[float, JointForces]:
        """The forces of each side. A side that is the mirror image of the right one has
        its linkage.
        """
        found = {}
        for side, edge in self._edges.items():
            assert isinstance(edge.mechanism, Linkage)
            found[side] = JointForces(edge.mechanism, self.structure.gravity)
        return found

    @cached_property
    def _weight(self) -> float:
        """The weight of what moves on the right side [N]."""
        linkage = self._forces[1.0].linkage
        return float(linkage.weighed.weight.sum()) * self.structure.gravity

    def _during(self, side: float, arc: Array, tau: Array) -> JointForce:
        """Return the forces at times tau of arcs on a side."""
        arcs, edge, forces = self.found.arcs, self._edges[side], self._forces[side]
        sides, point = arcs.side[arc], arcs.points(arc, tau)
        equation = self.found.equation.on(sides)
        phi = equation.rotation(point.y) * edge.alpha
        rate = equation.rotation_rate(point.y, point.v) * (edge.alpha * edge.p)
        g, way = self.structure.gravity, forces.linkage.direction * side
        middle = 0.5 * (arcs.start[arc] + arcs.stop[arc])
        across, up = (g * x for x in self.ground.during(middle, tau))
        # a side that is the mirror image of the other is computed as this one
        across = way * across
        acceleration = forces.linkage.acceleration(phi, rate, across, up, g)
        return forces.during(Moving(phi, rate, acceleration, across, up))

    def columns(self, tau: Array) -> dict[str, Array]:
        """Return arrays by column name at times tau: the least N and the largest |T|/N
        at the hinges, then N and T of each hinge and the force of each slider, all over
        the weight of what moves; load_min is the least force of a load that is not
        carried, over its weight. Values are NaN at rest, where the bodies are
        statically indeterminate, and after the end.
        """
        found = {name: np.full(tau.shape, np.nan) for name in self._names()}
        moving, arcs = self.found.arcs.at(tau)
        for side in self._forces:
            here = self.found.arcs.side[arcs] == side
            inside, arc = moving[here], arcs[here]
            if not inside.size:
                continue
            stop = self.found.arcs.stop[arc]
            at = self._during(side, arc, np.minimum(tau[inside], stop))
            if known := self._known(side):
                least = at.compression[:, known].min(axis=1)
                found["thrust_min"][inside] = least / self._weight
                found["shear_ratio"][inside] = _ratio(at)[:, known].max(axis=1)
            for i, (n, t) in enumerate(
                zip(at.compression.T, at.shear.T, strict=True), 1
            ):
                found[f"hinge{i}_n"][inside] = n / self._weight
                found[f"hinge{i}_t"][inside] = t / self._weight
            for i, force in enumerate(at.sliders.T, 1):
                found[f"slider{i}"][inside] = force / self._weight
            if at.loads.size:
                found["load_min"][inside] = at.loads.min(axis=1)
        return found

    def _names(self) -> list[str]:
        """The names of the columns."""
        linkages = [forces.linkage for forces in self._forces.values()]
        hinges = max(len(linkage.hinges) for linkage in linkages)
        sliders = max(len(linkage.sliders) for linkage in linkages)
        names = ["thrust_min", "shear_ratio"]
        names += [f"hinge{n}_{x}" for n in range(1, hinges + 1) for x in ("n", "t")]
        names += [f"slider{n}" for n in range(1, sliders + 1)]
        bear = any(linkage.bearings for linkage in linkages)
        return [*names, "load_min"] if bear else names

    def _known(self, side: float) -> list[int]:
        """Indices of the hinges on a known face, whose N and T are known."""
        forces = self._forces[side]
        hinges = enumerate(forces.linkage.hinges)
        return [i for i, hinge in hinges if forces.face_at(hinge) is not None]

    @cached_property
    def extremes(self) -> dict[str, WorstHinge]:
        """The least N over the weight of what moves (thrust_min) and the largest |T|/N
        (friction) over all hinges on known faces and in time; empty if nothing moved.
        """
        worst: dict[str, WorstHinge] = {}
        starts, stops, sides, *_ = self.found.arcs
        for arc in np.flatnonzero(stops > starts).tolist():
            side = float(sides[arc])
            for i in self._known(side):
                for name, sign in (("thrust_min", -1.0), ("friction", 1.0)):

                    def value(
                        tau: Array,
                        arc: int = arc,
                        side: float = side,
                        i: int = i,
                        name: str = name,
                    ) -> Array:
                        at = self._during(side, np.full(tau.size, arc), tau)
                        if name == "friction":
                            return _ratio(at)[:, i]
                        return -at.compression[:, i] / self._weight

                    _, _, most, when = extent(
                        value, float(starts[arc]), float(stops[arc])
                    )
                    if name not in worst or most > sign * worst[name].value:
                        which = "right" if side > 0.0 else "left"
                        worst[name] = WorstHinge(sign * most, which, i + 1, when)
        return worst

    def opens(self) -> bool | None:
        """True if a hinge loses its compression, or a load leaves its body: another
        mechanism follows. None if that is not known of every hinge.
        """
        starts, stops, *_ = self.found.arcs
        share = 0.5 * (1.0 - np.cos(np.linspace(0.0, np.pi, 25)))[1:-1]
        tau = (starts + np.multiply.outer(share, stops - starts)).ravel()
        found = self.columns(tau)
        least = [found[name] for name in ("thrust_min", "load_min") if name in found]
        if any(bool(np.any(values < 0.0)) for values in least):
            return True
        sides = self._forces.items()
        every = all(len(self._known(s)) == len(f.linkage.hinges) for s, f in sides)
        return False if every else None

    def summary(self, when: str, time: float) -> dict[str, Any]:
        """Return the extremes as a row; `when`: suffix of the columns of times, `time`:
        the factor from tau to their unit.
        """
        row = dict[str, Any]()
        for name, column in (("friction", "friction_needed"), ("thrust_min",) * 2):
            value, side, hinge, tau = self.extremes.get(name) or (None,) * 4
            known = value is not None and np.isfinite(value)
            row[column] = value if known else None
            row[f"{name}_side"], row[f"{name}_hinge"] = side, hinge
            row[f"{name}_{when}"] = None if tau is None else tau * time
        friction, thrust = (self.extremes.get(k) for k in ("friction", "thrust_min"))
        lifted = thrust is not None and thrust.value <= 0.0
        row["opens"] = True if lifted else self.opens()
        if self.structure.friction is not None:
            limit = self.structure.friction
            row["slides"] = friction is not None and friction.value > limit
        return row

    def event(self, event: Event, _: float) -> dict[str, float | None]:
        """Return the columns just after an event."""
        return {
            name: float(x[0]) if np.isfinite(x[0]) else None
            for name, x in self.columns(np.array([event.tau])).items()
        }

    def words(self) -> str:
        """Return a sentence on the extreme forces."""
        if not self.found.arcs.start.size:
            return "the mechanism never moved"
        if not self.extremes:
            return "N and T are not known without outlines that touch at the hinges"
        thrust, friction = self.extremes["thrust_min"], self.extremes["friction"]
        text = f"least N {thrust.value:.4g} of the weight at hinge {thrust.hinge}"
        text += f" ({thrust.side}), largest |T|/N {friction.value:.4g} at hinge"
        text += f" {friction.hinge} ({friction.side})"
        if thrust.value <= 0.0:
            text += "; a hinge lifts off, so another mechanism follows"
        limit = self.structure.friction
        if limit is not None:
            slides = "a joint slides" if friction.value > limit else "no joint slides"
            text += f"; with the friction {limit:g} of the document {slides}"
        return text


def _ratio(at: JointForce) -> Array:
    """|T|/N at the hinges, infinite without compression, (n, hinges)."""
    with np.errstate(all="ignore"):
        ratio = np.abs(at.shear) / at.compression
    return np.where(at.compression > 0.0, ratio, np.inf)
