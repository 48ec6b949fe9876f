"""The largest amplitude of a search. An acceleration as limit gives a different A for each structure."""

from __future__ import annotations

from typing import NamedTuple

from ..errors import UsageError
from ..structures.parameters import RockingParameters


class Limit(NamedTuple):
    """The largest amplitude of a search: A, or an acceleration [m/s2]."""

    value: float
    acceleration: bool = False

    def of(self, structure: RockingParameters) -> float:
        """Returns the limit as A for a structure. Raises UsageError for an acceleration if the structure has no units."""
        if not self.acceleration:
            return self.value
        if structure.dimensionless:
            raise UsageError("`a_max`: found an acceleration; expected a number A for a structure without units")
        return float(structure.dimensionless_amplitude(self.value))


def limit_of(a_max: float | Limit, structure: RockingParameters) -> float:
    """Returns the limit as A for a structure; a number is returned as it is. Raises UsageError as `Limit.of`."""
    return a_max.of(structure) if isinstance(a_max, Limit) else a_max
