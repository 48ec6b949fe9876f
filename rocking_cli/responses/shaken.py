"""The answer of one body to a demand and to small changes of it."""

from typing import NamedTuple

import numpy as np

from ..dynamics.method import Method, governing_method
from ..dynamics.outcome import Outcome, safe
from ..dynamics.response import Response, response
from ..envelopes.capacity import SHIFTS, Capacity, CapacitySearch
from ..errors import UsageError
from ..motions import Motion
from ..motions.grid import Grid
from ..structures.parameters import RockingParameters

_SAME = 0.01  # of theta/alpha: rotations under them that differ by less are one


def capacity_search(
    structure: RockingParameters, motion: Motion, shaking: Grid, a_max: float
) -> CapacitySearch:
    """Return the search for the overturning amplitudes of a demand. Raises UsageError
    as `check` does.
    """
    if structure.dimensionless:
        raise UsageError("a restitution alone has no units: give a structure document")
    amplitude, omega = shaking.cell(structure)
    if not amplitude > 0.0:
        raise UsageError("the amplitude is 0; expected a positive one")
    return CapacitySearch(
        structure,
        motion,
        amplitude,
        omega,
        governing_method(structure, dimensionless=shaking.dimensionless),
        a_max,
    )


class Shaken(NamedTuple):
    """The answer of a body to a demand and to small changes of it."""

    search: CapacitySearch  # the search for its overturning amplitudes
    amplitudes: np.ndarray  # A [-]: the demand first, then amplitudes close to it
    response: Response  # by the governing equation, at these amplitudes

    @property
    def outcome(self) -> Outcome:
        """The outcome under the demand."""
        return Outcome(int(self.response.outcome[0]))

    @property
    def falling(self) -> np.ndarray:
        """Those of the amplitudes that overturn the body, (some,)."""
        outcome = self.response.outcome
        return self.amplitudes[~safe(outcome) & (outcome != Outcome.FAILED)]

    @property
    def unsettled(self) -> bool:
        """True if small changes of the demand change the outcome or the rotation."""
        stands = safe(self.response.outcome)
        if not stands.any():
            return False
        turned = self.response.theta_ratio[stands]
        return bool(self.falling.size or np.ptp(turned) > _SAME)

    def lowest(self, found: Capacity) -> tuple[float | None, float | None]:
        """(lowest overturning amplitude, end of the safe interval around the demand)
        [m/s2], None without one; found: what the search has found.
        """
        structure, demand = self.search.structure, self.search.amplitude
        near = self.falling if self.outcome.safe else self.falling[:0]
        return (
            least_acceleration(structure, found.first, *near),
            least_acceleration(structure, found.safe_to, *near[near > demand]),
        )


def answer_of(search: CapacitySearch) -> Shaken:
    """Compute the answer of a body to the demand of a search."""
    shifted = search.amplitude * (1.0 + SHIFTS)
    return Shaken(
        search,
        shifted,
        respond(search.method, search.structure, search.motion, shifted, search.omega),
    )


def least_acceleration(
    structure: RockingParameters, *amplitudes: float | None
) -> float | None:
    """Return the least of these amplitudes A as an acceleration [m/s2], None without
    one.
    """
    least = min((x for x in amplitudes if x is not None), default=None)
    return None if least is None else float(structure.ground_acceleration(least))


def respond(
    method: Method,
    structure: RockingParameters,
    motion: Motion,
    amplitude: np.ndarray,
    omega: float,
) -> Response:
    """Return the response at these amplitudes, computed on floats."""
    return response(
        method.system_of(structure),
        motion,
        amplitude,
        omega,
        how="floats",
    )
