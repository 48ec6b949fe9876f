"""What a person waits for: whole commands on few structures, in seconds."""

import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from scenes import quake

RECORDS = {"1,559 samples": (1559, 0.02, 3), "8,000 samples": (8000, 0.005, 2), "16,400 samples": (16400, 0.005, 5)}
STATUE = "kind: rigid\nname: S{n}\nleft: 0.{n:02d}\nright: 0.4\nheight: 2.0\ngyration: 0.9\n"
BLOCK = "kind: block\nname: B{n}\nwidth: 0.5\nheight: {height:g}\n"
OF_EACH_RECORD = (
    "response block:0.5x2.5 --events --model nonlinear",
    "response block:0.5x2.5 --events --model linear",
    "check block:0.5x2.5",
    "check block:0.5x2.5 --verdict-only",
)
OF_THE_SHORTEST = (
    "check blocks.yaml",
    "spectrum blocks.yaml --model nonlinear -o blocks.h5 --overwrite",
    "envelope block:0.5x2.5 --a-max 10",
)
WITHOUT = (
    "check statues.yaml --a-g 0.35g --f-g 1.5 -q",
    "envelope block:0.5x2.5 --grid f_g=0.5:4:40 --model nonlinear -q",
    "params arch:10x1.5x157.5deg",
)


def waited(command: str, where: str, folder: Path, *more: str) -> None:
    """Print how long a command takes."""
    began = time.perf_counter()
    subprocess.run([sys.executable, "-m", "rocking_cli", *command.split(), *more], check=True, capture_output=True, cwd=folder)
    print(f"{command:<66} {where:<16} {time.perf_counter() - began:6.2f} s", flush=True)


def main() -> None:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "blocks.yaml").write_text("---\n".join(BLOCK.format(n=n, height=1.5 + 0.1 * n) for n in range(1, 21)))
        (folder / "statues.yaml").write_text("---\n".join(STATUE.format(n=n) for n in range(42, 54)))
        for record, (count, dt, seed) in RECORDS.items():
            samples = np.column_stack([np.arange(count) * dt, quake(count, dt, seed)])
            np.savetxt(folder / "record.csv", samples, delimiter=",", header="t,a", comments="")
            for command in (*OF_EACH_RECORD, *(OF_THE_SHORTEST if count < 2000 else ())):
                waited(command, record, folder, "--motion", "record.csv", "--unit", "m/s2", "-q")
        for command in WITHOUT:
            waited(command, "", folder)


if __name__ == "__main__":
    main()
