"""The nonlinear equation of a rigid body (Eq. 2.3), by Taylor series. With y = |theta|
/ sin(alpha), z = alpha - y sin(alpha) and a the outward drive over g tan(alpha),

    y'' = -sin z / sin(alpha) + a cos z / cos(alpha) - 2 zeta y'
"""

import math
from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from typing import Any, Self

import numpy as np

from ...arrays import Array
from ...errors import ArgumentError
from ...structures.parameters import LEAST_ALPHA
from .equation import Equation, falls_by_energy
from .recurrence import Series, product_terms
from .taylor import order_for


class RigidBodyEquation(Equation):
    """The equation of a rigid body (Eq. 2.3).

    y = theta/sin(alpha), over tau = p t. `Method("nonlinear").system_of(structure)`
    makes the system of a structure with it.

    Parameters
    ----------
    alpha
        critical angle [rad], the two angles (right, left) if the edges differ, or an
        array with one alpha for each cell, (cells,), or with those of its right edge
        and its left one, (2, cells)
    tolerance
        error of theta/alpha that the integration aims at [-]
    damping
        zeta [-]

    Raises
    ------
    ArgumentError
        when an alpha is not between 1e-30 and pi/2, the tolerance not between 1e-13
        and 1e-2, or the damping negative

    Examples
    --------
    >>> system = System(RigidBodyEquation(0.25, tolerance=1e-10))
    >>> found = response(system, sine(), 1.5, 6.0, 0.9)
    >>> f"{float(found.theta_ratio):.6f}"
    '0.153431'
    """

    cellwise = (
        "_each",
        "alpha",
        "sin",
        "cos",
        "tan",
        "bottom",
        "gain",
        "largest_m",
        "damping",
    )

    alpha: Any  # critical angle [rad], float or (lanes,)
    sin: Any  # sin(alpha) [-]
    cos: Any  # cos(alpha) [-]
    tan: Any  # tan(alpha) [-]
    bottom: Any  # 1 - cos(alpha) [-]
    gain: Any  # as in `Equation` [-]

    def __init__(
        self,
        alpha: float | tuple[float, float] | Array,
        tolerance: float = 1e-9,
        damping: float = 0.0,
    ) -> None:
        super().__init__(damping)
        self.order, self.tolerance = order_for(tolerance), tolerance
        self._by_cell = isinstance(alpha, np.ndarray)
        # number of cells if each has two edges, otherwise 0
        self._two_edged = np.size(alpha) // 2 if np.ndim(alpha) == 2 else 0
        kinds = np.ravel(alpha)
        which = np.arange(kinds.size)
        if kinds.size > 2:  # not the edges of one body
            kinds, which = np.unique(kinds, return_inverse=True)
        numbers = [_numbers(x) | {"damping": damping} for x in kinds.tolist()]
        # Of the cells, or of the right edge and the left; of all right edges first.
        if not numbers:
            raise ArgumentError("alpha: found no angle; expected one or more")
        each = {key: np.array([x[key] for x in numbers])[which] for key in numbers[0]}
        if self._two_edged:
            gain = each["gain"].reshape(2, -1)
            gain[:] = gain.max(axis=0)
        elif not self._by_cell:
            each["gain"][:] = each["gain"].max()
        self._take(
            each,
            each if self._by_cell else {key: float(x[0]) for key, x in each.items()},
        )

    def _take(self, each: dict[str, Array], own: Mapping[str, Any]) -> None:
        self._each = each
        for key, x in own.items():
            setattr(self, key, x)
        self.largest_m = 1.0 / self.cos

    def _with(self, each: dict[str, Array], own: Mapping[str, Any]) -> Self:
        """Return this equation for the numbers `each` of cells, edges or lanes, of
        which it has `own`.
        """
        there = object.__new__(type(self))
        for name in ("damped", "order", "tolerance", "_by_cell", "_two_edged"):
            setattr(there, name, getattr(self, name))
        there._take(each, own)
        return there

    def _at(self, lanes: Array | slice) -> Self:
        """Return the equation for a selection of its numbers (alpha, sin(alpha) ...).
        lanes: indices into the arrays that it has, which are by cell, by edge or by
        lane.
        """
        each = {key: x[lanes] for key, x in self._each.items()}
        return self._with(each, each)

    def on(self, side: Array, cell: Array | None = None) -> Self:
        if self._by_cell:
            if cell is None:
                return self
            return self._at(cell + self._two_edged * (side < 0.0))
        return (
            self
            if len(self._each["alpha"]) == 1
            else self._at((side < 0.0).astype(np.int64))
        )

    def part(self, lanes: slice) -> Self:
        return self if isinstance(self.alpha, float) else self._at(lanes)

    def edge(self, side: float) -> Self:
        each = self.on(np.array([side]))._each
        return self._with(each, {key: float(x[0]) for key, x in each.items()})

    def joined(self, others: Sequence[Self]) -> Self:
        each = {
            key: np.concatenate([one._each[key] for one in (self, *others)])
            for key in self._each
        }
        if all(x.min() == x.max() for x in each.values()):
            return self
        rows = self._with(each, each)
        rows._by_cell = True
        return rows

    def of_each_cell(self, equations: Sequence[Self], counts: Sequence[int]) -> Self:
        # (bodies, edges) of each number, then all right edges before all left ones
        numbers = {
            key: np.array([one._each[key] for one in equations]) for key in self._each
        }
        if all(np.all(x == x[0]) for x in numbers.values()):
            return self
        each = {
            key: np.repeat(x, counts, axis=0).T.ravel() for key, x in numbers.items()
        }
        cells = self._with(each, each)
        cells._by_cell = True
        edges = len(self._each["alpha"])
        cells._two_edged = each["alpha"].size // edges * (edges - 1)
        return cells

    @cached_property
    def square(self) -> Any:
        """sin^2(alpha)."""
        return self.sin * self.sin

    @cached_property
    def uplift_amplitude(self) -> Any:
        return self.tan / self.alpha

    @cached_property
    def limit(self) -> Any:
        return 0.5 * math.pi / self.sin

    @cached_property
    def barrier(self) -> Any:
        return 1.0 / (1.0 + self.cos)

    @cached_property
    def per_y(self) -> Any:
        return self.sin / self.alpha

    @cached_property
    def per_rotation(self) -> Any:
        return self.alpha / self.sin

    def along(
        self, y: Series, new: Callable[[], Series]
    ) -> tuple[Series, Series, Callable[[int], None]]:
        """F = sin z/sin(alpha) and G = cos z/cos(alpha), each from the other's earlier
        terms: n F_n = -cos(alpha) sum i Y_i G_(n-i).
        """
        tan = math.tan if isinstance(y[0], float) else np.tan
        half = tan(0.5 * (self.alpha - self.sin * y[0]))
        square = half * half
        over = 1.0 / (1.0 + square)
        lift, push, rate = new(), new(), new()  # rate: n Y_n, from n = 1 on
        lift.append(half * (2.0 / self.sin) * over)
        push.append((1.0 - square) * over * (1.0 / self.cos))
        falls, pushes = -self.cos, self.square / self.cos

        def extend(n: int) -> None:
            rate.append(n * y[n])
            by_push, by_lift = product_terms(rate, push, lift)
            by_push *= falls / n
            by_lift *= pushes / n
            lift.append(by_push)
            push.append(by_lift)

        return lift, push, extend

    def force(self, y: Array, a: Array, weight: Array | float = 1.0) -> Array:
        """The force f = -w sin z / sin(alpha) + a cos z / cos(alpha)."""
        z = self.alpha - self.sin * y
        return a * np.cos(z) / self.cos - weight * (np.sin(z) / self.sin)

    def slope(self, y: Array | float, force: Array | float) -> Array | float:
        """df/dy, with the drive by the force: (1 + f sin(alpha) sin z)/cos z."""
        z = self.alpha - self.sin * y
        if isinstance(z, float):
            return (1.0 + force * self.sin * math.sin(z)) / math.cos(z)
        return np.asarray((1.0 + force * self.sin * np.sin(z)) / np.cos(z))

    def fall(self, y: Array, v: Array) -> tuple[Array, Array]:
        """The energy is K = v^2/2 + [cos z - cos(alpha)]/sin^2(alpha), 1/(1 +
        cos(alpha)) at the barrier.
        """
        turned = self.sin * y
        energy = (
            0.5 * v * v
            + 2.0
            * np.sin(self.alpha - 0.5 * turned)
            * np.sin(0.5 * turned)
            / self.square
        )
        return falls_by_energy(v, energy, self.barrier, turned > self.alpha), energy

    def peak(self, energy: Array) -> Array:
        """Largest y for an energy up to the barrier: 1 - cos(alpha - y sin(alpha)) = 1
        - cos(alpha) - sin^2(alpha) K.
        """
        left = np.maximum(0.0, self.bottom - self.square * energy)
        return (self.alpha - 2.0 * np.arcsin(np.sqrt(0.5 * left))) / self.sin

    def certainly_overturns(
        self, y: Array, v: Array, inward: Array, steady: bool = True
    ) -> Array:
        """True if the body moves outwards beyond the barrier of the strongest inward
        drive to come, or with the speed to pass it, or has theta >= pi/2. Under a
        constant inward e = inward tan(alpha) the equilibrium is at beta = alpha +
        arctan e and y'' is sqrt(1 + e^2) sin(theta - beta) / sin(alpha). While v > 0
        the energy over that barrier never falls.
        """
        e = inward * self.tan
        gap = self.alpha + np.arctan(e) - self.sin * y
        on_its_side = self.sin * y >= 0.5 * math.pi
        if self.damped or not steady:  # energy is lost, or the barrier moves
            return ((v > 0.0) & (gap <= 0.0)) | on_its_side
        half = np.tan(0.5 * gap)
        half *= half
        # sin^2 of half the gap
        height = 2.0 / self.square * np.sqrt(1.0 + e * e) * (half / (1.0 + half))
        passes = (v > 0.0) & ((gap <= 0.0) | (0.5 * v * v > height))
        return passes | on_its_side


def _numbers(alpha: float) -> dict[str, float]:
    """Return the numbers of an edge with this critical angle [rad]. Raises
    ArgumentError for an angle that no rigid body has.
    """
    if not LEAST_ALPHA <= alpha < 0.5 * math.pi:
        raise ArgumentError(
            f"alpha: found {alpha:g} rad; expected an angle of a rigid body from"
            f" {LEAST_ALPHA:g} rad to below 90 deg"
        )
    cos = math.cos(alpha)
    gain = 1.0 / cos**2  # (cos z + tan(alpha) sin z) / cos(alpha), for |a| <= 1
    bottom = 2.0 * math.sin(0.5 * alpha) ** 2
    return {
        "alpha": alpha,
        "sin": math.sin(alpha),
        "cos": cos,
        "tan": math.tan(alpha),
        "bottom": bottom,
        "gain": gain,
    }
