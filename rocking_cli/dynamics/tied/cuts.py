"""Where events end steps of tied bodies."""

from __future__ import annotations

import numpy as np

from ...arrays import Array
from .devices import Branch
from .series import Step, falls
from .tied_lanes import CutStep

SLOWEST = 1e-14  # speed at which an upper end is passed, at least


def cut(
    step: Step,
    now: Branch,
    low: Array,
    high: Array,
    touch: Array,
) -> CutStep:
    """Cut steps where an event ends them: at an end (low, high) of the branch, or at a
    peak where a restraint yields; touch: the largest |y| of a touch.
    """
    arc, turns = step.arc, np.flatnonzero(step.turn > 0.0)
    reach, y, v = step.h.copy(), step.end.y.copy(), step.end.v.copy()

    # Up to the turn, if there is one, y is monotone.
    reach[turns], v[turns] = step.turn[turns], 0.0
    y[turns] = arc.take(turns).at(step.turn[turns]).y
    touches = turns[
        (step.outward[turns] < 0.0)
        & (low[turns] <= 0.0)
        & (np.abs(y[turns]) < touch[turns])
    ]
    y[touches] = 0.0
    top = y.copy()
    up, down = (step.outward > 0.0) & (y >= high), (step.outward < 0.0) & (y <= low)
    down[touches] = False

    # A peak at which nothing yields ends no branch: such a step goes on to its end.
    peaked = np.zeros(y.size, dtype=bool)
    peaked[turns] = (step.outward[turns] > 0.0) & ~up[turns]
    through = peaked & ~now.yields
    reach[through] = step.h[through]
    y[through] = step.end.y[through]
    v[through] = step.end.v[through]
    down |= through & (y <= low)

    # An end of the branch is passed once, before or after the turn.
    at = np.flatnonzero(up | down)
    if at.size:
        y[at] = level = np.where(up[at], high[at], low[at])
        sense = np.where(up[at], -1.0, 1.0)
        here = arc.take(at)
        here.terms *= sense
        here.terms[0] -= sense * level
        turned = np.where(through[at], step.turn[at], 0.0)
        reach[at], v[at] = falls(here, turned, reach[at])
        v[at] *= sense
        # a body that just reaches the upper end still passes it, and turns beyond it
        v[up] = np.maximum(v[up], SLOWEST)
    return CutStep(reach, y, v, np.where(through, top, y), up, down, peaked)
