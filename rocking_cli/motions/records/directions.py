"""Directions of components, by one rule for all formats.

A name states a direction by a SEED code (HNZ, BHE), by a word of some language (Up,
vertical, U-D, north), by an angle (360 Deg, S62W), or by a letter (N, E, Z, V2).
"""

import re

from .units import plain

_UP_WORDS = (
    r"up|upward|upwards|ud|u-d|u/d|u_d|du|dn|down|downward|dwn|vrt|ver|vert\w*|"
    r"vertikale?|dusey|上下|竖向|垂直|竖直"
)
_VERTICAL = re.compile(
    rf"(?<![a-z])[-+]?(?:{_UP_WORDS})\d{{0,2}}(?![a-z])"
    r"|^[-+]?[uvz]\d{0,2}(?![a-z\d])(?!\d*[ew]\b)"  # V2, +Z, Z (3)
    r"|(?:^|[ ._])[bhefcdslmgv][hnlgmp]z\d{0,2}(?:$|[ ._(])"  # HNZ, BHZ00, XX.ABC..HNZ
    r"|(?:^|[ ._])[-+]?[uvz](?:$| \(\d+\)$| comp\w*$)"
)
_ACROSS_WORDS = (
    r"n|s|e|w|ns|sn|ew|we|n-s|s-n|e-w|w-e|n/s|e/w|n_s|e_w|eo|oe|e-o|o-e|"
    r"north|south|east|west|northsouth|"
    r"eastwest|nord|sud|est|ovest|ost|norte|sur|este|oeste|kuzey|guney|dogu|bati|"
    r"x|y|l|t|r|h|h1|h2|hor\w*|long|longitudinal|lon|longi|"
    r"trans|transverse|tran|transversal|"
    r"radial|rad|tangential|南北|东西|東西"
)
_ACROSS = re.compile(
    rf"^[-+]?(?:{_ACROSS_WORDS})\d?(?: comp\w*)?$"
    r"|^(?:\d{2,3}(?:\.0*)?|\d{1,3}(?:\.\d*)? ?(?:deg\w*|°))$"
    r"|^[ns] ?\d{1,2}(?: ?(?:deg\w*|°))? ?[ew]$"
    r"|(?:^|[ ._])(?!ch\d)[bhefcdslmgv][hnlgmp][ens123rtxy]\d{0,2}(?:$|[ ._(])"
)


# what stands between `Component` and the direction, as in `Component: CHAN 2: UP`
_CHANNEL = re.compile(
    r"(?:[\s:=,;(\[#]++|[-–](?=\s)"
    r"|(?:chan(?:nel)?|chn|ch|sensor|trace|track|loc(?:ation)?|kanal|canale?)\.?\s*"
    r"(?:no\.?\s*)?\d{0,3}(?![\w.])"
    r"|acc\w*\.?(?=\s)"
    r"|\d{1,2}(?=\s*[:=(\[]|\s+[-–]\s))*"
    r"([-+\w./]+(?: deg)?)",
    re.IGNORECASE,
)
_TITLE_OF_UP = re.compile(
    r"(\bvert(?:ical)?|(?<=[-–] )(?:up|ud|u-d|down|dn|vrt)|(?<=comp )[vz])"
    r"(?:\s+comp(?:onent)?\.?)?\W*$",
    re.IGNORECASE,
)


# keys of an angle; beside one may stand UP, and a dip of 90 deg is vertical
_ANGLE = re.compile(
    r"\b(?:(?:azimuth?|axis|sensor|achse|asse|eje)\W*(?P<word>[^\W\d_]+)"
    r"|(?:dip|inclination)\W*[-+]?90(?:\.0*)?(?!\.?\d))",
    re.IGNORECASE,
)


def vertical_by_angle(words: str) -> str | None:
    """Return the vertical direction that a line states in the place of an angle, as
    `Azimuth: UP` or `Dip: -90`.
    """
    for found in _ANGLE.finditer(words):
        if found["word"] is None or is_up(found["word"]):
            return found["word"] or "vertical"
    return None


def direction_behind(words: str) -> str:
    """Return the word behind `Component` and words such as CHAN 2, which may be a
    direction.
    """
    found = _CHANNEL.match(words)
    return "" if found is None else found[1].strip(".")


def up_at_end(title: str) -> str | None:
    """Return the vertical direction at the end of a title, as of EL CENTRO VERTICAL."""
    found = _TITLE_OF_UP.search(title)
    return None if found is None else found[1]


def is_up(name: str) -> bool:
    """True if a name states the vertical direction."""
    return _VERTICAL.search(plain(name).strip()) is not None


def is_up_alone(words: str) -> bool:
    """True if words state the vertical direction and nothing else, as UP COMPONENT."""
    kept = [
        x
        for x in words.split()
        if not re.fullmatch(r"(?i)(?:comp|component|dir)\.?:?", x)
    ]
    return len(kept) == 1 and is_up(kept[0])


def is_across(name: str) -> bool:
    """True if a name states a horizontal direction."""
    return not is_up(name) and _ACROSS.search(plain(name).strip()) is not None


def is_direction(name: str) -> bool:
    """True if a name states a direction."""
    return is_up(name) or is_across(name)
