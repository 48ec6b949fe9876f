"""The response of a structure under one motion, computed and read from a dimensionless
spectrum (section 4 of the paper).
"""

from collections.abc import Hashable
from pathlib import Path
from typing import Any

import numpy as np

from ..dynamics.method import LINEAR
from ..dynamics.outcome import Outcome, safe
from ..dynamics.response import response
from ..envelopes.intervals import A_MAX, HIGHEST, trace_envelope
from ..errors import UsageError
from ..motions import Motion
from ..motions.grid import Grid, parse_grid
from ..structures.given import Structure, structure_from
from ..structures.parameters import RockingParameters
from .file.reader import SpectraFile

ETA_TOLERANCE = 1e-6  # restitutions closer than this count as equal


def predict(
    structure: Structure, spectrum: SpectraFile | str | Path, shaking: Grid | str
) -> dict[str, Any]:
    """Return what a dimensionless spectrum says of a structure (section 4 of the
    paper).

    The row also has the response that is computed for the structure itself, so that the
    error of the reading is known.

    Parameters
    ----------
    structure
        parameters, a document, a path, or a text such as "block:0.5x2"
    spectrum
        a linear spectrum over A and Omega that holds the restitution of the structure
        to 1e-6: an open file or its path
    shaking
        amplitude and frequency, a grid of one cell or its text

    Returns
    -------
    dict
        theta_max [rad], theta_ratio [-], outcome, A, Omega, capacity_demand, margin and
        margin_side; theta_ratio_interpolated is linear between the cells around (A,
        Omega), None unless all of them are safe; interpolation_error is its distance
        from theta_ratio

    Raises
    ------
    UsageError
        when the spectrum has other axes, model or restitutions, or does not reach
        (A, Omega)
    OutputError
        for a file that is no spectra file or is damaged

    Notes
    -----
    The linear equation (Eqs. 2.4, 3.6) decides.

    Examples
    --------
    >>> oscillator = dimensionless_oscillator(eta=0.9)
    >>> grid = parse_grid("A=1:4:50,Omega=1:8:50")
    >>> _ = write_spectrum([oscillator], sine(), grid, "p.h5", workers=1)
    >>> found = predict(oscillator, "p.h5", parse_grid("A=1.5,Omega=6"))
    >>> found["outcome"], round(found["theta_ratio"], 6)
    ('rocked', 0.167098)
    """
    structure = structure_from(structure)
    shaking = parse_grid(shaking) if isinstance(shaking, str) else shaking
    if not isinstance(spectrum, SpectraFile):
        with SpectraFile(spectrum) as file:
            return predict(structure, file, shaking)
    check_linear(spectrum)

    def key(of: RockingParameters) -> Hashable:  # of its dimensionless system
        system = LINEAR.system_of(of).with_restitution(None)
        return system._replace(body=None, scale=None).key()

    same = key(structure)
    etas = {i: s.eta for i, s in enumerate(spectrum.structures) if key(s) == same}
    if not etas:
        raise UsageError(
            f"{structure.name}: the spectrum is for bodies with other edges or damping;"
            " `exact` computes it"
        )
    nearest = min(etas, key=lambda i: abs(etas[i] - structure.eta))
    if abs(etas[nearest] - structure.eta) > ETA_TOLERANCE:
        held = ", ".join(f"{x:g}" for x in sorted(set(etas.values())))
        raise UsageError(
            f"{structure.name}: its eta is {structure.eta:.6g}, the spectrum holds"
            f" {held}; `exact` computes it"
        )
    amplitude, omega = shaking.cell(structure)
    a, w = spectrum.grid.amplitude.values, spectrum.grid.frequency.values
    if not (a[0] <= amplitude <= a[-1] and w[0] <= omega <= w[-1]):
        held = f"A {a[0]:g} to {a[-1]:g}, Omega {w[0]:g} to {w[-1]:g}"
        raise UsageError(
            f"{structure.name}: A = {amplitude:.6g}, Omega = {omega:.6g} is outside the"
            f" spectrum ({held}); `exact` computes it"
        )
    row = predict_exactly(structure, spectrum.motion(), shaking)
    read_off = _interpolated(spectrum, nearest, amplitude, omega)
    theta_ratio = row["theta_ratio"]
    error = (
        None if read_off is None or theta_ratio is None else abs(read_off - theta_ratio)
    )
    return {**row, "theta_ratio_interpolated": read_off, "interpolation_error": error}


def check_linear(spectrum: SpectraFile) -> None:
    """Raise UsageError unless the spectrum is linear and dimensionless."""
    if not spectrum.grid.dimensionless or spectrum.scene["model"] != LINEAR.model:
        raise UsageError(
            f"{spectrum.path}: expected a linear spectrum on axes A and Omega"
        )


def predict_exactly(
    structure: RockingParameters, motion: Motion, shaking: Grid
) -> dict[str, Any]:
    """Compute a row with theta_max [rad], theta_ratio, outcome, and the distance to
    overturning from boundaries traced along A. capacity_demand: the lowest overturning
    amplitude over A, below 1 if a lower amplitude overturns the body; margin: relative
    distance in A to the nearest boundary between standing and overturning; margin_side:
    the side of A on which it lies. They are None if no amplitude up to A_MAX and 2 A
    overturns, and at A = 0. theta_max is None if the edges differ, since the largest
    theta/alpha does not state its edge. Raises UsageError for a demand above the limit
    of a scan.
    """
    amplitude, omega = shaking.cell(structure)
    if 2.0 * amplitude > HIGHEST:
        raise UsageError(
            f"{structure.name}: found A = {amplitude:.6g}; expected up to"
            f" {HIGHEST / 2.0:g}"
        )
    found = response(
        LINEAR.system_of(structure),
        motion,
        np.array([amplitude]),
        np.array([omega]),
    )
    # `+`: the motion as it is, not reversed
    falls = trace_envelope(
        structure,
        motion,
        [omega],
        a_max=max(A_MAX, 2.0 * amplitude, 2.0 / motion.largest),
        sign="+",
    )
    ends = [edge for i in falls for edge in (i.a_from, i.a_to) if edge is not None]
    # between two overturning modes there is no boundary
    edges = [edge for edge in ends if ends.count(edge) == 1]
    nearest = (
        min(edges, key=lambda edge: abs(edge - amplitude), default=None)
        if amplitude > 0.0
        else None
    )
    ratio = float(found.theta_ratio[0]) if np.isfinite(found.theta_ratio[0]) else None
    si = (
        {}
        if structure.dimensionless
        else {
            "a_g": float(structure.ground_acceleration(amplitude)),
            "omega_g": omega * structure.p,
        }
    )
    return {
        "structure": structure.name,
        "eta": structure.eta,
        "A": amplitude,
        "Omega": omega,
        **si,
        "theta_max": (
            None if ratio is None or structure.sides else ratio * structure.alpha
        ),
        "theta_ratio": ratio,
        "outcome": Outcome(int(found.outcome[0])).flag,
        "capacity_demand": (
            falls[0].a_from / amplitude if falls and amplitude > 0.0 else None
        ),
        "margin": None if nearest is None else abs(nearest - amplitude) / amplitude,
        "margin_side": (
            None if nearest is None else "above" if nearest > amplitude else "below"
        ),
        "theta_ratio_interpolated": None,
        "interpolation_error": None,
    }


def _interpolated(
    spectrum: SpectraFile, index: int, amplitude: float, omega: float
) -> float | None:
    """Return theta_ratio interpolated between the cells around (A, Omega), None unless
    all of them are safe.
    """
    places = []
    for axis, value in (
        (spectrum.grid.frequency.values, omega),
        (spectrum.grid.amplitude.values, amplitude),
    ):
        low = int(np.searchsorted(axis, value, side="right")) - 1
        on_a_line = axis[low] == value
        share = (
            0.0
            if on_a_line
            else float((value - axis[low]) / (axis[low + 1] - axis[low]))
        )
        places.append((slice(low, low + (1 if on_a_line else 2)), share))
    (rows, x), (columns, y) = places
    block = spectrum.block(index, rows, columns)
    if not safe(block["outcome"]).all():
        return None
    across = block["theta_ratio"] @ np.array([1 - y, y][: columns.stop - columns.start])
    return float(across[0] * (1 - x) + across[-1] * x)
