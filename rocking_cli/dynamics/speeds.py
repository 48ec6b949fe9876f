"""The largest angular speed of rocking, beside the response."""

from __future__ import annotations

import numpy as np

from ..motions.motion import Motion
from .outcome import Outcome
from .response import Response, look_at_forces, run_of
from .system import System

Array = np.ndarray


def response_with_speed(system: System, motion: Motion, amplitude: Array, omega: Array, eta: Array | float) -> tuple[Response, Array]:
    """`response`, and max over time of |d theta/d tau|/alpha [-], tau = p t, under straight lines, p and alpha those that A and Omega are
    told in where the edges differ; NaN where theta_ratio is. Parameters as of `response`."""
    amplitude, omega, eta = np.broadcast_arrays(*(np.asarray(x, dtype=float) for x in (amplitude, omega, eta)))
    cells = amplitude.ravel(), omega.ravel(), eta.ravel()
    run = run_of(system, motion, cells, True, speed=True)
    run.all()
    look_at_forces(run, system, motion, cells)
    shape = amplitude.shape
    kept = (run.outcome == Outcome.ROCKED) | (run.outcome == Outcome.NO_UPLIFT)
    assert run.speed is not None  # which was asked for
    rate = np.where(kept, run.speed.speed.largest, np.nan).reshape(shape)
    return Response(run.theta_ratio.reshape(shape), run.outcome.reshape(shape), run.impacts.reshape(shape), run.work), rate
