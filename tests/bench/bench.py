"""Side by side in one run: the engine, a compiled lower bound, heyoka and SciPy. Prints a table and the ratios the README quotes.

Scene L: linear, one sine cycle, eta 0.9, A and Omega 0.5 ... 12. Scene N: nonlinear, alpha 0.25, tolerance 1e-9, the same grid.
The faster of two or more runs counts; what peers compile, they compile before the clock starts. `--values` sets the values of each
axis (1000), `--sample` the cells given to heyoka.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import time
from pathlib import Path

import compiled
import numba
import numpy as np
import peers

from rocking_cli import dimensionless_oscillator, linear_response, nonlinear_response, sine, trace_envelope

ETA, ALPHA = 0.9, 0.25


def clock(action, times=2):
    """(least time, result)."""
    best = np.inf
    for _ in range(times):
        start = time.perf_counter()
        result = action()
        best = min(best, time.perf_counter() - start)
    return best, result


def line(name, seconds, cells, note=""):
    print(f"  {name:<42}{1e6 * seconds / cells:10.3f} us a cell  {note}", flush=True)


def agreement(theta, outcome, reference, reference_outcome):
    same = outcome == reference_outcome
    gaps = np.abs(theta - reference)[same]
    return f"{(~same).sum()} outcomes differ, theta/alpha within {np.nanmax(gaps):.1e}, 99 % within {np.nanquantile(gaps, 0.99):.1e}"


def whole_command(values, workers, *options):
    """Run time of the sweep inside `rocking spectrum`, and of the whole process."""
    grid = f"A=0.5:12:{values},Omega=0.5:12:{values}"
    command = [sys.executable, "-m", "rocking_cli", "spectrum", *options, "--grid", grid, "--workers", str(workers), "--overwrite"]

    def run():
        return subprocess.run([*command, "-o", "out/bench.h5", "--json", "-q"], check=True, capture_output=True, text=True).stdout

    import json

    whole, said = clock(run, 3)
    return json.loads(said)["run_time"], whole


def main() -> None:
    options = argparse.ArgumentParser()
    options.add_argument("--values", type=int, default=1000)
    options.add_argument("--sample", type=int, default=20_000)
    chosen = options.parse_args()
    Path("out").mkdir(exist_ok=True)
    n, cores = chosen.values, os.cpu_count() or 1
    axis = np.linspace(0.5, 12.0, n)
    random = np.random.default_rng(20120924)
    at = random.integers(0, n, (chosen.sample, 2))
    cells = np.column_stack([axis[at[:, 0]], axis[at[:, 1]]])
    picked = at[:, 1], at[:, 0]

    print(f"Scene L, {n} x {n}")
    compiled.sweep(axis[:2], axis[:2], ETA)
    numba.set_num_threads(1)
    one, (theta, outcome) = clock(lambda: compiled.sweep(axis, axis, ETA))
    engine, found = clock(lambda: linear_response(sine(), axis[None, :], axis[:, None], ETA))
    line("compiled kernel, one thread", one, n * n)
    line("engine, one process", engine, n * n, agreement(theta, outcome, found.theta_ratio, found.outcome))
    numba.set_num_threads(cores)
    all_threads, _ = clock(lambda: compiled.sweep(axis, axis, ETA), 4)
    line(f"compiled kernel, {cores} threads", all_threads, n * n)
    timed = {w: whole_command(n, w, "--eta", str(ETA)) for w in (1, cores)}
    for w, (sweep, whole) in timed.items():
        line(f"rocking spectrum, {w} worker{'s' if w > 1 else ''}, with file", sweep, n * n, f"whole process {whole:.2f} s")
    heyoka, answer = peers.on_all_cores(peers.heyoka_cells, cells, ETA, None, 1e-12, workers=cores)
    line(
        f"heyoka tol 1e-12, {cores} processes",
        heyoka,
        len(cells),
        agreement(answer[:, 1], answer[:, 0], found.theta_ratio[picked], found.outcome[picked]),
    )
    scipy, answer = peers.on_all_cores(peers.scipy_cells, cells[:400], ETA, None, 1e-12, workers=cores)
    some = tuple(x[:400] for x in picked)
    line(
        f"SciPy DOP853 1e-12, {cores} processes",
        scipy,
        400,
        agreement(answer[:, 1], answer[:, 0], found.theta_ratio[some], found.outcome[some]),
    )
    ours = timed[cores][0] / n**2
    print(f"  engine / compiled, one thread      {engine / one:8.2f}")
    print(f"  {cores} workers with file / compiled    {ours / (all_threads / n**2):8.2f}")
    print(f"  heyoka / {cores} workers with file      {heyoka / len(cells) / ours:8.1f}")
    print(f"  SciPy / {cores} workers with file       {scipy / 400 / ours:8.0f}")
    print(f"  1 worker / {cores} workers              {timed[1][0] / timed[cores][0]:8.2f}")

    print(f"Scene N, alpha {ALPHA}, tolerance 1e-9, {n // 2} x {n // 2}")
    half = axis[::2]
    engine, _ = clock(lambda: nonlinear_response(sine(), half[None, :], half[:, None], ETA, ALPHA))
    line("engine, one process", engine, half.size**2)
    exact = nonlinear_response(sine(), *cells.T, ETA, ALPHA, tolerance=1e-13)
    mine = nonlinear_response(sine(), *cells.T, ETA, ALPHA)
    with_one, answer = clock(lambda: peers.heyoka_cells(cells[: len(cells) // 4], ETA, ALPHA, 1e-9))
    first = slice(0, len(cells) // 4)
    line(
        "heyoka tol 1e-9, one process",
        with_one,
        len(cells) // 4,
        agreement(answer[:, 1], answer[:, 0], exact.theta_ratio[first], exact.outcome[first]),
    )
    line(
        "engine against tolerance 1e-13", engine, half.size**2, agreement(mine.theta_ratio, mine.outcome, exact.theta_ratio, exact.outcome)
    )
    print(f"  heyoka / engine                    {with_one / (len(cells) // 4) / (engine / half.size**2):8.2f}")

    print("Envelope, 400 frequencies 0.5 ... 12, every boundary to the last digits")
    seconds, intervals = clock(lambda: trace_envelope(sine(), np.linspace(0.5, 12.0, 400), dimensionless_oscillator(ETA)))
    print(f"  {seconds:.2f} s, {len(intervals)} intervals")

    print("Time a cell against the number of cells (linear, one process)")
    for size in (100, 300, 1000, 2000):
        some = np.linspace(0.5, 12.0, size)
        seconds, _ = clock(lambda some=some: linear_response(sine(), some[None, :], some[:, None], ETA), 2)
        line(f"{size * size} cells", seconds, size * size)


if __name__ == "__main__":
    main()
