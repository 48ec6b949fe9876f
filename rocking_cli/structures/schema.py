"""A JSON Schema of structure documents, made of the tables of keys of the kinds."""

from __future__ import annotations

import json
import math
import re
from typing import Any

from ..documents.keys import Key, Keys
from ..documents.quantities import UNITS, accepted
from ..plugins import installed
from .kinds import GROUP, KINDS, keys_of, own_keys

Schema = dict[str, Any]
DRAFT = "http://json-schema.org/draft-07/schema#"
_NUMBER = r"[+-]?([0-9]+(\.[0-9]*)?|\.[0-9]+)([eE][+-]?[0-9]+)?"
_NAME = {"type": ["string", "number", "boolean"]}  # it may look like a number
_MAPPING = {"type": "object"}


def schema_text() -> str:
    """Return the JSON Schema (draft 7) of one structure document of any kind as a text;
    documents of installed packages without a table of keys may have any keys.
    """
    words = [*KINDS, *(word for word in installed(GROUP) if word not in KINDS)]
    tables = {word: keys_of(word) for word in words}
    tables["parameters"] = keys_of("parameters", *words)
    schema = {
        "$schema": DRAFT,
        "title": "Structure document of rocking",
        **_MAPPING,
        "required": ["kind"],
        "properties": {"kind": {"enum": words}},
        "allOf": [
            {
                "if": {"properties": {"kind": {"const": word}}, "required": ["kind"]},
                "then": {"$ref": f"#/definitions/{word}"},
            }
            for word, keys in tables.items()
            if own_keys(word).all
        ],
        "definitions": {
            **{dimension: _quantity(dimension) for dimension in UNITS},
            **{
                word: _mapping(keys)
                for word, keys in tables.items()
                if own_keys(word).all
            },
        },
    }
    return json.dumps(schema, indent=1, ensure_ascii=False)


def _quantity(dimension: str) -> Schema:
    """Return the schema of a number, a number with a unit, or one with a spread."""
    units = "|".join(
        re.sub(r"[\^$.*+?()\[\]{}|/\\]", r"\\\g<0>", u) for u in UNITS[dimension]
    )
    one = rf"\s*{_NUMBER}\s*({units})?\s*" if units else rf"\s*{_NUMBER}\s*"
    normal = rf"{one}(\+-|±)({one}|\s*{_NUMBER}\s*%\s*)"
    return {
        "type": ["number", "string", "null"],
        "pattern": rf"^({one}|{normal}|{one}\.\.{one})$",
        "patternErrorMessage": f"expected {accepted(dimension)}; a spread is MEAN +- SD"
        " or LOW .. HIGH",
    }


def _mapping(keys: Keys) -> Schema:
    """Return the schema of a document, or of a mapping inside it."""
    found: Schema = {
        **_MAPPING,
        "properties": {
            name: ({"description": key.doc} if key.doc else {}) | _of(key)
            for name, key in keys.all.items()
        },
        "additionalProperties": False,
        "required": list(keys.required),
    }
    ways = [[{"required": list(way.required)} for way in group] for group in keys.ways]
    return found | {"allOf": [{"anyOf": group} for group in ways]}


def _of(key: Key) -> Schema:
    """Return the schema of the values of a key."""
    inner = _mapping(key.inner) if key.inner else {}
    pair = {
        "type": "array",
        "items": {"$ref": f"#/definitions/{key.of}"},
        "minItems": 2,
        "maxItems": 2,
    }
    forms: dict[str, Schema] = {
        "choice": {"enum": [*key.words, None]},
        "flag": {"type": ["boolean", "null"]},
        "whole": {
            "type": ["number", "string", "null"],
            "pattern": "^[0-9]+$",
            "multipleOf": 1,
        },
        "text": {"type": [*_NAME["type"], "null"]},
        "name": _NAME,
        "names": {"type": "array", "items": _NAME, "minItems": 1},
        "pair": pair,
        "pairs": {"type": "array", "items": pair, "minItems": 3},
        "part": inner,
        "parts": {"type": ["array", "null"], "items": inner},
        "named": {**_MAPPING, "additionalProperties": inner},
    }
    found = forms.get(key.form, {})
    if key.form in UNITS:
        found = {"allOf": [{"$ref": f"#/definitions/{key.form}"}]}
    limits = {
        "exclusiveMinimum": key.above,
        "minimum": key.least,
        "exclusiveMaximum": key.below,
        "maximum": key.most,
    }
    found |= {word: end for word, end in limits.items() if math.isfinite(end)}
    if key.form in UNITS and inner:  # a mapping in place of the number
        found = {"if": _MAPPING, "then": inner, "else": found}
    if key.words and key.form != "choice":  # a word in place of the value
        found = {"if": {"enum": [*key.words]}, "else": found}
    return found
