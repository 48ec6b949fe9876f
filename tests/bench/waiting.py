"""What a person waits for: whole commands on few structures, in seconds."""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

BLOCK = "block:0.5x2.5"
RECORDS = {"1,559 samples": (1559, 0.02, 3), "8,000 samples": (8000, 0.005, 2), "16,400 samples": (16400, 0.005, 5)}
LINEAR, NONLINEAR = ("--model", "linear"), ("--model", "nonlinear")
OF_ONE = {  # under each record
    "response --events, nonlinear": ("response", BLOCK, "--events", *NONLINEAR),
    "response --events, linear": ("response", BLOCK, "--events", *LINEAR),
    "check": ("check", BLOCK),
    "check --verdict-only": ("check", BLOCK, "--verdict-only"),
}
OF_SEVERAL = {  # under the shortest record
    "check, 20 blocks": ("check", "blocks.yaml"),
    "spectrum, 20 blocks": ("spectrum", "blocks.yaml", *NONLINEAR, "-o", "blocks.h5", "--overwrite"),
    "envelope --motion up to A = 10": ("envelope", BLOCK, "--a-max", "10"),
}
WITHOUT = {  # a record
    "check, 12 statues, a pulse": ("check", "statues.yaml", "--a-g", "0.35g", "--f-g", "1.5"),
    "envelope, 40 frequencies in Hz": ("envelope", BLOCK, "--grid", "f_g=0.5:4:40", *NONLINEAR),
    "params of an arch": ("params", "configs/arch.yaml"),
}
STATUE = "kind: rigid\nname: S{n}\nleft: 0.{n:02d}\nright: 0.4\nheight: 2.0\ngyration: 0.9\n"


def quake(count: int, dt: float, seed: int) -> np.ndarray:
    """Noise about 2 Hz that swells and fades, 3.4 m/s2 at its peak."""
    f, t = np.fft.rfftfreq(count, dt), np.arange(count) / count
    colour = f * f / ((0.06 + f * f) * np.sqrt((1.0 - (f / 2.0) ** 2) ** 2 + (0.6 * f) ** 2) * (1.0 + (f / 10.0) ** 4))
    a = np.fft.irfft(np.fft.rfft(np.random.default_rng(seed).standard_normal(count)) * colour, count)
    a *= np.minimum(t / 0.06, 1.0) * np.where(t < 0.2, 1.0, np.exp(-7.3 * (t - 0.2)))
    return 3.4 * a / np.abs(a).max()


def waited(what: str, where: str, command: tuple[str, ...], folder: Path, *more: str) -> None:
    """Print how long a command takes."""
    named = [str(folder / word) if word.startswith(("blocks", "statues")) else word for word in command]
    began = time.perf_counter()
    subprocess.run([sys.executable, "-m", "rocking_cli", *named, *more], check=True, capture_output=True)
    print(f"{what:<32} {where:<16} {time.perf_counter() - began:6.2f} s", flush=True)


def main() -> None:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        blocks = (f"kind: block\nname: B{n}\nwidth: 0.5\nheight: {1.5 + 0.1 * n:g}\n" for n in range(1, 21))
        (folder / "blocks.yaml").write_text("---\n".join(blocks))
        (folder / "statues.yaml").write_text("---\n".join(STATUE.format(n=n) for n in range(42, 54)))
        for record, (count, dt, seed) in RECORDS.items():
            path = folder / f"{count}.csv"
            np.savetxt(path, np.column_stack([np.arange(count) * dt, quake(count, dt, seed)]), delimiter=",", header="t,a", comments="")
            for what, command in OF_ONE.items():
                waited(what, record, command, folder, "--motion", str(path), "--unit", "m/s2", "-q")
        first = next(iter(RECORDS))
        for what, command in OF_SEVERAL.items():
            waited(what, first, command, folder, "--motion", str(folder / f"{RECORDS[first][0]}.csv"), "--unit", "m/s2", "-q")
        for what, command in WITHOUT.items():
            waited(what, "", command, folder, *(() if command[0] == "params" else ("-q",)))


if __name__ == "__main__":
    main()
