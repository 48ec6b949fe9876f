"""How far a run is: one line on standard error, only where somebody sees it."""

from __future__ import annotations

import sys
from time import monotonic
from typing import TextIO, cast

import click

from . import streams


class ProgressLine:
    """Done and total, their unit, the rate and the time left, from the first moment on.

    Nothing is shown with --quiet, where standard error is no terminal, and where rows that appear on the terminal one by one are
    progress enough. Another line ends this one, so that it stands on a line of its own.
    """

    def __init__(self, label: str, quiet: bool, unit: str) -> None:
        context = click.get_current_context(silent=True)
        rows = context is not None and context.params.get("form") is not None and sys.stdout.isatty()
        self._unit, self._start, self._first = unit, monotonic(), 0
        hidden = quiet or rows or not sys.stderr.isatty()
        self._bar = (
            None
            if hidden
            else click.progressbar(
                length=1,  # until the first call tells it
                label=streams.printable(label),
                width=20,
                show_percent=True,
                item_show_func=lambda rate: rate,
                file=cast(TextIO, sys.stderr),
            )
        )
        if self._bar is not None:
            streams.end_line(self._bar.render_finish)
            self._bar.__enter__()

    def __call__(self, done: int, total: int) -> None:
        bar = self._bar
        if bar is None:
            return
        streams.end_line(bar.render_finish)
        if not bar.pos:
            self._first = done  # of a sweep that goes on, some were there before
        bar.length, bar.show_pos = total, True
        seconds = monotonic() - self._start
        new = done - self._first
        bar.update(done - bar.pos, f"{new / seconds:.3g} {self._unit}/s" if new and seconds > 0.0 else self._unit)
        if done >= total:
            streams.end_line()
