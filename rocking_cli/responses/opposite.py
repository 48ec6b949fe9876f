"""The opposite direction of a motion, which matters to bodies whose sides differ."""

from collections.abc import Sequence

from ..dynamics.method import has_direction
from ..dynamics.outcome import Outcome
from ..envelopes.amplitudes import Limit
from .check import Demand, outcome_alone, standings, verdicts


def opposite_outcomes(demands: Sequence[Demand]) -> list[tuple[str, Outcome]]:
    """Return the name of each structure whose sides differ, and its outcome under the
    demand in the opposite direction.
    """
    return [
        (structure.name, outcome_alone(structure, motion.scaled(-1.0), grid))
        for structure, motion, grid in demands
        if has_direction(structure)
    ]


def opposite_is_worse(
    demands: Sequence[Demand],
    opposite: Sequence[Demand],
    limit: Limit | None,
    workers: int | None,
) -> list[bool]:
    """Return whether the second demand on each structure is worse than the first: it
    falls, or has the lesser capacity, or else rocks further. limit: largest amplitude
    of the search for capacities, None without a search.
    """
    every, count = [*demands, *opposite], len(demands)
    if limit is None:
        severities = [(outcome_alone(*demand).falls, 0.0) for demand in every]
    else:
        severities = [
            (one.falls, 1.0 / one.capacity_demand if one.capacity_demand else 0.0)
            for one in standings(every, a_max=limit, workers=workers)
        ]
    pairs = list(zip(severities[:count], severities[count:], strict=True))
    worse = [there > here for here, there in pairs]
    equal = [i for i, (here, there) in enumerate(pairs) if here == there]
    turned = [
        one.theta_ratio or 0.0
        for i in equal
        for one in verdicts([demands[i], opposite[i]], a_max=None)
    ]
    for i, here, there in zip(equal, turned[::2], turned[1::2], strict=True):
        worse[i] = there > here
    return worse
