"""`rocking info`: the contents of a spectra file, its verification, and the command
that makes it again.
"""

import shlex
from collections.abc import Mapping
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Any

import click

from . import streams
from .command import argument, command, flag
from .parameter_types import InputPath
from .printing import emit, form, note, printed

if TYPE_CHECKING:
    from ..spectra.file.reader import SpectraFile

_MOST_NAMES = 12
# options that change no cell of the spectrum
_OF_THE_RUN = (
    "output",
    "overwrite",
    "resume",
    "shard",
    "scheduler",
    "workers",
    "quiet",
    "form",
    "json_",
)


@command(
    "rocking spectrum --eta 0.9 --grid A=0.5:8:20,Omega=1:6:20 -o map.h5 && rocking"
    " info map.h5 --verify",
    printed,
)
def info(
    files: tuple[str, ...] = argument(
        nargs=-1, type=InputPath(), required=True, metavar="FILE..."
    ),
    verify: bool = flag("--verify", "Check every chunk against its checksum."),
    again: bool = flag(
        "--command",
        "Also print eta, tolerance, counts and the command that makes the file again.",
    ),
    documents: bool = flag(
        "--documents", "Print the documents of the structures instead, as JSON Lines."
    ),
) -> int:
    """Show the contents of spectra files: scene, completeness, run time, estimated
    error.

    The exit code is 1 if a file is damaged, or with --verify if a chunk is damaged.
    """
    from ..spectra.file.reader import SpectraFile

    damaged: list[str] = []
    rows: list[dict[str, Any]] = []
    for path in files:
        with SpectraFile(path, any_kind=True) as file:
            if documents:
                emit(_documents(file), form="json")
                continue
            row = _contents(path, file)
            if verify:
                numbers = file.damaged_chunks()
                row["damaged_chunks"] = len(numbers)
                damaged += [f"{path}: chunk {i} is damaged" for i in numbers]
            if again:
                row |= _origin(path, file)
            rows.append(row)
    if documents:
        return 0

    hidden = {"command": None} if form() is None else {}  # it stands below a table
    emit([{**row, **hidden} for row in rows])
    commands = [row["command"] for row in rows] if again else []
    if form() is None:
        _put_commands(commands)
    if not all(commands):
        note("written by a function of Python: the file holds no command")
    for line in damaged:
        streams.say(f"rocking: {line}")
    return 1 if damaged else 0


def _contents(path: str, file: "SpectraFile") -> dict[str, Any]:
    """Return the row of a file: its scene, completeness, run time, errors."""
    from ..spectra.work.machine import described

    attributes, dimensions = file.attributes, file.frame.dimensions
    names = {
        f"{name}s": _names(values)
        for name, values in dimensions.items()
        if isinstance(values, list)
    }
    axes = {
        name: f"{values[0]:g} to {values[-1]:g}, {len(values)}"
        for name, values in dimensions.items()
        if not isinstance(values, list)
    }
    checked = attributes.get("checked_cells")
    return {
        "file": path,
        **names,
        "model": file.scene["model"],
        "motion": attributes["motion"],
        **axes,
        "chunks": f"{int(file.done.sum())} of {file.done.size}",
        "complete": "yes" if file.complete else "no",
        "run_time": attributes.get("run_time"),
        "check_time": attributes.get("check_time"),
        "error_bound": attributes.get("error_bound"),
        "error_bound_median": attributes.get("error_bound_median"),
        "cells_above_ten_medians": attributes.get("cells_above_ten_medians"),
        "largest_difference": (
            attributes.get("largest_difference") if checked else None
        ),
        "checked_cells": checked,
        "source": attributes.get("source"),
        "sealed": "yes" if file.digest else "no",
        "digest": file.digest,
        "computed_on": "; ".join(map(described, file.machines)) or None,
    }


def _origin(path: str, file: "SpectraFile") -> dict[str, Any]:
    """Return the columns of --command."""
    counts = {
        key.removeprefix("cells_"): int(n)
        for key, n in file.attributes.items()
        if key.startswith("cells_")
    }
    etas = [f"{one['eta']:.6g}" for one in file.scene.get("structures", ())]
    return {
        "eta": _names(etas) or None,
        "tolerance": file.attributes.get("tolerance"),
        "cells": ", ".join(f"{n} {name}" for name, n in counts.items() if n),
        "command": _command(path, file),
    }


def _put_commands(commands: list[str | None]) -> None:
    """Print commands on standard output, broken where the shell goes on."""
    for line in filter(None, commands):
        parts = wrap(
            line,
            96,
            subsequent_indent="  ",
            break_long_words=False,
            break_on_hyphens=False,
        )
        streams.put(*(f"{part} \\" for part in parts[:-1]), parts[-1])


def _names(values: list[str]) -> str:
    """Return the names as a text; if there are many, only the first, the last and their
    number.
    """
    if len(values) <= _MOST_NAMES:
        return ", ".join(values)
    return f"{len(values)}, {values[0]} to {values[-1]}"


def _documents(file: "SpectraFile") -> list[dict[str, Any]]:
    """Return the documents of a spectra file, each with the name of its structure in
    the file.
    """
    from ..documents.parsing import parse_documents

    text = str(file.attributes.get("documents", ""))
    found = [
        document
        for part in text.split("\n---\n")
        if part
        for document in parse_documents(part, file.path.name)
    ]
    names = file.frame.dimensions.get("structure", [])
    return [
        {**{key: value.plain() for key, value in one.values.items()}, "name": name}
        for one, name in zip(found, names, strict=False)
    ]


def _command(path: str, file: "SpectraFile") -> str | None:
    """Return the command that computes a file again from the documents in it and the
    motions of its own command, if it states one.
    """
    from ..motions.reading import holds_records

    history = str(file.attributes.get("history", ""))
    if file.frame.of_verdicts:  # it holds no documents
        return history.partition(": ")[2] or None
    try:
        call = shlex.split(history.partition("rocking ")[2]) or [""]
    except ValueError:  # a quote without its other one: another program wrote it
        return None
    name, *arguments = call
    root = click.get_current_context().find_root()
    assert isinstance(root.command, click.Group)
    made = root.command.get_command(root, name)
    if made is None:
        return None
    given, _, _ = made.make_parser(click.Context(made)).parse_args(arguments)
    files = given.get("files")
    stated = files if isinstance(files, list | tuple) else []
    records = [one for one in stated if holds_records(one)]
    words = [*records, *_stated_options(made, given)]
    source = ""
    if _documents(file):
        source = f"{shlex.join(['rocking', 'info', path, '--documents'])} | "
        words = ["-", *words]
    words = ["rocking", name, *words, "-o", f"{Path(path).stem}-again.h5"]
    return f"{source}{shlex.join(words)}"


def _stated_options(made: click.Command, given: Mapping[str, Any]) -> list[str]:
    """Return the options of a call that determine its cells, as words."""
    words: list[str] = []
    for parameter in made.params:
        if (
            isinstance(parameter, click.Option)
            and parameter.name in given
            and parameter.name not in _OF_THE_RUN
        ):
            flag, value = parameter.opts[-1], given[parameter.name]
            for one in value if parameter.multiple else [value]:
                words += [flag] if parameter.is_flag else [flag, str(one)]
    return words
