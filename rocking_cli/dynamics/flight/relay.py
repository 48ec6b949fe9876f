"""The relay: few cells under a long record, whose legs are walked side by side.

A body at rest has forgotten how it came there: where and how it lifts off again follows from the record alone, and with it every digit of
what comes. So the legs between marks of the record are walked at once, each by a runner who takes the body to be at rest at its mark. One
that comes to the next mark otherwise than the leg from there begins goes on in the place of its runner; one that comes there as it begins,
to the last bit, is done. When all are, each leg begins as the one before it ends: that is the way of the cell, the same as of one walk.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

import numpy as np

from ..lanes import Cells, Lanes
from ..march.account import Work
from ..outcome import Outcome, overturned
from .walk import Walk, Walkers

if TYPE_CHECKING:
    from ..march.lines import LineDemands

Array = np.ndarray

FULL = 4096  # legs side by side: beyond it a stride's time is that of its elements, not of its calls
_SHORTEST, _FIRST = 256, 1 << 13  # samples of a leg, at least; of the first stretch, each later one being twice as long
_AHEAD = 8  # legs that a runner takes over from others as long as it is not certain that the cell comes that way
_STATE = ("k", "u", "side", "y", "v", "b", "peak", "impacts", "steps")  # what makes two lanes of a cell the same from there on
_OPEN = np.uint8(255)  # in the place of an outcome


def relay(walk: Walk, cell: Array) -> None:
    """Bring these cells of a walk to their end, stretch by stretch, so that those that fall are left out of later ones."""
    lanes, begin, span, alone = walk.start(cell), 0, _FIRST, False
    while lanes.cell.size:
        begin = max(begin, min(int(lanes.k.min()), walk.last - 1))  # bodies at rest lift off later
        end = walk.last if begin + 3 * span // 2 > walk.last else begin + span
        count = 1 if alone else int(np.clip(FULL // lanes.cell.size, 1, max(1, (end - begin) // _SHORTEST)))
        marks = np.linspace(begin, end, count + 1).astype(np.int64)
        marks[-1] += end == walk.last  # nobody hands over there
        legs = Legs(walk, lanes, marks)
        legs.run()
        lanes, alone = legs.hand_in(), 2 * legs.taken_over > legs.outcome.size  # bodies that hardly rest: in the next stretch one by one
        begin, span = end, 2 * span


@dataclass
class Runners(Walkers):
    """Lanes on legs, which are their cells; runner: the leg they set out on."""

    runner: Array


class Legs(Walk):
    """The legs of lanes of a walk between marks, those of a lane one after the other, as cells of their own.

    begins, ends: how they do, as lanes; runner: who is on a leg, -1 where it does not matter any more; linked: whether the next leg begins
    as this one ends; taken_over: how many did not at first.
    """

    def __init__(self, walk: Walk, lanes: Lanes, marks: Array) -> None:
        self.__dict__.update(walk.__dict__)
        self.walk, self.lanes, self.count, size = walk, lanes, marks.size - 1, lanes.cell.size
        own = np.repeat(lanes.cell, self.count)
        self.cells = Cells(*(x[:, own] for x in walk.cells))
        self.equation, self.apart, self.work, self.demands = walk.equation.of(own), True, Work(), None
        self.theta_ratio, self.risen = np.zeros(own.size), np.zeros(own.size)
        self.impacts, self.struck = (np.zeros(own.size, dtype=np.int32) for _ in range(2))
        self.outcome, self.until = np.full(own.size, _OPEN), np.tile(marks[1:], size)
        if self.equation.damping:
            self.bounced = np.zeros(own.size, dtype=bool)
        every, begin = np.arange(own.size), np.tile(marks[:-1], size)  # at rest there
        self.begins = self._lifted(every, self.contact.uplift(self.cells, self.segments, every, begin, np.zeros(own.size)))
        first = lanes.take(np.arange(size))
        first.cell = np.arange(0, own.size, self.count)
        self.begins.put(first.cell, first)
        self.ends = self.begins.take(np.arange(own.size))
        self.runner, self.linked = np.arange(own.size), np.zeros(own.size, dtype=bool)
        self.closed, self.taken_over = False, 0

    def run(self) -> None:
        """Until each leg that matters begins as the one before it ends."""
        entering = self.begins.take(np.arange(self.outcome.size))  # copied: those that walk are changed in their place
        while entering.cell.size:
            self._walk(entering.cell.size, entering.take)
            entering = self._left()

    def _left(self) -> Lanes:
        """Lanes at the end of legs that cells are certain to come to and that nobody has gone on from, on the next one."""
        shape = (-1, self.count)
        waits = self._certain() & ((self.outcome == _OPEN) & ~self.linked).reshape(shape)
        waits[:, -1] = False
        lanes = self.ends.take(np.flatnonzero(waits))
        self.linked[lanes.cell] = True
        lanes.cell = lanes.cell + 1
        self._enter(lanes, lanes.cell)
        return lanes

    def _certain(self) -> Array:
        """Legs that are known to be on the way of their cell, (cells, legs)."""
        linked = self.linked.reshape(-1, self.count)
        return np.logical_and.accumulate(np.column_stack([np.ones(len(linked), dtype=bool), linked[:, :-1]]), axis=1)

    def hand_in(self) -> Lanes:
        """Hand in what became of the lanes to their walk; those that go on."""
        walk, cell, shape = self.walk, self.lanes.cell, (-1, self.count)
        open_ = (self.outcome == _OPEN).reshape(shape)
        goes = open_.all(axis=1)
        final = np.where(goes, self.count - 1, np.argmin(open_, axis=1))
        walk.work += self.work
        risen = np.where(np.arange(self.count) <= final[:, None], self.risen.reshape(shape), 0.0)
        walk.risen[cell] = np.maximum(walk.risen[cell], risen.max(axis=1))
        walk.struck[cell] += np.where(np.arange(self.count) < final[:, None], self.struck.reshape(shape), 0).sum(axis=1, dtype=np.int32)
        leg = np.arange(cell.size) * self.count + final
        self._settle_cells(cell[~goes], leg[~goes])
        cell, leg = cell[goes], leg[goes]
        walk.struck[cell] += self.struck[leg]
        lanes = self.ends.take(leg)
        lanes.cell = cell
        if walk.demands is not None:
            taken = (np.arange(self.count) <= final[:, None]) & ~overturned(walk.outcome[self.lanes.cell])[:, None]
            asked = Asking(self, walk.demands).of(np.flatnonzero(taken))
            walk.demands.take_over(asked, np.repeat(self.lanes.cell, self.count))
        return lanes

    def _settle_cells(self, cell: Array, leg: Array) -> None:
        """What became of cells in their last leg."""
        walk, outcome = self.walk, self.outcome[leg]
        after = (walk.struck[cell] > 0) & (outcome == Outcome.OVERTURNED_NO_IMPACT)
        walk.outcome[cell] = np.where(after, np.uint8(Outcome.OVERTURNED_AFTER_IMPACT), outcome)
        walk.impacts[cell] = self.impacts[leg] + walk.struck[cell]
        if walk.peaks:
            walk.theta_ratio[cell] = np.maximum(self.theta_ratio[leg], walk.risen[cell])

    def _stop(self, cell: Array) -> Array:
        return np.minimum(self.until[cell], self.last)

    def _launch(self, lanes: Lanes, slot: Array) -> Runners:
        there = super()._launch(lanes, slot)
        return Runners(**{f.name: getattr(there, f.name) for f in fields(there)}, runner=lanes.cell.copy())

    def _careful(self, lanes: Walkers) -> Walkers:
        """Lanes that have come to the end of their leg go on in the next one without a round."""
        assert isinstance(lanes, Runners)
        lanes = lanes.take(np.flatnonzero(self.runner[lanes.cell] == lanes.runner))
        over = lanes.k >= self.until[lanes.cell]
        if not over.any():
            return super()._careful(lanes)
        onward = self._hand_over(lanes.take(np.flatnonzero(over)))
        lanes = lanes.take(np.flatnonzero(~over & (self.runner[lanes.cell] == lanes.runner)))
        return super()._careful(lanes).join(onward)

    def _hand_over(self, lanes: Runners) -> Runners:
        """Those of these lanes, at the end of their leg, that come to the next otherwise than it begins: they take it over."""
        lanes.b[(lanes.u == 0.0) & (lanes.y > 0.0)] = 0.0  # it follows from the rest, and is not kept while they walk
        gone = lanes.take(slice(0, 0))
        while lanes.cell.size:
            self.ends.put(lanes.cell, lanes)
            lanes = lanes.take(np.flatnonzero((lanes.cell + 1) % self.count))
            lanes.cell = lanes.cell + 1
            differ = np.zeros(lanes.cell.size, dtype=bool)
            for name in _STATE:
                differ |= getattr(lanes, name) != getattr(self.begins, name)[lanes.cell]
            self.linked[lanes.cell[~differ] - 1] = True
            lanes = lanes.take(np.flatnonzero(differ))
            far = lanes.cell - lanes.runner > _AHEAD
            if far.any():
                lanes = lanes.take(np.flatnonzero(~far | self._certain().ravel()[lanes.cell - 1]))
            self.linked[lanes.cell - 1] = True
            self._enter(lanes, lanes.runner)
            past = lanes.k >= self.until[lanes.cell]
            gone, lanes = gone.join(lanes.take(np.flatnonzero(~past))), lanes.take(np.flatnonzero(past))
        return gone

    def _enter(self, lanes: Lanes, runner: Array) -> None:
        """These lanes begin their leg in the place of whoever was on it."""
        leg = lanes.cell
        self.taken_over += leg.size
        self.begins.put(leg, lanes)
        self.runner[leg], self.linked[leg], self.outcome[leg], self.risen[leg], self.struck[leg] = runner, False, _OPEN, 0.0, 0
        if self.equation.damping:
            self.bounced[leg] = False

    def _finish(self, lanes: Lanes, at: Array, outcome: Outcome, peak: Array | float) -> None:
        super()._finish(lanes, at, outcome, peak)
        self.closed |= at.size > 0

    def _lost(self, lanes: Walkers, at: Array) -> Array:
        """Runners in whose place others are, or who have nothing to decide, besides those that nothing can bring back."""
        assert isinstance(lanes, Runners)
        if self.closed:
            self._leave_out()
        idle = self.runner[lanes.cell[at]] != lanes.runner[at]
        return np.concatenate([at[idle], super()._lost(lanes, at[~idle])])

    def _leave_out(self) -> None:
        """The legs of cells whose end is known."""
        self.closed, shape = False, (-1, self.count)
        known = self._certain() & (self.outcome != _OPEN).reshape(shape)
        self.runner.reshape(shape)[known.any(axis=1)] = -1


class Asking(Walk):
    """Legs walked once more, each from where it is known to begin, for what they ask of the ground."""

    def __init__(self, legs: Legs, demands: LineDemands) -> None:
        self.__dict__.update(legs.__dict__)
        self.begins, self.until = legs.begins, legs.until
        self.found = type(demands)(demands.body, self.equation, self.segments, self.shaken, self.contact, self.cells)
        self.demands, self.work = self.found, Work()
        if self.equation.damping:
            self.bounced = np.zeros(self.until.size, dtype=bool)

    def of(self, leg: Array) -> LineDemands:
        """Of these legs; bodies that stay at rest ask no more than was asked as they came to it."""
        lanes = self.begins.take(leg)
        lanes = lanes.take(np.flatnonzero((lanes.k < len(self.segments)) | (lanes.y > 0.0)))
        self._walk(lanes.cell.size, lanes.take)
        return self.found

    def _stop(self, cell: Array) -> Array:
        return np.minimum(self.until[cell], self.last)

    def _careful(self, lanes: Walkers) -> Walkers:
        """Lanes at the end of their leg are done."""
        return super()._careful(lanes.take(np.flatnonzero(lanes.k < self.until[lanes.cell])))
