"""Documents from YAML, JSON or CSV: nodes and cells to values by key."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import DocumentError
from .composition import DEEPEST, MOST_VALUES, Place, Value, unspaced
from .document import Document
from .quantities import with_a_point
from .table import ITEM, Cell, Faulty, rows_of_structures
from .texts import Text, text_at

if TYPE_CHECKING:
    import yaml


def documents_in(path: str | Path, faulty: Faulty | None = None) -> Iterator[Document]:
    """Yield the documents of a YAML, JSON or CSV file one by one; `-` is standard
    input; faulty: as of `each_document`. Raises UsageError (no such file) or
    DocumentError.
    """
    return each_document(text_at(path), faulty)


def parse_documents(text: str, source: str = "<text>") -> list[Document]:
    """Return all documents of a text.

    Parameters
    ----------
    text
        YAML documents, JSON objects one after the other, or rows of a CSV table
    source
        the name of the text in messages

    Returns
    -------
    list of Document
        in the order of the text

    Raises
    ------
    DocumentError
        for a text that is none of these, with line and column

    Examples
    --------
    >>> documents = parse_documents('{"kind": "block"} {"kind": "arch"}')
    >>> [document.values["kind"].content for document in documents]
    ['block', 'arch']
    """
    return list(each_document(Text.of(text, source)))


def each_document(text: Text, faulty: Faulty | None = None) -> Iterator[Document]:
    """Yield the documents of a text one by one, so that a caller who drops them holds
    one row of a table. faulty: called with the fault of each row of a table that is
    left out; without it the first one is raised. Raises DocumentError, as
    `parse_documents` does.
    """
    rows, source = rows_of_structures(text, faulty), text.source
    documents = (
        _of_nodes(text.whole(), source)
        if rows is None
        else _of_rows(rows, source, faulty)
    )
    if (first := next(documents, None)) is None:
        raise DocumentError(
            f"{Place(source, 1, 1)}: empty; expected a structure document, such as"
            " `kind: block` with width and height"
        )
    yield first
    yield from documents


def _of_nodes(text: str, source: str) -> Iterator[Document]:
    """Yield the documents of YAML or JSON."""
    from .nodes import compose

    for i, node in enumerate(compose(text, source)):
        yield _document(node, source, i)


def _of_rows(
    rows: Iterable[list[Cell]], source: str, faulty: Faulty | None
) -> Iterator[Document]:
    """Yield the documents of a table, whose other columns may be labels."""
    for i, cells in enumerate(rows):
        try:
            document = document_of(cells, source, i)
        except DocumentError as fault:
            if faulty is None:
                raise
            faulty(fault)
            continue
        yield document


def document_of(cells: Sequence[Cell], source: str, index: int = 0) -> Document:
    """Return the document with these keys, texts and places, such as the cells of a CSV
    row. Raises DocumentError.
    """
    values: dict[str, Value] = {}
    keys: dict[str, Place] = {}
    for cell in cells:
        value = _value_of(cell)
        if item := ITEM.fullmatch(cell.key):
            name, number, part = item.groups()
            whole = values.setdefault(name, Value([], cell.place))
            keys.setdefault(name, cell.place)
            _add_to_list(whole, cell, name, int(number), part, value)
        else:
            values[cell.key], keys[cell.key] = value, cell.place
    return Document(source, cells[0].place, values, keys, index, cells=cells)


def _value_of(cell: Cell) -> Value:
    """Return the value of a cell: its text, or the YAML list or mapping that it
    states.
    """
    text, place = cell.text, cell.place
    if text.startswith(("[", "{")) and (node := _only_node(text, place)):
        return replace(_value(node, 1, [0]), place=place)
    return Value(text, place)


def _add_to_list(
    whole: Value, cell: Cell, name: str, number: int, part: str, value: Value
) -> None:
    """Add a key to an item of a list, or a new item; name: of the list; number: of the
    item, from 1; part: the key. Raises DocumentError.
    """
    items = whole.content
    if not isinstance(items, list) or not 1 <= number <= len(items) + 1:
        raise DocumentError(
            f"{cell.place}: {cell.key}: found item {number}; expected items in order,"
            f" from {name}_1"
        )
    if number > len(items):
        items.append(Value({}, cell.place))
    content = items[number - 1].content
    if not isinstance(content, dict):
        raise DocumentError(
            f"{cell.place}: {cell.key}: found together with {name}, which states the"
            " same item; expected one of them"
        )
    content[part] = value


def _only_node(text: str, place: Place) -> yaml.Node | None:
    """Return the YAML list or mapping of a cell, None for a text that only begins like
    one.
    """
    from .nodes import compose

    try:
        nodes = compose(text, place.source, place.line - 1)
    except DocumentError:
        return None
    return nodes[0] if len(nodes) == 1 else None


def _document(node: yaml.Node, source: str, index: int) -> Document:
    """Return the document of a YAML node. Raises DocumentError if it is no mapping."""
    value = _value(node, 0, [0])
    if not isinstance(value.content, dict):
        hint = unspaced(value.content) if isinstance(value.content, str) else ""
        expected = "a mapping of keys to values, such as `kind: block`"
        raise DocumentError(
            f"{value.place}: {hint or f'found {value}; expected {expected}'}"
        )
    keys = {str(key.value): _place(key) for key, _ in node.value}
    mark = node.start_mark
    text = mark.buffer[mark.pointer : node.end_mark.pointer] if mark.buffer else ""
    return Document(
        source, value.place, value.content, keys, index, text.rstrip("\0").strip()
    )


def _place(node: yaml.Node) -> Place:
    """Return where a node begins."""
    return Place(
        node.start_mark.name, node.start_mark.line + 1, node.start_mark.column + 1
    )


def _value(node: yaml.Node, depth: int, count: list[int]) -> Value:
    """Return the value of a node; depth: of its nesting; count: one number, the values
    so far. Raises DocumentError.
    """
    from yaml import ScalarNode, SequenceNode

    place = _place(node)
    count[0] += 1
    if depth > DEEPEST or count[0] > MOST_VALUES:
        raise DocumentError(
            f"{place}: {'nested too deeply' if depth > DEEPEST else 'too many values'}"
            " to be a structure document"
        )
    if isinstance(node, ScalarNode):
        return Value(
            _whole_characters(node.value, place), place, quoted=node.style is not None
        )
    if isinstance(node, SequenceNode):
        return Value([_value(child, depth + 1, count) for child in node.value], place)
    return Value(_mapping(node, depth, count), place)


def _mapping(node: yaml.Node, depth: int, count: list[int]) -> dict[str, Value]:
    """Return the values of a mapping by key. Raises DocumentError."""
    content: dict[str, Value] = {}
    before = ("", "")  # the key and the text of the value before
    for key, child in node.value:
        place = _place(key)
        _refuse_decimal_comma(before, key, child)
        before = (str(key.value), str(child.value))
        _require_word(key, child)
        if key.value in content:
            raise DocumentError(
                f"{place}: duplicate key {key.value!r}, first given at line"
                f" {content[key.value].place.line}"
            )
        if key.value == "<<":
            raise DocumentError(
                f"{place}: merge keys (<<) are not part of structure documents"
            )
        content[_whole_characters(key.value, place)] = _value(child, depth + 1, count)
    return content


def _refuse_decimal_comma(
    before: tuple[str, str], key: yaml.Node, child: yaml.Node
) -> None:
    """Raise DocumentError for a number such as 0,45 inside braces, whose comma ends the
    value before and makes the rest a key without a value.
    """
    name, start = before
    if (
        child.value == ""
        and re.fullmatch(r"\d+( \S+)?", str(key.value))
        and start.lstrip("+-").isdigit()
    ):
        number = f"{start},{key.value}"
        raise DocumentError(
            f"{_place(key)}: {name}: found {number}; expected a"
            f" number{with_a_point(number)}"
        )


def _require_word(key: yaml.Node, child: yaml.Node) -> None:
    """Raise DocumentError for a key that is no word, or that holds its value, as in
    `width:2`.
    """
    from yaml import ScalarNode

    if not isinstance(key, ScalarNode):
        raise DocumentError(f"{_place(key)}: a key must be a word")
    if key.style is None and child.value == "" and (fault := unspaced(key.value)):
        raise DocumentError(f"{_place(key)}: {fault}")


def _whole_characters(text: str, place: Place) -> str:
    """Return the text with each pair of surrogates joined to one character."""
    if text.isascii() or not any("\ud800" <= c <= "\udfff" for c in text):
        return text
    try:
        return text.encode("utf-16", "surrogatepass").decode("utf-16")
    except UnicodeDecodeError:
        raise DocumentError(
            f"{place}: holds half a character (a lone surrogate)"
        ) from None
