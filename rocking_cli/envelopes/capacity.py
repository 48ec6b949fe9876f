"""Capacity: the lowest amplitude that overturns one body, and the end of the safe
interval around a demand.

The demand is one of the amplitudes of the search, so the answers agree with the
response at the demand.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..dynamics.march.proofs import FEW_SIGN_CHANGES
from ..dynamics.method import Method
from ..dynamics.shared_march import SharedMarch
from ..errors import UsageError
from ..motions import Motion
from ..structures.parameters import RockingParameters
from .amplitudes import COARSE, LONGEST_FINE
from .boundaries import looks_finely
from .first_falls import Climb, lowest_falls
from .intervals import HIGHEST

if TYPE_CHECKING:
    from .narrow_falls import FallSearch


# ratio of neighbouring amplitudes, minus 1, of an envelope under a record: a cell costs
# as much as a thousand under a pulse
RATIO = 5e-3
# relative changes of a demand, which its answer should withstand
SHIFTS = np.array([0.0, *(sign * 10.0**-n for n in (12, 9, 6) for sign in (-1.0, 1.0))])
_TRACED = 1e-6  # relative width to which boundaries under a record are traced
_STATED = 1e-4  # relative width of falls that may be missed in the tenth below a fall
_TOGETHER = 24  # searches that share a scan, at most
_PROVED = 20  # rows of a climb from which on proofs below it take less time


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

    def can_be_scanned(self) -> bool:
        """True if an approximate scan can follow the body under a record."""
        from .scan import Scan

        return Scan.supports(self.method.system_of(self.structure), self.motion)

    def fall_search(self) -> FallSearch:
        """Set up the search for narrow falls."""
        from .narrow_falls import FallSearch

        digits = tracing_width(self.method, self.motion)
        return FallSearch.of(
            self.method.system_of(self.structure),
            self.motion,
            self.omega,
            digits,
        )

    def capacity(self) -> Capacity:
        """Compute the capacity.

        Intervals narrower than `narrowest` may be missed, but not around the demand.
        Changes are traced to `tracing_width`. Raises UsageError if the demand or
        `a_max` is above the limit of a scan.
        """
        (found,) = capacities([self])
        return found


def capacities(
    searches: Sequence[CapacitySearch],
    tell: Callable[[int, float], None] = lambda _, share: None,
) -> Iterator[Capacity]:
    """Yield the capacity of each search: those under one pulse share their marches, and
    some of those under records their scans. tell: called now and then with the index of
    a search and about the share of it that is done. Raises UsageError as
    `CapacitySearch.ends`.
    """
    found: dict[int, Capacity] = {}
    scanned: list[int] = []
    motions: dict[int, list[int]] = {}  # the searches under each pulse
    for i, one in enumerate(searches):
        lowest, top = one.ends()
        if not lowest < top:
            found[i] = Capacity(None, None, _finite(lowest))
        elif not _long(one.motion):
            motions.setdefault(id(one.motion), []).append(i)
        elif one.can_be_scanned():
            scanned.append(i)
    for own in motions.values():
        # Where the climb looks finely, the march of a body must not depend on others.
        finely = looks_finely(searches[own[0]].motion)
        for group in [[i] for i in own] if finely else [own]:
            found.update(
                zip(group, _under_a_pulse([searches[i] for i in group]), strict=True)
            )

    def search_records(some: list[int]) -> None:
        def told(share: float) -> None:
            for i in some:
                tell(i, share)

        under_records = _under_records([searches[i] for i in some], told)
        found.update(zip(some, under_records, strict=True))

    for i in range(len(searches)):
        if i not in found:
            search_records(scanned[:_TOGETHER] if i in scanned else [i])
            scanned = [k for k in scanned if k not in found]
        yield found[i]


def _under_records(
    searches: Sequence[CapacitySearch], progress: Callable[[float], None]
) -> list[Capacity]:
    """The capacities of bodies that are lifted, under records: the lowest falls below
    and above the demand.
    """
    from .narrow_falls import side_by_side

    rows = []
    for one in searches:
        falls, (lowest, top), demand = one.fall_search(), one.ends(), one.amplitude
        stands = demand <= lowest or not falls.falls(np.array([demand]))[0]
        falls.known[demand] = not stands
        rows += [
            (falls, falls.first(lowest, demand)),
            (falls, falls.first(max(lowest, demand), top if stands else demand)),
        ]
    ends = np.reshape(side_by_side(rows, progress), (-1, 2))
    return [
        Capacity(
            _finite(first := min(below, above)),
            _finite(above),
            one.ends()[0],
            falls.share_of_falls(first) if math.isfinite(first) else 0.0,
        )
        for one, (falls, _), (below, above) in zip(
            searches, rows[::2], ends.tolist(), strict=True
        )
    ]


def _finite(amplitude: float) -> float | None:
    """The amplitude, None if it is infinite."""
    return amplitude if math.isfinite(amplitude) else None


def _under_a_pulse(searches: Sequence[CapacitySearch]) -> list[Capacity]:
    """The capacities of bodies that are lifted, under one pulse: one climb up to the
    demand, and one above it.
    """
    motion, bodies = searches[0].motion, np.arange(len(searches))
    omega, demand = (
        np.array([getattr(one, key) for one in searches])
        for key in ("omega", "amplitude")
    )
    uplift, top = np.array([one.ends() for one in searches]).T
    digits = np.array([tracing_width(one.method, motion) for one in searches])
    march = SharedMarch(
        motion, [one.structure for one in searches], [one.method for one in searches]
    )
    lifted = demand > uplift * (1.0 + 1e-12)
    body = np.append(bodies[lifted], bodies)
    low = np.append(uplift[lifted], np.maximum(uplift, demand))
    high = np.append(demand[lifted], top)
    if body.size >= _PROVED:
        from .stretches import proved_to

        low = proved_to(march, body, omega[body], low, high)
    found = lowest_falls(
        march.of_rows(body, omega[body]),
        Climb(low, high, uplift[body]),
        digits[body],
        finely=looks_finely(motion),
    ).amplitude
    below, above = np.full(bodies.size, np.inf), found[-bodies.size :]
    below[lifted] = found[: -bodies.size]
    falls = lifted & (above == demand)  # the first amplitude above is the demand itself
    return [
        _capacity(one, float(lowest), min(first, then), None if falls_here else then)
        for one, lowest, first, then, falls_here in zip(
            searches, uplift, below.tolist(), above.tolist(), falls, strict=True
        )
    ]


def _capacity(
    search: CapacitySearch, uplift: float, first: float, above: float | None
) -> Capacity:
    """The capacity from the lowest fall, and that above the demand, None if the body
    falls under it; infinite without one.
    """
    if not np.isfinite(first):
        return Capacity(None, None, uplift)
    share_of_falls, is_first = 0.0, above == first
    if falls_may_be_narrow(search.motion):
        first, share_of_falls = search.fall_search().lowest_and_share(uplift, first)
    if is_first and first >= search.amplitude:
        above = first
    safe_to = None if above is None else _finite(above)
    return Capacity(first, safe_to, uplift, share_of_falls)


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
