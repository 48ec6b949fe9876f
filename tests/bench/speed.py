"""What `make bench` measured last, and the README's table of it: bench.py writes speed.json, a test compares the table."""

from __future__ import annotations

import json
import re
from pathlib import Path

FILE = Path(__file__).with_name("speed.json")
MARKS = re.compile(r"(?<=<!-- speed -->\n).*?(?=<!-- /speed -->)", re.DOTALL)
ROWS = {  # key of the file: what is timed, unit, what holds the answer, and how near it is
    "linear": ("a linear cell of 10⁶, one process", "µs", "1e-12 in θ/α after one cycle, every outcome"),
    "sweep": ("the same with its file, two processes", "µs", "stated in the file"),
    "linear_compiled": ("the same algorithm compiled (numba), two threads", "µs", ""),
    "linear_heyoka": ("heyoka at 1e-12, two processes", "µs", ""),
    "linear_scipy": ("SciPy's DOP853 at 1e-12, two processes", "µs", ""),
    "nonlinear": ("a nonlinear cell of a rigid body at 1e-9", "µs", "half the tolerance times the cell's condition"),
    "nonlinear_heyoka": ("heyoka at 1e-9", "µs", ""),
    "envelope": ("an envelope of 400 frequencies up to A = 20", "s", "boundaries to the last digits, intervals wider than 1e-3"),
}


def write(figures: dict[str, float]) -> None:
    """Keep what was measured, to two digits: the table tells no more."""
    assert figures.keys() == ROWS.keys()
    FILE.write_text(json.dumps({key: float(f"{value:.2g}") for key, value in figures.items()}, indent=1) + "\n", encoding="utf-8")


def in_readme(text: str) -> str:
    """The README's text with the table that the file holds."""
    figures = json.loads(FILE.read_text(encoding="utf-8"))
    rows = [f"| {what} | {figures[key]:g} {unit} | {error} |\n" for key, (what, unit, error) in ROWS.items()]
    return MARKS.sub("".join(["| one cycle of a sine | time | error at most |\n|---|---|---|\n", *rows]), text)
