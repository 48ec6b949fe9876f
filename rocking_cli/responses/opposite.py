"""The opposite direction of a motion, which matters to bodies whose sides differ."""

from collections.abc import Sequence

from ..dynamics.method import has_direction
from ..dynamics.outcome import Outcome
from ..envelopes.amplitudes import Limit
from .check import Demand, outcome_alone, standings


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
    found = list(standings([*demands, *opposite], a_max=limit, workers=workers))
    severities = [one.severity for one in found]
    here, there = severities[: len(demands)], severities[len(demands) :]
    return [worse > less for less, worse in zip(here, there, strict=True)]
