"""The first overturning amplitudes of many rows, a body at one Omega each: they are
bracketed by a scan of the amplitudes, and narrowed only as far as a comparison needs.
"""

from collections.abc import Callable, Mapping

import numpy as np

from ..dynamics.outcome import Outcome, safe
from ..dynamics.shared_march import SharedMarch
from ..processes import refuse_endless
from .boundaries import AROUND, ScanPoints, Search, changes_between, looks_finely

Array = np.ndarray

_CELLS = 40_000  # cells of the scan that are computed together, about
# amplitudes of a row that are computed together, at least and at most
_FEWEST, _MOST = 200, 2000
_PARTS = 256  # parts of a bracket in one cut


class FirstFalls:
    """The first overturning amplitude of rows: `low` < first <= `high`, where `low` is
    the amplitude of the scan below it, or a closer one that stands.
    """

    def __init__(
        self,
        march: SharedMarch,
        searches: Mapping[int, Search],
        body: Array,
        omega: Array,
        digits: Array,
    ) -> None:
        self.march = march  # computes the outcomes of the bodies
        self.searches = searches  # the amplitudes of the scan of each body
        self.body = body  # index of the body of each row, (rows,)
        self.omega = omega  # Omega of each row [-], (rows,)
        self.digits = digits  # relative width of a closed bracket, (bodies,)
        self.low = np.full(body.size, np.inf)  # [-], (rows,)
        # [-], infinite where no amplitude of the scan overturns, (rows,)
        self.high = np.full(body.size, np.inf)

    def climb(
        self,
        most: Array,
        lowers: Callable[[Array], Array] | None = None,
        tell: Callable[[float], None] = lambda _: None,
    ) -> None:
        """Bracket the first fall of every row, up to the amplitudes `most` [-],
        (bodies,). lowers: function of the rows that have just fallen, which returns the
        new `most`; tell: called with the share that is done.
        """
        most = most.copy()
        begins = self._first_points()
        ahead = ScanPoints(*(np.zeros(0, dtype=x) for x in (int, float, int, int)))
        going, place, cells = np.arange(self.body.size), 0, 0
        while going.size:
            # A stretch of scan points, the same ones of every row that goes on.
            count = int(np.clip(_CELLS // going.size, _FEWEST, _MOST))
            point = np.arange(place, place + count)
            row, at = np.nonzero(point >= begins[going, None])
            row, amplitude = going[row], self._amplitude(going[row], point[at])
            below = amplitude <= most[self.body[row]]
            new = self._compute(row[below], amplitude[below])
            place += count

            # The first falls in it; fallen rows, and rows that are through, end.
            self._take_falls(_with(ahead, new))
            fallen = going[np.isfinite(self.high[going])]
            if lowers is not None and fallen.size:
                most = lowers(fallen)
            going = going[np.isinf(self.high[going])]
            next_one = self._amplitude(going, np.full(going.size, place))
            share = next_one / most[self.body[going]]
            tell(float(share.min(initial=1.0)))
            going = going[share <= 1.0]
            ahead = self._tail(new, going)
            cells += new.row.size
            refuse_endless(cells, len(self.march.motion.segments))

    def _first_points(self) -> Array:
        """The first scan point of each row that is computed: nothing below it
        overturns.
        """
        first = np.zeros(self.body.size, dtype=np.int64)
        for body in np.unique(self.body):
            rows = np.flatnonzero(self.body == body)
            first[rows] = self.searches[body].safe_points(self.omega[rows])
        return first

    def _amplitude(self, row: Array, point: Array) -> Array:
        """The amplitudes of scan points of these rows, infinite beyond the last one."""
        found = np.zeros(row.size)
        body = self.body[row]
        for i in np.unique(body):
            own, grid = body == i, self.searches[i].grid
            inside = point[own] < grid.size
            found[own] = np.where(inside, grid.amplitude(point[own]), np.inf)
        return found

    def _compute(self, row: Array, amplitude: Array) -> ScanPoints:
        _, label, impacts = self.march.response(
            self.body[row], amplitude, self.omega[row], peaks=False
        )
        label[label == Outcome.NO_UPLIFT] = Outcome.ROCKED
        return ScanPoints(row, amplitude, label, impacts)

    def _take_falls(self, points: ScanPoints) -> None:
        """Take the lowest fall between these points of each row, or at the first."""
        finely = looks_finely(self.march.motion)
        counted = np.ones(max(0, points.row.size - 1), dtype=bool)
        found = changes_between(points, counted, finely, self._compute)
        falls = np.flatnonzero(~safe(found.above))
        falls = falls[np.lexsort((found.high[falls], found.row[falls]))]
        rows, first = np.unique(found.row[falls], return_index=True)
        self.low[rows] = found.low[falls[first]]
        self.high[rows] = found.high[falls[first]]
        # The first point of a row has no amplitude below it.
        rows, first = np.unique(points.row, return_index=True)
        at_once = ~safe(points.label[first])
        amplitude = points.amplitude[first[at_once]]
        self.low[rows[at_once]] = self.high[rows[at_once]] = amplitude

    @staticmethod
    def _tail(points: ScanPoints, rows: Array) -> ScanPoints:
        """The last points of these rows, next to which the next ones may be changes."""
        _, counts = np.unique(points.row, return_counts=True)
        ends = np.repeat(np.cumsum(counts), counts)
        last = np.arange(points.row.size) >= ends - AROUND - 1
        kept = last & np.isin(points.row, rows)
        return ScanPoints(*(x[kept] for x in points))

    def sharpen(self, rows: Array) -> None:
        """Narrow the brackets of these rows by one cut each."""
        rows = rows[self.open(rows)]
        if not rows.size:
            return
        share = np.arange(1, _PARTS) / _PARTS
        low, high = self.low[rows, None], self.high[rows, None]
        inner = low + (high - low) * share
        label = self._compute(np.repeat(rows, _PARTS - 1), inner.ravel()).label
        falls = np.column_stack([~safe(label).reshape(inner.shape), rows >= 0])
        at, of = falls.argmax(axis=1), np.arange(rows.size)
        ends = np.column_stack([low, inner, high])
        self.low[rows], self.high[rows] = ends[of, at], ends[of, at + 1]

    def open(self, rows: Array) -> Array:
        """True for rows whose bracket can be narrowed."""
        low, high = self.low[rows], self.high[rows]
        middle = 0.5 * (low + high)
        wide = high - low > self.digits[self.body[rows]] * high
        return np.isfinite(high) & wide & (low < middle) & (middle < high)

    def not_above(self, rows: Array, others: Array) -> Array:
        """True where the first fall of a row is not above that of another one, (pairs,)
        each. The brackets are narrowed until they tell.
        """
        while True:
            above = self.low[rows] >= self.high[others]
            below = self.high[rows] <= self.low[others]
            same = rows == others
            unknown = ~(above | below | same)
            unclear = np.unique(np.append(rows[unknown], others[unknown]))
            unclear = unclear[self.open(unclear)]
            if not unclear.size:
                equal = unknown & (self.high[rows] <= self.high[others])
                return same | below | equal
            self.sharpen(unclear)

    def lowest(self, rows: Array) -> int:
        """The row with the lowest first fall of these rows; the first of equal ones."""
        while True:
            best = rows[self.high[rows].argmin()]
            rivals = rows[(self.low[rows] < self.high[best]) & (rows != best)]
            unclear = np.append(rivals, best) if rivals.size else rivals
            if not self.open(unclear).any():
                return int(best)
            self.sharpen(unclear)

    def exceeds(self, rows: Array, amplitude: Array) -> Array:
        """True where the first fall of a row is above an amplitude, (rows,) each."""
        while True:
            above, below = self.low[rows] >= amplitude, self.high[rows] <= amplitude
            unclear = rows[~(above | below)]
            unclear = unclear[self.open(unclear)]
            if not unclear.size:
                return self.high[rows] > amplitude
            self.sharpen(unclear)


def _with(one: ScanPoints, other: ScanPoints) -> ScanPoints:
    """Both points, by row and amplitude."""
    row, amplitude, label, impacts = (
        np.concatenate([x, y]) for x, y in zip(one, other, strict=True)
    )
    order = np.lexsort((amplitude, row))
    return ScanPoints(row[order], amplitude[order], label[order], impacts[order])
