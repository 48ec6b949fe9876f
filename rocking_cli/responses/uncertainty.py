"""Structures whose numbers have spreads: the share of draws that falls, its interval,
and which key matters.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..dynamics.method import Method, governing_method
from ..dynamics.outcome import Outcome, safe
from ..dynamics.response import LONG, Response, cheaper, response
from ..envelopes.intervals import A_MAX
from ..errors import UsageError
from ..motions.grid import Grid, HasMotion, demand_of
from ..motions.motion import Motion
from ..showing import Shown
from ..structures.draws import DRAWS, draws
from ..structures.given import Structure, structure_from
from ..structures.parameters import RockingParameters

Array = np.ndarray

LEVEL = 0.95  # of the intervals
BINS = 16  # of equal count, for an index of first order
STEP = 0.01  # ratio of neighbouring amplitudes of the search, minus 1
QUANTILES = {"q05": 0.05, "q50": 0.5, "q95": 0.95}  # by their names in columns
_UNDER_A_RECORD = 64  # draws whose first overturning is searched under a record
_DIGITS = 1e-6  # relative width of a traced first overturning amplitude
# neighbouring amplitudes of each body that are computed together, at least and at most,
# and cells of a group that are
_FEWEST, _MOST, _CELLS = 24, 400, 25_000


@dataclass(frozen=True)
class Share:
    """The share of draws for which something holds, with its interval.

    Attributes
    ----------
    count
        draws for which it holds
    draws
        all draws
    low
        lower end of the 95 % interval [-]
    high
        its upper end [-]

    Examples
    --------
    >>> found = Share.of(12, 1024)
    >>> f"{found.low:.5f} {found.share:.5f} {found.high:.5f}"
    '0.00607 0.01172 0.02038'
    """

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

        Parameters
        ----------
        count
            draws for which it holds
        draws
            all draws

        Returns
        -------
        Share
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
    omega = np.array([shaking.cell(s)[1] for s in structures])
    together = Together(method, motion, structures, omega)
    first = together.lowest_falls(together.least_uplifts(), np.asarray(a_max, float))
    unit = np.array([float(s.ground_acceleration(1.0)) for s in structures])
    return first * unit


@dataclass(frozen=True, repr=False)
class DrawnVerdict(Shown):
    """The verdicts on the draws of one structure under one demand.

    Attributes
    ----------
    share
        of the draws that fall
    left_out
        draws that make no structure
    fault
        why the first of them makes none
    failed
        draws whose computation failed; they count as falls
    quantiles
        first overturning amplitude of the ground [m/s2] that 5, 50 and 95 % of the
        draws do not exceed; infinite where none overturns up to the limit, empty
        without a search
    searched
        draws whose first overturning was searched
    indices
        index of first order of each key [-]

    Examples
    --------
    >>> (wall,) = load_structures('block:0.5x2,restitution=0.85..0.95')
    >>> demand = parse_grid('a_g=0.4g,f_g=1.5')
    >>> found = drawn_verdict(wall, sine(), demand, n=64, a_max=None)
    >>> found.key, f"{found.share.share:.1f}"
    ('restitution', '0.8')
    """

    share: Share  # of the draws that fall
    left_out: int  # draws that make no structure
    fault: str | None  # why the first of them makes none
    failed: int  # draws whose computation failed; they count as falls
    # first overturning amplitude of the ground [m/s2] that 5, 50 and 95 % of the draws
    # do not exceed; infinite where none overturns up to the limit, empty without search
    quantiles: tuple[float, ...]
    searched: int  # draws whose first overturning was searched
    # index of first order of each key [-]: of the first overturning amplitude, or
    # without a search of the outcome
    indices: dict[str, float]

    @property
    def key(self) -> str | None:
        """The key that explains most; None if the result does not vary."""
        most = max(self.indices, key=self.indices.__getitem__)
        return most if self.indices[most] else None

    def _shown(self) -> dict[str, float | int | str | None]:
        return self.row()

    def row(self) -> dict[str, float | int | str | None]:
        """Return the columns that `rocking check --draws` adds."""
        key = self.key
        values = (
            self.share.share,
            self.share.low,
            self.share.high,
            self.share.draws,
            *(x if np.isfinite(x) else None for x in self.quantiles),
            key,
            None if key is None else self.indices[key],
        )
        return dict(zip(drawn_columns(bool(self.quantiles)), values, strict=True))


def drawn_columns(searched: bool) -> tuple[str, ...]:
    """Return the columns that `rocking check --draws` adds; searched: with the
    quantiles of the first overturning amplitude.
    """
    quantiles = tuple(f"first_overturning_a_{name}" for name in QUANTILES)
    shares = ("share_falls", "share_low", "share_high", "draws")
    return (*shares, *(quantiles if searched else ()), "key_1", "index_1")


def drawn_verdict(
    structure: Structure,
    motion: Motion | HasMotion,
    shaking: Grid | str | None = None,
    *,
    n: int = DRAWS,
    seed: int = 0,
    a_max: float | None = A_MAX,
) -> DrawnVerdict:
    """Return the share of draws that falls under a demand, and which key matters.

    A draw that overturns, loses contact or rests leaning falls. The outcome is that at
    the demand: a draw may stand there although it overturns at a lower amplitude.

    Parameters
    ----------
    structure
        parameters, a document, a path, or a text such as "block:0.62+-0.01x2", with at
        least one number that has a spread
    motion
        the motion of the ground
    shaking
        the demand, a grid of one cell or its text; a record does not need it
    n
        number of draws, rounded up to a power of two
    seed
        of the draws
    a_max
        largest A of the search for the first overturning amplitude [-], which goes at
        least to twice the demand; None: no search. Under a record the first 64 draws
        are searched

    Returns
    -------
    DrawnVerdict

    Raises
    ------
    UsageError
        if no number has a spread, or n is out of range

    Examples
    --------
    >>> (wall,) = load_structures('block:0.62+-0.01x2')
    >>> found = drawn_verdict(wall, sine(), parse_grid('a_g=0.4g,f_g=1'), a_max=None)
    >>> round(found.share.share, 2)
    0.62
    """
    structure = structure_from(structure)
    motion, shaking = demand_of(motion, shaking)
    if structure.drawn_from is None:
        raise UsageError(
            f"{structure.name}: found no number with a spread; expected one, such as"
            " width: 0.5 m +- 10 mm"
        )
    every = list(draws(structure.drawn_from, n, seed))
    made = [draw for draw in every if draw.parameters is not None]
    if not made:
        raise UsageError(f"no draw makes a structure: {every[0].fault}")
    bodies = [draw.parameters for draw in made if draw.parameters is not None]
    keys = np.array([list(draw.values.values()) for draw in made])

    codes = outcomes_at(bodies, motion, shaking)
    result = _falls(codes).astype(float)
    share = Share.of(int(result.sum()), result.size)
    quantiles: tuple[float, ...] = ()
    if a_max is not None:
        some = bodies if len(motion.segments) <= LONG else bodies[:_UNDER_A_RECORD]
        result, quantiles = _first_and_quantiles(some, motion, shaking, a_max)
    indices = first_order_indices(keys[: result.size], result)
    return DrawnVerdict(
        share=share,
        left_out=len(every) - len(made),
        fault=next((draw.fault for draw in every if draw.fault), None),
        failed=int(np.count_nonzero(codes == Outcome.FAILED)),
        quantiles=quantiles,
        searched=result.size if quantiles else 0,
        indices=dict(zip(made[0].values, indices.tolist(), strict=True)),
    )


def _first_and_quantiles(
    bodies: Sequence[RockingParameters], motion: Motion, shaking: Grid, a_max: float
) -> tuple[Array, tuple[float, ...]]:
    """Return (first overturning amplitude of each body [m/s2], its quantiles). A body
    that does not overturn counts with the end of its search, and is infinite in the
    quantiles.
    """
    tops = [max(a_max, 2.0 * shaking.cell(body)[0]) for body in bodies]
    first = first_overturning_of(bodies, motion, shaking, tops)
    quantiles = np.quantile(first, [*QUANTILES.values()], method="inverted_cdf")
    ends = [
        float(body.ground_acceleration(top))
        for body, top in zip(bodies, tops, strict=True)
    ]
    return np.minimum(first, ends), tuple(quantiles.tolist())


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
        self.eta = np.array([s.eta for s in structures])  # restitution of each [-]
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
        return self.responses(which, amplitude, peaks=False)[1]

    def responses(
        self, which: Array, amplitude: Array, peaks: bool = True
    ) -> tuple[Array, Array]:
        """Return (theta_ratio, outcome) of cells: structure `which` at this amplitude
        A; without peaks theta_ratio is NaN.
        """
        theta_ratio = np.full(which.size, np.nan)
        outcome = np.zeros(which.size, dtype=np.uint8)
        for number in np.unique(self.group[which]):
            at = np.flatnonzero(self.group[which] == number)
            at = at[np.argsort(which[at], kind="stable")]  # by structure
            got = self._of_group(which[at], amplitude[at], peaks)
            theta_ratio[at], outcome[at] = got.theta_ratio, got.outcome
        return theta_ratio, outcome

    def _of_group(self, which: Array, amplitude: Array, peaks: bool) -> Response:
        """Return the responses of cells of one group, which are in the order of their
        structures.
        """
        own, counts = np.unique(which, return_counts=True)
        structures = [self.structures[i] for i in own]
        system = self.method.system_of_cells(structures, counts.tolist())
        if self.method.exact:
            system = system._replace(body=None, own=())
        how = cheaper(self.motion, which.size) if own.size == 1 else "arrays"
        cells = (amplitude, self.omega[which], self.eta[which])
        return response(system, self.motion, *cells, peaks=peaks, how=how)

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
