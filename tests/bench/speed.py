"""What `make bench` measured last, the README's table of it, and how far it is from what is aimed at.

bench.py writes speed.json; a test compares the README's table with it.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

Figures = dict[str, float]
FILE = Path(__file__).with_name("speed.json")
MARKS = re.compile(r"(?<=<!-- speed -->\n).*?(?=<!-- /speed -->)", re.DOTALL)
ROWS = {  # key of the file: what is timed, unit, what holds the answer, and how near it is
    "linear": ("a linear cell of 10⁶, one process", "µs", "1e-12 in θ/α after one cycle, every outcome"),
    "sweep": ("the same with its file, two processes", "µs", "stated in the file"),
    "linear_compiled": ("the same algorithm compiled (numba), two threads", "µs", ""),
    "linear_heyoka": ("heyoka at 1e-12, two processes", "µs", ""),
    "linear_scipy": ("SciPy's DOP853 at 1e-12, two processes", "µs", ""),
    "linear_small": ("a linear cell of 10⁴, one process", "µs", "as of 10⁶"),
    "ricker": ("the same under a Ricker wavelet", "µs", "1e-12"),
    "nonlinear": ("a nonlinear cell of a rigid body at 1e-9", "µs", "half the tolerance times the cell's condition"),
    "nonlinear_heyoka": ("heyoka at 1e-9", "µs", ""),
    "arch": ("a nonlinear cell of an arch at 1e-9", "µs", "the same"),
    "envelope": ("an envelope of 400 frequencies up to A = 20", "s", "intervals wider than 1e-3"),
}
# measured as well, for the targets alone: whole processes, ratios, and what bounds them (see `Target`)
MORE = (
    "linear_compiled_one", "nonlinear_compiled", "nonlinear_halves", "nonlinear_command", "mavroeidis", "sweep_process",
    "envelope_cycles", "lossless", "process", "help", "params", "large", "large_single", "cluster", "packing", "one_cell",
    "process_import", "help_import", "params_import", "start",
    *(f"{key}_bound" for key in ("linear_small", "ricker", "mavroeidis", "nonlinear", "arch", "lossless", "envelope", "envelope_cycles")),
)  # fmt: skip


KERNEL, THERE = "linear_compiled_one", 0.508  # the figure that tells how fast a machine is; its value where targets in us and s were set


class Target(NamedTuple):
    """What is aimed at: the value of the figures, in a unit, at most or at least; bound: what this machine takes in any case, measured
    in the same run. A time is held against it as it would be on the machine for which it was set (`THERE`), a ratio as it is."""

    what: str
    value: Callable[[Figures], float]
    limit: float
    unit: str
    at_least: bool = False
    bound: Callable[[Figures], float] | None = None
    by: str = ""

    def line(self, figures: Figures) -> str:
        """The figure, what it comes to there, the target, a mark where it falls short, and the bound."""
        value = there = self.value(figures)
        if self.unit != "x":
            there *= THERE / figures[KERNEL]
        met = there >= self.limit if self.at_least else there <= self.limit
        bound = f"   {self.bound(figures):.3g} {self.by}" if self.bound else ""
        scaled, limit = "" if self.unit == "x" else f"{there:.3g}", f"{'>=' if self.at_least else '<='} {self.limit:g}"
        return f"  {'' if met else '!':<2}{self.what:<58}{value:9.3g} {self.unit:<3}{scaled:>7} {limit:<8}{bound}"


ARITHMETIC = "its arithmetic at the rate of vectors"  # counted and measured by bounds.py


def timed(what: str, key: str, limit: float, unit: str, by: str = ARITHMETIC) -> Target:
    """A figure by itself, and its arithmetic."""
    return Target(what, lambda f: f[key], limit, unit, bound=lambda f: f[f"{key}_bound"], by=by)


TARGETS = (
    Target(
        "linear, two workers with file, over the compiled kernel",
        lambda f: f["sweep"] / f["linear_compiled"],
        1.0,
        "x",
        bound=lambda f: 0.5 * (f["linear"] + f["packing"]) / f["linear_compiled"],
        by="the engine and gzip alone on two",
    ),
    Target(
        "  the whole process",
        lambda f: f["sweep_process"] / f["linear_compiled"],
        1.5,
        "x",
        bound=lambda f: (0.5 * (f["linear"] + f["packing"]) + f["start"]) / f["linear_compiled"],
        by="that, and its imports",
    ),
    Target(
        "linear, 10^4 cells, one process",
        lambda f: f["linear_small"],
        0.8,
        "us",
        bound=lambda f: f["linear"] + 100.0 * f["one_cell"],
        by="as of 10^6, and the calls for one cell that chatters",
    ),
    Target(
        "nonlinear rigid body, heyoka over the engine",
        lambda f: f["nonlinear_heyoka"] / f["nonlinear"],
        8.0,
        "x",
        True,
        bound=lambda f: f["nonlinear_heyoka"] / f["nonlinear_compiled"],
        by="a compiled Taylor kernel",
    ),
    Target(
        "  the engine over a compiled Taylor kernel, one thread",
        lambda f: f["nonlinear"] / f["nonlinear_compiled"],
        1.5,
        "x",
        bound=lambda f: f["nonlinear_bound"] / f["nonlinear_compiled"],
        by=ARITHMETIC,
    ),
    Target(
        "  as a command, two workers, over one engine",
        lambda f: f["nonlinear_command"] / f["nonlinear"],
        0.65,
        "x",
        bound=lambda f: f["nonlinear_halves"] / f["nonlinear"],
        by="half of it in each of two processes at once",
    ),
    timed("nonlinear arch of seven voussoirs", "arch", 8.0, "us"),
    timed("Ricker wavelet", "ricker", 10.0, "us"),
    timed("Mavroeidis-Papageorgiou pulse", "mavroeidis", 10.0, "us"),
    timed("envelope of 400 frequencies, every boundary", "envelope", 1.0, "s", f"{ARITHMETIC}, on all cores"),
    timed("  of 5 cycles, from those of 8 and of 40", "envelope_cycles", 10.0, "s", f"{ARITHMETIC}, on all cores"),
    timed("bodies that hardly lose speed, just above uplift", "lossless", 1.0, "s"),
    Target(
        "a whole process, 10 x 10 cells",
        lambda f: f["process"],
        0.15,
        "s",
        bound=lambda f: f["process_import"],
        by="to import NumPy, h5py, click and PyYAML",
    ),
    Target("  rocking --help", lambda f: f["help"], 0.08, "s", bound=lambda f: f["help_import"], by="to import click"),
    Target("  rocking params", lambda f: f["params"], 0.08, "s", bound=lambda f: f["params_import"], by="to import click and PyYAML"),
    Target("many cells over few, a cell, one process", lambda f: f["large"] / f["large_single"], 1.1, "x", bound=lambda f: 1.0, by="alike"),
    Target("two dask workers, one over both", lambda f: f["cluster"], 1.7, "x", True, bound=lambda f: 2.0, by="two processes"),
)


def table(figures: Figures) -> str:
    """Every target, under a line that tells how times of this machine are held against those of the other."""
    how = f"Times as measured, and as of the machine for which their targets were set: times {THERE} / {figures[KERNEL]:.3g}"
    why = "what the compiled kernel takes there and here for a linear cell on one thread. What falls short is marked."
    return "\n".join([f"Targets. {how}, {why}", *(target.line(figures) for target in TARGETS)])


def write(figures: Figures) -> None:
    """Keep what was measured, to two digits: the table tells no more."""
    assert figures.keys() == {*ROWS, *MORE}
    FILE.write_text(json.dumps({key: float(f"{value:.2g}") for key, value in figures.items()}, indent=1) + "\n", encoding="utf-8")


def in_readme(text: str) -> str:
    """The README's text with the table that the file holds: a row for each figure that was measured."""
    figures = json.loads(FILE.read_text(encoding="utf-8"))
    rows = [f"| {what} | {figures[key]:g} {unit} | {error} |\n" for key, (what, unit, error) in ROWS.items() if key in figures]
    return MARKS.sub("".join(["| one cycle of a sine | time | error at most |\n|---|---|---|\n", *rows]), text)
