"""Overturning envelopes: for each frequency, every interval of amplitudes that overturns, traced by root finding.

Between the interval that overturns after an impact and the one that overturns without lies a safe window, so a threshold
is not enough. The outcome is computed on amplitudes 1e-3 apart, which no wider interval escapes, and closer just above
uplift; every change between neighbours is bisected down to the last digits. Slow pulses (Omega below 1) have intervals
narrower than the scan, and more of them the closer one looks: those can be missed, safe ones and overturning ones.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..dynamics.engine import response
from ..dynamics.outcome import Outcome
from ..errors import UsageError
from ..motions import Motion, pulse
from ..structures.parameters import RockingParameters
from .grid import Axis, parse_axes
from .scene import LINEAR, Method

A_MAX = 20.0
SCAN_STEP = 0.999e-3  # no interval wider than 1e-3 in A escapes
INTERVAL_COLUMNS = ("structure", "Omega", "A_from", "A_to", "mode")
CURVE_COLUMNS = ("structure", "curve", "Omega", "A")
_BATCH = 1_000_000

Labels = Callable[[np.ndarray, np.ndarray], np.ndarray]
_MODES = {
    Outcome.OVERTURNED_AFTER_IMPACT: "after_impact",
    Outcome.OVERTURNED_NO_IMPACT: "no_impact",
    Outcome.FAILED: "failed",
}


@dataclass(frozen=True)
class Interval:
    """An interval of amplitudes that overturns at one Omega: from A_from to A_to (None: on beyond the limit)."""

    omega: float
    a_from: float
    a_to: float | None
    mode: str


def trace_envelope(
    motion: Motion,
    omegas: Sequence[float] | np.ndarray,
    structure: RockingParameters,
    *,
    method: Method = LINEAR,
    a_max: float = A_MAX,
    progress: Callable[[int, int], None] | None = None,
) -> list[Interval]:
    """Every overturning interval with A up to `a_max`, wider than 1e-3, for each Omega [-] of a structure.

    For a linear oscillator of which only the restitution is known give `dimensionless_oscillator(eta)`. Boundaries are
    traced to the last digits of the model's outcome. Intervals that touch but differ in mode are listed apart. Raises
    UsageError when a_max is not above the initiation or the model does not hold for the structure.
    """
    model = method.model_of(structure)
    omegas = np.atleast_1d(np.asarray(omegas, dtype=float))
    lowest = model.initiation / motion.peak

    def outcome(amplitude: np.ndarray, omega: np.ndarray) -> np.ndarray:
        found = response(model, motion, amplitude, omega, structure.eta, peaks=False).outcome
        return np.where(found == Outcome.NO_UPLIFT, np.uint8(Outcome.ROCKED), found)  # safe is safe

    if not (np.isfinite(a_max) and a_max > lowest):
        raise UsageError(f"a-max is {a_max:g}, accepted is a finite amplitude above the uplift at A = {lowest:g}")
    if a_max > 1e5:
        raise UsageError(f"a-max is {a_max:g}, accepted is up to 1e5")
    amplitudes = _scan(lowest, a_max)
    intervals: list[Interval] = []
    rows = max(1, _BATCH // amplitudes.size)
    for first in range(0, omegas.size, rows):
        some = omegas[first : first + rows]
        intervals += _trace(outcome, some, amplitudes)
        if progress:
            progress(min(first + rows, omegas.size), omegas.size)
    return intervals


def _scan(lowest: float, highest: float) -> np.ndarray:
    """Amplitudes to look at: SCAN_STEP apart, and closer just above uplift, where slow pulses pack their intervals."""
    even = np.linspace(lowest, highest, int(np.ceil((highest - lowest) / SCAN_STEP)) + 1)
    close = lowest * (1.0 + np.geomspace(1e-3, 0.1, 460))
    return np.unique(np.concatenate([even, close[close < highest]]))


def _trace(outcome: Labels, omegas: np.ndarray, amplitudes: np.ndarray) -> list[Interval]:
    found = outcome(amplitudes[None, :], omegas[:, None])
    row, at = np.nonzero(found[:, 1:] != found[:, :-1])
    marks = _bisect(outcome, omegas[row], amplitudes[at], amplitudes[at + 1], found[row, at], found[row, at + 1], row)
    intervals: list[Interval] = []
    for i, omega in enumerate(omegas):
        label, begin = int(found[i, 0]), float(amplitudes[0])
        for a, following in [*sorted(marks.get(i, [])), (None, 0)]:
            if label in _MODES:
                intervals.append(Interval(float(omega), begin, a, _MODES[Outcome(label)]))
            if a is not None:
                label, begin = following, a
    return intervals


def _bisect(
    outcome: Labels, omega: np.ndarray, low: np.ndarray, high: np.ndarray, below: np.ndarray, above: np.ndarray, row: np.ndarray
) -> dict[int, list[tuple[float, int]]]:
    """Boundaries by row: (amplitude, label above it). A bracket whose middle is of a third kind becomes two."""
    marks: dict[int, list[tuple[float, int]]] = {}
    while omega.size:
        middle = 0.5 * (low + high)
        closed = (high - low <= 4e-16 * high) | (middle <= low) | (middle >= high)
        for i in np.flatnonzero(closed):
            marks.setdefault(int(row[i]), []).append((float(high[i]), int(above[i])))
        go = np.flatnonzero(~closed)
        omega, low, high, below, above, row, middle = (x[go] for x in (omega, low, high, below, above, row, middle))
        label = outcome(middle, omega)
        third = np.flatnonzero((label != below) & (label != above))
        extra = (omega[third], middle[third], high[third], label[third], above[third], row[third])
        lower = label == below
        low, high = np.where(lower, middle, low), np.where(lower, high, middle)
        above = np.where(lower, above, label)
        omega, low, high, below, above, row = (
            np.concatenate([x, y]) for x, y in zip((omega, low, high, below, above, row), extra, strict=True)
        )
    return marks


def frequency_axis(text: str) -> Axis:
    """The single frequency axis of `--grid`: Omega, omega_g, f_g or T_g. Raises UsageError."""
    axes = parse_axes(text)
    if len(axes) != 1 or next(iter(axes)) not in ("Omega", "omega_g"):
        raise UsageError(f"--grid: found {' and '.join(axes)}; accepted is one axis, Omega, omega_g, f_g or T_g")
    return next(iter(axes.values()))


def _scaled(structure: RockingParameters, axis: Axis) -> np.ndarray:
    if axis.name == "Omega":
        return axis.values
    if structure.structure == "dimensionless":
        raise UsageError("a restitution alone has no units: give a structure document, or the axis Omega")
    return axis.values / structure.p


def structure_intervals(
    structure: RockingParameters,
    axis: Axis,
    motion: Motion,
    *,
    method: Method = LINEAR,
    a_max: float = A_MAX,
    progress: Callable[[int, int], None] | None = None,
) -> Iterator[dict[str, Any]]:
    """Records of a structure's overturning intervals, with units where it has any. Raises as `trace_envelope`."""
    for found in trace_envelope(motion, _scaled(structure, axis), structure, method=method, a_max=a_max, progress=progress):
        record = {"structure": structure.name, "Omega": found.omega, "A_from": found.a_from, "A_to": found.a_to, "mode": found.mode}
        if structure.structure != "dimensionless":
            record["omega_g"] = found.omega * structure.p
            record["a_from"] = structure.ground_acceleration(found.a_from)
            record["a_to"] = None if found.a_to is None else structure.ground_acceleration(found.a_to)
        yield record


def structure_curves(structure: RockingParameters, axis: Axis, motion: Motion) -> Iterator[dict[str, Any]]:
    """Records of the closed-form curves for a structure. Raises UsageError where there is no closed form."""
    from .closed_form import PULSES, closed_form_curves

    forms = {pulse(name).pieces: name for name in PULSES}
    if motion.pieces not in forms:
        raise UsageError(f"--closed-form: found {motion.name}; accepted are a sine of 1 cycle, a half sine and a rectangular pulse")
    for point in closed_form_curves(_scaled(structure, axis), structure.eta, forms[motion.pieces]):
        yield {"structure": structure.name, "curve": point.curve, "Omega": point.omega, "A": point.amplitude}
