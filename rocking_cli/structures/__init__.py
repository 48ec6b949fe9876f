"""Structures: from structure documents to rocking parameters."""

from __future__ import annotations

import json
import warnings
from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..documents.files import named_after
from ..documents.spreads import NOTED_CUT
from ..errors import DocumentError, StructureError
from .building_modes import modes_in
from .kinds import KINDS, build, known_keys, reports_of
from .parameters import OTHERS, RockingParameters, Side
from .rigidity import rigidity_of
from .shared_keys import damping_of, friction_of, labels_of

if TYPE_CHECKING:
    from ..documents.document import Document
    from ..documents.table import Faulty


def build_structure(document: Document) -> RockingParameters:
    """Return the rocking parameters of one document.

    Parameters
    ----------
    document
        of any kind of structure, see `read_documents` and `parse_documents`

    Returns
    -------
    RockingParameters
        p, alpha, eta, lambda and a_scale; of a block p = sqrt(3 g/(4 R)) and eta = 1 -
        1.5 sin^2(alpha) (Eqs. 2.3, 2.6), of a spire Eqs. 3.1 to 3.3, of an arch Eqs.
        3.5 to 3.9

    Raises
    ------
    DocumentError
        if the document is not valid or the theory does not cover the structure, with
        file, line, key and the values accepted

    Notes
    -----
    A block of alpha above 54.7 degrees and a point mass of alpha above 45 degrees would
    have a negative eta; they are refused unless the document states `restitution`.

    Examples
    --------
    >>> (document,) = parse_documents("{kind: block, width: 0.5, height: 2}")
    >>> column = build_structure(document)
    >>> f"{column.p:.6f} {column.alpha:.6f} {column.eta:.6f}"
    '2.671671 0.244979 0.911765'
    """
    # Names stand in lists with commas between them, so a name holds none.
    stem = (
        "structure"
        if document.source.startswith("<")
        else named_after(document.source).replace(",", " ")
    )
    name = document.word(
        "name", stem if document.index == 0 else f"{stem}-{document.index + 1}"
    )
    try:
        built = build(document, name)
        static, kinetic = friction_of(document)
        damping = damping_of(document) + built.damping
        details, flexible = rigidity_of(document, built)
        building = modes_in(document)
        document.has("labels")  # a key of every kind, also of installed packages
        document.finish(known_keys)
        cut = cut_remarks(document)
        stated: dict[str, Any] = {
            "damping": damping,
            "friction": static,
            "kinetic_friction": kinetic,
            "building": building,
            "labels": labels_of(document),
            "details": {**built.details, **details},
            "remarks": (*built.remarks, *document.doubts.values(), *cut, *flexible),
            "document": document,
        }
        # most bodies are complete: a copy would cost as much as they did
        changed = {key: x for key, x in stated.items() if getattr(built, key) != x}
        return replace(built, **changed) if changed else built
    except StructureError as error:
        raise DocumentError(
            f"{document.place}: {document.values['kind'].content}: {error}"
        ) from None


def cut_remarks(document: Document) -> list[str]:
    """Return a remark on each normal number of which the range of its key cuts off more
    than a thousandth.
    """
    found = []
    for path, key in document.uncertain.items():
        if (cut := key.spread.cut(key.low, key.high)) > NOTED_CUT:
            value = document.value_at(path)
            place = document.place if value is None else value.place
            found.append(
                f"{place}: {path}: {100.0 * cut:.2g} % of {value} are out of its range"
                " and are not drawn"
            )
    return found


def read_documents(path: str | Path) -> list[Document]:
    """Return the documents of a file.

    Parameters
    ----------
    path
        a YAML, JSON or CSV file, "-" for standard input, or a text that is a document
        itself, such as "block:0.5x2" or "{kind: block, width: 0.5, height: 2}"

    Returns
    -------
    list of Document
        in the order of the file

    Raises
    ------
    UsageError
        if the file cannot be read
    DocumentError
        if it holds no valid document, with file, line and column

    Examples
    --------
    >>> [document.source for document in read_documents("configs/arch.yaml")]
    ['configs/arch.yaml']
    """
    return list(documents_in(path))


def documents_in(path: str | Path, faulty: Faulty | None = None) -> Iterator[Document]:
    """Yield the documents of a file one by one, as `read_documents` returns them;
    faulty: called with the fault of each row of a table that is left out.
    """
    from ..documents import parsing
    from ..documents.files import is_document_text

    if isinstance(path, str) and is_document_text(path):
        return iter(parsing.parse_documents(path))
    stated = None
    if ":" in str(path):
        from .inline import inline_document

        stated = inline_document(str(path))
    return parsing.documents_in(path, faulty) if stated is None else iter([stated])


def on_each_interface(document: Document) -> list[Document]:
    """Return a document for each interface on which a stack can rock.

    Parameters
    ----------
    document
        of a stack, or its parameters as `rocking params --json` prints them; any other
        structure, and a stack that states `rocks_on`, has one document

    Returns
    -------
    list of Document
        the weakest interface first, under the name of the stack

    Raises
    ------
    DocumentError
        if the document is not valid

    Examples
    --------
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
        # Without eta the pieces above are too squat to rock there.
        if weakest or one["eta"] is not None or document.has("restitution"):
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
    return replace(document, written=text, index=index, within=None)


def load_structures(
    paths: str | Path | Iterable[str | Path],
) -> list[RockingParameters]:
    """Return the rocking parameters of every document of some files.

    Parameters
    ----------
    paths
        a path, or several, each in a form that `read_documents` accepts

    Returns
    -------
    list of RockingParameters
        in the order of the files, with distinct names; a stack has one for each
        interface on which it can rock, see `on_each_interface`

    Raises
    ------
    UsageError
        if a file cannot be read
    DocumentError
        if a document is not valid

    Warns
    -----
    UserWarning
        for numbers without a unit that are not usual, such as a height of 190

    Examples
    --------
    >>> structures = load_structures(["configs/block.yaml", "configs/arch.yaml"])
    >>> [(structure.name, f"{structure.p:.4f}") for structure in structures]
    [('Column', '2.6717'), ('Oppenheim', '1.8421')]
    """
    paths = [paths] if isinstance(paths, str | Path) else paths
    documents = (
        one
        for path in paths
        for document in documents_in(path)
        for one in on_each_interface(document)
    )
    structures = list(with_distinct_names(map(build_structure, documents)))
    for remark in dict.fromkeys(
        remark for structure in structures for remark in structure.remarks
    ):
        warnings.warn(remark, stacklevel=2)
    return structures


def with_distinct_names(
    structures: Iterable[RockingParameters],
) -> Iterator[RockingParameters]:
    """Yield the same structures with distinct names: a repeated name gets a number.
    Spectra files identify structures by name.
    """
    last: dict[str, int] = {}  # number of each name that is taken; none below is free
    for structure in structures:
        name = structure.name
        while name in last:
            last[structure.name] += 1
            name = f"{structure.name}-{last[structure.name]}"
        last[name] = 1
        yield structure if name == structure.name else replace(structure, name=name)


__all__ = [
    "KINDS",
    "RockingParameters",
    "Side",
    "build_structure",
    "load_structures",
    "on_each_interface",
    "read_documents",
]
