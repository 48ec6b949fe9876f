"""Demands on structures that stand on the floor of a building."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from ..errors import UsageError
from ..structures.building_modes import FloorMode
from ..structures.parameters import RockingParameters
from .grid import Grid, as_recorded
from .motion import Motion

NEEDS_UNITS = (
    "a building goes with an amplitude and a frequency that have units: expected a_g"
    " and f_g, T_g or omega_g"
)


def moved_by_floor(
    ground: Motion, shaking: Grid, modes: Sequence[FloorMode]
) -> tuple[Motion, Grid]:
    """Return the motion of a floor and its demand, for that of the ground; the demand
    stays that of the ground. Raises UsageError for a pulse whose amplitude or frequency
    is dimensionless.
    """
    from .buildings import Building, floor_of

    building = Building(tuple(modes))
    if ground.acceleration is not None:
        return floor_of(ground, building), shaking
    if shaking.dimensionless or shaking.amplitude.name != "a_g":
        raise UsageError(NEEDS_UNITS)
    a_g = float(shaking.amplitude.values[0])
    omega = float(shaking.frequency.values[0])
    return floor_of(ground, building, a_g, omega), as_recorded(a_g)


def on_floors(
    demands: Sequence[tuple[RockingParameters, Motion, Grid]],
) -> Sequence[tuple[RockingParameters, Motion, Grid]]:
    """Return demands (structure, motion, shaking) with each structure that stands in a
    building under the motion of its floor; the motion of a floor stays as it is. Raises
    UsageError as `moved_by_floor`.
    """
    if not any(structure.building for structure, _, _ in demands):
        return demands
    # of each motion, demand and building; structures in one building share its motion
    known: dict[tuple[Any, ...], tuple[Motion, Grid]] = {}
    found = []
    for structure, motion, shaking in demands:
        modes = structure.building
        if modes:
            structure = replace(structure, building=())
        if modes and motion.floor is None:
            key = id(motion), id(shaking), modes
            if key not in known:
                known[key] = moved_by_floor(motion, shaking, modes)
            motion, shaking = known[key]
        found.append((structure, motion, shaking))
    return found
