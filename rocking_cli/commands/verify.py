"""`rocking verify`: the shipped cases, run in the installed package."""

import os
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import click

from .command import command, flag, group, option
from .parameter_types import OutputPath
from .printing import emit, note, printed


@dataclass(frozen=True)
class VerifyOptions:
    """What becomes of the inputs and the page."""

    output: Path | None = option(
        "-o --output",
        "Keep the inputs, and the page as page.html, in this new folder.",
        type=OutputPath(),
        metavar="FOLDER",
    )
    trace: bool = flag(
        "--trace", "Print which test and case holds which requirement; run no case."
    )


@command("rocking verify -o verified", printed)
def verify(wanted: VerifyOptions = group(VerifyOptions)) -> int:
    """Verify the installed program with the cases that it ships.

    Each case is a command on inputs that are written to a folder, and numbers that a
    closed form, a publication or another program says must come out, each with the
    difference that its source is good for. A row for each number: expected, within,
    computed, passed. The page holds the rows, the version, the digest of the installed
    files, the platform and the date, and which requirement is held by which equation,
    module, test and case, as --trace prints it. The exit code is 1 if a number is not
    as its source says.
    """
    from .requirements import requirements
    from .shipped_cases import (
        Comparison,
        compared,
        installation,
        page,
        shipped_cases,
        tally_of,
    )

    target = wanted.output
    if target is not None and os.path.lexists(target):
        raise click.UsageError(
            f"-o {target}: exists; expected the name of a new folder"
        )
    cases = shipped_cases()
    traced = requirements({case.name: case.equation for case in cases})
    if wanted.trace:
        emit(traced)
        return 0
    found: list[Comparison] = []

    def rows(folder: Path) -> Iterator[dict[str, Any]]:
        for one in compared(cases, folder):
            found.append(one)
            yield one.row()

    beside = None if target is None else target.absolute().parent
    with tempfile.TemporaryDirectory(dir=beside, prefix=".verify-") as temporary:
        folder = Path(temporary) / "cases"
        emit(rows(folder), unseen=_UNSEEN)
        if target is not None:
            text = page(found, installation(), traced)
            (folder / "page.html").write_text(text, encoding="utf-8")
            folder.rename(target)
    note(tally_of(found))
    return int(not all(one.passed for one in found))


# columns that a table shows only if --columns names them
_UNSEEN = ("equation", "source", "command")
