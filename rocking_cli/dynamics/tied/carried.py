"""The errors of tied bodies, carried along with their motion as `condition` says; here
is what restraints add.

The restraints add their stiffness to df/dy, so an error may swing in place of growing.
The force does not jump where a restraint engages, yields, unloads or becomes slack; it
jumps where one breaks, by D: an error dy reaches that place by dy/v too early, so dv
grows by D dy/v. The error of a peak at which a restraint yields stays in its permanent
elongation, and so in its force: it is added with the worst sign.
"""

from __future__ import annotations

import numpy as np

from ...arrays import Array
from ..condition import ErrorMoments, in_tolerances, moved, rows, sheared, slope_between
from .devices import Branch, Devices
from .series import HeldBody, Step
from .tied_lanes import CutStep, TiedLanes


def carry(
    lanes: TiedLanes, held: HeldBody, end: tuple[Array, Array], h: Array, error: Array
) -> None:
    """Carry the moments of lanes along arcs of duration h [tau] to their states (y, v)
    at the end; error: of y' on them.
    """
    slope = slope_between(held, (lanes.y, lanes.v), end, h)
    error = in_tolerances(error, held.error_unit)
    lanes.moments[:3] = moved(lanes.moments, h, slope, held.damping, error)
    if lanes.yielded.any():
        stiffness = held.moment.slope(0.5 * (lanes.y + end[0]))
        push = np.abs(stiffness) * h * np.sqrt(lanes.yielded)
        yy, _, vv = rows(lanes.moments)
        lanes.moments[0] = (np.sqrt(yy) + 0.5 * push * h) ** 2
        lanes.moments[2] = (np.sqrt(vv) + push) ** 2


def carry_step(
    lanes: TiedLanes, held: HeldBody, step: Step, ended: CutStep, touch: Array
) -> None:
    """Carry the moments to the ends of steps, and to their peaks where these are the
    largest so far; touch: the error of y at a touch, (lanes,).
    """
    before, start = lanes.moments.copy(), (lanes.y, lanes.v)
    carry(lanes, held, (ended.y, ended.v), ended.reach, step.error)
    touches = (ended.y == 0.0) & (ended.v == 0.0) & ~ended.down
    lanes.moments[0] += np.where(
        touches, in_tolerances(touch, held.error_unit) ** 2, 0.0
    )
    if (ended.peaked & (ended.top >= lanes.peak)).any():
        at = np.flatnonzero(ended.peaked & (ended.top >= lanes.peak))
        slope = slope_between(held, start, (ended.top, 0.0 * ended.top), step.turn)
        error = in_tolerances(step.error, held.error_unit)
        moment = moved(before, step.turn, slope, held.damping, error)[0]
        rate = held.equation.rotation_rate(ended.top, np.ones(ended.top.size))
        lanes.moments[3, at] = (rate * rate * moment)[at]


def carry_through_break(
    lanes: TiedLanes,
    at: Array,
    devices: Devices,
    row: Array,
    before: Branch,
    now: Branch,
) -> None:
    """Carry the moments of the lanes `at` through a rupture; before, now: their
    branches before and after it.
    """
    y = lanes.y[at]
    jump = devices.pull_on(row, before).at(y) - devices.pull_on(row, now).at(y)
    moments: ErrorMoments = rows(lanes.moments[:, at])
    lanes.moments[:3, at] = sheared(moments, jump, lanes.v[at])


def keep_yield_error(lanes: TiedLanes, at: Array) -> None:
    """Keep the error of the peaks of the lanes `at`, at which a restraint yields."""
    lanes.yielded[at] = np.maximum(lanes.yielded[at], lanes.moments[0, at])
