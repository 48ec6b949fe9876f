"""A first look at a trace: its zero, its impacts and peaks, and its releases. The fit
takes start values from here, never an estimate.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from ...arrays import Array
from ...errors import DocumentError, counted
from .trace import Trace

LEAST_IMPACTS = 3  # with a whole half-cycle after them
LEAST_SAMPLES = 8  # of a half-cycle
_BAND = 0.05  # of the largest value: smaller ones are no half-cycle
_LEFT = 0.97  # of the first peak: the hand has gone when the fall is below
_AGAIN = 1.5  # a peak larger by this factor begins a new release,
_LOW = 0.5  # if the one before is smaller than this share of the first one
_SQUARE = 0.15  # of the range of a square wave: less is no side of it
_FINEST = 1e-5  # of the range: no trace is less noisy
_SIGMAS = 6.0  # peaks below so many noises are left out
_POWERS = np.vander(np.arange(5.0), 3)
# times five samples: their parabola of least squares at each of them
_PARABOLA = _POWERS @ np.linalg.pinv(_POWERS)


@dataclass(frozen=True)
class Release:
    """One release: the window that is fitted, and what it looks like."""

    window: slice  # of the samples
    side: int  # of the first half-cycle: 0 right (theta > 0), 1 left
    impacts: Array  # approximate times [s], (n + 1,); the last one ends the window
    peaks: Array  # approximate peaks of half-cycles 0 to n, unsigned, (n + 1,)


def noise_of(y: Array) -> float:
    """Return the standard deviation of white noise on a smooth trace, from its third
    differences.
    """
    third = np.diff(y, 3)
    spread = 1.4826 * np.median(np.abs(third - np.median(third)))
    if not spread:  # few digits: most neighbours are alike
        spread = np.std(third)
    return max(float(spread / np.sqrt(20.0)), _FINEST * float(np.ptp(y)))


def releases_of(trace: Trace, y: Array, rates: bool, least: float) -> list[Release]:
    """Return the releases of a trace. y: readings as a rotation or in proportion to it,
    or its rate if `rates`; least: half-cycles with a smaller peak than this share of
    the first one are left out. Raises DocumentError.
    """
    t = trace.t
    turns = _turns(_smooth(y))
    swings = np.abs(np.diff(y[turns]))
    if swings.size and abs(y[-1] - y[turns[-1]]) > _AGAIN * swings.max():
        raise DocumentError(
            f"{trace.name}: the reading grows beyond {abs(y[turns]).max():.3g} (in SI)"
            " and does not return: it falls"
        )
    v = _integrated(t, y) if rates else _centred(t, _smooth(y))
    lowest = 0.0 if rates else _SIGMAS * noise_of(y)
    band = max(min(_BAND, 0.8 * least) * np.max(np.abs(v)), 0.5 * lowest)
    stays, crossings = _stays(t, v, band)
    if stays.size < 2:
        raise DocumentError(
            f"{trace.name}: the trace never crosses its zero: no impact (one-sided"
            " body? overturned?)"
        )
    heights = np.maximum.reduceat(np.abs(v), stays)
    begins = [0]
    for i in range(1, stays.size):
        if heights[i] <= _AGAIN * heights[i - 1]:
            continue
        if begins[-1] == i - 1:  # the hand was on the other side first
            begins[-1] = i
        elif heights[i - 1] < _LOW * heights[begins[-1]]:
            begins.append(i)
    found = []
    for first, behind in pairwise([*begins, stays.size]):
        # the last stay of a release has no impact of its own at its end
        if behind - first < 2:
            continue
        times, tops = crossings[first : behind - 1], heights[first : behind - 1]
        count = _used(trace, times, tops, max(least * tops[0], lowest))
        times, tops = times[: count + 1], tops[: count + 1]
        begin, end = stays[first], np.searchsorted(t, times[-1])
        held = np.abs(v[begin : np.searchsorted(t, times[0])]) >= _LEFT * tops[0]
        window = slice(int(begin + np.flatnonzero(held)[-1] + 1), int(end))
        _require_no_gap(trace, window, 0.25 * float(np.min(np.diff(times))))
        found.append(Release(window, int(v[begin] < 0.0), times, tops))
    if not found:
        raise too_few(trace, 0)
    return found


def require_samples(trace: Trace) -> None:
    """Raise DocumentError for fewer samples than the half-cycles of a release need."""
    if trace.t.size < LEAST_SAMPLES * LEAST_IMPACTS:
        raise DocumentError(
            f"{trace.name}: found {counted(trace.t.size, 'sample')}; expected a trace"
            " of free rocking"
        )


def too_few(trace: Trace, count: int) -> DocumentError:
    """Return the error for too few impacts."""
    return DocumentError(
        f"{trace.name}: {counted(count, 'impact')} with a whole half-cycle after"
        f" {'it' if count == 1 else 'them'}; {LEAST_IMPACTS} are needed"
    )


def unfolded(y: Array) -> Array:
    """Return an unsigned trace less its zero, with another sign after each minimum."""
    v = _smooth(y)
    at = _turns(v)
    least = at[1::2] if at.size > 1 and v[at[0]] > v[at[1]] else at[::2]
    turns = np.searchsorted(least, np.arange(y.size))
    zero = np.median(v[least]) if least.size else v.min()
    return np.asarray((y - zero) * (-1.0) ** turns)


def sign_changes(t: Array, y: Array) -> Array:
    """Return the times [s] at which a square wave changes its sign, such as the
    acceleration along the axis of a rocking body.
    """
    v = _medians(y)
    low, high = np.percentile(v, [2.0, 98.0])
    return _stays(t, v - 0.5 * (low + high), _SQUARE * (high - low))[1]


def _used(trace: Trace, times: Array, tops: Array, lowest: float) -> int:
    """Return the number of impacts before the first half-cycle that is too small or too
    short, of those with these peaks, which the impacts end. Raises DocumentError.
    """
    samples = np.diff(np.searchsorted(trace.t, times))  # of half-cycles 1, 2, ...
    small = np.flatnonzero((tops[1:] < lowest) | (samples < LEAST_SAMPLES))
    count = int(small[0]) if small.size else samples.size
    if count >= LEAST_IMPACTS:
        return count
    if small.size and samples[count] < LEAST_SAMPLES:
        rate = LEAST_SAMPLES / np.min(np.diff(times[: LEAST_IMPACTS + 1]))
        raise DocumentError(
            f"{trace.name}: half-cycle {count + 1} has {samples[count]} samples;"
            f" {LEAST_SAMPLES} are needed: sample faster than {rate:.3g} Hz"
        )
    raise too_few(trace, count)


def _require_no_gap(trace: Trace, window: slice, most: float) -> None:
    """Raise DocumentError if two samples of a window are farther apart than `most`."""
    steps = np.diff(trace.t[window])
    at = int(np.argmax(steps))
    if steps[at] > most:
        raise DocumentError(
            f"{trace.name}:{trace.lines[window][at + 1]}: a gap of {steps[at]:.3g} s;"
            f" expected at most a quarter of a half-cycle, {most:.3g} s"
        )


def _medians(y: Array) -> Array:
    """Return a running median of 5 samples; beyond an end stand more of its sample."""
    windows = sliding_window_view(np.pad(y, 2, mode="edge"), 5)
    return np.asarray(np.median(windows, axis=-1))


def _smooth(y: Array) -> Array:
    """Return a running median of 5 and then a parabola over 5 samples."""
    v = _medians(y)
    middle = sliding_window_view(v, 5) @ _PARABOLA[2]
    return np.concatenate([_PARABOLA[:2] @ v[:5], middle, _PARABOLA[3:] @ v[-5:]])


def _turns(v: Array) -> Array:
    """Return the indices of successive extremes that differ by more than `_BAND` of the
    whole range.
    """
    band, found, up = _BAND * np.ptp(v), [], True
    best = 0
    for i, x in enumerate(v.tolist()):
        if (x > v[best]) == up and x != v[best]:
            best = i
        elif abs(x - v[best]) > band:
            found.append(best)
            best, up = i, not up
    return np.array(found, int)


def _centred(t: Array, v: Array) -> Array:
    """Return a trace less its zero: the straight line through the middles of successive
    extremes, each the more certain the smaller its swing; where it does not swing, the
    median of its end.
    """
    at = _turns(v)
    e = v[at]
    if at.size < 3:
        return np.asarray(v - np.median(v[-max(5, v.size * 3 // 100) :]))
    middle, swing = 0.25 * (e[:-2] + 2.0 * e[1:-1] + e[2:]), np.abs(e[2:] - e[1:-1])
    line = np.polyfit(t[at[1:-1]], middle, min(1, at.size - 3), w=1.0 / swing)
    return np.asarray(v - np.polyval(line, t))


def _integrated(t: Array, rate: Array) -> Array:
    """Return the rotation of a rate, less the straight line through its middles."""
    v = np.append(0.0, np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(t)))
    for _ in range(3):
        v = _centred(t, v)
    return np.asarray(v)


def _stays(t: Array, v: Array, band: float) -> tuple[Array, Array]:
    """Return (the first index of each stay on one side beyond the band, times of the
    last zero before each but the first).
    """
    beyond = np.flatnonzero(np.abs(v) > band)
    begins = beyond[np.flatnonzero(np.diff(np.sign(v[beyond]), prepend=0.0))]
    before = np.array(
        [np.flatnonzero(v[:i] * v[i] <= 0.0)[-1] for i in begins[1:]], int
    )
    share = v[before] / (v[before] - v[before + 1])
    return begins, t[before] + (t[before + 1] - t[before]) * share
