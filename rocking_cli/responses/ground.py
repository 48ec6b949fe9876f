"""How the ground moves along a history: between the ends of its pieces one closed form, or straight lines."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property, reduce
from itertools import pairwise

import numpy as np

from ..motions.blocks import blocks
from ..motions.motion import Motion
from ..motions.polyline import Polyline
from .extremes import Extent

Array = np.ndarray


@dataclass(frozen=True)
class Ground:
    """What shakes: a motion, its amplitude over g [-] and its omega, radians of its phase by tau."""

    motion: Motion
    amplitude: float
    omega: float

    @cached_property
    def stops(self) -> Array:
        """Where pieces end [tau]."""
        stop = self.motion.stop if isinstance(self.motion, Polyline) else [piece.stop for piece in self.motion.pieces]
        return np.asarray(stop) / self.omega

    def along(self, low: float, high: float) -> Callable[[Array], Array]:
        """xg''/g as a function of tau on a stretch in which no piece ends: one closed form, from end to end."""
        return self._of(self.motion, low, high)

    def up_along(self, low: float, high: float) -> Callable[[Array], Array]:
        """The same of zg''/g."""
        return np.zeros_like if self.motion.vertical is None else self._of(self.motion.vertical, low, high)

    def _of(self, motion: Motion, low: float, high: float) -> Callable[[Array], Array]:
        at = int(np.searchsorted(self.stops, 0.5 * (low + high)))
        if at >= self.stops.size:
            return np.zeros_like
        piece = motion.pieces[at]
        return lambda tau: self.amplitude * piece.value(tau * self.omega)

    def at(self, tau: Array) -> tuple[Array, Array]:
        """(xg''/g, zg''/g) at times tau; right-hand values where they jump."""
        motions = (self.motion, self.motion.vertical)
        across, up = (np.zeros(tau.shape) if m is None else self.amplitude * m.value(tau * self.omega) for m in motions)
        return across, up

    def cut(self, low: float, high: float) -> Iterator[tuple[float, float]]:
        """A stretch of time cut where pieces end."""
        first, last = self._between(low, high)
        yield from pairwise([low, *self.stops[first:last].tolist(), high])

    def _between(self, low: float, high: float) -> tuple[int, int]:
        """The first piece that ends after `low`, and the first that does not end before `high`."""
        return int(np.searchsorted(self.stops, low, side="right")), int(np.searchsorted(self.stops, high))

    def lines(self, low: float, high: float) -> Extent | None:
        """The extent of xg''/g on a stretch of straight lines, which is at their ends; None of another motion or with a vertical one."""
        if not isinstance(self.motion, Polyline):
            return None
        if low >= self.stops[-1]:
            return Extent(0.0, low, 0.0, low)
        first, last = self._between(low, high)
        found: list[Extent] = []
        for part in blocks(min(last, self.stops.size - 1) + 1 - first):
            k = np.arange(first + part.start, first + part.stop)
            tau = np.array([np.maximum(self.stops[np.maximum(k - 1, 0)], low), np.minimum(self.stops[k], high)])
            tau[0, k == 0] = low
            phase = tau * self.omega - self.motion.start[k]
            push = (self.amplitude * (self.motion.constant[k] + self.motion.slope[k] * phase)).ravel()
            least, most = (tau.ravel()[push == value].max() for value in (push.min(), push.max()))  # the last of equals
            found.append(Extent(float(push.min()), float(least), float(push.max()), float(most)))
        return reduce(Extent.join, found)
