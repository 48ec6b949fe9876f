"""The records of what cells ask of the ground, and the search for what breaks them between two instants.

Where a hull of the forces is known (`hulls`) it says where to look; elsewhere quartics do (`quartics`).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, Self

import numpy as np

from .hulls import Crests

Array = np.ndarray

EXACT = 1e-12  # by which a record must be beaten
_NEAR = 1e-6  # half of what a parabola may add to a value near an extremum
_LOOKS = 10  # evaluations on the way to an extremum
_BENT = 300.0  # times the way from one of them to the crest of a parabola, as part of the stretch: what part of its bend may be wrong


class Course(NamedTuple):
    """What is followed along a stretch, (2, lanes): -Fz and the outward Fx/Fz, and their slopes by its time."""

    value: Array
    slope: Array

    def take(self, at: Array | slice) -> Self:
        """Of some lanes."""
        return type(self)(self.value[:, at], self.slope[:, at])

    def join(self, other: Self) -> Self:
        """These and others."""
        return type(self)(*(np.concatenate(pair, axis=1) for pair in zip(self, other, strict=True)))


Along = Callable[[Array, Array], Course]  # the course of stretches of these indices, at these times


class Records:
    """The records of cells: friction [-] and fz_min, the least Fz over m g [-]."""

    def __init__(self, cells: int) -> None:
        self.friction, self.fz_min = np.zeros(cells), np.ones(cells)

    def beaten(self, cell: Array, fz: Array, friction: Array) -> Array:
        """Whether a least Fz and a largest |Fx|/Fz that are possible would beat the records of cells."""
        return ~((fz >= self.fz_min[cell] - EXACT) & (friction <= self.friction[cell] + EXACT))

    def note(self, cell: Array, fz: Array, friction: Array) -> None:
        """Values of some instant."""
        np.minimum.at(self.fz_min, cell, fz)
        np.maximum.at(self.friction, cell, np.where(fz > 0.0, friction, np.inf))

    def note_row(self, row: Array, cell: Array, fz: Array, friction: Array) -> None:
        """The same, of -Fz (row 0) or |Fx|/Fz (row 1) alone."""
        one, other = row == 0, row == 1
        np.minimum.at(self.fz_min, cell[one], fz[one])
        np.maximum.at(self.friction, cell[other], np.where(fz[other] > 0.0, friction[other], np.inf))

    def approach(self, cell: Array, along: Along, length: Array, row: Array, near: Crests, within: float) -> Array:
        """Take in the largest -Fz (row 0) or |Fx|/Fz (row 1) of stretches of this length [tau] from where hulls show it, by Newton's
        method, `within` that of it; the stretches that do not have it there, by index."""
        left, own, x, bend = ~near.plain, np.arange(row.size), near.x, near.bend
        x_before, slope_before = np.full((2, own.size), np.nan)
        for _ in range(_LOOKS):
            if not own.size:
                break
            here = along(own, x * length[own])
            self.note_row(row, cell[own], -here.value[0], np.abs(here.value[1]))
            value, slope = (np.where(row == 0, *both) for both in here)
            sense = np.where((row == 1) & (value < 0.0), -1.0, 1.0)
            slope = sense * slope * length[own]
            chord = (slope - slope_before) / (x - x_before)
            bend = np.where(chord < 0.0, chord, bend)
            ends = ((x == 0.0) & (slope <= 0.0)) | ((x == 1.0) & (slope >= 0.0))
            crest = ~ends & (bend < 0.0)
            away = np.abs(slope / bend)
            close = crest & (0.5 * away * np.abs(slope) * np.minimum(_BENT * away, 1.0) <= within)
            for i in (0, 1):
                at = np.flatnonzero(close & (row == i))
                self._settle(i, cell[own[at]], value[at], sense[at] * slope[at], sense[at] * bend[at])
            left[own[~(ends | crest)]] = True
            more = np.flatnonzero(crest & ~close & ~left[own])
            row, own, x_before, slope_before, bend = row[more], own[more], x[more], slope[more], bend[more]
            x = np.clip(x_before - slope_before / bend, 0.0, 1.0)
        left[own] = True
        return np.flatnonzero(left)

    def _settle(self, row: int, cell: Array, value: Array, slope: Array, bend: Array) -> None:
        """An extremum nearby, with what a parabola of this second derivative still rises from there: its place then has an error of the
        square of its distance."""
        rise = np.clip(-0.5 * slope**2 / bend, -2.0 * _NEAR, 2.0 * _NEAR)
        value = value + np.where(bend * (np.sign(value) if row else 1.0) < 0.0, rise, 0.0)
        if row:
            np.maximum.at(self.friction, cell, np.abs(value))
        else:
            np.minimum.at(self.fz_min, cell, -value)
