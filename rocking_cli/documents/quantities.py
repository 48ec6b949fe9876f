"""Numbers with units, such as `157.5 deg`, `25 mm` or `0.3 g`. A number without a unit
is in SI units.
"""

import math
import re
from collections.abc import Iterable
from functools import lru_cache

from ..errors import ArgumentError, RockingError, UsageError

# m/s^2: the unit `g`, and the default gravity of a structure. The paper uses it, not
# standard gravity (9.80665).
DEFAULT_GRAVITY = 9.81
# [m]; moments of inertia hold fifth powers, which must stay within double precision
SMALLEST_LENGTH = 1e-9
LARGEST_LENGTH = 1e9

UNITS: dict[str, dict[str, float]] = {
    "length": {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "km": 1e3, "in": 0.0254, "ft": 0.3048},
    "angle": {"rad": 1.0, "deg": math.pi / 180.0, "°": math.pi / 180.0, "mrad": 1e-3},
    "acceleration": {
        **dict.fromkeys(("m/s2", "m/s^2", "m/s²", "m/s**2", "m s-2"), 1.0),
        **dict.fromkeys(("cm/s2", "cm/s^2", "cm/s²", "gal"), 1e-2),
        "mm/s2": 1e-3,
        "g": DEFAULT_GRAVITY,
        "mg": 1e-3 * DEFAULT_GRAVITY,
        "%g": 1e-2 * DEFAULT_GRAVITY,
        "ft/s2": 0.3048,
        "in/s2": 0.0254,
    },
    "frequency parameter": {"rad/s": 1.0, "1/s": 1.0, "rad s-1": 1.0},
    "angular frequency": {"rad/s": 1.0, "1/s": 1.0, "rad s-1": 1.0},
    "frequency": {"Hz": 1.0, "1/s": 1.0},
    "time": {"s": 1.0, "ms": 1e-3},
    "number of years": {"yr": 1.0, "years": 1.0, "kyr": 1e3},
    "velocity": {
        "m/s": 1.0,
        "cm/s": 1e-2,
        "mm/s": 1e-3,
        "ft/s": 0.3048,
        "in/s": 0.0254,
    },
    "mass": {"kg": 1.0, "t": 1e3},
    "density": {
        **dict.fromkeys(("kg/m3", "kg/m^3", "kg/m³"), 1.0),
        **dict.fromkeys(("t/m3", "t/m^3", "t/m³"), 1e3),
    },
    "moment of inertia": {
        **dict.fromkeys(("kg m2", "kg m^2", "kg m²"), 1.0),
        **dict.fromkeys(("t m2", "t m^2", "t m²"), 1e3),
    },
    "force": {"N": 1.0, "kN": 1e3, "MN": 1e6},
    "stiffness": {"N/m": 1.0, "kN/m": 1e3, "MN/m": 1e6, "N/mm": 1e3, "kN/mm": 1e6},
    "damping coefficient": {
        **dict.fromkeys(("N s/m", "Ns/m"), 1.0),
        **dict.fromkeys(("kN s/m", "kNs/m"), 1e3),
    },
    "area": {
        **dict.fromkeys(("m2", "m^2", "m²"), 1.0),
        "cm2": 1e-4,
        **dict.fromkeys(("mm2", "mm^2", "mm²"), 1e-6),
    },
    "stress": {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "GPa": 1e9},
    "number": {},
}
# from each unit to SI
FACTORS = {unit: factor for units in UNITS.values() for unit, factor in units.items()}

# units that are spelt out
_SPELT = {
    **dict.fromkeys(("inch", "inches"), "in"),
    **dict.fromkeys(("meter", "metre", "meters", "metres"), "m"),
    **dict.fromkeys(("degree", "degrees"), "deg"),
    **dict.fromkeys(("sec", "second", "seconds"), "s"),
    "hertz": "hz",
}

_NUMBER = r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
# a number with commas, and the unit behind it
_WITH_COMMAS = re.compile(r"(?<![\d,.])([+-]?[\d.]*,[\d.,]*)(?<=\d)([^,:x]{0,20})")
_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2}(?:,\d{3})+(?:\.\d+)?")
_DECIMAL_COMMA = re.compile(r"([+-]?(?:[1-9]\d{0,2}(?:\.\d{3})+|\d*)),(\d+)")
_DASHED = re.compile(rf"({_NUMBER}[^-]*)-({_NUMBER}[^-]*)")  # 0.1g-1g
_QUANTITY = re.compile(rf"\s*({_NUMBER})(.*)", re.DOTALL)


@lru_cache  # a text is split again for its unit
def split_quantity(text: str) -> tuple[float, str] | None:
    """Split a quantity into (number, unit text); None if the text does not begin with a
    decimal number.
    """
    match = _QUANTITY.match(text)
    return None if match is None else (float(match[1]), match[2].strip())


def is_bare(text: str) -> bool:
    """True for a number without a unit."""
    parts = split_quantity(text)
    return parts is not None and not parts[1]


def unit_of(text: str) -> str:
    """Return the unit that a quantity states, an empty text without one."""
    parts = split_quantity(text)
    return "" if parts is None else parts[1]


def parse_quantity(text: str, dimension: str) -> float:
    """Return the SI value of a finite quantity. Raises ArgumentError, whose text states
    the accepted values.
    """
    parts = split_quantity(text)
    if parts is None or (parts[1] and parts[1] not in UNITS[dimension]):
        raise ArgumentError(accepted(dimension) + as_meant(text, dimension))
    number, unit = parts
    value = number * (UNITS[dimension][unit] if unit else 1.0)
    if not math.isfinite(value):
        raise ArgumentError(
            f"{accepted(dimension)}, within the range of double precision"
        )
    if dimension == "length" and abs(value) > LARGEST_LENGTH:
        raise ArgumentError(f"{accepted(dimension)}, up to {LARGEST_LENGTH:g} m")
    return value


def as_meant(text: str, dimension: str) -> str:
    """Return a hint on how the quantity that a text means is written: with a decimal
    point, without %, its unit in other letters, a range with colons; else an empty
    text.
    """
    if (hint := with_a_point(text)) or (parts := split_quantity(text)) is None:
        return hint
    number, unit = parts
    if ends := _DASHED.fullmatch(text):
        return f"; a range is written {ends[1].strip()}:{ends[2].strip()}"
    written = ""
    if unit == "%" and dimension == "number":
        written = f"{number / 100.0:g}"
    elif unit == "%" and dimension == "acceleration":
        written = f"{number / 100.0:g}g"
    else:
        name = _named_unit(unit, UNITS[dimension])
        written = name and f"{number:g} {name}"
    return f"; did you mean {written}?" if written else ""


def unit_as_meant(word: str, known: Iterable[str]) -> str:
    """Return a question on the unit that a word means, else an empty text."""
    name = _named_unit(word, known)
    return f" (did you mean {name!r}?)" if name else ""


def _named_unit(word: str, known: Iterable[str]) -> str:
    """Return the unit that a word means in other letters or spelt out, else an empty
    text.
    """
    plain = word.casefold()
    meant = (plain, _SPELT.get(plain, plain))
    return next((unit for unit in known if unit.casefold() in meant), "")


def with_a_point(text: str) -> str:
    """Return a hint for a text that holds a number whose commas are decimal or part
    thousands, an empty text for others.
    """
    match = _WITH_COMMAS.search(text)
    if match is None:
        return ""
    number, unit = match.groups()
    decimal = _DECIMAL_COMMA.fullmatch(number)
    pointed = ""
    if decimal:
        whole = decimal[1].replace(".", "") or "0"
        pointed = f"{whole}.{decimal[2]}{unit} with a decimal point"
    if not _THOUSANDS.fullmatch(number):
        return f"; write {pointed}" if pointed else ""
    plain = f"{number.replace(',', '')}{unit}"
    return (
        f"; does the comma stand for thousands? write {plain}, or {pointed}"
        if pointed
        else f"; write {plain} without commas"
    )


def quantity_at(
    place: str,
    text: str,
    dimension: str,
    fault: type[RockingError] = UsageError,
    hint: str = "",
) -> float:
    """Return the SI value of a quantity. Raises `fault`, which names the place, the
    text, the accepted values and the hint.
    """
    try:
        return parse_quantity(text, dimension)
    except ArgumentError as error:
        raise fault(f"{place}: found {text!r}; expected {error}{hint}") from None


def parse_whole(text: str) -> int | None:
    """Return the whole number of a text of 1 to 18 plain digits, None for any other
    text (`2e3`, `1_000`, `²`, `-1`).
    """
    text = text.strip()
    return (
        int(text) if text.isascii() and text.isdecimal() and len(text) <= 18 else None
    )


def si_unit(dimension: str | None) -> str:
    """Return the SI unit of a dimension, empty for a plain number."""
    return next(iter(UNITS.get(dimension or "number", {})), "")


def headed(name: str, unit: str) -> str:
    """Return the heading of a column: its name, and its unit in brackets."""
    return f"{name} [{unit}]" if unit else name


def accepted(dimension: str) -> str:
    """Return the accepted forms of a quantity of this dimension, in words."""
    if dimension == "number":
        return "a number without a unit"
    units = UNITS[dimension]
    article = "an" if dimension[0] in "aeiou" else "a"
    return (
        f"{article} {dimension}: a bare number in {next(iter(units))}, or one with a"
        f" unit ({', '.join(units)})"
    )
