"""The bounded response of the linear oscillator to a record.

Of all solutions of Y'' = Y + s the one that stays bounded is the sum of its two modes, each integrated in the direction in which it
decays: Y + Y' = -int_tau^T exp(tau - t) s dt and Y - Y' = -int_0^tau exp(t - tau) s dt. Every motion on one side is then
y = 1 + c Y + up exp(tau) + down exp(-tau), c = -side A: the state at any later sample costs two exponentials, whatever lies between.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

Array = np.ndarray

_TERMS = 20  # of the series of the weights: the first one left out is below 1e-17 up to `stepper.LONGEST`
LONGEST_STRETCH = 24.0  # tau: exp of it stays below 3e10, so that growth cannot bury the state in rounding
_FORGOTTEN = 1e-20  # a mode that has decayed to this part is no longer felt


def bounded_response(samples: Array, pace: Array) -> Array:
    """Y + iY' at the samples, (paces, samples); pace: interval between samples [tau], (paces,), at most `stepper.LONGEST`."""
    all_of_it = -np.expm1(-pace)  # int_0^h exp(-t) dt
    far = np.zeros_like(pace)  # int_0^h exp(-t) t/h dt
    for k in range(_TERMS, -1, -1):
        far = far * -pace + (k + 1.0) / math.factorial(k + 2)
    far *= pace
    near = all_of_it - far
    decays = np.exp(-pace[:, None] * 2.0 ** np.arange((samples.size - 1).bit_length()))  # over 1, 2, 4 ... samples
    result = np.empty((pace.size, samples.size), dtype=complex)
    for row, *weights, decay in zip(result, near.tolist(), far.tolist(), decays, strict=True):
        felt = decay[decay >= _FORGOTTEN].tolist()
        up, down = _mode(samples, weights, felt), _mode(samples[::-1], weights, felt)[::-1]
        row.real, row.imag = 0.5 * (up + down), 0.5 * (up - down)
    return result


def _mode(samples: Array, weights: Sequence[float], decays: Sequence[float]) -> Array:
    """The integral of one mode from each sample to the last of them."""
    near, far = weights
    total = np.append(-(near * samples[:-1] + far * samples[1:]), 0.0)
    for level, decay in enumerate(decays):
        reach = 1 << level
        total[:-reach] += decay * total[reach:]
    return total
