"""Taylor series of each lane's motion: the flow of the equations that have no closed form.

The equation gives the series term by term; a step is as long as its last terms allow, so the error is controlled without a
rejected step, and the series is the dense output on which impacts and peaks are found.
"""

from __future__ import annotations

import math
from typing import NamedTuple, Self

import numpy as np

from ..motions.motion import Segments
from .flow import Point
from .lanes import Lanes
from .windows import segment_value

Array = np.ndarray

# The error of a step, in y, is this part of the tolerance: rocking doubles an error every 0.7 in tau, and on the cells
# that survive a pulse it grows by a factor of tens.
LOCAL = 1e-2
LOWEST, HIGHEST = 1e-13, 1e-2  # tolerances that are accepted


class Series(NamedTuple):
    """(terms, lanes) coefficients of (h / unit)^n, and how far [tau] they may be used."""

    terms: Array
    unit: Array
    longest: Array
    fastest: Array

    @property
    def y(self) -> Array:
        """Displacement at the start."""
        return self.terms[0]

    @property
    def v(self) -> Array:
        """Velocity at the start."""
        return self.terms[1] / self.unit

    @property
    def b(self) -> Array:
        """Acceleration at the start."""
        return 2.0 * self.terms[2] / self.unit**2

    def take(self, lanes: Array) -> Self:
        """The series of some lanes."""
        return type(self)(self.terms[:, lanes], self.unit[lanes], self.longest[lanes], self.fastest[lanes])

    def at(self, h: Array) -> Point:
        """y and three derivatives after h, by Horner's rule."""
        x = h / self.unit
        y = v = b = j = np.zeros_like(x)
        for c in self.terms[::-1]:
            j = j * x + b
            b = b * x + v
            v = v * x + y
            y = y * x + c
        over = 1.0 / self.unit
        return Point(y, v * over, 2.0 * b * over * over, 6.0 * j * over * over * over)

    def at_ground(self, h: Array) -> Array:
        """y'' at an impact after h."""
        return self.at(h).b


class Drive(NamedTuple):
    """Series of the outward drive, without its first term: (terms, lanes) in powers of h / unit, and that unit."""

    terms: list[Array]
    unit: Array
    fastest: Array


def order_for(tolerance: float) -> int:
    """Terms that make the longest step for its work. Raises ValueError when the tolerance is out of range."""
    if not LOWEST <= tolerance <= HIGHEST:
        raise ValueError(f"tolerance is {tolerance:g}, accepted is a number from {LOWEST:g} to {HIGHEST:g}")
    return max(8, math.ceil(1.0 - 0.5 * math.log(tolerance * LOCAL)))


def drive_series(segments: Segments, lanes: Lanes, order: int) -> Drive:
    """Terms 1 ... order of the drive. The first, the drive now, follows from the acceleration that a lane carries."""
    _, sin, cos = segment_value(segments, lanes.k, lanes.u)
    outward = -lanes.side * lanes.amplitude
    w = segments.frequency[:, lanes.k] * lanes.omega
    fastest = 1.0 + w.max(axis=0, initial=0.0)
    unit = 1.0 / fastest
    turn = [(outward * a, outward * b, f * unit) for a, b, f in zip(sin, cos, w, strict=True)]
    terms = [np.zeros_like(unit)]
    for n in range(1, order + 1):
        turn = [(b * (x / n), -a * (x / n), x) for a, b, x in turn]
        terms.append(sum((a for a, _, _ in turn), np.zeros_like(unit)))
    if segments.sloped:
        terms[1] = terms[1] + outward * segments.slope[lanes.k] * lanes.omega * unit
    return Drive(terms, unit, fastest)


def series(terms: Array, drive: Drive, tolerance: float) -> Series:
    """The series of these terms, with the step that the tolerance allows."""
    # Four terms, since one or two can be small by accident: after a jump from rest the series has even powers only.
    last = np.arange(terms.shape[0] - 4, terms.shape[0])[:, None]
    with np.errstate(divide="ignore"):
        reach = ((LOCAL * tolerance / np.abs(terms[-4:])) ** (1.0 / last)).min(axis=0)
    return Series(terms, drive.unit, np.minimum(reach, 4.0 * drive.fastest) * drive.unit, drive.fastest)
