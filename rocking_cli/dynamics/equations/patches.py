"""The functions of a mechanism's equation as power series in y on patches, fitted to
the linkage to rounding. A patch is short against the distance to the linkage's nearest
lock-up. It is then cut into narrow patches, on which a value needs a few terms only.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ...arrays import Array
from ...errors import ArgumentError
from ...structures.mechanics.kinematics import linearise
from ...structures.mechanics.linkage import Linkage

DEGREE = 28  # degree of the series of a patch
_PARTS = 512  # narrow patches that a fitted patch is cut into
# terms of a narrow patch's series for a value: there x is below 1/1024, and x^6 below
# 1e-18
_TERMS = 6
# lambda(phi) / lambda(0): no drive below 50 times the uplift's brings the structure
# back from there
_COLLAPSED = -50.0
# a Newton step this short, over the whole interval, leaves an error of the square of
# the step
_CLOSE = 1e-9
_SETTLED = (
    1e-11  # of the whole path: after a Newton step so short nothing is left to do
)
_PLACES = 1024  # between the place where the links lock and the collapse
_WIDEN = 2.0  # a patch's series is fitted on this times its width
# A smaller Chebyshev coefficient is rounding: values are of order one, with errors of
# 1e-14, or of 1e-15 over lambda where lambda is small.
_SMALL = 3e-14


@dataclass(frozen=True)
class Patches:
    """Functions of y by patches: on each patch a series in powers of (y - centre) /
    half.
    """

    edges: Array  # ends of the patches, in y, (patches + 1,)
    centre: Array  # middle of each patch, in y, (patches,)
    half: Array  # half the width that was fitted, in y, (patches,)
    # integrals of lift and of push over y from the last edge, where the links lock, to
    # places up to the collapse, (2, places); 0 where they do not lock before
    beyond: Array
    lift: Array  # coefficients of F/F0 [-], (terms, patches)
    push: Array  # coefficients of G/G0 [-], (terms, patches)
    turn: Array  # coefficients of phi/alpha [-], (terms, patches)
    work: Array  # coefficients of int lift dy from 0, (terms, patches)
    thrust: Array  # coefficients of int push dy from 0, (terms, patches)

    def of(self, y: Array) -> tuple[Array, Array]:
        """(index of the patch, argument of its series) for each displacement y."""
        at = np.searchsorted(self.edges[1:-1], y, side="right")
        return at, (y - self.centre.take(at)) / self.half.take(at)

    def value(self, coefficients: Array, y: Array) -> Array:
        """The value at y of the tabulated function with these coefficients."""
        at, x = self.of(y)
        total = coefficients[_TERMS - 1].take(at)
        for row in coefficients[_TERMS - 2 :: -1]:
            total *= x
            total += row.take(at)
        return total

    def slope(self, coefficients: Array, y: Array) -> Array:
        """The derivative at y of the tabulated function with these coefficients."""
        at, x = self.of(y)
        total = (_TERMS - 1) * coefficients[_TERMS - 1].take(at)
        for n in range(_TERMS - 2, 0, -1):
            total *= x
            total += n * coefficients[n].take(at)
        return total / self.half.take(at)


def _shifted(rows: Array, x: Array, count: int) -> Array:
    """The first terms, about x in place of 0, of series (functions, terms, lanes), by
    Horner's rule. It overwrites `rows`.
    """
    for first in range(count):
        for n in range(rows.shape[1] - 2, first - 1, -1):
            rows[:, n] += x * rows[:, n + 1]
    return rows[:, :count]


def largest(table: Patches, coefficients: Array) -> float:
    """An upper bound of a tabulated function: its largest value on 4097 points, plus
    the growth between points that its slope allows.
    """
    y = np.linspace(0.0, float(table.edges[-1]), 4097)
    return float(
        table.value(coefficients, y).max()
        + np.abs(table.slope(coefficients, y)).max() * y[1]
    )


def inverse(table: Patches, coefficients: Array, value: Array, high: float) -> Array:
    """The y in [0, high] at which a rising function has a value: Newton's method in a
    bracket that only shrinks, from its chord on.
    """
    shape, value = np.shape(value), np.atleast_1d(np.asarray(value, dtype=float))
    nodes = np.linspace(0.0, high, 513)
    known = table.value(coefficients, nodes)
    at = np.searchsorted(known[1:-1], value)
    a, b = nodes.take(at), nodes.take(at + 1)
    low, top = known.take(at), known.take(at + 1)
    # The first guess: the chord between the two nodes around the value.
    y = np.clip(a + (value - low) / (top - low) * (b - a), a, b)
    lanes = np.flatnonzero(~np.isnan(value))
    for _ in range(60):
        if not lanes.size:
            break
        here = y[lanes]
        gap = table.value(coefficients, here) - value[lanes]
        a[lanes] = np.where(gap < 0.0, here, a[lanes])
        b[lanes] = np.where(gap < 0.0, b[lanes], here)
        with np.errstate(all="ignore"):
            newton = here - gap / table.slope(coefficients, here)
        inside = (newton >= a[lanes]) & (newton <= b[lanes])
        y[lanes] = np.where(inside, newton, 0.5 * (a[lanes] + b[lanes]))
        step = np.abs(y[lanes] - here)
        lanes = lanes[
            (step > np.where(inside, _CLOSE, 1e-15) * high)
            & (b[lanes] - a[lanes] > 1e-15 * high)
        ]
    return np.where(np.isnan(value), np.nan, y).reshape(shape)


@lru_cache(maxsize=32)
def tabulate(mechanism: Linkage) -> Patches:
    """Computes the coefficients of Eq. 3.4 as functions of y, to rounding. Raises
    ArgumentError as `MechanismEquation`.
    """
    form = linearise(mechanism)
    path = _PatchPath(mechanism, form.alpha, form.stiffness)
    fits = _fit(path, 0.0, path.length, 0)
    edges = np.array([0.0, *(f[0] for f in fits)])
    centre, half = np.array([f[1] for f in fits]), np.array([f[2] for f in fits])
    lift, push, turn = (np.array([f[3][i] for f in fits]).T for i in range(3))
    work, thrust = (_integral(c, edges, centre, half) for c in (lift, push))
    functions = lift, push, turn, work, thrust
    return _narrowed(Patches(edges, centre, half, path.beyond, *functions))


def _narrowed(wide: Patches) -> Patches:
    """Return the functions of `wide` on narrower patches, so that a value, or a series
    about any y of a patch, needs only a few terms.
    """
    share, width = (np.arange(_PARTS) + 0.5) / _PARTS, np.diff(wide.edges)
    edges = np.append(
        (wide.edges[:-1, None] + width[:, None] * (share - 0.5 / _PARTS)).ravel(),
        wide.edges[-1],
    )
    centre = (wide.edges[:-1, None] + width[:, None] * share).ravel()
    half = wide.half.repeat(_PARTS)
    x = (centre - wide.centre.repeat(_PARTS)) / half
    functions = np.stack(
        [
            np.pad(c, ((0, DEGREE + 2 - len(c)), (0, 0)))
            for c in (wide.lift, wide.push, wide.turn, wide.work, wide.thrust)
        ]
    )
    rows = _shifted(functions.repeat(_PARTS, axis=2), x, DEGREE + 1)
    at_rest = np.polynomial.polynomial.polyval(
        (0.0 - centre[0]) / half[0], rows[2:, :_TERMS, 0].T
    )
    rows[2:, 0, 0] -= at_rest  # 0 at rest to the last digit
    series = *rows[:2, : DEGREE + 1], *rows[2:, :_TERMS]
    return Patches(edges, centre, half, wide.beyond, *series)


class _PatchPath:
    """Computes y(phi) from rest to collapse by quadrature, and F/F0, G/G0, phi/alpha at
    given y.
    """

    def __init__(self, mechanism: Linkage, alpha: float, stiffness: float) -> None:
        # y, F and G are the same by every coordinate of the mechanism.
        self.mechanism, self.most, self.turned = mechanism.beyond_lock()
        self.alpha = alpha
        # F and G at rest, over which the table has them.
        at_rest = self.mechanism.coefficients(0.0)
        root = float(np.sqrt(at_rest.inertia))
        self.lift0, self.push0 = float(at_rest.lift) / root, float(at_rest.push) / root
        # rounding of the coefficients of Eq. 3.4, over that of a number near 1
        self.noise = max(1.0, 0.1 * self.push0 / self.lift0)
        self.rate = stiffness / self.lift0  # dy/dphi over sqrt(M)
        # Rotations, and y at each of them: the integral by Gauss-Legendre quadrature.
        end, self.beyond = self._collapse()
        self.marks = np.linspace(0.0, end, 513)
        self.nodes, self.weights = np.polynomial.legendre.leggauss(20)
        self.sums = np.concatenate(
            [[0.0], np.cumsum(self._integral(self.marks[:-1], self.marks[1:]))]
        )
        self.length = float(self.sums[-1])

    def _integral(self, start: Array, stop: Array) -> Array:
        """The increase of y between rotations [rad]: the integral of dy/dphi, by
        Gauss-Legendre quadrature.
        """
        half = 0.5 * (stop - start)
        phi = (0.5 * (start + stop))[..., None] + half[..., None] * self.nodes
        return (
            self.rate
            * half
            * (np.sqrt(self.mechanism.coefficients(phi).inertia) * self.weights).sum(
                axis=-1
            )
        )

    def phi(self, y: Array) -> Array:
        """Rotation at y [rad], by Newton's method; NaN beyond the reach
        of the links.
        """
        first = self.marks[1] / self.sums[1]
        last = (self.marks[-1] - self.marks[-2]) / (self.sums[-1] - self.sums[-2])
        phi = (
            np.interp(y, self.sums, self.marks)
            + np.minimum(y, 0.0) * first
            + np.maximum(y - self.length, 0.0) * last
        )
        # Newton's method from the linear interpolation between the rotations.
        for _ in range(12):
            at = np.clip(
                np.searchsorted(self.marks, phi, side="right") - 1,
                0,
                self.marks.size - 1,
            )
            gap = self.sums[at] + self._integral(self.marks[at], phi) - y
            step = gap / (self.rate * np.sqrt(self.mechanism.coefficients(phi).inertia))
            phi = phi - step
            if not np.abs(step).max() > _SETTLED * self.marks[-1]:
                break
        return phi

    def __call__(self, y: Array) -> list[Array]:
        phi = self.phi(y)
        c = self.mechanism.coefficients(phi)
        root = np.sqrt(c.inertia)
        return [
            c.lift / root / self.lift0,
            c.push / root / self.push0,
            self.turned(phi) / self.alpha,
        ]

    def _collapse(self) -> tuple[float, Array]:
        """(Coordinate at which the structure has collapsed, lies on its side or locks
        [rad]; `Patches.beyond`). There phi is at least 1.25 alpha. Raises
        ArgumentError.
        """
        at = np.linspace(0.0, self.most, 20001)[:-1]
        c, phi = self.mechanism.coefficients(at), self.turned(at)
        with np.errstate(all="ignore"):
            multiplier = np.asarray(c.lift / c.push)
        collapsed = multiplier < _COLLAPSED * multiplier[0]
        # lambda(phi) = V'/(g B) must fall and B stay positive, up to the collapse.
        goes_on = (
            (np.diff(multiplier) < 0.0)
            & (np.asarray(c.push)[1:] > 0.0)
            & (np.diff(phi) > 0.0)
            & ~collapsed[1:]
        )
        last = at.size - 1 if goes_on.all() else int(np.argmin(goes_on))
        if phi[last] < 1.25 * self.alpha:
            raise ArgumentError(
                "the nonlinear model does not hold: its lambda(phi) does not fall on to"
                " the unstable equilibrium and beyond it"
            )
        if collapsed[last + 1 :][:1].any() or phi[last] > 0.5 * np.pi - 2.0 * at[1]:
            return float(at[last]), np.zeros((2, 1))
        # from here to the collapse, or as far as the path is known
        until = last + int(np.argmax(np.append(collapsed[last:-1], True)))
        forces = self.rate * np.stack([c.lift / self.lift0, c.push / self.push0])
        steps = 0.5 * at[1] * (forces[:, last:until] + forces[:, last + 1 : until + 1])
        beyond = np.pad(np.cumsum(steps, axis=1), ((0, 0), (1, 0)))
        few = np.linspace(0, beyond.shape[1] - 1, _PLACES).astype(np.int64)
        return float(at[last]), beyond[:, few]


def _fit(
    path: _PatchPath, start: float, stop: float, depth: int
) -> list[tuple[float, float, float, list[Array]]]:
    """Return patches from start to stop, halved until their series converge."""
    if depth > 16:
        raise ArgumentError(
            "the nonlinear model does not hold: the linkage locks too close to rest"
        )
    centre, half = 0.5 * (start + stop), 0.5 * _WIDEN * (stop - start)
    x = np.cos(np.pi * (np.arange(DEGREE + 8) + 0.5) / (DEGREE + 8))
    with np.errstate(all="ignore"):
        values = path(centre + half * x)
    found = []
    for v in values:
        if not np.all(np.isfinite(v)):
            break
        # The series converges if its last coefficients are at the level of rounding.
        c = np.polynomial.chebyshev.chebfit(x, v, DEGREE + 7)
        small = (
            _SMALL
            * path.noise
            * max(1.0, np.abs(c).max())
            * (1.0 if depth < 8 else 10.0)
        )
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
    """Coefficients, by patches, of the integral from y = 0 of a function; its
    coefficients are given by patches.
    """
    n = np.arange(1, coefficients.shape[0] + 1)[:, None]
    raised = np.concatenate([np.zeros((1, centre.size)), coefficients * half / n])
    total = 0.0
    for i in range(centre.size):
        ends = np.polynomial.polynomial.polyval(
            (edges[i : i + 2] - centre[i]) / half[i], raised[:, i]
        )
        raised[0, i] = total - ends[0]
        total += float(ends[1] - ends[0])
    return raised
