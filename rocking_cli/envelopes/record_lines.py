"""A record as straight lines that each cover several samples, for approximate scans.

A line has the integral and the first moment of the samples that it covers. The
difference r of the record and the line moves a body by W times the outward drive of
s = 1, where W'' = r and W is 0 at both ends of the line.
"""

from typing import NamedTuple

import numpy as np

from ..arrays import Array
from ..motions.segments import Segments


class RecordLines(NamedTuple):
    """The lines of a record."""

    s: Array  # s at the start of each line [-], (lines,)
    rise: Array  # increase of s over the line [-], (lines,)
    length: Array  # length of the line [rad], (lines,)
    up: Array  # the vertical s_v at the start of each line [-], (lines,); 0 without one
    up_rise: Array  # increase of s_v over the line [-], (lines,)
    # the difference r of record and line, for each sample of a line: W and W' at its
    # start, r there, and the rise of r, (4, lines, samples); without samples if the
    # lines are the record itself
    residual: Array


def record_lines(segments: Segments, step: float) -> RecordLines:
    """The lines of a record. Each line covers whole segments, up to `step` [rad] in
    all, or a part of a segment. Under a vertical motion each covers one at most.
    """
    length = segments.length[:]
    count = max(1, int(step / length.max() * (1.0 + 1e-9)))
    uneven = np.ptp(length) > 1e-9 * length.max()
    if count == 1 or uneven or segments.weighed is not None:
        return _parts(segments, step)
    return _joined(segments, count)


def _parts(segments: Segments, step: float) -> RecordLines:
    """The lines that each cover a part of a segment, up to `step` [rad], or all of
    it.
    """
    start, length = segments.s_start[:], segments.length[:]
    up = np.zeros((2, length.size))
    if (weighed := segments.weighed) is not None:
        up = np.array([weighed.vertical.s_start[:], weighed.vertical.s_end[:]])
    ends = np.array([[start, segments.s_end[:]], up])
    cuts = np.maximum(1, np.ceil(length / step * (1.0 - 1e-9))).astype(np.intp)
    part = np.arange(cuts.sum()) - np.repeat(np.cumsum(cuts) - cuts, cuts)
    (start, up), (end, up_end) = np.repeat(ends, cuts, axis=2).swapaxes(0, 1)
    length, cuts = np.repeat(length, cuts), np.repeat(cuts, cuts)
    return RecordLines(
        start + (end - start) * part / cuts,
        (end - start) / cuts,
        length / cuts,
        up + (up_end - up) * part / cuts,
        (up_end - up) / cuts,
        np.zeros((4, length.size, 0)),
    )


def _joined(segments: Segments, count: int) -> RecordLines:
    """The lines that each cover so many segments, all of one length."""
    size = float(segments.length[0])
    start = segments.s_start[:]
    s, rise = (
        np.append(x, np.zeros(-x.size % count)).reshape(-1, count)
        for x in (start, segments.s_end[:] - start)
    )

    # The line with the integral and the first moment of its samples.
    middle = size * (np.arange(count) + 0.5 - 0.5 * count)
    moment = (size * (s + 0.5 * rise) * middle + size * size * rise / 12.0).sum(axis=1)
    whole = size * count
    gain = 12.0 * moment / whole**2
    begin = (s + 0.5 * rise).mean(axis=1) - 0.5 * gain

    # The rest of the samples above the line, and its integrals before each of them.
    r = s - begin[:, None] - gain[:, None] * np.arange(count) / count
    r_rise = rise - gain[:, None] / count
    gains = size * (r + 0.5 * r_rise)
    dw = np.cumsum(gains, axis=1) - gains
    gains = size * dw + size * size * (0.5 * r + r_rise / 6.0)
    w = np.cumsum(gains, axis=1) - gains
    length = np.full(begin.size, whole)
    still, residual = np.zeros(begin.size), np.array([w, dw, r, r_rise])
    return RecordLines(begin, gain, length, still, still, residual)
