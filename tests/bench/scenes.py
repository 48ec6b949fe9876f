"""The scenes that `make bench` times: one structure under one motion over a grid, each
a function that returns its number of cells.

`python tests/bench/scenes.py [SCENE...]`, or `make trace SCENE="linear arch"`, prints
where their time goes, function by function.
"""

import cProfile
import math
import pstats
import sys
import tempfile
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from rocking_cli import (
    LinearEquation,
    Method,
    Motion,
    RigidBodyEquation,
    RockingParameters,
    System,
    dimensionless_oscillator,
    load_structures,
    parse_grid,
    pulse,
    response,
    sine,
    trace_envelope,
    write_spectrum,
)
from rocking_cli.motions import Harmonic, Piece
from rocking_cli.motions.biaxial import with_vertical
from rocking_cli.motions.recording import Recording
from rocking_cli.motions.records import Record
from rocking_cli.structures.parameters import Side

ETA, ALPHA = 0.9, 0.25
CONFIGS = Path(__file__).resolve().parents[2] / "configs"
UPWARDS = Motion("up", (Piece(0.0, 2.0 * math.pi, (Harmonic(1.0, 2.3, 0.3),)),))
LEFT, RIGHT = (
    Side("left", 2.0, 0.2, math.tan(0.2), 1.0, ETA),
    Side("right", 2.1, 0.22, math.tan(0.22), 1.0, ETA),
)
PLAIN = RockingParameters(
    name="symmetric",
    structure="block",
    p=2.0,
    alpha=0.2,
    eta=ETA,
    uplift=math.tan(0.2),
    a_scale=1.0,
)
BODIES = {
    "unequal": RockingParameters.of_sides("unequal", "prism", LEFT, RIGHT),
    "one-sided": replace(PLAIN, eta=-0.45, one_sided=True),
    "damped": replace(PLAIN, damping=0.05),
}


def axis(values: int) -> np.ndarray:
    """A and Omega alike."""
    return np.linspace(0.5, 12.0, values)


def cells(system: System, motion: Motion, values: int, eta: float = ETA) -> int:
    """A system over the grid of both axes."""
    response(system, motion, axis(values)[None, :], axis(values)[:, None], eta)
    return values * values


def body(structure: RockingParameters, model: str, values: int) -> int:
    """A structure under one cycle of a sine."""
    return cells(Method(model).system_of(structure), sine(), values, structure.eta)


def arch(values: int) -> int:
    """The arch of seven voussoirs as it is shipped, at a tolerance of 1e-9."""
    return body(load_structures(CONFIGS / "arch.yaml")[0], "nonlinear", values)


def quake(count: int, dt: float, seed: int) -> np.ndarray:
    """Noise about 2 Hz that swells and fades, 3.4 m/s2 at its peak."""
    f, t = np.fft.rfftfreq(count, dt), np.arange(count) / count
    colour = (
        f
        * f
        / (
            (0.06 + f * f)
            * np.sqrt((1.0 - (f / 2.0) ** 2) ** 2 + (0.6 * f) ** 2)
            * (1.0 + (f / 10.0) ** 4)
        )
    )
    a = np.fft.irfft(
        np.fft.rfft(np.random.default_rng(seed).standard_normal(count)) * colour, count
    )
    a *= np.minimum(t / 0.06, 1.0) * np.where(t < 0.2, 1.0, np.exp(-7.3 * (t - 0.2)))
    return 3.4 * a / np.abs(a).max()


def recording(samples: np.ndarray, dt: float, number: int = 0) -> Recording:
    """Samples [m/s2] as a synthetic record."""
    return Recording(
        Record(
            f"synthetic-{number}",
            "text",
            None,
            dt,
            samples,
            None,
            "m/s2",
            "none",
            f"{number:064x}",
        )
    )


def shaken(system: System, finer: int = 1, longer: int = 1, values: int = 200) -> int:
    """A system under a record of 2,000 samples: A 1 ... 8, 2 pi/p 0.5 ... 12 s; finer:
    parts of each sample; longer: times as many in the same time.
    """
    samples, dt = quake(2000 * longer, 0.01 / longer, 1), 0.01 / longer
    if finer > 1:
        samples, dt = (
            np.interp(
                np.arange(finer * (samples.size - 1) + 1) / finer,
                np.arange(samples.size),
                samples,
            ),
            dt / finer,
        )
    amplitude, size = (
        np.linspace(1.0, 8.0, values)[None, :],
        np.linspace(0.5, 12.0, values)[:, None] / (2.0 * np.pi),
    )
    response(system, recording(samples, dt).motion, amplitude, size, ETA)
    return values * values


def envelope(motion: Motion, frequencies: int, workers: int | None = None) -> int:
    """Every boundary up to A = 20; the count is that of the frequencies."""
    trace_envelope(
        dimensionless_oscillator(eta=ETA), motion, axis(frequencies), workers=workers
    )
    return frequencies


def lossless() -> int:
    """Bodies that hardly lose speed, lifted just above uplift: sequences of impacts
    without number.
    """
    amplitude, omega, eta = np.meshgrid(
        [1 + 1e-9], [0.5, 2.0, 8.0], [1 - 1e-6, 1 - 1e-9, 1.0], indexing="ij"
    )
    response(LINEAR, sine(), amplitude, omega, eta)
    return amplitude.size


def file(values: int, workers: int = 1, scheduler: str | None = None) -> int:
    """Linear oscillators with the check and the file."""
    grid = parse_grid(f"A=0.5:12:{values},Omega=0.5:12:{values}")
    with tempfile.TemporaryDirectory() as folder:
        write_spectrum(
            [dimensionless_oscillator(eta=ETA)],
            sine(),
            grid,
            Path(folder) / "scene.h5",
            workers=workers,
            scheduler=scheduler,
        )
    return values * values


LINEAR, RIGID = System(LinearEquation()), System(RigidBodyEquation(ALPHA), scale=ALPHA)
SCENES: dict[str, Callable[[], int]] = {
    "linear": partial(cells, LINEAR, sine(), 1000),
    "linear-small": partial(cells, LINEAR, sine(), 100),
    "ricker": partial(cells, LINEAR, pulse("ricker-symmetric"), 100),
    "mavroeidis": partial(cells, LINEAR, pulse("mavroeidis-papageorgiou"), 100),
    "nonlinear": partial(cells, RIGID, sine(), 300),
    "vertical": partial(cells, RIGID, with_vertical(sine(), UPWARDS, 0.3), 150),
    "arch": partial(arch, 100),
    **{
        f"{name}-linear": partial(body, one, "linear", 300)
        for name, one in BODIES.items()
    },
    **{
        f"{name}-nonlinear": partial(body, one, "nonlinear", 100)
        for name, one in BODIES.items()
    },
    "envelope": partial(envelope, sine(), 400, 1),
    "envelope-cycles": partial(envelope, sine(5), 40, 1),
    "lossless": lossless,
    "file": partial(file, 1000),
    "record": partial(shaken, LINEAR),
    "record-fine": partial(shaken, LINEAR, finer=4),
    "record-long": partial(shaken, LINEAR, longer=10),
    "record-nonlinear": partial(shaken, RIGID),
}


def trace(name: str) -> None:
    """Print the 25 functions in which a scene spends most, by their own time."""
    profile = cProfile.Profile()
    count = profile.runcall(SCENES[name])
    print(f"{name}: {count} cells")
    pstats.Stats(profile).sort_stats("tottime").print_stats(25)


if __name__ == "__main__":
    for chosen in sys.argv[1:] or SCENES:
        if chosen not in SCENES:
            sys.exit(f"no scene {chosen!r}; expected {', '.join(SCENES)}")
        trace(chosen)
