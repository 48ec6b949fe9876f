"""Lanes of the engine: the state of many rocking bodies, as arrays of one length."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from ...motions.motion import Segments

Array = np.ndarray


@dataclass
class Lanes:
    """One body a lane. The side is stored, never inferred from a sign.

    cell: index of the cell; amplitude: its drive in units of the uplift
    acceleration; omega, eta: its Omega and eta; k, u: position in the motion (segment, phase in
    it); side: +1 or -1; y, v, b: displacement on that side in the model's unit and its two derivatives by tau; peak: largest y at a turning
    point so far; impacts, steps: numbers so far.
    """

    cell: Array
    amplitude: Array
    omega: Array
    eta: Array
    k: Array
    u: Array
    side: Array
    y: Array
    v: Array
    b: Array
    peak: Array
    impacts: Array
    steps: Array

    def take(self, lanes: Array) -> Lanes:
        """Some of the lanes, copied."""
        return Lanes(*(getattr(self, f.name)[lanes] for f in fields(self)))

    def join(self, other: Lanes) -> Lanes:
        """These lanes followed by others."""
        return Lanes(*(np.concatenate([getattr(self, f.name), getattr(other, f.name)]) for f in fields(self)))


def place(segments: Segments, k: Array, u: Array) -> tuple[Array, Array]:
    """The same position with the phase inside its segment; k is the number of segments at the end of the motion."""
    last = len(segments)
    over = np.flatnonzero((k < last) & (u >= segments.length[np.minimum(k, last - 1)]))
    if over.size:
        k, u = k.copy(), u.copy()
    while over.size:
        u[over] -= segments.length[k[over]]
        k[over] += 1
        u[over[k[over] >= last]] = 0.0
        over = over[(k[over] < last)]
        over = over[u[over] >= segments.length[k[over]]]
    return k, u


def phase_between(segments: Segments, k: Array, u: Array, to_k: Array, to_u: Array) -> Array:
    """Phase from one position to a later one, summed over whole segments so that 10^4 cycles lose no digits."""
    phase = to_u - u
    at = k
    behind = np.flatnonzero(at < to_k)
    if behind.size:
        at = at.copy()
    while behind.size:
        phase[behind] += segments.length[at[behind]]
        at[behind] += 1
        behind = behind[at[behind] < to_k[behind]]
    return phase
