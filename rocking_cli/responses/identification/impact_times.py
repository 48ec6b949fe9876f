"""Restitution from the times of impacts alone: with T from impact to impact

    tanh(p T_(k+1)/2) = eta tanh(p T_k/2)

of the linear equation, in which alpha cancels.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ...arrays import Array
from ...errors import DocumentError, UsageError, counted
from .body import KnownBody
from .first_look import LEAST_IMPACTS
from .identified import COLUMNS, Estimate, Identification, bounds
from .trace import Trace


def of_impact_times(
    trace: Trace, body: KnownBody | None, least: float, level: float
) -> Identification:
    """Return what the times of impacts tell; least: as in `identify`. Raises UsageError
    without a body, DocumentError.
    """
    from scipy.special import stdtrit

    if body is None:
        raise UsageError(f"{trace.name}: impact times need a structure, for p")
    p = float(np.mean(body.p))
    longs = np.diff(trace.t)
    x = 1.0 - 1.0 / np.cosh(0.5 * p * longs)  # theta/alpha of each half-cycle
    small = np.flatnonzero(x < least * x[:1])
    used = int(small[0]) if small.size else longs.size
    if used - 1 < LEAST_IMPACTS:
        raise DocumentError(
            f"{trace.name}: {counted(max(used - 1, 0), 'impact')} between whole"
            f" half-cycles; {LEAST_IMPACTS} are needed"
        )
    speeds = np.tanh(0.5 * p * longs[:used])
    eta = speeds[1:] / speeds[:-1]
    scatter = float(np.std(eta, ddof=1))
    mean = Estimate(float(eta.mean()), scatter / np.sqrt(eta.size))
    if mean.value > 1.0:
        raise DocumentError(
            f"{trace.name}: the times between impacts grow, by eta = {mean.text()}"
        )
    student = float(stdtrit(eta.size - 1, 0.5 + 0.5 * level))
    momentum = body.momentum(np.zeros(1))
    row: dict[str, Any] = dict.fromkeys(COLUMNS) | {
        "trace": trace.name,
        "release": 1,
        "impacts": eta.size,
        "p_structure": p,
        **bounds("eta", mean, student),
        "eta_scatter": scatter,
        "eta_momentum": momentum,
    }
    lines = (
        f"# {trace.name}: {eta.size} impacts, times alone; scatter between impacts"
        f" {scatter:.1g}, between tests not known",
        f"restitution: {mean.text()}  # momentum: {momentum:.3f}",
    )
    remark = f"{trace.name}: times of impacts tell eta, never alpha or the inset"
    return Identification(
        row, _rows(trace, x, eta), lines, (remark,), None, {"eta": mean}
    )


def _rows(trace: Trace, x: Array, eta: Array) -> list[dict[str, Any]]:
    """Return a row for each impact between two half-cycles; x: their theta/alpha."""
    more = {"trace": trace.name, "release": 1, "side": None, "theta_before": None}
    return [
        {
            **more,
            **bounds("eta", None, 0.0),
            "impact": k + 2,
            "t": float(trace.t[k + 1]),
            "ratio": float(x[k]),
            "eta_alone": float(one),
        }
        for k, one in enumerate(eta)
    ]
