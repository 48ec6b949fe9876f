"""What the C library does with memory that is freed."""

from __future__ import annotations

import ctypes
import sys
from contextlib import suppress
from functools import cache

_TRIM_THRESHOLD, _MMAP_THRESHOLD = -1, -3  # of mallopt(3)
_BLOCK = 32 << 20  # bytes, the largest that it takes


@cache
def keep_freed_memory() -> None:
    """Let glibc keep what is freed, blocks of up to 32 MB and 64 MB in all, for what is asked for next.

    It would give the arrays of each round back to the system and fault them in again for the next, which takes as long as all the rest;
    by itself it learns not to after some rounds, and not at all where MALLOC_TRIM_THRESHOLD_ is set, as dask does for its workers.
    """
    if sys.platform == "linux":
        with suppress(AttributeError):  # another library than glibc
            mallopt = ctypes.CDLL(None).mallopt
            mallopt(_MMAP_THRESHOLD, _BLOCK)
            mallopt(_TRIM_THRESHOLD, 2 * _BLOCK)
