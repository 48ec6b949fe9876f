"""Rocking spectra at the scale of a database: synthetic records x 10^4 cells each, what they take, how large the file is, what is to be
expected of 21,000 components; and the first overturning scales of 40 sizes under one record.

    python tests/bench/database.py [RECORDS] [--long]
"""

from __future__ import annotations

import argparse
import os
import tempfile
import time
from pathlib import Path

import numpy as np

from rocking_cli import Axis, Method
from rocking_cli.motions.recording import Recording
from rocking_cli.motions.records import Record
from rocking_cli.spectra.record_envelope import Tracing, tracing_records
from rocking_cli.spectra.record_scene import angles_scene
from rocking_cli.spectra.sweep import SweepOptions, write_scene

SAMPLES, STEP = 2000, 0.01
DATABASE = 21_000  # horizontal components


def synthetic(number: int) -> Recording:
    """A record of our own: sixty sinusoids of random phases that swell and fade, with a peak between 0.1 and 1 g."""
    random = np.random.default_rng(number)
    t = STEP * np.arange(SAMPLES)
    f, phase = 0.3 * 40.0 ** random.random(60), 2.0 * np.pi * random.random(60)
    wave = (np.sin(2.0 * np.pi * np.outer(t, f) + phase) / (1.0 + (f / 3.0) ** 1.5)).sum(axis=1)
    wave *= np.minimum(1.0, (t / 3.0) ** 2) * np.exp(-0.3 * np.maximum(0.0, t - 8.0))
    wave *= 9.81 * 10.0 ** random.uniform(-1.0, 0.0) / np.abs(wave).max()
    return Recording(Record(f"synthetic-{number}", "text", None, STEP, wave, None, "m/s2", "none", f"{number:064x}"))


def spectra(records: int, alphas: int, sizes: int, method: Method, workers: int) -> None:
    """Sweep and print: time, time a cell, bytes a cell, and both for the database."""
    alpha, period = Axis("alpha", np.radians(np.linspace(5.0, 30.0, alphas))), Axis("T", np.linspace(0.5, 12.0, sizes))
    scene = angles_scene(alpha, period, [synthetic(i) for i in range(records)], 0.9, method)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "records.h5"
        began, busy = time.perf_counter(), processor_time()
        summary = write_scene(scene, path, SweepOptions(workers=workers, check=4 if method.exact else 0))
        seconds, busy, size = time.perf_counter() - began, processor_time() - busy, path.stat().st_size
    cell, byte = busy / summary.cells, size / summary.cells
    uplifted = 1.0 - summary.outcomes["no_uplift"] / summary.cells
    print(
        f"{method.model}: {records} records of {SAMPLES} samples x {alphas * sizes} cells, {100.0 * uplifted:.0f} % of which lift off: "
        f"{seconds:.0f} s on {workers} processes, {1e6 * cell:.0f} us of a processor a cell, {size / 1e6:.1f} MB, {byte:.1f} bytes a cell"
    )
    whole = DATABASE * 1e4
    print(
        f"  expected of {DATABASE} components x 10^4 cells: {whole * cell / 7200:.1f} h on two processors, {whole * cell / 3600:.1f} h / n "
        f"on n of a cluster, {whole * byte / 1e9:.1f} GB in {DATABASE} chunks"
    )


def processor_time() -> float:
    """Seconds of a processor that this process and those which it started and ended have taken."""
    return sum(os.times()[:4])


def envelopes(method: Method, workers: int) -> None:
    """First overturning scale of 40 sizes under one record."""
    scene = angles_scene(Axis("alpha", np.array([0.2])), Axis("T", np.linspace(0.8, 8.0, 40)), [synthetic(0)], 0.9, method)
    for first in (True, False):
        began = time.perf_counter()
        rows = list(tracing_records(Tracing(scene, 20.0, first), workers=workers))
        what = "first overturning" if first else f"all {len(rows)} intervals"
        seconds = time.perf_counter() - began
        print(f"{method.model}: 40 sizes under a record of {SAMPLES} samples, {what}: {seconds:.1f} s on {workers} processes")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("records", type=int, nargs="?", default=44)
    parser.add_argument("--long", action="store_true", help="two records of the nonlinear equation and the envelopes too: minutes")
    options = parser.parse_args()
    spectra(options.records, 100, 100, Method(), 2)
    if options.long:
        spectra(2, 100, 100, Method("nonlinear"), 2)
        envelopes(Method(), 2)
        envelopes(Method("nonlinear"), 2)


if __name__ == "__main__":
    main()
