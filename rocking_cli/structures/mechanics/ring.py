"""The ring of an arch, and its four-hinge mechanism (Fig. 5); per unit width and unit
density.

A position along the arch is an angle s [rad] from the left springing. The links are the
sectors between the hinges A, B, C, D, which lie on the intrados, extrados, intrados,
extrados. Link A-B turns by phi, clockwise, and the linkage sways to the right (+x). The
parts outside A and D do not move.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from ...arrays import Array
from ..sketch import Outline
from .assembly import GROUND, Assembly, Face, Hinge, PlanarBody, Rigid, mirror_image
from .kinematics import Coefficients
from .linkage import Linkage
from .moments import Moments

INTRADOS, EXTRADOS = "intrados", "extrados"
FACES = (INTRADOS, EXTRADOS, INTRADOS, EXTRADOS)
_SAME = 1e-12  # rad: sections that are closer are one


class Ring(NamedTuple):
    """The ring of an arch."""

    radius: float  # r of the centre line [m]
    thickness: float  # t [m]
    angle: float  # beta, the inclusion angle [rad]

    def point(self, s: Any, face: str) -> tuple[Any, Any]:
        """Return (x, z) [m], from the centre of the ring, of the point on a face at the
        angle s.
        """
        rho = self.radius + (0.5 if face == EXTRADOS else -0.5) * self.thickness
        polar = 0.5 * np.pi + 0.5 * self.angle - s
        return rho * np.cos(polar), rho * np.sin(polar)

    def sector(self, start: Any, stop: Any) -> Moments:
        """Return the moments of the sector between two angles, in closed form."""
        r, t = self.radius, self.thickness
        a, b = (0.5 * np.pi + 0.5 * self.angle - s for s in (start, stop))
        lever = r * r * t + t**3 / 12.0  # (r_o^3 - r_i^3) / 3
        spread = stop - start
        return Moments(
            r * t * spread,
            lever * (np.sin(a) - np.sin(b)),
            lever * (np.cos(b) - np.cos(a)),
            r * t * (r * r + 0.25 * t * t) * spread,
        )

    def body(self, name: str, start: float, stop: float) -> PlanarBody:
        """Return the sector between two angles; arcs of its outline are polygons."""
        part = self.sector(start, stop)
        along = np.linspace(start, stop, max(2, math.ceil((stop - start) / 0.03)) + 1)
        inner, outer = self.point(along, INTRADOS), self.point(along[::-1], EXTRADOS)
        outline: Outline = tuple(
            (float(a), float(b)) for a, b in np.concatenate([inner, outer], axis=1).T
        )
        return PlanarBody.of(name, part, outline)


@dataclass(frozen=True, kw_only=True)
class ArchLinkage(Linkage):
    """The four-hinge mechanism of an arch that sways to the right."""

    ring: Ring  # of the arch
    angles: tuple[float, ...]  # of the hinges A, B, C, D [rad], rising
    # number of voussoirs, None for a continuous arch; no effect on the mechanism
    voussoirs: int | None = field(default=None, compare=False)

    @cached_property
    def faces(self) -> list[Face]:
        """None: `RingForces` has the forces on its joints."""
        return []

    @property
    def swaying(self) -> tuple[Array, Coefficients]:
        """The clockwise rotations of the links at rest, (3,), and M, V'/g and B, for a
        clockwise rotation of link A-B.
        """
        rest = self.at_rest_turning(-1.0)
        at = self._coefficients(rest)
        return -rest.rate[0], Coefficients(*(float(x[0]) for x in at))

    @property
    def mirrored(self) -> Linkage:
        """The mechanism that sways to the left, of the same bodies."""
        names = self.assembly.names
        image = {GROUND: GROUND} | dict(zip(names, reversed(names), strict=True))
        joints = mirror_image(self.joints, image, 0.0)
        return replace(self, joints=joints, coordinate=image[self.turning])


def arch_linkage(
    ring: Ring,
    angles: Sequence[float],
    voussoirs: int | None = None,
    *,
    images: bool = True,
) -> ArchLinkage:
    """Return the mechanism of an arch with these hinges [rad]. Its bodies are the
    voussoirs, or the sectors between the hinges; images: True if the mirror images of
    the hinges part bodies too. The first body of each hinge is that beyond it.
    """
    joints = np.linspace(0.0, ring.angle, (voussoirs or 1) + 1)
    hinges_at = np.append(angles, np.subtract(ring.angle, angles) if images else [])
    near = np.abs(np.subtract.outer(hinges_at, joints)).min(axis=1)
    sections = np.sort(np.append(joints, hinges_at[near > _SAME]))
    sections = sections[np.append(True, np.diff(sections) > _SAME)]
    bodies = tuple(
        ring.body(f"v{i}", float(start), float(stop))
        for i, (start, stop) in enumerate(pairwise(sections), 1)
    )
    names = [body.name for body in bodies]
    at = [int(np.abs(sections - s).argmin()) for s in angles]
    hinges = []
    for i, s, face in zip(at, angles, FACES, strict=True):
        x, z = ring.point(s, face)
        bodies_there = ([*names, GROUND][i], [GROUND, *names][i])
        hinges.append(Hinge(bodies_there, (float(x), float(z))))
    links = [tuple(names[i:j]) for i, j in pairwise(at)]
    links.append((GROUND, *names[: at[0]], *names[at[-1] :]))
    return ArchLinkage(
        Assembly(bodies),
        (*hinges, *(Rigid(link) for link in links if len(link) > 1)),
        links[0][0],
        ring=ring,
        angles=tuple(angles),
        voussoirs=voussoirs,
    )
