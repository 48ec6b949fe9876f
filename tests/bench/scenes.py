"""The scenes that are timed and traced: one structure under one motion over a grid, each as a run that answers how many cells it had."""

from __future__ import annotations

import math
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np

from rocking_cli import (
    Method,
    Motion,
    System,
    build_structure,
    dimensionless_oscillator,
    linear_response,
    nonlinear_response,
    parse_documents,
    parse_grid,
    pulse,
    response,
    sine,
    trace_envelope,
    write_spectrum,
)
from rocking_cli.dynamics.equations.rigid_body import RigidBodyEquation
from rocking_cli.motions import Harmonic, Piece
from rocking_cli.motions.biaxial import with_vertical

ETA, ALPHA = 0.9, 0.25
ARCH = Path(__file__).resolve().parents[2] / "configs" / "arch.yaml"


def axis(values: int) -> np.ndarray:
    """A and Omega alike."""
    return np.linspace(0.5, 12.0, values)


def linear(motion: Motion, values: int) -> int:
    """Linear oscillators."""
    linear_response(motion, axis(values)[None, :], axis(values)[:, None], ETA)
    return values * values


def nonlinear(values: int) -> int:
    """Rigid bodies at a tolerance of 1e-9."""
    nonlinear_response(sine(), axis(values)[None, :], axis(values)[:, None], ETA, ALPHA)
    return values * values


def weighed(values: int) -> int:
    """Rigid bodies on ground that moves upwards too, at another frequency."""
    up = Motion("up", (Piece(0.0, 2.0 * math.pi, (Harmonic(1.0, 2.3, 0.3),)),))
    system = System(RigidBodyEquation(ALPHA), scale=ALPHA)
    response(system, with_vertical(sine(), up, 0.3), axis(values)[None, :], axis(values)[:, None], ETA)
    return values * values


def arch() -> tuple[System, float]:
    """The arch of seven voussoirs as it is shipped, at a tolerance of 1e-9, and its restitution."""
    built = build_structure(parse_documents(ARCH.read_text(encoding="utf-8"))[0])
    return Method("nonlinear").system_of(built), built.eta


def arches(values: int) -> int:
    """That arch."""
    system, eta = arch()
    response(system, sine(), axis(values)[None, :], axis(values)[:, None], eta)
    return values * values


def envelope(motion: Motion, frequencies: int, workers: int | None = None) -> int:
    """Every boundary up to A = 20; the count is that of the frequencies."""
    trace_envelope(dimensionless_oscillator(ETA), motion, np.linspace(0.5, 12.0, frequencies), workers=workers)
    return frequencies


def lossless() -> int:
    """Bodies that hardly lose speed, lifted just above uplift: trains of bounces without number."""
    amplitude, omega, eta = np.meshgrid([1 + 1e-9], [0.5, 2.0, 8.0], [1 - 1e-6, 1 - 1e-9, 1.0], indexing="ij")
    linear_response(sine(), amplitude, omega, eta)
    return amplitude.size


def file(values: int, workers: int = 1, scheduler: str | None = None) -> int:
    """Linear oscillators with the check and the file."""
    grid = parse_grid(f"A=0.5:12:{values},Omega=0.5:12:{values}")
    with tempfile.TemporaryDirectory() as folder:
        write_spectrum([dimensionless_oscillator(ETA)], sine(), grid, Path(folder) / "scene.h5", workers=workers, scheduler=scheduler)
    return values * values


SCENES: dict[str, Callable[[], int]] = {
    "linear": partial(linear, sine(), 1000),
    "linear-small": partial(linear, sine(), 100),
    "ricker": partial(linear, pulse("ricker-symmetric"), 100),
    "mavroeidis": partial(linear, pulse("mavroeidis-papageorgiou"), 100),
    "nonlinear": partial(nonlinear, 300),
    "vertical": partial(weighed, 150),
    "arch": partial(arches, 100),
    "envelope": partial(envelope, sine(), 400, 1),
    "envelope-cycles": partial(envelope, sine(5), 40, 1),
    "lossless": lossless,
    "file": partial(file, 1000),
}
