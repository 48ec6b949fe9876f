"""The bounded response of the linear oscillator to a record.

Of all solutions of Y'' = Y + s the one that stays bounded is the sum of its two modes, each integrated in the direction in which it
decays: Y + Y' = -int_tau^T exp(tau - t) s dt and Y - Y' = -int_0^tau exp(t - tau) s dt. Every motion on one side is then
y = 1 + c Y + up exp(tau) + down exp(-tau), c = -side A: the state at any later sample costs two exponentials, whatever lies between.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from ...motions.blocks import blocks

Array = np.ndarray

_TERMS = 20  # of the series of the weights: the first one left out is below 1e-17 up to `LONGEST`
LONGEST = 0.5  # longest interval between samples [tau] for which lanes are propagated
LONGEST_STRETCH = 24.0  # tau: exp of it stays below 3e10, so that growth cannot bury the state in rounding
_FORGOTTEN = 1e-20  # a mode that has decayed to this part is no longer felt
_STRETCH = 1 << 18  # samples of a long record that are tabled at a time


class BoundedResponse:
    """Y + iY' of several paces at `size` samples from the `first` on: at all of a record, or on one stretch of a long one.

    pace: interval between samples [tau], (paces,), at most `LONGEST`. No digit depends on the stretch.
    """

    def __init__(self, samples: Array, pace: Array) -> None:
        self.samples, self.pace = samples, pace
        self.size = min(samples.size, max(_STRETCH, 1 + int(LONGEST_STRETCH / pace.min())))
        self.first, self.table = samples.size, np.zeros(0, dtype=complex)  # none yet

    @property
    def stop(self) -> int:
        """The first sample after the stretch."""
        return self.first + self.size

    def move(self, first: int) -> None:
        """To the stretch that begins at this sample, or ends with the record."""
        self.table = np.zeros(0, dtype=complex)  # so that one stretch is held at a time
        self.first = min(first, self.samples.size - self.size)
        self.table = bounded_response(self.samples, self.pace, self.first, self.stop).ravel()

    def at(self, row: Array, n: Array) -> Array:
        """At samples n of the stretch; row: `size` times the index of the pace."""
        return self.table.take(row + n - self.first if self.first else row + n)


def bounded_response(samples: Array, pace: Array, first: int = 0, stop: int | None = None) -> Array:
    """Y + iY' at the samples from `first` to before `stop`, (paces, samples); pace: as above."""
    stop = samples.size if stop is None else stop
    all_of_it = -np.expm1(-pace)  # int_0^h exp(-t) dt
    far = np.zeros_like(pace)  # int_0^h exp(-t) t/h dt
    for k in range(_TERMS, -1, -1):
        far = far * -pace + (k + 1.0) / math.factorial(k + 2)
    far *= pace
    near = all_of_it - far
    decays = np.exp(-pace[:, None] * 2.0 ** np.arange((samples.size - 1).bit_length()))  # over 1, 2, 4 ... samples
    result = np.empty((pace.size, stop - first), dtype=complex)
    for row, *weights, decay in zip(result, near.tolist(), far.tolist(), decays, strict=True):
        felt = decay[decay >= _FORGOTTEN].tolist()
        begin, end = max(0, first - (1 << len(felt))), min(samples.size, stop + (1 << len(felt)))
        row.real = _mode(samples, first, end, weights, felt)[: stop - first]
        row.imag = _mode(samples, stop - 1, begin - 1, weights, felt)[: stop - first][::-1]
        for part in blocks(stop - first):
            up, down = row.real[part].copy(), row.imag[part]
            row.real[part] = 0.5 * (up + down)
            row.imag[part] = 0.5 * (up - down)
    return result


def _mode(samples: Array, first: int, stop: int, weights: Sequence[float], decays: Sequence[float]) -> Array:
    """The integral of one mode from each sample to the last of them; they are taken from `first` to before `stop`, backwards too."""
    (near, far), sense = weights, 1 if stop > first else -1
    total = np.zeros(abs(stop - first))
    for part in blocks(total.size - 1):  # in place, part by part: no more than the result itself is held
        s = samples[np.arange(first + sense * part.start, first + sense * (part.stop + 1), sense)]
        total[part] = -(near * s[:-1] + far * s[1:])
    for level, decay in enumerate(decays):
        reach = 1 << level
        for part in blocks(total.size - reach):  # from the front: what comes later has not changed yet
            total[part] += decay * total[part.start + reach : part.stop + reach]
    return total


def shares(order: Array, rows: Array, most: int) -> Iterator[Array]:
    """`order`, sorted by rows, cut so that each part has at most so many of them."""
    first = 0
    while first < order.size:
        stop = int(np.searchsorted(rows, rows[first] + most))
        yield order[first:stop]
        first = stop
