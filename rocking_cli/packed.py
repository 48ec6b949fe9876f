"""Sequences that may be larger than the memory."""

import pickle
import weakref
from collections.abc import Iterable, Iterator, Sequence
from itertools import islice
from tempfile import SpooledTemporaryFile
from typing import Any, TypeVar

T = TypeVar("T")
_HELD = 1 << 22  # bytes that wait in memory
_TOGETHER = 512  # items that are packed together


class Streamed(Sequence[T]):
    """A sequence that makes its items anew in each iteration, from the first one on."""

    def __getitem__(self, which: Any) -> Any:
        if isinstance(which, slice):
            return list(islice(self, which.start, which.stop))
        return next(islice(self, which, None))


class Packed(Streamed[T]):
    """Items that wait in a temporary file. Many of them are other objects in each
    iteration, with the same values.
    """

    def __init__(self, items: Iterable[T] = ()) -> None:
        self._file = SpooledTemporaryFile(max_size=_HELD)  # noqa: SIM115
        weakref.finalize(self, self._file.close)
        self._end = self._count = 0  # bytes in the file, items in all
        self._last: list[T] = []  # the items that are not packed yet
        for item in items:
            self.append(item)

    def append(self, item: T) -> None:
        """Add an item at the end."""
        self._last.append(item)
        self._count += 1
        if len(self._last) == _TOGETHER:
            self._file.seek(self._end)
            pickle.dump(self._last, self._file)
            self._end, self._last = self._file.tell(), []

    def __len__(self) -> int:
        return self._count

    def __iter__(self) -> Iterator[T]:
        at = 0
        while at < self._end:
            self._file.seek(at)
            block = pickle.load(self._file)
            at = self._file.tell()
            yield from block
        yield from self._last
