"""How the links of a planar mechanism move: the loops that its hinges and sliders
close, with exact first and second derivatives.

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
from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ..sketch import Point
from .assembly import Assembly, Face, Hinge, Joint, MechanismFault, Slide, numbered

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


@dataclass(frozen=True)
class LoopClosure:
    """Links that have one degree of freedom.

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
    def hinges(self) -> list[Hinge]:
        """The hinges, in the order of the joints."""
        return [joint for joint in self.joints if isinstance(joint, Hinge)]

    @cached_property
    def sliders(self) -> list[Slide]:
        """The sliders, in the order of the joints."""
        return [joint for joint in self.joints if isinstance(joint, Slide)]

    @cached_property
    def faces(self) -> list[Face]:
        """The stretches on which bodies of different links touch at rest."""
        return [
            face
            for face in self.assembly.faces(self.hinges)
            if self.link_of[face.bodies[0]] != self.link_of[face.bodies[1]]
        ]

    @cached_property
    def links(self) -> list[list[str]]:
        """Names of the bodies of each link; the first link is the ground."""
        return self.assembly.links(self.joints)

    @cached_property
    def link_of(self) -> dict[str, int]:
        """Index of the link of each body."""
        return numbered(self.links)

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
        for slider in self.sliders:
            row, t = self.chain(self.link_of[slider.body], complex(*slider.at))
            along = complex(*slider.along)
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
        rates = np.abs(self.at_rest_turning(1.0).rate[0])
        link = self.link_of[name]
        return bool(link and rates[link - 1] > _NO_TURN * rates.max())

    @property
    def sense(self) -> float:
        """sigma: the rotation of the coordinate's body, +1 counterclockwise."""
        return 1.0

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

    def at_rest_turning(self, sense: float) -> Positions:
        """Return the position at rest, with derivatives by a rotation of the
        coordinate's body in this sense.
        """
        return self._with_rates(np.zeros((1, self._unknowns)), sense)

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
    def _walks(self) -> tuple[_Walk, _Walk]:
        """The path onwards from rest, and backwards."""
        return _Walk(self, 1.0, np.pi), _Walk(self, -1.0, _BACKWARDS)

    @staticmethod
    def _predicted(start: Positions, step: Array) -> Array:
        """The unknowns a step [rad] further, to second order."""
        h = step[:, None]
        return start.q + h * (start.rate + 0.5 * h * start.drift)

    def reach_to(self, phi: float) -> float:
        """Return phi [rad], or the largest rotation before it at which the links still
        fit together.
        """
        return self._walks[0].to(phi)

    def positions(self, phi: Array) -> Positions:
        """Return the positions at rotations phi, (n,) [rad]; NaN beyond the path."""
        onward, back = self._walks
        onward.to(float(np.fmax.reduce(phi, initial=0.0)))
        back.to(-float(np.fmin.reduce(phi, initial=0.0)))
        marks, nodes = onward.marks, onward.nodes
        if back.marks.size > 1:
            marks = np.concatenate([-back.marks[:0:-1], marks])
            pairs = zip(back.nodes, nodes, strict=True)
            nodes = Positions(*(np.concatenate([a[:0:-1], b]) for a, b in pairs))
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


class _Walk:
    """The path from rest in one direction, as far as it has been followed. Newton's
    method for the positions starts from the nodes on it.
    """

    def __init__(self, links: LoopClosure, way: float, stop: float) -> None:
        self.links = links
        self.way = way  # +1 onwards, -1 backwards
        self.stop = stop  # largest |phi| [rad]
        self.step = _FIRST  # the next one that is tried [rad]
        self.marks = np.zeros(1)  # |phi| of the nodes, rising [rad]
        self.nodes = links.at_rest_turning(links.sense)

    def to(self, phi: float) -> float:
        """Follow the path to |phi| = phi [rad], or to where it ends. Return phi, or the
        end.
        """
        at, found = float(self.marks[-1]), list[tuple[float, Positions]]()
        here = Positions(*(x[-1:] for x in self.nodes))
        while at < min(phi, self.stop) and self.step > _SHORTEST:
            step = min(self.step, self.stop - at)
            guess = self.links._predicted(here, np.array([self.way * step]))
            q = self.links._closed(guess)
            jump = float(np.abs(q - guess).max())
            if jump < _JUMP:
                at = self.stop if at + step > self.stop - 1e-12 else at + step
                here = self.links._with_rates(q, self.links.sense)
                found.append((at, here))
                step = min(_LONGEST, 2.0 * step if jump < 0.1 * _JUMP else step)
            else:
                step *= 0.5
            self.step = step
        if found:
            marks, nodes = zip(*found, strict=True)
            self.marks = np.append(self.marks, marks)
            fields = zip(self.nodes, *nodes, strict=True)
            self.nodes = Positions(*(np.concatenate(x) for x in fields))
        return min(phi, at)


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
