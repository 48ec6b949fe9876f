"""Progress of a run on standard error: one line that a terminal renews every second, or
a line every half a minute in a log, with what is done and the time left.

A thread writes them, because the main thread may wait for worker processes for minutes,
and a handler of a signal waits as long. The thread holds `streams.lock` while it
writes, which a fork waits for, so that no worker process inherits a half-written line.
"""

import math
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Lock, Thread
from time import monotonic

from ..interruption import deferred
from . import streams
from .printing import is_quiet

_TICK = 1.0  # s between two states of the line on a terminal
_FIRST = 10.0  # s after which a run is called long
_EVERY = 30.0  # s between two lines of a log
_ENOUGH = 3.0  # units that give the rate
_SHARE, _SECONDS = 0.05, 5.0  # or this share of all units, after so many seconds
_LARGER = (("days", 86400.0), ("h", 3600.0), ("min", 60.0))  # than a second
_HALF_LIFE = 60.0  # s in which a new estimate of the time left gets half of the weight
_BAR, _LEAST_BAR = 20, 5  # characters


class _Reporter:
    """The progress of one call, as the thread shows it."""

    def __init__(self) -> None:
        self.began = monotonic()
        self.line: ProgressLine | None = None  # of the present part of the call
        self._next = self.began + _FIRST  # time of the next line of a log

    def tick(self) -> None:
        """Write what has become due."""
        with streams.lock:
            if streams.silent:
                return
            now, line = monotonic(), self.line
            if sys.stderr.isatty():
                if line is not None and line.unfinished:
                    line.show()
                elif now - self.began >= _FIRST:
                    streams.renew(self._in_words(now))
            elif now >= self._next:
                streams.say(self._in_words(now))
                self._next += _EVERY

    def _in_words(self, now: float) -> str:
        if self.line is None:
            return f"still computing ({now - self.began:.0f} s)"
        if not self.line.unfinished:  # what follows has no units
            return (
                f"still computing (after {self.line.label}; {now - self.began:.0f} s in"
                " all)"
            )
        return self.line.in_words()


_reporter: _Reporter | None = None  # of the present call


@contextmanager
def reporting() -> Iterator[None]:
    """Context of a call: a thread shows its progress on standard error, except with
    --quiet."""
    global _reporter
    streams.silent = False
    reporter, running = _Reporter(), Lock()
    running.acquire()

    def run() -> None:
        while not running.acquire(timeout=_TICK):
            reporter.tick()

    _reporter = reporter
    thread = Thread(target=run, name="progress", daemon=True)
    with deferred():
        thread.start()
    try:
        yield
    finally:
        _reporter = None
        running.release()
        thread.join()
        streams.erase()


class ProgressLine:
    """The units of work done, their number and the time left; on a terminal a line,
    which any other output replaces until it is renewed. With --quiet there is none.
    """

    def __init__(self, label: str, unit: str) -> None:
        self.label = label
        self._unit = unit  # name of the units, such as chunks
        self._start = monotonic()
        self._first = 0.0  # units that were done at the first call
        self._done = 0.0  # a part of a unit counts as such
        self._total = 0
        # the time left that was told last, and when [s]
        self._told: tuple[float, float] | None = None
        self._ended = False  # True when the line has stated that all is done
        self._visible = sys.stderr.isatty() and not is_quiet()
        if _reporter is not None:
            _reporter.line = self
        self.show()

    @property
    def unfinished(self) -> bool:
        """True while some units are not done."""
        return self._done < max(self._total, 1)

    def in_words(self) -> str:
        """Return the time left at the rate so far; until enough units are done, the
        time passed.
        """
        seconds, new = monotonic() - self._start, self._done - self._first
        if not self._total:
            return f"{self.label}: still computing ({seconds:.0f} s)"
        units = f"{int(self._done)} of {self._total} {self._unit} done"
        if not float(
            self._done
        ).is_integer():  # parts of a unit are done; a terminal has 80 columns
            percent = 100.0 * self._done / self._total
            shown = f"{percent:.2g}" if percent < 10.0 else f"{math.floor(percent)}"
            units = f"{shown} % of {self._total} {self._unit}"
        early = new < _SHARE * self._total or seconds < _SECONDS
        if new < _ENOUGH and early:
            return f"{self.label}: still computing ({units}, {seconds:.0f} s)"
        left = self._damped(seconds / new * (self._total - self._done))
        larger = (one for one in _LARGER if left >= 2.0 * one[1])
        name, unit = next(larger, ("s", 1.0))
        more = f"{float(f'{left / unit:.2g}'):g} {name}"
        return f"{self.label}: about {more} more ({units}, {seconds:.0f} s)"

    def _damped(self, left: float) -> float:
        """Return the time left [s], drawn to that which was told before, so that a slow
        unit among quick ones does not change it much.
        """
        now = monotonic()
        if self._told is not None:
            before, at = self._told
            old = 0.5 ** ((now - at) / _HALF_LIFE)
            expected = max(before - (now - at), 1.0)
            left = expected**old * max(left, 1.0) ** (1.0 - old)
        self._told = left, now
        return left

    def __call__(self, done: float, total: int) -> None:
        with streams.lock:
            if done < total:
                self._ended = False
            if not self._done:
                self._first = done  # a resumed sweep begins with some units done
            self._done, self._total = done, total
            self.show()

    def show(self) -> None:
        """Show the line, if standard error is a terminal."""
        if not self._visible or self._ended:
            return
        share = self._done / max(self._total, 1)
        if share < 1.0:
            streams.renew(_with_bar(share, self.in_words()))
            return
        seconds, self._ended = monotonic() - self._start, True
        streams.say(
            _with_bar(
                share, f"{self.label}: {self._total} {self._unit} in {seconds:.0f} s"
            )
        )


def _with_bar(share: float, words: str) -> str:
    """Return the words behind a bar of the share that is done; a bar that has no room
    beside them is shorter, or left out.
    """
    room = streams.columns_of(sys.stderr) - len(words) - len("[] ") - 1
    bar = min(_BAR, room)
    return words if bar < _LEAST_BAR else f"[{'#' * int(bar * share):-<{bar}}] {words}"
