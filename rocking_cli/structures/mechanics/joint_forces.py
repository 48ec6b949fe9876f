"""Forces at the joints of a planar mechanism: in motion, at the onset, and the impulses
of an impact.

Each link has three equations of Newton and Euler; a hinge has two unknowns, a slider
one. They can be solved exactly, since the weight, the inertia and the shaking do no
work in excess of the equation of motion.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar, NamedTuple

import numpy as np

from ...arrays import Array
from ..sketch import Point
from .assembly import NEAR, Face, Hinge
from .linkage import Linkage
from .loop_closure import Positions
from .measured import Measured, ratio_of
from .moments import BOTH, NONE, VERTICAL

_UNIQUE = 1e-9  # least singular value over the largest: forces are unique


class Moving(NamedTuple):
    """Instants of a mechanism. Every array is (n,)."""

    phi: Array  # [rad]
    rate: Array  # phi' [rad/s]
    acceleration: Array  # phi'' [rad/s2]
    across: Array  # ground acceleration xg'' [m/s2]
    up: Array  # ground acceleration zg'' [m/s2]


class JointForce(NamedTuple):
    """The force at each joint. Compression and shear are along the normal and the face
    at rest, NaN where no face is known.
    """

    hinges: Array  # force (x, z) on the first body of each hinge [N], (n, hinges, 2)
    sliders: Array  # force of each slider along J d on its body [N], (n, sliders)
    compression: Array  # N at each hinge [N], (n, hinges)
    shear: Array  # T at each hinge [N], (n, hinges)
    # force of each load that is not carried, over its weight [-], (n, bearings)
    loads: Array


@dataclass(frozen=True)
class JointForces:
    """The forces at the joints of a mechanism in one direction. Hinges and sliders have
    the numbers 1, 2 ... of its joints.
    """

    linkage: Linkage  # the mechanism
    gravity: float  # g [m/s2]

    # by quantity, its column and those of its place
    SHOWN: ClassVar[dict[str, tuple[str, tuple[str, ...]]]] = {
        "friction": ("friction_needed", ("side", "hinge")),
        "thrust_min": ("thrust_min", ("side", "hinge")),
    }

    @property
    def weight(self) -> float:
        """The weight of what moves [N]."""
        return float(self.linkage.weighed.weight.sum()) * self.gravity

    @cached_property
    def _known(self) -> list[int]:
        """Indices of the hinges on a known face, whose N and T are known."""
        hinges = enumerate(self.linkage.hinges)
        return [i for i, hinge in hinges if self.face_at(hinge) is not None]

    @property
    def complete(self) -> bool:
        """True if N and T of all hinges are known."""
        return len(self._known) == len(self.linkage.hinges)

    def places(self, _: str) -> tuple[int, ...]:
        """Return the numbers of the hinges or joints of a quantity."""
        return tuple(i + 1 for i in self._known)

    def measured(self, moving: Moving, weight: float) -> Measured:
        """Return the forces at instants over a weight: the least N and the largest
        |T|/N, N and T of each hinge, the force of each slider, and load_min, the least
        force of a load that is not carried, over its weight.
        """
        at = self.during(moving)
        n, t = at.compression, at.shear
        measures = {"thrust_min": -n / weight, "friction": ratio_of(np.abs(t), n)}
        measures = {name: x[:, self._known] for name, x in measures.items()}
        worst = (
            [x.max(axis=1) for x in measures.values()]
            if self._known
            else np.full((2, len(n)), np.nan)
        )
        joints = np.stack([n, t], axis=-1).reshape(len(n), -1)
        joints = np.concatenate([joints, at.sliders], axis=1) / weight
        loads = [at.loads.min(axis=1)] if at.loads.size else []
        rows = [-worst[0], worst[1], *joints.T, *loads]
        return Measured(dict(zip(self.names, rows, strict=True)), measures)

    @property
    def names(self) -> list[str]:
        """The columns that are measured."""
        linkage = self.linkage
        names = ["thrust_min", "shear_ratio"]
        hinges = range(1, len(linkage.hinges) + 1)
        names += [f"hinge{i}_{axis}" for i in hinges for axis in ("n", "t")]
        names += [f"slider{i}" for i in range(1, len(linkage.sliders) + 1)]
        return names + ["load_min"] * bool(linkage.bearings)

    def opened(self, values: Mapping[str, Any]) -> Any:
        """True where a hinge loses its compression, or a load leaves its body; values:
        of quantities or columns.
        """
        found = [values[name] for name in ("thrust_min", "load_min") if name in values]
        return np.any([x <= 0.0 for x in found], axis=0)

    def face_at(self, hinge: Hinge) -> Face | None:
        """Return the face at whose end a hinge is: one of its own two bodies, or else
        of their links; None if there is none.
        """
        link_of, near = self.linkage.link_of, NEAR * self.linkage.assembly.size
        links = {link_of[name] for name in hinge.bodies}
        found = [
            face
            for face in self.linkage.faces
            if min(np.hypot(*np.subtract(end, hinge.at)) for end in face.ends) <= near
            and {link_of[name] for name in face.bodies} == links
        ]
        own = [face for face in found if set(face.bodies) == set(hinge.bodies)]
        return next(iter(own or found), None)

    def _system(self, at: Positions) -> Array:
        """The matrix of the unknowns in the equations of the links, (n, 3 links,
        unknowns).
        """
        linkage = self.linkage
        points = linkage.motion(at, linkage.weighed.chains).place
        centres = points[:, : len(linkage.masses)]
        joints = [(hinge.bodies[0], hinge.at) for hinge in linkage.hinges]
        joints += [(slider.body, slider.at) for slider in linkage.sliders]
        places = linkage.motion(at, linkage.chains(joints)).place
        columns = [
            self._column(centres, places[:, i], unit, *hinge.bodies)
            for i, hinge in enumerate(linkage.hinges)
            for unit in (1.0 + 0.0j, 1.0j)
        ]
        for i, slider in enumerate(linkage.sliders, len(linkage.hinges)):
            along = complex(*slider.along)
            across = 1j * along / abs(along)
            columns.append(self._column(centres, places[:, i], across, slider.body))
        return np.stack(columns, axis=-1)

    def _column(
        self, centres: Array, place: Array, force: complex, body: str, other: str = ""
    ) -> Array:
        """A force on a body at a place, and its reaction on another one, in the
        equations of the links, (n, 3 links).
        """
        column = np.zeros((*centres.shape, 3))
        for name, sign in ((body, 1.0), (other, -1.0)):
            if name and (link := self.linkage.link_of[name]):
                arm = place - centres[:, link - 1]
                column[:, link - 1, 0] += sign * force.real
                column[:, link - 1, 1] += sign * force.imag
                column[:, link - 1, 2] += sign * (np.conj(arm) * force).imag
        return column.reshape(len(column), -1)

    @cached_property
    def unique(self) -> bool:
        """True if the equations determine all forces."""
        system = self._system(self.linkage.positions(np.zeros(1)))[0]
        scaled = system / self._scale[:, None]
        sizes = np.linalg.svd(scaled, compute_uv=False)
        unknowns = scaled.shape[1]
        return unknowns <= len(scaled) and bool(sizes[-1] > _UNIQUE * sizes[0])

    @property
    def _scale(self) -> Array:
        """Units of the equations: forces, and moments over the size."""
        return np.tile([1.0, 1.0, self.linkage.assembly.size], len(self.linkage.masses))

    def _solved(self, at: Positions, wanted: Array) -> JointForce:
        """Return the forces whose sums on the links are `wanted`, (n, 3 links)."""
        scale = self._scale
        found = (
            np.linalg.pinv(self._system(at) / scale[:, None])
            @ ((wanted / scale)[:, :, None])
        )
        n, count = len(at.q), len(self.linkage.hinges)
        hinges = found[:, : 2 * count, 0].reshape(n, count, 2)
        compression, shear = np.full((2, n, count), np.nan)
        for i, hinge in enumerate(self.linkage.hinges):
            if (face := self.face_at(hinge)) is None:
                continue
            links = [self.linkage.link_of[name] for name in face.bodies]
            on_first = links[0] == self.linkage.link_of[hinge.bodies[0]]
            force = (hinges[:, i, 0] + 1j * hinges[:, i, 1]) * (1.0 if on_first else -1)
            along = np.conj(complex(*face.normal)) * force
            compression[:, i], shear[:, i] = along.real, along.imag
        sliders = found[:, 2 * count :, 0]
        return JointForce(hinges, sliders, compression, shear, np.ones((n, 0)))

    def during(self, moving: Moving) -> JointForce:
        """Return the forces at instants of the motion."""
        linkage, g = self.linkage, self.gravity
        at = linkage.positions(moving.phi)
        rate2, n = moving.rate**2, moving.phi.size
        wanted = np.zeros((n, len(linkage.masses), 3))
        points = linkage.motion(at, linkage.weighed.chains)
        gained = (
            points.rate * moving.acceleration[:, None] + points.drift * rate2[:, None]
        )
        gained = gained + (moving.across + 1j * moving.up)[:, None]
        for i, mass in enumerate(linkage.masses):
            spin = at.rate[:, i] * moving.acceleration + at.drift[:, i] * rate2
            wanted[:, i, 0] = mass.mass * gained[:, i].real
            wanted[:, i, 1] = mass.mass * (gained[:, i].imag + g)
            wanted[:, i, 2] = mass.inertia * spin
        first = len(linkage.masses)
        press = np.ones((n, len(linkage.bearings)))
        for k, index in enumerate(linkage.bearings):
            load = linkage.assembly.loads[index]
            if load.inertia == VERTICAL:
                press[:, k] += gained[:, first + k].imag / g
            # its downward force
            force, link = load.mass * g * press[:, k], linkage.link_of[load.body] - 1
            arm = (points.place[:, first + k] - points.place[:, link]).real
            wanted[:, link, 1] += force
            wanted[:, link, 2] += arm * force
        return self._solved(at, wanted.reshape(n, -1))._replace(loads=press)

    def at_onset(self) -> JointForce:
        """Return the forces at the moment of uplift, one instant."""
        rest, zero = self.linkage.at_rest, np.zeros(1)
        across = np.array([-self.gravity * rest.lift / rest.push])
        return self.during(Moving(zero, zero, zero, across, zero))

    def impulses(self, before: Linkage, eta: float) -> JointForce:
        """Return the impulses [N s, per rad/s of phi' before] with which the mechanism
        `before` changes into this one.
        """
        linkage = self.linkage
        wanted = np.zeros((1, len(linkage.masses), 3))
        for change in momentum_changes(before, linkage, eta):
            if link := linkage.link_of[change.body]:
                arm = change.place - linkage.masses[link - 1].centre
                wanted[0, link - 1] += change.about(arm)
        return self._solved(linkage.positions(np.zeros(1)), wanted.reshape(1, -1))


class MomentumChange(NamedTuple):
    """The momentum that a body, or a load on it, gains in an impact."""

    body: str  # name of the body
    place: complex  # its mass centre, or the bearing of the load [m]
    momentum: complex  # gain [N s]
    spin: float  # gain of the angular momentum about this place [N m s]

    def about(self, arm: complex) -> Array:
        """Return (x, z, moment) about a point from which the place is at `arm`."""
        moment = (np.conj(arm) * self.momentum).imag + self.spin
        return np.array([self.momentum.real, self.momentum.imag, moment])


def momentum_changes(
    before: Linkage, after: Linkage, eta: float
) -> list[MomentumChange]:
    """Return what each body and load gains as the motion -phi' of `before` changes into
    eta phi' of `after`, for phi' = 1. Of a load that only rises it is vertical.
    """
    old, new = _Fields(before), _Fields(after)
    found = []
    for body in after.assembly.bodies:
        name, at = body.name, body.centre
        gain = eta * new.at(name, at) + old.at(name, at)
        turn = eta * new.spin(name) + old.spin(name)
        momentum, spin = body.mass * gain, body.inertia * turn
        found.append(MomentumChange(name, complex(*at), momentum, spin))
    for was, load in zip(before.assembly.loads, after.assembly.loads, strict=True):
        if load.inertia == NONE:
            continue
        gain = eta * new.at(load.body, load.at) + old.at(was.body, was.at)
        gain = gain if load.inertia == BOTH else 1j * gain.imag
        place = complex(*load.at)
        found.append(MomentumChange(load.body, place, load.mass * gain, 0.0))
    return found


class _Fields:
    """The velocities of a mechanism at rest, for phi' = 1."""

    def __init__(self, linkage: Linkage) -> None:
        self.linkage, self.rest = linkage, linkage.positions(np.zeros(1))

    def at(self, body: str, place: Point) -> complex:
        """Return the velocity of a point of a body [m]."""
        chains = self.linkage.chains([(body, place)])
        return complex(self.linkage.motion(self.rest, chains).rate[0, 0])

    def spin(self, body: str) -> float:
        """Return the rotation of a body [-]."""
        link = self.linkage.link_of[body]
        return float(self.rest.rate[0, link - 1]) if link else 0.0


def momentum_restitution(before: Linkage, after: Linkage) -> tuple[float, float]:
    """Return (eta, share of the energy that is kept) of the impact at which the motion
    changes from `before` to `after`: no impulse does work on the new motion.
    """
    old, new = _Fields(before), _Fields(after)
    shared = 0.0  # N of eta = -N/D
    for body in after.assembly.bodies:
        u, w = old.at(body.name, body.centre), new.at(body.name, body.centre)
        shared += body.mass * float((np.conj(u) * w).real)
        shared += body.inertia * old.spin(body.name) * new.spin(body.name)
    for was, load in zip(before.assembly.loads, after.assembly.loads, strict=True):
        if load.inertia == NONE:
            continue
        u, w = old.at(was.body, was.at), new.at(load.body, load.at)
        across = u.real * w.real if load.inertia == BOTH else 0.0
        shared += load.mass * (across + u.imag * w.imag)
    old_m, new_m = before.at_rest.inertia, after.at_rest.inertia
    return 0.0 - shared / new_m, shared * shared / (old_m * new_m)
