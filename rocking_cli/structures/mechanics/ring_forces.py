"""Forces in an arch that sways: at its four hinges, as at those of any mechanism, and
the resultant on every radial joint.

The balance of the part of a link between its first hinge and a joint gives the thrust
N, the shear T and the moment M about the joint's centre. The assumed mechanism holds
while N > 0 and |M| <= N t/2 on every joint, else another hinge opens, and |T| <= mu N,
else the joint slides.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar, NamedTuple

import numpy as np

from ...arrays import Array
from .joint_forces import JointForce, JointForces, Moving
from .measured import Measured, ratio_of
from .ring import EXTRADOS, INTRADOS, ArchLinkage

_SECTIONS = 180  # radial sections of an arch without voussoirs that are looked at
_RATIOS = ("friction", "eccentricity")


class Resultants(NamedTuple):
    """The resultants on each joint, (n, joints)."""

    thrust: Array  # N, per unit density and width
    shear: Array  # |T|, per unit density and width
    eccentricity: Array  # |M|/(N t/2) [-]


@dataclass(frozen=True)
class _Parts:
    """The parts of an arch, each from a hinge to a joint. Arrays are (joints,)."""

    hinge: Array  # index of the hinge
    link: Array  # index of the link
    mass: Array  # negative for a joint before its hinge
    inertia: Array  # about the mass centre
    normal: Array  # of the joint at rest, complex
    chains: tuple[Array, Array]  # of the mass centres, joints' centres and hinges


@dataclass(frozen=True)
class RingForces(JointForces):
    """The forces in an arch that sways to one side. Hinges have the numbers 1 to 4 from
    the left springing, joints begin with 0 there, whichever way the arch sways.
    """

    linkage: ArchLinkage  # the mechanism that sways to the right
    mirrored: bool = False  # True if it sways to the left

    # by quantity, its column and those of its place
    SHOWN: ClassVar[dict[str, tuple[str, tuple[str, ...]]]] = {
        "friction": ("friction_needed", ("joint",)),
        "thrust_min": ("thrust_min", ("joint",)),
        "eccentricity": ("eccentricity", ("joint",)),
        "hinge_force": ("hinge_force", ("hinge",)),
    }

    @property
    def weight(self) -> float:
        """The weight of the whole arch, per unit density and width."""
        ring = self.linkage.ring
        return self.gravity * ring.radius * ring.thickness * ring.angle

    @cached_property
    def joints(self) -> Array:
        """Angles of the joints from springing A [rad]."""
        count = (self.linkage.voussoirs or _SECTIONS) + 1
        return np.linspace(0.0, self.linkage.ring.angle, count)

    def _parts_to(self, joints: Array) -> _Parts:
        """Return the parts of the arch that end at these joints."""
        ring, hinges = self.linkage.ring, np.array(self.linkage.angles)
        part_of = np.searchsorted(hinges, joints)
        hinge, link = np.maximum(part_of - 1, 0), part_of % 4
        part = ring.sector(hinges[hinge], joints)
        mass = np.where(part.mass == 0.0, 1.0, part.mass)
        x, z = part.x / mass, part.z / mass
        faces = np.array([ring.point(joints, face) for face in (INTRADOS, EXTRADOS)])
        middle = faces.mean(axis=0)
        polar = 0.5 * np.pi + 0.5 * ring.angle - joints
        points = np.array([at for _, at in self.linkage.hinges])[hinge].T
        found = [
            self.linkage.chain(int(at), complex(*place))
            for places in ((x, z), middle, points)
            for at, *place in zip(link, *places, strict=True)
        ]
        chains = np.array([d for d, _ in found]), np.array([t for _, t in found])
        normal = np.sin(polar) - 1j * np.cos(polar)
        return _Parts(hinge, link, part.mass, part.about(x, z), normal, chains)

    def resultants(
        self, moving: Moving, hinges: JointForce, joints: Array
    ) -> Resultants:
        """Return the resultants on joints at these angles from springing A [rad], under
        the forces at the hinges of these instants.
        """
        parts, at = self._parts_to(joints), self.linkage.positions(moving.phi)
        points = self.linkage.motion(at, parts.chains)
        centre, middle, hinge = np.split(points.place, 3, axis=1)
        phi2, rate2 = moving.acceleration[:, None], moving.rate[:, None] ** 2
        gained = (points.rate * phi2 + points.drift * rate2)[:, : joints.size]
        gained += (moving.across + 1j * (moving.up + self.gravity))[:, None]

        # Newton: the force on the joint is the rest of m a = sum of forces.
        inertia = parts.mass * gained
        first = (hinges.hinges @ np.array([1.0, 1j]))[:, parts.hinge]
        force = first - inertia

        # Euler, about the centre of the joint.
        spin = np.zeros((moving.phi.size, len(self.linkage.links)))
        spin[:, 1:] = at.rate * phi2 + at.drift * rate2
        moment = _moment(hinge - middle, first) - _moment(centre - middle, inertia)
        moment -= parts.inertia * spin[:, parts.link]

        normal = self.linkage.turned(at.q)[:, parts.link] * parts.normal
        along = np.conj(normal) * force
        half = 0.5 * self.linkage.ring.thickness
        return Resultants(
            along.real, np.abs(along.imag), np.abs(moment) / (half * along.real)
        )

    @property
    def complete(self) -> bool:
        """True if N and T of all joints are known."""
        return True

    def places(self, name: str) -> tuple[int, ...]:
        """Return the numbers of the hinges or joints of a quantity."""
        first, count = (1, 4) if name == "hinge_force" else (0, self.joints.size)
        numbers = tuple(range(first, first + count))
        return numbers[::-1] if self.mirrored else numbers

    def measured(self, moving: Moving, weight: float) -> Measured:
        """Return the forces at instants: the force of the ground on the links, the
        least N, the largest |T|/N and |M|/(N t/2) away from the hinges, and the
        force at each hinge of the part left of it on the part right of it.
        """
        found = self.during(moving)
        on = self.resultants(moving, found, self.joints)
        near = np.abs(np.subtract.outer(self.joints, self.linkage.angles)).min(axis=1)
        eccentricity = np.where(on.thrust > 0.0, on.eccentricity, np.inf)
        measures = {
            "hinge_force": np.hypot(*found.hinges.T).T / weight,
            "thrust_min": -on.thrust / weight,
            "friction": ratio_of(on.shear, on.thrust),
            "eccentricity": np.where(near < 1e-9, -np.inf, eccentricity),
        }
        # In a mirrored arch the last hinge is the first from the left, and the part
        # before it is the right one.
        hinges = found.hinges / weight
        on_links = hinges[:, 0] - hinges[:, 3]
        if self.mirrored:
            hinges = hinges[:, ::-1] * np.array([1.0, -1.0])
            on_links = on_links * np.array([-1.0, 1.0])
        worst = [measures[name].max(axis=1) for name in ("thrust_min", *_RATIOS)]
        rows = [*on_links.T, -worst[0], *worst[1:], *hinges.reshape(-1, 8).T]
        return Measured(dict(zip(self.names, rows, strict=True)), measures)

    @property
    def names(self) -> list[str]:
        """The columns that are measured."""
        hinges = [f"hinge{n}_{axis}" for n in (1, 2, 3, 4) for axis in ("fx", "fz")]
        worst = ["thrust_min", "shear_ratio", "eccentricity"]
        return ["fx_ratio", "fz_ratio", *worst, *hinges]

    def opened(self, values: Mapping[str, Any]) -> Any:
        """True where a further hinge opens; values: of quantities or columns."""
        return values["eccentricity"] > 1.0 + 1e-9


def _moment(arm: Array, force: Array) -> Array:
    """Return the counterclockwise moment of forces at these arms."""
    return (np.conj(arm) * force).imag
