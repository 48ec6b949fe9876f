"""Documents as values by key; each error message names file, line, column, key, the
value found and the values accepted.

Scalars keep their text, and `quantities` reads them. This avoids YAML 1.1's own rules,
by which `1e-3` is a string, `010` is eight, `no` is a boolean and `1:30` is ninety.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from itertools import combinations
from typing import Any

from ..errors import ArgumentError, DocumentError, did_you_mean
from .composition import Place, Value
from .keys import Key, Keys, both, length
from .quantities import (
    FACTORS,
    accepted,
    as_meant,
    is_bare,
    parse_quantity,
    si_unit,
)
from .spreads import MOST_CUT, Spread, has_no_unit, is_spread, parse_spread
from .table import ITEM, LABELS, Cell, split_heading, text_of_row

# words of this field that a column may have for a key, and the key
MEANT = {
    **dict.fromkeys(("eta", "e", "cor"), "restitution"),
    **dict.fromkeys(("mu", "cof"), "friction"),
    **dict.fromkeys(("zeta", "xi"), "damping"),
    "g": "gravity",
    "r": "radius",
    "h": "height",
    "b": "width",
    "t": "thickness",
    "rho": "density",
    "weight": "mass",
}
# words for a mass centre, which no key of most kinds states
_CENTRES = (
    *("centroid", "barycentre", "barycenter", "eccentricity", "cg", "cog"),
    *(axis + end for axis in "xyz" for end in ("g", "cg")),
)
_NUMBER, _LENGTH = Key("number"), length()


@dataclass(frozen=True)
class Uncertain:
    """A key whose value has a spread, and the range of the key."""

    path: str  # of the key in the document, such as `ties.0.height`
    spread: Spread  # [SI]
    dimension: str  # of the key
    low: float  # least value of the key [SI]
    high: float  # largest value of the key [SI]


@dataclass
class Document:
    """One document: its values by key, each with its place in the file.

    `read_documents` and `parse_documents` make documents; `build_structure` and
    `family` take them. A kind of structure reads a document with `quantity`, `length`,
    `choice`, `flag`, `integer`, `word`, `pair` and `parts`; what a call does not state,
    such as the limits of a number, is that of the declared key. Each of these methods
    marks its key as asked for, and `finish` refuses the other keys.

    Examples
    --------
    >>> (document,) = parse_documents("{kind: block, width: 500 mm, height: 2}")
    >>> document.length("width"), document.has("restitution")
    (0.5, False)
    >>> taller = document.with_value("height", "3 m", "a study")
    >>> f"{build_structure(taller).alpha:.4f}"
    '0.1651'
    """

    source: str  # the file
    place: Place  # where it begins
    values: dict[str, Value]  # by key
    keys: dict[str, Place]  # the place of each key
    index: int = 0  # its number in the file
    written: str = ""  # its text in the file; that of a row is made of its cells
    asked: set[str] = field(default_factory=set)  # keys that were read
    # the documents in the lists of this one
    inner: list[Document] = field(default_factory=list)
    # of each quantity that was read, by its path, such as `ties.0.height`
    dimensions: dict[str, str] = field(default_factory=dict)
    # the keys with a spread, by their path
    uncertain: dict[str, Uncertain] = field(default_factory=dict)
    # the document around this one, and the path there
    within: tuple[Document, str] | None = None
    cells: Sequence[Cell] = ()  # of a row of a table, whose other columns are labels
    label_columns: Collection[str] = ()  # those of these cells that are labels
    table: dict[str, Key] = field(default_factory=dict)  # the declared keys
    # a remark on the first unusual value of each dimension
    doubts: dict[str, str] = field(default_factory=dict)
    # the keys with a value that is not null
    stated: set[str] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        self.stated = {
            key
            for key, value in self.values.items()
            if value.word() not in ("", "~", "null")
        }

    def __repr__(self) -> str:
        number = f", document {self.index + 1}" * (self.index > 0)
        return f"Document({self.source}{number}: {', '.join(self.values)})"

    def __getstate__(self) -> dict[str, Any]:
        """Pickle without the table of keys, which reading the document sets again."""
        return vars(self) | {"table": {}}

    @property
    def text(self) -> str:
        """The document as a text: as the file has it, or of the cells of a row."""
        return self.written or text_of_row(self.cells, self.label_columns)

    def has(self, key: str) -> bool:
        """True if the key has a value that is not null.

        Parameters
        ----------
        key
            key of the document; it counts as asked for

        Returns
        -------
        bool
        """
        self.asked.add(key)
        return key in self.stated

    def fault(self, key: str | None, found: str, wanted: str) -> DocumentError:
        """Return the error for the value of a key.

        Parameters
        ----------
        key
            key of the document, None for the document itself
        found
            what was found, in words
        wanted
            what is accepted, in words

        Returns
        -------
        DocumentError
            with file, line and column of the value
        """
        place = (
            self.place
            if key is None
            else (
                self.values[key].place
                if key in self.values
                else self.keys.get(key, self.place)
            )
        )
        return DocumentError(
            f"{place}: {key + ': ' if key else ''}found {found}; expected {wanted}"
        )

    def missing(self, key: str, wanted: str) -> DocumentError:
        """Return the error for a required key that is absent or misspelt.

        Parameters
        ----------
        key
            key of the document
        wanted
            what is accepted, in words

        Returns
        -------
        DocumentError
            with the place of a key of similar spelling, else of the document
        """
        from difflib import get_close_matches

        left = [other for other in self.keys if other not in self.asked]
        for other in get_close_matches(key, left, n=1, cutoff=0.75):
            return DocumentError(
                f"{self.keys[other]}: unknown key {other!r} (did you mean {key!r}?)"
            )
        return DocumentError(f"{self.place}: no key {key!r}; expected {key}: {wanted}")

    def declare(
        self, keys: Keys, elsewhere: Callable[[], Collection[str]] = frozenset
    ) -> None:
        """Take a table of keys: the methods below read the document by it.

        Parameters
        ----------
        keys
            the keys that the document may have
        elsewhere
            as in `finish`

        Raises
        ------
        DocumentError
            for a key that is not in the table, and for keys that say one thing in two
            ways
        """
        self.table = keys.all
        self._refuse([key for key in self.keys if key not in keys.all], elsewhere)
        for group, ways in enumerate(keys.ways):
            if keys.way(self.stated, group) >= 0:
                continue
            given = [key for key in keys.all if key in self.stated]
            pairs = (x for x in combinations(given, 2) if keys.way(x, group) < 0)
            one, other = next(pairs, (given[0], given[-1]))
            wanted = ", or ".join(both(way.required) for way in ways)
            only = "not both" if len(ways) == 2 else "not several"
            found = f"{other} together with {one}"
            raise self.fault(other, found, f"{wanted}, {only}")

    def quantity(self, key: str, dimension: str | None = None, **limits: Any) -> float:
        """Return the SI value of a key.

        Parameters
        ----------
        key
            key of the document
        dimension
            "length", "angle", "acceleration", "number" or another key of `UNITS`, by
            default that of the declared key
        limits
            instead of those of the declared key: `above`, `below` (the value itself
            must not reach them), `least`, `most` [SI]; `where`, the range in words;
            `default`, the value of an absent key, None if the key is required

        Returns
        -------
        float
            the value [SI]

        Raises
        ------
        DocumentError
            for an absent required key, another unit, or a value out of range
        """
        told = self.table.get(key, _NUMBER)
        return self._quantity(key, told.narrowed(form=dimension, **limits))

    def _quantity(self, key: str, told: Key) -> float:
        """Return the SI value of a key of this form. Raises DocumentError."""
        dimension, (outer, path) = told.form, self._outermost(key)
        outer.dimensions[path] = dimension
        if not self.has(key):
            if told.default is None:
                raise self.missing(key, accepted(dimension))
            return float(told.default)
        value, spread = self.values[key], None
        text = value.content
        if not isinstance(text, str):
            wanted = told.range() if told.words else accepted(dimension)
            raise self.fault(key, str(value), wanted)
        try:
            if is_spread(text):
                spread = parse_spread(text, dimension)
            number = spread.mean if spread else parse_quantity(text, dimension)
        except ArgumentError as error:
            said = is_spread(text) or not told.words
            wanted = str(error) if said else told.range() + as_meant(text, dimension)
            raise self.fault(key, str(value), wanted) from None
        ends = (spread.first, spread.second) if spread and spread.bounded else (number,)
        if not all(map(told.holds, ends)):
            bare = dimension == "angle" and is_bare(text)
            hint = " (a bare number is in rad)" if bare else ""
            raise self.fault(key, str(value), told.range() + hint)
        if spread and not spread.certain:
            if (cut := spread.cut(told.low, told.high)) > MOST_CUT:
                inside = Key(dimension, least=told.low, most=told.high).range()
                share = f"{100.0 * cut:.3g} % are not {inside}"
                raise DocumentError(
                    f"{value.place}: {path}: found {value}, of which {share}; expected"
                    " a smaller standard deviation, or LOW .. HIGH"
                )
            outer.uncertain[path] = Uncertain(
                path, spread, dimension, told.low, told.high
            )
        self._doubt(key, told, value, number)
        return number

    def _doubt(self, key: str, told: Key, value: Value, number: float) -> None:
        """Keep a remark on a number [SI] without a unit that is not usual."""
        if told.usual and has_no_unit(str(value.content)):
            dimension = told.form if told.is_quantity else told.of
            if doubt := told.usual.doubt(number, si_unit(dimension)):
                outer, path = self._outermost(key)
                outer.doubts.setdefault(dimension, f"{value.place}: {path}: {doubt}")

    def _outermost(self, path: str) -> tuple[Document, str]:
        """Return the outermost document, and the path there of a path in this one."""
        if self.within is None:
            return self, path
        outer, own = self.within
        return outer._outermost(f"{own}.{path}")

    def optional(self, key: str) -> float | None:
        """Return the SI value of a declared key, None without one.

        Parameters
        ----------
        key
            key of the document

        Returns
        -------
        float or None
            None if the key is absent, or has a word such as `auto` that may stand in
            place of a value

        Raises
        ------
        DocumentError
            as `quantity` does
        """
        if not self.has(key) or self.values[key].content in self.table[key].words:
            return None
        return self.quantity(key)

    def length(self, key: str) -> float:
        """Return the value of a key that must be a positive length.

        Parameters
        ----------
        key
            key of the document

        Returns
        -------
        float
            the length [m]

        Raises
        ------
        DocumentError
            for an absent key, another unit, or a length that is not positive
        """
        return self._quantity(key, self.table.get(key, _LENGTH))

    def choice(
        self, key: str, options: Sequence[str] = (), default: str | None = None
    ) -> str:
        """Return the value of a key that must be one of some words.

        Parameters
        ----------
        key
            key of the document
        options
            the accepted words, by default those of the declared key
        default
            the word of an absent key, None if the key is required

        Returns
        -------
        str

        Raises
        ------
        DocumentError
            for an absent required key and for another word
        """
        told = self.table.get(key, Key("choice"))
        options, default = options or told.words, default or told.default
        if not self.has(key):
            if default is None:
                raise self.missing(key, f"one of {', '.join(options)}")
            return default
        value = self.values[key]
        if value.content not in options:
            raise self.fault(
                key,
                str(value),
                "one of"
                f" {', '.join(options)}{did_you_mean(str(value.content), options)}",
            )
        return str(value.content)

    def flag(self, key: str) -> bool:
        """Return the value of a key that must be true or false.

        Parameters
        ----------
        key
            key of the document

        Returns
        -------
        bool
            False if the key is absent

        Raises
        ------
        DocumentError
            for another value
        """
        if not self.has(key):
            return False
        value = self.values[key]
        if value.word() not in ("true", "false"):
            raise self.fault(key, str(value), "true or false")
        return value.word() == "true"

    def integer(
        self, key: str, least: int | None = None, most: int | None = None
    ) -> int:
        """Return the value of a key that must be a whole number.

        Parameters
        ----------
        key
            key of the document
        least, most
            limits that the number may reach, by default those of the declared key

        Returns
        -------
        int

        Raises
        ------
        DocumentError
            for an absent key, a fraction, or a number out of range
        """
        told = self.table.get(key, _NUMBER).narrowed(least=least, most=most)
        wanted = f"a whole number from {told.least:.0f} to {told.most:.0f}"
        if self.has(key) and is_spread(str(self.values[key].content)):
            raise self.fault(
                key, str(self.values[key]), f"{wanted}; it takes no spread"
            )
        number = self._quantity(key, told.narrowed(form="number", where=wanted))
        if number != int(number):
            raise self.fault(key, str(self.values[key]), wanted)
        return int(number)

    def word(self, key: str, default: str) -> str:
        """Return the value of a key that must be a text of printable characters.

        Parameters
        ----------
        key
            key of the document
        default
            the text of an absent key

        Returns
        -------
        str

        Raises
        ------
        DocumentError
            for an empty text and for a value that is no text
        """
        if not self.has(key):
            return default
        content = self.values[key].content
        if (
            not isinstance(content, str)
            or not content.strip()
            or not content.isprintable()
        ):
            raise self.fault(
                key, str(self.values[key]), "a text of printable characters"
            )
        return content

    def pair(
        self, key: str, value: Value, dimension: str, name: str, wanted: str
    ) -> tuple[float, float]:
        """Return a list of two quantities that stands inside the value of a key.

        Parameters
        ----------
        key
            key of the document
        value
            the list, a part of the value of `key`
        dimension
            dimension of both quantities, as in `quantity`
        name
            what the pair is, for the message, such as "point"
        wanted
            what is accepted, in words

        Returns
        -------
        tuple of two floats
            the quantities [SI]

        Raises
        ------
        DocumentError
            if the value is no such list
        """
        if isinstance(value.content, list) and len(value.content) == 2:
            texts = [str(v.content) for v in value.content]
            try:
                first, second = (parse_quantity(text, dimension) for text in texts)
            except ArgumentError:
                pass
            else:
                told = self.table.get(key, _NUMBER)
                for v, number in zip(value.content, (first, second), strict=True):
                    self._doubt(key, told, v, number)
                return first, second
            if any(is_spread(str(v)) for v in value.content):
                found = f"a {name} with a spread (line {value.place.line})"
                raise self.fault(key, found, f"{wanted}; they take no spread")
        raise self.fault(
            key,
            f"a {name} that is not a pair of {dimension}s (line {value.place.line})",
            wanted,
        )

    def reference(self, key: str, value: Value, names: Sequence[str], what: str) -> str:
        """Return a text inside the value of a key that names a part of the document.

        Parameters
        ----------
        key
            key of the document
        value
            the text, the value of `key` or a part of it
        names
            the names of all such parts
        what
            what the text names, for the message, such as "a body"

        Returns
        -------
        str
            one of the names

        Raises
        ------
        DocumentError
            for another text, and for a value that is no text
        """
        word = value.content
        if not isinstance(word, str) or word not in names:
            hint = did_you_mean(word, names) if isinstance(word, str) else ""
            path = f"{self.within[1]}.{key}" if self.within else key
            raise DocumentError(
                f"{value.place}: {path}: found {value}; expected {what}, one of"
                f" {', '.join(names)}{hint}"
            )
        return word

    def part(self, key: str, value: Value, path: str = "") -> Document:
        """Return a mapping that stands inside the value of a key as a document.

        Parameters
        ----------
        key
            key of the document
        value
            the mapping
        path
            its path in this document, such as `ties.0`; by default the key

        Returns
        -------
        Document

        Raises
        ------
        DocumentError
            if the value is no mapping
        """
        if not isinstance(value.content, dict):
            raise DocumentError(
                f"{value.place}: {key}: found {value}; expected a mapping of keys to"
                " values"
            )
        found = Document(
            self.source,
            value.place,
            value.content,
            {k: v.place for k, v in value.content.items()},
            within=(self, path or key),
        )
        if (inner := self.table.get(key, _NUMBER).inner) is not None:
            found.declare(inner)
        return found

    def parts(self, key: str, wanted: str = "") -> list[Document]:
        """Return each mapping of a list as a document.

        `finish` of this document finishes them too.

        Parameters
        ----------
        key
            key of the document, whose value is the list
        wanted
            what is accepted, in words, by default made of the declared keys

        Returns
        -------
        list of Document
            one or more

        Raises
        ------
        DocumentError
            for an absent key, an empty list, and an item that is no mapping
        """
        value = self.values[key] if self.has(key) else None
        inner = self.table.get(key, _NUMBER).inner
        if inner is not None and not wanted:
            wanted = f"a list of {key}, each with {inner.in_words()}"
        if value is None:
            raise self.missing(key, wanted)
        if not isinstance(value.content, list) or not value.content:
            raise self.fault(key, str(value), wanted)
        found = [
            self.part(key, child, f"{key}.{i}") for i, child in enumerate(value.content)
        ]
        self.inner += found
        return found

    def finish(self, elsewhere: Callable[[], Collection[str]] = frozenset) -> None:
        """Refuse the keys that no method asked for.

        In a row of a table such a column is a label, unless its name is like a key of
        this document or is one of `elsewhere`.

        Parameters
        ----------
        elsewhere
            returns the keys of other documents, which are no labels; called for a
            column that no method asked for

        Raises
        ------
        DocumentError
            for an unknown key, with the known ones
        """
        for part in self.inner:
            part.finish()
        unread = [key for key in self.keys if key not in self.asked]
        for key in unread:
            if key in self.table and key in self.stated:
                of = f" of kind {self.values['kind']}" if "kind" in self.values else ""
                found = f"{key}{of}, which does not go with the other keys"
                raise self.fault(key, found, f"no {key}")
        self._refuse([key for key in unread if key not in self.table], elsewhere)
        # the other names, which only a fault tells, are more than the document itself
        self.asked &= self.keys.keys()

    def _refuse(
        self, unknown: Sequence[str], elsewhere: Callable[[], Collection[str]]
    ) -> None:
        """Refuse keys that are not known, or keep those of a row of a table as labels.
        Raises DocumentError.
        """
        if not unknown:
            return
        units = {cell.key: cell.unit for cell in self.cells}
        known, here = frozenset({*self.table, *self.asked}), frozenset(self.keys)
        for key in unknown:
            unit = units.get(key, "")
            if (
                not self.cells
                or unit
                or key in elsewhere()
                or not _is_label(key, known, here)
            ):
                raise self._unknown(key, known, unit)
        self._keep_labels(unknown)

    def _unknown(self, key: str, known: frozenset[str], stated: str) -> DocumentError:
        """Return the error for a key that is not one of those known; stated: the unit
        of its column.
        """
        place = self.keys[key]
        base, unit = split_heading(key)
        if unit and self.cells and base in known:
            return DocumentError(
                f"{place}: {base}: found the unit {unit!r} in the heading; expected one"
                f" of {', '.join(FACTORS)}"
            )
        if self.cells and {*_CENTRES}.intersection(_words_of_the_field(key)):
            return DocumentError(
                f"{place}: unknown key {key!r}: the place of a mass centre; expected"
                " kind rigid, whose keys left, right and height state it, or no such"
                " column"
            )
        here = frozenset(self.keys)
        meant = _key_like(key, known, here) if self.cells else ""
        words = (
            f" (did you mean {meant!r}?)"
            if meant
            else did_you_mean(key, sorted(known), MEANT)
        )
        label = f" with the unit {stated}, which no label has" if stated else ""
        words = words or f"; known keys of this kind: {', '.join(sorted(known))}"
        return DocumentError(f"{place}: unknown key {key!r}{label}{words}")

    def _keep_labels(self, keys: Collection[str]) -> None:
        """Move the columns of these keys to the key `labels`, with their texts as they
        are written.
        """
        labels = {
            cell.key: Value(cell.written, cell.place, quoted=True)
            for cell in self.cells
            if cell.key in keys
            or ((item := ITEM.fullmatch(cell.key)) and item[1] in keys)
        }
        self.values = {
            key: value for key, value in self.values.items() if key not in keys
        }
        self.keys = {key: place for key, place in self.keys.items() if key not in keys}
        self.values[LABELS], self.keys[LABELS] = Value(labels, self.place), self.place
        self.label_columns = tuple(labels)
        self.stated = self.stated.difference(keys) | {LABELS}

    def value_at(self, key: str) -> Value | None:
        """Return the value of a key or at a path.

        Parameters
        ----------
        key
            key of the document, or a path such as `ties.0.yield`

        Returns
        -------
        Value or None
            None if there is no value
        """
        head, *path = [key] if key in self.values else key.split(".")
        found = self.values.get(head)
        for name in path:
            found = found.inner(name) if found else None
        return found

    def with_value(self, key: str, text: str, source: str) -> Document:
        """Return a copy with one value replaced or added.

        Parameters
        ----------
        key
            key of the document, or a path such as `ties.0.yield`
        text
            the new value, as a document would state it
        source
            the place of the value in messages

        Returns
        -------
        Document

        Raises
        ------
        DocumentError
            for a path that does not exist
        """
        head, *path = key.split(".")
        new, keys = Value(text, Place(source, 0, 0)), self.keys
        if path and head in self.values:
            key, new = head, self.values[head].with_inner(path, new)
        else:
            keys = {**keys, key: new.place}
        return replace(
            self,
            values={**self.values, key: new},
            keys=keys,
            asked=set(),
            inner=[],
            dimensions={},
            uncertain={},
            table={},
            doubts={},
        )


@lru_cache  # every row of a table asks for those of its columns
def _is_label(heading: str, known: frozenset[str], here: frozenset[str]) -> bool:
    """True for the heading of a column that is like no known key and no word of the
    field; here: the keys of the document.
    """
    return not (
        split_heading(heading)[0] in known
        or _words_of_the_field(heading)
        or _key_like(heading, known, here)
    )


def _key_like(heading: str, asked: frozenset[str], stated: frozenset[str]) -> str:
    """Return the key among those asked for that the heading of a column probably means,
    an empty text for a label; stated: the keys of the document.
    """
    from difflib import get_close_matches

    word = heading.strip().casefold()
    for one in (word, *_words_of_the_field(heading)):
        if MEANT.get(one) in asked:
            return MEANT[one]
    known = sorted(asked)
    begun = [key for key in known if len(word) > 2 and key.startswith(word)]
    named = [
        key
        for key in re.split(r"[^a-z]+", word)
        if key in asked - stated - {"name", "kind"}
    ]
    close = get_close_matches(word, known, n=1, cutoff=0.8)
    return next(iter([*close, *begun, *named]), "")


def _words_of_the_field(heading: str) -> tuple[str, ...]:
    """Return the words in the heading of a column that this field has for keys, which
    no label has.
    """
    words = re.findall(r"[a-z]+", heading.casefold())
    return tuple(
        word
        for word in words
        if (word in MEANT or word in _CENTRES) and (len(words) == 1 or len(word) > 1)
    )
