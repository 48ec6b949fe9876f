"""`rocking info`: the contents of a spectra file, and its verification."""

from typing import TYPE_CHECKING, Any

from . import streams
from .command import argument, command, flag
from .parameter_types import InputPath
from .printing import emit, printed

if TYPE_CHECKING:
    from ..spectra.file.reader import SpectraFile

_MOST_NAMES = 12
_STATED = (
    *("run_time", "check_time"),
    *("error_bound", "error_bound_median", "cells_above_ten_medians"),
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
            rows.append(row)
    if documents:
        return 0

    emit(rows)
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
        **{key: attributes.get(key) for key in _STATED},
        "largest_difference": (
            attributes.get("largest_difference") if checked else None
        ),
        "checked_cells": checked,
        "source": attributes.get("source"),
        "sealed": "yes" if file.digest else "no",
        "digest": file.digest,
        "computed_on": "; ".join(map(described, file.machines)) or None,
    }


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
