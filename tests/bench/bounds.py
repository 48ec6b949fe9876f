"""What a scene takes of this machine whatever runs it: the functions, divisions, products and sums of its arcs and series.

They are counted while the scene runs, in forked processes too: every evaluation of a flow, every arc and every series. Their rates are
measured on blocks that stay in the cache, with the vector unit. What else a march does (windows, contacts, proofs, lanes) is left out.
"""

from __future__ import annotations

import multiprocessing
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from functools import partial
from typing import Any
from unittest import mock

import numpy as np
from numba import njit

from rocking_cli.dynamics.equations import collocation
from rocking_cli.dynamics.equations.flow import LinearFlow
from rocking_cli.dynamics.equations.linear import LinearEquation
from rocking_cli.dynamics.equations.mechanism import _SHIFT, MechanismEquation
from rocking_cli.dynamics.equations.rigid_body import RigidBodyEquation
from rocking_cli.dynamics.equations.summed_flow import _PAIRS, SHORT, SummedFlow
from rocking_cli.dynamics.equations.taylor import TaylorSeries, order_for

OPERATIONS = ("product and sum", "division", "tangent", "sinh", "root")
BLOCK = 2048  # lanes of a full block (`taylor.CACHED`)
NEAR, WIDE = 1024, 8192  # elements of blocks that the first and the second cache hold; a call of NumPy wants the wider one
Array = np.ndarray
Counts = tuple[int, int, int, int, int]  # of OPERATIONS


def evaluation(flow: LinearFlow | SummedFlow, h: Array) -> Counts:
    """The operations of y and its three derivatives after h."""
    terms, size = len(flow.sin), h.size
    if isinstance(flow, SummedFlow):
        short = int(np.count_nonzero(flow.fastest * h < SHORT))  # by the drive's derivatives
        whole = size - short
        products = short * (2 * _PAIRS * (terms + 4) + 12) + whole * (12 + 12 * terms)
        return products, whole * terms, whole * terms, size, size
    return size * (12 + 20 * terms), size * 2 * terms, size * terms, size, size


def at_impact(flow: LinearFlow | SummedFlow, h: Array) -> Counts:
    """Those of the force at an impact."""
    each = h.size * len(flow.sin)
    return 4 * each, each, each, 0, 0


def arc(equation: LinearEquation, segments: Any, lanes: Any) -> Counts:
    """Those of the drive's coefficients where an arc begins: a sine and a cosine a harmonic, by the tangent of half the angle."""
    each = lanes.y.size * segments.harmonics
    return 4 * each, each, each, 0, 0


def body_series(equation: RigidBodyEquation, segments: Any, lanes: Any) -> Counts:
    """Those of a rigid body's series: of sin z and cos z from each other, of the drive by cos z."""
    size, n = lanes.y.size, np.arange(equation.order - 1)
    return size * int((2 * n + (n + 1) + 6).sum()), size, 2 * size, 0, 0


def mechanism_series(equation: MechanismEquation, y: Array, segments: Any, lanes: Any) -> Counts:
    """Those of a mechanism's: F and G moved to y, powers of y - y0, F and G along the motion, the drive by G."""
    size, n = lanes.y.size, np.arange(len(y) - 2)
    return size * int((2 * _SHIFT + n * (n - 1) // 2 + 2 * n + (n + 1) + 6).sum()), size, size, 0, 0


def step(marks: Any, tolerance: float, segments: Any, lanes: Any, *_: Any) -> Counts:
    """Those of a mechanism's step by collocation: the drive at its points, F and G there, sweeps, and terms of what they come to."""
    points, size, harmonics = order_for(tolerance, collocation._POINTS), lanes.y.size, segments.harmonics
    sweeps, last = (points + 1) * points, (points - 1) // 4
    forces = points * (3 + collocation._COARSE * 2 + 5 + 2 * 4 + 3 + 2 * last + 5 * harmonics)
    whole = forces + (collocation._COARSE + 2 + last) * sweeps + 3 * sweeps // 2
    return size * whole, size * points * harmonics, size * points * harmonics, 0, 0


def of_series(flow: TaylorSeries, h: Array) -> Counts:
    """Those of y and its three derivatives after h."""
    return h.size * 5 * len(flow.terms), 2 * h.size, 0, 0, 0


COUNTED = (
    (LinearFlow, "at", evaluation),
    (SummedFlow, "at", evaluation),
    (LinearFlow, "at_ground", at_impact),
    (SummedFlow, "at_ground", at_impact),
    (TaylorSeries, "at", of_series),
    (LinearEquation, "flow", arc),
    (RigidBodyEquation, "flow", body_series),
    (MechanismEquation, "_fill", mechanism_series),
    (collocation, "_step", step),
)


@contextmanager
def counted() -> Iterator[Any]:
    """The number of each of OPERATIONS that is asked for inside, here and in what is forked from here."""
    total = multiprocessing.Array("d", len(OPERATIONS))

    def counting(action: Any, operations: Any, *arguments: Any) -> Any:
        more = operations(*arguments)
        with total.get_lock():
            for i, n in enumerate(more):
                total[i] += n
        return action(*arguments)

    with ExitStack() as patches:
        for owner, name, operations in COUNTED:
            action = getattr(owner, name)
            patches.enter_context(
                mock.patch.object(owner, name, lambda *x, action=action, operations=operations: counting(action, operations, *x))
            )
        yield total


@njit(fastmath=True)
def _summed_products(one, other, turns):
    total = 0.0
    for _ in range(turns):
        for k in range(one.size):
            total += one[k] * other[k]
    return total


def rates() -> Array:
    """Seconds of each of OPERATIONS an element."""
    near, turns = np.linspace(0.01, 1.5, NEAR), 100
    _summed_products(near, near, 1)  # compiles
    products = _least(partial(_summed_products, near, near.copy(), turns)) / (turns * NEAR)
    x = np.linspace(0.01, 1.5, WIDE)
    out = x.copy()
    functions = [partial(np.divide, 1.0, x, out=out), *(partial(f, x, out=out) for f in (np.tan, np.sinh, np.sqrt))]
    return np.array([products, *(_least(f) / WIDE for f in functions)])


def steps_alone(scene: Any) -> float:
    """Seconds that a mechanism's steps of a scene take by the calls of NumPy that make them, all of them in full blocks."""
    lanes, full, step = 0, partial(int), collocation._step

    def counting(*arguments: Any) -> Any:
        nonlocal lanes, full
        size = arguments[3].y.size
        lanes += size
        full = partial(step, *arguments) if size == BLOCK else full
        return step(*arguments)

    with mock.patch.object(collocation, "_step", counting):
        scene()
    return lanes * _least(full) / BLOCK


def _least(action: Any) -> float:
    """Of so many runs, since one in which the machine did something else says nothing."""
    best = np.inf
    for _ in range(200):
        start = time.perf_counter()
        action()
        best = min(best, time.perf_counter() - start)
    return best


def seconds(operations: Any, rate: Array) -> float:
    """What so many of them take one processor."""
    return float(np.dot(operations, rate))
