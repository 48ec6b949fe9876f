"""Proofs that the outcome of a lane is already known, so that the march need not follow
it to the end.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ...arrays import Array
from ..batch import Batch
from ..lanes import Lanes
from ..outcome import Outcome

# of a motion; with more an envelope also scans where the number of impacts changes:
# bodies are followed to the end
FEW_SIGN_CHANGES = 1


class Proved(NamedTuple):
    """Lanes whose outcome is known."""

    at: Array  # indices of the lanes, (proved,)
    outcome: Array | Outcome  # their outcomes, (proved,), or one outcome for all
    # largest y of lanes that rocked, NaN for other outcomes, (proved,)
    peak: Array | float


class LaneProof(NamedTuple):
    """A proof that ends the march of lanes early."""

    # function of the batch and of its lanes just after an impact, or in the air at the
    # end of a step; returns the lanes whose outcome it proves
    proves: Callable[[Batch, Lanes], Proved]
    # True for a proof about still ground, before which the run calls its observers
    still: bool = False


def free_motion(batch: Batch, lanes: Lanes) -> Proved:
    """Prove the outcome of undamped lanes for which the shaking is over, by their free
    motion (Lemma 8).
    """
    at = np.flatnonzero(lanes.segment >= len(batch.segments))
    if not at.size:
        return Proved(at, at, lanes.peak[at])
    free = batch.contact.free_motion(
        batch.equation, lanes, at, lanes.y[at], lanes.v[at]
    )
    outcome = free.outcome(lanes.impacts[at] > 0)
    return Proved(at, outcome, np.maximum(lanes.peak[at], free.peak))


def damped_settling(batch: Batch, lanes: Lanes) -> Proved:
    """Prove that damped lanes on still ground stay upright (`Contact.settles`), and
    raise the stored peak of lanes on still ground to their next peak where it is known.
    """
    at = np.flatnonzero(lanes.segment >= batch.shaken)
    upright, lanes.peak[at] = batch.contact.settles(batch.equation, lanes.take(at))
    at = at[upright]
    return Proved(at, Outcome.ROCKED, lanes.peak[at])


FREE_MOTION = LaneProof(free_motion, still=True)
UNSETTLED = LaneProof(
    lambda batch, lanes: Proved(
        np.flatnonzero(lanes.segment >= len(batch.segments)), Outcome.FAILED, np.nan
    )
)
# a lane that has not settled at the end of the still ground fails
DAMPED = [
    LaneProof(damped_settling, still=True),
    UNSETTLED,
]


def proofs_of(batch: Batch, observed: bool) -> tuple[list[LaneProof], list[LaneProof]]:
    """(proofs for lanes just after an impact, proofs for those lanes after they are
    taken from rest to their next uplift) of a run. observed: True if observers look for
    more than peaks and outcomes.
    """
    if batch.equation.damped:
        return DAMPED, []
    if batch.segments.weighed is not None:
        return [FREE_MOTION], []
    # If only the outcome is wanted, lanes that cannot overturn any more end.
    last = [] if observed or batch.peaks else _cannot_overturn(batch)
    return [FREE_MOTION], last


def _cannot_overturn(batch: Batch) -> list[LaneProof]:
    """Return the proof by Lemma 9, none where it is not used: where an envelope also
    looks at the number of impacts, and under records, where it proves nothing.
    """
    segments = batch.segments
    if segments.straight or segments.sign_changes > FEW_SIGN_CHANGES:
        return []
    from ..impulse_bound import ImpulseBound

    bound = ImpulseBound.of(batch.equation, batch.cells, segments)

    def proves(batch: Batch, lanes: Lanes) -> Proved:
        at = np.flatnonzero(bound.cannot_overturn(batch.cells, lanes))
        return Proved(at, Outcome.ROCKED, np.nan)

    return [LaneProof(proves)]
