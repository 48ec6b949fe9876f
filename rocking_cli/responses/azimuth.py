"""The direction in which two horizontal components of a record are worst for a
structure.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import cache, partial
from typing import Any

import numpy as np

from ..dynamics.method import has_direction
from ..envelopes.amplitudes import Limit
from ..errors import UsageError, counted
from ..motions.grid import as_recorded
from ..motions.recording import Recording
from ..structures.parameters import RockingParameters
from .check import Demand, OfRange, Progress, Standing, standings


def at_azimuth(pair: Sequence[Recording], azimuth: float) -> Recording:
    """Return the motion in one direction: the first component times cos(azimuth) plus
    the second times sin(azimuth); azimuth in rad.

    The shorter component is zero after its end. Both components have one factor: of
    components that are scaled to a measure that of the larger one, which reaches it.
    Raises UsageError unless there are two
    components with the same step.
    """
    if len(pair) != 2:
        raise UsageError(
            f"found {counted(len(pair), 'horizontal component')}; expected two for an"
            " azimuth"
        )
    one, two = (r.record for r in pair)
    if one.dt != two.dt:
        raise UsageError(
            f"{one.label} has a step of {one.dt:g} s and {two.label} one of {two.dt:g}"
            " s; expected equal steps"
        )
    both = np.zeros((2, max(one.npts, two.npts)))
    both[0, : one.npts], both[1, : two.npts] = one.acceleration, two.acceleration
    name = f"{math.degrees(azimuth):.6g} deg"
    turned = replace(
        one,
        component=name,
        acceleration=math.cos(azimuth) * both[0] + math.sin(azimuth) * both[1],
        header_pga=None,
    )
    factor = min((one.factor for one in pair), key=abs)
    found = Recording(turned, factor, upwards=pair[0].upwards)
    building = pair[0].building
    return found if building is None else found.on_floor(building)


def worst_azimuths(
    structures: Sequence[RockingParameters],
    pair: Sequence[Recording],
    azimuths: np.ndarray,
    limit: Limit | None = None,
    *,
    workers: int | None = None,
    progress: Progress | None = None,
) -> list[tuple[Demand, OfRange]]:
    """Return (demand in the worst direction, what the range adds to its verdict) for
    each structure. The worst direction is the one with the least capacity, among those
    that overturn the structure if there are any. Without a capacity it is the direction
    of the largest rotation, or slide, or of the largest acceleration if nothing moves.
    Structures whose sides differ are shaken in the opposite directions too.

    limit: the largest amplitude of the search for capacities, None without a search.
    Raises UsageError as `at_azimuth` and `check` do.
    """
    limit = limit if azimuths.size > 1 else None
    turned = cache(partial(at_azimuth, pair))
    tried: list[list[tuple[float, Demand]]] = []
    for s in structures:
        angles = [
            *azimuths.tolist(),
            *((azimuths + math.pi).tolist() if has_direction(s) else ()),
        ]
        tried.append(
            [
                (
                    angle,
                    (s, turned(angle).motion, as_recorded(turned(angle).acceleration)),
                )
                for angle in angles
            ]
        )
    every = [demand for several in tried for _, demand in several]
    answers = standings(every, a_max=limit, workers=workers, progress=progress)
    found = []
    for several in tried:
        own = [(*one, next(answers)) for one in several]
        azimuth, demand, least = max(own, key=_severity)
        there, further, most = max(own, key=lambda one: one[2].moved or 0.0)
        rocks = not least.falls and bool(most.moved)
        columns = {"azimuth": azimuth, "largest_azimuth": there if rocks else None}
        found.append((demand, OfRange(columns, further if rocks else None)))
    return found


def _severity(one: tuple[float, Demand, Standing]) -> tuple[Any, float]:
    """Return the severity of a demand; of those under which nothing moves the largest
    acceleration counts.
    """
    _, (_, _, grid), standing = one
    return standing.severity, float(grid.amplitude.values[0])
