"""Whether structures withstand a motion with a margin: outcomes alone, without the
capacities of `check`.
"""

from collections.abc import Sequence

import numpy as np

from ..dynamics.outcome import Outcome, safe
from ..dynamics.shared_march import SharedMarch
from ..envelopes.boundaries import Search
from ..envelopes.capacity import CapacitySearch
from ..motions import Motion
from .check import Demand
from .shaken import SHIFTS, capacity_search

Array = np.ndarray


def withstand(
    demands: Sequence[Demand], margin: float, *, scanned: bool = True
) -> list[bool | None]:
    """Return for each demand whether no amplitude up to `margin` times the demand
    overturns the structure; None if the outcome at the demand is not known.

    It is the question whether the capacity of `check` is at least the margin times the
    demand, and the amplitudes are those of its search; it holds for structures that do
    not slide, under motions whose overturning intervals are wide
    (`falls_may_be_narrow`). scanned: False for the
    amplitudes at the margin and close to the demand only. The structures that can share
    a march are computed together. Raises UsageError as `check` does.
    """
    found: list[bool | None] = [None] * len(demands)
    motions = {id(motion): motion for _, motion, _ in demands}
    for motion in motions.values():
        own = [i for i, demand in enumerate(demands) if demand[1] is motion]
        group = _MarginSearch(
            motion, [capacity_search(*demands[i], 0.0) for i in own], margin
        )
        stands = group.stand_at_once()
        if scanned:
            group.scan(stands)
        for i, one in zip(own, stands, strict=True):
            found[i] = one
    return found


class _MarginSearch:
    """Structures under one motion, of each the search for its capacity."""

    def __init__(
        self, motion: Motion, searches: Sequence[CapacitySearch], margin: float
    ) -> None:
        self.searches, self.margin = searches, margin
        self.omega = np.array([search.omega for search in searches])  # of each [-]
        self.march = SharedMarch(
            motion,
            [search.structure for search in searches],
            [search.method for search in searches],
        )

    def _outcomes(self, which: Sequence[int], asked: Sequence[Array]) -> list[Array]:
        """Return the outcomes of these structures at the amplitudes of each."""
        sizes = [amplitudes.size for amplitudes in asked]
        own = np.repeat(np.asarray(which, dtype=np.int64), sizes)
        _, outcome, _ = self.march.response(
            own, np.concatenate(asked), self.omega[own], peaks=False
        )
        return np.split(outcome, np.cumsum(sizes)[:-1])

    def stand_at_once(self) -> list[bool | None]:
        """Return for each structure whether the amplitudes close to the demand, and the
        one at the margin, leave it standing; None if the outcome at the demand is not
        known.
        """
        asked = [
            np.append(one.amplitude * (1.0 + SHIFTS), self.margin * one.amplitude)
            for one in self.searches
        ]
        found: list[bool | None] = []
        every = range(len(asked))
        for amplitude, outcome in zip(asked, self._outcomes(every, asked), strict=True):
            if outcome[0] == Outcome.FAILED:
                found.append(None)
                continue
            falls = ~safe(outcome)
            falls[:-1] &= outcome[:-1] != Outcome.FAILED
            found.append(not falls[amplitude <= amplitude[-1]].any())
        return found

    def scan(self, stands: list[bool | None]) -> None:
        """Scan the amplitudes up to the margin of the structures that stand so far, and
        change the answers of those that one of them overturns.
        """
        which, asked = [], []
        for i, one in enumerate(self.searches):
            lowest, _ = one._replace(a_max=self.margin * one.amplitude).ends()
            if stands[i] and lowest < self.margin * one.amplitude:
                which.append(i)
                asked.append(self._scan_of(one))
        if not which:
            return
        for i, outcome in zip(which, self._outcomes(which, asked), strict=True):
            stands[i] = bool(safe(outcome).all())

    def _scan_of(self, one: CapacitySearch) -> Array:
        """The amplitudes of the scan of a structure up to the margin."""
        system, top = one.method.system_of(one.structure), self.margin * one.amplitude
        scan = Search(system, one.motion, one.structure.eta, top)
        (first,) = scan.safe_points(np.array([one.omega]))
        return scan.grid.amplitude(np.arange(first, scan.grid.size))
