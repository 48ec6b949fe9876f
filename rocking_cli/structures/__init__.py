"""What rocks: from structure documents to rocking parameters. A new kind is one file and one line in KINDS."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path

from ..documents.document import Document, parse_documents, read_documents
from ..errors import DocumentError, StructureError
from . import arch, block, drum, frame, parameters, point_mass, prism, spire
from .parameters import RockingParameters, Side, damping_of

KINDS: dict[str, Callable[[Document, str], RockingParameters]] = {
    "block": block.build,
    "point_mass": point_mass.build,
    "spire": spire.build,
    "arch": arch.build,
    "frame": frame.build,
    "prism": prism.build,
    "drum": drum.build,
    "parameters": parameters.build,
}


def build_structure(document: Document) -> RockingParameters:
    """The rocking parameters of one document. Raises DocumentError, which names the file, line, key and what is accepted."""
    kind = document.choice("kind", list(KINDS))
    stem = "structure" if document.source.startswith("<") else Path(document.source).stem
    name = document.word("name", stem if document.index == 0 else f"{stem}-{document.index + 1}")
    try:
        built = replace(KINDS[kind](document, name), damping=damping_of(document))
    except StructureError as error:
        raise DocumentError(f"{document.place}: {kind}: {error}") from None
    document.finish()
    return built


def load_structures(paths: Iterable[str | Path]) -> list[RockingParameters]:
    """The rocking parameters of every document in these files, in order; `-` is standard input.

    Raises UsageError for a file that cannot be read and DocumentError for a document that is not valid.
    """
    return with_distinct_names([build_structure(document) for path in paths for document in read_documents(path)])


def with_distinct_names(structures: Iterable[RockingParameters]) -> list[RockingParameters]:
    """The same structures; a name that was there before gets a number, so that a file's coordinate tells them apart."""
    taken: set[str] = set()
    named = []
    for structure in structures:
        name, number = structure.name, 1
        while name in taken:
            number += 1
            name = f"{structure.name}-{number}"
        taken.add(name)
        named.append(structure if name == structure.name else replace(structure, name=name))
    return named


__all__ = ["KINDS", "Document", "RockingParameters", "Side", "build_structure", "load_structures", "parse_documents", "read_documents"]
