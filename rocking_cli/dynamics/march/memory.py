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
    """Let glibc keep freed blocks of up to 32 MB, 64 MB in all: to fault the arrays of each round in anew takes as long as all the rest."""
    if sys.platform == "linux":
        with suppress(AttributeError):  # another library than glibc
            mallopt = ctypes.CDLL(None).mallopt
            mallopt(_MMAP_THRESHOLD, _BLOCK)
            mallopt(_TRIM_THRESHOLD, 2 * _BLOCK)
