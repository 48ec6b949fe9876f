"""`rocking report`: structures under a motion, as one page."""

from __future__ import annotations

import shlex
import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from . import ground, options, streams
from .parameter_types import OutputPath
from .progress import ProgressLine

if TYPE_CHECKING:
    from ..motions import Motion
    from ..motions.biaxial import Upwards
    from ..motions.grid import Grid
    from ..motions.recording import Recording

MOST = 12  # structures of a page


@click.command(epilog="Example: rocking report configs/block.yaml configs/arch.yaml --a-g 0.35g --f-g 1.5 -o report.html")
@options.files
@click.option("-o", "--output", required=True, type=OutputPath(), help="The page: .html.")
@ground.motions
@ground.vertical_of_each
@ground.shaking
@options.workers
@options.overwrite
@options.quiet
@click.pass_context
def report(
    context: click.Context,
    files: tuple[str, ...],
    output: Path,
    motion: Motion | None,
    recordings: tuple[Recording, ...],
    shaking: Grid | None,
    upwards: Upwards | None,
    workers: int | None,
    overwrite: bool,
    quiet: bool,
) -> None:
    """Write a page about structures under a pulse or a set of records: what stands, what falls, and by how much.

    One HTML file that opens in a browser without a network: the table of rocking check, and for each structure its drawing,
    parameters and their relations, the map with the demand on it, how often the linear equation is wrong, fragility where records
    are given; then the command, versions and hashes. The equation is that of
    rocking check. It needs the extra: pip install 'rocking[report]'.
    """
    from ..dynamics.outcome import Outcome
    from ..motions.grid import as_recorded, demand_in_words
    from ..publishing import check_target, published
    from ..reports.page import Subject, demand_extra, page
    from ..responses.check import check_all, tally
    from ..structures import build_structure, read_documents, with_distinct_names

    if not files:
        raise click.UsageError("no structure: give FILE, or - for standard input")
    if shaking is None and not recordings:
        raise click.UsageError("no shaking: give --a-g and --omega-g (or --f-g, --T-g), or --motion FILE")
    check_target(output, overwrite, (".html", ".htm"))
    options.refuse_own_input(output, recordings)
    demand_extra()
    documents = [document for path in files for document in read_documents(path)]
    if len(documents) > MOST:
        raise click.UsageError(f"found {len(documents)} structures; accepted are up to {MOST} on a page")
    structures = with_distinct_names([build_structure(document) for document in documents])
    options.remark_on(structures)
    workers = options.at_most_the_cpus(workers, quiet)
    if upwards is not None:
        recordings = tuple(replace(r, upwards=upwards) for r in recordings)
    shakes: list[tuple[Motion, Grid]] = [(r.motion, shaking or as_recorded(r.acceleration)) for r in recordings]
    if motion is not None and shaking is not None:
        shakes.append((motion if upwards is None else upwards(motion), shaking))
    demands = [(structure, *shake) for shake in shakes for structure in structures]
    verdicts = check_all(demands, workers=workers, progress=ProgressLine("report", quiet, "stages"))
    text = page(
        [Subject(document, structure) for document, structure in zip(documents, structures, strict=True)],
        verdicts,
        pulse=None if recordings else shakes[0],
        demand=demand_in_words(shakes),
        recordings=recordings,
        vertical=context.params["vertical"],
        command=streams.printable(shlex.join(["rocking", *sys.argv[1:]])),
        made=options.now(),
        workers=workers,
    )
    with published(output, overwrite) as file:
        file.write(text.encode())
    options.note_demand(shakes, quiet)
    options.note_governing(structures, shakes[0][1].dimensionless, quiet)
    options.note(f"{output}: {tally(verdicts)}", quiet)
    if any(v.outcome == Outcome.FAILED for v in verdicts):
        context.exit(4)
