"""What a person waits for: whole commands on one structure and one record, in seconds."""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

BLOCK = "block:0.5x2.5"
RECORDS = {"1,559 samples": (1559, 0.02, 3), "8,000 samples": (8000, 0.005, 2), "16,400 samples": (16400, 0.005, 5)}
COMMANDS = {
    "response --events, nonlinear": ["response", BLOCK, "--events", "--model", "nonlinear"],
    "response --events, linear": ["response", BLOCK, "--events", "--model", "linear"],
    "check": ["check", BLOCK],
}


def quake(count: int, dt: float, seed: int) -> np.ndarray:
    """Noise about 2 Hz that swells and fades, 3.4 m/s2 at its peak."""
    f, t = np.fft.rfftfreq(count, dt), np.arange(count) / count
    colour = f * f / ((0.06 + f * f) * np.sqrt((1.0 - (f / 2.0) ** 2) ** 2 + (0.6 * f) ** 2) * (1.0 + (f / 10.0) ** 4))
    a = np.fft.irfft(np.fft.rfft(np.random.default_rng(seed).standard_normal(count)) * colour, count)
    a *= np.minimum(t / 0.06, 1.0) * np.where(t < 0.2, 1.0, np.exp(-7.3 * (t - 0.2)))
    return 3.4 * a / np.abs(a).max()


def main() -> None:
    with tempfile.TemporaryDirectory() as folder:
        for name, (count, dt, seed) in RECORDS.items():
            path = Path(folder) / "record.csv"
            np.savetxt(path, np.column_stack([np.arange(count) * dt, quake(count, dt, seed)]), delimiter=",", header="t,a", comments="")
            for what, command in COMMANDS.items():
                began = time.perf_counter()
                call = [sys.executable, "-m", "rocking_cli", *command, "--motion", str(path), "--unit", "m/s2", "-q"]
                subprocess.run(call, check=True, capture_output=True)
                print(f"{what:<32} {name:<16} {time.perf_counter() - began:6.2f} s")


if __name__ == "__main__":
    main()
