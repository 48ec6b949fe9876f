"""The forces in an arch along its response by Eq. 3.4: at its four hinges and on its joints, and the worst of them.

Hinges are numbered from the left springing, 1 to 4, wherever the mechanism of the moment has them, and joints from it, 0, on.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from ..errors import UsageError
from ..structures.mechanics.fourbar import FourBar
from ..structures.parameters import RockingParameters
from .arch_forces import ArchForces, Resultants, State
from .chebyshev import extent
from .ground_history import Ground
from .history import Arc, Event, History

Array = np.ndarray


class Worst(NamedTuple):
    """The worst of a quantity over joints, or hinges, and time: its value [-], the number of the joint or hinge, and when [tau]."""

    value: float
    joint: int
    tau: float


class JointDemands(NamedTuple):
    """Demands of a response on the joints: the least N over the arch's weight, the largest |T|/N, and the largest |M|/(N t/2) beside the
    hinges; and of the hinges: the largest force over that weight. Each None where the arch never moved."""

    thrust: Worst | None
    friction: Worst | None
    eccentricity: Worst | None
    hinge: Worst | None


HINGE_COLUMNS = tuple(f"hinge{n}_{axis}" for n in (1, 2, 3, 4) for axis in ("fx", "fz"))
_INSTANTS = 0.5 * (1.0 - np.cos(np.linspace(0.0, np.pi, 25)))  # of an arc, at which the worst joint and hinge are chosen
_SECTIONS = 180  # radial sections of an arch without voussoirs that are looked at
_QUANTITIES: dict[str, Callable[[Resultants], Array]] = {
    "thrust": lambda r: -r.thrust,
    "friction": lambda r: np.where(r.thrust > 0.0, r.shear / r.thrust, np.inf),
    "eccentricity": lambda r: np.where(r.thrust > 0.0, r.eccentricity, np.inf),
}


@dataclass(frozen=True)
class ArchHistory:
    """The forces of one response of an arch by Eq. 3.4."""

    structure: RockingParameters
    ground: Ground
    found: History

    def __post_init__(self) -> None:
        if self.structure.damping:
            raise UsageError(f"{self.structure.name}: found damping; expected none for the forces in an arch")

    @cached_property
    def forces(self) -> ArchForces:
        """Of its mechanism."""
        assert isinstance(self.structure.mechanism, FourBar)  # `TimeHistory.arch_forces` builds no other
        return ArchForces(self.structure.mechanism, self.structure.gravity)

    @cached_property
    def joints(self) -> Array:
        """Angles of the joints from springing A [rad]."""
        return np.linspace(0.0, self.forces.mechanism.ring.angle, (self.forces.mechanism.voussoirs or _SECTIONS) + 1)

    def state(self, arc: Arc, tau: Array) -> State:
        """The arch along an arc, mirrored where it sways to the left."""
        side, s, g = np.full(tau.size, arc.side), self.structure, self.structure.gravity
        point = arc.flow.take(np.zeros(tau.size, dtype=np.int64)).at((tau - arc.start) * arc.pace)
        equation = self.found.equation.on(side)
        across, up = self.ground.along(arc.start, arc.stop), self.ground.up_along(arc.start, arc.stop)
        rate = equation.rotation_rate(point.y, point.v) * (s.alpha * s.p)
        return State(equation.rotation(point.y) * s.alpha, rate, arc.side * g * across(tau), g * up(tau))

    def columns(self, tau: Array) -> dict[str, Array]:
        """By name at times tau: force of the ground on the links over the arch's weight, least N over it, largest |T|/N, largest
        |M|/(N t/2) beside the hinges, and the forces at the hinges over that weight; NaN at rest, where the arch is redundant, and after
        the end."""
        names = ("fx_ratio", "fz_ratio", "thrust_min", "shear_ratio", "eccentricity", *HINGE_COLUMNS)
        found = {name: np.full(tau.shape, np.nan) for name in names}
        for arc in self.found.arcs.each():
            inside = np.flatnonzero((tau >= arc.start) & (tau <= min(arc.stop * (1.0 + 1e-14), self.found.end)))
            if not inside.size:
                continue
            state = self.state(arc, np.minimum(tau[inside], arc.stop))
            hinges, joints = self.forces.hinges(state).hinges, self.forces.resultants(state, self.joints)
            on = (hinges[:, 0] - hinges[:, 3]) / self.forces.weight
            found["fx_ratio"][inside], found["fz_ratio"][inside] = arc.side * on[:, 0], on[:, 1]
            there = self._from_the_left(arc, hinges).reshape(inside.size, -1) / self.forces.weight
            for name, values in zip(HINGE_COLUMNS, there.T, strict=True):
                found[name][inside] = values
            for name, quantity, sign in (("thrust_min", "thrust", -1.0), ("shear_ratio", "friction", 1.0), ("eccentricity",) * 2 + (1.0,)):
                found[name][inside] = sign * self._over_joints(quantity, joints).max(axis=1)
        return found

    def _from_the_left(self, arc: Arc, hinges: Array) -> Array:
        """The forces, (n, 4, 2), that what is left of each hinge exerts on what is right of it. Where the arch sways to the left all is
        mirrored: the last hinge comes first, and before it is what is right of it."""
        return hinges if arc.side > 0.0 else hinges[:, ::-1] * np.array([1.0, -1.0])

    def _over_joints(self, quantity: str, joints: Resultants) -> Array:
        values = _QUANTITIES[quantity](joints)
        if quantity == "eccentricity":
            hinges = np.abs(np.subtract.outer(self.joints, self.forces.mechanism.hinges)).min(axis=1) < 1e-9
            values = np.where(hinges, -np.inf, values)
        return values

    @cached_property
    def demands(self) -> JointDemands:
        """Of each quantity the worst joint of every arc, of 25 instants, and the extreme on it, in time."""
        worst: dict[str, Worst] = {}
        for arc in self.found.arcs.each():
            if not arc.stop > arc.start:
                continue
            state = self.state(arc, arc.start + (arc.stop - arc.start) * _INSTANTS)
            joints = self.forces.resultants(state, self.joints)
            hinge = int(np.hypot(*self.forces.hinges(state).hinges.T).max(axis=1).argmax())

            def force(t: Array, arc: Arc = arc, hinge: int = hinge) -> Array:
                return np.hypot(*self.forces.hinges(self.state(arc, t)).hinges[:, hinge].T) / self.forces.weight

            _, _, largest, when = extent(force, arc.start, arc.stop)
            if "hinge" not in worst or largest > worst["hinge"].value:
                worst["hinge"] = Worst(largest, 1 + hinge if arc.side > 0.0 else 4 - hinge, when)
            for quantity in _QUANTITIES:
                joint = int(self._over_joints(quantity, joints).max(axis=0).argmax())
                one = self.joints[joint : joint + 1]

                def value(t: Array, arc: Arc = arc, one: Array = one, quantity: str = quantity) -> Array:
                    return _QUANTITIES[quantity](self.forces.resultants(self.state(arc, t), one))[:, 0]

                _, _, largest, when = extent(value, arc.start, arc.stop)
                number = joint if arc.side > 0.0 else self.joints.size - 1 - joint
                if quantity not in worst or largest > worst[quantity].value:
                    worst[quantity] = Worst(largest, number, when)
        thrust = worst.get("thrust")
        least = None if thrust is None else thrust._replace(value=-thrust.value)
        return JointDemands(least, *(worst.get(name) for name in ("friction", "eccentricity", "hinge")))

    def summary(self, when: str, time: float) -> dict[str, Any]:
        """As a record; `when` names a time, `time` its unit by tau."""
        found = self.demands
        names = {"friction": found.friction, "thrust_min": found.thrust, "eccentricity": found.eccentricity, "hinge_force": found.hinge}
        record: dict[str, Any] = {}
        for name, worst in names.items():
            place = f"{name}_hinge" if name == "hinge_force" else f"{name}_joint"
            record[name] = None if worst is None or not np.isfinite(worst.value) else worst.value
            record[place], record[f"{name}_{when}"] = (None, None) if worst is None else (worst.joint, worst.tau * time)
        opens = found.eccentricity is not None and found.eccentricity.value > 1.0 + 1e-9
        record["opens"] = opens
        if self.structure.friction is not None:
            record["slides"] = found.friction is not None and found.friction.value > self.structure.friction
        return record

    def event(self, event: Event) -> dict[str, Any]:
        """The columns at an event, after it."""
        return {name: float(x[0]) for name, x in self.columns(np.array([event.tau])).items()}

    def words(self) -> str:
        """The worst forces, in a sentence."""
        thrust, friction, eccentricity, hinge = self.demands
        if thrust is None or friction is None or eccentricity is None or hinge is None:
            return "the arch never moved"
        text = f"least N {thrust.value:.4g} of the weight on joint {thrust.joint}"
        text += f", largest |T|/N {friction.value:.4g} on joint {friction.joint}"
        text += f", largest |M|/(N t/2) {eccentricity.value:.4g} on joint {eccentricity.joint}"
        text += ", where a further hinge opens" if eccentricity.value > 1.0 + 1e-9 else ", so no further hinge opens"
        text += f"; largest force at a hinge {hinge.value:.4g} of the weight, at hinge {hinge.joint}"
        s = self.structure
        if s.friction is not None:
            slides = "a joint slides" if friction.value > s.friction else "no joint slides"
            text += f"; with the friction {s.friction:g} of the document {slides}"
        return text
