"""What a dimensionless spectrum says of a structure under one motion: the paper's use of a rocking spectrum (section 4)."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..dynamics.method import LINEAR
from ..dynamics.outcome import Outcome, overturned
from ..dynamics.response import response
from ..errors import UsageError
from ..motions import Motion
from ..structures.parameters import RockingParameters
from .envelope import trace_envelope
from .grid import Grid
from .reader import SpectraFile

ETA_TOLERANCE = 1e-6  # spectra of restitutions closer than this are taken for the same


def predict(spectrum: SpectraFile, structure: RockingParameters, shaking: Grid) -> dict[str, Any]:
    """theta_max [rad], theta_ratio, outcome, margin and interpolation error of a structure from a linear dimensionless spectrum.

    theta_ratio is interpolated linearly in the grid's cell (A, Omega) and its error is the difference from the computed
    value of this one cell. The outcome is that of the cell's corners where they and the computed one agree, else `undecided`: a
    boundary runs through the cell. margin: a lower bound of the relative distance in A to the nearest boundary at the two
    frequencies. Raises UsageError when the spectrum has other axes, model or restitutions, or does not reach (A, Omega).
    """
    if not spectrum.grid.dimensionless or spectrum.scene["model"] != LINEAR.model:
        raise UsageError(f"{spectrum.path}: accepted is a linear spectrum on axes A and Omega")
    etas = [s.eta for s in spectrum.structures]
    nearest = int(np.argmin(np.abs(np.array(etas) - structure.eta)))
    if abs(etas[nearest] - structure.eta) > ETA_TOLERANCE:
        held = ", ".join(f"{x:g}" for x in sorted(set(etas)))
        raise UsageError(f"{structure.name}: its eta is {structure.eta:.6g}, the spectrum holds {held}; --exact computes it")
    amplitude, omega = (float(x[0]) for x in shaking.scaled(structure))
    a, w = spectrum.grid.amplitude.values, spectrum.grid.frequency.values
    if not (a[0] <= amplitude <= a[-1] and w[0] <= omega <= w[-1]):
        raise UsageError(
            f"{structure.name}: A = {amplitude:.6g}, Omega = {omega:.6g} is outside the spectrum "
            f"(A {a[0]:g} to {a[-1]:g}, Omega {w[0]:g} to {w[-1]:g}); --exact computes it"
        )
    rows, x = _cell(w, omega)
    columns, y = _cell(a, amplitude)
    block = spectrum.block(nearest, slice(rows[0], rows[-1] + 1))
    outcomes = {int(block["outcome"][r - rows[0], c]) for r in rows for c in columns}
    if Outcome.NOT_COMPUTED in outcomes:
        raise UsageError(f"{spectrum.path}: this part of the spectrum is not computed; --exact computes it")
    record = _record(structure, amplitude, omega, shaking)
    margin = min((_margin(block["outcome"][r - rows[0]], a, amplitude) for r in rows), default=math.inf)
    safe = all(Outcome(o).safe for o in outcomes)
    exact = response(LINEAR.system_of(structure), spectrum.motion(), np.array([amplitude]), np.array([omega]), structure.eta)
    truth = Outcome(int(exact.outcome[0]))
    agree = truth.safe if safe else outcomes == {truth}
    if not agree:
        return {**record, "theta_max": None, "theta_ratio": None, "outcome": "undecided", "margin": 0.0, "interpolation_error": None}
    ratio = error = None
    if safe:
        theta = block["theta_ratio"][[[r - rows[0]] for r in rows], columns]
        across = np.array([1 - y, y][: len(columns)])
        ratio = float(theta[0] @ across) * (1 - x) + float(theta[-1] @ across) * x if truth == Outcome.ROCKED else 0.0
        error = abs(ratio - float(exact.theta_ratio[0]))
    return {
        **record,
        "theta_max": None if ratio is None else ratio * structure.alpha,
        "theta_ratio": ratio,
        "outcome": truth.flag,
        "margin": margin if math.isfinite(margin) else None,
        "interpolation_error": error,
    }


def predict_exactly(structure: RockingParameters, motion: Motion, shaking: Grid, a_max: float = 0.0) -> dict[str, Any]:
    """The same, computed; no interpolation, and margin to the boundaries, traced up to a_max and at least twice A."""
    amplitude, omega = (float(x[0]) for x in shaking.scaled(structure))
    model = LINEAR.system_of(structure)
    found = response(model, motion, np.array([amplitude]), np.array([omega]), structure.eta)
    outcome = Outcome(int(found.outcome[0]))
    edges = [
        edge
        for i in trace_envelope(motion, [omega], structure, a_max=max(a_max, 2.0 * amplitude, 2.0 / motion.peak))
        for edge in (i.a_from, i.a_to)
        if edge is not None
    ]
    ratio = float(found.theta_ratio[0]) if np.isfinite(found.theta_ratio[0]) else None
    return {
        **_record(structure, amplitude, omega, shaking),
        "theta_max": None if ratio is None else ratio * structure.alpha,
        "theta_ratio": ratio,
        "outcome": outcome.flag,
        "margin": min((abs(e - amplitude) / amplitude for e in edges), default=None),
        "interpolation_error": 0.0 if ratio is not None else None,
    }


def _record(structure: RockingParameters, amplitude: float, omega: float, shaking: Grid) -> dict[str, Any]:
    units = {}
    if not structure.dimensionless:
        units = {"a_g": float(structure.ground_acceleration(amplitude)), "omega_g": omega * structure.p}
    return {"structure": structure.name, "eta": structure.eta, "A": amplitude, "Omega": omega, **units}


def _cell(axis: np.ndarray, value: float) -> tuple[list[int], float]:
    """The grid lines around a value, and its place between them."""
    if axis.size == 1:
        return [0], 0.0
    low = int(np.clip(np.searchsorted(axis, value, side="right") - 1, 0, axis.size - 2))
    place = float((value - axis[low]) / (axis[low + 1] - axis[low]))
    return ([low], 0.0) if place == 0.0 else ([low + 1], 0.0) if place == 1.0 else ([low, low + 1], place)


def _margin(outcomes: np.ndarray, axis: np.ndarray, value: float) -> float:
    """Relative distance from a value to the nearest change between safe and overturned along a row: a lower bound."""
    over = overturned(outcomes)
    at = np.flatnonzero(over[1:] != over[:-1])
    if not at.size:
        return math.inf
    low, high = axis[at], axis[at + 1]
    distance = np.where(value < low, low - value, np.where(value > high, value - high, 0.0))
    return float(distance.min() / value)
