"""Intensity measures of a record: exact integrals of its samples joined by straight
lines, without any correction.
"""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..arrays import Array
from ..documents.quantities import DEFAULT_GRAVITY
from ..showing import Shown
from .blocks import largest
from .records import Record, record_from


@dataclass(frozen=True, repr=False)
class Intensity(Shown):
    """The intensity measures of a record, as `intensity` returns them.

    Attributes
    ----------
    pga: peak acceleration [m/s2]
    pga_time: time of the peak acceleration [s]
    pgv: peak velocity [m/s]
    pgd: peak displacement [m]
    arias: Arias intensity [m/s]
    cav: cumulative absolute velocity [m/s]
    d5_75: duration from 5 to 75 % of the Arias intensity [s]
    d5_95: duration from 5 to 95 % of the Arias intensity [s]

    Examples
    --------
    >>> measured = intensity(read_record("configs/motions/synthetic.at2"))
    >>> round(measured.arias, 3), round(measured.d5_95, 2)
    (2.825, 5.1)
    """

    pga: float  # peak acceleration [m/s2]
    pga_time: float  # time of the peak acceleration [s]
    pgv: float  # peak velocity [m/s]
    pgd: float  # peak displacement [m]
    arias: float  # Arias intensity [m/s]
    cav: float  # cumulative absolute velocity [m/s]
    d5_75: float  # duration from 5 to 75 % of the Arias intensity [s]
    d5_95: float  # duration from 5 to 95 % of the Arias intensity [s]

    def _shown(self) -> dict[str, float]:
        return vars(self)


def intensity(record: Record | str | Path) -> Intensity:
    """Return the intensity measures of a record; velocity and displacement start at
    zero.

    Parameters
    ----------
    record
        as recorded, or the path of its file

    Returns
    -------
    Intensity
        PGA, PGV, PGD, Arias intensity, CAV and significant durations, in SI

    Raises
    ------
    ArgumentError
        for an argument that is no record

    Examples
    --------
    >>> measured = intensity(read_record("configs/motions/synthetic.at2"))
    >>> round(measured.pga, 3), round(measured.pgv, 3)
    (3.924, 0.67)
    """
    record = record_from(record)
    steps = np.full(record.npts - 1, record.dt)
    return intensity_of_lines(
        record.acceleration, steps, record.dt * np.arange(record.npts)
    )


def intensity_of_lines(a: Array, dt: Array, t: Array) -> Intensity:
    """Return the measures of accelerations a [m/s2] at times t [s], (n,), joined by
    straight lines over steps dt [s], (n - 1,), of which a jump has one of zero.
    """
    a0, a1 = a[:-1], a[1:]
    v = _sums(0.5 * dt * (a0 + a1))
    d = _sums(dt * v[:-1] + dt * dt / 6.0 * (2.0 * a0 + a1))
    energy = _sums(dt / 3.0 * (a0**2 + a0 * a1 + a1**2))
    total = np.abs(a0) + np.abs(a1)
    i, areas = np.flatnonzero(a0 * a1 < 0.0), 0.5 * dt * total
    # two triangles where a changes its sign, else a trapezoid
    areas[i] = 0.5 * dt[i] * (a0[i] ** 2 + a1[i] ** 2) / total[i]
    at_5, at_75, at_95 = (
        _reached(a, dt, t, energy, part) for part in (0.05, 0.75, 0.95)
    )
    # The velocity has an extreme where the acceleration changes its sign.
    return Intensity(
        pga=largest(a),
        pga_time=float(t[np.abs(a).argmax()]),
        pgv=max(
            largest(v), largest(v[i] + 0.5 * dt[i] * a[i] ** 2 / (a[i] - a[i + 1]))
        ),
        pgd=_largest_displacement(a, v, d, dt),
        arias=math.pi / (2.0 * DEFAULT_GRAVITY) * float(energy[-1]),
        cav=float(areas.sum()),
        d5_75=at_75 - at_5,
        d5_95=at_95 - at_5,
    )


def _sums(gains: Array) -> Array:
    return np.cumsum(np.concatenate([[0.0], gains]))


def _largest_displacement(a: Array, v: Array, d: Array, dt: Array) -> float:
    """max |d| over samples and over the roots of v = v0 + a0 s + (a1 - a0)/dt s^2/2
    inside intervals, without cancellation.
    """
    most = largest(d)
    # v has a root inside only if it changes its sign, or if the vertex of its parabola
    # is inside.
    i = np.flatnonzero((v[:-1] * v[1:] <= 0.0) | (a[:-1] * a[1:] < 0.0))
    curved, sloped, flat = 0.5 * dt[i] * (a[i + 1] - a[i]), dt[i] * a[i], v[i]
    with np.errstate(all="ignore"):
        root = np.sqrt(sloped**2 - 4.0 * curved * flat)
        q = -0.5 * (sloped + np.copysign(root, sloped))
        for s in (q / curved, flat / q):
            inside = np.flatnonzero((s > 0.0) & (s < 1.0))
            j, x = i[inside], s[inside]
            there = d[j] + dt[j] * x * (
                v[j] + dt[j] * x * (a[j] / 2.0 + (a[j + 1] - a[j]) * x / 6.0)
            )
            most = max(most, largest(there))
    return most


def _reached(a: Array, dt: Array, t: Array, energy: Array, part: float) -> float:
    """The time [s] at which the integral of a^2 (`energy` at samples) reaches `part` of
    its final value; 0 for a zero record.
    """
    target = part * float(energy[-1])
    if not target > 0.0:
        return 0.0
    i = int(np.searchsorted(energy, target)) - 1
    a0 = float(a[i])
    rise = float(a[i + 1] - a[i]) / float(dt[i])
    wanted = target - float(energy[i])
    low, high = 0.0, float(dt[i])
    # bisection of a rising function; 60 steps reach double precision
    for _ in range(60):
        middle = 0.5 * (low + high)
        gained = middle * (a0 * a0 + middle * (a0 * rise + middle * rise * rise / 3.0))
        low, high = (low, middle) if gained >= wanted else (middle, high)
    return float(t[i]) + high
