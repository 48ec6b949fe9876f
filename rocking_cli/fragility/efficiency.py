"""How well each intensity measure predicts overturning: the dispersion of the curve."""

from dataclasses import replace
from typing import Any

import numpy as np

from ..errors import UsageError
from ..motions.intensity_measures import Measure
from .exposure import first_of
from .fits import Curve, fit_cells, fit_first
from .measures import compared
from .study import Study

EFFICIENCY_COLUMNS = ("structure", "im", "median", "beta", "efficiency", "n")


def efficiency(study: Study) -> list[dict[str, Any]]:
    """Return rows with the dispersion for each measure, the smallest first; efficiency:
    the smallest dispersion over that of the row.

    The dispersion is that of the first overturnings, if traced, otherwise of the cells
    at the levels. Raises UsageError for too few overturnings.
    """
    measures = compared(study.motions.members, study.motions.measure)
    found = [(measure.name, _curve(study, measure)) for measure in measures]
    found.sort(key=lambda pair: pair[1].beta)
    least, name = found[0][1].beta, study.structure.name
    rows = (
        (name, im, curve.median, curve.beta, least / curve.beta, round(curve.n))
        for im, curve in found
    )
    return [dict(zip(EFFICIENCY_COLUMNS, row, strict=True)) for row in rows]


def _curve(study: Study, measure: Measure) -> Curve:
    """Return the curve of overturning over another measure than that of the levels."""
    motions, weight = study.motions, study.motions.weight
    here, own = study.own(motions.measure), study.own(measure)
    power = measure.power / motions.measure.power
    if study.intervals is not None:
        first, most = first_of(study.intervals) / here, study.highest / here
        return fit_first(own * first**power, own * most**power, weight)
    fallen, known = study.exposure.beyond(None)
    x = own[:, None] * (motions.levels / here[:, None]) ** power
    n = weight[:, None] * known
    if not 0.0 < (n * fallen).sum() < n.sum():
        raise UsageError(
            f"{study.structure.name}: all cells overturn, or none; expected levels at"
            " which some do"
        )
    curve = fit_cells(x.ravel(), n.ravel(), np.ravel(n * fallen))
    return replace(curve, n=float(weight.size))
