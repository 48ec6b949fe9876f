"""From bodies, joints and loads to the rocking parameters of a mechanism, in both
directions (independent of any document).

`find_mechanism` returns a `PlanarMechanism`; its method `parameters` returns the
`RockingParameters`. A single rigid body on two hinges becomes one of Eq. 2.3, with
a_scale = 1; every other mechanism follows Eq. 3.4.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ..parameters import RockingParameters, Side
from .admissibility import overlapping_at_rest
from .assembly import Assembly, Hinge, Joint, MechanismFault
from .joint_forces import momentum_restitution
from .mechanism_remarks import remarks_on
from .mechanism_search import mirrored_joints, searched_joints, with_coordinate
from .mechanism_side import MechanismSide
from .plane import top_arms

_EQUAL = 1e-10  # relative difference of numbers of two sides that are equal
_SHARES = np.array([0.0, 0.3, 0.7, 1.0, 1.2])  # of alpha, where the sides are compared
SIDES = {1.0: "right", -1.0: "left"}


@dataclass(frozen=True)
class PlanarMechanism:
    """A mechanism in both directions, or in one."""

    right: MechanismSide  # moves towards +x
    left: MechanismSide | None  # moves towards -x; None for a one-sided mechanism
    searched: bool  # True if its hinges were found from the outlines

    @property
    def sides(self) -> list[MechanismSide]:
        """The mechanisms of the directions in which it moves."""
        return [self.right] if self.left is None else [self.right, self.left]

    @cached_property
    def momentum(self) -> tuple[tuple[float, float], tuple[float, float]] | None:
        """(eta, kept energy) on leaving the right side and the left side; None for a
        one-sided mechanism.
        """
        if self.left is None:
            return None
        return (
            momentum_restitution(self.right, self.left),
            momentum_restitution(self.left, self.right),
        )

    @cached_property
    def alike(self) -> bool:
        """True if both sides have the same motion."""
        if self.left is None or self.momentum is None:
            return False
        (one, _), (other, _) = self.momentum
        if not math.isclose(one, other, rel_tol=_EQUAL, abs_tol=_EQUAL):
            return False
        phi = _SHARES * min(self.right.form.alpha, self.left.form.alpha)
        reach = min(one.reach_to(float(phi[-1])) for one in self.sides)
        phi = np.minimum(phi, (1.0 - 1e-6) * reach)
        pairs = zip(*(one.coefficients(phi) for one in self.sides), strict=True)
        return all(
            bool(np.abs(a - b).max() <= _EQUAL * np.abs(a).max()) for a, b in pairs
        )

    @property
    def whole(self) -> bool:
        """True if one rigid body, with the same parts, moves on every side: then the
        forces on the ground are those of Eq. 2.3.
        """
        parts = {(tuple(s.links[1]), s.masses[0].centre) for s in self.sides}
        return self._rigid_sides and len(parts) == 1

    def parameters(
        self,
        name: str,
        structure: str,
        *,
        gravity: float,
        restitution: float | None = None,
        friction: float | None = None,
    ) -> RockingParameters:
        """Return the rocking parameters.

        Parameters
        ----------
        name: of the structure
        structure: its kind
        gravity: g [m/s2]
        restitution: given instead of that from momentum [-]; needed, above -1 and up to
            0, for a one-sided mechanism
        friction: of the joints [-], with which the friction that they need is compared

        Raises
        ------
        MechanismFault
            if the mechanism does not rock, or momentum gives a negative restitution
        """
        sides = dict(zip(SIDES, self.sides, strict=False))
        etas = self._etas(restitution)
        arm = {} if self.whole else {"arm": None}
        found: dict[float, dict[str, Any]] = {
            s: {**one.numbers(gravity), "eta": etas[s], **arm}
            for s, one in sides.items()
        }
        if self.alike:
            found[-1.0] = found[1.0]
        rows = self._rows(gravity, etas if restitution is None else {})
        more: dict[str, Any] = {
            "eta_source": "momentum" if restitution is None else "given",
            "gravity": gravity,
            "details": self._details(rows),
            "remarks": self._remarks(name, rows, friction, etas),
            "top": self._tops() if self.whole else (),
        }
        carriers = {s: None if self._rigid_sides else one for s, one in sides.items()}
        if self.left is None:
            return RockingParameters(
                name=name,
                structure=structure,
                **found[1.0],
                one_sided=True,
                mechanism=carriers[1.0],
                **more,
            )
        left, right = (
            Side(SIDES[s], **found[s], mechanism=carriers[s]) for s in (-1.0, 1.0)
        )
        return RockingParameters.of_sides(name, structure, left, right, **more)

    @property
    def _rigid_sides(self) -> bool:
        """True if a single rigid body moves on every side."""
        return all(side.single for side in self.sides)

    def _etas(self, restitution: float | None) -> dict[float, float]:
        """The restitution on leaving each side. Raises MechanismFault."""
        if self.left is None:
            if restitution is None:
                raise MechanismFault(
                    "one_sided",
                    "restitution: needed for a one-sided mechanism (between -1 and 0).",
                )
            return {1.0: restitution}
        if restitution is not None:
            return {1.0: restitution, -1.0: restitution}
        assert self.momentum is not None
        etas = {side: eta for side, (eta, _) in zip(SIDES, self.momentum, strict=True)}
        if min(etas.values()) < 0.0:
            raise MechanismFault(
                "restitution",
                f"restitution: momentum gives {min(etas.values()):.3g}, that is no"
                " rocking on to the other side (loads with vertical inertia, or squat"
                " bodies); state a restitution, or inertia: none if the load is on soft"
                " bearings.",
            )
        return etas

    def _rows(
        self, gravity: float, etas: dict[float, float]
    ) -> dict[str, list[dict[str, Any]]]:
        """The joints of each side, one side if both are alike; etas: of the impacts
        from momentum, empty without.
        """
        right, left = self.right, self.left
        rows = {"right": right.joint_rows(gravity, left, etas.get(-1.0))}
        if left is not None and not self.alike:
            rows["left"] = left.joint_rows(gravity, right, etas.get(1.0))
        return rows

    def _details(self, rows: dict[str, list[dict[str, Any]]]) -> dict[str, Any]:
        """The details of `RockingParameters`: those of the side that lifts first."""
        first = self.right
        if self.left is not None and not self.alike:
            both = self.left, self.right
            first = min(both, key=lambda side: side.numbers(1.0)["uplift"])
        side = "right" if first is self.right else "left"
        found: dict[str, Any] = {
            "joints": rows[side],
            "joints_source": "searched" if self.searched else "given",
        }
        if len(rows) > 1:
            found["joints_other"] = next(r for s, r in rows.items() if s != side)
        if not first.single:
            found["a_scale_3_7"] = first.form.a_scale_3_7
        governing = self._governing()
        if governing is not None:
            found["lambda_governing"] = governing
        reactions = [row["reaction"] for row in rows[side] if "reaction" in row]
        if reactions:
            found["top_reaction"] = reactions[0]
        if self.momentum is not None:
            found["energy_kept"] = self.momentum[0][1]
        inside = self._impulses_inside()
        if inside is not None:
            found["impulses_inside"] = inside
        return found

    def _impulses_inside(self) -> bool | None:
        """True if compression inside the joints can give the impacts on both sides, as
        eta from momentum assumes; None if that is not known.
        """
        if self.left is None or self.momentum is None:
            return None
        (eta, _), (back, _) = self.momentum
        found = [self.left.impulses_inside(self.right, eta)]
        if not self.alike:
            found.append(self.right.impulses_inside(self.left, back))
        return None if None in found else all(found)

    def _governing(self) -> float | None:
        """The least acceleration over g that the faces do not carry in one of the
        directions.
        """
        found = [side.governing for side in self.sides]
        known = [one[0] for one in found if one is not None]
        return min(known) if len(known) == len(found) else None

    def _remarks(
        self,
        name: str,
        rows: dict[str, list[dict[str, Any]]],
        friction: float | None,
        etas: dict[float, float],
    ) -> tuple[str, ...]:
        """Sentences on numbers that are probably wrong."""
        found: list[str] = []
        # rows of one side where both are alike; eta of the impact onto this side
        for (side, word), of_side in zip(SIDES.items(), self.sides, strict=False):
            if word in rows:
                found += remarks_on(of_side, rows[word], friction, etas.get(-side))
        return tuple(f"{name}: {text}" for text in dict.fromkeys(found))

    def _tops(self) -> tuple[float, ...]:
        """Distances from the left and the right hinge to the farthest point of the top
        [m]; empty without outlines.
        """
        bodies = map(self.right.assembly.body, self.right.links[1])
        sides = self.left or self.right, self.right
        return top_arms(
            [p for body in bodies for p in body.outline],
            (side.hinges[0].at for side in sides),
        )


def find_mechanism(
    assembly: Assembly,
    joints: Sequence[Joint],
    *,
    other: Sequence[Joint] | None = None,
    axis: float | None = None,
    coordinate: str | None = None,
    other_coordinate: str | None = None,
    one_sided: bool = False,
) -> PlanarMechanism:
    """Return the mechanism of these bodies.

    Parameters
    ----------
    assembly: bodies and loads
    joints: hinges, sliders and rigid groups in one direction; without a hinge they are
        searched: those of the least lambda
    other: those in the other direction, None for the mirror image
    axis: x of the mirror [m], None for the middle of the outlines
    coordinate: name of the body whose rotation is theta, None for the first that turns
    other_coordinate: the same in the other direction
    one_sided: True if it moves towards +x only

    Raises
    ------
    MechanismFault
        if it is no mechanism of one degree of freedom that rocks
    """
    if pair := overlapping_at_rest(assembly):
        raise MechanismFault(
            "bodies", f"bodies: {pair[0]!r} and {pair[1]!r} overlap at rest."
        )
    about = assembly.middle if axis is None else axis
    searched = not any(isinstance(joint, Hinge) for joint in joints)
    free = tuple(joints) if searched else None
    if searched:
        joints = searched_joints(assembly, joints, 1.0)
    first = MechanismSide(assembly, tuple(joints), coordinate)
    first.require()
    if one_sided:
        if first.direction < 0.0:
            raise MechanismFault(
                "one_sided",
                "one_sided: these joints move towards -x; a one-sided mechanism moves"
                " towards +x: give its mirror image.",
            )
        return PlanarMechanism(first, None, searched)
    turning = first.turning
    there = assembly.with_bearings(about)
    if other is not None:
        again, path = tuple(other), "other_side"
    else:
        again, turning = mirrored_joints(assembly, first, about, free)
        path = "joints"
    second = with_coordinate(
        MechanismSide(there, again, path=path), other_coordinate, turning
    )
    second.require()
    if first.direction == second.direction:
        way = "+x" if first.direction > 0.0 else "-x"
        raise MechanismFault(
            "other_side",
            f"other_side: these joints move towards {way}, as the first ones do.",
        )
    sides = sorted((first, second), key=lambda side: -side.direction)
    return PlanarMechanism(sides[0], sides[1], searched)
