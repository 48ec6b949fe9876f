"""The options of what a command writes, the spectra file of a sweep and a figure, and its history: the call and the time."""

from __future__ import annotations

import shlex
import sys
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import click

from . import options, streams
from .command import option
from .parameter_types import InputPath, quantity
from .printing import note

if TYPE_CHECKING:
    from ..reports.figures.canvas import Look


@dataclass(frozen=True)
class Looks:
    """How a figure is written."""

    size: float | None = option("--size", type=quantity("length"), metavar="WIDTH", help="Width of the figure, such as 85mm.")
    dpi: float | None = option("--dpi", type=click.FloatRange(20.0, 2400.0), help="Dots per inch (default: 200; maps in SVG and PDF 600).")
    title: str | None = option("--title", metavar="TEXT", help="Title in place of the figure's own.")
    style: str | None = option("--style", type=InputPath(), metavar="FILE", help="Style file of matplotlib (.mplstyle).")

    def look(self) -> Look:
        """The look that the options ask for. Raises click.UsageError."""
        from ..reports.figures.canvas import Look

        if self.size is not None and not 0.02 <= self.size <= 2.0:
            raise click.UsageError(f"--size: found {self.size:g} m; expected a width from 20 mm to 2 m, with its unit, such as 85mm")
        return Look(self.size, self.dpi, self.title, self.style)


@dataclass(frozen=True)
class Sweep:
    """The options of the computation and of the file of a sweep."""

    workers: int | None = options.workers()
    overwrite: bool = options.overwrite()
    resume: bool = option("--resume", is_flag=True, help="Go on with an interrupted sweep of the same scene (OUTPUT.part).")
    shard: str | None = option("--shard", metavar="I/N", help="Compute only the I-th of N parts; rocking merge joins them.")
    scheduler: str | None = option("--scheduler", metavar="ADDRESS", help="Compute on a dask.distributed cluster, such as tcp://host:8786.")

    def writing(self, documents: str) -> dict[str, Any]:
        """Arguments of `write_scene`; documents: the texts of the structures. Raises click.UsageError for --shard."""
        from ..documents.quantities import parse_whole

        shard = None
        if self.shard is not None:
            part, count = (parse_whole(x) for x in self.shard.partition("/")[::2])
            if part is None or count is None or not 1 <= part <= count <= 1_000_000:
                raise click.UsageError(f"--shard: found {self.shard!r}; expected I/N with I from 1 to N, such as 2/8")
            shard = part, count
        return {
            "overwrite": self.overwrite, "resume": self.resume, "scheduler": self.scheduler, "shard": shard, "documents": documents,
            "tell": note,
        }  # fmt: skip


def command_line() -> str:
    """The call as a shell command."""
    return streams.printable(shlex.join(["rocking", *sys.argv[1:]]))


def now() -> str:
    """The time in UTC as the history of a file states it."""
    from datetime import UTC, datetime

    return datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
