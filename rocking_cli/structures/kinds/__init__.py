"""The kinds of structure.

A new kind is one file with `build` and `REPORTS`, and its name in KINDS. It may also have SIZES, the keys that `block:0.5x2`
states, and `sketch(document, parameters)`, the geometry for `rocking draw`. An installed package adds a kind by an entry point;
`damping`, `friction`, and `gravity` and `restitution` if build does not read them, are read for it:

    [project.entry-points."rocking.structures"]
    tower = "my_package.tower"

Entry points are read only for a `kind` that is not in KINDS.
"""

from __future__ import annotations

import math
from collections import UserDict
from collections.abc import Sequence
from contextlib import AbstractContextManager
from dataclasses import replace
from importlib import import_module
from typing import TYPE_CHECKING, Protocol, cast

from ...plugins import blamed, installed
from ..parameters import RockingParameters
from ..shared_keys import gravity_of, one_sided_restitution_of, restitution_of

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

    from ...documents.document import Document
    from ..sketch import Sketch

GROUP = "rocking.structures"


class Kind(Protocol):
    """The interface of a kind of structure; a module can implement it."""

    @property
    def REPORTS(self) -> Sequence[str]:
        """The keys of this kind in RockingParameters.details; a document of kind `parameters` keeps them."""

    def build(self, document: Document, name: str) -> RockingParameters:
        """The rocking parameters of a document of this kind.

        The document's methods read its keys and refuse wrong values; a key that no method reads is refused afterwards. May raise
        StructureError for a geometry that does not rock.
        """


class _Kinds(UserDict[str, "Kind | str"]):
    """Kinds by name; a name stands for a module of this package, which is imported at its first use."""

    def __getitem__(self, word: str) -> Kind:
        kind = self.data[word]
        if isinstance(kind, str):
            self.data[word] = kind = cast(Kind, import_module(f".{kind}", __package__))
        return kind


_OWN = ("block", "point_mass", "spire", "arch", "frame", "prism", "drum", "rigid", "stack", "wall")
KINDS = _Kinds({**{name: name for name in _OWN}, "parameters": "stated"})


def kind_of(document: Document) -> tuple[str, Kind]:
    """(name, kind) of a document. Raises DocumentError if the kind is unknown or its package does not load."""
    value = document.values.get("kind")
    found = {} if value is not None and isinstance(value.content, str) and value.content in KINDS else installed(GROUP)
    word = document.choice("kind", [*KINDS, *found])
    if word in KINDS:
        return word, KINDS[word]
    entry = found[word]
    with _blamed(document, entry):
        return word, _load(entry)


def built_by(document: Document, name: str) -> RockingParameters:
    """The parameters that the kind of a document builds. Raises DocumentError and StructureError as the kind does, and DocumentError
    for a package that raises another error, exits, or returns something else."""
    word, kind = kind_of(document)
    if word in KINDS:
        return kind.build(document, name)
    with _blamed(document, installed(GROUP)[word]):
        built = kind.build(document, name)
        if not isinstance(built, RockingParameters):
            raise TypeError(f"build returns {type(built).__name__}, which is no RockingParameters")
    return _with_shared_keys(document, built)


def _with_shared_keys(document: Document, built: RockingParameters) -> RockingParameters:
    """The structure with the gravity and restitution that its document states and its kind has not read: p^2 is proportional to gravity.
    They stay unread, and so are refused, for a structure with two sides or a mechanism, whose other numbers may depend on them."""
    if built.sides or built.mechanism is not None:
        return built
    unread = {"gravity", "restitution"} - document.asked
    if "gravity" in unread and document.has("gravity"):
        gravity = gravity_of(document)
        built = replace(built, gravity=gravity, p=built.p * math.sqrt(gravity / built.gravity))
    if "restitution" in unread and document.has("restitution"):
        of = one_sided_restitution_of(document, (1.0, 1.0), built.eta) if built.one_sided else restitution_of(document, built.eta, "")
        built = replace(built, eta=of[0], eta_source=of[1] if of[1] == "given" else built.eta_source)
    return built


def _blamed(document: Document, entry: EntryPoint) -> AbstractContextManager[None]:
    return blamed(entry, lambda found: document.fault("kind", found, f"a package that works, or one of {', '.join(KINDS)}"))


def reports_of(word: str) -> Sequence[str]:
    """The details that a kind reports; empty for an unknown kind."""
    if word in KINDS:
        return KINDS[word].REPORTS
    entry = installed(GROUP).get(word)
    try:
        return () if entry is None else _load(entry).REPORTS
    except (Exception, SystemExit):  # its details are then refused by name, as for a kind that is not installed
        return ()


def sizes_of(word: str) -> Sequence[str]:
    """The keys that the sizes of `KIND:AxB` state; empty for a kind without this form."""
    return tuple(getattr(KINDS.get(word), "SIZES", ()))


def sketch_of(document: Document, built: RockingParameters) -> Sketch:
    """The sketch of a structure. Raises DocumentError if its kind has no geometry."""
    word, kind = kind_of(document)
    draw = getattr(kind, "sketch", None)
    if draw is None:
        drawn = [name for name, other in KINDS.items() if hasattr(other, "sketch")]
        raise document.fault("kind", f"{word}, which states no geometry to draw", f"one of {', '.join(drawn)}")
    found: Sketch = draw(document, built)
    return found


def _load(entry: EntryPoint) -> Kind:
    kind: Kind = entry.load()
    if not (callable(getattr(kind, "build", None)) and isinstance(getattr(kind, "REPORTS", None), tuple | list)):
        raise TypeError(f"{entry.value} has no build(document, name), or no REPORTS, a tuple of keys")
    return kind
