"""The annual rate of a lognormal limit state at a site."""

import math
from pathlib import Path

import numpy as np

from ..errors import UsageError
from .hazard import HazardCurve
from .hazard_files import read_hazard


def annual_rate(median: float, beta: float, hazard: HazardCurve | str | Path) -> float:
    """Return the annual rate of a limit state whose capacity is lognormal.

    Parameters
    ----------
    median
        of the capacity, in the SI unit of the hazard curve, positive
    beta
        dispersion [-], positive
    hazard
        the hazard curve of the site, or the path of a file that `read_hazard` reads

    Returns
    -------
    float
        the integral of Phi(ln(x/median)/beta) over |dH(x)| [1/year]

    Raises
    ------
    UsageError
        for a median or beta that is not positive

    Notes
    -----
    Motions below the first and above the last level of the hazard curve are not
    counted.

    Examples
    --------
    >>> hazard = HazardCurve([1e-4, 1.0, 1e4], [5e5, 5e-5, 5e-15])
    >>> round(annual_rate(0.43, 0.35, hazard), 8)
    0.00060472
    """
    if not (
        median > 0.0 and beta > 0.0 and math.isfinite(median) and math.isfinite(beta)
    ):
        raise UsageError(
            f"found median = {median:g} and beta = {beta:g}; expected positive numbers"
        )
    if isinstance(hazard, str | Path):
        hazard = read_hazard(hazard)
    return float(hazard.rate_of(np.array(math.log(median)), np.array(beta)))
