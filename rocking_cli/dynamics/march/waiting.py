"""Steps of a march that wait for the fate of their cell: those of bodies that fall need not be looked at, and of the others all at once,
so that the largest of them spare the rest.

A cell that takes many steps has them looked at in parts of so many, always the same ones: neither other cells nor the time at which
somebody asks change a digit.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import NamedTuple, Self

import numpy as np

from ..equations.taylor import TaylorSeries
from ..lanes import Lanes
from .hulls import Hull

Array = np.ndarray

_PART = 8  # steps of a cell that are looked at together


class Steps(NamedTuple):
    """Lanes as they began a step, their series where they have one that is not found again cheaply, the step's length [tau], y and v at
    its end, and its hull with the series."""

    lanes: Lanes
    arc: TaylorSeries | None
    stop: Array
    y: Array
    v: Array
    hull: Hull | None

    def take(self, at: Array) -> Self:
        """Of some lanes."""
        arc = None if self.arc is None else self.arc.take(at)
        hull = None if self.hull is None else self.hull.take(at)
        return type(self)(self.lanes.take(at), arc, self.stop[at], self.y[at], self.v[at], hull)


def joined(steps: Sequence[Steps]) -> Steps:
    """All of these, which are of one equation."""
    if len(steps) == 1:
        return steps[0]
    first, rest = steps[0], steps[1:]
    lanes = Lanes.joined([x.lanes for x in steps])
    arc = None if first.arc is None else first.arc.join([x.arc for x in rest if x.arc is not None])
    hull = None if first.hull is None else first.hull.join([x.hull for x in rest if x.hull is not None])
    stop, y, v = (np.concatenate(parts) for parts in zip(*((x.stop, x.y, x.v) for x in steps), strict=True))
    return Steps(lanes, arc, stop, y, v, hull)


class Waiting:
    """The steps that wait."""

    def __init__(self) -> None:
        self._steps: list[tuple[Steps, Array]] = []
        self.held = 0

    def add(self, steps: Steps, at: Array) -> None:
        """Steps of which the lanes `at` are wanted; nobody may write into them any more."""
        if at.size:
            self._steps.append((steps, at))
            self.held += at.size

    def ready(self, done: Array, wanted: Array, promising: Callable[[Steps, Array], Array]) -> Iterator[list[tuple[Steps, Array]]]:
        """The parts of cells that are complete, one after the other, each over all cells; they no longer wait.

        done: how many parts each cell has completed; wanted: of which cells they are looked at, (cells,).
        """
        found, left = dict[int, list[tuple[Steps, Array]]](), []
        for steps, at in self._steps:
            if steps.hull is not None:
                at = at[promising(steps, at).any(axis=0)]
            cell, part = steps.lanes.cell[at], (steps.lanes.steps[at] - 1) // _PART
            ready = part < done[cell]
            look = np.flatnonzero(ready & wanted[cell])
            for n in np.flatnonzero(np.bincount(part[look])).tolist():
                found.setdefault(n, []).append((steps, at[look[part[look] == n]]))
            going = at[~ready]
            if 4 * going.size < steps.stop.size:
                steps, going = steps.take(going), np.arange(going.size)
            if going.size:
                left.append((steps, going))
        self._steps, self.held = left, sum(at.size for _, at in left)
        for n in sorted(found):
            yield found[n]


def parts_done(going: Lanes, cells: int) -> Array:
    """How many parts each cell has completed, all of those that are not among the lanes that go on; (cells,)."""
    done = np.full(cells, np.iinfo(np.int64).max)
    done[going.cell] = going.steps // _PART
    return done
