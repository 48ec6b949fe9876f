"""Structures whose numbers have spreads: the share of draws that falls, its interval,
and which key matters.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..dynamics.method import Method, governing_method
from ..dynamics.outcome import Outcome, safe
from ..dynamics.response import cheaper, response

if TYPE_CHECKING:
    from ..motions.grid import Grid
    from ..motions.motion import Motion
    from ..structures.parameters import RockingParameters

Array = np.ndarray

LEVEL = 0.95  # of the intervals
BINS = 16  # of equal count, for an index of first order
STEP = 0.01  # ratio of neighbouring amplitudes of the search, minus 1
_DIGITS = 1e-6  # relative width of a traced first overturning amplitude
# neighbouring amplitudes of each body that are computed together, at least and at most,
# and cells of a group that are
_FEWEST, _MOST, _CELLS = 24, 400, 25_000


@dataclass(frozen=True)
class Share:
    """The share of draws for which something holds, with its interval."""

    count: int  # draws for which it holds
    draws: int  # all draws
    low: float  # lower end of the 95 % interval [-]
    high: float  # its upper end [-]

    @property
    def share(self) -> float:
        """The share of the draws [-]."""
        return self.count / self.draws

    @classmethod
    def of(cls, count: int, draws: int) -> Share:
        """Return the share with its interval of Clopper and Pearson, which holds for
        independent draws and is wider than needed for those of a Sobol sequence.

        Examples
        --------
        >>> found = Share.of(12, 1024)
        >>> round(found.low, 6), round(found.high, 6)
        (0.00607, 0.020381)
        """
        from scipy.special import betaincinv

        tail = 0.5 * (1.0 - LEVEL)
        low = betaincinv(count, draws - count + 1, tail) if count else 0.0
        high = (
            betaincinv(count + 1, draws - count, 1.0 - tail) if count < draws else 1.0
        )
        return cls(count, draws, float(low), float(high))


def first_order_indices(keys: Array, result: Array) -> Array:
    """Return the share of the variance of a result that each key explains alone.

    The variance of the means over 16 bins of equal count of a key, over the variance of
    the result: Var E[Y|x]/Var Y. Ranks of the result are not used: their estimator
    assumes independent draws, and these are points of a Sobol sequence.

    Parameters
    ----------
    keys
        values of the keys, (draws, keys)
    result
        result of each draw, finite, (draws,)

    Returns
    -------
    numpy.ndarray
        index of first order of each key [-], (keys,); zero if the result does not vary
    """
    variance = float(np.var(result))
    if variance == 0.0:
        return np.zeros(keys.shape[1])
    found = []
    for column in keys.T:
        bins = np.array_split(result[np.argsort(column, kind="stable")], BINS)
        bins = [one for one in bins if one.size]
        means = np.array([one.mean() for one in bins])
        weights = np.array([one.size for one in bins]) / result.size
        spread = float(weights @ (means - weights @ means) ** 2)
        found.append(spread / variance)
    return np.array(found)


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
    cells = np.array([(*shaking.cell(s), s.eta) for s in structures])
    return _Together(method, motion, structures, cells[:, 1], cells[:, 2]).outcomes(
        np.arange(len(structures)), cells[:, 0]
    )


def first_overturning_of(
    structures: Sequence[RockingParameters],
    motion: Motion,
    shaking: Grid,
    a_max: Sequence[float],
) -> Array:
    """Return the lowest amplitude that overturns each structure.

    All structures go up the same ladder of amplitudes, 1 % apart; a structure leaves it
    at its first overturning, whose bracket is then halved. Intervals narrower than a
    step may be missed.

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
    cells = np.array([(*shaking.cell(s), s.eta) for s in structures])
    together = _Together(method, motion, structures, cells[:, 1], cells[:, 2])
    first = together.lowest_falls(together.least_uplifts(), np.asarray(a_max, float))
    unit = np.array([float(s.ground_acceleration(1.0)) for s in structures])
    return first * unit


class _Together:
    """Structures under one motion, each at its own amplitudes."""

    def __init__(
        self,
        method: Method,
        motion: Motion,
        structures: Sequence[RockingParameters],
        omega: Array,
        eta: Array,
    ) -> None:
        self.method, self.motion, self.structures = method, motion, structures
        self.omega, self.eta = omega, eta  # of each structure [-]
        groups: dict[object, int] = {}
        self.group = np.array(
            [groups.setdefault(self._shared(s), len(groups)) for s in structures]
        )

    def _shared(self, structure: RockingParameters) -> object:
        """Return what the structures of one march have in common: nothing for plain
        bodies whose equation takes cells of several alphas.
        """
        kind = self.method.kind_of(structure)
        if structure.plain and kind.of_cells is not None:
            return None
        return self.method.shares(structure)

    def least_uplifts(self) -> Array:
        """Return the least amplitude A that lifts each structure."""
        return np.array(
            [
                self.method.system_of(s).least_uplift(self.motion)
                for s in self.structures
            ]
        )

    def outcomes(self, which: Array, amplitude: Array) -> Array:
        """Return the outcome of cells: structure `which` at this amplitude A."""
        found = np.zeros(which.size, dtype=np.uint8)
        for number in np.unique(self.group[which]):
            at = np.flatnonzero(self.group[which] == number)
            found[at] = self._of_group(which[at], amplitude[at])
        return found

    def _of_group(self, which: Array, amplitude: Array) -> Array:
        order = np.argsort(which, kind="stable")
        own, counts = np.unique(which, return_counts=True)
        structures = [self.structures[i] for i in own]
        system = self.method.system_of_cells(structures, counts.tolist())
        if self.method.exact:
            system = system._replace(body=None, own=())
        how = cheaper(self.motion, which.size) if own.size == 1 else "arrays"
        at = which[order]
        cells = (amplitude[order], self.omega[at], self.eta[at])
        got = response(system, self.motion, *cells, peaks=False, how=how).outcome
        found = np.empty_like(got)
        found[order] = got
        return found

    def lowest_falls(self, lowest: Array, highest: Array) -> Array:
        """Return the lowest amplitude A that overturns each structure between two
        amplitudes, infinite without one.
        """
        first = np.full(lowest.size, np.inf)
        stands = lowest.copy()  # largest amplitude up to which no rung overturns
        climbing = np.flatnonzero(np.isfinite(lowest) & (lowest < highest))
        while climbing.size:
            largest = int(np.bincount(self.group[climbing]).max())
            window = int(np.clip(_CELLS // largest, _FEWEST, _MOST))
            rungs = stands[climbing, None] * (1.0 + STEP) ** np.arange(1, window + 1)
            rungs = np.minimum(rungs, highest[climbing, None])
            codes = self.outcomes(np.repeat(climbing, window), rungs.ravel())
            falls = _falls(codes).reshape(rungs.shape)
            hit = falls.any(axis=1)
            at = np.argmax(falls, axis=1)
            for i, j in zip(np.flatnonzero(hit), at[hit], strict=True):
                first[climbing[i]] = rungs[i, j]
                if j:
                    stands[climbing[i]] = rungs[i, j - 1]
            stands[climbing[~hit]] = rungs[~hit, -1]
            climbing = climbing[~hit & (rungs[:, -1] < highest[climbing])]

        # Each bracket is halved, all of them together.
        open_ones = np.flatnonzero(np.isfinite(first))
        while open_ones.size:
            middle = 0.5 * (stands[open_ones] + first[open_ones])
            falls = _falls(self.outcomes(open_ones, middle))
            first[open_ones[falls]] = middle[falls]
            stands[open_ones[~falls]] = middle[~falls]
            wide = first[open_ones] - stands[open_ones] > _DIGITS * first[open_ones]
            open_ones = open_ones[wide]
        return first


def _falls(outcome: Array) -> Array:
    """True where a structure does not stand; a failed cell counts as a fall."""
    return ~safe(outcome) | (outcome == Outcome.FAILED)
