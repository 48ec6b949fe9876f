"""An arch as a linkage by another hand: links placed by circles that meet, energies
from differences of their places.

Of the package only the rest geometry is taken: hinge points, and mass, first and polar
moments of the links. A link's place follows from its two hinges; M = sum m |c'|^2 + I
r'^2 and the work of the weight and of the ground from the mass centres c and rotations
r, all by eighth-order differences over phi, and the sums kept as Chebyshev series. M
phi'' + M'/2 phi'^2 + (g + z'') Z' + side x'' X' = 0: a sway to the left is the mirror
image.
"""

import math
from typing import Any

import numpy as np
from numpy.polynomial import Chebyshev
from oracles.collocation import Body, Edge

FIRST = {
    1: 4 / 5,
    2: -1 / 5,
    3: 4 / 105,
    4: -1 / 280,
}  # derivatives: weights over the step, +- so many steps off
SECOND = {0: -205 / 72, 1: 8 / 5, 2: -1 / 5, 3: 8 / 315, 4: -1 / 560}


def links_of(linkage: Any) -> tuple[np.ndarray, list[tuple[float, ...]]]:
    """(The four hinges, (4, 2); (mass, first x, first z, polar about 0) of the three
    links) of a linkage of the package, at rest.
    """
    found = []
    for mass, centre, inertia in linkage.masses:
        first = mass * centre
        polar = inertia + mass * abs(centre) ** 2
        found.append((mass, first.real, first.imag, polar))
    return np.array([hinge.at for hinge in linkage.hinges]), found


def places(points: np.ndarray, phi: float) -> np.ndarray:
    """(4, 2): the hinges when the first link has turned by phi towards +x."""
    a, b, c, d = (complex(*p) for p in points)
    moved = a + (b - a) * np.exp(-1j * phi)
    r, s, gap = abs(c - b), abs(d - c), abs(d - moved)
    along = (r * r - s * s + gap * gap) / (2.0 * gap)
    across = math.sqrt(r * r - along * along) * (
        1.0 if ((c - b) / (d - b)).imag > 0.0 else -1.0
    )
    third = moved + (along + 1j * across) * (d - moved) / gap
    return np.array([[z.real, z.imag] for z in (a, moved, third, d)])


def carried(
    points: np.ndarray, masses: list[tuple[float, ...]], phi: float
) -> np.ndarray:
    """(3, 3): x and z of the mass centres and rotations, clockwise, of the links;
    masses: (mass, first x, first z, polar about 0).
    """
    now, found = places(points, phi), []
    for i, (m, x, z, _) in enumerate(masses):
        before, after = (complex(*(p[i + 1] - p[i])) for p in (points, now))
        turn = after / before
        centre = complex(*now[i]) + (complex(x, z) / m - complex(*points[i])) * turn
        found.append([centre.real, centre.imag, -np.angle(turn)])
    return np.array(found)


class Linkage(Body):
    """An arch as `integrate` takes it; most: the largest phi that is followed."""

    def __init__(
        self,
        points: np.ndarray,
        masses: list[tuple[float, ...]],
        most: float,
        gravity: float,
        edge: Edge,
    ) -> None:
        super().__init__(edge, edge, gravity=gravity)
        self.most = most
        mass = np.array([m for m, *_ in masses])
        spin = np.array([polar - (x * x + z * z) / m for m, x, z, polar in masses])

        def sums(phi: float, h: float = 2e-3) -> list[float]:
            slope = sum(
                w
                * (
                    carried(points, masses, phi + i * h)
                    - carried(points, masses, phi - i * h)
                )
                / h
                for i, w in FIRST.items()
            )
            inertia = float(
                (
                    mass * (slope[:, 0] ** 2 + slope[:, 1] ** 2)
                    + spin * slope[:, 2] ** 2
                ).sum()
            )
            return [
                inertia,
                float((mass * slope[:, 1]).sum()),
                float((mass * slope[:, 0]).sum()),
            ]

        nodes = 0.5 * most * (1.0 - np.cos(np.pi * (np.arange(24) + 0.5) / 24))
        values = np.array([sums(phi) for phi in nodes])
        self.inertia, self.lift, self.push = (
            Chebyshev.fit(nodes, v, 23, domain=[0.0, most]) for v in values.T
        )
        self.growth = self.inertia.deriv()

    def acceleration(self, side: int, u: Any, v: Any, across: Any, up: Any) -> Any:
        work = (self.gravity + up) * self.lift(u) + side * across * self.push(u)
        return -(work + 0.5 * self.growth(u) * v**2) / self.inertia(u)

    def far(self, side: int, across: Any, up: Any) -> float:
        return self.most
