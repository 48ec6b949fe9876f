"""Closings: proofs that lanes come to a known outcome, so that they need not be followed.

A run chooses its closings once, by what they need and what holds for it (`conditions`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ...motions.segments import Segments
from ..contacts.sequences import outlasts, settles
from ..lanes import Lanes
from ..outcome import Outcome
from .batch import Batch

Array = np.ndarray

FEW = 2  # pushes of a motion: under more, an envelope looks closer where the number of impacts changes, and bodies are followed to the end


class Closed(NamedTuple):
    """Lanes whose outcome is known: their indices, outcomes, and the largest y of those that rocked, NaN of others."""

    at: Array
    outcome: Array | Outcome
    peak: Array | float


@dataclass(frozen=True)
class Closing:
    """needs: conditions under which the proof holds; closes(batch, lanes): the lanes just after an impact that it closes; counts: field of
    `Work` that counts them; still: True of lanes that are left on still ground, which observers are told."""

    needs: frozenset[str]
    closes: Callable[[Batch, Lanes], Closed]
    counts: str | None = None
    still: bool = False


def conditions(batch: Batch, observed: bool) -> frozenset[str]:
    """What holds for a run, of what closings may need; observed: True if anything but peaks and outcomes is looked for."""
    held = {
        "undamped": not batch.equation.damping,
        "damped": bool(batch.equation.damping),
        "equal edges": batch.contact.alike,
        "constant weight": batch.segments.weighed is None,
        "linear equation": batch.equation.bounded,
        "straight lines": batch.segments.straight,
        "few pushes": not batch.segments.straight and batch.segments.pushes <= FEW,
        "only the peak": batch.peaks and not observed,
        "only the outcome": not batch.peaks and not observed,
        "unobserved": not observed,
    }
    return frozenset(name for name, holds in held.items() if holds)


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


def _rocked(proved: Callable[[Batch, Lanes], Array]) -> Callable[[Batch, Lanes], Closed]:
    def closes(batch: Batch, lanes: Lanes) -> Closed:
        at = np.flatnonzero(proved(batch, lanes))
        return Closed(at, Outcome.ROCKED, lanes.peak[at])

    return closes


def _failed(proved: Callable[[Batch, Lanes], Array]) -> Callable[[Batch, Lanes], Closed]:
    return lambda batch, lanes: Closed(np.flatnonzero(proved(batch, lanes)), Outcome.FAILED, np.nan)


def _bounces_on(batch: Batch, lanes: Lanes) -> Array:
    from ..contacts.adiabatic import bounces_on

    return bounces_on(batch.segments, lanes, batch.equation)


FREE_MOTION = Closing(frozenset({"undamped"}), free_motion, "free_phase", still=True)
SYMMETRIC = frozenset({"undamped", "equal edges", "constant weight"})
OUTCOME_ONLY = SYMMETRIC | {"linear equation", "only the outcome", "few pushes"}
AT_IMPACTS = (
    FREE_MOTION,
    Closing(frozenset({"damped"}), damped_settling, still=True),
    Closing(frozenset({"damped"}), _failed(lambda batch, lanes: lanes.k >= len(batch.segments))),  # it should have settled
    Closing(
        SYMMETRIC | {"linear equation", "only the peak"}, _rocked(lambda batch, lanes: settles(batch.segments, lanes)), "chatters_closed"
    ),
    Closing(SYMMETRIC | {"straight lines", "unobserved"}, _rocked(_bounces_on), "chatters_closed"),
    Closing(SYMMETRIC, _failed(lambda batch, lanes: outlasts(batch.segments, lanes, batch.equation, batch.most_steps))),
)  # fmt: skip


def impulse_bound(segments: Segments) -> Closing:
    """Lanes that nothing to come overturns (Lemma 9), where only the outcome is wanted."""
    from ..impulse import ImpulseAhead

    ahead = ImpulseAhead.of(segments)
    return Closing(OUTCOME_ONLY, lambda _, lanes: Closed(np.flatnonzero(ahead.cannot_overturn(lanes)), Outcome.ROCKED, np.nan))


def closings_of(batch: Batch, observed: bool) -> tuple[list[Closing], list[Closing]]:
    """The closings of a run: for lanes just after an impact, and for those of them that have been taken to their next uplift."""
    held = conditions(batch, observed)
    after_rest = [impulse_bound(batch.segments)] if held >= OUTCOME_ONLY else []
    return [closing for closing in AT_IMPACTS if closing.needs <= held], after_rest
