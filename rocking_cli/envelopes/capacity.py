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
from ..dynamics.outcome import Outcome
from ..errors import UsageError
from ..motions import Motion
from ..structures.parameters import RockingParameters
from .amplitudes import COARSE, LONGEST_FINE
from .boundaries import Search
from .changes import Brackets
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
        fall_search: FallSearch | None = None,
        progress: Callable[[float], None] | None = None,
    ) -> Capacity:
        """Compute the capacity; fall_search: one of `fall_searches`; progress: called
        now and then with about the share that is done.

        Intervals narrower than `narrowest` may be missed, but not around the demand.
        Changes are traced to `tracing_width`. Raises UsageError if the demand or
        `a_max` is above the limit of a scan.
        """
        lowest, top = self.ends()
        if not lowest < top:
            return Capacity(None, None, lowest if np.isfinite(lowest) else None)
        fall_search = fall_search or fall_searches([self])[0]
        if fall_search is None:
            return self._by_windows(lowest, top)
        if progress is not None:
            told = _told_by_marches(fall_search.falls, progress)
            fall_search = replace(fall_search, falls=told)
        return self._by_falls(fall_search, lowest, top)

    def _by_falls(self, falls: FallSearch, lowest: float, top: float) -> Capacity:
        """The capacity under a record: the lowest falls below and above the demand."""
        demand = self.amplitude
        stands = demand <= lowest or not falls.falls(np.array([demand]))[0]
        below = falls.first(lowest, min(demand, top)) if lowest < demand else None
        above = falls.first(max(lowest, demand), top) if stands else None
        first = below or (above if stands else falls.lowest(lowest, demand))
        share = 0.0 if first is None else falls.share_of_falls(first)
        return Capacity(first, above, lowest, share)

    def _by_windows(self, lowest: float, top: float) -> Capacity:
        """The capacity under a pulse: one window of amplitudes after the other, until
        the outcome at the demand and the next fall above it are known.
        """
        motion, demand = self.motion, self.amplitude
        system = self.method.system_of(self.structure)
        search = Search(
            system,
            motion,
            self.structure.eta,
            top,
            digits=tracing_width(self.method, motion),
            parts=_PARTS,
        )
        brackets: list[Brackets] = []
        above_demand = False
        for begin, end in _windows(lowest, demand, top, at_once=system.bounded):
            fall, last = replace(search, a_min=begin, a_max=end).fall(self.omega)
            brackets += [fall] if fall.row.size else []
            above_demand = begin >= demand and fall.row.size > 0
            if above_demand or (end <= demand and not Outcome(last).safe):
                break
        if not brackets:
            return Capacity(None, None, lowest)

        found = search.first_falls_in(self.omega, Brackets.joined(brackets))
        first, share_of_falls = min(found), 0.0
        if falls_may_be_narrow(motion):
            first, share_of_falls = self.fall_search().lowest_and_share(lowest, first)
        if not above_demand:
            return Capacity(first, None, lowest, share_of_falls)
        safe_to = found[-1] if first < demand else first
        return Capacity(first, safe_to, lowest, share_of_falls)


def fall_searches(
    searches: Sequence[CapacitySearch], progress: Callable[[float], None] | None = None
) -> list[FallSearch | None]:
    """Return for each capacity the search for narrow overturning intervals, None if its
    motion needs none; one scan serves all searches. progress: called now and then with
    about the share of the searches that is done. Raises UsageError as
    `CapacitySearch.ends`.
    """
    found: list[FallSearch | None] = []
    scanned = []
    for one in searches:
        lowest, top = one.ends()
        fall_search = one.fall_search() if _long(one.motion) and lowest < top else None
        found.append(fall_search)
        if fall_search is not None:
            scanned.append(
                (fall_search, lowest, float(np.clip(one.amplitude, lowest, top)), top)
            )
    if scanned:
        from .lowest_fall import scan_together

        told = progress or (lambda _: None)
        scan_together(scanned, lambda share: told(_SCANNED * share))
    return found


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
