"""Sliding of a rigid body on Coulomb friction, without events: time stepping of the
displacement alone (Moreau), and a block of three degrees of freedom on two corners that
knows neither sticking nor rocking.
"""

import math
from collections.abc import Callable

import numpy as np

G = 9.81
Ground = Callable[[float], tuple[float, float]]  # t -> (x_g'', z_g'') [m/s2]


def moreau(ground: Ground, mu: float, duration: float, steps: int) -> np.ndarray:
    """Return u [m] after each of equal steps: the velocity after a step without
    friction is brought back towards 0 by at most the impulse of friction.
    """
    h, u, v = duration / steps, 0.0, 0.0
    path = np.empty(steps)
    for i in range(steps):
        across, up = ground((i + 0.5) * h)
        free, most = v - h * across, h * mu * max(G + up, 0.0)
        now = math.copysign(max(abs(free) - most, 0.0), free)
        u += 0.5 * h * (v + now)
        v = now
        path[i] = u
    return path


class BlockOnCorners:
    """A rectangular block on two springs with Coulomb friction under its corners."""

    def __init__(self, width: float, height: float, mu: float) -> None:
        self.b, self.h, self.mu = 0.5 * width, 0.5 * height, mu
        self.spin = (self.b**2 + self.h**2) / 3.0  # I/m
        self.stiff, self.damp = 4e7, 8e3  # per unit of mass, of each corner

    def run(self, ground: Ground, duration: float, step: float) -> tuple[float, float]:
        """Return (largest |theta| [rad], displacement of the base at the end [m])."""
        sink = G / (2.0 * self.stiff)
        x, z, theta = 0.0, -sink, 0.0
        vx = vz = spin = most = 0.0
        anchors = [0.0, 0.0]
        for i in range(round(duration / step)):
            across, up = ground((i + 0.5) * step)
            fx, fz, moment = -across, -G - up, 0.0
            cos, sin = math.cos(theta), math.sin(theta)
            for j, side in enumerate((-1.0, 1.0)):
                rx = side * self.b * cos + self.h * sin
                rz = side * self.b * sin - self.h * cos
                depth, rate = -(z + self.h + rz), -(vz + spin * rx)
                slip = x + rx - side * self.b
                if depth <= 0.0:
                    anchors[j] = slip
                    continue
                normal = max(0.0, self.stiff * depth + self.damp * rate)
                pull = -self.stiff * (slip - anchors[j]) - self.damp * (vx - spin * rz)
                if abs(pull) > self.mu * normal:
                    pull = math.copysign(self.mu * normal, pull)
                    anchors[j] = slip + pull / self.stiff
                fx, fz = fx + pull, fz + normal
                moment += rx * normal - rz * pull
            vx, vz = vx + step * fx, vz + step * fz
            spin += step * moment / self.spin
            x, z, theta = x + step * vx, z + step * vz, theta + step * spin
            most = max(most, abs(theta))
        return most, x
