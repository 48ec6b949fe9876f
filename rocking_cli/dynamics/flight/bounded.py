"""The bounded response of the linear oscillator to a record.

Of all solutions of Y'' = Y + s the one that stays bounded is the sum of its two modes, each integrated in the direction in which it
decays: Y + Y' = -int_tau^T exp(tau - t) s dt and Y - Y' = -int_0^tau exp(t - tau) s dt. Every motion on one side is then
y = 1 + c Y + up exp(tau) + down exp(-tau), c = -side A: the state at any later sample costs two exponentials, whatever lies between.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from ...motions.blocks import blocks
from ...motions.columns import Column

Array = np.ndarray

_TERMS = 20  # of the series of the weights: the first one left out is below 1e-17 up to `LONGEST`
LONGEST = 0.5  # longest interval between samples [tau] for which the flight is made
_FORGOTTEN = 1e-20  # a mode that has decayed to this part is no longer felt


def bounded_response(samples: Array | Column, pace: Array) -> Array:
    """Y + iY' at every sample, (paces, samples); pace: interval between samples [tau], (paces,), at most `LONGEST`."""
    h = pace[:, None]
    all_of_it = -np.expm1(-h)  # int_0^h exp(-t) dt
    far = np.zeros_like(h)  # int_0^h exp(-t) t/h dt
    for k in range(_TERMS, -1, -1):
        far = far * -h + (k + 1.0) / math.factorial(k + 2)
    far *= h
    near = all_of_it - far
    result = np.zeros((pace.size, samples.size), dtype=complex)
    up, down = result.real, result.imag  # in place, part by part: no more than the table itself is held
    for part in blocks(samples.size - 1):
        now, then = samples[part], samples[part.start + 1 : part.stop + 1]
        up[:, part] = -(near * now + far * then)
        down[:, part.start + 1 : part.stop + 1] = -(near * then + far * now)
    reach = 1
    while reach < samples.size:
        decay = np.exp(-h * reach)
        if decay.max() < _FORGOTTEN:
            break
        parts = list(blocks(samples.size - reach))
        for part in parts:  # from the front: what comes later has not changed yet
            up[:, part] += decay * up[:, part.start + reach : part.stop + reach]
        for part in reversed(parts):
            down[:, part.start + reach : part.stop + reach] += decay * down[:, part]
        reach *= 2
    for part in blocks(samples.size):
        rises, falls = up[:, part].copy(), down[:, part]
        up[:, part] = 0.5 * (rises + falls)
        down[:, part] = 0.5 * (rises - falls)
    return result


def shares(order: Array, rows: Array, most: int) -> Iterator[Array]:
    """`order`, sorted by rows, cut so that each part has at most so many of them."""
    first = 0
    while first < order.size:
        stop = int(np.searchsorted(rows, rows[first] + most))
        yield order[first:stop]
        first = stop
