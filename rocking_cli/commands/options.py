"""Options that several commands share, each defined once, and the structures of a call."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from .command import argument, option
from .parameter_types import InputPath, OutputPath, Parsed, limit
from .printing import below, note

if TYPE_CHECKING:
    from ..motions.grid import Grid
    from ..motions.recording import Recording
    from ..structures import RockingParameters
    from .families import Family

FIGURES = (".png", ".svg", ".pdf")
_REMARKS = 3  # printed at most


def _at_most_the_cpus(_: click.Context, __: click.Parameter, given: int | None) -> int | None:
    from ..processes import available_cpus

    cpus = available_cpus()
    if given is None or given <= cpus:
        return given
    note(f"--workers {given}: reduced to {cpus}, the number of available CPUs")
    return cpus


# Arguments and options that several commands share.
files = partial(argument, nargs=-1, type=InputPath(), metavar="[FILE]...")
output = partial(option, "-o", "--output", type=OutputPath())
overwrite = partial(option, "--overwrite", is_flag=True, help="Replace an output that exists.")
strict = partial(option, "--strict", is_flag=True, help="Refuse data of machines or libraries whose results may differ in the last digits.")
workers = partial(option, "--workers", type=click.IntRange(1), callback=_at_most_the_cpus, help="Processes to use (default: all cores).")
a_max = partial(
    option, "--a-max", type=Parsed("amplitude", limit), default="20", show_default=True, metavar="AMPLITUDE",
    help="Largest amplitude of the search: A, or with a unit a_g, such as 1g.",
)  # fmt: skip
vary = partial(
    option, "--vary", multiple=True, metavar="KEY=START:STOP:N",
    help="Vary this key: a family of structures; repeatable, all combinations.",
)  # fmt: skip


def structures_of(files: tuple[str, ...], etas: tuple[float | None, ...] = ()) -> list[RockingParameters]:
    """The structures of the given documents and the dimensionless oscillators of the given restitutions."""
    return structures_and_texts(files, etas)[0]


def structures_and_texts(files: tuple[str, ...], etas: tuple[float | None, ...] = ()) -> tuple[list[RockingParameters], str]:
    """The structures, and the text of their documents."""
    from ..structures import build_structure, with_distinct_names
    from ..structures.parameters import dimensionless_oscillator

    documents = [] if etas and not files else documents_of(files)
    if None in etas:
        raise click.UsageError("--eta block goes with --alpha")
    structures = [build_structure(document) for document in documents]
    try:
        oscillators = [dimensionless_oscillator(eta) for eta in etas if eta is not None]
    except ValueError as error:
        raise click.UsageError(f"--eta: {error}") from None
    found = with_distinct_names([*structures, *oscillators])
    remark_on(found)
    return found, "\n---\n".join(d.text for d in documents)


def members_of(files: tuple[str, ...], vary: tuple[str, ...], etas: tuple[float | None, ...] = ()) -> Family:
    """The structures of `structures_of`, or the families of --vary with the columns of their varied values."""
    if not vary:
        return structures_of(files, etas), {}, 0
    from .families import families

    if etas:
        raise click.UsageError("--vary goes with FILE, not with --eta")
    return families(documents_of(files), vary)


def documents_of(files: tuple[str, ...], most: int | None = None, place: str = "") -> list[Any]:
    """The structure documents of the files, up to `most` in a `place`. Raises click.UsageError."""
    from ..structures import read_documents

    if not files:
        sizeless = any(parameter.name == "etas" for parameter in click.get_current_context().command.params)
        instead = ", or --eta with a dimensionless grid" if sizeless else ""
        raise click.UsageError(f"no structure: give FILE (- for standard input){instead}")
    found = [document for path in files for document in read_documents(path)]
    if most is not None and len(found) > most:
        raise click.UsageError(f"found {len(found)} structures; up to {most} fit {place}")
    return found


def remark_on(structures: Iterable[RockingParameters] = (), grid: Grid | None = None, spans: str = "") -> None:
    """Print up to three remarks on unusual structures, amplitudes and spans."""
    from ..reports.plausibility import bare_remarks, grid_remarks, span_remarks, structure_remarks

    remarks = [remark for one in structures for remark in structure_remarks(one)] + ([] if grid is None else list(grid_remarks(grid)))
    remarks += [*span_remarks(spans), *bare_remarks(spans)]
    for remark in remarks[:_REMARKS]:
        below(remark)
    if len(remarks) > _REMARKS:
        below(f"and {len(remarks) - _REMARKS} more such remarks")


def refuse_own_input(output: Path, recordings: Sequence[Recording] = ()) -> None:
    """Raise click.UsageError if the output is a document or a record of this call, which --overwrite would destroy."""
    context = click.get_current_context()
    sources = [recording.record.source for recording in recordings]
    for parameter in context.command.params:
        if isinstance(parameter.type, InputPath):
            given = context.params[parameter.name or ""] or ()
            sources += [given] if isinstance(given, str) else given
    for source in sources:
        if os.path.isfile(source) and output.is_file() and os.path.samefile(source, output):
            raise click.UsageError(f"{output} is an input of this call; give another output")
