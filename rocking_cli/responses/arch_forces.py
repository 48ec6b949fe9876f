"""The forces in an arch that rocks as a linkage of four hinges: at the hinges, and the resultant on every radial joint.

The three links give nine Newton-Euler equations, in the frame of the ground, for the four hinge forces and phi'':

    m_i a_i = H_i - H_(i+1) + m_i (-xg'', -g - zg''),   I_i alpha_i = moments of H_i and -H_(i+1) about the mass centre of link i

with H the force that what is before a hinge exerts on what is after it. phi'' is that of Eq. 3.4. The resultant on a joint follows from
the balance of the part of the link before it. While the mechanism is as it is assumed N > 0 on every joint and |M| <= N t/2, the
moment about the joint's centre: beyond that another hinge opens; and |T| <= mu N: beyond that the joint slides.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from ..errors import UsageError
from ..structures.fourbar import FourBar
from ..structures.parameters import RockingParameters
from .extremes import extent
from .forces import Ground
from .history import Arc, Event, History

Array = np.ndarray


class State(NamedTuple):
    """Instants of an arch that sways towards +x: phi [rad], phi' [rad/s], and the ground accelerations xg'', zg'' [m/s2]; (n,)."""

    phi: Array
    rate: Array
    across: Array
    up: Array


class LinkForces(NamedTuple):
    """hinges: (n, 4, 2) forces (x, z) on A, B, C, D; bend: phi'' [rad/s2]; per unit density and width."""

    hinges: Array
    bend: Array


class Resultants(NamedTuple):
    """On each joint, (n, joints): thrust N and shear T over the arch's weight, eccentricity |M|/(N t/2) [-]."""

    thrust: Array
    shear: Array
    eccentricity: Array


class _Link(NamedTuple):
    """A link in motion: angle turned, angular velocity, angular acceleration = turn phi'' + spun; its first hinge at rest and now, with
    that hinge's acceleration = (gain phi'' + drift)."""

    angle: Array
    speed: Array
    turn: Array
    spun: Array
    rest: Array
    now: Array
    gain: Array
    drift: Array

    def place(self, x: Array, z: Array) -> tuple[Array, Array, Array]:
        """Of points at rest, (points,): where they are, and the factor and the rest of their acceleration, each (n, points, 2)."""
        cos, sin = np.cos(self.angle)[:, None], np.sin(self.angle)[:, None]
        dx, dz = x - self.rest[0], z - self.rest[1]
        arm = np.stack([cos * dx + sin * dz, cos * dz - sin * dx], axis=-1)
        across = _turned(arm)
        speed2 = (self.speed**2)[:, None, None]
        gain = self.gain[:, None] + self.turn[:, None, None] * across
        drift = self.drift[:, None] + self.spun[:, None, None] * across - speed2 * arm
        return self.now[:, None] + arm, gain, drift


def _turned(arm: Array) -> Array:
    """A quarter turn clockwise, (..., 2): the velocity of an arm that turns by 1 rad/s towards +x."""
    return np.stack([arm[..., 1], -arm[..., 0]], axis=-1)


@dataclass(frozen=True)
class ArchForces:
    """The forces in an arch of this mechanism under this gravity [m/s2]."""

    mechanism: FourBar
    gravity: float

    @property
    def weight(self) -> float:
        """Of the whole arch, per unit density and width."""
        ring = self.mechanism.ring
        return self.gravity * ring.radius * ring.thickness * ring.angle

    def _links(self, state: State) -> list[_Link]:
        a, b, c, d = self.mechanism.points
        second, third = self.mechanism._angles(state.phi)
        angles = [state.phi, second, third]
        bars = [_rotated(end - start, angle) for start, end, angle in zip((a, b, c), (b, c, d), angles, strict=True)]
        cross = [_turned(bar) for bar in bars]
        one = np.ones_like(state.phi)
        w2, w3 = _closed(cross[1], cross[2], -cross[0])
        speeds = [state.rate * w for w in (one, w2, w3)]
        centripetal = sum(s[:, None] ** 2 * bar for s, bar in zip(speeds, bars, strict=True))
        k2, k3 = _closed(cross[1], cross[2], centripetal)
        turns, spuns = [one, w2, w3], [0.0 * one, k2, k3]
        now, gain, drift = np.broadcast_to(a, bars[0].shape), np.zeros_like(bars[0]), np.zeros_like(bars[0])
        links = []
        for i, rest in enumerate((a, b, c)):
            links.append(_Link(angles[i], speeds[i], turns[i], spuns[i], rest, now, gain, drift))
            now = now + bars[i]
            gain = gain + turns[i][:, None] * cross[i]
            drift = drift + spuns[i][:, None] * cross[i] - speeds[i][:, None] ** 2 * bars[i]
        return links

    def hinges(self, state: State) -> LinkForces:
        """The hinge forces and phi'' in these states."""
        links, bodies = self._links(state), self.mechanism.links
        n = state.phi.size
        system, load = np.zeros((n, 9, 9)), np.zeros((n, 9))
        ends = [*(link.now for link in links), np.broadcast_to(self.mechanism.points[3], (n, 2))]
        pull = np.stack([-state.across, -self.gravity - state.up], axis=-1)
        for i, (link, body) in enumerate(zip(links, bodies, strict=True)):
            at, gain, drift = (x[:, 0] for x in link.place(np.array([body.x / body.mass]), np.array([body.z / body.mass])))
            row = 3 * i
            for axis in (0, 1):
                system[:, row + axis, 2 * i + axis], system[:, row + axis, 2 * i + 2 + axis] = 1.0, -1.0
                system[:, row + axis, 8] = -body.mass * gain[:, axis]
                load[:, row + axis] = body.mass * (drift[:, axis] - pull[:, axis])
            for end, sign in ((i, 1.0), (i + 1, -1.0)):  # clockwise: z Fx - x Fz
                arm = ends[end] - at
                system[:, row + 2, 2 * end] += sign * arm[:, 1]
                system[:, row + 2, 2 * end + 1] += -sign * arm[:, 0]
            central = body.about(body.x / body.mass, body.z / body.mass)
            system[:, row + 2, 8] = -central * link.turn
            load[:, row + 2] = central * link.spun
        found = np.linalg.solve(system, load[..., None])[..., 0]
        return LinkForces(found[:, :8].reshape(n, 4, 2), found[:, 8])

    def resultants(self, state: State, joints: Array) -> Resultants:
        """On the joints at these angles from springing A [rad], (joints,), in these states."""
        ring, marks = self.mechanism.ring, self.mechanism.hinges
        links, (forces, bend) = self._links(state), self.hinges(state)
        n = state.phi.size
        shape = (n, joints.size)
        push, moment, normal = np.zeros((*shape, 2)), np.zeros(shape), np.zeros((*shape, 2))
        pull = np.stack([-state.across, -self.gravity - state.up], axis=-1)[:, None]
        origin, zero, none = self.mechanism.points[0], np.zeros(n), np.zeros((n, 2))
        still = _Link(zero, zero, zero, zero, origin, np.broadcast_to(origin, (n, 2)), none, none)
        for i in range(5):  # before A, the three links, and beyond D, which stands on the ground
            low, high = ((-np.inf, *marks)[i], (*marks, np.inf)[i])
            mine = np.flatnonzero((joints > low) & (joints <= high)) if i else np.flatnonzero(joints <= high)
            if not mine.size:
                continue
            link = still if i in (0, 4) else links[i - 1]
            hinge = max(0, i - 1)
            start = np.full(mine.size, marks[hinge])
            part = ring.sector(start, joints[mine])  # from the hinge to the joint; negative backwards
            safe = np.where(part.mass == 0.0, 1.0, part.mass)
            at, gain, drift = link.place(part.x / safe, part.z / safe)
            inertia = part.mass[:, None] * (gain * bend[:, None, None] + drift - pull)
            force = forces[:, hinge, None] - inertia
            centre = 0.5 * (np.array(ring.point(joints[mine], "intrados")) + np.array(ring.point(joints[mine], "extrados")))
            place = link.place(centre[0], centre[1])[0]
            end = self._hinge_now(links, hinge, n)[:, None] - place
            arm = at - place
            central = part.about(part.x / safe, part.z / safe)
            spin = link.turn * bend + link.spun
            torque = end[..., 1] * forces[:, hinge, None, 0] - end[..., 0] * forces[:, hinge, None, 1]
            torque -= arm[..., 1] * inertia[..., 0] - arm[..., 0] * inertia[..., 1] + central * spin[:, None]
            push[:, mine], moment[:, mine] = force, torque
            polar = 0.5 * np.pi + 0.5 * ring.angle - joints[mine]
            normal[:, mine] = _rotated(np.stack([np.sin(polar), -np.cos(polar)], axis=-1), link.angle)
        thrust = (push * normal).sum(axis=-1)
        shear = np.abs((push * _turned(normal)).sum(axis=-1))
        return Resultants(thrust / self.weight, shear / self.weight, np.abs(moment) / (0.5 * ring.thickness * thrust))

    def _hinge_now(self, links: list[_Link], hinge: int, n: int) -> Array:
        return links[hinge].now if hinge < 3 else np.broadcast_to(self.mechanism.points[3], (n, 2))


class Worst(NamedTuple):
    """The worst of a quantity over joints and time: its value [-], the joint's number and when [tau]."""

    value: float
    joint: int
    tau: float


class JointDemands(NamedTuple):
    """What a response asks of the joints: the least N over the arch's weight, the largest |T|/N, and the largest |M|/(N t/2) beside the
    hinges; each None where the arch never moved."""

    thrust: Worst | None
    friction: Worst | None
    eccentricity: Worst | None


_SECTIONS = 180  # radial sections of an arch without voussoirs that are looked at
_QUANTITIES: dict[str, Callable[[Resultants], Array]] = {
    "thrust": lambda r: -r.thrust,
    "friction": lambda r: np.where(r.thrust > 0.0, r.shear / r.thrust, np.inf),
    "eccentricity": lambda r: np.where(r.thrust > 0.0, r.eccentricity, np.inf),
}


@dataclass(frozen=True)
class ArchHistory:
    """The forces of one response of an arch by Eq. 3.4; joints are numbered from the left springing, 0, on."""

    structure: RockingParameters
    ground: Ground
    found: History

    def __post_init__(self) -> None:
        if self.structure.damping:
            raise UsageError(f"{self.structure.name}: found damping; accepted for the forces in an arch is none")

    @cached_property
    def forces(self) -> ArchForces:
        """Of its mechanism."""
        assert isinstance(self.structure.mechanism, FourBar)  # `of_arch` says so
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
        """By name at times tau: force of the ground on the links over the arch's weight, least N over it, largest |T|/N, and largest
        |M|/(N t/2) beside the hinges; NaN at rest, where the arch is redundant, and after the end."""
        found = {name: np.full(tau.shape, np.nan) for name in ("fx_ratio", "fz_ratio", "thrust_min", "shear_ratio", "eccentricity")}
        for arc in self.found.arcs:
            inside = np.flatnonzero((tau >= arc.start) & (tau <= min(arc.stop * (1.0 + 1e-14), self.found.end)))
            if not inside.size:
                continue
            state = self.state(arc, np.minimum(tau[inside], arc.stop))
            hinges, joints = self.forces.hinges(state).hinges, self.forces.resultants(state, self.joints)
            on = (hinges[:, 0] - hinges[:, 3]) / self.forces.weight
            found["fx_ratio"][inside], found["fz_ratio"][inside] = arc.side * on[:, 0], on[:, 1]
            for name, quantity, sign in (("thrust_min", "thrust", -1.0), ("shear_ratio", "friction", 1.0), ("eccentricity",) * 2 + (1.0,)):
                found[name][inside] = sign * self._over_joints(quantity, joints).max(axis=1)
        return found

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
        for arc in self.found.arcs:
            if not arc.stop > arc.start:
                continue
            tau = arc.start + (arc.stop - arc.start) * 0.5 * (1.0 - np.cos(np.linspace(0.0, np.pi, 25)))
            joints = self.forces.resultants(self.state(arc, tau), self.joints)
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
        return JointDemands(
            None if thrust is None else thrust._replace(value=-thrust.value), worst.get("friction"), worst.get("eccentricity")
        )

    def summary(self, when: str, time: float) -> dict[str, Any]:
        """As a record; `when` names a time, `time` its unit by tau."""
        found = self.demands
        names = {"friction": found.friction, "thrust_min": found.thrust, "eccentricity": found.eccentricity}
        record: dict[str, Any] = {}
        for name, worst in names.items():
            record[name] = None if worst is None or not np.isfinite(worst.value) else worst.value
            record[f"{name}_joint"], record[f"{name}_{when}"] = (None, None) if worst is None else (worst.joint, worst.tau * time)
        opens = found.eccentricity is not None and found.eccentricity.value > 1.0 + 1e-9
        record["opens"] = opens
        if self.structure.friction is not None:
            record["slides"] = found.friction is not None and found.friction.value > self.structure.friction
        return record

    def event(self, event: Event, time: float) -> dict[str, Any]:
        """The columns at an event, after it."""
        return {name: float(x[0]) for name, x in self.columns(np.array([event.tau])).items()}

    def words(self) -> str:
        """What came of it, in a sentence."""
        thrust, friction, eccentricity = self.demands
        if thrust is None or friction is None or eccentricity is None:
            return "the arch never moved"
        text = f"least N {thrust.value:.4g} of the weight on joint {thrust.joint}"
        text += f", largest |T|/N {friction.value:.4g} on joint {friction.joint}"
        text += f", largest |M|/(N t/2) {eccentricity.value:.4g} on joint {eccentricity.joint}"
        text += ", where a further hinge opens" if eccentricity.value > 1.0 + 1e-9 else ", so no further hinge opens"
        s = self.structure
        if s.friction is not None:
            slides = "a joint slides" if friction.value > s.friction else "no joint slides"
            text += f"; with the friction {s.friction:g} of the document {slides}"
        return text


def _rotated(vector: Array, angle: Array) -> Array:
    """Vectors turned clockwise: (2,) or (points, 2) by (n,) angles, (n, 2) or (n, points, 2)."""
    vector = np.asarray(vector)
    cos, sin = (f(angle) if vector.ndim == 1 else f(angle)[:, None] for f in (np.cos, np.sin))
    return np.stack([cos * vector[..., 0] + sin * vector[..., 1], cos * vector[..., 1] - sin * vector[..., 0]], axis=-1)


def _closed(one: Array, other: Array, wanted: Array) -> tuple[Array, Array]:
    """x, y with x one + y other = wanted, vectors (n, 2)."""
    area = one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]
    return (
        (wanted[:, 0] * other[:, 1] - wanted[:, 1] * other[:, 0]) / area,
        (one[:, 0] * wanted[:, 1] - one[:, 1] * wanted[:, 0]) / area,
    )
