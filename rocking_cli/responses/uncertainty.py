"""The verdicts on a structure whose numbers have spreads: the share of draws that
falls, and which key matters.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..dynamics.method import governing_method
from ..dynamics.outcome import Outcome
from ..dynamics.response import LONG
from ..envelopes.intervals import A_MAX
from ..envelopes.together import Together, fallen, first_overturning_of, outcomes_at
from ..errors import UsageError
from ..motions.given import AnyMotion, demand_of
from ..motions.grid import Grid
from ..motions.motion import Motion
from ..showing import Shown
from ..structures.draws import DRAWS, draws
from ..structures.given import Structure, structure_from
from ..structures.parameters import RockingParameters
from .shares import ShareOfDraws, first_order_indices, index_interval

# the key that explains most, its index of first order, and the interval of the index
_OF_THE_KEY = ("key_1", "index_1", "index_low", "index_high")
QUANTILES = {"q05": 0.05, "q50": 0.5, "q95": 0.95}  # by their names in columns
_UNDER_A_RECORD = 64  # draws whose first overturning is searched under a record


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
    interval
        95 % interval of the index of `key` [-]

    Examples
    --------
    >>> (wall,) = load_structures('block:0.5x2,restitution=0.85..0.95')
    >>> demand = parse_grid('a_g=0.4g,f_g=1.5')
    >>> found = drawn_verdict(wall, sine(), demand, n=64, a_max=None)
    >>> found.key, f"{found.share.share:.1f}"
    ('restitution', '0.8')
    """

    share: ShareOfDraws  # of the draws that fall
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
    # 95 % interval of the index of `key` [-]
    interval: tuple[float, float]

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
            *(
                (None, None, None)
                if key is None
                else (self.indices[key], *self.interval)
            ),
        )
        return dict(zip(drawn_columns(bool(self.quantiles)), values, strict=True))


def drawn_columns(searched: bool) -> tuple[str, ...]:
    """Return the columns that `rocking check --draws` adds; searched: with the
    quantiles of the first overturning amplitude.
    """
    quantiles = tuple(f"first_overturning_a_{name}" for name in QUANTILES)
    shares = ("share_falls", "share_low", "share_high", "draws")
    return (*shares, *(quantiles if searched else ()), *_OF_THE_KEY)


def drawn_verdict(
    structure: Structure,
    motion: AnyMotion,
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
        the motion of the ground: an object, the name of a pulse, or a path
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
    result = fallen(codes).astype(float)
    share = ShareOfDraws.of(int(result.sum()), result.size)
    quantiles: tuple[float, ...] = ()
    if a_max is not None:
        some = bodies if len(motion.segments) <= LONG else bodies[:_UNDER_A_RECORD]
        result, quantiles = _first_and_quantiles(some, motion, shaking, a_max)
    keys = keys[: result.size]
    indices = first_order_indices(keys, result)
    return DrawnVerdict(
        share=share,
        left_out=len(every) - len(made),
        fault=next((draw.fault for draw in every if draw.fault), None),
        failed=int(np.count_nonzero(codes == Outcome.FAILED)),
        quantiles=quantiles,
        searched=result.size if quantiles else 0,
        indices=dict(zip(made[0].values, indices.tolist(), strict=True)),
        interval=index_interval(keys[:, indices.argmax()], result),
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


def share_curve(
    structure: RockingParameters,
    motion: Motion,
    shaking: Grid,
    amplitudes: Array,
    n: int = DRAWS,
    seed: int = 0,
) -> list[ShareOfDraws]:
    """Return the share of draws that falls at each of some amplitudes.

    Parameters
    ----------
    structure
        a structure whose document holds at least one number with a spread
    motion
        the motion of the ground: an object, the name of a pulse, or a path
    shaking
        the demand, a grid of one cell, whose frequency holds
    amplitudes
        of the ground [m/s2], (k,)
    n
        number of draws, rounded up to a power of two
    seed
        of the draws

    Returns
    -------
    list of ShareOfDraws
        (k,)
    """
    assert structure.drawn_from is not None
    every = draws(structure.drawn_from, n, seed)
    bodies = [draw.parameters for draw in every if draw.parameters is not None]
    method = governing_method(*bodies, dimensionless=shaking.dimensionless)
    omega = np.array([shaking.cell(body)[1] for body in bodies])
    together = Together(method, motion, bodies, omega)
    scale = np.array([float(body.dimensionless_amplitude(1.0)) for body in bodies])
    which = np.tile(np.arange(len(bodies)), amplitudes.size)
    codes = together.outcomes(which, (amplitudes[:, None] * scale).ravel())
    falls = fallen(codes).reshape(amplitudes.size, -1).sum(axis=1)
    return [ShareOfDraws.of(int(count), len(bodies)) for count in falls]
