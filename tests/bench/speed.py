"""What `make bench` measured last, the README's table of it, and how far it is from
what is aimed at.

bench.py writes speed.json; a test compares the README's table with it.
"""

import json
import re
from pathlib import Path
from typing import NamedTuple

Figures = dict[str, float]
FILE = Path(__file__).with_name("speed.json")
MARKS = re.compile(r"(?<=<!-- speed -->\n).*?(?=<!-- /speed -->)", re.DOTALL)
# key of the file: what is timed, unit, what holds the answer, and how near it is
ROWS = {
    "linear": (
        "a linear cell of 10⁶, one process",
        "µs",
        "1e-12 in θ/α after one cycle, every outcome",
    ),
    "sweep": ("the same with its file, two processes", "µs", "stated in the file"),
    "linear_compiled": ("the same algorithm compiled (numba), two threads", "µs", ""),
    "linear_heyoka": ("heyoka at 1e-12, two processes", "µs", ""),
    "linear_scipy": ("SciPy's DOP853 at 1e-12, two processes", "µs", ""),
    "linear-small": ("a linear cell of 10⁴, one process", "µs", "as of 10⁶"),
    "ricker": ("the same under a Ricker wavelet", "µs", "1e-12"),
    "nonlinear": (
        "a nonlinear cell of a rigid body at 1e-9",
        "µs",
        "the tolerance times the cell's condition",
    ),
    "nonlinear_heyoka": ("heyoka at 1e-9", "µs", ""),
    "arch": ("a nonlinear cell of an arch at 1e-9", "µs", "the same"),
    "envelope": (
        "an envelope of 400 frequencies up to A = 20",
        "s",
        "intervals wider than 1e-3",
    ),
}
# Measured as well, for the targets alone: other scenes, whole processes and ratios.
MORE = (
    "linear_compiled_one",
    "nonlinear_command",
    "mavroeidis",
    "sweep_process",
    "envelope-cycles",
    "lossless",
    "record",
    "record-fine",
    "record-long",
    "record-nonlinear",
    "process",
    "help",
    "params",
    "large",
    "large_single",
    "cluster",
)
IN_SECONDS = (
    "envelope-cycles",
    "lossless",
)  # scenes whose figure is that of the whole scene
# the figure that tells how fast a machine is; its value where targets in us and s were
# set
KERNEL, THERE = ("linear_compiled_one", 0.508)


class Target(NamedTuple):
    """What is aimed at: a figure, or the ratio of two (key and over), at most or at
    least a limit. A time is held against it as it would be on the machine for which it
    was set (`THERE`), a ratio as it is.
    """

    what: str
    key: str
    over: str
    limit: float
    unit: str = "x"
    at_least: bool = False

    def line(self, figures: Figures) -> str:
        """The figure, what it comes to there, the target, and a mark where it falls
        short.
        """
        value = there = figures[self.key] / (figures[self.over] if self.over else 1.0)
        if self.unit != "x":
            there *= THERE / figures[KERNEL]
        met = there >= self.limit if self.at_least else there <= self.limit
        scaled, limit = (
            "" if self.unit == "x" else f"{there:.3g}",
            f"{'>=' if self.at_least else '<='} {self.limit:g}",
        )
        return (
            f"  {'' if met else '!':<2}{self.what:<58}{value:9.3g}"
            f" {self.unit:<3}{scaled:>7} {limit}"
        )


TARGETS = (
    Target(
        "linear, two workers with file, over the compiled kernel",
        "sweep",
        "linear_compiled",
        1.0,
    ),
    Target("  the whole process", "sweep_process", "linear_compiled", 1.5),
    Target("linear, 10^4 cells, one process", "linear-small", "", 0.8, "us"),
    Target(
        "nonlinear rigid body, heyoka over the engine",
        "nonlinear_heyoka",
        "nonlinear",
        8.0,
        at_least=True,
    ),
    Target(
        "  as a command, two workers, over one engine",
        "nonlinear_command",
        "nonlinear",
        0.65,
    ),
    Target("nonlinear arch of seven voussoirs", "arch", "", 8.0, "us"),
    Target("Ricker wavelet", "ricker", "", 10.0, "us"),
    Target("Mavroeidis-Papageorgiou pulse", "mavroeidis", "", 10.0, "us"),
    Target("record of 2,000 samples, linear", "record", "", 60.0, "us"),
    Target("  four times as finely", "record-fine", "record", 1.5),
    Target("  20,000 samples in the same time", "record-long", "record", 2.0),
    Target("  nonlinear rigid body", "record-nonlinear", "", 300.0, "us"),
    Target("envelope of 400 frequencies, every boundary", "envelope", "", 1.0, "s"),
    Target("  of 40 under 5 cycles, one process", "envelope-cycles", "", 2.0, "s"),
    Target(
        "bodies that hardly lose speed, just above uplift", "lossless", "", 1.0, "s"
    ),
    Target("a whole process, 10 x 10 cells", "process", "", 0.15, "s"),
    Target("  rocking --help", "help", "", 0.08, "s"),
    Target("  rocking params", "params", "", 0.08, "s"),
    Target("many cells over few, a cell, one process", "large", "large_single", 1.1),
    Target("two dask workers, one over both", "cluster", "", 1.7, at_least=True),
)


def table(figures: Figures) -> str:
    """Every target, under a line that tells how times of this machine are held against
    those of the other.
    """
    how = (
        "Times as measured, and as of the machine for which their targets were set:"
        f" times {THERE} / {figures[KERNEL]:.3g}"
    )
    why = (
        "what the compiled kernel takes there and here for a linear cell on one thread."
        " What falls short is marked."
    )
    return "\n".join(
        [f"Targets. {how}, {why}", *(target.line(figures) for target in TARGETS)]
    )


def write(figures: Figures) -> None:
    """Keep what was measured, to two digits: the table tells no more."""
    assert figures.keys() == {*ROWS, *MORE}
    FILE.write_text(
        json.dumps(
            {key: float(f"{value:.2g}") for key, value in figures.items()}, indent=1
        )
        + "\n",
        encoding="utf-8",
    )


def in_readme(text: str) -> str:
    """The README's text with the table that the file holds."""
    figures = json.loads(FILE.read_text(encoding="utf-8"))
    rows = [
        f"| {what} | {figures[key]:g} {unit} | {error} |\n"
        for key, (what, unit, error) in ROWS.items()
    ]
    return MARKS.sub(
        "".join(
            ["| one cycle of a sine | time | error at most |\n|---|---|---|\n", *rows]
        ),
        text,
    )
