"""A commented example document of each kind, from the configs that are shipped with the package."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

from ..errors import UsageError


def template(kind: str) -> str:
    """The text of the example document of a kind. Raises UsageError if there is none."""
    name = f"{kind}.yaml"
    inside, beside = files("rocking_cli") / "configs" / name, Path(__file__).resolve().parents[2] / "configs" / name
    for place in (inside, beside):
        if place.is_file():
            return place.read_text(encoding="utf-8")
    raise UsageError(f"no commented document of kind {kind} came with this installation")
