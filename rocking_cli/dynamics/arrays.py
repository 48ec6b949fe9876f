"""Base of records of arrays."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

Array = np.ndarray


@dataclass
class Arrays:
    """Base of dataclasses of lanes. A field is an array whose last axis holds the lanes, another such record, or a value of all lanes."""

    def take(self, at: Array | slice) -> Self:
        """The record of these lanes, copied if they are given by index."""
        return type(self)(*[_taken(getattr(self, name), at) for name in self.__dataclass_fields__])

    def put(self, places: Array, others: Self) -> None:
        """Write the lanes of another record into these places."""
        for name in self.__dataclass_fields__:
            getattr(self, name)[places] = getattr(others, name)

    @classmethod
    def joined(cls, parts: Sequence[Self]) -> Self:
        """The lanes of all parts, one after the other; fields that only a subclass has are left out."""
        return cls(*[_joined([getattr(part, name) for part in parts]) for name in cls.__dataclass_fields__])

    def join(self, other: Self) -> Self:
        """These lanes followed by those of another record."""
        return self.joined([self, other])


def _taken(x: Any, at: Any) -> Any:
    if isinstance(x, np.ndarray):
        return x[at] if x.ndim == 1 else x.take(at, axis=-1)  # [..., at] would lie lane by lane
    return x.take(at) if isinstance(x, Arrays) else x


def _joined(parts: list[Any]) -> Any:
    return parts[0].joined(parts) if isinstance(parts[0], Arrays) else np.concatenate(parts)
