"""What a person waits for: whole commands on few structures, in seconds by the clock
and of the processor, and as a ratio to those of an older commit.

`PYTHONPATH=tests python tests/bench/waiting.py --base DIR [WORD...]` takes turns with
the package in DIR; words choose the rows that contain one of them. Without `--base`
there are no ratios. A command that fails has its last sentence in place of its times.
The last row compares the start of a sweep with the import of its packages.
"""

import argparse
import math
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
from support.synthetic_records import at2_file, far_shock, near_shock

HERE = Path(__file__).resolve().parents[2]
BLOCK = "kind: block\nname: B{n}\nwidth: {width:g}\nheight: {height:g}\n"
STATUE = (
    "kind: rigid\nname: S{n}\nleft: {left:g}\nright: {right:g}\nheight: {height:g}\n"
    "gyration: {gyration:g}\n"
)
# what is asked, and the command; the files are those of `documents`
ROWS = {
    "check, 8,000 samples": "check block:0.5x2.5 --motion far.at2",
    "check, 1,560 samples": "check block:0.5x2.5 --motion near.at2",
    "spectrum of 20 blocks of one slenderness": (
        "spectrum blocks.yaml --motion near.at2 --model nonlinear -o b.h5 --overwrite"
    ),
    "check of 20 blocks": "check blocks.yaml --motion near.at2",
    "check under 22 records": "check block:0.5x2 --motion records",
    "check of 12 statues, 0.5 to 5 Hz": "check statues.yaml --a-g 0.3g --f-g 0.5:5",
    "  their outcomes only": (
        "check statues.yaml --a-g 0.3g --f-g 0.5:5 --verdict-only"
    ),
    "check of a tied wall, 1,600 samples": "check {configs}/wall_tied.yaml --motion"
    " {configs}/motions/synthetic.at2",
    "solve, width": (
        "solve {configs}/block.yaml --vary width=0.4:0.8 --a-g 0.4g --f-g 1"
    ),
    "solve, yield of a tie": (
        "solve {configs}/wall_tied.yaml --vary ties.0.yield=6kN:20kN --a-g 0.8g --f-g 1"
    ),
    "report of 12 statues": (
        "report statues.yaml --a-g 0.35g --f-g 1.5 -o report.html --overwrite"
    ),
    "envelope of 2 bodies at 60 frequencies": (
        "envelope {configs}/block.yaml {configs}/rigid.yaml --grid f_g=0.5:5:60"
    ),
    "fragility under 7 records with a hazard": (
        "fragility {configs}/block.yaml --motion seven --levels 0.1g:1g:10 --hazard"
        " {configs}/hazard.csv"
    ),
    "fragility of 3 blocks under 7 records": (
        "fragility three.yaml --motion seven --levels 0.1g:1g:10 --hazard"
        " {configs}/hazard.csv"
    ),
    "plot of 4 maps": "plot four.h5 --all -o four.png --overwrite",
    "animation of a response": "plot response.csv --animate r.gif --overwrite",
    "spectrum of 10 x 10 cells": (
        "spectrum --eta 0.9 --grid A=0.5:12:10,Omega=0.5:12:10 -o s.h5 --overwrite"
    ),
}
# the commands that write the files which some rows read
PREPARED = (
    "spectrum {configs}/block.yaml {configs}/rigid.yaml {configs}/frame.yaml"
    " {configs}/prism.yaml --grid a_g=0.05g:1g:40,f_g=0.5:5:40 -o four.h5",
    "response {configs}/block.yaml --a-g 0.3g --f-g 1.5 --csv",
)
START = "spectrum --eta 0.9 --grid A=1:2:2,Omega=1:2:2 -o start.h5 --overwrite"
IMPORTS = "import numpy, h5py"
STARTS = 5  # starts of which the quickest counts


class Waited(NamedTuple):
    """What a command took."""

    clock: float  # [s]
    processor: float  # of it and its processes [s]


def documents(folder: Path) -> None:
    """Write the structures, records and spectra that the commands read."""
    heights = [0.5 + 0.2 * n for n in range(20)]
    (folder / "blocks.yaml").write_text(
        "---\n".join(
            BLOCK.format(n=n, width=0.2 * h, height=h) for n, h in enumerate(heights)
        )
    )
    (folder / "three.yaml").write_text(
        "---\n".join(
            BLOCK.format(n=n, width=w, height=h)
            for n, (w, h) in enumerate(((0.5, 2.0), (0.4, 1.8), (0.6, 2.6)))
        )
    )
    sizes = [0.5 + 0.13 * n for n in range(12)]
    (folder / "statues.yaml").write_text(
        "---\n".join(
            STATUE.format(
                n=n, left=0.37 * h, right=0.27 * h, height=h, gyration=0.6 * h
            )
            for n, h in enumerate(sizes)
        )
    )
    at2_file(folder / "far.at2", *far_shock())
    at2_file(folder / "near.at2", *near_shock())
    for name, count in (("records", 22), ("seven", 7)):
        for n in range(count):  # the two records, at other speeds and peaks
            _vary((far_shock, near_shock)[n % 2](), n, folder / name)
    for command in PREPARED:
        done = ran(HERE, command, folder)
        if done.returncode:
            sys.exit(said_of(done))
        if done.stdout:
            (folder / "response.csv").write_text(done.stdout)


def _vary(record: tuple[np.ndarray, float], n: int, folder: Path) -> None:
    """Write the n-th variant of a record, (samples, time step), into a folder."""
    folder.mkdir(exist_ok=True)
    samples, dt = record
    turned = np.append(samples[n * 5 :], samples[: n * 5])
    at2_file(folder / f"r{n:02d}.at2", turned * (0.6 + 0.04 * n), dt)


def ran(package: Path, command: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """Run a command with the package that lies in a folder."""
    words = command.format(configs=HERE / "configs").split()
    return _python(package, ["-m", "rocking_cli", *words, "-q"], folder)


def _python(
    package: Path, words: list[str], folder: Path
) -> subprocess.CompletedProcess[str]:
    """Run Python with the package that lies in a folder."""
    path = {**os.environ, "PYTHONPATH": str(package), "MPLBACKEND": "Agg"}
    return subprocess.run(
        [sys.executable, *words], capture_output=True, text=True, cwd=folder, env=path
    )


def said_of(done: subprocess.CompletedProcess[str]) -> str:
    """Return the exit code of a command that failed and its last sentence."""
    *_, last = ["no message", *done.stderr.strip().splitlines()]
    return f"failed, exit {done.returncode}: {last}"


def waited(
    run: Callable[[], subprocess.CompletedProcess[str]],
) -> tuple[Waited, subprocess.CompletedProcess[str]]:
    """Return the times of a command, and the command when it has ended."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    began = time.perf_counter()
    done = run()
    clock = time.perf_counter() - began
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    processor = after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime
    return Waited(clock, processor), done


def row_of(command: str, base: Path | None, folder: Path) -> str:
    """Return the times of a command and its ratio to the base, or why it failed."""
    here, done = waited(partial(ran, HERE, command, folder))
    if done.returncode:
        return said_of(done)
    row = f"{here.clock:7.2f} s {here.processor:7.2f} s "
    if base is None:
        return row
    there, done = waited(partial(ran, base, command, folder))
    if done.returncode:
        return f"{row} base {said_of(done)}"
    return f"{row}{there.processor:9.2f} s {here.processor / there.processor:8.2f}"


def start_row(base: Path | None, folder: Path) -> str:
    """Return the processor time of the start of a sweep over that of its imports."""
    runs = {
        "imports": partial(_python, HERE, ["-c", IMPORTS], folder),
        "here": partial(ran, HERE, START, folder),
    }
    if base is not None:
        runs["base"] = partial(ran, base, START, folder)
    least = dict.fromkeys(runs, math.inf)
    for _ in range(STARTS):  # in turns
        for name, run in runs.items():
            took, done = waited(run)
            if done.returncode:
                return f"{name} {said_of(done)}"
            least[name] = min(least[name], took.processor)
    ratios = {name: x / least["imports"] for name, x in least.items()}
    row = f"{ratios['here']:7.2f}"
    if base is not None:
        row += f", base {ratios['base']:.2f}"
    return row


def main() -> None:
    options = argparse.ArgumentParser()
    options.add_argument("--base", type=Path)
    options.add_argument("words", nargs="*")
    chosen = options.parse_args()
    base = None if chosen.base is None else chosen.base.resolve()
    if base is not None and not (base / "rocking_cli").is_dir():
        options.error(f"--base: found no folder rocking_cli in {base}")

    def wanted(row: str) -> bool:
        return not chosen.words or any(word in row for word in chosen.words)

    print(f"What a person waits for{'':<24} clock  processor   base, of it this")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        documents(folder)
        for row, command in filter(lambda item: wanted(item[0]), ROWS.items()):
            print(f"  {row:<42}{row_of(command, base, folder)}", flush=True)
        row = f"spectrum start / {IMPORTS}"
        if wanted(row):
            print(f"  {row:<42}{start_row(base, folder)}", flush=True)


if __name__ == "__main__":
    main()
