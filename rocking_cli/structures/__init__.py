"""Structures: from structure documents to rocking parameters."""

from __future__ import annotations

import json
import warnings
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import DocumentError, StructureError
from .kinds import KEYS, KINDS, build, reports_of
from .parameters import OTHERS, RockingParameters, Side
from .shared_keys import damping_of, friction_of, labels_of
from .sizes import size_remarks

if TYPE_CHECKING:
    from ..documents.document import Document


def build_structure(document: Document) -> RockingParameters:
    """Return the rocking parameters of one document. Raises DocumentError, which names
    file, line, key and the values accepted.

    >>> (document,) = parse_documents('{kind: block, width: 0.5, height: 2}')
    >>> round(build_structure(document).p, 6)
    2.671671
    """
    # Names stand in lists with commas between them, so a name holds none.
    stem = (
        "structure"
        if document.source.startswith("<")
        else Path(document.source).stem.replace(",", " ")
    )
    name = document.word(
        "name", stem if document.index == 0 else f"{stem}-{document.index + 1}"
    )
    try:
        built = build(document, name)
        built = replace(
            built,
            damping=damping_of(document) + built.damping,
            friction=friction_of(document),
        )
    except StructureError as error:
        raise DocumentError(
            f"{document.place}: {document.values['kind'].content}: {error}"
        ) from None
    document.has("labels")  # a key of every kind, also of those of installed packages
    document.finish(KEYS)
    remarks = (*built.remarks, *size_remarks(document, built))
    return replace(built, labels=labels_of(document), remarks=remarks)


def read_documents(path: str | Path) -> list[Document]:
    """All documents of a YAML, JSON or CSV file (`-` is standard input), or the
    document that a text like `block:0.5x2` states. Raises UsageError if the file cannot
    be read, and DocumentError if it holds no valid document.

    >>> [document.source for document in read_documents('configs/arch.yaml')]
    ['configs/arch.yaml']
    """
    from ..documents.document import read_documents as of_file

    stated = None
    if ":" in str(path):
        from .inline import inline_document

        stated = inline_document(str(path))
    return of_file(path) if stated is None else [stated]


def on_each_interface(document: Document) -> list[Document]:
    """Return a document for each interface on which a stack can rock, the weakest one
    first under the name of the stack; also of its parameters as `rocking params --json`
    prints them. A stack that states `rocks_on`, and any other structure, has one
    document. Raises DocumentError.

    >>> (statue,) = parse_documents('''
    ... {name: Statue, kind: stack,
    ...  pieces: [{width: 1, height: 4}, {width: 0.1, height: 0.38}]}''')
    >>> [build_structure(document).name for document in on_each_interface(statue)]
    ['Statue', 'Statue on piece 1 from below']
    """
    kind = document.values["kind"].content if "kind" in document.values else ""
    if (
        kind == "parameters"
        and OTHERS in document.values
        and build_structure(document).details.get(OTHERS)
    ):
        others = document.values[OTHERS]
        first = replace(
            others,
            content={
                key: value for key, value in document.values.items() if key != OTHERS
            },
        )
        return [
            _alone(document.part(OTHERS, value), document.index)
            for value in (first, *others.content)
        ]
    if "interfaces" not in reports_of(str(kind)):
        return [document]
    built = build_structure(document)
    if document.has("rocks_on") or not (interfaces := built.details.get("interfaces")):
        return [document]
    found: list[Document] = []
    for i, one in enumerate(interfaces):
        weakest = one["on"] == built.details["rocks_on"]
        if (
            weakest or one["eta"] is not None or document.has("restitution")
        ):  # else it is too squat to rock there
            name = built.name if weakest else f"{built.name} on {one['on']}"
            here = document.with_value("name", name, document.source).with_value(
                "rocks_on", str(i), document.source
            )
            found.insert(0 if weakest else i, _alone(here, document.index))
    return found


def _alone(document: Document, index: int) -> Document:
    """Return the document with its own text and this number in its file."""
    text = json.dumps(
        {
            key: value.content if key == "name" else value.plain()
            for key, value in document.values.items()
        }
    )
    return replace(document, text=text, index=index, within=None)


def load_structures(
    paths: str | Path | Iterable[str | Path],
) -> list[RockingParameters]:
    """Return the rocking parameters of every document of these paths, in order, of a
    stack on each of its interfaces (see `on_each_interface`). `read_documents` lists
    the accepted forms of a path. Raises UsageError if a file cannot be read, and
    DocumentError if a document is not valid. Warns (UserWarning) of lengths without a
    unit that make a body higher than 30 m.

    >>> structures = load_structures(['configs/block.yaml', 'configs/arch.yaml'])
    >>> [structure.name for structure in structures]
    ['Column', 'Oppenheim']
    """
    paths = [paths] if isinstance(paths, str | Path) else paths
    documents = [
        one
        for path in paths
        for document in read_documents(path)
        for one in on_each_interface(document)
    ]
    structures = with_distinct_names(
        [build_structure(document) for document in documents]
    )
    for remark in dict.fromkeys(
        remark for structure in structures for remark in structure.remarks
    ):
        warnings.warn(remark, stacklevel=2)
    return structures


def with_distinct_names(
    structures: Iterable[RockingParameters],
) -> list[RockingParameters]:
    """Return the same structures with distinct names: a repeated name gets a number.
    Spectra files identify structures by name.
    """
    taken: set[str] = set()
    named = []
    for structure in structures:
        name, number = structure.name, 1
        while name in taken:
            number += 1
            name = f"{structure.name}-{number}"
        taken.add(name)
        named.append(
            structure if name == structure.name else replace(structure, name=name)
        )
    return named


__all__ = [
    "KINDS",
    "RockingParameters",
    "Side",
    "build_structure",
    "load_structures",
    "on_each_interface",
    "read_documents",
]
