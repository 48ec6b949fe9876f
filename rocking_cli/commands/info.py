"""`rocking info`: the contents of a spectra file, its verification, and the command
that makes it again.
"""

import shlex
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
)  # what changes no cell


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
    from ..spectra.work.machine import described

    damaged: list[str] = []
    rows: list[dict[str, Any]] = []
    for path in files:
        with SpectraFile(path) as file:
            if documents:
                emit(_documents(file), form="json")
                continue
            attributes, dimensions = file.attributes, file.frame.dimensions
            names = {
                f"{name}s": _names(values)
                for name, values in dimensions.items()
                if isinstance(values, list)
            }
            axes = {
                k: f"{v[0]:g} to {v[-1]:g}, {len(v)}"
                for k, v in dimensions.items()
                if not isinstance(v, list)
            }
            row = {
                "file": path,
                **names,
                "model": file.scene["model"],
                "motion": attributes["motion"],
                **axes,
            }
            row |= {
                "chunks": f"{int(file.done.sum())} of {file.done.size}",
                "complete": "yes" if file.complete else "no",
            }
            row |= {
                key: attributes.get(key)
                for key in ("run_time", "estimated_error", "checked_cells", "source")
            }
            row |= {} if row["checked_cells"] else {"estimated_error": None}
            row |= {"sealed": "yes" if file.digest else "no", "digest": file.digest}
            row["computed_on"] = "; ".join(described(m) for m in file.machines) or None
            if verify:
                bad = file.damaged_chunks()
                row["damaged_chunks"] = len(bad)
                damaged += [f"{path}: chunk {i} is damaged" for i in bad]
            if again:
                counts = {
                    key.removeprefix("cells_"): int(n)
                    for key, n in attributes.items()
                    if key.startswith("cells_")
                }
                etas = [f"{one['eta']:.6g}" for one in file.scene.get("structures", ())]
                row |= {
                    "eta": _names(etas) or None,
                    "tolerance": attributes.get("tolerance"),
                }
                row |= {
                    "cells": ", ".join(
                        f"{n} {name}" for name, n in counts.items() if n
                    ),
                    "command": _command(path, file),
                }
            rows.append(row)
    if documents:
        return 0
    emit(
        [{**row, "command": None} for row in rows] if form() is None else rows,
        keys=("file",),
    )
    commands = [row["command"] for row in rows] if again else []
    for line in filter(None, commands if form() is None else []):
        parts = wrap(
            line,
            96,
            subsequent_indent="  ",
            break_long_words=False,
            break_on_hyphens=False,
        )
        streams.put(*(f"{part} \\" for part in parts[:-1]), parts[-1])
    if not all(commands):
        note("written by a function of Python: the file holds no command")
    for line in damaged:
        streams.say(f"rocking: {line}")
    return 1 if damaged else 0


def _names(values: list[str]) -> str:
    """Return the names as a text; if there are many, only the first, the last and their
    number.
    """
    return (
        ", ".join(values)
        if len(values) <= _MOST_NAMES
        else f"{len(values)}, {values[0]} to {values[-1]}"
    )


def _documents(file: "SpectraFile") -> list[dict[str, Any]]:
    """Return the documents of a spectra file, each with the name of its structure in
    the file.
    """
    from ..documents.parsing import parse_documents

    text, names = (
        str(file.attributes.get("documents", "")),
        file.frame.dimensions.get("structure", []),
    )
    found = [
        one
        for part in text.split("\n---\n")
        if part
        for one in parse_documents(part, file.path.name)
    ]
    return [
        {**{k: v.plain() for k, v in one.values.items()}, "name": name}
        for one, name in zip(found, names, strict=False)
    ]


def _command(path: str, file: "SpectraFile") -> str | None:
    """Return the command that computes a file again from the documents in it and the
    motions of its own command, if it states one.
    """
    from ..motions.reading import holds_records

    name, *arguments = shlex.split(
        str(file.attributes.get("history", "")).partition("rocking ")[2]
    ) or [""]
    root = click.get_current_context().find_root()
    assert isinstance(root.command, click.Group)
    made = root.command.get_command(root, name)
    if made is None:
        return None
    given, _, _ = made.make_parser(click.Context(made)).parse_args(arguments)
    files = given.get("files")
    records = (
        [one for one in files if holds_records(one)]
        if isinstance(files, list | tuple)
        else []
    )
    words = [
        "rocking",
        name,
        *(["-"] if (stated := _documents(file)) else []),
        *records,
    ]
    for parameter in made.params:
        if (
            isinstance(parameter, click.Option)
            and parameter.name in given
            and parameter.name not in _OF_THE_RUN
        ):
            value = given[parameter.name]
            for one in value if parameter.multiple else [value]:
                words += (
                    [parameter.opts[-1]]
                    if parameter.is_flag
                    else [parameter.opts[-1], str(one)]
                )
    source = (
        f"{shlex.join(['rocking', 'info', path, '--documents'])} | " if stated else ""
    )
    return f"{source}{shlex.join([*words, '-o', f'{Path(path).stem}-again.h5'])}"
