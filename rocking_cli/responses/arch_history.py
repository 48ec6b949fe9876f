"""Forces in an arch along its response by Eq. 3.4, at its four hinges and on its
joints, and their extremes in time.

Hinges have the numbers 1 to 4 from the left springing, whichever way the arch sways;
joints are numbered from the left springing, 0.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar, NamedTuple

import numpy as np

from ..errors import UsageError
from ..motions.blocks import blocks
from ..structures.mechanics.fourbar import FourBar
from ..structures.parameters import RockingParameters
from .arch_forces import ArchForces, Resultants, State
from .arcs import Event, History
from .chebyshev import extent
from .ground_history import GroundMotion

Array = np.ndarray


class Worst(NamedTuple):
    """The extreme of a quantity over joints (or hinges) and time."""

    value: float  # [-]
    joint: int  # number of the joint or hinge
    tau: float  # its time [-]


HINGE_COLUMNS = tuple(f"hinge{n}_{axis}" for n in (1, 2, 3, 4) for axis in ("fx", "fz"))
# instants as parts of an arc, at which the worst joint and hinge are chosen
_INSTANTS = 0.5 * (1.0 - np.cos(np.linspace(0.0, np.pi, 25)))
_SECTIONS = 180  # radial sections of an arch without voussoirs that are looked at
_TOGETHER = 1024  # instants
_COLUMNS = {
    "thrust_min": ("thrust_min", -1.0),
    "shear_ratio": ("friction", 1.0),
    "eccentricity": ("eccentricity", 1.0),
}
_QUANTITIES: dict[str, Callable[[Resultants], Array]] = {
    "thrust_min": lambda r: -r.thrust,
    "friction": lambda r: np.where(r.thrust > 0.0, r.shear / r.thrust, np.inf),
    "eccentricity": lambda r: np.where(r.thrust > 0.0, r.eccentricity, np.inf),
}


@dataclass(frozen=True)
class ArchHistory:
    """The forces of one response of an arch by Eq. 3.4."""

    structure: RockingParameters  # an arch
    ground: GroundMotion  # motion and amplitude
    found: History  # the response

    lost: ClassVar[None] = None  # contact with the ground, as `ForceHistory` finds it

    def __post_init__(self) -> None:
        if self.structure.damping:
            raise UsageError(
                f"{self.structure.name}: found damping; expected none for the forces in"
                " an arch"
            )

    @cached_property
    def forces(self) -> ArchForces:
        """The forces in an arch of this mechanism."""
        # `TimeHistory.forces` builds this object for arches only.
        assert isinstance(self.structure.mechanism, FourBar)
        return ArchForces(self.structure.mechanism, self.structure.gravity)

    @cached_property
    def joints(self) -> Array:
        """Angles of the joints from springing A [rad]."""
        return np.linspace(
            0.0,
            self.forces.mechanism.ring.angle,
            (self.forces.mechanism.voussoirs or _SECTIONS) + 1,
        )

    def state(self, arc: Array, tau: Array) -> State:
        """Return the state of the arch at times tau; arc: the index of the arc of each
        time. A sway to the left is mirrored.
        """
        s, g, arcs = self.structure, self.structure.gravity, self.found.arcs
        side, point = arcs.side[arc], arcs.points(arc, tau)
        equation = self.found.equation.on(side)
        across, up = self.ground.during(0.5 * (arcs.start[arc] + arcs.stop[arc]), tau)
        rate = equation.rotation_rate(point.y, point.v) * (s.alpha * s.p)
        return State(
            equation.rotation(point.y) * s.alpha, rate, side * g * across, g * up
        )

    def columns(self, tau: Array) -> dict[str, Array]:
        """Return arrays by column name at times tau: the force of the ground on the
        links, the least N and the forces at the hinges, all over the arch's weight, the
        largest |T|/N, and the largest |M|/(N t/2) away from the hinges. Values are NaN
        after the end, and at rest, where the arch is statically indeterminate.
        """
        names = ("fx_ratio", "fz_ratio", *_COLUMNS, *HINGE_COLUMNS)
        found = {name: np.full(tau.shape, np.nan) for name in names}
        moving, arcs = self.found.arcs.at(tau)
        for part in blocks(moving.size, _TOGETHER):
            inside, arc = moving[part], arcs[part]
            state = self.state(arc, np.minimum(tau[inside], self.found.arcs.stop[arc]))
            hinges = self.forces.hinges(state).hinges
            joints = self.forces.resultants(state, self.joints)
            side, weight = self.found.arcs.side[arc], self.forces.weight
            on = (hinges[:, 0] - hinges[:, 3]) / weight
            found["fx_ratio"][inside] = side * on[:, 0]
            found["fz_ratio"][inside] = on[:, 1]
            # The forces of the part left of each hinge on the part right of it. In a
            # mirrored arch the last hinge is the first from the left, and the part
            # before it is the right one.
            mirrored = hinges[:, ::-1] * np.array([1.0, -1.0])
            there = (
                np.where(side[:, None, None] > 0.0, hinges, mirrored).reshape(
                    inside.size, -1
                )
                / weight
            )
            for name, values in zip(HINGE_COLUMNS, there.T, strict=True):
                found[name][inside] = values
            for name, (quantity, sign) in _COLUMNS.items():
                found[name][inside] = sign * self._over_joints(quantity, joints).max(
                    axis=1
                )
        return found

    def _over_joints(self, quantity: str, joints: Resultants) -> Array:
        values = _QUANTITIES[quantity](joints)
        if quantity == "eccentricity":
            hinges = (
                np.abs(
                    np.subtract.outer(self.joints, self.forces.mechanism.hinges)
                ).min(axis=1)
                < 1e-9
            )
            values = np.where(hinges, -np.inf, values)
        return values

    def _at_hinges(self, state: State) -> Array:
        """Return the forces at the hinges over the arch's weight, (n, 4)."""
        return np.hypot(*self.forces.hinges(state).hinges.T).T / self.forces.weight

    @cached_property
    def extremes(self) -> dict[str, Worst]:
        """The extreme of each quantity in time; empty if the arch never moved. 25
        instants of each arc choose the joint or hinge.

        thrust_min: least N over the arch's weight; friction: largest |T|/N;
        eccentricity: largest |M|/(N t/2) away from the hinges; hinge_force: largest
        force at a hinge over the arch's weight.
        """
        worst: dict[str, Worst] = {}
        starts, stops, sides, *_ = self.found.arcs
        for arc in np.flatnonzero(stops > starts).tolist():
            start, stop = float(starts[arc]), float(stops[arc])
            state = self.state(
                np.full(_INSTANTS.size, arc), start + (stop - start) * _INSTANTS
            )
            joints = self.forces.resultants(state, self.joints)
            values_of = {
                "hinge_force": self._at_hinges(state),
                **{name: self._over_joints(name, joints) for name in _QUANTITIES},
            }
            for name, values in values_of.items():
                at = int(values.max(axis=0).argmax())

                def value(
                    tau: Array, arc: int = arc, name: str = name, at: int = at
                ) -> Array:
                    now = self.state(np.full(tau.size, arc), tau)
                    if name == "hinge_force":
                        return self._at_hinges(now)[:, at]
                    return _QUANTITIES[name](
                        self.forces.resultants(now, self.joints[at : at + 1])
                    )[:, 0]

                _, _, largest, when = extent(value, start, stop)
                number = at if sides[arc] > 0.0 else values.shape[1] - 1 - at
                if name not in worst or largest > worst[name].value:
                    worst[name] = Worst(largest, number + (name == "hinge_force"), when)
        if "thrust_min" in worst:
            worst["thrust_min"] = worst["thrust_min"]._replace(
                value=-worst["thrust_min"].value
            )
        return worst

    def opens(self) -> bool:
        """True if a further hinge opens at one of 23 instants inside an arc, which is
        quicker than `extremes`.
        """
        starts, stops, *_ = self.found.arcs
        values = self.columns(
            (starts + np.multiply.outer(_INSTANTS[1:-1], stops - starts)).ravel()
        )["eccentricity"]
        return bool(np.any(values > 1.0 + 1e-9))

    def summary(self, when: str, time: float) -> dict[str, Any]:
        """Return the extremes as a row; `when`: suffix of the columns of times, `time`:
        the factor from tau to their unit.
        """
        found, row = self.extremes, dict[str, Any]()
        for name in ("friction", "thrust_min", "eccentricity", "hinge_force"):
            value, place, tau = found.get(name) or (None, None, None)
            column = "friction_needed" if name == "friction" else name
            row[column] = value if value is None or np.isfinite(value) else None
            row[f"{name}_{'hinge' if name == 'hinge_force' else 'joint'}"] = place
            row[f"{name}_{when}"] = None if tau is None else tau * time
        row["opens"] = bool(found) and found["eccentricity"].value > 1.0 + 1e-9
        if self.structure.friction is not None:
            row["slides"] = (
                bool(found) and found["friction"].value > self.structure.friction
            )
        return row

    def event(self, event: Event, _: float) -> dict[str, float | None]:
        """Return the columns just after an event."""
        return {
            name: float(x[0]) if np.isfinite(x[0]) else None
            for name, x in self.columns(np.array([event.tau])).items()
        }

    def words(self) -> str:
        """Return a sentence on the extreme forces."""
        if not self.extremes:
            return "the arch never moved"
        thrust, friction, eccentricity, hinge = (
            self.extremes[k]
            for k in ("thrust_min", "friction", "eccentricity", "hinge_force")
        )
        text = f"least N {thrust.value:.4g} of the weight on joint {thrust.joint}"
        text += f", largest |T|/N {friction.value:.4g} on joint {friction.joint}"
        text += (
            f", largest |M|/(N t/2) {eccentricity.value:.4g} on joint"
            f" {eccentricity.joint}"
        )
        text += (
            ", where a further hinge opens"
            if eccentricity.value > 1.0 + 1e-9
            else ", so no further hinge opens"
        )
        text += (
            f"; largest force at a hinge {hinge.value:.4g} of the weight, at hinge"
            f" {hinge.joint}"
        )
        s = self.structure
        if s.friction is not None:
            slides = (
                "a joint slides" if friction.value > s.friction else "no joint slides"
            )
            text += f"; with the friction {s.friction:g} of the document {slides}"
        return text
