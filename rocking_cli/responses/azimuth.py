"""The direction in which two horizontal components of a record are worst for a
structure.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from functools import cache, partial
from itertools import islice

import numpy as np

from ..dynamics.method import has_direction
from ..errors import UsageError, counted
from ..motions.grid import as_recorded
from ..motions.recording import Recording
from ..structures.parameters import RockingParameters
from .check import Demand, Progress, verdicts
from .verdict import Verdict


def at_azimuth(pair: Sequence[Recording], azimuth: float) -> Recording:
    """Return the motion in one direction: the first component times cos(azimuth) plus
    the second times sin(azimuth); azimuth in rad.

    The shorter component is zero after its end. Raises UsageError unless there are two
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
    found = Recording(turned, pair[0].factor, upwards=pair[0].upwards)
    building = pair[0].building
    return found if building is None else found.on_floor(building)


def worst_azimuths(
    structures: Sequence[RockingParameters],
    pair: Sequence[Recording],
    azimuths: np.ndarray,
    *,
    workers: int | None = None,
    progress: Progress | None = None,
) -> list[tuple[float, Demand]]:
    """Return (worst azimuth [rad], demand) for each structure: the first azimuth that
    overturns it; if none does, that of the largest rotation, or of the largest
    acceleration if nothing rocks. Structures whose sides differ are shaken in the
    opposite directions too.

    Raises UsageError as `at_azimuth` and `check` do.
    """
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
    found = verdicts(
        [demand for several in tried for _, demand in several],
        a_max=None,
        workers=workers,
        progress=progress,
    )
    return [
        max(
            zip(map(_rank, islice(found, len(several))), several, strict=True),
            key=lambda pair: pair[0],
        )[1]
        for several in tried
    ]


def _rank(verdict: Verdict) -> tuple[bool, float, float]:
    share = 0.0 if verdict.uplift_a is None else verdict.demand_a / verdict.uplift_a
    return not verdict.outcome.safe, verdict.theta_ratio or 0.0, share
