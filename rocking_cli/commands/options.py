"""Options that several commands share, each defined once; the structures of a call, its
text and its time.
"""

from __future__ import annotations

import itertools
import os
import re
import shlex
import sys
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, suppress
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from ..errors import DocumentError
from .command import argument, flag, given, option, partly, refuse
from .parameter_types import (
    InputPath,
    OutputPath,
    Parsed,
    VariedKey,
    limit,
    quantity,
)
from .printing import detail, emit, form, keep_labels, note, units_of
from .streams import printable

if TYPE_CHECKING:
    from ..motions.grid import Grid
    from ..motions.recording import Recording
    from ..reports.figures.canvas import Figure, Look
    from ..reports.units import Units
    from ..structures import RockingParameters
    from ..structures.family import Member

T = TypeVar("T")
FIGURES = (".png", ".svg", ".pdf")
_REMARKS = 3  # printed at most


def _at_most_the_cpus(
    _: click.Context, __: click.Parameter, given: int | None
) -> int | None:
    from ..processes import available_cpus

    cpus = available_cpus()
    if given is None or given <= cpus:
        return given
    detail(f"--workers {given}: reduced to {cpus}, the number of available CPUs")
    return cpus


# Arguments and options that several commands share.
files = partial(argument, nargs=-1, type=InputPath(), metavar="[FILE]...")
output = partial(option, "-o --output", type=OutputPath())
overwrite = partial(flag, "--overwrite", "Replace an output that exists.")
strict = partial(
    flag,
    "--strict",
    "Refuse data of machines or libraries whose results may differ in the last digits.",
)
workers = partial(
    option,
    "--workers",
    "Processes to use (default: all cores).",
    type=click.IntRange(1),
    callback=_at_most_the_cpus,
)
a_max = partial(
    option,
    "--a-max",
    "Largest amplitude of the search: A, or with a unit a_g, such as 1g.",
    type=Parsed("amplitude", limit),
    default="20",
)
vary = partial(
    option,
    "--vary",
    "Vary a key: a family; repeatable, all combinations.",
    multiple=True,
    type=VariedKey(),
    metavar="KEY=START:STOP:N[:log]",
)
inset_effect = partial(
    flag,
    "--inset-effect",
    "Print what pivots 5 % of the width inside the edges would take of the capacity.",
)
over = partial(
    option,
    "--over",
    "The axis of a family (default: the first key varied).",
    metavar="KEY[/KEY]",
)
draws = partial(
    option,
    "--draws",
    "Draw numbers with a spread, such as width: 0.5 m +- 10 mm, so many times.",
    type=click.IntRange(2, 1 << 20),
)
seed = partial(
    option,
    "--seed",
    "Seed of the random numbers.",
    type=click.IntRange(0),
    default=0,
)
skip_faulty = partial(
    flag,
    "--skip-faulty",
    "Leave out, and tell, rows of a table that hold a fault (exit code 4).",
)
sort = partial(
    option,
    "--sort",
    "The least capacity first, structures that never overturn last.",
    type=click.Choice(["capacity"]),
)


@dataclass(frozen=True)
class Looks:
    """How a figure is written."""

    size: float | None = option(
        "--size", "Width of the figure, such as 85mm.", type=quantity("length")
    )
    dpi: float | None = option(
        "--dpi",
        "Dots per inch (default: 200; maps in SVG and PDF 600).",
        type=click.FloatRange(20.0, 2400.0),
    )
    title: str | None = option(
        "--title", "Title in place of the figure's own.", metavar="TEXT"
    )
    style: str | None = option(
        "--style", "Style file of matplotlib (.mplstyle).", type=InputPath()
    )

    def look(self) -> Look:
        """Return the look that the options state. Raises click.UsageError."""
        from ..reports.figures.canvas import Look

        if self.size is not None and not 0.02 <= self.size <= 2.0:
            raise click.UsageError(
                f"--size: found {self.size:g} m; expected a width from 20 mm to 2 m,"
                " with its unit, such as 85mm"
            )
        return Look(self.size, self.dpi, self.title, self.style)


@dataclass(frozen=True)
class FigureFile:
    """The figure of a command that prints rows: that of `rocking plot`."""

    output: Path | None = output("Draw the rows too: .png, .svg or .pdf.")
    overwrite: bool = overwrite()

    def check(self) -> None:
        """Refuse, before any work is done, a figure that cannot or must not be
        written.
        """
        if self.output is None:
            refuse("goes with -o FIGURE", "overwrite")
        else:
            check_target(self.output, self.overwrite)

    def draw(
        self, source: Any, over: str | None = None, units: Units | None = None
    ) -> None:
        """Draw what `draw` takes, such as rows in SI, if the call has an output; over:
        the abscissa of a family; units: None for those of --units. Raises UsageError.
        """
        if self.output is not None:
            from ..reports.drawing_files import draw

            draw(
                source,
                self.output,
                over=over,
                units=units or units_of(),
                overwrite=self.overwrite,
                tell=note,
            )

    def emit(
        self, rows: Iterable[Mapping[str, Any]], columns: Sequence[str] = (), **how: Any
    ) -> None:
        """Print rows as `emit` does, and draw them."""
        drawn: list[Mapping[str, Any]] = []
        emit(_kept(rows, drawn), columns, **how)
        self.draw(drawn)

    def canvas(self) -> AbstractContextManager[Figure]:
        """Return the context of the figure, for what no other command draws."""
        from ..reports.figures.canvas import canvas

        assert self.output is not None
        return canvas(self.output, self.overwrite, tell=note)


def _kept(rows: Iterable[T], into: list[T]) -> Iterator[T]:
    """Yield rows and keep them in a list."""
    for row in rows:
        into.append(row)
        yield row


@dataclass(frozen=True)
class Sweep:
    """The options of the computation and of the file of a sweep."""

    workers: int | None = workers()
    overwrite: bool = overwrite()
    resume: bool = flag(
        "--resume", "Go on with an interrupted sweep of the same scene (OUTPUT.part)."
    )
    shard: str | None = option(
        "--shard",
        "Compute only the I-th of N parts; rocking merge joins them.",
        metavar="I/N",
    )
    scheduler: str | None = option(
        "--scheduler",
        "Compute on a dask.distributed cluster, such as tcp://host:8786.",
        metavar="ADDRESS",
    )

    def writing(self, structures: Iterable[RockingParameters]) -> dict[str, Any]:
        """Return the arguments of `write_scene`; structures: those whose documents the
        file holds. Raises click.UsageError for a wrong --shard.
        """
        from ..documents.quantities import parse_whole

        shard = None
        if self.shard is not None:
            part, count = (parse_whole(x) for x in self.shard.partition("/")[::2])
            if part is None or count is None or not 1 <= part <= count <= 1_000_000:
                raise click.UsageError(
                    f"--shard: found {self.shard!r}; expected I/N with I from 1 to N,"
                    " such as 2/8"
                )
            shard = part, count
        texts = "\n---\n".join(s.document.text for s in structures if s.document)
        return {**vars(self), "shard": shard, "documents": texts, "tell": note}


def structures_of(
    files: tuple[str, ...],
    etas: tuple[float | None, ...] = (),
    each: bool = False,
    with_documents: int | None = None,
) -> Sequence[RockingParameters]:
    """Return the structures of the documents in these files, and a dimensionless
    oscillator for each restitution; each: a stack is a structure for each of its
    interfaces, see `on_each_interface`; with_documents: number of structures that keep
    their documents, None for all; to save memory the others keep one only if it has a
    spread, and the structures are `Packed`.
    """
    from ..structures import build_structure
    from ..structures.parameters import dimensionless_oscillator

    numbers = itertools.count()

    def structure_of(document: Any) -> RockingParameters:
        built = build_structure(document)
        held = with_documents is None or next(numbers) < with_documents
        return built if held or built.drawn_from else replace(built, document=None)

    if None in etas:
        raise click.UsageError("--eta block goes with --alpha")
    documents = iter([]) if etas and not files else each_document(files)
    structures = sound(structure_of, _on_each(documents) if each else documents)
    oscillators = [dimensionless_oscillator(eta=eta) for eta in etas if eta is not None]
    every = itertools.chain(structures, oscillators)
    return _told(every, packed=with_documents is not None)


def _told(
    structures: Iterable[RockingParameters], packed: bool = False
) -> Sequence[RockingParameters]:
    """Return structures with distinct names, and print what is to be said of them;
    packed: True for `Packed` ones.
    """
    from ..packed import Packed
    from ..structures import with_distinct_names

    names = []

    def seen() -> Iterator[RockingParameters]:
        for s in introduced(with_distinct_names(structures)):
            if "interfaces" in s.details:
                names.append(s.name)
            yield s

    found = Packed(seen()) if packed else list(seen())
    if names:
        note(f"followed on one interface, as if no other opened: {', '.join(names)}")
    return found


def members_of(
    files: tuple[str, ...],
    vary: tuple[str, ...],
    etas: tuple[float | None, ...] = (),
    each: bool = False,
) -> tuple[Sequence[RockingParameters], dict[str, dict[str, float]]]:
    """Return (structures, columns): those of `structures_of`, or of the families of
    --vary, and for each name the varied values in SI as columns such as `varied_width`;
    each: see `structures_of`. Members without a solution are reported and left out.
    """
    if not vary:
        return structures_of(files, etas, each, with_documents=0), {}
    from ..documents.quantities import headed
    from ..structures.family import family, members, parse_variation
    from ..structures.parameters import VARIED

    refuse("does not go with --vary", "etas", "skip_faulty")
    documents = documents_of(files)
    variations = [parse_variation(text) for text in vary]
    members(variations)
    every = [
        member
        for document in documents
        for member in family(document, variations, each)
    ]
    for member in every:
        if member.parameters is None:
            note_no_solution(member)
    found = _told(one.parameters for one in every if one.parameters is not None)
    columns = {}
    for structure in found:
        values, units = (structure.details[key] for key in VARIED)
        columns[structure.name] = {
            headed(f"varied_{k}", "" if form() == "json" else units[k]): value
            for k, value in values.items()
        }
    return found, columns


def built_if_whole(documents: Iterable[Any]) -> Iterator[RockingParameters]:
    """Yield the structures of documents; one that lacks the key that the call varies
    has none.
    """
    from ..structures import build_structure

    for document in documents:
        with suppress(DocumentError):
            yield build_structure(document)


def note_no_solution(member: Member) -> None:
    """Print why a member of a family has no solution and is left out."""
    partly()
    varied = ", ".join(f"{key} = {value:g}" for key, value in member.shown.items())
    note(f"no solution for {varied}: {member.fault}")


def documents_of(
    files: tuple[str, ...], most: int | None = None, place: str = ""
) -> list[Any]:
    """Return the structure documents of the files. Raises click.UsageError for more
    than `most`; place: what limits them, in words.
    """
    found = list(each_document(files))
    if most is not None and len(found) > most:
        raise click.UsageError(
            f"found {len(found)} structures; expected at most {most} for {place}"
        )
    return found


def _on_each(documents: Iterable[Any]) -> Iterator[Any]:
    """Yield the documents of each interface of stacks, and others as they are."""
    from ..structures import on_each_interface

    for several in sound(on_each_interface, documents):
        yield from several


def sound(make: Callable[[Any], T], documents: Iterable[Any]) -> Iterator[T]:
    """Yield what `make` returns for each document. With --skip-faulty one that holds a
    fault is left out and told. Raises DocumentError.
    """
    for document in documents:
        try:
            made = make(document)
        except DocumentError as fault:
            _left_out(fault)
            continue
        yield made


def _left_out(fault: DocumentError) -> None:
    """Tell the fault of a structure that --skip-faulty leaves out; raise it without
    this option.
    """
    if not given("skip_faulty"):
        raise fault
    partly()
    note(f"left out: {fault}")


def each_document(files: tuple[str, ...]) -> Iterator[Any]:
    """Yield the structure documents of the files one by one. Raises click.UsageError
    without a file.
    """
    from ..structures import documents_in

    if not files:
        sizeless = any(
            parameter.name == "etas"
            for parameter in click.get_current_context().command.params
        )
        instead = ", or --eta with a dimensionless grid" if sizeless else ""
        raise click.UsageError(
            f"no structure: give FILE (- for standard input){instead}"
        )
    faulty = _left_out if given("skip_faulty") else None
    for path in files:
        yield from documents_in(path, faulty)


def introduced(
    structures: Iterable[RockingParameters], in_rows: bool = False
) -> Iterator[RockingParameters]:
    """Yield the structures of a call, and keep their labels for the rows of the output;
    in_rows: as of `keep_labels`. Behind the last one print what is to be said of them:
    remarks on their numbers, and the labels that tables have beside them.
    """
    from ..reports.plausibility import structure_remarks

    remarks: list[str] = []
    more = 0
    spread: dict[str, None] = {}  # keys
    names: dict[str, None] = {}  # of labels
    for structure in structures:
        if structure.building and given("building"):
            raise click.UsageError(
                "--building does not go with a structure whose document has the key"
                f" building: {structure.name}"
            )
        for remark in structure_remarks(structure):
            more += len(remarks) == _REMARKS
            remarks += [remark][: _REMARKS - len(remarks)]
        if structure.drawn_from:
            spread |= dict.fromkeys(structure.drawn_from.uncertain)
        if structure.labels:
            keep_labels([structure], in_rows)
            names |= dict.fromkeys(structure.labels)
        yield structure
    _tell_remarks(remarks, more)
    note_spreads(spread)
    if names:
        shown = ", ".join(names)
        has_columns = any(
            parameter.name == "columns"
            for parameter in click.get_current_context().command.params
        )
        detail(
            "labels, not used:"
            f" {shown}{' (--columns shows them)' if has_columns else ''}"
        )


def note_spreads(keys: Collection[str]) -> None:
    """Print which keys have a spread, if the call takes their means."""
    parameters = click.get_current_context().params
    if not keys or parameters.get("draws"):
        return
    more = "; --draws draws them" if "draws" in parameters else ""
    note(f"means are taken of numbers with a spread: {', '.join(keys)}{more}")


def remark_on(grid: Grid | None = None, spans: str = "") -> None:
    """Print remarks on amplitudes and spans that are probably wrong."""
    from ..reports.plausibility import bare_remarks, grid_remarks, span_remarks

    remarks = [] if grid is None else list(grid_remarks(grid))
    remarks += [*span_remarks(spans), *bare_remarks(spans)]
    _tell_remarks(remarks[:_REMARKS], len(remarks) - _REMARKS)


def _tell_remarks(remarks: Sequence[str], more: int) -> None:
    """Print remarks, and the number of the others."""
    note(*remarks, *([f"and {more} more such remarks"] if more > 0 else []))


def check_target(
    output: Path,
    overwrite: bool,
    suffixes: tuple[str, ...] = FIGURES,
    packages: tuple[str, ...] = (),
    instead: str = "",
) -> None:
    """Refuse, before any work is done, an output that cannot or must not be written.

    packages: the arguments of `require`, those of a figure if empty; instead: what its
    message adds. Raises UsageError, and OutputError if a package is missing.
    """
    from ..plugins import require
    from ..publishing import check_target as check
    from ..reports.figures.canvas import DRAWN_WITH

    if output.suffix.lower() in _OF_TABLES and suffixes == FIGURES:
        raise click.UsageError(
            f"{output}: expected a name that ends in .png, .svg or .pdf, for a figure,"
            f" or the rows by --csv > {output.with_suffix('.csv')}"
        )
    check(output, overwrite, suffixes)
    refuse_own_input(output)
    require(*(packages or DRAWN_WITH), instead=instead)


_OF_TABLES = (".csv", ".json", ".jsonl", ".xlsx", ".tex", ".md", ".txt")
_BESIDE = re.compile(r"(?:,\s*\w+=[^,=]*)+\Z")


def refuse_own_input(output: Path, recordings: Sequence[Recording] = ()) -> None:
    """Raise click.UsageError if the output is a document or a record of this call,
    which --overwrite would destroy.
    """
    context = click.get_current_context()
    sources = [recording.record.source for recording in recordings]
    for parameter in context.command.params:
        if isinstance(parameter.type, InputPath):
            given = context.params[parameter.name or ""] or ()
            sources += [given] if isinstance(given, str) else given
    for given in sources:
        # without what is stated beside it, as FILE,unit=g
        source = given if os.path.isfile(given) else _BESIDE.sub("", given)
        if (
            os.path.isfile(source)
            and output.is_file()
            and os.path.samefile(source, output)
        ):
            raise click.UsageError(
                f"{output} is an input of this call; give another output"
            )


def command_line() -> str:
    """Return the call as a shell command."""
    return printable(shlex.join(["rocking", *sys.argv[1:]]))


def now() -> str:
    """Return the time in UTC as the history of a file states it."""
    from datetime import UTC, datetime

    return datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
