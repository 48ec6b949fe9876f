"""Modes of linear buildings: the key `building` of a document, and the text of an
option.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from ..documents.keys import Key, Keys
from ..errors import DocumentError, UsageError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..documents.document import Document

MODE = Keys(
    {
        "T": Key(
            "time",
            "period",
            least=1e-3,
            most=1e3,
            where="a period from 0.001 to 1000 s",
        ),
        "xi": Key(
            "number",
            "damping ratio",
            above=0.0,
            below=1.0,
            where="a ratio of critical damping above 0 and below 1",
        ),
    },
    {
        "gamma_psi": Key(
            "number",
            "participation times shape at the floor",
            least=-1e3,
            most=1e3,
            default=1.0,
            where="a number from -1000 to 1000 other than zero",
        )
    },
)
ONE_EACH = "one mode for each period"
_FORM = "T=…,xi=…,gamma_psi=…, such as T=0.4,xi=0.05,gamma_psi=1.3"


class FloorMode(NamedTuple):
    """A mode of the building that carries a structure.

    Attributes
    ----------
    period: [s]
    damping: ratio of critical damping [-]
    gamma_psi: its participation times its shape at the floor [-]

    Examples
    --------
    >>> FloorMode(period=0.4, damping=0.05, gamma_psi=1.2).period
    0.4
    """

    period: float  # [s]
    damping: float  # ratio of critical damping [-]
    gamma_psi: float = 1.0  # its participation times its shape at the floor [-]


def parse_mode(text: str, option: str = "building") -> FloorMode:
    """Return the mode that `T=0.4,xi=0.05,gamma_psi=1.3` states; option: building, or
    floor, which needs every key: a code takes no participation for granted. Raises
    UsageError.
    """
    from ..documents.composition import Place
    from ..documents.parsing import document_of
    from ..documents.table import Cell

    place = Place(f"`{option}`: {text}", 0, 0)
    parts = [part.partition("=") for part in text.split(",")]
    cells = [Cell(key.strip(), value.strip(), place) for key, _, value in parts]
    document = document_of(cells, place.source)
    try:
        document.declare(MODE, lambda: [cell.key for cell in cells])  # no labels
        mode = _mode(document)
        if len(document.keys) < len(cells) or document.uncertain:
            raise document.fault(None, "a key twice, or with a spread", _FORM)
        if option == "floor" and not document.has("gamma_psi"):
            raise document.missing("gamma_psi", _FORM)
    except DocumentError as error:
        raise UsageError(str(error)) from None
    return mode


def _mode(part: Document) -> FloorMode:
    """Return the mode that a mapping states. Raises DocumentError."""
    mode = FloorMode(*map(part.quantity, MODE.all))
    if mode.gamma_psi == 0.0:
        raise part.fault("gamma_psi", "0", MODE.all["gamma_psi"].range())
    return mode


def repeated(modes: Sequence[FloorMode]) -> str:
    """Return in words which period two modes of a building have; empty if none."""
    periods = [mode.period for mode in modes]
    twice = [x for x in periods if periods.count(x) > 1]
    return f"two modes of T = {twice[0]:g} s" if twice else ""


def modes_in(document: Document) -> tuple[FloorMode, ...]:
    """Return the modes of the building that the document states, none for a structure
    on the ground. Raises DocumentError.
    """
    if not document.has("building"):
        return ()
    found = list(map(_mode, document.parts("building")))
    if twice := repeated(found):
        raise document.fault("building", twice, ONE_EACH)
    return tuple(found)


def row_of_mode(mode: FloorMode) -> dict[str, float]:
    """Return a mode as a mapping of a document."""
    return dict(zip(MODE.all, mode, strict=True))
