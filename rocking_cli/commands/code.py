"""The options of a check by a code."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import click

from .command import option
from .parameter_types import NUMBER, InputPath

if TYPE_CHECKING:
    from .code_rows import CodeRows


@dataclass(frozen=True)
class Code:
    """A code to check by, and its demand."""

    code: str | None = option("--code", type=click.Choice(["ntc2018"]), help="Check by the Italian code as well: code_linear, code_slv, …")
    spectrum: str | None = option(
        "--spectrum", type=InputPath(), metavar="FILE", help="Spectrum for --code: CSV of T and S_a at 5 % (default: the motion's)."
    )
    floor: tuple[str, ...] = option(
        "--floor",
        multiple=True,
        metavar="T=…,xi=…,gamma_psi=…",
        help="For --code: a mode of the building whose floor bears the body; repeatable.",
    )
    fc: float | None = option("--fc", type=NUMBER, metavar="FC", help="Confidence factor of --code (default 1).")

    def rows(self) -> CodeRows | None:
        """What the code adds to the rows of a check; None without --code. Raises UsageError, DocumentError."""
        if not (self.code or self.spectrum or self.floor or self.fc):
            return None
        from .code_rows import CodeRows

        return CodeRows(self)
