"""A mechanism in one direction, with its numbers, the forces at its joints, and the
checks that it stands, rocks, and opens its joints.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ...errors import StructureError
from ..sketch import Point
from .admissibility import check_opening, check_path, opening_ends
from .assembly import Hinge, MechanismFault
from .joint_forces import JointForces, momentum_changes
from .kinematics import Linearised, linearise
from .linkage import Linkage
from .moments import Moments, edge_at
from .statics import Statics, bodies_alone

# of the work of all weights: a smaller V' or B is zero
_WORK = 1e-9


@dataclass(frozen=True)
class MechanismSide(Linkage):
    """A mechanism in one direction: its motion, and what follows from it."""

    def require(self) -> None:
        """Raise MechanismFault if the mechanism does not stand, does not rock, or its
        joints do not open.
        """
        assert self.form.alpha > 0.0

    @cached_property
    def form(self) -> Linearised:
        """The mechanism at its unstable equilibrium. Raises MechanismFault."""
        return _linearised(self)

    @cached_property
    def single(self) -> bool:
        """True for one rigid body that turns about a hinge on the ground and carries no
        load but masses that are fixed to it.
        """
        return len(self.links) == 2 and not (self.sliders or self.bearings)

    @cached_property
    def governing(self) -> tuple[float, list[Point]] | None:
        """(largest lambda that the faces carry, hinges of the mechanism in which they
        fail then); None if the outline of a body is not known.
        """
        if self._statics is None:
            return None
        found = self._statics.governing(self.direction)
        if found is None:
            return 0.0, []
        return found.uplift, [j.at for j in found.joints if isinstance(j, Hinge)]

    def slides_from(self, friction: float) -> float | None:
        """Return the lambda beyond which the faces cannot carry the weights with this
        friction, None if the outline of a body is not known.
        """
        if self._statics is None:
            return None
        return self._statics.with_friction(self.direction, friction)

    @cached_property
    def _statics(self) -> Statics | None:
        """Its bodies on their faces, each alone; None if an outline is not known."""
        return self._on_faces(self.links[0], self.hinges)

    def _on_faces(
        self, staying: Sequence[str], hinges: Sequence[Hinge]
    ) -> Statics | None:
        """Bodies on their faces, each alone but for those that stay; None if an outline
        is not known.
        """
        assembly = self.assembly
        if any(not b.outline for b in assembly.bodies if b.name not in staying):
            return None
        groups = bodies_alone(assembly, staying)
        return Statics(assembly, groups, tuple(self.sliders), tuple(hinges))

    def impulses_inside(self, before: MechanismSide, eta: float) -> bool | None:
        """True if compression inside the joints can change the motion of `before` into
        this one: the line of impulse stays inside every joint that stays closed. None
        if the outline of a body is not known.
        """
        staying = [name for name in self.links[0] if name in before.links[0]]
        statics = self._on_faces(staying, (*self.hinges, *before.hinges))
        if statics is None:
            return None
        wanted: dict[str, np.ndarray] = {}
        for change in momentum_changes(before, self, eta):
            if change.body not in staying:
                row = change.about(change.place)
                wanted[change.body] = wanted.get(change.body, np.zeros(3)) + row
        return statics.carries(wanted, opening_ends(self, statics.faces))

    def numbers(self, gravity: float) -> dict[str, float]:
        """Return p, alpha, uplift and a_scale, and the arm of a single rigid body."""
        if not self.single:
            form = self.form
            return {
                "p": math.sqrt(gravity * form.stiffness),
                "alpha": form.alpha,
                "uplift": form.uplift,
                "a_scale": form.a_scale,
            }
        (mass,), (hinge, *_) = self.masses, self.hinges
        centre = (mass.centre.real, mass.centre.imag)
        body = Moments.of(mass.mass, centre, mass.inertia)
        return edge_at(body, hinge.at, gravity)._asdict()

    def joint_rows(
        self, gravity: float, before: MechanismSide | None, eta: float | None
    ) -> list[dict[str, Any]]:
        """Return a row for each hinge and slider, with the forces at the onset and of
        the impact with which the motion of `before` changes into this one.
        """
        forces = JointForces(self, gravity)
        onset = forces.at_onset() if forces.unique else None
        struck = None
        if onset is not None and before is not None and eta is not None:
            struck = forces.impulses(before, eta)
        rows: list[dict[str, Any]] = []
        for i, hinge in enumerate(self.hinges):
            row: dict[str, Any] = {"hinge": list(hinge.bodies), "at": list(hinge.at)}
            if onset is not None and np.isfinite(onset.compression[0, i]):
                n, t = float(onset.compression[0, i]), float(onset.shear[0, i])
                row |= {"compression": n, "friction_needed": _over(t, n)}
            if struck is not None and np.isfinite(struck.compression[0, i]):
                n, t = float(struck.compression[0, i]), float(struck.shear[0, i])
                row |= {"friction_at_impact": _over(t, n)}
            rows.append(row)
        for i, slide in enumerate(self.sliders):
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
    if linkage.reach_to(1e-6) < 1e-6:
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
    try:
        form = linearise(linkage)
        # next to the lock the position found may be that of the branch behind it, on
        # which the weight drives the mechanism: the sign there is that of a rounding
        beyond = min(form.alpha / (1.0 - 1e-3), 0.5 * math.pi)
        locked = linkage.reach_to(beyond) < beyond
    except MechanismFault:
        raise
    except StructureError:  # no equilibrium, or at the very place where the links lock
        locked = True
    if locked:
        end = linkage.reach_to(0.5 * math.pi)
        found = "the weight brings it back at every rotation up to 90 deg (it hangs)."
        if end < 0.5 * math.pi:
            found = (
                f"it locks at {math.degrees(end):.3g} deg, before its weight stops"
                " bringing it back."
            )
        raise MechanismFault(path, f"no unstable equilibrium: {found}")
    check_path(linkage, form.alpha)
    return form
