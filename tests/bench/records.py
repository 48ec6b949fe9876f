"""Records: the flight beside the march through all samples and a compiled kernel that walks through them, in turns of one run.

Scene R: a synthetic record of 2,000 points, A 1 ... 8, 2 pi/p 0.5 ... 12 s, eta 0.9, by the linear equation, which is flown, and by
Eq. 2.3, which is walked (alpha 0.25, tolerance 1e-9). `--values` sets the values of each axis; the march takes every eighth of them, so
that its narrow rounds are fewer than those of a whole scene.
"""

from __future__ import annotations

import argparse
import resource
import time

import compiled_record
import numba
import numpy as np

from rocking_cli import LinearEquation, RigidBodyEquation, System, linear_response, nonlinear_response
from rocking_cli.dynamics.equations.equation import Equation
from rocking_cli.dynamics.march.batch import Batch
from rocking_cli.dynamics.march.engine import Run
from rocking_cli.motions.polyline import Polyline, record_motion
from rocking_cli.motions.records import Record

ETA, ALPHA, TURNS = 0.9, 0.25, 2
MOST, QUICKER, KERNEL, REFINED, LONGER, NONLINEAR = 60.0, 10.0, 0.25, 1.5, 2.0, 300.0  # the marks


def shaken(samples: np.ndarray, dt: float) -> Polyline:
    return record_motion(Record("synthetic", "text", None, dt, samples, None, "m/s2", "synthetic", ""))


def noise(count: int, dt: float, seed: int = 1) -> np.ndarray:
    """Noise about 2.5 Hz that swells and fades."""
    f = np.fft.rfftfreq(count, dt)
    low = (f / 0.2) ** 2 / np.sqrt((1.0 - (f / 0.2) ** 2) ** 2 + (1.2 * f / 0.2) ** 2)
    ground = np.sqrt((1.0 + 1.44 * (f / 2.5) ** 2) / ((1.0 - (f / 2.5) ** 2) ** 2 + 1.44 * (f / 2.5) ** 2))
    white = np.fft.rfft(np.random.default_rng(seed).standard_normal(count))
    t = np.arange(count) / count
    return (
        np.fft.irfft(white * low * ground / (1.0 + (f / 12.0) ** 4), count)
        * np.minimum(1.0, t / 0.12)
        * np.exp(-4.0 * np.maximum(0.0, t - 0.35))
    )


def marched(motion: Polyline, amplitude: np.ndarray, omega: np.ndarray, equation: Equation) -> Run:
    a, w = np.broadcast_arrays(amplitude[None, :], omega[:, None])
    run = Run(Batch.of(System(equation), motion.segments, a.ravel(), w.ravel(), np.full(a.size, ETA)))
    run.all()
    return run


def scene(values: int) -> None:
    """Least process time of each, in turns; what each is held against."""
    numba.set_num_threads(1)
    samples = noise(2000, 0.01)
    fine = np.interp(np.arange(4 * 2000 - 3) / 4.0, np.arange(2000), samples)
    motions = {"2,000 points": shaken(samples, 0.01), "the same four times as finely": shaken(fine, 0.0025)}
    motions["20,000 points in the same time"] = shaken(noise(20_000, 0.001), 0.001)
    amplitude, omega = np.linspace(1.0, 8.0, values), np.linspace(0.5, 12.0, values) / (2.0 * np.pi)
    some = slice(None, None, 8)
    first = motions["2,000 points"]
    walk = {name: (m.samples.values, m.segments.later_max, m.samples.step) for name, m in motions.items()}
    walk = {n: (s, np.maximum.accumulate(np.abs(s)[::-1])[::-1].copy(), step) for n, (s, _, step) in walk.items()}
    compiled_record.sweep(*walk["2,000 points"], amplitude[:2], omega[:2], ETA)
    best: dict[str, float] = {}

    def note(name, action, cells):
        start = time.process_time()
        found = action()
        best[name] = min(best.get(name, np.inf), 1e6 * (time.process_time() - start) / cells)
        return found

    for _ in range(TURNS):
        for name, motion in motions.items():
            found = note(name, lambda m=motion: linear_response(m, amplitude[None, :], omega[:, None], ETA), values**2)
            if motion is first:
                theta, outcome = found.theta_ratio, found.outcome
            elif name.startswith("the same"):
                gap = np.abs(found.theta_ratio - theta)
                refined = f"{(found.outcome != outcome).sum()} outcomes differ, 99.9 % within {np.nanquantile(gap, 0.999):.1e}"
        answer = note(
            "compiled kernel, 2,000 points", lambda: compiled_record.sweep(*walk["2,000 points"], amplitude, omega, ETA), values**2
        )
    few = amplitude[some].size ** 2
    small = note("march, every eighth value", lambda: marched(first, amplitude[some], omega[some], LinearEquation()), few)
    small_flight = note(
        "flight, every eighth value",
        lambda: linear_response(first, amplitude[None, some], omega[some, None], ETA),
        few,
    )
    slow = note(
        "march of Eq. 2.3, every eighth value",
        lambda: marched(first, amplitude[some], omega[some], RigidBodyEquation(ALPHA)), few,
    )  # fmt: skip
    walked = note(
        "walk, every eighth value",
        lambda: nonlinear_response(first, amplitude[None, some], omega[some, None], ETA, ALPHA), few,
    )  # fmt: skip
    for _ in range(TURNS):
        note("Eq. 2.3, 2,000 points", lambda: nonlinear_response(first, amplitude[None, :], omega[:, None], ETA, ALPHA), values**2)
    for name, each in best.items():
        print(f"  {name:<42}{each:10.1f} us a cell")
    gap = np.abs(answer[0] - theta)[answer[1] == outcome]
    print(f"  against the kernel: {(answer[1] != outcome).sum()} outcomes differ, 99 % within {np.nanquantile(gap, 0.99):.1e}")
    print(f"  refined: {refined}")
    print(f"  Eq. 2.3 against its march: {(slow.outcome != walked.outcome.ravel()).sum()} of {slow.outcome.size} outcomes differ")
    print(f"  against the march: {(small.outcome != small_flight.outcome.ravel()).sum()} of {small.outcome.size} outcomes differ")
    flight = best["2,000 points"]
    mark("us a cell", flight, MOST)
    mark("march / flight", best["march, every eighth value"] / best["flight, every eighth value"], QUICKER, least=True)
    mark("flight / compiled kernel", flight / best["compiled kernel, 2,000 points"], KERNEL)
    mark("four times as finely / flight", best["the same four times as finely"] / flight, REFINED)
    mark("20,000 points / flight", best["20,000 points in the same time"] / flight, LONGER)
    mark("Eq. 2.3, us a cell", best["Eq. 2.3, 2,000 points"], NONLINEAR)
    print(f"  {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024:.0f} MB at the most, with the compiler")


def mark(name: str, found: float, limit: float, least: bool = False) -> None:
    """A figure beside what is asked of it."""
    met = found >= limit if least else found <= limit
    print(f"  {name:<42}{found:10.2f}  {'at least' if least else 'at most'} {limit:g}: {'met' if met else 'NOT MET'}")


if __name__ == "__main__":
    options = argparse.ArgumentParser()
    options.add_argument("--values", type=int, default=200)
    print("Scene R, one thread, process time")
    scene(options.parse_args().values)
