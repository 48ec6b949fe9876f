"""Forces in an arch that rocks as a linkage of four hinges: the force at each hinge,
and the resultant on every radial joint.

The three links give nine Newton-Euler equations, in the frame of the ground, for the
four hinge forces and phi'':

    m_i a_i = H_i - H_(i+1) + m_i (-xg'', -g - zg'')
    I_i alpha_i = moments of H_i and -H_(i+1) about the mass centre of link i

H is the force at a hinge: the part of the arch before the hinge exerts it on the part
after the hinge. phi'' is that of Eq. 3.4. The balance of the part of a link before a
joint gives the thrust N, the shear T and the moment M about the joint's centre. The
assumed mechanism holds while N > 0 and |M| <= N t/2 on every joint, else another hinge
opens, and |T| <= mu N, else the joint slides.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..structures.mechanics.fourbar import EXTRADOS, INTRADOS, FourBar
from ..structures.mechanics.moments import Moments

Array = np.ndarray


class State(NamedTuple):
    """Instants of an arch that sways towards +x."""

    phi: Array  # [rad], (n,)
    rate: Array  # phi' [rad/s], (n,)
    across: Array  # ground acceleration xg'' [m/s2], (n,)
    up: Array  # ground acceleration zg'' [m/s2], (n,)


class LinkForces(NamedTuple):
    """The forces at the hinges, per unit density and width."""

    hinges: Array  # forces (x, z) on A, B, C, D, (n, 4, 2)
    acceleration: Array  # phi'' [rad/s2], (n,)


class Resultants(NamedTuple):
    """The resultants on each joint."""

    thrust: Array  # N over the weight of the arch [-], (n, joints)
    shear: Array  # T over the weight of the arch [-], (n, joints)
    eccentricity: Array  # |M|/(N t/2) [-], (n, joints)


class _Link(NamedTuple):
    """A link in motion. Its angular acceleration is turn phi'' + turn_drift, the
    acceleration of its first hinge gain phi'' + drift.
    """

    angle: Array  # turned [rad], (n,)
    speed: Array  # angular velocity [rad/s], (n,)
    turn: Array  # [-], (n,)
    turn_drift: Array  # [rad/s2], (n,)
    rest: Array  # its first hinge at rest [m], (2,)
    now: Array  # its first hinge now [m], (n, 2)
    gain: Array  # [m], (n, 2)
    drift: Array  # [m/s2], (n, 2)

    def place(self, x: Array, z: Array) -> tuple[Array, Array, Array]:
        """Return what `carried` returns for points given at rest, (points,)."""
        cos, sin = np.cos(self.angle)[:, None], np.sin(self.angle)[:, None]
        dx, dz = x - self.rest[0], z - self.rest[1]
        return self.carried(np.stack([cos * dx + sin * dz, cos * dz - sin * dx], -1))

    def carried(self, arm: Array) -> tuple[Array, Array, Array]:
        """Return (place, gain, drift) of points of the link: their acceleration is
        gain phi'' + drift. arm: from the first hinge now; each (n, points, 2).
        """
        across = _perpendicular(arm)
        speed2 = (self.speed**2)[:, None, None]
        gain = self.gain[:, None] + self.turn[:, None, None] * across
        drift = (
            self.drift[:, None] + self.turn_drift[:, None, None] * across - speed2 * arm
        )
        return self.now[:, None] + arm, gain, drift


def _perpendicular(arm: Array) -> Array:
    """Turn arms clockwise by a right angle, (..., 2): the velocity of an arm that turns
    by 1 rad/s towards +x.
    """
    return np.stack([arm[..., 1], -arm[..., 0]], axis=-1)


def _still(point: Array, count: int) -> _Link:
    """Return a part that does not move, in `count` states."""
    zero, none = np.zeros(count), np.zeros((count, 2))
    place = np.broadcast_to(point, (count, 2))
    return _Link(zero, zero, zero, zero, point, place, none, none)


@dataclass(frozen=True)
class ArchForces:
    """The forces in an arch."""

    mechanism: FourBar  # of the arch
    gravity: float  # g [m/s2]

    @property
    def weight(self) -> float:
        """The weight of the whole arch, per unit density and width."""
        ring = self.mechanism.ring
        return self.gravity * ring.radius * ring.thickness * ring.angle

    def _links(self, state: State) -> list[_Link]:
        """Return the three links in these states, each carried by the one before it."""
        points = self.mechanism.points
        angles = [state.phi, *self.mechanism.rotations(state.phi)]
        bars = [
            _rotated(end - start, angle)
            for start, end, angle in zip(points[:-1], points[1:], angles, strict=True)
        ]
        turns, drifts = _turns(bars, state.rate)

        now = np.broadcast_to(points[0], bars[0].shape)
        gain = drift = np.zeros_like(bars[0])  # A does not move
        links: list[_Link] = []
        for i, bar in enumerate(bars):
            speed = state.rate * turns[i]
            links.append(
                _Link(
                    angles[i], speed, turns[i], drifts[i], points[i], now, gain, drift
                )
            )
            now, gain, drift = (x[:, 0] for x in links[-1].carried(bar[:, None]))
        return links

    def hinges(self, state: State) -> LinkForces:
        """Return the hinge forces and phi'' in these states."""
        links, count = self._links(state), state.phi.size
        ends, pull = self._hinges_now(links), self._pull(state)
        balances = [
            _balance(i, link, body, ends, pull)
            for i, (link, body) in enumerate(
                zip(links, self.mechanism.links, strict=True)
            )
        ]
        system = np.concatenate([rows for rows, _ in balances], axis=1)
        load = np.concatenate([right for _, right in balances], axis=1)
        found = np.linalg.solve(system, load[..., None])[..., 0]
        return LinkForces(found[:, :8].reshape(count, 4, 2), found[:, 8])

    def resultants(self, state: State, joints: Array) -> Resultants:
        """Return the resultants in these states on the joints at these angles from
        springing A [rad], (joints,).
        """
        links, found = self._links(state), self.hinges(state)
        shape = (state.phi.size, joints.size)
        force, normal = np.zeros((*shape, 2)), np.zeros((*shape, 2))
        moment = np.zeros(shape)

        # The part before A, the three links, and the part beyond D, which stands on the
        # ground; each begins at one of the hinges.
        still = _still(self.mechanism.points[0], state.phi.size)
        parts = zip((still, *links, still), (0, 0, 1, 2, 3), strict=True)
        part_of = np.searchsorted(self.mechanism.hinges, joints)
        ends, pull = self._hinges_now(links), self._pull(state)
        for i, (link, hinge) in enumerate(parts):
            mine = np.flatnonzero(part_of == i)
            if mine.size:
                hinge_force = found.hinges[:, hinge, None], ends[hinge][:, None]
                force[:, mine], moment[:, mine] = self._on_joints(
                    link, hinge, joints[mine], hinge_force, found.acceleration, pull
                )
                normal[:, mine] = self._normals(link, joints[mine])

        thrust = (force * normal).sum(axis=-1)
        shear = np.abs((force * _perpendicular(normal)).sum(axis=-1))
        return Resultants(
            thrust / self.weight,
            shear / self.weight,
            np.abs(moment) / (0.5 * self.mechanism.ring.thickness * thrust),
        )

    def _on_joints(
        self,
        link: _Link,
        hinge: int,
        joints: Array,
        hinge_force: tuple[Array, Array],
        acceleration: Array,
        pull: Array,
    ) -> tuple[Array, Array]:
        """Return (force, moment about the joint's centre) on joints of one link,
        (n, joints, 2) and (n, joints), by the balance of its part from the hinge to the
        joint. hinge_force: force and place of the hinge, (n, 1, 2); acceleration: phi''
        [rad/s2], (n,).
        """
        ring = self.mechanism.ring
        # negative if the joint lies before the hinge
        part = ring.sector(np.full(joints.size, self.mechanism.hinges[hinge]), joints)
        x, z = _centre_of(part)

        # Newton: the force on the joint is the rest of m a = sum of forces.
        at, gain, drift = link.place(x, z)
        inertia = part.mass[:, None] * (
            gain * acceleration[:, None, None] + drift - pull[:, None]
        )
        force = hinge_force[0] - inertia

        # Euler, about the centre of the joint.
        inner, outer = ring.point(joints, INTRADOS), ring.point(joints, EXTRADOS)
        centre = link.place(*(0.5 * (np.array(inner) + np.array(outer))))[0]
        spin = (link.turn * acceleration + link.turn_drift)[:, None]
        moment = _moment(hinge_force[1] - centre, hinge_force[0])
        moment -= _moment(at - centre, inertia) + part.about(x, z) * spin
        return force, moment

    def _normals(self, link: _Link, joints: Array) -> Array:
        """Return the unit normals of joints of one link, (n, joints, 2)."""
        polar = 0.5 * np.pi + 0.5 * self.mechanism.ring.angle - joints
        at_rest = np.stack([np.sin(polar), -np.cos(polar)], axis=-1)
        return _rotated(at_rest, link.angle)

    def _pull(self, state: State) -> Array:
        """Return the weight and the ground's inertia force per mass [m/s2], (n, 2)."""
        return np.stack([-state.across, -self.gravity - state.up], axis=-1)

    def _hinges_now(self, links: list[_Link]) -> list[Array]:
        """Return the displaced places of the four hinges, (n, 2) each; the last hinge
        does not move.
        """
        return [
            *(link.now for link in links),
            np.broadcast_to(self.mechanism.points[3], links[0].now.shape),
        ]


def _rotated(vector: Array, angle: Array) -> Array:
    """Turn vectors, (2,) or (points, 2), clockwise by angles, (n,); the result is (n,
    2) or (n, points, 2).
    """
    vector = np.asarray(vector)
    cos, sin = (
        f(angle) if vector.ndim == 1 else f(angle)[:, None] for f in (np.cos, np.sin)
    )
    return np.stack(
        [
            cos * vector[..., 0] + sin * vector[..., 1],
            cos * vector[..., 1] - sin * vector[..., 0],
        ],
        axis=-1,
    )


def _turns(bars: list[Array], rate: Array) -> tuple[list[Array], list[Array]]:
    """Return (w, k) of each link, (n,): its angular velocity is w phi', its angular
    acceleration w phi'' + k. bars: from hinge to hinge, (n, 2); rate: phi' [rad/s].
    """
    across = [_perpendicular(bar) for bar in bars]
    one = np.ones_like(rate)

    # The velocity of D is 0: the sum of w_i across_i.
    turns = [one, *_solved(across[1], across[2], -across[0])]

    # Its acceleration is 0 as well: the sum of k_i across_i is the centripetal part.
    centripetal = sum(
        (rate * turn)[:, None] ** 2 * bar for turn, bar in zip(turns, bars, strict=True)
    )
    return turns, [0.0 * one, *_solved(across[1], across[2], centripetal)]


def _centre_of(part: Moments) -> tuple[Array, Array]:
    """Return (x, z) of the mass centres of parts [m], the origin for an empty part."""
    mass = np.where(part.mass == 0.0, 1.0, part.mass)
    return part.x / mass, part.z / mass


def _balance(
    i: int, link: _Link, body: Moments, ends: list[Array], pull: Array
) -> tuple[Array, Array]:
    """Return three of the nine equations, those of link i, as (coefficients (n, 3, 9),
    right sides (n, 3)). The unknowns are the hinge forces Ax, Az, Bx, ..., Dz and
    phi''; ends: places of the hinges, (n, 2) each.
    """
    rows, right = np.zeros((len(pull), 3, 9)), np.zeros((len(pull), 3))
    x, z = body.x / body.mass, body.z / body.mass
    at, gain, drift = (x[:, 0] for x in link.place(np.array([x]), np.array([z])))

    # Newton: H_i - H_(i+1) - m gain phi'' = m (drift - pull)
    for axis in (0, 1):
        rows[:, axis, 2 * i + axis] = 1.0
        rows[:, axis, 2 * i + 2 + axis] = -1.0
        rows[:, axis, 8] = -body.mass * gain[:, axis]
        right[:, axis] = body.mass * (drift[:, axis] - pull[:, axis])

    # Euler about the mass centre; a clockwise moment is z Fx - x Fz.
    for end, sign in ((i, 1.0), (i + 1, -1.0)):
        arm = ends[end] - at
        rows[:, 2, 2 * end] += sign * arm[:, 1]
        rows[:, 2, 2 * end + 1] += -sign * arm[:, 0]
    central = body.about(x, z)
    rows[:, 2, 8] = -central * link.turn
    right[:, 2] = central * link.turn_drift
    return rows, right


def _moment(arm: Array, force: Array) -> Array:
    """Return the clockwise moment of forces at these arms, without the last axis."""
    return arm[..., 1] * force[..., 0] - arm[..., 0] * force[..., 1]


def _solved(one: Array, other: Array, wanted: Array) -> tuple[Array, Array]:
    """Solve x one + y other = wanted for x and y, (n,); one, other, wanted: vectors (n,
    2).
    """
    area = one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]
    return (
        (wanted[:, 0] * other[:, 1] - wanted[:, 1] * other[:, 0]) / area,
        (one[:, 0] * wanted[:, 1] - one[:, 1] * wanted[:, 0]) / area,
    )
