"""What Python gives as a structure: parameters, a document, or what the command line
takes, a path or a text such as `block:0.5x2`, or the text of a document.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Union

from ..documents.files import several
from ..errors import UsageError
from . import (
    build_structure,
    load_structures,
    read_documents,
    with_distinct_names,
)
from .parameters import RockingParameters

if TYPE_CHECKING:
    from ..documents.document import Document

# A document is named only: what has no document does not import their reader.
Structure = Union[RockingParameters, "Document", str, Path]


def documents_from(
    given: "Document | str | Path | Sequence[Document | str | Path]",
) -> "list[Document]":
    """Return the documents of one or several, those of a path in the order of its file.
    Raises UsageError and DocumentError as `read_documents` does.
    """
    found: list[Document] = []
    for one in several(given):
        found += read_documents(one) if isinstance(one, str | Path) else [one]
    return found


def document_from(given: "Document | str | Path") -> "Document":
    """Return the only document of what was given. Raises UsageError for several."""
    found = documents_from(given)
    if len(found) > 1:
        raise UsageError(
            f"{found[0].source}: found {len(found)} documents; expected one:"
            " read_documents reads them all"
        )
    return found[0]


def structures_from(given: Structure | Sequence[Structure]) -> list[RockingParameters]:
    """Return the structures of one or several, those of a path in the order of its
    file; a name that is repeated gets a number where something was read. Raises
    UsageError and DocumentError as `load_structures` does.
    """
    found: list[RockingParameters] = []
    read = False
    for one in several(given):
        if isinstance(one, RockingParameters):
            found.append(one)
            continue
        read = True
        found += (
            load_structures(one)
            if isinstance(one, str | Path)
            else [build_structure(one)]
        )
    return list(with_distinct_names(found)) if read else found


def structure_from(given: Structure) -> RockingParameters:
    """Return the only structure of what was given. Raises UsageError for several."""
    found = structures_from(given)
    if len(found) > 1:
        names = ", ".join(structure.name for structure in found)
        raise UsageError(
            f"{given}: found {len(found)} structures ({names}); expected one:"
            " load_structures reads them all"
        )
    return found[0]
