"""The search for the lowest amplitude that overturns a body, for many bodies together:
they climb from amplitude to amplitude until they fall, and the brackets of their falls
are narrowed.

Nothing wider than 0.001 in A is missed. Just above uplift the amplitudes are closer,
and so they are around changes under a motion of many cycles, where narrow intervals
gather; that is no proof. With a ratio in place of this step, intervals that are
narrower than the ratio may be missed.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ..arrays import Array
from ..dynamics.outcome import Outcome, safe
from .amplitudes import SCAN_STEP
from .boundaries import AROUND, ScanPoints, changes_between
from .changes import Brackets, narrowed

# function of rows and their amplitudes, (cells,) each: (codes of `Outcome`, numbers of
# impacts)
RowMarch = Callable[[Array, Array], tuple[Array, Array]]

# cells of a climb that are computed together: in its first stretch, and at most; each
# stretch has twice as many as the one before
_FIRST, _CELLS = 2000, 40_000
_FEWEST = 24  # amplitudes of a row that are computed together, at least
# parts of a bracket in one cut, of many brackets and of few: a few hundred cells take
# as long as a dozen
_LEAST, _PARTS, _CUT = 16, 256, 4096
# distances of the first amplitudes from uplift [-]; the last step is SCAN_STEP long
_OFFSETS = SCAN_STEP * np.append(0.0, np.geomspace(1.0, 100.0, 460))
WITHIN = 1.2  # falls of a rival that matter, over the lowest one


class FirstFalls(NamedTuple):
    """The first falls of the rows of a search. Every array is (rows,)."""

    amplitude: Array  # lowest A that overturns [-], infinite where none does
    # the amplitude of the search below it [-], itself at the first amplitude
    stands: Array
    outcome: Array  # outcome there, a code of `Outcome`; ROCKED where none overturns


class Climb(NamedTuple):
    """The amplitudes A of a search, row by row. Every array is (rows,)."""

    low: Array  # the first amplitude [-]
    high: Array  # the last one [-]; a row without an amplitude has a lower one
    uplift: Array  # least amplitude that lifts the body [-]
    # largest ratio of neighbouring amplitudes minus 1 [-], in place of steps of 0.001
    ratio: float = 0.0

    def amplitude(self, row: Array, n: Array) -> Array:
        """The n-th amplitudes of rows, infinite beyond the last one."""
        low, high, uplift = self.low[row], self.high[row], self.uplift[row]
        if self.ratio:
            width = np.log(high / low)
            last = np.ceil(width / np.log1p(self.ratio))
            rung = low * np.exp(width * n / np.maximum(last, 1.0))
            return np.where(n < last, rung, np.where(n > last, np.inf, high))
        # The amplitudes above `low` do not depend on it.
        start = np.maximum(low - uplift, 0.0)
        first = _OFFSETS.searchsorted(start, side="right") + np.maximum(
            0, (start - _OFFSETS[-1]) // SCAN_STEP
        ).astype(np.int64)

        def at(n: Array) -> Array:
            return np.clip(uplift + _offset(first + n - 1), low, high)

        return np.where((n > 0) & (at(n - 1) >= high), np.inf, at(n))


def _offset(n: Array) -> Array:
    """The distance of the n-th amplitude of a scan from uplift [-]."""
    last = _OFFSETS.size - 1
    return _OFFSETS[np.clip(n, 0, last)] + SCAN_STEP * np.maximum(n - last, 0)


def lowest_falls(
    march: RowMarch,
    climb: Climb,
    digits: Array | float = np.inf,
    *,
    finely: bool = False,
    rivals: Array | None = None,
    stretch: int | None = None,
    tell: Callable[[float], None] = lambda _: None,
) -> FirstFalls:
    """Return the lowest amplitude of each row that overturns its body.

    digits: relative width to which brackets are narrowed, (rows,) or one for all,
    infinite for the amplitudes of the climb; finely: True for more amplitudes around a
    change of the outcome or of the number of impacts; rivals: number of the group of
    each row, of which falls more than 1.2 times the lowest one count as none; stretch:
    amplitudes of a row that are computed together, None for as many as take little
    time; tell: called with the share that is done.
    """
    climbing = _Climbing(march, climb, finely, rivals)
    while climbing.going.size:
        tell(climbing.climb_on(stretch))

    # The brackets of the falls are narrowed together.
    found = climbing.fallen.take(
        np.flatnonzero(climbing.fallen.high <= climbing.high[climbing.fallen.row])
    )
    parts = int(np.clip(_CUT // max(1, found.row.size), _LEAST, _PARTS))
    found = narrowed(
        lambda amplitude, row: climbing.compute(row, amplitude).label,
        found,
        digits,
        parts,
        lowest=True,
    )
    falls, stands = np.full((2, climb.high.size), np.inf)
    outcome = np.full(climb.high.size, Outcome.ROCKED, dtype=np.uint8)
    falls[found.row], stands[found.row] = found.high, found.low
    outcome[found.row] = found.above
    return FirstFalls(falls, stands, outcome)


class _Climbing:
    """The rows of a search on their way up: those that fall end."""

    def __init__(
        self, march: RowMarch, climb: Climb, finely: bool, rivals: Array | None
    ) -> None:
        self.march, self.climb = march, climb
        self.finely, self.rivals = finely, rivals
        self.high = climb.high.copy()  # the amplitude up to which each row climbs [-]
        self.going = np.flatnonzero(climb.low <= climb.high)
        self.place, self.room = 0, _FIRST
        # the last points of the stretch before, of the rows that still climb
        self.before = ScanPoints(*(np.zeros((self.going.size, 0), t) for t in "lfBl"))
        # brackets of the falls, of each row one
        self.fallen = Brackets(*(np.zeros(0, dtype=t) for t in "lffBB"))

    def compute(self, row: Array, amplitude: Array) -> ScanPoints:
        """The outcomes of rows at these amplitudes, of shapes that broadcast."""
        row = np.broadcast_to(row, amplitude.shape)
        outcome, impacts = self.march(row.ravel(), amplitude.ravel())
        outcome[safe(outcome)] = Outcome.ROCKED
        points = row, amplitude, outcome, impacts
        return ScanPoints(*(x.reshape(row.shape) for x in points))

    def climb_on(self, stretch: int | None) -> float:
        """Climb by a stretch, of so many amplitudes of each row; return the share of
        its way that the last row has climbed.
        """
        points = self._next_points(stretch)
        known = points.amplitude <= self.high[points.row]
        fallen = _first_changes(
            ScanPoints(*(x[known] for x in points)), self.finely, self.compute
        )

        # The rows that fall in it end; the others go on up to the falls of rivals.
        self.fallen = self.fallen.join(fallen)
        if self.rivals is not None:
            most = np.full(self.rivals.max() + 1, np.inf)
            np.minimum.at(most, self.rivals[fallen.row], WITHIN * fallen.high)
            self.high = np.minimum(self.high, most[self.rivals])
        come = self.climb.amplitude(self.going, np.array(self.place))
        share = come / self.high[self.going]
        on = ~np.isin(self.going, fallen.row) & (share <= 1.0)
        self.going = self.going[on]
        self.before = ScanPoints(*(x[on, -AROUND - 1 :] for x in points))
        return float(share[on].min(initial=1.0))

    def _next_points(self, stretch: int | None) -> ScanPoints:
        """A stretch of amplitudes of every row, after the last ones of the stretch
        before, next to which these may be changes.
        """
        count = stretch or max(_FEWEST, self.room // self.going.size)
        row = np.repeat(self.going[:, None], count, axis=1)
        amplitude = self.climb.amplitude(row, self.place + np.arange(count))
        self.room, self.place = min(2 * self.room, _CELLS), self.place + count
        inside = amplitude <= self.high[row]
        new = ScanPoints(row, amplitude, *np.zeros((2, *row.shape), dtype=np.int64))
        _, _, new.label[inside], new.impacts[inside] = self.compute(
            row[inside], amplitude[inside]
        )
        return ScanPoints(*map(np.hstack, zip(self.before, new, strict=True)))


def _first_changes(
    points: ScanPoints, finely: bool, compute: Callable[[Array, Array], ScanPoints]
) -> Brackets:
    """Brackets of the lowest fall of each row that has one between these points or at
    its first one; parameters as of `changes_between`.
    """
    same = points.row[1:] == points.row[:-1]
    changes = changes_between(points, same, finely, compute)
    # The first point of a row has no amplitude below it.
    row, amplitude, label, _ = (x[np.append(True, ~same)] for x in points)
    stands = np.full_like(label, Outcome.ROCKED)
    falls = changes.join(Brackets(row, amplitude, amplitude, stands, label))
    falls = falls.take(np.flatnonzero(~safe(falls.above)))
    falls = falls.take(np.lexsort((falls.high, falls.row)))
    return falls.take(np.unique(falls.row, return_index=True)[1])
