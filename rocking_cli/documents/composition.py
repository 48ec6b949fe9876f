"""Text to YAML nodes with their places; a text above a limit is refused before it costs
time and memory.
"""

import json
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import yaml

from ..errors import DocumentError
from .quantities import FACTORS, split_quantity

LONGEST = 2 << 20  # characters of a YAML file, or of one JSON object
MOST_VALUES = 100_000  # values of a document; an alias counts each time
DEEPEST = 20  # levels of nested lists and mappings
_BLANKS = re.compile(r"\s*")
# a quoted text, a comment of YAML, one of JavaScript
_COMMENT = re.compile(
    r'"(?:[^"\\\n]|\\.)*"|\'[^\'\n]*\'|#[^\n]*|(?<![^\s,{}\[\]:"\'])(//|/\*)'
)
_UNSPACED = re.compile(r"\s*-?\s*([A-Za-z_]\w*):([^\s:/\\,][^\s,]*)")


@dataclass(frozen=True)
class Place:
    """The place of a key or a value."""

    source: str  # the file
    line: int  # from 1, 0 if it comes from no file
    column: int  # from 1

    def __str__(self) -> str:
        return f"{self.source}:{self.line}:{self.column}" if self.line else self.source


@dataclass(frozen=True)
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


def compose(text: str, source: str, first: int = 0) -> list[yaml.Node]:
    """Return the root node of each document of a text, with its places in the file;
    first: lines before the text. Raises DocumentError.
    """
    begun = text.lstrip()
    if begun.startswith(("{", "//", "/*")):
        _refuse_comment(text, source)
    return (
        _compose_json(text, source)
        if begun.startswith("{")
        else _compose_yaml(text, source, first)
    )


def _refuse_comment(text: str, source: str) -> None:
    """Raise DocumentError for a text of braces with a comment of JavaScript, which
    neither JSON nor YAML has.
    """
    for found in _COMMENT.finditer(text):
        if found[1]:
            place = place_in(text, found.start(1), source)
            wanted = "expected no comment in JSON; write YAML, where # begins one"
            raise DocumentError(
                f"{place}: found a comment that begins with {found[1]}; {wanted}"
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


class _Unlikely(yaml.MarkedYAMLError):
    """Raised for valid YAML that is too large for a structure document."""


class _Composer(yaml.SafeLoader):
    """PyYAML's composer with limits on depth and number of values; it raises _Unlikely
    beyond them.
    """

    def __init__(self, text: str, source: str, first: int) -> None:
        super().__init__(text)
        self.name, self.line = source, first
        self.values = self.depth = 0

    def compose_document(self) -> Any:
        self.values = 0
        return super().compose_document()

    def compose_node(self, parent: yaml.Node | None, index: int) -> yaml.Node | None:
        self.depth += 1
        if parent is not None and self.depth > DEEPEST + 1:
            raise _Unlikely(problem="nested too deeply", problem_mark=parent.start_mark)
        node = super().compose_node(parent, index)
        self.depth -= 1
        self.values += 1
        if node is not None and self.values > MOST_VALUES:
            raise _Unlikely(problem="too many values", problem_mark=node.start_mark)
        return node


def _compose_yaml(text: str, source: str, first: int = 0) -> list[yaml.Node]:
    """Return the root node of each YAML document of a text. Raises DocumentError."""
    if len(text) > LONGEST:
        place = place_in(text, LONGEST, source, first)
        raise DocumentError(
            f"{place}: longer than {LONGEST >> 20} MiB, the limit of a structure"
            " document"
        )
    nodes: list[yaml.Node] = []
    try:
        composer = _Composer(text, source, first)
        while composer.check_node():
            nodes.append(composer.compose_document())
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        place = (
            Place(source, mark.line + 1, mark.column + 1)
            if mark
            else Place(source, first + 1, 1)
        )
        if isinstance(error, _Unlikely):
            raise DocumentError(
                f"{place}: {error.problem} to be a structure document"
            ) from None
        line = (
            text.splitlines()[mark.line - first - 1 : mark.line - first + 1]
            if mark
            else []
        )
        if hint := next(filter(None, map(unspaced, line)), ""):
            raise DocumentError(f"{place}: not valid YAML: {hint}") from None
        raise DocumentError(
            f"{place}: not valid YAML: {error.problem or error.context}"
        ) from None
    except yaml.reader.ReaderError as error:
        place = place_in(text, error.position, source, first)
        raise DocumentError(
            f"{place}: not valid YAML: holds the control character"
            f" U+{error.character:04X}"
        ) from None
    return nodes


def _compose_json(text: str, source: str) -> list[yaml.Node]:
    """Return the nodes of JSON objects one after the other: a JSON decoder finds the
    end of each, YAML's composer the places in it.
    """
    nodes: list[yaml.Node] = []
    decoder, at = json.JSONDecoder(), _after_blanks(text, 0)
    first = text.count("\n", 0, at)
    while at < len(text):
        try:
            _, end = decoder.raw_decode(text, at)
        except json.JSONDecodeError as error:
            if not nodes:  # a YAML flow mapping also begins with a brace
                return _compose_yaml(text, source)
            raise DocumentError(
                f"{source}:{error.lineno}:{error.colno}: not valid JSON:"
                f" {error.msg.removesuffix(' at')}"
            ) from None
        except RecursionError:
            end = len(text)  # the composer reports the place that is too deep
        nodes += _compose_yaml(text[at:end].replace("\t", " "), source, first)
        after = _after_blanks(text, end)
        first, at = first + text.count("\n", at, after), after
    return nodes


def _after_blanks(text: str, at: int) -> int:
    """Return the place of the next character that is no blank."""
    blanks = _BLANKS.match(text, at)
    return blanks.end() if blanks else at
