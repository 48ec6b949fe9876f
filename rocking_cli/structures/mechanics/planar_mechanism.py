"""From bodies, joints and loads to the rocking parameters of a mechanism, in both
directions (independent of any document).

`find_mechanism` returns a `PlanarMechanism`; its method `parameters` returns the
`RockingParameters`. A single rigid body on two hinges becomes one of Eq. 2.3, with
a_scale = 1; every other mechanism follows Eq. 3.4.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from ...errors import StructureError
from ..parameters import RockingParameters, Side
from ..sketch import Point
from .admissibility import (
    check_opening,
    check_path,
    opening_ends,
    overlapping_at_rest,
    place,
)
from .assembly import (
    Assembly,
    Hinge,
    Joint,
    MechanismFault,
    Slide,
    mirror_image,
)
from .joint_forces import JointForces, momentum_changes, momentum_restitution
from .kinematics import Linearised, linearise
from .linkage import Linkage
from .statics import Statics, bodies_alone

_EQUAL = 1e-10  # relative difference of numbers of two sides that are equal
_SHARES = np.array([0.0, 0.3, 0.7, 1.0, 1.2])  # of alpha, where the sides are compared
_WORK = 1e-9  # of the work of all weights: a smaller V' or B is zero
_GOVERNS = 1e-6  # of lambda: a difference that is not told
SIDES = {1.0: "right", -1.0: "left"}


@dataclass(frozen=True)
class MechanismSide:
    """A mechanism in one direction."""

    linkage: Linkage  # its motion

    def require(self) -> None:
        """Raise MechanismFault if the mechanism does not stand, does not rock, or its
        joints do not open.
        """
        assert self.form.alpha > 0.0

    @cached_property
    def form(self) -> Linearised:
        """The mechanism at its unstable equilibrium. Raises MechanismFault."""
        return _linearised(self.linkage)

    @cached_property
    def single(self) -> bool:
        """True for one rigid body that turns about a hinge on the ground and carries no
        load but masses that are fixed to it.
        """
        joints = [joint for joint in self.linkage.joints if isinstance(joint, Slide)]
        one = len(self.linkage.links) == 2 and not joints
        return one and not self.linkage.bearings

    @property
    def hinges(self) -> list[Hinge]:
        """Its hinges."""
        return [joint for joint in self.linkage.joints if isinstance(joint, Hinge)]

    @property
    def sliders(self) -> list[Slide]:
        """Its sliders."""
        return [joint for joint in self.linkage.joints if isinstance(joint, Slide)]

    @cached_property
    def governing(self) -> tuple[float, list[Point]] | None:
        """(largest lambda that the faces carry, hinges of the mechanism in which they
        fail then); None if the outline of a body is not known.
        """
        linkage, assembly = self.linkage, self.linkage.assembly
        staying = linkage.links[0]
        if any(not b.outline for b in assembly.bodies if b.name not in staying):
            return None
        statics = Statics(
            assembly,
            bodies_alone(assembly, staying),
            tuple(self.sliders),
            tuple(self.hinges),
        )
        found = statics.governing(linkage.direction)
        if found is None:
            return 0.0, []
        return found.uplift, [j.at for j in found.joints if isinstance(j, Hinge)]

    def impulses_inside(self, before: MechanismSide, eta: float) -> bool | None:
        """True if compression inside the joints can change the motion of `before` into
        this one: the line of impulse stays inside every joint that stays closed. None
        if the outline of a body is not known.
        """
        assembly, linkage = self.linkage.assembly, self.linkage
        staying = [n for n in linkage.links[0] if n in before.linkage.links[0]]
        if any(not b.outline for b in assembly.bodies if b.name not in staying):
            return None
        hinges = (*self.hinges, *before.hinges)
        statics = Statics(
            assembly, bodies_alone(assembly, staying), tuple(self.sliders), hinges
        )
        wanted: dict[str, np.ndarray] = {}
        for change in momentum_changes(before.linkage, linkage, eta):
            if change.body not in staying:
                row = change.about(change.place)
                wanted[change.body] = wanted.get(change.body, np.zeros(3)) + row
        return statics.carries(wanted, opening_ends(linkage, statics.faces))

    def arm(self) -> tuple[float, float]:
        """Return (R [m], inertia about the hinge [kg m2]) of a single rigid body."""
        (hinge,), (mass,) = self.hinges[:1], self.linkage.masses
        radius = abs(mass.centre - complex(*hinge.at))
        return radius, mass.inertia + mass.mass * radius**2

    def numbers(self, gravity: float) -> dict[str, float]:
        """Return p, alpha, uplift and a_scale."""
        if not self.single:
            form = self.form
            return {
                "p": math.sqrt(gravity * form.stiffness),
                "alpha": form.alpha,
                "uplift": form.uplift,
                "a_scale": form.a_scale,
            }
        radius, inertia = self.arm()
        (mass,) = self.linkage.masses
        off = mass.centre - complex(*self.hinges[0].at)
        return {
            "p": math.sqrt(gravity * radius * mass.mass / inertia),
            "alpha": math.atan2(abs(off.real), off.imag),
            "uplift": abs(off.real) / off.imag,
            "a_scale": 1.0,
        }

    def joint_rows(
        self, gravity: float, before: MechanismSide | None, eta: float | None
    ) -> list[dict[str, Any]]:
        """Return a row for each hinge and slider, with the forces at the onset and of
        the impact with which the motion of `before` changes into this one.
        """
        forces = JointForces(self.linkage, gravity)
        onset = forces.at_onset() if forces.unique else None
        struck = None
        if onset is not None and before is not None and eta is not None:
            struck = forces.impulses(before.linkage, eta)
        rows: list[dict[str, Any]] = []
        for i, hinge in enumerate(forces.hinges):
            row: dict[str, Any] = {"hinge": list(hinge.bodies), "at": list(hinge.at)}
            if onset is not None and np.isfinite(onset.compression[0, i]):
                n, t = float(onset.compression[0, i]), float(onset.shear[0, i])
                row |= {"compression": n, "friction_needed": _over(t, n)}
            if struck is not None and np.isfinite(struck.compression[0, i]):
                n, t = float(struck.compression[0, i]), float(struck.shear[0, i])
                row |= {"friction_at_impact": _over(t, n)}
            rows.append(row)
        for i, slide in enumerate(forces.sliders):
            row = {
                "slide": slide.body,
                "at": list(slide.at),
                "along": list(slide.along),
            }
            if onset is not None:
                row["reaction"] = abs(float(onset.sliders[0, i]))
            rows.append(row)
        return rows


def _over(shear: float, compression: float) -> float | None:
    """|T|/N, None without compression."""
    return abs(shear) / compression if compression > 0.0 else None


def _linearised(linkage: Linkage) -> Linearised:
    """Return the mechanism at its unstable equilibrium, and check that it stands, is
    driven by the ground, and that its joints open. Raises MechanismFault.
    """
    rest, path = linkage.at_rest, linkage.path
    if not linkage.reach > 1e-6:
        raise MechanismFault(
            path,
            "joints: the bodies move only infinitely little: take a joint away, or a"
            " rigid group apart.",
        )
    rates = linkage.motion(linkage.positions(np.zeros(1)), linkage.weighed.chains).rate
    work = float(np.abs(rates[0]) @ linkage.weighed.weight)
    if abs(rest.push) <= _WORK * work:
        raise MechanismFault(
            path,
            "joints: horizontal motion of the ground does not move this mechanism.",
        )
    if abs(rest.lift) <= _WORK * work:
        raise MechanismFault(
            path,
            "joints: the weight does not resist this mechanism (it rises by nothing at"
            " rest).",
        )
    check_opening(linkage)
    _check_equilibrium(linkage)
    try:
        form = linearise(linkage)
    except MechanismFault:
        raise
    except StructureError:  # at the very place where the links lock
        raise _locked(linkage) from None
    check_path(linkage, form.alpha)
    return form


def _check_equilibrium(linkage: Linkage) -> None:
    """Raise MechanismFault if the weight resists the mechanism to the end."""
    phi = np.linspace(0.0, linkage.reach, 513)
    if np.any(linkage.coefficients(phi).lift <= 0.0):
        return
    if linkage.reach >= 0.5 * math.pi:
        raise MechanismFault(
            linkage.path,
            "no unstable equilibrium: the weight brings it back at every rotation up to"
            " 90 deg (it hangs).",
        )
    raise _locked(linkage)


def _locked(linkage: Linkage) -> MechanismFault:
    return MechanismFault(
        linkage.path,
        f"no unstable equilibrium: it locks at {math.degrees(linkage.reach):.3g} deg,"
        " before its weight stops bringing it back.",
    )


@dataclass(frozen=True)
class PlanarMechanism:
    """A mechanism in both directions, or in one."""

    right: MechanismSide  # moves towards +x
    left: MechanismSide | None  # moves towards -x; None for a one-sided mechanism
    searched: bool  # True if its hinges were found from the outlines

    @cached_property
    def momentum(self) -> tuple[tuple[float, float], tuple[float, float]] | None:
        """(eta, kept energy) on leaving the right side and the left side; None for a
        one-sided mechanism.
        """
        if self.left is None:
            return None
        one, other = self.right.linkage, self.left.linkage
        return momentum_restitution(one, other), momentum_restitution(other, one)

    @cached_property
    def alike(self) -> bool:
        """True if both sides have the same motion."""
        if self.left is None or self.momentum is None:
            return False
        (one, _), (other, _) = self.momentum
        if not math.isclose(one, other, rel_tol=_EQUAL, abs_tol=_EQUAL):
            return False
        phi = _SHARES * min(self.right.form.alpha, self.left.form.alpha)
        pairs = zip(
            self.right.linkage.coefficients(phi),
            self.left.linkage.coefficients(phi),
            strict=True,
        )
        return all(
            bool(np.abs(a - b).max() <= _EQUAL * np.abs(a).max()) for a, b in pairs
        )

    @property
    def whole(self) -> bool:
        """True if one rigid body, with the same parts, moves on every side: then the
        forces on the ground are those of Eq. 2.3.
        """
        sides = [side for side in (self.right, self.left) if side is not None]
        parts = {(tuple(s.linkage.links[1]), s.linkage.masses[0].centre) for s in sides}
        return all(side.single for side in sides) and len(parts) == 1

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
        sides = {1.0: self.right} | ({-1.0: self.left} if self.left else {})
        etas = self._etas(restitution)
        arms = {s: one.arm()[0] for s, one in sides.items()} if self.whole else {}
        found: dict[float, dict[str, Any]] = {
            s: {**one.numbers(gravity), "eta": etas[s], "arm": arms.get(s)}
            for s, one in sides.items()
        }
        if self.alike:
            found[-1.0] = found[1.0]
        rows = self._rows(gravity, etas if restitution is None else {})
        more: dict[str, Any] = {
            "eta_source": "momentum" if restitution is None else "given",
            "gravity": gravity,
            "details": self._details(rows),
            "remarks": self._remarks(name, rows, friction, gravity, etas),
            "top": self._tops() if self.whole else (),
        }
        carriers = {
            s: None if self._rigid_sides else one.linkage for s, one in sides.items()
        }
        if self.left is None:
            return RockingParameters(
                name,
                structure,
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
        return self.right.single and (self.left is None or self.left.single)

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
            first = min(
                (self.left, self.right), key=lambda side: side.numbers(1.0)["uplift"]
            )
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
        sides = [side for side in (self.right, self.left) if side is not None]
        found = [side.governing for side in sides]
        known = [one[0] for one in found if one is not None]
        return min(known) if len(known) == len(found) else None

    def _remarks(
        self,
        name: str,
        rows: dict[str, list[dict[str, Any]]],
        friction: float | None,
        gravity: float,
        etas: dict[float, float],
    ) -> tuple[str, ...]:
        """Sentences on numbers that are probably wrong."""
        sides = {"right": self.right, "left": self.left}
        found: list[str] = []
        for which, of_joints in rows.items():
            side = sides[which]
            assert side is not None
            uplift = side.numbers(gravity)["uplift"]
            found += _on_governing(side, uplift)
            found += _on_hardening(side)
            found += [
                _on_onset(row, friction)
                for row in of_joints
                if "hinge" in row and _on_onset(row, friction)
            ]
            if not JointForces(side.linkage, gravity).unique:
                found.append(
                    "the forces at the joints are not unique (more than two columns);"
                    " none are printed."
                )
            eta = etas.get(-1.0 if which == "right" else 1.0, 0.0)  # onto this side
            found += [
                f"at the impact the joint at {place(row['at'])} would have to pull: eta"
                f" = {eta:.2g} from momentum holds it closed."
                for row in of_joints
                if row.get("friction_at_impact", 0.0) is None
            ]
        return tuple(f"{name}: {text}" for text in dict.fromkeys(found))

    def _tops(self) -> tuple[float, ...]:
        """Distances from the left and the right hinge to the farthest point of the top
        [m]; empty without outlines.
        """
        linkage = self.right.linkage
        bodies = [linkage.assembly.body(name) for name in linkage.links[1]]
        points = [p for body in bodies for p in body.outline]
        highest = max((z for _, z in points), default=0.0)
        top = [p for p in points if highest - p[1] <= 1e-9 * linkage.assembly.size]
        hinges = [side.hinges[0].at for side in (self.left or self.right, self.right)]
        return tuple(max(math.dist(at, p) for p in top) for at in hinges if top)


def _on_governing(side: MechanismSide, uplift: float) -> list[str]:
    if side.governing is None or not side.governing[0] < uplift * (1.0 - _GOVERNS):
        return []
    least, hinges = side.governing
    if not hinges:
        return [
            "the bodies do not stand under their weight without tension at a joint."
        ]
    where = ", ".join(place(at) for at in hinges)
    return [
        f"it moves from {least:.3g} g on, in another mechanism (hinges at {where});"
        f" lambda = {uplift:.3g} is that of the joints given."
    ]


def _on_hardening(side: MechanismSide) -> list[str]:
    if side.single or not side.linkage.lift_slope(0.0) > 0.0:
        return []
    return [
        "the weight's resistance grows with the rotation at first: lambda is not the"
        " largest acceleration that it resists."
    ]


def _on_onset(row: dict[str, Any], friction: float | None) -> str:
    """A sentence on a hinge that lifts off or slides at the onset, else an empty
    text.
    """
    where, compression = place(row["at"]), row.get("compression")
    if compression is None:
        return ""
    if not compression > 0.0:
        return (
            f"the hinge at {where} is in tension at the onset"
            f" ({compression / 1e3:.3g} kN): it lifts off before."
        )
    needed = row["friction_needed"]
    if friction is not None and needed > friction:
        return f"the joint at {where} needs a friction of {needed:.2g} at the onset."
    return ""


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
    first = MechanismSide(Linkage(assembly, tuple(joints), coordinate))
    first.require()
    if one_sided:
        if first.linkage.direction < 0.0:
            raise MechanismFault(
                "one_sided",
                "one_sided: these joints move towards -x; a one-sided mechanism moves"
                " towards +x: give its mirror image.",
            )
        return PlanarMechanism(first, None, searched)
    turning = first.linkage.turning
    there = assembly.with_bearings(about)
    if other is not None:
        again, path = tuple(other), "other_side"
    else:
        again, turning = _mirrored(assembly, first.linkage, about, free)
        path = "joints"
    second = MechanismSide(
        _named(Linkage(there, again, path=path), other_coordinate, turning)
    )
    second.require()
    if first.linkage.direction == second.linkage.direction:
        way = "+x" if first.linkage.direction > 0.0 else "-x"
        raise MechanismFault(
            "other_side",
            f"other_side: these joints move towards {way}, as the first ones do.",
        )
    sides = sorted((first, second), key=lambda side: -side.linkage.direction)
    return PlanarMechanism(sides[0], sides[1], searched)


def searched_joints(
    assembly: Assembly, joints: Sequence[Joint], side: float
) -> tuple[Joint, ...]:
    """Return the joints of the mechanism of the least lambda towards +x (side = 1) or
    -x; joints: the sliders and rigid groups that are given. Raises MechanismFault.
    """
    links = assembly.links(
        (*joints, *(Hinge((name, name), (0.0, 0.0)) for name in assembly.names))
    )
    sliders = tuple(joint for joint in joints if isinstance(joint, Slide))
    statics = Statics(assembly, tuple(tuple(link) for link in links), sliders)
    found = statics.governing(side)
    if found is None or not statics.stands(side):
        raise MechanismFault(
            "bodies",
            "it does not stand: the bodies do not carry their weight without tension at"
            f" a joint (edges at z = {assembly.ground_level:g} m stand on the ground).",
        )
    if not found.joints:
        raise MechanismFault(
            "joints",
            "joints: the bodies cannot move: take a joint away, or a rigid group"
            " apart.",
        )
    return found.joints


def _mirrored(
    assembly: Assembly, first: Linkage, axis: float, free: tuple[Joint, ...] | None
) -> tuple[tuple[Joint, ...], str]:
    """Return (joints in the other direction, body of its coordinate): the mirror image,
    or where hinges are searched and another mechanism governs there, that one. free:
    the given sliders and rigid groups if hinges are searched, else None. Raises
    MechanismFault.
    """
    turning, image = first.turning, assembly.images(axis)
    named = {
        name
        for joint in first.joints
        for name in ((joint.body,) if isinstance(joint, Slide) else joint.bodies)
    }
    lacking = [name for name in assembly.names if name in named - image.keys()]
    again: tuple[Joint, ...] = ()
    if not lacking:
        again = mirror_image(first.joints, image, axis)
        turning = image.get(turning, turning)
    if free is not None:
        there = assembly.with_bearings(axis)
        own = searched_joints(there, free, -first.direction)
        if lacking or not _same_uplift(there, again, own):
            return own, first.turning
    elif lacking:
        raise MechanismFault(
            "other_side",
            f"other_side: {lacking[0]!r} has no mirror image about x = {axis:g} m: list"
            " the joints of the other side.",
        )
    return again, turning


def _same_uplift(
    assembly: Assembly, one: tuple[Joint, ...], other: tuple[Joint, ...]
) -> bool:
    """True if two mechanisms of the same bodies have the same lambda."""
    rests = [Linkage(assembly, joints).at_rest for joints in (one, other)]
    first, second = (abs(rest.lift / rest.push) for rest in rests)
    return math.isclose(first, second, rel_tol=_EQUAL)


def _named(linkage: Linkage, stated: str | None, turning: str) -> Linkage:
    """Return the mechanism with the stated coordinate; or else with that of the other
    direction, if this body turns here.
    """
    if stated is not None:
        if not linkage.turns(stated):
            raise MechanismFault(
                "rotation_of_other",
                f"rotation_of_other: {stated!r} does not rotate: name another body.",
            )
        return replace(linkage, coordinate=stated)
    return replace(linkage, coordinate=turning) if linkage.turns(turning) else linkage
