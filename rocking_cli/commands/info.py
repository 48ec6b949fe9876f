"""`rocking info`: the contents of a spectra file, and its verification."""

from __future__ import annotations

from typing import Any

from . import streams
from .command import argument, command, option
from .parameter_types import InputPath
from .printing import emit, form, printed

_MOST_NAMES = 12


@command("rocking info towers.h5 --verify", printed)
def info(
    files: tuple[str, ...] = argument(nargs=-1, type=InputPath(), required=True, metavar="FILE..."),
    verify: bool = option("--verify", is_flag=True, help="Check every chunk against its checksum."),
) -> int:
    """Show the contents of spectra files: scene, completeness, run time, estimated error.

    The exit code is 1 if a file is damaged, or with --verify if a chunk is damaged.
    """
    from ..spectra.file.reader import SpectraFile
    from ..spectra.work.machine import described

    damaged = []
    records: list[dict[str, Any]] = []
    for path in files:
        with SpectraFile(path) as file:
            attributes, dimensions = file.attributes, file.frame.dimensions
            records.append(
                {
                    "file": path,
                    **{f"{name}s": _names(values) for name, values in dimensions.items() if isinstance(values, list)},
                    "model": file.scene["model"],
                    "motion": attributes["motion"],
                    **{
                        name: f"{values[0]:g} to {values[-1]:g}, {len(values)}"
                        for name, values in dimensions.items()
                        if not isinstance(values, list)
                    },
                    "chunks": f"{int(file.done.sum())} of {file.done.size}",
                    "complete": "yes" if file.complete else "no",
                    "run_time": attributes.get("run_time"),
                    "estimated_error": attributes.get("estimated_error"),
                    "checked_cells": attributes.get("checked_cells"),
                    "source": attributes.get("source"),
                    "sealed": "yes" if file.digest else "no",
                    "digest": file.digest,
                    "computed_on": "; ".join(described(m) for m in file.machines) or None,
                }
            )
            if verify:
                bad = file.damaged_chunks()
                records[-1]["damaged_chunks"] = len(bad)
                damaged += [f"{path}: chunk {i} is damaged" for i in bad]
    if form() is None:
        for record in records:
            for key, value in record.items():
                streams.put(f"{key:<16} {'-' if value is None else value}")
    else:
        emit(records)
    for line in damaged:
        streams.say(f"rocking: {line}")
    return 1 if damaged else 0


def _names(values: list[str]) -> str:
    """A text of all names; of many names only the first, the last and how many there are."""
    return ", ".join(values) if len(values) <= _MOST_NAMES else f"{len(values)}, {values[0]} to {values[-1]}"
