"""Takes cells through a record with equal steps: over samples where a proof allows it,
elsewhere by rounds of the march.
"""

from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np

from ...motions.segments import Samples
from ..drive import place
from ..lanes import Array, Lanes
from ..march.engine import Run, by_windows
from ..outcome import Outcome

# lanes in one call of `propagate`: their arrays fit the second-level cache, and rows
# are no power of two apart
WIDTH = 5056
# interval between samples [tau] up to which lanes are propagated over samples
LONGEST = 0.5


@dataclass
class PooledLanes(Lanes):
    """Lanes in the pool. Every array is (lanes,)."""

    pace: Array  # time between samples [tau]
    outward: Array  # outward drive of s = 1 [-]
    slot: Array  # index of the lane in the pool


Pooled = TypeVar("Pooled", bound=PooledLanes)


class SampleStepper(ABC, Generic[Pooled]):
    """Advances the cells of a `Run` along the samples of a record, in a
    pool of lanes.
    """

    def __init__(self, run: Run, samples: Sequence[Samples]) -> None:
        """samples: of each motion, in the order of the segments. They give every cell
        its motion, first and last sample, and step.
        """
        self.run = run
        self.equation = run.batch.equation
        self.cells = run.batch.cells
        self.segments = run.batch.segments
        # The samples s of each motion, those of all motions one after the other, and
        # the increase of s from each sample to the next [-].
        self.values = [one.values for one in samples]
        self.samples = np.concatenate(self.values)
        self.gains = np.concatenate([gains(one) for one in self.values])
        # The motion of each cell, its first and last sample, and the phase between two
        # samples [rad], (cells,).
        ends = np.cumsum([one.size for one in self.values])
        self.motion = np.searchsorted(ends, run.batch.first, side="right")
        self.first, self.last = run.batch.first, ends[self.motion] - 1
        self.step = np.array([one.step for one in samples])[self.motion]

    def march(self, waiting: Array) -> None:
        """March these cells to their end. Cells with about the same time tau between
        samples go together; those with more than `LONGEST` go from window to window of
        the drive.
        """
        pace = (self.step[waiting] / self.cells.omega[:, waiting]).max(axis=0)
        by_windows(self.run, waiting[pace > LONGEST])
        waiting, pace = waiting[pace <= LONGEST], pace[pace <= LONGEST]
        with np.errstate(all="ignore"):
            for share in (
                self.shares(waiting[np.argsort(pace, kind="stable")])
                if waiting.size
                else ()
            ):
                self._advance(share)

    def shares(self, waiting: Array) -> Iterator[Array]:
        """Splits the cells into groups, each of which fills the pool by itself."""
        yield waiting

    @abstractmethod
    def prepare(self, lanes: PooledLanes) -> Pooled:
        """Return lanes with the additional fields that a subclass needs in the pool."""

    def can_propagate(self, lanes: Pooled) -> Array:
        """True for lanes that are at a sample before the last one, from which a
        propagation may be tried.
        """
        return (lanes.phase == 0.0) & (lanes.segment < self.last.take(lanes.cell))

    @abstractmethod
    def propagate(self, lanes: Pooled, at: Array) -> Array:
        """Move the lanes `at` over samples; returns True for lanes that can go on."""

    def after_round(self, lanes: Pooled) -> None:
        """Renew the additional fields of lanes after a round of the march."""
        lanes.pace = self.step.take(lanes.cell) / lanes.omega
        lanes.outward = -lanes.side * lanes.amplitude

    def _advance(self, waiting: Array) -> None:
        """March these cells to their end, as many at once as the pool holds."""
        taken = min(self.run.pool, waiting.size)
        lanes = self._begin(waiting[:taken], np.arange(taken))
        free = np.zeros(taken, dtype=bool)
        ready = self.can_propagate(lanes)
        while lanes.cell.size:
            # Lanes at a sample are propagated until they stop.
            at = np.flatnonzero(ready)
            for first in range(0, at.size, WIDTH):
                some = at[first : first + WIDTH]
                ready[some] = self.propagate(lanes, some)
            # Stopped lanes take a round of the march, which may end them; the others
            # come back to their places.
            stopped = np.flatnonzero(~(ready | free))
            going = self._march_round(lanes.take(stopped))
            free[stopped] = True
            lanes.put(going.slot, going)
            free[going.slot], ready[going.slot] = False, self.can_propagate(going)
            fallen = self._overturn(lanes, np.flatnonzero(ready))
            free[fallen], ready[fallen] = True, False
            # New cells take the places that are free; without new cells the pool
            # shrinks.
            places = np.flatnonzero(free)
            more = min(places.size, waiting.size - taken)
            if more:
                new = self._begin(waiting[taken : taken + more], places[:more])
                taken += more
                lanes.put(new.slot, new)
                free[new.slot], ready[new.slot] = False, self.can_propagate(new)
            elif 4 * places.size >= free.size:
                keep = np.flatnonzero(~free)
                lanes, ready, free = lanes.take(keep), ready[keep], free[keep]
                lanes.slot = np.arange(keep.size)

    def _begin(self, cells: Array, slot: Array) -> Pooled:
        """Return lanes for these cells at their first uplift."""
        lanes = self.run.start(cells)
        lanes.segment, lanes.phase = place(self.segments, lanes.segment, lanes.phase)
        pace = self.step.take(lanes.cell) / lanes.omega
        return self.prepare(
            lanes.extended(
                PooledLanes, pace=pace, outward=-lanes.side * lanes.amplitude, slot=slot
            )
        )

    def _march_round(self, lanes: Pooled) -> Pooled:
        """Take one round of the march with lanes that cannot be propagated; returns the
        lanes that are not finished.
        """
        past = self.segments.ended(lanes.segment)
        if past.any():  # undamped lanes at the end of the shaking
            lanes.segment[past] = len(self.segments)
            ended = lanes.take(np.flatnonzero(past))
            failed = ~np.isfinite(ended.y)
            self.run.finish(ended, np.flatnonzero(failed), Outcome.FAILED, np.nan)
            self.run.end_shaking(ended.take(np.flatnonzero(~failed)))
            lanes = lanes.take(np.flatnonzero(~past))
        # a propagation does not keep the force
        self.run.renew_force(
            lanes, np.flatnonzero((lanes.phase == 0.0) & (lanes.y > 0.0))
        )
        going = self.run.round(lanes)
        self.after_round(going)
        return going

    def _overturn(self, lanes: PooledLanes, at: Array) -> Array:
        """Finish those of the lanes `at` that nothing can bring back (Lemma 6); returns
        their indices.
        """
        at = at[lanes.y[at] + lanes.v[at] > 1.0]
        at = at[
            self.run.batch.cannot_return(
                lanes, at, lanes.segment[at], lanes.y[at], lanes.v[at]
            )
        ]
        self.run.overturn(lanes, at)
        return at


def gains(samples: Array) -> Array:
    """The change of s over the interval after each sample, 0 after the last sample."""
    return np.append(np.diff(samples), 0.0)
