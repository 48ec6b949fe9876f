"""Closings: proofs that lanes just after an impact come to a known outcome, so that they need not be followed.

A run chooses its closings once, by what they need and what holds for it (`conditions`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ...motions.segments import Segments
from ..contacts.adiabatic import bounces_on
from ..contacts.long_sequences import outlasts
from ..contacts.settling import settles
from ..equations.equation import Equation
from ..lanes import Lanes
from ..outcome import Outcome

if TYPE_CHECKING:
    from .engine import Run

Array = np.ndarray


@dataclass(frozen=True)
class Closing:
    """needs: conditions under which the proof holds; outcome: of lanes that it closes, with their peak so far where they rocked;
    closes(segments, lanes, equation, most_steps): which lanes it closes, (lanes,); rests: whether they come to rest, or near it."""

    needs: frozenset[str]
    outcome: Outcome
    closes: Callable[[Segments, Lanes, Equation, int], Array]
    rests: bool = False


def conditions(run: Run) -> frozenset[str]:
    """What holds for a run, of what closings may need."""
    linear = run.equation.bounded
    held = {
        "undamped": not run.equation.damping,
        "equal edges": run.contact.alike,
        "constant weight": run.segments.weighed is None,
        "linear equation": linear,
        "straight lines": run.segments.straight,
        "only the peak": run.peaks and not run.observers,
        "only the outcome": not run.peaks and not run.observers,
        "unobserved": not run.observers,
    }
    return frozenset(name for name, holds in held.items() if holds)


SYMMETRIC = frozenset({"undamped", "equal edges", "constant weight"})
AT_IMPACTS = (
    Closing(
        SYMMETRIC | {"linear equation", "only the peak"}, Outcome.ROCKED,
        lambda segments, lanes, _equation, _most: settles(segments, lanes), rests=True,
    ),
    Closing(
        SYMMETRIC | {"straight lines", "unobserved"}, Outcome.ROCKED,
        lambda segments, lanes, equation, _most: bounces_on(segments, lanes, equation), rests=True,
    ),
    Closing(SYMMETRIC, Outcome.FAILED, outlasts),
)  # fmt: skip


def impulse_bound(run: Run) -> Callable[[Lanes], Array] | None:
    """Which lanes at the ground nothing to come overturns (Lemma 9), where only the outcome is wanted and the motion has few pushes; None
    where the proof does not hold."""
    if run.segments.straight or not conditions(run) >= SYMMETRIC | {"linear equation", "only the outcome"}:
        return None
    from ..impulse import FEW, ImpulseAhead

    return ImpulseAhead.of(run.segments).cannot_overturn if run.segments.pushes <= FEW else None
