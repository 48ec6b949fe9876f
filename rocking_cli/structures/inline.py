"""Structures stated on the command line, such as `block:0.5x2` or
`spire:1.5x12,thickness=0.15,crack=diagonal`.
"""

import os
import re
from typing import TYPE_CHECKING

from ..errors import DocumentError
from .kinds import sizes_of

if TYPE_CHECKING:
    from ..documents.document import Document

_KIND = re.compile(r"([A-Za-z_][A-Za-z0-9_]+):(.*)", re.DOTALL)


def inline_document(text: str) -> "Document | None":
    """Return the document that `KIND:SIZES,KEY=VALUE,…` states, or None if the text is
    a file name or has another form. The sizes are the keys SIZES of the kind, with an x
    between them. A unit of length after the last size holds for the sizes that have
    none. Raises DocumentError.
    """
    match = _KIND.fullmatch(text)
    if match is None or os.path.exists(text):
        return None
    from ..documents.composition import Place
    from ..documents.parsing import document_of
    from ..documents.quantities import with_a_point
    from ..documents.table import Cell

    word, rest = match.groups()
    stated, sizes = [("kind", word)], sizes_of(word)
    for i, part in enumerate(_parts(rest)):
        key, equals, value = (x.strip() for x in part.partition("="))
        if equals:
            stated.append((key, value))
        elif sizes is not None:  # `build_structure` refuses an unknown kind
            given = [size.strip() for size in part.split("x")]
            if i or not sizes or len(given) != len(sizes) or not all(given):
                short = (
                    f"{word}:{'x'.join(size.upper() for size in sizes)} or "
                    if sizes
                    else ""
                )
                raise DocumentError(
                    f"{text}: found {part.strip()!r}; expected"
                    f" {short}{word}:KEY=VALUE,KEY=VALUE{with_a_point(rest)}"
                )
            stated += zip(sizes, _in_one_unit(given), strict=True)
    keys = [key for key, _ in stated]
    if twice := [key for key in keys if keys.count(key) > 1]:
        raise DocumentError(f"{text}: {twice[0]} is given twice")
    stated = _nested(stated, text)
    if "name" not in keys:
        stated.append(("name", text.replace(",", " ")))
    found = document_of(
        [Cell(key, value, Place(text, 0, 0)) for key, value in stated], text
    )
    found.written, found.cells = found.text, ()  # its other keys are no labels
    return found


def _nested(stated: list[tuple[str, str]], text: str) -> list[tuple[str, str]]:
    """Return the keys with those of one mapping, such as friction.static and
    friction.kinetic, joined to its value. Raises DocumentError for a key that has a
    value and parts.
    """
    found: dict[str, str] = {}
    for key, value in stated:
        head, dot, name = key.partition(".")
        if head in found and not (dot and name and found[head].startswith("{")):
            raise DocumentError(
                f"{text}: {head} is given twice, once with parts: {key}={value}"
            )
        inner = found[head][1:-1] + ", " if head in found else ""
        if dot and name:
            found[head] = f"{{{inner}{name}: {value}}}"
        else:
            found[key] = value
    return list(found.items())


def _in_one_unit(sizes: list[str]) -> list[str]:
    """Return the sizes; the unit of length of the last size holds for the sizes that
    have none, so 45x180cm is 45 cm by 180 cm.
    """
    from ..documents.quantities import UNITS
    from ..documents.spreads import unit_of_last
    from ..documents.table import with_unit

    unit = unit_of_last(sizes[-1])
    return (
        [with_unit(size, unit) for size in sizes] if unit in UNITS["length"] else sizes
    )


def _parts(text: str) -> list[str]:
    """Split a text at its commas, except commas inside brackets."""
    parts, depth = [""], 0
    for character in text:
        depth += (character in "[{") - (character in "]}")
        if character == "," and depth <= 0:
            parts.append("")
        else:
            parts[-1] += character
    return parts if text.strip() else []
