"""Measures error and run time of the engine and of SciPy's solvers for one scene,
against an independent reference.
"""

import math
import time
from collections.abc import Iterator
from typing import Any

import numpy as np

from ..dynamics.method import Method, governing_method
from ..dynamics.outcome import Outcome
from ..dynamics.references.extrapolation import Script
from ..dynamics.references.general_solver import solve_cell
from ..dynamics.response import response
from ..errors import UsageError
from ..motions import Motion
from ..motions.grid import Grid
from ..spectra.scene import PulseScene
from ..spectra.verification import sampled_cells
from ..structures.parameters import RockingParameters

TOLERANCES = (1e-4, 1e-6, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12)
SCIPY_METHODS = ("RK45", "LSODA", "DOP853")
SCIPY_TOLERANCES = (1e-4, 1e-6, 1e-8, 1e-10, 1e-12)


def work_precision(
    scene: PulseScene, *, sample: int = 40, scipy: int = 10, seed: int = 0
) -> Iterator[dict[str, Any]]:
    """Yield the accuracy of each method at each tolerance (None: exact) for the first
    structure of a scene, as rows.

    time_per_cell [s]; error_max, error_99: maximum and 99th percentile of the error of
    theta/alpha over the cells with the right outcome; misjudged: number of the others.
    sample, scipy: number of cells of the engine and of each SciPy solver. Raises
    UsageError if no cell of the grid lifts.
    """
    structure = scene.structures[0]
    one = PulseScene((structure,), scene.grid, scene.motion, scene.method)
    amplitude, omega = one.grid.scaled(structure)
    at = sampled_cells(one, sample, seed)
    if not at.size:
        raise UsageError(
            "no cell of this grid leaves the ground; expected a grid that goes above"
            " uplift"
        )
    cells = [(float(amplitude[c]), float(omega[r])) for _, r, c in at]
    reference = one.method.reference_of(structure)
    truth = [reference(one.motion, a, w, structure.eta) for a, w in cells]
    known = [i for i, (outcome, _) in enumerate(truth) if outcome != Outcome.FAILED]
    cells, truth = [cells[i] for i in known], [truth[i] for i in known]

    thin = max(
        1, math.ceil(math.sqrt(amplitude.size * omega.size / 50_000))
    )  # so many cells at once are timed
    a, w = (x.ravel() for x in np.meshgrid(amplitude[::thin], omega[::thin]))
    for tolerance in (None,) if one.method.exact else TOLERANCES:
        system = (
            one.method if tolerance is None else Method(one.method.model, tolerance)
        ).system_of(structure)
        began = time.perf_counter()
        response(system, one.motion, a, w, structure.eta)
        cost = (time.perf_counter() - began) / a.size
        found = response(
            system,
            one.motion,
            np.array([x for x, _ in cells]),
            np.array([y for _, y in cells]),
            structure.eta,
        )
        answers = [
            (Outcome(int(o)), float(x))
            for o, x in zip(found.outcome, found.theta_ratio, strict=True)
        ]
        yield _compare(
            "rocking, exact" if tolerance is None else "rocking, in steps",
            tolerance,
            answers,
            truth,
            cost,
        )

    problem = one.method.problem_of(structure)
    for method in SCIPY_METHODS if scipy else ():
        for tolerance in SCIPY_TOLERANCES:
            began, solver = time.perf_counter(), Script(method, tolerance)
            answers = [
                solve_cell(one.motion, a, w, structure.eta, problem, solver)
                for a, w in cells[:scipy]
            ]
            cost = (time.perf_counter() - began) / max(1, len(answers))
            yield _compare(f"SciPy {method}", tolerance, answers, truth[:scipy], cost)


def accuracy(
    structure: RockingParameters,
    motion: Motion,
    grid: Grid,
    *,
    method: Method | None = None,
    sample: int = 40,
    scipy: int = 10,
    seed: int = 0,
) -> list[dict[str, Any]]:
    """Return error and run time of the methods over a grid, beside SciPy's solvers.

    Parameters
    ----------
    structure
        the structure
    motion
        the motion of the ground
    grid
        from whose cells some are drawn
    method
        the equation of motion; None for the nonlinear one if the geometry is known and
        the axes have units, else the linear one
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
        error_max and error_99 of theta/alpha [-], misjudged

    Raises
    ------
    UsageError
        for a number out of range, or an equation that does not hold for the structure

    Examples
    --------
    >>> grid = parse_grid("A=1:8:20,Omega=1:8:20")
    >>> rows = accuracy(
    ...     dimensionless_oscillator(0.9), sine(), grid, sample=5, scipy=0
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
    method = method or governing_method(structure, dimensionless=grid.dimensionless)
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
    answers: list[tuple[Outcome, float]],
    truth: list[tuple[Outcome, float]],
    cost: float,
) -> dict[str, Any]:
    right = [(x, y) for (o, x), (p, y) in zip(answers, truth, strict=True) if o == p]
    gaps = np.array([abs(x - y) for x, y in right if math.isfinite(y)])
    worst, most = (
        (float(gaps.max()), float(np.quantile(gaps, 0.99)))
        if gaps.size
        else (math.nan, math.nan)
    )
    return {
        "method": method,
        "tolerance": tolerance,
        "cells": len(answers),
        "time_per_cell": cost,
        "error_max": worst,
        "error_99": most,
        "misjudged": len(answers) - len(right),
    }
