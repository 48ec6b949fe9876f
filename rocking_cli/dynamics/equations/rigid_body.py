"""The nonlinear equation of a rigid body (Eq. 2.3), by Taylor series. With y = |theta| / sin(alpha), z = alpha - y sin(alpha) and a the
outward drive over g tan(alpha),

    y'' = -sin z / sin(alpha) + a cos z / cos(alpha) - 2 zeta y'

Below the ground tan z > tan alpha, so under a subcritical drive (a < 1) a body that has crossed y = 0 stays below it. Under a supercritical
drive f > 0 for y >= 0. So Lemmas 1 and 2 hold.
"""

import copy
import math
from collections.abc import Callable
from typing import Any, Self

import numpy as np

from ...motions.blocks import blocks
from ...motions.segments import Segments
from ...structures.parameters import LEAST_ALPHA
from ..lanes import Array, Lanes
from .equation import Law, SeriesEquation, falls_by_energy
from .taylor import CACHED, TaylorSeries, drive_series, order_for, ramp_flow, series


class RigidBodyEquation(SeriesEquation):
    """Eq. 2.3 for a rigid body. alpha: critical angle [rad], the two angles (right, left) if the edges differ, or an array with one alpha
    for each cell; tolerance: error of theta/alpha that the integration aims at; damping: zeta [-]. Raises ValueError when an alpha is not
    between 1e-30 and pi/2, the tolerance not between 1e-13 and 1e-2, or the damping negative."""

    alpha: Any
    sin: Any
    cos: Any
    tan: Any
    bottom: Any  # 1 - cos(alpha)
    square: Any  # sin^2(alpha)

    def __init__(self, alpha: float | tuple[float, float] | Array, tolerance: float = 1e-9, damping: float = 0.0) -> None:
        super().__init__(damping)
        self.order, self.tolerance = order_for(tolerance), tolerance
        self._by_cell = isinstance(alpha, np.ndarray)
        kinds, which = np.unique(np.atleast_1d(alpha), return_inverse=True)
        numbers = [_numbers(x) for x in kinds.tolist()]
        # Of the cells, or of the right edge and the left.
        self._each = {key: np.array([x[key] for x in numbers])[which] for key in numbers[0]}
        if not self._by_cell:
            self._each["gain"][:] = self._each["gain"].max()
        for key, x in self._each.items():
            setattr(self, key, x if self._by_cell else float(x[0]))
        self.bounds = 1.0, 1.0 / self.cos

    def _at(self, lanes: Array | slice) -> Self:
        """Return the equation with the numbers at these indices, of cells, of edges or of lanes."""
        there = copy.copy(self)
        there._each = {key: x[lanes] for key, x in self._each.items()}
        for key, x in there._each.items():
            setattr(there, key, x)
        there.bounds = 1.0, 1.0 / there.cos
        return there

    def on(self, side: Array, cell: Array | None = None) -> Self:
        if self._by_cell:
            return self if cell is None else self._at(cell)
        return self if len(self._each["alpha"]) == 1 else self._at((side < 0.0).astype(np.int64))

    def flow(self, segments: Segments, lanes: Lanes) -> TaylorSeries:
        """The series of every lane from its present state."""
        if segments.straight:
            return ramp_flow(self, segments, lanes)
        y, fastest = np.empty((self.order + 1, lanes.y.size)), np.empty(lanes.y.size)
        for block in blocks(lanes.y.size, CACHED):
            own = self if isinstance(self.alpha, float) else self._at(block)
            fastest[block] = own._fill(y[:, block], segments, lanes.take(block))
        return series(y, fastest, self.tolerance, self.damping)

    def _fill(self, y: Array, segments: Segments, lanes: Lanes) -> Array:
        """Fill (order + 1, lanes) with the terms of y; returns the rate [1/tau], so that the terms are in powers of rate h."""
        if lanes.y.size == 1:  # NumPy sums a single lane in another order: no digit may depend on a lane's neighbours
            twice = np.empty((len(y), 2))
            fastest = self._fill(twice, segments, lanes.take(np.zeros(2, dtype=np.int64)))
            y[:] = twice[:, :1]
            return fastest[:1]
        order, known = self.order, drive_series(segments, lanes, self.order - 2, -self.tan)
        unit2 = known.unit * known.unit
        turn = np.empty((order - 1, 2, lanes.y.size))
        rate, both = np.empty_like(y), np.empty_like(turn[0])  # n z_n
        (sin, cos), (by_sin, by_cos) = turn.swapaxes(0, 1), both  # of z
        half = np.tan(0.5 * (self.alpha - self.sin * lanes.y))
        over = 1.0 / (1.0 + half * half)
        sin[0] = 2.0 * half * over
        cos[0] = (1.0 - half * half) * over
        pushed = unit2 * lanes.b * -self.sin  # z'' of the lane: exactly 0 at uplift
        weight, drive = known.parts
        drive[0] = (pushed - (unit2 if weight is None else weight[0]) * sin[0]) / cos[0]
        y[0] = lanes.y
        np.multiply(lanes.v, known.unit, out=y[1])
        np.multiply(y[1], -self.sin, out=rate[1])
        for n in range(order - 1):
            if n:
                np.einsum("il,ijl->jl", rate[1 : n + 1], turn[n - 1 :: -1], out=both)
                np.multiply(by_cos, 1.0 / n, out=sin[n])
                np.multiply(by_sin, -1.0 / n, out=cos[n])
                if weight is None:
                    np.einsum("il,il->l", drive[: n + 1], cos[n::-1], out=pushed)
                    pushed += np.multiply(unit2, sin[n], out=half)
                else:
                    np.einsum("ijl,ijl->l", known.terms[: n + 1], turn[n::-1], out=pushed)
            if self.damping:
                pushed -= 2.0 * self.damping * known.unit * rate[n + 1]
            np.multiply(pushed, 1.0 / (n + 1), out=rate[n + 2])
        np.multiply(rate[2:], 1.0 / (np.arange(2.0, order + 1.0)[:, None] * -self.sin), out=y[2:])
        return known.fastest

    def along(self, y: Array) -> Callable[[int], Array]:
        rows, lanes = len(y) - 2, y.shape[1]
        rate, turn, both = np.empty((rows, lanes)), np.empty((rows, 2, lanes)), np.empty((2, lanes))  # rate: n y_n
        half = np.tan(0.5 * (self.alpha - self.sin * y[0]))
        square = half * half
        over = 1.0 / (1.0 + square)
        turn[0] = half * (2.0 / self.sin) * over, (1.0 - square) * over * (1.0 / self.cos)
        falls, pushes = -self.cos, self.square / self.cos

        def term(n: int) -> Array:
            if n:
                np.multiply(y[n], n, out=rate[n])
                np.einsum("il,ijl->jl", rate[1 : n + 1], turn[n - 1 :: -1], out=both)
                np.multiply(both[1], falls / n, out=turn[n, 0])
                np.multiply(both[0], pushes / n, out=turn[n, 1])
            return turn[n]

        return term

    def law(self, side: float) -> Law:
        """F = sin z/sin(alpha) and G = cos z/cos(alpha), each from the other's earlier terms: n F_n = -cos(alpha) sum i Y_i G_(n-i)."""
        there = self.on(np.array([side]))
        alpha, sin, cos = (float(np.ravel(x)[0]) for x in (there.alpha, there.sin, there.cos))
        numbers = {"alpha": alpha, "sine": sin, "falls": -cos, "pushes": sin * sin / cos, "by_sin": 2.0 / sin, "by_cos": 1.0 / cos}
        start = ("t = tan(0.5*(alpha - sine*y))", "o = 1.0/(1.0 + t*t)", "F0 = by_sin*t*o", "G0 = by_cos*(1.0 - t*t)*o")

        def term(n: int) -> tuple[str, ...]:
            by_g, by_f = (" + ".join(f"R{i}*{other}{n - i}" for i in range(1, n + 1)) for other in "GF")
            return f"R{n} = {float(n)}*Y{n}", f"F{n} = falls*{1.0 / n!r}*({by_g})", f"G{n} = pushes*{1.0 / n!r}*({by_f})"

        return Law("rigid body", start, term, numbers)

    def force(self, y: Array, a: Array, weight: Array | float = 1.0) -> Array:
        """The force f = -w sin z / sin(alpha) + a cos z / cos(alpha)."""
        z = self.alpha - self.sin * y
        return a * np.cos(z) / self.cos - weight * (np.sin(z) / self.sin)

    def fall(self, y: Array, v: Array) -> tuple[Array, Array]:
        """The energy is K = v^2/2 + [cos z - cos(alpha)]/sin^2(alpha), 1/(1 + cos(alpha)) at the barrier."""
        turned = self.sin * y
        energy = 0.5 * v * v + 2.0 * np.sin(self.alpha - 0.5 * turned) * np.sin(0.5 * turned) / self.square
        return falls_by_energy(v, energy, self.barrier, turned > self.alpha), energy

    def peak(self, energy: Array) -> Array:
        """Largest y for an energy up to the barrier: 1 - cos(alpha - y sin(alpha)) = 1 - cos(alpha) - sin^2(alpha) K."""
        left = np.maximum(0.0, self.bottom - self.square * energy)
        return (self.alpha - 2.0 * np.arcsin(np.sqrt(0.5 * left))) / self.sin

    def certainly_overturns(self, y: Array, v: Array, inward: Array, steady: bool = True) -> Array:
        """True if the body moves outwards beyond the barrier of the strongest inward drive to come, or with the speed to pass it, or has
        theta >= pi/2. Under a constant inward e = inward tan(alpha) the equilibrium is at beta = alpha + arctan e and y'' is sqrt(1 + e^2)
        sin(theta - beta) / sin(alpha). While v > 0 the energy over that barrier never falls."""
        e = inward * self.tan
        gap = self.alpha + np.arctan(e) - self.sin * y
        on_its_side = self.sin * y >= 0.5 * math.pi
        if self.damping or not steady:  # energy is lost, or the barrier moves
            return ((v > 0.0) & (gap <= 0.0)) | on_its_side
        half = np.tan(0.5 * gap)
        half *= half
        height = 2.0 / self.square * np.sqrt(1.0 + e * e) * (half / (1.0 + half))  # sin^2 of half the gap
        passes = (v > 0.0) & ((gap <= 0.0) | (0.5 * v * v > height))
        return passes | on_its_side


def _numbers(alpha: float) -> dict[str, float]:
    if not LEAST_ALPHA <= alpha < 0.5 * math.pi:
        raise ValueError(f"alpha: found {alpha:g} rad; expected an angle of a rigid body from {LEAST_ALPHA:g} rad to below 90 deg")
    sin, cos, tan = math.sin(alpha), math.cos(alpha), math.tan(alpha)
    return {
        "alpha": alpha, "sin": sin, "cos": cos, "tan": tan, "bottom": 2.0 * math.sin(0.5 * alpha) ** 2, "square": sin**2,
        "uplift_amplitude": tan / alpha, "limit": 0.5 * math.pi / sin, "barrier": 1.0 / (1.0 + cos),
        "per_y": sin / alpha, "per_rotation": alpha / sin,
        "gain": 1.0 / cos**2,  # (cos z + tan(alpha) sin z) / cos(alpha), for |a| <= 1
    }  # fmt: skip
