"""The nonlinear equation of a mechanism (Eq. 3.4), by Taylor series.

In the canonical coordinate q = int sqrt(M) dphi the velocity term is gone. With L = V'/g, F = L/sqrt(M), G = B/sqrt(M), values at
rest F0 and G0, y = q p^2/(g F0) and a the outward drive over lambda g,

    y'' = -F(y)/F0 + a G(y)/G0 - 2 zeta y'

F and G are tabulated once, as power series in y about the centres of patches that are short against the distance to the
linkage's nearest lock-up; a step composes the local series with that of y. F/G = lambda(phi) falls all the way (checked), which is what
the sign tests of `windows` ask; where it no longer falls, or has come to -50 times its value at rest, the structure has collapsed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Self

import numpy as np

from ...motions.motion import Segments
from ...structures.kinematics import Mechanism, linearise
from ..lanes import Lanes
from ..weight import WeighedSegments
from .energy import falls_by_energy
from .equation import Ramp
from .ramp import MOST_TERMS, ramp_flow
from .taylor import TaylorSeries, blocks, drive_series, order_for, series, weighed_series

Array = np.ndarray

DEGREE = 28  # of a patch's series
_COLLAPSED = -50.0  # lambda(phi) / lambda(0): no drive below 50 times the uplift's brings the structure back from there
_WIDEN = 2.0  # a patch's series is fitted on this times its width
_TOGETHER = 3  # powers of the series that are raised in one sum
_MARKS, _NEAR = 2048, 4  # marks of a finer table: within half their distance powers above the 4th are below 1e-13
_CHOOSE = np.array([[math.comb(j + k, k) for j in range(MOST_TERMS)] for k in range(_NEAR + 1)], dtype=float)
_MARGIN = 1e-6  # energy beyond a barrier from which overturning is certain, whatever the table's interpolation
# A Chebyshev coefficient below this is rounding: values are of order one, and come from the linkage to 1e-14, or to 1e-15 over
# lambda where that is small, since V' is then a small difference.
_SMALL = 3e-14


@dataclass(frozen=True)
class Patches:
    """Functions of y by patches: edges (patches + 1), centre, half (width fitted), and (degree + 1, patches) coefficients.

    Coefficients are of powers of (y - centre) / half. lift F/F0, push G/G0, turn phi/alpha; work and thrust: int lift dy and
    int push dy from 0.
    """

    edges: Array
    centre: Array
    half: Array
    lift: Array
    push: Array
    turn: Array
    work: Array
    thrust: Array

    def of(self, y: Array) -> tuple[Array, Array]:
        """(patch, argument of its series) of each displacement."""
        at = np.clip(np.searchsorted(self.edges, y, side="right") - 1, 0, self.centre.size - 1)
        return at, (y - self.centre[at]) / self.half[at]

    def value(self, coefficients: Array, y: Array) -> Array:
        """A tabulated function at y."""
        at, x = self.of(y)
        total = np.zeros_like(x)
        for row in coefficients[::-1]:
            total *= x
            total += row.take(at)
        return total

    def slope(self, coefficients: Array, y: Array) -> Array:
        """Its derivative."""
        at, x = self.of(y)
        total = np.zeros_like(x)
        for n in range(len(coefficients) - 1, 0, -1):
            total = total * x + n * coefficients[n][at]
        return total / self.half[at]


class MechanismEquation:
    """Eq. 3.4 for one mechanism; tolerance: error of phi/alpha that is aimed at; damping: zeta [-], of q.

    Raises ValueError when the mechanism does not stand or never becomes unstable, when its lambda(phi) does not fall on the
    way there, or when the tolerance is not between 1e-13 and 1e-2.
    """

    pool = 4096  # lanes: the powers of a series of 20 terms take 400 numbers a lane
    uplift_amplitude = 1.0
    bounded = False

    def __init__(self, mechanism: Mechanism, tolerance: float = 1e-9, damping: float = 0.0) -> None:
        if not 0.0 <= damping < np.inf:
            raise ValueError(f"damping is {damping:g}, accepted is a number from 0")
        self.damping = damping
        self.order, self.tolerance = order_for(tolerance, 0.8), tolerance  # fewer terms than for a body: they cost their third power
        self.table = tabulate(mechanism)
        table = self.table
        self.limit = float(table.edges[-1])
        self.top = float(_inverse(table, table.turn, np.array([1.0]), self.limit)[0])  # y at phi = alpha
        self.barrier = float(table.value(table.work, np.array([self.top]))[0])
        inner = np.linspace(0.0, self.top, 257)
        rates = (np.abs(table.slope(c, inner)) for c in (table.lift, table.push))
        self.gain = float(sum(r.max() for r in rates))
        self.bounds = _largest(table, table.lift), _largest(table, table.push)
        beyond = np.linspace(self.top, self.limit, 4097)
        self.marks = beyond, -table.value(table.lift, beyond) / table.value(table.push, beyond)

    def on(self, side: Array) -> Self:
        """An arch and its mirror image rock alike."""
        return self

    def flow(self, segments: Segments, lanes: Lanes) -> TaylorSeries:
        """The series of every lane: those of F and G about its y, composed with the series of y."""
        if not segments.harmonics and not isinstance(segments, WeighedSegments):
            return ramp_flow(self, segments, lanes)
        y, fastest = np.empty((self.order + 1, lanes.y.size)), np.empty(lanes.y.size)
        for block in blocks(lanes.y.size):
            fastest[block] = self._fill(y[:, block], segments, lanes.take(block))
        return series(y, fastest, self.tolerance, self.damping)

    def _fill(self, y: Array, segments: Segments, lanes: Lanes) -> Array:
        """Fill (order + 1, lanes) with the terms of y; returns the rate in whose powers they are."""
        count = self.order - 1
        weight: Array | None = None
        if isinstance(segments, WeighedSegments):
            known, weight = weighed_series(segments, lanes, count)
        else:
            known = drive_series(segments, lanes, count)
        table = self.table
        at, x = table.of(lanes.y)
        lift, push = self._local(at, x, count)
        drive = known.terms
        drive[0] = (lanes.b + (lift[0] if weight is None else weight[0] * lift[0])) / push[0]
        unit2 = known.unit * known.unit
        drive *= unit2
        lift *= unit2
        over = 1.0 / table.half[at]
        y[0] = lanes.y
        np.multiply(lanes.v, known.unit, out=y[1])
        self._compose(y, over, lift, push, drive, known.unit, weight)
        return known.fastest

    def _compose(self, y: Array, over: Array, lift: Array, push: Array, drive: Array, unit: Array, weight: Array | None) -> None:
        """Terms 2 ... of y: those of F and G along the motion follow from powers of y - y0; weight: its terms where it varies."""
        count, lanes = len(y) - 2, y.shape[1]
        power = np.zeros((count, count, lanes))  # [j, n]: term n of ((y - y0) / half)^j
        pushes = np.empty(drive.shape)  # G along the motion
        pushes[0], fallen = push[0], lift[0]
        lifts = np.empty_like(drive)  # F along the motion, where the weight varies
        for n in range(count):
            if n:
                np.multiply(y[n], over, out=power[1, n])
                for j in range(1, n, _TOGETHER):  # term m of power j is zero for m < j
                    last = min(n, j + _TOGETHER)
                    np.einsum("il,jil->jl", power[1, 1 : n - j + 1], power[j:last, n - 1 : j - 1 : -1], out=power[j + 1 : last + 1, n])
                here = power[1 : n + 1, n]
                fallen = np.einsum("jl,jl->l", lift[1 : n + 1], here)
                np.einsum("jl,jl->l", push[1 : n + 1], here, out=pushes[n])
            if weight is not None:
                lifts[n] = fallen
                fallen = np.einsum("il,il->l", weight[: n + 1], lifts[n::-1])
            pushed = np.einsum("il,il->l", drive[: n + 1], pushes[n::-1])
            pushed -= fallen
            if self.damping:
                pushed -= (2.0 * self.damping * (n + 1)) * unit * y[n + 1]
            np.multiply(pushed, 1.0 / ((n + 1) * (n + 2)), out=y[n + 2])

    def ramp_terms(self, y: Array, v: Array, ramp: Ramp) -> Array:
        """Terms of y under a straight line: those of F and G about each y, composed with the series of y."""
        count, lanes = len(ramp.factors), y.size
        lift, push = self._beside(y, count)
        drag = 2.0 * self.damping / ramp.unit
        terms = np.empty((count + 2, lanes))
        terms[0] = y
        np.multiply(v, ramp.unit, out=terms[1])
        power = np.zeros((count, count, lanes))  # [j, n]: term n of (y - y0)^j
        pushes, fallen = np.empty((count, lanes)), lift[0]
        pushes[0] = push[0]
        for n in range(count):
            if n:
                power[1, n] = terms[n]
                for j in range(1, n, _TOGETHER):  # term m of power j is zero for m < j
                    last = min(n, j + _TOGETHER)
                    np.einsum("il,jil->jl", power[1, 1 : n - j + 1], power[j:last, n - 1 : j - 1 : -1], out=power[j + 1 : last + 1, n])
                here = power[1 : n + 1, n]
                fallen = np.einsum("jl,jl->l", lift[1 : n + 1], here)
                np.einsum("jl,jl->l", push[1 : n + 1], here, out=pushes[n])
            pushed = np.multiply(ramp.drive, pushes[n], out=terms[n + 2])
            if n:
                pushed += ramp.gain * pushes[n - 1]
            pushed -= fallen
            if not n and ramp.force is not None:
                pushed[:] = ramp.force
            if self.damping:
                pushed -= drag * ((n + 1) * terms[n + 1])
            pushed *= ramp.factors[n]
        return terms

    def _beside(self, y: Array, count: int) -> Array:
        """(2, count, lanes): the series of F and G in powers of y - y0, from those about the nearest of many marks."""
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
        """(2, terms, marks): the series of F and G in powers of y about equal marks up to the limit."""
        at, x = self.table.of(np.linspace(0.0, self.limit, _MARKS + 1))
        count = MOST_TERMS + _NEAR
        return self._local(at, x, count) / self.table.half[at] ** np.arange(count)[:, None]

    def _local(self, at: Array, x: Array, count: int) -> Array:
        """(2, count, lanes): the series of F and G in powers of (y - y0) / half, shifted from the patch's centre to y0."""
        rows = np.stack([self.table.lift.take(at, axis=1), self.table.push.take(at, axis=1)])
        # Horner's rule, row j += x row j + 1 for j downwards, repeated from row k on for each k: turn s has come to j = last - s + k.
        last, rest = rows.shape[1] - 1, np.empty((2, count, x.size))
        for s in range(1, last + 1):
            here, size = last - s, min(count, s)
            rows[:, here : here + size] += np.multiply(x, rows[:, here + 1 : here + size + 1], out=rest[:, :size])
        return rows[:, :count]

    def force(self, y: Array, a: Array, weight: Array | float = 1.0) -> Array:
        """-w F/F0 + a G/G0."""
        return a * self.table.value(self.table.push, y) - weight * self.table.value(self.table.lift, y)

    def rotation(self, y: Array) -> Array:
        """phi/alpha."""
        return self.table.value(self.table.turn, y)

    def rotation_rate(self, y: Array, v: Array) -> Array:
        """Its derivative by tau."""
        return v * self.table.slope(self.table.turn, y)

    def displacement(self, rotation: Array) -> Array:
        """y of phi/alpha."""
        return _inverse(self.table, self.table.turn, rotation, self.limit)

    def fall(self, y: Array, v: Array) -> tuple[Array, Array]:
        """K = v^2/2 + int F/F0 dy is constant between impacts; the barrier is where phi = alpha."""
        energy = 0.5 * v * v + self.table.value(self.table.work, y)
        return falls_by_energy(v, energy, self.barrier, y > self.top), energy

    def crest(self, energy: Array) -> Array:
        """y where the work of the weight has used up the energy."""
        return _inverse(self.table, self.table.work, np.minimum(energy, self.barrier), self.top)

    def damped_crest(self, y: Array, v: Array) -> Array:
        """It has no closed form."""
        return np.full(y.shape, np.nan)

    def certainly_overturns(self, y: Array, v: Array, inward: Array, steady: bool = True) -> Array:
        """Beyond the barrier of the strongest inward drive still to come, or with the speed to pass it; or collapsed.

        Under a constant inward drive e the equilibrium is where F/G = -e, which is a maximum of int F + e G, since F/G falls; a
        weaker drive pushes back less.
        """
        table = self.table
        certain = y >= self.limit
        if (
            self.damping or not steady
        ):  # friction eats the energy, or the barrier moves: only the equilibrium itself is a point of no return
            return certain | ((v > 0.0) & (y >= self._equilibrium(inward) * (1.0 + _MARGIN)))
        maybe = np.flatnonzero(~certain & (v > 0.0))
        maybe = maybe[0.5 * v[maybe] ** 2 + table.value(table.work, y[maybe]) > self.barrier]
        if maybe.size:
            y, e = y[maybe], inward[maybe]
            top = self._equilibrium(e)
            rise = [table.value(c, top) - table.value(c, y) for c in (table.work, table.thrust)]
            certain[maybe] = (y >= top) | (0.5 * v[maybe] ** 2 > (rise[0] + e * rise[1]) * (1.0 + _MARGIN) + _MARGIN)
        return certain

    def _equilibrium(self, e: Array) -> Array:
        """y where F/G = -e, at most the limit; from a table, since at a maximum its last digits do not matter."""
        return np.interp(e, self.marks[1], self.marks[0])


def _largest(table: Patches, coefficients: Array) -> float:
    """An upper bound of a tabulated function: its largest value on 4097 points and what its slope adds between them."""
    y = np.linspace(0.0, float(table.edges[-1]), 4097)
    return float(table.value(coefficients, y).max() + np.abs(table.slope(coefficients, y)).max() * y[1])


def _inverse(table: Patches, coefficients: Array, value: Array, high: float) -> Array:
    """y in [0, high] where a rising function has a value: Newton's method inside a bracket that only shrinks."""
    shape, value = np.shape(value), np.atleast_1d(np.asarray(value, dtype=float))
    nodes = np.linspace(0.0, high, 513)
    at = np.clip(np.searchsorted(table.value(coefficients, nodes), value) - 1, 0, nodes.size - 2)
    a, b = nodes[at], nodes[at + 1]
    y = 0.5 * (a + b)
    lanes = np.flatnonzero(~np.isnan(value))
    for _ in range(60):
        if not lanes.size:
            break
        here = y[lanes]
        gap = table.value(coefficients, here) - value[lanes]
        a[lanes], b[lanes] = np.where(gap < 0.0, here, a[lanes]), np.where(gap < 0.0, b[lanes], here)
        with np.errstate(all="ignore"):
            newton = here - gap / table.slope(coefficients, here)
        inside = (newton >= a[lanes]) & (newton <= b[lanes])
        y[lanes] = np.where(inside, newton, 0.5 * (a[lanes] + b[lanes]))
        lanes = lanes[(np.abs(y[lanes] - here) > 1e-15 * high) & (b[lanes] - a[lanes] > 1e-15 * high)]
    return np.where(np.isnan(value), np.nan, y).reshape(shape)


@lru_cache(maxsize=32)
def tabulate(mechanism: Mechanism) -> Patches:
    """The coefficients of Eq. 3.4 as functions of y, to rounding. Raises ValueError; see `MechanismEquation`."""
    form = linearise(mechanism)
    path = _Path(mechanism, form.alpha, form.stiffness)
    fits = _fit(path, 0.0, path.length, 0)
    edges = np.array([0.0, *(f[0] for f in fits)])
    centre, half = np.array([f[1] for f in fits]), np.array([f[2] for f in fits])
    lift, push, turn = (np.array([f[3][i] for f in fits]).T for i in range(3))
    turn[0, 0] -= np.polynomial.polynomial.polyval((0.0 - centre[0]) / half[0], turn[:, 0])  # 0 at rest to the last digit
    work, thrust = (_integral(c, edges, centre, half) for c in (lift, push))
    return Patches(edges, centre, half, lift, push, turn, work, thrust)


class _Path:
    """The way from rest to collapse: y(phi) by quadrature, and F/F0, G/G0, phi/alpha at given y."""

    def __init__(self, mechanism: Mechanism, alpha: float, stiffness: float) -> None:
        self.mechanism, self.alpha = mechanism, alpha
        at_rest = mechanism.coefficients(0.0)
        root = float(np.sqrt(at_rest.inertia))
        self.lift0, self.push0 = float(at_rest.lift) / root, float(at_rest.push) / root
        self.noise = max(1.0, 0.1 * self.push0 / self.lift0)
        self.rate = stiffness / self.lift0  # dy/dphi over sqrt(M)
        end = _collapse(mechanism, alpha)
        self.marks = np.linspace(0.0, end, 513)
        self.nodes, self.weights = np.polynomial.legendre.leggauss(20)
        self.sums = np.concatenate([[0.0], np.cumsum(self._integral(self.marks[:-1], self.marks[1:]))])
        self.length = float(self.sums[-1])

    def _integral(self, start: Array, stop: Array) -> Array:
        half = 0.5 * (stop - start)
        phi = (0.5 * (start + stop))[..., None] + half[..., None] * self.nodes
        return self.rate * half * (np.sqrt(self.mechanism.coefficients(phi).inertia) * self.weights).sum(axis=-1)

    def phi(self, y: Array) -> Array:
        """Rotation at y [rad], by Newton's method; NaN beyond the reach of the links."""
        first, last = self.marks[1] / self.sums[1], (self.marks[-1] - self.marks[-2]) / (self.sums[-1] - self.sums[-2])
        phi = np.interp(y, self.sums, self.marks) + np.minimum(y, 0.0) * first + np.maximum(y - self.length, 0.0) * last
        for _ in range(12):
            at = np.clip(np.searchsorted(self.marks, phi, side="right") - 1, 0, self.marks.size - 1)
            gap = self.sums[at] + self._integral(self.marks[at], phi) - y
            phi = phi - gap / (self.rate * np.sqrt(self.mechanism.coefficients(phi).inertia))
        return phi

    def __call__(self, y: Array) -> list[Array]:
        phi = self.phi(y)
        c = self.mechanism.coefficients(phi)
        root = np.sqrt(c.inertia)
        return [c.lift / root / self.lift0, c.push / root / self.push0, phi / self.alpha]


def _collapse(mechanism: Mechanism, alpha: float) -> float:
    """The rotation from which nothing brings the structure back; at least 1.25 alpha."""
    phi = np.linspace(0.0, mechanism.reach, 20001)[:-1]
    c = mechanism.coefficients(phi)
    with np.errstate(all="ignore"):
        multiplier = np.asarray(c.lift / c.push)
    falls = (np.diff(multiplier) < 0.0) & (np.asarray(c.push)[1:] > 0.0) & (multiplier[1:] >= _COLLAPSED * multiplier[0])
    end = float(phi[-1] if falls.all() else phi[np.argmin(falls)])
    if end < 1.25 * alpha:
        raise ValueError("the nonlinear model does not hold: its lambda(phi) does not fall on to the unstable equilibrium and beyond it")
    return end


def _fit(path: _Path, start: float, stop: float, depth: int) -> list[tuple[float, float, float, list[Array]]]:
    """Patches from start to stop: halved until their series converge."""
    if depth > 16:
        raise ValueError("the nonlinear model does not hold: the linkage locks too close to rest")
    centre, half = 0.5 * (start + stop), 0.5 * _WIDEN * (stop - start)
    x = np.cos(np.pi * (np.arange(DEGREE + 8) + 0.5) / (DEGREE + 8))
    with np.errstate(all="ignore"):
        values = path(centre + half * x)
    found = []
    for v in values:
        if not np.all(np.isfinite(v)):
            break
        c = np.polynomial.chebyshev.chebfit(x, v, DEGREE + 7)
        small = _SMALL * path.noise * max(1.0, np.abs(c).max()) * (1.0 if depth < 8 else 10.0)
        if np.abs(c[DEGREE - 2 :]).max() > small:
            break
        c = np.where(np.abs(c) > small, c, 0.0)[: DEGREE + 1]
        powers = np.polynomial.chebyshev.cheb2poly(c)
        found.append(np.pad(powers, (0, DEGREE + 1 - powers.size)))
    else:
        return [(stop, centre, half, found)]
    middle = 0.5 * (start + stop)
    return [*_fit(path, start, middle, depth + 1), *_fit(path, middle, stop, depth + 1)]


def _integral(coefficients: Array, edges: Array, centre: Array, half: Array) -> Array:
    """The integral from y = 0 of a function by patches."""
    n = np.arange(1, coefficients.shape[0] + 1)[:, None]
    raised = np.concatenate([np.zeros((1, centre.size)), coefficients * half / n])
    total = 0.0
    for i in range(centre.size):
        ends = np.polynomial.polynomial.polyval((edges[i : i + 2] - centre[i]) / half[i], raised[:, i])
        raised[0, i] = total - ends[0]
        total += float(ends[1] - ends[0])
    return raised
