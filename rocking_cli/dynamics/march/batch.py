"""The cells of a run, their outcomes, and the ends of lanes: overturned, on still ground, or settled by a proof."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from ...motions.segments import Segments
from ..contacts.contact import Fate
from ..lanes import Lanes
from ..outcome import FALLEN, Outcome
from ..system import System
from .account import Work
from .free_fall import FreeFall

if TYPE_CHECKING:
    from ..observers.observer import Observer

Array = np.ndarray
Landing = TypeVar("Landing", bound=Lanes)

SETTLING = 250.0  # tau, times what damping slows the unstable mode: no body is longer on its way to its last impacts that matter


class Batch:
    """Cells that are run together. Parameters as in `Run`; observers: who takes part."""

    observers: Sequence[Observer] = ()

    def __init__(self, system: System, segments: Segments, amplitude: Array, omega: Array, eta: Array, peaks: bool) -> None:
        self.equation, self.contact = system.equation, system.contact
        self.peaks = peaks
        self.cells = self.contact.cells(self.equation, amplitude, omega, eta)
        self.segments, self.shaking, self.shaken = segments, segments, len(segments)
        if self.equation.damping and omega.size:  # no closed form of the free motion: march on over still ground
            self.segments = segments.followed_by_rest(SETTLING * (1.0 + 3.0 * self.equation.damping) * float(self.cells.omega.max()))
        if self.equation.damping:
            self.bounced = np.zeros(omega.size, dtype=bool)  # on still ground, which counts as no impact during the shaking
        self.theta_ratio = np.full(amplitude.size, 0.0 if peaks else np.nan)
        self.outcome = np.full(amplitude.size, Outcome.NO_UPLIFT, dtype=np.uint8)
        self.impacts = np.zeros(amplitude.size, dtype=np.int32)
        self.work = Work(cells=amplitude.size)
        self.free_fall = FreeFall.of(self.segments, self.cells, self.shaken)
        if self.free_fall is not None:  # also from under bodies that nothing lifts: one that is pushed against its wall
            self.outcome[self.free_fall.ever], self.theta_ratio[self.free_fall.ever] = Outcome.LOST_CONTACT, np.nan

    def cannot_return(self, lanes: Lanes, at: Array | slice, k: Array, y: Array, v: Array) -> Array:
        """True where no drive to come can bring the lanes `at` back from y, v in segments k (Lemma 6)."""
        side = lanes.side[at]
        inward = self.segments.hardest(side, lanes.amplitude[at], k)
        return self.equation.on(side, lanes.cell[at]).certainly_overturns(y, v, inward, self.segments.weighed is None)

    def end_free_fall(self, lanes: Landing) -> Landing:
        """Finish bodies from which the ground has fallen away: beyond `FALLEN` they have overturned before, others have lost contact."""
        if self.free_fall is None:
            return lanes
        falls = self.free_fall.now(lanes)
        over = falls & (self.equation.on(lanes.side, lanes.cell).rotation(lanes.y) >= FALLEN)
        self.overturn(lanes, np.flatnonzero(over))
        self.finish(lanes, np.flatnonzero(falls & ~over), Outcome.LOST_CONTACT, np.nan)
        return lanes.take(np.flatnonzero(~falls))

    def end_shaking(self, lanes: Lanes, last: Array) -> None:
        """Finish undamped lanes at the end of the shaking, by the outcome of their free motion."""
        y, v = lanes.y[last], lanes.v[last]
        self._meet(self.contact.fate(self.equation, lanes, last, y, v), lanes, last, y, v)

    def _meet(self, fate: Fate, lanes: Lanes, last: Array, y: Array, v: Array) -> None:
        """Finish the lanes `last`, which are at y, v when the shaking is over, by the outcome of their free motion."""
        self.overturn(lanes, last[fate.overturns])
        self.finish(lanes, last[fate.overturns_after_impact], Outcome.OVERTURNED_AFTER_IMPACT, np.nan)
        upright = ~(fate.overturns | fate.overturns_after_impact)
        stay, y, v = last[upright], y[upright], v[upright]
        for observer in self.observers:
            observer.free(lanes, stay, y, v)
        self.finish(lanes, stay, Outcome.ROCKED, np.maximum(lanes.peak[stay], fate.peak[upright]))
        self.work += Work(free_phase=last.size)

    def _settle(self, lanes: Landing) -> Landing:
        """Finish damped lanes on still ground that cannot rise above their peak: without damping they would have more energy, and even
        so they neither pass the barrier nor rise above their peak."""
        at = np.flatnonzero(lanes.k >= self.shaken)
        if not at.size:
            return lanes
        y, v = lanes.y[at], lanes.v[at]
        crest = self.equation.damped_crest(y, v)
        known = np.flatnonzero(np.isfinite(crest))
        y[known], v[known] = crest[known], 0.0
        lanes.peak[at] = np.fmax(lanes.peak[at], crest)
        most = self.contact.fate(self.equation, lanes, at, y, v)
        below = self.equation.on(lanes.side[at], lanes.cell[at]).rotation(y) < 1.0  # from above the barrier damping may keep it there
        settled = at[below & ~(most.overturns | most.overturns_after_impact) & (most.peak <= lanes.peak[at])]
        for observer in self.observers:
            settled = settled[observer.may_settle(lanes.take(settled), self.bounced)]
        for observer in self.observers:
            observer.settle(lanes.take(settled))
        self.finish(lanes, settled, Outcome.ROCKED, lanes.peak[settled])
        going = np.ones(lanes.k.size, dtype=bool)
        going[settled] = False
        return lanes.take(np.flatnonzero(going))

    def overturn(self, lanes: Lanes, at: Array) -> None:
        bounced = lanes.impacts[at] > 0
        if self.equation.damping:
            bounced |= self.bounced[lanes.cell[at]]
        self.finish(lanes, at[bounced], Outcome.OVERTURNED_AFTER_IMPACT, np.nan)
        self.finish(lanes, at[~bounced], Outcome.OVERTURNED_NO_IMPACT, np.nan)

    def _lose(self, cell: Array) -> None:
        """Mark cells that rock as having lost contact."""
        self.outcome[cell], self.theta_ratio[cell] = Outcome.LOST_CONTACT, np.nan

    def finish(self, lanes: Lanes, at: Array, outcome: Outcome, peak: Array | float) -> None:
        cell = lanes.cell[at]
        self.outcome[cell] = outcome
        if self.peaks:
            self.theta_ratio[cell] = self.equation.on(lanes.side[at], cell).rotation(np.asarray(peak))
        if outcome == Outcome.ROCKED:
            if self.free_fall is not None:
                self._lose(cell[self.free_fall.ever[cell]])
            for observer in self.observers:
                self._lose(cell[observer.lost(cell)])
        self.impacts[cell] = lanes.impacts[at]
