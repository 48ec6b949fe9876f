"""The Taylor terms of a motion, one after the other.

Every equation is y'' = -w F(y) + a G(y) - H(y) - 2 zeta y' (`equation`, where F and G
are called l and m), with the outward drive a, the weight w over m g and the moment H of
ties and a tendon. In powers of the time over a unit the terms of y are

    Y_(n+2) = unit^2/((n + 1)(n + 2)) [(a G)_n - (w F)_n - H_n]
              - 2 zeta unit Y_(n+1)/(n + 2)

The same code serves one body (a series is a list of floats), a scan (a list of arrays)
and a sweep (`TermRows`, where a product of two series is one call).
"""

from collections.abc import Callable
from operator import mul
from typing import Any, Protocol, Self

import numpy as np

from ...arrays import Array

# terms 0, 1, 2 ... of a series: a list of floats or of arrays, or TermRows
Series = Any


class Recurrence(Protocol):
    """An equation of motion whose Taylor terms can be found: every `Equation`, and one
    of tied bodies.
    """

    damping: Any  # zeta [-], float or (lanes,)
    damped: bool  # True if it is not 0
    tolerance: float  # error of y that a series keeps [-]
    gain: Any  # upper bound of |df/dy| near the ground, for drives |a| <= 1 [-]

    def along(
        self, y: Series, new: Callable[[], Series]
    ) -> tuple[Series, Series | None, Callable[[int], None]]:
        """Return F and G along a motion, both with their term 0, and a function that
        adds their terms n.

        y: terms of the motion; new: returns an empty series. G is None where it is 1.
        The caller calls the function for n = 1, 2 ..., when the terms 0 to n of y are
        known.
        """

    def held(
        self, y: Series, lift: Series, push: Series | None, new: Callable[[], Series]
    ) -> Callable[[int], Any] | None:
        """Return a function that returns term n of H along a motion, None where it is
        0; lift, push: F and G, as of `along`.

        The caller calls the function for n = 0, 1 ..., when the terms 0 to n of y, F
        and G are known.
        """

    def part(self, lanes: slice) -> Self:
        """Return the equation of some of its lanes."""


class TermRows:
    """A series whose terms are the rows of one array, (terms, lanes), for many lanes.

    The array has two columns for a single lane: NumPy sums one column in another order,
    and no digit may depend on a lane's neighbours.
    """

    __slots__ = ("array", "count")

    def __init__(self, most: int, lanes: int) -> None:
        self.array = np.empty((most, 2 if lanes == 1 else lanes))
        self.count = 0  # terms that are known

    @classmethod
    def of(cls, *terms: Array) -> "TermRows":
        """Return the series with these terms, each (lanes,)."""
        rows = cls(len(terms), terms[0].size)
        for term in terms:
            rows.append(term)
        return rows

    @classmethod
    def from_array(cls, terms: Array) -> "TermRows":
        """Return the series whose terms are these rows, (terms, lanes)."""
        rows = cls(0, 0)
        rows.array = terms.repeat(2, axis=1) if terms.shape[1] == 1 else terms
        rows.count = len(terms)
        return rows

    def append(self, term: Array | float) -> None:
        """Add the next term."""
        self.array[self.count] = term
        self.count += 1

    def __getitem__(self, n: int) -> Array:
        return self.array[n]

    def __len__(self) -> int:
        return self.count


def product_term(a: Series, b: Series) -> Any:
    """Return term n of the product of two series, where n is the last term of b."""
    n = len(b) - 1
    if type(b) is list:
        if len(a) == 2:  # a straight line
            return a[0] * b[n] + a[1] * b[n - 1] if n else a[0] * b[0]
        return sum(map(mul, a, reversed(b)))
    most = min(len(a), n + 1)
    return np.einsum("il,il->l", a.array[:most], b.array[n + 1 - most : n + 1][::-1])


def product_terms(a: Series, b: Series, c: Series) -> tuple[Any, Any]:
    """Return term n of the products a b and a c, where n is the last term of
    b and c.
    """
    if type(b) is not list:
        return product_term(a, b), product_term(a, c)
    by_b, by_c, n = 0.0, 0.0, len(b) - 1
    for x in a:
        by_b += x * b[n]
        by_c += x * c[n]
        n -= 1
    return by_b, by_c


def known(force: Any, own: Any) -> Any:
    """Return the force where it is known, elsewhere `own`; floats or arrays."""
    if isinstance(force, np.ndarray):
        return np.where(np.isnan(force), own, force)
    return own if force != force else force


def motion_terms(
    equation: Recurrence,
    y: Any,
    v: Any,
    unit: Any,
    factors: Any,
    drive: Series,
    weight: Series | None = None,
    force: Any = None,
) -> Any:
    """Return the terms of y in powers of the time over `unit` [tau].

    Parameters:
        y: displacement at the start, float or (lanes,)
        v: velocity y' at the start, by tau, float or (lanes,)
        unit: unit of time of the series [tau], float or (lanes,)
        factors: unit^2/((n + 1)(n + 2)) for n = 0, 1 ..., 0 beyond the degree of a lane
        drive: series of the outward drive
        weight: series of the weight over m g, None for 1
        force: y'' + 2 zeta y' at the start, where it is known to more digits than
            follow from the drive; NaN elsewhere

    Returns len(factors) + 2 terms: a list if `drive` is one, otherwise (terms, lanes).
    """
    count = len(factors) + 2
    new: Callable[[], Series] = list
    if isinstance(drive, TermRows):
        lanes = y.size

        def new() -> Series:
            return TermRows(count, lanes)

    motion = new()
    motion.append(y)
    motion.append(v * unit)
    lift, push, extend = equation.along(motion, new)
    held = equation.held(motion, lift, push, new)
    drag = 2.0 * equation.damping / unit if equation.damped else None
    line = type(motion) is list and len(drive) == 2
    for n, factor in enumerate(factors):
        if n:
            extend(n)
        weighed = lift[n] if weight is None else product_term(weight, lift)
        if push is None:  # G = 1
            own = drive[n] - weighed if n < len(drive) else -weighed
        elif line:
            own = drive[0] * push[n] - weighed
            if n:
                own = own + drive[1] * push[n - 1]
        else:
            own = product_term(drive, push)
            own -= weighed
        if held is not None:
            own = own - held(n)
        if n == 0 and force is not None:
            own = known(force, own)
        if drag is not None:
            own = own - drag * (n + 1) * motion[n + 1]
        motion.append(own * factor)
    return motion.array[:, : y.size] if isinstance(drive, TermRows) else motion
