"""The response of cells, computed one after the other on floats: `response` with
how="floats".
"""

import numpy as np

from ...motions.motion import Motion
from ..outcome import Outcome, Work
from ..response import Response, cells_that_lose_contact, response
from ..system import System
from .lane import Lane
from .march import march

Array = np.ndarray

# largest number of steps of a cell, and its growth with each segment; `response` takes
# cells beyond it
_STEPS, _FOR_EACH = (
    20_000,
    10,
)


def one_by_one(
    system: System,
    motion: Motion,
    amplitude: Array,
    omega: Array,
    eta: Array,
    *,
    shape: tuple[int, ...],
    peaks: bool,
) -> Response:
    """Return the response of flat cells in this shape, of a system of one structure
    without restraints.

    `response` on arrays decides bodies that bounce for very long, and bodies for which
    neither amplitude nor rotation proves Fz > 0.
    """
    prove = bool(
        amplitude.max(initial=0.0) > system.safe_amplitude(motion)
    )  # the peaks may prove that Fz > 0
    segments = system.segments(motion.coarsest)
    most = _STEPS + _FOR_EACH * len(segments)
    lanes: dict[tuple[float, float], Lane] = {}
    theta_ratio, outcome, impacts = (
        np.empty(amplitude.size, dtype=kind) for kind in (float, np.uint8, np.int32)
    )
    with np.errstate(all="ignore"):
        for i, (a, w, e) in enumerate(
            zip(amplitude.tolist(), omega.tolist(), eta.tolist(), strict=True)
        ):
            lane = lanes.get((w, e)) or lanes.setdefault(
                (w, e), Lane(system, segments, w, e)
            )
            ended = march(lane, a, peaks=peaks or prove, most=most)
            outcome[i], theta_ratio[i], impacts[i] = (
                ended.outcome,
                ended.theta_ratio,
                ended.impacts,
            )
    failed = np.flatnonzero(outcome == Outcome.FAILED)
    if failed.size:
        again = response(
            system, motion, amplitude[failed], omega[failed], eta[failed], peaks=peaks
        )
        outcome[failed], theta_ratio[failed], impacts[failed] = (
            again.outcome,
            again.theta_ratio,
            again.impacts,
        )
    doubtful = outcome == Outcome.ROCKED
    doubtful[failed] = False
    alone = None
    if not system.equation.damping and motion.vertical is None:

        def alone(i: int) -> bool:
            from .contact_watch import loses_contact

            return loses_contact(
                lanes[float(omega[i]), float(eta[i])], float(amplitude[i]), most
            )

    lost = cells_that_lose_contact(
        system, motion, (amplitude, omega, eta), doubtful, theta_ratio, alone=alone
    )
    outcome[lost], theta_ratio[lost] = Outcome.LOST_CONTACT, np.nan
    if not peaks:
        theta_ratio[:] = np.nan
    return Response(
        theta_ratio.reshape(shape),
        outcome.reshape(shape),
        impacts.reshape(shape),
        Work(cells=amplitude.size),
    )
