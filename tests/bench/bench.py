"""Side by side in one run: the engine, a compiled lower bound, heyoka, SciPy. Prints
each figure, and in the end the targets.

Scene L: linear, one sine cycle, eta 0.9, A and Omega 0.5 ... 12. Scene N: nonlinear,
alpha 0.25, tolerance 1e-9, the same grid; the others are those of scenes.py. The least
of several runs counts; what peers compile, they compile before the clock starts. What
runs in one process is timed by that process's own time, what needs more by the wall's.
`--values` sets the values of each axis (1000), `--sample` the cells given to heyoka.
With 1000 values the figures are kept in speed.json, from which the README's table is
written.
"""

import argparse
import json
import os
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import compiled
import numba
import numpy as np
import peers
import scenes
import speed
from distributed import LocalCluster

from rocking_cli import linear_response, nonlinear_response, sine

ETA, ALPHA = scenes.ETA, scenes.ALPHA
CONFIG = scenes.CONFIGS / "block.yaml"
ROCKING = [sys.executable, "-m", "rocking_cli"]
LONG = 5.0  # s: what takes longer is run once


def clock(action, times=2, now=time.perf_counter):
    """(least time, result)."""
    best = np.inf
    for _ in range(times):
        start = now()
        result = action()
        best = min(best, now() - start)
        if best > LONG:
            break
    return best, result


def line(name, seconds, cells, note=""):
    """Print and return the microseconds a cell."""
    print(f"  {name:<42}{1e6 * seconds / cells:10.3f} us a cell  {note}", flush=True)
    return 1e6 * seconds / cells


def agreement(answer, found):
    """How answers of a peer, (outcome, theta/alpha) of each cell, differ from those of
    the engine.
    """
    same = answer[0] == found[0]
    gaps = np.abs(answer[1] - found[1])[same]
    return (
        f"{(~same).sum()} outcomes differ, theta/alpha within {np.nanmax(gaps):.1e}, 99"
        f" % within {np.nanquantile(gaps, 0.99):.1e}"
    )


def whole_command(values, workers, *options):
    """Seconds of the sweep inside `rocking spectrum`, and of the whole process."""
    grid = f"A=0.5:12:{values},Omega=0.5:12:{values}"
    command = [
        *ROCKING,
        "spectrum",
        *options,
        "--grid",
        grid,
        "--workers",
        str(workers),
        "--overwrite",
        "-o",
        "out/bench.h5",
    ]
    run = partial(
        subprocess.run,
        [*command, "--json", "-q"],
        check=True,
        capture_output=True,
        text=True,
    )
    whole, done = clock(run, 1)
    return json.loads(done.stdout)["run_time"], whole


def scene_l(axis, cells, cores):
    """Figures of scene L; kernel, engine and command take turns, so that a slow minute
    of the machine meets them alike.
    """
    grid, size, least = (axis[None, :], axis[:, None]), axis.size**2, {}
    kernel = partial(compiled.sweep, axis, axis, ETA)
    compiled.sweep(axis[:2], axis[:2], ETA)  # compiles
    for _ in range(4):
        now = {}
        for name, threads in (("linear_compiled_one", 1), ("linear_compiled", cores)):
            numba.set_num_threads(threads)
            now[name], (theta, outcome) = clock(kernel, 1)
        now["linear"], found = clock(lambda: linear_response(sine(), *grid, ETA), 1)
        now["sweep"], now["sweep_process"] = whole_command(
            axis.size, cores, "--eta", str(ETA)
        )
        least = {
            name: min(seconds, least.get(name, np.inf)) for name, seconds in now.items()
        }
    print(
        "  the kernel and the engine: "
        + agreement((outcome, theta), (found.outcome, found.theta_ratio))
    )
    figures = {name: line(name, seconds, size) for name, seconds in least.items()}
    for name, run, some in (
        ("linear_heyoka", peers.heyoka_cells, cells),
        ("linear_scipy", peers.scipy_cells, cells[:400]),
    ):
        seconds, answer = peers.on_all_cores(run, some, ETA, None, 1e-12, workers=cores)
        mine = linear_response(sine(), *some.T, ETA)
        figures[name] = line(
            name,
            seconds,
            len(some),
            agreement(answer.T, (mine.outcome, mine.theta_ratio)),
        )
    return figures


def scene_n(axis, cells):
    """Figures of scene N, engine and heyoka in turns, one process each."""
    engine = heyoka = np.inf
    for _ in range(3):
        engine = min(
            engine,
            clock(
                lambda: nonlinear_response(
                    sine(), axis[None, :], axis[:, None], ETA, ALPHA
                ),
                1,
            )[0],
        )
        seconds, answer = clock(lambda: peers.heyoka_cells(cells, ETA, ALPHA, 1e-9), 1)
        heyoka = min(heyoka, seconds)
    exact, mine = (
        nonlinear_response(sine(), *cells.T, ETA, ALPHA, tolerance=tolerance)
        for tolerance in (1e-13, 1e-9)
    )
    truth = exact.outcome, exact.theta_ratio
    return {
        "nonlinear": line(
            "nonlinear",
            engine,
            axis.size**2,
            agreement((mine.outcome, mine.theta_ratio), truth),
        ),
        "nonlinear_heyoka": line(
            "nonlinear_heyoka", heyoka, len(cells), agreement(answer.T, truth)
        ),
    }


def other_scenes(n):
    """Figures of scenes.py, in process time; of the envelope on all cores,
    by the wall.
    """
    found = {}
    for name, scene in scenes.SCENES.items():
        seconds, cells = clock(scene, 3, time.process_time)
        line(f"scene {name}", seconds, cells)
        found[name] = seconds if name in speed.IN_SECONDS else 1e6 * seconds / cells
    found["envelope"], _ = clock(partial(scenes.envelope, sine(), 2 * n // 5))
    return {
        name: figure
        for name, figure in found.items()
        if name in {*speed.ROWS, *speed.MORE} and name not in ("linear", "nonlinear")
    }


def commands(n, cores):
    """Figures of whole commands, by the wall, with their compiled modules kept as they
    are for a user.
    """
    environment = {
        key: value
        for key, value in os.environ.items()
        if key != "PYTHONDONTWRITEBYTECODE"
    }
    small = [
        "--eta",
        "0.9",
        "--grid",
        "A=0.5:12:10,Omega=0.5:12:10",
        "-o",
        "out/small.h5",
        "--overwrite",
        "-q",
    ]
    found = {
        "nonlinear_command": (
            1e6
            * min(
                whole_command(n, cores, str(CONFIG), "--model", "nonlinear")[0]
                for _ in range(4)
            )
            / n**2
        )
    }
    for key, arguments in {
        "process": ["spectrum", *small],
        "help": ["--help"],
        "params": ["params", str(CONFIG)],
    }.items():
        found[key], _ = clock(
            partial(
                subprocess.run,
                [*ROCKING, *arguments],
                check=True,
                capture_output=True,
                env=environment,
            ),
            7,
        )
    return found


def many_cells(n, cores):
    """Time a cell of many cells and of few, one process in its own time; and of one
    dask worker over all, by the wall.
    """
    single, large = (
        clock(partial(scenes.file, values), 1, time.process_time)[0] / values**2
        for values in (n, 3 * n)
    )
    times = []
    for count in (1, cores):
        with LocalCluster(
            n_workers=count,
            threads_per_worker=1,
            processes=True,
            dashboard_address=None,
        ) as cluster:
            at = cluster.scheduler_address
            scenes.file(
                n // 4, scheduler=at
            )  # what it imports, it imports before the clock starts
            times.append(clock(partial(scenes.file, 2 * n, scheduler=at), 1)[0])
    return {
        "large_single": 1e6 * single,
        "large": 1e6 * large,
        "cluster": times[0] / times[1],
    }


def main() -> None:
    options = argparse.ArgumentParser()
    options.add_argument("--values", type=int, default=1000)
    options.add_argument("--sample", type=int, default=20_000)
    chosen = options.parse_args()
    Path("out").mkdir(exist_ok=True)
    n, cores = chosen.values, os.cpu_count() or 1
    axis = scenes.axis(n)
    cells = axis[np.random.default_rng(20120924).integers(0, n, (chosen.sample, 2))]
    print(f"Scene L, {n} x {n}, {cores} processes or threads unless said otherwise")
    figures = scene_l(axis, cells, cores)
    print(f"Scene N, alpha {ALPHA}, tolerance 1e-9, {n // 2} x {n // 2}, one process")
    figures |= scene_n(axis[::2], cells[: len(cells) // 4])
    figures |= other_scenes(n) | commands(n // 2, cores) | many_cells(n, cores)
    print(speed.table(figures))
    if n == 1000:
        speed.write(figures)


if __name__ == "__main__":
    main()
