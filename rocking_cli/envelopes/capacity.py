"""Capacity: the lowest amplitude that overturns one body, and the end of the safe
interval around a demand.

The boundaries are traced as in an envelope, but the search stops when both answers are
known. The demand is one of the amplitudes of the search, so the answers agree with the
response at the demand.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..dynamics.march.closings import FEW_SIGN_CHANGES
from ..dynamics.method import Method
from ..dynamics.outcome import Outcome, safe
from ..dynamics.shared_march import SharedMarch
from ..errors import UsageError
from ..motions import Motion
from ..structures.parameters import RockingParameters
from .amplitudes import COARSE, LONGEST_FINE
from .boundaries import (
    ScanPoints,
    Search,
    changes_between,
    lifted,
    looks_finely,
)
from .changes import Brackets, narrowed
from .intervals import HIGHEST

if TYPE_CHECKING:
    from .lowest_fall import FallSearch

Array = np.ndarray

# ratio of neighbouring amplitudes, minus 1, of an envelope under a record: a cell costs
# as much as a thousand under a pulse
RATIO = 5e-3
_TRACED = 1e-6  # relative width to which boundaries under a record are traced
_STATED = 1e-4  # relative width of falls that may be missed in the tenth below a fall
# range of A in the first batch, whose cells cost about as much as one round of the
# march
_FIRST_WINDOW = 1.5
_SCANNED = 0.4  # share of its scan in a search under a record, for the progress
_HALF = 60  # marches after which half of the rest of the search is taken as done
# parts of a bracket in one cut: there are few brackets, and a batch costs the same for
# any size
_PARTS = 256


@dataclass(frozen=True)
class Capacity:
    """The capacity of a body against a demand."""

    first: float | None  # lowest A that overturns [-], None if there is none
    # A at the end of the safe interval around the demand [-], None if the body falls
    # under the demand or no larger amplitude overturns it
    safe_to: float | None
    uplift: float | None  # lowest A that lifts the body [-], None if there is none
    # under a record or a pulse of several cycles, the share of amplitudes up to 5 %
    # above `first` that fall [-], if they form more than one interval, otherwise 0
    share_of_falls: float = 0.0


class CapacitySearch(NamedTuple):
    """A capacity to be computed. The search goes up to the larger of `a_max` and twice
    the demand.
    """

    structure: RockingParameters  # the structure
    motion: Motion  # the motion of the ground
    amplitude: float  # A of the demand [-]
    omega: float  # Omega of the demand [-]
    method: Method  # model and tolerance
    a_max: float  # largest A of the search [-]

    def ends(self) -> tuple[float, float]:
        """The least and the largest amplitude of the search. Raises UsageError if the
        largest is above the limit of a scan.
        """
        top = max(self.a_max, 2.0 * self.amplitude)
        if not top <= HIGHEST:
            raise UsageError(
                f"{self.structure.name}: found a search up to A = {top:.6g}; expected"
                f" up to {HIGHEST:g}"
            )
        return self.method.system_of(self.structure).least_uplift(self.motion), top

    def fall_search(self) -> FallSearch:
        """Set up the search for narrow falls."""
        from .lowest_fall import FallSearch

        digits = tracing_width(self.method, self.motion)
        return FallSearch.of(
            self.method.system_of(self.structure),
            self.motion,
            self.omega,
            self.structure.eta,
            digits,
        )

    def capacity(
        self,
        begun: FallSearch | Capacity | None = None,
        progress: Callable[[float], None] | None = None,
    ) -> Capacity:
        """Compute the capacity; begun: what `begun_together` has found of it; progress:
        called now and then with about the share that is done.

        Intervals narrower than `narrowest` may be missed, but not around the demand.
        Changes are traced to `tracing_width`. Raises UsageError if the demand or
        `a_max` is above the limit of a scan.
        """
        if begun is None:
            (begun,) = begun_together([self])
        if isinstance(begun, Capacity):
            return begun
        if progress is not None:
            begun = replace(begun, falls=_told_by_marches(begun.falls, progress))
        return self._by_falls(begun, *self.ends())

    def _by_falls(self, falls: FallSearch, lowest: float, top: float) -> Capacity:
        """The capacity under a record: the lowest falls below and above the demand."""
        demand = self.amplitude
        stands = demand <= lowest or not falls.falls(np.array([demand]))[0]
        below = falls.first(lowest, min(demand, top)) if lowest < demand else None
        above = falls.first(max(lowest, demand), top) if stands else None
        first = below or (above if stands else falls.lowest(lowest, demand))
        share = 0.0 if first is None else falls.share_of_falls(first)
        return Capacity(first, above, lowest, share)

    def _search(self) -> Search:
        """The search for the changes of the outcome, under a pulse."""
        return Search(
            self.method.system_of(self.structure),
            self.motion,
            self.structure.eta,
            self.ends()[1],
            digits=tracing_width(self.method, self.motion),
            parts=_PARTS,
        )


def begun_together(
    searches: Sequence[CapacitySearch], progress: Callable[[float], None] | None = None
) -> list[FallSearch | Capacity]:
    """Return for each search under a record the search for narrow overturning
    intervals, whose scans are one; under a pulse, and where the body is not lifted, the
    capacity. progress: called now and then with about the share of the searches that is
    done. Raises UsageError as `CapacitySearch.ends`.
    """
    found: dict[int, FallSearch | Capacity] = {}
    scanned = []
    motions: dict[int, list[int]] = {}  # the searches under each pulse
    for i, one in enumerate(searches):
        lowest, top = one.ends()
        if not lowest < top:
            found[i] = Capacity(None, None, lowest if np.isfinite(lowest) else None)
        elif _long(one.motion):
            found[i] = fall_search = one.fall_search()
            demand = float(np.clip(one.amplitude, lowest, top))
            scanned.append((fall_search, lowest, demand, top))
        else:
            motions.setdefault(id(one.motion), []).append(i)
    if scanned:
        from .lowest_fall import scan_together

        told = progress or (lambda _: None)
        scan_together(scanned, lambda share: told(_SCANNED * share))
    for own in motions.values():
        # Where the scan looks finely, the march of a body must not depend on others.
        finely = looks_finely(searches[own[0]].motion)
        groups = [[i] for i in own] if finely else [own]
        for group in groups:
            capacities = _Windows([searches[i] for i in group]).capacities()
            found.update(zip(group, capacities, strict=True))
    return [found[i] for i in range(len(searches))]


class _Windows:
    """The capacities of several bodies under one pulse: one window of amplitudes after
    the other, until the outcome at the demand and the next fall above it are known.
    """

    def __init__(self, asked: Sequence[CapacitySearch]) -> None:
        self.asked = asked
        self.motion = asked[0].motion
        self.searches = [one._search() for one in asked]
        self.omega = np.array([one.omega for one in asked])  # of each body [-]
        self.march = SharedMarch(
            self.motion, [one.structure for one in asked], [one.method for one in asked]
        )
        # the brackets of falls of each body, in the order of their amplitudes
        self.brackets: list[list[Brackets]] = [[] for _ in asked]
        # True if the last bracket of a body is above its demand
        self.above_demand = [False for _ in asked]

    def capacities(self) -> list[Capacity]:
        """Compute the capacities."""
        windows = [
            _windows(search.uplift, one.amplitude, search.a_max, search.system.bounded)
            for search, one in zip(self.searches, self.asked, strict=True)
        ]
        going = list(range(len(windows)))
        while going:
            window = {i: next(windows[i], None) for i in going}
            open_ones = {i: ends for i, ends in window.items() if ends is not None}
            going = self._searched(open_ones) if open_ones else []
        firsts = self._first_falls()
        return [self._capacity(i, found) for i, found in enumerate(firsts)]

    def _searched(self, windows: dict[int, tuple[float, float]]) -> list[int]:
        """Search a window of each of these bodies; returns the bodies to go on with."""
        bodies = list(windows)
        searches = [
            replace(self.searches[i], a_min=begin, a_max=end)
            for i, (begin, end) in windows.items()
        ]
        parts = [
            search.amplitudes(float(self.omega[i]))
            for i, search in zip(bodies, searches, strict=True)
        ]
        row = np.repeat(bodies, [part.size for part in parts])
        points = self._compute(row, np.concatenate(parts))
        counted = np.ones(row.size - 1, dtype=bool)
        finely = looks_finely(self.motion)
        changes = changes_between(points, counted, finely, self._compute)
        going = []
        for i, search in zip(bodies, searches, strict=True):
            label = points.label[row == i]
            own = changes.take(np.flatnonzero(changes.row == i))
            fall = _lowest_fall(own, i, search.lowest, int(label[0]))
            begin, end = windows[i]
            self.brackets[i] += [fall] if fall.row.size else []
            demand = self.asked[i].amplitude
            self.above_demand[i] = begin >= demand and fall.row.size > 0
            falls_at_demand = end <= demand and not safe(label[-1:])[0]
            if not (self.above_demand[i] or falls_at_demand):
                going.append(i)
        return going

    def _compute(self, row: Array, amplitude: Array) -> ScanPoints:
        """Compute the amplitudes of these bodies."""
        _, label, impacts = self.march.response(
            row, amplitude, self.omega[row], peaks=False
        )
        return ScanPoints(row, amplitude, lifted(label), impacts)

    def _first_falls(self) -> list[list[float]]:
        """The lowest overturning amplitude of each bracket of each body."""
        brackets = [one for own in self.brackets for one in own]
        body = np.repeat(np.arange(len(self.asked)), list(map(len, self.brackets)))
        first = np.zeros(body.size)
        digits = np.array([search.digits for search in self.searches])[body]
        for width in np.unique(digits):
            at = np.flatnonzero(digits == width)
            joined = Brackets.joined([brackets[i] for i in at])
            found = narrowed(
                lambda amplitude, row: self._outcome(amplitude, body[row]),
                replace(joined, row=at),
                float(width),
                _PARTS,
                True,
            )
            fallen = ~safe(found.above)
            for i in at:
                first[i] = found.high[fallen & (found.row == i)].min()
        return [first[body == i].tolist() for i in range(len(self.asked))]

    def _outcome(self, amplitude: Array, body: Array) -> Array:
        """The outcomes of these bodies, in the shape of the amplitudes."""
        own = np.broadcast_to(body, amplitude.shape).ravel()
        return self._compute(own, amplitude.ravel()).label.reshape(amplitude.shape)

    def _capacity(self, i: int, found: list[float]) -> Capacity:
        """The capacity of a body from the lowest overturning amplitudes found."""
        one, lowest = self.asked[i], self.searches[i].uplift
        if not found:
            return Capacity(None, None, lowest)
        first, share_of_falls = min(found), 0.0
        if falls_may_be_narrow(self.motion):
            first, share_of_falls = one.fall_search().lowest_and_share(lowest, first)
        if not self.above_demand[i]:
            return Capacity(first, None, lowest, share_of_falls)
        safe_to = found[-1] if first < one.amplitude else first
        return Capacity(first, safe_to, lowest, share_of_falls)


def _lowest_fall(changes: Brackets, row: int, lowest: float, label: int) -> Brackets:
    """Bracket of the lowest change of a body to an unsafe outcome, if any; the first
    amplitude counts too, as a change from rocking to its outcome.
    """
    start = Brackets(
        *(np.array([x]) for x in (row, lowest, lowest, Outcome.ROCKED, label))
    )
    brackets = changes.join(start)
    falls = np.flatnonzero(~safe(brackets.above))
    return brackets.take(falls[brackets.high[falls].argsort()[:1]])


def _told_by_marches(
    falls: Callable[[Array], Array], progress: Callable[[float], None]
) -> Callable[[Array], Array]:
    """The function `falls` of a search, which calls `progress` after each march. Nobody
    knows how many marches a search takes, so the share approaches 1."""
    marches = 0

    def told(amplitude: Array) -> Array:
        nonlocal marches
        found = falls(amplitude)
        marches += amplitude.size
        progress(1.0 - (1.0 - _SCANNED) * 0.5 ** (marches / _HALF))
        return found

    return told


def tracing_width(method: Method, motion: Motion) -> float:
    """The relative width to which a boundary is traced: 4e-16 for an exact method, else
    the tolerance; under a record at least 1e-6.
    """
    return max(method.stated_tolerance or 4e-16, _TRACED if _long(motion) else 0.0)


def narrowest(motion: Motion) -> str:
    """The width of intervals that a search may miss, as text."""
    return (
        f"{100.0 * COARSE:g} % of the amplitude ({100.0 * _STATED:g} % in the tenth"
        " below a fall)"
        if _long(motion)
        else "0.001 in A"
    )


def falls_may_be_narrow(motion: Motion) -> bool:
    """True if a search under this motion may find many narrow
    intervals that overturn.
    """
    return _long(motion) or motion.segments.sign_changes > FEW_SIGN_CHANGES


def _long(motion: Motion) -> bool:
    return len(motion.segments) > LONGEST_FINE


def _windows(
    lowest: float, demand: float, top: float, at_once: bool
) -> Iterator[tuple[float, float]]:
    """Ranges of amplitudes to search one after the other: one up to the demand, then
    wider and wider ones above it, or a single one with `at_once`.
    """
    begin, width = lowest, _FIRST_WINDOW
    if demand > lowest * (1.0 + 1e-12):
        yield lowest, demand
        begin = demand
    while begin < top:
        end = top if at_once or top - begin < 2.0 * width else begin + width
        yield begin, end
        begin, width = end, 2.0 * width
