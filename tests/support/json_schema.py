"""The part of JSON Schema, draft 7, that the schema of documents uses."""

import re

TYPES = {
    "object": dict,
    "array": list,
    "string": str,
    "boolean": bool,
    "null": type(None),
}


def faults(schema, value, root=None, path=""):
    """Yield (path, keyword) of each fault of a value."""
    root = schema if root is None else root
    if "$ref" in schema:
        definition = schema["$ref"].removeprefix("#/definitions/")
        yield from faults(root["definitions"][definition], value, root, path)
        return
    for keyword, check in CHECKS.items():
        if keyword in schema and not check(schema[keyword], value):
            yield path, keyword
    for one in schema.get("allOf", ()):
        yield from faults(one, value, root, path)
    if "anyOf" in schema and all(
        any(faults(one, value, root, path)) for one in schema["anyOf"]
    ):
        yield path, "anyOf"
    if "if" in schema:
        holds = not any(faults(schema["if"], value, root, path))
        yield from faults(
            schema.get("then" if holds else "else", {}), value, root, path
        )
    if isinstance(value, dict):
        for key, one in value.items():
            if key in schema.get("properties", ()):
                yield from faults(schema["properties"][key], one, root, f"{path}.{key}")
                continue
            more = schema.get("additionalProperties", True)
            if not more:
                yield f"{path}.{key}", "additionalProperties"
            elif more is not True:
                yield from faults(more, one, root, f"{path}.{key}")
    if isinstance(value, list) and "items" in schema:
        for i, one in enumerate(value):
            yield from faults(schema["items"], one, root, f"{path}.{i}")


def _is_number(value):
    return isinstance(value, int | float) and not isinstance(value, bool)


def _has_type(types, value):
    types = [types] if isinstance(types, str) else types
    return any(
        _is_number(value) if one == "number" else isinstance(value, TYPES[one])
        for one in types
    )


CHECKS = {
    "type": _has_type,
    "enum": lambda words, value: value in words,
    "const": lambda word, value: value == word,
    "required": lambda keys, value: (
        not isinstance(value, dict) or set(keys) <= set(value)
    ),
    "pattern": lambda pattern, value: (
        not isinstance(value, str) or bool(re.search(pattern, value))
    ),
    "minimum": lambda least, value: not _is_number(value) or value >= least,
    "maximum": lambda most, value: not _is_number(value) or value <= most,
    "exclusiveMinimum": lambda least, value: not _is_number(value) or value > least,
    "exclusiveMaximum": lambda most, value: not _is_number(value) or value < most,
    "multipleOf": lambda unit, value: not _is_number(value) or value % unit == 0,
    "minItems": lambda least, value: not isinstance(value, list) or len(value) >= least,
    "maxItems": lambda most, value: not isinstance(value, list) or len(value) <= most,
}
