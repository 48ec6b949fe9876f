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

from ..structures.mechanics.fourbar import FourBar

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
        """Return (place, gain, drift) of points given at rest, (points,): their
        acceleration is gain phi'' + drift; each (n, points, 2).
        """
        cos, sin = np.cos(self.angle)[:, None], np.sin(self.angle)[:, None]
        dx, dz = x - self.rest[0], z - self.rest[1]
        arm = np.stack([cos * dx + sin * dz, cos * dz - sin * dx], axis=-1)
        across = _turned(arm)
        speed2 = (self.speed**2)[:, None, None]
        gain = self.gain[:, None] + self.turn[:, None, None] * across
        drift = (
            self.drift[:, None] + self.turn_drift[:, None, None] * across - speed2 * arm
        )
        return self.now[:, None] + arm, gain, drift


def _turned(arm: Array) -> Array:
    """Turn arms clockwise by a right angle, (..., 2): the velocity of an arm that turns
    by 1 rad/s towards +x.
    """
    return np.stack([arm[..., 1], -arm[..., 0]], axis=-1)


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
        a, b, c, d = self.mechanism.points
        second, third = self.mechanism._angles(state.phi)
        angles = [state.phi, second, third]
        bars = [
            _rotated(end - start, angle)
            for start, end, angle in zip((a, b, c), (b, c, d), angles, strict=True)
        ]
        cross = [_turned(bar) for bar in bars]
        one = np.ones_like(state.phi)
        w2, w3 = _closed(cross[1], cross[2], -cross[0])
        speeds = [state.rate * w for w in (one, w2, w3)]
        centripetal = sum(
            s[:, None] ** 2 * bar for s, bar in zip(speeds, bars, strict=True)
        )
        k2, k3 = _closed(cross[1], cross[2], centripetal)
        turns, spuns = [one, w2, w3], [0.0 * one, k2, k3]
        now, gain, drift = (
            np.broadcast_to(a, bars[0].shape),
            np.zeros_like(bars[0]),
            np.zeros_like(bars[0]),
        )
        links = []
        for i, rest in enumerate((a, b, c)):
            links.append(
                _Link(angles[i], speeds[i], turns[i], spuns[i], rest, now, gain, drift)
            )
            now = now + bars[i]
            gain = gain + turns[i][:, None] * cross[i]
            drift = (
                drift + spuns[i][:, None] * cross[i] - speeds[i][:, None] ** 2 * bars[i]
            )
        return links

    def hinges(self, state: State) -> LinkForces:
        """Return the hinge forces and phi'' in these states."""
        links, bodies = self._links(state), self.mechanism.links
        n = state.phi.size
        system, load = np.zeros((n, 9, 9)), np.zeros((n, 9))
        ends = self._hinges_now(links)
        pull = np.stack([-state.across, -self.gravity - state.up], axis=-1)
        for i, (link, body) in enumerate(zip(links, bodies, strict=True)):
            at, gain, drift = (
                x[:, 0]
                for x in link.place(
                    np.array([body.x / body.mass]), np.array([body.z / body.mass])
                )
            )
            row = 3 * i
            for axis in (0, 1):
                (
                    system[:, row + axis, 2 * i + axis],
                    system[:, row + axis, 2 * i + 2 + axis],
                ) = (1.0, -1.0)
                system[:, row + axis, 8] = -body.mass * gain[:, axis]
                load[:, row + axis] = body.mass * (drift[:, axis] - pull[:, axis])
            for end, sign in ((i, 1.0), (i + 1, -1.0)):  # clockwise: z Fx - x Fz
                arm = ends[end] - at
                system[:, row + 2, 2 * end] += sign * arm[:, 1]
                system[:, row + 2, 2 * end + 1] += -sign * arm[:, 0]
            central = body.about(body.x / body.mass, body.z / body.mass)
            system[:, row + 2, 8] = -central * link.turn
            load[:, row + 2] = central * link.turn_drift
        found = np.linalg.solve(system, load[..., None])[..., 0]
        return LinkForces(found[:, :8].reshape(n, 4, 2), found[:, 8])

    def resultants(self, state: State, joints: Array) -> Resultants:
        """Return the resultants in these states on the joints at these angles from
        springing A [rad], (joints,).
        """
        ring, marks = self.mechanism.ring, self.mechanism.hinges
        links, (forces, acceleration) = self._links(state), self.hinges(state)
        n = state.phi.size
        shape = (n, joints.size)
        push, moment, normal = (
            np.zeros((*shape, 2)),
            np.zeros(shape),
            np.zeros((*shape, 2)),
        )
        pull = np.stack([-state.across, -self.gravity - state.up], axis=-1)[:, None]
        origin, zero, none = self.mechanism.points[0], np.zeros(n), np.zeros((n, 2))
        still = _Link(
            zero, zero, zero, zero, origin, np.broadcast_to(origin, (n, 2)), none, none
        )
        for i in range(
            5
        ):  # before A, the three links, and beyond D, which stands on the ground
            low, high = ((-np.inf, *marks)[i], (*marks, np.inf)[i])
            mine = (
                np.flatnonzero((joints > low) & (joints <= high))
                if i
                else np.flatnonzero(joints <= high)
            )
            if not mine.size:
                continue
            link = still if i in (0, 4) else links[i - 1]
            hinge = max(0, i - 1)
            start = np.full(mine.size, marks[hinge])
            part = ring.sector(
                start, joints[mine]
            )  # from the hinge to the joint; negative backwards
            safe = np.where(part.mass == 0.0, 1.0, part.mass)
            at, gain, drift = link.place(part.x / safe, part.z / safe)
            inertia = part.mass[:, None] * (
                gain * acceleration[:, None, None] + drift - pull
            )
            force = forces[:, hinge, None] - inertia
            centre = 0.5 * (
                np.array(ring.point(joints[mine], "intrados"))
                + np.array(ring.point(joints[mine], "extrados"))
            )
            place = link.place(centre[0], centre[1])[0]
            end = self._hinges_now(links)[hinge][:, None] - place
            arm = at - place
            central = part.about(part.x / safe, part.z / safe)
            spin = link.turn * acceleration + link.turn_drift
            torque = (
                end[..., 1] * forces[:, hinge, None, 0]
                - end[..., 0] * forces[:, hinge, None, 1]
            )
            torque -= (
                arm[..., 1] * inertia[..., 0]
                - arm[..., 0] * inertia[..., 1]
                + central * spin[:, None]
            )
            push[:, mine], moment[:, mine] = force, torque
            polar = 0.5 * np.pi + 0.5 * ring.angle - joints[mine]
            normal[:, mine] = _rotated(
                np.stack([np.sin(polar), -np.cos(polar)], axis=-1), link.angle
            )
        thrust = (push * normal).sum(axis=-1)
        shear = np.abs((push * _turned(normal)).sum(axis=-1))
        return Resultants(
            thrust / self.weight,
            shear / self.weight,
            np.abs(moment) / (0.5 * ring.thickness * thrust),
        )

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


def _closed(one: Array, other: Array, wanted: Array) -> tuple[Array, Array]:
    """Solve x one + y other = wanted for x and y, (n,); one, other, wanted: vectors (n,
    2).
    """
    area = one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]
    return (
        (wanted[:, 0] * other[:, 1] - wanted[:, 1] * other[:, 0]) / area,
        (one[:, 0] * wanted[:, 1] - one[:, 1] * wanted[:, 0]) / area,
    )
