"""The arch as a four-bar linkage (Fig. 5), at rest and displaced; per unit width and
unit density.

A position along the arch is an angle s [rad] from the left springing. The links are the
sectors between the hinges A, B, C, D, which lie on the intrados, extrados, intrados,
extrados. Link A-B turns by phi, clockwise, and the linkage sways to the right (+x). The
parts outside A and D do not move.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import Any, NamedTuple

import numpy as np

from .kinematics import Coefficients, slope_by_differences
from .moments import Moments, Spin, spin_about

INTRADOS, EXTRADOS = "intrados", "extrados"
FACES = (INTRADOS, EXTRADOS, INTRADOS, EXTRADOS)


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


class LinkRates(NamedTuple):
    """Rotations of links B-C and C-D per rotation of A-B, and the virtual work (Eq.
    3.4).
    """

    second: Any  # rotation of link B-C [-]
    third: Any  # rotation of link C-D [-]
    lift: Any  # V'/g
    push: Any  # B

    @property
    def admissible(self) -> Any:
        """True if the relative rotations alternate in sign, so that each hinge opens on
        the face opposite to it.
        """
        return (self.third > 0.0) & (self.second < 1.0) & (self.second < self.third)


def rates(points: Any, links: Any) -> LinkRates:
    """Return the first-order kinematics of the linkage in any position, from AB + w2 BC
    + w3 CD = 0. points: (x, z) of A, B, C, D; links: (mass, first moment of x, first
    moment of z) of the three links.
    """
    a, b, c, d = points
    one, two, three = links
    ab, bc, cd = ((q[0] - p[0], q[1] - p[1]) for p, q in ((a, b), (b, c), (c, d)))

    # The cross products of AB + w2 BC + w3 CD = 0 with CD and with BC.
    turn = _cross(bc, cd)
    second = -_cross(ab, cd) / turn
    third = _cross(ab, bc) / turn

    # The virtual work of Eq. 3.4: link A-B turns about A, B-C moves with B and turns
    # about it, C-D turns about D. First moments of x give u_z, those of z give u_x.
    x, z = (
        _first_moment(one, axis, a)
        + two[0] * ab[axis]
        + second * _first_moment(two, axis, b)
        + third * _first_moment(three, axis, d)
        for axis in (0, 1)
    )
    return LinkRates(second, third, -x, z)


def _cross(a: Any, b: Any) -> Any:
    """Return a_x b_z - a_z b_x."""
    return a[0] * b[1] - a[1] * b[0]


def _first_moment(link: Any, axis: int, point: Any) -> Any:
    """Return the first moment of a link about a point; axis: 0 for x, 1 for z."""
    return link[1 + axis] - link[0] * point[axis]


@dataclass(frozen=True)
class FourBar:
    """A mechanism of an arch."""

    ring: Ring  # of the arch
    hinges: tuple[float, ...]  # angles of the four hinges [rad], rising
    # number of voussoirs, None for a continuous arch; no effect on the mechanism
    voussoirs: int | None = field(default=None, compare=False)

    @property
    def springs(self) -> bool:
        """False: it carries its own weight only."""
        return False

    @cached_property
    def points(self) -> np.ndarray:
        """Hinge points at rest [m], shape (4, 2)."""
        return np.array(
            [
                self.ring.point(s, face)
                for s, face in zip(self.hinges, FACES, strict=True)
            ]
        )

    @cached_property
    def links(self) -> list[Moments]:
        """The moments of the three links at rest."""
        return [
            self.ring.sector(a, b)
            for a, b in zip(self.hinges[:-1], self.hinges[1:], strict=True)
        ]

    def at_rest(self) -> LinkRates:
        """Return the rates of the linkage at rest."""
        return rates(self.points, [m[:3] for m in self.links])

    @cached_property
    def reach(self) -> float:
        """Largest phi [rad] before two links lie in line and the linkage locks, at most
        pi/2.
        """
        scan = np.linspace(0.0, 0.5 * np.pi, 2001)
        fits = np.isfinite(self.rotations(scan)[0])
        return float(scan[np.argmin(fits) - 1]) if not fits.all() else float(scan[-1])

    def reach_to(self, phi: float) -> float:
        """Return phi [rad], or `reach` before it."""
        return min(phi, self.reach)

    def beyond_lock(self) -> tuple["FourBar", float, Callable[[Any], Any]]:
        return self, self.reach, np.asarray

    def rotations(self, phi: Any) -> tuple[Any, Any]:
        """Return the clockwise rotations [rad] of B-C and C-D at phi; NaN if the links
        cannot meet there.
        """
        a, b, c, d = self.points
        phi = np.asarray(phi, dtype=float)

        # B turns about A; D stays.
        ab = b - a
        b_now = (
            a[0] + np.cos(phi) * ab[0] + np.sin(phi) * ab[1],
            a[1] - np.sin(phi) * ab[0] + np.cos(phi) * ab[1],
        )
        bd = d[0] - b_now[0], d[1] - b_now[1]

        # C closes the triangle, on the same side of B-D as at rest.
        side = np.sign(_cross(c - b, d - b))
        bc = _triangle(bd, np.hypot(*(c - b)), np.hypot(*(d - c)), side)
        cd = bd[0] - bc[0], bd[1] - bc[1]
        return _angle_between(c - b, *bc), _angle_between(d - c, *cd)

    def displaced(
        self, phi: float
    ) -> list[Callable[[float, float], tuple[float, float]]]:
        """Return for each link a function from the (x, z) of a point at rest to its (x,
        z) at phi [m].
        """
        a, b, _, d = self.points
        second, third = (float(turn) for turn in self.rotations(phi))
        b_now = a + _rotate(b - a, np.array(phi))
        return [
            partial(_moved, a, a, phi),
            partial(_moved, b, b_now, second),
            partial(_moved, d, d, third),
        ]

    def coefficients(self, phi: Any) -> Coefficients:
        """Return M, V'/g and B of Eq. 3.4 at rotations phi [rad] of any
        size and shape.
        """
        shape = np.shape(phi)
        second, third = (turn.ravel() for turn in self.rotations(phi))
        phi = np.ravel(np.asarray(phi, dtype=float))
        a, b, c, d = self.points[..., None]
        b_now, c_now = a + _rotate(b - a, phi), d + _rotate(c - d, third)
        centres = [
            after + _rotate(np.array([[m.x], [m.z]]) / m.mass - before, turn)
            for m, (before, after, turn) in zip(
                self.links,
                ((a, a, phi), (b, b_now, second), (d, d, third)),
                strict=True,
            )
        ]
        links = [
            (m.mass, m.mass * x, m.mass * z)
            for m, (x, z) in zip(self.links, centres, strict=True)
        ]
        at = rates([self.points[0], b_now, c_now, self.points[3]], links)
        inertia = self._inertia(at, b_now - a, centres[1] - b_now)
        return Coefficients(
            inertia.reshape(shape), at.lift.reshape(shape), at.push.reshape(shape)
        )

    def _inertia(self, at: LinkRates, ab: Any, lever: Any) -> Any:
        """Return M = int rho u.u of Eq. 3.4; ab: from A to B, lever: from B to the mass
        centre of link B-C [m], each (2, n).
        """
        one, two, three = self.links
        # velocity of the mass centre of B-C, which moves with B and turns about it
        ux, uz = ab[1] + at.second * lever[1], -ab[0] - at.second * lever[0]
        central = two.about(two.x / two.mass, two.z / two.mass)
        inertia = (
            one.about(*self.points[0])
            + two.mass * (ux * ux + uz * uz)
            + at.second**2 * central
        )
        return inertia + at.third**2 * three.about(*self.points[3])

    def lift_slope(self, phi: float) -> float:
        """Return V''/g at phi [kg m], by differences."""
        return slope_by_differences(self, phi)

    def fields(self) -> list[tuple[float, float, Spin]]:
        """Return (start angle, stop angle, velocity field) of each link at rest, for
        phi' = 1 rad/s.
        """
        at, (a, b, _, d) = self.at_rest(), self.points
        w2, w3 = float(at.second), float(at.third)
        across, up = b[1] - a[1], -(b[0] - a[0])  # velocity of B
        spins = (
            spin_about(a[0], a[1]),
            Spin(across - w2 * b[1], up + w2 * b[0], w2),
            spin_about(d[0], d[1], w3),
        )
        return list(zip(self.hinges[:-1], self.hinges[1:], spins, strict=True))

    def sway(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the masses of the links, and the horizontal velocities of their mass
        centres at rest for phi' = 1, (links,) each.
        """
        across = [
            u.x0 + u.omega * m.z / m.mass
            for (_, _, u), m in zip(self.fields(), self.links, strict=True)
        ]
        return np.array([link.mass for link in self.links]), np.array(across)

    def overlap(self) -> tuple[float, float]:
        """Return (int rho u.w, int rho w.w); u: the velocity field of this mechanism
        before the impact, w: that of its mirror image about the crown after it. The
        first integral is over the parts that move in both fields. The ratio of the two
        is eta from conservation of angular momentum.
        """
        beta = self.ring.angle
        back = [(s, e, Spin(-f.x0, -f.z0, -f.omega)) for s, e, f in self.fields()]
        onward = [
            (beta - e, beta - s, Spin(-f.x0, f.z0, -f.omega))
            for s, e, f in self.fields()
        ]
        shared = 0.0
        for s1, e1, u in back:
            for s2, e2, w in onward:
                start, stop = max(s1, s2), min(e1, e2)
                if stop > start:
                    shared += u.product(w, self.ring.sector(start, stop))
        return float(shared), float(
            sum(w.product(w, self.ring.sector(s, e)) for s, e, w in onward)
        )


def _rotate(vector: np.ndarray, angle: np.ndarray) -> np.ndarray:
    """Turn a vector clockwise by n angles [rad]; shape (2, n)."""
    cos, sin = np.cos(angle), np.sin(angle)
    return np.array(
        [cos * vector[0] + sin * vector[1], cos * vector[1] - sin * vector[0]]
    )


def _moved(
    before: np.ndarray, after: np.ndarray, turn: float, x: float, z: float
) -> tuple[float, float]:
    """Return (x, z) of a point of a link that has turned by `turn` and whose point
    `before` has moved to `after`.
    """
    now = after + _rotate(np.array([x, z]) - before, np.array(turn))
    return float(now[0]), float(now[1])


def _triangle(bd: Any, length2: Any, length3: Any, side: Any) -> tuple[Any, Any]:
    """Return the vector B-C of a triangle over B-D; length2, length3: of B-C and C-D
    [m]; side: +1 or -1, of C beside B-D. NaN if the lengths do not reach.
    """
    across, up = bd
    span2 = across**2 + up**2
    along = (length2**2 - length3**2 + span2) / (2.0 * span2)  # of B-D, law of cosines
    with np.errstate(invalid="ignore"):
        aside = np.sqrt(length2**2 / span2 - along**2)
    return along * across + side * aside * up, along * up - side * aside * across


def _angle_between(before: np.ndarray, x: Any, z: Any) -> Any:
    """Return the clockwise angle from the vector `before` to (x, z) [rad]."""
    return np.arctan2(before[1] * x - before[0] * z, before[0] * x + before[1] * z)
