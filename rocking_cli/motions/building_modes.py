"""Modes of linear buildings, and the text that states one."""

from typing import NamedTuple

from ..documents.quantities import quantity_at
from ..errors import UsageError

SHORTEST, LONGEST = 1e-3, 1e3  # periods of a mode [s]
LARGEST = 1e3  # gamma_psi of a mode, of either sign
_KEYS = {"T": "time", "xi": "number", "gamma_psi": "number"}
_HINTS = {"xi": ", such as 0.05 for 5 %"}
# keys without a default; a code takes no participation for granted
_NEEDED = {"building": ("T", "xi"), "floor": tuple(_KEYS)}
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
    unknown = [key for key in keys if key not in _KEYS]
    if missing or unknown or len(given) < len(keys):
        why = f"no {missing[0]} in " if missing and not unknown else ""
        raise UsageError(f"`{option}`: found {why}{text!r}; expected {_FORM}")
    found = {
        key: quantity_at(
            f"`{option}`: {key}", value, _KEYS[key], hint=_HINTS.get(key, "")
        )
        for key, value in given.items()
    }
    mode = FloorMode(found["T"], found["xi"], found.get("gamma_psi", 1.0))
    if not SHORTEST <= mode.period <= LONGEST:
        raise UsageError(
            f"`{option}`: found T={given['T']}; expected a period from {SHORTEST:g} to"
            f" {LONGEST:g} s"
        )
    if not 0.0 < abs(mode.gamma_psi) <= LARGEST:
        raise UsageError(
            f"`{option}`: found gamma_psi={given['gamma_psi']}; expected a number from"
            f" {-LARGEST:g} to {LARGEST:g} other than zero"
        )
    if not 0.0 < mode.damping < 1.0:
        percent = 1.0 <= mode.damping < 100.0
        hint = f"; did you mean {mode.damping / 100.0:g}?" if percent else ""
        zero = ", without which the floor never rests" if mode.damping == 0.0 else ""
        raise UsageError(
            f"`{option}`: found xi={given['xi']}; expected a ratio of critical damping"
            f" above 0 and below 1{zero}{hint}"
        )
    return mode
