"""One exact piece of a motion: a constant, a slope and sinusoids of the phase phi [rad].

s(phi) = c0 + c1 (phi - start) + sum_j C_j sin(w_j phi + f_j)
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np


@dataclass(frozen=True)
class Harmonic:
    """A sinusoid C sin(w phi + f): amplitude C [-], frequency w [multiples of omega_g], phase f [rad]."""

    amplitude: float
    frequency: float = 1.0
    phase: float = 0.0


@dataclass(frozen=True)
class Piece:
    """One piece of a motion between two phases [rad]: harmonics, constant c0 [-], slope c1 [1/rad]."""

    start: float
    stop: float
    harmonics: tuple[Harmonic, ...] = ()
    constant: float = 0.0
    slope: float = 0.0

    def value(self, phase: np.ndarray | float) -> np.ndarray:
        """s(phase) [-], shape of `phase`."""
        phase = np.asarray(phase, dtype=float)
        total = self.constant + self.slope * (phase - self.start)
        for h in self.harmonics:
            total = total + h.amplitude * np.sin(h.frequency * phase + h.phase)
        return np.asarray(total)

    def scaled(self, factor: float) -> Piece:
        """The piece times a factor."""
        harmonics = tuple(replace(h, amplitude=factor * h.amplitude) for h in self.harmonics)
        return Piece(self.start, self.stop, harmonics, factor * self.constant, factor * self.slope)


def plus(a: Piece, b: Piece) -> Piece:
    """The sum of two pieces; sinusoids of equal frequency become one."""
    waves: dict[float, complex] = {}
    for h in (*a.harmonics, *b.harmonics):
        waves[h.frequency] = waves.get(h.frequency, 0.0) + h.amplitude * np.exp(1j * h.phase)
    harmonics = tuple(Harmonic(float(abs(c)), w, float(np.angle(c))) for w, c in waves.items())
    return Piece(a.start, a.stop, harmonics, a.constant + b.constant, a.slope + b.slope)


class Near(NamedTuple):
    """s - s_start and its first two derivatives by phase, (lanes,)."""

    change: np.ndarray
    rate: np.ndarray
    bend: np.ndarray
