"""The mechanism in one direction: its masses and loads on the motion of its links, and
the coefficients of Eq. 3.4.

    M = sum m |u|^2 + I omega^2 + sum_vertical m u_z^2, B = sum m u_x
    V'/g = sum m u_z + sum_loads m u_z

with the velocities u and omega for phi' = 1. Carried loads are part of the links; those
that only rise, and weights without mass, stand beside them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from ...arrays import Array
from .assembly import PlanarBody
from .kinematics import Coefficients
from .loop_closure import LoopClosure, Positions
from .moments import BOTH, NONE


class LinkMass(NamedTuple):
    """The bodies of a link together, with the masses that they carry."""

    mass: float  # [kg]
    centre: complex  # mass centre at rest [m]
    inertia: float  # about the mass centre [kg m2]


class WeighedPoints(NamedTuple):
    """Points with mass or weight."""

    chains: tuple[Array, Array]  # D and T of the points
    whole: Array  # mass that moves in both directions [kg], (points,)
    rising: Array  # mass that only rises [kg], (points,)
    weight: Array  # weight over g [kg], (points,)


@dataclass(frozen=True)
class Linkage(LoopClosure):
    """A mechanism of one degree of freedom in one direction."""

    @cached_property
    def sense(self) -> float:
        """sigma: the rotation of the coordinate's body, +1 counterclockwise, for which
        V'(0) > 0; +1 if V'(0) = 0.
        """
        rest = self.at_rest_turning(1.0)
        return 1.0 if self._coefficients(rest).lift[0] >= 0.0 else -1.0

    @cached_property
    def masses(self) -> list[LinkMass]:
        """The mass of each link that moves, with the loads that it carries."""
        carried = [load for load in self.assembly.loads if load.inertia == BOTH]
        found = []
        for link in self.links[1:]:
            parts = [self.assembly.body(name) for name in link]
            parts += [
                PlanarBody("", load.mass, load.at, 0.0)
                for load in carried
                if load.body in link
            ]
            mass = sum(part.mass for part in parts)
            centre = sum(part.mass * complex(*part.centre) for part in parts) / mass
            inertia = sum(
                part.inertia + part.mass * abs(complex(*part.centre) - centre) ** 2
                for part in parts
            )
            found.append(LinkMass(mass, centre, inertia))
        return found

    @cached_property
    def bearings(self) -> list[int]:
        """Indices of the loads that are not carried and bear on bodies that move."""
        return [
            i
            for i, load in enumerate(self.assembly.loads)
            if load.inertia != BOTH and self.link_of[load.body]
        ]

    @property
    def springs(self) -> bool:
        """True if it carries weights without mass."""
        return any(self.assembly.loads[i].inertia == NONE for i in self.bearings)

    @cached_property
    def weighed(self) -> WeighedPoints:
        """The mass centres of the links that move, then the bearings."""
        loads = [self.assembly.loads[i] for i in self.bearings]
        centres = [self.chain(i, m.centre) for i, m in enumerate(self.masses, 1)]
        chains = (
            np.array([d for d, _ in centres]),
            np.array([t for _, t in centres]).reshape(len(centres), -1),
        )
        bearings = self.chains([(load.body, load.at) for load in loads])
        whole = np.array([m.mass for m in self.masses] + [0.0] * len(loads))
        rising = np.array(
            [0.0] * len(centres)
            + [0.0 if load.inertia == NONE else load.mass for load in loads]
        )
        weight = np.array([m.mass for m in self.masses] + [load.mass for load in loads])
        joined = tuple(np.concatenate(x) for x in zip(chains, bearings, strict=True))
        return WeighedPoints((joined[0], joined[1]), whole, rising, weight)

    def _coefficients(self, at: Positions) -> Coefficients:
        """M, V'/g and the signed B."""
        chains, whole, rising, weight = self.weighed
        u = self.motion(at, chains).rate
        spins = at.rate[:, : len(self.links) - 1] ** 2
        inertia = (
            (u.real**2 + u.imag**2) @ whole
            + u.imag**2 @ rising
            + spins @ np.array([m.inertia for m in self.masses])
        )
        return Coefficients(inertia, u.imag @ weight, u.real @ whole)

    @cached_property
    def at_rest(self) -> Coefficients:
        """M, V'/g and the signed B at rest."""
        rest = self.at_rest_turning(self.sense)
        return Coefficients(*(float(x[0]) for x in self._coefficients(rest)))

    @property
    def direction(self) -> float:
        """+1 if it moves towards +x, -1 towards -x."""
        return 1.0 if self.at_rest.push >= 0.0 else -1.0

    def coefficients(self, phi: Any) -> Coefficients:
        """Return M, V'/g and B of Eq. 3.4, B > 0 at rest, at rotations phi [rad] of any
        shape.
        """
        shape = np.shape(phi)
        flat = np.ravel(np.asarray(phi, dtype=float))
        m, lift, push = self._coefficients(self.positions(flat))
        return Coefficients(
            m.reshape(shape), lift.reshape(shape), self.direction * push.reshape(shape)
        )

    def beyond_lock(self) -> tuple[Linkage, float, Callable[[Array], Array]]:
        """Return (the mechanism by a coordinate that goes on where phi is largest, the
        largest value of this coordinate [rad], phi [rad] as a function of it): by the
        rotation of the body that turns fastest there.
        """
        end = self.reach_to(0.5 * np.pi)
        if end >= 0.5 * np.pi:
            return self, end, np.asarray
        near = self.positions(np.linspace(0.0, (1.0 - 1e-6) * end, 65)).rate
        rates = near[:, : len(self.links) - 1]
        one_way = np.all(rates * rates[-1] > 0.0, axis=0)
        fastest = int(np.where(one_way, np.abs(rates[-1]), 0.0).argmax())
        other = replace(self, coordinate=self.links[fastest + 1][0])
        own = self._frame[0]

        def phi(at: Array) -> Array:
            q = other.positions(np.ravel(at)).q[:, own]
            return (self.sense * q).reshape(np.shape(at))

        return other, other.reach_to(np.pi), phi

    def lift_slope(self, phi: float) -> float:
        """Return V''/g at phi [kg m]."""
        chains, _, _, weight = self.weighed
        at = self.positions(np.array([phi]))
        return float(self.motion(at, chains).drift[0].imag @ weight)

    def sway(self) -> tuple[Array, Array]:
        """Return the masses of the links that move, with what they carry, and the
        horizontal velocities of their mass centres at rest for phi' = 1, (links,) each.
        """
        count = len(self.masses)
        rest = self.positions(np.zeros(1))
        across = self.motion(rest, self.weighed.chains).rate[0, :count].real
        return self.weighed.whole[:count], across

    def acceleration(
        self, phi: Array, rate: Array, across: Array, up: Array, gravity: float
    ) -> Array:
        """Return phi'' [rad/s2] by Eq. 3.4, without damping, at rotations phi and rates
        phi' under the ground accelerations [m/s2], (n,) each.
        """
        (chains, whole, rising, _), at = self.weighed, self.positions(phi)
        u, drift = self.motion(at, chains)[1:]
        count = len(self.links) - 1
        spins = np.array([m.inertia for m in self.masses])
        m, lift, push = self._coefficients(at)
        half_slope = (u.real * drift.real + u.imag * drift.imag) @ whole
        half_slope += (u.imag * drift.imag) @ rising
        half_slope += (at.rate[:, :count] * at.drift[:, :count]) @ spins
        pull = gravity * lift + up * (u.imag @ (whole + rising))
        found: Array = -(half_slope * rate**2 + pull + push * across) / m
        return found
