"""Modes of linear buildings: the key `building` of a document, and the text of an
option.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from ..documents.keys import Key, Keys
from ..documents.quantities import quantity_at
from ..errors import UsageError

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
# keys without a default; a code takes no participation for granted
_NEEDED = {"building": tuple(MODE.required), "floor": tuple(MODE.all)}
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
    floor, which needs every key. Raises UsageError.
    """
    parts = [part.partition("=") for part in text.split(",")]
    keys = [key.strip() for key, _, _ in parts]
    given = {key.strip(): value.strip() for key, _, value in parts}
    missing = [key for key in _NEEDED[option] if key not in given]
    unknown = [key for key in keys if key not in MODE.all]
    if missing or unknown or len(given) < len(keys):
        why = f"no {missing[0]} in " if missing and not unknown else ""
        raise UsageError(f"`{option}`: found {why}{text!r}; expected {_FORM}")
    found = {}
    for key, value in given.items():
        told = MODE.all[key]
        number = quantity_at(f"`{option}`: {key}", value, told.form)
        if not _holds(key, number):
            zero = key == "xi" and number == 0.0
            why = ", without which the floor never rests" if zero else ""
            raise UsageError(
                f"`{option}`: found {key}={value}; expected {told.range()}{why}"
                f"{_percent(key, number)}"
            )
        found[key] = number
    return FloorMode(found["T"], found["xi"], found.get("gamma_psi", 1.0))


def _holds(key: str, number: float) -> bool:
    """True for a value of a mode [SI] that is within its limits."""
    return MODE.all[key].holds(number) and not (key == "gamma_psi" and number == 0.0)


def _percent(key: str, number: float) -> str:
    """Return a question on a damping ratio that is probably in percent, or nothing."""
    percent = key == "xi" and 1.0 <= number < 100.0
    return f"; did you mean {number / 100.0:g}?" if percent else ""


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
    found = []
    for part in document.parts("building"):
        mode = FloorMode(*(part.quantity(key) for key in MODE.all))
        if mode.gamma_psi == 0.0:
            raise part.fault("gamma_psi", "0", MODE.all["gamma_psi"].range())
        found.append(mode)
    if twice := repeated(found):
        raise document.fault("building", twice, ONE_EACH)
    return tuple(found)


def row_of_mode(mode: FloorMode) -> dict[str, float]:
    """Return a mode as a mapping of a document."""
    return dict(zip(MODE.all, mode, strict=True))
