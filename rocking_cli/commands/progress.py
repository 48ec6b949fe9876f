"""Progress of a run on standard error: one line that a terminal renews, or a line every half a minute with the time left."""

import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from time import monotonic

from . import streams
from .printing import form, is_quiet

_FIRST, _EVERY = 10.0, 30.0  # s until a run is called long, and from each line on it to the next
_ENOUGH = 3  # units that give the rate
_current: "ProgressLine | None" = None


def _follow(line: "ProgressLine | None") -> None:
    """Let `reporting` report this line; None: no line."""
    global _current
    _current = line


@contextmanager
def reporting() -> Iterator[None]:
    """Context of a call: prints the progress on standard error after ten seconds and then every half a minute, except with --quiet or while
    a terminal shows a `ProgressLine`. It uses a system timer, if there is one, because a thread would endanger a fork."""
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
    """A line on a terminal that states the units of work done, their number and the time left; any other output first ends it. With
    --quiet, without a terminal, or if rows appear on it one by one, there is no line, and `reporting` prints its own."""

    def __init__(self, label: str, unit: str) -> None:
        self._label, self._unit, self._start, self._first = label, unit, monotonic(), 0
        self._done = self._total = 0
        self._visible = sys.stderr.isatty() and not is_quiet() and not (form() is not None and sys.stdout.isatty())
        _follow(self)
        self._show()

    @property
    def shown(self) -> bool:
        """True if a terminal shows the line, or will renew it."""
        return self._visible and self._done < max(self._total, 1)

    def in_words(self) -> str:
        """Return the time left at the rate so far; until enough units are done, the time passed."""
        seconds, new = monotonic() - self._start, self._done - self._first
        units = f"{self._done} of {self._total} {self._unit} done" if self._done < self._total else ""
        if not units or new < _ENOUGH:
            return f"{self._label}: still computing ({f'{units}, ' if units else ''}{seconds:.0f} s)"
        left = seconds / new * (self._total - self._done)
        unit, name = next((x for x in ((86400.0, "days"), (3600.0, "h"), (60.0, "min")) if left >= 2.0 * x[0]), (1.0, "s"))
        return f"{self._label}: about {float(f'{left / unit:.2g}'):g} {name} more ({units})"

    def __call__(self, done: int, total: int) -> None:
        if not self._done:
            self._first = done  # a resumed sweep begins with some units done
        self._done, self._total = done, total
        self._show()

    def _show(self) -> None:
        if self._visible:
            share, seconds = self._done / max(self._total, 1), monotonic() - self._start
            words = self.in_words() if share < 1.0 else f"{self._label}: {self._total} {self._unit} in {seconds:.0f} s"
            streams.renew(f"[{'#' * int(20 * share):-<20}] {words}")
            if share >= 1.0:
                streams.end_line()
