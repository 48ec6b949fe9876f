"""The kinds of structure. A new one is one file with `build` and `REPORTS`, and one line in KINDS. SIZES, where a kind has it, are
the keys that `block:0.5x2` states, and `sketch(document, parameters)` is what `rocking draw` draws.

An installed package adds a kind of its own by an entry point, which names a module (or object) of the same two:

    [project.entry-points."rocking.structures"]
    tower = "my_package.tower"

Entry points are looked at only for a `kind` that is not in KINDS.
"""

from __future__ import annotations

from collections.abc import Iterator, MutableMapping, Sequence
from importlib import import_module
from typing import TYPE_CHECKING, Protocol, cast

from ..parameters import RockingParameters

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

    from ...documents.document import Document
    from ..sketch import Sketch

GROUP = "rocking.structures"


class Kind(Protocol):
    """What a kind of structure has to provide; a module will do."""

    @property
    def REPORTS(self) -> Sequence[str]:
        """Keys of its own in RockingParameters.details, which a document of kind `parameters` carries along."""

    def build(self, document: Document, name: str) -> RockingParameters:
        """The rocking parameters of a document of this kind.

        It reads every key that it knows by the document's methods, which name place, key and what is accepted where they
        refuse; what nobody has read is refused afterwards. It may raise StructureError for numbers that do not rock.
        """


class _Kinds(MutableMapping[str, Kind]):
    """Kinds by name, each imported when it is first asked for: most calls need one of them."""

    def __init__(self, modules: dict[str, str]) -> None:
        self._kinds: dict[str, Kind | str] = dict(modules)

    def __getitem__(self, word: str) -> Kind:
        kind = self._kinds[word]
        if isinstance(kind, str):
            self._kinds[word] = kind = cast(Kind, import_module(f".{kind}", __package__))
        return kind

    def __setitem__(self, word: str, kind: Kind) -> None:
        self._kinds[word] = kind

    def __delitem__(self, word: str) -> None:
        del self._kinds[word]

    def __iter__(self) -> Iterator[str]:
        return iter(self._kinds)

    def __len__(self) -> int:
        return len(self._kinds)

    def __contains__(self, word: object) -> bool:
        return word in self._kinds


KINDS = _Kinds(
    {
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
        "parameters": "stated",
    }
)
"""A word after `kind`, and the module of this package that builds it."""


def kind_of(document: Document) -> tuple[str, Kind]:
    """The word after `kind` and the kind itself. Raises DocumentError for one that is unknown or whose package does not load."""
    value = document.values.get("kind")
    installed = {} if value is not None and isinstance(value.content, str) and value.content in KINDS else _installed()
    word = document.choice("kind", [*KINDS, *installed])
    if word in KINDS:
        return word, KINDS[word]
    entry = installed[word]
    try:
        return word, _load(entry)
    except Exception as error:  # whatever the import of a foreign package raises
        package = f"the package {entry.dist.name}" if entry.dist else entry.value
        found = f"{word}, which {package} adds and which cannot be used: {type(error).__name__}: {error}"
        raise document.fault("kind", found, f"a package that works, or one of {', '.join(KINDS)}") from error


def reports_of(word: str) -> Sequence[str]:
    """The details that a kind reports; none of a word that is no kind here."""
    if word in KINDS:
        return KINDS[word].REPORTS
    entry = _installed().get(word)
    try:
        return () if entry is None else _load(entry).REPORTS
    except Exception:  # its details are then refused by name, as those of a kind that is not installed
        return ()


def sizes_of(word: str) -> Sequence[str]:
    """The keys of the sizes that `KIND:AxB` states, none of a kind without such a form."""
    sizes: Sequence[str] = getattr(KINDS.get(word), "SIZES", ())
    return sizes


def sketch_of(document: Document, built: RockingParameters) -> Sketch:
    """The structure as it is drawn. Raises DocumentError for a kind that has no geometry."""
    word, kind = kind_of(document)
    draw = getattr(kind, "sketch", None)
    if draw is None:
        drawn = [name for name, other in KINDS.items() if hasattr(other, "sketch")]
        raise document.fault("kind", f"{word}, which states no geometry to draw", f"one of {', '.join(drawn)}")
    found: Sketch = draw(document, built)
    return found


def _installed() -> dict[str, EntryPoint]:
    from importlib.metadata import entry_points

    return {entry.name: entry for entry in entry_points(group=GROUP)}


def _load(entry: EntryPoint) -> Kind:
    kind: Kind = entry.load()
    if not (callable(getattr(kind, "build", None)) and isinstance(getattr(kind, "REPORTS", None), tuple | list)):
        raise TypeError(f"{entry.value} has no build(document, name), or no REPORTS, a tuple of keys")
    return kind
