"""Whether two spectra files hold the same scene."""

import json
from collections.abc import Mapping
from typing import Any


def first_difference(
    one: Any, other: Any, place: str = ""
) -> tuple[str, str, str] | None:
    """Return (the first place where two scenes differ, the value of each there, as JSON
    of at most 60 characters), None if they are equal. A difference in the first text of
    a list counts as one of the list; a list without lists or mappings is one value.
    """
    if one == other:
        return None
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        parts = [
            (f"{place}.{key}" if place else key, one.get(key), other.get(key))
            for key in {**one, **other}
        ]
    elif (
        isinstance(one, list)
        and isinstance(other, list)
        and any(isinstance(x, list | Mapping) for x in (*one, *other))
    ):
        if len(one) != len(other):
            return f"number of {place}", str(len(one)), str(len(other))
        places = [
            f"{place}[{i}]" if i or not isinstance(a, str) else place
            for i, a in enumerate(one)
        ]
        parts = list(zip(places, one, other, strict=True))
    else:
        return place, _short(one), _short(other)
    found = (first_difference(a, b, at) for at, a, b in parts)
    return next(filter(None, found), None)


def _short(value: Any) -> str:
    """Return a value as JSON of at most 60 characters."""
    text = json.dumps(value)
    return text if len(text) <= 60 else f"{text[:57]}..."
