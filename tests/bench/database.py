"""Rocking spectra at the scale of a database: time and file of 10^4 cells a record, the
same for 21,000 components, and overturning scales.

`python tests/bench/database.py [RECORDS]`, or `make database`.
"""

import os
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import scenes

from rocking_cli import Axis, Method
from rocking_cli.spectra.record_envelope import Tracing, tracing_rows
from rocking_cli.spectra.record_scene import angles_scene
from rocking_cli.spectra.sweep import write_scene
from rocking_cli.spectra.sweep_options import SweepOptions

SAMPLES, STEP, WORKERS = 2000, 0.01, 2
DATABASE = 21_000  # horizontal components
PER_RECORD = 10_000  # cells


def synthetic(number: int):
    """A record with a peak between 0.1 and 1 g."""
    factor = 10.0 ** np.random.default_rng(number).uniform(-1.0, 0.0)
    return scenes.recording(
        2.9 * factor * scenes.quake(SAMPLES, STEP, number), STEP, number
    )


def spectra(records: int, method: Method) -> None:
    """Sweep and print: time, time a cell, bytes a cell, and both for the database."""
    alpha, period = (
        Axis("alpha", np.radians(np.linspace(5.0, 30.0, 100))),
        Axis("T", np.linspace(0.5, 12.0, 100)),
    )
    scene = angles_scene(
        alpha, period, [synthetic(i) for i in range(records)], 0.9, method
    )
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "records.h5"
        began, busy = (
            time.perf_counter(),
            sum(os.times()[:4]),
        )  # with the processes that this one starts and ends
        summary = write_scene(
            scene, path, SweepOptions(workers=WORKERS, check=4 if method.exact else 0)
        )
        seconds, busy, size = (
            time.perf_counter() - began,
            sum(os.times()[:4]) - busy,
            path.stat().st_size,
        )
    cell, byte, whole = (
        busy / summary.cells,
        size / summary.cells,
        DATABASE * PER_RECORD,
    )
    uplifted = 1.0 - summary.outcomes["no_uplift"] / summary.cells
    print(
        f"{method.model}: {records} records of {SAMPLES} samples x {PER_RECORD} cells,"
        f" {uplifted:.0%} of which lift off: {seconds:.0f} s on {WORKERS} processes,"
        f" {1e6 * cell:.0f} us of a processor a cell, {size / 1e6:.1f} MB, {byte:.1f}"
        f" bytes a cell\n  expected of {DATABASE} components: {whole * cell / 3600:.1f}"
        f" h / n on n processors, {whole * byte / 1e9:.1f} GB"
    )


def envelopes(method: Method) -> None:
    """First overturning scale and all intervals of 40 sizes under one record."""
    scene = angles_scene(
        Axis("alpha", np.array([0.2])),
        Axis("T", np.linspace(0.8, 8.0, 40)),
        [synthetic(0)],
        0.9,
        method,
    )
    for first in (True, False):
        began = time.perf_counter()
        rows = list(tracing_rows(Tracing(scene, 20.0, first), workers=WORKERS))
        what = "first overturning" if first else f"all {len(rows)} intervals"
        print(
            f"{method.model}: 40 sizes under a record of {SAMPLES} samples, {what}:"
            f" {time.perf_counter() - began:.1f} s"
        )


if __name__ == "__main__":
    spectra(int(sys.argv[1]) if len(sys.argv) > 1 else 200, Method())
    spectra(2, Method("nonlinear"))
    envelopes(Method())
    envelopes(Method("nonlinear"))
