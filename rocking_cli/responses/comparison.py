"""Comparison of structures under motions of equal A and Omega, whose dimensionless
curves collapse (Fig. 8), and of the linear with the nonlinear equation (Fig. 7).
"""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from ..dynamics.method import Method, governing_method, methods_of
from ..motions.given import AnyMotion, demand_of
from ..motions.grid import Axis, Grid
from ..structures.given import Structure, structures_from
from ..structures.parameters import RockingParameters
from .history import quarter_period
from .time_history import TimeHistory, time_history

# The columns that say which row it is: of a structure, and of a point of a curve.
RELEASES = (0.3, 0.6, 0.9)  # theta/alpha of the free quarter periods (Fig. 7b)
_SAMPLES = 4001
_SHAKEN = 201  # times at least of a curve while the ground moves


def scaled_alike(
    structure: RockingParameters, shaking: Grid, first: RockingParameters
) -> Grid:
    """Return the grid of one cell, a_g and omega_g, that gives `structure` the A and
    Omega that `shaking` gives `first`.
    """
    shaking.require_one_cell()
    amplitude, omega = shaking.scaled(first)
    if structure.dimensionless:
        return Grid(Axis("A", amplitude), Axis("Omega", omega))
    return Grid(
        Axis("a_g", structure.ground_acceleration(amplitude)),
        Axis("omega_g", omega * structure.p),
    )


def compare(
    structures: Structure | Sequence[Structure],
    motion: AnyMotion,
    shaking: Grid | str | None = None,
    methods: Method | str | Sequence[Method | str] = (),
) -> list[TimeHistory]:
    """Return the response of each structure to one motion, at equal A and Omega.

    Structures of equal restitution then have one linear response theta/alpha over p t
    (section 4 of the paper).

    Parameters
    ----------
    structures
        one or more: parameters, documents, paths, or texts such as "block:0.5x2"
    motion
        the motion of the ground: an object, the name of a pulse, or a path
    shaking
        amplitude and frequency for the first structure, a grid of one cell or its text;
        a record does not need it
    methods
        the equations of motion or their names, such as "linear"; empty for the
        nonlinear one if all geometries are known and the motion has units, else the
        linear one

    Returns
    -------
    list of TimeHistory
        in the order of `structures`

    Raises
    ------
    UsageError
        for a demand of zero, or an equation that does not hold for a structure

    Examples
    --------
    >>> structures = load_structures(["configs/block.yaml", "configs/arch.yaml"])
    >>> found = compare(structures, sine(), parse_grid("A=2,Omega=5"))
    >>> [history.outcome("linear").flag for history in found]
    ['rocked', 'rocked']
    """
    bodies = structures_from(structures)
    motion, shaking = demand_of(motion, shaking)
    methods = methods_of(methods) or [
        governing_method(*bodies, dimensionless=shaking.dimensionless)
    ]
    return [
        time_history(s, motion, scaled_alike(s, shaking, bodies[0]), methods)
        for s in bodies
    ]


def collapse(responses: Sequence[TimeHistory], model: str) -> float:
    """Return the largest distance between the curves theta/alpha over p t of the
    structures by one equation [-].
    """
    curves = [r.histories[model] for r in responses]
    tau = np.linspace(0.0, min(r.end_of(model) for r in responses), _SAMPLES)
    first, *others = (c.at(tau)[0] for c in curves)
    return max((float(np.abs(other - first).max()) for other in others), default=0.0)


def comparison_rows(
    responses: Sequence[TimeHistory], methods: Sequence[Method]
) -> Iterator[dict[str, Any]]:
    """Yield a row for each structure: motion in units (no frequency for a record),
    peaks, and for two equations their difference and ratios of quarter periods.
    """
    for r in responses:
        s = r.structure
        # A record has no frequency.
        omega = None if r.motion.acceleration is not None else r.omega
        row: dict[str, Any] = {
            "structure": s.name,
            "eta": s.eta,
            "A": r.amplitude,
            "Omega": omega,
            "a_g": s.ground_acceleration(r.amplitude),
            "omega_g": None if omega is None else omega * s.p,
        }
        ratios: list[float] = []
        for method in methods:
            found = r.histories[method.model]
            suffix = f"_{method.model}" if len(methods) > 1 else ""
            peak = found.peak
            ratio = None if peak is None else abs(peak.theta_ratio)
            ratios += [] if ratio is None else [ratio]
            row |= {
                f"outcome{suffix}": found.outcome.flag,
                f"theta_max{suffix}": (
                    None
                    if peak is None
                    else float(s.alpha_on(peak.side)) * abs(peak.theta_ratio)
                ),
                f"theta_ratio{suffix}": ratio,
                f"t_max{suffix}": None if peak is None else peak.tau / s.p,
            }
        if len(methods) > 1:
            row["peak_difference"] = (
                ratios[1] / ratios[0] - 1.0 if len(ratios) == 2 else None
            )
            for release in RELEASES:
                linear, nonlinear = (
                    quarter_period(m.system_of(s), release) for m in methods
                )
                row[f"quarter_period_ratio_{release:g}"] = nonlinear / linear
        yield row


def curve_rows(
    responses: Sequence[TimeHistory], methods: Sequence[Method]
) -> Iterator[dict[str, Any]]:
    """Yield the points of all curves: structure, model, t [s], theta [rad], tau,
    theta/alpha, ground acceleration [m/s2], motion.
    """
    for r in responses:
        tau = np.union1d(
            r.times(None, False), np.linspace(0.0, r.motion.duration / r.omega, _SHAKEN)
        )
        ground = r.structure.ground_acceleration(
            r.amplitude * r.motion.value(tau * r.omega)
        )
        for method in methods:
            found = r.histories[method.model]
            for x, y, alpha, a in zip(
                tau,
                found.at(tau)[0],
                r.structure.alpha_on(found.sides(tau)),
                ground,
                strict=True,
            ):
                if np.isfinite(y):
                    yield {
                        "structure": r.structure.name,
                        "model": method.model,
                        "t": float(x) / r.structure.p,
                        "theta": float(alpha) * float(y),
                        "tau": float(x),
                        "theta_ratio": float(y),
                        "ground_acceleration": float(a),
                        "motion": r.motion.name,
                        "demand_A": r.amplitude,
                        "Omega": r.omega,
                    }
