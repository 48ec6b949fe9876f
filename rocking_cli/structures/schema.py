"""A JSON Schema of structure documents, made of what the readers of the kinds ask.

Each kind reads documents that record every question: the shipped ones, and probes that
state one more key, or one key alone. The keys that a reader asks for are those that it
accepts, so the schema needs no list of keys of its own.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterable, Iterator, Sequence
from copy import deepcopy
from functools import cache
from importlib.resources import files
from itertools import combinations, pairwise
from pathlib import Path
from typing import Any, cast

from ..documents.asking import (
    NAMES,
    AskedDocument,
    Plain,
    Question,
    Questions,
    plain_of,
)
from ..documents.parsing import documents_in
from ..documents.quantities import SMALLEST_LENGTH, UNITS, accepted
from ..errors import RockingError
from ..plugins import installed
from .kinds import GROUP, KINDS, reports_of
from .parameters import OTHERS, VARIED
from .templates import shipped

Node = dict[str, Plain]
Schema = dict[str, Any]

DRAFT = "http://json-schema.org/draft-07/schema#"
AUTO = "auto"  # the word in place of some quantities
_MIRRORED = "mirrored"  # the word in place of some lists
_ANY_NAME = "any_name_at_all"  # a key that only an open mapping takes
_PLAIN = ("quantity", "integer", "choice", "flag", "word", "pair", "name")
_PARTS = ("part", "parts", "named")  # forms with keys of their own
_TEXT = {"type": ["string", "number", "boolean"]}  # a name, which may look like another
_MOST_MISSING = 12  # required keys that are added to a probe
_NUMBER = r"[+-]?([0-9]+(\.[0-9]*)?|\.[0-9]+)([eE][+-]?[0-9]+)?"
_ABSOLUTE = (-1.0, 0.0, 1.0, SMALLEST_LENGTH, 0.5 * math.pi, math.pi, 2.0 * math.pi)
_SPREADS = "MEAN +- SD or LOW .. HIGH"
_SYNTAX = re.compile(r"[\^$.*+?()\[\]{}|/\\]")  # what a pattern must escape
_PROBES: dict[str, tuple[str, str]] = {  # two values of each dimension
    "length": ("1.3", "2.7"),
    "angle": ("0.2", "0.3"),
    "number": ("0.5", "0.7"),
}
_COMMENTED = re.compile(r"[ #-]*([a-z_]+):[^#]*#\s*(.+)")


def document_schema() -> Schema:
    """Return a JSON Schema (draft 7) of one structure document of any kind."""
    readings = {word: _KindReading(word) for word in KINDS}
    asked = {key: None for one in readings.values() for key in one.log.known}
    others = sorted(key for key in asked if "." not in key)
    reported = {key: None for word in KINDS for key in reports_of(word)}
    for reading in readings.values():
        reading.probe([*others, *reported, OTHERS, *VARIED])
    return {
        "$schema": DRAFT,
        "title": "Structure document of rocking",
        "type": "object",
        "required": ["kind"],
        "properties": {"kind": {"enum": list(KINDS)}},
        "allOf": [
            {
                "if": {"properties": {"kind": {"const": word}}, "required": ["kind"]},
                "then": {"$ref": f"#/definitions/{word}"},
            }
            for word in KINDS
        ],
        "definitions": {
            **{dimension: _quantity(dimension) for dimension in UNITS},
            **{word: reading.schema() for word, reading in readings.items()},
        },
    }


def made_text() -> str:
    """Return the text of `schema.json`, which `make schema` writes: making it takes
    many seconds.
    """
    return json.dumps(document_schema(), separators=(",", ":"), ensure_ascii=False)


def schema_text() -> str:
    """Return the JSON Schema of structure documents as a text; it names the kinds of
    installed packages, whose keys it does not know.
    """
    text = (files(__package__) / "schema.json").read_text(encoding="utf-8")
    schema = json.loads(text)
    own = [word for word in installed(GROUP) if word not in KINDS]
    schema["properties"]["kind"]["enum"] += own
    return json.dumps(schema, indent=1, ensure_ascii=False)


def _quantity(dimension: str, word: str = "") -> Schema:
    """Return the schema of a number, a number with a unit, or one with a spread; word:
    a text that may stand in its place.
    """
    units = "|".join(_SYNTAX.sub(r"\\\g<0>", unit) for unit in UNITS[dimension])
    one = rf"\s*{_NUMBER}\s*({units})?\s*" if units else rf"\s*{_NUMBER}\s*"
    normal = rf"{one}(\+-|±)({one}|\s*{_NUMBER}\s*%\s*)"
    begin = f"{word}|" if word else ""
    expected = f"{accepted(dimension)}{f', or {word}' if word else ''}"
    return {
        "type": ["number", "string", "null"],
        "pattern": rf"^({begin}{one}|{normal}|{one}\.\.{one})$",
        "patternErrorMessage": f"expected {expected}; a spread is {_SPREADS}",
    }


@cache
def _shipped_documents() -> tuple[tuple[str, Node], ...]:
    """Return (text of the file, values) of each shipped document."""
    home = shipped("block.yaml")
    found = []
    for path in sorted(Path(home).parent.glob("*.yaml")) if home else []:
        text = path.read_text(encoding="utf-8")
        for document in documents_in(path):
            plain = {key: plain_of(value) for key, value in document.values.items()}
            found.append((text, plain))
    return tuple(found)


def _descriptions() -> dict[tuple[str, str], str]:
    """Return the comments of the shipped documents by (kind, key)."""
    found: dict[tuple[str, str], str] = {}
    for text, plain in _shipped_documents():
        for line in text.splitlines():
            if match := _COMMENTED.match(line):
                found.setdefault((str(plain["kind"]), match[1]), match[2].rstrip(" ,"))
    return found


class _KindReading:
    """What the reader of one kind asks, over many documents."""

    def __init__(self, word: str) -> None:
        self.word = word
        self.log = Questions()
        self.needs: dict[str, list[frozenset[str]]] = {}  # required keys, by mapping
        self.taken: dict[str, None] = {}  # paths that a valid document may have
        # (valid, missing, faulty) of each document that was read, by its text
        self.read: dict[str, tuple[bool, str, str]] = {}
        self.whole = list(self._whole())  # valid documents
        for node in (*self.whole, self._alone()):
            self._read(node)
        self.probed = {"kind"}  # paths
        self._probe_asked()

    def _alone(self) -> Node:
        """Return the document that states its kind alone."""
        return {"kind": self.word}

    def _whole(self) -> Iterator[Node]:
        """Yield valid documents: the shipped ones, and of `parameters` what the other
        kinds print.
        """
        for _, plain in _shipped_documents():
            if plain["kind"] == self.word:
                yield plain
            elif self.word == "parameters":
                from . import build_structure

                row = build_structure(AskedDocument.of(plain, Questions())).row()
                yield cast(Node, _texts(row))

    def _read(self, node: Node) -> bool:
        """Read a document; True if it is valid."""
        from . import build_structure

        text = json.dumps(node, sort_keys=True)
        if text in self.read:
            valid, self.log.missing, self.log.faulty = self.read[text]
            return valid
        self.log.begin()
        valid = True
        try:
            build_structure(AskedDocument.of(node, self.log))
        except RockingError:
            valid = False
        if valid:
            self.taken |= self.log.seen
        elif not (self.log.missing or self.log.faulty):
            # its mappings were read, and do not make a structure together
            self.taken |= {path: None for path in self.log.seen if "." in path}
        self.read[text] = (valid, self.log.missing, self.log.faulty)
        return valid

    # Probes ---------------------------------------------------------------------------

    def _probe_asked(self) -> None:
        """Probe each key that is asked for, until no reading asks for another one."""
        while left := [path for path in self.log.known if path not in self.probed]:
            for path in left:
                self.probed.add(path)
                self._probe(path)

    def probe(self, others: Sequence[str]) -> None:
        """Probe what is asked for, the keys of other kinds that this kind refuses in
        its own words, and keys together.
        """
        while left := self._refused(key for key in others if key not in self.probed):
            for path in left:
                self.probed.add(path)
                self._probe(path)
            self._probe_asked()
        unread = [key for key in self._keys("") if not self._form(key)]
        for one, other in combinations(unread, 2):  # keys that go together
            node = self._with(self._with(self._alone(), one), other, "2")
            self._complete(node, one)
        for path in list(self.log.known):
            if self._form(path) in _PARTS:
                inside = f"{self._inside(path)}.{_ANY_NAME}"
                self._read(self._with(self._base(), inside))

    def _refused(self, keys: Iterable[str]) -> list[str]:
        """Return those of keys that are not known about which a reader complains."""
        found: list[str] = []
        unknown = [key for key in keys if key not in self.log.known]
        node = self._base() | dict.fromkeys(unknown, "1")
        while True:
            self._read(node)
            if (key := self.log.faulty) not in unknown:
                return found
            found.append(key)
            unknown.remove(key)
            del node[key]

    def _base(self) -> Node:
        return deepcopy(self.whole[0]) if self.whole else self._alone()

    def _bases(self) -> Iterator[Node]:
        """Yield two valid documents, and the first one with each flag, without the key
        that does not go with it.
        """
        yield from self.whole[:2]
        for path in list(self.log.asked):
            if "." not in path and self._form(path) == "flag":
                node = self._with(self._base(), path, "true")
                if not self._read(node) and self.log.faulty != path:
                    node.pop(self.log.faulty, None)
                yield node

    def _probe(self, path: str) -> None:
        """Read documents that state this key, alone and in a valid document."""
        inside, _, key = path.rpartition(".")
        self._read(self._with(self._base(), path))
        if path not in self.log.known:  # no key of this kind
            return
        self._read(self._with(self._base(), path, {}))
        nodes = [self._alone(), *self._bases()]
        if inside:
            nodes.append(self._base())
            self._empty(nodes[-1], inside)
        # two numbers tell apart the limits that depend on others
        for number, node in enumerate(nodes):
            for value in self._values(path, number % 2):
                self._complete(self._with(deepcopy(node), path, value), path)
        if key in self._keys(inside):
            self._note_needs(inside, key)

    def _values(self, path: str, number: int) -> list[Plain]:
        """Return values to try at a path: one if its form is known."""
        for asked in self.log.asked.get(path, ()):
            if asked.form == "integer":
                return [f"{asked.least + 2 * number:g}"]
            if asked.form == "quantity":
                return [_PROBES.get(asked.dimension, ("1", "2"))[number]]
            if asked.form == "choice":
                return list(asked.words)
            if asked.form in ("flag", "word"):
                return ["true"]
            if asked.form == "pair":
                return [["0", "1"]]
            if asked.form == "pairs":
                return [[["0", "0"], ["1", "0"], ["1", "4"]]]
            if asked.form == "name":
                return [NAMES[0]]
            if asked.form == "names":
                return [list(NAMES)]
        return [str(number + 1), [{}], {}, [{}, {}]]

    def _complete(self, node: Node, path: str) -> set[str]:
        """Read a document again and again with what it lacks; return these keys."""
        added: set[str] = set()
        for _ in range(_MOST_MISSING):
            self._read(node)
            lacking = self.log.missing
            if not lacking or lacking in added:
                return added
            added.add(lacking)
            self._with(node, lacking, self._values(lacking, len(added) % 2)[0])
        return added

    def _with(self, node: Node, path: str, value: Plain = "1") -> Node:
        """Put a value at a path into a document, with the mappings on its way."""
        at: Any = node
        *way, key = path.split(".")
        for name, following in pairwise([*way, key]):
            if name == "*":
                continue
            if following == "*":
                at = _first_item(at, name, self._form(name) == "named")
            else:
                at[name] = at[name] if isinstance(at.get(name), dict) else {}
                at = at[name]
        at[key] = value
        return node

    def _note_needs(self, inside: str, key: str) -> None:
        """Note the keys that a mapping needs beside this one, or without it."""
        begin = f"{inside}." if inside else ""
        others = self._keys(inside) if inside else []
        for given in ((), (key,), *((key, one) for one in others if one != key)):
            node = self._base() if inside else self._alone()
            if inside:
                self._empty(node, inside)
            for name in given:
                first = begin + name
                self._with(node, first, self._values(first, 1)[0])
            added = self._complete(node, begin + key)
            tried = {*added, *(begin + name for name in given)}
            faulty, whole = self.log.faulty, inside.removesuffix(".*")
            refused = faulty in tried and self._form(faulty) in _PLAIN
            if not (refused or (whole and faulty == whole)):
                own = {
                    path.removeprefix(begin) for path in added if path.startswith(begin)
                }
                needs = frozenset({*given, *(name for name in own if "." not in name)})
                found = self.needs.setdefault(inside, [])
                if needs not in found:
                    found.append(needs)

    def _empty(self, node: Node, inside: str) -> None:
        """Make the mapping at a path empty."""
        self._with(node, f"{inside}.{_ANY_NAME}")
        at: Any = node
        for name in inside.split("."):
            items = iter(at.values() if isinstance(at, dict) else at)
            at = next(items) if name == "*" else at[name]
        at.clear()

    # The schema -----------------------------------------------------------------------

    def _form(self, path: str) -> str:
        """Return what is asked at a path: its form with keys of its own, if it has one,
        else the first one.
        """
        forms = [asked.form for asked in self.log.asked.get(path, ())]
        return next((form for form in forms if form in _PARTS), *forms[:1] or ("",))

    def _inside(self, path: str) -> str:
        """Return the path of the mapping, or of the mappings, of a key."""
        return path if self._form(path) == "part" else f"{path}.*"

    def _keys(self, inside: str) -> list[str]:
        """Return the keys that a mapping takes."""
        begin = f"{inside}." if inside else ""
        return [
            path.removeprefix(begin)
            for path in self.taken
            if path.startswith(begin) and "." not in path.removeprefix(begin)
        ]

    def schema(self) -> Schema:
        """Return the schema of a document of this kind."""
        return self._mapping("", {"kind": {"const": self.word}})

    def _mapping(self, inside: str, more: Schema) -> Schema:
        """Return the schema of the document, or of a mapping inside it."""
        keys = [key for key in self._keys(inside) if key not in (*more, _ANY_NAME)]
        begin = f"{inside}." if inside else ""
        found: Schema = {
            "type": "object",
            "properties": {**more, **{key: self._of(begin + key) for key in keys}},
        }
        if begin + _ANY_NAME not in self.taken:
            found["additionalProperties"] = False
        needs = self.needs.get(inside, [])
        least = [one for one in needs if not any(other < one for other in needs)]
        if len(least) == 1 and least[0]:
            found["required"] = sorted(least[0])
        elif least and frozenset() not in least:
            found["anyOf"] = [{"required": sorted(one)} for one in least]
        return found

    def _of(self, path: str) -> Schema:
        """Return the schema of a key."""
        comment = _descriptions().get((self.word, path), "")
        found = self._form_schema(path)
        if comment:
            found = {"description": comment, **found}
        return found

    def _form_schema(self, path: str) -> Schema:
        """Return the schema of the values of a key, without its description."""
        asked: dict[str, list[Question]] = {}
        for one in self.log.asked.get(path, ()):
            asked.setdefault(one.form, []).append(one)
        if "integer" in asked:
            return self._integer_schema(asked["integer"])
        found = [self._one_form(path, form, same) for form, same in asked.items()]
        if self._takes(path, _MIRRORED) and asked.keys() & {"parts"}:
            found.append({"enum": [_MIRRORED, None]})
        return _by_type(found) if found else {}  # {}: asked for in another way

    def _one_form(self, path: str, form: str, asked: list[Question]) -> Schema:
        """Return the schema of the values of a key in one of its forms."""
        if form == "quantity":
            return self._quantity_schema(path, asked)
        if form == "choice":
            words = dict.fromkeys(word for one in asked for word in one.words)
            return {"enum": [*words, None]}
        if form == "flag":
            return {"type": ["boolean", "null"]}
        if form == "word":
            return {"type": [*_TEXT["type"], "null"]}
        if form in ("pair", "pairs"):
            one = {"$ref": f"#/definitions/{asked[0].dimension}"}
            pair = {"type": "array", "items": one, "minItems": 2, "maxItems": 2}
            several = {"type": "array", "items": pair, "minItems": 1}
            return pair if form == "pair" else several
        if form == "name":
            return {"type": [*_TEXT["type"], "null"]}
        if form == "names":
            return {"type": "array", "items": _TEXT, "minItems": 1}
        found = inside = self._mapping(self._inside(path), {})
        if form == "named":
            found = {"type": "object", "additionalProperties": inside}
        if form == "parts":
            least = 0 if self._takes(path, []) else 1
            found = {"type": "array", "items": inside, "minItems": least}
        if self._takes(path, ""):
            found["type"] = [found["type"], "null"]
        return found

    def _integer_schema(self, asked: list[Question]) -> Schema:
        """Return the schema of a whole number."""
        one = next(one for one in asked if one.form == "integer")
        whole = {"multipleOf": 1, "minimum": one.least}
        return {"type": ["number", "string", "null"], "pattern": "^[0-9]+$", **whole}

    def _quantity_schema(self, path: str, asked: list[Question]) -> Schema:
        """Return the schema of a quantity, without the limits that depend on the other
        numbers of a document.
        """
        dimension = asked[0].dimension
        found: Schema = {"allOf": [{"$ref": f"#/definitions/{dimension}"}]}
        lows = {(one.least, one.open_low) for one in asked}
        highs = {(one.most, one.open_high) for one in asked}
        for ends, word in ((lows, "inimum"), (highs, "aximum")):
            ((end, is_open),) = ends if len(ends) == 1 else ((math.inf, False),)
            if end in _ABSOLUTE:
                key = f"exclusiveM{word}" if is_open else f"m{word}"
                found[key] = end
        if self._takes(path, AUTO):
            found["allOf"] = [_quantity(dimension, AUTO)]
        return found

    def _takes(self, path: str, value: Plain) -> bool:
        """True if a valid document stays valid with this value at a path."""
        return "." not in path and any(
            self._read({**node, path: value}) for node in self.whole
        )


def _by_type(forms: list[Schema]) -> Schema:
    """Return the schema of values in one of these forms. A mapping or a list is held
    against its own form, so that a fault inside it is told at its key.
    """
    if len(forms) == 1:
        return forms[0]
    held = [one for one in forms if "properties" in one or "items" in one]
    plain = [one for one in forms if one not in held]
    if len(held) != 1:
        return {"anyOf": forms}
    return {
        "if": {"type": held[0]["type"]},
        "then": held[0],
        "else": plain[0] if len(plain) == 1 else {"anyOf": plain},
    }


def _first_item(at: Any, key: str, named: bool) -> Any:
    """Return the first mapping in the list, or in the mapping of names, of a key; it is
    put there if there is none.
    """
    given = at.get(key)
    if named:
        names = given if isinstance(given, dict) and given else {_ANY_NAME: {}}
        at[key] = {
            name: one if isinstance(one, dict) else {} for name, one in names.items()
        }
        return next(iter(at[key].values()))
    items = given if isinstance(given, list) and given else [{}]
    at[key] = [one if isinstance(one, dict) else {} for one in items]
    return at[key][0]


def _texts(value: Any) -> Plain:
    """Return a row as the texts of a document."""
    if isinstance(value, dict):
        return {key: _texts(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [_texts(one) for one in value]
    return (
        ""
        if value is None
        else str(value).lower()
        if value in (True, False)
        else str(value)
    )
