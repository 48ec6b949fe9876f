"""Documents that record what a reader asks of them: keys, dimensions, ranges, words."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from ..errors import DocumentError
from .composition import Place, Value
from .document import Document

# stand for the first two names that a reader accepts, in any document
NAMES = ("<first name>", "<second name>")
Plain = str | list["Plain"] | dict[str, "Plain"]


class Question(NamedTuple):
    """What a reader asks of one key."""

    # quantity, integer, choice, flag, word; pair: of quantities, pairs: a list of them;
    # name, names: of other parts of the document; part: a mapping, parts: a list of
    # mappings, named: a mapping of names to mappings
    form: str
    dimension: str = ""  # of quantities and pairs
    words: tuple[str, ...] = ()  # the options of a choice
    least: float = -math.inf  # least value [SI]
    most: float = math.inf  # largest value [SI]
    open_low: bool = False  # True if the least value itself is refused
    open_high: bool = False  # True if the largest value itself is refused


@dataclass
class Questions:
    """What readers asked, by path: `pieces.*.width` of the items of a list or of a
    mapping of names.
    """

    asked: dict[str, list[Question]] = field(default_factory=dict)  # what, by path
    known: dict[str, None] = field(default_factory=dict)  # every path, in order
    seen: dict[str, None] = field(default_factory=dict)  # paths of the last reading
    missing: str = ""  # path of the required key that the last reading lacked
    # path of the key whose value, or of the mapping that, the last reading refused
    faulty: str = ""

    def begin(self) -> None:
        """Begin a reading."""
        self.seen, self.missing, self.faulty = {}, "", ""

    def mark(self, path: str) -> None:
        """Record that a path was asked for."""
        self.known[path] = self.seen[path] = None

    def note(self, path: str, asked: Question) -> None:
        """Record what was asked at a path."""
        self.mark(path)
        found = self.asked.setdefault(path, [])
        if asked not in found:
            found.append(asked)


@dataclass
class AskedDocument(Document):
    """A document that records into a log what a reader asks of it."""

    log: Questions = field(default_factory=Questions)
    begin: str = ""  # of the paths of its keys, such as `pieces.*.`

    @classmethod
    def of(cls, plain: dict[str, Plain], log: Questions) -> AskedDocument:
        """Return the document with these values, as texts without quotes."""
        place = Place("<schema>", 1, 1)
        values = _value(plain, place).content
        assert isinstance(values, dict)
        return cls("<schema>", place, values, dict.fromkeys(values, place), log=log)

    def _note(self, key: str, form: str, *more: Any) -> None:
        self.log.note(self.begin + key, Question(form, *more))

    def has(self, key: str) -> bool:
        self.log.mark(self.begin + key)
        return super().has(key)

    def missing(self, key: str, wanted: str) -> DocumentError:
        self.log.missing = self.begin + key
        return super().missing(key, wanted)

    def fault(self, key: str | None, found: str, wanted: str) -> DocumentError:
        self.log.faulty = self.begin.rstrip(".*") if key is None else self.begin + key
        return super().fault(key, found, wanted)

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
        low, high = max(above, least), min(below, most)
        ends = (low > least, high < most)
        self._note(key, "quantity", dimension, (), low, high, *ends)
        return super().quantity(
            key,
            dimension,
            above=above,
            below=below,
            least=least,
            most=most,
            where=where,
            default=default,
        )

    def choice(
        self, key: str, options: Sequence[str], default: str | None = None
    ) -> str:
        self._note(key, "choice", "", tuple(options))
        return super().choice(key, options, default)

    def flag(self, key: str) -> bool:
        self._note(key, "flag")
        return super().flag(key)

    def integer(self, key: str, least: int, most: int) -> int:
        self._note(key, "integer", "number", (), float(least), float(most))
        return super().integer(key, least, most)

    def word(self, key: str, default: str) -> str:
        self._note(key, "word")
        return super().word(key, default)

    def pair(
        self, key: str, value: Value, dimension: str, name: str, wanted: str
    ) -> tuple[float, float]:
        self._note(key, "pair" if value is self.values[key] else "pairs", dimension)
        return super().pair(key, value, dimension, name, wanted)

    def reference(self, key: str, value: Value, names: Sequence[str], what: str) -> str:
        self._note(key, "name" if value is self.values[key] else "names")
        if value.content in NAMES:
            return names[min(NAMES.index(value.content), len(names) - 1)]
        return super().reference(key, value, names, what)

    def part(self, key: str, value: Value, path: str = "") -> Document:
        form = "part"
        if value is not self.values[key]:
            listed = isinstance(self.values[key].content, list)
            form = "parts" if listed else "named"
        self._note(key, form)
        found = super().part(key, value, path)
        begin = f"{self.begin}{key}.{'' if form == 'part' else '*.'}"
        return AskedDocument(
            found.source,
            found.place,
            found.values,
            found.keys,
            within=found.within,
            log=self.log,
            begin=begin,
        )

    def parts(self, key: str, wanted: str) -> list[Document]:
        self._note(key, "parts")
        return super().parts(key, wanted)


def plain_of(value: Value) -> Plain:
    """Return the texts of a value, without places."""
    if isinstance(value.content, list):
        return [plain_of(one) for one in value.content]
    if isinstance(value.content, dict):
        return {key: plain_of(one) for key, one in value.content.items()}
    return value.content


def _value(plain: Plain, place: Place) -> Value:
    """Return the value of these texts."""
    if isinstance(plain, list):
        return Value([_value(one, place) for one in plain], place)
    if isinstance(plain, dict):
        return Value({key: _value(one, place) for key, one in plain.items()}, place)
    return Value(plain, place)
