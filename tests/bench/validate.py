"""The rows of `rocking help validation` that need nothing but the package: closed
forms, other integrators, a thrust line.

Each line gives what was compared, with which source, the number of cases and the
largest difference; the exit code is 1 if one is too large or an outcome differs.
PYTHONPATH holds tests/, as make validate says.
"""

import math
import sys

import numpy as np
import peers
from oracles.thrust_line import largest_tilt
from scipy.integrate import quad
from scipy.optimize import brentq

from rocking_cli import (
    HazardCurve,
    annual_rate,
    build_structure,
    dimensionless_oscillator,
    fit_stripes,
    nonlinear_response,
    parse_documents,
    pulse,
    trace_envelope,
)

OMEGAS = (0.5, 1.0, 2.0, 4.0, 6.0)
ARCHES = (
    (10.0, 1.5, 157.5, 7),
    (10.0, 1.5, 157.5, 4),
    (1.0, 0.25, 180.0, 9),
    (1.0, 0.2, 140.0, 5),
    (5.0, 0.7, 120.0, 11),
    (1.0, 0.15, 150.0, 15),
)


def overturns_without_impact(name: str, omega: float) -> float:
    """A from which the linear oscillator overturns without impact: z = y + v - 1 must
    reach 0 while the pulse lasts, z' = z + A s.
    """
    motion = pulse(name)
    stop = float(motion.pieces[-1].stop) / omega

    def ends(a: float) -> float:
        start = 0.0 if name == "rectangular" else math.asin(1.0 / a) / omega
        drive = (
            (lambda t: 1.0)
            if name == "rectangular"
            else (lambda t: math.sin(omega * t))
        )
        return (
            a
            * quad(
                lambda t: math.exp(start - t) * drive(t),
                start,
                stop,
                epsabs=0,
                epsrel=1e-13,
            )[0]
            - 1.0
        )

    return float(brentq(ends, 1.0 + 1e-9, 1e3, xtol=1e-14, rtol=1e-14))


def envelopes(name: str) -> tuple[int, float]:
    """(cases, largest relative difference) of the amplitudes that overturn without
    impact.
    """
    worst = 0.0
    for omega in OMEGAS:
        found = trace_envelope(
            dimensionless_oscillator(eta=0.9), pulse(name), [omega], a_max=100.0
        )
        mine = next(i.a_from for i in found if i.mode == "no_impact")
        worst = max(worst, abs(mine / overturns_without_impact(name, omega) - 1.0))
    return len(OMEGAS), worst


def housner() -> tuple[int, float]:
    """The closed form 1/(1 - exp(-p t)) of a rectangular pulse of duration t."""
    stop = float(pulse("rectangular").pieces[-1].stop)
    return len(OMEGAS), max(
        abs(overturns_without_impact("rectangular", w) * -math.expm1(-stop / w) - 1.0)
        for w in OMEGAS
    )


def integrators(count: int = 120) -> tuple[int, float]:
    """Random rigid cells under one sine, Eq. 2.3, against SciPy's DOP853 at 1e-12:
    largest difference of theta/alpha; inf if an outcome differs.
    """
    random, alpha, eta, worst = np.random.default_rng(5), 0.2, 0.9, 0.0
    cells = list(
        zip(
            random.uniform(1.0, 6.0, count),
            random.uniform(1.0, 8.0, count),
            strict=True,
        )
    )
    for (a, omega), (outcome, peak) in zip(
        cells, peers.scipy_cells(cells, eta, alpha, 1e-12), strict=True
    ):
        found = nonlinear_response(
            pulse("sine"), np.array([a]), np.array([omega]), np.array([eta]), alpha
        )
        same = int(found.outcome[0]) == int(outcome)
        difference = (
            abs(float(found.theta_ratio[0]) - peak) if int(outcome) <= 2 else 0.0
        )
        worst = max(worst, difference if same else math.inf)
    return count, worst


def arches() -> tuple[int, float]:
    """lambda of arches against the static theorem, a linear programme."""
    worst = 0.0
    for radius, thickness, angle, count in ARCHES:
        text = (
            f"kind: arch\nradius: {radius}\nthickness: {thickness}\nangle: {angle}"
            f" deg\nvoussoirs: {count}\nrestitution: 0.6"
        )
        mine, tilt = (
            build_structure(parse_documents(text)[0]).uplift,
            largest_tilt(radius, thickness, math.radians(angle), count),
        )
        worst = max(worst, abs(mine / (tilt or math.nan) - 1.0))
    return len(ARCHES), worst


def counts() -> tuple[int, float]:
    """Medians and dispersions of counts, published to seven digits."""
    one = fit_stripes(
        [0.2, 0.3, 0.4, 0.6, 0.7, 0.8, 0.9, 1.0], [40] * 8, [0, 0, 0, 4, 6, 13, 12, 16]
    )
    two = fit_stripes([1.0, 1.5, 2.0], [54] * 3, [2, 25, 43])
    pairs = (
        (one.median, 1.0761158),
        (one.beta, 0.4292372),
        (two.median, 1.5724765),
        (two.beta, 0.2700332),
    )
    return 2, max(abs(mine / stated - 1.0) for mine, stated in pairs)


def rates() -> tuple[int, float]:
    """The annual rate k0 theta^-k exp(k^2 beta^2/2) of a straight hazard curve."""
    x = np.geomspace(1e-5, 1e5, 7)
    return 1, abs(
        annual_rate(0.43, 0.35, HazardCurve(x, 5e-5 * x**-2.5))
        / (5e-5 * 0.43**-2.5 * math.exp(0.5 * 0.875**2))
        - 1.0
    )


ROWS = (
    ("rectangular pulse, overturning", "closed form, Housner 1963", housner, 1e-11),
    (
        "rectangular pulse, envelope",
        "quadrature of the unstable mode",
        lambda: envelopes("rectangular"),
        1e-9,
    ),
    (
        "half sine, envelope",
        "quadrature of the unstable mode",
        lambda: envelopes("half-sine"),
        1e-9,
    ),
    ("rocking under a sine, Eq. 2.3", "SciPy's DOP853 at 1e-12", integrators, 1e-6),
    ("lambda of arches", "thrust line, linear programme", arches, 1e-7),
    ("fragility of counts", "Baker 2015, two tables", counts, 1e-7),
    ("annual rate", "closed form, straight hazard curve", rates, 1e-11),
)


def main() -> int:
    """Print the rows; 1 if a difference is too large."""
    failed = 0
    for name, source, compare, most in ROWS:
        cases, worst = compare()
        failed |= not worst <= most
        print(
            f"{name:33} {source:36} {cases:4}"
            f" {worst:9.1e}{'' if worst <= most else f'  above {most:g}'}",
            flush=True,
        )
    return failed


if __name__ == "__main__":
    sys.exit(main())
