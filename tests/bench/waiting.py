"""What a person waits for: whole commands on few structures, in seconds by the clock
and of the processor, and as a ratio to those of an older commit.

`PYTHONPATH=tests python tests/bench/waiting.py --base DIR [WORD...]` takes turns with
the package in DIR; words choose the rows that contain one of them. Without `--base`
there are no ratios.
"""

import argparse
import os
import resource
import subprocess
import sys
import tempfile
import time
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
        "solve {configs}/wall_tied.yaml --vary ties.0.yield=1kN:20kN --a-g 0.5g --f-g 1"
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
    "spectrum of 10 x 10 cells": (
        "spectrum --eta 0.9 --grid A=0.5:12:10,Omega=0.5:12:10 -o s.h5 --overwrite"
    ),
}


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
        records = folder / name
        records.mkdir()
        for n in range(count):  # the two records, at other speeds and peaks
            samples, dt = (far_shock, near_shock)[n % 2]()
            at2_file(
                records / f"r{n:02d}.at2",
                np.append(samples[n * 5 :], samples[: n * 5]) * (0.6 + 0.04 * n),
                dt,
            )


def waited(package: Path, command: str, folder: Path) -> Waited:
    """Run a command with the package that lies in a folder."""
    path = {**os.environ, "PYTHONPATH": str(package), "MPLBACKEND": "Agg"}
    words = command.format(configs=HERE / "configs").split()
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    began = time.perf_counter()
    subprocess.run(
        [sys.executable, "-m", "rocking_cli", *words, "-q"],
        check=True,
        capture_output=True,
        cwd=folder,
        env=path,
    )
    clock = time.perf_counter() - began
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return Waited(
        clock,
        after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime,
    )


def main() -> None:
    options = argparse.ArgumentParser()
    options.add_argument("--base", type=Path)
    options.add_argument("words", nargs="*")
    chosen = options.parse_args()
    print(f"What a person waits for{'':<24} clock  processor   base, of it this")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        documents(folder)
        maps = (
            "spectrum {configs}/block.yaml {configs}/rigid.yaml {configs}/frame.yaml"
            " {configs}/prism.yaml --grid a_g=0.05g:1g:40,f_g=0.5:5:40 -o four.h5"
        )
        waited(HERE, maps, folder)
        for row, command in ROWS.items():
            if chosen.words and not any(word in row for word in chosen.words):
                continue
            here = waited(HERE, command, folder)
            ratio = ""
            if chosen.base is not None:
                base = waited(chosen.base.resolve(), command, folder)
                share = here.processor / base.processor
                ratio = f"{base.processor:9.2f} s {share:8.2f}"
            print(
                f"  {row:<42}{here.clock:7.2f} s {here.processor:7.2f} s {ratio}",
                flush=True,
            )


if __name__ == "__main__":
    main()
