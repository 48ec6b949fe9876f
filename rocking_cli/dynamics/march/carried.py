"""The errors of free bodies, carried along with their motion as `condition` says."""

import numpy as np

from ...arrays import Array
from ..batch import Batch
from ..condition import at_free_peak, in_tolerances, moved, slope_between
from ..equations.equation import Equation
from ..lanes import Lanes
from ..system import System
from .one_turn import StepResult


def carry_errors(
    batch: Batch, lanes: Lanes, step: StepResult, equation: Equation
) -> None:
    """Carry the moments of the errors to the ends of the steps, and to their peaks
    where these are the largest so far.
    """
    y, v = np.where(step.hit, 0.0, step.end.y), step.end.v.copy()
    np.copyto(v, step.impact_v, where=step.hit)
    ends, h = ((lanes.y, lanes.v), (y, v)), step.reach
    slope, damping = (
        np.broadcast_to(x, h.shape)
        for x in (slope_between(equation, *ends, h), equation.damping)
    )
    error = in_tolerances(step.error, equation.error_unit)
    at = np.flatnonzero(step.top >= lanes.peak)
    if at.size:
        before = lanes.moments.take(at, axis=1)
        until = moved(before, step.top_at[at], slope[at], damping[at], error[at])
        _keep_moment(batch, lanes, at, step.top[at], until[0])
    lanes.moments[:3] = moved(lanes.moments, h, slope, damping, error)


def _keep_moment(
    batch: Batch | System, lanes: Lanes, at: Array, y: Array, moment: Array
) -> None:
    """Store the second moment of |theta|/alpha at peaks y of the lanes `at`, from that
    of y.
    """
    equation = batch.equation.on(lanes.side[at], lanes.cell[at])
    rate = equation.rotation_rate(y, np.ones(at.size))
    lanes.moments[3, at] = rate * rate * moment


def carry_free_peaks(
    batch: Batch | System, lanes: Lanes, at: Array, peak: Array
) -> None:
    """Take the peaks of free motions into the moments of the lanes `at`."""
    higher = np.flatnonzero(peak > lanes.peak[at])
    at = at[higher]
    if not at.size:
        return

    def peak_of(y: Array, v: Array) -> Array:
        return batch.contact.free_motion(batch.equation, lanes, at, y, v).peak

    y, v, top = lanes.y[at], lanes.v[at], peak[higher]
    here = batch.equation.on(lanes.side[at], lanes.cell[at])
    state = y, v, here.force(y, np.zeros(at.size))
    moments = lanes.moments[:3].take(at, axis=1)
    moment = at_free_peak(moments, state, top, peak_of)
    _keep_moment(batch, lanes, at, top, moment)
