"""Capacity: the lowest amplitude that overturns one body, and the end of the safe
interval around a demand.

The demand is one of the amplitudes of the search, so the answers agree with the
response at the demand.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..arrays import Array
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
    from .lowest_fall import FallSearch


# ratio of neighbouring amplitudes, minus 1, of an envelope under a record: a cell costs
# as much as a thousand under a pulse
RATIO = 5e-3
# relative changes of a demand, which its answer should withstand
SHIFTS = np.array([0.0, *(sign * 10.0**-n for n in (12, 9, 6) for sign in (-1.0, 1.0))])
_TRACED = 1e-6  # relative width to which boundaries under a record are traced
_STATED = 1e-4  # relative width of falls that may be missed in the tenth below a fall
_SCANNED = 0.4  # share of its scan in a search under a record, for the progress
_PROVED = 20  # rows of a climb from which on proofs below it take less time
_HALF = 60  # marches after which half of the rest of the search is taken as done


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
        # Where the climb looks finely, the march of a body must not depend on others.
        finely = looks_finely(searches[own[0]].motion)
        for group in [[i] for i in own] if finely else [own]:
            found.update(
                zip(group, _capacities([searches[i] for i in group]), strict=True)
            )
    return [found[i] for i in range(len(searches))]


def _capacities(searches: Sequence[CapacitySearch]) -> list[Capacity]:
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
    safe_to = above if above is not None and np.isfinite(above) else None
    return Capacity(first, safe_to, uplift, share_of_falls)


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
