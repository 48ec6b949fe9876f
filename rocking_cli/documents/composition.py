"""The values of documents with their places, and the limits of a text."""

import json
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from ..errors import DocumentError
from .quantities import FACTORS, split_quantity

LONGEST = 2 << 20  # characters of a YAML file, or of one JSON object
MOST_VALUES = 100_000  # values of a document; an alias counts each time
DEEPEST = 20  # levels of nested lists and mappings
_UNSPACED = re.compile(r"(?:\s*-)?\s*([A-Za-z_]\w*):([^\s:/\\,][^\s,]*)")


@dataclass(frozen=True, slots=True)
class Place:
    """The place of a key or a value."""

    source: str  # the file
    line: int  # from 1, 0 if it comes from no file
    column: int  # from 1

    def __str__(self) -> str:
        return f"{self.source}:{self.line}:{self.column}" if self.line else self.source


@dataclass(frozen=True, slots=True)
class Value:
    """The text of a scalar, a list of values, or a mapping."""

    # text of a scalar, a list of values, or a mapping
    content: "str | list[Value] | dict[str, Value]"
    place: Place  # where it begins
    quoted: bool = False  # True for a text in quotes

    def __str__(self) -> str:
        if isinstance(self.content, str):
            short = (
                self.content if len(self.content) <= 60 else self.content[:57] + "..."
            )
            plain = short.isprintable() and short and not self.quoted
            return (
                short
                if plain
                else json.dumps(short, ensure_ascii=not short.isprintable())
            )
        return "a list" if isinstance(self.content, list) else "a mapping"

    def word(self) -> str | None:
        """Return an unquoted text in lower case, as true, True and TRUE are one word;
        None for any other value.
        """
        return (
            self.content.casefold()
            if isinstance(self.content, str) and not self.quoted
            else None
        )

    def inner(self, name: str) -> "Value | None":
        """Return the value of a key of this mapping, or of an index of this list; None
        without it.
        """
        if isinstance(self.content, dict):
            return self.content.get(name)
        if isinstance(self.content, list) and name.isdigit():
            return self.content[int(name)] if int(name) < len(self.content) else None
        return None

    def with_inner(self, path: Sequence[str], new: "Value") -> "Value":
        """Return a copy with the value at a path replaced, or added to a mapping.

        Raises DocumentError for a path that leads nowhere.
        """
        name, *rest = path
        content = self.content
        if isinstance(content, dict) and (not rest or name in content):
            changed = content[name].with_inner(rest, new) if rest else new
            return replace(self, content={**content, name: changed})
        if isinstance(content, list) and rest and (old := self.inner(name)):
            items = [x.with_inner(rest, new) if x is old else x for x in content]
            return replace(self, content=items)
        wanted = (
            f"a number from 0 to {len(content) - 1} and a key"
            if isinstance(content, list)
            else "a key of a mapping"
        )
        raise DocumentError(
            f"{new.place}: found {name!r} in {self} of line {self.place.line}; expected"
            f" {wanted}"
        )

    def plain(self) -> Any:
        """Return the value as JSON has it, a number in SI units as a float."""
        if isinstance(self.content, list):
            return [v.plain() for v in self.content]
        if isinstance(self.content, dict):
            return {k: v.plain() for k, v in self.content.items()}
        if self.quoted:
            return self.content
        parts = split_quantity(self.content)
        if parts and (not parts[1] or FACTORS.get(parts[1]) == 1.0):
            return parts[0]
        return {"null": None, "~": None, "": None, "true": True, "false": False}.get(
            self.content.casefold(), self.content
        )


def unspaced(text: str) -> str:
    """Return a sentence on `key:value` without the blank that YAML needs after the
    colon, an empty text for any other text.
    """
    if (match := _UNSPACED.match(text)) is None:
        return ""
    return (
        f"found {match[0][:60]!r}; expected a blank after the colon: `{match[1]}:"
        f" {match[2][:60]}`"
    )


def place_in(text: str, at: int, source: str, first: int = 0) -> Place:
    """Return the place of character number `at` of a text."""
    before = text[:at]
    return Place(
        source, first + before.count("\n") + 1, len(before) - before.rfind("\n")
    )
