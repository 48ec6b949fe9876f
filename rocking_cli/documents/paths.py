"""Values inside the lists and mappings of a document, by a path such as `ties.0.yield`."""

from collections.abc import Sequence
from dataclasses import replace

from ..errors import DocumentError
from .composition import Place
from .document import Document, Value


def value_at(document: Document, key: str) -> Value | None:
    """The value of a key or at a path; None without it."""
    found, path = document.values.get(key), key.split(".")
    if found is not None:
        return found
    found = document.values.get(path[0])
    for name in path[1:]:
        content = None if found is None else found.content
        if isinstance(content, dict):
            found = content.get(name)
        else:
            found = content[int(name)] if isinstance(content, list) and name.isdigit() and int(name) < len(content) else None
    return found


def with_value(document: Document, key: str, text: str, source: str) -> Document:
    """`Document.with_value`, also for a path. Raises DocumentError if there is no such place."""
    head, *path = key.split(".")
    if not path or head not in document.values:
        return document.with_value(key, text, source)
    value = _with_inner(document.values[head], path, Value(text, Place(source, 0, 0)))
    return replace(document, values={**document.values, head: value}, asked=set(), inner=[], dimensions={})


def _with_inner(value: Value, path: Sequence[str], new: Value) -> Value:
    """A list or mapping with the value at a path in it replaced."""
    name, *rest = path
    if isinstance(value.content, dict) and (not rest or name in value.content):
        return replace(value, content={**value.content, name: _with_inner(value.content[name], rest, new) if rest else new})
    if isinstance(value.content, list) and rest and name.isdigit() and int(name) < len(value.content):
        return replace(value, content=[_with_inner(x, rest, new) if i == int(name) else x for i, x in enumerate(value.content)])
    wanted = f"a number from 0 to {len(value.content) - 1} and a key" if isinstance(value.content, list) else "a key of a mapping"
    raise DocumentError(f"{new.place}: found {name!r} in {value} (line {value.place.line}); expected {wanted}")
