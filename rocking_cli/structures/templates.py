"""A commented example document of each kind: a document of the configs that are shipped
with the package, with what the table of keys says of each key; and the lists of keys.
"""

import re
import textwrap
from collections.abc import Iterator, Mapping
from importlib.resources import files
from pathlib import Path

from ..documents.keys import Key
from ..errors import UsageError
from .kinds import KINDS, keys_of, own_keys
from .shared_keys import RIGID, SHARED

_LINE = re.compile(r"(?:# )?([a-z_]+):[^#]*")  # of a key, which may be a comment
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
        a YAML document; the keys that it does not state follow as comments

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
        text = place.read_text(encoding="utf-8")
        (word,) = re.findall(r"^kind: (.*)$", text, re.MULTILINE)
        return "\n".join([*_commented(text.splitlines(), keys_of(word).all), ""])
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


def _commented(lines: list[str], keys: Mapping[str, Key]) -> Iterator[str]:
    """Yield the lines of a document, each key with what it is, and then the other
    keys.
    """
    left = {name: key for name, key in keys.items() if name not in ("kind", "name")}
    for line in lines:
        key = left.pop(match[1], None) if (match := _LINE.fullmatch(line)) else None
        yield f"{line:<19} # {key.told()}" if key and key.doc else line
        for name in re.findall(r"^(?:# )?([a-z_]+):", line):
            left.pop(name, None)
    for name, key in left.items():
        yield f"# {name + ':':<17} # {key.told()}"


def key_lists() -> str:
    """Return the keys of each kind as the page of help lists them."""
    tables = {word: own_keys(word) for word in KINDS}
    return "\n".join(
        textwrap.fill(
            f"{word:<12} {keys.in_words(explained=True)}",
            80,
            initial_indent="  ",
            subsequent_indent=15 * " ",
            break_on_hyphens=False,
        )
        for word, keys in {**tables, "every kind": SHARED, "rigid kinds": RIGID}.items()
    )
