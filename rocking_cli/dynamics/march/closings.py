"""Closings: proofs that lanes come to a known outcome, so that they need not be followed."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ..contacts.sequences import KEEPS, bounces_on, outlasts, settles
from ..drive import ImpulseAhead
from ..lanes import Array, Lanes
from ..outcome import Outcome
from .batch import Batch

FEW = 2  # pushes of a motion: under more, an envelope looks closer where the number of impacts changes, and bodies are followed to the end


class Closed(NamedTuple):
    """Lanes whose outcome is known: their indices, outcomes, and the largest y of those that rocked, NaN of others."""

    at: Array
    outcome: Array | Outcome
    peak: Array | float


class Closing(NamedTuple):
    """closes(batch, lanes): the lanes just after an impact that it closes; counts: field of `Work` that counts them; still: True of lanes
    that are left on still ground, which observers are told."""

    closes: Callable[[Batch, Lanes], Closed]
    counts: str = ""
    still: bool = False


def free_motion(batch: Batch, lanes: Lanes) -> Closed:
    """Undamped lanes for which the shaking is over: the outcome of their free motion (Lemma 8)."""
    at = np.flatnonzero(lanes.k >= len(batch.segments))
    if not at.size:
        return Closed(at, at, lanes.peak[at])
    free = batch.contact.free_motion(batch.equation, lanes, at, lanes.y[at], lanes.v[at])
    before = np.where(lanes.impacts[at] > 0, Outcome.OVERTURNED_AFTER_IMPACT, Outcome.OVERTURNED_NO_IMPACT)
    outcome = np.where(free.overturns, before, np.where(free.overturns_after_impact, Outcome.OVERTURNED_AFTER_IMPACT, Outcome.ROCKED))
    return Closed(at, outcome, np.maximum(lanes.peak[at], free.peak))


def damped_settling(batch: Batch, lanes: Lanes) -> Closed:
    """Damped lanes on still ground that cannot rise above their peak: without damping they would have more energy, and even so they
    neither pass the barrier nor rise above their peak. The peaks of lanes on still ground are raised to the next one where it is known."""
    at = np.flatnonzero(lanes.k >= batch.shaken)
    y, v = lanes.y[at], lanes.v[at]
    top = batch.equation.damped_peak(y, v)
    known = np.flatnonzero(np.isfinite(top))
    y[known], v[known] = top[known], 0.0
    lanes.peak[at] = np.fmax(lanes.peak[at], top)
    most = batch.contact.free_motion(batch.equation, lanes, at, y, v)
    below = batch.rotation(lanes, at, y) < 1.0  # from above the barrier damping may keep it there
    at = at[below & ~(most.overturns | most.overturns_after_impact) & (most.peak <= lanes.peak[at])]
    return Closed(at, Outcome.ROCKED, lanes.peak[at])


def _rocked(lanes: Lanes, proved: Array) -> Closed:
    at = np.flatnonzero(proved)
    return Closed(at, Outcome.ROCKED, lanes.peak[at])


FREE_MOTION = Closing(free_motion, "free_phase", still=True)
UNSETTLED = Closing(lambda batch, lanes: Closed(np.flatnonzero(lanes.k >= len(batch.segments)), Outcome.FAILED, np.nan))
DAMPED = [Closing(damped_settling, still=True), UNSETTLED]  # at the end of the still ground they should have settled
SETTLES = Closing(lambda batch, lanes: _rocked(lanes, settles(batch.segments, lanes)), "chatters_closed")
BOUNCES_ON = Closing(lambda batch, lanes: _rocked(lanes, bounces_on(batch.segments, lanes, batch.equation)), "chatters_closed")
OUTLASTS = Closing(lambda batch, lanes: Closed(np.flatnonzero(outlasts(batch.segments, lanes, batch.most_steps)), Outcome.FAILED, np.nan))


def closings_of(batch: Batch, observed: bool) -> tuple[list[Closing], list[Closing]]:
    """The closings of a run: for lanes just after an impact, and for those of them that have been taken to their next uplift. observed:
    True if anything but peaks and outcomes is looked for."""
    segments, linear = batch.segments, batch.equation.bounded
    if batch.equation.damping:
        return DAMPED, []
    if not batch.contact.alike or segments.weighed is not None:
        return [FREE_MOTION], []
    lasting = float(batch.cells.eta.max(initial=0.0)) > KEEPS
    if observed:
        return [FREE_MOTION, *[OUTLASTS] * lasting], []
    early = [FREE_MOTION, *[SETTLES] * (linear and batch.peaks), *[BOUNCES_ON] * (lasting and segments.straight), *[OUTLASTS] * lasting]
    if batch.peaks or not linear or segments.straight or segments.pushes > FEW:
        return early, []
    ahead = ImpulseAhead.of(segments)  # where only the outcome is wanted: lanes that nothing to come overturns (Lemma 9)
    return early, [Closing(lambda _, lanes: Closed(np.flatnonzero(ahead.cannot_overturn(lanes)), Outcome.ROCKED, np.nan))]
