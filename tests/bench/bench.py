"""Side by side in one run: the engine, a compiled lower bound, heyoka, SciPy. Prints tables, and in the end each target beside its figure.

Scene L: linear, one sine cycle, eta 0.9, A and Omega 0.5 ... 12. Scene N: nonlinear, alpha 0.25, tolerance 1e-9, the same grid; the others
are those of scenes.py. The faster of two or more runs counts; what peers compile, they compile before the clock starts. What runs in
one process is timed by that process's own time, what needs more by the wall's. `--values` sets the values of each axis (1000), `--sample`
the cells given to heyoka. With 1000 values the figures are kept in speed.json, from which the README's table is written.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import subprocess
import sys
import time
from dataclasses import replace
from functools import partial
from pathlib import Path

import compiled
import compiled_taylor
import h5py
import numba
import numpy as np
import peers
import scenes
import speed
from distributed import LocalCluster

from rocking_cli import Method, RockingParameters, linear_response, nonlinear_response, response, sine
from rocking_cli.spectra.file.layout import pack
from rocking_cli.structures.parameters import Side

ETA, ALPHA = scenes.ETA, scenes.ALPHA
CONFIG = scenes.ARCH.with_name("block.yaml")


def clock(action, times=2, now=time.perf_counter):
    """(least time, result)."""
    best = np.inf
    for _ in range(times):
        start = now()
        result = action()
        best = min(best, now() - start)
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

    whole, said = clock(run, 1)
    return json.loads(said)["run_time"], whole


def write_alone(found):
    """The file of a spectrum without its computation."""
    packed = [pack(block) for name in ("theta_ratio", "outcome") for block in np.array_split(getattr(found, name), 8)]
    with h5py.File("out/bench.h5", "w") as file:
        for i, raw in enumerate(packed):
            file.create_dataset(str(i), data=np.frombuffer(raw, dtype=np.uint8))
        file.flush()


def scene_l(axis, cores, rounds=4):
    """Least seconds of each, all of them once in every round, so that a slow minute of the machine meets them alike."""
    compiled.sweep(axis[:2], axis[:2], ETA)
    found = linear_response(sine(), axis[None, :], axis[:, None], ETA)
    least = {}

    def note(name, seconds):
        least[name] = min(seconds, least.get(name, np.inf))

    for _ in range(rounds):
        for threads in (1, cores):
            numba.set_num_threads(threads)
            name = f"compiled kernel, {'one thread' if threads == 1 else f'{threads} threads'}"
            note(name, clock(lambda: compiled.sweep(axis, axis, ETA), 1)[0])
        note("engine, one process", clock(lambda: linear_response(sine(), axis[None, :], axis[:, None], ETA), 1)[0])
        note("the write alone: shuffle, gzip, HDF5", clock(lambda: write_alone(found), 1)[0])
        for workers in (1, cores):
            sweep, whole = whole_command(axis.size, workers, "--eta", str(ETA))
            note(f"rocking spectrum, {workers} worker{'s' if workers > 1 else ''}, with file", sweep)
            note(f"the same, whole process, {workers} worker{'s' if workers > 1 else ''}", whole)
    return least


def systems(values):
    """Bodies with unequal edges, one side, or damping, over the symmetric one; `values` a side of the grid, least of three turns."""
    alpha = 0.2
    left, right = Side("left", 2.0, alpha, math.tan(alpha), 1.0, ETA), Side("right", 2.1, 0.22, math.tan(0.22), 1.0, ETA)
    plain = RockingParameters("symmetric", "block", 2.0, alpha, ETA, math.tan(alpha), 1.0)
    bodies = {
        "symmetric": plain,
        "unequal edges": RockingParameters.of_sides("unequal", "prism", left, right),
        "one-sided": replace(plain, eta=-0.45, one_sided=True),
        "damped, zeta 0.05": replace(plain, damping=0.05),
    }
    for model, count in (("linear", values), ("nonlinear", values // 3)):
        axis, best = np.linspace(0.5, 12.0, count), dict.fromkeys(bodies, math.inf)
        for _ in range(3):
            for name, body in bodies.items():
                system = Method(model).system_of(body)
                seconds, _ = clock(partial(response, system, sine(), axis[None, :], axis[:, None], body.eta), 1)
                best[name] = min(best[name], seconds)
        print(f"Systems, {model}, {count} x {count}")
        for name, seconds in best.items():
            line(name, seconds, count * count, f"{seconds / best['symmetric']:.2f} x")


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
    best = scene_l(axis, cores)
    theta, outcome = compiled.sweep(axis, axis, ETA)
    found = linear_response(sine(), axis[None, :], axis[:, None], ETA)
    kernel, kernels = best["compiled kernel, one thread"], best[f"compiled kernel, {cores} threads"]
    engine, write = best["engine, one process"], best["the write alone: shuffle, gzip, HDF5"]
    one, all_workers = best["rocking spectrum, 1 worker, with file"], best[f"rocking spectrum, {cores} workers, with file"]
    for name, seconds in best.items():
        exact = agreement(theta, outcome, found.theta_ratio, found.outcome) if name == "engine, one process" else ""
        line(name, seconds, n * n, exact)
    heyoka, answer = peers.on_all_cores(peers.heyoka_cells, cells, ETA, None, 1e-12, workers=cores)
    same = agreement(answer[:, 1], answer[:, 0], found.theta_ratio[picked], found.outcome[picked])
    line(f"heyoka tol 1e-12, {cores} processes", heyoka, len(cells), same)
    scipy, answer = peers.on_all_cores(peers.scipy_cells, cells[:400], ETA, None, 1e-12, workers=cores)
    some = tuple(x[:400] for x in picked)
    same = agreement(answer[:, 1], answer[:, 0], found.theta_ratio[some], found.outcome[some])
    line(f"SciPy DOP853 1e-12, {cores} processes", scipy, 400, same)
    ours = all_workers / n**2
    cells_of = {"linear": engine / n**2, "sweep": ours, "linear_compiled": kernels / n**2, speed.KERNEL: kernel / n**2}
    cells_of |= {"linear_heyoka": heyoka / len(cells), "linear_scipy": scipy / 400}
    print(f"  engine / compiled, one thread      {engine / kernel:8.2f}")
    print(f"  {cores} workers with file / compiled    {all_workers / kernels:8.2f}")
    print(f"  heyoka / {cores} workers with file      {heyoka / len(cells) / ours:8.1f}")
    print(f"  SciPy / {cores} workers with file       {scipy / 400 / ours:8.0f}")
    print(f"  1 worker / {cores} workers              {one / all_workers:8.2f}")
    print(f"  (1 worker - write) / engine        {(one - write) / engine:8.2f}")

    print(f"Scene N, alpha {ALPHA}, tolerance 1e-9, {n // 2} x {n // 2}")
    half = axis[::2]
    some = cells[: len(cells) // 4]
    engine = with_one = np.inf
    numba.set_num_threads(1)
    taylor = partial(compiled_taylor.sweep, half, half, ETA, ALPHA, 1e-9, compiled_taylor.ORDER)
    kernel, _ = clock(taylor, 1)  # compiles
    for _ in range(3):
        kernel = min(kernel, clock(taylor, 1)[0])
        engine = min(engine, clock(lambda: nonlinear_response(sine(), half[None, :], half[:, None], ETA, ALPHA), 1)[0])
        seconds, answer = clock(lambda: peers.heyoka_cells(some, ETA, ALPHA, 1e-9), 1)
        with_one = min(with_one, seconds)
    line("engine, one process", engine, half.size**2)
    line("compiled Taylor kernel, one thread", kernel, half.size**2)
    exact = nonlinear_response(sine(), *cells.T, ETA, ALPHA, tolerance=1e-13)
    mine = nonlinear_response(sine(), *cells.T, ETA, ALPHA)
    first = slice(0, len(cells) // 4)
    same = agreement(answer[:, 1], answer[:, 0], exact.theta_ratio[first], exact.outcome[first])
    line("heyoka tol 1e-9, one process", with_one, len(some), same)
    same = agreement(mine.theta_ratio, mine.outcome, exact.theta_ratio, exact.outcome)
    line("engine against tolerance 1e-13", engine, half.size**2, same)
    cells_of |= {"nonlinear": engine / half.size**2, "nonlinear_compiled": kernel / half.size**2, "nonlinear_heyoka": with_one / len(some)}
    print(f"  engine / compiled                  {engine / kernel:8.2f}")
    print(f"  heyoka / engine                    {with_one / len(some) / (engine / half.size**2):8.2f}")

    systems(n // 3)
    cells_of["sweep_process"] = best[f"the same, whole process, {cores} workers"] / n**2
    figures = {key: 1e6 * value for key, value in cells_of.items()}
    figures |= other_scenes(n) | {"nonlinear_command": nonlinear_command(n // 2, cores)} | processes() | many_cells(n, cores)
    print(speed.table(figures))
    if n == 1000:
        speed.write(figures)


def other_scenes(n):
    """Figures of the scenes with one process, in its own time, least of three; of envelopes on all cores, by the wall."""
    found = {}
    for key, scene in (("linear_small", "linear-small"), *((name, name) for name in ("ricker", "mavroeidis", "arch", "lossless"))):
        least, cells = clock(scenes.SCENES[scene], 3, time.process_time)
        found[key] = (1.0 if key == "lossless" else 1e6 / cells) * least
        print(f"Scene {scene}: {cells} cells, {least:.3f} s")
    whole = 2 * n // 5
    found["envelope"] = envelope(sine(), whole, times=2)
    # A run waits as long for the last bodies of few frequencies as of many, so what these take is not a part of what many take.
    few, some = (envelope(sine(5), whole // part) for part in (50, 10))
    more = (whole - whole // 10) / (whole // 10 - whole // 50)
    return found | {"envelope_cycles": some + (some - few) * more}


def envelope(motion, frequencies, times=1):
    """Seconds of an envelope on all cores."""
    least, _ = clock(partial(scenes.envelope, motion, frequencies), times)
    print(f"Envelope, {frequencies} frequencies 0.5 ... 12, {motion.name}: {least:.2f} s", flush=True)
    return least


def nonlinear_command(values, workers):
    """Seconds a cell, in millionths, of the sweep with its file on all cores; the least of four, as of the engine."""
    return 1e6 * min(whole_command(values, workers, str(CONFIG), "--model", "nonlinear")[0] for _ in range(4)) / values**2


def processes():
    """Seconds of whole commands, by the wall: the least of seven, with their compiled modules kept as they are for a user."""
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONDONTWRITEBYTECODE"}
    found, python = {}, [sys.executable, "-m", "rocking_cli"]
    small = ["--eta", "0.9", "--grid", "A=0.5:12:10,Omega=0.5:12:10", "-o", "out/small.h5", "--overwrite", "-q"]
    for key, arguments in {"process": ["spectrum", *small], "help": ["--help"], "params": ["params", str(CONFIG)]}.items():
        command = partial(subprocess.run, [*python, *arguments], check=True, capture_output=True, env=environment)
        found[key], _ = clock(command, 7)
        print(f"rocking {arguments[0]}: {found[key]:.3f} s")
    return found


def many_cells(n, workers):
    """Time a cell of many cells and of few, one process in its own time; and of one dask worker over all, by the wall."""
    found = {}
    for key, values in (("large_single", n), ("large", 3 * n)):
        start = time.process_time()
        cells = scenes.file(values)
        found[key] = 1e6 * (time.process_time() - start) / cells
        print(f"{cells} cells with their file: {found[key]:.3f} us a cell")
    times = []
    for count in (1, workers):
        with LocalCluster(n_workers=count, threads_per_worker=1, processes=True, dashboard_address=None) as cluster:
            scenes.file(n // 4, scheduler=cluster.scheduler_address)  # what it imports, it imports before the clock starts
            times.append(clock(lambda address=cluster.scheduler_address: scenes.file(2 * n, scheduler=address), 1)[0])
    print(f"dask, 1 and {workers} workers: {times[0]:.2f} and {times[1]:.2f} s")
    return found | {"cluster": times[0] / times[1]}


if __name__ == "__main__":
    main()
