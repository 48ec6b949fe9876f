"""Faults and differences of spectra files, in words."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any


def reason(error: BaseException) -> str:
    """The message of a fault."""
    text = str(error.args[0]) if isinstance(error, KeyError) and error.args else str(error)
    return text if " " in text else f"it has no {text!r}"


def difference(one: Any, other: Any, place: str = "") -> tuple[str, str, str] | None:
    """(the place where two scenes first differ, the value there in each, as JSON of at most 60 characters); None if they are equal.

    If a text in a list differs, the place is that of the list.
    """
    if one == other:
        return None
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        key = next(k for k in [*one, *other] if k not in one or k not in other or one[k] != other[k])
        place = f"{place}.{key}" if place else key
        if key in one and key in other:
            return difference(one[key], other[key], place)
        one, other = one.get(key), other.get(key)
    elif isinstance(one, list) and isinstance(other, list) and any(isinstance(x, list | Mapping) for x in [*one, *other]):
        if len(one) == len(other):
            i = next(i for i, (a, b) in enumerate(zip(one, other, strict=True)) if a != b)
            return difference(one[i], other[i], place if isinstance(one[i], str) else f"{place}[{i}]")
        place, one, other = f"number of {place}", len(one), len(other)
    first, second = (text if len(text) <= 60 else f"{text[:57]}..." for text in map(json.dumps, (one, other)))
    return place, first, second
