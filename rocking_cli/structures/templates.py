"""A commented example document of each kind, from the configs that are shipped with the package."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

from ..errors import UsageError


def template(kind: str) -> str:
    """The text of the example document of a kind. Raises UsageError if there is none.

    >>> build_structure(parse_documents(template('block'))[0]).structure
    'block'
    """
    for folder in (files("rocking_cli"), Path(__file__).resolve().parents[2]):
        place = folder / "configs" / f"{kind}.yaml"
        if place.is_file():
            return place.read_text(encoding="utf-8")
    raise UsageError(f"this installation has no commented document of kind {kind}")
