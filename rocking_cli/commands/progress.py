"""How far a run is: one line on standard error that a terminal renews, or a line every half a minute that says how long it takes yet."""

from __future__ import annotations

import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from time import monotonic
from typing import TextIO, cast

import click

from . import streams
from .printing import form, is_quiet

_FIRST, _EVERY = 10.0, 30.0  # s until a run is called long, and from each line on it to the next
_ENOUGH = 3  # units that tell how long the others take
_current: ProgressLine | None = None


def _follow(line: ProgressLine | None) -> None:
    """Let `told` speak of this line."""
    global _current
    _current = line


@contextmanager
def told() -> Iterator[None]:
    """For a call: after ten seconds, and every half a minute from then on, a line on standard error says how far it is, unless --quiet
    is given or a `ProgressLine` on the terminal says so. A timer of the system, where it has one: a thread would endanger a fork."""
    _follow(None)
    began = monotonic()
    if not hasattr(signal, "setitimer"):
        yield
        return

    def say(*_: object) -> None:
        if not ((_current is not None and _current.shown) or is_quiet()):
            with suppress(RuntimeError):  # another line was being written
                streams.say(f"still computing ({monotonic() - began:.0f} s)" if _current is None else _current.in_words())

    before = signal.signal(signal.SIGALRM, say)
    signal.siginterrupt(signal.SIGALRM, False)
    signal.setitimer(signal.ITIMER_REAL, _FIRST, _EVERY)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


class ProgressLine:
    """Done and total, their unit, the rate and the time left, from the first moment on.

    The line is not shown with --quiet, where standard error is no terminal, and where rows appear on the terminal one by one; `told`
    speaks there. Another line ends this one, so that it stands on a line of its own.
    """

    def __init__(self, label: str, unit: str) -> None:
        self._label, self._unit, self._start, self._first = label, unit, monotonic(), 0
        self._done = self._total = 0
        _follow(self)
        hidden = is_quiet() or (form() is not None and sys.stdout.isatty()) or not sys.stderr.isatty()
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

    @property
    def shown(self) -> bool:
        """Whether a terminal shows the line, or will renew it."""
        return self._bar is not None and self._done < max(self._total, 1)

    def in_words(self) -> str:
        """The time left, at the rate so far, as soon as enough units are done, else the time passed."""
        seconds, new = monotonic() - self._start, self._done - self._first
        units = f"{self._done} of {self._total} {self._unit} done" if self._done < self._total else ""
        if not units or new < _ENOUGH:
            return f"{self._label}: still computing ({f'{units}, ' if units else ''}{seconds:.0f} s)"
        left = seconds / new * (self._total - self._done)
        unit, name = next((x for x in ((86400.0, "days"), (3600.0, "h"), (60.0, "min")) if left >= 2.0 * x[0]), (1.0, "s"))
        return f"{self._label}: about {float(f'{left / unit:.2g}'):g} {name} more ({units})"

    def __call__(self, done: int, total: int) -> None:
        if not self._done:
            self._first = done  # of a sweep that goes on, some were there before
        self._done, self._total = done, total
        bar = self._bar
        if bar is None:
            return
        streams.end_line(bar.render_finish)
        bar.length, bar.show_pos = total, True
        seconds = monotonic() - self._start
        new = done - self._first
        bar.update(done - bar.pos, f"{new / seconds:.3g} {self._unit}/s" if new and seconds > 0.0 else self._unit)
        if done >= total:
            streams.end_line()
