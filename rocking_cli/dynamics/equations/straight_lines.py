"""Taylor series of lanes along the straight lines of a record: the degree that a line
needs, the terms, and the error that they leave out.
"""

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from ...arrays import Array
from ...motions.segments import Segments
from ..lanes import Lanes
from .recurrence import Recurrence, TermRows, motion_terms
from .taylor import LONGEST, MOST_TERMS, WITHIN, Drive, TaylorSeries, drive_series

_LEAST = 1e-3  # tau: the unit of lanes at the end of their line
# growth rate of lanes up to a little beyond the barrier; the last terms show where it
# is larger
GROWTH = 1.3
_INVERSES = 1.0 / np.cumprod(np.maximum(1.0, np.arange(MOST_TERMS + 1.0)))  # of n!
# largest size of the first term left out, over the error that a step may have
_ROOM = 0.1


def growth_rate(stiffness: Array | float) -> Array:
    """Return the growth rate [1/tau] of a motion for the degree of its series, with
    this stiffness of restraints, 0 without them.
    """
    return np.asarray(GROWTH * np.sqrt(np.maximum(1.0, stiffness)))


def degrees(
    size: Array, unit: Array, tolerance: float, growth: Array | float = GROWTH
) -> Array:
    """Degree that each lane's series needs; size: bound of the acceleration and of the
    slope of the drive during the unit; growth: growth rate of the motion [1/tau].
    """
    degree = np.full(unit.shape, 3, dtype=np.int64)
    reach = growth * unit
    # what term n adds to the acceleration, n (n - 1) c_n/unit^2, over n - 1; here n = 3
    left = 0.5 * size * reach
    for n in range(4, MOST_TERMS + 1):
        left *= reach / (n - 1.0)
        more = left > _ROOM * WITHIN * tolerance
        if not more.any():
            break
        degree[more] = n
    return degree


@lru_cache(maxsize=256)
def size_limits(unit: float, tolerance: float, growth: float = GROWTH) -> list[float]:
    """Return the largest size, as `degrees` takes it, for which a series of degree 3, 4
    ... up to `MOST_TERMS` holds over this unit; growth: as of `degrees`.
    """
    reach, limits = growth * unit, []
    least = 0.5 * reach
    for n in range(3, MOST_TERMS):
        least *= reach / n
        limits.append(_ROOM * WITHIN * tolerance / least if least else math.inf)
    return limits


def factors_for(unit: Array, degree: Array) -> Array:
    """unit^2/((n + 1)(n + 2)) for the terms n + 2 of y up to the largest degree, 0
    beyond a lane's degree, (degrees, lanes).
    """
    n = np.arange(1.0, float(degree.max(initial=3)))[:, None]
    rows: Array = unit * unit / (n * (n + 1.0))
    rows[n + 1.0 > degree] = 0.0
    return rows


def last_terms(terms: Array, last: Array, unit: Array) -> Array:
    """Size of the last two terms of each lane, (lanes,): steps need size <= `WITHIN`
    tolerance unit. last: flat index of the last term.
    """
    flat = terms.ravel()
    size = np.abs(flat.take(last - unit.size))
    size *= unit
    size *= 0.25
    size += np.abs(flat.take(last))
    return size


def line_drive(segments: Segments, lanes: Any, unit: Array | None = None) -> Drive:
    """Return the drive of lanes, with the names of `Lanes`, on their straight line from
    now on. unit: unit of time of the series [tau], None for the rest of the line.
    """
    if unit is None:
        left = (segments.length[lanes.segment] - lanes.phase) / lanes.omega
        unit = np.clip(left, _LEAST, LONGEST)
    outward = -lanes.side * lanes.amplitude
    slope = outward * segments.slope[lanes.segment]
    start = outward * segments.s_start[lanes.segment] + slope * lanes.phase
    drive = Drive(TermRows.of(start, slope * lanes.omega * unit), unit)
    if (weighed := segments.weighed) is not None:
        heavier = (
            weighed.sway(lanes.side, lanes.amplitude)
            * weighed.vertical.slope[lanes.segment]
            * lanes.omega
            * unit
        )
        drive = drive._replace(
            weight=TermRows.of(
                weighed.weight(lanes.side, lanes.amplitude, lanes.segment, lanes.phase),
                heavier,
            )
        )
    return drive


def weight_series(segments: Segments, lanes: Lanes, order: int) -> TaylorSeries | None:
    """Return the series of the weight over m g of lanes from now on, up to term `order`
    under sinusoids; None where it is constant.
    """
    if segments.weighed is None:
        return None
    if segments.straight:
        drive = line_drive(segments, lanes)
    else:
        drive, _ = drive_series(segments, lanes, order)
    assert drive.weight is not None
    unit = drive.unit
    return TaylorSeries(drive.weight.array[:, : unit.size], unit, unit)


def line_flow(
    equation: Recurrence,
    segments: Segments,
    lanes: Lanes,
    growth: Array | float = GROWTH,
) -> TaylorSeries:
    """Return the series of lanes under straight lines, each to the end of its line or
    for `LONGEST`; growth: as of `degrees`.
    """
    drive = line_drive(segments, lanes)
    unit = drive.unit
    # A bound of |y''| and of the slope of the drive gives the degree.
    line = drive.terms.array[:, : unit.size]
    size = 2.0 + np.abs(lanes.v) * (growth / GROWTH)
    for rows in (drive.terms, drive.weight):
        if rows is None:
            continue
        start, gain = np.abs(rows.array[:, : unit.size])
        size += start + gain / unit
    weight = 1.0 if drive.weight is None else start + gain
    degree = degrees(size, unit, equation.tolerance, growth)
    terms = motion_terms(
        equation,
        lanes.y,
        lanes.v,
        unit,
        factors_for(unit, degree),
        drive.terms,
        drive.weight,
        lanes.force,
    )
    # The last terms show for how long the series holds.
    sizes = [_term(terms, degree - i) for i in range(3)]
    last = sizes[1] * unit * 0.25 + sizes[0]
    with np.errstate(divide="ignore"):
        short = (WITHIN * equation.tolerance * unit / last) ** (1.0 / (degree - 1.0))
    # What is left out: the next two terms, and the bound of the term after the last
    # one, since the terms themselves can be small by accident.
    start, gain = np.abs(line)
    slope = growth * growth * weight + equation.gain * (start + gain)
    change = equation.gain * (gain + np.abs(lanes.v * unit))
    error = 2.0 * equation.damping * sizes[0]
    error += _speed_error(sizes, degree, unit, slope, change)
    error += size * unit * (growth * unit) ** (degree - 1.0) * _INVERSES[degree]

    # the digits of turning points depend on the number of terms, which must not depend
    # on a lane's neighbours
    if drive.weight is not None:
        terms = np.concatenate(
            [terms, np.zeros((MOST_TERMS + 1 - len(terms), unit.size))]
        )
    return TaylorSeries(
        terms,
        unit,
        np.minimum(short, 1.0) * unit,
        equation.damping,
        error,
    )


def _term(terms: Array, n: Array) -> Array:
    """The size of term n of each lane."""
    lanes = n.size
    return np.abs(terms.ravel().take(n * lanes + np.arange(lanes)))


def _speed_error(
    last: Sequence[Array], degree: Array, unit: Array, slope: Array, change: Array
) -> Array:
    """The error of y' after the unit [tau] of series without damping, by the next two
    terms; last: sizes of the term `degree` and of the two before it; slope: bound of
    df/dy, change: that of its change over the unit, from which the next terms follow.
    """
    first = slope * last[1] + change * last[2]
    second = slope * last[0] + change * last[1]
    return np.asarray(unit * (first / degree + second / (degree + 1.0)))
