"""The nonlinear equation of a mechanism (Eq. 3.4), by Taylor series.

The canonical coordinate q = int sqrt(M) dphi removes the velocity term. With L = V'/g,
F = L/sqrt(M), G = B/sqrt(M), values at rest F0 and G0, y = q p^2/(g F0) and a the
outward drive over lambda g,

    y'' = -F(y)/F0 + a G(y)/G0 - 2 zeta y'

F and G are tabulated once (`patches`), and their series are composed with that of y.
The sign tests of `march.one_turn` need F/G = lambda(phi) to fall from rest on (this is
checked). Where F/G no longer falls, or is below -50 times its value at rest, the
structure has collapsed. A linkage may lock before: its table ends there, and a body
that comes to its end is lost if no drive to come is stronger than the weight.
"""

import math
from collections.abc import Callable
from functools import cached_property
from operator import mul

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from ...arrays import Array
from ...errors import ArgumentError
from ...structures.mechanics.linkage import Linkage
from ..drive import summed
from .equation import Equation, falls_by_energy
from .patches import DEGREE, inverse, largest, tabulate
from .recurrence import Series, TermRows
from .taylor import MOST_TERMS, order_for, powers

_SHIFT = 4  # powers of x used to shift the series of a narrow patch
# intervals of a finer table: within half of one, powers above the 4th are below 1e-13
_MARKS, _NEAR = (2048, 4)
_CHOOSE = np.array(
    [[math.comb(j + k, k) for j in range(MOST_TERMS)] for k in range(_NEAR + 1)],
    dtype=float,
)
# energy beyond a barrier from which overturning is certain, whatever the table's
# interpolation
_MARGIN = 1e-6
_FACTORIALS = np.array([[float(math.factorial(k))] for k in range(DEGREE + 1)])


class MechanismEquation(Equation):
    """The equation of a mechanism of one degree of freedom (Eq. 3.4).

    It is integrated in q = int sqrt(M) d(phi), which has no velocity term.
    `Method("nonlinear").system_of(arch)` makes the system of an arch with it.

    Parameters
    ----------
    mechanism
        the mechanism, such as that of `RockingParameters.mechanism`
    tolerance
        error of phi/alpha that the integration aims at [-]
    damping
        zeta of q [-]

    Raises
    ------
    ArgumentError
        when the mechanism does not stand, when it never becomes unstable, when its
        lambda(phi) does not fall until then, or when the tolerance is not between
        1e-13 and 1e-2

    Examples
    --------
    >>> (arch,) = load_structures("configs/arch.yaml")
    >>> system = System(MechanismEquation(arch.mechanism))
    >>> found = response(system, sine(), 1.5, 6.0, arch.eta)
    >>> f"{float(found.theta_ratio):.6f}"
    '0.101799'
    """

    composed = 12
    rotation_proportional = False

    def __init__(
        self, mechanism: Linkage, tolerance: float = 1e-9, damping: float = 0.0
    ) -> None:
        super().__init__(damping)
        # fewer terms than for a body: cost ~ terms^3; the table has no more of them
        self.order = min(order_for(tolerance, 0.8), MOST_TERMS + 1)
        self.tolerance = tolerance
        self.table = table = tabulate(mechanism)
        self.limit = float(table.edges[-1])
        # y at phi = alpha
        self.top = float(inverse(table, table.turn, np.array([1.0]), self.limit)[0])
        self.barrier = float(table.value(table.work, np.array([self.top]))[0])
        # bound of |df/dy| up to the equilibrium, for drives |a| <= 1
        inner = np.linspace(0.0, self.top, 257)
        self.gain = float(
            sum(np.abs(table.slope(c, inner)).max() for c in (table.lift, table.push))
        )
        turns = table.slope(table.turn, inner)
        self.spread = float(turns.max() / turns.min())
        self.largest_m = largest(table, table.push)
        # y beyond the equilibrium, and the inward drive that has its equilibrium there
        beyond = np.linspace(self.top, self.limit, 4097)
        self.marks = (
            beyond,
            -table.value(table.lift, beyond) / table.value(table.push, beyond),
        )

    def longest(self, terms: Array, fastest: Array) -> Array:
        """As of `Equation`, where y also stays where its patch was fitted."""
        step = super().longest(terms, fastest)
        sizes = powers(step * fastest, len(terms))
        sizes *= terms
        np.abs(sizes, out=sizes)
        room = 0.5 * self.table.half.take(self.table.of(terms[0])[0])
        return step * np.minimum(1.0, room / summed(sizes[1:]))

    def along(
        self, y: Series, new: Callable[[], Series]
    ) -> tuple[Series, Series, Callable[[int], None]]:
        """The series of F and G about the present y, composed with that
        of the motion.
        """
        if isinstance(y, list):
            return _composed_floats(self._about(y[0]), y)
        return composed(self.near(y[0], len(y.array) - 2), y, new)

    def room(self, y: float) -> float:
        """Return the distance from y up to which the series about y hold.

        Parameters
        ----------
        y
            displacement, in the unit of the side

        Returns
        -------
        float
            the distance, in the unit of y
        """
        return 0.5 * float(self.table.half[self.table.of(np.array([y]))[0][0]])

    def _about(self, y: float) -> list[list[float]]:
        """The first terms of F and of G as series about this y."""
        at, x = self.table.of(np.array([y]))
        scale = float(self.table.half[at[0]]) ** np.arange(self.composed)
        rows: list[list[float]] = (
            self._local(at, x, self.composed)[:, :, 0] / scale
        ).tolist()
        return rows

    def near(self, y: Array, count: int) -> Array:
        """Return the series of F and G (Eq. 3.4) in powers of y - y0, shifted from the
        nearest of many marks.

        Parameters
        ----------
        y
            displacements y0, in the unit of the side, (lanes,)
        count
            number of terms

        Returns
        -------
        numpy.ndarray
            terms of F and of G, (2, count, lanes)
        """
        at = np.rint(y * (_MARKS / self.limit)).astype(np.int64)
        np.clip(at, 0, _MARKS, out=at)
        off = y - at * (self.limit / _MARKS)
        rows = self._marked[:, : count + _NEAR].take(at, axis=2)
        total = np.zeros((2, count, y.size))
        for k in range(_NEAR, -1, -1):
            total *= off
            total += _CHOOSE[k, :count, None] * rows[:, k : k + count]
        return total

    @cached_property
    def _marked(self) -> Array:
        """The series of F and G of Eq. 3.4 in powers of y - y0 about equally spaced y0
        up to the limit, (2, terms, y0).
        """
        at, x = self.table.of(np.linspace(0.0, self.limit, _MARKS + 1))
        count = MOST_TERMS + _NEAR
        return (
            self._local(at, x, count) / self.table.half[at] ** np.arange(count)[:, None]
        )

    def _local(self, at: Array, x: Array, count: int) -> Array:
        """The series of F and G of Eq. 3.4 in powers of (y - y0)/half, shifted from the
        centre of the patch that holds y0, (2, count, lanes).
        """
        # NumPy sums a single lane in another order: no digit may depend on a lane's
        # neighbours
        if x.size == 1:
            return self._local(at.repeat(2), x.repeat(2), count)[:, :, :1]
        given = min(count + _SHIFT, DEGREE + 1)
        rows = np.zeros((2, count + _SHIFT, x.size))
        for function, row in zip((self.table.lift, self.table.push), rows, strict=True):
            function[:given].take(at, axis=1, out=row[:given])
            # k! c_k: term k about y0 is the sum over m of term k + m times x^m/m!
            row[:given] *= _FACTORIALS[:given]
        x_m = powers(x, _SHIFT + 1)
        x_m /= _FACTORIALS[: _SHIFT + 1]
        local: Array = np.einsum(
            "ml,fmlk->fkl", x_m, sliding_window_view(rows, count, axis=1)
        )
        local /= _FACTORIALS[:count]
        return local

    def force(self, y: Array, a: Array, weight: Array | float = 1.0) -> Array:
        """The force f = -w F/F0 + a G/G0."""
        return a * self.table.value(self.table.push, y) - weight * self.table.value(
            self.table.lift, y
        )

    def rotation(self, y: Array) -> Array:
        return self.table.value(self.table.turn, y)

    def rotation_rate(self, y: Array, v: Array) -> Array:
        return v * self.table.slope(self.table.turn, y)

    def displacement(self, rotation: Array) -> Array:
        return inverse(self.table, self.table.turn, rotation, self.limit)

    def fall(self, y: Array, v: Array) -> tuple[Array, Array]:
        """The energy is K = v^2/2 + int F/F0 dy, constant between impacts; the barrier
        is at phi = alpha.
        """
        energy = 0.5 * v * v + self.table.value(self.table.work, y)
        return falls_by_energy(v, energy, self.barrier, y > self.top), energy

    def peak(self, energy: Array) -> Array:
        """The y at which the work of the weight equals the energy."""
        return inverse(
            self.table, self.table.work, np.minimum(energy, self.barrier), self.top
        )

    def may_overturn(self, y: Array, v: Array) -> Array:
        return np.asarray((v > 0.0) | (y >= self.limit))

    def certainly_overturns(
        self, y: Array, v: Array, inward: Array, steady: bool = True
    ) -> Array:
        """True if the body moves outwards beyond the barrier of the strongest inward
        drive to come, or with the speed to pass it, or has collapsed. Under a constant
        inward drive e the equilibrium, F/G = -e, is a maximum of int F + e G, since F/G
        falls.
        """
        table = self.table
        certain = y >= self.limit
        self._require_lost(v[certain], inward[certain], steady)
        if self.damped or not steady:  # energy is lost, or the barrier moves
            return certain | (
                (v > 0.0) & (y >= self._equilibrium(inward) * (1.0 + _MARGIN))
            )
        maybe = np.flatnonzero(~certain & (v > 0.0))
        maybe = maybe[
            0.5 * v[maybe] ** 2 + table.value(table.work, y[maybe]) > self.barrier
        ]
        if maybe.size:
            y, e = y[maybe], inward[maybe]
            top = self._equilibrium(e)
            rise = [
                table.value(c, top) - table.value(c, y)
                for c in (table.work, table.thrust)
            ]
            later = self._rise_beyond(e)
            certain[maybe] = ((y >= top) & (later <= 0.0)) | (
                0.5 * v[maybe] ** 2
                > (rise[0] + e * rise[1] + later) * (1.0 + _MARGIN) + _MARGIN
            )
        return certain

    def _rise_beyond(self, inward: Array) -> Array:
        """The energy that a constant inward drive takes from a body between the limit,
        where the links lock, and the collapse; 0 where the weight prevails. Where the
        drive is infinite the ground falls away: there no body stands.
        """
        work, thrust = self.table.beyond
        e = np.where(np.isfinite(inward), inward, 0.0)
        found: Array = (work[:, None] + e * thrust[:, None]).max(axis=0)
        return found

    def _require_lost(self, v: Array, inward: Array, steady: bool) -> None:
        """Raise ArgumentError if an inward drive to come could bring a body back that
        comes to the limit with the speed v.
        """
        if not inward.size:
            return
        rise = self._rise_beyond(inward)
        lost = rise <= 0.0
        if steady and not self.damped:
            lost |= (v > 0.0) & (0.5 * v**2 > rise * (1.0 + _MARGIN) + _MARGIN)
        if not lost.all():
            end = float(self.rotation(np.array([self.limit]))[0])
            raise ArgumentError(
                "the nonlinear model does not hold: the body comes to the rotation of"
                f" {end:.3g} alpha, where its links lock, and a drive of"
                f" {inward[~lost].max():.3g} times that at uplift may still bring it"
                " back; expected a weaker motion, or another body in rotation_of"
            )

    def _equilibrium(self, e: Array) -> Array:
        """The y at which F/G = -e, at most the limit, from a table; at a maximum an
        error of y has an effect of second order only.
        """
        return np.interp(e, self.marks[1], self.marks[0])


def composed(
    local: Array, y: TermRows, new: Callable[[], Series]
) -> tuple[Series, Series, Callable[[int], None]]:
    """The series of F(y) and G(y) along the series of y, as `Equation.along`, for many
    lanes; local: those of F and G in powers of y - y0 about the present y0, (2, terms,
    lanes).
    """
    count = local.shape[1]
    # [j, n]: term n of (y - y0)^j; it is zero for n < j
    power = np.zeros((count, count, y.array.shape[1]))
    found = new(), new()
    for function, series in zip(local, found, strict=True):
        series.append(function[0])

    def extend(n: int) -> None:
        power[1, n] = y[n]
        np.einsum(
            "il,jil->jl",
            power[1, 1:n],
            power[1:n, n - 1 : 0 : -1],
            out=power[2 : n + 1, n],
        )
        for function, series in zip(local, found, strict=True):
            series.append(
                np.einsum("jl,jl->l", function[1 : n + 1], power[1 : n + 1, n])
            )

    return *found, extend


def _composed_floats(
    local: list[list[float]], y: list[float]
) -> tuple[list[float], list[float], Callable[[int], None]]:
    """`along` for one body; local: the series of F and of G about the present y."""
    # [j]: terms j, j + 1 ... of (y - y0)^j
    power: list[list[float]] = [[] for _ in local[0]]
    found = [local[0][0]], [local[1][0]]

    def extend(n: int) -> None:
        for j in range(n, 1, -1):
            power[j].append(sum(map(mul, y[1:], reversed(power[j - 1]))))
        power[1].append(y[n])
        for function, series in zip(local, found, strict=True):
            series.append(sum(function[j] * power[j][-1] for j in range(1, n + 1)))

    return *found, extend
