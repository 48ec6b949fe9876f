"""Measured errors of the table of stiff and extreme cells, both equations, against paths that share no code with the engine.

A row's cells are computed by the engine (nonlinear at tolerance 1e-11) and one by one by the slower path of checks. A rigid body that
rises by less than 1e-7 bounces through thousands of its steps; its reference is the linear one times sin(alpha)/alpha, from which it
differs by a part of (4 sqrt(2 (A - 1))/Omega)^2, the square of its time in the air. Cells that a reference gives up are counted apart.
"""

from __future__ import annotations

import math

import numpy as np

from rocking_cli import (
    Method,
    Outcome,
    RockingParameters,
    build_structure,
    dimensionless_oscillator,
    linear_response,
    parse_documents,
    pulse,
    response,
    sine,
    trace_envelope,
)  # fmt: skip

METHOD = Method("nonlinear", 1e-11)
LINEAR = Method().reference_of(dimensionless_oscillator(0.9))


def cells(*axes):
    return (np.ravel(x) for x in np.meshgrid(*axes, indexing="ij"))


def low(motion, amplitude, omega, eta, alpha):
    """(outcome, theta/alpha) of a rigid body that hardly rises in short hops, None of others."""
    if omega < 1.0 or amplitude > 1.01:
        return None
    outcome, theta = LINEAR(motion, amplitude, omega, eta)
    return (outcome, theta * math.sin(alpha) / alpha) if outcome == Outcome.ROCKED and theta < 1e-7 else None


def row(name, motion, amplitude, omega, eta, alpha=0.25, structure=None):
    """Engine against references; amplitudes are over that of uplift."""
    amplitude, omega, eta = (np.ravel(x) for x in np.broadcast_arrays(amplitude, omega, eta))
    lift = math.tan(alpha) / alpha if structure is None else 1.0
    body = structure or RockingParameters("body", "block", 1.0, alpha, 0.9, math.tan(alpha), 1.0)
    nonlinear = METHOD.reference_of(body)
    said = []
    for found, reference in (
        (linear_response(motion, amplitude, omega, eta), lambda a, w, n: LINEAR(motion, a, w, n)),
        (
            response(METHOD.system_of(body), motion, lift * amplitude, omega, eta),
            lambda a, w, n: low(motion, a, w, n, alpha) or nonlinear(motion, lift * a, w, n),
        ),
    ):
        worst, differ, lost = 0.0, 0, 0
        for i, cell in enumerate(zip(amplitude, omega, eta, strict=True)):
            outcome, theta = reference(*(float(x) for x in cell))
            if outcome == Outcome.FAILED:
                lost += 1
                continue
            differ += outcome != found.outcome[i]
            if outcome == found.outcome[i] and not math.isnan(theta):
                worst = max(worst, abs(theta - float(found.theta_ratio[i])))
        said.append(f"{worst:8.1e} {differ:3d} differ {lost:3d} not checked")
    print(f"{name:<46}{amplitude.size:4d} cells | {said[0]} | {said[1]}", flush=True)


def main() -> None:
    print(f"{'':<46}{'':10} | linear: largest error of theta/alpha  | nonlinear")
    strong = np.array([1 + 1e-12, 1.001, 2.0, 1e2, 1e8])
    etas = [0.0, 0.9]  # with less loss the references take minutes for thousands of bounces
    for omega in (1e-4, 1e-2, 1.0, 1e2, 1e4):
        amplitude, eta = cells(strong, etas)
        row(f"A = 1 + 1e-12 ... 1e8, Omega = {omega:g}", sine(), amplitude, omega, eta)
    row("impulses, Omega = 1e4", pulse("half-sine"), np.linspace(1000, 9000, 3), 1e4, 0.5)
    for alpha in (1e-6, 1e-3, 1.2):
        amplitude, omega = cells([1.0001, 1.5, 8.0], [0.5, 4.0, 20.0])
        row(f"alpha = {alpha:g}", sine(), amplitude, omega, 0.9, alpha)
    row("100 cycles", sine(100), [1.0005, 1.2], [30.0, 60.0], 0.2)
    for omega in (2.0, 5.0):
        edges = [a for i in trace_envelope(dimensionless_oscillator(0.9), sine(), [omega], a_max=10) for a in (i.a_from, i.a_to) if a]
        row(f"1e-9 beside a boundary, Omega = {omega:g}", sine(), [a * (1 + f * 1e-9) for a in edges for f in (-1, 1)], omega, 0.9)
    row("drives that jump", pulse("rectangular-impulse"), [1.5, 2.0 + 1e-6, 3.0], [3.0, 8.0, 300.0], 0.5)
    arch = "kind: arch\nradius: 10\nthickness: 1.0751 m\nangle: 180 deg\nrestitution: 0.8"
    row("an arch at the edge of stability", sine(), [1.1, 1.5, 4.0, 12.0], 4.0, 0.8, structure=build_structure(parse_documents(arch)[0]))


if __name__ == "__main__":
    main()
