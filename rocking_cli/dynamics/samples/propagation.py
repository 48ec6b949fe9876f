"""Exact propagation over samples, proved free of impacts: the lanes that it can take, and how far it reaches (Lemma 11)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..arrays import Arrays

Array = np.ndarray


@dataclass
class ExactLanes(Arrays):
    """Lanes that can be propagated, (lanes,): all that a propagation reads, so that nothing else is copied where some stay behind.

    slot: place in the pool; k, u, y, v, peak as in `Lanes`; may: whether they are not known to be held up; up, down: coefficients of
    exp(tau) and exp(-tau) in y, tau from the first sample that is not before u; drive: the outward drive of s = 1; pace: tau between
    samples; row: where the table of the pace begins; level: of the window that is tried next, at most `top`, which follows from the pace
    alone: no propagation depends on a lane's neighbours.
    """

    slot: Array
    k: Array
    u: Array
    y: Array
    v: Array
    peak: Array
    may: Array
    up: Array
    down: Array
    drive: Array
    pace: Array
    row: Array
    level: Array
    top: Array

    def at(self, n: Array, bounded: Array) -> tuple[Array, Array]:
        """y and v at samples n, of lanes that are at a sample."""
        grown, there = np.exp((n - self.k) * self.pace), bounded.take(self.row + n)
        up, down = self.up * grown, self.down / grown
        return self.drive * there.real + (up + down) + 1.0, self.drive * there.imag + (up - down)


class Propagation(NamedTuple):
    """The propagation of all lanes: samples and state at their ends, the peak with them, 1 - a at the most, and their time [tau]."""

    to: Array
    y: Array
    v: Array
    peak: Array
    fall: Array
    time: Array


def horizon(y: Array, v: Array, least: Array) -> tuple[Array, Array]:
    """Time [tau] for which y + v sinh h + (y - 1 + least)(cosh h - 1) stays positive, and 1 - least."""
    fall = 1.0 - least
    q = y - fall
    grows = q + v
    root = fall * fall
    q -= v
    q *= grows
    root -= q
    np.sqrt(root, out=root)
    root += fall
    root /= -grows  # exp of the time
    never = np.flatnonzero((grows >= 0.0) & ~(root > 1.0))
    time = np.log(np.maximum(root, 1.0, out=root), out=root)
    time[never] = np.inf
    return time, fall
