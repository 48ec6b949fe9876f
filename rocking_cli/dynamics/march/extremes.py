"""The records of what cells ask of the ground, and the search for what breaks them between two instants.

On every stretch the extremes are those of cubics through values and slopes: a stretch is halved until they meet the value in the middle
closely, and left as soon as it cannot beat what its cell has had. An extremum inside a stretch whose cubic has none is the end's own to
what the cubic there leaves out. Where a hull of the forces is known (`hulls`) it says where to look.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, Self

import numpy as np

from .hulls import Crests

Array = np.ndarray

EXACT = 1e-12  # by which a record must be beaten
_NEAR = 1e-6  # difference of a cubic from the function in its middle, from which its extremum is close enough to settle
_HALVINGS = 24
_LOOKS, _RISE = 10, 1e-10  # evaluations on the way to an extremum; what a parabola rises beyond one that is close enough to settle


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

    def search(
        self, cell: Array, along: Along, low: Array, high: Array, one: Course, other: Course, size: Callable[[Array], Array] = np.abs
    ) -> None:
        """Take in stretches from `low` to `high`, whose ends are `one` and `other`; size: of Fx/Fz, what it takes of friction."""
        for end in (one, other):
            self.note(cell, -end.value[0], size(end.value[1]))
        own = np.arange(cell.size)
        ends = np.maximum(one.value, other.value)
        ends[1] = np.maximum(size(one.value[1]), size(other.value[1]))
        most, x, bend = cubic_extremes(one, other, high - low, size)
        with np.errstate(invalid="ignore"):
            doubt = (most - ends) + 0.05 * np.abs(other.value - one.value)  # a cubic's rise is met to much less than itself
        for _ in range(_HALVINGS):
            here = cell[own]
            maybe = most + doubt > np.array([-self.fz_min[here], self.friction[here]]) + EXACT
            near = [np.flatnonzero(maybe[row] & (doubt[row] <= _NEAR)) for row in (0, 1)]
            more = np.flatnonzero(np.any(maybe & (doubt > _NEAR), axis=0))
            length, half = high - low, 0.5 * (low[more] + high[more])
            times = [low[at] + x[row, at] * length[at] for row, at in enumerate(near)]
            looked = np.concatenate([*near, more])
            if not looked.size:
                return
            there = along(own[looked], np.concatenate([*times, half]))  # at once: narrow calls cost as much as wide ones
            marks = np.cumsum([0, *(at.size for at in near)])
            for row, at in enumerate(near):
                settled = there.take(slice(marks[row], marks[row + 1]))
                self._settle(row, here[at], settled.value[row], settled.slope[row], bend[row, at], size)
            if not more.size:
                return
            middle = there.take(slice(marks[2], None))
            own, low, high, one, other = own[more], low[more], high[more], one.take(more), other.take(more)
            self.note(cell[own], -middle.value[0], size(middle.value[1]))
            guess = 0.5 * (one.value + other.value) + 0.125 * (high - low) * (one.slope - other.slope)
            gap = 0.25 * np.abs(middle.value - guess)  # halves of a stretch are met 16 times as closely
            own, doubt = np.tile(own, 2), np.tile(gap, 2)
            low, high = np.concatenate([low, half]), np.concatenate([half, high])
            one, other = one.join(middle), middle.join(other)
            most, x, bend = cubic_extremes(one, other, high - low, size)

    def approach(self, cell: Array, along: Along, length: Array, row: Array, near: Crests) -> Array:
        """Take in the largest -Fz (row 0) or |Fx|/Fz (row 1) of stretches of this length [tau] from where hulls show it, by Newton's
        method; the stretches that do not have it there, by index."""
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
            close = crest & (0.5 * slope * slope <= _RISE * -bend)
            for i in (0, 1):
                at = np.flatnonzero(close & (row == i))
                self._settle(i, cell[own[at]], value[at], sense[at] * slope[at], sense[at] * bend[at], np.abs)
            left[own[~(ends | crest)]] = True
            more = np.flatnonzero(crest & ~close & ~left[own])
            row, own, x_before, slope_before, bend = row[more], own[more], x[more], slope[more], bend[more]
            x = np.clip(x_before - slope_before / bend, 0.0, 1.0)
        left[own] = True
        return np.flatnonzero(left)

    def _settle(self, row: int, cell: Array, value: Array, slope: Array, bend: Array, size: Callable[[Array], Array]) -> None:
        """An extremum nearby, with what a parabola of this second derivative still rises from there: its place then has an error of the
        square of its distance."""
        rise = np.clip(-0.5 * slope**2 / bend, -2.0 * _NEAR, 2.0 * _NEAR)  # no more than the cubic leaves open
        value = value + np.where(bend * (np.sign(value) if row else 1.0) < 0.0, rise, 0.0)
        if row:
            np.maximum.at(self.friction, cell, size(value))
        else:
            np.minimum.at(self.fz_min, cell, -value)


def cubic_extremes(one: Course, other: Course, h: Array, size: Callable[[Array], Array] = np.abs) -> tuple[Array, Array, Array]:
    """(2, stretches): the largest -Fz, and the largest `size` of Fx/Fz, of the cubics through these ends inside stretches of length h, and
    the part of the stretch at which it is, and the second derivative there; minus infinity where they have none."""
    rise = other.value - one.value
    c1, c2, c3 = h * one.slope, 3.0 * rise - h * (2.0 * one.slope + other.slope), h * (one.slope + other.slope) - 2.0 * rise
    most, where = np.full(rise.shape, -np.inf), np.full(rise.shape, 0.5)
    with np.errstate(all="ignore"):
        root = np.sqrt(c2 * c2 - 3.0 * c1 * c3)
        q = -(c2 + np.copysign(root, c2))
        for x in (q / (3.0 * c3), c1 / q):
            value = one.value + x * (c1 + x * (c2 + x * c3))
            value[1] = size(value[1])
            better = (x > 0.0) & (x < 1.0) & (value > most)
            most, where = np.where(better, value, most), np.where(better, x, where)
    return most, where, (2.0 * c2 + 6.0 * c3 * where) / (h * h)
