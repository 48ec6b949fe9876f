"""The search for the worst frequency of a structure on the floor of a building, whose
motion is another one at each frequency of the ground.
"""

from collections.abc import Iterator, Sequence

import numpy as np

from ..arrays import Array
from ..dynamics.response import cheaper, response
from ..motions import Motion
from ..motions.buildings import Building, floor_of
from .first_falls import Climb, RowMarch, lowest_falls
from .frequency_search import OUTCOME_REACH, FrequencyRange, FrequencySearch, Tell

# on a floor, whose straight lines miss 1e-3 of its peak: this width, also of brackets;
# steps in a cycle; ratio of the amplitudes minus 1, and amplitudes computed together
_FINE_ON_FLOORS, _STEPS = 1e-3, 72
_LADDER_ON_FLOORS, _RUNGS_ON_FLOORS = 0.05, 12
_ONE = np.zeros(1, dtype=np.int64)  # the rows of the one body of a search


class FloorMarch:
    """One structure on a floor, whose motion is another one at each Omega of the
    ground; the cells of one Omega are marched together. It only looks for frequencies,
    so its floors have fewer steps.
    """

    def __init__(self, one: FrequencyRange) -> None:
        self.one = one
        self.a_g = float(one.structure.ground_acceleration(one.amplitude))
        self.floors: dict[float, Motion] = {}

    def floor(self, omega: float) -> Motion:
        """Return the motion of the floor at an Omega of the ground."""
        if omega not in self.floors:
            one = self.one
            omega_g = omega * one.structure.p
            self.floors[omega] = floor_of(
                one.motion, Building(one.modes), self.a_g, omega_g, per_cycle=_STEPS
            )
        return self.floors[omega]

    def response(
        self, which: Array, amplitude: Array, omega: Array, peaks: bool = True
    ) -> tuple[Array, Array, Array]:
        """As `SharedMarch.response`."""
        found = np.full(omega.size, np.nan), *np.zeros((2, omega.size), dtype=np.int32)
        own = np.array([1.0 / self.one.structure.p])
        for here in np.unique(omega).tolist():
            at = np.flatnonzero(omega == here)
            floor = self.floor(here)
            how = cheaper(self.one.system, floor, at.size)
            answer = response(
                self.one.system, floor, amplitude[at], own, peaks=peaks, how=how
            )
            found[0][at], found[1][at] = answer.theta_ratio, answer.outcome
            found[2][at] = answer.impacts_at_least
        return found

    def of_rows(self, which: Array, omega: Array) -> RowMarch:
        """As `SharedMarch.of_rows`."""
        return lambda row, amplitude: self.response(
            which[row], amplitude, omega[row], peaks=False
        )[1:]


class FloorSearch(FrequencySearch):
    """The search for the worst Omega of one structure on a floor. Its amplitudes are
    those of a ladder.
    """

    fine = _FINE_ON_FLOORS

    def __init__(
        self, ranges: Sequence[FrequencyRange], motion: Motion, tell: Tell
    ) -> None:
        (one,) = ranges
        if one.most is None:
            one = one._replace(most=OUTCOME_REACH * one.amplitude)
        self.floors = FloorMarch(one)
        super().__init__([one], motion, tell, self.floors)

    def _between(self, bodies: Sequence[int]) -> Iterator[tuple[int, float]]:
        for body, omega in zip(bodies, self.least(), strict=False):
            if omega is not None and not self._stands(body, omega):
                yield body, omega

    def _first_falls(
        self, body: Array, omega: Array, most: Array, tell: Tell = lambda _: None
    ) -> Array:
        (one,) = self.ranges
        uplift = np.array(
            [one.system.least_uplift(self.floors.floor(x)) for x in omega.tolist()]
        )
        return lowest_falls(
            self.march.of_rows(body, omega),
            Climb(uplift, most[body], uplift, _LADDER_ON_FLOORS),
            self.fine,
            rivals=body,
            stretch=_RUNGS_ON_FLOORS,
            tell=tell,
        ).amplitude

    def _first_at(self, one: FrequencyRange, omega: float, most: float) -> float:
        return float(self._first_falls(_ONE, np.array([omega]), np.array([most]))[0])
