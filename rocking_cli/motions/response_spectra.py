"""Elastic response spectra of records, and the intensity measures that are read from
them.

The displacement u of an oscillator with circular frequency w and damping xi under
straight lines a(t) has z = u' - conj(s) u, s = w (-xi + i sqrt(1 - xi^2)), with z' = s
z - a, and so an exact recurrence from sample to sample (Nigam and Jennings 1969):

    z(h) = E z - a0 (E - 1)/s - (a1 - a0) (E - 1 - s h)/(s^2 h),   E = exp(s h),
    u = Im z / Im s

S_d is the largest |u| at any time, also between the samples and after the record; S_a =
w^2 S_d is the pseudo-acceleration.
"""

import math
import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ..arrays import Array
from ..documents.quantities import parse_quantity
from ..errors import ArgumentError, UsageError
from .records import Record, record_from

DAMPING = 0.05  # damping of a spectrum that states none, and of measures
# in the shortest period, at least: then a step holds one turning point of u
_STEPS = 12
_SIZE = 1 << 21  # samples times periods that are computed at once
_FINEST = 1 << 24  # samples, to which a short period cuts the steps of a record
_NAME = re.compile(r"(SA|AvgSA)(?:\((.*)\))?", re.IGNORECASE)


def displacement_spectrum(
    record: Record | str | Path,
    periods: Sequence[float] | Array,
    damping: float = DAMPING,
) -> Array:
    """Return the displacement spectrum S_d of a record, of the elastic oscillator.

    Parameters
    ----------
    record
        as recorded, or the path of its file
    periods
        T [s], positive, (n,)
    damping
        ratio of critical damping [-], from 0 to below 1

    Returns
    -------
    array
        S_d [m], (n,)

    Raises
    ------
    UsageError
        for bad periods or damping, and for periods that would cut the record into more
        than 2^24 samples

    Examples
    --------
    >>> record = read_record("configs/motions/synthetic.at2")
    >>> displacement_spectrum(record, [0.5, 1.0]).round(4).tolist()
    [0.0621, 0.367]
    """
    record = record_from(record)
    periods = np.asarray(periods, dtype=float)
    if not (
        periods.ndim == 1
        and periods.size
        and np.all(np.isfinite(periods))
        and np.all(periods > 0.0)
    ):
        raise UsageError("`periods`: expected one or more positive times in s")
    if not 0.0 <= damping < 1.0:
        raise UsageError(
            f"`damping`: found {damping:g}; expected a number from 0 to below 1"
        )
    shortest = min(record.dt, record.dt * _STEPS * record.npts / _FINEST)
    if np.any(periods < shortest):
        raise UsageError(
            f"`periods`: found {periods.min():g} s; expected times from {shortest:.3g}"
            f" s for {record.name}"
        )
    found, order = np.empty(periods.size), np.argsort(periods)
    while order.size:
        finer = max(1, math.ceil(record.dt * _STEPS / periods[order[0]]))
        some, order = np.split(order, [max(1, _SIZE // (finer * record.npts))])
        found[some] = _largest(record, finer, 2.0 * math.pi / periods[some], damping)
    return found


def acceleration_spectrum(
    record: Record | str | Path,
    periods: Sequence[float] | Array,
    damping: float = DAMPING,
) -> Array:
    """Return the spectrum of the pseudo-acceleration S_a = (2 pi/T)^2 S_d of a record.

    Parameters
    ----------
    record
        as recorded, or the path of its file
    periods
        T [s], positive, (n,)
    damping
        ratio of critical damping [-], from 0 to below 1

    Returns
    -------
    array
        S_a [m/s2], (n,)

    Raises
    ------
    UsageError
        as `displacement_spectrum`

    Examples
    --------
    >>> record = read_record("configs/motions/synthetic.at2")
    >>> acceleration_spectrum(record, [0.5, 1.0]).round(3).tolist()
    [9.803, 14.488]
    """
    return (2.0 * math.pi / np.asarray(periods)) ** 2 * displacement_spectrum(
        record, periods, damping
    )


def periods_of(name: str) -> tuple[str, Array] | None:
    """Return the name and the periods [s] of SA(T), AvgSA(T1) (ten from 0.2 to 1.5 T1;
    by default 1 s) or AvgSA(T, T, ...), None for another measure. Raises UsageError for
    a period that is not positive.
    """
    if (match := _NAME.fullmatch(name.strip())) is None:
        return None
    mean = match[1].casefold() != "sa"
    text = match[2] or ("1" if mean else "")
    try:
        periods = np.array([parse_quantity(part, "time") for part in text.split(",")])
    except ArgumentError as error:
        found = f"{text!r} for a period" if text else "no period"
        hint = f", such as {name}(1.0)" if not text else ""
        raise UsageError(f"{name}: found {found}; expected {error}{hint}") from None
    if not np.all(periods > 0.0) or (periods.size > 1 and not mean):
        raise UsageError(
            f"{name}: expected {'positive periods' if mean else 'one positive period'}"
            " in s, as in SA(1.0) or AvgSA(0.5,1)"
        )
    name = f"{'AvgSA' if mean else 'SA'}({','.join(f'{x:g}' for x in periods)})"
    return name, (
        periods[0] * np.linspace(0.2, 1.5, 10)
        if mean and periods.size == 1
        else periods
    )


def mean_acceleration(record: Record, periods: Array) -> float:
    """Return the geometric mean of S_a [m/s2] over the periods, at 5 % damping; 0 for a
    record that is zero.
    """
    found = acceleration_spectrum(record, periods)
    return float(np.exp(np.log(found).mean())) if np.all(found > 0.0) else 0.0


def _largest(record: Record, finer: int, w: Array, damping: float) -> Array:
    """max |u| [m] of oscillators of frequency w [rad/s], with each step of the record
    cut into `finer` equal ones.
    """
    steps = finer * (record.npts - 1)
    a = np.interp(
        np.arange(steps + 1) / finer, np.arange(record.npts), record.acceleration
    )[:, None]
    h, s = record.dt / finer, w * complex(-damping, math.sqrt(1.0 - damping**2))
    z = _at_samples(a, h, s)
    most = np.abs(z.imag / s.imag).max(axis=0)
    _include_turns(most, a, h, z, s, w, damping)

    # The first turn after the record.
    turn = np.mod(-np.angle(z[-1] * s), math.pi) / s.imag
    return np.maximum(most, np.abs((z[-1] * np.exp(s * turn)).imag) / s.imag)


def _at_samples(a: Array, h: float, s: Array) -> Array:
    """The states of oscillators at the samples, (n, oscillators): z = u' - conj(s) u
    [m/s], so that z' = s z - a. a: ground acceleration [m/s2], (n, 1), linear over each
    step h [s]; s: the root of each oscillator [1/s], (oscillators,).
    """
    # What each step adds to the state ...
    z = np.zeros((len(a), s.size), dtype=complex)
    z[1:] = -a[:-1] * gain(s, h) - np.diff(a, axis=0) * rise(s, h)
    # ... and the sums of all that came before, each decayed by exp(s h) a step, over
    # twice as many steps each time.
    factor, reach = np.exp(s * h), 1
    while reach < len(a):
        z[reach:] += factor * z[:-reach]
        factor, reach = factor * factor, 2 * reach
    return z


def _include_turns(
    most: Array,
    a: Array,
    h: float,
    z: Array,
    s: Array,
    w: Array,
    damping: float,
) -> None:
    """Raise `most` to |u| of oscillators (s, w) where u' = 0 between two samples; z:
    their states at the samples (`_at_samples`).
    """
    # A change of the sign of u' between two samples, and its place on the chord.
    v = z.real - damping * w * z.imag / s.imag
    k, i = np.nonzero(v[:-1] * v[1:] < 0.0)
    a0, slope, s, w = a[k, 0], (a[k + 1, 0] - a[k, 0]) / h, s[i], w[i]
    t = h * v[k, i] / (v[k, i] - v[k + 1, i])
    for _ in range(4):  # Newton's method
        there = np.exp(s * t) * z[k, i] - a0 * gain(s, t) - slope * t * rise(s, t)
        displacement = there.imag / s.imag
        speed = there.real - damping * w * there.imag / s.imag
        acceleration = -2.0 * damping * w * speed - w**2 * displacement - a0 - slope * t
        t = np.clip(
            t - speed / np.where(acceleration == 0.0, np.inf, acceleration), 0.0, h
        )
    np.maximum.at(most, i, np.abs(displacement))


def gain(s: Array | complex, h: Array | float) -> Array:
    """(exp(s h) - 1)/s: the state after h of an oscillator under a = -1 from rest."""
    return np.asarray(np.expm1(s * h) / s)


def rise(s: Array | complex, h: Array | float) -> Array:
    """(exp(s h) - 1 - s h)/(s^2 h): the state after h from rest under an a that goes
    from 0 to -1; by its series where s h is small.
    """
    x = s * h
    small = np.abs(x) < 1e-3
    safe = np.where(x == 0.0, 1.0, x)
    return h * np.where(
        small,
        0.5 + x / 6.0 + x * x / 24.0 + x**3 / 120.0,
        (np.expm1(x) - x) / (safe * safe),
    )
