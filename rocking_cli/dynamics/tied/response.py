"""The response of arrays of cells of a tied body."""

from __future__ import annotations

import numpy as np

from ...motions.motion import Motion
from ..outcome import Work
from ..response import Cells, Response
from ..system import System
from .march import March


def tied_response(system: System, motion: Motion, cells: Cells, shape: tuple[int, ...], peaks: bool) -> Response:
    """The `Response` of flat cells in a shape; peaks: False leaves theta_ratio NaN. Raises UsageError for a vertical motion."""
    found = March(system, motion.coarsest, *cells).run()
    work = Work(cells=cells[0].size, impacts=int(found.impacts.sum()), steps=int(found.steps.sum()))
    ratio = found.theta_ratio if peaks else np.full(found.outcome.size, np.nan)
    return Response(ratio.reshape(shape), found.outcome.reshape(shape), found.impacts.reshape(shape), work)
