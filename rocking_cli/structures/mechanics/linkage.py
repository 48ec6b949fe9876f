"""The motion of any planar mechanism of rigid bodies with one degree of freedom, with
exact first and second derivatives, and the coefficients of Eq. 3.4.

Bodies of a link turn together; a hinge to a link whose place is known gives the place
of the next link. So every point is a sum over the links j of D_j exp(i theta_j) in the
complex plane x + i z, plus the translations of links that no chain of hinges connects
to the ground. The hinges and sliders that are left close the loops, C(q) = 0, with

    J q' = 0, theta_c' = sigma           (sigma = +1 or -1, c the coordinate's body)
    J q'' = Re(sum K_j exp(i theta_j) theta_j'^2), theta_c'' = 0
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from ..sketch import Point
from .assembly import (
    BOTH,
    GROUND,
    NONE,
    Assembly,
    Hinge,
    Joint,
    MechanismFault,
    PlanarBody,
    Slide,
)
from .kinematics import Coefficients

Array = np.ndarray

_CLOSED = 1e-9  # of the size: the largest gap of a closed loop
_NO_TURN = 1e-9  # of the fastest motion: a body that turns less does not turn
_JUMP = 3e-3  # largest distance of a node from its prediction, over the size
_SHORTEST, _LONGEST, _FIRST = 1e-10, 0.05, 0.005  # rad, steps between nodes
_BACKWARDS = 0.8  # rad, how far nodes go beyond rest for the fit of the coefficients


class Positions(NamedTuple):
    """The unknowns along the path: the rotation of each link, then translations over
    the size. Every array is (n, unknowns).
    """

    q: Array  # the unknowns [rad, -]
    rate: Array  # dq/dphi
    drift: Array  # d2q/dphi2


class PointMotion(NamedTuple):
    """Points along the path, as complex numbers x + i z. Every array is (n, points)."""

    place: Array  # [m]
    rate: Array  # d/dphi [m]
    drift: Array  # d2/dphi2 [m]


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
class Linkage:
    """A mechanism of one degree of freedom in one direction.

    Raises
    ------
    MechanismFault
        on use, when the bodies do not have one degree of freedom, or the body of the
        coordinate does not turn
    """

    assembly: Assembly  # bodies and loads
    joints: tuple[Joint, ...]  # hinges, sliders and rigid groups
    # name of the body whose rotation is phi; None for the first one that turns
    coordinate: str | None = None
    path: str = "joints"  # path of the key that states the joints

    @cached_property
    def links(self) -> list[list[str]]:
        """Names of the bodies of each link; the first link is the ground."""
        return self.assembly.links(self.joints)

    @cached_property
    def link_of(self) -> dict[str, int]:
        """Index of the link of each body."""
        found = {name: i for i, link in enumerate(self.links) for name in link}
        return {GROUND: 0} | found

    @cached_property
    def _chains(self) -> tuple[Array, Array, list[int]]:
        """(D and T of the origin of each link, (links, links) and (links,
        translations); indices of the hinges that close a loop).
        """
        count, size = len(self.links), self.assembly.size
        origin = np.zeros((count, count), dtype=complex)
        moved = np.zeros((count, count, 2), dtype=complex)
        roots: list[int] = []
        known, waiting = {0}, self._between_links()
        while len(known) < count:
            for i, (a, b, p) in list(waiting.items()):
                if (a in known) != (b in known):
                    old, new = (a, b) if a in known else (b, a)
                    origin[new], moved[new] = origin[old], moved[old]
                    origin[new, old] += p
                    origin[new, new] -= p
                    known.add(new)
                    del waiting[i]
                    break
            else:  # no chain of hinges leads to the ground
                root = next(i for i in range(count) if i not in known)
                moved[root, root] = size, 1j * size
                roots.append(root)
                known.add(root)
        translations = moved[:, roots].reshape(count, 2 * len(roots))
        return origin, translations, list(waiting)

    def _between_links(self) -> dict[int, tuple[int, int, complex]]:
        """(link, link, place) of each hinge, by the index of its joint."""
        found = {}
        for i, joint in enumerate(self.joints):
            if isinstance(joint, Hinge):
                one, other = joint.bodies
                ends = self.link_of[one], self.link_of[other]
                found[i] = (*ends, complex(*joint.at))
        return found

    def chain(self, link: int, place: complex) -> tuple[Array, Array]:
        """Return D, (links,), and T, (translations,), of a point of a link."""
        origin, moved, _ = self._chains
        row = origin[link].copy()
        row[link] += place
        return row, moved[link]

    @cached_property
    def _loops(self) -> tuple[Array, Array]:
        """K and T of the equations that close the loops, in parts of the size:
        (equations, links), (equations, translations).
        """
        rows: list[Array] = []
        moved: list[Array] = []
        hinges = self._between_links()
        for i in self._chains[2]:
            a, b, p = hinges[i]
            (one, t_one), (other, t_other) = self.chain(a, p), self.chain(b, p)
            rows += [one - other, -1j * (one - other)]
            moved += [t_one - t_other, -1j * (t_one - t_other)]
        for joint in self.joints:
            if isinstance(joint, Slide):
                row, t = self.chain(self.link_of[joint.body], complex(*joint.at))
                along = complex(*joint.along)
                across = np.conj(1j * along / abs(along))
                rows.append(across * row)
                moved.append(across * t)
        shape = len(self.links), self._chains[1].shape[1]
        size = self.assembly.size
        return (
            np.array(rows).reshape(len(rows), shape[0]) / size,
            np.real(np.array(moved).reshape(len(rows), shape[1])) / size,
        )

    def _slopes(self, turned: Array) -> Array:
        """J at exp(i theta), (n, links): (n, equations, unknowns); the ground has no
        unknown.
        """
        loops, moved = self._loops
        by_turn = np.real(1j * loops[:, 1:] * turned[:, None, 1:])
        shape = (len(turned), *moved.shape)
        return np.concatenate([by_turn, np.broadcast_to(moved, shape)], axis=2)

    @cached_property
    def _frame(self) -> tuple[int, Array, Array]:
        """(index of the coordinate among the unknowns; the other unknowns; equations
        that are independent at rest). Raises MechanismFault.
        """
        count = len(self.links)
        if count == 1:
            raise MechanismFault(self.path, _CANNOT_MOVE)
        self._require_distinct_hinges()
        slopes = self._slopes(np.ones((1, count), dtype=complex))[0]
        sizes, field = np.zeros(0), np.eye(slopes.shape[1])
        if len(slopes):
            _, sizes, field = np.linalg.svd(slopes, full_matrices=True)
        rank = int(np.sum(sizes > _CLOSED * max(sizes.max(initial=0.0), 1e-3)))
        freedom = slopes.shape[1] - rank
        if freedom == 0:
            raise MechanismFault(self.path, _CANNOT_MOVE)
        if freedom > 1:
            raise MechanismFault(
                self.path,
                f"joints: the bodies have {freedom} degrees of freedom at rest; a"
                " mechanism has one. Add a hinge or a slider, or join bodies in a rigid"
                " group.",
            )
        motion = np.abs(field[-1])
        turns = motion[: count - 1] > _NO_TURN * motion.max()
        at = self._coordinate(turns)
        others = np.delete(np.arange(slopes.shape[1]), at)
        return at, others, _independent(slopes[:, others], rank)

    def _require_distinct_hinges(self) -> None:
        """Raise MechanismFault for a hinge inside a link, or given twice."""
        seen = set()
        for i, (a, b, p) in self._between_links().items():
            where, joint = f"{self.path}.{i}", self.joints[i]
            assert isinstance(joint, Hinge)
            one, other = joint.bodies
            if a == b:
                raise MechanismFault(
                    where,
                    f"{where}: {one!r} and {other!r} move as one already: take the"
                    " hinge or the rigid group away.",
                )
            if (found := (frozenset((a, b)), p)) in seen:
                raise MechanismFault(where, f"{where}: this hinge is given twice.")
            seen.add(found)

    def _coordinate(self, turns: Array) -> int:
        """Index of the link whose rotation is phi, less one. turns: True for each link
        that turns at rest, (links - 1,).
        """
        if self.coordinate is None:
            if not turns.any():
                name = self.links[1][0]
                raise MechanismFault(
                    "rotation_of",
                    f"rotation_of: {name!r} does not rotate, nor does any other body.",
                )
            first = [
                self.link_of[name]
                for name in self.assembly.names
                if self.link_of[name] and turns[self.link_of[name] - 1]
            ]
            return first[0] - 1
        at = self.link_of[self.coordinate] - 1
        if at < 0 or not turns[at]:
            raise MechanismFault(
                "rotation_of",
                f"rotation_of: {self.coordinate!r} does not rotate: name another body.",
            )
        return at

    @property
    def turning(self) -> str:
        """The name of the body whose rotation is phi."""
        return self.coordinate or self.links[self._frame[0] + 1][0]

    def turns(self, name: str) -> bool:
        """True if a body turns at rest."""
        rates = np.abs(self._with_rates(np.zeros((1, self._unknowns)), 1.0).rate[0])
        link = self.link_of[name]
        return bool(link and rates[link - 1] > _NO_TURN * rates.max())

    @cached_property
    def sense(self) -> float:
        """sigma: the rotation of the coordinate's body, +1 counterclockwise, for which
        V'(0) > 0; +1 if V'(0) = 0.
        """
        rest = self._with_rates(np.zeros((1, self._unknowns)), 1.0)
        return 1.0 if self._coefficients(rest).lift[0] >= 0.0 else -1.0

    @property
    def _unknowns(self) -> int:
        return len(self.links) - 1 + self._chains[1].shape[1]

    def turned(self, q: Array) -> Array:
        """exp(i theta) of each link, (n, links)."""
        count = len(self.links)
        angles = np.concatenate([np.zeros((len(q), 1)), q[:, : count - 1]], axis=1)
        return np.exp(1j * angles)

    def _gaps(self, q: Array, turned: Array) -> Array:
        """C of all equations, in parts of the size, (n, equations)."""
        loops, moved = self._loops
        translated = q[:, len(self.links) - 1 :]
        return np.real((turned - 1.0) @ loops.T) + translated @ moved.T

    def _closed(self, q: Array) -> Array:
        """Return the unknowns that close the loops, by Newton's method from q, at the
        rotation of the coordinate that q has; NaN where it does not converge.
        """
        _, others, rows = self._frame
        q = q.copy()
        if not others.size:
            return q
        with np.errstate(all="ignore"):
            for _ in range(8):
                turned = self.turned(q)
                slopes = self._slopes(turned)[:, rows][:, :, others]
                step = _solved(slopes, self._gaps(q, turned)[:, rows])
                q[:, others] -= step
                if not np.nanmax(np.abs(step), initial=0.0) > 1e-13:
                    break
            off = np.abs(self._gaps(q, self.turned(q))).max(axis=1)
        q[~(off < _CLOSED)] = np.nan
        return q

    def _with_rates(self, q: Array, sense: float) -> Positions:
        """Return positions with the exact derivatives of q, by the rotation of the
        coordinate in this sense.
        """
        at, others, rows = self._frame
        turned = self.turned(q)
        rate, drift = np.zeros(q.shape), np.zeros(q.shape)
        rate[:, at] = sense
        if others.size:
            slopes = self._slopes(turned)[:, rows]
            left = slopes[:, :, others]
            rate[:, others] = -sense * _solved(left, slopes[:, :, at])
            square = rate[:, : len(self.links) - 1] ** 2
            pull = np.real((turned[:, 1:] * square) @ self._loops[0][rows, 1:].T)
            drift[:, others] = _solved(left, pull)
        return Positions(q, rate, drift)

    @cached_property
    def _nodes(self) -> tuple[Array, Positions]:
        """Places on the path from which Newton's method starts: their phi, rising, and
        positions; before rest too.
        """
        back = self._walk(-1.0, _BACKWARDS)
        onward = self._walk(1.0, 0.5 * np.pi)
        phi = np.array([p for p, _ in (*back[:0:-1], *onward)])
        parts = [found for _, found in (*back[:0:-1], *onward)]
        fields = (np.concatenate(x) for x in zip(*parts, strict=True))
        return phi, Positions(*fields)

    def _walk(self, way: float, stop: float) -> list[tuple[float, Positions]]:
        """Follow the path from rest to |phi| = stop, or to where it ends."""
        phi, step = 0.0, _FIRST
        here = self._with_rates(np.zeros((1, self._unknowns)), self.sense)
        found = [(0.0, here)]
        while phi < stop and step > _SHORTEST:
            step = min(step, stop - phi)
            guess = self._predicted(here, np.array([way * step]))
            q = self._closed(guess)
            jump = float(np.abs(q - guess).max())
            if jump < _JUMP:
                phi = stop if phi + step > stop - 1e-12 else phi + step
                here = self._with_rates(q, self.sense)
                found.append((way * phi, here))
                step = min(_LONGEST, 2.0 * step if jump < 0.1 * _JUMP else step)
            else:
                step *= 0.5
        return found

    @staticmethod
    def _predicted(start: Positions, step: Array) -> Array:
        """The unknowns a step [rad] further, to second order."""
        h = step[:, None]
        return start.q + h * (start.rate + 0.5 * h * start.drift)

    @cached_property
    def reach(self) -> float:
        """Largest phi [rad] at which the links still fit together, at most pi/2."""
        return float(self._nodes[0][-1])

    def positions(self, phi: Array) -> Positions:
        """Return the positions at rotations phi, (n,) [rad]; NaN beyond the path."""
        marks, nodes = self._nodes
        at = np.clip(np.searchsorted(marks, phi), 1, marks.size - 1)
        at -= phi - marks[at - 1] < marks[at] - phi
        start = Positions(*(x[at] for x in nodes))
        return self._with_rates(
            self._closed(self._predicted(start, phi - marks[at])), self.sense
        )

    def motion(self, at: Positions, points: tuple[Array, Array]) -> PointMotion:
        """Return the motion of points; points: their D, (points, links), and T,
        (points, translations).
        """
        count = len(self.links) - 1
        chains, moved = points
        turned, rate, drift = self.turned(at.q), at.rate[:, :count], at.drift[:, :count]
        arms = turned[:, 1:] * 1j
        through = chains[:, 1:].T
        return PointMotion(
            turned @ chains.T + at.q[:, count:] @ moved.T,
            (arms * rate) @ through + at.rate[:, count:] @ moved.T,
            (arms * (drift + 1j * rate * rate)) @ through
            + at.drift[:, count:] @ moved.T,
        )

    def chains(self, places: Sequence[tuple[str, Point]]) -> tuple[Array, Array]:
        """Return D and T of points of bodies."""
        found = [self.chain(self.link_of[name], complex(*at)) for name, at in places]
        count, translations = len(self.links), self._chains[1].shape[1]
        return (
            np.array([d for d, _ in found]).reshape(len(found), count),
            np.array([t for _, t in found]).reshape(len(found), translations),
        )

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
        rest = self._with_rates(np.zeros((1, self._unknowns)), self.sense)
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


_CANNOT_MOVE = (
    "joints: the bodies cannot move: take a joint away, or a rigid group apart."
)


def _solved(left: Array, right: Array) -> Array:
    """Solve left x = right, (n, k, k) and (n, k); NaN where left is singular."""
    if left.shape[1] == 1:
        return right / left[:, :, 0]
    try:
        found: Array = np.linalg.solve(left, right[:, :, None])[:, :, 0]
    except np.linalg.LinAlgError:
        found = np.full(right.shape, np.nan)
        for i, (a, b) in enumerate(zip(left, right, strict=True)):
            if np.linalg.cond(a) < 1e15:
                found[i] = np.linalg.solve(a, b)
    return found


def _independent(rows: Array, rank: int) -> Array:
    """Return the indices of `rank` rows that are independent, by elimination with the
    longest remaining row first.
    """
    left, found = rows.copy(), list[int]()
    for _ in range(rank):
        found.append(int(np.linalg.norm(left, axis=1).argmax()))
        unit = left[found[-1]] / np.linalg.norm(left[found[-1]])
        left = left - np.outer(left @ unit, unit)
    return np.sort(np.array(found, dtype=np.int64))
