"""Whether structures withstand a motion with a margin: outcomes alone, without their
capacities.
"""

from collections.abc import Sequence

import numpy as np

from ..dynamics.outcome import Outcome, safe
from ..dynamics.shared_march import SharedMarch
from .capacity import SHIFTS, CapacitySearch
from .first_falls import Climb, lowest_falls


def withstand(
    searches: Sequence[CapacitySearch], margin: float, *, scanned: bool = True
) -> list[bool | None]:
    """Return for each search whether no amplitude up to `margin` times the demand
    overturns the structure; None if the outcome at the demand is not known.

    It is the question whether the capacity is at least the margin times the demand; it
    holds for structures that do not slide, under motions whose overturning intervals
    are wide (`falls_may_be_narrow`). scanned: False for the amplitudes at the margin
    and close to the demand only. The structures under one motion are computed together.
    Raises UsageError as `CapacitySearch.ends`.
    """
    found: list[bool | None] = [None] * len(searches)
    motions: dict[int, list[int]] = {}
    for i, one in enumerate(searches):
        motions.setdefault(id(one.motion), []).append(i)
    for own in motions.values():
        group = [searches[i] for i in own]
        for i, stands in zip(own, _withstand(group, margin, scanned), strict=True):
            found[i] = stands
    return found


def _withstand(
    searches: Sequence[CapacitySearch], margin: float, scanned: bool
) -> list[bool | None]:
    """`withstand` of structures under one motion."""
    march = SharedMarch(
        searches[0].motion,
        [search.structure for search in searches],
        [search.method for search in searches],
    )
    demand = np.array([search.amplitude for search in searches])
    omega = np.array([search.omega for search in searches])

    # The demand, amplitudes close to it, and the one at the margin.
    row, close = np.arange(demand.size), demand[:, None] * (1.0 + SHIFTS)
    asked = np.column_stack([close, margin * demand])
    outcome, _ = march.of_rows(row, omega)(
        np.repeat(row, asked.shape[1]), asked.ravel()
    )
    outcome = outcome.reshape(asked.shape)
    falls = ~safe(outcome)
    falls[:, :-1] &= outcome[:, :-1] != Outcome.FAILED
    stands = ~np.any(falls & (asked <= asked[:, -1:]), axis=1)
    known = outcome[:, 0] != Outcome.FAILED

    # The amplitudes up to the margin of those that stand so far.
    if scanned and (going := np.flatnonzero(stands & known)).size:
        most = margin * demand[going]
        uplift = np.array(
            [
                searches[i]._replace(a_max=top).ends()[0]
                for i, top in zip(going.tolist(), most.tolist(), strict=True)
            ]
        )
        climb = Climb(uplift, most, uplift)
        found = lowest_falls(march.of_rows(going, omega[going]), climb)
        stands[going] = np.isinf(found.amplitude)
    return [bool(x) if y else None for x, y in zip(stands, known, strict=True)]
