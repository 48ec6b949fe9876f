"""Draws of a structure whose numbers have spreads: a scrambled Sobol sequence in the
ranks of its keys.
"""

from __future__ import annotations

import inspect
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..documents.quantities import si_unit
from ..errors import DocumentError, UsageError
from .given import document_from
from .parameters import RockingParameters, numbers_of

if TYPE_CHECKING:
    from ..documents.document import Document, Uncertain

DRAWS = 1024  # number of draws if the command line states none
MOST_DRAWS = 1 << 20
UNIT_OF = {"p": "rad/s", "alpha": "rad"}  # of the rocking parameters, 1 for the others
_EDGE = 2.0**-31  # ranks stay so far inside (0, 1)


class Draw(NamedTuple):
    """One draw of a structure whose numbers have spreads.

    Attributes
    ----------
    values
        SI values of the keys with a spread, by their path
    parameters
        the structure, None if these values make none that rocks
    fault
        the reason why they make none

    Examples
    --------
    >>> (document,) = read_documents('block:0.4..0.6x2')
    >>> draw = next(draws(document, 8))
    >>> draw.parameters.uplift == draw.values['width'] / 2.0
    True
    """

    values: dict[str, float]  # SI values of the keys with a spread, by their path
    # parameters of the structure, None if these values make no structure that rocks
    parameters: RockingParameters | None
    fault: str | None  # the reason why they make none


def uncertain_keys(document: Document) -> list[Uncertain]:
    """Return the keys of a document that have a spread, in its order.

    Raises
    ------
    DocumentError
        if the document is not valid at the means of its keys

    Examples
    --------
    >>> (document,) = read_documents('block:0.5+-0.01x2,restitution=0.85..0.95')
    >>> [key.path for key in uncertain_keys(document)]
    ['width', 'restitution']
    """
    from . import build_structure

    build_structure(document)
    order = list(document.keys)

    return sorted(
        document.uncertain.values(),
        key=lambda key: (order.index(key.path.partition(".")[0]), key.path),
    )


def draws(
    document: Document | str | Path, n: int = DRAWS, seed: int = 0
) -> Iterator[Draw]:
    """Yield draws of a structure whose keys have spreads.

    The keys are independent of each other. Coordinate k of the points of a scrambled
    Sobol sequence belongs to the k-th key of the document; each draw is as likely as
    any other.

    Parameters
    ----------
    document
        the structure: a document, a path, or a text such as "block:0.62+-0.01x2"
    n
        number of draws, rounded up to a power of two
    seed
        of the scrambling; the same seed gives the same draws

    Yields
    ------
    Draw
        the values of the keys and the structure that they make

    Raises
    ------
    DocumentError
        if the document is not valid at the means of its keys
    UsageError
        if no key has a spread, or n is out of range

    Examples
    --------
    >>> wall = "block:0.5+-0.01x2"
    >>> found = [draw.parameters.uplift for draw in draws(wall, 256)]
    >>> round(sum(found) / 256, 4)
    0.25
    """
    from . import build_structure

    document = document_from(document)
    keys = uncertain_keys(document)
    if not keys:
        raise UsageError(
            f"{document.source}: found no number with a spread; expected one, such as"
            " width: 0.5 m +- 10 mm"
        )
    ranks = sobol(len(keys), n, seed)
    columns = [
        key.spread.at(ranks[:, k], key.low, key.high) for k, key in enumerate(keys)
    ]
    for row in np.column_stack(columns).tolist():
        values = {key.path: value for key, value in zip(keys, row, strict=True)}
        drawn = document
        for key in keys:
            text = f"{values[key.path]!r} {si_unit(key.dimension)}".strip()
            drawn = drawn.with_value(key.path, text, document.source)
        try:
            yield Draw(values, build_structure(drawn), None)
        except DocumentError as error:
            yield Draw(values, None, str(error))


def summaries(found: Iterable[Draw]) -> list[dict[str, Any]]:
    """Return the distribution of each rocking parameter over the draws.

    Parameters
    ----------
    found
        draws of one structure; those without parameters are left out

    Returns
    -------
    list of dict
        for p [rad/s], alpha [rad], eta, lambda and a_scale [-]: quantity, unit, mean,
        sd, q05, q50, q95

    Examples
    --------
    >>> (document,) = read_documents('block:0.5+-0.01x2')
    >>> rows = {row['quantity']: row for row in summaries(draws(document))}
    >>> round(rows['lambda']['mean'], 4), round(rows['lambda']['sd'], 3)
    (0.25, 0.005)
    """
    made = [numbers_of(one.parameters) for one in found if one.parameters is not None]
    rows = []
    for name in made[0] if made else ():
        values = np.array([numbers[name] for numbers in made])
        quantiles = np.quantile(values, (0.05, 0.5, 0.95)).tolist()
        rows.append(
            {
                "quantity": name,
                "unit": UNIT_OF.get(name, ""),
                "mean": float(values.mean()),
                "sd": float(values.std(ddof=1)),
                **dict(zip(("q05", "q50", "q95"), quantiles, strict=True)),
            }
        )
    return rows


def sobol(dimensions: int, n: int, seed: int) -> np.ndarray:
    """Return points of a scrambled Sobol sequence, inside of (0, 1).

    Parameters
    ----------
    dimensions
        number of coordinates
    n
        number of points, rounded up to a power of two
    seed
        of the scrambling

    Returns
    -------
    numpy.ndarray
        (points, dimensions)

    Raises
    ------
    UsageError
        if n is not from 2 to 2^20, or the seed is negative
    """
    from scipy.stats import qmc

    if not 2 <= n <= MOST_DRAWS:
        raise UsageError(f"draws: found {n}; expected a number from 2 to {MOST_DRAWS}")
    if seed < 0:
        raise UsageError(f"seed: found {seed}; expected a number that is not negative")
    # SciPy 1.15 renamed the argument.
    name = "rng" if "rng" in inspect.signature(qmc.Sobol).parameters else "seed"
    sequence = qmc.Sobol(dimensions, scramble=True, **{name: seed})
    points = sequence.random_base2((n - 1).bit_length())
    return np.clip(points, _EDGE, 1.0 - _EDGE)
