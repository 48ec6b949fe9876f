"""The share of draws for which something holds, with its interval, and the share of a
variance that a key explains.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Array

LEVEL = 0.95  # of the intervals
BINS = 16  # of equal count, at most, for an index of first order
_LEAST = 8  # draws of a bin, at least
_RESAMPLES = 400  # for the interval of an index


@dataclass(frozen=True)
class ShareOfDraws:
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
    >>> found = ShareOfDraws.of(12, 1024)
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
    def of(cls, count: int, draws: int) -> ShareOfDraws:
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
        ShareOfDraws
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
    the result: Var E[Y|x]/Var Y. With fewer than 128 draws the bins are fewer, of 8
    draws. Ranks of the result are not used: their estimator
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
    return np.array([_index(column, result) for column in keys.T])


def index_interval(key: Array, result: Array) -> tuple[float, float]:
    """Return the 95 % interval of the index of first order of a key.

    It is that of the bootstrap over the draws: twice the index less the quantiles of
    its resamples, within 0 to 1.

    Parameters
    ----------
    key
        values of the key, (draws,)
    result
        result of each draw, finite, (draws,)

    Returns
    -------
    tuple of (float, float)
        lower and upper end [-]
    """
    generator = np.random.default_rng(0)
    some = generator.integers(result.size, size=(_RESAMPLES, result.size))
    resampled = [_index(key[i], result[i]) for i in some]
    tail = 0.5 * (1.0 - LEVEL)
    low, high = np.quantile(resampled, (tail, 1.0 - tail))
    twice = 2.0 * _index(key, result)
    return max(twice - float(high), 0.0), min(twice - float(low), 1.0)


def _index(key: Array, result: Array) -> float:
    """Return the index of first order of a key."""
    variance = float(np.var(result))
    if variance == 0.0:
        return 0.0
    count = min(BINS, max(result.size // _LEAST, 1))
    bins = np.array_split(result[np.argsort(key, kind="stable")], count)
    means = np.array([one.mean() for one in bins])
    weights = np.array([one.size for one in bins]) / result.size
    return float(weights @ (means - weights @ means) ** 2) / variance
