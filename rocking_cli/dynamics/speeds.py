"""The largest angular speed of rocking, beside the response."""

from __future__ import annotations

import numpy as np

from ..motions.motion import Motion
from .observers.peak_speed import PeakSpeed
from .outcome import Outcome
from .response import Response, batch_of, look_at_forces, response_of, run_of
from .system import System

Array = np.ndarray


def response_with_speed(system: System, motion: Motion, amplitude: Array, omega: Array, eta: Array | float) -> tuple[Response, Array]:
    """`response`, and max over time of |d theta/d tau|/alpha [-], tau = p t, under straight lines, p and alpha those that A and Omega are
    told in where the edges differ; NaN where theta_ratio is. Parameters as of `response`."""
    amplitude, omega, eta = np.broadcast_arrays(*(np.asarray(x, dtype=float) for x in (amplitude, omega, eta)))
    cells = amplitude.ravel(), omega.ravel(), eta.ravel()
    batch = batch_of(system, motion, cells, True)
    speed = PeakSpeed(batch.equation, batch.contact, batch.shaken, batch.size)
    run, loss = run_of(system, motion, batch, None, speed, jumps=motion.vertical is None)
    run.all()
    look_at_forces(run, loss, system, motion, cells)
    kept = (run.outcome == Outcome.ROCKED) | (run.outcome == Outcome.NO_UPLIFT)
    return response_of(run, amplitude.shape), np.where(kept, speed.speed.largest, np.nan).reshape(amplitude.shape)
