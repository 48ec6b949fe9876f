"""The nonlinear equation of a rigid body (Eq. 2.3), by Taylor series.

With y = |theta| / sin(alpha), z = alpha - y sin(alpha) and a the outward drive over g tan(alpha),

    y'' = -sin z / sin(alpha) + a cos z / cos(alpha)

The series of y, sin z and cos z follow from each other term by term; the drive's are known. A step is as long as the last
terms allow, so the error is controlled without a rejected step; and the series is the dense output on which impacts
and peaks are found. In a valley of the drive (a < 1) tan z > tan alpha below the ground, so that a body which has crossed
y = 0 stays below it, and in a ridge y'' > 0 for y >= 0: the sign tests of `windows` hold as they stand.
"""

from __future__ import annotations

import math
from typing import NamedTuple, Self

import numpy as np

from ..motions.motion import Motion, Segments
from .engine import Response, response
from .flow import Point
from .free import Fate
from .lanes import Lanes
from .windows import segment_value

Array = np.ndarray

# The error of a step, in y, is this part of the tolerance: rocking doubles an error every 0.7 in tau, and on the cells
# that survive a pulse it grows by a factor of tens.
LOCAL = 1e-2
POOL = 4096  # lanes: a series of 18 terms for each stays in the second-level cache


class Series(NamedTuple):
    """Taylor series of each lane's motion: (terms, lanes) coefficients of (h / unit)^n, and how far they may be used."""

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


class RigidModel:
    """Eq. 2.3 for a body of critical angle alpha [rad]; tolerance: error of theta/alpha that is aimed at.

    Raises ValueError when alpha is not between 0 and pi/2 or the tolerance not between 1e-13 and 1e-2.
    """

    def __init__(self, alpha: float, tolerance: float = 1e-9) -> None:
        if not 0.0 < alpha < 0.5 * math.pi:
            raise ValueError(f"alpha is {alpha:g} rad, accepted for a rigid body is an angle between 0 and 90 deg")
        if not 1e-13 <= tolerance <= 1e-2:
            raise ValueError(f"tolerance is {tolerance:g}, accepted is a number from 1e-13 to 1e-2")
        self.alpha, self.tolerance = alpha, tolerance
        self.sin, self.cos, self.tan = math.sin(alpha), math.cos(alpha), math.tan(alpha)
        self.ratio = self.sin / alpha
        self.gain = 1.0 / self.cos**2  # of -l + a m near the ground, for |a| <= 1: (cos z + tan(alpha) sin z) / cos(alpha)
        self.order = max(8, math.ceil(1.0 - 0.5 * math.log(tolerance * LOCAL)))

    def flow(self, segments: Segments, lanes: Lanes) -> Series:
        """The series of every lane from its present state."""
        _, sin, cos = segment_value(segments, lanes.k, lanes.u)
        outward = -lanes.side * lanes.amplitude
        w = segments.frequency[:, lanes.k] * lanes.omega
        fastest = 1.0 + w.max(axis=0, initial=0.0)
        unit = 1.0 / fastest
        z = self.alpha - self.sin * lanes.y
        s, c = [np.sin(z)], [np.cos(z)]
        # The drive now, from the acceleration that the lane carries: at uplift it is 1 to the last bit.
        drive = [(lanes.b + s[0] / self.sin) * self.cos / c[0]]
        ramp = outward * segments.slope[lanes.k] * lanes.omega * unit
        turn = [(outward * a, outward * b, f * unit) for a, b, f in zip(sin, cos, w, strict=True)]
        y = [lanes.y, lanes.v * unit]
        k, unit2 = self.sin, unit * unit
        rate = [np.zeros_like(z)]  # n y_n, for the recurrences of sin z and cos z
        for n in range(self.order - 1):
            if n:
                rate.append(n * y[n])
                change_s, change_c = rate[n] * c[0], rate[n] * s[0]
                for i in range(1, n):
                    change_s = change_s + rate[i] * c[n - i]
                    change_c = change_c + rate[i] * s[n - i]
                s.append(change_s * (-k / n))
                c.append(change_c * (k / n))
                turn = [(b * (x / n), -a * (x / n), x) for a, b, x in turn]
                drive.append(sum((a for a, _, _ in turn), np.zeros_like(z)) + (ramp if n == 1 else 0.0))
            pushed = drive[0] * c[n]
            for i in range(1, n + 1):
                pushed = pushed + drive[i] * c[n - i]
            y.append(unit2 * (pushed / self.cos - s[n] / self.sin) / ((n + 1) * (n + 2)))
        terms = np.array(y)
        # Four terms, since one or two can be small by accident: after a jump from rest the series has even powers only.
        last = np.arange(terms.shape[0] - 4, terms.shape[0])[:, None]
        with np.errstate(divide="ignore"):
            reach = ((LOCAL * self.tolerance / np.abs(terms[-4:])) ** (1.0 / last)).min(axis=0)
        return Series(terms, unit, np.minimum(reach, 4.0 * fastest) * unit, fastest)

    def acceleration(self, y: Array, a: Array) -> Array:
        """-sin z / sin(alpha) + a cos z / cos(alpha)."""
        z = self.alpha - self.sin * y
        return a * np.cos(z) / self.cos - np.sin(z) / self.sin

    def fate(self, y: Array, v: Array, eta: Array) -> Fate:
        """Energy is constant between impacts: K = v^2/2 + [cos z - cos(alpha)]/sin^2(alpha), the barrier K = 1/(1 + cos(alpha))."""
        barrier = 1.0 / (1.0 + self.cos)
        turned = self.sin * y
        energy = 0.5 * v * v + 2.0 * np.sin(self.alpha - 0.5 * turned) * np.sin(0.5 * turned) / self.sin**2
        beyond = turned > self.alpha
        overturns = np.where(beyond, (v >= 0.0) | (energy < barrier), (v > 0.0) & (energy > barrier))
        rebound = eta * eta * energy
        after = ~overturns & (rebound > barrier)
        outward = np.where((v > 0.0) & ~overturns, self._crest(energy), y)
        return Fate(overturns, after, np.where(overturns | after, np.nan, np.maximum(outward, self._crest(rebound))))

    def _crest(self, energy: Array) -> Array:
        """Largest y for an energy up to the barrier: 1 - cos(alpha - y sin(alpha)) = 1 - cos(alpha) - sin^2(alpha) K."""
        left = np.maximum(0.0, (1.0 - self.cos) - self.sin**2 * energy)
        return (self.alpha - 2.0 * np.arcsin(np.sqrt(0.5 * left))) / self.sin

    def certainly_overturns(self, y: Array, v: Array, inward: Array) -> Array:
        """Beyond the barrier of the strongest inward drive that is still to come, or with the speed to pass it.

        Under a constant inward e = inward tan(alpha) the equilibrium is at beta = alpha + arctan e and y'' is
        sqrt(1 + e^2) sin(theta - beta) / sin(alpha); a weaker drive pushes back less. While v > 0 the energy over that barrier
        never falls, so a body that passes it goes on. On its side (theta = pi/2) a body has overturned.
        """
        e = inward * self.tan
        gap = self.alpha + np.arctan(e) - self.sin * y
        height = 2.0 * np.sqrt(1.0 + e * e) * np.sin(0.5 * gap) ** 2 / self.sin**2
        passes = (v > 0.0) & ((gap <= 0.0) | (0.5 * v * v > height))
        return passes | (self.sin * y >= 0.5 * math.pi)


def nonlinear_response(
    motion: Motion, amplitude: Array, omega: Array, eta: Array | float, alpha: float, *, tolerance: float = 1e-9, peaks: bool = True
) -> Response:
    """Largest rotation and outcome of rigid bodies of one critical angle under one motion (Eqs. 2.3, 2.6).

    Parameters: amplitude A = a_g / (alpha g) [-], omega Omega = omega_g / p [-] and eta [-] as in `linear_response`; alpha
    [rad]; tolerance: of theta/alpha. theta_ratio is max |theta|/alpha. Raises ValueError when a number is out of range.
    """
    model = RigidModel(alpha, tolerance)
    return response(model, motion, np.asarray(amplitude) * (alpha / model.tan), omega, eta, peaks=peaks, pool=POOL)
