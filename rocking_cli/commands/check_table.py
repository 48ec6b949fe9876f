"""The table of verdicts that `rocking check -o FILE.h5` writes."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click
import numpy as np

from . import options
from .check_demands import LONG_TABLE
from .command import partly, refuse
from .printing import emit, form, note
from .progress import ProgressLine

if TYPE_CHECKING:
    from .check import CheckOptions
    from .check_demands import Demands

TABLES = (".h5", ".hdf5", ".nc")  # endings of a table


def is_table(output: Path | None) -> bool:
    """True for the name of a table of verdicts. Raises click.UsageError if another
    call states how to write one.
    """
    if output is not None and output.suffix.lower() in TABLES:
        refuse(
            "does not go with -o FILE.h5, which holds one verdict for each structure"
            " and motion",
            *("draws", "code", "sort", "inset_effect", "azimuth"),
            *("columns", "where", "style"),
        )
        return True
    refuse("goes with -o FILE.h5", "resume", "shard", "scheduler")
    return False


def write_table(demands: Demands, wanted: CheckOptions, sweep: options.Sweep) -> int:
    """Write the verdicts of a call into a file, say how many fall, and return the exit
    code.
    """
    from ..dynamics.outcome import Outcome
    from ..spectra.file.partial_file import check_output
    from ..spectra.sweep_options import SweepOptions
    from ..spectra.verdicts import SIGNS, VerdictScene, write_verdicts

    output = wanted.output
    assert output is not None
    if demands.up_to is not None:
        raise click.UsageError(
            "-o FILE.h5 does not go with a range of frequencies; expected one"
        )
    if wanted.fail_on not in (None, "overturning"):
        raise click.UsageError("-o FILE.h5 goes with --fail-on overturning alone")
    check_output(output, sweep.overwrite, sweep.resume)
    options.refuse_own_input(output, demands.shaken.recordings)
    shaken = demands.shaken
    stated, opposite = SIGNS
    shakes = {opposite if demands.sign == "-" else stated: shaken.shakes}
    if demands.sign == "both":
        shakes[opposite] = shaken.reversed.shakes
    structures = tuple(demands.structures)
    forces = len(structures) < LONG_TABLE
    scene = VerdictScene(structures, shakes, shaken.recordings, wanted.limit, forces)
    settings = SweepOptions(
        history=f"{options.now()}: {options.command_line()}",
        progress=ProgressLine("check", "chunks"),
        **sweep.writing(()),
    )
    row = write_verdicts(scene, output, settings)
    counts = np.array([row[f"cells_{o.flag}"] for o in Outcome])
    falls = int(sum(counts[o] for o in Outcome if o.falls))
    known = int(counts.sum() - counts[Outcome.NOT_COMPUTED])
    note(f"{output}: {known:,} verdicts, {falls:,} of them falls")
    if form() == "json":
        emit([{"output": str(output), **row}])
    partly(counts[Outcome.FAILED])
    return 5 if wanted.fail_on and falls else 0
