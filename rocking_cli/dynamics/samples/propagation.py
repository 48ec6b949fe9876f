"""Exact propagation over samples, proved free of impacts: how far it reaches (Lemma 11)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

Array = np.ndarray


class Propagation(NamedTuple):
    """The propagation of all lanes: y and y' at their ends, the peak with them, 1 - a at the most, and their time [tau]."""

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
