"""A first look at a trace: its zero, its impacts and peaks, and its releases. The fit
takes start values from here, never an estimate.
"""

from dataclasses import dataclass

import numpy as np

from ...arrays import Array
from ...errors import DocumentError, counted
from .trace import Trace

LEAST_IMPACTS = 3  # with a whole half-cycle after them
LEAST_SAMPLES = 8  # of a half-cycle
_BAND = 0.05  # of the largest value: smaller ones are no half-cycle
_LEFT = 0.97  # of the first peak: the hand has gone when the fall is below
_AGAIN = 1.5  # a peak larger by this factor begins a new release,
_LOW = 0.5  # if the one before is smaller than this share of the first one
_SQUARE = 0.3  # of the height of a square wave: less is no side of it
_FINEST = 1e-5  # of the range: no trace is less noisy
_SIGMAS = 6.0  # peaks below so many noises are left out


@dataclass(frozen=True)
class Release:
    """One release: the window that is fitted, and what it looks like."""

    first: int  # index of the first sample of the window
    end: int  # index behind its last sample
    side: int  # of the first half-cycle: 0 right (theta > 0), 1 left
    impacts: (
        Array  # approximate times of the impacts [s], (n + 1,); the last one ends it
    )
    peaks: Array  # approximate peaks of half-cycles 0 to n, unsigned, (n + 1,)

    @property
    def count(self) -> int:
        """The number n of impacts with a whole half-cycle after them."""
        return len(self.impacts) - 1


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
    if t.size < LEAST_SAMPLES * LEAST_IMPACTS:
        raise DocumentError(
            f"{trace.name}: found {counted(t.size, 'sample')}; expected a trace of free"
            " rocking"
        )
    _require_return(trace, y)
    v = _integrated(t, y) if rates else _centred(t, _smooth(y))
    least_peak = 0.0 if rates else _SIGMAS * noise_of(y)
    stays = _stays(
        v, max(min(_BAND, 0.8 * least) * np.max(np.abs(v)), 0.5 * least_peak)
    )
    if len(stays) < 2:
        raise DocumentError(
            f"{trace.name}: the trace never crosses its zero: no impact (one-sided"
            " body? overturned?)"
        )
    crossings = np.array([_crossing(t, v, i) for i, _ in stays[1:]])
    heights = np.array(
        [
            np.max(np.abs(v[i:j]))
            for (i, _), (j, _) in zip(stays, [*stays[1:], (v.size, 0)], strict=True)
        ]
    )
    begins = [0]
    for i in range(1, len(stays)):
        if heights[i] <= _AGAIN * heights[i - 1]:
            continue
        if begins[-1] == i - 1:  # the hand was on the other side first
            begins[-1] = i
        elif heights[i - 1] < _LOW * heights[begins[-1]]:
            begins.append(i)
    found = []
    for first, behind in zip(begins, [*begins[1:], len(stays)], strict=True):
        # the last stay of a release has no impact of its own at its end
        if behind - first >= 2:
            found.append(
                _release(
                    trace,
                    v,
                    stays,
                    crossings,
                    heights,
                    (first, behind),
                    (least, least_peak),
                )
            )
    if not found:
        raise _few(trace, 0)
    return found


def _few(trace: Trace, count: int) -> DocumentError:
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
    from scipy.ndimage import median_filter

    v = median_filter(y, 5, mode="nearest")
    low, high = np.percentile(v, [2.0, 98.0])
    v = v - 0.5 * (low + high)
    stays = _stays(v, _SQUARE * 0.5 * (high - low))
    return np.array([_crossing(t, v, i) for i, _ in stays[1:]])


def _release(
    trace: Trace,
    v: Array,
    stays: list[tuple[int, int]],
    crossings: Array,
    heights: Array,
    span: tuple[int, int],
    least: tuple[float, float],
) -> Release:
    """Return the release of the stays of a span. Raises DocumentError."""
    t, (first, behind) = trace.t, span
    times, tops = crossings[first : behind - 1], heights[first : behind - 1]
    count = _used(trace, times, tops, max(least[0] * tops[0], least[1]))
    times, tops = times[: count + 1], tops[: count + 1]
    begin = stays[first][0]
    held = np.abs(v[begin : np.searchsorted(t, times[0])]) >= _LEFT * tops[0]
    begin += int(np.flatnonzero(held)[-1]) + 1
    end = int(np.searchsorted(t, times[-1]))
    _require_no_gap(trace, begin, end, 0.25 * float(np.min(np.diff(times))))
    return Release(begin, end, int(stays[first][1] < 0), times, tops)


def _used(trace: Trace, times: Array, tops: Array, lowest: float) -> int:
    """Return the number of impacts before the first half-cycle that is too small or too
    short, of those with these peaks, which the impacts end. Raises DocumentError.
    """
    count, t = len(tops) - 1, trace.t
    for k in range(1, len(tops)):
        samples = int(np.sum((t > times[k - 1]) & (t < times[k])))
        if k <= LEAST_IMPACTS and samples < LEAST_SAMPLES:
            rate = LEAST_SAMPLES / np.min(np.diff(times[: LEAST_IMPACTS + 1]))
            raise DocumentError(
                f"{trace.name}: half-cycle {k} has {samples} samples; {LEAST_SAMPLES}"
                f" are needed: sample faster than {rate:.3g} Hz"
            )
        if tops[k] < lowest or samples < LEAST_SAMPLES:
            count = k - 1
            break
    if count < LEAST_IMPACTS:
        raise _few(trace, count)
    return count


def _require_no_gap(trace: Trace, begin: int, end: int, most: float) -> None:
    """Raise DocumentError if two samples of a window are farther apart than `most`."""
    steps = np.diff(trace.t[begin:end])
    at = int(np.argmax(steps))
    if steps[at] > most:
        raise DocumentError(
            f"{trace.name}:{trace.lines[begin + at + 1]}: a gap of {steps[at]:.3g} s;"
            f" expected at most a quarter of a half-cycle, {most:.3g} s"
        )


def _require_return(trace: Trace, y: Array) -> None:
    """Raise DocumentError if the trace ends on a way out that is longer than every
    swing before.
    """
    at = _turns(_smooth(y))
    swings = np.abs(np.diff(y[at]))
    if swings.size and abs(y[-1] - y[at[-1]]) > _AGAIN * swings.max():
        raise DocumentError(
            f"{trace.name}: the reading grows beyond {abs(y[at]).max():.3g} (in SI) and"
            " does not return: it falls"
        )


def _smooth(y: Array) -> Array:
    """Return a running median of 5 and then a parabola over 5 samples."""
    from scipy.ndimage import median_filter
    from scipy.signal import savgol_filter

    return np.asarray(savgol_filter(median_filter(y, 5, mode="nearest"), 5, 2))


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
    from scipy.integrate import cumulative_trapezoid

    v = cumulative_trapezoid(rate, t, initial=0.0)
    for _ in range(3):
        v = _centred(t, v)
    return np.asarray(v)


def _stays(v: Array, band: float) -> list[tuple[int, int]]:
    """Return (first index, sign) of each stay on one side beyond the band."""
    beyond = np.flatnonzero(np.abs(v) > band)
    sign = np.sign(v[beyond]).astype(int)
    new = np.flatnonzero(np.diff(sign, prepend=0))
    return [(int(beyond[i]), int(sign[i])) for i in new]


def _crossing(t: Array, v: Array, i: int) -> float:
    """Return the time of the last zero before the sample i."""
    before = np.flatnonzero(v[:i] * v[i] <= 0.0)[-1]
    a, b = v[before], v[before + 1]
    return float(t[before] + (t[before + 1] - t[before]) * a / (a - b))
