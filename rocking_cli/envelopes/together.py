"""Many structures under one motion, each at its own amplitudes: bodies that differ in
alpha, restitution and size are marched together.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..arrays import Array
from ..dynamics.method import Method, governing_method
from ..dynamics.outcome import Outcome, safe
from ..dynamics.shared_march import SharedMarch
from ..motions.grid import Grid
from ..motions.motion import Motion
from ..structures.friction import friction_that_slides
from ..structures.parameters import RockingParameters
from .capacity import falls_may_be_narrow
from .first_falls import Climb, lowest_falls

_RATIO = 0.01  # ratio of neighbouring amplitudes of the search, minus 1
_DIGITS = 1e-6  # relative width of a traced first overturning amplitude


def outcomes_at(
    structures: Sequence[RockingParameters], motion: Motion, shaking: Grid
) -> Array:
    """Return the outcome of each structure under one demand.

    Parameters
    ----------
    structures
        structures with a geometry, by whose governing equation the outcome is found
    motion
        the motion of the ground
    shaking
        the demand, a grid of one cell

    Returns
    -------
    numpy.ndarray
        codes of `Outcome`, (structures,)
    """
    method = governing_method(*structures, dimensionless=shaking.dimensionless)
    cells = np.array([shaking.cell(s) for s in structures])
    together = Together(method, motion, structures, cells[:, 1])
    return together.outcomes(np.arange(len(structures)), cells[:, 0])


def first_overturning_of(
    structures: Sequence[RockingParameters],
    motion: Motion,
    shaking: Grid,
    a_max: Sequence[float],
) -> Array:
    """Return the lowest amplitude that overturns each structure.

    The amplitudes of the search are 1 % apart: narrower intervals may be missed. Where
    overturning intervals may be narrow, as under a record, there may be several of them
    between two amplitudes, and the lower one is returned.

    Parameters
    ----------
    structures
        structures with a geometry
    motion
        the motion of the ground
    shaking
        the demand, a grid of one cell, whose frequency holds
    a_max
        largest amplitude A of each search [-]

    Returns
    -------
    numpy.ndarray
        amplitude of the ground [m/s2], infinite where none overturns, (structures,)
    """
    method = governing_method(*structures, dimensionless=shaking.dimensionless)
    omega = np.array([shaking.cell(s)[1] for s in structures])
    together = Together(method, motion, structures, omega)
    first = together.lowest_falls(np.asarray(a_max, float))
    unit = np.array([float(s.ground_acceleration(1.0)) for s in structures])
    return first * unit


class Together:
    """Structures under one motion, each at its own amplitudes."""

    def __init__(
        self,
        method: Method,
        motion: Motion,
        structures: Sequence[RockingParameters],
        omega: Array,
    ) -> None:
        self.method, self.motion, self.structures = method, motion, structures
        self.omega = omega  # Omega of each structure [-]
        # of each structure: its friction if it slides and never rocks
        self.friction = [friction_that_slides(s) for s in structures]
        self.march = SharedMarch(motion, structures, [method] * len(structures))

    def least_uplifts(self) -> Array:
        """Return the least amplitude A that lifts each structure, infinite for one
        that slides and never rocks.
        """
        return np.array(
            [
                np.inf
                if friction is not None
                else self.method.system_of(s).least_uplift(self.motion)
                for s, friction in zip(self.structures, self.friction, strict=True)
            ]
        )

    def outcomes(self, which: Array, amplitude: Array) -> Array:
        """Return the outcome of cells: structure `which` at this amplitude A."""
        return self.responses(which, amplitude, peaks=False)[1]

    def responses(
        self, which: Array, amplitude: Array, peaks: bool = True
    ) -> tuple[Array, Array]:
        """Return (theta_ratio, outcome) of cells: structure `which` at this amplitude
        A; without peaks theta_ratio is NaN.
        """
        theta_ratio = np.full(which.size, np.nan)
        outcome = np.zeros(which.size, dtype=np.uint8)
        slide = np.array([self.friction[i] is not None for i in which], dtype=bool)
        for i in np.unique(which[slide]):
            at = np.flatnonzero(which == i)
            outcome[at] = self._of_sliding(int(i), amplitude[at])
            lost = outcome[at] == Outcome.LOST_CONTACT
            theta_ratio[at] = np.where(lost | (not peaks), np.nan, 0.0)
        at = np.flatnonzero(~slide)
        theta_ratio[at], outcome[at], _ = self.march.response(
            which[at], amplitude[at], self.omega[which[at]], peaks
        )
        return theta_ratio, outcome

    def _of_sliding(self, i: int, amplitude: Array) -> list[Outcome]:
        """Return the outcomes of a structure that slides at amplitudes A."""
        from ..dynamics.sliding import Base

        friction, structure = self.friction[i], self.structures[i]
        assert friction is not None
        base = Base(self.motion, friction)
        with np.errstate(divide="ignore"):
            ratios = structure.gravity / structure.ground_acceleration(amplitude)
        return [base.under(ratio).outcome for ratio in ratios.tolist()]

    def lowest_falls(self, highest: Array) -> Array:
        """Return the lowest amplitude A that overturns each structure up to an
        amplitude, as `first_overturning_of`; infinite without one.
        """
        lowest = self.least_uplifts()
        march = self.march.of_rows(np.arange(lowest.size), self.omega)
        climb = Climb(lowest, highest, lowest, _RATIO)
        if falls_may_be_narrow(self.motion):
            return lowest_falls(march, climb).stands
        return lowest_falls(march, climb, _DIGITS).amplitude


def fallen(outcome: Array) -> Array:
    """True where a structure does not stand; a failed cell counts as a fall."""
    return np.asarray(~safe(outcome))
