"""Directions of components, by one rule for all formats and for names of files.

A name states a direction by a SEED code (HNZ, BHE), by a word (Up, vertical, U-D,
north), by an angle (360 Deg, S62W), or by a letter (N, E, Z, V2). Another name states
none: nobody knows whether HN3 is vertical, while HN1 and HN2 are horizontal beside it.
"""

import re
from itertools import pairwise
from pathlib import PurePath

from .units import plain

UP, DOWN, ACROSS, UNKNOWN = "up", "down", "across", "unknown"
_NAMES = {
    UP: "u v z up ud upward upwards vert vertical vertikal vertikale ver vrt dusey 上下"
    " 竖向 垂直 竖直",
    DOWN: "d du dn dwn down downward",
    ACROSS: "n s e w o x y l t r h ns sn ew we eo oe north south east west nord sud est"
    " ovest ost norte sur este oeste kuzey guney dogu bati northsouth eastwest hor"
    " horiz horizontal lon long longi longitudinal trans tran transverse transversal"
    " rad radial radi tangential 南北 东西 東西",
}
_WORDS = {word: name for name, words in _NAMES.items() for word in words.split()}
_SEED = re.compile(r"(?!ch\d)[bhefcdslmgv][hnlgmp]([zens123rtxy])\d{0,2}")
_ANGLE = re.compile(r"\d{2,3}(?:\.0*)?|\d{1,3}(?:\.\d*)?(?:deg\w*|°)|[ns]\d{1,2}[ew]")
_COMPONENT = re.compile(r"\b(?:comp(?:onent)?|dir(?:ection)?)\b\.?")


def direction_of(name: str) -> str:
    """Return UP, DOWN or ACROSS as a name states it, else UNKNOWN."""
    text = _COMPONENT.sub("", re.sub(r"\([^)]*\)", "", plain(name)))  # Up (3)
    text = text.strip(" :=.").rstrip("- ")
    whole = _whole(text)
    if whole != UNKNOWN:
        return whole
    words = [x for x in re.split(r"[\s.,:;()\[\]]+", text) if x]
    pairs = [a + b for a, b in pairwise(words) if b[:3] == "deg"]
    # a letter counts alone or at the end: the N of `N wing` is no direction
    long = [x for x in words[:-1] if len(x.strip("+-")) > 1] + words[-1:]
    found = [_of_word(x) for x in long if not x.isdecimal()]
    found += [ACROSS for x in pairs if _ANGLE.fullmatch(x)]
    return next((x for x in (UP, DOWN, ACROSS) if x in found), UNKNOWN)


def _whole(text: str) -> str:
    """The direction that a name states as a whole, as `N 20 E`."""
    close = re.sub(r"[\s_]+", "", text)
    if close != text and _SEED.fullmatch(close):  # the letters of V NS are no code
        return UNKNOWN
    found = _of_word(close)
    return ACROSS if found == UNKNOWN and _ANGLE.fullmatch(close) else found


def _of_word(word: str) -> str:
    """The direction of one word such as U-D, +Z, V2, HNE or N28W."""
    letters = re.sub(r"(?<=\w)[-/_](?=\w)", "", word.lstrip("+-"))
    if seed := _SEED.fullmatch(letters):
        return ACROSS if seed[1] in "12" else _WORDS.get(seed[1], UNKNOWN)
    if _ANGLE.fullmatch(letters) and not letters[0].isdecimal():
        return ACROSS
    found = _WORDS.get(re.sub(r"\d{1,2}$", "", letters), UNKNOWN)
    turned = found in (UP, DOWN) and word.startswith("-")
    return {UP: DOWN, DOWN: UP}[found] if turned else found


def is_component(name: str) -> bool:
    """True if a name is a direction, or a SEED code, and nothing else."""
    text = plain(name).strip()
    return _whole(text) != UNKNOWN or _SEED.fullmatch(text) is not None


def is_vertical_name(name: str) -> bool:
    """True if a name states the vertical direction, upwards or downwards."""
    return direction_of(name) in (UP, DOWN)


def up_in_name(source: str) -> str | None:
    """Return the vertical direction in the last part of a file name, as of S1_Z.AT2,
    ELC-UP.txt and S1.ud; None without one. A V is one in capitals only.
    """
    path = PurePath(source.removesuffix(".gz"))
    for part in (path.suffix[1:], re.split(r"[\s_.\-]+", path.stem)[-1]):
        letters = part.lower()
        stated = part == "V" or letters == "z" or len(re.sub(r"\d", "", part)) > 1
        if stated and part != path.name and is_vertical_name(part):
            return part
    return None
