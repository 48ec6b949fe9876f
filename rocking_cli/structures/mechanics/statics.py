"""Limit analysis of bodies that touch without tension and do not slide: the largest
horizontal acceleration that the forces on their faces can carry, and from the dual
programme the mechanism in which they then begin to move.

    max lambda: N >= 0 at both ends of every face, T and the forces of sliders free,
    equilibrium of every body under (side lambda m g, -m g)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from ...arrays import Array
from ..sketch import Point
from .assembly import (
    GROUND,
    NEAR,
    Assembly,
    Face,
    Hinge,
    Joint,
    Rigid,
    Slide,
    numbered,
)
from .moments import BOTH

_STILL = 1e-6  # of the largest velocity of the dual: a relative velocity that is zero
_TOLERANCE = 1e-10  # of the programme


class Governing(NamedTuple):
    """The mechanism that governs in one direction."""

    uplift: float  # lambda, the largest acceleration over g that is carried [-]
    joints: tuple[Joint, ...]  # its hinges, rigid groups and the sliders


@dataclass(frozen=True)
class Statics:
    """Bodies, or groups of bodies that move as one, on their faces."""

    assembly: Assembly  # bodies and loads
    # bodies that move as one; bodies in the first group stay
    groups: tuple[tuple[str, ...], ...]
    sliders: tuple[Slide, ...] = ()  # points held by sliders
    hinges: tuple[Hinge, ...] = ()  # hinges on the ground show its faces

    @cached_property
    def faces(self) -> list[Face]:
        """The faces between different groups."""
        faces = self.assembly.faces(self.hinges)
        return [face for face in faces if len(self._pair(face.bodies)) == 2]

    @cached_property
    def pins(self) -> list[Hinge]:
        """Given hinges on no face of their bodies: they carry any force."""
        near = NEAR * self.assembly.size

        def held(hinge: Hinge) -> bool:
            return any(
                self._pair(face.bodies) == self._pair(hinge.bodies)
                and np.hypot(*np.subtract(end, hinge.at)) <= near
                for face in self.faces
                for end in face.ends
            )

        apart = [one for one in self.hinges if len(self._pair(one.bodies)) == 2]
        return [hinge for hinge in apart if not held(hinge)]

    @cached_property
    def _group(self) -> dict[str, int]:
        return numbered(self.groups)

    def _pair(self, bodies: Sequence[str]) -> frozenset[int]:
        """The groups of the bodies of a face or a hinge."""
        return frozenset(self._group[name] for name in bodies)

    @cached_property
    def _matrix(self) -> tuple[Array, list[tuple[float | None, float | None]]]:
        """(equilibrium of the groups, (3 groups, forces); bounds of the forces): N at
        both ends and T of each face, then pins, then sliders.
        """
        columns: list[Array] = []
        bounds: list[tuple[float | None, float | None]] = []
        for face in self.faces:
            one, other = (self._group[name] for name in face.bodies)
            along = (-face.normal[1], face.normal[0])
            forces = [(end, face.normal) for end in face.ends] + [(face.ends[0], along)]
            columns += [self._column(one, other, at, force) for at, force in forces]
            bounds += [(0.0, None), (0.0, None), (None, None)]
        for hinge in self.pins:
            one, other = (self._group[name] for name in hinge.bodies)
            for force in ((1.0, 0.0), (0.0, 1.0)):
                columns.append(self._column(one, other, hinge.at, force))
                bounds.append((None, None))
        for slider in self.sliders:
            length = np.hypot(*slider.along)
            across = (-slider.along[1] / length, slider.along[0] / length)
            one = self._group[slider.body]
            columns.append(self._column(one, 0, slider.at, across))
            bounds.append((None, None))
        shape = (3 * (len(self.groups) - 1), 0)
        return (np.array(columns).T if columns else np.zeros(shape)), bounds

    def _column(self, one: int, other: int, at: Point, force: Point) -> Array:
        """A force on group `one`, and its reaction on group `other`, in the equations
        of equilibrium; moments in parts of the size.
        """
        column = np.zeros(3 * len(self.groups))
        moment = (at[0] * force[1] - at[1] * force[0]) / self.assembly.size
        for group, sign in ((one, 1.0), (other, -1.0)):
            column[3 * group : 3 * group + 3] = sign * np.array([*force, moment])
        return column[3:]

    def _weights(self) -> tuple[Array, Array]:
        """Equations of equilibrium of the weights that push and of the weights that
        press, over the whole weight, for lambda = 1 towards +x; (3 groups,) each.
        """
        push, press = np.zeros((2, 3 * len(self.groups)))
        parts = [(b.name, b.centre, b.mass, True) for b in self.assembly.bodies]
        parts += [
            (x.body, x.at, x.mass, x.inertia == BOTH) for x in self.assembly.loads
        ]
        moving = [part for part in parts if self._group[part[0]]]
        whole = sum(mass for _, _, mass, _ in moving)
        for name, (x, z), mass, pushes in moving:
            at = 3 * self._group[name]
            share, size = mass / whole, self.assembly.size
            press[at + 1] -= share
            press[at + 2] -= share * x / size
            if pushes:
                push[at] += share
                push[at + 2] -= share * z / size
        return push[3:], press[3:]

    def governing(self, side: float) -> Governing | None:
        """Return the mechanism that governs towards +x (side = 1) or -x; None if the
        bodies do not stand under their weight. Its lambda is infinite if nothing moves.
        """
        found = self._programme(side)
        if found.status == 3:
            return Governing(np.inf, ())
        if found.status != 0:
            return None
        velocities = -found.eqlin.marginals.reshape(-1, 3)
        moved = np.concatenate([np.zeros((1, 3)), velocities])
        return Governing(float(-found.fun), self._joints(moved))

    def stands(self, side: float) -> bool:
        """True if the faces carry the weight, without any acceleration; side: that in
        which they are known to carry some acceleration.
        """
        return self._programme(-side).status in (0, 3)

    def with_friction(self, side: float, friction: float) -> float:
        """Return the largest lambda that the faces carry with |T| <= friction (N_1 +
        N_2), an upper bound of that at which something slides or turns; 0 if they do
        not carry the weight.
        """
        found = self._programme(side, friction)
        if found.status == 3:
            return float(np.inf)
        return float(-found.fun) if found.status == 0 else 0.0

    def _programme(self, side: float, friction: float | None = None) -> Any:
        """The solution of the programme in one direction; lambda >= 0 is its last
        unknown.
        """
        from scipy.optimize import linprog

        matrix, bounds = self._matrix
        push, press = self._weights()
        slides = None
        if friction is not None and self.faces:
            slides = np.zeros((2 * len(self.faces), matrix.shape[1] + 1))
            for i in range(len(self.faces)):
                for k, sign in enumerate((1.0, -1.0)):
                    row = slides[2 * i + k]
                    row[3 * i : 3 * i + 3] = -friction, -friction, sign
        return linprog(
            np.append(np.zeros(matrix.shape[1]), -1.0),
            A_ub=slides,
            b_ub=None if slides is None else np.zeros(len(slides)),
            A_eq=np.column_stack([matrix, side * push]),
            b_eq=-press,
            bounds=[*bounds, (0.0, None)],
            method="highs",
            options={
                "primal_feasibility_tolerance": _TOLERANCE,
                "dual_feasibility_tolerance": _TOLERANCE,
            },
        )

    def _joints(self, moved: Array) -> tuple[Joint, ...]:
        """The joints of the mechanism with these velocities (x, z at the origin, and
        rotation times the size) of the groups, (groups, 3).
        """
        size, rates = self.assembly.size, self._rates(moved)
        fastest = max((abs(x) for pair in rates for x in pair), default=0.0)
        opens = [[x > _STILL * fastest for x in pair] for pair in rates]
        closed = [
            face.bodies
            for face, ends in zip(self.faces, opens, strict=True)
            if not any(ends)
        ]
        stay, *alone = self.groups
        links = self.assembly.links([*map(Rigid, ((GROUND, *stay), *closed, *alone))])
        link_of = numbered(links)
        hinges: dict[tuple[frozenset[int], Point], Hinge] = {}
        for face, ends in zip(self.faces, opens, strict=True):
            groups = frozenset(link_of[name] for name in face.bodies)
            if ends[0] != ends[1] and len(groups) == 2:
                at = face.ends[0] if ends[1] else face.ends[1]
                hinges.setdefault((groups, _rounded(at, size)), Hinge(face.bodies, at))
        order = sorted(hinges.values(), key=lambda hinge: hinge.at)
        slides = (slider for slider in self.sliders if link_of[slider.body])
        still = [Rigid((GROUND, *links[0]))] if links[0] else []
        whole = (Rigid(tuple(link)) for link in links[1:] if len(link) > 1)
        return (*order, *still, *whole, *slides)

    def _rates(self, moved: Array) -> list[list[float]]:
        """How fast both ends of each face open at these velocities."""
        rates = []
        for face in self.faces:
            one, other = (moved[self._group[name]] for name in face.bodies)
            x, z, turn = one - other
            turn /= self.assembly.size
            ends = [(x - at[1] * turn, z + at[0] * turn) for at in face.ends]
            rates.append([float(np.dot(face.normal, u)) for u in ends])
        return rates

    def carries(self, wanted: dict[str, Array], opening: Array) -> bool:
        """True if compression at the ends of faces that do not open can give these sums
        (x, z, moment about the origin) on the bodies; opening: for each face, whether
        it opens at each end, (faces, 2).
        """
        from scipy.optimize import linprog

        matrix, bounds = self._matrix[0], list(self._matrix[1])
        open_ends = zip(self.faces, opening.tolist(), strict=True)
        for i, (_, ends) in enumerate(open_ends):
            none = (0.0, 0.0)
            pair = [none if opens else (0.0, None) for opens in ends]
            # a face that is open all along has no shear either
            bounds[3 * i : 3 * i + 3] = [*pair, none if all(ends) else (None, None)]
        sums = np.zeros((len(self.groups), 3))
        for name, row in wanted.items():
            sums[self._group[name]] += row / [1.0, 1.0, self.assembly.size]
        rows = sums[1:].ravel()
        found = linprog(
            np.zeros(matrix.shape[1]),
            A_eq=matrix,
            b_eq=rows / (np.abs(rows).max() or 1.0),
            bounds=bounds,
            method="highs",
        )
        return bool(found.status == 0)


def bodies_alone(
    assembly: Assembly, staying: Sequence[str]
) -> tuple[tuple[str, ...], ...]:
    """Return each body as a group of its own, those that stay as the first group."""
    free = [(name,) for name in assembly.names if name not in staying]
    return (tuple(staying), *free)


def _rounded(at: Point, size: float) -> Point:
    return round(at[0] / size, 8), round(at[1] / size, 8)
