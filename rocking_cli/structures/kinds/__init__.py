"""The kinds of structure.

A new kind is one file, and one line in KINDS. The file has

- `body(document)`, which returns the `RigidBody` of a rigid body, or
  `build(document, name)`, which returns the RockingParameters of any other structure.
  Both may raise StructureError for a geometry that does not rock;
- `KEYS`, the table of the keys of its documents, besides those of every kind and of
  every rigid body. The document's methods read the keys as the table says and refuse
  wrong values; schema, help, completion and `rocking init` show them;
- `REPORTS`, the keys of this kind in RockingParameters.details; a document of kind
  `parameters` keeps them;
- `SIZES`, the keys that `block:0.5x2` states, if the kind has this form;
- `sketch(document, parameters)` beside `build`, the geometry for `rocking draw`, if the
  kind has one.

An installed package adds a kind by an entry point; `damping`, `friction`, and `gravity`
and `restitution` if build does not read them, are read for it. Without `KEYS` it takes
each key that it reads:

    [project.entry-points."rocking.structures"]
    tower = "my_package.tower"

Entry points are read only for a `kind` that is not in KINDS.
"""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from contextlib import AbstractContextManager, nullcontext, suppress
from dataclasses import replace
from functools import cache
from importlib import import_module
from typing import TYPE_CHECKING, Any, TypeVar

from ...documents.keys import Key, Keys
from ...errors import DocumentError
from ...plugins import blamed, installed
from ..parameters import RockingParameters
from ..shared_keys import (
    RIGID,
    SHARED,
    gravity_of,
    has_loads,
    one_sided_restitution_of,
    restitution_of,
)
from ..sketch import Sketch

if TYPE_CHECKING:
    from ...documents.document import Document
    from ..mechanics.single_body import RigidBody

Made = TypeVar("Made")

GROUP = "rocking.structures"
_NONE = Keys()
# the module of each kind, which is imported when a document is of this kind
KINDS = {
    "block": "block",
    "point_mass": "point_mass",
    "spire": "spire",
    "arch": "arch",
    "frame": "frame",
    "prism": "prism",
    "drum": "drum",
    "rigid": "rigid",
    "stack": "stack",
    "wall": "wall",
    "mechanism": "mechanism",
    "parameters": "stated",
}


def build(document: Document, name: str) -> RockingParameters:
    """Return the parameters of a document of any kind. Raises DocumentError for an
    unknown kind, and for the kind of an installed package that does not load, raises
    another error, exits, or returns something else; otherwise what the kind raises.
    """
    value = document.values.get("kind")
    known = value is not None and str(value.content) in KINDS
    word = document.choice("kind", [*KINDS, *([] if known else installed(GROUP))])
    with _named(document, word):
        kind = _module(word)
        _declare(document)
        if hasattr(kind, "body"):
            found = kind.body(document).parameters(document, name)
        else:
            found = kind.build(document, name)
        built = _required(found, RockingParameters)
        if word not in KINDS:
            json.dumps(dict(built.details))  # which can be printed
    return _with_shared_keys(document, built)


def _required(found: Any, kind: type[Made]) -> Made:
    """Return what the module of a kind made. Raises TypeError for something else."""
    if isinstance(found, kind):
        return found
    raise TypeError(f"found a {type(found).__name__}; expected a {kind.__name__}")


def _named(document: Document, word: str) -> AbstractContextManager[None]:
    """Whatever the code of a package raises becomes a DocumentError that names it."""
    if word in KINDS:
        return nullcontext()
    wanted = f"a package that works, or one of {', '.join(KINDS)}"
    return blamed(
        installed(GROUP)[word], lambda said: document.fault("kind", said, wanted)
    )


def _declare(document: Document) -> None:
    """Give a document the keys of its kind. Raises DocumentError for others."""
    word = str(document.values["kind"].content)
    of = document.values.get("structure_kind")  # of parameters
    keys = keys_of(word, str(of.content) if of else "")
    for key in document.keys:
        if key in RIGID.all and key not in keys.all:
            raise document.fault(
                key,
                f"{key} of kind {word}",
                f"no {key}, or a kind of one rigid body, such as block or wall",
            )
    if own_keys(word).all:
        document.declare(keys, known_keys)
    else:  # of a package: it takes what it reads
        document.table = keys.all


def own_keys(word: str) -> Keys:
    """Return the keys that a kind declares, without those that kinds share."""
    found: Keys = _listed(word, "KEYS") or _NONE
    return found


def keys_of(word: str, *reported: str) -> Keys:
    """Return the keys of documents of a kind, its own first, then the details that the
    kinds `reported` report; only those of every kind for a package that declares none,
    or does not load.
    """
    details = {key: None for one in reported if one for key in reports_of(one)}
    return _joined(own_keys(word), bool(_listed(word, "body")), *details)


@cache  # every row of a table asks for those of its kind
def _joined(own: Keys, rigid: bool, *details: str) -> Keys:
    shared = RIGID | SHARED if rigid else SHARED
    return Keys(optional=dict.fromkeys(details, Key("any"))) | own | shared


def rigid_body_of(document: Document) -> RigidBody | None:
    """Return the rigid body of a document, on its geometric edges; None for one that
    takes no inset, such as parameters, and for a body that carries loads.
    """
    from ..mechanics.single_body import RigidBody

    word = str(document.values["kind"].content)
    if word not in KINDS or not hasattr(kind := _module(word), "body"):
        return None
    found = kind.body(document)
    if not isinstance(found, RigidBody) or has_loads(document):
        return None
    with suppress(DocumentError):  # a cracked spire takes no inset
        found.inset_by(0.1 * found.lever)
        return found
    return None


def _module(word: str) -> Any:
    """Return the module of a kind, of this package or of an installed one."""
    if word in KINDS:
        return _own_module(KINDS[word])
    return installed(GROUP)[word].load()


@cache
def _own_module(name: str) -> Any:
    """Return a module of this package."""
    return import_module(f".{name}", __package__)


def _with_shared_keys(
    document: Document, built: RockingParameters
) -> RockingParameters:
    """Apply the gravity and restitution of the document if the kind has not read them;
    p^2 is proportional to gravity. For a structure with two sides or a mechanism both
    stay unread, and so are refused, since its other numbers may depend on them.
    """
    if built.sides or built.mechanism is not None:
        return built
    unread = {"gravity", "restitution"} - document.asked
    if "gravity" in unread and document.has("gravity"):
        gravity = gravity_of(document)
        built = replace(
            built, gravity=gravity, p=built.p * math.sqrt(gravity / built.gravity)
        )
    if "restitution" in unread and document.has("restitution"):
        of = (
            one_sided_restitution_of(document, (1.0, 1.0), built.eta)
            if built.one_sided
            else restitution_of(document, built.eta, "")
        )
        built = replace(
            built, eta=of[0], eta_source=of[1] if of[1] == "given" else built.eta_source
        )
    return built


def reports_of(word: str) -> Sequence[str]:
    """Return the keys of the details that a kind reports; empty for an unknown kind and
    for a package that does not load.
    """
    return tuple(_listed(word, "REPORTS") or ())


def sizes_of(word: str) -> Sequence[str] | None:
    """Return the keys whose values `KIND:AxB` states; empty for a kind without this
    form, None for an unknown kind and for a package that does not load.
    """
    if word not in KINDS and word not in installed(GROUP):
        return None
    sizes = _listed(word, "SIZES")
    return None if sizes is None else tuple(sizes)


def _listed(word: str, name: str) -> Any:
    """Return what the module of a kind has under `name`, () without it; None for an
    unknown kind and for a package that does not load.
    """
    try:
        return getattr(_module(word), name, ())
    except KeyboardInterrupt:
        raise
    except BaseException:  # of the code of a package
        return None


@cache
def known_keys() -> frozenset[str]:
    """Return the keys of documents of all kinds, without those inside lists. A column
    of a table with such a name is no label.
    """
    return frozenset(
        name
        for word in KINDS
        for name, key in keys_of(word).all.items()
        # of `parameters` these are details that it carries along
        if word != "parameters" or key.form != "any"
    )


def is_drawn(word: str) -> bool:
    """True if a kind of this package has a geometry to draw."""
    return any(hasattr(_module(word), name) for name in ("body", "sketch"))


def sketch_of(document: Document, built: RockingParameters) -> Sketch:
    """Return the sketch of a structure that was built from the document. Raises
    DocumentError if its kind has no geometry.
    """
    word = str(document.values["kind"].content)
    with _named(document, word):
        kind = _module(word)
        if not document.table:
            _declare(document)
        if hasattr(kind, "body"):
            return _required(kind.body(document).sketch(document, built), Sketch)
        if hasattr(kind, "sketch"):
            return _required(kind.sketch(document, built), Sketch)
    raise document.fault(
        "kind",
        f"{word}, which states no geometry to draw",
        f"one of {', '.join(filter(is_drawn, KINDS))}",
    )
