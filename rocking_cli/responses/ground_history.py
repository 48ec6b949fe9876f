"""The ground acceleration along a history, piece by piece: a closed form on each piece,
or straight lines.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property, partial, reduce
from itertools import pairwise

import numpy as np

from ..arrays import Array
from ..motions.blocks import blocks
from ..motions.motion import Motion
from ..motions.polyline import Polyline
from .chebyshev import Extent, extent


@dataclass(frozen=True)
class GroundMotion:
    """The motion of the ground over tau."""

    motion: Motion  # over its phase
    amplitude: float  # a_g over g [-]
    omega: float  # phase over tau [rad]

    @property
    def _signals(self) -> tuple[Motion, ...]:
        """The horizontal motion, and the vertical one if there is one."""
        return (
            (self.motion,)
            if self.motion.vertical is None
            else (self.motion, self.motion.vertical)
        )

    @cached_property
    def stops(self) -> Array:
        """The ends of the pieces [tau]."""
        across = self._signals[0]
        stop = (
            across.stop
            if isinstance(across, Polyline)
            else [piece.stop for piece in self.motion.pieces]
        )
        stops = np.array(stop, dtype=float)
        stops /= self.omega
        return stops

    def during(self, inside: Array | float, tau: Array) -> tuple[Array, Array]:
        """Return (xg''/g, zg''/g) at times tau by the closed form of the piece that
        holds the time `inside`, one of each tau or of all.
        """
        k = np.broadcast_to(np.searchsorted(self.stops, inside), tau.shape)
        found = [np.zeros(tau.shape) for _ in range(2)]
        shaken = np.flatnonzero(k < self.stops.size)
        for values, signal in zip(found, self._signals, strict=False):
            if isinstance(signal, Polyline):
                at = k[shaken]
                phase = tau[shaken] * self.omega - signal.start[at]
                values[shaken] = self.amplitude * (
                    signal.constant[at] + signal.slope[at] * phase
                )
            else:
                for piece in np.unique(k[shaken]).tolist():
                    at = np.flatnonzero(k == piece)
                    values[at] = self.amplitude * signal.pieces[piece].value(
                        tau[at] * self.omega
                    )
        return found[0], found[1]

    def at(self, tau: Array) -> tuple[Array, Array]:
        """Return (xg''/g, zg''/g) at times tau; at a jump the values after it."""
        motions = (self.motion, self.motion.vertical)
        across, up = (
            (
                np.zeros(tau.shape)
                if m is None
                else self.amplitude * m.value(tau * self.omega)
            )
            for m in motions
        )
        return across, up

    def extents(
        self, low: float, high: float, across: float = 0.0, down: float = 0.0
    ) -> Iterator[tuple[Extent, Extent]]:
        """Yield the extents on [low, high] of the vertical force over m g, and of the
        ratio of the horizontal one to it, of a body at rest; for straight lines once,
        otherwise for each piece. The ratio means nothing if the vertical force is not
        positive. across, down: what holds the body, over m g, as of `DeviceForces`.
        """
        if (lines := self.lines(low, high, across, down)) is not None:
            yield lines
            return
        first, last = self._between(low, high)
        for a, b in pairwise([low, *self.stops[first:last].tolist(), high]):
            middle = 0.5 * (a + b)
            weight = extent(partial(self._weight, middle, down), a, b)
            yield (
                weight,
                (
                    extent(partial(self._ratio, middle, across, down), a, b)
                    if weight.least > 0.0
                    else weight
                ),
            )

    def _weight(self, inside: float, down: float, tau: Array) -> Array:
        return 1.0 + down + self.during(inside, tau)[1]

    def _ratio(self, inside: float, across: float, down: float, tau: Array) -> Array:
        push = across + self.during(inside, tau)[0]
        return push / self._weight(inside, down, tau)

    def _between(self, low: float, high: float) -> tuple[int, int]:
        """Return the indices of the first piece that ends after `low`, and of the first
        one that does not end before `high`.
        """
        return int(np.searchsorted(self.stops, low, side="right")), int(
            np.searchsorted(self.stops, high)
        )

    def lines(
        self, low: float, high: float, across: float = 0.0, down: float = 0.0
    ) -> tuple[Extent, Extent] | None:
        """Return what `extents` yields for straight lines: the extremes are at the ends
        of lines. None for a motion of other pieces.
        """
        signals = [x for x in self._signals if isinstance(x, Polyline)]
        if len(signals) < len(self._signals):
            return None
        first_signal, *up = signals
        if low >= self.stops[-1]:
            weight, ratio = 1.0 + down, across / (1.0 + down)
            return Extent(weight, low, weight, low), Extent(ratio, low, ratio, low)
        first, last = self._between(low, high)
        found: list[tuple[Extent, Extent]] = []
        for part in blocks(min(last, self.stops.size - 1) + 1 - first):
            k = np.arange(first + part.start, first + part.stop)
            tau = np.array(
                [
                    np.maximum(self.stops[np.maximum(k - 1, 0)], low),
                    np.minimum(self.stops[k], high),
                ]
            )
            tau[0, k == 0] = low
            phase = tau * self.omega - first_signal.start[k]
            push, *rise = (
                self.amplitude * (x.constant[k] + x.slope[k] * phase)
                for x in (first_signal, *up)
            )
            upwards = 1.0 + down + sum(rise, start=np.zeros(tau.shape))
            with np.errstate(divide="ignore", invalid="ignore"):
                ratios = (across + push) / upwards
            found.append((_extent(upwards, tau), _extent(ratios, tau)))
        return reduce(Extent.join, (weight for weight, _ in found)), reduce(
            Extent.join, (ratio for _, ratio in found)
        )


def _extent(values: Array, tau: Array) -> Extent:
    """Return the extent of these values; among equal values the last one counts."""
    least, most = float(values.min()), float(values.max())
    return Extent(
        least,
        float(tau[values == least].max(initial=-np.inf)),
        most,
        float(tau[values == most].max(initial=-np.inf)),
    )
