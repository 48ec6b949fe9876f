"""Measures error and run time of the engine and of SciPy's solvers for one scene,
against an independent reference.
"""

import math
import time
from collections.abc import Iterable, Iterator, Sequence
from functools import partial
from itertools import islice
from typing import Any, NamedTuple

import numpy as np

from ..dynamics.method import Method, governing_method
from ..dynamics.outcome import Outcome
from ..dynamics.references.extrapolation import EdgeMotion, Path, StatePoint
from ..dynamics.references.general_solver import solve_cell
from ..dynamics.response import response
from ..errors import UsageError
from ..motions.given import AnyMotion, with_grid
from ..motions.grid import Grid
from ..spectra.error_bound import tolerance_of
from ..spectra.scene import CellPlace, PulseScene
from ..spectra.verification import drawn_cells
from ..structures.given import Structure, structure_from

TOLERANCES = (1e-4, 1e-6, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12)
_DRAWS = 10_000  # cells of the grid among which those that lift are looked for
SCIPY_METHODS = ("RK45", "LSODA", "DOP853")
SCIPY_TOLERANCES = (1e-4, 1e-6, 1e-8, 1e-10, 1e-12)


def work_precision(
    scene: PulseScene, *, sample: int = 40, scipy: int = 10, seed: int = 0
) -> Iterator[dict[str, Any]]:
    """Yield the accuracy of each method at each tolerance (None: exact) for the first
    structure of a scene, as rows.

    time_per_cell [s]; largest_difference, error_99: maximum and 99th percentile of the
    error of theta/alpha over the cells with the right outcome; error_bound: the
    tolerance times their largest condition, None of SciPy; misjudged: number of the
    others.
    sample, scipy: number of cells of the engine and of each SciPy solver. Raises
    UsageError if no cell of the grid lifts.
    """
    structure = scene.structures[0]
    one = PulseScene((structure,), scene.grid, scene.motion, scene.method)
    known = list(islice(_known_cells(one, drawn_cells(one, _DRAWS, seed)), sample))
    if not known:
        raise UsageError(
            "no cell of this grid leaves the ground; expected a grid that goes above"
            " uplift"
        )
    for tolerance in (None,) if one.method.exact else TOLERANCES:
        yield _of_engine(one, tolerance, known)
    for method in SCIPY_METHODS if scipy else ():
        for tolerance in SCIPY_TOLERANCES:
            yield _of_scipy(one, method, tolerance, known[:scipy])


class KnownCell(NamedTuple):
    """A cell with the answer of the reference."""

    amplitude: float  # A [-]
    omega: float  # Omega [-]
    outcome: Outcome  # outcome by the reference
    theta_ratio: float  # theta_max/alpha of the reference [-]


def _known_cells(scene: PulseScene, places: Iterable[CellPlace]) -> Iterator[KnownCell]:
    """Yield those of these cells that lift and that the reference solves."""
    (structure,) = scene.structures
    amplitude, omega = scene.grid.scaled(structure)
    reference = scene.method.reference_of(structure)
    for _, row, column in places:
        a, w = float(amplitude[column]), float(omega[row])
        cell = KnownCell(a, w, *reference(scene.motion, a, w))
        if cell.outcome not in (Outcome.FAILED, Outcome.NO_UPLIFT):
            yield cell


def _of_engine(
    scene: PulseScene, tolerance: float | None, known: Sequence[KnownCell]
) -> dict[str, Any]:
    """Return the row of the engine; the time of a cell is that in a run of many."""
    (structure,) = scene.structures
    method = (
        scene.method if tolerance is None else Method(scene.method.model, tolerance)
    )
    system = method.system_of(structure)
    solve = partial(response, system, scene.motion)

    amplitude, omega = _timed_cells(scene)
    began = time.perf_counter()
    solve(amplitude, omega)
    cost = (time.perf_counter() - began) / amplitude.size

    found = solve(
        np.array([cell.amplitude for cell in known]),
        np.array([cell.omega for cell in known]),
    )
    answers = [
        (Outcome(int(code)), float(ratio))
        for code, ratio in zip(found.outcome, found.theta_ratio, strict=True)
    ]
    name = "rocking, exact" if tolerance is None else "rocking, in steps"
    largest = float(np.fmax.reduce(found.condition, initial=0.0))
    bound = min(1.0, tolerance_of(method) * largest)
    return _compare(name, tolerance, answers, known, cost) | {"error_bound": bound}


def _timed_cells(scene: PulseScene) -> tuple[np.ndarray, np.ndarray]:
    """Return (A, Omega) of up to about 50,000 cells of the grid."""
    amplitude, omega = scene.grid.scaled(scene.structures[0])
    thin = max(1, math.ceil(math.sqrt(amplitude.size * omega.size / 50_000)))
    a, w = np.meshgrid(amplitude[::thin], omega[::thin])
    return a.ravel(), w.ravel()


def scipy_path(
    method: str,
    tolerance: float,
    flow: EdgeMotion,
    start: StatePoint,
    stop: float,
    limit: float,
) -> Path:
    """Return the same as `path` of the reference, by SciPy's `solve_ivp` with events,
    as a user's script would call it; method, tolerance: that it is given.
    """
    from scipy.integrate import solve_ivp

    events: tuple[Any, ...] = (
        lambda t, state: state[0],
        lambda t, state: state[1],
        lambda t, state: state[0] - limit,
    )
    # The three events in order: impact, peak, end of the body's range. Only a peak does
    # not stop the integration.
    for event, direction, terminal in zip(
        events, (-1, -1, 1), (True, False, True), strict=True
    ):
        event.direction, event.terminal = direction, terminal
    found = solve_ivp(
        lambda t, state: flow.rate(t, *state.tolist()),
        (start.time, stop),
        start[1:],
        method=method,
        rtol=max(tolerance, 2.3e-14),
        atol=tolerance,
        events=events,
    )
    impacts, peaks, _, steps = (
        [StatePoint(float(t), *y.tolist()) for t, y in zip(*x, strict=True)]
        for x in zip(
            [*found.t_events, found.t], [*found.y_events, found.y.T], strict=True
        )
    )
    return Path(
        [p for p in peaks if p.time > start.time],
        impacts[0] if impacts else steps[-1],
        bool(impacts),
        steps,
    )


def _of_scipy(
    scene: PulseScene, method: str, tolerance: float, known: Sequence[KnownCell]
) -> dict[str, Any]:
    """Return the row of one solver of SciPy, which solves cell by cell."""
    solver = partial(scipy_path, method, tolerance)
    (structure,) = scene.structures
    problem = scene.method.problem_of(structure)
    began = time.perf_counter()
    answers = [
        solve_cell(scene.motion, cell.amplitude, cell.omega, problem, solver)
        for cell in known
    ]
    cost = (time.perf_counter() - began) / max(1, len(answers))
    return _compare(f"SciPy {method}", tolerance, answers, known, cost)


def accuracy(
    structure: Structure,
    motion: AnyMotion,
    grid: Grid | str | None = None,
    *,
    method: Method | str | None = None,
    sample: int = 40,
    scipy: int = 10,
    seed: int = 0,
) -> list[dict[str, Any]]:
    """Return error and run time of the methods over a grid, beside SciPy's solvers.

    Parameters
    ----------
    structure
        parameters, a document, a path, or a text such as "block:0.5x2"
    motion
        the motion of the ground: an object, the name of a pulse, or a path
    grid
        from whose cells some are drawn, or its text; a record does not need it
    method
        the equation of motion or its name, such as "linear"; None for the nonlinear one
        if the geometry is known and the axes have units, else the linear one
    sample
        number of cells that are compared, from 1
    scipy
        number of cells that SciPy's solvers compute, 0 for none
    seed
        of the random choice of cells

    Returns
    -------
    list of dict
        rows of `rocking accuracy`: method, tolerance, cells, time_per_cell [s],
        largest_difference and error_99 of theta/alpha [-], misjudged, error_bound

    Raises
    ------
    UsageError
        for a number out of range, or an equation that does not hold for the structure

    Examples
    --------
    >>> grid = parse_grid("A=1:8:20,Omega=1:8:20")
    >>> rows = accuracy(
    ...     dimensionless_oscillator(eta=0.9), sine(), grid, sample=5, scipy=0
    ... )
    >>> rows[0]["method"], rows[0]["misjudged"]
    ('rocking, exact', 0)
    """
    for name, value, least in (
        ("sample", sample, 1),
        ("scipy", scipy, 0),
        ("seed", seed, 0),
    ):
        if value < least:
            raise UsageError(
                f"`{name}`: found {value}; expected a whole number from {least}"
            )
    structure = structure_from(structure)
    motion, grid = with_grid(motion, grid)
    method = Method.of(
        method or governing_method(structure, dimensionless=grid.dimensionless)
    )
    return list(
        work_precision(
            PulseScene((structure,), grid, motion, method),
            sample=sample,
            scipy=scipy,
            seed=seed,
        )
    )


def _compare(
    method: str,
    tolerance: float | None,
    answers: Sequence[tuple[Outcome, float]],
    known: Sequence[KnownCell],
    cost: float,
) -> dict[str, Any]:
    """Return the row of a method: its errors where its outcome is right."""
    right = [
        (ratio, cell.theta_ratio)
        for (outcome, ratio), cell in zip(answers, known, strict=True)
        if outcome == cell.outcome
    ]
    errors = np.array([abs(x - y) for x, y in right if math.isfinite(y)])
    return {
        "method": method,
        "tolerance": tolerance,
        "cells": len(answers),
        "time_per_cell": cost,
        "largest_difference": float(errors.max()) if errors.size else math.nan,
        "error_99": float(np.quantile(errors, 0.99)) if errors.size else math.nan,
        "misjudged": len(answers) - len(right),
        "error_bound": None,
    }
