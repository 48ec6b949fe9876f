"""Records in process time: `python tests/bench/records.py [--values N]`, N values of each axis.

Scene R: a synthetic record of 2,000 points, A 1 ... 8, 2 pi/p 0.5 ... 12 s, eta 0.9, by the linear equation and by Eq. 2.3 (alpha 0.25,
tolerance 1e-9), and by the linear equation the same record with four times as many points, and one of 20,000 points.
"""

from __future__ import annotations

import argparse
import resource
import time
from functools import partial

import numpy as np
from waiting import quake

from rocking_cli import linear_response, nonlinear_response
from rocking_cli.motions.polyline import Polyline, record_motion
from rocking_cli.motions.records import Record

ETA, ALPHA, TURNS = 0.9, 0.25, 2
MOST, REFINED, LONGER, NONLINEAR = 60.0, 1.5, 2.0, 300.0  # what is aimed at: us a cell and ratios


def shaken(samples: np.ndarray, dt: float) -> Polyline:
    return record_motion(Record("synthetic", "text", None, dt, samples, None, "m/s2", "synthetic", ""))


def scene(values: int) -> None:
    """Least process time of each, in turns, beside what is aimed at."""
    samples = quake(2000, 0.01, 1)
    first = shaken(samples, 0.01)
    fine = shaken(np.interp(np.arange(4 * 2000 - 3) / 4.0, np.arange(2000), samples), 0.0025)
    long = shaken(quake(20_000, 0.001, 1), 0.001)
    cells = np.linspace(1.0, 8.0, values)[None, :], np.linspace(0.5, 12.0, values)[:, None] / (2.0 * np.pi), ETA
    runs = {key: partial(linear_response, motion, *cells) for key, motion in (("linear", first), ("fine", fine), ("long", long))}
    runs["Eq. 2.3"] = partial(nonlinear_response, first, *cells, ALPHA)
    best, found = dict.fromkeys(runs, np.inf), {}
    for _ in range(TURNS):
        for key, run in runs.items():
            start = time.process_time()
            found[key] = run()
            best[key] = min(best[key], 1e6 * (time.process_time() - start) / values**2)
    gap = np.abs(found["fine"].theta_ratio - found["linear"].theta_ratio)
    differ = (found["fine"].outcome != found["linear"].outcome).sum()
    print(f"  four times as finely: {differ} outcomes differ, 99.9 % within {np.nanquantile(gap, 0.999):.1e}")
    for name, value, limit in (
        ("linear, us a cell", best["linear"], MOST),
        ("four times as finely, over that", best["fine"] / best["linear"], REFINED),
        ("20,000 points in the same time, over that", best["long"] / best["linear"], LONGER),
        ("Eq. 2.3, us a cell", best["Eq. 2.3"], NONLINEAR),
    ):
        print(f"  {name:<42}{value:10.2f}  at most {limit:g}: {'met' if value <= limit else 'NOT MET'}")
    print(f"  {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024:.0f} MB at the most")


if __name__ == "__main__":
    options = argparse.ArgumentParser()
    options.add_argument("--values", type=int, default=200)
    print("Scene R, one thread, process time")
    scene(options.parse_args().values)
