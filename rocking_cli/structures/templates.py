"""A commented example document of each kind, from the configs that are shipped with the
package.
"""

from importlib.resources import files
from pathlib import Path

from ..errors import UsageError
from .kinds import KINDS

# The kinds, and shapes of a kind with a document of their own.
TEMPLATES = (*KINDS, "wall_between_floors")


def template(kind: str) -> str:
    """Return the text of the commented example document of a kind.

    Parameters
    ----------
    kind
        such as "block", "arch" or "stack", or "wall_between_floors"

    Returns
    -------
    str
        a YAML document

    Raises
    ------
    UsageError
        if there is none of this kind

    Examples
    --------
    >>> build_structure(parse_documents(template("block"))[0]).structure
    'block'
    """
    if kind in TEMPLATES and (place := shipped(f"{kind}.yaml")):
        return place.read_text(encoding="utf-8")
    raise UsageError(f"this installation has no commented document of kind {kind}")


def shipped(name: str | Path) -> Path | None:
    """Return the path of a file or folder in the shipped folder `configs`; None if
    there is none.
    """
    places = (
        Path(str(folder)) / "configs" / name
        for folder in (files("rocking_cli"), Path(__file__).resolve().parents[2])
    )
    return next(filter(Path.exists, places), None)
