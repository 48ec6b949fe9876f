"""Ctrl-C, SIGTERM, a terminal that closes and Ctrl-Break: one way to stop, which is
never lost.

Python raises KeyboardInterrupt at any point of the program. Inside a callback of a C
library or a finalizer it prints the exception and goes on. So this module remembers the
request, long loops ask for it with `check`, and `deferred` keeps a write whole. What
`threading` builds of locks (conditions, events, futures) stays locked for ever if it is
left at a wrong moment: the main thread uses it inside `deferred` only, and waits for a
plain lock.
"""

from __future__ import annotations

import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sys import UnraisableHookArgs

# SIGHUP: a terminal closes; SIGBREAK, on Windows: Ctrl-Break, or a console closes
STOPS = tuple(
    signal.Signals[name]
    for name in ("SIGINT", "SIGTERM", "SIGHUP", "SIGBREAK")
    if name in signal.Signals.__members__
)

_asked = False
_deferred = False


def listen() -> None:
    """Make every signal of `STOPS` a KeyboardInterrupt that `check` raises again; call
    it from the main thread.
    """
    for number in STOPS:
        # nohup, which has the program outlive its terminal, ignores SIGHUP
        if number.name != "SIGHUP" or signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, _stop)
    sys.unraisablehook = _forgotten


def _forgotten(unraisable: UnraisableHookArgs) -> None:
    """Print an exception that nobody can catch, except a stop, which is remembered."""
    if not issubclass(unraisable.exc_type, KeyboardInterrupt):
        sys.__unraisablehook__(unraisable)


def check() -> None:
    """Raise KeyboardInterrupt if a stop was asked for before."""
    if _asked:
        raise KeyboardInterrupt


@contextmanager
def deferred() -> Iterator[None]:
    """Let the block finish: a stop inside it comes at its end, or at that of the block
    around it.
    """
    global _deferred
    before, _deferred = _deferred, True
    try:
        yield
    finally:
        _deferred = before
    if not before:
        check()


def _stop(number: int, frame: FrameType | None) -> None:
    global _asked
    _asked = True
    if not _deferred:
        raise KeyboardInterrupt
