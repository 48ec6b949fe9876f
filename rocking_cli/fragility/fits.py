"""Fits of fragility curves to data that support one; `estimates` has the methods."""

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from ..arrays import Array
from ..errors import ArgumentError, UsageError, counted
from ..showing import Shown
from .estimates import MOST, Estimate, cloud, first_overturning, stripes

FEWEST = 4  # least number of records for a fit


@dataclass(frozen=True, repr=False)
class Curve(Shown):
    """A fragility curve: a lognormal distribution of the capacity.

    P(x) = Phi(ln(x/median)/beta). `fit_stripes`, `fit_first` and `fit_cloud` return
    one.

    Attributes
    ----------
    median: in the unit of the intensity measure
    beta: dispersion [-]
    n: number of records

    Examples
    --------
    >>> curve = Curve(median=0.43, beta=0.35, n=54)
    >>> curve.median, curve.beta
    (0.43, 0.35)
    """

    median: float  # in the unit of the intensity measure
    beta: float  # dispersion [-]
    n: float  # number of records

    def _shown(self) -> dict[str, float]:
        return asdict(self)

    def __call__(self, x: Array | float) -> Array:
        """Return the probability at intensities x, in the shape of x."""
        from scipy.special import ndtr

        with np.errstate(divide="ignore"):
            return np.asarray(
                ndtr(np.log(np.asarray(x, dtype=float) / self.median) / self.beta)
            )


def check_levels(x: Array) -> Array:
    """Return the levels as an array. Raises UsageError unless they are positive and
    rise.
    """
    x = np.asarray(x, dtype=float)
    if (
        x.ndim != 1
        or x.size < 2
        or not np.all(np.isfinite(x))
        or not x[0] > 0.0
        or np.any(np.diff(x) <= 0.0)
    ):
        raise UsageError("levels: expected two or more, positive and rising")
    return x


def fit_stripes(x: Array, n: Array, z: Array) -> Curve:
    """Return the curve of counts at some levels, by maximum likelihood.

    Parameters
    ----------
    x
        levels of the intensity measure, positive and rising, (k,)
    n
        number of records at each level, (k,)
    z
        how many of them are beyond the limit state, (k,)

    Returns
    -------
    Curve
        median in the unit of `x`

    Raises
    ------
    UsageError
        unless at two levels some records are beyond the limit state and some are not,
        and their share rises

    Examples
    --------
    >>> curve = fit_stripes([1.0, 1.5, 2.0], [54, 54, 54], [2, 25, 43])
    >>> round(curve.median, 5), round(curve.beta, 5)
    (1.57248, 0.27003)
    """
    x, n, z = check_levels(x), np.asarray(n, dtype=float), np.asarray(z, dtype=float)
    if (
        not x.shape == n.shape == z.shape
        or np.any(n <= 0.0)
        or np.any(z < 0.0)
        or np.any(z > n)
    ):
        raise UsageError("counts: expected n above 0 and z from 0 to n at every level")
    mixed = int(np.count_nonzero((z > 0.0) & (z < n)))
    if mixed < 2:
        raise UsageError(
            f"{counted(mixed, 'level')} with some records beyond the limit state and"
            " some not; a fit needs two"
        )
    return fit_cells(x, n, z)


def fit_cells(x: Array, n: Array, z: Array) -> Curve:
    """Return the curve of cells of weight n at any x, z of it beyond the limit state.
    Raises UsageError if the share does not rise.
    """
    return _curve(
        stripes(x, n, z),
        np.max(n),
        "the share beyond the limit state does not rise with the levels; a fit",
    )


def _require_one_shape(**given: Any) -> None:
    """Raise ArgumentError unless the arrays that are given have one dimension and one
    length.
    """
    shapes = {name: np.shape(x) for name, x in given.items() if x is not None}
    if len({*shapes.values()}) > 1 or len(next(iter(shapes.values()))) != 1:
        found = ", ".join(f"{name} of the shape {x}" for name, x in shapes.items())
        raise ArgumentError(f"found {found}; expected arrays of one length")


def _curve(estimate: Estimate, n: float, flat: str = "") -> Curve:
    centre, beta = map(float, estimate)
    if flat and beta >= 0.99 * MOST:
        raise UsageError(f"{flat} needs one that does")
    return Curve(float(np.exp(centre)), beta, float(n))


def fit_first(r: Array, limit: Array | float, weight: Array | None = None) -> Curve:
    """Return the curve of the intensities at which records first overturn a body.

    Parameters
    ----------
    r
        intensity of each record, NaN without overturning up to `limit`, (k,)
    limit
        highest intensity that was computed, one or (k,)
    weight
        weights of the records, (k,), None for equal ones

    Returns
    -------
    Curve
        median in the unit of `r`

    Raises
    ------
    UsageError
        for fewer than four records that overturn the body

    Notes
    -----
    If all records overturn the body, the median is exp(mean ln r) and beta the standard
    deviation of ln r with k - 1. Otherwise the likelihood counts records without
    overturning as 1 - Phi at `limit`.

    Examples
    --------
    >>> curve = fit_first([0.2, 0.3, 0.4, 0.5], 1.0)
    >>> round(curve.median, 4), round(curve.beta, 4)
    (0.331, 0.3956)
    """
    _require_one_shape(r=r, limit=limit if np.ndim(limit) else None, weight=weight)
    overturned = int(np.count_nonzero(np.isfinite(r)))
    if overturned < FEWEST:
        raise UsageError(
            f"{overturned} of {np.size(r)} records overturn the body; a fit of first"
            f" overturnings needs at least {FEWEST}"
        )
    return _curve(first_overturning(r, limit, weight), np.size(r))


def fit_cloud(
    x: Array, theta_ratio: Array, limit: float, weight: Array | None = None
) -> Curve:
    """Return the curve of a regression of unscaled rotations on an intensity measure.

    Parameters
    ----------
    x
        intensity of each record, (k,)
    theta_ratio
        |theta|/alpha under each record [-], NaN where it overturned, (k,)
    limit
        |theta|/alpha of the limit state [-]
    weight
        weights of the records, (k,), None for equal ones

    Returns
    -------
    Curve
        median in the unit of `x`

    Raises
    ------
    UsageError
        for too few rotations, or if they do not grow with x

    Examples
    --------
    >>> curve = fit_cloud([1.0, 2.0, 3.0, 4.0], [0.1, 0.25, 0.3, 0.45], 0.5)
    >>> round(curve.median, 4), round(curve.beta, 4)
    (4.4542, 0.1223)
    """
    _require_one_shape(x=x, theta_ratio=theta_ratio, weight=weight)
    there = int(
        np.count_nonzero(np.isfinite(theta_ratio) & (np.asarray(theta_ratio) > 0.0))
    )
    if there < FEWEST:
        raise UsageError(
            f"{there} of {np.size(x)} records rock the body without overturning; a"
            f" regression needs at least {FEWEST}"
        )
    return _curve(
        cloud(x, theta_ratio, limit, weight),
        there,
        "the rotation does not grow with the intensity measure; a regression",
    )
