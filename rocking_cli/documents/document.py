"""Documents as values by key; each error message names file, line, column, key, the
value found and the values accepted.

Scalars keep their text, and `quantities` reads them. This avoids YAML 1.1's own rules,
by which `1e-3` is a string, `010` is eight, `no` is a boolean and `1:30` is ninety.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass, field, replace

from ..errors import DocumentError, did_you_mean
from .composition import Place, Value
from .quantities import (
    FACTORS,
    SMALLEST_LENGTH,
    accepted,
    is_bare,
    parse_quantity,
)
from .table import ITEM, Cell, split_heading, text_of_row

MEANT = {
    "eta": "restitution",
    "e": "restitution",
    "zeta": "damping",
    "g": "gravity",
    "r": "radius",
    "h": "height",
    "b": "width",
    "weight": "mass",
}
LABELS = "labels"  # the key of texts that the computation does not use


@dataclass
class Document:
    """One document: its values by key. Each reading method marks its key as asked for;
    `finish` refuses the other keys.
    """

    source: str  # the file
    place: Place  # where it begins
    values: dict[str, Value]  # by key
    keys: dict[str, Place]  # the place of each key
    index: int = 0  # its number in the file
    text: str = ""  # as the file has it
    asked: set[str] = field(default_factory=set)  # keys that were read
    # the documents in the lists of this one
    inner: list[Document] = field(default_factory=list)
    # of each quantity that was read, by its path, such as `ties.0.height`
    dimensions: dict[str, str] = field(default_factory=dict)
    # lengths [m] that state no unit, by their path
    bare: dict[str, tuple[float, Place]] = field(default_factory=dict)
    # the document around this one, and the path there
    within: tuple[Document, str] | None = None
    cells: tuple[Cell, ...] = ()  # of a row of a table, whose other columns are labels

    def has(self, key: str) -> bool:
        """True if the key has a value that is not null."""
        self.asked.add(key)
        value = self.values.get(key)
        return value is not None and (
            value.quoted or value.word() not in ("", "~", "null")
        )

    def fault(self, key: str | None, found: str, wanted: str) -> DocumentError:
        """Return the error for the value of a key (None: for the document)."""
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
        """Return the error for a required key that is absent or misspelt."""
        from difflib import get_close_matches

        left = [other for other in self.keys if other not in self.asked]
        for other in left:
            if split_heading(other)[0] == key:
                return self._unknown(other)
        for other in get_close_matches(key, left, n=1, cutoff=0.75):
            return DocumentError(
                f"{self.keys[other]}: unknown key {other!r} (did you mean {key!r}?)"
            )
        return DocumentError(f"{self.place}: no key {key!r}; expected {key}: {wanted}")

    def quantity(
        self,
        key: str,
        dimension: str,
        *,
        above: float = -math.inf,
        below: float = math.inf,
        least: float = -math.inf,
        most: float = math.inf,
        where: str = "",
        default: float | None = None,
    ) -> float:
        """Return the SI value of a key, `default` if it is absent; where: the range in
        words. Raises DocumentError.
        """
        self.dimensions[key] = dimension
        if self.within:
            self.within[0].dimensions[f"{self.within[1]}.{key}"] = dimension
        if not self.has(key):
            if default is None:
                raise self.missing(key, accepted(dimension))
            return default
        value = self.values[key]
        if not isinstance(value.content, str):
            raise self.fault(key, str(value), accepted(dimension))
        try:
            number = parse_quantity(value.content, dimension)
        except ValueError as error:
            raise self.fault(key, str(value), str(error)) from None
        if dimension == "length" and is_bare(value.content):
            self.note_bare(key, number, value.place)
        if not (above < number < below and least <= number <= most):
            hint = (
                " (a bare number is in rad)"
                if dimension == "angle" and is_bare(value.content)
                else ""
            )
            raise self.fault(
                key,
                str(value),
                (where or _range_text(above, below, least, most)) + hint,
            )
        return number

    def note_bare(self, path: str, number: float, place: Place) -> None:
        """Note a length [m] without a unit in the outermost document."""
        if self.within is None:
            self.bare[path] = (number, place)
        else:
            self.within[0].note_bare(f"{self.within[1]}.{path}", number, place)

    def length(self, key: str) -> float:
        """Return the value of a key that must be a positive length [m]."""
        return self.quantity(
            key,
            "length",
            least=SMALLEST_LENGTH,
            where=f"a positive length, from {SMALLEST_LENGTH:g} m",
        )

    def choice(
        self, key: str, options: Sequence[str], default: str | None = None
    ) -> str:
        """Return the value of a key, one of the words `options`."""
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
        """Return the value of a key that is true or false; False if it is absent."""
        if not self.has(key):
            return False
        value = self.values[key]
        if value.word() not in ("true", "false"):
            raise self.fault(key, str(value), "true or false")
        return value.word() == "true"

    def integer(self, key: str, least: int, most: int) -> int:
        """Return the value of a key, a whole number from `least` to `most`."""
        wanted = f"a whole number from {least} to {most}"
        number = self.quantity(key, "number", least=least, most=most, where=wanted)
        if number != int(number):
            raise self.fault(key, str(self.values[key]), wanted)
        return int(number)

    def word(self, key: str, default: str) -> str:
        """Return the value of a key, a text of printable characters that
        is not empty.
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
        """Return the SI values of a list of two quantities inside the value of `key`;
        name: the name of the pair.
        """
        if isinstance(value.content, list) and len(value.content) == 2:
            try:
                first, second = (
                    parse_quantity(v.content, dimension)
                    for v in value.content
                    if isinstance(v.content, str)
                )
            except ValueError:
                pass
            else:
                for i, (v, number) in enumerate(
                    zip(value.content, (first, second), strict=True)
                ):
                    if dimension == "length" and is_bare(str(v.content)):
                        self.note_bare(
                            f"{key}.{value.place.line}.{value.place.column}.{i}",
                            number,
                            v.place,
                        )
                return first, second
        raise self.fault(
            key,
            f"a {name} that is not a pair of {dimension}s (line {value.place.line})",
            wanted,
        )

    def part(self, key: str, value: Value, path: str = "") -> Document:
        """Return a mapping inside the value of `key` as a document."""
        if not isinstance(value.content, dict):
            raise DocumentError(
                f"{value.place}: {key}: found {value}; expected a mapping of keys to"
                " values"
            )
        return Document(
            self.source,
            value.place,
            value.content,
            {k: v.place for k, v in value.content.items()},
            within=(self, path or key),
        )

    def parts(self, key: str, wanted: str) -> list[Document]:
        """Return each mapping of a non-empty list as a document; `finish` of this
        document finishes them too.
        """
        value = self.values[key] if self.has(key) else None
        if value is None:
            raise self.missing(key, wanted)
        if not isinstance(value.content, list) or not value.content:
            raise self.fault(key, str(value), wanted)
        found = [
            self.part(key, child, f"{key}.{i}") for i, child in enumerate(value.content)
        ]
        self.inner += found
        return found

    def finish(self, elsewhere: Collection[str] = ()) -> None:
        """Raise DocumentError if the document holds a key that no method asked for. In
        a row of a table such a column is a label, unless its name is like a key of this
        document, or is a key of others; elsewhere: those keys.
        """
        for part in self.inner:
            part.finish()
        unknown = [key for key in self.keys if key not in self.asked]
        for key in unknown:
            if (
                not self.cells
                or key in elsewhere
                or split_heading(key)[0] in self.asked
                or self._meant(key)
            ):
                raise self._unknown(key)
        if unknown:
            self._keep_labels(unknown)

    def _meant(self, heading: str) -> str:
        """Return the key that the heading of a column probably means, an empty text for
        a label.
        """
        from difflib import get_close_matches

        word = heading.strip().casefold()
        if MEANT.get(word) in self.asked:
            return MEANT[word]
        begun = [key for key in self.asked if len(word) > 2 and key.startswith(word)]
        named = [
            key
            for key in re.split(r"[^a-z]+", word)
            if key in self.asked - self.keys.keys() - {"name", "kind"}
        ]
        return next(
            iter(
                [
                    *get_close_matches(word, sorted(self.asked), n=1, cutoff=0.8),
                    *begun,
                    *named,
                ]
            ),
            "",
        )

    def _unknown(self, key: str) -> DocumentError:
        """Return the error for a key that no method asked for."""
        place, known, (base, unit) = (
            self.keys[key],
            sorted(self.asked),
            split_heading(key),
        )
        if unit and self.cells and (base in self.asked or base in self.dimensions):
            return DocumentError(
                f"{place}: {base}: found the unit {unit!r} in the heading; expected one"
                f" of {', '.join(FACTORS)}"
            )
        meant = self._meant(key) if self.cells else ""
        words = (
            f" (did you mean {meant!r}?)" if meant else did_you_mean(key, known, MEANT)
        )
        return DocumentError(
            f"{place}: unknown key {key!r}{words}; known keys of this kind:"
            f" {', '.join(known)}"
        )

    def _keep_labels(self, keys: Collection[str]) -> None:
        """Move the columns of these keys to the key `labels`, with their texts as they
        are written.
        """
        kept, labels = [], {}
        for cell in self.cells:
            if cell.key in keys or (
                (item := ITEM.fullmatch(cell.key)) and item[1] in keys
            ):
                labels[cell.key] = Value(cell.written, cell.place, quoted=True)
            else:
                kept.append(cell)
        self.values = {
            key: value for key, value in self.values.items() if key not in keys
        }
        self.keys = {key: place for key, place in self.keys.items() if key not in keys}
        self.values[LABELS], self.keys[LABELS] = Value(labels, self.place), self.place
        texts = {name: label.content for name, label in labels.items()}
        self.cells = ()
        self.text = f"{text_of_row(kept)}\n{LABELS}: {json.dumps(texts)}"

    def value_at(self, key: str) -> Value | None:
        """Return the value of a key, or at a path such as `ties.0.yield`; None without
        it.
        """
        head, *path = [key] if key in self.values else key.split(".")
        found = self.values.get(head)
        for name in path:
            found = found.inner(name) if found else None
        return found

    def with_value(self, key: str, text: str, source: str) -> Document:
        """Return a copy with the value of a key, or at a path such as `ties.0.yield`,
        replaced or added; source: its place in errors.
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
            bare={},
        )


def _range_text(above: float, below: float, least: float, most: float) -> str:
    """Return the limits of a value in words."""
    low = (
        f"above {above:g}"
        if above > -math.inf
        else f"at least {least:g}"
        if least > -math.inf
        else ""
    )
    high = (
        f"below {below:g}"
        if below < math.inf
        else f"at most {most:g}"
        if most < math.inf
        else ""
    )
    return "a value " + " and ".join(x for x in (low, high) if x)
